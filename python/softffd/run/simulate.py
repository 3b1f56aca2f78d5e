"""Runs a scene or an FMU through fmpy's library handle, with kept buffers."""

from __future__ import annotations

import math
import os
import re
import tempfile
import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.component import Block, Component
from softffd.fmu.package import package_fmu
from softffd.lattice import LatticeBox
from softffd.run.inputs import Inputs, Source
from softffd.run.result import Result
from softffd.scene.scene import Scene, shipped_scenes
from softffd.spelling import did_you_mean, nearest_of

Progress = Callable[[float, float], None]
Interpolation = Literal["held", "linear", "cubic"]
POSITION = re.compile(r"position\[(\d+),(\d+),(\d+)\]\.([xyz])")


def simulate(
    scene_or_fmu: Scene | str | Path,
    *,
    stop_time: float | None = None,
    step: float | None = None,
    start_values: Mapping[str, Any] | None = None,
    inputs: Source | None = None,
    interpolation: Interpolation = "held",
    progress: Progress | None = None,
) -> Result:
    """Runs a scene (packaged on the way) or an FMU from time 0 and returns all its outputs.

    stop_time, step: end and communication step [s], > 0; the scene's or FMU's own by default. A last step that is left over is shorter.
    start_values: parameters and inputs by variable name. inputs: values over time (see softffd.inputs.Inputs); none by default: a scene's
    own CSV file drives it only where it is given, inputs=scene.default_inputs, as `softffd run SCENE` does.
    interpolation: between communication points inputs are "held", "linear" or "cubic": forces and loads with continuous slopes, the others
    linear (fmi2SetRealInputDerivatives). The values at the next communication point must then be known in advance.
    progress: called as progress(share of the run in 0..1, simulated time [s]).
    Raises FmuError where a name, a value or a step is refused, and where the result would not fit into memory.
    """
    if interpolation not in (choices := get_args(Interpolation)):
        nearest = did_you_mean(nearest_of(str(interpolation), choices))
        raise FmuError(f"interpolation: wanted one of {', '.join(choices)}, got {interpolation!r}{nearest}")
    if isinstance(scene_or_fmu, Scene):
        with tempfile.TemporaryDirectory(prefix="softffd-") as folder:
            fmu = package_fmu(scene_or_fmu, Path(folder) / f"{scene_or_fmu.name}.fmu")
            return _run(fmu, scene_or_fmu, stop_time, step, start_values, inputs, interpolation, progress)
    return _run(_fmu_path(scene_or_fmu), None, stop_time, step, start_values, inputs, interpolation, progress)


def _fmu_path(fmu: Any) -> Path:
    if not isinstance(fmu, str | Path):
        raise FmuError(f"simulate: wanted a Scene or the path of an FMU, got {type(fmu).__name__}")
    path = Path(fmu)
    if path.suffix == ".toml" or (str(fmu) in shipped_scenes() and not path.exists()):
        raise FmuError(f'{fmu}: wanted a Scene or the path of an FMU, got the name of a scene; take load_scene("{fmu}")')
    return path


def _run(fmu, scene, stop_time, step, start_values, inputs, interpolation, progress) -> Result:
    with Component(fmu) as component:
        experiment = component.description.defaultExperiment
        stop_time = positive("stop time", stop_time, experiment and experiment.stopTime)
        step = positive("communication step", step, experiment and experiment.stepSize)
        source = Inputs(inputs)
        start_values = dict(start_values or {})
        component.initialize(start_values, stop_time=stop_time)
        recorder = _Recorder.of(component, source, stop_time, step, interpolation)
        recorder.apply_inputs(component, 0)
        component.exit_initialization()
        began, began_cpu = clock.perf_counter(), clock.process_time()
        recorder.run(component, progress)
        elapsed, elapsed_cpu = clock.perf_counter() - began, clock.process_time() - began_cpu
        title = component.description.description or component.description.modelName
        summary = {
            "title": title,
            "simulated_time_s": stop_time,
            "run_time_s": elapsed,
            "cpu_time_s": elapsed_cpu,
            "real_time_factor": stop_time / elapsed if elapsed > 0 else math.inf,
            "communication_step_s": step,
            "communication_steps": len(recorder.times) - 1,
            "warnings": component.warnings(),
        }
        return recorder.result(component, start_values, summary, scene)


def positive(what: str, given: float | None, default: Any) -> float:
    """The given value, else the default, if it is a number > 0 [s]; FmuError says what is wrong otherwise."""
    if given is None and default is None:
        raise FmuError(f"{what}: wanted > 0 s, got none; the FMU names no default, so it must be given")
    value = float(default if given is None else given)
    if not (math.isfinite(value) and value > 0):
        source = "given" if given is not None else "in the FMU's default experiment"
        raise FmuError(f"{what}: wanted > 0 s, got {value:g} ({source})")
    return value


def communication_points(stop_time: float, step: float) -> np.ndarray:
    """Multiples of step, and the stop time: (T,) [s]."""
    count = math.ceil(stop_time / step * (1 - 1e-9))
    return np.append(step * np.arange(count), stop_time)


def require_memory(stop_time: float, step: float, bytes_per_point: int) -> None:
    """FmuError where the values of all communication points would not fit into this machine's memory."""
    count = stop_time / step
    if not count * bytes_per_point <= _memory():
        raise FmuError(
            f"communication step {step:g} s and stop time {stop_time:g} s make {count:.3g} communication points, whose result would take "
            f"{count * bytes_per_point / 1e9:.3g} GB; wanted at most {_memory() / 1e9:.3g} GB, this machine's memory: "
            "take a longer step, a shorter stop time or fewer outputs"
        )


def _memory() -> float:
    """Of this machine [bytes]; 16 GB where it does not tell."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return 16e9


def step_lengths(times: np.ndarray, step: float) -> list[float]:
    """Lengths between the times: the same double for all but a shorter last one."""
    last = float(times[-1] - times[-2])
    return [step] * (len(times) - 2) + [step if math.isclose(last, step, rel_tol=1e-9) else last]


@dataclass
class _Recorder:
    """Buffers of a run: what is set and got at each communication point."""

    times: np.ndarray
    steps: list[float]
    source: Inputs
    interpolation: Interpolation
    inputs: Block
    driven: Block
    """Those of `inputs` that the source gives itself"""
    reals: Block
    integers: Block
    input_rows: np.ndarray
    real_rows: np.ndarray
    integer_rows: np.ndarray

    @classmethod
    def of(cls, component: Component, source: Inputs, stop_time: float, step: float, interpolation: Interpolation) -> _Recorder:
        given = [_input(component, source, name) for name in source.names]
        inputs = Block.of([*given, *(_input(component, source, name) for name in source.derived_names)], True)
        reals = Block.of(component.variables("output"), True)
        integers = Block.of(component.variables("output", real=False), False)
        places = math.prod(component.lattice.points) if component.lattice else len(reals.names) // 3
        held = len(inputs.names) + len(component.variables("input"))
        require_memory(stop_time, step, 8 * (held + len(reals.names) + len(integers.names) + 3 * places + 8))
        times = communication_points(stop_time, step)
        rows = len(times)
        return cls(
            times, step_lengths(times, step), source, interpolation, inputs, Block.of(given, True), reals, integers,
            np.zeros((rows, len(inputs.names))), np.zeros((rows, len(reals.names))), np.zeros((rows, len(integers.names)), np.int64),
        )  # fmt: skip

    def apply_inputs(self, component: Component, row: int) -> None:
        if not self.inputs.names:
            return
        time, then = self.times[row], self.times[min(row + 1, len(self.steps))]
        self.inputs.values[:] = self.source.values(time, then)
        self.input_rows[row] = self.inputs.values
        component.set(self.inputs)
        if self.interpolation != "held" and then > time:
            course = self.source.rates if self.interpolation == "linear" else self.source.bends
            component.set_rates(self.driven, course(time, then))

    def record(self, component: Component, row: int) -> None:
        component.get(self.reals)
        self.real_rows[row] = self.reals.values
        if self.integers.names:
            component.get(self.integers)
            self.integer_rows[row] = self.integers.values

    def run(self, component: Component, progress: Progress | None) -> None:
        last, times = len(self.times) - 1, self.times.tolist()
        self.record(component, 0)
        report_every = max(1, last // 200)
        for row in range(last):
            if row > 0:
                self.apply_inputs(component, row)
            component.do_step(times[row], self.steps[row])
            self.record(component, row + 1)
            if progress and (row + 1) % report_every == 0:
                progress((row + 1) / last, times[row + 1])
        self.apply_inputs(component, last)

    def result(self, component: Component, start_values: dict[str, Any], summary: dict[str, Any], scene: Scene | None) -> Result:
        columns = dict(zip(self.reals.names, self.real_rows.T, strict=True))
        positions = _positions(columns, len(self.times), component.lattice)
        others = {name: column for name, column in columns.items() if not POSITION.fullmatch(name)}
        others |= dict(zip(self.integers.names, self.integer_rows.T, strict=True))
        held = {v.name: np.full(len(self.times), float(start_values.get(v.name, v.start))) for v in component.variables("input")}
        held |= dict(zip(self.inputs.names, self.input_rows.T, strict=True))
        parameters = {v.name: float(start_values.get(v.name, v.start)) for v in component.variables("parameter")}
        return Result(self.times, positions, others, held, parameters, summary, scene, component.lattice)


def _input(component: Component, source: Inputs, name: str) -> Any:
    """The input of this name; FmuError that tells the source otherwise."""
    try:
        variable = component.variable(name)
    except FmuError as error:
        raise FmuError(f"{source.where}{error}") from None
    if variable.causality != "input":
        raise FmuError(f"{source.where}{name}: wanted an input of the FMU, got its {variable.causality} of that name")
    return variable


def _positions(columns: dict[str, np.ndarray], rows: int, lattice: LatticeBox | None) -> np.ndarray:
    """(T, nx, ny, nz, 3) from the columns position[i,j,k].c; NaN where there is none. Without a lattice the largest indices count."""
    found = {name: match for name in columns if (match := POSITION.fullmatch(name))}
    indices = [tuple(map(int, match.groups()[:3])) for match in found.values()]
    counts = lattice.points if lattice else tuple(np.max(indices, axis=0) + 1 if indices else (0, 0, 0))
    positions = np.full((rows, *counts, 3), np.nan)
    for name, match in found.items():
        i, j, k = map(int, match.groups()[:3])
        positions[:, i, j, k, "xyz".index(match.group(4))] = columns[name]
    return positions
