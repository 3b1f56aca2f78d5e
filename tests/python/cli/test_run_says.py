"""What `softffd run` says before, during and after a run, and what it leaves alone."""

import json
import os
import subprocess
import sys
import time
import tomllib
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mesh_files import ball as trimesh_ball
from softffd import Result, Simulation, load_scene, save_mesh, simulate
from softffd.cli.command import main
from softffd.cli.keep import RESULTS
from softffd.cli.told import pace
from softffd.embedding import mass
from softffd.errors import FmuError
from softffd.fmu.package import package_fmu, scene_masses
from softffd.fmu.variables import method_value
from softffd.lattice import bounding_box
from softffd.run import progress
from softffd.run.drive import Drive
from softffd.run.findings import findings
from softffd.run.progress import ProgressLine
from softffd.run.simulate import shares
from softffd.scene.new import scene_of_mesh
from softffd.scene.scene import scene_from

PUSHED = """
title = "A box and a plate"
[material]
damping = 0.5
[[plane]]
name = "plate"
point = [0.0, 0.0, 5.0]
normal = [0.0, 0.0, -1.0]
motion = "input"
[[load]]
name = "push"
points = "x+"
[outputs]
energy = true
[experiment]
stop_time = 0.2
"""


@pytest.fixture(autouse=True)
def box(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("box.toml").write_text(PUSHED)
    return tmp_path


def told(capsys, *arguments: str, status: int = 0) -> str:
    assert main(list(arguments)) == status
    said = capsys.readouterr()
    return said.err if status else said.out


def stopped_at(monkeypatch, row: int, error: type[BaseException] = KeyboardInterrupt) -> None:
    """The component's step of this number, from 0, raises."""
    whole = Drive.go_on

    def go_on(many, until):
        whole(many, min(until, row))
        if until > row:
            raise error

    monkeypatch.setattr(Drive, "go_on", go_on)


def test_what_runs_is_said_before_the_first_step(monkeypatch, capsys):
    Path("box.csv").write_text("time,plane.plate.point.z\n0,5\n")
    stopped_at(monkeypatch, 0, FmuError)
    main(["run", "box.toml", "--set", "mass=2"])
    said = capsys.readouterr().out
    assert said.startswith("A box and a plate\n  lattice 4 x 4 x 4 over 1 x 1 x 1 m, mass 2 kg; 9 inputs, ")
    assert "\n  box.csv: drives plane.plate.point.z; plane.plate.velocity.x" in said
    assert "nothing drives load.push.x, " in said and said.endswith("keep their start values\n")


@pytest.mark.parametrize("name", ["plane.plate.point.z", "plane.plate.velocity.z"])
def test_a_start_value_of_what_the_file_drives_is_refused(name, capsys):
    Path("box.csv").write_text("time,plane.plate.point.z\n0,5\n")
    said = told(capsys, "run", "box.toml", "--set", f"{name}=4", status=1)
    assert f"box.csv: {name} comes from here over time" in said and "--no-input" in said
    told(capsys, "run", "box.toml", "--set", "load.push.y=1", "--no-pictures")
    told(capsys, "run", "box.toml", "--set", f"{name}=4", "--no-input", "--no-pictures", "-o", "alone")
    with pytest.raises(FmuError, match=r"inputs: load\.push\.x comes from here"):
        simulate(load_scene("box.toml"), start_values={"load.push": (1, 2, 3)}, inputs=lambda time: {"load.push.x": 0.0})


def test_methods_are_told_with_their_share_and_reason(capsys):
    fall = "gravity = [0, 0, -9.81]\n[[plane]]\nname = 'ground'\n[initial]\noffset = [0, 0, 0.2]\n[experiment]\nstop_time = 0.4\n"
    Path("fall.toml").write_text(f"[environment]\n{fall}")
    said = told(capsys, "run", "fall.toml", "--no-pictures")
    methods = json.loads(Path("softffd-fall/summary.json").read_text())["methods"]
    with Simulation(load_scene("fall.toml"), stop_time=0.4) as sim:
        counted = Counter()
        for _ in range(40):
            sim.step()
            counted[sim.methods()[-1]] += 1
    assert {(row["method"], row["reason"]): row["communication_steps"] for row in methods} == counted and len(counted) > 1
    for row in methods:
        assert row["simulated_s"] == pytest.approx(0.01 * row["communication_steps"])
        assert f"  {row['communication_steps'] / 40:.0%} of it by {row['method']}: {row['reason']}\n" in said
    said = told(capsys, "run", "box.toml", "--set", "solver.method=leapfrog", "--stop-time", "0.02", "--no-pictures")
    assert "\n  all of it by leapfrog: as set" in said


def test_a_component_that_tells_of_no_method_runs_too():
    assert shares([], np.arange(3.0)) == []


@pytest.mark.parametrize(
    ("factor", "words"),
    [(0.055, "18 times slower"), (0.5, "2 times slower"), (1.01, "as fast as"), (0.99, "as fast as"), (1.5, "1.5 times faster"),
     (4321.4, "4321 times faster"), (0.0, "inf times slower")],
)  # fmt: skip
def test_pace_is_faster_or_slower(factor, words):
    assert pace(factor).startswith(words) and pace(factor).endswith(" real time")


def test_nothing_is_said_of_what_did_not_happen(capsys):
    said = told(capsys, "run", "box.toml", "--no-pictures")
    assert "largest deformation" not in said and "reaction" not in said and "energy" not in said
    assert json.loads(Path("softffd-box/summary.json").read_text())["plane.plate.reaction_peak_N"] == 0
    said = told(capsys, "run", "box.toml", "--set", "load.push.x=100", "--overwrite", "--no-pictures")
    assert "largest deformation" in said and "energy balance" in said and "reaction" not in said


@pytest.mark.parametrize("positions", ["none", "z+"])
def test_pictures_of_an_earlier_run_go_where_there_are_none_now(positions):
    save_mesh(trimesh_ball(), "ball.obj")
    Path("meshed.toml").write_text('[mesh]\nfile = "ball.obj"\n[experiment]\nstop_time = 0.02\n')
    assert main(["run", "meshed.toml", "-o", "kept"]) == 0
    kept = Path("kept")
    shown = {"picture.png", "view.html", "deformed.obj"}
    assert {file.name for file in kept.iterdir()} >= shown
    for name in ("deformed.mtl", "deformed.png", "deformed_2.png", "deformed.glb", "mine.png", "deformed.blend"):
        (kept / name).write_text("old")
    Path("meshed.toml").write_text(Path("meshed.toml").read_text() + f'[outputs]\npositions = "{positions}"\n')
    assert main(["run", "meshed.toml", "-o", "kept", "--overwrite"]) == 0
    assert {file.name for file in kept.iterdir()} == {*RESULTS, "mine.png", "deformed.blend"}
    found = json.loads((kept / "summary.json").read_text())["findings"]
    assert [line for line in found if "no pictures" in line]
    assert Result.load(kept).summary["findings"] == found


def test_the_mesh_of_the_run_stays_where_it_is_called_as_its_result_would_be():
    save_mesh(trimesh_ball(), "deformed.obj")
    Path("meshed.toml").write_text('[mesh]\nfile = "deformed.obj"\n[experiment]\nstop_time = 0.02\n[outputs]\npositions = "none"\n')
    for _ in range(2):
        assert main(["run", "meshed.toml", "-o", ".", "--overwrite"]) == 0
    assert Path("deformed.obj").is_file()


@pytest.mark.parametrize("kind", ["obj", "ply", "glb", "stl"])
def test_the_mesh_that_a_run_writes_stands_upright_in_the_next(kind):
    ball = trimesh_ball()
    save_mesh(replace(ball, vertices=ball.vertices * [1.0, 2.0, 3.0]), f"ball.{kind}")
    assert main(["run", f"ball.{kind}", "--up", "z", "--stop-time", "0.1", "-o", "kept", "--no-pictures"]) == 0
    deformed = Result.load("kept").deformed()
    again = scene_from(tomllib.loads(scene_of_mesh(f"kept/deformed.{kind}", folder="kept").text), path="kept/again.toml")
    np.testing.assert_allclose(again.loaded_mesh.bounds, bounding_box(deformed), atol=1e-5)


def test_an_interrupted_run_keeps_what_was_simulated(monkeypatch, capsys):
    whole = simulate(load_scene("box.toml"), start_values={"load.push.x": 3.0})
    stopped_at(monkeypatch, 7)
    said = told(capsys, "run", "box.toml", "--set", "load.push.x=3", status=130)
    assert said == "softffd: interrupted; at 0.07 s of 0.2 s; what was simulated until then is kept in softffd-box\n"
    kept = np.load("softffd-box/result.npz")
    np.testing.assert_array_equal(kept["positions"], whole.positions[:8])
    np.testing.assert_array_equal(kept["time"], whole.time[:8])
    summary = json.loads(Path("softffd-box/summary.json").read_text())
    assert summary["simulated_time_s"] == kept["time"][-1] and summary["communication_steps"] == 7
    assert Path("softffd-box/view.html").is_file()


@pytest.mark.parametrize("drawing", ["plot", "view"])
def test_an_interrupt_while_it_draws_names_what_is_kept(drawing, monkeypatch, capsys):
    def interrupt(*_arguments, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr(Result, drawing, interrupt)
    said = told(capsys, "run", "box.toml", status=130)
    assert said == "softffd: interrupted; what was simulated is kept in softffd-box, but not all that shows it\n"
    assert len(Result.load("softffd-box").time) == 21 and not Path("softffd-box/view.html").exists()


def test_an_interrupted_simulation_hands_over_its_result(monkeypatch):
    stopped_at(monkeypatch, 3)
    with pytest.raises(KeyboardInterrupt) as stopped:
        simulate(load_scene("box.toml"), inputs=lambda time: {"load.push.x": 1 + time})
    result = stopped.value.result
    assert len(result.time) == len(result.positions) == 4
    np.testing.assert_allclose(result.inputs["load.push.x"], 1 + result.time, rtol=1e-15)


def test_results_of_an_earlier_run_stay_unless_asked(capsys):
    told(capsys, "run", "box.toml", "--no-pictures")
    before = Path("softffd-box/result.npz").read_bytes()
    said = told(capsys, "run", "box.toml", "--set", "mass=3", "--no-pictures")
    assert "kept in softffd-box-2: " in said and "softffd-box is there already; --overwrite" in said
    assert Path("softffd-box-2/result.npz").is_file() and Path("softffd-box/result.npz").read_bytes() == before
    said = told(capsys, "run", "box.toml", "--set", "mass=3", "-o", "softffd-box", status=1)
    assert "softffd-box/result.npz, softffd-box/result.csv, softffd-box/summary.json: there already" in said and "--overwrite" in said
    assert Path("softffd-box/result.npz").read_bytes() == before
    told(capsys, "run", "box.toml", "--set", "load.push.x=3", "--overwrite", "--no-pictures")
    assert Path("softffd-box/result.npz").read_bytes() != before


def test_stiffness_is_that_of_all_springs_and_vectors_have_commas():
    values = {"stiffness": "1e4", "gravity": "0, 0, -2"}
    scene = load_scene("box.toml").replace({"environment.gravity": [0, 0, -1]})
    parameters = simulate(scene, stop_time=0.01, start_values=values).parameters
    assert [parameters[f"stiffness.{kind}"] for kind in ("edge", "face", "body")] == [1e4] * 3
    assert parameters["gravity.z"] == -2
    with pytest.raises(FmuError, match="gravity: wanted 3 numbers"):
        simulate(scene, start_values={"gravity": "123"})  # not 1, 2 and 3


def test_every_stage_of_a_run_is_shown_where_somebody_looks(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    assert main(["run", "box.toml"]) == 0
    shown = capsys.readouterr().err
    stages = ["packaging", "simulating", "writing the numbers", "drawing picture.png", "writing view.html"]
    assert sorted(stages, key=shown.index) == stages


@pytest.mark.parametrize(
    "stage, command", [("packaging", "build box.toml"), ("packaging", "info box.toml"), ("reading the mesh", "new cut --mesh flat.obj")]
)
def test_other_commands_that_may_take_minutes_show_what_they_do(stage, command, monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    Path("flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    assert main(command.split()) == 0
    assert f"{stage}: ..." in capsys.readouterr().err


def test_the_masses_of_a_mesh_are_worked_out_once(monkeypatch):
    worked = []
    monkeypatch.setattr(mass, "_shares", lambda *given, real=mass._shares: worked.append(0) or real(*given))
    scene = load_scene("car_drop")
    package_fmu(scene, "car.fmu")
    simulate(scene, stop_time=scene.experiment.communication_step)
    assert scene_masses(scene).mass.sum() == pytest.approx(scene.mass.total, rel=1e-12) and len(worked) == 1
    heavier = scene.replace({"mass.total": 2 * scene.mass.total})
    assert scene_masses(heavier).mass.sum() == pytest.approx(heavier.mass.total, rel=1e-12) and len(worked) == 2


def test_a_stage_without_news_tells_how_long_it_takes(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr("softffd.run.progress.QUIET", 0.02)
    with ProgressLine("drawing") as progress:
        for _ in range(200):
            progress._over.wait(0.01)
            if "drawing: ... (0 s so far)" in (shown := capsys.readouterr().err):
                break
    assert "so far" in shown


def test_a_title_that_the_output_cannot_say_is_said_as_far_as_it_can(tmp_path):
    (tmp_path / "u.toml").write_text('title = "a \u2192 b"\n', encoding="utf-8")
    command, cp1252 = [sys.executable, "-m", "softffd", "info", "u.toml"], os.environ | {"PYTHONIOENCODING": "cp1252"}
    said = subprocess.run(command, cwd=tmp_path, env=cp1252, capture_output=True)
    assert (said.returncode, said.stdout.splitlines()[0]) == (0, b"a ? b"), said.stderr


@pytest.mark.skipif(not Path("/dev/fd").is_dir(), reason="no pipes with names")
def test_inputs_may_come_through_a_pipe():
    reading, writing = os.pipe()
    os.write(writing, b"time,plane.plate.point.z\n0,4\n")
    os.close(writing)
    assert main(["run", "box.toml", "--input", f"/dev/fd/{reading}", "--no-pictures", "-o", "kept"]) == 0
    os.close(reading)
    assert Result.load("kept").inputs["plane.plate.point.z"][0] == 4.0


def test_method_and_tolerance_are_those_asked_for(tmp_path, capsys):
    options = ["--stop-time", "0.02", "--method", "leapfrog", "--tolerance", "1e-2", "--no-pictures", "-o", str(tmp_path)]
    assert main(["run", "hanging", *options]) == 0, capsys.readouterr().err
    assert Result.load(tmp_path).parameters["solver.method"] == method_value("leapfrog")


def test_a_slow_run_is_told_what_makes_it_slow():
    result = simulate(load_scene("hanging"), stop_time=0.02)
    slow = replace(result, summary=result.summary | {"real_time_factor": 1e-3})
    said = [line for line in findings(slow)["findings"] if line.startswith("slower than a hundredth of real time")]
    assert len(said) == 1 and "to try: a larger tolerance (--tolerance, now" in said[0] and "a coarser lattice (now" in said[0]
    assert not any("hundredth" in line for line in findings(replace(result, summary=result.summary | {"real_time_factor": 1}))["findings"])


def test_long_runs_tell_how_far_they_are(monkeypatch, capsys):
    monkeypatch.setattr(progress, "QUIET", 0.02)
    monkeypatch.setattr(progress, "NOW_AND_THEN", 0.01)
    with progress.ProgressLine("simulating") as line:
        time.sleep(0.05)
        line(0.5, 1.25)
        time.sleep(0.1)
    assert "simulating: 50%, 1.25 s, 0 s left (0 s so far)" in capsys.readouterr().err
