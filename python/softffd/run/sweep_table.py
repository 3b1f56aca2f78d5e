"""The table of a sweep, and the files it is kept in."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from softffd.files import replacing, table_text, write_text
from softffd.run.result import Columns
from softffd.run.result_file import UNREADABLE, damaged, read_arrays, write_arrays
from softffd.run.sweep_plan import Index, Plan
from softffd.run.tables import package

COMPARED = ("fmu", "library", "values", "outputs", "start_values", "inputs", "stop_time", "step", "tolerance", "method")


@dataclass(frozen=True, eq=False, repr=False)
class Sweep:
    """Outputs over the grid of the varied values. The grid has an axis for each of `values`, in their order."""

    values: dict[str, np.ndarray]
    """The values (n,) of each varied variable, numbers or names"""
    outputs: dict[str, np.ndarray]
    """Each output over the grid; NaN where the run failed or is still to come"""
    messages: np.ndarray
    """Over the grid: the words of a run that failed, empty for others"""
    done: np.ndarray
    """Over the grid: whether the run is made"""
    about: dict[str, Any]
    """title, units by name, stop_time and step [s], and what tells one sweep from another"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", Columns(self.values, "varied variable"))
        object.__setattr__(self, "outputs", Columns(self.outputs, "output"))

    @classmethod
    def empty(cls, plan: Plan) -> Sweep:
        """Of a sweep that has not begun."""
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
        """Enters a run: its outputs in their order, or the words of what failed."""
        if isinstance(result, str):
            self.messages[index] = result
        else:
            for column, value in zip(self.outputs.values(), result, strict=True):
                column[index] = value
        self.done[index] = True

    @property
    def failures(self) -> list[tuple[dict[str, Any], str]]:
        """The values and the words of each run that failed."""
        return [(self._at(index), str(self.messages[index])) for index in np.ndindex(self.done.shape) if self.messages[index]]

    def _at(self, index: Index) -> dict[str, Any]:
        return {name: values[i].item() for i, (name, values) in zip(index, self.values.items(), strict=True)}

    def differences(self, other: Sweep) -> list[str]:
        """What of the question is not the same; empty for the same sweep."""
        return [key.replace("_", " ") for key in COMPARED if self.about.get(key) != other.about.get(key)]

    # ---- files and other forms ----

    def save(self, file: str | Path) -> Path:
        """Writes an NPZ file with an array for each varied variable and each output; it appears whole or not at all."""
        own = {"sweep.done": self.done, "sweep.messages": self.messages.astype(str), "sweep.about": json.dumps(self.about)}
        arrays: dict[str, Any] = {**self.values, **self.outputs, **own}
        Path(file).parent.mkdir(parents=True, exist_ok=True)
        with replacing(file) as stream:
            write_arrays(stream, arrays)
        return Path(file)

    @classmethod
    def load(cls, file: str | Path) -> Sweep:
        """A saved sweep; SoftffdError for a file that is none."""
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
        """Writes a row for each run: values, outputs, and the words of what failed."""
        rows = (
            [*self._at(index).values(), *(f"{column[index]:.17g}" for column in self.outputs.values()), self.messages[index]]
            for index in np.ndindex(self.done.shape)
        )
        write_text(file, table_text([*self.values, *self.outputs, "failure"], rows))
        return Path(file)

    def to_xarray(self) -> Any:
        """An xarray.Dataset: the varied variables are its dimensions, the outputs its variables. SoftffdError where xarray is missing."""
        xarray = package("xarray", "to_xarray", "datasets")
        units = self.about["units"]
        data = {name: (tuple(self.values), column, {"units": units[name]}) for name, column in self.outputs.items()}
        axes = {name: (name, values, {"units": units[name]}) for name, values in self.values.items()}
        return xarray.Dataset(data, axes, {"title": self.about["title"]})

    def plot(self, file: str | Path | None = None, *, outputs: Iterable[str] | str | None = None) -> Any:
        """A matplotlib Figure of some outputs, all by default: lines over one varied variable, maps over two; written where `file` says."""
        from softffd.show.sweep import draw

        names = self.outputs if outputs is None else [outputs] if isinstance(outputs, str) else outputs
        chosen = {name: self.outputs[name] for name in names}
        return draw(self.about["title"], self.values, chosen, self.about["units"], self.messages != "", file)
