"""The runs of a sweep on any executor of concurrent.futures: the FMU goes to its workers as bytes, with all that the runs need."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future, as_completed
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import softffd
from softffd.errors import SoftffdError
from softffd.fmu.package import package_fmu
from softffd.run.sweep.plan import Plan
from softffd.run.sweep.worker import run_all

CHUNKS, TOGETHER = 64, 50
"""Runs go to the workers in about so many chunks, of so many runs at most: an interrupt loses what is in them"""
LOST = "the worker process ended, each time that it was tried"

Index = tuple[int, ...]
Results = list[np.ndarray | str]


def on_executor(executor: Executor, plan: Plan, indices: Sequence[Index]) -> Iterator[tuple[Index, np.ndarray | str]]:
    """Each run with its readings (r,), or the words of what failed, as they come from the workers.

    Runs whose worker ended are tried again, one at a time: what ends its worker then is a failed run. SoftffdError where workers have
    another version or the executor takes nothing any more. Leaving the iteration early takes back what has not begun.
    """
    if not indices:
        return
    fmu, sent = _bytes_of(plan), replace(plan, source=Path(), folder="")
    together = min(TOGETHER, math.ceil(len(indices) / CHUNKS))
    given: dict[Future[Results], Sequence[Index]] = {}

    def give(runs: Sequence[Index]) -> Future[Results]:
        try:
            future = executor.submit(run_elsewhere, sent, fmu, runs, softffd.__version__)
        except RuntimeError as error:  # it is broken or shut down
            raise SoftffdError(f"executor: takes no runs any more: {error}") from None
        given[future] = runs
        return future

    try:
        begun = [give(indices[n : n + together]) for n in range(0, len(indices), together)]
        suspects: list[Index] = []
        for future in as_completed(begun):
            runs, results = given.pop(future), _results(future)
            if results is None:
                suspects += runs
            else:
                yield from zip(runs, results, strict=True)
        for run in suspects:
            yield run, (_results(give([run])) or [LOST])[0]
    finally:
        for future in given:
            future.cancel()


def run_elsewhere(plan: Plan, fmu: bytes, runs: Sequence[Index], version: str) -> Results:
    """The results of some runs, on a worker: one component is opened, and reset between them."""
    if softffd.__version__ != version:
        raise SoftffdError(f"executor: a worker has softffd {softffd.__version__}, wanted {version}")
    with _as_file(fmu) as file:
        return list(run_all(replace(plan, source=file), runs))


def _results(future: Future[Results]) -> Results | None:
    """Of some runs; none where their worker ended."""
    try:
        return future.result()
    except SoftffdError:
        raise
    except Exception as error:
        if _tells_of_a_lost_worker(error):
            return None
        raise SoftffdError(f"executor: could not make the runs: {type(error).__name__}: {error}") from None


def _tells_of_a_lost_worker(error: Exception) -> bool:
    """By the name of its type: BrokenProcessPool, TerminatedWorkerError of loky, KilledWorker of Dask."""
    return any(part in type(error).__name__ for part in ("Broken", "Terminated", "Killed"))


@contextmanager
def _as_file(fmu: bytes) -> Iterator[Path]:
    with TemporaryDirectory(prefix="softffd-") as folder:
        file = Path(folder) / "swept.fmu"
        file.write_bytes(fmu)
        yield file


def _bytes_of(plan: Plan) -> bytes:
    if isinstance(plan.source, str | Path):
        return Path(plan.source).read_bytes()
    with TemporaryDirectory(prefix="softffd-") as folder:
        return package_fmu(plan.source, Path(folder) / "swept.fmu").read_bytes()
