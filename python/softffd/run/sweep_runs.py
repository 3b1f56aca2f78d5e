"""Makes the runs of a plan: in this process, in several, or on an executor of concurrent.futures, whose workers get the FMU as bytes. A
component is opened once and reset between its runs."""

import math
import sys
import tempfile
import time as clock
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Executor, Future, as_completed
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing.context import SpawnContext, SpawnProcess
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np

import softffd
from softffd.errors import FmuError, SoftffdError
from softffd.run.drive import Drive
from softffd.run.simulation import Simulation
from softffd.run.sweep_plan import COURSE, END, Index, Plan

FOLD: dict[str, Callable[[np.ndarray], Any]] = {
    END: lambda column: column[-1], "max": np.max, "min": np.min, "mean": np.mean, COURSE: lambda column: column,
}  # fmt: skip
CHUNKS, TOGETHER = 64, 50  # approximate number of an executor's chunks of runs, most runs in one
CHUNK_TIME = 2.0  # a chunk ends with the run in which it becomes this old [s], its other runs follow later: an interrupt loses no more
LOST = "the worker process ended, each time that it was tried"

Readings = np.ndarray | str  # the values read from a run (r,), (r, T) for whole courses; or the message of its failure
Make = Callable[[Plan, Sequence[Index]], Generator[tuple[Index, Readings]]]
"""Makes runs of a plan and yields each when it is done. Leaving the iteration early ends or cancels the runs under way."""


@contextmanager
def runner(jobs: int, executor: Executor | None) -> Iterator[Make]:
    """Yields the function that makes runs; processes and opened components are kept until the block ends."""
    if executor is not None:
        yield lambda plan, indices: _on_executor(executor, plan, indices)
    elif jobs == 1:
        opened: dict[int, Opened] = {}
        try:
            yield lambda plan, indices: _here(opened, plan, indices)
        finally:
            for each in opened.values():
                each.close()
    else:
        with _processes(jobs) as pool:
            yield lambda plan, indices: _by_futures(lambda runs: pool.schedule(run_list, (plan, runs)), indices, 8 * jobs)


# ---- here ----


class Opened:
    """A component that is opened for the first run of its plan and kept; after a failure it is opened anew."""

    _simulation: Simulation | None = None

    def run(self, plan: Plan, index: Index) -> Readings:
        """Returns the readings of a run, whose bits are those of `simulate`, or the message of its failure. plan: the same each time,
        but for its values."""
        try:
            if self._simulation is None:
                simulation = self._simulation = Simulation(plan.source)
                names = plan.driven, dict.fromkeys(each.name for each in plan.readings)
                driven, read = ([simulation.component.variable(name) for name in some] for some in names)
                self._drive = Drive(simulation, plan.times, plan.step, driven, read)
                self._drive.input_rows[:-1] = plan.course
            self._simulation.restart(start_values=plan.start(index), stop_time=plan.stop_time, **plan.settings)
            self._drive.apply(0)
            self._simulation.initialize()
            return _read(self._simulation, self._drive, plan)
        except FmuError as error:
            self.close()
            return str(error)

    def close(self) -> None:
        """Frees the component."""
        if self._simulation:
            self._simulation.close()
        self._simulation = None


def _here(opened: dict[int, Opened], plan: Plan, indices: Sequence[Index]) -> Generator[tuple[Index, Readings]]:
    """Yields runs made in this process. opened: by the identity of their plans' times, which plans that differ only in values share."""
    one = opened.setdefault(id(plan.times), Opened())
    for index in indices:
        yield index, one.run(plan, index)


def run_list(plan: Plan, runs: Sequence[Index]) -> list[Readings]:
    """Returns the results of the first of some runs, made in a process of this machine: those of CHUNK_TIME, at least one."""
    opened, results, began = Opened(), [], clock.monotonic()
    try:
        for index in runs:
            results.append(opened.run(plan, index))
            if clock.monotonic() - began > CHUNK_TIME:
                break
        return results
    finally:
        opened.close()


def _read(simulation: Simulation, drive: Drive, plan: Plan) -> np.ndarray:
    """Does the steps of a run and returns its readings; FmuError with the time at which the run fails."""
    try:
        for _ in drive.run():
            pass
    except FmuError as error:
        raise FmuError(f"at {simulation.time:g} s: {error}") from None
    columns = drive.columns()
    return np.array([FOLD[reading.fold](columns[reading.name]) for reading in plan.readings], dtype=float)


# ---- elsewhere ----


def _on_executor(executor: Executor, plan: Plan, indices: Sequence[Index]) -> Generator[tuple[Index, Readings]]:
    if not indices:
        return
    fmu, sent = _bytes_of(plan), replace(plan, source=Path())
    yield from _by_futures(lambda runs: executor.submit(run_elsewhere, sent, fmu, runs, softffd.__version__), indices, CHUNKS)


def _by_futures(
    submit: Callable[[Sequence[Index]], Future[list[Readings]]], indices: Sequence[Index], chunks: int
) -> Generator[tuple[Index, Readings]]:
    """Yields runs as they are done; runs that a chunk had no time for are given again. Runs whose worker ended are tried again, one at a
    time; a run that ends its worker again counts as failed. SoftffdError if workers have another version or the executor takes no more
    runs."""
    together = max(1, min(TOGETHER, math.ceil(len(indices) / chunks)))
    given: dict[Future[list[Readings]], Sequence[Index]] = {}

    def give(runs: Sequence[Index]) -> Future[list[Readings]]:
        try:
            future = submit(runs)
        except RuntimeError as error:  # the executor is broken or shut down
            raise SoftffdError(f"executor: takes no runs any more: {error}") from None
        given[future] = runs
        return future

    try:
        begun = [give(indices[n : n + together]) for n in range(0, len(indices), together)]
        suspects: list[Index] = []
        while begun:
            rest: list[Future[list[Readings]]] = []
            for future in as_completed(begun):
                runs, results = given.pop(future), _results(future)
                if results is None:
                    suspects += runs
                    continue
                yield from zip(runs, results, strict=False)
                if later := runs[len(results) :]:
                    rest.append(give(later))
            begun = rest
        for run in suspects:
            yield run, (_results(give([run])) or [LOST])[0]
    finally:
        for future in given:
            future.cancel()


def run_elsewhere(plan: Plan, fmu: bytes, runs: Sequence[Index], version: str) -> list[Readings]:
    """Returns the results of the first of some runs, see `run_list`, made on a worker of an executor."""
    if softffd.__version__ != version:
        raise SoftffdError(f"executor: a worker has softffd {softffd.__version__}, wanted {version}")
    with TemporaryDirectory(prefix="softffd-") as folder:
        file = Path(folder) / "swept.fmu"
        file.write_bytes(fmu)
        return run_list(replace(plan, source=file), runs)


def _results(future: Future[list[Readings]]) -> list[Readings] | None:
    """Returns the results of a chunk; None if its worker ended, which the name of the error's type shows: ProcessExpired of pebble,
    BrokenProcessPool, TerminatedWorkerError of loky, KilledWorker of Dask."""
    try:
        return future.result()
    except SoftffdError:
        raise
    except Exception as error:
        if any(part in type(error).__name__ for part in ("Expired", "Broken", "Terminated", "Killed")):
            return None
        raise SoftffdError(f"executor: could not make the runs: {type(error).__name__}: {error}") from None


def _bytes_of(plan: Plan) -> bytes:
    if isinstance(plan.source, Path):
        return plan.source.read_bytes()
    from softffd.fmu.package import package_fmu

    with TemporaryDirectory(prefix="softffd-") as folder:
        return package_fmu(plan.source, Path(folder) / "swept.fmu").read_bytes()


class _Process(SpawnProcess):
    """A process that does not run the user's script again; the script need not be written for that."""

    def start(self) -> None:
        script = sys.modules["__main__"]
        sys.modules["__main__"] = ModuleType("__main__")
        try:
            super().start()
        finally:
            sys.modules["__main__"] = script


class _Context(SpawnContext):
    Process = _Process


@contextmanager
def _processes(count: int) -> Iterator[Any]:
    """Yields a pool of `count` processes of this machine, which end with the block; their temporary files are then deleted."""
    from pebble import ProcessPool

    with TemporaryDirectory(prefix="softffd-", ignore_cleanup_errors=True) as scratch:
        pool = ProcessPool(count, initializer=_begin_process, initargs=(scratch,), context=_Context())
        try:
            yield pool
        finally:
            pool.stop()
            pool.join()


def _begin_process(scratch: str) -> None:
    tempfile.tempdir = scratch
