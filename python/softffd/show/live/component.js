export async function load_library(bytes, say) {
  let memory;
  const text = at => { const all = new Uint8Array(memory.buffer); let end = at; while (all[end]) end++; return new TextDecoder().decode(all.slice(at, end)); };
  const imports = { wasi_snapshot_preview1: { fd_close: () => 52, fd_seek: () => 52, fd_write: () => 52 }, softffd: { log: (status, category, message) => say(status, text(category), text(message)) } };
  const { instance } = await WebAssembly.instantiate(bytes, imports);
  memory = instance.exports.memory;
  instance.exports._initialize();
  return { x: instance.exports, memory };
}
export class Component {
  constructor({ x, memory }, scene, guid) {
    Object.assign(this, { x, memory });
    const put = s => { const b = new TextEncoder().encode(s + "\0"), at = x.malloc(b.length); new Uint8Array(memory.buffer).set(b, at); return [at, b.length - 1]; };
    const [at, n] = put(scene), [id] = put(guid);
    this.handle = x.softffd_open(at, n, id);
    x.free(at); x.free(id);
    if (!this.handle) throw new Error("the scene was refused");
  }
  block(references) {
    const n = references.length, at = this.x.malloc(8 * n + 8), refs = this.x.malloc(4 * n + 4), memory = this.memory;
    new Uint32Array(memory.buffer, refs, n).set(references);
    return { n, at, refs, get values() { return new Float64Array(memory.buffer, at, n); } };
  }
  check(status, what) { if (status > 1) throw new Error(what); }
  set(b) { if (b.n) this.check(this.x.fmi2SetReal(this.handle, b.refs, b.n, b.at), "set"); }
  get(b) { if (b.n) this.check(this.x.fmi2GetReal(this.handle, b.refs, b.n, b.at), "get"); return b.values; }
  setup(start) { this.check(this.x.fmi2SetupExperiment(this.handle, 0, 0, start, 0, 0), "setup"); }
  initialize() { this.check(this.x.fmi2EnterInitializationMode(this.handle), "enter"); this.check(this.x.fmi2ExitInitializationMode(this.handle), "exit"); }
  step(t, h) { return this.x.fmi2DoStep(this.handle, t, h, 1); }
  save() { const at = this.x.malloc(4); new Uint32Array(this.memory.buffer, at, 1)[0] = 0; this.check(this.x.fmi2GetFMUstate(this.handle, at), "save"); const s = new Uint32Array(this.memory.buffer, at, 1)[0]; this.x.free(at); return s; }
  restore(state) { this.check(this.x.fmi2SetFMUstate(this.handle, state), "restore"); }
  free(state) { const at = this.x.malloc(4); new Uint32Array(this.memory.buffer, at, 1)[0] = state; this.check(this.x.fmi2FreeFMUstate(this.handle, at), "free"); this.x.free(at); }
  reset() { this.check(this.x.fmi2Reset(this.handle), "reset"); }
}
