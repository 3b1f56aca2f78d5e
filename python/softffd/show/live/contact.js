// ---- where the object touches: points of the lattice, or vertices of the surface, that are on an obstacle -----------------
const MOST_MARKED = 200, MOST_WEIGHTS = 2e6;
let touching = null, touched = new Float32Array(0);

// What obstacles meet, by its parameters in the volume; null: the control points themselves.
function places_met() {
  if (live.meets === "surface") return decode(run.coordinates, Float32Array);
  if (!run.bases.includes(2)) return null;
  const nodes = [];                                    // of a solid: thirds of patches
  for (let k = 0; k < NZ; k++) for (let j = 0; j < NY; j++) for (let i = 0; i < NX; i++)
    nodes.push(...[i, j, k].map((m, a) => run.bases[a] === 2 ? m / 3 : m / (run.counts[a] - 1)));
  return nodes;
}
function prepare_touch() {
  const places = places_met();
  if (!places) return { count: POINTS, at: p => now.points.subarray(3 * p, 3 * p + 3) };
  const each = run.counts.reduce((product, n, a) => product * (run.bases[a] ? 4 : n), 1), every = Math.ceil(places.length / 3 * each / MOST_WEIGHTS);
  const chosen_ones = Array.from({ length: Math.floor(places.length / 3 / every) }, (_, n) => weights_at([...places.slice(3 * n * every, 3 * n * every + 3)]));
  return { count: chosen_ones.length, at: n => place_of(chosen_ones[n]) };
}
const BEYOND = {
  sphere: (at, [x]) => [Math.hypot(...at) - x / 2],
  cylinder: ([x, y, z], size) => [Math.hypot(x, y) - size[0] / 2, Math.abs(z) - size[2] / 2],
  box: (at, size) => at.map((x, a) => Math.abs(x) - size[a] / 2),
};
// Signed distance of a place from an obstacle [m], negative inside.
function gap({ now: { anchor, normal, tangent } }, solid, at) {
  const off = plus(at, -1, anchor);
  if (!solid) return dot(off, normal);
  const beyond = BEYOND[solid.kind]([dot(off, tangent), dot(off, cross(normal, tangent)), dot(off, normal)], solid.size);
  return Math.hypot(...beyond.map(b => Math.max(b, 0))) + Math.min(Math.max(...beyond), 0);
}
function find_touched() {
  touching ||= prepare_touch();
  const found = [];
  for (let n = 0; n < touching.count; n++) {
    const at = touching.at(n);
    if (obstacles.some((each, m) => Math.abs(gap(each, live.solids[m - run.planes.length], at)) <= live.near)) found.push(at);
  }
  const few = Math.min(found.length, MOST_MARKED);
  touched = Float32Array.from(Array.from({ length: few }, (_, n) => [...found[Math.floor(n * found.length / few)]]).flat());
}
