// The bifurcation diagram: all extrema of the last revolution against ν_s.

// Names and markers of special points.
const SPECIAL = {
  fold: ["fold", "diamond"], flip: ["period doubling", "square"], torus: ["torus", "down"],
  branch_point: ["branch point", "down"], grazing_front: ["grazing of the front flank", "circle"],
  grazing_back: ["grazing of the back flank", "circle"], switching: ["turning point at a switch of C(t)", "up"],
};
const DASHES = { "1": [], "0": [2, 3], "-1": [7, 4] }; // stable, neutral, unstable

class Diagram {
  constructor(canvas) {
    this.canvas = canvas;
    this.key = "";
    this.layer = document.createElement("canvas");
  }

  // Prepare what does not change while ν_s is dragged.
  arrange(width, height, result, sweep) {
    const sets = [];
    if (view.beside) sets.push({ ...studyDots(view.beside), variant: view.beside, pale: true });
    sets.push({ ...studyDots(view.variant), variant: view.variant, pale: sweep.active });
    if (sweep.active) sets.push({ ...sweep.dots, variant: view.variant, pale: false });
    this.sets = sets;
    // Branches belong to the parameters of the study.
    this.branches = sweep.active ? [] : studyBranches(view.variant);
    this.special = sweep.active ? [] : studySpecialPoints(view.variant);
    const low = Math.min(NU_FIRST, view.nu), high = Math.max(NU_LAST, view.nu);
    const wide = low < high ? [low, high] : [low - 0.1, high + 0.1];
    // The range stays as it is while the run fits in, so that the dots need not be drawn again.
    const known = sets.map((set) => set.y).concat([[0, 1.5]]);
    let y = rangeOf(known);
    if (result.yMax > y[1] || result.yMin < y[0]) y = rangeOf(known.concat([[result.yMin, result.yMax]]));
    this.frame = new Frame(54, 12, width - 66, height - 56, wide, y);
    this.backlash = result.problem.backlash;
  }

  still(pen, theme) {
    const { frame } = this;
    frame.regions(pen, theme, this.backlash);
    pen.within(frame.x, frame.y, frame.width, frame.height, () => {
      for (const set of this.sets) {
        for (const maximum of [false, true]) {
          const chosen = [];
          for (let i = 0; i < set.y.length; i++) {
            if (set.maximum[i] === maximum) chosen.push(frame.toX(set.nu[i]), frame.toY(set.y[i]));
          }
          const colour = set.pale ? theme.line : maximum ? theme.of(set.variant) : theme.soft;
          pen.dots(chosen, colour, (set.pale ? 2 : 1.8) + (NUMBERS.nu.length < 60 ? 1.5 : 0));
        }
      }
      this.branches.forEach((branch) => this.branch(pen, theme, branch));
      for (const { kind, nu, max, min } of this.special) {
        for (const y of [max, min]) {
          pen.marker(SPECIAL[kind][1], frame.toX(nu), frame.toY(y), 3.2, theme.ink, theme.normal);
        }
      }
    });
    frame.axes(pen, theme, { xLabel: "mesh frequency νₛ", yLabel: "extrema of y in yₛₜ" });
  }

  // A branch as lines of y_max and y_min: whole where stable, dotted where neutral, else dashed.
  branch(pen, theme, { nu, max, min, stability }) {
    const { frame } = this;
    for (const y of [max, min]) {
      for (let first = 0, i = 1; i <= nu.length; i++) {
        if (i < nu.length && stability[i] === stability[first]) continue;
        const size = Math.min(i, nu.length - 1) - first + 1;
        pen.line(frame.points(size, (k) => nu[first + k], (k) => y[first + k]), theme.ink, 1, DASHES[stability[first]]);
        first = i;
      }
    }
  }

  live(pen, theme, result) {
    const { frame } = this, x = frame.toX(view.nu);
    pen.within(frame.x - 5, frame.y, frame.width + 10, frame.height, () => {
      pen.line([x, frame.y, x, frame.y + frame.height], theme.accent, 1.5);
      pen.dots(result.extrema.flatMap(({ y }) => [x, frame.toY(y)]), theme.accent, 5);
    });
  }

  // The dot next to a place, with its words.
  nearest(x, pixel) {
    const { frame } = this;
    let best = null, least = 14 ** 2;
    for (const set of this.sets) {
      for (let i = 0; i < set.y.length; i++) {
        const dx = frame.toX(set.nu[i]) - x, dy = frame.toY(set.y[i]) - pixel;
        const distance = dx * dx + dy * dy;
        if (distance < least) {
          least = distance;
          const kind = set.maximum[i] ? "maximum" : "minimum";
          const where = `${variantLabel(set.variant)}  νₛ = ${number(set.nu[i], 6)}`;
          best = { x: x + dx, y: pixel + dy, words: `${where}\n${kind} y = ${number(set.y[i], 6)} yₛₜ` };
        }
      }
    }
    for (const { kind, nu, max, min, periods } of this.special) {
      for (const y of [max, min]) {
        const dx = frame.toX(nu) - x, dy = frame.toY(y) - pixel;
        if (dx * dx + dy * dy >= least) continue;
        least = dx * dx + dy * dy;
        const what = `${SPECIAL[kind][0]} of ${variantLabel(view.variant)}: νₛ = ${number(nu, 7)}, period ${periods} T`;
        const height = `${y === max ? "greatest" : "least"} y = ${number(y, 6)} yₛₜ`;
        best = { x: x + dx, y: pixel + dy, words: `${what}\n${height}` };
      }
    }
    return best;
  }
}
