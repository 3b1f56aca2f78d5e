// ---- the source of what is simulated now: a worker steps the component, the page keeps the clock --------------------
const live = JSON.parse(element("live").textContent), { h, centre } = live.open, WINDOW = 5;   // s that curves show
const [body] = bodies, { obstacles, points: POINTS } = body, [NX, NY, NZ] = body.counts;
let now = { frame: 0, points: Float32Array.from(live.start), outputs: null, parts: live.open.parts.map(part => part.point), turns: live.open.parts.map(() => UNTURNED), pull: null, at: null };
let worker, asked = {}, owed = 0, failed = false, hand = null, loads = live.open.loads.map(load => load.start), largest_force = live.weight || 1e-9, looked_at = null, drawn = 0, telling;
const waiting_messages = [], pace = { clock: 0, time: 0, now: 1 };
for (const each of obstacles) each.pose = [...decode(each.poses, Float32Array)];

const source = {
  says: { on: "one communication step", back: "how to go back: save and restore" },
  decimals: 2,
  pace: 1,
  moves: true,
  points: () => now.points,
  pose(each) {
    const n = part_of(each), turn = now.turns[n], { pose } = each;
    return Float32Array.from(n < 0 ? pose : [...held_at(n), ...turned(turn, pose.slice(3, 6)), ...turned(turn, pose.slice(6))]);
  },
  cells: n => cell_shares(run.cells[n]),
  touch() {
    const arrows = [];
    if (now !== looked_at) { find_touched(); looked_at = now; }
    if (now.outputs) for (const { force, centre: at } of body.touch.arrows) {
      const f = force.map(i => now.outputs[i]), size = Math.hypot(...f);
      if (size > 1e-3 * largest_force) arrows.push([at.map((i, a) => now.outputs[i] - centre[a]), f.map(x => x / size * body.touch.longest * Math.sqrt(size / largest_force))]);
    }
    if (now.at && hand) { const at = now.at.map((x, a) => x - centre[a]); arrows.push([at, hand.target.map((x, a) => x - centre[a] - at[a]), HANDLE]); }
    loads.forEach((_, n) => arrows.push([place_of_load(n), arrow_of_load(n), HANDLE]));
    return { places: touched, arrows, handles: Float32Array.from(loads.flatMap((_, n) => place_of_load(n))) };
  },
  values(row) {
    if (!now.outputs) return [0, null];
    const vector = row.at.map(i => now.outputs[i]);
    return [size_of(row, vector), vector.length > 1 ? vector : null];
  },
  told() {
    if (failed || !now.outputs || !state.playing) return failed ? "stopped" : now.outputs ? "paused" : "loading";
    return pace.now > 0.93 * state.speed ? "" : pace.now < 0.95 ? `${+pace.now.toPrecision(1)} of real time` : `${+pace.now.toPrecision(2)} × real time`;
  },
  begin() {
    element("timeline").hidden = true;
    for (const { parts } of run.rows) parts.cursor.remove();
    element("hint").textContent = "drag a plate, a solid, a pin, a load or the object: move it · Ctrl: turn it · beside: turn · wheel: zoom · right drag: move · space: play · ?: all keys";
    begin_panel();
    load();
  },
  switched() { pace.clock = 0; shown = null; },          // between playing and paused
  follow() {
    if (state.playing && performance.now() - drawn < 100) return;
    drawn = performance.now();
    run.rows.forEach(draw_curve);
  },
  go_to() {},
  // A worker that is late makes time go slower: what it owes is forgotten.
  advance(passed) {
    owed = Math.min(owed + passed * state.speed, Math.max(0.1 * state.speed, 2 * h));
    if (!asked && owed >= h) ask({ run: now.frame + owed, budget: 14, hand, loads });
  },
  step(count) {
    if (count > 0) ask({ one_step: true });
    else tell("Time goes forward only: save here, and restore takes you back");
  },
};
function size_of(row, vector) {
  if (row.kind === "moved") return Math.hypot(...vector.map((x, a) => x - (row.first ||= vector)[a]));
  return vector.length > 1 ? Math.hypot(...vector) : vector[0];
}

// ---- the worker: one request at a time ------------------------------------------------------------------------------
async function load() {
  if (!globalThis.WebAssembly) return say_instead("This page simulates with WebAssembly, which this browser does not offer; so it shows a still picture.");
  try {
    const wasm = (await opened(element("wasm").textContent)).buffer;
    worker = new Worker(URL.createObjectURL(new Blob([element("worker").textContent], { type: "text/javascript" })));
    worker.onmessage = hear;
    worker.onerror = e => stop(e.message || "the worker could not start");
    asked = null;
    ask({ open: live.open, wasm });
  } catch (error) { stop(error.message); }
}
function ask(message) {
  if (failed && !message.again) return;
  if (asked) { if (!("run" in message)) waiting_messages.push(message); return; }
  if (message.again) failed = false;
  asked = message.one_step ? { run: now.frame + h, budget: 0, hand, loads } : message;
  worker.postMessage(asked, message.wasm ? [message.wasm] : []);
}
function hear({ data }) {
  if (data.told) return tell(data.told);
  const answered = asked;
  asked = null;
  if (data.failed) return stop(data.failed);
  if (data.frame !== undefined) take_frame(data, answered);
  if (data.refused) {                                  // the state is that before the step: from there it may go on
    let_go();
    set_playing(false);
    tell(`paused, and let go: ${data.refused}`);
  }
  if (data.saved !== undefined) { tell(`saved at ${seconds(data.saved)}`); element("restore").disabled = false; }
  if (data.values) { set_sliders(data.values); loads = data.loads; show_loads(); }
  if (data.recording) keep_recording(data.recording);
  if (waiting_messages.length) ask(waiting_messages.shift());
}
function take_frame(frame, { run: until }) {
  if (frame.frame < now.frame) for (const row of run.rows) row.trace = (row.trace || []).filter(([t]) => t < frame.frame);
  if (until !== undefined) { owed = frame.frame < until - 1.5 * h ? 0 : Math.max(0, owed - (frame.frame - now.frame)); measure_pace(frame.frame - now.frame); }
  else owed = 0;
  now = frame;
  for (const { force } of body.touch.arrows) largest_force = Math.max(largest_force, Math.hypot(...force.map(i => now.outputs[i])));
  for (const row of run.rows) (row.trace ||= []).push([now.frame, source.values(row)[0]]);
  state.time = now.frame;
  shown = null;
  show();
}
function measure_pace(done) {
  pace.time += done;
  const clock = performance.now();
  if (clock - pace.clock < 500) return;
  if (clock - pace.clock < 3000) pace.now = pace.time / (clock - pace.clock) * 1000;
  Object.assign(pace, { clock, time: 0 });
}
function stop(text) {
  failed = true;
  set_playing(false);
  tell(`stopped: ${text}. Again starts anew`);
}
function tell(text) {
  element("told").textContent = text;
  clearTimeout(telling);
  telling = setTimeout(() => { element("told").textContent = ""; }, failed ? 1e9 : 15000);
}

// The last seconds of a value, as a curve.
function draw_curve({ trace, parts }) {
  if (!trace) return;
  const end = Math.max(now.frame, WINDOW), kept = trace.findIndex(([t]) => t >= end - WINDOW);
  if (kept > 0) trace.splice(0, kept);
  const each = Math.ceil(trace.length / 200), shown_ones = trace.filter((_, n) => n % each === 0 || n === trace.length - 1);
  const values = shown_ones.map(([, v]) => v), low = Math.min(0, ...values), high = Math.max(...values, low + 1e-12);
  parts.path.setAttribute("d", shown_ones.map(([t, v], n) =>
    `${n ? "L" : "M"}${(100 * (t - end + WINDOW) / WINDOW).toFixed(2)} ${(24 - 22 * (v - low) / (high - low)).toFixed(2)}`).join(""));
}
