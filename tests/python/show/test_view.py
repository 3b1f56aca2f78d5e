import base64
import html
import json
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from made_up_run import ORIGIN, SIZE, made_up_run, with_solids
from mesh_files import GREEN, RED, two_colours
from softffd.embedding.deform import deform
from softffd.errors import SoftffdError
from softffd.lattice import rest_grid
from softffd.mesh.mesh import Mesh, load_mesh
from softffd.scene.rigid import Box, Sphere
from softffd.show import view
from softffd.show.stage import stage_of
from softffd.show.surface import cage_surface, split_at_creases
from softffd.show.view import write_view

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--window-size=900,600",
    "--virtual-time-budget=2000",
]
needs_browser = pytest.mark.usefixtures("browser")


@pytest.fixture
def browser():
    """In one place, so that pytest says it in one line."""
    if CHROMIUM is None:
        pytest.skip("no chromium on this machine to look at the page with")


ASK_THE_SHADER = """
<pre id="answer"></pre><script>
const asked = gl.createProgram(), outputs = ["world", "shading", "displacement", "strain"];
gl.attachShader(asked, shader(gl.VERTEX_SHADER, HEADING + SOURCES.volume + SOURCES["object-vertex"]));
gl.attachShader(asked, shader(gl.FRAGMENT_SHADER, "#version 300 es" + SOURCES["object-fragment"]));
gl.transformFeedbackVaryings(asked, outputs, gl.INTERLEAVED_ATTRIBS);
gl.linkProgram(asked);
gl.useProgram(asked);
gl.uniform3fv(gl.getUniformLocation(asked, "origin"), run.origin);
gl.uniform3fv(gl.getUniformLocation(asked, "size"), run.size);
gl.uniform1i(gl.getUniformLocation(asked, "cells"), 3);
const count = decode(run.coordinates, Float32Array).length / 3, found = new Float32Array(8 * count), answers = [];
const target = gl.createBuffer();
gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, target);
gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, found.byteLength, gl.DYNAMIC_READ);
gl.bindVertexArray(object.array);
for (const time of TIMES) {
  state.time = time;
  load_points();
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, target);
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.beginTransformFeedback(gl.POINTS);
  gl.drawArrays(gl.POINTS, 0, count);
  gl.endTransformFeedback();
  gl.disable(gl.RASTERIZER_DISCARD);
  gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, found);
  answers.push(Array.from(found));
}
document.getElementById("answer").textContent = JSON.stringify(answers);
</script>
"""


USE_THE_CONTROLS = """
<pre id="answer"></pre><script>
function after(key, what) {
  document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  return what();
}
function pointer(type, x) {
  canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX: x, clientY: 9, buttons: 1 }));
}
canvas.setPointerCapture = () => {};
const seconds_shown = () => +state.time.toFixed(6), before = { ...camera };
const answer = { space: [state.playing, after(" ", () => state.playing), element("play").getAttribute("aria-label")] };
set_playing(false);
go_to(1);
last_clock = 2000;
state.playing = true;
advance(960);
answer.late_frame = seconds_shown();
state.playing = false;
answer.frames = [".", ",", "Home", "End"].map(key => after(key, seconds_shown));
Object.assign(element("slider"), { value: 0.5 }).dispatchEvent(new Event("input"));
answer.slider = seconds_shown();
answer.lattice = [after("l", () => state.lattice), element("lattice").getAttribute("aria-pressed")];
element("lattice").click();
answer.lattice.push(state.lattice);
set_colour("strain");
answer.contacts = [after("k", () => state.contacts), element("contacts").getAttribute("aria-pressed")];
answer.colours = ["c", "c", "c"].map(key => after(key, () => element("colour").value));
answer.speed = [after("[", () => state.speed), after("]", () => state.speed)];
pointer("pointerdown", 10);
pointer("pointermove", 60);
pointer("pointerup", 60);
answer.dragged = camera.yaw < before.yaw;
canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: -100 }));
answer.zoomed = camera.distance < before.distance;
element("reset").click();
answer.reset = camera.yaw === before.yaw && Math.abs(camera.distance - before.distance) < 1e-9;
document.getElementById("answer").textContent = JSON.stringify(answer);
</script>
"""


def chromium(page, folder, *arguments, without_3d=False):
    flags = [*FLAGS, f"--user-data-dir={folder / 'profile'}", *(["--disable-3d-apis"] if without_3d else [])]
    done = subprocess.run([CHROMIUM, *flags, *arguments, page], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def run_of(page):
    return json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', page.read_text("utf-8"))[1])


def decoded(text, kind, width):
    return np.frombuffer(base64.b64decode(text), kind).reshape(-1, width).astype(float)


def test_page_needs_nothing_from_outside(tmp_path):
    page = write_view(made_up_run(), tmp_path / "view.html").read_text("utf-8")
    assert "http:" not in page and "https:" not in page and "{{" not in page
    assert not re.search(r'(src|href)="(?!data:)', page) and not re.search(r"\bimport\b|\bfetch\b|url\(", page)
    assert "default-src 'none'" in page


def test_page_holds_every_frame_relative_to_its_centre(tmp_path):
    result = made_up_run(counts=(3, 4, 2))
    run = run_of(write_view(result, tmp_path / "view.html"))
    held = decoded(run["positions"], "<f4", 3).reshape(41, 2, 4, 3, 3).transpose(0, 3, 2, 1, 4)
    centre = ORIGIN - run["origin"]
    assert run["counts"] == [3, 4, 2] and run["note"] == ""
    assert np.allclose(decoded(run["time"], "<f8", 1)[:, 0], result.time)
    assert np.allclose(held + centre, result.positions, atol=1e-6)


def test_planes_move_with_the_frames(tmp_path):
    run = run_of(write_view(made_up_run(), tmp_path / "view.html"))
    ground, press = (decoded(plane["poses"], "<f4", 9) for plane in run["planes"])
    assert [p["name"] for p in run["planes"]] == ["ground", "press"]
    assert np.ptp(ground, axis=0).max() == 0 and np.allclose(ground[0, 3:6], [0, 0, 1])
    assert np.isclose(np.ptp(press[:, 2]), 0.6, atol=1e-5)


def test_solids_are_held_with_their_triangles_and_poses(tmp_path):
    ball = Sphere(name="ball", radius=0.5, point=(1.0, 0.0, 0.7), velocity=(0.25, 0.0, 0.0))
    crate = Box(name="crate", size=(0.4, 0.6, 1.0), point=(-1.0, 0.0, 0.7))
    run = run_of(write_view(with_solids(made_up_run(), ball, crate), tmp_path / "view.html"))
    assert [each["name"] for each in run["planes"]] == ["ground", "press"] and [each["name"] for each in run["solids"]] == ["ball", "crate"]
    poses, centre = decoded(run["solids"][0]["poses"], "<f4", 9), ORIGIN - run["origin"]
    assert np.allclose(poses[[0, -1], :3] + centre, [[1.0, 0.0, 0.7], [1.5, 0.0, 0.7]], atol=1e-6)
    assert np.allclose(decoded(run["solids"][1]["poses"], "<f4", 9)[0, 3:], [0, 0, 1, 1, 0, 0])
    vertices, triangles = (decoded(run["solids"][1][what], kind, 3) for what, kind in (("vertices", "<f4"), ("triangles", "<u4")))
    assert np.allclose(np.abs(vertices), [0.2, 0.3, 0.5]) and len(triangles) == 12


@needs_browser
@pytest.mark.parametrize("shown", [True, False])
def test_browser_draws_solids(tmp_path, shown):
    ball = Sphere(name="ball", radius=0.5, point=(0.0, -1.0, 0.7))
    result = replace(made_up_run(), inputs={}, parameters={})
    page, shot = write_view(with_solids(result, ball), tmp_path / "view.html"), tmp_path / "shot.png"
    if not shown:
        page.write_text(page.read_text("utf-8").replace("obstacles: true", "obstacles: false"), "utf-8")
    chromium(f"file://{page}#t=1.2", tmp_path, f"--screenshot={shot}")
    red, green, blue = np.moveaxis(np.asarray(Image.open(shot).convert("RGB"))[80:450, 50:620] / 255.0, 2, 0)
    grey = (red > 0.3) & (red < 0.75) & (np.abs(blue - red) < 0.12) & (np.abs(green - red) < 0.08)
    assert (grey.sum() > 8000) == shown


def test_readout_has_reactions_with_their_vectors_and_energies(tmp_path):
    rows = {row["label"]: row for row in run_of(write_view(made_up_run(), tmp_path / "view.html"))["rows"]}
    assert list(rows) == ["ground", "press", "kinetic", "elastic"]
    assert np.isclose(decoded(rows["ground"]["values"], "<f4", 1).max(), 2000)
    assert np.isclose(decoded(rows["ground"]["vectors"], "<f4", 3)[:, 2].min(), -2000)
    assert rows["elastic"]["vectors"] is None and rows["elastic"]["unit"] == "J"


def test_a_page_holds_what_touches_and_the_forces_on_obstacles(tmp_path):
    result = made_up_run()
    run = run_of(write_view(result, tmp_path / "view.html"))
    touch, centre = run["touch"], ORIGIN - run["origin"]
    landed = result.time > 0.8 - 1e-9
    assert set(np.array(touch["counts"])[landed]) == {16} and touch["counts"][0] == 0
    lowest = result.positions[-1, :, :, 0].swapaxes(0, 1).reshape(16, 3)
    assert np.allclose(decoded(touch["places"], "<f4", 3)[-16:] + centre, lowest, atol=1e-6)
    starts, ways = (decoded(touch["arrows"][0][what], "<f4", 3) for what in ("starts", "ways"))
    assert np.allclose(starts + centre, [0.1, 0.05, 0.2], atol=1e-6)
    assert (ways[:, 2] < 0).tolist() == (result.outputs["plane.ground.reaction.z"] < -1e-3).tolist() and not ways[:, :2].any()


@needs_browser
@pytest.mark.parametrize("shown", [True, False])
def test_browser_draws_dots_and_arrows_in_yellow(tmp_path, shown):
    page, shot = write_view(made_up_run(), tmp_path / "view.html"), tmp_path / "shot.png"
    if not shown:
        page.write_text(page.read_text("utf-8").replace("contacts: true", "contacts: false"), "utf-8")
    chromium(f"file://{page}#t=1.2", tmp_path, f"--screenshot={shot}")
    red, green, blue = np.moveaxis(np.asarray(Image.open(shot).convert("RGB"))[80:520, 50:620] / 255.0, 2, 0)
    yellow = np.argwhere((red > 0.9) & (green > 0.75) & (blue < 0.15))
    assert len(yellow) > 600 if shown else len(yellow) == 0
    if shown:  # one arrow goes up from the press, one down from the ground
        assert np.ptp(yellow[:, 0]) > 150


def test_a_long_run_is_thinned_evenly_with_its_ends_and_says_so(tmp_path):
    run = run_of(write_view(made_up_run(counts=(2, 2, 2), frames=2001), tmp_path / "view.html"))
    time = decoded(run["time"], "<f8", 1)[:, 0]
    assert len(time) == 600 and time[0] == 0 and time[-1] == 2
    assert np.diff(time).max() < 0.0041 and np.diff(time).min() > 0.0029
    assert run["note"] == "600 of 2,001 recorded frames are shown"


def test_a_large_lattice_gets_fewer_frames(monkeypatch, tmp_path):
    monkeypatch.setattr(view, "MOST_POINT_BYTES", 12 * 8 * 10)
    assert run_of(write_view(made_up_run(counts=(2, 2, 2)), tmp_path / "v.html"))["note"].startswith("10 of 41")


def test_a_frame_costs_only_its_control_points(tmp_path):
    sizes = [write_view(made_up_run(frames=n), tmp_path / "v.html").stat().st_size for n in (101, 201)]
    assert (sizes[1] - sizes[0]) / 100 < 4 / 3 * (64 * 12 + 2 * 36 + 8 + 6 * 12 + 2 * 2 * 12 + 16 * 12 + 2 * 2 * 27)


def test_a_title_cannot_break_the_page(tmp_path):
    title = 'Soft & "hard" </script><b>{{run}}'
    page = write_view(made_up_run(title=title), tmp_path / "view.html")
    assert run_of(page)["title"] == title
    assert f"<title>{html.escape(title)}</title>" in page.read_text("utf-8")


def test_a_texture_travels_in_the_page_no_larger_than_needed(tmp_path):
    vertices, faces = cage_surface(ORIGIN, SIZE, divisions=2)
    mesh = Mesh(vertices, faces, uv=vertices[:, :2], texture=Image.new("RGB", (3000, 10), (9, 99, 199)))
    run = run_of(write_view(made_up_run(), tmp_path / "view.html", mesh=mesh))
    assert run["pictures"][0].startswith("data:image/png;base64,")
    (tmp_path / "texture.png").write_bytes(base64.b64decode(run["pictures"][0].partition(",")[2]))
    assert Image.open(tmp_path / "texture.png").width == 1024
    places = decoded(run["coordinates"], "<f4", 3) * SIZE + ORIGIN
    assert np.allclose(decoded(run["uv"], "<f4", 2), places[:, :2], atol=1e-6)


@pytest.mark.parametrize(("name", "pictures"), [("kd.obj", 0), ("pictures.obj", 2), ("vertices.glb", 0), ("faces.ply", 0)])
def test_a_page_holds_the_colours_of_the_mesh(name, pictures, tmp_path):
    run = page_of_two_colours(tmp_path, name)[0]
    assert len(run["pictures"]) == pictures
    assert run["parts"] == ([[0, 12], [1, 12]] if pictures else [[-1, 24]])
    tints, faces = decoded(run["tints"], "u1", 4)[:, :3] / 255, decoded(run["triangles"], "<u4", 3).astype(int)
    heights = decoded(run["coordinates"], "<f4", 3)[:, 2]
    upper = heights[faces].mean(axis=1) > 0.5
    wanted = np.ones((24, 3)) if pictures else np.where(upper[:, None], GREEN, RED)
    assert np.allclose(tints[faces], wanted[:, None], atol=0.02)  # a byte of light in glTF
    assert not pictures or (upper == np.repeat([False, True], 12)).all()


def page_of_two_colours(folder, name):
    mesh = load_mesh(two_colours(folder, name))
    origin, size = mesh.bounds[0], np.ptp(mesh.bounds, axis=0)
    result = made_up_run()
    still = replace(result, positions=np.tile(rest_grid((4, 4, 4), origin, size), (len(result.time), 1, 1, 1, 1)))
    page = write_view(still, folder / "view.html", mesh=mesh, origin=origin, size=size)
    return run_of(page), page


def test_colour_scales_end_near_the_largest_value(tmp_path):
    result = made_up_run()
    result.positions[:] = result.positions[0] - [0, 0, 0.8]
    result.positions[20] = (result.positions[0] - ORIGIN) * [1.0, 1.0, 1.5] + ORIGIN
    largest = run_of(write_view(result, tmp_path / "view.html"))["largest"]
    assert np.isclose(largest["strain"], (1.5**2 - 1) / 2, rtol=1e-3)
    assert np.isclose(largest["displacement"], 0.5 * SIZE[2], rtol=1e-3)


def cells_of_page(page):
    return {each["name"]: each | {"values": decoded(each["values"], "u1", 2).reshape(41, 3, 3, 3, 2)} for each in run_of(page)["cells"]}


def test_a_page_holds_stress_and_stretch_of_the_cells(tmp_path):
    result = made_up_run()
    cells = cells_of_page(write_view(result, tmp_path / "view.html"))
    assert list(cells) == ["von_mises", "stretch"]
    low, high = cells["stretch"]["ends"]
    found = low + (high - low) * cells["stretch"]["values"][24, ..., 0].transpose(2, 1, 0) / 255
    wanted = np.sqrt(np.linalg.eigvalsh(2 * result.strain(24) + np.eye(3))[..., -1])
    assert np.abs(found - wanted).max() < 0.6 * (high - low) / 255
    assert cells["von_mises"]["ends"][0] == 0 and cells["von_mises"]["values"][..., 0].max() == 255
    assert not cells["von_mises"]["values"][..., 1].any()


def test_cells_turned_inside_out_are_marked(tmp_path):
    result = made_up_run()
    result.positions[20, 1:, 0, 0] -= [2 * SIZE[0], 0, 0]
    stress = cells_of_page(write_view(result, tmp_path / "view.html"))["von_mises"]["values"]
    assert set(stress[20, ..., 1].ravel()) == {0, 255} and not stress[19, ..., 1].any()


@needs_browser
@pytest.mark.parametrize("folded", [False, True])
def test_browser_colours_the_cells(tmp_path, folded):
    """The share of the scale 1 everywhere: the ramp's dark end; turned inside out: grey."""
    page, shot = write_view(made_up_run(), tmp_path / "view.html"), tmp_path / "shot.png"
    values = base64.b64encode(bytes([0, 255] if folded else [255, 0]) * (41 * 27)).decode()
    text = re.sub(r'("name":"von_mises".*?"values":")[^"]*', lambda match: match[1] + values, page.read_text("utf-8"))
    page.write_text(text.replace("lattice: true", "lattice: false").replace("obstacles: true", "obstacles: false"), "utf-8")
    shown = chromium(f"file://{page}#t=1.2&colour=von_mises", tmp_path, f"--screenshot={shot}", "--dump-dom")
    assert "von Mises stress" in re.search(r'id="quantity">(.*?)<', shown)[1]
    middle = np.asarray(Image.open(shot).convert("RGB"))[285:310, 370:500].reshape(-1, 3) / 255.0
    red, _, blue = np.median(middle, axis=0)
    assert abs(blue - red) < 0.08 if folded else blue - red > 0.2


def test_a_run_without_recorded_positions_is_refused(tmp_path):
    result = made_up_run()
    result.positions[:] = np.nan
    with pytest.raises(SoftffdError, match=r'outputs.positions = "all"'):
        write_view(result, tmp_path / "view.html")
    assert not list(tmp_path.iterdir())


@needs_browser
@pytest.mark.short("counts0-bezier", "counts2-bspline")
@pytest.mark.parametrize(
    ("counts", "basis"), [((4, 4, 4), "bezier"), ((2, 8, 5), "bezier"), ((5, 9, 3), "bspline"), ((32, 6, 12), "bspline")]
)
def test_shader_evaluates_the_volume_its_normals_and_its_strain(tmp_path, counts, basis):
    result = made_up_run(counts=counts)
    result = replace(result, lattice=replace(result.lattice, basis=basis))
    page = write_view(result, tmp_path / "view.html")
    question = ASK_THE_SHADER.replace("TIMES", json.dumps([0.0, 1.2, 1.225]))
    page.write_text(page.read_text("utf-8").replace("</body>", question + "</body>"), "utf-8")
    shown = chromium(f"file://{page}#t=0", tmp_path, "--dump-dom")
    run, answers = run_of(page), json.loads(re.search(r'<pre id="answer">(.*?)</pre>', shown)[1])
    rest = stage_of(result).vertices[split_at_creases(stage_of(result).vertices, stage_of(result).faces)[0]]
    normals = decoded(run["normals"], "<i2", 4)[:, :3] / 32767
    frames = [result.positions[0], result.positions[24], (result.positions[24] + result.positions[25]) / 2]
    for answer, positions in zip(np.reshape(answers, (3, -1, 8)), frames, strict=True):
        place, gradient = volume(rest, positions, basis)
        cofactor = np.linalg.det(gradient)[:, None, None] * np.linalg.inv(gradient).transpose(0, 2, 1)
        green = (np.einsum("vab,vac->vbc", gradient, gradient) - np.eye(3)) / 2
        assert np.allclose(answer[:, :3] - run["origin"] + ORIGIN, place, atol=2e-6)
        assert np.allclose(answer[:, 3:6], np.einsum("vab,vb->va", cofactor, normals), atol=1e-3)
        assert np.allclose(answer[:, 6], np.linalg.norm(place - rest, axis=1), atol=2e-6)
        assert np.allclose(answer[:, 7], np.linalg.norm(green, axis=(1, 2)), atol=1e-4)


def volume(rest, positions, basis):
    """Q (V, 3) and its gradient (V, 3, 3) by central differences; inside, or one-sided at the box's faces."""
    box = {"origin": ORIGIN, "size": SIZE, "basis": basis}
    columns = []
    for axis in np.eye(3):
        ahead, behind = (np.clip(rest + s * 1e-5 * axis, ORIGIN, ORIGIN + SIZE) for s in (1, -1))
        way = ((ahead - behind) @ axis)[:, None]
        columns.append((deform(ahead, positions, **box) - deform(behind, positions, **box)) / way)
    return deform(np.clip(rest, ORIGIN, ORIGIN + SIZE), positions, **box), np.stack(columns, axis=-1)


@needs_browser
def test_browser_shows_object_lattice_and_ground_and_no_error(tmp_path):
    page = write_view(made_up_run(), tmp_path / "view.html")
    shot = tmp_path / "shot.png"
    chromium(f"file://{page}#t=1.2&colour=paint", tmp_path, f"--screenshot={shot}")
    image = np.asarray(Image.open(shot).convert("RGB")) / 255.0
    scene = image[100:500, 50:620]
    blue = (scene[..., 2] - scene[..., 0] > 0.25).mean()
    orange = (scene[..., 0] - scene[..., 2] > 0.4).mean()
    assert 0.05 < blue < 0.6 and 0.002 < orange < 0.2
    assert len(np.unique((scene[300:] * 255).reshape(-1, 3).astype(int), axis=0)) > 200
    lit = chromium(f"file://{page}#t=1.2", tmp_path, "--dump-dom")
    assert re.search(r'id="message"[^>]* hidden', lit) and "1.20" in re.search(r'<b id="now">(.*?)</b>', lit)[1]


@needs_browser
@pytest.mark.parametrize("name", ["kd.obj", "pictures.glb"])
def test_browser_shows_the_colours_of_the_mesh(name, tmp_path):
    shot = tmp_path / "shot.png"
    chromium(f"file://{page_of_two_colours(tmp_path, name)[1]}#t=1", tmp_path, f"--screenshot={shot}")
    red, green, blue = np.moveaxis(np.asarray(Image.open(shot).convert("RGB"))[80:520, :620] / 255.0, 2, 0)
    reddish, greenish = np.argwhere(red > 2 * np.maximum(green, blue)), np.argwhere(green > 1.3 * np.maximum(red, blue))
    assert len(reddish) > 3000 and len(greenish) > 3000
    assert np.median(greenish[:, 0]) < np.median(reddish[:, 0])


@needs_browser
def test_keys_buttons_and_pointers_do_what_they_say(tmp_path):
    page = write_view(made_up_run(), tmp_path / "view.html")
    page.write_text(page.read_text("utf-8").replace("</body>", USE_THE_CONTROLS + "</body>"), "utf-8")
    shown = chromium(f"file://{page}#t=1", tmp_path, "--dump-dom")
    assert json.loads(re.search(r'<pre id="answer">(.*?)</pre>', shown)[1]) == {
        "space": [False, True, "Pause"],
        "late_frame": 1.0,
        "frames": [1.05, 1.0, 0.0, 2.0],
        "slider": 0.5,
        "lattice": [False, "false", True],
        "contacts": [False, "false"],
        "colours": ["von_mises", "stretch", "paint"],
        "speed": [0.5, 1],
        "dragged": True,
        "zoomed": True,
        "reset": True,
    }


@needs_browser
def test_browser_without_webgl_says_what_is_missing(tmp_path):
    page = write_view(made_up_run(), tmp_path / "view.html")
    shown = chromium(f"file://{page}", tmp_path, "--dump-dom", without_3d=True)
    assert "WebGL 2" in re.search(r'id="message"[^>]*>(.*?)</div>', shown, re.S)[1]
    assert not re.search(r'id="message"[^>]* hidden', shown) and re.search(r'id="bar"[^>]* hidden', shown)
