"""Runs a scene or an FMU for every combination of some values: the resulting table, and its files."""

from __future__ import annotations

import json
import multiprocessing
import time as clock
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import SoftffdError
from softffd.files import path_with, replacing, table_text, write_text
from softffd.run.inputs import Source
from softffd.run.result import Columns
from softffd.run.result_file import UNREADABLE, damaged, read_arrays, write_arrays
from softffd.run.sweep_plan import Index, Plan, plan_of
from softffd.run.sweep_runs import runner
from softffd.run.tables import package
from softffd.spelling import whole_number

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

COMPARED = ("fmu", "library", "values", "outputs", "start_values", "inputs", "stop_time", "step", "tolerance", "method")
KEEP_EVERY = 10.0  # interval at which the file of a sweep is written [s]


def sweep(
    scene_or_fmu: Scene | str | Path, vary: Mapping[str, Iterable[Any]], *, outputs: Iterable[str] | str | None = None,
    stop_time: float | None = None, step: float | None = None, start_values: Mapping[str, Any] | None = None, inputs: Source | None = None,
    tolerance: float | None = None, method: str | None = None, jobs: int | None = None, executor: Executor | None = None,
    file: str | Path | None = None, progress: Callable[[int, int], object] | None = None,
) -> Sweep:  # fmt: skip
    """Runs every combination of the values in `vary` and returns a table of outputs; the numbers are those of `simulate`.

    scene_or_fmu: a scene, the path of its file, the name of a shipped one, or the path of an FMU.
    vary: values by the name of a parameter or input of the FMU.
    outputs: names, for the value at the end of the run, or "max(NAME)", "min(NAME)", "mean(NAME)" over its communication points; a
        vector's name means its components. By default all outputs but those at control points.
    stop_time, step, start_values, inputs, tolerance, method: settings of every run, as for `simulate`. A variable that `inputs` or the
        start values give cannot be varied.
    jobs: number of processes, by default this one. With more than one, a run that takes its process down counts as a failed run too.
    executor: any of concurrent.futures, such as `client.get_executor()` of a distributed.Client, MPIPoolExecutor of mpi4py, or loky's. Its
        workers make the runs; they need the same softffd and no files. The executor stays open; if it goes on without a worker that a run
        took down, that run counts as failed too.
    file: file ending in .npz that keeps the runs that are done, written whole or not at all. After an interrupt the same call makes the
        missing runs.
    progress: called as progress(runs done, runs of the sweep).
    A run that fails is NaN in the table, with its message. Raises FmuError if a name or a value cannot be used in any run, and
    SoftffdError if `file` holds another sweep.
    """
    require_workers(jobs, executor)
    file = None if file is None else path_with(".npz", file)
    plan = plan_of(
        scene_or_fmu, vary, outputs, stop_time=stop_time, step=step, start_values=start_values, inputs=inputs, tolerance=tolerance,
        method=method,
    )  # fmt: skip
    table = _begun(plan, file)
    missing = [index for index in np.ndindex(plan.shape) if not table.done[index]]
    kept = clock.monotonic()
    try:
        processes = min(jobs or 1, max(2, len(missing)))
        with runner(processes, executor) as make, closing(make(plan, missing)) as runs:  # an interrupt ends the runs under way
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
    """Returns the table in the file, else an empty one; SoftffdError if the file holds something else or cannot be written."""
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
    """Raises SoftffdError if so many processes are not possible, or if the executor is none."""
    if jobs is not None and executor is not None:
        raise SoftffdError("jobs: wanted without an executor, whose workers decide how many runs there are at a time")
    if executor is not None and not isinstance(executor, Executor):
        raise SoftffdError(f"executor: wanted one of concurrent.futures, such as client.get_executor(), got {type(executor).__name__}")
    if (1 if jobs is None else whole_number("jobs", jobs, 1)) > 1 and multiprocessing.current_process().daemon:
        raise SoftffdError(f"jobs: a daemonic process, as those of multiprocessing.Pool are, starts no others; wanted jobs=1, got {jobs}")


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """Outputs over the grid of the varied values. The grid has an axis for each of `values`, in their order."""

    values: dict[str, np.ndarray]
    """The values (n,) of each varied variable, numbers or names"""
    outputs: dict[str, np.ndarray]
    """Each output over the grid; NaN where the run failed or is still to come"""
    messages: np.ndarray
    """Over the grid: the message of a run that failed, empty for other runs"""
    done: np.ndarray
    """Over the grid: True if the run is done"""
    about: dict[str, Any]
    """title, units by name, stop_time and step [s], and the settings that distinguish one sweep from another"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", Columns(self.values, "varied variable"))
        object.__setattr__(self, "outputs", Columns(self.outputs, "output"))

    @classmethod
    def empty(cls, plan: Plan) -> Sweep:
        """Returns the table of a sweep that has not begun."""
        names = [str(reading) for reading in plan.readings]
        units = plan.about["units"] | {str(reading): plan.about["units"][reading.name] for reading in plan.readings}
        asked = {
            "values": plan.given, "outputs": names, "start_values": plan.start_values, "stop_time": plan.stop_time, "step": plan.step,
        }  # fmt: skip
        about = json.loads(
            json.dumps(plan.about | asked | plan.settings | {"units": units}, default=lambda value: np.asarray(value).tolist())
        )
        return cls(
            {name: np.array(values) for name, values in plan.given.items()}, {name: np.full(plan.shape, np.nan) for name in names},
            np.full(plan.shape, "", dtype=object), np.zeros(plan.shape, bool), about,
        )  # fmt: skip

    def __repr__(self) -> str:
        grid = " x ".join(f"{name} ({len(values)})" for name, values in self.values.items())
        count = f"{self.done.sum()} of {self.done.size}" if not self.done.all() else f"{self.done.size}"
        return f"<Sweep of {self.about['title']!r}: {grid}; {count} runs, {len(self.failures)} failed; {', '.join(self.outputs)}>"

    def note(self, index: Index, result: np.ndarray | str) -> None:
        """Enters a run: its outputs in their order, or the message of its failure."""
        if isinstance(result, str):
            self.messages[index] = result
        else:
            for column, value in zip(self.outputs.values(), result, strict=True):
                column[index] = value
        self.done[index] = True

    @property
    def failures(self) -> list[tuple[dict[str, Any], str]]:
        """The varied values and the message of each run that failed."""
        return [(self._at(index), str(self.messages[index])) for index in np.ndindex(self.done.shape) if self.messages[index]]

    def _at(self, index: Index) -> dict[str, Any]:
        return {name: values[i].item() for i, (name, values) in zip(index, self.values.items(), strict=True)}

    def differences(self, other: Sweep) -> list[str]:
        """Returns the settings in which two sweeps differ; empty for the same sweep."""
        return [key.replace("_", " ") for key in COMPARED if self.about.get(key) != other.about.get(key)]

    # ---- files and other forms ----

    def save(self, file: str | Path) -> Path:
        """Writes an NPZ file with an array for each varied variable and each output; it appears whole or not at all."""
        own = {"sweep.done": self.done, "sweep.messages": self.messages.astype(str), "sweep.about": json.dumps(self.about)}
        arrays: dict[str, Any] = {**self.values, **self.outputs, **own}
        with replacing(file) as stream:
            write_arrays(stream, arrays)
        return Path(file)

    @classmethod
    def load(cls, file: str | Path) -> Sweep:
        """Returns a saved sweep; SoftffdError for a file that is none."""
        kept = read_arrays(Path(file), "sweep")
        try:
            about = json.loads(str(kept["sweep.about"]))
            values, outputs = ({name: kept[name] for name in about[key]} for key in ("values", "outputs"))
            messages, done = kept["sweep.messages"], kept["sweep.done"]
            words = [about["title"], *(about["units"][name] for name in (*values, *outputs))]
            flat = [(axis.size,) == axis.shape and axis.dtype.kind in "fiubU" for axis in values.values()]
            over_grid = [(column, "f") for column in outputs.values()] + [(messages, "U"), (done, "b")]
            shape = tuple(axis.size for axis in values.values())
            if not (all(flat) and all(isinstance(word, str) for word in words)) or any(
                array.shape != shape or array.dtype.kind != kind for array, kind in over_grid
            ):
                raise ValueError("its arrays are not those of one grid")
            return cls(values, outputs, messages.astype(object), done, about)
        except (KeyError, TypeError, *UNREADABLE) as fault:
            raise damaged(Path(file), "sweep", fault) from None

    def to_csv(self, file: str | Path) -> Path:
        """Writes a row for each run: values, outputs, and the message of a failure. Returns the path of the file."""
        rows = (
            [*self._at(index).values(), *(f"{column[index]:.17g}" for column in self.outputs.values()), self.messages[index]]
            for index in np.ndindex(self.done.shape)
        )
        write_text(file, table_text([*self.values, *self.outputs, "failure"], rows))
        return Path(file)

    def to_xarray(self) -> Any:
        """Returns an xarray.Dataset: varied variables are its dimensions, outputs its variables. SoftffdError if xarray is missing."""
        xarray = package("xarray", "to_xarray", "datasets")
        units = self.about["units"]
        data = {name: (tuple(self.values), column, {"units": units[name]}) for name, column in self.outputs.items()}
        axes = {name: (name, values, {"units": units[name]}) for name, values in self.values.items()}
        return xarray.Dataset(data, axes, {"title": self.about["title"]})

    def plot(self, file: str | Path | None = None, *, outputs: Iterable[str] | str | None = None) -> Any:
        """Returns a matplotlib Figure of outputs, all by default: lines over one variable, maps over two; written to `file` if given."""
        from softffd.show.sweep import draw

        names = self.outputs if outputs is None else [outputs] if isinstance(outputs, str) else outputs
        chosen = {name: self.outputs[name] for name in names}
        return draw(self.about["title"], self.values, chosen, self.about["units"], self.messages != "", file)
