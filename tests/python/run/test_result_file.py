"""The one file of a result: it brings everything back, and nothing else passes for it."""

from dataclasses import fields, replace

import numpy as np
import pytest

from mesh_files import ball
from scenes import box, table_and_press
from softffd import MeshError, Result, SoftffdError, load_scene, package_fmu, save_mesh, simulate
from softffd.cli.command import main

BALL = """
title = "Ball"
[lattice]
points = [3, 3, 3]
margin = 0.1
[mesh]
file = "ball.obj"
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
point = [0.0, 0.0, -2.0]
[experiment]
stop_time = 0.05
"""


@pytest.fixture(scope="module")
def result() -> Result:
    course = {"plane.press.point": (0.0, 0.0, 0.95)}
    return simulate(box(plane=table_and_press(), energy=True, stop_time=0.1), inputs=course, start_values={"mass": 2})


@pytest.fixture
def ball_run(tmp_path) -> Result:
    save_mesh(ball(), tmp_path / "ball.obj")
    (tmp_path / "ball.toml").write_text(BALL)
    return simulate(load_scene(tmp_path / "ball.toml"))


def require_same(one: Result, other: Result) -> None:
    for field in fields(Result):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if field.name in ("outputs", "inputs"):
            assert list(a) == list(b)
            a, b = np.array(list(a.values())), np.array(list(b.values()))
        assert np.array_equal(a, b, equal_nan=True) if isinstance(a, np.ndarray) else a == b, field.name


def test_what_is_saved_comes_back_whole(result, tmp_path):
    assert result.log and result.scene and result.parameters["mass"] == 2
    for path in (tmp_path / "run.npz", tmp_path / "folder"):
        files = result.save(path)
        require_same(result, Result.load(path))
        assert [file.name for file in files] == (["run.npz"] if path.suffix else ["result.npz", "result.csv", "summary.json"])
    assert sorted(file.name for file in tmp_path.iterdir()) == ["folder", "run.npz"]


def test_what_the_command_keeps_is_a_result(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "press", "--stop-time", "0.1", "-o", "out"]) == 0
    loaded = Result.load("out")
    assert loaded.scene == load_scene("press") and loaded.summary["findings"]
    np.testing.assert_array_equal(loaded.positions, simulate(loaded.scene, stop_time=0.1, inputs=loaded.scene.default_inputs).positions)


def test_an_fmu_s_result_has_no_scene_and_keeps_its_names(tmp_path):
    scene = box(fmu={"names": "plain"}, velocities="all", stop_time=0.02)
    run = simulate(package_fmu(scene, tmp_path / "plain.fmu"))
    run.save(tmp_path / "run.npz")
    loaded = Result.load(tmp_path / "run.npz")
    require_same(run, loaded)
    assert loaded.scene is None and loaded.sceneless == "" and loaded.plain_names


def test_outputs_may_be_called_what_the_file_calls_its_own(result, tmp_path):
    named = replace(result, outputs={name: result.time + n for n, name in enumerate(("time", "positions", "header", "file", "a/b"))})
    named.save(tmp_path / "run.npz")
    require_same(named, Result.load(tmp_path / "run.npz"))


def test_the_mesh_is_found_where_it_was_or_beside_the_file(ball_run, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    ball_run.save(elsewhere / "run.npz")
    loaded = Result.load(elsewhere / "run.npz")
    assert loaded.scene == ball_run.scene
    np.testing.assert_array_equal(loaded.deformed(), ball_run.deformed())
    (tmp_path / "ball.obj").rename(elsewhere / "ball.obj")
    np.testing.assert_array_equal(Result.load(elsewhere / "run.npz").deformed(), ball_run.deformed())


@pytest.mark.parametrize("change, why", [(lambda file: file.unlink(), "ball.obj"), (None, "ball.obj is another mesh than at the time")])
def test_without_its_mesh_a_result_says_why_it_has_no_scene(ball_run, tmp_path, change, why):
    ball_run.save(tmp_path / "run.npz")
    if change:
        change(tmp_path / "ball.obj")
    else:
        save_mesh(replace(ball(), vertices=1.001 * ball().vertices), tmp_path / "ball.obj")
    loaded = Result.load(tmp_path / "run.npz")
    assert loaded.scene is None and why in loaded.sceneless and why in repr(loaded)
    with pytest.raises(MeshError, match=r"deformed: wanted a mesh, for .*ball\.obj"):
        loaded.deformed()
    np.testing.assert_array_equal(loaded.deformed(ball()), ball_run.deformed(ball()))


def test_a_damaged_file_is_refused_or_harmless(result, tmp_path):
    path = tmp_path / "run.npz"
    small = simulate(box(points=[2, 2, 2], stop_time=0.02))
    small.save(path)
    whole = path.read_bytes()
    refused = 0
    for place in range(0, len(whole), max(1, len(whole) // 400)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
        try:
            require_same(small, Result.load(path))
        except SoftffdError as error:
            assert "run.npz: " in str(error)
            refused += 1
        path.write_bytes(whole[:place])
        with pytest.raises(SoftffdError, match=r"run\.npz: damaged, or no result that softffd wrote"):
            Result.load(path)
    assert refused > 200


def test_foreign_files_are_refused_by_name(tmp_path):
    np.savez(tmp_path / "other.npz", time=np.arange(3), positions=np.zeros((3, 2, 2, 2, 3)))
    np.save(tmp_path / "one.npy", np.arange(3))
    np.savez(tmp_path / "objects.npz", header=np.array([{}], dtype=object))
    (tmp_path / "text.npz").write_text("time,x\n")
    (tmp_path / "empty.npz").write_bytes(b"")
    for name in ("other.npz", "one.npy", "objects.npz", "text.npz", "empty.npz", "missing.npz", "."):
        with pytest.raises(SoftffdError, match=r"wanted a result that softffd wrote|damaged, or no result that softffd wrote"):
            Result.load(tmp_path / name)


def test_a_later_version_is_named(result, tmp_path, monkeypatch):
    monkeypatch.setattr("softffd.run.result_file.VERSION", 2)
    monkeypatch.setattr("softffd.run.result_file.__version__", "9.9")
    result.save(tmp_path / "run.npz")
    monkeypatch.undo()
    with pytest.raises(SoftffdError, match=r"written by softffd 9\.9, whose results this one"):
        Result.load(tmp_path / "run.npz")


def test_a_file_that_cannot_be_written_leaves_the_one_before(result, tmp_path):
    path = tmp_path / "run.npz"
    result.save(path)
    before = path.read_bytes()
    with pytest.raises(ValueError, match="Object arrays cannot be saved"):
        replace(result, outputs={"bad": np.array([object()])}).save(path)
    assert path.read_bytes() == before and [file.name for file in tmp_path.iterdir()] == ["run.npz"]
    with pytest.raises(SoftffdError, match=r"wanted a folder to write to, but .*run\.npz is a file"):
        result.save(path / "inside.npz")
