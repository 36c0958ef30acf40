// What the page shows: variant, frequency, changed parameters. The hash of the address holds it.

const NU_FIRST = NUMBERS.nu[0], NU_LAST = NUMBERS.nu[NUMBERS.nu.length - 1];
const NU_LOW = 0.05, NU_HIGH = 5;

// Names of the parameters that can be changed -> { factor, value, least, greatest } as shown.
const CONTROLS = {};
for (const field of document.querySelectorAll("[data-parameter]")) {
  const { parameter, factor, value, least, greatest } = field.dataset;
  CONTROLS[parameter] = { factor: +factor, value: +value, least: +least, greatest: +greatest };
}
const WHOLE = new Set(["revolutions"]);

const view = { variant: "", beside: "", nu: 0, periods: 5, changed: {} };
resetView();

function resetView() {
  const preferred = ["c-lubricant", STUDY.variants[0]].find((name) => rowOf(name) >= 0);
  Object.assign(view, { variant: preferred, beside: "", periods: 5, changed: {} });
  view.nu = clamp(0.7, NU_FIRST, NU_LAST);
}

function clamp(x, low, high) {
  return Math.min(Math.max(x, low), high);
}

// Set a parameter to a number in the unit that is shown; the study's own value is no change.
function change(name, shown) {
  const { least, greatest, value } = CONTROLS[name];
  if (!Number.isFinite(shown)) return;
  const allowed = clamp(WHOLE.has(name) ? Math.round(shown) : shown, least, greatest);
  if (allowed === value) delete view.changed[name];
  else view.changed[name] = allowed;
}

function shownValue(name) {
  return view.changed[name] ?? CONTROLS[name].value;
}

function setNu(nu) {
  if (Number.isFinite(nu)) view.nu = +clamp(nu, NU_LOW, NU_HIGH).toFixed(6);
}

// The parameters of the run that is shown, in the units of the library.
function pairOf() {
  const pair = { ...STUDY.pair };
  for (const [name, shown] of Object.entries(view.changed)) {
    pair[name] = shown * CONTROLS[name].factor;
  }
  pair.kept_revolutions = Math.min(pair.kept_revolutions, pair.revolutions);
  return pair;
}

function readHash(hash) {
  resetView();
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  for (const [name, text] of given) {
    if ((name === "variant" || name === "beside") && rowOf(text) >= 0) view[name] = text;
    else if (name === "nu") setNu(parseFloat(text));
    else if (name === "periods" && [2, 5, 21].includes(+text)) view.periods = +text;
    else if (Object.hasOwn(CONTROLS, name)) change(name, parseFloat(text));
  }
}

function hashOf() {
  const given = new URLSearchParams({ variant: view.variant, nu: String(view.nu) });
  if (view.beside) given.set("beside", view.beside);
  if (view.periods !== 5) given.set("periods", String(view.periods));
  for (const [name, shown] of Object.entries(view.changed)) given.set(name, String(shown));
  return `#${given}`;
}
