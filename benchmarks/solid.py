"""Accuracy of springs and solids by points per side: deflections of a clamped cube against elasticity, and the force of a pressed pad.

    python benchmarks/solid.py                                # the tables
    python benchmarks/solid.py docs/materials.md                # and in place of those in this page

The cube is pinned at x = 0 and loaded so little that it is linear. Implicit steps take springs to rest, drag takes a solid to rest. The
reference, `tests/data/solid.json`, is a finite-element solution made without this program. The pad is a cube of 20 mm of 1 MPa between
plates of friction 0.8, pressed to nine tenths of its height in half a second and held.
"""

from __future__ import annotations

import json
import re
import sys
from itertools import product
from pathlib import Path

import numpy as np

from softffd import Simulation, simulate
from softffd.scene.scene import scene_from

REFERENCE = json.loads((Path(__file__).resolve().parents[1] / "tests" / "data" / "solid.json").read_text())
LOADS = {"end pull": 0, "own weight along": 0, "end shear": 2, "own weight across": 2}
"""Loads with the axis along which each acts"""
POINTS = (4, 7, 13)
SOLID_POINTS, RATIOS = (4, 7, 10), (0.25, 0.45, 0.49)
PAD_POINTS = (4, 5, 7, 10, 13)
MODULUS, DENSITY, SMALL = 1e6, 1e3, 1e-6
"""Modulus [Pa], density [kg/m3], and load by modulus, which is also the size of the strains"""
SIDE = 0.02
"""Side of the pad [m]"""


def main() -> None:
    """Prints the tables, and writes the tables into the pages named on the command line."""
    tables = [deflections(), solid_deflections(), pads()]
    print("\n\n".join(tables))
    for page in map(Path, sys.argv[1:]):
        text = page.read_text()
        for table in tables:
            head = re.escape(table.splitlines()[0])
            text = re.sub(rf"^{head}\n(\|.*\n)*", lambda _, new=table: new + "\n", text, flags=re.MULTILINE)
        page.write_text(text)


def deflections() -> str:
    """Returns a table of the errors of the mean tip displacement of springs, with a line per load."""
    lines = ["| load | " + " | ".join(f"{n} points a side" for n in POINTS) + " |", "|---" * (1 + len(POINTS)) + "|"]
    for load in LOADS:
        lines.append(_line(load, [100 * error(n, load) for n in POINTS]))
    return "\n".join(lines)


def _line(name: str, errors: list[float]) -> str:
    """Returns a line of errors [%] with two digits each and no minus before a zero."""
    return f"| {name} | " + " | ".join(f"{e:.1f} %" if abs(e) >= 1 else f"{round(e, 2) + 0.0:.2f} %" for e in errors) + " |"


def solid_deflections() -> str:
    """Returns a table of the errors of the mean tip displacement of solids, with a line per load and Poisson's ratio."""
    heads = " | ".join(f"{n} points a side" for n in SOLID_POINTS)
    lines = [f"| load, Poisson's ratio | {heads} |", "|---" * (1 + len(SOLID_POINTS)) + "|"]
    for load, ratio in product(LOADS, RATIOS):
        lines.append(_line(f"{load}, {ratio:g}", [100 * solid_error(n, load, ratio) for n in SOLID_POINTS]))
    return "\n".join(lines)


def solid_error(n: int, load: str, ratio: float) -> float:
    """Returns the relative error of the displacement of a solid's tip at rest."""
    axis, weight = LOADS[load], "weight" in load
    scene = scene_from(
        {
            "lattice": {"points": [n, n, n]},
            "material": {"model": "solid", "youngs_modulus": MODULUS, "poissons_ratio": ratio, "damping": 20 * DENSITY / n**3},
            "mass": {"density": DENSITY},
            "environment": {"gravity": [SMALL * MODULUS / DENSITY * (weight and a == axis) for a in range(3)]},
            "pin": [{"name": "wall", "points": "x-"}],
            "load": [{"name": "end", "points": "x+"}],
            "solver": {"method": "leapfrog"},
        }
    )
    share = np.ones(n)
    share[3:-1:3] = 2  # all weights of a patch have the same integral, and two patches meet in these points
    share = np.outer(share, share) / share.sum() ** 2
    with Simulation(scene) as sim:
        place = sim.block(f"position[{n - 1},{j},{k}].{'xyz'[axis]}" for j in range(n) for k in range(n))
        if not weight:
            sim[f"load.end.{'xyz'[axis]}"] = SMALL * MODULUS
        before = place.get().copy()
        for _ in range(8):
            sim.step(1.0)  # in each step drag leaves exp(-10) of the remaining displacement
        return float(share.ravel() @ (place.get() - before) / SMALL / REFERENCE[f"{ratio:g}"][load]) - 1


def error(n: int, load: str) -> float:
    """Returns the relative error of the displacement of the tip of springs at rest."""
    axis, weight = LOADS[load], "weight" in load
    scene = scene_from(
        {
            "lattice": {"points": [n, n, n]},
            "material": {"youngs_modulus": MODULUS, "internal_damping": 0.03},
            "mass": {"density": DENSITY},
            "environment": {"gravity": [SMALL * MODULUS / DENSITY * (weight and a == axis) for a in range(3)]},
            "pin": [{"name": "wall", "points": "x-"}],
            "inputs": {"forces": "x+"},
            "solver": {"method": "backward_euler"},
        }
    )
    share = np.ones(n)
    share[[0, -1]] = 0.5  # points on the edges of the face have half the area of inner points, corners a quarter
    share = np.outer(share, share) / (n - 1) ** 2
    with Simulation(scene) as sim:
        tip = [f"{n - 1},{j},{k}].{'xyz'[axis]}" for j in range(n) for k in range(n)]
        if not weight:
            sim.block("force[" + point for point in tip).set((SMALL * MODULUS * share).ravel().tolist())
        place = sim.block("position[" + point for point in tip)
        before = place.get().copy()
        for _ in range(4):
            sim.step(1.0)  # about five periods each; implicit steps leave no vibration
        return float(share.ravel() @ (place.get() - before) / SMALL / REFERENCE["0.25"][load]) - 1


def pads() -> str:
    """Returns a table of the force of the pad, with a column per lattice."""
    forces = " | ".join(f"{pad_force(n):.2f} N" for n in PAD_POINTS)
    return f"| points a side | {' | '.join(map(str, PAD_POINTS))} |\n" + "|---" * (1 + len(PAD_POINTS)) + f"|\n| force | {forces} |"


def pad_force(n: int) -> float:
    """Returns the force on the upper plate [N], while the pad is held."""
    above = {"name": "above", "point": [0.0, 0.0, SIDE], "normal": [0.0, 0.0, -1.0], "motion": "input", "inputs": ["point.z", "velocity.z"]}
    scene = scene_from(
        {
            "lattice": {"points": [n, n, n], "size": [SIDE, SIDE, SIDE]},
            "material": {"youngs_modulus": MODULUS},
            "mass": {"density": DENSITY},
            "plane": [{"name": "below", "friction": 0.8}, above | {"friction": 0.8}],
            "solver": {"method": "backward_euler"},
            "experiment": {"stop_time": 0.8, "communication_step": 0.1},
        }
    )
    speed = -SIDE / 5  # m/s, for half a second
    pressed = simulate(
        scene,
        inputs=lambda t: {"plane.above.point.z": SIDE + speed * min(t, 0.5), "plane.above.velocity.z": speed * (t < 0.5)},
    )
    return float(pressed.outputs["plane.above.reaction.z"][-1])


if __name__ == "__main__":
    main()
