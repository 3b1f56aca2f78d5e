"""Whole runs from Python against the alternatives of a user: fmpy's loop, one run after the other, an FMU of FMI 2.0."""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
from boxes import STEP, box
from measured import Pair, require_alike, row

import softffd
from softffd.scene.scene import scene_from

STEPS = 20_000
"""Communication steps of a run, with one internal step each"""

INPUTS = {"none": None, "a table": "table", "a function": lambda t: {"load.push.x": math.sin(9 * t)}}


def loop_with(name: str, *, goal: float | None = None) -> None:
    """Adds a row for one kind of inputs. fmpy gets the function as a table."""

    @row("runs", f"simulate, inputs: {name}", "fmpy's simulate_fmu, same FMU", goal=goal, every_set=False)
    def loop() -> Iterator[Pair]:
        stop = STEP * STEPS
        times = np.linspace(0, stop, 201)
        columns = [(name, float) for name in ("time", "load.push.x", "load.push.y", "load.push.z")]
        table = np.array([(t, math.sin(9 * t), 0.0, 0.0) for t in times], dtype=columns)
        inputs = table if INPUTS[name] == "table" else INPUTS[name]
        given = table if callable(inputs) else inputs
        scene = box(load=[{"name": "push", "points": "x+"}], experiment={"stop_time": stop, "communication_step": STEP})
        with tempfile.TemporaryDirectory() as folder:
            fmu = softffd.package_fmu(scene, Path(folder) / "box.fmu")

            def base() -> Any:
                return fmpy.simulate_fmu(str(fmu), stop_time=stop, step_size=STEP, output_interval=STEP, input=given)

            own, rows = softffd.simulate(fmu, inputs=inputs), base()
            late = 1e-3  # m; fmpy sets inputs a step later
            require_alike("the run", own.positions[-1, 3, 3, 3, 0], rows["position[3,3,3].x"][-1], late)
            yield Pair(lambda: softffd.simulate(fmu, inputs=inputs), base, per=STEPS)


loop_with("none", goal=0.08)
loop_with("a table", goal=0.08)
loop_with("a function")


def sweep_of(runs: int, stop_time: float, *, driven: bool) -> None:
    """Adds a row for a sweep of the shipped scene `press`, with another stiffness of the edge springs in each run."""

    @row("runs", f"a sweep of press, {runs} runs of {stop_time:g} s{', driven' * driven}", "simulate, run by run", every_set=False)
    def sweep() -> Iterator[Pair]:
        scene, values = softffd.load_scene("press"), np.linspace(900, 1100, runs)
        inputs = scene.default_inputs if driven else None

        def one_by_one() -> None:
            for value in values:
                softffd.simulate(scene, start_values={"stiffness.edge": value}, inputs=inputs, stop_time=stop_time)

        def together() -> None:
            outputs = ["plane.table.reaction.z"]
            softffd.sweep(scene, {"stiffness.edge": values}, outputs=outputs, inputs=inputs, stop_time=stop_time)

        yield Pair(together, one_by_one, per=runs)


sweep_of(3, 4.0, driven=True)
sweep_of(20, 0.2, driven=False)


@row("runs", "one step of a scene, opened and closed", "fmpy's simulate_fmu of its FMU", every_set=False)
def one_step() -> Iterator[Pair]:
    """Measures the cost of a run beside its steps."""
    scene = softffd.load_scene("press")
    step = scene.experiment.communication_step
    with tempfile.TemporaryDirectory() as folder:
        fmu = softffd.package_fmu(scene, Path(folder) / "press.fmu")
        yield Pair(
            lambda: softffd.simulate(scene, stop_time=step), lambda: fmpy.simulate_fmu(str(fmu), stop_time=step, output_interval=step)
        )


@row("runs", "opening 16^3 in fmpy, FMI 3.0", "the same in FMI 2.0", every_set=False)
def opening() -> Iterator[Pair]:
    """Reads the description, loads the library and makes an instance."""
    scene = scene_from({"lattice": {"points": [16] * 3, "basis": "bspline"}, "inputs": {"forces": "all"}})
    with tempfile.TemporaryDirectory() as folder:
        unpacked = {}
        for fmi in (2, 3):
            path = softffd.package_fmu(scene, Path(folder) / f"box{fmi}.fmu", fmi=fmi)
            unpacked[fmi] = fmpy.extract(str(path), unzipdir=f"{folder}/{fmi}")

        def opened(fmi: int) -> float:
            began = time.process_time()
            description = fmpy.read_model_description(unpacked[fmi], validate=False)
            instance = fmpy.instantiate_fmu(unpacked[fmi], description, fmi_type="CoSimulation")
            took = time.process_time() - began
            instance.freeInstance()
            return took

        yield Pair(lambda: opened(3), lambda: opened(2))
