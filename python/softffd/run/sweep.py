"""Runs a scene or an FMU for every combination of some values."""

from __future__ import annotations

import multiprocessing
import time as clock
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import SoftffdError
from softffd.run.inputs import Source
from softffd.run.sweep_plan import Plan, plan_of
from softffd.run.sweep_runs import runner
from softffd.run.sweep_table import Sweep

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

KEEP_EVERY = 10.0
"""The file of a sweep is written so often [s]."""


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
    require_workers(jobs, executor)
    settings = {key: value for key, value in (("tolerance", tolerance), ("method", method)) if value is not None}
    plan = plan_of(scene_or_fmu, vary, outputs, stop_time, step, start_values, inputs, settings)
    file = None if file is None else Path(file)
    table = _begun(plan, file)
    missing = [index for index in np.ndindex(plan.shape) if not table.done[index]]
    kept = clock.monotonic()
    try:
        processes = min(jobs or 1, max(2, len(missing)))
        with runner(processes, executor) as make, closing(make(plan, missing)) as runs:  # an interrupt ends what is under way
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


def require_workers(jobs: int | None, executor: Executor | None) -> None:
    """SoftffdError where there cannot be so many processes, or where the executor is none."""
    if jobs is not None and executor is not None:
        raise SoftffdError("jobs: wanted without an executor, whose workers decide how many runs there are at a time")
    if executor is not None and not hasattr(executor, "submit"):
        raise SoftffdError(f"executor: wanted one of concurrent.futures, got {type(executor).__name__}")
    if jobs is not None and jobs < 1:
        raise SoftffdError(f"jobs: wanted at least 1, got {jobs}")
    if (jobs or 1) > 1 and multiprocessing.current_process().daemon:
        raise SoftffdError(f"jobs: a daemonic process, as those of multiprocessing.Pool are, starts no others; wanted jobs=1, got {jobs}")
