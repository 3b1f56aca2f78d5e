"""The runs of a sweep: one component, opened once and reset between them; in this process, in several, or on any executor of
concurrent.futures, whose workers get the FMU as bytes with all that the runs need."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, Future, as_completed
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import softffd
from softffd.errors import FmuError, SoftffdError
from softffd.fmu.block import KINDS, Blocks
from softffd.run.guard import Lost, guarded
from softffd.run.simulation import Simulation
from softffd.run.sweep.plan import END, Index, Plan
from softffd.run.times import step_lengths

FOLD: dict[str, Callable[[np.ndarray], Any]] = {END: lambda column: column[-1], "max": np.max, "min": np.min, "mean": np.mean}

MOST_TOGETHER = 200
"""Runs that a process makes at most before a new one takes over"""
PATIENCE = 1e6
"""A single run may take this long [s]."""
CHUNKS, TOGETHER = 64, 50
"""Runs go to an executor in about so many chunks, of so many runs at most: an interrupt loses what is in them"""
LOST = "the worker process ended, each time that it was tried"

Readings = np.ndarray | str
"""Of a run what was read (r,), or the words of what failed"""


def made(plan: Plan, indices: Sequence[Index], jobs: int, executor: Executor | None) -> Generator[tuple[Index, Readings]]:
    """Each run of the grid with its readings, as they come; leaving the iteration early ends or takes back what is under way."""
    if executor is not None:
        yield from _on_executor(executor, plan, indices)
    elif jobs == 1:
        yield from zip(indices, run_all(plan, indices), strict=True)
    else:
        together = min(MOST_TOGETHER, math.ceil(len(indices) / (4 * jobs)) or 1)
        for index, result in guarded(partial(run_all, plan), indices, lambda _index: PATIENCE, jobs, together):
            if isinstance(result, Lost) and result.how == "fault":
                raise RuntimeError(result.words)
            yield index, result.words if isinstance(result, Lost) else result


def run_all(plan: Plan, indices: Sequence[Index]) -> Iterator[Readings]:
    """The readings of some runs. After a failure the component is opened anew."""
    if plan.folder:
        os.chdir(plan.folder)
    runner: Runner | None = None
    try:
        for index in indices:
            result: Readings
            try:
                runner = runner or Runner(plan)
                result = runner.run(plan.start(index))
            except FmuError as error:
                result = str(error)
                if runner:
                    runner.close()
                runner = None
            yield result
    finally:
        if runner:
            runner.close()


class Runner:
    """An opened component with the buffers of its runs."""

    def __init__(self, plan: Plan):
        self._plan = plan
        self._simulation = Simulation(plan.source)
        component = self._simulation.component
        variables = list(dict.fromkeys(component.variable(reading.name) for reading in plan.readings))
        self._inputs = Blocks(component, [component.variable(name) for name in plan.driven])
        self._blocks = [component.block_of(some) for kind in KINDS if (some := [v for v in variables if v.kind == kind])]
        self._times = plan.times.tolist()
        self._steps = step_lengths(plan.times, plan.step)
        self._rows = [np.zeros((len(self._times), len(block.names))) for block in self._blocks]
        self._follows = any(reading.fold != END for reading in plan.readings)
        self.close = self._simulation.close

    def run(self, start_values: dict[str, Any]) -> np.ndarray:
        """The readings of one run from its start; the bits are those of `simulate`. FmuError with the time where it fails."""
        simulation, plan = self._simulation, self._plan
        simulation.restart(start_values=start_values, stop_time=plan.stop_time, **plan.settings)
        self._drive(0)
        simulation.initialize()
        try:
            for row, step in enumerate(self._steps):
                if row:
                    self._drive(row)
                if self._follows:
                    self._record(row)
                simulation.step(step, end=self._times[row + 1])
        except FmuError as error:
            raise FmuError(f"at {simulation.time:g} s: {error}") from None
        self._record(-1)
        columns = {name: rows[:, n] for block, rows in zip(self._blocks, self._rows, strict=True) for n, name in enumerate(block.names)}
        return np.array([FOLD[reading.fold](columns[reading.name]) for reading in plan.readings], dtype=float)

    def _drive(self, row: int) -> None:
        if self._inputs.names:
            self._inputs.set(self._plan.course[row])

    def _record(self, row: int) -> None:
        for block, rows in zip(self._blocks, self._rows, strict=True):
            rows[row] = block.get()


# ---- on an executor ----


def _on_executor(executor: Executor, plan: Plan, indices: Sequence[Index]) -> Iterator[tuple[Index, Readings]]:
    """Runs whose worker ended are tried again, one at a time: what ends its worker then is a failed run. SoftffdError where workers have
    another version or the executor takes nothing any more."""
    if not indices:
        return
    fmu, sent = _bytes_of(plan), replace(plan, source=Path(), folder="")
    together = min(TOGETHER, math.ceil(len(indices) / CHUNKS))
    given: dict[Future[list[Readings]], Sequence[Index]] = {}

    def give(runs: Sequence[Index]) -> Future[list[Readings]]:
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


def run_elsewhere(plan: Plan, fmu: bytes, runs: Sequence[Index], version: str) -> list[Readings]:
    """The results of some runs, on a worker."""
    if softffd.__version__ != version:
        raise SoftffdError(f"executor: a worker has softffd {softffd.__version__}, wanted {version}")
    with TemporaryDirectory(prefix="softffd-") as folder:
        file = Path(folder) / "swept.fmu"
        file.write_bytes(fmu)
        return list(run_all(replace(plan, source=file), runs))


def _results(future: Future[list[Readings]]) -> list[Readings] | None:
    """Of some runs; none where their worker ended, by the name of the error's type: BrokenProcessPool, TerminatedWorkerError of loky,
    KilledWorker of Dask."""
    try:
        return future.result()
    except SoftffdError:
        raise
    except Exception as error:
        if any(part in type(error).__name__ for part in ("Broken", "Terminated", "Killed")):
            return None
        raise SoftffdError(f"executor: could not make the runs: {type(error).__name__}: {error}") from None


def _bytes_of(plan: Plan) -> bytes:
    if isinstance(plan.source, Path):
        return plan.source.read_bytes()
    from softffd.fmu.package import package_fmu

    with TemporaryDirectory(prefix="softffd-") as folder:
        return package_fmu(plan.source, Path(folder) / "swept.fmu").read_bytes()
