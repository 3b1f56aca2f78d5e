// ---- vectors ---------------------------------------------------------------------------------------------------
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, s, b) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const unit = a => { const l = Math.hypot(...a) || 1; return [a[0] / l, a[1] / l, a[2] / l]; };

// ---- camera: orbits about `target`, with the run's up direction as its pole --------------------------------------
const FOV = 0.56, UP = run.up, EAST = unit(cross(Math.abs(UP[1]) < 0.9 ? [0, 1, 0] : [0, 0, 1], UP)), NORTH = cross(UP, EAST);
const camera = {};
function reset_view() {
  Object.assign(camera, { yaw: run.view[0], pitch: run.view[1], distance: 1, shift: [0, 0, 0], home: true });
  camera.distance = fitting_distance();
  show();
}
// So far away that the box of all that the lattices ever cover is in the picture.
function fitting_distance() {
  const { back, right, above } = camera_frame(), tall = 0.82 * Math.tan(FOV / 2), [width, height] = pane_size(), free = width - covered()[0] - covered()[1], wide = tall * free / height;
  let distance = 0.5 * run.radius;
  for (let corner = 0; corner < 8; corner++) {
    const c = run.half.map((h, a) => corner >> a & 1 ? h : -h);
    distance = Math.max(distance, dot(c, back) + Math.abs(dot(c, right)) / wide, dot(c, back) + Math.abs(dot(c, above)) / tall);
  }
  return distance;
}
// Of a pane: all turn as one, each about the middle of its own.
function camera_frame(pane = PANES[0]) {
  const c = Math.cos(camera.pitch), s = Math.sin(camera.pitch);
  const back = [0, 1, 2].map(a => c * (Math.cos(camera.yaw) * EAST[a] + Math.sin(camera.yaw) * NORTH[a]) + s * UP[a]);
  const right = unit(cross(UP, back)), above = cross(back, right);
  const target = state.follow ? plus(camera.shift, 1, middle_of_object(pane)) : camera.shift;
  return { back, right, above, eye: plus(target, camera.distance, back) };
}
function camera_matrix({ back, right, above, eye }) {
  const f = 1 / Math.tan(FOV / 2), [width, height] = pane_size(), aspect = width / height;
  const near = Math.max(camera.distance - 6 * run.radius, camera.distance * 0.02), far = camera.distance + 12 * run.radius;
  const a = (near + far) / (near - far), b = 2 * near * far / (near - far), m = [];
  for (let i = 0; i < 3; i++) m.push(f / aspect * right[i], f * above[i], a * back[i], -back[i]);
  m.push(-f / aspect * dot(right, eye), -f * dot(above, eye), -a * dot(back, eye) + b, dot(back, eye));
  const shift = off_middle();
  for (let i = 0; i < 16; i += 4) m[i] += shift * m[i + 3];
  return new Float32Array(m);
}
// What readout and controls cover of the canvas on the left and on the right, pixels of the page, but on an upright phone, where it is
// little; where the middle of the rest is, -1 .. 1.
const BROAD = matchMedia("(min-width: 641px)");
function covered() {
  if (!BROAD.matches) return [0, 0];
  const panel = document.getElementById("panel"), { offsetLeft: begin, clientWidth: width } = canvas;
  return [panel?.open ? panel.offsetLeft + panel.offsetWidth - begin : 0, begin + width - element("readout").offsetLeft].map(x => Math.max(x, 0));
}
function off_middle() {
  const [left, right] = covered();
  return (left - right) / pane_size()[0];
}
function middle_of_object(pane = PANES[0]) {
  const sum = [0, 0, 0], count = pane.reduce((points, body) => points + body.points, 0);
  for (const { points, texels } of pane) for (let p = 0; p < points; p++) for (let a = 0; a < 3; a++) sum[a] += texels[4 * p + a] / count;
  return sum;
}
// Panes stand beside each other, in a narrow window below each other: size of one in pixels of the page; place of one in those of the canvas.
const beside = () => canvas.clientWidth >= canvas.clientHeight;
function pane_size() {
  const { clientWidth: w, clientHeight: h } = canvas;
  return beside() ? [w / PANES.length, h] : [w, h / PANES.length];
}
function pane_box(n) {
  const [w, h] = beside() ? [Math.floor(canvas.width / PANES.length), canvas.height] : [canvas.width, Math.floor(canvas.height / PANES.length)];
  return beside() ? [n * w, 0, w, h] : [0, canvas.height - (n + 1) * h, w, h];
}
