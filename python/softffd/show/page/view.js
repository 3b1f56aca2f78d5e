// ---- time --------------------------------------------------------------------------------------------------------
let last_clock = null;

function advance(clock) {
  const passed = last_clock === null ? 0 : Math.min(Math.max((clock - last_clock) / 1000, 0), 0.1);  // a frame's clock may be behind
  last_clock = state.playing ? clock : null;
  if (state.playing) source.advance(passed);
}
function step_frames(count) {
  set_playing(false);
  source.step(count);
}
function set_playing(playing) {
  state.playing = playing && source.moves;
  last_clock = null;
  source.switched?.();
  element("play").setAttribute("aria-label", state.playing ? "Pause" : "Play");
  element("play").querySelector("path").setAttribute("d", state.playing ? "M3 2h4v12H3zM9 2h4v12H9z" : "M4 1.6l10 6.4-10 6.4z");
  show();
}

// ---- words and numbers -------------------------------------------------------------------------------------------
const NUMBERS = new Intl.NumberFormat("en", { maximumSignificantDigits: 4 });
function quantity(value, unit_name) {
  if (!unit_name) return NUMBERS.format(value);
  const prefixes = [["G", 1e9], ["M", 1e6], ["k", 1e3], ["", 1], ["m", 1e-3], ["µ", 1e-6]], size = Math.abs(value);
  const [prefix, factor] = prefixes.find(([, f]) => size >= f * 0.99995) || (size > 1e-9 ? prefixes[5] : ["", 1]);
  const scaled = value / factor;
  return `${(Math.abs(scaled) < 1e-9 ? 0 : scaled).toPrecision(4).replace(/^0\.000$/, "0")} ${prefix}${unit_name}`;
}
// Three significant digits of the largest component for all.
function rounded(vector) {
  const largest = Math.max(...vector.map(Math.abs)), digits = largest > 0 ? 2 - Math.floor(Math.log10(largest)) : 0;
  return Array.from(vector, v => NUMBERS.format(+(Math.round(v * 10 ** digits) / 10 ** digits || 0).toPrecision(4)));
}
const seconds = t => `${t.toFixed(source.decimals)} s`;

function make_rows() {
  for (const row of run.rows) {
    const box = document.createElement("div");
    box.className = "row";
    box.style.setProperty("--mark", row.mark);
    box.innerHTML = `<div><span class="label"></span><span class="value"></span></div><div class="vector"></div>
      <svg viewBox="0 0 100 26" preserveAspectRatio="none" aria-hidden="true"><path/><line y1="0" y2="26"/></svg>`;
    box.querySelector(".label").append(name_of(bodies[row.body], row.label), Object.assign(document.createElement("span"), { textContent: ` ${row.kind}` }));
    const [value, vector, curve, path, cursor] = [".value", ".vector", "svg", "path", "line"].map(part => box.querySelector(part));
    row.parts = { value, vector, curve, path, cursor };
    if (row.taxels) add_map(row, box);
    element("readout").append(box);
  }
}
// The taxels of a sensor at the time shown, in the colours of the surface.
function add_map(row, box) {
  const [width, height] = row.taxels.counts, map = Object.assign(document.createElement("canvas"), { className: "taxels", width, height });
  map.setAttribute("role", "img");
  map.setAttribute("aria-label", `Contact pressure on the ${width} × ${height} taxels of ${row.label}`);
  map.title = `${width} × ${height} taxels, ${row.taxels.words}; colours end at ${quantity(row.taxels.most, row.unit)}`;
  map.style.setProperty("--aspect", row.taxels.aspect);
  box.insertBefore(map, row.parts.curve);
  row.parts.vector.textContent = row.taxels.words;
  row.parts.map = map.getContext("2d");
}
function draw_map(row) {
  const [width, height] = row.taxels.counts, image = new ImageData(width, height), last = run.ramp.length / 3 - 1;
  source.taxels(row).forEach((share, n) => {
    const at = 3 * Math.round(share / 255 * last), pixel = n % width + width * (height - 1 - Math.floor(n / width));
    image.data.set([...run.ramp.slice(at, at + 3), 255], 4 * pixel);
  });
  row.parts.map.putImageData(image, 0, 0);
}
function write_readout() {
  element("now").textContent = seconds(state.time);
  element("frame").textContent = source.told();
  for (const row of run.rows) {
    const [size, vector] = source.values(row);
    row.parts.value.textContent = quantity(size, row.unit);
    if (vector) row.parts.vector.textContent = `(${rounded(vector).join(", ")}) ${row.unit}`;
    if (row.taxels) draw_map(row);
  }
  source.follow();
}
function set_colour(colour) {
  state.colour = element("colour").value = colour;
  element("scale").hidden = colour === "paint";
  const inner = run.cells.find(each => each.name === colour), number = v => quantity(+v.toPrecision(3), inner.unit);
  element("quantity").textContent = inner ? inner.words : colour === "strain" ? "strain (size of the Green strain tensor)" : "displacement from rest";
  element("smallest").textContent = inner ? number(inner.ends[0]) : "0";
  element("largest").textContent = inner ? number(inner.ends[1])
    : colour === "strain" ? NUMBERS.format(+run.largest.strain.toPrecision(3)) : quantity(run.largest.displacement || 0, "m");
  show();
}
function toggle(name) {
  state[name] = !state[name];
  element(name).setAttribute("aria-pressed", state[name]);
  if (name === "follow") { camera.shift = [0, 0, 0]; camera.home = false; }
  show();
}
const SPEEDS = [1000, 500, 200, 100, 50, 20, 10, 5, 2].map(n => 1 / n).concat([1, 2, 5, 10, 20, 50, 100]);
function offer_speeds() {
  for (const s of SPEEDS) element("speed").add(new Option(s < 1 ? `1/${Math.round(1 / s)}` : `${s} ×`, s));
  const wanted = source.pace;                              // a run of a few seconds plays as it is, others last about five
  set_speed(wanted >= 0.25 && wanted <= 4 ? 1 : SPEEDS.reduce((best, s) => Math.abs(Math.log(s / wanted)) < Math.abs(Math.log(best / wanted)) ? s : best));
}
function set_speed(speed) {
  state.speed = speed;
  element("speed").value = speed;
}
const change_speed = by => set_speed(SPEEDS[Math.min(Math.max(SPEEDS.indexOf(state.speed) + by, 0), SPEEDS.length - 1)]);

// ---- hands -------------------------------------------------------------------------------------------------------
function turn(dx, dy) {
  camera.yaw -= dx;
  camera.pitch = Math.min(Math.max(camera.pitch + dy, -1.5), 1.5);
  show();
}
function zoom(factor) {
  camera.distance = Math.min(Math.max(camera.distance * factor, 0.15 * run.radius), 30 * run.radius);
  camera.home = false;
  show();
}
function move(dx, dy) {
  const { right, above } = camera_frame(), scale = 2 * camera.distance * Math.tan(FOV / 2) / pane_size()[1];
  camera.shift = plus(plus(camera.shift, -dx * scale, right), dy * scale, above);
  camera.home = false;
  show();
}
function listen_to_pointers() {
  const down = new Map();
  const spread = () => { const [a, b] = [...down.values()]; return Math.hypot(a.x - b.x, a.y - b.y) || 1; };
  canvas.addEventListener("pointerdown", e => { canvas.setPointerCapture(e.pointerId); down.set(e.pointerId, { x: e.clientX, y: e.clientY }); source.press?.(e, down.size); });
  canvas.addEventListener("pointermove", e => {
    const at = down.get(e.pointerId);
    if (!at) return;
    const dx = e.clientX - at.x, dy = e.clientY - at.y, before = down.size > 1 ? spread() : 0;
    Object.assign(at, { x: e.clientX, y: e.clientY });
    if (down.size > 1) { zoom(before / spread()); move(dx / 2, dy / 2); }
    else if (source.drag?.(e)) return;
    else if (e.buttons & 6 || e.shiftKey) move(dx, dy);
    else turn(dx * 0.008, dy * 0.008);
  });
  for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, e => { down.delete(e.pointerId); source.release?.(e); });
  canvas.addEventListener("wheel", e => { e.preventDefault(); zoom(Math.exp(Math.max(Math.min(e.deltaY, 120), -120) * 0.0016)); }, { passive: false });
  canvas.addEventListener("contextmenu", e => e.preventDefault());
  canvas.addEventListener("dblclick", reset_view);
}
const next_colour = () => set_colour(COLOURS[(COLOURS.indexOf(state.colour) + 1) % COLOURS.length]);
function listen() {
  element("play").onclick = () => set_playing(!state.playing);
  element("speed").onchange = e => set_speed(+e.target.value);
  element("colour").onchange = e => set_colour(e.target.value);
  for (const name of ["lattice", "obstacles", "contacts", "follow"]) element(name).onclick = () => toggle(name);
  element("reset").onclick = reset_view;
  element("picture").onclick = save_picture;
  element("film").onclick = toggle_film;
  element("film").hidden = !canvas_films;
  element("help-button").onclick = element("help").querySelector("button").onclick = toggle_help;
  new ResizeObserver(() => draw(performance.now())).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
  listen_to_pointers();
  listen_to_keys();
}

// ---- start -------------------------------------------------------------------------------------------------------
const NO_WEBGL = "This page draws with WebGL 2, which this browser does not offer, so that it shows a still picture. WebGL may be switched off " +
  "in the settings, or the browser may be old: a current Firefox, Chrome, Edge or Safari plays the run.";
const OLD = "This page needs a browser of 2023 or later, which can unpack what it holds; so it shows a still picture.";
const LOST = "The browser took the 3D view away, perhaps for lack of memory. Load the page again to go on.";
function say_instead(text) {
  element("bar").hidden = true;
  element("message").hidden = false;
  element("message").firstElementChild.textContent = text;
  document.body.classList.add("still");                  // its pictures take the place of the canvas
}
function write_page() {
  element("title").textContent = run.title;
  element("subtitle").textContent = run.subtitle;
  element("note").textContent = run.note;
  element("note").hidden = !run.note;
  element("grid").textContent = bodies.some(({ planes }) => planes.length) ? `grid: ${run.spacing} m` : "";
  document.body.classList.toggle("several", bodies.length > 1);
  document.body.classList.toggle("beside", PANES.length > 1);
  element("lattice").setAttribute("aria-pressed", state.lattice);
  for (const name of ["obstacles", "contacts"]) element(name).hidden = !bodies.some(({ obstacles }) => obstacles.length);
  element("pressed").hidden = !bodies.some(({ touch }) => touch.arrows.length);
  for (const each of run.cells) element("colour").add(new Option({ von_mises: "stress", contact_pressure: "contact pressure" }[each.name] || each.name, each.name));
  element("ramp").style.background = `linear-gradient(90deg, ${Array.from({ length: 9 }, (_, i) => {
    const at = 3 * Math.round(i / 8 * (run.ramp.length / 3 - 1)); return `rgb(${run.ramp.slice(at, at + 3)})`; }).join(",")})`;
}
// "#t=0.4" in the address opens the page at that time, paused; "&colour=strain" with that colour.
async function start() {
  const wanted = new URLSearchParams(location.hash.slice(1)), still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  write_page();
  make_rows();
  if (!gl) return say_instead(NO_WEBGL);
  if (!globalThis.DecompressionStream) return say_instead(OLD);
  canvas.addEventListener("webglcontextlost", () => say_instead(LOST));
  for (const body of bodies) body.surface = await unpack(body.surface);
  source.begin();
  build();
  gl.depthFunc(gl.LEQUAL);
  listen();
  offer_speeds();
  reset_view();
  set_colour(COLOURS.includes(wanted.get("colour")) ? wanted.get("colour") : state.colour);
  if (wanted.has("t")) source.go_to(+wanted.get("t") || 0);
  set_playing(!wanted.has("t") && !still);
}
start().catch(error => { say_instead(`The 3D view could not start: ${error.message}`); throw error; });
