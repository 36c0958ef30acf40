// What the run gives, in numbers.

function number(value, digits = 5) {
  if (!Number.isFinite(value)) return "–";
  return String(+value.toPrecision(digits)).replace("-", "−");
}

// How far the stroboscopic points of the last revolution are apart: 0 for a motion of period T.
function strobeSpread({ strobes, problem }) {
  let y = [Infinity, -Infinity], v = [Infinity, -Infinity];
  for (let n = problem.periods - problem.keptPeriods; n <= problem.periods; n++) {
    y = [Math.min(y[0], strobes[2 * n]), Math.max(y[1], strobes[2 * n])];
    v = [Math.min(v[0], strobes[2 * n + 1]), Math.max(v[1], strobes[2 * n + 1])];
  }
  return Math.max(y[1] - y[0], v[1] - v[0]);
}

// The least number of periods after which the motion repeats, 0 if it does not within 6.
function repeatsAfter({ strobes, problem }) {
  const end = problem.periods, size = Math.min(12, problem.keptPeriods);
  for (let shift = 1; shift <= Math.min(6, size - 1); shift++) {
    let apart = 0;
    for (let n = end - size + shift; n <= end; n++) {
      apart = Math.max(apart, Math.abs(strobes[2 * n] - strobes[2 * (n - shift)]));
    }
    if (apart < 1e-3) return shift;
  }
  return 0;
}

function motionWords(result) {
  const periods = repeatsAfter(result);
  if (periods === 1) return "repeats after each mesh period";
  if (periods > 1) return `repeats after ${periods} mesh periods`;
  return `does not repeat (stroboscopic points ${number(strobeSpread(result), 3)} yₛₜ apart)`;
}

function readout(result, milliseconds) {
  const known = Object.keys(view.changed).length ? null : studyCase(view.variant, view.nu);
  const rows = {
    "y-max": `${number(result.yMax, 7)} yₛₜ`,
    "y-min": `${number(result.yMin, 7)} yₛₜ`,
    loss: `${number(100 * result.contactLossFraction, 3)} % of the time, ${result.contactLosses} times`,
    motion: result.status === "ok" ? motionWords(result) : result.status,
    study: comparison(result, known),
    time: `${number(milliseconds, 3)} ms, ${result.steps} steps`,
  };
  for (const [name, words] of Object.entries(rows)) {
    document.getElementById(`read-${name}`).textContent = words;
  }
}

// How far the run is from the one in the datasets of the study.
function comparison(result, known) {
  if (!known) return "no case with these parameters";
  if (known.status !== "ok") return known.status.replace("_", " ");
  const apart = Math.max(Math.abs(result.yMax - known.yMax), Math.abs(result.yMin - known.yMin));
  const agrees = apart < 2e-6 * Math.max(1, Math.abs(known.yMax)); // the dataset has 32 bits here
  const words = agrees ? "agrees with the dataset" : `${number(apart, 2)} yₛₜ from the dataset`;
  return known.sensitive ? `${words}; this motion amplifies errors` : words;
}
