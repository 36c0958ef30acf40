// The diagram with changed parameters, computed in the background: a few runs in each frame.

const SWEEP_STEPS = 160;
const SLICE = 10; // ms of each frame

class Sweep {
  constructor(onProgress) {
    this.onProgress = onProgress;
    this.key = "";
    this.stop();
  }

  get active() {
    return this.key !== "";
  }

  stop() {
    this.key = "";
    this.waiting = [];
    this.total = 0;
    this.dots = { nu: [], y: [], maximum: [] };
    clearTimeout(this.timer);
  }

  // Begin, unless these very parameters are computed already; without changes there is nothing to do.
  request() {
    const changes = Object.entries(view.changed).sort();
    const key = changes.length ? JSON.stringify([view.variant, changes]) : "";
    if (key === this.key) return;
    this.stop();
    if (!key) return;
    this.key = key;
    this.pair = pairOf();
    this.variant = view.variant;
    this.waiting = spread(NU_FIRST, NU_LAST, SWEEP_STEPS);
    this.total = this.waiting.length;
    this.timer = setTimeout(() => this.proceed(key), 250);
  }

  proceed(key) {
    if (key !== this.key) return;
    const end = performance.now() + SLICE;
    while (this.waiting.length && performance.now() < end) {
      const nu = this.waiting.shift();
      for (const extremum of simulate(problemOf(this.pair, this.variant, nu), 0).extrema) {
        this.dots.nu.push(nu);
        this.dots.y.push(extremum.y);
        this.dots.maximum.push(extremum.kind > 0);
      }
    }
    this.onProgress();
    if (this.waiting.length) this.timer = setTimeout(() => this.proceed(key), 0);
  }
}

// Values that are spread evenly over a range, coarse ones first.
function spread(low, high, steps) {
  const found = [];
  for (let stride = 8; stride >= 1; stride /= 2) {
    for (let i = 0; i <= steps; i += stride) {
      if (stride === 8 || i % (2 * stride)) found.push(low + (high - low) * i / steps);
    }
  }
  return found;
}
