"use strict";
// ---- the run -------------------------------------------------------------------------------------------------
const element = id => document.getElementById(id);
const run = JSON.parse(element("run").textContent);
const decode = (text, Type) => new Type(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
const [NX, NY, NZ] = run.counts, POINTS = NX * NY * NZ;
const obstacles = [...run.planes, ...run.solids];
const COLOURS = ["paint", "displacement", "strain", ...run.cells.map(each => each.name)];
const state = { time: 0, playing: false, speed: 1, colour: run.cage ? "displacement" : "paint", lattice: !!run.cage, obstacles: true, contacts: true, follow: false };

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
// So far away that the box of all that the lattice ever covers is in the picture.
function fitting_distance() {
  const { back, right, above } = camera_frame(), tall = 0.82 * Math.tan(FOV / 2), wide = tall * canvas.clientWidth / canvas.clientHeight;
  let distance = 0.5 * run.radius;
  for (let corner = 0; corner < 8; corner++) {
    const c = run.half.map((h, a) => corner >> a & 1 ? h : -h);
    distance = Math.max(distance, dot(c, back) + Math.abs(dot(c, right)) / wide, dot(c, back) + Math.abs(dot(c, above)) / tall);
  }
  return distance;
}
function camera_frame() {
  const c = Math.cos(camera.pitch), s = Math.sin(camera.pitch);
  const back = [0, 1, 2].map(a => c * (Math.cos(camera.yaw) * EAST[a] + Math.sin(camera.yaw) * NORTH[a]) + s * UP[a]);
  const right = unit(cross(UP, back)), above = cross(back, right);
  const target = state.follow ? plus(camera.shift, 1, middle_of_object()) : camera.shift;
  return { back, right, above, eye: plus(target, camera.distance, back) };
}
function camera_matrix({ back, right, above, eye }) {
  const f = 1 / Math.tan(FOV / 2), aspect = canvas.width / canvas.height;
  const near = Math.max(camera.distance - 6 * run.radius, camera.distance * 0.02), far = camera.distance + 12 * run.radius;
  const a = (near + far) / (near - far), b = 2 * near * far / (near - far), m = [];
  for (let i = 0; i < 3; i++) m.push(f / aspect * right[i], f * above[i], a * back[i], -back[i]);
  m.push(-f / aspect * dot(right, eye), -f * dot(above, eye), -a * dot(back, eye) + b, dot(back, eye));
  return new Float32Array(m);
}
function middle_of_object() {
  const sum = [0, 0, 0];
  for (let p = 0; p < POINTS; p++) for (let a = 0; a < 3; a++) sum[a] += texels[4 * p + a] / POINTS;
  return sum;
}

// ---- WebGL -------------------------------------------------------------------------------------------------------
const canvas = element("canvas");
const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, powerPreference: "high-performance" });
const WIDTHS = run.counts.map((n, a) => run.bases[a] ? 4 : n);
const HEADING = "#version 300 es\n" + ["X", "Y", "Z"].map((axis, a) =>
  `#define N${axis} ${run.counts[a]}\n#define W${axis} ${WIDTHS[a]}\n#define B${axis} ${run.bases[a]}\n`).join("") +
  `#define MOST ${Math.max(4, ...WIDTHS)}\n`;
const SHADOW = 256, texels = new Float32Array(4 * POINTS);
const SOURCES = Object.fromEntries(element("shaders").textContent.split(/^\/{4} /m).slice(1).map(text => {
  const end = text.indexOf("\n");
  return [text.slice(0, end), text.slice(end)];
}));
let object, lines, balls, points, ramp, cells, plain, skins, heights, planes, solids;

function shader(type, source) {
  const made = gl.createShader(type);
  gl.shaderSource(made, source);
  gl.compileShader(made);
  if (!gl.getShaderParameter(made, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(made));
  return made;
}
function program(vertex, fragment) {
  const made = gl.createProgram();
  gl.attachShader(made, shader(gl.VERTEX_SHADER, HEADING + SOURCES.volume + SOURCES[vertex]));
  gl.attachShader(made, shader(gl.FRAGMENT_SHADER, "#version 300 es" + SOURCES[fragment]));
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(made));
  const places = {}, count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS) || 0;
  for (let i = 0; i < count; i++) { const { name, type } = gl.getActiveUniform(made, i); places[name] = [gl.getUniformLocation(made, name), type]; }
  return { made, places };
}
function use({ made, places }, values) {
  gl.useProgram(made);
  for (const [name, value] of Object.entries(values)) {
    if (!places[name]) continue;
    const [place, type] = places[name];
    if (type === gl.FLOAT) gl.uniform1f(place, value);
    else if (type === gl.FLOAT_VEC2) gl.uniform2fv(place, value);
    else if (type === gl.FLOAT_VEC3) gl.uniform3fv(place, value);
    else if (type === gl.FLOAT_VEC4) gl.uniform4fv(place, value);
    else if (type === gl.FLOAT_MAT4) gl.uniformMatrix4fv(place, false, value);
    else gl.uniform1i(place, value);
  }
}
function vertices(attributes, triangles) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  attributes.forEach(({ data, width, type, stride = 0, normalised = false, integer = false, each = 0 }, place) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(place);
    if (integer) gl.vertexAttribIPointer(place, width, type, stride, 0);
    else gl.vertexAttribPointer(place, width, type, normalised, stride, 0);
    gl.vertexAttribDivisor(place, each);
  });
  if (triangles) { gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer()); gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW); }
  gl.bindVertexArray(null);
  return array;
}
function texture(format, width, height, from, type, data, filter) {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, from, type, data);
  for (const [key, value] of [[gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) gl.texParameteri(gl.TEXTURE_2D, key, value);
  return made;
}
function drawing_surface() {
  const image = texture(gl.R8, SHADOW, SHADOW, gl.RED, gl.UNSIGNED_BYTE, null, gl.LINEAR), frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, image, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { image, frame };
}
function lattice_edges() {
  const ends = [], at = (i, j, k) => i + NX * (j + NY * k);
  for (let k = 0; k < NZ; k++) for (let j = 0; j < NY; j++) for (let i = 0; i < NX; i++) {
    if (i + 1 < NX) ends.push(at(i, j, k), at(i + 1, j, k));
    if (j + 1 < NY) ends.push(at(i, j, k), at(i, j + 1, k));
    if (k + 1 < NZ) ends.push(at(i, j, k), at(i, j, k + 1));
  }
  return new Int32Array(ends);
}
function build() {
  const triangles = decode(run.triangles, Uint32Array), edges = lattice_edges(), pinned = new Float32Array(POINTS);
  for (const p of run.pinned) pinned[p] = 1;
  object = { program: program("object-vertex", "object-fragment"), shadow: program("height-vertex", "height-fragment"), count: triangles.length,
    array: vertices([{ data: decode(run.coordinates, Float32Array), width: 3, type: gl.FLOAT },
      { data: decode(run.normals, Int16Array), width: 3, type: gl.SHORT, stride: 8, normalised: true },
      { data: decode(run.uv, Float32Array), width: 2, type: gl.FLOAT },
      { data: decode(run.tints, Uint8Array), width: 3, type: gl.UNSIGNED_BYTE, stride: 4, normalised: true }], triangles) };
  lines = { program: program("line-vertex", "line-fragment"), count: edges.length / 2,
    array: vertices([{ data: edges, width: 2, type: gl.INT, integer: true, each: 1 }]) };
  balls = { program: program("ball-vertex", "ball-fragment"), array: vertices([{ data: pinned, width: 1, type: gl.FLOAT }]) };
  points = texture(gl.RGBA32F, NX * NY, NZ, gl.RGBA, gl.FLOAT, null, gl.NEAREST);
  cells = gl.createTexture();
  ramp = texture(gl.RGB8, run.ramp.length / 3, 1, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(run.ramp), gl.LINEAR);
  plain = blank();
  skins = run.pictures.map(load_skin);
  heights = drawing_surface();
  planes = { program: program("plane-vertex", "plane-fragment"), occlusion: program("cover-vertex", "occlusion-fragment"),
    array: gl.createVertexArray(), surfaces: run.planes.map(drawing_surface) };
  solids = { program: program("solid-vertex", "object-fragment"), shadow: program("solid-height-vertex", "height-fragment"), forms: run.solids.map(build_form) };
  build_touch();
}
function build_form(solid) {
  const triangles = decode(solid.triangles, Uint32Array);
  return { count: triangles.length, array: vertices([solid.vertices, solid.normals].map(text =>
    ({ data: decode(text, Float32Array), width: 3, type: gl.FLOAT })), triangles) };
}

// A palette's few texels must not mix, so only pictures get smaller copies of themselves for the distance.
function load_skin(source) {
  const skin = blank(), image = new Image();
  image.onload = () => {
    gl.bindTexture(gl.TEXTURE_2D, skin);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, true);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB8, gl.RGB, gl.UNSIGNED_BYTE, image);
    gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.REPEAT);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.REPEAT);
    if (Math.min(image.width, image.height) > 64) {
      gl.generateMipmap(gl.TEXTURE_2D);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
    }
    show();
  };
  image.src = source;
  return skin;
}
function blank() { return texture(gl.RGB8, 1, 1, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array([255, 255, 255]), gl.LINEAR); }

// ---- drawing -----------------------------------------------------------------------------------------------------
let shown = null, waiting = 0;                           // the time whose control points and shadows the GPU holds; the frame asked for

function show() { waiting ||= requestAnimationFrame(draw); }
function draw(clock) {
  cancelAnimationFrame(waiting);                          // where a change of size draws before it
  waiting = 0;
  if (gl.isContextLost()) return;
  advance(clock);
  draw_view();
  if (film) copy_view(film.target);
  if (state.playing) show();
}
function draw_view() {
  fit_canvas();
  if (shown !== state.time) { load_points(); cast_shadows(); shown = state.time; write_readout(); }
  const frame = camera_frame();
  const common = { camera: camera_matrix(frame), eye: frame.eye, up: UP, points: 0, viewport: [canvas.width, canvas.height],
    key: unit([0, 1, 2].map(a => -0.45 * frame.right[a] + 0.75 * UP[a] + 0.55 * frame.back[a])) };
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, canvas.width, canvas.height);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  draw_object(common);
  if (state.obstacles) draw_solids(common);
  gl.enable(gl.BLEND);
  gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.depthMask(false);
  if (state.obstacles) draw_planes(common);
  draw_lattice(common);
  if (state.contacts) draw_touch(common);
  gl.depthMask(true);
  gl.disable(gl.BLEND);
}
function fit_canvas() {
  const scale = Math.min(window.devicePixelRatio || 1, 2), w = Math.round(canvas.clientWidth * scale), h = Math.round(canvas.clientHeight * scale);
  if (canvas.width === w && canvas.height === h) return;
  canvas.width = w;
  canvas.height = h;
  if (camera.home) camera.distance = fitting_distance();   // not once somebody has zoomed or moved
}
function load_points() {
  const now = source.points();
  for (let p = 0; p < POINTS; p++) texels.set(now.subarray(3 * p, 3 * p + 3), 4 * p);
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, points);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, NX * NY, NZ, gl.RGBA, gl.FLOAT, texels);
  for (const each of obstacles) place_obstacle(each);
  for (const plane of run.planes) spread_plane(plane);
}
function place_obstacle(each) {
  const pose = source.pose(each), normal = unit(pose.subarray(3, 6)), raw = pose.subarray(6, 9);
  each.now = { anchor: [...pose.subarray(0, 3)], normal, tangent: unit(plus(raw, -dot(raw, normal), normal)) };
}
// The patch drawn of a plane lies under the scene's centre; its grid is anchored to the obstacle's own point. A floor fades
// out; any other plane is a plate with an edge, large enough for the scene, whose part below the floors is not drawn.
function spread_plane(plane) {
  const { anchor, normal, tangent } = plane.now;
  const sides = [tangent, cross(normal, tangent)].map(side => dot(side.map(Math.abs), run.half) + 0.2 * run.radius);
  const reach = plane.floor ? 1.9 * run.radius : Math.max(...sides);
  const extent = plane.floor ? [1, 1] : sides.map(side => side / reach);
  Object.assign(plane.now, { centre: plus([0, 0, 0], dot(anchor, normal), normal), reach, extent, plate: plane.floor ? 0 : 1 });
}
const floors = () => run.planes.filter(plane => plane.floor).slice(0, 4).map(({ now }) => [...now.normal, dot(now.anchor, now.normal)]);
function cast_shadows() {
  gl.viewport(0, 0, SHADOW, SHADOW);
  gl.disable(gl.DEPTH_TEST);
  run.planes.slice(0, 6).forEach((plane, i) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, heights.frame);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.MIN);
    use(object.shadow, { ...plane.now, points: 0 });
    gl.bindVertexArray(object.array);
    gl.drawElements(gl.TRIANGLES, object.count, gl.UNSIGNED_INT, 0);
    solids.forms.forEach(({ count, array }, n) => {
      const { anchor, normal, tangent } = run.solids[n].now;
      use(solids.shadow, { ...plane.now, anchor, pole: normal, first: tangent });
      gl.bindVertexArray(array);
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
    });
    gl.blendEquation(gl.FUNC_ADD);
    gl.disable(gl.BLEND);
    gl.bindFramebuffer(gl.FRAMEBUFFER, planes.surfaces[i].frame);
    bind(1, heights.image);
    use(planes.occlusion, { heights: 1 });
    gl.bindVertexArray(planes.array);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  });
  gl.clearColor(0, 0, 0, 0);
}
function bind(unit_number, image) {
  gl.activeTexture(gl.TEXTURE0 + unit_number);
  gl.bindTexture(gl.TEXTURE_2D, image);
}
// A texel for each cell: share of the scale, whether it is turned inside out; linear between the centres of cells.
function load_cells() {
  const shown = run.cells.find(each => each.name === state.colour), size = [NX - 1, NY - 1, NZ - 1];
  gl.activeTexture(gl.TEXTURE3);
  gl.bindTexture(gl.TEXTURE_3D, cells);
  if (!shown) return;
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.RG8, ...size, 0, gl.RG, gl.UNSIGNED_BYTE, source.cells(shown));
  for (const end of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, end, gl.CLAMP_TO_EDGE);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, filter, gl.LINEAR);
}
function draw_object(common) {
  const colouring = Math.min(COLOURS.indexOf(state.colour), 3);
  load_cells();
  bind(0, points);
  bind(1, ramp);
  use(object.program, { ...common, origin: run.origin, size: run.size, ramp: 1, skin: 2, cells: 3, cage: run.cage,
    colouring, largest: run.largest[state.colour] || 1 });
  gl.bindVertexArray(object.array);
  let first = 0;
  for (const [picture, count] of run.parts) {
    bind(2, picture < 0 ? plain : skins[picture]);
    gl.drawElements(gl.TRIANGLES, 3 * count, gl.UNSIGNED_INT, 12 * first);
    first += count;
  }
}
function draw_solids(common) {
  bind(2, plain);
  solids.forms.forEach(({ count, array }, i) => {
    use(solids.program, { ...common, ...run.solids[i].now, tint: run.solids[i].tint, ramp: 1, skin: 2, cells: 3, cage: 0, colouring: 0, largest: 1 });
    gl.bindVertexArray(array);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 0);
  });
}
function draw_planes(common) {
  const order = run.planes.map((plane, i) => [Math.hypot(...plus(plane.now.centre, -1, common.eye)), plane, i]).sort((a, b) => b[0] - a[0]);
  const below = [...floors(), ...Array(4).fill([0, 0, 0, -1])].slice(0, 4).flat();
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 2);
  gl.bindVertexArray(planes.array);
  for (const [, plane, i] of order) {
    bind(1, planes.surfaces[i].image);
    use(planes.program, { ...common, ...plane.now, tint: plane.tint, spacing: run.spacing, shadow: 1, "floors[0]": below });
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
  gl.disable(gl.POLYGON_OFFSET_FILL);
}
// Twice: what the surface hides shows through it faintly. Without the lattice only the points that pins hold.
function draw_lattice(common) {
  const ratio = canvas.width / canvas.clientWidth, dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const ink = dark ? [0.93, 0.95, 0.98] : [0.10, 0.13, 0.18];
  const diameter = 0.028 * run.radius * canvas.height / Math.tan(FOV / 2) * Math.min(1, 4 / Math.max(NX, NY, NZ)) ** 1.4;
  for (const [depth, line, ball] of [[gl.GREATER, 0.14, 0.15], [gl.LEQUAL, 0.75, 1]]) {
    gl.depthFunc(depth);
    if (state.lattice) {
      use(lines.program, { ...common, width: 0.7 * ratio, ink: [...ink, line] });
      gl.bindVertexArray(lines.array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, lines.count);
    }
    use(balls.program, { ...common, diameter, least: 4 * ratio, most: 18 * ratio, opacity: ball, alone: state.lattice ? 0 : 1,
      free_colour: run.free, pinned_colour: dark ? [0.85, 0.88, 0.92] : run.fixed });
    gl.bindVertexArray(balls.array);
    gl.drawArrays(gl.POINTS, 0, POINTS);
  }
  gl.depthFunc(gl.LEQUAL);
}
