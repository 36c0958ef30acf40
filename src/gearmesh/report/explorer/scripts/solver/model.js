// The statement of a run in static deflections, 1/Ω_s and static forces, as gearmesh.study.pair and
// gearmesh.model state it. `pair` holds the parameters by their names in the units of the library:
// mm, N/mm, kg, N s/mm, rad.

const POWERS = {
  a: [0, 0, 0], b: [1, 0, 0], c: [0, 1, 0], d: [0, 0, 1],
  e: [1, 1, 0], f: [1, 0, 1], g: [1, 1, 1], h: [0, 1, 1],
};
const SYMBOLS = { conservative: "○", material: "□", lubricant: "•", both: "×" };
const KG_PER_N_S2_MM = 1000;
const PITCH_PHASE = 0.5;

// A variant from its name, such as c-lubricant or c-material-5x.
function readVariant(name) {
  const [letter, symbol, multiple] = name.split("-");
  return { name, letter, symbol, factor: multiple ? parseFloat(multiple) : 1 };
}

function variantLabel(name) {
  const { letter, symbol, factor } = readVariant(name);
  return `${letter}-${SYMBOLS[symbol]}${factor === 1 ? "" : ` (${factor}k)`}`;
}

// Mean stiffness C_s of eq. (5).
function meanStiffness(pair) {
  const high = pair.mesh_stiffness_max, low = pair.stiffness_ratio * high;
  return low + 0.5 * (high - low) * (1 + (2 * pair.contact_ratio - 3));
}

// k1, k2, k3 of eq. (7) in units of C_s y_st, for the powers that act.
function dampingLaw(pair, powers, factor, suffix) {
  const critical = 2 * Math.sqrt(meanStiffness(pair) * pair.reduced_mass / KG_PER_N_S2_MM);
  const reach = pair.static_deflection / pair.damping_length;
  return powers.map((acts, i) => {
    const k = pair[`damping_${i + 1}${suffix}`] ?? pair.damping;
    return 2 * (k / critical) * factor * acts * reach ** i;
  });
}

function problemOf(pair, variantName, nu) {
  const variant = readVariant(variantName), none = [0, 0, 0];
  const powers = POWERS[variant.letter], stiffness = meanStiffness(pair), yst = pair.static_deflection;
  const inMaterial = variant.symbol === "material" || variant.symbol === "both";
  const inLubricant = variant.symbol === "lubricant" || variant.symbol === "both";
  const problem = {
    nu,
    period: 2 * Math.PI / nu,
    periods: pair.revolutions * pair.teeth,
    keptPeriods: pair.kept_revolutions * pair.teeth,
    contactRatio: pair.contact_ratio,
    stiffnessMax: pair.mesh_stiffness_max / stiffness,
    stiffnessMin: pair.stiffness_ratio * pair.mesh_stiffness_max / stiffness,
    material: dampingLaw(pair, inMaterial ? powers : none, variant.factor, ""),
    lubricant: dampingLaw(pair, inLubricant ? powers : none, variant.factor, "m"),
    backlash: pair.backlash / yst,
    bodyMass: pair.body_mass / pair.reduced_mass,
    bearingStiffness: pair.bearing_stiffness / stiffness,
    bearingDampingRatio: pair.bearing_damping_ratio,
    friction: pair.friction_coefficient * Math.tan(pair.pressure_angle),
    frictionCoefficient: pair.friction_coefficient,
    initialPhase: pair.initial_phase,
    tolerance: pair.tolerance,
  };
  problem.segments = segmentsOf(problem);
  const b = -2 / problem.bearingStiffness;
  const y = (pair.initial_displacement ?? yst) / yst;
  problem.start = [(y - b) + b, (pair.initial_velocity ?? 0) / yst, b, 0];
  return problem;
}

// The parts of a mesh period, counted from the start of the run, in which neither C(t) nor the sign
// of the friction jumps: C_max in double contact; one pair rubs before and behind the pitch point.
function segmentsOf(problem) {
  const half = 0.5 * (problem.contactRatio - 1);
  const places = [half, 1 - half];
  if (problem.friction !== 0) places.push(PITCH_PHASE);
  const edges = places.map((place) => modulo(place - problem.initialPhase)).sort((a, b) => a - b);
  edges.unshift(0);
  edges.push(1);
  const found = [];
  for (let i = 0; i + 1 < edges.length; i++) {
    const [start, end] = [edges[i], edges[i + 1]];
    if (!(start < end)) continue;
    const middle = modulo(0.5 * (start + end) + problem.initialPhase);
    const double = Math.abs(middle - Math.round(middle)) < half;
    const sigma = middle - PITCH_PHASE;
    found.push({
      start, end, double,
      length: (end - start) * problem.period,
      stiffness: double ? problem.stiffnessMax : problem.stiffnessMin,
      gamma: double ? 0 : -Math.sign(sigma),
    });
  }
  return found;
}

function modulo(x) {
  return x - Math.floor(x);
}
