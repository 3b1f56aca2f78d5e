"""The commands as a user types them: what they write, what they say, how they end."""

import json
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

import softffd.__main__
from mesh_files import ball, two_colours
from softffd import deform, load_mesh, load_scene, save_mesh
from softffd.cli.command import main
from softffd.fmu.component import Component
from softffd.installed import least_glibc
from softffd.run.drive import Drive
from softffd.scene.document import shipped_scenes

QUICK = """
title = "A quick box"
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
point = [0.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
[initial]
offset = [0.0, 0.0, 0.05]
[outputs]
energy = true
[experiment]
stop_time = 0.2
"""


@pytest.fixture
def quick(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("quick.toml").write_text(QUICK)
    return tmp_path


def refused(capsys, *arguments) -> str:
    """The message of a command that must end with status 1, without a traceback."""
    assert main(list(map(str, arguments))) == 1
    message = capsys.readouterr().err
    assert message.startswith("softffd: ") and "Traceback" not in message
    return message


def test_build_then_run_the_fmu_then_run_the_scene_then_without_pictures_which_leaves_none_of_an_earlier_run(quick, capsys):
    assert main(["build", "quick.toml"]) == 0
    Path("quick.fmu").rename("QUICK.FMU")
    assert main(["run", "QUICK.FMU", "-o", "from_fmu", "--no-pictures"]) == 0
    assert main(["run", "quick.toml", "-o", "from_scene"]) == 0
    a, b = (np.load(quick / folder / "result.npz") for folder in ("from_fmu", "from_scene"))
    np.testing.assert_array_equal(a["positions"], b["positions"])
    assert a["positions"].shape == (21, 4, 4, 4, 3) and a["time"].shape == (21,)
    for name in ("result.csv", "summary.json", "picture.png", "view.html"):
        assert (quick / "from_scene" / name).stat().st_size > 100
    assert not list(quick.rglob("*.partial"))
    shown = {"picture.png", "view.html"}
    before = {file.name for file in (quick / "from_scene").iterdir()}
    assert main(["run", "quick.toml", "-o", "from_scene", "--overwrite", "--no-pictures"]) == 0
    assert before >= shown and {file.name for file in (quick / "from_scene").iterdir()} == before - shown
    assert "picture.png" not in capsys.readouterr().out.splitlines()[-1]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="glibc is Linux's")
def test_build_says_which_glibc_its_library_needs(quick, capsys):
    assert main(["build", "quick.toml"]) == 0
    needed = re.search(r"runs on .*\S+ with glibc (\d+)\.(\d+) or newer", capsys.readouterr().out)
    here = os.confstr("CS_GNU_LIBC_VERSION").split()[1].split(".")
    assert (2, 2) < tuple(map(int, needed.groups())) <= tuple(map(int, here))


def test_the_newest_version_that_a_library_names_is_needed(tmp_path):
    library = tmp_path / "softffd.so"
    library.write_bytes(b"\x7fELF\0GLIBC_2.4\0GLIBC_2.17\0GLIBC_2.2.5\0GLIBC_2.9\0")
    assert least_glibc(library) == "2.17"
    library.write_bytes(b"MZ\0KERNEL32.dll\0")
    assert least_glibc(library) is None


def test_result_csv_has_every_output_by_name_and_the_summary_tells_time_deformation_reaction_and_energy(quick):
    main(["run", "quick.toml", "-o", "out", "--no-pictures"])
    header = (quick / "out" / "result.csv").read_text().splitlines()[0]
    for name in ("time", "plane.ground.reaction.z", '"position[3,3,3].z"', "energy.work"):
        assert name in header
    table = np.genfromtxt(quick / "out" / "result.csv", delimiter=",", skip_header=1)
    assert table.shape[0] == 21 and np.isfinite(table).all()
    summary = json.loads((quick / "out" / "summary.json").read_text())
    assert summary["simulated_time_s"] == 0.2 and summary["real_time_factor"] > 0
    assert summary["largest_deformation_m"] > 0
    assert summary["plane.ground.reaction_peak_N"] > 9.81
    assert summary["energy_gap_J"] < 0.1 * summary["energy_turned_over_J"]


def test_set_and_input_reach_the_component(quick):
    Path("inputs.csv").write_text("time,load.push.x\n0,0\n0.1,5\n")
    Path("pushed.toml").write_text(QUICK + '[material]\ndamping = 0.0\n[[load]]\nname = "push"\npoints = "x+"\n')
    assert main(["run", "pushed.toml", "--input", "inputs.csv", "--set", "mass=2", "--stop-time", "0.1", "-o", "out", "--no-pictures"]) == 0
    x = np.load(quick / "out" / "result.npz")["positions"][-1].mean(axis=(0, 1, 2))
    rows = 0.01 * np.arange(10)
    exact = sum(50 * t / 2 * 0.01 * (0.1 - t - 0.005) for t in rows)  # held over each step: sum of a H (T - t - H/2)
    assert x[0] - 0.5 == pytest.approx(exact, rel=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("name", shipped_scenes())
def test_every_shipped_scene_runs(name, tmp_path, capsys):
    assert main(["run", name, "-o", str(tmp_path)]) == 0
    assert load_scene(name).title in capsys.readouterr().out


def test_the_pressed_box_recovers(tmp_path):
    main(["run", "press", "-o", str(tmp_path), "--no-pictures"])
    z = np.load(tmp_path / "result.npz")["positions"][..., 2]
    heights = z.max(axis=(1, 2, 3)) - z.min(axis=(1, 2, 3))
    assert heights.min() == pytest.approx(0.6, abs=1e-3)
    assert heights[-1] == pytest.approx(1.0, abs=2e-3)


def test_demo_keeps_what_it_promises(tmp_path, capsys):
    assert main(["demo", "-o", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    for word in ("simulated", "real time", "largest deformation", "reaction peak", "energy balance"):
        assert word in said
    files = ("car_drop.fmu", "picture.png", "view.html", "deformed.obj", "result.npz", "bump.png", "bump.html")
    for name in files:
        assert (tmp_path / name).stat().st_size > 1000
    assert len(trimesh.load(tmp_path / "deformed.obj", force="mesh", process=False).vertices) >= 2000


def test_new_wants_a_name_writes_a_scene_that_runs_and_prints_a_command_to_copy(quick, capsys):
    assert main(["new", "mine"]) == 0
    assert main(["run", "mine.toml", "--stop-time", "0.05", "-o", "out", "--no-pictures"]) == 0
    assert "exists already" in refused(capsys, "new", "mine")
    assert "wanted a name in UTF-8" in refused(capsys, "new", "\udcff") and not list(Path().glob("\udcff*"))
    for name in ("", ".", "..", ".toml"):
        assert "wanted the name of a scene" in refused(capsys, "new", name)
    assert main(["new", "deep/my scene"]) == main(["new", "my scene"]) == 0 and Path("deep/my scene.toml").is_file()
    assert "softffd run 'my scene.toml'" in capsys.readouterr().out


def test_schema_and_scenes_print(capsys):
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out)["properties"]["lattice"]
    assert main(["scenes"]) == 0
    said = capsys.readouterr().out
    assert [name for name in shipped_scenes() if name not in said] == []


DISTRIBUTIONS = ("uniform", "vertices", "surface", "volume")


def mesh_scene(folder: Path, file: Path | str, distribution: str) -> Path:
    path = folder / "mesh.toml"
    path.write_text(
        f'[mesh]\nfile = "{file}"\nup = "y"\n[mass]\ntotal = 2.0\ndistribution = "{distribution}"\n'
        '[environment]\ngravity = [0.0, 0.0, -9.81]\n[[pin]]\nname = "base"\npoints = "z-"\n'
        "[experiment]\nstop_time = 0.05\n"
    )
    return path


def test_the_mesh_that_run_writes_is_deformed_in_the_scene_s_basis(tmp_path):
    save_mesh(ball(), tmp_path / "ball.obj")
    scene = mesh_scene(tmp_path, "ball.obj", "uniform")
    scene.write_text('[lattice]\npoints = [7, 7, 7]\nbasis = "bspline"\n' + scene.read_text())
    assert main(["run", str(scene), "-o", str(tmp_path / "out"), "--no-pictures"]) == 0
    loaded, positions = load_scene(scene), np.load(tmp_path / "out" / "result.npz")["positions"][-1]
    wanted = deform(loaded.loaded_mesh, positions, origin=loaded.lattice.origin, size=loaded.lattice.size, basis="bspline")
    written = load_mesh(tmp_path / "out" / "deformed.obj", up="y").vertices
    np.testing.assert_allclose(written, wanted, atol=1e-6)


@pytest.mark.parametrize(("name", "kept"), [("pictures.obj", "deformed.obj"), ("faces.off", "deformed.glb")])
def test_run_writes_the_mesh_with_its_looks_and_says_what_is_lost(name, kept, tmp_path, capsys):
    file = two_colours(tmp_path, name)
    (tmp_path / "the ball.png").unlink(missing_ok=True)
    scene = mesh_scene(tmp_path, file, "uniform")
    assert main(["run", str(scene), "--stop-time", "0.02", "-o", str(tmp_path / "out"), "--no-pictures"]) == 0
    said = capsys.readouterr().out
    assert ("pictures.obj: material ball: its picture the ball.png is missing or cannot be read" in said) == (name == "pictures.obj")
    looks = load_mesh(tmp_path / "out" / kept).looks
    assert {material.name for material in looks.materials} == (
        {"crate", "ball"} if kept[-3:] == "obj" else {"colour_cc3300", "colour_009966"}
    )
    assert len(looks.textures) == (name == "pictures.obj")


def test_a_mesh_is_enough_to_run_and_new_writes_the_same_scene(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "meshes").mkdir()
    two_colours(tmp_path / "meshes", "kd.obj")
    (tmp_path / "meshes" / "kd.csv").write_text("of another program\n")
    assert main(["run", "meshes/kd.obj", "--up", "z", "--stop-time", "0.05"]) == 0
    said = capsys.readouterr().out
    assert said.startswith(
        "meshes/kd.obj: 16 vertices, 1 x 1 x 3, no unit in the file: taken as metres, --unit mm otherwise; z up; fills 67 % of its box\n"
    )
    assert "softffd new kd --mesh meshes/kd.obj" in said
    assert {"picture.png", "view.html", "deformed.obj"} <= {file.name for file in Path("softffd-kd").iterdir()}
    assert main(["new", "mine", "--mesh", "meshes/kd.obj", "--up", "z"]) == 0
    assert main(["run", "mine.toml", "--stop-time", "0.05", "--no-pictures"]) == 0
    one, other = (np.load(Path(folder) / "result.npz")["positions"] for folder in ("softffd-kd", "softffd-mine"))
    np.testing.assert_array_equal(one, other)


def test_options_of_meshes_need_one_and_a_mesh_in_place_of_a_scene_is_told_what_to_do(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert "--unit: wanted with a mesh file, got press" in refused(capsys, "run", "press", "--unit", "mm")
    assert "--density: wanted with --mesh FILE" in refused(capsys, "new", "mine", "--density", "5")
    assert not list(tmp_path.iterdir())
    two_colours(tmp_path, "kd.obj")
    said = refused(capsys, "build", "kd.obj")
    assert "wanted a scene file (TOML), got a mesh; to drop it on the ground: softffd run kd.obj; " in said
    assert "softffd new kd --mesh kd.obj" in said


@pytest.mark.short("spot.obj-volume", "beetle.obj-surface")
@pytest.mark.parametrize(
    "file, distribution",
    [*(("spot.obj", spread) for spread in DISTRIBUTIONS), *(("beetle.obj", spread) for spread in DISTRIBUTIONS if spread != "volume")],
)
def test_real_meshes_run_with_every_fitting_distribution(file, distribution, real_meshes, tmp_path):
    scene = mesh_scene(tmp_path, real_meshes / file, distribution)
    assert main(["run", str(scene), "-o", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "deformed.obj").stat().st_size > 1e4


def test_a_damaged_mesh_gives_one_clear_paragraph(tmp_path, capsys):
    (tmp_path / "cut.stl").write_bytes(b"solid" + bytes(75))
    message = refused(capsys, "run", mesh_scene(tmp_path, "cut.stl", "uniform"))
    assert "cut.stl" in message and len(message) < 600


def test_missing_files_and_wrong_names_say_what_is_near(quick, capsys):
    assert 'did you mean "car_drop"?' in refused(capsys, "run", "car_dorp")
    assert "nothing.fmu: there is no such FMU" in refused(capsys, "run", "nothing.fmu")
    Path("folder.fmu").mkdir()
    assert "folder.fmu: wanted an FMU, got a folder" in refused(capsys, "run", "folder.fmu")
    assert 'did you mean "plane.ground.friction"?' in refused(capsys, "run", "quick.toml", "--set", "plane.ground.frction=1")
    assert "NAME=VALUE" in refused(capsys, "run", "quick.toml", "--set", "mass")
    assert "mass: wanted a number, got 'heavy'" in refused(capsys, "run", "quick.toml", "--set", "mass=heavy")
    assert 'did you mean "leapfrog"?' in refused(capsys, "run", "quick.toml", "--set", "solver.method=leapfrg")
    assert "stop time: wanted > 0 s, got -1" in refused(capsys, "run", "quick.toml", "--stop-time", "-1")
    Path("bad.csv").write_text("time,load.push.x\n0,1\n")
    assert "no such variable" in refused(capsys, "run", "quick.toml", "--input", "bad.csv")
    Path("words.csv").write_text("time,load.push.x\n0,much\n")
    assert "wanted a number" in refused(capsys, "run", "quick.toml", "--input", "words.csv")
    Path("broken.fmu").write_bytes(b"PK nonsense")
    assert "cannot be opened" in refused(capsys, "run", "broken.fmu")
    assert "softffd: platform amiga: this installation has no library for it; it has linux64" in refused(
        capsys, "build", "quick.toml", "--platform", "amiga"
    )


def test_an_input_file_is_named_where_one_of_its_columns_is_none(quick, capsys):
    for column, message in {"plane.ground.pint.z": "no such variable", "plane.ground.reaction.z": "got its output"}.items():
        Path("in.csv").write_text(f"time,{column}\n0,1\n")
        assert f"in.csv: {column}: " in (said := refused(capsys, "run", "quick.toml", "--input", "in.csv")) and message in said
    Path("in.csv").rename("quick.csv")  # the scene's own
    assert "quick.csv: plane.ground.reaction.z" in refused(capsys, "run", "quick.toml")


def test_the_name_of_an_fmu_ends_in_fmu_and_is_no_folder(quick, capsys):
    Path("taken.fmu").mkdir()
    for name, said in {"": '"": wanted', ".": ".: ", "x": 'did you mean "x.fmu"?', "taken.fmu": "got a folder"}.items():
        message = refused(capsys, "build", "quick.toml", "-o", name)
        assert said in message and "wanted a file name ending in .fmu" in message
    assert {path.name for path in quick.iterdir()} == {"quick.toml", "taken.fmu"}


def test_build_and_drivers_write_over_nothing_that_is_there_unless_they_are_told_to(quick, capsys):
    Path("quick.fmu").write_text("mine")
    assert "quick.fmu: there already; to write over what is there: --overwrite" in refused(capsys, "build", "quick.toml")
    Path("plate.fmu").write_text("mine")
    assert "plate.fmu: there already" in refused(capsys, "drivers")
    assert Path("quick.fmu").read_text() == Path("plate.fmu").read_text() == "mine" and not Path("actuator.fmu").exists()
    assert main(["build", "quick.toml", "--overwrite"]) == 0
    assert Path("quick.fmu").stat().st_size > 1000


def test_an_fmu_without_a_default_experiment_asks_for_times(quick, capsys):
    main(["build", "quick.toml"])
    with zipfile.ZipFile("quick.fmu") as whole, zipfile.ZipFile("bare.fmu", "w") as bare:
        for name in whole.namelist():
            bare.writestr(name, re.sub(rb"<DefaultExperiment[^>]*/>", b"", whole.read(name)))
    assert "stop time: wanted > 0 s, got none" in refused(capsys, "run", "bare.fmu")
    assert "communication step: wanted > 0 s, got none" in refused(capsys, "run", "bare.fmu", "--stop-time", "0.1")


@pytest.mark.parametrize(
    "command", [["run", "quick.toml"], ["build", "quick.toml", "--reference"], ["demo"], ["accuracy"], ["stability"], ["drivers"]]
)
def test_a_folder_that_cannot_be_is_refused_before_anything_runs(command, quick, monkeypatch, capsys):
    monkeypatch.setattr(Component, "do_step", None)
    monkeypatch.setattr(Drive, "go_on", None)
    assert "is a file" in refused(capsys, *command, "-o", "quick.toml/out")
    Path("locked").mkdir()
    monkeypatch.setattr(os, "access", lambda path, _mode: Path(path).name != "locked")
    assert "may not be written to" in refused(capsys, *command, "-o", "locked/out")


def test_a_reader_that_has_enough_ends_the_command_quietly():
    code = "import sys; from softffd.__main__ import main; sys.exit(main())"
    for command in ("schema", "scenes"):
        writer = subprocess.Popen([sys.executable, "-c", code, command], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        writer.stdout.close()
        assert writer.stderr.read() == b"" and writer.wait() == 141


@pytest.mark.parametrize("when", ["importing", "running"])
def test_an_interrupt_at_any_time_is_one_line(when, monkeypatch, capsys):
    def interrupt(*_arguments):
        raise KeyboardInterrupt

    if when == "importing":
        monkeypatch.delitem(sys.modules, "softffd.cli.command")
        monkeypatch.setattr(sys, "meta_path", [SimpleNamespace(find_spec=interrupt)])
    else:
        monkeypatch.setattr("softffd.cli.command.parse", interrupt)
    assert softffd.__main__.main() == 130
    assert capsys.readouterr().err == "softffd: interrupted\n"


def test_a_scene_with_several_faults_lists_them_all(quick, capsys):
    Path("bad.toml").write_text("[material]\nstifness = 1\n[mass]\ntotal = -1\n[[plane]]\nname = 'a'\nnormal = [0,0,0]\n")
    message = refused(capsys, "run", "bad.toml")
    for words in ("stiffness", "mass.total", "normal"):
        assert words in message


def test_an_interrupt_leaves_no_half_written_file(quick, monkeypatch, capsys):
    def interrupt(*_arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(Drive, "go_on", interrupt)
    assert main(["run", "quick.toml", "-o", "out"]) == 130
    assert not Path("out").exists()
    assert "interrupted" in capsys.readouterr().err


def test_the_module_runs_as_a_program(quick):
    done = subprocess.run([sys.executable, "-m", "softffd", "run", "nowhere"], capture_output=True, text=True)
    assert done.returncode == 1 and done.stderr.startswith("softffd: ")
