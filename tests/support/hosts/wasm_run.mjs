// node wasm_run.mjs RUN.json: a run. Prints what the component has said, and of each communication point the outputs' bytes in base64, the
// reals first.
import { Component, library, run, said } from "./wasm_library.mjs";

const component = new Component(library, run.scene, run.guid), rows = [];
const inputs = component.block(run.inputs), reals = component.block(run.reals), integers = component.block(run.integers);

function give(row) {
  inputs.values.set(run.rows[row]);
  component.set(inputs);
}
function record() {
  component.get(reals);
  component.ask("GetInteger", integers.list, integers.count, integers.at);
  rows.push(Buffer.concat([component.bytes(reals.at, 8 * reals.count), component.bytes(integers.at, 4 * integers.count)]).toString("base64"));
}

component.setup(0, run.times.at(-1));
give(0);
component.initialize();
record();
for (const n of run.rows.keys()) {
  if (n) give(n);
  component.step(run.times[n], run.times[n + 1] - run.times[n]);
  record();
}
component.close();
console.log(JSON.stringify({ said, rows }));
