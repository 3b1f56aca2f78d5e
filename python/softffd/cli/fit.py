"""`softffd fit`: parameters of scenes or FMUs from measured curves, and the files of it."""

from __future__ import annotations

import argparse
import os
import shlex
import time as clock
from pathlib import Path

from softffd.cli.sweep import executor_at
from softffd.errors import SoftffdError
from softffd.files import require_new, require_writable
from softffd.fitting.fit import fit
from softffd.fitting.result import FILES
from softffd.run.progress import ProgressLine
from softffd.spelling import number_in


def run_fit(options: argparse.Namespace, start_values: dict[str, str]) -> None:
    """Fits, keeps the result and says what came out."""
    vary = dict(_varied(text) for text in options.vary)
    if len(vary) < len(options.vary):
        raise SoftffdError("--vary: wanted each parameter once")
    folder = options.output or Path(f"softffd-fit-{Path(options.scenes[0]).stem}")
    if not options.overwrite:
        require_new([folder / name for name in FILES], "another folder by -o DIR")
    require_writable(folder)
    jobs = None if options.scheduler else os.cpu_count() if options.jobs is None else options.jobs
    began = clock.monotonic()
    with executor_at(options.scheduler) as executor, ProgressLine("fitting") as line:

        def progress(runs: int, residual: float) -> None:
            line.note(f"{runs} runs, {clock.monotonic() - began:.0f} s; residual {residual:.4g}")

        found = fit(
            options.scenes, options.data, options.match, vary, against=options.against, recorded=options.recorded, noise=options.noise,
            stop_time=options.stop_time, step=options.step, start_values=start_values,
            inputs={} if options.no_input else options.input, tolerance=options.tolerance, method=options.method,
            jobs=jobs, executor=executor, progress=progress,
        )  # fmt: skip
        files = found.save(folder)
    print(found)
    print(f"  kept in {folder}: {', '.join(file.name for file in files)}")
    given = [f"{name}={value:.6g}" for name, value in found.values.items()]
    print(f"  a run with these values: softffd run {shlex.quote(options.scenes[0])} {' '.join(f'--set {each}' for each in given)}")


def _varied(text: str) -> tuple[str, float | None]:
    """Name and start of a --vary."""
    name, equals, start = (part.strip() for part in text.partition("="))
    try:
        if name and (start or not equals):
            return name, number_in(start) if equals else None
    except ValueError:
        pass
    raise SoftffdError(f"--vary {text}: wanted NAME or NAME=START, e.g. --vary youngs_modulus=1e6")
