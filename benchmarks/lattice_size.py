"""What finer lattices cost: package, state, and time per internal step and control point against 4 x 4 x 4 in the same run.

    python benchmarks/lattice_size.py

Every scene is a box of B-splines with the position of every control point as an output, leapfrog with a fixed internal step. Each is run
in turn with that of 4 x 4 x 4, several times over, and the smallest time of each counts; the ratio is what to read.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from softffd import Simulation
from softffd.fmu.package import package_fmu
from softffd.scene.scene import Scene, scene_from

SIDES = (4, 6, 8, 12, 16, 24, 32)
REPEATS = 5
POINT_STEPS = 2_000_000
"""Internal steps times control points in a timed communication step."""


def main() -> None:
    """Prints the table."""
    with tempfile.TemporaryDirectory() as folder:
        print("points     package s     MB   open s  state MB   ns/step/point  ratio to 4 x 4 x 4")
        small = _build(Path(folder), SIDES[0])[0]
        for side in SIDES:
            fmu, seconds = _build(Path(folder), side)
            start = time.perf_counter()
            with Simulation(fmu) as own, Simulation(small) as base:
                opened, state, _ = time.perf_counter() - start, _begin(own), _begin(base)
                laps = [(_run(own, side), _run(base, SIDES[0])) for _ in range(REPEATS)]
            took, other = (1e9 * min(times) / POINT_STEPS for times in zip(*laps, strict=True))
            megabytes = fmu.stat().st_size / 1e6
            print(
                f"{side:2}^3 {side**3:6} {seconds:8.2f} {megabytes:8.2f} {opened:8.2f} {state / 1e6:9.2f} {took:13.1f} {took / other:14.2f}"
            )


def _build(folder: Path, side: int) -> tuple[Path, float]:
    start = time.perf_counter()
    path = package_fmu(_scene(side), folder / f"box{side}.fmu")
    return path, time.perf_counter() - start


def _scene(side: int) -> Scene:
    """Springs and masses such that the stable step is the same for every lattice."""
    return scene_from(
        {
            "lattice": {"points": [side] * 3, "basis": "bspline"},
            "mass": {"total": side**3 / 64},
            "material": {"stiffness": 1e3, "damping": 0.0},
            "initial": {"stretch": [1.02, 1.0, 1.0]},
            "solver": {"method": "leapfrog", "step": 1e-4},
        }
    )


def _begin(simulation: Simulation) -> int:
    """Initializes; returns the size of the serialized state in bytes."""
    simulation.initialize()
    return len(bytes(simulation.save()))


def _run(simulation: Simulation, side: int) -> float:
    """Seconds of a communication step."""
    interval = 1e-4 * round(POINT_STEPS / side**3)
    start = time.process_time()
    simulation.step(interval)
    return time.process_time() - start


if __name__ == "__main__":
    main()
