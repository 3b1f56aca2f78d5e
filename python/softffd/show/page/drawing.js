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
  if (shown !== state.time) { bodies.forEach(load_points); PANES.forEach(cast_shadows); shown = state.time; write_readout(); }
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  PANES.forEach(draw_pane);
}
function draw_pane(pane, n) {
  const frame = camera_frame(pane), box = pane_box(n);
  const common = { camera: camera_matrix(frame), eye: frame.eye, up: UP, points: 0, viewport: box.slice(2),
    key: unit([0, 1, 2].map(a => -0.45 * frame.right[a] + 0.75 * UP[a] + 0.55 * frame.back[a])) };
  gl.viewport(...box);
  gl.scissor(...box);
  gl.enable(gl.SCISSOR_TEST);                              // marks reach beyond their places
  gl.enable(gl.DEPTH_TEST);
  for (const body of pane) draw_object(common, body);
  if (state.obstacles) for (const body of pane) draw_solids(common, body);
  gl.enable(gl.BLEND);
  gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  gl.depthMask(false);
  if (state.obstacles) draw_planes(common, pane);
  for (const body of pane) draw_lattice(common, body);
  if (state.contacts) for (const body of pane) draw_touch(common, body);
  gl.depthMask(true);
  gl.disable(gl.BLEND);
  gl.disable(gl.SCISSOR_TEST);
  name_obstacles(common, pane, n);
}
function fit_canvas() {
  const scale = Math.min(window.devicePixelRatio || 1, 2), w = Math.round(canvas.clientWidth * scale), h = Math.round(canvas.clientHeight * scale);
  if (canvas.width === w && canvas.height === h) return;
  canvas.width = w;
  canvas.height = h;
  refit();
}
function refit() {
  if (camera.home) camera.distance = fitting_distance();   // not once somebody has zoomed or moved
  show();
}
function load_points(body) {
  const now = source.points(body), { texels, points, counts: [NX, NY, NZ] } = body;
  for (let p = 0; p < points; p++) texels.set(now.subarray(3 * p, 3 * p + 3), 4 * p);
  bind(0, body.lattice);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, NX * NY, NZ, gl.RGBA, gl.FLOAT, texels);
  for (const each of body.obstacles) place_obstacle(each, body);
  for (const plane of body.planes) spread_plane(plane);
}
function place_obstacle(each, body) {
  const pose = source.pose(each, body), normal = unit(pose.subarray(3, 6)), raw = pose.subarray(6, 9);
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
const planes_of = pane => pane.flatMap(body => body.planes);
const floors = pane => planes_of(pane).filter(plane => plane.floor).slice(0, 4).map(({ now }) => [...now.normal, dot(now.anchor, now.normal)]);
function cast_shadows(pane) {
  gl.viewport(0, 0, SHADOW, SHADOW);
  gl.disable(gl.DEPTH_TEST);
  for (const plane of planes_of(pane).slice(0, 6)) {
    gl.bindFramebuffer(gl.FRAMEBUFFER, heights.frame);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendEquation(gl.MIN);
    for (const body of pane) cast_shadow(body, plane);
    gl.blendEquation(gl.FUNC_ADD);
    gl.disable(gl.BLEND);
    gl.bindFramebuffer(gl.FRAMEBUFFER, plane.shadow.frame);
    bind(1, heights.image);
    use(planes.occlusion, { heights: 1 });
    gl.bindVertexArray(planes.array);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
  gl.clearColor(0, 0, 0, 0);
}
// The heights of a body and of its solids above a plane.
function cast_shadow({ object, lattice, solids: forms }, plane) {
  bind(0, lattice);
  use(object.shadow, { ...plane.now, points: 0 });
  gl.bindVertexArray(object.array);
  gl.drawElements(gl.TRIANGLES, object.count, gl.UNSIGNED_INT, 0);
  for (const { form, now: { anchor, normal, tangent } } of forms) {
    use(solids.shadow, { ...plane.now, anchor, pole: normal, first: tangent });
    gl.bindVertexArray(form.array);
    gl.drawElements(gl.TRIANGLES, form.count, gl.UNSIGNED_INT, 0);
  }
}
function bind(unit_number, image) {
  gl.activeTexture(gl.TEXTURE0 + unit_number);
  gl.bindTexture(gl.TEXTURE_2D, image);
}
// A texel for each cell or taxel: share of the scale, whether a cell is turned inside out; linear between the centres.
function load_cells(body) {
  const shown = run.cells.findIndex(each => each.name === state.colour), size = body.sizes?.[shown] || body.counts.map(n => n - 1);
  gl.activeTexture(gl.TEXTURE3);
  gl.bindTexture(gl.TEXTURE_3D, body.cell_shares);
  if (shown < 0) return;
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage3D(gl.TEXTURE_3D, 0, gl.RG8, ...size, 0, gl.RG, gl.UNSIGNED_BYTE, source.cells(shown, body));
  for (const end of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, end, gl.CLAMP_TO_EDGE);
  for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, filter, gl.LINEAR);
}
function draw_object(common, body) {
  const { object, origin, size, cage, skins } = body, colouring = state.colour === "contact_pressure" ? 4 : Math.min(COLOURS.indexOf(state.colour), 3);
  load_cells(body);
  bind(0, body.lattice);
  bind(1, ramp);
  use(object.program, { ...common, origin, size, ramp: 1, skin: 2, cells: 3, cage, colouring, largest: run.largest[state.colour] || 1, hollow: 0 });
  gl.bindVertexArray(object.array);
  let first = 0;
  for (const [picture, count] of body.surface.parts) {
    bind(2, picture < 0 ? plain : skins[picture]);
    gl.drawElements(gl.TRIANGLES, 3 * count, gl.UNSIGNED_INT, 12 * first);
    first += count;
  }
}
function draw_solids(common, body) {
  bind(2, plain);
  for (const { form, now, tint } of body.solids) {
    use(solids.program, { ...common, ...now, tint, ramp: 1, skin: 2, cells: 3, cage: 0, colouring: 0, largest: 1, hollow: 1 });
    gl.bindVertexArray(form.array);
    gl.drawElements(gl.TRIANGLES, form.count, gl.UNSIGNED_INT, 0);
  }
}
function draw_planes(common, pane) {
  const order = planes_of(pane).map(plane => [Math.hypot(...plus(plane.now.centre, -1, common.eye)), plane]).sort((a, b) => b[0] - a[0]);
  const below = [...floors(pane), ...Array(4).fill([0, 0, 0, -1])].slice(0, 4).flat();
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 2);
  gl.bindVertexArray(planes.array);
  for (const [, plane] of order) {
    bind(1, plane.shadow.image);
    use(planes.program, { ...common, ...plane.now, tint: plane.tint, spacing: run.spacing, shadow: 1, "floors[0]": below });
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
  gl.disable(gl.POLYGON_OFFSET_FILL);
}
// Twice: what the surface hides shows through it faintly. Without the lattice only the points that pins hold.
function draw_lattice(common, { counts, points, lattice, lines, balls }) {
  const ratio = canvas.width / canvas.clientWidth, dark = matchMedia("(prefers-color-scheme: dark)").matches;
  const ink = dark ? [0.93, 0.95, 0.98] : [0.10, 0.13, 0.18];
  const diameter = 0.028 * run.radius * common.viewport[1] / Math.tan(FOV / 2) * Math.min(1, 4 / Math.max(...counts)) ** 1.4;
  bind(0, lattice);
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
    gl.drawArrays(gl.POINTS, 0, points);
  }
  gl.depthFunc(gl.LEQUAL);
}
