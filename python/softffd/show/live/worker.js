// The worker of a live page. It owns the component and the record of what is done; the page owns the clock, and asks for time.
// `live_component.js` stands before it. One message, one answer, which names what was asked for:
//   { open, wasm }              a frame                      the scene, and what is known of its variables (page.py); the library
//   { run, budget, hand, loads } a frame, steps, took [ms],  until a time [s]; within a budget [ms]; hand: null, { part, target, turn }: an obstacle
//                               perhaps refused: text        or pin, perhaps with a turn from its start, or { weights, target, stiffness,
//                                                            damping, most }: the object, in world places; loads: forces (L, 3) [N]
//   { set: values }             a frame                      the tunable parameters, all
//   { save } { restore }        { saved: t } a frame, values, loads
//   { again: values, loads }    a frame                      from the start, with these parameters and loads
//   { recording }               { recording: csv }
// A frame is { frame: t, points, outputs, parts, turns, pull, at }. Beside answers: { told: text }; in place of one: { failed: text }.
const TURNED = {                                         // how inputs say a turn from where they start
  normal: turned,
  orientation: product,
  rotation: (turn, start) => vector_of(product(turn, turn_of(start))),
};
const DISCARD = 2, ERROR = 3;                            // of FMI: a step that is refused; a component that has to be reset

class LiveRun {
  constructor(component, opened) {
    this.component = component;
    this.opened = opened;
    component.ask("SetDebugLogging", 1, 0, 0);         // else it keeps to itself why it refuses a step
    this.inputs = component.block(opened.inputs);
    this.positions = component.block(opened.positions);
    this.outputs = component.block(opened.outputs);
    this.free = opened.parts.map(({ free }) => free && component.block([...free.position, ...free.velocity, ...free.orientation]));
    this.tuned = opened.parameters.map(each => component.block([each.reference]));
    this.wanted = opened.parameters.map(each => each.start);
    this.loads = opened.loads.map(each => each.start);
    this.begin();
  }
  // From the start, with the parameters that are wanted now.
  begin() {
    const { component, opened } = this;
    component.setup(0);
    this.values = opened.parameters.map(each => each.start);
    this.tune();
    this.first = [...this.values];
    Object.assign(this, { count: 0, record: [], changed: [], hand: null, before: null, parts: opened.parts.map(part => ({ ...part, turn: UNTURNED })) });
    this.write_inputs();
    component.initialize();
    this.look();
  }
  again() {
    this.component.reset();
    this.begin();
  }
  get time() { return this.count * this.opened.h; }    // a multiple of the step, as `softffd run` counts
  look() {
    this.points = Float64Array.from(this.component.get(this.positions));
    this.parts.forEach((part, n) => {
      if (!part.free) return;
      const seen = [...this.component.get(this.free[n])], orientation = seen.slice(6);
      part.first ||= orientation;
      Object.assign(part, { point: seen.slice(0, 3), velocity: seen.slice(3, 6), turn: product(orientation, backwards(part.first)) });
    });
  }

  // Hands over the parameters that have changed, these alone: setting one makes the component prepare the body anew.
  tune() {
    this.wanted.forEach((value, n) => {
      if (value === this.values[n]) return;
      this.tuned[n].values[0] = this.values[n] = value;
      this.component.set(this.tuned[n]);
      this.changed?.push([n, value]);
    });
  }
  set(values) {
    this.wanted = [...values];
    if (this.count === 0) this.again();                // before the first step they are start values
  }

  // Obstacles and pins go on at their own speed, or towards the hand: their poses and velocities agree, so that nothing jumps. Free bodies go
  // their own way, but for the force by which a hand draws one.
  write_inputs() {
    const { starts, forces, loads } = this.opened, values = this.inputs.values, write = (vector, at) => values.set(vector.map(x => x + 0), at);   // no -0, which the record has not
    values.set(starts);
    this.parts.forEach((part, n) => {
      if (part.free) return this.hand?.part === n && write(this.drawn(part), part.at);
      part.velocity = part.drift;
      part.spin = [0, 0, 0];
      if (this.hand?.part === n || part.taken) this.lead(part, this.hand?.part === n ? this.hand : { target: part.point });
      write(part.point, part.at);
      write(part.velocity, part.speed);
      if (!part.turns) return;
      if (part.turn !== UNTURNED) write(TURNED[part.turns](part.turn, part.axis), part.turned);
      write(part.spin, part.spins);
    });
    loads.forEach(({ at }, n) => write(this.loads[n], at));
    this.pull = this.pulled();
    if (this.pull) for (const [p, w] of this.hand.weights) for (let a = 0; a < 3; a++) values[forces + 3 * p + a] = w * this.pull[a] + 0;
    this.component.set(this.inputs);
  }
  // Its velocities towards where the hand is; what was held once stays where it was let go.
  lead(part, { target, turn = part.turn }) {
    const { h, most_speed, most_turn } = this.opened, rates = (way, most, least) => {
      const length = Math.hypot(...way), rate = Math.min(length / Math.max(3 * h, 0.02), most);
      return way.map(x => length > least ? x / length * rate : 0);
    };
    part.taken = true;
    part.velocity = rates(target.map((x, a) => x - part.point[a]), most_speed, 1e-9 * most_speed);
    if (part.turns && turn !== part.turn) part.spin = rates(vector_of(product(turn, backwards(part.turn))), most_turn, 1e-9);
  }
  // The force on the place that the hand holds [N]: a spring and a dashpot, bounded.
  pulled() {
    if (!this.hand?.weights) return this.before = null;
    const { target, stiffness, damping, most } = this.hand, at = this.held_place(), before = this.before || at;
    const force = at.map((x, a) => stiffness * (target[a] - x) - damping * (x - before[a]) / this.opened.h), size = Math.hypot(...force);
    this.before = at;
    return size > most ? force.map(f => f * most / size) : force;
  }
  // That on the centre of a free body.
  drawn({ point, velocity, stiffness, damping, most }) {
    const force = point.map((x, a) => stiffness * (this.hand.target[a] - x) - damping * velocity[a]), size = Math.hypot(...force);
    return size > most ? force.map(f => f * most / size) : force;
  }
  // What the hand pulls at, of the object or a free body.
  hand_at() {
    const part = this.parts[this.hand?.part];
    return this.hand?.weights ? this.held_place() : part?.free ? part.point : null;
  }
  held_place() {
    return [0, 1, 2].map(a => this.hand.weights.reduce((sum, [p, w]) => sum + w * this.points[3 * p + a], 0));
  }
  step() {
    this.tune();
    if (this.count === 0) this.hand = null;            // its inputs were handed over before the initialization ended
    else this.write_inputs();
    const done = { moving: this.inputs.values.slice(0, this.opened.forces), pull: this.pull, weights: this.hand?.weights, tuned: this.changed };
    this.component.step(this.time, this.opened.h);     // throws where it is refused, and all is as before
    this.record.push(done);
    this.changed = [];
    for (const part of this.parts) {
      if (part.free) continue;
      part.point = part.point.map((x, a) => x + part.velocity[a] * this.opened.h);
      if (part.spin.some(x => x)) part.turn = product(turn_of(part.spin.map(x => x * this.opened.h)), part.turn);
    }
    this.count++;
    this.look();
  }
  // Whole communication steps until a time, or until the budget [ms] is spent. Where one is refused all is as before, with the reason.
  run(until, budget, hand, loads = this.loads) {
    const began = performance.now(), before = this.kept();
    let refused;
    try {
      do {
        Object.assign(this, { hand, loads });
        if ((this.count + 1) * this.opened.h > until + 1e-6 * this.opened.h) break;
        this.step();
      } while (performance.now() - began < budget);
    } catch (error) {
      if (![DISCARD, ERROR].includes(error.status)) throw error;
      refused = last_words || error.message;
      if (error.status === ERROR) this.component.reset();
      this.go_back(before);
    } finally { this.component.forget(before.state); }
    return { steps: this.count - before.count, took: performance.now() - began, refused };
  }
  frame() {
    const { centre } = this.opened;
    return { frame: this.time, points: Float32Array.from(this.points, (x, i) => x - centre[i % 3]), outputs: Float64Array.from(this.component.get(this.outputs)),
      parts: this.parts.map(part => part.point), turns: this.parts.map(part => part.turn), pull: this.pull, at: this.hand_at() };
  }
  save() {
    if (this.saved) this.component.forget(this.saved.state);
    this.saved = this.kept();
    return { saved: this.time };
  }
  restore() {
    this.go_back(this.saved);
    return { values: this.values, loads: this.loads };
  }
  // A moment: the component's state, and what belongs to it here. Records grow at their ends, so that their length is enough.
  kept() {
    const { count, first, record, loads } = this;
    return { ...this.own(), count, first, record, loads, length: record.length, state: this.component.save() };
  }
  go_back(moment) {
    this.component.restore(moment.state);
    Object.assign(this, { ...moment, ...this.own(moment), hand: null, before: null, wanted: [...moment.values] });
    this.record.length = moment.length;
    this.look();
  }
  // Copies of what changes in place.
  own({ values, changed, parts } = this) {
    return { values: [...values], changed: [...changed], parts: parts.map(part => ({ ...part })) };
  }

  // What was done, as a CSV file of inputs: the columns that ever differ from the start values, a row for each communication point.
  recording() {
    const { names, starts, forces, h, parameters, recorded } = this.opened, { record } = this, values = [...this.first];
    const tuned = parameters.map((_, n) => n).filter(n => values[n] !== parameters[n].start || record.some(each => each.tuned.some(([m]) => m === n)));
    const moving = names.slice(0, forces).map((_, n) => n).filter(n => record.some(each => each.moving[n] !== starts[n]));
    const pulled = new Set(record.flatMap(each => each.pull ? each.weights.map(([p]) => p) : [])), points = [...pulled].sort((a, b) => a - b);
    if (!moving.length && !points.length && !tuned.length) points.push(0);   // a file of inputs has one at least
    const columns = points.flatMap(p => [0, 1, 2].map(a => names[forces + 3 * p + a]));
    const lines = [recorded, ["time", ...moving.map(n => names[n]), ...columns, ...tuned.map(n => parameters[n].name)].map(name => `"${name}"`).join(",")];
    record.forEach((each, k) => {
      for (const [n, value] of each.tuned) values[n] = value;
      const force = new Map(each.pull ? each.weights : []);
      const forced = points.flatMap(p => [0, 1, 2].map(a => force.has(p) ? force.get(p) * each.pull[a] + 0 : 0));
      lines.push([k * h, ...moving.map(n => each.moving[n]), ...forced, ...tuned.map(n => values[n])].join(","));
    });
    if (record.length) lines.push([record.length * h, ...lines[lines.length - 1].split(",").slice(1)].join(","));   // what is held at the end
    return lines.join("\n") + "\n";
  }
}

let live;
const ANSWERS = {
  async open({ open, wasm }) {
    const library = await load_library(await WebAssembly.compile(wasm), log);
    live = new LiveRun(new Component(library, open.scene, open.guid), open);
    return { ready: true, ...live.frame() };
  },
  run: ({ run, budget, hand, loads }) => ({ ...live.run(run, budget, hand, loads), ...live.frame() }),
  set({ set }) { live.set(set); return live.frame(); },
  save: () => live.save(),
  restore: () => ({ ...live.restore(), ...live.frame() }),
  again({ again, loads = live.loads }) { Object.assign(live, { wanted: [...again], loads }); live.again(); return live.frame(); },
  recording: () => ({ recording: live.recording() }),
};
let last_words = "";
function log(status, text) {
  if (status === 0) return;
  last_words = text;
  postMessage({ told: text });
}
onmessage = async ({ data }) => {
  last_words = "";
  const asked = Object.keys(ANSWERS).find(name => name in data);
  try { postMessage({ asked, ...await ANSWERS[asked](data) }); } catch (error) { postMessage({ asked, failed: last_words || error.message }); }
};
