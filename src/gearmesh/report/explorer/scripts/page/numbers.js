// The numbers of the study, unpacked from the page.

const STUDY = JSON.parse(document.getElementById("study").textContent);
const ARRAYS = { f8: Float64Array, f4: Float32Array, u2: Uint16Array, i1: Int8Array };

function unpacked(text, index) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  const found = {};
  for (const [name, [type, start, size]] of Object.entries(index)) {
    found[name] = new ARRAYS[type](bytes.buffer, start, size);
  }
  return found;
}

const NUMBERS = unpacked(document.getElementById("numbers").textContent.trim(), STUDY.arrays);
const FIRST_EXTREMUM = new Uint32Array(NUMBERS.counts.length + 1);
NUMBERS.counts.forEach((count, i) => { FIRST_EXTREMUM[i + 1] = FIRST_EXTREMUM[i] + count; });

// The row of a variant, −1 if the study does not have it.
function rowOf(variant) {
  return STUDY.variants.indexOf(variant);
}

const dotsOf = new Map();

// All extrema of a variant: ν_s, y and whether it is a maximum, in three arrays.
function studyDots(variant) {
  if (dotsOf.has(variant)) return dotsOf.get(variant);
  const row = rowOf(variant), size = NUMBERS.nu.length, found = { nu: [], y: [], maximum: [] };
  dotsOf.set(variant, found);
  for (let j = 0; j < size; j++) {
    const cell = row * size + j;
    for (let i = FIRST_EXTREMUM[cell]; i < FIRST_EXTREMUM[cell + 1]; i++) {
      found.nu.push(NUMBERS.nu[j]);
      found.y.push(NUMBERS.y[i]);
      found.maximum.push(NUMBERS.maximum[i] > 0);
    }
  }
  return found;
}

// The branches of orbits of a variant, each with points [ν_s, y_max, y_min, stability] in arrays.
function studyBranches(variant) {
  const row = rowOf(variant), found = new Map();
  const { branch_variant: variants, branch_number: numbers } = NUMBERS;
  for (let i = 0; variants && i < variants.length; i++) {
    if (variants[i] !== row) continue;
    if (!found.has(numbers[i])) found.set(numbers[i], { nu: [], max: [], min: [], stability: [] });
    const branch = found.get(numbers[i]);
    branch.nu.push(NUMBERS.branch_nu[i]);
    branch.max.push(NUMBERS.branch_max[i]);
    branch.min.push(NUMBERS.branch_min[i]);
    branch.stability.push(NUMBERS.branch_stability[i]);
  }
  return [...found.values()];
}

function studySpecialPoints(variant) {
  const row = rowOf(variant), found = [];
  for (let i = 0; NUMBERS.special_variant && i < NUMBERS.special_variant.length; i++) {
    if (NUMBERS.special_variant[i] !== row) continue;
    found.push({
      kind: STUDY.kinds[NUMBERS.special_kind[i]], periods: NUMBERS.special_periods[i],
      nu: NUMBERS.special_nu[i], max: NUMBERS.special_max[i], min: NUMBERS.special_min[i],
    });
  }
  return found;
}

// What the study has at a variant and a frequency, null off its grid.
function studyCase(variant, nu) {
  const row = rowOf(variant), size = NUMBERS.nu.length;
  const column = NUMBERS.nu.findIndex((value) => Math.abs(value - nu) < 1e-9);
  if (row < 0 || column < 0) return null;
  const cell = row * size + column, status = NUMBERS.status[cell];
  if (status < 0) return null;
  return {
    status: STUDY.statuses[status], sensitive: NUMBERS.sensitive[cell] > 0,
    yMax: NUMBERS.y_max[cell], yMin: NUMBERS.y_min[cell],
  };
}
