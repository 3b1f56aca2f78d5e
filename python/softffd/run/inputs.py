"""Inputs over time: a callable, constants, a structured array as fmpy's simulate_fmu takes, a DataFrame or a CSV file; and the velocities
of planes and pins that follow from their poses."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.component import Component
from softffd.fmu.interface import ScalarVariable
from softffd.names import components_in, is_pose, parse_name, structured, vector_names
from softffd.rotation import between_directions, between_orientations, nearer, quaternion
from softffd.run.tables import checked, is_data_frame, read_csv, table_of
from softffd.scene.document import shown

if TYPE_CHECKING:
    import pandas as pd


def derived_velocities(now: Mapping[str, float], then: Mapping[str, float], step: float) -> dict[str, float]:
    """Returns velocities that take every pose in `now` to the pose in `then` after `step` [s], except those that `now` gives itself.

    Names are those of the FMU's variables: .point of an obstacle gives .velocity, .normal or .rotation gives .angular_velocity; .position
    and .orientation of a pin likewise. Components of points that are not given count as unchanged; rotations need the whole normal,
    rotation vector or quaternion.
    """
    derived: dict[str, float] = {}
    parts = dict.fromkeys((name.family, name.instance) for name in map(parse_name, now) if name)
    for pose, (velocity, rate) in RATES.items():
        for part in (part for family, part in parts if family == pose):
            given, wanted = vector_names(pose, part), vector_names(velocity, part)
            if any(name in now for name in wanted) or (rate is not SHIFT and not all(name in now for name in given)):
                continue
            first = np.array([now.get(name, 0.0) for name in given])
            last = np.array([then[name] if name in now else 0.0 for name in given])
            derived |= {name: float(v) for name, v in zip(wanted, rate(first, last) / step, strict=True)}
    return derived


Rate = Callable[[np.ndarray, np.ndarray], np.ndarray]
SHIFT: Rate = lambda first, last: last - first  # noqa: E731
RATES: dict[str, tuple[str, Rate]] = {
    "plane_point": ("plane_velocity", SHIFT),
    "pin_position": ("pin_velocity", SHIFT),
    "plane_normal": ("plane_angular_velocity", between_directions),
    "plane_rotation": ("plane_angular_velocity", lambda first, last: between_orientations(quaternion(first), quaternion(last))),
    "pin_orientation": ("pin_angular_velocity", between_orientations),
}  # by family of poses: the family of velocities that follows from it, and how their change is computed
Source = Union[Callable[[float], Mapping[str, Any]], Mapping[str, Any], np.ndarray, "pd.DataFrame", str, Path]

OVERSEEN = 0.1  # part of a column's range by which a value between communication points may be beyond those at them without a warning
SLACK = 1e-9  # relative difference up to which a row's time equals that of a communication point: multiples of a step are rounded


class Inputs:
    """Values of some input variables at any time.

    Arrays and CSV files have a first column `time` [s], not decreasing, and one column per variable; in a DataFrame the column `time`, or
    else the index, is the time. Values are linear between rows, but Integers and Booleans keep the last row's value; before the first and
    after the last row, values are held. A quaternion counts as the orientation that it means, whichever sign it has. Rows of one time are
    a jump: an interval that begins there has the values of the last of these rows, an interval that ends there those of the first. A
    callable gives values by name, the same names at every time; a dict gives constants. Both give numbers or vectors.

    A table may also have columns of tunable parameters, which keep the last row's value.

    A plane or pin whose pose is given but whose velocity is not gets the velocity that takes it to its pose at the end of the
    communication step, if that velocity is an input; a jump moves the plane or pin without velocity.

    Names at control points may have either form (softffd.names); `names` has the structured one.
    """

    def __init__(self, source: Source | None, start_time: float = 0.0, variables: Container[str] = ()):
        """start_time: start of the run [s]. variables: the FMU's, which say the components of a vector; without them a vector of 3 has
        .x .y .z, one of 4 .w .x .y .z. FmuError if the source has none of these types or its values cannot be used."""
        source = {} if source is None else source
        self._start = start_time
        self.where = f"{shown(Path(source))}: " if isinstance(source, str | Path) else "inputs: "  # beginning of messages about the source
        self._is_file = isinstance(source, str | Path)
        self.is_function, self._steady = callable(source), isinstance(source, Mapping)
        self._held: set[str] = set()
        self._at, self.names, self._rows = _course(source, self.where, start_time, self._held, variables)
        self.tuned: dict[str, ScalarVariable] = {}  # tunable parameters that a table gives, by their names there; set by `driven`
        now = self._at(start_time, False)
        self.derived_names = list(derived_velocities(now, now, 1.0))  # velocities that follow from given poses

    def derive_only(self, names: Iterable[str]) -> None:
        """Keeps only those of `derived_names` that are among these names, the inputs of an FMU, in either form."""
        there = set(map(structured, names))
        self.derived_names = [name for name in self.derived_names if structured(name) in there]

    def driven(self, component: Component, *, tunable: bool = False) -> list[ScalarVariable]:
        """Returns the inputs of an FMU that are driven: in the order of `names`, then the velocities that follow from them, where these
        are inputs of the FMU. From this call on, whole numbers keep the value of the last row instead of being interpolated. FmuError,
        which names the source, for a name that is no input. tunable: columns of tunable parameters are accepted too, see `changes`."""
        found = {name: self._input(component, name, tunable) for name in self.names}
        self.tuned = {name: variable for name, variable in found.items() if variable.causality == "parameter"}
        self.names = [name for name in self.names if name not in self.tuned]
        self.derive_only({variable.name for variable in component.variables("input")})
        self._held.update([*self.tuned, *(name for name, variable in found.items() if variable.kind != "Real")])
        return [found[name] for name in self.names] + [component.variable(name) for name in self.derived_names]

    def _input(self, component: Component, name: str, tunable: bool) -> ScalarVariable:
        try:
            variable = component.variable(name)
        except FmuError as error:
            raise FmuError(f"{self.where}{error}") from None
        tunable = tunable and not (self._steady or self.is_function)
        if tunable and variable.variability == "tunable":
            return variable
        if variable.causality != "input":
            fixed = is_pose(name) and variable.causality == "parameter"
            hint = "; the scene names it in `inputs` of a plane or pin to make it one" if fixed else ""
            wanted = "an input or a tunable parameter" if tunable else "an input"
            got = f"{variable.variability} parameter" if variable.causality == "parameter" else variable.causality
            raise FmuError(f"{self.where}{name}: wanted {wanted} of the FMU, got its {got} of that name{hint}")
        if variable.type == "String":
            raise FmuError(f"{self.where}{name}: wanted an input that is a number, got a String; start values set it")
        return variable

    def changes(self, times: np.ndarray) -> dict[int, dict[str, float]]:
        """Returns the values that tunable parameters change to, by row of communication points (T,) [s] and by name; in the first row,
        those that differ from the start values. Other rows leave a parameter alone, since setting one makes the component prepare the
        body anew."""
        found: dict[int, dict[str, float]] = {}
        now = self._at(times[:-1], False) if self.tuned else {}
        for name, variable in self.tuned.items():
            values = np.append(float(variable.start or 0.0), now[name])
            for row in np.flatnonzero(values[1:] != values[:-1]).tolist():
                found.setdefault(row, {})[variable.name] = float(values[row + 1])
        return found

    def overseen(self, times: np.ndarray) -> list[str]:
        """Returns a warning for each column of a table of which a run with these communication points (T,) [s] does not see a peak: within
        a communication step, a row is beyond the values at both ends of the step by more than OVERSEEN of the column's range. What only
        rises or only falls within a step is seen at its end."""
        slack = SLACK * abs(self._rows)
        behind = np.searchsorted(times, self._rows - slack, "left")
        between = (behind == np.searchsorted(times, self._rows + slack, "right")) & (behind > 0) & (behind < len(times))
        at, step = self._rows[between], np.tile(behind[between] - 1, 2)
        if not len(at):
            return []
        begin, end, *sides = (self._at(*each) for each in ((times[:-1], False), (times[1:], True), (at, True), (at, False)))
        found = []
        for name in begin:
            first, last, values = begin[name], end[name], np.concatenate([side[name] for side in sides])
            beyond = np.maximum(values - np.maximum(first, last)[step], np.minimum(first, last)[step] - values)
            worst = int(np.argmax(beyond))
            if beyond[worst] > OVERSEEN * np.ptp(np.concatenate([first, last, values])):
                found.append(
                    f"{self.where}{name}: the run misses its value {values[worst]:g} at {np.tile(at, 2)[worst]:g} s, between communication "
                    f"points with {first[step[worst]]:g} and {last[step[worst]]:g}: take a shorter communication step"
                )
        return found

    def require_undriven(self, started: Iterable[str], driven: Container[str]) -> None:
        """Raises FmuError if a start value has no effect because this source gives the variable from the first communication point on."""
        if lost := next((name for name in started if name in driven), None):
            follows = "" if lost in self.names else " with its pose"
            other = "; inputs={} goes without the file, as softffd run --no-input does" if self._is_file else ""
            raise FmuError(
                f"{self.where}{lost} comes from here over time{follows}, so its start value has no effect: leave out one of the two{other}"
            )

    def values(self, time: float, then: float) -> np.ndarray:
        """Returns values at a communication point, in the order of `names`, then `derived_names`; then: the next point, or `time` again
        [s]."""
        now = self._at(time, False)
        derived = derived_velocities(now, self._at(then, True), then - time) if then > time else {}
        return np.array([*(now[name] for name in self.names), *(derived.get(name, 0.0) for name in self.derived_names)])

    def rows(self, times: np.ndarray) -> np.ndarray:
        """Returns `values` at each of some communication points except the last, (points - 1, names)."""
        if self._steady:
            return np.broadcast_to(self.values(times[0], times[1]), (len(times) - 1, len(self.names) + len(self.derived_names)))
        if self.derived_names or self.is_function:
            return np.array([self.values(time, then) for time, then in pairwise(times)])
        now = self._at(times[:-1], False)
        return np.stack([now[name] for name in self.names], axis=1) if self.names else np.zeros((len(times) - 1, 0))

    def rates(self, time: float, then: float) -> np.ndarray:
        """Returns the slopes from a communication point to the next, `then` > `time` [s], in the order of `names` [unit / s]."""
        begin, end = self._row(time, False), self._row(then, True)
        for places in _orientations(self.names):
            end[places] = nearer(end[places], begin[places])
        return (end - begin) / (then - time)

    def bends(self, time: float, then: float) -> np.ndarray:
        """Returns the first to third derivatives at `time` of the course from a communication point to the next, `then` > `time` [s]:
        (3, names) [unit / s, unit / s2, unit / s3]. Forces and loads follow cubics whose slopes are continuous where the values are and
        which rise and fall where the values do (Fritsch, Carlson 1980), so that nothing overshoots. Other inputs, which take the first
        derivative only, are linear."""
        step, mean = then - time, self.rates(time, then)
        begin, end = self._slope_at(time, step, ends=False), self._slope_at(then, step, ends=True)
        cubic = np.array([begin, 2 * (3 * mean - 2 * begin - end) / step, 6 * (begin + end - 2 * mean) / step**2])
        takes_bends = [(found := parse_name(name)) is not None and found.family in ("force", "load") for name in self.names]
        return np.where(takes_bends, cubic, [mean, 0 * mean, 0 * mean])

    def _row(self, time: float, ends: bool) -> np.ndarray:
        values = self._at(time, ends)
        return np.array([values[name] for name in self.names])

    def _slope_at(self, time: float, step: float, *, ends: bool) -> np.ndarray:
        """Returns the slopes where a step ends or begins, limited so that the cubics on both sides follow the values. At a jump only
        the step's own side counts. No values before the start are used."""
        near, first = step / 256, time - self._start < step
        before, after = self._row(time, True), self._row(time, False)
        after_mean = (self._row(time + step, True) - after) / step
        before_mean = after_mean if first else (before - self._row(time - step, False)) / step
        after_slope = (self._row(time + near, True) - after) / near
        before_slope = after_slope if first else (before - self._row(time - near, False)) / near
        jump = before != after
        if ends:
            after_mean, after_slope = np.where(jump, before_mean, after_mean), np.where(jump, before_slope, after_slope)
        else:
            before_mean, before_slope = np.where(jump, after_mean, before_mean), np.where(jump, after_slope, before_slope)
        most = np.where(before_mean * after_mean > 0, 3 * np.minimum(abs(before_mean), abs(after_mean)), 0.0)
        return np.clip((before_slope + after_slope) / 2, -most, most)


Course = Callable[[Any, bool], Mapping[str, Any]]
"""Values by name at a time [s], for an interval that ends there (True) or begins there (False); of a table also at many times."""


def _course(source: Source, where: str, start: float, held: set[str], variables: Container[str]) -> tuple[Course, list[str], np.ndarray]:
    """Returns the course of a source, its names in order, and the times of a table's rows [s]. held: names whose values a table holds
    between its rows."""
    if callable(source):
        return _of_function(source, where, start, variables)
    if isinstance(source, Mapping):
        numbers = _constants(source, where, variables)
        return _of_function(lambda time: numbers, where, start, variables)
    if isinstance(source, str | Path):
        return _of_table(read_csv(Path(source)), where, held)
    if is_data_frame(source) or isinstance(source, np.ndarray):
        return _of_table(checked(table_of(source) if is_data_frame(source) else source), where, held)
    wanted = "a function of time, a dict of constants, a structured array, a DataFrame or a CSV file"
    raise FmuError(f"{where}wanted {wanted}, got {type(source).__name__}: {source!r:.70}")


def _constants(given: Mapping[str, Any], where: str, variables: Container[str]) -> dict[str, float]:
    """Returns numbers by the names of single variables; a vector is given by the name that its components share. FmuError, which begins
    with `where`, for anything else."""
    numbers: dict[str, float] = {}
    for name, value in given.items():
        if isinstance(value, float) and math.isfinite(value):
            numbers[name] = value
            continue
        try:
            values = np.asarray(math.nan if isinstance(value, str | bytes) else value, dtype=float)
        except (TypeError, ValueError):
            values = np.array(math.nan)
        if not np.isfinite(values).all():
            raise FmuError(f"{where}{name}: wanted a finite number or a vector of them, got {value!r:.70}")
        if values.ndim == 0:
            numbers[str(name)] = float(values)
            continue
        usual = {c: f"{name}.{c}" for c in {3: "xyz", 4: "wxyz"}.get(values.size, "")}
        names = components_in(variables, name) or usual
        if values.ndim != 1 or not names:
            raise FmuError(f"{where}{name}: wanted a number or a vector of 3 (of 4 for an orientation), got the shape {values.shape}")
        if len(names) != len(values):
            raise FmuError(f"{where}{name}: wanted {len(names)} numbers, got {value!r:.70}")
        numbers |= dict(zip(names.values(), values.tolist(), strict=True))
    return numbers


def _of_function(
    function: Callable[[float], Mapping[str, Any]], where: str, start: float, variables: Container[str]
) -> tuple[Course, list[str], np.ndarray]:
    def asked(time: float) -> dict[str, float]:
        values = function(time)
        if not (isinstance(values, Mapping) and all(isinstance(name, str) for name in values)):
            raise FmuError(f"{where}at {time:g} s: wanted a dict of values by name, got {values!r:.70}")
        return _constants(values, f"{where}at {time:g} s: ", variables)

    given = list(asked(start))
    names, wanted = _structured(given, where), set(given)

    def course(time: float, _ends: bool) -> dict[str, float]:
        numbers = asked(time)
        if numbers.keys() != wanted:
            changes = {"missing": wanted - numbers.keys(), "additional": numbers.keys() - wanted}
            got = "; ".join(f"{what}: {', '.join(sorted(map(str, some)))}" for what, some in changes.items() if some)
            raise FmuError(f"{where}at {time:g} s: wanted the same names as at {start:g} s, got {got}")
        return dict(zip(names, map(numbers.__getitem__, given), strict=True))

    return course, names, np.empty(0)


def _orientations(names: list[str]) -> list[list[int]]:
    """Returns the indices in `names` of the components of each quaternion that is there as a whole."""
    pins = dict.fromkeys(found.instance for name in names if (found := parse_name(name)) and found.family == "pin_orientation")
    quaternions = [vector_names("pin_orientation", pin) for pin in pins]
    return [[names.index(name) for name in each] for each in quaternions if set(each) <= set(names)]


def _structured(given: list[str], where: str) -> list[str]:
    """Returns the names in their structured form; FmuError if two of them mean the same variable."""
    by_name: dict[str, str] = {}
    for name in given:
        if (other := by_name.setdefault(structured(name), name)) != name:
            raise FmuError(f"{where}{name}: wanted each variable once, got {other} too, which is the same one")
    return list(by_name)


def _of_table(table: np.ndarray, where: str, held: set[str]) -> tuple[Course, list[str], np.ndarray]:
    times, given = table["time"].astype(float), list((table.dtype.names or ())[1:])
    names = _structured(given, where)
    values = np.array([table[own].astype(float) for own in given])
    for places in _orientations(names):
        turning = values[places].T  # q and -q mean one orientation; each row takes the one nearer to the row before, since
        flips = (turning[1:] * turning[:-1]).sum(axis=1) < 0  # otherwise values between two rows would go through zero
        values[places, 1:] *= np.where(np.cumsum(flips) % 2, -1, 1)
    columns = dict(zip(names, values, strict=True))

    def course(time: Any, ends: bool) -> dict[str, Any]:
        slack = SLACK * abs(time)
        first, behind = np.searchsorted(times, time - slack, "left"), np.searchsorted(times, time + slack, "right")
        here, row = first < behind, np.minimum(first, len(times) - 1) if ends else behind - 1  # has this time rows, and which counts
        last = np.maximum(behind - 1, 0)
        return {
            name: np.where(here, column[row], column[last] if name in held else np.interp(time, times, column))
            for name, column in columns.items()
        }

    return course, names, times
