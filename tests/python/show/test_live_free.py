"""Free bodies of a live page: they move by themselves, a hand draws one by a bounded force, and the recording runs to the same bits."""

import numpy as np
import pytest

from browser import LIVE, showing
from pages import in_node, live_of, parts_by_name
from scenes import GRAVITY, meshed
from softffd import simulate
from softffd.show.live.scene import live_scene
from validation import shapes

FREE = {"motion": "free", "mass": 2.0}
PARTS = {
    "sphere": [{"name": "ball", "radius": 0.1, "point": [0.5, 0.5, 1.6], **FREE, "velocity": [0.0, 0.0, 3.0]}],
    "box": [{"name": "crate", "size": [0.3, 0.4, 0.5], "point": [1.4, 0.5, 0.5], **FREE, "angular_velocity": [1.0, 2.0, 3.0]}],
    "plane": [{"name": "floor", "point": [0.0, 0.0, -0.5]}],
}


@pytest.fixture
def scene(tmp_path):
    return meshed(tmp_path, shapes.cube(2, 0.1), **PARTS, gravity=GRAVITY, pin=[{"name": "foot", "points": "z-"}], stop_time=0.1)


def test_a_live_scene_leaves_free_bodies_free(scene):
    parts = {part.name: part.motion for part in (*live_scene(scene).obstacles, *live_scene(scene).pin)}
    assert parts == {"floor": "input", "ball": "free", "crate": "free", "foot": "input"}


def test_a_free_body_is_drawn_by_its_force_and_the_recording_runs_to_the_same_bits(live_page, scene, tmp_path):
    page = live_page(scene)
    live = live_of(page)
    parts, long = parts_by_name(live), {"budget": 1e9}
    ball = live["open"]["parts"][parts["ball"]]
    target = [0.9, 0.5, 1.6]
    held = {"hand": {"part": parts["ball"], "target": target}, **long}
    far = {"hand": {"part": parts["ball"], "target": [1e3, 0.5, 1.6]}, **long}
    free = {"hand": None, **long}
    messages = [{"run": 0.02, **free}, {"save": True}, {"run": 0.6, **held}, {"restore": True}, {"run": 0.6, **held}]
    messages += [{"run": 0.7, **far}, {"recording": True}]
    _, begun, saved, held, back, again, pulled, recorded = in_node(page, messages, tmp_path)
    assert saved["saved"] == back["frame"] == begun["frame"] and held["points"] == again["points"] and held["parts"] == again["parts"]
    assert begun["parts"][parts["ball"]][2] > 1.6 and begun["at"] is None and held["at"] == held["parts"][parts["ball"]]
    assert np.linalg.norm(np.array(held["at"]) - target) < 0.05  # its weight
    (tmp_path / "recording.csv").write_text(recorded["recording"])
    run = simulate(live_scene(scene), inputs=tmp_path / "recording.csv", stop_time=pulled["frame"], open_end=True)
    assert [run.outputs[f"sphere.ball.position.{c}"][-1] for c in "xyz"] == pulled["parts"][parts["ball"]]
    assert [run.outputs[f"box.crate.position.{c}"][-1] for c in "xyz"] == pulled["parts"][parts["crate"]]
    force = np.stack([run.inputs[f"sphere.ball.force.{c}"] for c in "xyz"], axis=1)
    sizes = np.linalg.norm(force, axis=1)
    assert sizes.max() == pytest.approx(ball["most"], rel=1e-12) and not force[0].any()
    turn = pulled["turns"][parts["crate"]]
    assert np.linalg.norm(turn) == pytest.approx(1.0) and abs(turn[0]) < 0.99


@pytest.mark.full
def test_the_mouse_draws_a_free_body_and_does_not_turn_it(live_page, scene):
    page = live_page(scene.replace({"environment.gravity": None, "sphere": None}))
    crate = "live.open.parts.findIndex(part => part.label === 'crate')"
    with showing(page, ready=LIVE) as browser:
        x, y = browser.ask(
            f"(place => [canvas.offsetLeft + place[0] * canvas.clientWidth, canvas.offsetTop + place[1] * canvas.clientHeight])"
            f"(on_pane(camera_matrix(camera_frame()), now.parts[{crate}].map((x, a) => x - centre[a])))"
        )
        browser.drag((x, y), (x, y - 60))
        assert browser.ask(f"hand.part === {crate} && hand.turn === undefined")
        browser.wait_for(f"Math.hypot(...now.parts[{crate}].map((x, a) => x - hand.target[a])) < 0.05 && !!now.at")
        browser.mouse("mouseReleased", x, y - 60)
        assert browser.ask("hand === null")
