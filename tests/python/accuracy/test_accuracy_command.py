"""The command `softffd accuracy` and its files."""

import json
from pathlib import Path

import pytest

from measured_scenes import SMALL, table_rows
from softffd import FmuError, load_scene
from softffd.accuracy import command as command
from softffd.cli.command import main

pytestmark = pytest.mark.usefixtures("hasty")


def test_the_command_keeps_table_document_picture_and_page(folder, few, capsys):
    assert main(["accuracy", "small.toml", "--quick", "-o", "out"]) == 0
    assert "small: A small box" in (said := capsys.readouterr().out) and "confirmed by" in said
    rows = table_rows()
    assert {row["method"] for row in rows} == {"central_difference", "bm4"}
    assert all(float(row["cpu_time_s"]) > 0 and float(row["error"]) > 0 and int(row["internal_steps"]) > 0 for row in rows)
    document = json.loads(Path("out/accuracy.json").read_text())
    (scene,) = document["scenes"]
    assert document["machine"]["cores"] >= 1 and document["versions"]["softffd"] and document["scenes_not_measured"] == {}
    assert scene["reference"]["confirmed"] and scene["complete"] and len(scene["runs"]) == len(rows)
    best = scene["levels"]["1e-4"]["best"]  # which, depends on how busy the machine is
    assert best in {"central_difference", "bm4"} and scene["levels"]["1e-4"]["best_over_published"]["factor"] >= 1
    page = Path("out/report.html").read_text()
    assert page.count("data:image/png;base64,") == 1 and "{{" not in page and 'src="http' not in page
    assert f'method = "{best}"' in page and "published / best" in page and "central_difference" in page
    assert Path("out/small.png").read_bytes().startswith(b"\x89PNG")


def test_an_interrupt_keeps_what_is_done_and_names_the_rest(folder, few, fail_runs, capsys):
    for name in ("second", "third"):
        Path(f"{name}.toml").write_text(SMALL)
    fail_runs(KeyboardInterrupt, lambda name, setting: name == "second" and setting.method == "bm4")
    assert main(["accuracy", "small.toml", "second.toml", "third.toml", "--quick", "-o", "out"]) == 130
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "second, third" in said and "Traceback" not in said
    document = json.loads(Path("out/accuracy.json").read_text())
    assert [scene["complete"] for scene in document["scenes"]] == [True, False]
    assert document["scenes_not_measured"] == {"third": "interrupted"}
    page = Path("out/report.html").read_text()
    assert "Not complete: second (interrupted)" in page and "Not measured: third (interrupted)" in page
    assert {row["scene"] for row in table_rows()} == {"small", "second"}
    assert not list(Path("out").glob(".*"))


def test_an_interrupt_before_the_first_run_leaves_an_empty_report(folder, few, fail_runs, capsys):
    fail_runs(KeyboardInterrupt)
    assert main(["accuracy", "small.toml", "--quick", "-o", "out"]) == 130
    assert json.loads(Path("out/accuracy.json").read_text())["scenes_not_measured"] == {"small": "interrupted"}
    assert "small" in capsys.readouterr().err


def test_a_scene_that_cannot_be_measured_leaves_the_others(folder, few, fail_runs, capsys):
    Path("second.toml").write_text(SMALL)
    fail_runs(FmuError("the component reported an error: out of luck"), lambda name, _setting: name == "small")
    assert main(["accuracy", "small.toml", "second.toml", "--quick", "-o", "out"]) == 1
    assert "small: the component reported an error: out of luck" in capsys.readouterr().err
    document = json.loads(Path("out/accuracy.json").read_text())
    assert [scene["scene"] for scene in document["scenes"]] == ["second"] and "out of luck" in document["scenes_not_measured"]["small"]


def test_a_scene_in_which_no_run_succeeds_is_not_measured(folder, few, fail_runs, capsys):
    fail_runs(FmuError("out of luck"), lambda _name, setting: setting.method in ("central_difference", "bm4"))
    assert main(["accuracy", "small.toml", "--quick", "-o", "out"]) == 1
    assert "small: no run succeeded; the last: out of luck" in capsys.readouterr().err and not table_rows()


def test_an_unknown_scene_is_refused_before_anything_runs(folder, capsys):
    assert main(["accuracy", "small.toml", "spni", "-o", "out"]) == 1
    assert 'did you mean "spin"?' in capsys.readouterr().err and not Path("out").exists()
    assert main(["accuracy", "small.toml", "--step", "-1", "-o", "out"]) == 1
    assert "communication step: wanted > 0 s" in capsys.readouterr().err


def test_the_standard_set_is_shipped():
    scenes = [load_scene(name) for name in command.STANDARD]
    assert len(scenes) == 8 and all(scene.solver.step == 0 for scene in scenes)
