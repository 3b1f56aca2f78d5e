"""A process for each instruction set, which measures the rows that it is asked for: the library chooses its loops when it is loaded."""

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
"""The column of a library that is given by its file, with the widest instructions."""
NUMBA = {"avx2": "haswell", "baseline": "x86-64"}
"""What numba calls a processor that has these instructions and no wider ones."""
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")}


def instruction_sets() -> list[str]:
    """Those of this processor that the library has loops for, the widest first; where they are not known, what it takes by itself."""
    table = Path("/proc/cpuinfo")
    flags = re.search(r"^flags\s*:(.*)$", table.read_text(), re.MULTILINE) if table.is_file() else None
    if not flags or os.uname().machine != "x86_64":
        return ["widest"]
    known = flags[1].split()
    return [name for name, flag in (("avx512", "avx512f"), ("avx2", "avx2")) if flag in known] + ["baseline"]


def compiler(library: Path) -> str | None:
    """What made a library, where that stands in it."""
    said = re.search(rb"GCC: \([^)]*\) [\d.]+|(?:zig|clang) version [\w.]+", library.read_bytes())
    return said[0].decode() if said else None


def build() -> dict[str, Any]:
    """What made the library that is measured, and with which flags, as far as it is known."""
    flags = re.search(r"^  FLAGS = (.*)$", NATIVE.read_text(), re.MULTILINE) if NATIVE.is_file() else None
    counting = [word for word in flags[1].split() if re.match("-(O|f(?!file)|m|std)", word)] if flags else None
    return {"compiler": compiler(installed.host_library()), "flags": " ".join(dict.fromkeys(counting)) if counting else None}


def environment(name: str) -> dict[str, str]:
    """Of a column's process: the library and numba's baselines have the same instructions. numba adds the processor's own features to a
    name unless it is told that there are none."""
    kept = {key: value for key, value in os.environ.items() if key != "SOFTFFD_INSTRUCTIONS"} | ONE_THREAD
    if name not in ("widest", OTHER):
        kept["SOFTFFD_INSTRUCTIONS"] = name
    return kept | ({"NUMBA_CPU_NAME": NUMBA[name], "NUMBA_CPU_FEATURES": ""} if name in NUMBA else {})


def serve(name: str, library: Path | None, *, quick: bool) -> int:
    """Measures the rows whose names come in, a line each, until there are no more; in the other library's column with that one."""
    if name == OTHER:
        installed.host_library = lambda: library.resolve()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what others print is not for the table
    for line in sys.stdin:
        print(json.dumps(measure(ROWS[line.strip()], quick=quick)), file=answers, flush=True)
    return 0


class Columns:
    """The processes. Use as a context manager."""

    def __init__(self, sets: list[str], library: Path | None, *, quick: bool):
        self._processes = {name: self._begun(name, library, quick) for name in sets}

    @staticmethod
    def _begun(name: str, library: Path | None, quick: bool) -> subprocess.Popen:
        words = ["--quick"] * quick + (["--library", str(library)] if library else [])
        command = [sys.executable, str(BENCH), "--column", name, *words]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        return subprocess.Popen(command, env=environment(name), start_new_session=True, **pipes)  # which Ctrl-C does not reach

    def measure(self, name: str, row: str) -> dict[str, Any]:
        """What the column comes to; SoftffdError where its process has ended."""
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
