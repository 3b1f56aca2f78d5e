// ---- keys: one table, for whoever listens and for whoever asks for it --------------------------------------------------
const KEY_NAMES = { " ": "Space", ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓", Escape: "Esc" };
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
// Keys, what they do, the action, and the element that must have the focus, if any. The first row that fits counts.
const KEYS = [
  [Object.keys(ARROWS), "turn the view, once it was clicked", key => turn(...ARROWS[key].map(way => -0.08 * way)), canvas],
  [[" "], "play or pause", () => set_playing(!state.playing)],
  [[".", "ArrowRight", "ArrowUp"], source.says.on, () => step_frames(1)],
  [[",", "ArrowLeft", "ArrowDown"], source.says.back, () => step_frames(-1)],
  [["[", "]"], "slower, faster", key => change_speed(key === "]" ? 1 : -1)],
  [["C"], "another colour of the surface", () => next_colour()],
  [["L"], "control points and lattice", () => toggle("lattice")],
  [["O"], "obstacles", () => toggle("obstacles")],
  [["K"], "contacts and forces", () => toggle("contacts")],
  [["F"], "the camera follows the object", () => toggle("follow")],
  [["+", "="], "nearer", () => zoom(0.9)],
  [["-"], "farther", () => zoom(1.1)],
  [["R"], "first view again", () => reset_view()],
  [["P"], "save the view as a picture", () => save_picture()],
  ...canvas_films ? [[["V"], "record a film of the view, and save it", () => toggle_film()]] : [],
  [["?"], "these keys", () => toggle_help()],
];

function listen_to_keys() {
  addEventListener("keydown", e => {
    const help = element("help").open, key = e.key.length === 1 ? e.key.toUpperCase() : e.key;
    if (e.ctrlKey || e.metaKey || e.altKey || e.target.tagName === "SELECT" || (e.key === " " && e.target.tagName === "BUTTON")) return;
    const row = KEYS.find(([keys, , , focus]) => keys.includes(key) && (!focus || focus === e.target));
    if (!row || (help && key !== "?")) return;
    row[2](key);
    e.preventDefault();
  });
}
function toggle_help() {
  const help = element("help");
  if (help.open) return help.close();
  element("keys").replaceChildren(...KEYS.map(([keys, words]) => {
    const line = document.createElement("tr"), names = document.createElement("th");
    names.append(...keys.map(key => Object.assign(document.createElement("kbd"), { textContent: KEY_NAMES[key] || key })));
    line.append(names, Object.assign(document.createElement("td"), { textContent: words }));
    return line;
  }));
  help.showModal();
}
