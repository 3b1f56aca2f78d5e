// ---- the hand: what is under the pointer, and where it is taken ------------------------------------------------------
// A pixel is drawn with numbers of its place: whole numbers, which every WebGL 2 can draw into.
SOURCES["pick-vertex"] = `
layout(location = 0) in vec3 coordinates;
uniform mat4 camera;
out vec3 world;
void main() { mat3 derivative; vec3 place; gl_Position = camera * vec4(evaluate(coordinates, derivative, place), 1); world = coordinates; }`;
SOURCES["pick-fragment"] = `
precision highp float;
in vec3 world;
uniform float number;
out highp uvec4 found;
void main() { found = uvec4(floatBitsToUint(world), uint(number)); }`;
const REACH = { mouse: 3, pen: 6, touch: 12 };           // how far beside the pointer a thing is taken, pixels of the page
let picker, grip = null;                               // grip: what a pointer holds

function build_picker() {
  const frame = gl.createFramebuffer(), radius = Math.ceil(REACH.touch * 2), side = 2 * radius + 1;
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  for (const [place, format] of [[gl.COLOR_ATTACHMENT0, gl.RGBA32UI], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]]) {
    const made = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, made);
    gl.renderbufferStorage(gl.RENDERBUFFER, format, side, side);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, made);
  }
  return { frame, radius, side, object: program("pick-vertex", "pick-fragment"), solid: program("solid-vertex", "pick-fragment"), plane: program("plane-vertex", "pick-fragment") };
}
// The obstacle at a place of the canvas, or the parameters there of the object; the nearest within reach; null where there is nothing that can be held.
function pick(x, y, reach) {
  picker ||= build_picker();
  const ratio = canvas.width / canvas.clientWidth, { radius, side } = picker, common = { camera: camera_matrix(camera_frame()), points: 0 };
  gl.bindFramebuffer(gl.FRAMEBUFFER, picker.frame);
  gl.viewport(radius - Math.floor(x * ratio), radius + Math.floor(y * ratio) + 1 - canvas.height, canvas.width, canvas.height);
  gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
  gl.clearBufferfv(gl.DEPTH, 0, [1]);
  gl.enable(gl.DEPTH_TEST);
  bind(0, body.lattice);
  use(picker.object, { ...common, number: 1 });
  gl.bindVertexArray(body.object.array);
  gl.drawElements(gl.TRIANGLES, body.object.count, gl.UNSIGNED_INT, 0);
  if (state.obstacles) obstacles.forEach((each, n) => {
    const { form } = each;
    if (!form && each.floor && part_of(each) !== chosen) return;   // a floor is everywhere: it is held once it is chosen in the list
    use(form ? picker.solid : picker.plane, { ...common, ...each.now, number: n + 2 });
    gl.bindVertexArray(form ? form.array : planes.array);
    if (form) gl.drawElements(gl.TRIANGLES, form.count, gl.UNSIGNED_INT, 0); else gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  });
  const found = new Uint32Array(4 * side * side), places = new Float32Array(found.buffer);
  gl.readPixels(0, 0, side, side, gl.RGBA_INTEGER, gl.UNSIGNED_INT, found);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  let best = null, least = (reach * ratio + 0.5) ** 2;
  for (let n = 0; n < side * side; n++) {
    const away = (n % side - radius) ** 2 + (Math.floor(n / side) - radius) ** 2;
    if (found[4 * n + 3] && away < least) { least = away; best = n; }
  }
  if (best === null) return null;
  const number = found[4 * best + 3], at = [...places.subarray(4 * best, 4 * best + 3)];
  return number === 1 ? { uvw: at } : { obstacle: obstacles[number - 2], at };
}
const part_of = obstacle => live.open.parts.findIndex(part => part.label === obstacle.name && !part.held.length);

// The weights of the control points along an axis, as view.glsl has them, in double precision.
function along(s, n, basis) {
  const b = Array(n).fill(0);
  if (basis === 1) {
    const first = Math.min(Math.max(Math.floor(s), 0), n - 4), c = [1, 0, 0, 0];
    for (let m = 1; m < 4; m++) {
      let rising = 0;
      for (let r = 0; r < m; r++) {
        const low = Math.max(first + 1 - m + r, 0), high = Math.min(first + r + 1, n - 3), part = c[r] / (high - low);
        c[r] = rising + (high - s) * part;
        rising = (s - low) * part;
      }
      c[m] = rising;
    }
    c.forEach((x, r) => { b[first + r] = x; });
    return b;
  }
  const wide = basis === 2 ? 4 : n, first = basis === 2 ? 3 * Math.min(Math.max(Math.floor(s), 0), n / 3 - 1 | 0) : 0, t = s - first / (basis === 2 ? 3 : 1);
  b[first] = 1;
  for (let m = 1; m < wide; m++) {
    let carried = 0;
    for (let i = 0; i < m; i++) { const old = b[first + i]; b[first + i] = carried + (1 - t) * old; carried = t * old; }
    b[first + m] = carried;
  }
  return b;
}
function weights_at(uvw) {
  const [x, y, z] = uvw.map((s, a) => along(s, body.counts[a], body.bases[a])), weights = [];
  for (let k = 0; k < NZ; k++) for (let j = 0; j < NY; j++) for (let i = 0; i < NX; i++) {
    const w = x[i] * y[j] * z[k];
    if (Math.abs(w) > 1e-9) weights.push([i + NX * (j + NY * k), w]);
  }
  return weights;
}
function place_of(weights) {
  let x = 0, y = 0, z = 0;
  for (const [p, w] of weights) { x += w * now.points[3 * p]; y += w * now.points[3 * p + 1]; z += w * now.points[3 * p + 2]; }
  return [x, y, z];
}
const world = at => at.map((x, a) => x + centre[a]);
// The pull at a place of the object: as stiff and as damped as stays stable with the mass that is felt there.
function pull(weights, target) {
  const mass = 1 / weights.reduce((sum, [p, w]) => sum + w * w / live.masses[p], 0), stiffness = Math.min(live.pull.stiffness, 0.15 * mass / (h * h));
  return { weights, target: world(target), stiffness, damping: Math.min(1.4 * Math.sqrt(stiffness * mass), 0.3 * mass / h), most: live.pull.most };
}

// ---- pointers --------------------------------------------------------------------------------------------------------
function ray({ clientX, clientY, pointerType }) {
  const { left, top, width, height } = canvas.getBoundingClientRect(), { eye, back, right, above } = camera_frame(), tall = Math.tan(FOV / 2);
  const x = clientX - left, y = clientY - top, sx = (2 * x / width - 1 - off_middle()) * tall * width / height, sy = (1 - 2 * y / height) * tall;
  return { x, y, reach: REACH[pointerType] || REACH.mouse, eye, back, way: unit(plus(plus(back.map(b => -b), sx, right), sy, above)) };
}
const in_picture = ({ eye, way, back }, at) => plus(eye, dot(plus(at, -1, eye), back) / dot(way, back), way);
// The place of a line that is nearest to a ray.
function on_line({ eye, way }, at, normal) {
  const between_them = plus(at, -1, eye), b = dot(normal, way);
  return plus(at, (b * dot(way, between_them) - dot(normal, between_them)) / Math.max(1 - b * b, 1e-3), normal);
}
function near_pointer(r, place) {
  const [x, y] = on_pane(camera_matrix(camera_frame()), place) || [Infinity, Infinity];
  return Math.hypot(x * canvas.clientWidth - r.x, y * canvas.clientHeight - r.y) < 11 + r.reach;
}
// A load by its place or by the tip of its arrow, a pin by one of its points.
function load_or_pin_near(r) {
  const load = live.open.loads.findIndex((_, n) => near_pointer(r, place_of_load(n)) || near_pointer(r, plus(place_of_load(n), 1, arrow_of_load(n))));
  if (load >= 0) return { load };
  for (const [part, { held }] of live.open.parts.entries()) if (held.some(p => near_pointer(r, now.points.subarray(3 * p, 3 * p + 3)))) return { part, at: in_picture(r, held_at(part)) };
  return null;
}
const held_at = part => now.parts[part].map((x, a) => x - centre[a]);
function grip_at(e) {
  const r = ray(e), near = load_or_pin_near(r);
  if (near) return near;
  const found = pick(r.x, r.y, r.reach);
  if (found?.uvw) { const weights = weights_at(found.uvw); return { weights, at: place_of(weights) }; }
  const part = found ? part_of(found.obstacle) : -1;
  const normal = found && body.planes.includes(found.obstacle) && !(e.altKey || state.sideways) ? found.obstacle.now.normal : null;
  return part < 0 ? null : { part, at: found.at, normal };
}
// Loads: arrows from the middle of their points; one twice as long is four times the force.
function place_of_load(n) {
  const { points: own } = live.open.loads[n], sum = [0, 0, 0];
  for (const p of own) for (let a = 0; a < 3; a++) sum[a] += now.points[3 * p + a] / own.length;
  return sum;
}
const longest_load = () => 2 * body.touch.longest;       // of the arrow of the largest load
function arrow_of_load(n) {
  const size = Math.hypot(...loads[n]);
  return loads[n].map(f => size > 0 ? f / size * longest_load() * Math.sqrt(size / live.pull.most) : 0);
}
function load_of_arrow(way) {
  const length = Math.hypot(...way), share = Math.min(length / longest_load(), 1);
  return way.map(x => length > 0 && share > 0.03 ? +(x / length * live.pull.most * share ** 2).toPrecision(4) : 0);
}
function turn_by(part, across, up, from) {
  const { right, above } = camera_frame();
  return { part, target: hand?.part === part ? hand.target : now.parts[part], turn: product(product(turn_of(above.map(x => x * across)), turn_of(right.map(x => x * up))), from) };
}
function can_turn(part) {
  const { turns, free, label } = live.open.parts[part];
  if (!turns) tell(`${label} ${free ? "is a free body: it is drawn, not turned" : "is a sphere, which looks the same however it is turned"}`);
  return !!turns;
}
Object.assign(source, {
  press(e, fingers) {
    if (grip || fingers > 1) return source.release(grip && { pointerId: grip.id });   // a second finger: the view is meant
    if (failed || !now.outputs || e.button !== 0 || e.shiftKey || !(grip = grip_at(e))) return;
    Object.assign(grip, { id: e.pointerId, start: grip.part === undefined ? null : held_at(grip.part) });
    if (grip.part !== undefined && (e.ctrlKey || e.metaKey || state.turning) && can_turn(grip.part)) grip.turn = [e.clientX, e.clientY, now.turns[grip.part]];
    canvas.style.cursor = "grabbing";
    if (!grip.weights) choose(holds.findIndex(({ part, load }) => part === grip.part && load === grip.load));
    if (!state.playing) tell("Paused: it moves while the simulation plays, or step by step");
    source.drag(e);
  },
  drag(e) {
    if (grip?.id !== e.pointerId) return false;
    const r = ray(e);
    if (grip.load !== undefined) return set_load(grip.load, load_of_arrow(plus(in_picture(r, place_of_load(grip.load)), -1, place_of_load(grip.load)))), true;
    if (grip.turn) { const [x, y, from] = grip.turn; hand = turn_by(grip.part, 0.008 * (e.clientX - x), 0.008 * (e.clientY - y), from); return show(), true; }
    const to = grip.normal ? on_line(r, grip.at, grip.normal) : in_picture(r, grip.at);
    hand = grip.weights ? pull(grip.weights, to) : { part: grip.part, target: world(plus(grip.start, 1, plus(to, -1, grip.at))) };
    show();
    return true;
  },
  release(e) {
    if (!grip || grip.id !== e?.pointerId) return;
    grip = hand = null;
    canvas.style.cursor = "";
    show();
  },
});

// ---- keys: what is chosen in the list of obstacles, pins and places goes where the arrows say -----------------------------
function nudge({ part, load, uvw }, key, far) {
  const { right, above } = camera_frame(), [dx, dy] = ARROWS[key], way = (far ? 0.1 : 0.02) * run.radius;
  if (load !== undefined) return set_load(load, plus(plus(loads[load], dx * live.pull.most * (far ? 0.1 : 0.02), right), -dy * live.pull.most * (far ? 0.1 : 0.02), above));
  if (part !== undefined && state.turning) {
    if (can_turn(part)) hand = turn_by(part, dx * (far ? 0.2 : 0.04), dy * (far ? 0.2 : 0.04), hand?.part === part && hand.turn || now.turns[part]);
    return show();
  }
  const plane = part !== undefined && body.planes.find(each => part_of(each) === part);
  const up = plane && !state.sideways ? (dot(plane.now.normal, above) < 0 ? plane.now.normal.map(x => -x) : plane.now.normal) : above;
  const from = part !== undefined ? (hand?.part === part ? hand.target.map((x, a) => x - centre[a]) : held_at(part))
    : hand?.weights ? hand.target.map((x, a) => x - centre[a]) : place_of(weights_at(uvw));
  const to = plus(plus(from, dx * way, plane && !state.sideways ? [0, 0, 0] : right), -dy * way, up);
  hand = part !== undefined ? { part, target: world(to), turn: hand?.part === part ? hand.turn : undefined } : pull(weights_at(uvw), to);
  show();
}
function let_go() { grip = hand = null; show(); }
