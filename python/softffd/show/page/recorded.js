// ---- the source of runs that were recorded: their frames, and their playback ----------------------------------------
for (const body of bodies) {
  body.times = decode(body.time, Float64Array);
  body.positions = decode(body.positions, Float32Array);
  for (const each of body.obstacles) each.poses = decode(each.poses, Float32Array);
  body.cells = body.cells.map(each => decode(each, Uint8Array));
  for (const arrow of body.touch.arrows) for (const part of ["starts", "ways"]) arrow[part] = decode(arrow[part], Float32Array);
  body.touch.places = decode(body.touch.places, Float32Array);
  body.touch.firsts = body.touch.counts.reduce((sums, count) => [...sums, sums[sums.length - 1] + count], [0]);
}
for (const row of run.rows) {
  row.values = decode(row.values, Float32Array);
  row.vectors = row.vectors && decode(row.vectors, Float32Array);
  if (row.taxels) row.taxels.shares = decode(row.taxels.shares, Uint8Array);
}
// One clock: the times of all. A run that has ended stays as it is while others go on.
const times = [...new Set(bodies.flatMap(body => [...body.times]))].sort((a, b) => a - b), LAST = times.length - 1;
const HOLD = 0.7;                                        // s that the last frame stays before the run starts again
let held = 0;
state.time = times[0];

const source = {
  says: { on: "one frame on", back: "one frame back" },
  decimals: Math.min(Math.max(2 - Math.floor(Math.log10((times[LAST] - times[0]) / 100 || 1)) - 1, 1), 6),
  pace: (times[LAST] - times[0]) / 5,                    // at which it lasts five seconds
  moves: LAST > 0,
  points: body => between(body, body.positions, 3 * body.points),
  pose: (each, body) => between(body, each.poses, 9),
  cells: (n, body) => new Uint8Array(between(body, body.cells[n], body.cells[n].length / body.times.length)),
  touch(body) {
    const { places, firsts, arrows } = body.touch, frame = frame_shown(body), at = data => data.subarray(3 * frame, 3 * frame + 3);
    return { places: places.subarray(3 * firsts[frame], 3 * firsts[frame + 1]), arrows: arrows.map(arrow => [at(arrow.starts), at(arrow.ways)]) };
  },
  values(row) {
    const frame = frame_shown(bodies[row.body]);
    return [row.values[frame], row.vectors && row.vectors.subarray(3 * frame, 3 * frame + 3)];
  },
  taxels({ body, taxels: { shares, counts: [n, m] } }) {
    const frame = frame_shown(bodies[body]);
    return shares.subarray(n * m * frame, n * m * (frame + 1));
  },
  told: () => `frame ${frame_shown({ times }) + 1} of ${LAST + 1}`,
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
    for (const { parts } of run.rows) for (const end of ["x1", "x2"]) parts.cursor.setAttribute(end, across(state.time));
  },
  advance(passed) {
    if (state.time < times[LAST]) { state.time = Math.min(state.time + passed * state.speed, times[LAST]); held = 0; }
    else if ((held += passed) > HOLD) state.time = times[0];
  },
  go_to,
  step(count) {
    const [low, , share] = frame_at({ times }, state.time);
    go_to(times[Math.min(Math.max(low + count + (count < 0 && share > 0 ? 1 : 0), 0), LAST)]);
  },
};

// Of a run or of the clock: index of the last recorded frame at or before t, and the share of the way to the next.
function frame_at({ times }, t) {
  let low = 0, high = times.length - 1;
  while (low < high) { const middle = (low + high + 1) >> 1; if (times[middle] <= t) low = middle; else high = middle - 1; }
  const next = Math.min(low + 1, times.length - 1), gap = times[next] - times[low];
  return [low, next, gap > 0 ? Math.min(Math.max((t - times[low]) / gap, 0), 1) : 0];
}
function frame_shown(of) {
  const [low, next, share] = frame_at(of, state.time);
  return share > 0.999 ? next : low;
}
function between(body, data, width) {
  const out = new Float32Array(width), [a, b, share] = frame_at(body, state.time);
  for (let i = 0; i < width; i++) out[i] = data[a * width + i] * (1 - share) + data[b * width + i] * share;
  return out;
}
function go_to(t) {
  state.time = Math.min(Math.max(t, times[0]), times[LAST]);
  show();
}
// Where obstacles are first touched, and where the force on each is largest: by time its words and its colour.
function find_marks() {
  const marks = new Map(), add = (time, words, mark, kind) => {
    if (marks.has(time)) marks.get(time).words += `; ${words}`; else marks.set(time, { words, mark, kind });
  };
  bodies.forEach((body, n) => {
    const pressed = run.rows.filter(row => row.body === n && row.kind === "reaction" && body.obstacles.some(({ name }) => name === row.label) && row.values.some(v => v > 0));
    const first = Math.min(...pressed.map(({ values }) => values.findIndex(v => v > 0)));
    const touched = pressed.filter(({ values }) => values[first] > 0).map(({ label }) => label).join(", ");
    if (touched) add(body.times[first], `${name_of(body, "first contact")}: ${touched}`, "var(--ink)", "contact");
    for (const { label, values, unit, mark } of pressed) {
      const most = values.reduce((best, v, frame) => v > values[best] ? frame : best, 0);
      add(body.times[most], `${name_of(body, label)}: largest reaction, ${quantity(values[most], unit)}`, mark, "peak");
    }
  });
  return [...marks].sort(([a], [b]) => a - b);
}
const marks = [];
function draw_marks() {
  marks.push(...find_marks());
  for (const [time, { words, mark, kind }] of marks) {
    const title = `${words}, at ${seconds(time)}`, button = Object.assign(document.createElement("button"), { className: kind, title, tabIndex: -1 });
    button.setAttribute("aria-label", title);
    button.style.cssText = `left: ${across(time)}%; --mark: ${mark}`;
    button.onclick = () => { set_playing(false); go_to(time); };
    element("marks").append(button);
  }
}
function next_mark() {
  const [time] = marks.find(([time]) => time > state.time) || marks[0] || [null];
  if (time !== null) { set_playing(false); go_to(time); }
}
const across = time => 100 * (time - times[0]) / (times[LAST] - times[0] || 1);
function draw_curve({ values, parts, body }) {
  const low = Math.min(0, ...values), high = Math.max(...values, low + 1e-12), x = i => across(bodies[body].times[i]), y = v => 24 - 22 * (v - low) / (high - low);
  parts.path.setAttribute("d", Array.from(values, (v, i) => `${i ? "L" : "M"}${x(i).toFixed(2)} ${y(v).toFixed(2)}`).join(""));
  const seek = e => {
    const { left, width } = parts.curve.getBoundingClientRect();
    go_to(times[0] + (times[LAST] - times[0]) * (e.clientX - left) / width);
  };
  parts.curve.addEventListener("pointerdown", e => { parts.curve.setPointerCapture(e.pointerId); set_playing(false); seek(e); });
  parts.curve.addEventListener("pointermove", e => { if (e.buttons) seek(e); });
}
