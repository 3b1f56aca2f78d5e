"""The sanitizers of addresses and of undefined behaviour find nothing: in the C++ tests, and in the fingerprint's scenes and cases,
whose bits stay the same. The flags are those of the preset asan-ubsan; the build is one of its own, build/sanitized.
"""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import cpp_tests

FOLDER = cpp_tests.ROOT / "build" / "sanitized"
PRESET = ("--preset", "asan-ubsan", "-DSOFTFFD_WERROR=OFF")  # a sanitizer brings warnings of its own, another with every compiler
PARTS = 8
"""Parts of the fingerprint, each of some minutes at most."""
PATIENCE = 1800.0
"""Time [s] in which any test has ended, also on a busy machine."""
REPORT = re.compile(r"runtime error:|ERROR: \w+Sanitizer|Sanitizer CHECK failed")

FAULTS = {1: "ERROR: AddressSanitizer: heap-buffer-overflow", 2: "runtime error: signed integer overflow"}
"""Of tests/support/cpp/faults.cpp: what is said of each."""

pytestmark = pytest.mark.full
bundled_with_programs = pytest.mark.bundle("all that is sanitized")
bundled_with_results = pytest.mark.bundle("the sanitized library")


@pytest.fixture(scope="session")
def runtime(tmp_path_factory) -> str:
    """The libraries that a process loads first where it loads sanitized ones later, as LD_PRELOAD wants them."""
    program = tmp_path_factory.mktemp("runtime") / "nothing"
    compiler = shlex.split(os.environ.get("CXX", "c++"))
    try:
        command = [*compiler, "-x", "c++", "-", "-fsanitize=address,undefined", "-o", program]
        subprocess.run(command, input="int main() {}", capture_output=True, text=True, check=True)
        loaded = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        loaded = ""
    found = re.findall(r"lib[au]\w*san\S* => (/\S+)", loaded)
    if len(found) < 2:
        pytest.skip("the compiler has no sanitizer runtime that Python can load")
    return " ".join(found)


@pytest.fixture(scope="session")
def library(runtime) -> Path:
    cpp_tests.build(FOLDER, *PRESET, target="softffd")
    (found,) = FOLDER.glob("binaries/*/softffd.so")
    return found


@pytest.fixture(scope="session")
def programs(runtime) -> Path:
    cpp_tests.build(FOLDER, *PRESET)
    return FOLDER


@pytest.fixture(scope="session")
def faults(runtime) -> Path:
    """The folder of the program and of the library with faults."""
    for target in ("faults", "faults_library"):
        cpp_tests.build(FOLDER, *PRESET, target=target)
    return FOLDER / "tests" / "core"


@pytest.fixture(scope="session")
def preloaded(runtime) -> dict[str, str]:
    """Python itself leaves allocations to the system when it ends: leaks are not looked for."""
    return dict(os.environ) | {"LD_PRELOAD": runtime, "ASAN_OPTIONS": "detect_leaks=0"}


def run(command: list, environment: dict[str, str] | None = None) -> tuple[int, str]:
    """Status and all that is printed."""
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE)
    return done.returncode, done.stdout


def compare(library: Path, *options: str) -> list:
    """The command that compares results of this library with the fingerprint."""
    return [sys.executable, cpp_tests.ROOT / "tests" / "support" / "fingerprint.py", "compare", "--library", library, *options]


@bundled_with_programs
@pytest.mark.parametrize("source", cpp_tests.SOURCES, ids=cpp_tests.source_id)
def test_a_program_runs_without_a_report(programs, source):
    cpp_tests.check(programs, source, patience=PATIENCE)


@bundled_with_results
@pytest.mark.parametrize("part", range(1, PARTS + 1))
def test_results_have_their_bits_without_a_report(library, preloaded, part):
    status, said = run(compare(library, "--part", f"{part}/{PARTS}"), preloaded)
    assert status == 0 and not REPORT.search(said), said[-6000:]
    assert re.search(r"^[1-9]\d* entries, 0 differ$", said, re.MULTILINE), said


@bundled_with_results
@pytest.mark.parametrize(("number", "report"), FAULTS.items(), ids=["address", "undefined"])
def test_a_fault_is_reported(faults, preloaded, number, report):
    load = f"import ctypes; ctypes.CDLL({str(faults / 'faults.so')!r}).fault"
    for command, environment in [([faults / "faults"], None), ([sys.executable, "-c"], preloaded)]:
        arguments = [f"{load}({n})" for n in (0, number)] if environment else ["0", str(number)]
        sound, wrong = (run([*command, argument], environment) for argument in arguments)
        assert sound == (0, ""), sound[1]
        assert wrong[0] != 0 and report in wrong[1] and REPORT.search(wrong[1]), wrong[1]


@bundled_with_results
def test_the_comparison_loads_the_sanitized_library(library):
    """Without the runtime it says so and ends, which another library would not."""
    status, said = run(compare(library, "scene standard, leapfrog"))
    assert status != 0 and "ASan runtime does not come first" in said
