"""Commands that make many runs, and their files: `softffd sweep`, over a grid of values; `softffd fit`, parameters from measured curves."""

import argparse
import math
import os
import shlex
import time as clock
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from softffd.cli.options import run_options
from softffd.errors import SoftffdError
from softffd.files import require_new, require_writable
from softffd.fitting.fit import fit
from softffd.fitting.result import FILES
from softffd.run.progress import ProgressLine
from softffd.run.sweep import sweep
from softffd.run.tables import package
from softffd.spelling import number_in

CONNECTING, WORKERS = 10.0, 60.0  # longest wait for a scheduler's answer, and for a cluster's first worker [s]
WANTED = "NAME=FROM:TO:COUNT, NAME=FROM:TO:COUNT:log or NAME=V1,V2,..., e.g. --vary stiffness.edge=500:2000:4:log"


def run_sweep(options: argparse.Namespace) -> None:
    """Makes the missing runs of the sweep, keeps the results and prints a summary."""
    vary = dict(_varied(text) for text in options.vary)
    if len(vary) < len(options.vary):
        raise SoftffdError("--vary: wanted each variable once")
    folder = options.output or Path(f"softffd-sweep-{Path(options.what).stem}")
    require_writable(folder)
    began = clock.monotonic()
    with _workers(options) as workers, ProgressLine("sweeping") as line:

        def progress(done: int, total: int) -> None:
            line.note(f"{done} of {total} runs, {clock.monotonic() - began:.0f} s", at_once=done == total)

        table = sweep(
            options.what, vary, outputs=options.measure, file=folder / "sweep.npz", progress=progress, **run_options(options), **workers
        )
    files = [folder / "sweep.npz", table.to_csv(folder / "sweep.csv")]
    if len(table.values) <= 2:
        table.plot(folder / "sweep.png", outputs=list(table.outputs)[:30])
        files.append(folder / "sweep.png")
    _say(table, files, folder)


def _say(table: Any, files: list[Path], folder: Path) -> None:
    failures = table.failures
    print(f"{table.about['title']}\n  {table.done.size} runs, {len(failures)} failed")
    for name, column in table.outputs.items():
        if np.isfinite(column).any():
            print(f"  {name}: {np.nanmin(column):.6g} to {np.nanmax(column):.6g} {table.about['units'][name]}".rstrip())
    for values, words in failures[:3]:
        print(f"  failed with {', '.join(f'{name} = {value}' for name, value in values.items())}: {words}")
    print(f"  kept in {folder}: {', '.join(file.name for file in files)}")
    if len(failures) == table.done.size:
        raise SoftffdError(f"sweep: wanted runs that succeed, got {len(failures)} that failed, the first with: {failures[0][1]}")


def _varied(text: str) -> tuple[str, list[Any]]:
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
    try:
        return number_in(text)
    except ValueError:
        return text


def run_fit(options: argparse.Namespace) -> None:
    """Fits the parameters, keeps the result and prints a summary."""
    vary = dict(_started(text) for text in options.vary)
    if len(vary) < len(options.vary):
        raise SoftffdError("--vary: wanted each parameter once")
    folder = options.output or Path(f"softffd-fit-{Path(options.scenes[0]).stem}")
    require_new([folder / name for name in FILES], "another folder by -o DIR", overwrite=options.overwrite)
    require_writable(folder)
    began = clock.monotonic()
    with _workers(options) as workers, ProgressLine("fitting") as line:

        def progress(runs: int, residual: float) -> None:
            line.note(f"{runs} runs, {clock.monotonic() - began:.0f} s; residual {residual:.4g}")

        found = fit(
            options.scenes, options.data, options.match, vary, against=options.against, recorded=options.recorded, noise=options.noise,
            progress=progress, **run_options(options), **workers,
        )  # fmt: skip
        files = found.save(folder)
    print(found)
    print(f"  kept in {folder}: {', '.join(file.name for file in files)}")
    given = [f"{name}={value:.6g}" for name, value in found.values.items()]
    print(f"  a run with these values: softffd run {shlex.quote(options.scenes[0])} {' '.join(f'--set {each}' for each in given)}")


def _started(text: str) -> tuple[str, float | None]:
    name, equals, start = (part.strip() for part in text.partition("="))
    try:
        if name and (start or not equals):
            return name, number_in(start) if equals else None
    except ValueError:
        pass
    raise SoftffdError(f"--vary {text}: wanted NAME or NAME=START, e.g. --vary youngs_modulus=1e6")


@contextmanager
def _workers(options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Yields the arguments of `sweep` and `fit` for who makes the runs: processes of this machine, or the Dask cluster at an address."""
    if (scheduler := options.scheduler) is None:
        yield {"jobs": os.cpu_count() if options.jobs is None else options.jobs}
        return
    distributed = package("distributed", "--scheduler", "clusters")
    try:
        distributed.comm.get_address_host(scheduler)  # ValueError; a client of such an address would end only after 20 s
        client = distributed.Client(scheduler, timeout=CONNECTING, set_as_default=False)
    except (OSError, ValueError) as error:  # OSError: nobody answers; ValueError: no valid address
        why = f"no Dask scheduler answered within {CONNECTING:g} s" if isinstance(error, OSError) else str(error)
        raise SoftffdError(f"--scheduler: wanted the address of one, such as tcp://host:8786, got {scheduler}: {why}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKERS)
        except TimeoutError:
            raise SoftffdError(f"--scheduler: wanted a cluster with workers, that at {scheduler} had none for {WORKERS:g} s") from None
        yield {"executor": client.get_executor(pure=False)}
