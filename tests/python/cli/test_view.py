"""`softffd view`: the page of a run that was kept."""

import os
import shutil
from pathlib import Path

import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.util import write_csv

from mesh_files import ball
from pages import run_of, whole_run_of
from scenes import box
from softffd import save_mesh, simulate, write_ssp
from softffd.cli.command import main
from softffd.run.replay import replay_system
from softffd.scene.document import SHIPPED
from softffd.scene.scene import scene_from


@pytest.fixture(autouse=True)
def kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    simulate(box(points=[2, 2, 2], title="Two", stop_time=0.02)).save("kept")


def test_a_page_is_made_where_there_is_none_and_kept_where_there_is_beside_a_folder_or_one_file(opened, capsys):
    page = Path("kept/view.html")
    assert main(["view", "kept"]) == 0 and "<title>Two</title>" in page.read_text()
    assert capsys.readouterr().out == f"{page}\n" and opened == [page.resolve().as_uri()]
    page.write_text("mine")
    assert main(["view", "kept"]) == 0 and page.read_text() == "mine" and len(opened) == 2
    os.utime(page, (0, 0))  # older than the result
    assert main(["view", "kept"]) == 0 and "<title>Two</title>" in page.read_text()
    assert main(["view", "kept/result.npz"]) == 0 and opened[-1] == Path("kept/result.html").resolve().as_uri()


def test_a_mesh_that_lies_elsewhere_is_told_and_named(opened, tmp_path, monkeypatch, capsys):
    save_mesh(ball(), "ball.obj")
    simulate(scene_from({"mesh": {"file": "ball.obj"}}, path=tmp_path / "b.toml"), stop_time=0.02).save("deep/kept")
    monkeypatch.chdir("deep")
    for command in (["view", "kept"], ["export", "kept", "--to", "ply"]):
        assert main(command) == 0 and "ball.obj, is not beside it nor below its folder: copy it there, or" in capsys.readouterr().out
        assert main([*command, "--mesh", "../ball.obj", *(["--overwrite"] * (command[0] == "export"))]) == 0
        assert "without its scene" not in capsys.readouterr().out
    assert not run_of(Path("kept/view.html"))["cage"]
    assert main(["view", "kept", "kept", "--mesh", "../ball.obj"]) == 1 and "--mesh: wanted with one kept run" in capsys.readouterr().err


@pytest.mark.parametrize("what", ["nowhere", ".", "nowhere.npz"])
def test_what_holds_no_result_is_refused(opened, capsys, what):
    assert main(["view", what]) == 1
    assert f"softffd: {what}: wanted a folder that softffd run wrote" in capsys.readouterr().err and not opened


def test_several_runs_have_one_page_under_their_names(opened, capsys):
    for name in ("softffd-b", "c.npz"):
        simulate(box(points=[2, 2, 2], title=name, stop_time=0.02)).save(name)
    assert main(["view", "softffd-b", "c.npz"]) == 0
    page = Path("b-c.html")
    assert "<title>b beside c</title>" in page.read_text() and opened == [page.resolve().as_uri()]
    assert main(["view", "softffd-b", "c.npz"]) == 1 and "--overwrite" in capsys.readouterr().err
    assert main(["view", "softffd-b", "c.npz", "--ssp", "-o", "one.html"]) == 0 and "<title>b and c</title>" in Path("one.html").read_text()
    assert main(["view", "c.npz", "c.npz"]) == 1 and "wanted each run once, got c.npz, c.npz" in capsys.readouterr().err
    assert main(["view", "kept", "--ssp"]) == 1 and "--ssp: wanted with two runs or more" in capsys.readouterr().err


def test_the_soft_bodies_of_a_system_run_again_with_what_a_host_recorded(capsys):
    lid = {"name": "lid", "point": [0, 0, 0], "normal": [0, 0, -1], "motion": "input"}
    low = box(lattice={"points": [2, 2, 2], "origin": [0, 0, -1]}, plane=[lid])
    write_ssp("s.ssp", {"a": low, "b": low}, [("a.position[1,1,1].z", "b.plane.lid.point.z")], start_values={"b.damping": 0.25})
    rows = simulate_ssp("s.ssp", stop_time=0.02, step_size=0.005)
    write_csv("rows.csv", rows)
    assert main(["view", "s.ssp", "rows.csv"]) == 0
    run = whole_run_of(Path("s.html"))
    assert [body["name"] for body in run["bodies"]] == ["a", "b"] and {body["pane"] for body in run["bodies"]} == {0}
    assert replay_system(Path("s.ssp"), rows)["b"].parameters["damping"] == 0.25
    for what, words in ((["s.ssp"], "wanted with it the CSV file"), (["kept/result.npz", "rows.csv"], "rows.csv")):
        assert main(["view", *what, "-o", "x.html"]) == 1 and words in capsys.readouterr().err
    Path("bad.ssp").write_text("no")
    assert main(["view", "bad.ssp", "rows.csv"]) == 1 and "cannot be read as a system" in capsys.readouterr().err


@pytest.fixture
def with_mesh() -> Path:
    """A system of a body with a mesh."""
    Path("scene").mkdir()
    shutil.copy(SHIPPED / "materials" / "block.obj", "scene")
    lid = {"name": "lid", "point": [0, 0, 9], "normal": [0, 0, -1], "motion": "input"}
    block = scene_from({"mesh": {"file": "block.obj"}, "lattice": {"points": [2, 2, 2]}, "plane": [lid]}, path="scene/block.toml")
    other = box(points=[2, 2, 2])
    return write_ssp("s.ssp", {"block": block, "other": other}, [("other.position[1,1,1].z", "block.plane.lid.point.z")])


def test_a_body_of_a_system_is_shown_with_the_mesh_of_its_scene(with_mesh):
    rows = simulate_ssp(str(with_mesh), stop_time=0.02, step_size=0.005)
    result = replay_system(with_mesh, rows)["block"]
    assert result.deformed().shape == result.scene.loaded_mesh.vertices.shape and result.scene.name == "block"
    os.rename("scene/block.obj", "scene/other.obj")
    assert "no such file" in replay_system(with_mesh, rows)["block"].sceneless
