"""Exported runs, read back by readers of their own, have the vertices of `Result.deformed`."""

import json
import os
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.spatial import cKDTree

from exported import Glb, planes, read_pc2, single, solids, surface
from made_up_run import made_up_run
from scenes import box
from softffd import SoftffdError, load_mesh, simulate
from softffd.cli.command import main
from softffd.export.film import SIZES
from softffd.export.formats import FORMATS, format_of
from softffd.show.stage import stage_of


def test_pc2_has_every_vertex_at_every_row_and_its_mesh_beside_it(run, tmp_path):
    files = run.export(tmp_path / "run.pc2")
    assert [file.name for file in files] == sorted(os.listdir(tmp_path)) and len(files) == 2
    places, start, rate = read_pc2(tmp_path / "run.pc2")
    wanted = np.stack([surface(run, row) for row in range(len(run.time))])
    assert (start, rate) == (0.0, 1.0) and np.abs(places - wanted).max() <= single(wanted)
    rest = [line.split()[1:4] for line in (tmp_path / "run_rest.obj").read_text().splitlines() if line.startswith("v ")]
    still = run.loaded_mesh.vertices if run.loaded_mesh else stage_of(run).vertices
    assert np.array(rest, dtype=float) == pytest.approx(still, abs=1e-8)


def test_a_series_of_ply_files_has_the_chosen_rows_and_their_times(thrown, tmp_path):
    thrown.export(tmp_path / "run.ply", frames=3)
    listed = json.loads((tmp_path / "run.ply.series").read_text())["files"]
    assert [each["name"] for each in listed] == [f"run_ply/run_000{number}.ply" for number in range(3)]
    rows = [0, (len(thrown.time) - 1) // 2, len(thrown.time) - 1]
    for each, row in zip(listed, rows, strict=True):
        assert each["time"] == thrown.time[row]
        assert np.abs(load_mesh(tmp_path / each["name"]).vertices - surface(thrown, row)).max() <= single(surface(thrown, row))


@pytest.mark.parametrize("tolerance", [None, 1e-5])
def test_glb_is_within_the_error_that_it_states(run, tolerance, tmp_path):
    run.export(tmp_path / "run.glb", tolerance=tolerance)
    glb = Glb(tmp_path / "run.glb")
    said, side = glb.tree["asset"]["extras"], max(run.lattice.size)
    errors = []
    start = surface(run, 0)
    index = cKDTree(start).query(glb.at(0.0)["object"])[1]  # it has a vertex for each of its normals
    assert len(glb.time) == len(run.time) and len(np.unique(start[index], axis=0)) == len(np.unique(start, axis=0))
    for row, time in enumerate(glb.time):
        shown = glb.at(time)
        errors.append(np.linalg.norm(shown["object"] - surface(run, row)[index], axis=1).max())
        for part, places in solids(run, row).items():
            assert np.abs(shown[part] - places).max() <= 2 * single(places), part
        for part, (point, normal) in planes(run, row).items():
            depth = (point - shown[part]) @ normal  # behind, so that what touches is seen
            assert np.ptp(depth) <= 4 * single(shown[part]) and 0 < depth.mean() < 0.02 * side, part
    assert max(errors) == pytest.approx(said["largest_error_m"], rel=1e-3, abs=1e-6 * side)
    assert said["largest_error_m"] <= (tolerance or 1e-3) * side and said["largest_error_of_box"] == said["largest_error_m"] / side
    assert glb.time == pytest.approx(run.time - run.time[0], abs=1e-6)


def test_glb_takes_more_windows_for_less_error_and_no_more_than_eight_shapes(thrown, tmp_path):
    windows = []
    for number, tolerance in enumerate((1e-2, 1e-3, 1e-5)):
        thrown.export(tmp_path / f"{number}.glb", tolerance=tolerance)
        windows.append(Glb(tmp_path / f"{number}.glb").tree["asset"]["extras"]["windows"])
    assert 1 == windows[0] <= windows[1] < windows[2]


def test_between_windows_nothing_jumps(thrown, tmp_path):
    thrown.export(tmp_path / "run.glb", tolerance=1e-5)
    glb = Glb(tmp_path / "run.glb")
    moments = np.linspace(glb.time[0], glb.time[-1], 6 * len(glb.time))
    places = np.stack([glb.at(moment)["object"] for moment in moments])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1)
    rows = np.stack([glb.at(moment)["object"] for moment in glb.time])
    assert steps.max() <= 0.25 * np.linalg.norm(np.diff(rows, axis=0), axis=2).max()


def test_a_rigid_run_needs_no_shape_and_one_of_a_single_row_no_animation(pressed, tmp_path):
    still = made_up_run()
    still = replace(still, positions=np.repeat(still.positions[:1], len(still.time), axis=0))
    still.export(tmp_path / "still.glb")
    assert not any("targets" in each for mesh in Glb(tmp_path / "still.glb").tree["meshes"] for each in mesh["primitives"])
    one = {name: {key: np.atleast_1d(value)[:1] for key, value in getattr(pressed, name).items()} for name in ("outputs", "inputs")}
    replace(pressed, time=pressed.time[:1], positions=pressed.positions[:1], **one).export(tmp_path / "one.glb")
    data = (tmp_path / "one.glb").read_bytes()
    assert "animations" not in json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])


def test_gif_is_of_the_run_in_real_time(pressed, tmp_path, monkeypatch):
    monkeypatch.setitem(SIZES, ".gif", (160, 106, 20))
    pressed.export(tmp_path / "run.gif", frames=3)
    with Image.open(tmp_path / "run.gif") as film:
        assert film.n_frames > 1 and film.info["loop"] == 0
        lasts, shots = 0, set()
        for number in range(film.n_frames):
            film.seek(number)
            lasts += film.info["duration"]
            shots.add(film.convert("RGB").tobytes())
    assert lasts == pytest.approx(2050, abs=50) and len(shots) == 3


def test_the_ending_or_the_word_tells_the_format():
    assert format_of(Path("a.GLB"), None) == format_of(None, "glb") == format_of(Path("a"), "glb") == "glb"
    for path, to, said in [
        (None, None, "wanted --to, one of"),
        (Path("a.glbb"), None, 'did you mean ".glb"'),
        (Path("a.glb"), "pc2", "has the ending of glb"),
        (None, "gbl", 'did you mean "glb"'),
    ]:
        with pytest.raises(SoftffdError, match=said):
            format_of(path, to)


def test_the_help_names_every_format(capsys):
    with pytest.raises(SystemExit):
        main(["export", "--help"])
    said = " ".join(capsys.readouterr().out.split())
    assert "Format: " + ", ".join(list(FORMATS)[:-1]) + f" or {list(FORMATS)[-1]};" in said


@pytest.mark.parametrize("name", FORMATS)
def test_what_fails_leaves_no_file(name, thrown, tmp_path, monkeypatch):
    def stop(*_words):
        raise KeyboardInterrupt

    if needs := FORMATS[name].needs:
        pytest.importorskip(needs[0], reason=f"{needs[0]} is not installed: pip install 'softffd[{needs[1]}]'")
    kept = tmp_path / "kept"
    kept.mkdir()
    monkeypatch.setattr("softffd.export.take.Take.deformed", stop)
    monkeypatch.setattr("softffd.show.panel.Panels.image", stop)
    monkeypatch.setattr("shutil.which", lambda _: sys.executable)  # in the place of ffmpeg
    with pytest.raises(KeyboardInterrupt):
        thrown.export(kept / "run", to=name, frames=2)
    assert os.listdir(kept) == []


def test_a_folder_with_other_things_is_not_taken_for_a_series(thrown, tmp_path):
    (tmp_path / "run_ply").mkdir()
    (tmp_path / "run_ply" / "mine.txt").write_text("mine")
    with pytest.raises(SoftffdError, match=r"wanted a folder for the series alone, got one with mine\.txt"):
        thrown.export(tmp_path / "run.ply")
    assert os.listdir(tmp_path) == ["run_ply"]


@pytest.mark.parametrize(("name", "shown"), [("thrown", False), ("pressed", True)])
def test_a_film_shows_the_lattice_when_asked_for_it_and_by_default_where_there_is_no_mesh(name, shown, request, tmp_path, monkeypatch):
    monkeypatch.setitem(SIZES, ".gif", (160, 106, 20))
    run, films = request.getfixturevalue(name), {}
    for asked in (None, True, False):
        run.export(tmp_path / "run.gif", frames=2, lattice=asked)
        films[asked] = (tmp_path / "run.gif").read_bytes()
    assert films[True] != films[False] and films[None] == films[shown]


def test_what_cannot_be_is_refused(thrown, pressed, tmp_path):
    blind = replace(pressed, positions=np.full_like(pressed.positions, np.nan))
    for run, kind, keys, said in (
        (thrown, "glb", {"tolerance": 0.0}, "wanted a number > 0"),
        (thrown, "glb", {"tolerance": "1e-3"}, "wanted one number, got '1e-3'"),
        (thrown, "glb", {"tolerance": 1e-9}, "single precision"),
        *[(thrown, "glb", {"frames": frames}, "whole number of at least 2") for frames in (0, 1, 2.5, "5")],
        (thrown, "pc2", {"tolerance": 1e-3}, "and with glb, got"),
        (thrown, "pc2", {"lattice": False}, "lattice: wanted with gif, mp4, which are drawn, got pc2"),
        (blind, "glb", {}, "were not recorded"),
    ):
        with pytest.raises(SoftffdError, match=said):
            run.export(tmp_path / f"run.{kind}", **keys)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", [name for name, each in FORMATS.items() if not each.draws])
def test_places_that_single_precision_does_not_hold_are_refused(name, pressed, tmp_path):
    if needs := FORMATS[name].needs:
        pytest.importorskip(needs[0])
    far = replace(pressed, positions=pressed.positions + 5e6)
    with pytest.raises(SoftffdError, match=f"export to {name}: .* single precision, leave an error of .* of the box; wanted at most"):
        far.export(tmp_path / "run", to=name)
    assert os.listdir(tmp_path) == []


def test_the_command_writes_beside_nothing_unless_it_may(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    simulate(box(points=[2, 2, 2], title="Two", stop_time=0.02)).save("kept")
    assert main(["export", "kept", "--to", "glb"]) == 0
    said = capsys.readouterr().out
    assert "largest error" in said and "kept.glb: " in said
    assert main(["export", "kept/result.npz", "-o", "kept.glb"]) == 1
    assert "kept.glb: there already" in capsys.readouterr().err
    assert main(["export", "kept", "-o", "kept.glb", "--overwrite"]) == 0
    assert main(["export", "nowhere", "--to", "glb"]) == 1
    assert "wanted a folder that softffd run wrote" in capsys.readouterr().err
    assert sorted(os.listdir()) == ["kept", "kept.glb"]
    assert main(["export", "kept", "--to", "ply"]) == 0
    Path("kept.ply.series").unlink()
    assert main(["export", "kept", "--to", "ply"]) == 1
    assert "kept_ply/kept_000" in capsys.readouterr().err
