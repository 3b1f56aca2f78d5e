"""The cost map: what kinds of scenes cost by stiffness, without and with internal damping.

    python benchmarks/cost_map.py                                         # the table, in some minutes
    python benchmarks/cost_map.py --tau 1e-4 --only rests drops           # damped columns and these kinds alone
    python benchmarks/cost_map.py --tau 1e-4 --page docs/measurements.md  # and in place of the table in this page

A cube of 0.1 m and 0.5 kg runs for 0.05 s in communication steps of 10 ms. A cell shows how many times faster than real time the run is,
in processor time, the number of internal steps, and "!" if there is a warning. Cells slower than real time or refused are bold. Steps are
the same on every machine, times are not; the cost of a bare explicit step in the same run is therefore printed below the table.
"""

from __future__ import annotations

import argparse
import math
import re
import tempfile
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

from boxes import STEP, box
from rows_steps import steps_of

from softffd import FmuError, Simulation
from softffd.scene.scene import Scene, scene_from

SIDE, MASS = 0.1, 0.5
"""Side [m] and mass [kg] of the cube"""
STOP, COMMUNICATION_STEP = 0.05, 0.01
"""Duration of a run and communication step [s]"""
STIFFNESSES, DAMPINGS = (1e3, 1e5, 1e7), (0.0, 1e-4)
"""Stiffnesses [N/m] and internal damping times [s]"""
LIMIT = 25.0
"""Processor time [s] after which a cell is abandoned at a communication point"""
SQUARES = 6
"""Squares along a side of each face of the surface"""
TIMES_ITS_NEIGHBOUR = 10.0


@dataclass(frozen=True)
class Kind:
    """A row of the map."""

    sections: dict[str, Any]
    points: int = 4
    surface: bool = False
    material: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Cell:
    """The cost of a scene. `finished` is false if the run was abandoned or a step was refused."""

    seconds: float
    steps: int
    warned: bool
    finished: bool
    refused: bool = False

    @property
    def times_real_time(self) -> float:
        return STOP / self.seconds if self.finished else 0.0

    def __str__(self) -> str:
        if self.refused:
            return "**refused**"
        if not self.finished:
            return f"**> {LIMIT:g} s**"
        words = f"{self.times_real_time:.2g} ({self.steps:,}{'!' * self.warned})"
        return words if self.times_real_time >= 1 else f"**{words}**"


PINNED = [{"name": "wall", "points": "z+"}]
GROUND = {"name": "ground", "friction": 0.5}
LID = {"name": "lid", "friction": 0.5, "point": [0.0, 0.0, 0.098], "normal": [0.0, 0.0, -1.0]}
TABLE = {"name": "table", "friction": 0.5, "point": [0.0, 0.0, -0.5], "size": [2.0, 2.0, 1.0]}
TILTED = {"offset": [0.0, 0.0, 0.03], "rotation": {"axis": [1.0, 0.4, 0.0], "degrees": 25.0}}

KINDS = {
    "free, turning": Kind({"initial": {"velocity": [1.0, 0.0, 0.0], "angular_velocity": [0.0, 3.0, 1.0]}}),
    "pinned face": Kind({"pin": PINNED}),
    "pinned face, a layer of 1e8": Kind({"pin": PINNED, "region": [{"points": "z-", "stiffness": 1e8}]}),
    "pinned face, volume stiffness": Kind({"pin": PINNED}, material={"volume_stiffness": 1e4}),
    "rests, points": Kind({"plane": [GROUND]}),
    "rests, surface": Kind({"plane": [GROUND]}, surface=True),
    "drops 1 cm, points": Kind({"plane": [GROUND], "initial": {"offset": [0.0, 0.0, 0.01]}}),
    "drops 1 cm, surface": Kind({"plane": [GROUND], "initial": {"offset": [0.0, 0.0, 0.01]}}, surface=True),
    "drops 2 mm on a box, surface": Kind({"box": [TABLE], "initial": {"offset": [0.0, 0.0, 0.002]}}, surface=True),
    "drops tilted, points": Kind({"plane": [GROUND], "initial": TILTED}),
    "squeezed by 2 mm between planes": Kind({"plane": [GROUND, LID]}),
    "8^3, pinned face": Kind({"pin": PINNED}, points=8),
    "8^3, rests": Kind({"plane": [GROUND]}, points=8),
}


def main() -> None:
    """Prints the table, and writes the table into the page given by --page."""
    options = parsed()
    kinds = [name for name in KINDS if not options.only or any(text in name for text in options.only)]
    columns = list(product(options.stiffness, options.tau))
    found: dict[str, list[Cell]] = {}
    lines = head(columns)
    print("\n".join(lines), flush=True)
    for name in kinds:
        found[name] = [measured(KINDS[name], *column) for column in columns]
        lines.append(f"| {name} | {' | '.join(map(str, found[name]))} |")
        print(lines[-1], flush=True)
    sizes = sorted({KINDS[name].points for name in kinds})
    print("\nbare explicit step:", ", ".join(f"{1e6 * bare_step(side):.2g} us ({side}^3)" for side in sizes))
    print("\n".join(beside_neighbours(found, columns)))
    if options.page:
        write(options.page, lines)


def parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="cost_map.py", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--only", nargs="+", metavar="TEXT", help="kinds with this in their names")
    parser.add_argument("--stiffness", nargs="+", type=float, default=STIFFNESSES, metavar="K", help="of each spring [N/m]")
    parser.add_argument("--tau", nargs="+", type=float, default=DAMPINGS, metavar="TAU", help="internal damping [s]")
    parser.add_argument("--page", type=Path, metavar="FILE.md", help="put the table in the place of the one with its head there")
    return parser.parse_args()


def head(columns: list[tuple[float, float]]) -> list[str]:
    return [f"| k [N/m] | {' | '.join(map(column_words, columns))} |", "|---" * (1 + len(columns)) + "|"]


def column_words(column: tuple[float, float]) -> str:
    """Returns stiffness and internal damping as text: "1e3, tau 1e-4"."""
    stiffness, tau = map(number_words, column)
    return f"{stiffness}, tau {tau}" if column[1] else stiffness


def number_words(number: float) -> str:
    """Returns a number as short text: "1e3" for 1000."""
    return re.sub(r"e([+-])0*", lambda sign: "e" + sign[1].strip("+"), f"{number:.0e}")


def measured(kind: Kind, stiffness: float, tau: float) -> Cell:
    """Runs a scene to its end, or until the run is abandoned or refused. stiffness: [N/m]; tau: internal damping [s]."""
    with warnings.catch_warnings(), Simulation(scene_of(kind, stiffness, tau)) as simulation:
        warnings.simplefilter("ignore")
        began, seconds = time.process_time(), 0.0
        left = round(STOP / COMMUNICATION_STEP)
        refused = False
        while left and seconds < LIMIT and not refused:
            try:
                simulation.step(COMMUNICATION_STEP)
                left -= 1
            except FmuError:
                refused = True
            seconds = time.process_time() - began
        return Cell(seconds, int(simulation["solver.steps"]), bool(simulation.warnings), not left, refused)


def scene_of(kind: Kind, stiffness: float, tau: float) -> Scene:
    material = {"stiffness": stiffness, "damping": 0.0, **({"internal_damping": tau} if tau else {}), **kind.material}
    lattice = {"points": [kind.points] * 3, **({"basis": "bspline"} if kind.points > 4 else {})}
    shape: dict[str, Any] = {"lattice": lattice | {"size": [SIDE] * 3, "origin": [0.0] * 3}, "mass": {"total": MASS}}
    if kind.surface:
        mesh = {"file": str(Path(cube_folder().name, "cube.obj")), "scale": SIDE}
        shape = {"lattice": lattice, "mass": {"total": MASS, "distribution": "uniform"}, "mesh": mesh}
    about = {"environment": {"gravity": [0.0, 0.0, -9.81]}, "outputs": {"solver": True}}
    return scene_from({**shape, "material": material, **about, **kind.sections})


@cache
def cube_folder() -> tempfile.TemporaryDirectory[str]:
    """Returns a folder with `cube.obj`, a cube of 1 m with SQUARES^2 squares per face. The folder is removed when the program ends."""
    index: dict[tuple[int, ...], int] = {}
    faces = [[index.setdefault(corner, len(index) + 1) for corner in square] for square in squares()]
    lines = [f"v {' '.join(f'{x / SQUARES:.9g}' for x in corner)}" for corner in index]
    lines += [f"f {' '.join(map(str, face))}" for face in faces]
    folder = tempfile.TemporaryDirectory()
    Path(folder.name, "cube.obj").write_text("\n".join(lines) + "\n")
    return folder


def squares() -> Iterator[list[tuple[int, ...]]]:
    """Yields the corners of each square of a cube's surface, counterclockwise from outside, in units of a square's side."""
    for axis, place, i, j in product(range(3), (0, SQUARES), range(SQUARES), range(SQUARES)):
        corners = []
        for u, v in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)):
            corner = [0, 0, 0]
            corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = place, u, v
            corners.append(tuple(corner))
        yield corners if place else corners[::-1]


def bare_step(side: int) -> float:
    """Returns the processor time [s] of an explicit step of springs alone."""
    count = steps_of(side)
    with Simulation(box(side)) as simulation:
        simulation.step(count * STEP)
        began = time.process_time()
        simulation.step(count * STEP)
        return (time.process_time() - began) / count


def beside_neighbours(found: dict[str, list[Cell]], columns: list[tuple[float, float]]) -> Iterator[str]:
    """Yields a line for each cell that takes more than ten times as long as a cell of the next stiffness, or of the next damping."""
    stiffnesses, dampings = (sorted(set(values)) for values in zip(*columns, strict=True))
    place = {column: (stiffnesses.index(column[0]), dampings.index(column[1])) for column in columns}
    for name, cells in found.items():
        run = [(column, cell) for column, cell in zip(columns, cells, strict=True) if not cell.refused]
        for (one, cell), (other, beside) in product(run, repeat=2):
            ratio = cell.seconds / beside.seconds
            if math.dist(place[one], place[other]) == 1 and ratio > TIMES_ITS_NEIGHBOUR:
                yield f"{name}: {column_words(one)} takes {ratio:.0f} times as long as {column_words(other)}"


def write(page: Path, lines: list[str]) -> None:
    """Replaces the table with the same head in a page. Ends the program if there is none."""
    text, count = re.subn(rf"^{re.escape(lines[0])}\n(\|.*\n)*", lambda _: "\n".join(lines) + "\n", page.read_text(), flags=re.MULTILINE)
    if not count:
        raise SystemExit(f"cost_map.py: {page}: wanted a table that begins with {lines[0]}")
    page.write_text(text)


if __name__ == "__main__":
    main()
