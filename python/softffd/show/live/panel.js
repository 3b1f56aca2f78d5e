// ---- the panel: what can be held, the parameters, moments that are kept, and the recording --------------------------
let chosen = null;                                     // of what can be held, what the arrow keys move
const places = [...live.probes, { label: "object", uvw: body.counts.map((n, a) => body.bases[a] === 1 ? (n - 3) / 2 : body.bases[a] === 2 ? n / 3 / 2 : 0.5) }];
const holds = [...live.open.parts.map(({ label }, part) => ({ label, part })), ...live.open.loads.map(({ label }, load) => ({ label, load })), ...places];
const small = () => matchMedia("(max-width: 900px), (max-height: 480px)").matches;
const sliders = live.sliders.map(slider => ({ ...slider, send: send_parameters }));
const load_sliders = live.open.loads.map(({ label, start }, load) => ["x", "y", "z"].map((axis, a) =>
  ({ label: `${label} ${axis}`, unit: "N", start: start[a], low: -live.pull.most, high: live.pull.most, send: v => set_load(load, loads[load].map((f, b) => b === a ? v : f)) })));

function begin_panel() {
  element("panel").open = !small();
  element("panel").ontoggle = refit;
  element("panel").firstElementChild.onkeydown = e => { if (e.key === " ") e.stopPropagation(); };
  const acts = {
    step: () => step_frames(1), save: () => ask({ save: true }), restore: () => ask({ restore: true }), record: () => now.frame > 0 ? ask({ recording: true }) : tell("Nothing has been done yet"),
    again() { let_go(); ask({ again: parameters_now(), loads }); }, sideways: () => toggle("sideways"), turning: () => toggle("turning"),
  };
  for (const [name, act] of Object.entries(acts)) element(name).onclick = act;
  KEYS.push([["S"], "keep this moment", acts.save], [["B"], "back to the moment that was kept", () => element("restore").click()],
    [["A"], "from the start, with these values", acts.again], [["N"], "plates go sideways too", acts.sideways], [["T"], "obstacles and pins are turned, not moved", acts.turning],
    [["W"], "save what was done, for softffd run", acts.record], [["Escape"], "let go", let_go]);
  holds.forEach(({ label }, n) => element("grips").append(grip_button(label, n)));
  element("turning").hidden = !live.open.parts.some(part => part.turns);
  [...load_sliders.flat(), ...sliders].forEach(make_slider);
}
function grip_button(label, n) {
  const button = Object.assign(document.createElement("button"), { textContent: label, title: "Arrow keys move it, with Shift farther; Escape lets go" });
  button.setAttribute("aria-pressed", false);
  button.onclick = () => choose(chosen === n ? null : n);
  button.onkeydown = e => {
    if (!ARROWS[e.key] || !now.outputs) return;
    if (chosen !== n) choose(n);
    nudge(holds[n], e.key, e.shiftKey);
    e.preventDefault();
    e.stopPropagation();
  };
  return button;
}
function choose(n) {
  if (n !== chosen && !grip) hand = null;
  chosen = n;
  [...element("grips").children].forEach((button, m) => button.setAttribute("aria-pressed", m === n));
}
function make_slider(slider) {
  const label = document.createElement("label"), value = document.createElement("output"), { low, high, logarithmic } = slider;
  const input = Object.assign(document.createElement("input"), { type: "range", min: 0, max: 1, step: "any" });
  const share = v => logarithmic ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low);
  label.append(slider.label, value, input);
  slider.show = v => {
    slider.now = v;
    input.value = share(v);
    value.textContent = slider.unit ? quantity(+v.toPrecision(3), slider.unit) : NUMBERS.format(+v.toPrecision(3));
    input.setAttribute("aria-valuetext", value.textContent);
  };
  input.onkeydown = e => { if (ARROWS[e.key]) e.stopPropagation(); };   // are its own
  input.oninput = () => {
    const s = +input.value;
    const v = logarithmic ? low * (high / low) ** s : low + s * (high - low);
    slider.show(low < 0 && Math.abs(v) < 0.02 * high ? 0 : +v.toPrecision(4));   // nothing is easy to find
    slider.send(slider.now);
  };
  slider.show(slider.start);
  element("sliders").append(label);
}
function set_load(n, force) {
  loads = loads.map((old, m) => m === n ? force.map(f => Math.min(Math.max(f, -live.pull.most), live.pull.most)) : old);
  show_loads();
}
function show_loads() {
  loads.forEach((force, n) => force.forEach((f, a) => load_sliders[n][a].show(f)));
  show();
}
function parameters_now() {
  const values = live.open.parameters.map(each => each.start);
  for (const { now: v, start, parameters, factors } of sliders)
    if (v !== start) parameters.forEach((n, i) => { values[n] = v * factors[i]; });
  return values;
}
function send_parameters() {
  for (let i = waiting_messages.length - 1; i >= 0; i--) if (waiting_messages[i].set) waiting_messages.splice(i, 1);
  ask({ set: parameters_now() });
}
function set_sliders(values) {
  for (const { show: put, parameters, factors } of sliders) {
    const i = Math.max(factors.findIndex(factor => factor !== 0), 0);
    put(values[parameters[i]] / (factors[i] || 1));
  }
}
// A file of inputs for `softffd run`.
function keep_recording(text) {
  const name = `${file_stem()}.csv`;
  download(name, new Blob([text], { type: "text/csv" }));
  tell(`${name}: ${live.command} ${name} does the same, to the bit`);
}
