// ---- where the object touches: points of the lattice, or vertices of the surface, that are on an obstacle -----------------
const MOST_MARKED = 200, MOST_WEIGHTS = 1e6;
let touching = null, touched = new Float32Array(0);

// What obstacles meet, by its parameters in the volume; null: the control points themselves.
function places_met() {
  if (live.meets === "surface") return body.surface.coordinates;
  if (!body.bases.includes(2)) return null;
  const nodes = [];                                    // of a solid: thirds of patches
  for (let k = 0; k < NZ; k++) for (let j = 0; j < NY; j++) for (let i = 0; i < NX; i++)
    nodes.push(...[i, j, k].map((m, a) => body.bases[a] === 2 ? m / 3 : m / (body.counts[a] - 1)));
  return nodes;
}
function prepare_touch() {
  const places = places_met();
  if (!places) return { count: POINTS, at: p => now.points.subarray(3 * p, 3 * p + 3) };
  const width = body.counts.reduce((product, n, a) => product * (body.bases[a] ? 4 : n), 1), every = Math.ceil(places.length / 3 * width / MOST_WEIGHTS);
  const count = Math.floor(places.length / 3 / every), which = new Uint16Array(count * width), weights = new Float64Array(count * width);
  for (let n = 0; n < count; n++) weights_at([...places.slice(3 * n * every, 3 * n * every + 3)]).forEach(([p, w], i) => { which[n * width + i] = p; weights[n * width + i] = w; });
  return { count, at(n) {
    let x = 0, y = 0, z = 0;
    for (let i = n * width, { points } = now; i < (n + 1) * width; i++) {
      const p = 3 * which[i], w = weights[i];
      x += w * points[p]; y += w * points[p + 1]; z += w * points[p + 2];
    }
    return [x, y, z];
  } };
}
function find_touched() {
  touching ||= prepare_touch();
  const found = [], pressed = obstacles.filter((_, m) => body.touch.arrows[m].force.some(i => now.outputs?.[i]));
  for (let n = 0; pressed.length && n < touching.count; n++) {
    const at = touching.at(n);
    if (pressed.some(each => Math.abs(gap(each, at)) <= live.near)) found.push(at);
  }
  const few = Math.min(found.length, MOST_MARKED);
  touched = Float32Array.from(Array.from({ length: few }, (_, n) => [...found[Math.floor(n * found.length / few)]]).flat());
}
