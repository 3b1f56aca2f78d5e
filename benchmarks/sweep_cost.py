"""What a sweep costs against the same runs one by one: processor time of both in the same program, one core.

    .venv/bin/python benchmarks/sweep_cost.py [RUNS]

RUNS (200 by default) runs of the shipped `press` with other edge springs, by `simulate` and by `sweep`: driven by its own inputs and not,
over its 4 s and over 0.2 s. The last column is the least there can be: the component's own calls, that is set, initialize and step, with
nothing read; what a sweep adds to it is one opening, reading and the interpreter. Half of the single runs come before the sweep, half
after it.

Predicted from single runs: opening is 12 ms, reading all outputs and computing the inputs of 400 steps 35 ms, the steps themselves 30 ms
(not driven) and 100 ms (driven). A sweep cannot go below 0.6 over 4 s, and is at 0.2 over 0.2 s, where opening is most of a run.
Found: 0.73 driven and 0.63 not driven over 4 s, 0.20 over 0.2 s; at most 0.03 above the component's own calls. Before `simulate`
went many steps at a time it was 0.63, 0.50 and 0.14.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import softffd
from softffd.run.inputs import Inputs
from softffd.run.times import communication_points

NAME, OUTPUT = "stiffness.edge", "plane.table.reaction.z"


def main() -> None:
    """Prints the table."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    scene = softffd.load_scene("press")
    print(f"{runs} runs of press, ms a run         simulate    sweep   ratio   own calls   ratio")
    for words, driven, stop_time in (("driven, 4 s", 1, 4.0), ("still, 4 s", 0, 4.0), ("driven, 0.2 s", 1, 0.2), ("still, 0.2 s", 0, 0.2)):
        compare(words, scene, scene.default_inputs if driven else None, stop_time, np.linspace(900, 1100, runs))


def compare(words: str, scene: softffd.Scene, inputs: Any, stop_time: float, values: np.ndarray) -> None:
    """One line of the table; the numbers of both must be the same."""
    found: list[float] = []
    table: list[softffd.Sweep] = []
    first, second = np.array_split(values, 2)
    single = processor_time(lambda: one_by_one(scene, first, inputs, stop_time, found))
    together = processor_time(
        lambda: table.append(softffd.sweep(scene, {NAME: values}, outputs=[OUTPUT], inputs=inputs, stop_time=stop_time))
    )
    least = own_calls(scene, values, inputs, stop_time)
    single += processor_time(lambda: one_by_one(scene, second, inputs, stop_time, found))
    assert table[0].outputs[OUTPUT].tolist() == found
    single, together, least = (total / len(values) * 1e3 for total in (single, together, least))
    print(f"{words:34} {single:8.1f} {together:8.1f} {together / single:7.2f} {least:11.1f} {least / single:7.2f}", flush=True)


def one_by_one(scene: softffd.Scene, values: np.ndarray, inputs: Any, stop_time: float, found: list[float]) -> None:
    """Runs by `simulate`."""
    for value in values:
        result = softffd.simulate(scene, start_values={NAME: value}, inputs=inputs, stop_time=stop_time)
        found.append(float(result.outputs[OUTPUT][-1]))


def own_calls(scene: softffd.Scene, values: np.ndarray, inputs: Any, stop_time: float) -> float:
    """Processor time of what the component itself does in these runs [s]; opening and the course of the inputs are not counted."""
    times = communication_points(stop_time, step := scene.experiment.communication_step)
    with softffd.Simulation(scene) as simulation:
        source = Inputs(inputs)
        source.derive_only({variable.name for variable in simulation.component.variables("input")})
        block = simulation.component.block([*source.names, *source.derived_names])
        course = [source.values(now, then) for now, then in zip(times, [*times[1:], times[-1]], strict=True)]

        def run() -> None:
            for value in values:
                simulation.restart(start_values={NAME: value}, stop_time=stop_time)
                for row, time_ in enumerate(times[:-1]):
                    if inputs:
                        block.set(course[row])
                    simulation.initialize()
                    simulation.component.do_step(time_, step)

        return processor_time(run)


def processor_time(call: Callable[[], Any]) -> float:
    """[s]"""
    began = time.process_time()
    call()
    return time.process_time() - began


if __name__ == "__main__":
    main()
