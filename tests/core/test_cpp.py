"""Builds and runs the C++ tests of tests/core and tests/fmi."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from locks import one_at_a_time

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted([*ROOT.glob("tests/core/**/test_*.cpp"), *ROOT.glob("tests/fmi/test_*.cpp")])


@pytest.fixture(scope="session")
def built() -> Path:
    """The folder of the built test programs: run.py builds the library there too, so that objects are compiled once."""
    folder = ROOT / "build" / "native"
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    options = ["-DCMAKE_BUILD_TYPE=Release", "-DSOFTFFD_TESTS=ON", f"-DPython3_EXECUTABLE={sys.executable}"]
    with one_at_a_time(folder):
        for command in [["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *options], ["cmake", "--build", folder]]:
            done = subprocess.run(command, env=environment, capture_output=True, text=True)
            assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return folder


@pytest.mark.parametrize("source", SOURCES, ids=lambda source: f"{source.parent.name}-{source.stem}")
def test_cpp(built: Path, source: Path) -> None:
    program = built / "tests" / source.relative_to(ROOT / "tests").parts[0] / source.stem
    done = subprocess.run([program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout
    assert " tests, 0 failed checks" in done.stdout and not done.stdout.endswith("\n0 tests, 0 failed checks\n")
