// ---- the source of a run that was recorded: its frames, and their playback ------------------------------------------
const times = decode(run.time, Float64Array), LAST = times.length - 1;
const history = decode(run.positions, Float32Array);
for (const each of obstacles) each.poses = decode(each.poses, Float32Array);
for (const row of run.rows) {
  row.values = decode(row.values, Float32Array);
  row.vectors = row.vectors && decode(row.vectors, Float32Array);
}
for (const each of run.cells) each.values = decode(each.values, Uint8Array);
for (const arrow of run.touch.arrows) for (const part of ["starts", "ways"]) arrow[part] = decode(arrow[part], Float32Array);
const places = decode(run.touch.places, Float32Array);
const firsts = run.touch.counts.reduce((sums, count) => [...sums, sums[sums.length - 1] + count], [0]);
const HOLD = 0.7;                                        // s that the last frame stays before the run starts again
let held = 0;
state.time = times[0];

const source = {
  says: { on: "one frame on", back: "one frame back" },
  decimals: Math.min(Math.max(2 - Math.floor(Math.log10((times[LAST] - times[0]) / 100 || 1)) - 1, 1), 6),
  pace: (times[LAST] - times[0]) / 5,                    // at which it lasts five seconds
  moves: LAST > 0,
  points: () => between(history, 3 * POINTS),
  pose: each => between(each.poses, 9),
  cells: each => new Uint8Array(between(each.values, 2 * (NX - 1) * (NY - 1) * (NZ - 1))),
  touch() {
    const frame = frame_shown(), at = data => data.subarray(3 * frame, 3 * frame + 3);
    return { places: places.subarray(3 * firsts[frame], 3 * firsts[frame + 1]), arrows: run.touch.arrows.map(arrow => [at(arrow.starts), at(arrow.ways)]) };
  },
  values(row) {
    const frame = frame_shown();
    return [row.values[frame], row.vectors && row.vectors.subarray(3 * frame, 3 * frame + 3)];
  },
  told: () => `frame ${frame_shown() + 1} of ${LAST + 1}`,
  begin() {
    Object.assign(element("slider"), { min: times[0], max: times[LAST], step: (times[LAST] - times[0]) / 5000 || 1 });
    element("slider").oninput = e => { set_playing(false); go_to(+e.target.value); };
    KEYS.push([["Home", "End"], "first frame, last frame", key => go_to(times[key === "Home" ? 0 : LAST])]);
    KEYS.push([["M"], "next first contact or largest reaction", next_mark]);
    run.rows.forEach(draw_curve);
    draw_marks();
  },
  follow() {
    element("slider").value = state.time;
    element("slider").setAttribute("aria-valuetext", seconds(state.time));
    const x = 100 * (state.time - times[0]) / (times[LAST] - times[0] || 1);
    for (const { parts } of run.rows) for (const end of ["x1", "x2"]) parts.cursor.setAttribute(end, x);
  },
  advance(passed) {
    if (state.time < times[LAST]) { state.time = Math.min(state.time + passed * state.speed, times[LAST]); held = 0; }
    else if ((held += passed) > HOLD) state.time = times[0];
  },
  go_to,
  step(count) {
    const [low, , share] = frame_at(state.time);
    go_to(times[Math.min(Math.max(low + count + (count < 0 && share > 0 ? 1 : 0), 0), LAST)]);
  },
};

// Index of the last recorded frame at or before t, and the share of the way to the next.
function frame_at(t) {
  let low = 0, high = LAST;
  while (low < high) { const middle = (low + high + 1) >> 1; if (times[middle] <= t) low = middle; else high = middle - 1; }
  const next = Math.min(low + 1, LAST), gap = times[next] - times[low];
  return [low, next, gap > 0 ? Math.min(Math.max((t - times[low]) / gap, 0), 1) : 0];
}
function frame_shown() {
  const [low, next, share] = frame_at(state.time);
  return share > 0.999 ? next : low;
}
function between(data, width) {
  const out = new Float32Array(width), [a, b, share] = frame_at(state.time);
  for (let i = 0; i < width; i++) out[i] = data[a * width + i] * (1 - share) + data[b * width + i] * share;
  return out;
}
function go_to(t) {
  state.time = Math.min(Math.max(t, times[0]), times[LAST]);
  show();
}
// Where obstacles are first touched, and where the force on each is largest: by frame its words and its colour.
function find_marks() {
  const marks = new Map(), add = (frame, words, mark, kind) => {
    if (marks.has(frame)) marks.get(frame).words += `; ${words}`; else marks.set(frame, { words, mark, kind });
  };
  const pressed = run.rows.filter(({ kind, label, values }) => kind === "reaction" && obstacles.some(({ name }) => name === label) && values.some(v => v > 0));
  if (pressed.length) {
    const first = Math.min(...pressed.map(({ values }) => values.findIndex(v => v > 0)));
    add(first, `first contact: ${pressed.filter(({ values }) => values[first] > 0).map(({ label }) => label).join(", ")}`, "var(--ink)", "contact");
  }
  for (const { label, values, unit, mark } of pressed) {
    const most = values.reduce((best, v, frame) => v > values[best] ? frame : best, 0);
    add(most, `${label}: largest reaction, ${quantity(values[most], unit)}`, mark, "peak");
  }
  return [...marks].sort(([a], [b]) => a - b);
}
const marks = [];
function draw_marks() {
  marks.push(...find_marks());
  for (const [frame, { words, mark, kind }] of marks) {
    const title = `${words}, at ${seconds(times[frame])}`, button = Object.assign(document.createElement("button"), { className: kind, title, tabIndex: -1 });
    button.setAttribute("aria-label", title);
    button.style.cssText = `left: ${100 * (times[frame] - times[0]) / (times[LAST] - times[0] || 1)}%; --mark: ${mark}`;
    button.onclick = () => { set_playing(false); go_to(times[frame]); };
    element("marks").append(button);
  }
}
function next_mark() {
  const [frame] = marks.find(([frame]) => frame > frame_shown()) || marks[0] || [null];
  if (frame !== null) { set_playing(false); go_to(times[frame]); }
}
function draw_curve({ values, parts }) {
  const low = Math.min(0, ...values), high = Math.max(...values, low + 1e-12);
  const x = i => 100 * (times[i] - times[0]) / (times[LAST] - times[0] || 1), y = v => 24 - 22 * (v - low) / (high - low);
  parts.path.setAttribute("d", Array.from(values, (v, i) => `${i ? "L" : "M"}${x(i).toFixed(2)} ${y(v).toFixed(2)}`).join(""));
  const seek = e => {
    const { left, width } = parts.curve.getBoundingClientRect();
    go_to(times[0] + (times[LAST] - times[0]) * (e.clientX - left) / width);
  };
  parts.curve.addEventListener("pointerdown", e => { parts.curve.setPointerCapture(e.pointerId); set_playing(false); seek(e); });
  parts.curve.addEventListener("pointermove", e => { if (e.buttons) seek(e); });
}
