// ---- colours of the cells: von Mises stress and largest principal stretch at their centres, by the formulas of run/stress.py -----------
const CELLS = body.counts.map(n => n - 1), SIDES = body.size.map((side, a) => side / CELLS[a]), VOLUME = SIDES[0] * SIDES[1] * SIDES[2];
const WAYS = [];                                         // springs from a point to half of its neighbours, in numbers of cells
for (const x of [-1, 0, 1]) for (const y of [-1, 0, 1]) for (const z of [-1, 0, 1]) if (9 * x + 3 * y + z > 0) WAYS.push([x * SIDES[0], y * SIDES[1], z * SIDES[2]]);

// For the cells along each axis: the control points that count at their centres, their weights, and their slopes by the place at rest.
const centres = body.counts.map((n, a) => Array.from({ length: n - 1 }, (_, cell) => {
  if (body.bases[a] !== 2 && !live.solid) return [[cell, 0.5, -1 / SIDES[a]], [cell + 1, 0.5, 1 / SIDES[a]]];
  const e = 1e-4, [at, ahead, behind] = [0, e, -e].map(d => along(body.bases[a] === 2 ? (cell + 0.5) / 3 + d : (cell + 0.5) / (n - 1) + d, n, body.bases[a]));
  const length = body.size[a] / (body.bases[a] === 2 ? n / 3 | 0 : 1);
  return at.map((w, p) => [p, w, (ahead[p] - behind[p]) / (2 * e * length)]).filter(([, w, d]) => w || d);
}));
// F, row by row.
function gradient(i, j, k) {
  const F = Array(9).fill(0);
  for (const [z, wz, dz] of centres[2][k]) for (const [y, wy, dy] of centres[1][j]) for (const [x, wx, dx] of centres[0][i]) {
    const p = 3 * (x + NX * (y + NY * z)), slopes = [dx * wy * wz, wx * dy * wz, wx * wy * dz];
    for (let a = 0; a < 3; a++) for (let b = 0; b < 3; b++) F[3 * a + b] += now.points[p + a] * slopes[b];
  }
  return F;
}
const rows_of = F => [F.slice(0, 3), F.slice(3, 6), F.slice(6, 9)];
const change_of = F => { const [a, b, c] = rows_of(F); return dot(a, cross(b, c)); };
const slider_of = label => sliders.find(slider => slider.label === label);

// Cauchy stress without what is the same along all axes, which has no part in the following.
function stress(F, cell) {
  const rows = rows_of(F), S = Array(9).fill(0), J = change_of(F);
  if (live.solid) {
    const mu = slider_of("youngs modulus").now / (2 * (1 + slider_of("poissons ratio").now));
    return S.map((_, n) => mu * dot(rows[n / 3 | 0], rows[n % 3]) / J);
  }
  const { now: value, start } = slider_of("stiffness") || slider_of("youngs modulus");
  WAYS.forEach((rest, way) => {
    const d = rows.map(row => dot(row, rest)), n = WAYS.length * cell + way, k = live.springs[n] + (value / start - 1) * live.stiffer[n];
    const pull = k * (1 - Math.hypot(...rest) / Math.hypot(...d)) / (VOLUME * J);
    for (let a = 0; a < 9; a++) S[a] += pull * d[a / 3 | 0] * d[a % 3];
  });
  return S;
}
const MEASURES = {
  von_mises(F, cell) {
    const S = stress(F, cell), mean = (S[0] + S[4] + S[8]) / 3;
    return Math.sqrt(1.5 * S.reduce((sum, s, n) => sum + (s - (n % 4 ? 0 : mean)) ** 2, 0));
  },
  // The root of the largest eigenvalue of F^T F, by the cosine of a third of an angle.
  stretch(F) {
    const [a, b, c] = [0, 1, 2].map(n => [F[n], F[n + 3], F[n + 6]]), m = (dot(a, a) + dot(b, b) + dot(c, c)) / 3;
    const [p, q, r, x, y, z] = [dot(a, a) - m, dot(b, b) - m, dot(c, c) - m, dot(b, c), dot(c, a), dot(a, b)];
    const size = Math.sqrt((p * p + q * q + r * r + 2 * (x * x + y * y + z * z)) / 6) || 1e-300;
    const half = (p * (q * r - x * x) - z * (z * r - x * y) + y * (z * x - q * y)) / (2 * size ** 3);
    return Math.sqrt(m + 2 * size * Math.cos(Math.acos(Math.min(Math.max(half, -1), 1)) / 3));
  },
};
// Shares of the scale in 255 and whether a cell is inverted; the scale's end is the largest value so far.
function cell_shares(each) {
  const values = [], out = new Uint8Array(2 * CELLS[0] * CELLS[1] * CELLS[2]);
  for (let k = 0; k < CELLS[2]; k++) for (let j = 0; j < CELLS[1]; j++) for (let i = 0; i < CELLS[0]; i++) {
    const F = gradient(i, j, k);
    values.push(change_of(F) > 0 ? MEASURES[each.name](F, (i * CELLS[1] + j) * CELLS[2] + k) : NaN);
  }
  const most = Math.max(...values.filter(Number.isFinite), each.ends[1]);
  if (most > 1.001 * each.ends[1]) { each.ends[1] = most; element("largest").textContent = quantity(+most.toPrecision(3), each.unit); }
  values.forEach((value, n) => {
    out[2 * n] = Number.isFinite(value) ? Math.round(255 * Math.min(Math.max((value - each.ends[0]) / (each.ends[1] - each.ends[0]), 0), 1)) : 0;
    out[2 * n + 1] = Number.isFinite(value) ? 0 : 255;
  });
  return out;
}
