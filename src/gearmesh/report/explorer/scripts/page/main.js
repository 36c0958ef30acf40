// The page: controls, pointer and keyboard, and a loop that draws once in a frame.

const SAMPLES = 256;
const byId = (id) => document.getElementById(id);
const canvases = { diagram: byId("diagram"), plane: byId("plane"), course: byId("course") };
const diagram = new Diagram(canvases.diagram), plane = new Plane(), timeCourse = new TimeCourse();
const sweep = new Sweep(() => request());
let theme = readTheme(), result = null, course = null, cursor = null, tip = null;
let pending = null, hashTimer = 0;

// Ask for a drawing in the next frame, and for the run to be computed again.
function request(run = false) {
  const waits = pending !== null;
  pending = run || pending === true;
  if (waits) return;
  requestAnimationFrame(() => {
    const wanted = pending;
    pending = null;
    if (wanted) compute();
    draw();
  });
}

function compute() {
  const start = performance.now();
  result = simulate(problemOf(pairOf(), view.variant, view.nu), SAMPLES);
  course = courseOf(result);
  if (cursor !== null && cursor >= course.count) cursor = null;
  readout(result, performance.now() - start);
  sweep.request();
  byId("progress").textContent = "";
  clearTimeout(hashTimer);
  hashTimer = setTimeout(() => history.replaceState(null, "", hashOf()), 150);
}

// A pen for a canvas of the size that the page gives it, in pixels of the screen.
function penFor(canvas, layer = canvas) {
  const ratio = window.devicePixelRatio || 1, { clientWidth: width, clientHeight: height } = canvas;
  if (layer.width !== Math.round(width * ratio) || layer.height !== Math.round(height * ratio)) {
    layer.width = Math.round(width * ratio);
    layer.height = Math.round(height * ratio);
  }
  const context = layer.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { pen: new CanvasPen(context), width, height };
}

function draw() {
  drawDiagram();
  for (const [panel, canvas] of [[plane, canvases.plane], [timeCourse, canvases.course]]) {
    const { pen, width, height } = penFor(canvas);
    panel.arrange(width, height, result, course);
    panel.draw(pen, theme, cursor);
  }
  if (sweep.active) byId("progress").textContent = progressWords();
  tellCursor();
}

function progressWords() {
  const done = sweep.total - sweep.waiting.length;
  const words = done < sweep.total ? `${done} of ${sweep.total} runs` : `${sweep.total} runs`;
  return `Diagram with your parameters: ${words}. Pale dots: this study.`;
}

// The dots of the diagram are a layer of their own, drawn again only if it has to change.
function drawDiagram() {
  const canvas = canvases.diagram, { pen, width, height } = penFor(canvas);
  diagram.arrange(width, height, result, sweep);
  const { frame } = diagram;
  const key = JSON.stringify([
    width, height, view.variant, view.beside, frame.xRange, frame.yRange, diagram.backlash,
    theme.page, sweep.key, sweep.dots.y.length,
  ]);
  if (key !== diagram.key) {
    diagram.still(penFor(canvas, diagram.layer).pen, theme);
    diagram.key = key;
  }
  pen.context.drawImage(diagram.layer, 0, 0, width, height);
  diagram.live(pen, theme, result);
  if (tip) pen.marker("circle", tip.x, tip.y, 5, theme.ink, theme.accent);
}

function tellCursor() {
  const words = tip ? tip.words : cursor === null ? "" : cursorWords();
  byId("hover").textContent = words;
}

function cursorWords() {
  const i = cursor, { y, v, stiffness, modified, tooth } = course;
  return `t/T = ${number(course.time(i), 6)}   y = ${number(y[i])} yₛₜ   y′ = ${number(v[i])} yₛₜ   ` +
    `C = ${number(stiffness[i], 4)} Cₛ   C(H₁+H₂) = ${number(modified[i], 4)} Cₛ   F = ${number(tooth[i])} Fₛₜ`;
}

// Controls -------------------------------------------------------------------------------------

function showControls() {
  byId("variant").value = view.variant;
  byId("beside").value = view.beside;
  byId("periods").value = String(view.periods);
  if (document.activeElement !== byId("nu-field")) byId("nu-field").value = view.nu;
  byId("nu").value = view.nu;
  for (const field of document.querySelectorAll("[data-parameter]")) {
    const { parameter } = field.dataset, value = shownValue(parameter);
    if (document.activeElement !== field) field.value = +value.toPrecision(6);
    const slider = byId(`slide-${parameter}`);
    slider.value = "logarithmic" in slider.dataset ? Math.log10(value) : value;
    slider.setAttribute("aria-valuetext", field.value);
    field.closest(".parameter").classList.toggle("changed", parameter in view.changed);
  }
  byId("reset").disabled = !Object.keys(view.changed).length;
}

// The text of the stop of the tour whose view is shown; it stays while the reader plays with it.
function showStop() {
  const links = [...document.querySelectorAll("[data-stop]")], hash = hashOf();
  const shown = links.find((link) => link.getAttribute("href") === hash);
  if (!shown) return;
  for (const link of links) {
    byId(`stop-${link.dataset.stop}`).hidden = link !== shown;
    if (link === shown) link.setAttribute("aria-current", "step");
    else link.removeAttribute("aria-current");
  }
}

function changed() {
  showStop();
  showControls();
  request(true);
}

function listen() {
  const on = (id, kind, act) => byId(id).addEventListener(kind, act);
  on("variant", "change", (event) => { view.variant = event.target.value; changed(); });
  on("beside", "change", (event) => { view.beside = event.target.value; changed(); });
  on("periods", "change", (event) => { view.periods = +event.target.value; changed(); });
  on("nu", "input", (event) => { setNu(+event.target.value); changed(); });
  on("nu-field", "change", ({ target }) => {
    setNu(parseFloat(target.value));
    target.blur(); // so that it shows the number that is used
    changed();
  });
  for (const field of document.querySelectorAll("[data-parameter]")) {
    const { parameter } = field.dataset;
    field.addEventListener("change", () => {
      change(parameter, parseFloat(field.value));
      field.blur();
      changed();
    });
    on(`slide-${parameter}`, "input", ({ target }) => {
      const value = "logarithmic" in target.dataset ? 10 ** +target.value : +target.value;
      change(parameter, +value.toPrecision(5));
      changed();
    });
  }
  on("reset", "click", () => { view.changed = {}; changed(); });
  on("save-svg", "click", () => save(fileName(".svg"), "image/svg+xml", pictureSvg()));
  on("save-png", "click", savePng);
  on("save-course", "click", () => save(fileName(".csv"), "text/csv", courseTable(result)));
  on("save-diagram", "click", () => save(fileName("-diagram.csv"), "text/csv", diagramTable(sweep)));
  // A stop is shown at once: the address may still wait to be written for the view before.
  for (const link of document.querySelectorAll("[data-stop]")) {
    link.addEventListener("click", () => { readHash(link.hash); changed(); });
  }
  window.addEventListener("hashchange", () => {
    if (location.hash !== hashOf()) { readHash(location.hash); changed(); }
  });
  new ResizeObserver(() => request()).observe(canvases.diagram);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    theme = readTheme();
    request();
  });
}

const firstStop = document.querySelector("[data-stop]");
readHash(location.hash || firstStop?.getAttribute("href") || "");
listen();
listenToPictures();
changed();
// For tests, and for those who want to compute more: the model, and what is shown.
window.gearmesh = {
  diagram, problemOf, simulate, view, studyDots, studyCase, studyBranches, studySpecialPoints, pairOf,
  sweep, result: () => result, course: () => course,
};
