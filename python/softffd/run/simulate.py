"""Runs a scene or an FMU from start to stop time."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from softffd.errors import FmuError, Interrupted, UnknownName
from softffd.fmu.component import Component
from softffd.fmu.instance import Message
from softffd.lattice import LatticeBox
from softffd.names import belonging, structured
from softffd.run.drive import NUMBERS, Drive, communication_points, positive
from softffd.run.inputs import Inputs, Source
from softffd.run.parts import in_place, is_position, places
from softffd.run.result import Result
from softffd.run.simulation import Simulation, choice_in, run_source
from softffd.spelling import one_number, wanted_one_of

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

Progress = Callable[[float, float], None]
Begun = Callable[[Simulation, Inputs], object]
Interpolation = Literal["held", "linear", "cubic"]


def simulate(
    scene_or_fmu: Scene | str | Path, *, stop_time: float | None = None, step: float | None = None,
    start_values: Mapping[str, Any] | None = None, inputs: Source | None = None, interpolation: Interpolation = "held",
    output: Iterable[str] | str | None = None, start_time: float = 0.0, tolerance: float | None = None, method: str | None = None,
    open_end: bool = False, progress: Progress | None = None, begun: Begun | None = None,
) -> Result:  # fmt: skip
    """Runs a scene or an FMU from start to stop time and returns its Result.

    scene_or_fmu: a scene, the path of its file, the name of a shipped one, or the path of an FMU.
    stop_time, step: end and communication step [s], > 0; the scene's or FMU's own by default. A last step that is left over is shorter.
    start_values: parameters and inputs by name, numbers or vectors.
    inputs: values over time, or constants in a dict (see softffd.run.inputs.Inputs); by default the scene's own, from the CSV file beside
        it (scene.default_inputs). inputs={} for none.
    output: names of the outputs to record, all by default: single ones, vectors, or what they belong to, as "position", "plane.press",
        "energy".
    start_time: start of the run [s], before the stop time.
    tolerance, method: as in Simulation; the scene's own by default.
    open_end: do not give the component the end of the run, up to which errors add up; it then takes the scene's stop time for that end.
    interpolation: between communication points inputs are "held", "linear" or "cubic": forces and loads with continuous slopes, the others
        linear (fmi2SetRealInputDerivatives). Unless inputs are held, the values at the next communication point must be known in advance.
    progress: called as progress(fraction of the run in 0..1, simulated time [s]).
    begun: called with the simulation and its inputs when everything is set, before the first step.
    Raises FmuError if a name, a value or a step is refused, if a variable that `inputs` drive has a start value, and if the result would
    not fit into memory. Ctrl-C raises Interrupted, a KeyboardInterrupt that has the result so far.
    """
    if not math.isfinite(one_number("start time", start_time)):
        raise FmuError(f"start time: wanted a finite number of s, got {start_time:g}")
    if interpolation not in (choices := get_args(Interpolation)):
        raise FmuError(f"interpolation: {wanted_one_of(choices, interpolation)}")
    what = run_source(scene_or_fmu, "simulate")
    scene = None if isinstance(what, Path) else what
    if inputs is None and scene:
        inputs = scene.default_inputs
    with Component(what) as component:
        stop_time = positive("stop time", stop_time, component.interface.stop_time, after=start_time)
        step = positive("communication step", step, component.interface.step)
        source = Inputs(inputs, start_time, component.by_name)
        simulation = Simulation(
            component, tolerance=tolerance, method=method, start_values=start_values, start_time=start_time,
            stop_time=None if open_end else stop_time,
        )  # fmt: skip
        run = _Run(simulation, source, stop_time, step, interpolation, _recorded_outputs(component, output))
        started = [name for given in start_values or {} for name in simulation.block(given).names]
        source.require_undriven(started, [*run.inputs.names, *source.tuned])
        run.fill(0, 1)
        run.apply(0)
        run.retune(0)
        simulation.initialize()
        if begun:
            begun(simulation, source)
        starts = _starts(component)
        began, began_cpu = clock.perf_counter(), clock.process_time()
        whole = run.to_the_end(progress)
        elapsed, elapsed_cpu = clock.perf_counter() - began, clock.process_time() - began_cpu
        times = run.times[: run.done + 1]
        simulated = float(times[-1] - times[0])
        summary = {
            "title": component.interface.title, "simulated_time_s": simulated, "run_time_s": elapsed, "cpu_time_s": elapsed_cpu,
            "real_time_factor": simulated / elapsed if elapsed > 0 else math.inf, "communication_step_s": step,
            "communication_steps": run.done, "methods": shares(run.changes, times),
            "warnings": [*source.overseen(times), *simulation.warnings],
        }  # fmt: skip
        if not whole:
            raise Interrupted(run.result(summary | {"interrupted_before_s": stop_time}, starts, scene))
        return run.result(summary, starts, scene)


class _Run(Drive):
    """A run whose inputs come from a source, and which returns a Result."""

    def __init__(
        self, simulation: Simulation, source: Inputs, stop_time: float, step: float, interpolation: Interpolation, chosen: set[str]
    ):
        component = simulation.component
        driven = source.driven(component, tunable=True)
        reals, *others = ([v for v in component.variables("output", kind) if v.name in chosen] for kind in NUMBERS)
        outputs = [*in_place(reals), *(variable for some in others for variable in some)]
        points = math.prod(component.lattice.points) if component.lattice else len(reals) // 3
        recorded = len(driven) + len(component.variables("input")) + len(outputs) + 3 * points + 8
        times = communication_points(stop_time, step, simulation.time, bytes_each=8 * recorded)
        super().__init__(simulation, times, step, driven, outputs, single=source.is_function or interpolation != "held")
        self._source = source
        self._tuning = source.changes(times)  # values that tunable parameters are still to take, by row
        self._slopes = {"linear": source.rates, "cubic": source.bends}.get(interpolation)
        self._moving = [n for n, variable in enumerate(driven[: len(source.names)]) if variable.kind == "Real"]
        """Indices of the Reals among the variables that the source gives itself"""
        self._rates = component.block_of([driven[n] for n in self._moving])
        self.changes: list[tuple[int, tuple[str, str]]] = []
        """Communication steps in which the method or its reason was new, with both; a choice before the first step counts for that step"""

    def fill(self, first: int, until: int) -> None:
        if first < until:
            self.input_rows[first:until] = self._source.rows(self.times[first : until + 1])

    def retune(self, row: int) -> int:
        for name, value in self._tuning.pop(row, {}).items():
            try:
                self._component.block([name]).set([value])
            except FmuError as error:
                raise FmuError(f"{self._source.where}at {self.times[row]:g} s: {error}") from None
        return min(self._tuning, default=super().retune(row))

    def apply(self, row: int) -> None:
        super().apply(row)
        if self._slopes and self._rates.names:
            self._rates.set_rates(self._slopes(*self.times[row : row + 2])[..., self._moving])

    def to_the_end(self, progress: Progress | None) -> bool:
        """Does all steps. False if the run was interrupted on the way: its rows then end with the last step that was done."""
        last, whole = len(self.times) - 1, True
        report_every = max(1, last // 200)
        try:
            with self._choices_heard():
                for done in self.run(most=report_every if progress else None):
                    if progress and done % report_every == 0:
                        progress(done / last, float(self.times[done]))
        except KeyboardInterrupt:
            if self.done == 0:
                raise
            whole = False
        end = self.times[self.done]
        self.input_rows[self.done] = self._source.values(end, end)
        return whole

    @contextmanager
    def _choices_heard(self) -> Iterator[None]:
        """While the block runs, records the component's messages about a method that takes over; the choices are then in `changes`."""
        component = self._simulation.component
        listener = component.listener
        said = [(0, message) for message in component.messages]

        def hear(message: Message) -> None:
            said.append((self.done, message))
            if listener:
                listener(message)

        component.listener = hear
        try:
            yield
        finally:
            component.listener = listener
            self.changes = [(row, choice) for row, message in said if (choice := choice_in(message.text))]

    def result(self, summary: dict[str, Any], starts: Mapping[str, float], scene: Scene | None) -> Result:
        """Returns the Result. starts: the numbers of parameters and inputs before the first step."""
        component, rows = self._simulation.component, slice(self.done + 1)
        block, values = self.outputs["Real"]
        moved = sum(map(is_position, block.names))
        positions = _positions(block.names[:moved], values[rows, :moved], component.lattice)
        others = {name: column for n, (name, column) in enumerate(self.columns().items()) if n >= moved}
        causality = {name: component.variable(name).causality for name in starts}
        held = {name: np.full(self.done + 1, float(value)) for name, value in starts.items() if causality[name] == "input"}
        held |= dict(zip(self.inputs.names, self.input_rows[rows].T, strict=True))
        parameters = {name: value for name, value in starts.items() if causality[name] == "parameter"}
        return Result(
            self.times[rows], positions, others, held, parameters, summary, scene, component.lattice, component.interface.flat,
            component.obstacles, tuple(self._simulation.log), taxels=component.taxels,
        )  # fmt: skip


def _starts(component: Component) -> dict[str, float]:
    blocks = [component.block_of(component.variables(causality, kind)) for causality in ("input", "parameter") for kind in NUMBERS]
    values = {name: value for block in blocks for name, value in zip(block.names, block.get().tolist(), strict=True)}
    return {name: values[name] for name in component.by_name if name in values}


def _positions(names: Sequence[str], values: np.ndarray, lattice: LatticeBox | None) -> np.ndarray:
    """Returns (T, nx, ny, nz, 3) from values (T, m) of variables position[i,j,k].c in the order of their places: a view if all
    variables are there, else an array with NaN for those that are not. Without a lattice the largest indices give the counts."""
    indices = places(names)
    counts = lattice.points if lattice else tuple(indices[:, :3].max(axis=0, initial=-1) + 1)
    if len(names) == 3 * math.prod(counts):
        return values.reshape(len(values), *counts, 3)
    positions = np.full((len(values), *counts, 3), np.nan)
    if names:
        positions.reshape(len(values), -1)[:, np.ravel_multi_index(tuple(indices.T), positions.shape[1:])] = values
    return positions


def _recorded_outputs(component: Component, wanted: Iterable[str] | str | None) -> set[str]:
    """Returns the names of the outputs to record; without a choice all but Strings, which no result has.

    A name selects the output of that name and all that belong to it: plane.press.reaction.z, plane.press.reaction, plane.press, energy,
    position[0,0,1], position. FmuError, with the nearest name, if a name selects no output.
    """
    by_name = belonging(component.numbers("output"))
    names: set[str] = set()
    for name in by_name if wanted is None else wanted if isinstance(wanted, Iterable) and not isinstance(wanted, str) else [wanted]:
        if (key := structured(str(name))) not in by_name:
            raise _unknown(str(name), component, by_name)
        names.update(by_name[key])
    return names


def _unknown(name: str, component: Component, choices: Collection[str]) -> FmuError:
    if found := component.by_name.get(name):
        got = " that is a number, got a String" if found.type == "String" else f", got its {found.causality} of that name"
        return FmuError(f"output: {name}: wanted an output of the FMU{got}")
    return UnknownName(f"output: {name}: the FMU has no such output{component.hint(name, choices)}")


def shares(changes: Sequence[tuple[int, tuple[str, str]]], times: np.ndarray) -> list[dict[str, Any]]:
    """Returns what each method with its reason took of a run, most first: method, reason, simulated_s, share in 0..1, communication_steps.

    changes: the communication steps, from 0, in which a choice was new, in order, with the choice. times: communication points (T,) [s].
    Without changes, as for a component that reports no choice, the list is empty.
    """
    ends = [row for row, _ in changes[1:]] + [len(times) - 1]
    taken: dict[tuple[str, str], list[float]] = {}
    for (begin, choice), end in zip(changes, ends, strict=False):
        so_far = taken.setdefault(choice, [0.0, 0])
        so_far[0] += float(times[end] - times[begin])
        so_far[1] += end - begin
    whole = float(times[-1] - times[0])
    rows = [
        {"method": method, "reason": reason, "simulated_s": length, "share": length / whole, "communication_steps": int(steps)}
        for (method, reason), (length, steps) in taken.items()
        if steps
    ]
    return sorted(rows, key=lambda row: -float(row["share"]))
