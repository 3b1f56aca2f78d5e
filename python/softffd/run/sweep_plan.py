"""The plan of a sweep, checked against the FMU before the first run."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from softffd.errors import FmuError, UnknownName
from softffd.fmu.block import number_of
from softffd.fmu.component import Component
from softffd.fmu.interface import ScalarVariable
from softffd.names import components_in, parse_name
from softffd.run.drive import communication_points, positive
from softffd.run.inputs import Inputs, Source
from softffd.run.parts import at_point
from softffd.run.simulation import Simulation, run_source
from softffd.spelling import wanted_one_of

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

END, COURSE, FOLDS = "end", "course", ("max", "min", "mean")
MOST_RUNS = 10_000_000
SETTABLE = ("parameter", "input")

Index = tuple[int, ...]  # indices of a run in the grid


class Reading(NamedTuple):
    """A value that is read from a run: an output at the end of the run, or folded over its communication points."""

    fold: str  # "end", "max", "min" or "mean"; for a fit "course", all values
    name: str

    def __str__(self) -> str:
        return self.name if self.fold == END else f"{self.fold}({self.name})"


@dataclass(frozen=True)
class Plan:
    """All that a worker needs, and what distinguishes one sweep from another. The plan is sent to other processes."""

    source: Scene | Path
    given: dict[str, list[Any]]  # the values of each varied variable as they were given: numbers or names
    numbers: dict[str, list[Any]]  # the numbers that stand for these values; for a String, its texts
    readings: tuple[Reading, ...]
    start_values: dict[str, Any]
    settings: dict[str, Any]  # tolerance and method of all runs, if they are given
    stop_time: float
    step: float
    times: np.ndarray  # the communication points (T,) [s]
    driven: tuple[str, ...]  # names of the inputs over time
    course: np.ndarray  # values of these inputs (T - 1, m) from each communication point to the next
    about: dict[str, Any]  # title, units and the fingerprints of the FMU and its library

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the grid."""
        return tuple(map(len, self.numbers.values()))

    def start(self, index: Index) -> dict[str, Any]:
        """Returns the start values of one run of the grid."""
        return self.start_values | {name: numbers[i] for i, (name, numbers) in zip(index, self.numbers.items(), strict=True)}


def plan_of(
    scene_or_fmu: Scene | str | Path, vary: Mapping[str, Iterable[Any]], outputs: Iterable[str] | str | None, *, stop_time: float | None,
    step: float | None, start_values: Mapping[str, Any] | None, inputs: Source | None, **given: Any,
) -> Plan:  # fmt: skip
    """Returns the plan of a sweep, see `sweep`; FmuError for a request that this FMU cannot meet. given: tolerance and method."""
    settings = {key: value for key, value in given.items() if value is not None}
    what = run_source(scene_or_fmu, "sweep")
    what = what.absolute() if isinstance(what, Path) else what  # for processes that start in another folder
    if inputs is None and not isinstance(what, Path):
        inputs = what.default_inputs
    with Simulation(what, start_values=start_values, **settings) as simulation:
        component = simulation.component
        interface = component.interface
        stop_time = positive("stop time", stop_time, interface.stop_time)
        step = positive("communication step", step, interface.step)
        source = Inputs(inputs, variables=component.by_name)
        driven = [variable.name for variable in source.driven(component)]
        started = [name for given in start_values or {} for name in simulation.block(given).names]
        source.require_undriven(started, driven)
        varied = _varied(component, vary, driven, source.where)
        if lost := next((name for name in [*started, *(["solver.method"] if settings.get("method") else [])] if name in varied), None):
            raise FmuError(f"{lost}: is varied, so that its start value would be lost: leave out one of the two")
        numbers = {name: [number_of(component.variable(name), value) for value in values] for name, values in varied.items()}
        for name, column in numbers.items():
            if wrong := [number for number in column if not (isinstance(number, str) or math.isfinite(number))]:
                raise FmuError(f"{name}: wanted finite numbers, got {wrong[0]:g}")
        readings = _readings(component, outputs)
        if (count := math.prod(map(len, numbers.values()))) * len(readings) > MOST_RUNS:
            raise FmuError(f"vary: {count} runs of {len(readings)} outputs; wanted at most {MOST_RUNS:g} values: vary less, or read less")
        times = communication_points(stop_time, step, bytes_each=8 * (len(driven) + len(readings) + 1))
        course = source.rows(times)
        units = {name: component.variable(name).unit or "" for name in [*varied, *(reading.name for reading in readings)]}
        about = {
            "title": interface.title, "fmu": interface.guid, "library": component.library_hash(), "units": units,
            "inputs": hashlib.sha256("\n".join(driven).encode() + course.tobytes()).hexdigest() if driven else "",
        }  # fmt: skip
        return Plan(
            what, varied, numbers, readings, dict(start_values or {}), settings, stop_time, step, times, tuple(driven), course, about,
        )  # fmt: skip


def _varied(component: Component, vary: Mapping[str, Iterable[Any]], driven: Sequence[str], where: str) -> dict[str, list[Any]]:
    if not isinstance(vary, Mapping) or not vary:
        raise FmuError(f"vary: wanted values by name, such as {{'stiffness.edge': [1e3, 2e3]}}, got {vary!r:.70}")
    found: dict[str, list[Any]] = {}
    for name, values in vary.items():
        variable = component.by_name.get(name)
        if variable is None or variable.causality not in SETTABLE:
            raise UnknownName(_not_varied(component, str(name), variable, driven))
        if variable.name in driven:
            raise FmuError(f"{name}: cannot be varied: {where.removesuffix(': ')} gives it (or its velocity) over time")
        if variable.name in found:
            raise FmuError(f"{name}: wanted each variable once, got it in both forms of its name")
        found[variable.name] = _listed(str(name), values)
    return found


def _not_varied(component: Component, name: str, variable: ScalarVariable | None, driven: Sequence[str]) -> str:
    free = [v.name for v in component.by_name.values() if v.causality in SETTABLE and v.name not in driven]
    single = [each for each in free if not at_point(each)]
    points = sorted({f"{found.family}[i,j,k].{found.component}" for each in free if (found := parse_name(each)) and at_point(each)})
    why = f"it is an {variable.causality}" if variable else "the FMU has no such parameter or input" + component.hint(name, free)
    return f"{name}: cannot be varied: {why}; those that can: {', '.join(single + points)}"


def _listed(name: str, values: Iterable[Any]) -> list[Any]:
    try:
        listed = [] if isinstance(values, str) else [value.item() if isinstance(value, np.generic) else value for value in values]
    except TypeError:
        listed = []
    if not listed:
        raise FmuError(f"{name}: wanted a list of values, got {values!r:.70}")
    return listed


def _readings(component: Component, outputs: Iterable[str] | str | None) -> tuple[Reading, ...]:
    every = component.numbers("output")
    if outputs is None:
        outputs = [name for name in every if not at_point(name)]
    asked = list(outputs) if isinstance(outputs, Iterable) and not isinstance(outputs, str) else [outputs]
    if not asked:
        raise FmuError("outputs: wanted at least one, such as 'position[0,0,0].z' or 'max(position[0,0,0].z)', got none")
    return tuple(dict.fromkeys(reading for text in asked for reading in _reading(component, str(text), every)))


def _reading(component: Component, text: str, every: list[str]) -> list[Reading]:
    """Returns the readings that a text means: one, or one for each component of a vector."""
    call = re.fullmatch(r"\s*(\w+)\s*\((.*)\)\s*", text)
    fold, name = (call[1], call[2].strip()) if call else (END, text.strip())
    if call and fold not in FOLDS:
        raise FmuError(f"{text}: {wanted_one_of(FOLDS, fold)}")
    names = [name] if name in component.by_name else components_in(component.by_name, name).values()
    variables = [component.by_name[each] for each in names]
    other = next(("String" if v.causality == "output" else v.causality for v in variables if v.name not in every), "")
    if other or not variables:
        what = f"an output, got the FMU's {other} of that name" if other else "an output of the FMU, which has none of this name"
        raise UnknownName(f"{text}: wanted {what}{component.hint(name, every)}")
    return [Reading(fold, variable.name) for variable in variables]
