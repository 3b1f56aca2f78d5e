"""What a run costs beside its internal steps: processor time of `simulate` against fmpy's `simulate_fmu` on the same FMU, in the same run.

    python benchmarks/loop_cost.py

20,000 communication steps of one internal step each (leapfrog) of 4 x 4 x 4 points, whose 192 positions are recorded by both: without
inputs, with a load that a table gives, and with one that a function gives, which fmpy takes as a table. Opening the FMU is part of it.
Smallest of three; the ratios are what to read.

Predicted: an internal step 1.7 us, setting and getting 192 numbers by the library 0.2 us, the loop around them nothing: 2 us of fmpy's 65,
0.03; a function is called from Python before each step, some 10 us more.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import numpy as np

import softffd
from softffd.scene.scene import scene_from

STEP, STEPS, REPEATS = 1e-4, 20_000, 3
SCENE = {
    "load": [{"name": "push", "points": "x+"}],
    "outputs": {"reactions": False},
    "solver": {"method": "leapfrog", "step": STEP},
    "experiment": {"stop_time": STEP * STEPS, "communication_step": STEP},
}


def main() -> None:
    """Prints the table."""
    times = np.linspace(0, STEP * STEPS, 201)
    table = np.array([(t, math.sin(9 * t)) for t in times], dtype=[("time", float), ("load.push.x", float)])
    print(f"{'inputs':10} fmpy us/step   simulate us/step   ratio")
    with tempfile.TemporaryDirectory() as folder:
        fmu = softffd.package_fmu(scene_from(SCENE), Path(folder) / "box.fmu")
        for name, inputs in (("none", None), ("table", table), ("function", lambda t: {"load.push.x": math.sin(9 * t)})):
            given = table if callable(inputs) else inputs
            base = smallest(lambda given=given: fmpy.simulate_fmu(str(fmu), step_size=STEP, output_interval=STEP, input=given))
            own = smallest(lambda inputs=inputs: softffd.simulate(fmu, inputs=inputs))
            print(f"{name:10} {base / STEPS * 1e6:12.1f} {own / STEPS * 1e6:18.1f} {own / base:7.3f}")


def smallest(call: Callable[[], Any]) -> float:
    """The smallest of several processor times [s]."""
    times = []
    for _ in range(REPEATS):
        began = time.process_time()
        call()
        times.append(time.process_time() - began)
    return min(times)


if __name__ == "__main__":
    main()
