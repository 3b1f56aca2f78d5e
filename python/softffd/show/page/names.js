// ---- names of what is seen from its solid side, and how far places are from obstacles ---------------------------------------
const BEYOND = {
  sphere: (at, [x]) => [Math.hypot(...at) - x / 2],
  cylinder: ([x, y, z], size) => [Math.hypot(x, y) - size[0] / 2, Math.abs(z) - size[2] / 2],
  box: (at, size) => at.map((x, a) => Math.abs(x) - size[a] / 2),
};
// Signed distance of a place from an obstacle [m], negative inside.
function gap({ kind, size, now: { anchor, normal, tangent } }, at) {
  const off = plus(at, -1, anchor);
  if (!kind) return dot(off, normal);
  const beyond = BEYOND[kind]([dot(off, tangent), dot(off, cross(normal, tangent)), dot(off, normal)], size);
  return Math.hypot(...beyond.map(b => Math.max(b, 0))) + Math.min(Math.max(...beyond), 0);
}
// The place of a point in the pane, in shares of it from the upper left; null behind the eye.
function on_pane(m, [x, y, z]) {
  const [cx, cy, , cw] = [0, 1, 2, 3].map(i => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i]);
  return cw > 0 ? [(cx / cw + 1) / 2, (1 - cy / cw) / 2] : null;
}
// Where the words stand: of the edge's places that are in the picture, at the lowest; of a solid above.
function place_of_name({ kind, now }, matrix) {
  if (kind) return [0.5, 0.06];
  const sides = [now.tangent, cross(now.normal, now.tangent)], places = [];
  for (const x of [-0.8, 0, 0.8]) for (const y of [-0.8, 0, 0.8]) {
    const at = on_pane(matrix, sides.reduce((place, side, a) => plus(place, [x, y][a] * (now.plate ? 1 : 0.5) * now.extent[a] * now.reach, side), now.centre));
    if ((x || y) && at && at[0] > 0.1 && at[0] < 0.9 && at[1] > 0.1 && at[1] < 0.75) places.push(at);
  }
  return places.sort((a, b) => b[1] - a[1])[0] || [0.5, 0.7];
}
// Where the pane begins in the page.
function corner_of(n) {
  const [width, height] = pane_size();
  return [canvas.offsetLeft + (beside() ? n * width : 0), canvas.offsetTop + (beside() ? 0 : n * height)];
}
function label(text, kind = "") {
  return element("names").appendChild(Object.assign(document.createElement("span"), { textContent: text, className: kind }));
}
function put(label, x, y) { label.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`; }
function name_obstacles({ camera: matrix, eye }, pane, n) {
  const [width, height] = pane_size(), [left, top] = corner_of(n), taken = [];
  for (const body of pane) for (const each of body.obstacles) {
    each.label ||= label(`${name_of(body, each.name)}, from its solid side`);
    each.label.hidden = !state.obstacles || gap(each, eye) >= 0;
    if (each.label.hidden) continue;
    let [x, y] = place_of_name(each, matrix);
    while (taken.some(other => Math.abs(other - y) < 26 / height)) y -= 26 / height;
    taken.push(y);
    const [before, after] = covered(), half = each.label.offsetWidth / 2 + 6;
    put(each.label, left + Math.min(Math.max(x * width, before + half), width - after - half), top + y * height);
  }
  if (PANES.length > 1) put(pane.label ||= label(pane[0].name, "pane"), left + width / 2, Math.max(top, canvas.offsetTop > 0 ? 0 : element("title").parentNode.offsetHeight) + 16);
}
const name_of = (body, name) => body.name ? `${body.name}: ${name}` : name;
