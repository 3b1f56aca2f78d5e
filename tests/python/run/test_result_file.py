"""The one file of a result: it brings everything back, and nothing else passes for it."""

import json
import zipfile
from dataclasses import fields, replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest

from mesh_files import ball
from scenes import GRAVITY, box, table_and_press
from softffd import MeshError, Result, SoftffdError, load_scene, package_fmu, save_mesh, simulate
from softffd.cli.command import main
from softffd.scene.scene import scene_from


@pytest.fixture(scope="module")
def result() -> Result:
    course = {"plane.press.point": (0.0, 0.0, 0.95)}
    return simulate(box(plane=table_and_press(), energy=True, stop_time=0.1), inputs=course, start_values={"mass": 2})


@pytest.fixture(scope="module")
def small() -> Result:
    return simulate(box(points=[2, 2, 2], stop_time=0.02))


@pytest.fixture
def ball_run(tmp_path) -> Result:
    save_mesh(ball(), tmp_path / "ball.obj")
    ground = {"plane": [{"name": "ground", "point": [0.0, 0.0, -2.0]}], "environment": {"gravity": GRAVITY}}
    mesh = {"mesh": {"file": "ball.obj"}, "lattice": {"points": [3, 3, 3], "margin": 0.1}}
    return simulate(scene_from({**mesh, **ground, "experiment": {"stop_time": 0.05}}, path=tmp_path / "ball.toml"))


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
        np.testing.assert_array_equal(np.load(files[0])["plane.press.reaction.z"], result.outputs["plane.press.reaction.z"])
        assert [file.name for file in files] == (["run.npz"] if path.suffix else ["result.npz", "result.csv", "summary.json"])
    assert sorted(file.name for file in tmp_path.iterdir()) == ["folder", "run.npz"]


def test_what_the_command_keeps_is_a_result(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "press", "--stop-time", "0.1", "-o", "out", "--no-pictures"]) == 0
    loaded = Result.load("out")
    assert loaded.scene == load_scene("press") and loaded.summary["findings"]
    np.testing.assert_array_equal(loaded.positions, simulate(loaded.scene, stop_time=0.1, inputs=loaded.scene.default_inputs).positions)


def test_an_fmu_s_result_has_no_scene_and_keeps_its_names(tmp_path):
    scene = box(fmu={"names": "flat"}, velocities="all", stop_time=0.02)
    run = simulate(package_fmu(scene, tmp_path / "plain.fmu"))
    run.save(tmp_path / "run.npz")
    loaded = Result.load(tmp_path / "run.npz")
    require_same(run, loaded)
    assert loaded.scene is None and loaded.sceneless == "" and loaded.flat_names


def test_outputs_may_be_called_what_the_file_calls_its_own(result, tmp_path):
    named = replace(result, outputs={name: result.time + n for n, name in enumerate(("time", "positions", "header", "file", "a/b"))})
    named.save(tmp_path / "run.npz")
    require_same(named, Result.load(tmp_path / "run.npz"))


def test_the_mesh_is_found_below_the_folders_of_the_result_and_of_the_user_or_where_he_says(ball_run, tmp_path, monkeypatch):
    kept, mesh = tmp_path / "kept", tmp_path / "ball.obj"
    ball_run.save(tmp_path / "run.npz")
    assert Result.load(tmp_path / "run.npz").scene == ball_run.scene
    ball_run.save(kept / "run.npz")
    np.testing.assert_array_equal(Result.load(kept / "run.npz", mesh=mesh).deformed(), ball_run.deformed())
    with monkeypatch.context() as moved:
        moved.chdir(tmp_path)
        assert Result.load("kept/run.npz").scene == ball_run.scene
    mesh.rename(kept / "ball.obj")
    np.testing.assert_array_equal(Result.load(kept / "run.npz").deformed(), ball_run.deformed())


def test_a_mesh_for_a_run_without_one_is_refused(small, tmp_path):
    small.save(tmp_path / "run.npz")
    with pytest.raises(SoftffdError, match=r"mesh: wanted none for .*run\.npz, whose run has no mesh, got nope\.obj"):
        Result.load(tmp_path / "run.npz", mesh="nope.obj")


def test_a_mesh_in_any_other_place_is_not_looked_at(ball_run, tmp_path, monkeypatch):
    ball_run.save(tmp_path / "kept" / "run.npz")
    asked, is_file = [], Path.is_file
    monkeypatch.setattr(Path, "is_file", lambda path: asked.append(path) or is_file(path))
    monkeypatch.setattr("softffd.mesh.files.load_mesh", lambda file, **_keys: asked.append(file))
    loaded = Result.load(tmp_path / "kept" / "run.npz")
    assert loaded.scene is None and "copy it there, or name it: --mesh FILE, load(..., mesh=FILE)" in loaded.sceneless
    assert tmp_path / "ball.obj" not in asked


def test_the_mesh_of_a_shipped_scene_is_found(tmp_path):
    run = simulate(load_scene("car_drop"), stop_time=0.02)
    run.save(tmp_path / "run.npz")
    assert Result.load(tmp_path / "run.npz").scene == run.scene


@pytest.mark.parametrize(
    "change, why",
    [
        (Path.unlink, "ball.obj"),
        (lambda file: save_mesh(replace(ball(), vertices=1.001 * ball().vertices), file), "ball.obj is another mesh than at the time"),
    ],
)
def test_without_its_mesh_a_result_says_why_it_has_no_scene(ball_run, tmp_path, change, why):
    ball_run.save(tmp_path / "run.npz")
    change(tmp_path / "ball.obj")
    loaded = Result.load(tmp_path / "run.npz")
    assert loaded.scene is None and why in loaded.sceneless and why in repr(loaded)
    with pytest.raises(MeshError, match=r"deformed: wanted a mesh, for .*ball\.obj"):
        loaded.deformed()
    np.testing.assert_array_equal(loaded.deformed(ball()), ball_run.deformed(ball()))


def test_a_damaged_file_is_refused_or_harmless(small, tmp_path):
    path = tmp_path / "run.npz"
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


WRONG = [
    *[{key: None} for key in ("outputs", "inputs", "parameters", "summary", "flat_names", "log")],
    *[{key: 3} for key in ("version", "outputs", "inputs", "parameters", "summary", "lattice", "log", "scene", "obstacles")],
    *[{key: []} for key in ("parameters", "summary", "lattice", "flat_names", "obstacles")],
    {"version": "1", "outputs": {}}, {"version": None, "log": [[1]]}, {"version": 10**400}, {"version": 2, "softffd": ...},
    {"summary": {"warnings": 3}}, {"parameters": {"mass": 10**400}},
    {"outputs": ["time"]}, {"outputs": [["mass"]]}, {"inputs": ["a"] * 99}, {"parameters": {"mass": [1]}}, {"log": [["a", "b", "c"]]},
    {"lattice": {"points": [2, 2]}}, {"lattice": {"points": [2, 2, 3], "origin": [0, 0, 0], "size": [1, 1, 1], "basis": "bezier"}},
    {"lattice": {"points": [2, 2, 2], "origin": [0, 0, 0], "size": [1, 1, 1], "basis": "bezir"}},
    {"lattice": {"points": [2, 2, 2], "origin": [0, 0, 0], "size": [False, 1, 1], "basis": "bezier"}}, {"obstacles": {"meet": "nothing"}},
    {"obstacles": {"meet": "lattice", "solids": [{}]}}, {"scene": {"keys": []}}, {"scene": {"keys": [], "path": "a", "mesh": None}},
    *[{key: ...} for key in ("version", "outputs", "inputs", "parameters", "summary", "lattice", "flat_names", "log", "scene")],
]  # fmt: skip


def rewritten(result: Result, path, arrays=None, **changes) -> Result:
    """What a file with other arrays or another header is loaded as; ... for a key of the header takes it away."""
    result.save(path)
    with np.load(path) as kept:
        whole = dict(kept) | (arrays or {})
    header = json.loads(str(whole["header"])) | changes
    whole["header"] = np.array(json.dumps({key: value for key, value in header.items() if value is not ...}))
    np.savez(path, **whole)
    return Result.load(path)


@pytest.mark.parametrize("changes", WRONG, ids=str)
def test_a_header_that_is_not_of_this_form_is_refused(small, tmp_path, changes):
    with pytest.raises(SoftffdError, match=r"run\.npz: (damaged, or no result that softffd wrote \(|written by softffd )"):
        rewritten(small, tmp_path / "run.npz", **changes)


@pytest.mark.parametrize(
    "keys",
    [{"mesh": []}, {"mesh": {}}, {"mesh": {"file": 3}}, {"mesh": {"file": "a\0b"}}, {"mesh": {"file": ""}}, {"mesh": {"file": ".."}},
     {"plane": 3}, {"pin": [{"points": {"1": 2}}]}, {"": 1}, {"lattice": {"points": [3, 3, 3]}}],
)  # fmt: skip
def test_a_scene_that_is_none_is_told_and_the_numbers_stay(small, tmp_path, keys):
    loaded = rewritten(small, tmp_path / "run.npz", scene={"keys": keys, "path": "a\0b", "mesh": None})
    assert loaded.scene is None and loaded.sceneless
    np.testing.assert_array_equal(loaded.positions, small.positions)


def test_arrays_of_other_shapes_are_refused(small, tmp_path):
    for key, wrong in (("time", small.time[1:]), ("positions", small.positions[..., :2]), ("time", np.array(1.0)),
                       ("inputs", np.array(1.0)), ("positions", small.positions.astype("S8"))):  # fmt: skip
        with pytest.raises(SoftffdError, match="damaged, or no result that softffd wrote"):
            rewritten(small, tmp_path / "run.npz", {key: wrong})


def test_what_would_not_fit_into_the_memory_is_refused_unread(small, tmp_path, monkeypatch):
    monkeypatch.setattr("softffd.run.result_file.memory", lambda: 1e3)
    small.save(tmp_path / "run.npz")
    with pytest.raises(SoftffdError, match=r"run\.npz: its arrays take .* GB; wanted at most 1e-06 GB, this machine's memory"):
        Result.load(tmp_path / "run.npz")


@pytest.mark.parametrize("numbers", [10**9, 10**14])
def test_an_array_that_promises_more_than_its_entry_holds_is_refused(numbers, tmp_path):
    stream = BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": "<f8", "fortran_order": False, "shape": (numbers,)})
    with zipfile.ZipFile(tmp_path / "run.npz", "w") as archive:
        archive.writestr("header.npy", stream.getvalue())
    with pytest.raises(SoftffdError, match=r"run\.npz: damaged, or no result that softffd wrote"):
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
