// node wasm_refusals.mjs RUN.json: what the component refuses. Prints what came of each attempt, [status, what was said]; and whether a state
// that is restored goes on as it did.
import { Component, library, run, said } from "./wasm_library.mjs";

const opened = () => new Component(library, run.scene, run.guid);
function begun() {
  const component = opened();
  component.setup(0);
  component.initialize();
  return component;
}
function given(component, value) {
  const block = component.block([run.input]);
  block.values[0] = value;
  component.set(block);
}
function spoilt() {
  const component = begun();
  try { given(component, NaN); } catch { said.length = 0; }
  return component;
}
const attempts = {
  "another guid": () => new Component(library, run.scene, "{another}"),
  "a damaged scene": () => new Component(library, run.damaged, run.guid),
  "a step too early": () => opened().step(0, 0.01),
  "an unknown variable": () => { const component = begun(); component.get(component.block([12345])); },
  "not a number": () => given(begun(), NaN),
  "a step backwards": () => begun().step(0, -0.01),
  "a failed instance": () => spoilt().step(0, 0.01),
  "a failed instance after a reset": () => {
    const component = spoilt();
    component.reset();
    component.setup(0);
    component.initialize();
    component.step(0, 0.01);
  },
};
function outcome(attempt) {
  said.length = 0;
  try { attempt(); } catch (error) { return [error.status ?? "refused", [...said]]; }
  return [null, [...said]];
}

const component = begun(), state = component.save();
const [once, again] = [0, 1].map(() => {
  component.restore(state);
  component.step(0, 0.01);
  return Buffer.from(component.serialized(component.save()));
});
const found = Object.fromEntries(Object.entries(attempts).map(([name, attempt]) => [name, outcome(attempt)]));
console.log(JSON.stringify({ said: found, restores: once.equals(again) }));
