"""`softffd sweep`: a scene or an FMU over a grid of values, and the files of it."""

from __future__ import annotations

import argparse
import math
import os
import time as clock
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from softffd.errors import SoftffdError
from softffd.files import require_writable
from softffd.run.progress import ProgressLine
from softffd.run.sweep import sweep
from softffd.run.tables import package
from softffd.spelling import number_in

CONNECTING, WORKERS = 10.0, 60.0  # so long a scheduler may take to answer, and a cluster to have its first worker [s]

WANTED = "NAME=FROM:TO:COUNT, NAME=FROM:TO:COUNT:log or NAME=V1,V2,..., e.g. --vary stiffness.edge=500:2000:4:log"


def run_sweep(options: argparse.Namespace, start_values: dict[str, str]) -> None:
    """Makes what is missing of the sweep, keeps it and says what came out."""
    vary = dict(_varied(text) for text in options.vary)
    if len(vary) < len(options.vary):
        raise SoftffdError("--vary: wanted each variable once")
    folder = options.output or Path(f"softffd-sweep-{Path(options.what).stem}")
    require_writable(folder)
    jobs = None if options.scheduler else os.cpu_count() if options.jobs is None else options.jobs
    began = clock.monotonic()
    with executor_at(options.scheduler) as executor, ProgressLine("sweeping") as line:

        def progress(done: int, total: int) -> None:
            line.note(f"{done} of {total} runs, {clock.monotonic() - began:.0f} s", at_once=done == total)

        table = sweep(
            options.what, vary, outputs=options.measure, stop_time=options.stop_time, step=options.step, start_values=start_values,
            inputs={} if options.no_input else options.input, tolerance=options.tolerance, method=options.method,
            jobs=jobs, executor=executor, file=folder / "sweep.npz", progress=progress,
        )  # fmt: skip
    files = [folder / "sweep.npz", table.to_csv(folder / "sweep.csv")]
    if len(table.values) <= 2:
        table.plot(folder / "sweep.png", outputs=list(table.outputs)[:30])
        files.append(folder / "sweep.png")
    _say(table, files, folder)


@contextmanager
def executor_at(scheduler: str | None) -> Iterator[Executor | None]:
    """Of the Dask cluster at an address; none without one."""
    if scheduler is None:
        yield None
        return
    distributed = package("distributed", "--scheduler", "clusters")
    try:
        client = distributed.Client(scheduler, timeout=CONNECTING, set_as_default=False)
    except (OSError, ValueError) as error:  # nobody is there; no address
        why = f"no Dask scheduler answered within {CONNECTING:g} s" if isinstance(error, OSError) else str(error)
        raise SoftffdError(f"--scheduler: wanted the address of one, such as tcp://host:8786, got {scheduler}: {why}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKERS)
        except TimeoutError:
            raise SoftffdError(f"--scheduler: wanted a cluster with workers, that at {scheduler} had none for {WORKERS:g} s") from None
        yield client.get_executor(pure=False)


def _say(table: Any, files: list[Path], folder: Path) -> None:
    failures = table.failures
    print(f"{table.about['title']}\n  {table.done.size} runs, {len(failures)} failed")
    for name, column in table.outputs.items():
        if np.isfinite(column).any():
            print(f"  {name}: {np.nanmin(column):.6g} to {np.nanmax(column):.6g} {table.about['units'][name]}".rstrip())
    for values, words in failures[:3]:
        print(f"  failed with {', '.join(f'{name} = {value}' for name, value in values.items())}: {words}")
    print(f"  kept in {folder}: {', '.join(file.name for file in files)}")


def _varied(text: str) -> tuple[str, list[Any]]:
    """The name and the values of a --vary."""
    name, _, given = text.partition("=")
    parts = given.strip().split(":")
    if not name.strip() or not given.strip() or (len(parts) > 1 and len(parts) not in (3, 4)) or parts[3:] not in ([], ["log"]):
        raise SoftffdError(f"--vary {text}: wanted {WANTED}")
    if len(parts) == 1:
        return name.strip(), [_value(each.strip()) for each in given.split(",")]
    try:
        first, last, count = map(number_in, parts[:3])
    except ValueError:
        raise SoftffdError(f"--vary {text}: wanted {WANTED}") from None
    if not (math.isfinite(first) and math.isfinite(last) and 1 <= count <= 1_000_000 and count.is_integer()):
        raise SoftffdError(f"--vary {text}: wanted finite ends and a whole count of 1 to 1000000")
    if parts[3:] and not (first > 0 and last > 0):
        raise SoftffdError(f"--vary {text}: wanted ends > 0 for values by a factor")
    return name.strip(), (np.geomspace if parts[3:] else np.linspace)(first, last, int(count)).tolist()


def _value(text: str) -> float | str:
    """A number, or the name of a value."""
    try:
        return number_in(text)
    except ValueError:
        return text
