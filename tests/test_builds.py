"""Another compiler and another instruction set give the same bits: zig's compiler (clang) in the place of the machine's, as releases are
built, and the machine's without the clones for wide registers. Both are held against the fingerprint.
"""

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


@pytest.fixture(scope="session", params=["zig", "baseline"])
def library(request) -> Path:
    if request.param == "baseline":
        options = ["-DCMAKE_CXX_FLAGS=-DSOFTFFD_NO_CLONES"]
    else:
        try:
            options = [f"-DCMAKE_CXX_COMPILER={importers.installed('zig')};{ZIG_OPTIONS}"]
        except importers.Missing as missing:
            pytest.skip(str(missing))
    folder = cpp_tests.ROOT / "build" / request.param
    cpp_tests.build(folder, "-DCMAKE_BUILD_TYPE=Release", *options, target="softffd")
    (found,) = folder.glob("binaries/linux64/softffd.so")
    return found


@pytest.mark.parametrize("part", range(1, PARTS + 1))
def test_another_build_gives_the_same_bits(library, part):
    compare = [cpp_tests.ROOT / "tests" / "support" / "fingerprint.py", "compare", "--library", library, "--part", f"{part}/{PARTS}", "-j1"]
    done = subprocess.run([sys.executable, *compare], capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert re.search(r"^[1-9]\d* entries, 0 differ$", done.stdout, re.MULTILINE), done.stdout
