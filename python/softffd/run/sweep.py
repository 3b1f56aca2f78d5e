"""Runs a scene or an FMU for every combination of some values: in this process, in several, or on any executor of concurrent.futures,
whose workers get the FMU as bytes. A component is opened once and reset between its runs."""

from __future__ import annotations

import math
import multiprocessing
import sys
import tempfile
import time as clock
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, as_completed
from contextlib import closing, contextmanager
from dataclasses import replace
from multiprocessing.context import SpawnContext, SpawnProcess
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

import softffd
from softffd.errors import FmuError, SoftffdError
from softffd.run.drive import Drive
from softffd.run.inputs import Source
from softffd.run.simulation import Simulation
from softffd.run.sweep_plan import END, Index, Plan, plan_of
from softffd.run.sweep_table import Sweep

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

FOLD: dict[str, Callable[[np.ndarray], Any]] = {END: lambda column: column[-1], "max": np.max, "min": np.min, "mean": np.mean}
KEEP_EVERY = 10.0
"""The file of a sweep is written so often [s]."""
CHUNKS, TOGETHER = 64, 50
"""Runs go to an executor in about so many chunks, of so many runs at most: an interrupt loses what is in them"""
LOST = "the worker process ended, each time that it was tried"

Readings = np.ndarray | str
"""Of a run what was read (r,), or the words of what failed"""


def sweep(
    scene_or_fmu: Scene | str | Path,
    vary: Mapping[str, Iterable[Any]],
    *,
    outputs: Iterable[str] | str | None = None,
    stop_time: float | None = None,
    step: float | None = None,
    start_values: Mapping[str, Any] | None = None,
    inputs: Source | None = None,
    tolerance: float | None = None,
    method: str | None = None,
    jobs: int | None = None,
    executor: Executor | None = None,
    file: str | Path | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Sweep:
    """Runs every combination of the values in `vary` and returns a table of outputs; the numbers are those of `simulate`.

    scene_or_fmu: a scene, the path of its file, the name of a shipped one, or the path of an FMU.
    vary: values by the name of a parameter or input of the FMU.
    outputs: names, for the value at the end of the run, or "max(NAME)", "min(NAME)", "mean(NAME)" over its communication points; a
    vector's name means its components. By default all outputs but those at control points.
    stop_time, step, start_values, inputs, tolerance, method: of every run, as for `simulate`. What `inputs` or start
        values give cannot be varied.
    jobs: processes, by default this one. In more than one a run that takes its process down is a failed run too.
    executor: any of concurrent.futures, such as `client.get_executor()` of a distributed.Client, MPIPoolExecutor of mpi4py, or loky's: the
    runs are made by its workers, which need the same softffd and no files. It stays open; where it goes on without a worker that a run
    took down, that is a failed run too.
    file: NPZ file that keeps what is done, written whole or not at all: of an interrupted sweep the same call makes what is missing.
    progress: called as progress(runs done, runs of the sweep).
    A run that fails is NaN in the table, with its words. Raises FmuError where a name or a value cannot be used in any run, and
    SoftffdError where `file` holds another sweep.
    """
    if jobs is not None and executor is not None:
        raise SoftffdError("jobs: wanted without an executor, whose workers decide how many runs there are at a time")
    if executor is not None and not hasattr(executor, "submit"):
        raise SoftffdError(f"executor: wanted one of concurrent.futures, got {type(executor).__name__}")
    if jobs is not None and jobs < 1:
        raise SoftffdError(f"jobs: wanted at least 1, got {jobs}")
    if (jobs or 1) > 1 and multiprocessing.current_process().daemon:
        raise SoftffdError(f"jobs: a daemonic process, as those of multiprocessing.Pool are, starts no others; wanted jobs=1, got {jobs}")
    settings = {key: value for key, value in (("tolerance", tolerance), ("method", method)) if value is not None}
    plan = plan_of(scene_or_fmu, vary, outputs, stop_time, step, start_values, inputs, settings)
    file = None if file is None else Path(file)
    table = _begun(plan, file)
    missing = [index for index in np.ndindex(plan.shape) if not table.done[index]]
    kept = clock.monotonic()
    try:
        with closing(_made(plan, missing, jobs or 1, executor)) as runs:  # an interrupt ends what is under way
            for count, (index, result) in enumerate(runs, table.done.size - len(missing) + 1):
                table.note(index, result)
                if file is not None and clock.monotonic() - kept > KEEP_EVERY:
                    table.save(file)
                    kept = clock.monotonic()
                if progress:
                    progress(count, table.done.size)
    except KeyboardInterrupt:
        if file is None:
            raise
        raise KeyboardInterrupt(
            f"{table.done.sum()} of {table.done.size} runs are kept in {file}, the same call goes on from there"
        ) from None
    finally:
        if file is not None:
            table.save(file)
    return table


def _begun(plan: Plan, file: Path | None) -> Sweep:
    """The table as it is in the file, else an empty one; SoftffdError where the file holds something else or cannot be written."""
    table = Sweep.empty(plan)
    if file is None:
        return table
    if not file.exists():
        table.save(file)
        return table
    kept = Sweep.load(file)
    if others := kept.differences(table):
        raise SoftffdError(f"{file}: holds another sweep: other {', '.join(others)}; wanted the same one, or another file")
    return kept


# ---- here ----


def run_all(plan: Plan, indices: Sequence[Index]) -> Iterator[Readings]:
    """The readings of some runs, whose bits are those of `simulate`. After a failure the component is opened anew."""
    simulation: Simulation | None = None
    try:
        for index in indices:
            result: Readings
            try:
                if simulation is None:
                    simulation = Simulation(plan.source)
                    drive = _drive(simulation, plan)
                simulation.restart(start_values=plan.start(index), stop_time=plan.stop_time, **plan.settings)
                drive.apply(0)
                simulation.initialize()
                result = _read(simulation, drive, plan)
            except FmuError as error:
                result = str(error)
                if simulation:
                    simulation.close()
                simulation = None
            yield result
    finally:
        if simulation:
            simulation.close()


def _drive(simulation: Simulation, plan: Plan) -> Drive:
    variable = simulation.component.variable
    read = dict.fromkeys(variable(reading.name) for reading in plan.readings)
    drive = Drive(simulation, plan.times, plan.step, [variable(name) for name in plan.driven], list(read))
    drive.input_rows[:-1] = plan.course
    return drive


def _read(simulation: Simulation, drive: Drive, plan: Plan) -> np.ndarray:
    """The readings of a run from its first step on; FmuError with the time where it fails."""
    try:
        for _ in drive.run():
            pass
    except FmuError as error:
        raise FmuError(f"at {simulation.time:g} s: {error}") from None
    columns = drive.columns()
    return np.array([FOLD[reading.fold](columns[reading.name]) for reading in plan.readings], dtype=float)


# ---- elsewhere ----


def _made(plan: Plan, indices: Sequence[Index], jobs: int, executor: Executor | None) -> Generator[tuple[Index, Readings]]:
    """Each run of the grid with its readings, as they come; leaving the iteration early ends or takes back what is under way."""
    if not indices:
        return
    if executor is not None:
        fmu, sent = _bytes_of(plan), replace(plan, source=Path())
        yield from _by_futures(lambda runs: executor.submit(run_elsewhere, sent, fmu, runs, softffd.__version__), indices, CHUNKS)
    elif jobs == 1:
        yield from zip(indices, run_all(plan, indices), strict=True)
    else:
        with _processes(min(jobs, len(indices))) as pool:
            yield from _by_futures(lambda runs: pool.schedule(run_list, (plan, runs)), indices, 8 * jobs)


def _by_futures(
    submit: Callable[[Sequence[Index]], Future[list[Readings]]], indices: Sequence[Index], chunks: int
) -> Iterator[tuple[Index, Readings]]:
    """Runs whose worker ended are tried again, one at a time: what ends its worker then is a failed run. SoftffdError where workers have
    another version or the executor takes nothing any more."""
    together = min(TOGETHER, math.ceil(len(indices) / chunks))
    given: dict[Future[list[Readings]], Sequence[Index]] = {}

    def give(runs: Sequence[Index]) -> Future[list[Readings]]:
        try:
            future = submit(runs)
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


def run_list(plan: Plan, runs: Sequence[Index]) -> list[Readings]:
    """The results of some runs, in a process of this machine."""
    return list(run_all(plan, runs))


def run_elsewhere(plan: Plan, fmu: bytes, runs: Sequence[Index], version: str) -> list[Readings]:
    """The results of some runs, on a worker of an executor."""
    if softffd.__version__ != version:
        raise SoftffdError(f"executor: a worker has softffd {softffd.__version__}, wanted {version}")
    with TemporaryDirectory(prefix="softffd-") as folder:
        file = Path(folder) / "swept.fmu"
        file.write_bytes(fmu)
        return run_list(replace(plan, source=file), runs)


def _results(future: Future[list[Readings]]) -> list[Readings] | None:
    """Of some runs; none where their worker ended, by the name of the error's type: ProcessExpired of pebble, BrokenProcessPool,
    TerminatedWorkerError of loky, KilledWorker of Dask."""
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
    """A process that does not run the user's script again, which need not be made for that."""

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
    """A pool of so many processes of this machine, which end with the block; their temporary files go then."""
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
