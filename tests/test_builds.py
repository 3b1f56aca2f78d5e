"""Another compiler and other instruction sets give the same bits: zig's compiler (clang) in the place of the machine's, as releases are
built, and file by file, so that each names what it includes; and narrower registers than the processor has. All are held against the
fingerprint.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import cpp_tests
import importers

ZIG_OPTIONS = "-m;ziglang;c++;-target;x86_64-linux-gnu.2.17"
PARTS = 4
"""Parts of the fingerprint, each of some minutes at most."""
PATIENCE = 1800.0
"""Time [s] in which any part has ended, also on a busy machine."""

pytestmark = [
    pytest.mark.full,
    pytest.mark.bundle("other builds"),
    pytest.mark.skipif(sys.platform != "linux", reason="both libraries are built for linux64"),
]


@pytest.fixture(scope="session")
def zig_library() -> Path:
    try:
        options = [f"-DCMAKE_CXX_COMPILER={importers.installed('zig')};{ZIG_OPTIONS}", "-DSOFTFFD_UNITY=OFF"]
    except importers.Missing as missing:
        pytest.skip(str(missing))
    folder = cpp_tests.ROOT / "build" / "zig"
    cpp_tests.build(folder, "-DCMAKE_BUILD_TYPE=Release", *options, target="softffd")
    (found,) = folder.glob("binaries/linux64/softffd.so")
    return found


def require_same_bits(part: int, *options: object, **environment: str) -> None:
    compare = [cpp_tests.ROOT / "tests" / "support" / "fingerprint.py", "compare", "--part", f"{part}/{PARTS}", "-j1", *options]
    done = subprocess.run([sys.executable, *compare], capture_output=True, text=True, timeout=PATIENCE, env=os.environ | environment)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert re.search(r"^[1-9]\d* entries, 0 differ$", done.stdout, re.MULTILINE), done.stdout


@pytest.mark.parametrize("part", range(1, PARTS + 1))
def test_another_compiler_gives_the_same_bits(zig_library, part):
    require_same_bits(part, "--library", zig_library)


@pytest.mark.parametrize("part", range(1, PARTS + 1))
@pytest.mark.parametrize("instructions", ["avx2", "baseline"])
def test_narrower_registers_give_the_same_bits(instructions, part):
    require_same_bits(part, SOFTFFD_INSTRUCTIONS=instructions)
