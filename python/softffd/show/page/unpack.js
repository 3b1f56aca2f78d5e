// ---- the surface: what surface.py has packed ---------------------------------------------------------------------------
const NORMAL_MOST = 2 ** 11 - 1;
const decode = (text, Type) => new Type(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
const opened = async text => new Uint8Array(await new Response(new Blob([decode(text.trim(), Uint8Array)]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer());

// Columns of whole numbers. Those of vertices are sums of what is held; a number's last bit is its sign.
function columns_of(bytes, columns) {
  let at = 0;
  return columns.map(([count, planes]) => {
    const values = new Int32Array(count);
    for (let plane = 0; plane < planes; plane++, at += count) for (let i = 0; i < count; i++) values[i] |= bytes[at + i] << 8 * plane;
    for (let i = 0; i < count; i++) values[i] = values[i] >>> 1 ^ -(values[i] & 1);
    return values;
  });
}
function summed(values) {
  for (let i = 1; i < values.length; i++) values[i] += values[i - 1];
  return values;
}
function interleaved(Type, columns, width, value) {
  const out = new Type(width * columns[0].length);
  columns.forEach((column, a) => { for (let i = 0; i < column.length; i++) out[width * i + a] = value(column[i], a); });
  return out;
}
// { coordinates (3), normals (3 of 4), tints (3 of 4), uv (2), atlas (4) where there are taxels, triangles (3), parts }
async function unpack({ block, columns, scales, uv_scales, atlas_scales = [], parts }) {
  const all = columns_of(await opened(block), columns), placed = of => (i, a) => of[a][0] + i * of[a][1];
  const [x, y, z, n, m, r, g, b, u, v] = all, [first, second, third] = all.slice(-3), taxels = all.slice(10, 10 + atlas_scales.length);
  for (const each of all.slice(0, -2)) summed(each);
  const triangles = new Uint32Array(3 * first.length), normals = new Int16Array(4 * n.length);
  for (let i = 0; i < first.length; i++) { triangles[3 * i] = first[i]; triangles[3 * i + 1] = first[i] + second[i]; triangles[3 * i + 2] = first[i] + third[i]; }
  for (let i = 0; i < n.length; i++) {
    let p = n[i] / NORMAL_MOST, q = m[i] / NORMAL_MOST;
    const up = 1 - Math.abs(p) - Math.abs(q), fold = Math.max(-up, 0);
    p -= p < 0 ? -fold : fold;
    q -= q < 0 ? -fold : fold;
    const size = 32767 / Math.hypot(p, q, up);
    normals.set([p * size, q * size, up * size], 4 * i);
  }
  return { coordinates: interleaved(Float32Array, [x, y, z], 3, placed(scales)), normals, tints: interleaved(Uint8Array, [r, g, b], 4, i => i),
    uv: interleaved(Float32Array, [u, v], 2, placed(uv_scales)), atlas: taxels.length && interleaved(Float32Array, taxels, 4, placed(atlas_scales)), triangles, parts };
}
