// ---- what a reader keeps of the view: a picture (PNG) and a film (WebM), both with the page's background ---------------
const FILM = "video/webm", canvas_films = !!canvas.captureStream && !!globalThis.MediaRecorder?.isTypeSupported(FILM);
const FILM_RATE = 8e6;                                   // bits per second
let film = null;                                         // the recorder and its canvas, while a film is made

const file_stem = () => run.title.replace(/[^\p{L}\p{N}]+/gu, "_").replace(/^_|_$/g, "").slice(0, 40) || "run";
function download(name, blob) {
  const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(blob) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
// Of the canvas what neither readout nor controls cover: where it begins, its width and height.
function free_view() {
  const ratio = canvas.width / canvas.clientWidth, [left, right] = covered().map(x => Math.round(x * ratio));
  return [left, canvas.width - left - right, canvas.height];
}
// The free view as it is drawn now, in the middle of a canvas of two dimensions.
function copy_view(target) {
  const pen = target.getContext("2d"), { width, height } = target, style = getComputedStyle(document.documentElement);
  const sky = pen.createRadialGradient(width / 2, 0.35 * height, 0, width / 2, 0.35 * height, 0.75 * Math.max(width, height));
  sky.addColorStop(0, style.getPropertyValue("--sky").trim());
  sky.addColorStop(1, style.getPropertyValue("--floor").trim());
  pen.fillStyle = sky;
  pen.fillRect(0, 0, width, height);
  const [left, across, down] = free_view(), scale = Math.min(width / across, height / down), w = scale * across, h = scale * down;
  pen.drawImage(canvas, left, 0, across, down, (width - w) / 2, (height - h) / 2, w, h);
}
function copy_of_view() {
  const [, width, height] = free_view();
  return Object.assign(document.createElement("canvas"), { width, height });
}

function save_picture() {
  const target = copy_of_view(), name = `${file_stem()}_${state.time.toFixed(source.decimals)}s.png`;
  draw_view();                                           // what WebGL has drawn is gone after the frame
  copy_view(target);
  target.toBlob(blob => download(name, blob));
}
function toggle_film() {
  if (film) return film.recorder.state === "recording" && film.recorder.stop();
  const target = copy_of_view(), name = `${file_stem()}_from_${state.time.toFixed(source.decimals)}s.webm`, parts = [];
  draw_view();
  copy_view(target);
  const recorder = new MediaRecorder(target.captureStream(), { mimeType: FILM, videoBitsPerSecond: FILM_RATE });
  recorder.ondataavailable = ({ data }) => parts.push(data);
  recorder.onstop = () => {
    film = null;
    mark_film();
    download(name, new Blob(parts, { type: FILM }));
  };
  film = { recorder, target };
  recorder.start();
  mark_film();
}
function mark_film() {
  element("film").setAttribute("aria-pressed", !!film);
  element("film").querySelector("span").textContent = film ? "Stop" : "Record";
}
