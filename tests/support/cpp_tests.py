"""The C++ tests of tests/core and tests/fmi/library: where they are, how they are built, and what one says that has passed."""

import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from locks import one_at_a_time

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted([*ROOT.glob("tests/core/**/test_*.cpp"), *ROOT.glob("tests/fmi/library/test_*.cpp")])
APART = ("test_allocation", "test_failing_memory", "test_first_exception", "test_load_library")
"""Programs of their own (tests/fmi/CMakeLists.txt)"""


def source_id(source: Path) -> str:
    """A test's name in a parametrised one."""
    return f"{source.parent.name}-{source.stem}"


def build(folder: Path, *options: str, target: str = "all") -> None:
    """Configures and builds the target; of several processes one does, and the others find it."""
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    configure = ["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *options, "-DSOFTFFD_TESTS=ON", f"-DPython3_EXECUTABLE={sys.executable}"]
    with one_at_a_time(folder):
        for command in [configure, ["cmake", "--build", folder, "--target", target]]:
            done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
            assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


def check(folder: Path, source: Path, environment: Mapping[str, str] | None = None, *, patience: float = 300) -> None:
    """Runs the program that the folder has of this source; patience [s]."""
    room = folder / "tests" / source.relative_to(ROOT / "tests").parts[0]
    program = [room / source.stem] if source.stem in APART else [room / f"{room.name}_tests", source.stem]
    done = subprocess.run(program, env=environment, capture_output=True, text=True, timeout=patience)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[:6000]
    assert " tests, 0 failed checks" in done.stdout and not done.stdout.endswith("\n0 tests, 0 failed checks\n")
