// One run from event to event, and what is measured of it (gearmesh.solvers.reduced.sweep).

const NORMAL_MESH = 1, CONTACT_LOSS = 0, INVERSE_MESH = -1;
const FARTHEST = 1e6; // beyond this distance, in y_st, a run has diverged
const MOST_STEPS = 4000; // in a mesh period; more is hopeless while someone waits for a picture

function regimeOf(y, backlash) {
  return y >= 0 ? NORMAL_MESH : y <= -backlash ? INVERSE_MESH : CONTACT_LOSS;
}

// Two radians of the fastest oscillation, as gearmesh.solvers.limits.
function longestStep(problem) {
  const bearing = problem.bearingStiffness / problem.bodyMass;
  const stiffest = problem.contactRatio > 1 ? problem.stiffnessMax : problem.stiffnessMin;
  return 2 / Math.sqrt(stiffest * (1 + 2 / problem.bodyMass) + bearing);
}

// Integrate a run. `samplesPerPeriod` samples of y, v and y'' are kept of the last revolutions.
function simulate(problem, samplesPerPeriod) {
  const run = new Run(problem, samplesPerPeriod);
  while (run.period < problem.periods && run.status === "ok") run.step();
  return run.finish();
}

class Run {
  constructor(problem, samplesPerPeriod) {
    this.problem = problem;
    this.perPeriod = samplesPerPeriod;
    this.motion = new Motion(problem);
    this.longest = longestStep(problem);
    this.firstKept = problem.periods - problem.keptPeriods;
    this.period = this.segment = this.sinceSegment = this.sinceBoundary = this.steps = 0;
    this.regime = regimeOf(this.motion.y[0], problem.backlash);
    this.found = { end: 0, event: PASSED };
    this.status = "ok";
    this.strobes = new Float64Array(2 * (problem.periods + 1));
    this.extrema = [];
    this.lossTime = this.losses = 0;
    this.yMax = -Infinity;
    this.yMin = Infinity;
    const size = problem.keptPeriods * samplesPerPeriod;
    this.samples = ["y", "v", "a"].map(() => new Float64Array(size));
    this.nextSample = 0;
    this.recordBoundary();
    this.enter();
  }

  get kept() {
    return this.period >= this.firstKept;
  }

  // Take over the laws of the regime and of the segment.
  enter() {
    const { problem, motion, regime } = this, part = problem.segments[this.segment];
    const lost = regime === CONTACT_LOSS, s = problem.backlash;
    motion.elastic = lost ? 0 : part.stiffness;
    motion.friction = problem.friction * part.gamma;
    motion.offset = regime === INVERSE_MESH ? -s : 0;
    [motion.k1, motion.k2, motion.k3] = lost ? problem.lubricant : problem.material;
    this.above = regime === NORMAL_MESH ? Infinity : lost ? 0 : -s;
    this.below = regime === NORMAL_MESH ? 0 : lost ? -s : -Infinity;
  }

  step() {
    const { motion, found } = this, length = this.problem.segments[this.segment].length;
    this.turn();
    motion.expand();
    const remaining = length - this.sinceSegment;
    const step = Math.min(remaining, this.longest, motion.chooseStep(this.problem.tolerance));
    findEvent(motion, step, step >= remaining, this.below, this.above, found);
    if (this.kept && this.perPeriod) this.sample(found.end);
    if (this.kept && this.regime === CONTACT_LOSS) this.lossTime += found.end;
    motion.moveTo(found.end);
    if (found.event === TURNED) motion.v[0] = 0;
    this.sinceSegment += found.end;
    this.sinceBoundary += found.end;
    if (found.event === CROSSED) this.cross();
    if (found.event === SEGMENT_ENDED || !(length > this.sinceSegment)) this.endSegment();
    this.steps += 1;
    if (!(Math.abs(motion.y[0]) < FARTHEST)) this.status = "diverged";
    else if (this.steps > MOST_STEPS * (this.period + 1)) this.status = "too many steps";
  }

  // Find the direction of motion, and record an extremum where it has changed.
  turn() {
    const { motion } = this, before = motion.sign;
    motion.sign = motion.direction();
    if (before * motion.sign >= 0 || !this.kept) return;
    const y = motion.y[0];
    this.take(y);
    this.extrema.push({
      time: this.period * this.problem.period + this.sinceBoundary, y, kind: -motion.sign,
    });
  }

  // Change the regime, and put y on the level exactly.
  cross() {
    const { motion, regime } = this, lost = regime === CONTACT_LOSS;
    const rising = motion.sign > 0;
    motion.y[0] = rising ? this.above : this.below;
    if (!lost && this.kept) this.losses += 1;
    this.regime = !lost ? CONTACT_LOSS : rising ? NORMAL_MESH : INVERSE_MESH;
    this.enter();
  }

  endSegment() {
    this.sinceSegment = 0;
    this.segment += 1;
    if (this.segment === this.problem.segments.length) {
      this.segment = 0;
      this.period += 1;
      this.sinceBoundary = 0;
      this.recordBoundary();
    }
    this.enter();
  }

  recordBoundary() {
    const { motion, period } = this;
    this.strobes[2 * period] = motion.y[0];
    this.strobes[2 * period + 1] = motion.v[0];
    if (this.period === this.firstKept) this.take(motion.y[0]);
  }

  take(y) {
    this.yMax = Math.max(this.yMax, y);
    this.yMin = Math.min(this.yMin, y);
  }

  // Write the samples of y, v and y'' that fall on the step.
  sample(end) {
    const { motion, samples, perPeriod } = this, spacing = this.problem.period / perPeriod;
    const begin = (this.period - this.firstKept) * perPeriod;
    for (;;) {
      const time = (this.nextSample - begin) * spacing - this.sinceBoundary;
      if (!(time < end) || this.nextSample >= begin + perPeriod) return;
      derivatives(motion.v, time, _there);
      samples[0][this.nextSample] = valueAt(motion.y, time);
      samples[1][this.nextSample] = _there[0];
      samples[2][this.nextSample] = _there[1];
      this.nextSample += 1;
    }
  }

  finish() {
    const { problem, motion } = this, duration = problem.keptPeriods * problem.period;
    this.take(motion.y[0]);
    return {
      status: this.status, problem, strobes: this.strobes, extrema: this.extrema,
      yMax: this.yMax, yMin: this.yMin, steps: this.steps,
      contactLossFraction: this.lossTime / duration, contactLosses: this.losses,
      y: this.samples[0], v: this.samples[1], a: this.samples[2], perPeriod: this.perPeriod,
    };
  }
}
