// The bifurcation diagram: all extrema of the last revolution against ν_s.

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
    const low = Math.min(NU_FIRST, view.nu), high = Math.max(NU_LAST, view.nu);
    const wide = low < high ? [low, high] : [low - 0.1, high + 0.1];
    const y = rangeOf(sets.map((set) => set.y).concat([[0, 1.5], result.extrema.map((e) => e.y)]));
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
          pen.dots(chosen, colour, set.pale ? 2 : 1.8);
        }
      }
    });
    frame.axes(pen, theme, { xLabel: "mesh frequency νₛ", yLabel: "extrema of y in yₛₜ" });
  }

  live(pen, theme, result) {
    const { frame } = this, x = frame.toX(view.nu);
    pen.within(frame.x - 5, frame.y, frame.width + 10, frame.height, () => {
      pen.line([x, frame.y, x, frame.y + frame.height], theme.accent, 1.5);
      for (const extremum of result.extrema) {
        const colour = extremum.kind > 0 ? theme.of(view.variant) : theme.soft;
        pen.marker("circle", x, frame.toY(extremum.y), 3, colour, theme.normal);
      }
    });
  }

  // The dot next to a place, with its words.
  nearest(x, y) {
    const { frame } = this;
    let best = null, least = 14 ** 2;
    for (const set of this.sets) {
      for (let i = 0; i < set.y.length; i++) {
        const dx = frame.toX(set.nu[i]) - x, dy = frame.toY(set.y[i]) - y;
        const distance = dx * dx + dy * dy;
        if (distance < least) {
          least = distance;
          best = { x: x + dx, y: y + dy, words: `${variantLabel(set.variant)}  νₛ = ${number(set.nu[i], 6)}\n${set.maximum[i] ? "maximum" : "minimum"} y = ${number(set.y[i], 6)} yₛₜ` };
        }
      }
    }
    return best;
  }
}
