// The component in WebAssembly: the functions of FMI 2.0 with numbers for pointers. Runs in a page, a worker and node alike; needs nothing.

// The library of a compiled WebAssembly.Module: { module, exports, memory }. log(status, text) takes what the component says.
async function load_library(module, log) {
  let memory;
  const view = () => new DataView(memory.buffer);
  const text = (at, end) => new TextDecoder().decode(new Uint8Array(memory.buffer).slice(at, end));
  const texts = at => text(at, new Uint8Array(memory.buffer).indexOf(0, at));
  const wasi = {                                         // only what ends the component prints
    fd_write(_file, pieces, count, written) {
      let total = 0;
      for (let piece = pieces; piece < pieces + 8 * count; piece += 8) {
        const at = view().getUint32(piece, true), length = view().getUint32(piece + 4, true);
        if (length) log(FATAL, text(at, at + length));
        total += length;
      }
      view().setUint32(written, total, true);
      return 0;
    },
    fd_seek: () => NOT_SUPPORTED,
    fd_close: () => NOT_SUPPORTED,
  };
  const softffd = { log: (status, _category, message) => log(status, texts(message)) };
  const { exports } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi, softffd });
  memory = exports.memory;
  exports._initialize();
  return { module, exports, memory };
}
const NOT_SUPPORTED = 52, WARNING = 1, FATAL = 4;        // of WASI; of FMI

// An instance of the resolved scene's text. A call that the component refuses throws; the reason went to the log.
class Component {
  constructor(library, scene, guid) {
    Object.assign(this, { library, call: library.exports });
    const text = new TextEncoder().encode(scene), token = new TextEncoder().encode(guid + "\0");
    this.handle = this.lend(text.length + token.length, at => {
      this.bytes(at, text.length).set(text);
      this.bytes(at + text.length, token.length).set(token);
      return this.call.softffd_open(at, text.length, at + text.length);
    });
    if (!this.handle) throw new Error("the component refuses the scene");
  }
  // Views last until memory grows: they are made anew for each use.
  bytes(at, count) { return new Uint8Array(this.library.memory.buffer, at, count); }
  lend(size, use) {                                      // room in the component's memory for the time of a call
    const at = this.room(size);
    try { return use(at); } finally { this.call.free(at); }
  }
  room(size) {
    const at = this.call.malloc(size);
    if (!at) throw new Error("the component has no memory left");
    return at;
  }
  // Value references, and a place for their values that stays.
  block(references) {
    const { memory } = this.library, count = references.length, at = this.room(12 * count + 1), list = at + 8 * count;
    new Uint32Array(memory.buffer, list, count).set(references);
    return { count, at, list, get values() { return new Float64Array(memory.buffer, at, count); } };
  }
  ask(name, ...values) {
    const status = this.call[`fmi2${name}`](this.handle, ...values);
    if (status > WARNING) throw Object.assign(new Error(`fmi2${name}: status ${status}`), { status });
    return status;
  }
  set({ list, count, at }) { if (count) this.ask("SetReal", list, count, at); }
  get(block) {
    if (block.count) this.ask("GetReal", block.list, block.count, block.at);
    return block.values;
  }
  setup(start, stop) { this.ask("SetupExperiment", 0, 0, start, stop === undefined ? 0 : 1, stop ?? 0); }
  initialize() {
    this.ask("EnterInitializationMode");
    this.ask("ExitInitializationMode");
  }
  step(time, step) { return this.ask("DoStep", time, step, 1); }
  reset() { this.ask("Reset"); }
  close() { this.call.fmi2FreeInstance(this.handle); }
  // States: save gives a handle, which restore takes any number of times and forget gives up.
  number(use) {
    return this.lend(4, at => {
      this.bytes(at, 4).fill(0);
      use(at);
      return new Uint32Array(this.library.memory.buffer, at, 1)[0];
    });
  }
  save() { return this.number(at => this.ask("GetFMUstate", at)); }
  restore(state) { this.ask("SetFMUstate", state); }
  forget(state) {
    this.lend(4, at => {
      new Uint32Array(this.library.memory.buffer, at, 1)[0] = state;
      this.ask("FreeFMUstate", at);
    });
  }
  serialized(state) {
    const size = this.number(at => this.ask("SerializedFMUstateSize", state, at));
    return this.lend(size, at => {
      this.ask("SerializeFMUstate", state, at, size);
      return this.bytes(at, size).slice();
    });
  }
}
