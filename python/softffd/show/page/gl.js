"use strict";
// ---- the run: bodies, each with its lattice, its surface and its obstacles, in one picture or in several ----------------
const element = id => document.getElementById(id);
const run = JSON.parse(element("run").textContent), { bodies } = run;
const PANES = bodies.reduce((panes, body) => { (panes[body.pane] ||= []).push(body); return panes; }, []);
for (const body of bodies) Object.assign(body, { obstacles: [...body.planes, ...body.solids], points: body.counts.reduce((a, b) => a * b) });
const COLOURS = ["paint", "displacement", "strain", ...run.cells.map(each => each.name)], CAGES = bodies.every(body => body.cage);
const state = { time: 0, playing: false, speed: 1, colour: CAGES ? "displacement" : "paint", lattice: CAGES, obstacles: true, contacts: true, follow: false };

// ---- WebGL -------------------------------------------------------------------------------------------------------
const canvas = element("canvas");
const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, powerPreference: "high-performance" });
const SHADOW = 256;
function heading({ counts, bases }) {
  const widths = counts.map((n, a) => bases[a] ? 4 : n);
  return "#version 300 es\n" + ["X", "Y", "Z"].map((axis, a) => `#define N${axis} ${counts[a]}\n#define W${axis} ${widths[a]}\n#define B${axis} ${bases[a]}\n`).join("") +
    `#define MOST ${Math.max(4, ...widths)}\n`;
}
for (const body of bodies) Object.assign(body, { heading: heading(body), texels: new Float32Array(4 * body.points) });
const SOURCES = Object.fromEntries(element("shaders").textContent.split(/^\/{4} /m).slice(1).map(text => {
  const end = text.indexOf("\n");
  return [text.slice(0, end), text.slice(end)];
}));
let ramp, plain, heights, planes, solids;

function shader(type, source) {
  const made = gl.createShader(type);
  gl.shaderSource(made, source);
  gl.compileShader(made);
  if (!gl.getShaderParameter(made, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(made));
  return made;
}
function program(vertex, fragment, body = bodies[0]) {
  const made = gl.createProgram();
  gl.attachShader(made, shader(gl.VERTEX_SHADER, body.heading + SOURCES.volume + SOURCES[vertex]));
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
function lattice_edges([NX, NY, NZ]) {
  const ends = [], at = (i, j, k) => i + NX * (j + NY * k);
  for (let k = 0; k < NZ; k++) for (let j = 0; j < NY; j++) for (let i = 0; i < NX; i++) {
    if (i + 1 < NX) ends.push(at(i, j, k), at(i + 1, j, k));
    if (j + 1 < NY) ends.push(at(i, j, k), at(i, j + 1, k));
    if (k + 1 < NZ) ends.push(at(i, j, k), at(i, j, k + 1));
  }
  return new Int32Array(ends);
}
function build() {
  ramp = texture(gl.RGB8, run.ramp.length / 3, 1, gl.RGB, gl.UNSIGNED_BYTE, new Uint8Array(run.ramp), gl.LINEAR);
  plain = blank();
  heights = drawing_surface();
  planes = { program: program("plane-vertex", "plane-fragment"), occlusion: program("cover-vertex", "occlusion-fragment"), array: gl.createVertexArray() };
  solids = { program: program("solid-vertex", "object-fragment"), shadow: program("solid-height-vertex", "height-fragment") };
  bodies.forEach(build_body);
  build_touch();
}
function build_body(body) {
  const { coordinates, normals, uv, tints, atlas, triangles } = body.surface, edges = lattice_edges(body.counts), pinned = new Float32Array(body.points);
  for (const p of body.pinned) pinned[p] = 1;
  body.object = { program: program("object-vertex", "object-fragment", body), shadow: program("height-vertex", "height-fragment", body), count: triangles.length,
    array: vertices([{ data: coordinates, width: 3, type: gl.FLOAT },
      { data: normals, width: 3, type: gl.SHORT, stride: 8, normalised: true },
      { data: uv, width: 2, type: gl.FLOAT },
      { data: tints, width: 3, type: gl.UNSIGNED_BYTE, stride: 4, normalised: true },
      ...(atlas ? [{ data: atlas, width: 4, type: gl.FLOAT }] : [])], triangles) };
  body.lines = { program: program("line-vertex", "line-fragment", body), count: edges.length / 2,
    array: vertices([{ data: edges, width: 2, type: gl.INT, integer: true, each: 1 }]) };
  body.balls = { program: program("ball-vertex", "ball-fragment", body), array: vertices([{ data: pinned, width: 1, type: gl.FLOAT }]) };
  body.lattice = texture(gl.RGBA32F, body.counts[0] * body.counts[1], body.counts[2], gl.RGBA, gl.FLOAT, null, gl.NEAREST);
  body.cell_shares = gl.createTexture();
  body.skins = body.pictures.map(load_skin);
  for (const plane of body.planes) plane.shadow = drawing_surface();
  for (const solid of body.solids) solid.form = build_form(solid);
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
