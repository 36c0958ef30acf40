// Pictures and numbers as files.

function save(name, type, content) {
  const link = document.createElement("a");
  const blob = content instanceof Blob ? content : new Blob([content], { type });
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

function fileName(ending) {
  return `gearmesh-${view.variant}-nu-${view.nu}${ending}`;
}

// All changed and unchanged parameters, as lines that start with #.
function statement() {
  const lines = [`study: ${STUDY.study}`, `variant: ${view.variant}`, `nu: ${view.nu}`];
  for (const [name, value] of Object.entries(pairOf())) lines.push(`${name}: ${JSON.stringify(value)}`);
  return lines.map((line) => `# ${line}\n`).join("");
}

function courseTable(result) {
  const { problem, perPeriod } = result, shown = view.periods;
  view.periods = problem.keptPeriods;
  const course = courseOf(result);
  view.periods = shown;
  const lines = ["t_over_T,y_rel,v_rel,a_rel,stiffness_rel,modified_stiffness_rel,force_dynamic_rel,tooth_force_rel"];
  for (let i = 0; i < course.count; i++) {
    lines.push([
      problem.periods - problem.keptPeriods + i / perPeriod, course.y[i], course.v[i], course.a[i],
      course.stiffness[i], course.modified[i], course.dynamic[i], course.tooth[i],
    ].join(","));
  }
  return `${statement()}# lengths in y_st, stiffness in C_s, forces in F_st, time in mesh periods\n${lines.join("\n")}\n`;
}

function diagramTable(sweep) {
  const dots = sweep.active ? sweep.dots : studyDots(view.variant);
  const lines = ["nu,y_rel,kind"];
  dots.nu.forEach((nu, i) => lines.push(`${nu},${dots.y[i]},${dots.maximum[i] ? "maximum" : "minimum"}`));
  return `${statement()}${lines.join("\n")}\n`;
}

function pictureSvg() {
  const pen = new SvgPen(), width = 1200, top = 30;
  const title = `${variantLabel(view.variant)}, νₛ = ${view.nu}   ${changesInWords()}`;
  pen.text(title, 54, 20, theme.ink, { size: 14, bold: true });
  const shifted = (x, y, draw) => {
    pen.parts.push(`<g transform="translate(${x} ${y})">`);
    draw(pen);
    pen.parts.push("</g>");
  };
  shifted(0, top, (at) => {
    diagram.arrange(700, 420, result, sweep);
    diagram.still(at, theme);
    diagram.live(at, theme, result);
  });
  shifted(700, top, (at) => {
    plane.arrange(500, 420, result, course);
    plane.draw(at, theme, null);
  });
  shifted(0, top + 420, (at) => {
    timeCourse.arrange(width, 480, result, course);
    timeCourse.draw(at, theme, null);
  });
  request();
  return pen.document(width, top + 900, theme.page);
}

function changesInWords() {
  return Object.entries(view.changed).map(([name, value]) => `${name} = ${value}`).join(", ");
}

function savePng() {
  const blob = new Blob([pictureSvg()], { type: "image/svg+xml" });
  const image = new Image(), url = URL.createObjectURL(blob);
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
