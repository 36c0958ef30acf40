// Taylor series of the reduced equations of motion (gearmesh.solvers.reduced.taylor): with
// y = u + b, u = R_b (φ_3 + φ_2) and b = y_3 − y_2,
//
//   u'' = 1 − N + g E,    b'' = −2 μ N − 2 ζ w b' − w² b,
//   E = c (y − y_0),      N = E + k_1 v + k_2 |v| v + k_3 v³,    v = y'.
//
// Between two events c, y_0, g, the k_i and the sign of v are constants.

const ORDER = 18;
const REST = 1e-14; // velocities and accelerations below this are rounding errors of a body at rest

// The state of a run, the laws that act on it, and the series of y, v = y', b and r = b'.
class Motion {
  constructor(problem) {
    this.y = new Float64Array(ORDER + 1);
    this.v = new Float64Array(ORDER + 1);
    this.b = new Float64Array(ORDER + 1);
    this.r = new Float64Array(ORDER + 1);
    this.square = new Float64Array(ORDER + 1); // v²
    this.twoMu = 2 / problem.bodyMass;
    const frequency = Math.sqrt(problem.bearingStiffness / problem.bodyMass);
    this.support = frequency * frequency;
    this.supportDamping = 2 * problem.bearingDampingRatio * frequency;
    [this.y[0], this.v[0], this.b[0], this.r[0]] = problem.start;
    this.sign = 0;
    this.elastic = this.friction = this.offset = this.k1 = this.k2 = this.k3 = 0;
  }

  // The sign of v; of the acceleration where v is 0; the last one where both are.
  direction() {
    const v = this.v[0], elastic = this.elastic * (this.y[0] - this.offset);
    const bearing = this.support * this.b[0] + this.supportDamping * this.r[0];
    const acceleration = 1 - elastic + this.friction * elastic - this.twoMu * elastic - bearing;
    const leading = Math.abs(v) <= REST ? acceleration : v;
    if (Math.abs(leading) <= REST) return this.sign || 1;
    return leading < 0 ? -1 : 1;
  }

  // Fill the series from the state.
  expand() {
    const { y, v, b, r, square, k1, k3, twoMu } = this;
    const bend = this.k2 * this.sign, share = 1 + twoMu;
    for (let k = 0; k < ORDER; k++) {
      const height = k === 0 ? y[0] - this.offset : y[k];
      const elastic = this.elastic * height;
      let damping = k1 * v[k];
      if (bend !== 0 || k3 !== 0) {
        square[k] = product(v, v, k);
        damping += bend * square[k];
        if (k3 !== 0) damping += k3 * product(square, v, k);
      }
      const normal = elastic + damping, part = 1 / (k + 1);
      const bearing = this.support * b[k] + this.supportDamping * r[k];
      const load = k === 0 ? 1 : 0;
      y[k + 1] = v[k] * part;
      b[k + 1] = r[k] * part;
      r[k + 1] = (-twoMu * normal - bearing) * part;
      v[k + 1] = (load - share * normal + this.friction * elastic - bearing) * part;
    }
  }

  // The step at which the first terms left out reach the tolerance (Jorba and Zou).
  chooseStep(tolerance) {
    let step = Infinity;
    for (let k = ORDER - 3; k < ORDER; k++) {
      const size = Math.abs(this.v[k]) + Math.abs(this.r[k]) + 1e-290;
      step = Math.min(step, Math.pow(tolerance, 1 / ORDER) * Math.pow(size, -1 / k));
    }
    return step;
  }

  moveTo(s) {
    const y = valueAt(this.y, s), v = valueAt(this.v, s), b = valueAt(this.b, s);
    this.r[0] = valueAt(this.r, s);
    [this.y[0], this.v[0], this.b[0]] = [y, v, b];
  }
}

function product(left, right, k) {
  let total = 0;
  for (let i = 0; i <= k; i++) total += left[i] * right[k - i];
  return total;
}

// The polynomial of a series, without its last coefficient of v, b' that the recurrence leaves open.
function valueAt(series, s) {
  let value = series[ORDER];
  for (let k = ORDER - 1; k >= 0; k--) value = value * s + series[k];
  return value;
}
