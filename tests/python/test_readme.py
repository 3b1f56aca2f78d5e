"""Every example of the README runs, in the order in which it stands there."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", (ROOT / "README.md").read_text(), re.MULTILINE | re.DOTALL)
THIS_SUITE = "python3 python/run.py test"


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Where a reader would work: the scene of the README saved under the name that it gives."""
    folder = tmp_path_factory.mktemp("reader")
    (folder / "box.toml").write_text(next(text for kind, text in BLOCKS if kind == "toml"))
    return folder


def command_lines() -> list[str]:
    lines = [line.split("#")[0].strip() for kind, text in BLOCKS if kind == "sh" for line in text.splitlines()]
    return [line for line in lines if line and line != THIS_SUITE]


def run(command: list, folder: Path) -> str:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(command, cwd=folder, env=os.environ | {"PATH": path}, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_readme_has_its_examples():
    assert THIS_SUITE in (ROOT / "README.md").read_text()
    assert len(command_lines()) >= 6 and sum(kind == "python" for kind, _ in BLOCKS) >= 3


@pytest.mark.parametrize("line", command_lines())
def test_command_runs(line, folder):
    words = line.replace("python3 python/run.py", "softffd").split()  # run.py hands over to the same program once it has set up
    run([sys.executable, "-m", *words], folder)


@pytest.mark.parametrize("code", [text for kind, text in BLOCKS if kind == "python"])
def test_script_runs(code, folder):
    if not (folder / "box.fmu").exists():
        run([sys.executable, "-m", "softffd", "build", "box.toml"], folder)
    assert run([sys.executable, "-c", code], folder)


def test_the_coupled_plate_presses_with_its_weight(folder):
    code = next(text for kind, text in BLOCKS if kind == "python" and "Component" in text)
    if not (folder / "box.fmu").exists():
        run([sys.executable, "-m", "softffd", "build", "box.toml"], folder)
    newtons = float(re.search(r"with (\S+) N", run([sys.executable, "-c", code], folder))[1])
    assert newtons == pytest.approx(5 * 9.81, rel=1e-2)


def test_every_file_that_the_readme_names_exists():
    text = (ROOT / "README.md").read_text()
    for name in re.findall(r"`((?:python|fmu_src|tests|modelDescription|docs)/[\w/.]+)`", text):
        assert (ROOT / name).exists(), name
