"""The live page: what it holds, and that a recording of what a hand did runs natively to the same bits."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from pages import assert_shown, in_node, live_of, parts_by_name, whole_run_of
from scenes import box
from softffd import save_mesh, simulate
from softffd.cli.command import main
from softffd.cli.keep import run_scene_or_fmu
from softffd.mesh.mesh import Mesh
from softffd.run.findings import reactions
from softffd.show.live.described import Described
from softffd.show.live.page import live_page as page_text
from softffd.show.live.scene import is_recording, live_scene
from softffd.show.skin import cage_surface
from softffd.show.stage import stage_of


def session(live: dict, part: str, target: list[float], slider: int, corner: int) -> list[dict]:
    """Moves a part, pulls at a control point, changes a parameter at the start and on the way, saves and restores; then the recording."""
    starts = [each["start"] for each in live["open"]["parameters"]]
    stiffer, softer = [*starts], [*starts]
    stiffer[slider] *= 2
    softer[slider] /= 2
    hand = {"part": parts_by_name(live)[part], "target": target}
    most, size = live["pull"]["most"] / 20, live["open"]["most_speed"] / 3
    pull = {"weights": [[corner, 0.75], [corner + 1, 0.25]], "stiffness": 10 * most / size, "damping": 0.0, "most": most}
    pull["target"] = [x + 0.3 * size for x in live["open"]["centre"]]
    long = {"budget": 1e9}
    return [
        {"set": stiffer}, {"run": 0.05, "hand": hand, **long}, {"set": softer}, {"run": 0.1, "hand": hand, **long}, {"save": True},
        {"run": 0.15, "hand": None, **long}, {"set": starts}, {"run": 0.2, "hand": pull, **long}, {"restore": True},
        {"run": 0.15, "hand": pull, **long}, {"run": 0.2, "hand": None, **long}, {"recording": True},
    ]  # fmt: skip


@pytest.mark.full
def test_a_refused_step_leaves_all_as_it_was_and_the_run_goes_on(tmp_path, live_page):
    page = live_page("bumper")  # whose plate may not go through the pin behind it
    live = live_of(page)
    hand = {"part": parts_by_name(live)["plate"], "target": [0.05, 0.05, -0.02]}
    run = {"hand": None, "budget": 1e9}
    again = {"again": [each["start"] for each in live["open"]["parameters"]]}
    messages = [{"run": 0.02, **run}, {"run": 1, "hand": hand, "budget": 1e9}, {"run": 0.04, **run}, again, {"run": 0.04, **run}]
    before, refused, after, begun, same = in_node(page, messages, tmp_path)[1:]
    assert "a control point of pin." in refused["refused"]
    assert [each["frame"] for each in (before, refused, after, begun, same)] == [0.02, 0.02, 0.04, 0, 0.04]
    assert after["points"] == same["points"] and after["outputs"] == same["outputs"]


@pytest.mark.short("press")
@pytest.mark.parametrize("name", ["press", "car_ball", "hanging", "bumper", "car_drop"])
def test_a_recording_runs_natively_to_the_same_bits(tmp_path, live_page, name):
    page = live_page(name)
    live = live_of(page)
    parts = live["open"]["parts"]
    part = {"press": "press", "car_ball": "ball"}.get(name, parts[-1]["label"])
    target = np.array(parts[parts_by_name(live)[part]]["point"]) - 0.05 * live["open"]["most_speed"] / 3
    answers = in_node(page, session(live, part, target.tolist(), 0, 21), tmp_path)
    recording = tmp_path / "recording.csv"
    recording.write_text(answers[-1]["recording"])
    last = answers[-2]
    result = run_scene_or_fmu(name, inputs=recording)
    assert is_recording(recording) and result.time[-1] == last["frame"]
    assert_shown(result, last["points"], live["open"]["centre"])
    for row in (row for row in whole_run_of(page)["rows"] if row["kind"] == "reaction"):
        force = next(force for found, force in reactions(result).items() if found.name == row["label"])
        assert [last["outputs"][n] for n in row["at"]] == force[-1].tolist()
    assert any(values.any() for key, values in result.inputs.items() if key.startswith("force"))


LED = {
    "gravity": [0, 0, -9.81],
    "plane": [{"name": "ground", "point": [0, 0, -0.01]}, {"name": "lid", "point": [0, 0, 1.05], "normal": [0.1, 0, -1]}],
    "box": [{"name": "crate", "size": [0.4, 0.5, 0.6], "point": [1.3, 0.5, 0.5], "rotation": {"axis": [0, 1, 0], "degrees": 20}}],
    "cylinder": [{"name": "roll", "radius": 0.1, "length": 2.0, "point": [-0.2, 0.5, 0.5], "normal": [0, 1, 0]}],
    "sphere": [{"name": "ball", "radius": 0.2, "point": [0.5, -0.3, 0.5]}],
    "pin": [{"name": "base", "points": [[0, 0, 0], [1, 0, 0]]}],
    "load": [{"name": "push", "points": "x+"}],
}


@pytest.mark.full
def test_turns_and_loads_by_hand_run_natively_to_the_same_bits(tmp_path, live_page):
    """Every kind of obstacle and a pin, about an axis that is none of the world's, saved and restored on the way."""
    save_mesh(Mesh(*cage_surface([0.02] * 3, [0.96] * 3, divisions=6)), tmp_path / "cube.obj")
    scene = box(**LED, mesh={"file": tmp_path / "cube.obj"}, contact={"of": "surface"})
    page = live_page(scene)
    live = live_of(page)
    parts, long = parts_by_name(live), {"budget": 1e9}
    assert {part["label"]: part["turns"] for part in live["open"]["parts"]} == {
        "ground": "normal", "lid": "normal", "ball": None, "roll": "normal", "crate": "rotation", "base": "orientation"
    }  # fmt: skip
    turn = [np.cos(0.1), *(np.sin(0.1) * np.array([2, 3, 6]) / 7)]
    messages, end = [], 0.0
    for name in ("lid", "roll", "crate", "base", "ball"):
        part, end = parts[name], end + 0.05
        point = (np.array(live["open"]["parts"][part]["point"]) + 0.01).tolist()
        messages += [{"run": end, "hand": {"part": part, "target": point, "turn": turn}, "loads": [[3.0 * end, 0.0, -1.0]], **long}]
        messages += [{"save": True}] if name == "roll" else [{"run": end + 0.01, "hand": None, **long}]
        end = messages[-1].get("run", end)
    *_, last, recorded = in_node(page, [*messages, {"restore": True}, *messages[3:], {"recording": True}], tmp_path)
    way, whole = np.array(last["turns"][parts["crate"]][1:]), np.array(turn[1:])
    assert np.allclose(np.cross(way, whole), 0, atol=1e-12) and 0.5 < np.linalg.norm(way) / np.linalg.norm(whole) <= 1
    assert last["turns"][parts["ball"]] == [1, 0, 0, 0]
    (tmp_path / "recording.csv").write_text(recorded["recording"])
    result = simulate(live_scene(scene), inputs=tmp_path / "recording.csv", stop_time=last["frame"], open_end=True)
    assert_shown(result, last["points"], live["open"]["centre"])
    assert result.inputs["load.push.x"].max() > 0.5 and abs(result.inputs["box.crate.rotation.z"]).max() > 0.05
    assert not result.summary["warnings"]


def test_a_page_of_ten_thousand_triangles_is_below_two_megabytes(tmp_path):
    """Whatever the library is: this one packs into as much as the built one."""
    sphere = trimesh.creation.uv_sphere(count=[51, 51])
    assert len(sphere.faces) > 10_000
    save_mesh(Mesh(sphere.vertices, sphere.faces), tmp_path / "ball.obj")
    ground = {"plane": [{"name": "ground", "point": [0, 0, -1]}], "gravity": [0, 0, -9.81]}
    scene = box(mesh={"file": tmp_path / "ball.obj"}, contact={"of": "surface"}, **ground)
    noise = np.random.default_rng(0).bytes(600_000)
    page = page_text(scene, simulate(scene.replace({"outputs.positions": "all"}), stop_time=0.01), noise)
    assert len(page.encode()) < 2e6


def test_a_live_scene_moves_by_hand_what_does_not_turn():
    planes = [
        {"name": "belt", "velocity": [1.0, 0.0, 0.0]},
        {"name": "press", "point": [0, 0, 2], "normal": [0, 0, -1], "velocity": [0, 0, -1], "motion": "input"},
        {"name": "drum", "point": [0, 0, -1], "angular_velocity": [1.0, 0.0, 0.0]},
    ]
    scene = live_scene(box(plane=planes, pin=[{"name": "base", "points": "z-"}], communication_step=1e-3))
    belt, press, drum = scene.plane
    assert (belt.motion, press.motion, drum.motion, scene.pin[0].motion) == ("input", "input", "fixed", "input")
    assert belt.velocity == (1.0, 0.0, 0.0) and press.velocity == (0.0, 0.0, 0.0)
    assert scene.experiment.communication_step == 1e-3 and live_scene("press").experiment.communication_step == 1 / 480


def test_a_slider_has_a_range_for_each_parameter():
    body = {"stiffness": {"edge": 400.0, "face": 100.0, "body": 0.0}, "damping": 0.5, "internal_damping": 1e-3}
    scene = live_scene(box(material=body, gravity=[0, 0, 0], plane=[{"name": "ground", "friction": 0.0}]))
    run = simulate(scene, stop_time=0.01)
    sliders = {each["label"]: each for each in Described(scene, stage_of(run)).sliders()}
    assert list(sliders) == ["stiffness", "damping", "internal damping", "gravity", "ground friction"]
    assert (sliders["stiffness"]["low"], sliders["stiffness"]["high"], sliders["stiffness"]["factors"]) == (40.0, 4000.0, [1.0, 0.25, 0.0])
    assert sliders["gravity"]["high"] > 19 and sliders["gravity"]["factors"] == [0.0, 0.0, -1.0]
    assert (sliders["ground friction"]["low"], sliders["ground friction"]["high"]) == (0.0, 1.0)


def test_a_page_needs_the_library_for_web_pages_and_a_new_name(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("softffd.installed.WASM", "nowhere")
    assert main(["live", "press"]) == 1
    said = capsys.readouterr().err
    assert "python3 python/run.py wasm" in said and "wheel" in said and not list(tmp_path.iterdir())
    Path("live.html").write_text("mine")
    assert main(["live", "press"]) == 1 and "--overwrite" in capsys.readouterr().err
    assert Path("live.html").read_text() == "mine"


def test_only_a_file_that_says_so_is_a_recording(tmp_path):
    table = tmp_path / "table.csv"
    table.write_text("time,plane.press.point.z\n0,1.05\n1,1.0\n")
    assert not is_recording(table) and not is_recording(tmp_path / "nowhere.csv")
    table.write_text("# recorded by softffd live: a box\n" + table.read_text())
    assert is_recording(table)
    result = run_scene_or_fmu("press", inputs=table, stop_time=0.05)
    assert result.summary["communication_steps"] == 24 and "force[0,0,0].x" in result.inputs
