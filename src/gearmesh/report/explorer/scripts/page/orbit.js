// The phase plane and the time course of the run that is shown.

// The samples that are shown: the last periods of the run, and the forces there.
function courseOf(result) {
  const { problem, perPeriod } = result, kept = problem.keptPeriods;
  const shown = Math.min(view.periods, kept), count = shown * perPeriod;
  const first = result.y.length - count, firstPeriod = problem.periods - shown;
  const stiffness = new Float64Array(count), modified = new Float64Array(count);
  const dynamic = new Float64Array(count), tooth = new Float64Array(count);
  const corners = [];
  const ends = problem.segments.map((part) => Math.ceil(part.end * perPeriod - 1e-9));
  let segment = 0, before = problem.segments[problem.segments.length - 1].double;
  for (let i = 0; i < count; i++) {
    const place = i % perPeriod;
    if (place === 0) segment = 0;
    while (place >= ends[segment]) segment += 1;
    const part = problem.segments[segment];
    if (part.double !== before) corners.push({ at: i, name: part.double ? "A" : "B" });
    before = part.double;
    const y = result.y[first + i], v = result.v[first + i];
    const regime = regimeOf(y, problem.backlash);
    const depth = regime === NORMAL_MESH ? y : regime === INVERSE_MESH ? y + problem.backlash : 0;
    const [k1, k2, k3] = regime === CONTACT_LOSS ? problem.lubricant : problem.material;
    stiffness[i] = part.stiffness;
    modified[i] = regime === CONTACT_LOSS ? 0 : part.stiffness;
    dynamic[i] = part.stiffness * y;
    tooth[i] = part.stiffness * depth + (k1 + k2 * Math.abs(v) + k3 * v * v) * v;
  }
  return {
    count, perPeriod, firstPeriod, corners, stiffness, modified, dynamic, tooth,
    y: result.y.subarray(first), v: result.v.subarray(first), a: result.a.subarray(first),
    time: (i) => firstPeriod + i / perPeriod,
  };
}

class Plane {
  arrange(width, height, result, course) {
    this.frame = new Frame(
      54, 12, width - 66, height - 56, rangeOf([result.y, [0]]), rangeOf([result.v]),
    );
    this.result = result;
    this.course = course;
  }

  draw(pen, theme, cursor) {
    const { frame, result, course } = this, { problem } = result;
    const colour = theme.of(view.variant);
    frame.regions(pen, theme, problem.backlash, "x");
    pen.within(frame.x, frame.y, frame.width, frame.height, () => {
      pen.line([frame.x, frame.toY(0), frame.x + frame.width, frame.toY(0)], theme.line);
      // Every second sample will do, and keeps the drag smooth.
      pen.line(frame.points(result.y.length >> 1, (i) => result.y[2 * i], (i) => result.v[2 * i]), colour, 1.1);
      const { strobes } = result;
      for (let n = problem.periods - problem.keptPeriods; n <= problem.periods; n++) {
        pen.marker("circle", frame.toX(strobes[2 * n]), frame.toY(strobes[2 * n + 1]), 2.5, theme.ink, theme.normal);
      }
      for (const { at, name } of course.corners) {
        const x = frame.toX(course.y[at]), y = frame.toY(course.v[at]);
        pen.marker(name === "A" ? "up" : "down", x, y, 4.5, theme.ink, colour);
      }
      for (const { at, name } of course.corners.slice(-2)) {
        pen.text(name, frame.toX(course.y[at]) + 8, frame.toY(course.v[at]) - 6, theme.ink, { bold: true, size: 13 });
      }
      if (cursor !== null) pen.marker("circle", frame.toX(course.y[cursor]), frame.toY(course.v[cursor]), 5, theme.ink, theme.accent);
    });
    frame.axes(pen, theme, { xLabel: "y in yₛₜ", yLabel: "y′ in yₛₜ" });
  }

  // The sample next to a place of the phase plane.
  nearest(x, y) {
    const { frame, course } = this;
    let best = null, least = 20 ** 2;
    for (let i = 0; i < course.count; i++) {
      const distance = (frame.toX(course.y[i]) - x) ** 2 + (frame.toY(course.v[i]) - y) ** 2;
      if (distance < least) [best, least] = [i, distance];
    }
    return best;
  }
}

const ROWS = [
  { name: "y", label: "y", lines: [["y", "own", 1.3]], regions: true },
  { name: "v", label: "y′", lines: [["v", "own", 1.3]] },
  { name: "c", label: "C, C(H₁+H₂)", lines: [["stiffness", "grey", 2.6], ["modified", "ink", 1.6]] },
  { name: "f", label: "F, F dyn", lines: [["dynamic", "grey", 1.1], ["tooth", "own", 1.3]] },
];

class TimeCourse {
  arrange(width, height, result, course) {
    this.course = course;
    this.problem = result.problem;
    const gap = 10, row = (height - 56 - gap * (ROWS.length - 1)) / ROWS.length;
    const time = [course.time(0), course.time(course.count)];
    this.frames = ROWS.map(({ lines }, i) => new Frame(
      54, 12 + i * (row + gap), width - 66, row, time, rangeOf(lines.map(([name]) => course[name]).concat([[0]])),
    ));
  }

  draw(pen, theme, cursor) {
    const { course, frames } = this;
    ROWS.forEach((row, i) => {
      const frame = frames[i], last = i === ROWS.length - 1;
      if (row.regions) frame.regions(pen, theme, this.problem.backlash);
      else pen.rect(frame.x, frame.y, frame.width, frame.height, theme.normal);
      pen.within(frame.x, frame.y, frame.width, frame.height, () => {
        for (const [name, colour, width] of row.lines) {
          const values = course[name], paint = colour === "own" ? theme.of(view.variant) : theme[colour];
          pen.line(frame.points(course.count, course.time, (k) => values[k]), paint, width);
        }
        if (row.name === "y") {
          for (const { at, name } of course.corners) {
            const x = frame.toX(course.time(at)), y = frame.toY(course.y[at]);
            pen.marker(name === "A" ? "up" : "down", x, y, 3.5, theme.ink, theme.of(view.variant));
          }
        }
        if (cursor !== null) {
          const x = frame.toX(course.time(cursor));
          pen.line([x, frame.y, x, frame.y + frame.height], theme.accent, 1.2);
        }
      });
      frame.axes(pen, theme, { yLabel: row.label, xNumbers: last, xLabel: last ? "time t/T in mesh periods" : "" });
    });
  }

  sampleAt(x) {
    const at = Math.round((this.frames[0].fromX(x) - this.course.firstPeriod) * this.course.perPeriod);
    return at >= 0 && at < this.course.count ? at : null;
  }
}
