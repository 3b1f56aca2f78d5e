"""Runs a scene or an FMU through fmpy's library handle, with kept buffers."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from softffd.errors import FmuError, Interrupted, UnknownName
from softffd.fmu.block import Blocks
from softffd.fmu.component import Component
from softffd.lattice import LatticeBox
from softffd.names import meant_by, structured
from softffd.run.inputs import Inputs, Source
from softffd.run.many_steps import ManySteps
from softffd.run.parts import in_place, is_position, places
from softffd.run.result import Result
from softffd.run.simulation import Simulation, choice_in, run_source
from softffd.run.times import communication_points, one_number, positive, require_memory, step_lengths
from softffd.spelling import did_you_mean, nearest_of

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

Progress = Callable[[float, float], None]
Begun = Callable[[Simulation, Inputs], object]
Interpolation = Literal["held", "linear", "cubic"]
NUMBERS = ("Real", "Integer", "Boolean")
"""Kinds of variables that a result has; Booleans are 0 and 1 there"""


def simulate(
    scene_or_fmu: Scene | str | Path,
    *,
    stop_time: float | None = None,
    step: float | None = None,
    start_values: Mapping[str, Any] | None = None,
    inputs: Source | None = None,
    interpolation: Interpolation = "held",
    output: Iterable[str] | str | None = None,
    start_time: float = 0.0,
    tolerance: float | None = None,
    method: str | None = None,
    progress: Progress | None = None,
    begun: Begun | None = None,
) -> Result:
    """Runs a scene or an FMU from start to stop time and returns its outputs.

    scene_or_fmu: a scene, the path of its file, the name of a shipped one, or the path of an FMU.
    stop_time, step: end and communication step [s], > 0; the scene's or FMU's own by default. A last step that is left over is shorter.
    start_values: parameters and inputs by name, numbers or vectors.
    inputs: values over time, or constants in a dict (see softffd.run.inputs.Inputs); by default a scene's own, of the CSV file beside it
    (scene.default_inputs). inputs={} for none.
    output: names of the outputs to record, all by default: single ones, vectors, or what they belong to, as "position", "plane.press",
    "energy".
    start_time: [s], before the stop time.
    tolerance, method: instead of the scene's own, as in Simulation.
    interpolation: between communication points inputs are "held", "linear" or "cubic": forces and loads with continuous slopes, the others
    linear (fmi2SetRealInputDerivatives). The values at the next communication point must then be known in advance.
    progress: called as progress(share of the run in 0..1, simulated time [s]).
    begun: called with the simulation and its inputs when everything is set, before the first step.
    Raises FmuError where a name, a value or a step is refused, where a start value is given to what `inputs` drive, and where the result
    would not fit into memory. Ctrl-C raises Interrupted, a KeyboardInterrupt that has the result so far.
    """
    if not math.isfinite(one_number("start time", start_time)):
        raise FmuError(f"start time: wanted a finite number of s, got {start_time:g}")
    if interpolation not in (choices := get_args(Interpolation)):
        nearest = did_you_mean(nearest_of(str(interpolation), choices))
        raise FmuError(f"interpolation: wanted one of {', '.join(choices)}, got {interpolation!r}{nearest}")
    what = run_source(scene_or_fmu, "simulate")
    scene = None if isinstance(what, Path) else what
    if inputs is None and scene:
        inputs = scene.default_inputs
    with Component(what) as component:
        interface = component.interface
        stop_time = positive("stop time", stop_time, interface.stop_time, after=start_time)
        step = positive("communication step", step, interface.step)
        source = Inputs(inputs, start_time)
        with Simulation(
            component, tolerance=tolerance, method=method, start_values=start_values, start_time=start_time, stop_time=stop_time
        ) as simulation:
            recorder = _Recorder(simulation, source, stop_time, step, interpolation, output)
            started = [name for given in start_values or {} for name in simulation.block(given).names]
            source.require_undriven(started, recorder.inputs.names)
            recorder.apply_inputs(0)
            simulation.initialize()
            if begun:
                begun(simulation, source)
                recorder.starts = _read(component, "input", "parameter")
            began, began_cpu = clock.perf_counter(), clock.process_time()
            whole = recorder.run(progress)
            elapsed, elapsed_cpu = clock.perf_counter() - began, clock.process_time() - began_cpu
            simulated = float(recorder.times[-1] - recorder.times[0])
            summary = {
                "title": interface.title,
                "simulated_time_s": simulated,
                "run_time_s": elapsed,
                "cpu_time_s": elapsed_cpu,
                "real_time_factor": simulated / elapsed if elapsed > 0 else math.inf,
                "communication_step_s": step,
                "communication_steps": len(recorder.times) - 1,
                "methods": shares(recorder.changes, recorder.times),
                "warnings": simulation.warnings,
            }
            if not whole:
                raise Interrupted(recorder.result(summary | {"interrupted_before_s": stop_time}, scene))
            return recorder.result(summary, scene)


class _Recorder:
    """Buffers of a run: what is set and got at each communication point."""

    def __init__(
        self, simulation: Simulation, source: Inputs, stop_time: float, step: float, interpolation: Interpolation,
        output: Iterable[str] | str | None,
    ):  # fmt: skip
        self.simulation, self.source, self.interpolation = simulation, source, interpolation
        component = self.component = simulation.component
        chosen, driven = _recorded_outputs(component, output), source.driven(component)
        self.interpolated = [n for n, variable in enumerate(driven[: len(source.names)]) if variable.kind == "Real"]
        """Which of the source's names are Reals that it gives itself"""
        self.inputs, self.driven = Blocks(component, driven), component.block_of([driven[n] for n in self.interpolated])
        reals, integers, booleans = ([v for v in component.variables("output", kind) if v.name in chosen] for kind in NUMBERS)
        self.reals, self.integers, self.booleans = map(component.block_of, (in_place(reals), integers, booleans))
        self.starts = _read(component, "input", "parameter")
        """Parameters and inputs before the first communication point"""
        points = math.prod(component.lattice.points) if component.lattice else len(reals) // 3
        recorded = len(self.inputs.names) + len(component.variables("input")) + len(reals) + len(integers) + len(booleans)
        require_memory(stop_time - simulation.time, step, 8 * (recorded + 3 * points + 8))
        self.times = communication_points(stop_time, step, simulation.time)
        self.steps = step_lengths(self.times, step)
        rows = len(self.times)
        self.input_rows, self.real_rows = np.zeros((rows, len(driven))), np.zeros((rows, len(reals)))
        self.integer_rows, self.boolean_rows = (np.zeros((rows, len(some)), np.int64) for some in (integers, booleans))
        self.changes: list[tuple[int, tuple[str, str]]] = []
        """Communication steps in which the method or its reason were new"""
        self.done = 0
        """Communication steps that are recorded"""

    def apply_inputs(self, row: int) -> None:
        if not self.inputs.names:
            return
        time, then = self.times[row], self.times[min(row + 1, len(self.steps))]
        self.inputs.set(self.source.values(time, then))
        self.input_rows[row] = self.inputs.values
        if self.driven.names and self.interpolation != "held" and then > time:
            course = self.source.rates if self.interpolation == "linear" else self.source.bends
            self.driven.set_rates(course(time, then)[..., self.interpolated])

    def run(self, progress: Progress | None) -> bool:
        """All steps; False where it was interrupted on the way: what there is ends then with the last step that was done."""
        self.real_rows[0], self.integer_rows[0], self.boolean_rows[0] = self.reals.get(), self.integers.get(), self.booleans.get()
        try:
            self._go_on(progress)
        except KeyboardInterrupt:
            if self.done == 0:
                raise
            self._cut()
            return False
        return True

    def _go_on(self, progress: Progress | None) -> None:
        """Held values go to the library with many steps at once; what is a function, or moves within a step, is set before each. Inputs
        that are no Reals, and Booleans, are for the host."""
        last, times = len(self.times) - 1, self.times.tolist()
        report_every = max(1, last // 200)
        reals = self.inputs.real
        one_by_one = self.source.is_function or self.interpolation != "held" or reals is None or bool(self.booleans.names)
        inputs = self.component.block_of([]) if one_by_one or reals is None else reals
        rows = {"inputs": (inputs, self.input_rows), "reals": (self.reals, self.real_rows), "integers": (self.integers, self.integer_rows)}
        many = ManySteps(self.component, self.times, self.steps, rows, single=one_by_one)
        try:
            with many.listening():
                while self.done < last:
                    if one_by_one:
                        until = self.done + 1
                        if self.done > 0:
                            self.apply_inputs(self.done)
                    else:
                        until = min(last, self.done + many.together, (self.done // report_every + 1) * report_every if progress else last)
                        self.input_rows[self.done : until] = self.source.rows(self.times[self.done : until + 1])
                    many.go_on(until)
                    if self.booleans.names:
                        self.boolean_rows[until] = self.booleans.get()
                    self.done, self.simulation.time = until, times[until]
                    if progress and self.done % report_every == 0:
                        progress(self.done / last, times[self.done])
        finally:
            self.done, self.simulation.time = many.done, times[many.done]
            self.changes = [(row, choice) for row, message in many.said if (choice := choice_in(message.text))]
        self.apply_inputs(last)

    def _cut(self) -> None:
        """Keeps the communication points up to the last step that was done."""
        rows = slice(self.done + 1)
        self.times, self.steps = self.times[rows], self.steps[: self.done]
        self.input_rows, self.real_rows = self.input_rows[rows], self.real_rows[rows]
        self.integer_rows, self.boolean_rows = self.integer_rows[rows], self.boolean_rows[rows]
        if self.inputs.names:
            self.input_rows[-1] = self.source.values(self.times[-1], self.times[-1])

    def result(self, summary: dict[str, Any], scene: Scene | None) -> Result:
        component, names = self.component, self.reals.names
        moved = sum(map(is_position, names))
        positions = _positions(names[:moved], self.real_rows[:, :moved], component.lattice)
        others = dict(zip(names[moved:], self.real_rows[:, moved:].T, strict=True))
        others |= dict(zip(self.integers.names, self.integer_rows.T, strict=True))
        others |= dict(zip(self.booleans.names, self.boolean_rows.T, strict=True))
        causality = {name: component.variable(name).causality for name in self.starts}
        held = {name: np.full(len(self.times), float(value)) for name, value in self.starts.items() if causality[name] == "input"}
        held |= dict(zip(self.inputs.names, self.input_rows.T, strict=True))
        parameters = {name: value for name, value in self.starts.items() if causality[name] == "parameter"}
        return Result(
            self.times, positions, others, held, parameters, summary, scene, component.lattice, component.interface.flat,
            component.obstacles, tuple(self.simulation.log),
        )  # fmt: skip


def _read(component: Component, *causalities: str) -> dict[str, float]:
    """The numbers of these causalities by name, in the order of the FMU."""
    blocks = [component.block_of(component.variables(causality, kind)) for causality in causalities for kind in NUMBERS]
    values = {name: value for block in blocks for name, value in zip(block.names, block.get().tolist(), strict=True)}
    return {name: values[name] for name in component.by_name if name in values}


def _positions(names: Sequence[str], values: np.ndarray, lattice: LatticeBox | None) -> np.ndarray:
    """(T, nx, ny, nz, 3) from values (T, m) of variables position[i,j,k].c in the order of their places: a view where all are there, else
    with NaN where there is none. Without a lattice the largest indices count."""
    indices = places(names)
    counts = lattice.points if lattice else tuple(indices[:, :3].max(axis=0, initial=-1) + 1)
    if len(names) == 3 * math.prod(counts):
        return values.reshape(len(values), *counts, 3)
    positions = np.full((len(values), *counts, 3), np.nan)
    if names:
        positions.reshape(len(values), -1)[:, np.ravel_multi_index(tuple(indices.T), positions.shape[1:])] = values
    return positions


def _recorded_outputs(component: Component, wanted: Iterable[str] | str | None) -> set[str]:
    """The names of the outputs to record; all without a choice but Strings, which no result has.

    A name means the output that has it and all that belong to it: plane.press.reaction.z, plane.press.reaction, plane.press, energy,
    position[0,0,1], position. FmuError, with the nearest name, where no output is meant.
    """
    by_name: dict[str, list[str]] = {}
    for variable in component.by_name.values():
        if variable.causality == "output" and variable.kind != "String":
            for name in meant_by(variable.name):
                by_name.setdefault(name, []).append(variable.name)
    names: set[str] = set()
    for name in by_name if wanted is None else [wanted] if isinstance(wanted, str) else wanted:
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
    """What each method with its reason took of a run, most first: method, reason, simulated_s, share in 0..1, communication_steps.

    changes: the communication steps, from 0, in which a choice was new, in their order, with it. times: communication points (T,) [s].
    Without changes, as of a component that tells of no choice, there is nothing.
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
