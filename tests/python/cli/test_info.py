"""`softffd info` of scenes and FMUs."""

from pathlib import Path

import pytest

from softffd import load_scene, simulate
from softffd.cli.command import main
from validation import shapes as bodies

HELD = """
title = "Held at two ends"
[lattice]
size = [2.0, 1.0, 1.0]
[mass]
total = 3.0
[inputs]
forces = [[1, 1, 1], [2, 1, 1]]
[[pin]]
name = "base"
points = "x-"
[[pin]]
name = "hand"
points = [[3, 0, 0], [3, 3, 0]]
motion = "input"
[[plane]]
name = "ground"
point = [0.0, 0.0, -0.25]
"""


def info(capsys, *arguments: str) -> list[str]:
    capsys.readouterr()
    assert main(["info", *arguments]) == 0
    return capsys.readouterr().out.splitlines()


@pytest.fixture(autouse=True)
def held(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("held.toml").write_text(HELD)


@pytest.mark.parametrize("names", ["structured", "flat"])
@pytest.mark.parametrize("fmi", ["2", "3"])
def test_an_fmu_is_told_like_its_scene(fmi, names, capsys):
    Path("held.toml").write_text(f'{HELD}[fmu]\nnames = "{names}"\n')
    assert main(["build", "held.toml", "--fmi", fmi]) == 0
    for every in ([], ["--all"]):
        assert info(capsys, "held.fmu", *every) == info(capsys, "held.toml", *every)


def test_variables_have_causality_unit_and_start(capsys):
    rows = [line.split() for line in info(capsys, "held.toml", "--all")]
    assert ["plane.ground.point.z", "parameter", "fixed", "m", "-0.25"] in rows
    assert ["pin.hand.position.x", "input", "continuous", "m", "2"] in rows
    assert ["solver.method", "parameter", "fixed", "auto"] in rows
    assert ["force[2,1,1].y", "input", "continuous", "N", "0"] in rows
    result = simulate(load_scene("held.toml"), stop_time=0.01)
    listed = {row[0] for row in rows if row}
    assert listed >= {*result.inputs, *result.parameters, *result.outputs}


def test_control_points_take_one_line_unless_all_are_asked_for_and_the_frames_of_pins_are_told(capsys):
    lines = info(capsys, "held.toml")
    assert any(line.startswith("position[i,j,k] .x .y .z (64 control points)  output") for line in lines)
    assert any(line.startswith("force[i,j,k] .x .y .z (2 control points)") for line in lines)
    assert len(lines) < 70  # 251 variables
    assert "  pin base, fixed: the frame at rest is at (0, 0.5, 0.5) m with the world's axes; it holds 16 points" in lines
    assert "  pin hand, moved by its inputs: the frame at rest is at (2, 0.5, 0) m with the world's axes; it holds 2 points" in lines


@pytest.mark.parametrize("fmi", ["2", "3"])
def test_a_body_s_inertia_and_the_points_that_obstacles_meet_are_told_of_scenes_and_of_fmus(fmi, capsys, monkeypatch):
    shape = bodies.sphere(3)
    Path("ball.toml").write_text(
        f'[mesh]\nfile = "{bodies.write(Path("ball.obj"), shape)}"\n[mass]\ndistribution = "volume"\n'
        '[contact]\nof = "surface"\npenetration = 1e-2\n[[plane]]\nname = "ground"\n'
    )
    monkeypatch.setattr("softffd.embedding.samples.MOST", 500)
    assert main(["build", "ball.toml", "--fmi", fmi]) == 0
    built = capsys.readouterr().out.splitlines()
    notes = [line for line in built if "inertia" in line or "vertices" in line or "fills" in line]
    assert "the mesh fills 52 % of its box; the elastic body is the whole box" in notes[0]
    assert "lumped masses have 2.38 times the inertia of the mesh (volume)" in notes[1]
    assert "of 642 vertices; the others penetrate by at most" in notes[2] and "% of the lattice's height" in notes[2]
    for what in ("ball.toml", "ball.fmu"):
        assert info(capsys, what)[3:6] == notes
