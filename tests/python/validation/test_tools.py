"""The tools of the sources: how they are run, and that no wheel has them."""

import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest
from scikit_build_core.settings.skbuild_read_settings import SettingsReader

from softffd.cli import command
from softffd.cli.command import exit_status, main
from validation.tools import TOOLS, parser, run_tool

ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("state, packages", [("wheel", ["python/softffd"]), ("editable", ["python/softffd", "python/validation"])])
def test_a_wheel_has_the_package_alone_and_a_checkout_the_tools_too(state, packages):
    assert SettingsReader.from_file(ROOT / "pyproject.toml", state=state).settings.wheel.packages == packages


def test_every_tool_is_run_by_the_script_and_by_its_module(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "python"))
    script = __import__("run")
    for name in ("run", "release"):
        sys.modules.pop(name, None)
    assert set(script.TOOLS) == set(TOOLS)
    assert all(f"python/run.py {name} " in script.__doc__ for name in TOOLS)
    told = subprocess.run([sys.executable, "-m", "validation", "stability", "--only", "jmps"], capture_output=True, text=True)
    assert told.returncode == 1 and told.stderr.startswith("softffd: --only jmps: wanted") and "Traceback" not in told.stderr


def test_an_installed_program_says_where_the_survey_is(monkeypatch, capsys):
    monkeypatch.setattr(command, "find_spec", lambda _name: None)
    assert main(["stability", "--quick"]) == 1
    assert "python3 python/run.py stability --quick" in capsys.readouterr().err


def test_a_wrong_word_is_told_the_nearest(capsys):
    for words, nearest in ((["stabilty"], "stability"), (["random", "1", "--fmily", "solids"], "--family")):
        with pytest.raises(SystemExit):
            run_tool(words)
        assert f'did you mean "{nearest}"' in capsys.readouterr().err
    assert parser().parse_args(["random", "3"]).family == "lattice"


def test_the_twin_of_a_scene_is_made(tmp_path):
    assert find_spec("pythonfmu")
    assert exit_status(lambda: run_tool(["twin", "hanging", "-o", str(tmp_path / "twin.fmu")])) == 0
    with zipfile.ZipFile(tmp_path / "twin.fmu") as fmu:
        assert {"resources/softffd_twin/rotation.py", "resources/softffd_twin/twin/model.py"} <= set(fmu.namelist())
