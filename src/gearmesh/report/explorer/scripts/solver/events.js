// The first event of a step (gearmesh.solvers.reduced.events): a turning point of y, or the level
// that ends the regime. Up to the first turning point y is monotone, so it passes a level at most
// once; an orbit that dips through y = 0 and returns within a step (grazing) is found, too.

const PLACES = 4;
const MOST_ITERATIONS = 60;
const PASSED = 0, TURNED = 1, CROSSED = 2, SEGMENT_ENDED = 3;

// Write v, y'' and y''' at s into `out`.
function derivatives(v, s, out) {
  let value = v[ORDER], slope = 0, bend = 0;
  for (let k = ORDER - 1; k >= 0; k--) {
    bend = bend * s + slope;
    slope = slope * s + value;
    value = value * s + v[k];
  }
  out[0] = value;
  out[1] = slope;
  out[2] = 2 * bend;
}

const _there = new Float64Array(3);

// The place in ⟨low; high⟩ where `series` − level passes 0, side times which is positive at `low`.
function root(series, level, side, low, high) {
  let at = 0.5 * (low + high);
  for (let i = 0; i < MOST_ITERATIONS; i++) {
    derivatives(series, at, _there);
    const value = _there[0] - level;
    if (side * value > 0) low = at;
    else high = at;
    const newton = value / _there[1];
    let next = at - newton;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const moved = Math.abs(next - at);
    at = next;
    if (moved <= 1e-15 + 1e-15 * Math.abs(at) || high - low <= 1e-16) break;
  }
  return at;
}

// The place of the least value of side × v in ⟨low; high⟩, where side × v' turns from − to +.
function lowestPlace(v, side, low, high) {
  let at = 0.5 * (low + high);
  for (let i = 0; i < MOST_ITERATIONS; i++) {
    derivatives(v, at, _there);
    if (side * _there[1] < 0) low = at;
    else high = at;
    let next = at - _there[1] / _there[2];
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (Math.abs(next - at) <= 1e-7) return next;
    at = next;
  }
  return at;
}

// The first place of ⟨0; step⟩ at which sign × v falls below 0, Infinity if there is none.
function turningPoint(motion, step) {
  const { v, sign } = motion, width = step / PLACES;
  let before = sign * v[0], slopeBefore = sign * v[1];
  for (let j = 0; j < PLACES; j++) {
    const low = j * width, high = low + width;
    derivatives(v, high, _there);
    const value = sign * _there[0], slope = sign * _there[1];
    if (value < -REST) {
      // A step that begins at a turning point must not find that one again.
      const from = before <= REST ? firstRise(v, sign, low, high) : low;
      return from < 0 ? high : root(v, 0, sign, from, high);
    }
    if (slopeBefore < 0 && slope > 0) {
      const meet = (value - before - slope * width) / (slopeBefore - slope);
      if (before + slopeBefore * meet <= 0) {
        const at = lowestPlace(v, sign, low, high);
        if (sign * valueAt(v, at) < -REST) return root(v, 0, sign, low, at);
      }
    }
    before = value;
    slopeBefore = slope;
  }
  return Infinity;
}

// A place in ⟨low; high⟩ where sign × v is above rounding, found by halving; −1 if there is none.
function firstRise(v, sign, low, high) {
  for (let width = 0.5 * (high - low); width > 1e-9; width *= 0.5) {
    if (sign * valueAt(v, low + width) > REST) return low + width;
  }
  return -1;
}

// How far the step goes, up to its first event, and what that event is: written into `found`.
function findEvent(motion, step, ends, below, above, found) {
  const turn = turningPoint(motion, step);
  const end = Math.min(turn, step), { sign } = motion;
  const level = sign > 0 ? above : below;
  found.end = end;
  found.event = turn < step ? TURNED : ends ? SEGMENT_ENDED : PASSED;
  if (Math.abs(level) < Infinity && sign * (level - valueAt(motion.y, end)) < 0) {
    found.end = root(motion.y, level, -sign, 0, end);
    found.event = CROSSED;
  }
}
