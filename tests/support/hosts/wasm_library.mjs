// The component in WebAssembly, for node: `run` is the JSON file that a test wrote, `said` what the component has said, [status, text] each.
import { readFileSync } from "node:fs";

export const run = JSON.parse(readFileSync(process.argv[2], "utf8"));
export const said = [];
export const { load_library, Component } = new Function(`${readFileSync(run.component, "utf8")}\nreturn { load_library, Component };`)();
export const library = await load_library(await WebAssembly.compile(readFileSync(run.library)), (...message) => said.push(message));
