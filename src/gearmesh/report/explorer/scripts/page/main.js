// The page: controls, pointer and keyboard, and a loop that draws once in a frame.

const SAMPLES = 256;
const byId = (id) => document.getElementById(id);
const canvases = { diagram: byId("diagram"), plane: byId("plane"), course: byId("course") };
const diagram = new Diagram(canvases.diagram), plane = new Plane(), timeCourse = new TimeCourse();
const sweep = new Sweep(() => request({ still: true }));
let theme = readTheme(), result = null, course = null, cursor = null, tip = null;
let pending = null, hashTimer = 0;

// Ask for a drawing in the next frame: `run` computes again, `still` draws the whole diagram again.
function request(what = {}) {
  if (pending) return void Object.assign(pending, what);
  pending = { ...what };
  requestAnimationFrame(() => {
    const wanted = pending;
    pending = null;
    if (wanted.run) compute();
    draw(wanted.run || wanted.still);
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

function draw(whole) {
  drawDiagram(whole);
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
function drawDiagram(whole) {
  const canvas = canvases.diagram, { pen, width, height } = penFor(canvas);
  diagram.arrange(width, height, result, sweep);
  const { frame } = diagram;
  const key = JSON.stringify([width, height, view.variant, view.beside, frame.xRange, frame.yRange, diagram.backlash, theme.page, sweep.key, sweep.dots.y.length]);
  if (whole && key !== diagram.key || key !== diagram.key) {
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
  request({ run: true });
}

function listen() {
  const on = (id, kind, act) => byId(id).addEventListener(kind, act);
  on("variant", "change", (event) => { view.variant = event.target.value; changed(); });
  on("beside", "change", (event) => { view.beside = event.target.value; changed(); });
  on("periods", "change", (event) => { view.periods = +event.target.value; changed(); });
  on("nu", "input", (event) => { setNu(+event.target.value); changed(); });
  on("nu-field", "change", (event) => { setNu(parseFloat(event.target.value)); changed(); });
  for (const field of document.querySelectorAll("[data-parameter]")) {
    const { parameter } = field.dataset;
    field.addEventListener("change", () => { change(parameter, parseFloat(field.value)); field.blur(); changed(); });
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
  window.addEventListener("hashchange", () => {
    if (location.hash !== hashOf()) { readHash(location.hash); changed(); }
  });
  new ResizeObserver(() => request({ still: true })).observe(canvases.diagram);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { theme = readTheme(); request({ still: true }); });
}

// Pointer and keyboard on the pictures -----------------------------------------------------------

function placeOf(event) {
  const box = event.currentTarget.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

function listenToPictures() {
  const dragged = canvases.diagram;
  const follow = (event) => { setNu(+diagram.frame.fromX(placeOf(event)[0]).toFixed(4)); tip = null; changed(); };
  dragged.addEventListener("pointerdown", (event) => { dragged.setPointerCapture(event.pointerId); follow(event); });
  dragged.addEventListener("pointermove", (event) => {
    if (event.buttons) return void follow(event);
    tip = diagram.nearest(...placeOf(event));
    request();
  });
  const point = (find) => (event) => { tip = null; cursor = find(...placeOf(event)); request(); };
  canvases.plane.addEventListener("pointermove", point((x, y) => plane.nearest(x, y)));
  canvases.course.addEventListener("pointermove", point((x) => timeCourse.sampleAt(x)));
  canvases.course.addEventListener("pointerdown", point((x) => timeCourse.sampleAt(x)));
  for (const canvas of Object.values(canvases)) {
    canvas.addEventListener("pointerleave", () => { tip = null; request(); });
    canvas.addEventListener("keydown", (event) => {
      const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!direction) return;
      event.preventDefault();
      if (canvas === canvases.diagram) { setNu(view.nu + direction * (event.shiftKey ? 0.01 : 0.001)); changed(); return; }
      cursor = clamp((cursor ?? 0) + direction * (event.shiftKey ? 32 : 4), 0, course.count - 1);
      request();
    });
  }
}

// Pictures as files ------------------------------------------------------------------------------

function pictureSvg() {
  const pen = new SvgPen(), width = 1200, top = 30;
  pen.text(`${variantLabel(view.variant)}, νₛ = ${view.nu}   ${changesInWords()}`, 54, 20, theme.ink, { size: 14, bold: true });
  const shifted = (x, y, height, draw) => {
    pen.parts.push(`<g transform="translate(${x} ${y})">`);
    draw(height);
    pen.parts.push("</g>");
  };
  shifted(0, top, 420, (height) => { diagram.arrange(700, height, result, sweep); diagram.still(pen, theme); diagram.live(pen, theme, result); });
  shifted(700, top, 420, (height) => { plane.arrange(500, height, result, course); plane.draw(pen, theme, null); });
  shifted(0, top + 420, 480, (height) => { timeCourse.arrange(width, height, result, course); timeCourse.draw(pen, theme, null); });
  request({ still: true });
  return pen.document(width, top + 900, theme.page);
}

function changesInWords() {
  return Object.entries(view.changed).map(([name, value]) => `${name} = ${value}`).join(", ");
}

function savePng() {
  const image = new Image(), url = URL.createObjectURL(new Blob([pictureSvg()], { type: "image/svg+xml" }));
  image.onload = () => {
    const canvas = document.createElement("canvas");
    canvas.width = 2 * image.width;
    canvas.height = 2 * image.height;
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => save(fileName(".png"), "image/png", blob));
    URL.revokeObjectURL(url);
  };
  image.src = url;
}

const firstStop = document.querySelector("[data-stop]");
readHash(location.hash || firstStop?.getAttribute("href") || "");
listen();
listenToPictures();
changed();
// For tests, and for those who want to compute more: the model, and what is shown.
window.gearmesh = { diagram, problemOf, simulate, view, studyDots, studyCase, studyBranches, studySpecialPoints, pairOf, result: () => result, course: () => course, sweep };
