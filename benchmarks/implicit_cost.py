"""Cost of implicit steps by lattice: slow motion (ros34pw2) against leapfrog on the same scene, and sliding on a plane (backward_euler).

    python benchmarks/implicit_cost.py

A falling cube of 1e6 N/m is pulled apart slowly for 0.3 s. Another cube of 1e6 N/m slides down with friction, in communication steps of
10 ms. Times are processor times of whole runs without their opening; the positions of both methods are compared. Layers of up to 64 points
use a matrix factor, larger layers use conjugate gradients. Leapfrog is left out for the last lattices, where it would take minutes.
"""

from __future__ import annotations

import math
import time

from softffd import Scene, Simulation
from softffd.scene.scene import scene_from

LATTICES = ((4, 4, 4), (6, 6, 6), (8, 8, 8), (9, 9, 9), (12, 12, 12), (32, 32, 4), (16, 16, 16), (24, 24, 24))
EXPLICIT_UP_TO = 1000
"""Most control points of a lattice that leapfrog runs"""
GRAVITY = -9.81


def main() -> None:
    """Prints the table."""
    print("lattice        points  ros34pw2: steps  ms/step  leapfrog: steps       s   gain  difference  sliding ms/step")
    for counts in LATTICES:
        points = math.prod(counts)
        seconds, steps, places = _pull(counts, "ros34pw2")
        line = f"{' x '.join(map(str, counts)):14} {points:6} {steps:16} {1e3 * seconds / steps:8.2f}"
        if points <= EXPLICIT_UP_TO:
            explicit, taken, others = _pull(counts, "leapfrog")
            line += f" {taken:16} {explicit:7.2f} {explicit / seconds:6.1f} {abs(places - others).max():11.1e}"
        else:
            line += " " * 43
        print(f"{line} {_slide(counts):16.2f}", flush=True)


def _scene(counts: tuple[int, int, int], method: str, **sections: object) -> Scene:
    points = math.prod(counts)
    document = {
        "lattice": {"points": list(counts)},
        "material": {"stiffness": 1e6, "damping": 32.0 / points},
        "outputs": {"solver": True},
        "solver": {"method": method},
    }
    return scene_from({**document, **sections})


def _pull(counts: tuple[int, int, int], method: str) -> tuple[float, int, object]:
    loads = [{"name": "left", "points": "x-"}, {"name": "right", "points": "x+"}]
    scene = _scene(counts, method, load=loads, environment={"gravity": [0.0, 0.0, GRAVITY]}, experiment={"stop_time": 0.3})
    with Simulation(scene) as sim:
        began = time.process_time()
        for n in range(3):
            force = 20 * math.sin(math.pi / 2 * (n + 1) / 3) ** 2
            sim["load.left.x"], sim["load.right.x"] = -force, force
            sim.step(0.1)
        return time.process_time() - began, int(sim["solver.steps"]), sim.positions.copy()


def _slide(counts: tuple[int, int, int]) -> float:
    steps = 20
    sections = {"plane": [{"name": "ground", "friction": 0.3}], "environment": {"gravity": [4.0, 0.0, GRAVITY]}}
    with Simulation(_scene(counts, "backward_euler", **sections)) as sim:
        began = time.process_time()
        for _ in range(steps):
            sim.step(0.01)
        return 1e3 * (time.process_time() - began) / steps


if __name__ == "__main__":
    main()
