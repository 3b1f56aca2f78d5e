// live_in_node.mjs PAGE MESSAGES.json: the worker of a live page without a browser. Each message gets its answer, all of them as JSON.
import fs from "node:fs";
import vm from "node:vm";
import zlib from "node:zlib";

const [, , page, messages] = process.argv;
const held = name => fs.readFileSync(page, "utf8").match(new RegExp(`<script type="[^"]*" id="${name}">([^]*?)</script>`))[1];
const { open } = JSON.parse(held("live")), wasm = new Uint8Array(zlib.gunzipSync(Buffer.from(held("wasm").trim(), "base64"))).buffer;
const answers = [];
let heard;
globalThis.postMessage = data => data.told ? console.error(data.told) : heard(data);
vm.runInThisContext(held("worker"));
for (const message of [{ open, wasm }, ...JSON.parse(fs.readFileSync(messages, "utf8"))]) {
  const answer = new Promise(resolve => { heard = resolve; });
  onmessage({ data: message });
  answers.push(await answer);
}
console.log(JSON.stringify(answers, (_, value) => ArrayBuffer.isView(value) ? [...value] : value));
