"""One measured curve and the runs that should reproduce it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import FmuError, UnknownName
from softffd.fitting.branches import OverAnother, at_middles, over_time
from softffd.fitting.measured import Columns, Data, columns_of
from softffd.fitting.parameters import Parameter, parameters_of
from softffd.fmu.component import Component
from softffd.names import is_step_mean, structured
from softffd.run.inputs import Inputs, Source
from softffd.run.simulation import run_source
from softffd.run.sweep_plan import COURSE, Index, Plan, Reading, plan_of
from softffd.spelling import did_you_mean, nearest_of

if TYPE_CHECKING:
    from softffd.scene.scene import Scene


STILL = 1e-9  # relative difference up to which two times are equal


@dataclass(frozen=True)
class Points(Plan):
    """Runs at listed points, not over a grid: the varied values with the same index belong together."""

    def start(self, index: Index) -> dict[str, Any]:
        """Returns the start values of one run."""
        return self.start_values | {name: numbers[index[0]] for name, numbers in self.numbers.items()}


@dataclass(frozen=True)
class Experiment:
    """A measured curve, and what is needed to compute the curve of a run that belongs to it."""

    plan: Points
    title: str
    match: str
    against: str  # name of the quantity that replaces time, or "time"
    units: dict[str, str]
    measured: np.ndarray  # (m,)
    at: np.ndarray  # places of the measured values: (m,), times [s] or values of `against`
    unused: list[str]  # columns of the data that are not used
    mean: bool  # whether the matched variable is a mean over steps, and the data are not
    along_mean: bool  # the same for `against`
    over: OverAnother | None
    course: np.ndarray | None  # values of `against` (T,) if it is an input; else they are read from the run

    def at_points(self, points: Sequence[Mapping[str, float]]) -> Points:
        """Returns the plan of runs with these parameters."""
        return replace(self.plan, numbers={name: [point[name] for point in points] for name in self.plan.numbers})

    def curve(self, readings: np.ndarray, *, strict: bool = False) -> np.ndarray:
        """Returns a run's curve (m,) at the points of the data. readings: (1 or 2, T). Raises FmuError if the branches do not match."""
        times = self.plan.times
        values = at_middles(times, readings[0], mean=self.mean, means=self.mean)
        if self.over is None:
            return over_time(at_middles(times, times, mean=False, means=self.mean), values, self.at)
        along = readings[1] if self.course is None else self.course
        return self.over(at_middles(times, along, mean=self.along_mean, means=self.mean), values, strict=strict)


def experiment_of(
    scene_or_fmu: Scene | str | Path, folder: Path, data: Data, match: str, vary: Mapping[str, Any], against: str | None, recorded: bool,
    inputs: Source | None, *, stop_time: float | None, step: float | None, **how: Any,
) -> tuple[Experiment, list[Parameter]]:  # fmt: skip
    """Returns an experiment and its parameters, after checking everything; see `fit`.

    folder: a temporary one for the FMU of a scene. how: start values, tolerance, method."""
    what = run_source(scene_or_fmu, "fit")
    driven = inputs is not None and not (isinstance(inputs, Mapping) and not inputs)
    if inputs is None and not isinstance(what, Path):
        inputs = what.default_inputs
    file = _as_fmu(what, folder)
    columns = columns_of(data)
    match, against = structured(match), None if against is None else structured(against)
    with Component(file) as component:
        _require_matched(component, match)
        parameters = parameters_of(component, vary)
        along = against or "time"
        if against is not None and against not in component.by_name:
            raise UnknownName(f"against: {against}: the FMU has no such variable{component.hint(against)}")
        measured, at = columns.column(match), columns.column(along)
        timed = "time" in columns.values
        given = columns.inputs(component, {match} if timed and not driven else {match, along})
        if given is not None and driven:
            names = ", ".join((given.dtype.names or ())[1:])
            raise FmuError(f"{columns.where}has columns of inputs, {names}, and `inputs` drives the runs too: leave out one of the two")
        inputs = inputs if given is None else given
        own, title, default_step = component.lattice is not None, component.interface.title, component.interface.step
        played = [] if given is None else list(given.dtype.names or ())
        unused = columns.unused(component, {match, along, *played})
        units = {name: component.by_name[name].unit or "" for name in (match, *([against] if against else []))} | {"time": "s"}
        is_input = against is not None and component.by_name[against].causality == "input"
    if timed and columns.values["time"][0] < 0:
        raise FmuError(f"{columns.where}wanted times >= 0 s, for runs begin at 0 s, got {columns.values['time'][0]:g}")
    if timed:
        stop_time = _stop_time(columns, stop_time, default_step if step is None else step)
    readings = [match] if against is None or is_input else [match, against]
    starts = {parameter.name: [parameter.start] for parameter in parameters}
    plan = plan_of(file, starts, readings, stop_time=stop_time, step=step, inputs=inputs, **how)
    points = Points(**{**vars(plan), "readings": tuple(Reading(COURSE, each.name) for each in plan.readings)})
    over = None if against is None else OverAnother(against, at)
    course = _course(Inputs(inputs, variables=component.by_name), against, points) if against and is_input else None
    mean, along_mean = (own and not recorded and is_step_mean(name) for name in (match, along))
    return Experiment(points, title, match, along, units, measured, at, unused, mean, along_mean, over, course), parameters


def _as_fmu(what: Scene | Path, folder: Path) -> Path:
    """Returns the path of the FMU. A scene's FMU is packaged once for all runs and all workers."""
    if isinstance(what, Path):
        return what.absolute()
    from softffd.fmu.package import package_fmu

    folder.mkdir()
    return package_fmu(what, folder / f"{what.name}.fmu")


def _require_matched(component: Component, match: str) -> None:
    outputs = component.numbers("output")
    if (found := component.by_name.get(match)) is None or found.name not in outputs:
        got = f"got its {found.causality} of that name" if found else "it has none of this name"
        raise UnknownName(f"match: {match}: wanted an output of the FMU that is a number, {got}{component.hint(match, outputs)}")


def _stop_time(columns: Columns, given: float | None, step: float | None) -> float:
    """Returns the given stop time, else the communication point at or after the last row. Raises FmuError if rows are later."""
    times = columns.values["time"]
    if given is None:
        return float(times[-1]) if not step or not step > 0 else math.ceil(times[-1] / step * (1 - STILL)) * step
    if times[-1] > given * (1 + STILL):
        late = times[times > given * (1 + STILL)][0]
        raise FmuError(f"{columns.where}time: wanted rows up to the run's end, {given:g} s, got one at {late:g} s: give a later stop time")
    return given


def _course(source: Inputs, against: str, plan: Points) -> np.ndarray:
    if against not in source.names:
        nearest = did_you_mean(nearest_of(against, source.names))
        raise FmuError(f"against: {against}: wanted an input that goes over time, or an output; nothing drives this one{nearest}")
    place = source.names.index(against)
    return np.array([source.values(time, time)[place] for time in plan.times])
