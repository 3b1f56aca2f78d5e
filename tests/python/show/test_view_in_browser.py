import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from scipy.spatial import cKDTree

from browser import showing
from made_up_run import ORIGIN, SIZE, made_up_run, with_solids
from pages import page_of_two_colours, run_of
from softffd.embedding.basis import parameter
from softffd.embedding.deform import deform
from softffd.scene.rigid import Sphere
from softffd.show.stage import stage_of
from softffd.show.view import write_view

ASK_THE_SHADER = """(() => {
const [body] = bodies, asked = gl.createProgram(), outputs = ["world", "shading", "displacement", "strain"];
gl.attachShader(asked, shader(gl.VERTEX_SHADER, body.heading + SOURCES.volume + SOURCES["object-vertex"]));
gl.attachShader(asked, shader(gl.FRAGMENT_SHADER, "#version 300 es" + SOURCES["object-fragment"]));
gl.transformFeedbackVaryings(asked, outputs, gl.INTERLEAVED_ATTRIBS);
gl.linkProgram(asked);
gl.useProgram(asked);
gl.uniform3fv(gl.getUniformLocation(asked, "origin"), body.origin);
gl.uniform3fv(gl.getUniformLocation(asked, "size"), body.size);
gl.uniform1i(gl.getUniformLocation(asked, "cells"), 3);
const count = body.surface.coordinates.length / 3, found = new Float32Array(8 * count), answers = [];
const target = gl.createBuffer();
gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, target);
gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, found.byteLength, gl.DYNAMIC_READ);
gl.bindVertexArray(body.object.array);
for (const time of TIMES) {
  state.time = time;
  load_points(body);
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, target);
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.beginTransformFeedback(gl.POINTS);
  gl.drawArrays(gl.POINTS, 0, count);
  gl.endTransformFeedback();
  gl.disable(gl.RASTERIZER_DISCARD);
  gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, found);
  answers.push(Array.from(found));
}
return answers;
})()"""


USE_THE_CONTROLS = """(() => {
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
return answer;
})()"""


DRAWN = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))"


def colours(browser, folder, rows=slice(None), columns=slice(0, 620)):
    """Red, green and blue of what the page shows there."""
    browser.ask(DRAWN)
    browser.shot(folder / "shot.png")
    return np.moveaxis(np.asarray(Image.open(folder / "shot.png").convert("RGB"))[rows, columns] / 255.0, 2, 0)


def test_browser_draws_solids_until_obstacles_are_hidden(tmp_path):
    ball = Sphere(name="ball", radius=0.5, point=(0.0, -1.0, 0.7))
    result = replace(made_up_run(), inputs={}, parameters={})
    with showing(write_view(with_solids(result, ball), tmp_path / "view.html"), hash="#t=1.2") as browser:
        for shown in (True, False):
            red, green, blue = colours(browser, tmp_path, slice(80, 450), slice(50, 620))
            grey = (red > 0.3) & (red < 0.75) & (np.abs(blue - red) < 0.12) & (np.abs(green - red) < 0.08)
            assert (grey.sum() > 8000) == shown
            browser.ask("toggle('obstacles')")


def test_browser_shows_object_lattice_and_ground_and_yellow_dots_and_arrows_until_contacts_are_hidden(tmp_path):
    with showing(write_view(made_up_run(), tmp_path / "view.html"), hash="#t=1.2&colour=paint") as browser:
        red, green, blue = colours(browser, tmp_path)
        scene = np.s_[100:500, 50:620]
        assert 0.05 < (blue - red > 0.25)[scene].mean() < 0.6 and 0.002 < (red - blue > 0.4)[scene].mean() < 0.2
        ground = (np.stack([red, green, blue], axis=-1)[300:500, 50:620] * 255).reshape(-1, 3).astype(int)
        assert len(np.unique(ground, axis=0)) > 200
        assert browser.ask("element('message').hidden") and "1.20" in browser.ask("element('now').textContent")
        for shown in (True, False):
            browser.ask("set_colour('strain')")
            red, green, blue = colours(browser, tmp_path, slice(80, 520), slice(50, 620))
            yellow = np.argwhere((red > 0.9) & (green > 0.75) & (blue < 0.15))
            assert len(yellow) > 600 if shown else len(yellow) == 0
            if shown:  # one arrow goes up from the press, one down from the ground
                assert np.ptp(yellow[:, 0]) > 150
            browser.ask("toggle('contacts')")


def test_browser_draws_short_arrows_short(tmp_path):
    with showing(write_view(made_up_run(), tmp_path / "view.html"), hash="#t=1.2&colour=strain") as browser:
        heights = []
        for length in (1.0, 0.1):
            arrow = f"{{ places: new Float32Array(), arrows: [[[0, 0, 0], [0, 0, {length}]]] }}"
            browser.ask(f"source.touch = () => ({arrow}), toggle('lattice')")
            red, green, blue = colours(browser, tmp_path, slice(80, 520), slice(50, 620))
            heights.append(np.ptp(np.argwhere((red > 0.8) & (green > 0.65) & (blue < 0.3))[:, 0]))
        assert 0 < heights[1] < 0.2 * heights[0]


@pytest.mark.short("True")
@pytest.mark.parametrize("folded", [False, True])
def test_browser_colours_the_cells(tmp_path, folded):
    """The share of the scale 1 everywhere: the ramp's dark end; turned inside out: grey."""
    page = write_view(made_up_run(), tmp_path / "view.html")
    values = base64.b64encode(bytes([0, 255] if folded else [255, 0]) * (41 * 27)).decode()
    text = re.sub(r'("positions":"[^"]*","cells":\[")[^"]*', lambda match: match[1] + values, page.read_text("utf-8"))
    page.write_text(text.replace("lattice: CAGES", "lattice: false").replace("obstacles: true", "obstacles: false"), "utf-8")
    with showing(page, hash="#t=1.2&colour=von_mises") as browser:
        assert "von Mises stress" in browser.ask("element('quantity').textContent")
        red, _, blue = np.median(colours(browser, tmp_path, slice(335, 350), slice(240, 300)), axis=(1, 2))
        assert abs(blue - red) < 0.08 if folded else blue - red > 0.2


@pytest.mark.short("counts2-bspline")
@pytest.mark.parametrize(
    ("counts", "basis"),
    [((4, 4, 4), "bezier"), ((2, 8, 5), "bezier"), ((5, 9, 3), "bspline"), ((32, 6, 12), "bspline"), ((7, 10, 4), "patches")],
)
def test_shader_evaluates_the_volume_its_normals_and_its_strain(tmp_path, counts, basis):
    result = made_up_run(counts=counts)
    result = replace(result, lattice=replace(result.lattice, basis=basis))
    page = write_view(result, tmp_path / "view.html")
    with showing(page, hash="#t=0") as browser:
        answers = browser.ask(ASK_THE_SHADER.replace("TIMES", json.dumps([0.0, 1.2, 1.225])))
    run = run_of(page)
    rest, normals = places_at_rest(result, run["coordinates"]), run["normals"]
    smooth = np.ones(len(rest), bool) if basis != "patches" else apart_from_joints(rest, counts)
    frames = [result.positions[0], result.positions[24], (result.positions[24] + result.positions[25]) / 2]
    for answer, positions in zip(np.reshape(answers, (3, -1, 8)), frames, strict=True):
        place, gradient = volume(rest, positions, basis)
        cofactor = np.linalg.det(gradient)[:, None, None] * np.linalg.inv(gradient).transpose(0, 2, 1)
        green = (np.einsum("vab,vac->vbc", gradient, gradient) - np.eye(3)) / 2
        assert np.allclose(answer[:, :3] - run["origin"] + ORIGIN, place, atol=4e-6)
        assert np.allclose(answer[smooth, 3:6], np.einsum("vab,vb->va", cofactor, normals)[smooth], atol=1e-3)
        assert np.allclose(answer[:, 6], np.linalg.norm(place - rest, axis=1), atol=4e-6)
        assert np.allclose(answer[smooth, 7], np.linalg.norm(green, axis=(1, 2))[smooth], atol=1e-4)


def places_at_rest(result, coordinates):
    """The page's vertices (W, 3) [m], which are rounded to 20 bits, from their parameters: the nearest of the stage's own."""
    stage = stage_of(result)
    places = zip(((stage.vertices - stage.origin) / stage.size).T, stage.counts, strict=True)
    own = np.stack([parameter(t, n, stage.basis) for t, n in places], axis=1)
    apart, nearest = cKDTree(own).query(coordinates)
    assert apart.max() < np.linalg.norm(np.ptp(own, axis=0)) / 2**20
    return stage.vertices[nearest]


def apart_from_joints(rest, counts):
    """Which places are not where patches meet: there differences take both sides."""
    place = (rest - ORIGIN) / SIZE * (np.array(counts) // 3)
    return ((np.abs(place - place.round()) > 1e-3) | (place < 0.5) | (place > np.array(counts) // 3 - 0.5)).all(axis=1)


def volume(rest, positions, basis):
    """Q (V, 3) and its gradient (V, 3, 3) by central differences; inside, or one-sided at the box's faces."""
    box = {"origin": ORIGIN, "size": SIZE, "basis": basis}
    columns = []
    for axis in np.eye(3):
        ahead, behind = (np.clip(rest + s * 1e-5 * axis, ORIGIN, ORIGIN + SIZE) for s in (1, -1))
        way = ((ahead - behind) @ axis)[:, None]
        columns.append((deform(ahead, positions, **box) - deform(behind, positions, **box)) / way)
    return deform(np.clip(rest, ORIGIN, ORIGIN + SIZE), positions, **box), np.stack(columns, axis=-1)


@pytest.mark.short("pictures.glb")
@pytest.mark.parametrize("name", ["kd.obj", "pictures.glb"])
def test_browser_shows_the_colours_of_the_mesh(name, tmp_path):
    with showing(page_of_two_colours(tmp_path, name)[1], hash="#t=1") as browser:
        red, green, blue = colours(browser, tmp_path, slice(80, 520))
    reddish, greenish = np.argwhere(red > 2 * np.maximum(green, blue)), np.argwhere(green > 1.3 * np.maximum(red, blue))
    assert len(reddish) > 3000 and len(greenish) > 3000
    assert np.median(greenish[:, 0]) < np.median(reddish[:, 0])


def test_keys_buttons_and_pointers_do_what_they_say(tmp_path):
    with showing(write_view(made_up_run(), tmp_path / "view.html"), hash="#t=1") as browser:
        answer = browser.ask(USE_THE_CONTROLS)
    assert answer == {
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


def test_browser_without_webgl_says_what_is_missing(tmp_path):
    page = write_view(made_up_run(), tmp_path / "view.html")
    with showing(page, "--disable-3d-apis", ready="document.readyState === 'complete'") as browser:
        assert "WebGL 2" in browser.ask("document.getElementById('message').textContent")
        assert browser.ask("['message', 'bar'].map(each => document.getElementById(each).hidden)") == [False, True]
