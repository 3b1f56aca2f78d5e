"""A process for each instruction set, which measures rows on request. The library chooses its loops when it is loaded."""

from __future__ import annotations

import contextlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from measured import ROWS, measure

from softffd import installed
from softffd.errors import SoftffdError

BENCH = Path(__file__).resolve().parent / "bench.py"
NATIVE = BENCH.parents[1] / "build" / "native" / "build.ninja"
OTHER = "other library"
"""Name of the column of a library given by its file, with the widest instructions"""
NUMBA = {"avx2": "haswell", "baseline": "x86-64"}
"""numba's name of a processor that has these instructions and no wider ones"""
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")}


def instruction_sets() -> list[str]:
    """Returns the instruction sets of this processor for which the library has loops, the widest first.

    If the sets are not known, the only name is "widest", the library's own choice."""
    table = Path("/proc/cpuinfo")
    flags = re.search(r"^flags\s*:(.*)$", table.read_text(), re.MULTILINE) if table.is_file() else None
    if not flags or os.uname().machine != "x86_64":
        return ["widest"]
    known = flags[1].split()
    return [name for name, flag in (("avx512", "avx512f"), ("avx2", "avx2")) if flag in known] + ["baseline"]


def compiler(library: Path) -> str | None:
    """Returns the compiler that a library file names, or None."""
    said = re.search(rb"GCC: \([^)]*\) [\d.]+|(?:zig|clang) version [\w.]+", library.read_bytes())
    return said[0].decode() if said else None


def build() -> dict[str, Any]:
    """Returns the compiler and the flags of the measured library, as far as known."""
    flags = re.search(r"^  FLAGS = (.*)$", NATIVE.read_text(), re.MULTILINE) if NATIVE.is_file() else None
    counting = [word for word in flags[1].split() if re.match("-(O|f(?!file)|m|std)", word)] if flags else None
    return {"compiler": compiler(installed.host_library()), "flags": " ".join(dict.fromkeys(counting)) if counting else None}


def environment(name: str) -> dict[str, str]:
    """Returns the environment of a column's process, in which the library and numba's baselines use the same instructions. numba adds the
    features of the processor to a name unless the environment states that there are none."""
    kept = {key: value for key, value in os.environ.items() if key != "SOFTFFD_INSTRUCTIONS"} | ONE_THREAD
    if name not in ("widest", OTHER):
        kept["SOFTFFD_INSTRUCTIONS"] = name
    return kept | ({"NUMBA_CPU_NAME": NUMBA[name], "NUMBA_CPU_FEATURES": ""} if name in NUMBA else {})


def serve(name: str, library: Path | None, *, quick: bool) -> int:
    """Measures the rows whose names are read from stdin, a line each, until its end. The column OTHER measures `library`."""
    if name == OTHER:
        installed.host_library = lambda: library.resolve()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # output of other code must not enter the answers
    for line in sys.stdin:
        print(json.dumps(measure(ROWS[line.strip()], quick=quick)), file=answers, flush=True)
    return 0


class Columns:
    """The measuring processes by column. Use as a context manager."""

    def __init__(self, sets: list[str], library: Path | None, *, quick: bool):
        self._processes = {name: self._begun(name, library, quick) for name in sets}

    @staticmethod
    def _begun(name: str, library: Path | None, quick: bool) -> subprocess.Popen:
        words = ["--quick"] * quick + (["--library", str(library)] if library else [])
        command = [sys.executable, str(BENCH), "--column", name, *words]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        return subprocess.Popen(command, env=environment(name), start_new_session=True, **pipes)  # unreachable for Ctrl-C

    def measure(self, name: str, row: str) -> dict[str, Any]:
        """Returns the result of a row in a column. Raises SoftffdError if the process of the column has ended."""
        process = self._processes[name]
        with contextlib.suppress(BrokenPipeError):
            print(row, file=process.stdin, flush=True)
        if not (answer := process.stdout.readline()):
            raise SoftffdError(f"bench: {row}, {name}: the process that measured ended with status {process.wait()}")
        return json.loads(answer)

    def __enter__(self) -> Columns:
        return self

    def __exit__(self, *_exception: object) -> None:
        for process in self._processes.values():
            process.terminate()
        for process in self._processes.values():
            process.communicate()
