"""The cost of the parts of a scene: an internal step with a part against an internal step of springs alone."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from boxes import STEP, box
from measured import Pair, row

from softffd import Simulation
from validation import shapes

GROUP, ALONE = "parts of a scene", "a step of springs alone"
INTERVAL = 0.1
"""Communication step [s]: a thousand internal steps, so many that the cost of the communication step itself does not count"""

GRAVITY = {"environment": {"gravity": [0.0, 0.0, -9.81]}}
AT_REST = {"initial": {"stretch": [1.0, 1.0, 1.0]}}
SETTLING = 3.0
"""Time [s] after which a body with the damping of SETTLES has come to rest on the ground"""
SETTLES = {"material": {"damping": 0.3}}
LONG = 0.1
"""Duration [s] of a run that is compared as a whole"""
SLIDING = {"velocity": [1.0, 0.0, 0.0]}


def ground(height: float) -> dict[str, Any]:
    """Returns the sections of a plane, with its reaction and torque as outputs."""
    plane = {"name": "ground", "point": [0.0, 0.0, height], "normal": [0.0, 0.0, 1.0], "friction": 0.4}
    return {"plane": [plane], "outputs": {"reactions": True}}


def part(name: str, *, goal: float | None = None, **sections: Any) -> None:
    """Adds a row for a scene with these additional sections."""

    @row(GROUP, name, ALONE, goal=goal)
    def with_part() -> Iterator[Pair]:
        with Simulation(box(**sections)) as own, Simulation(box()) as bare:
            yield Pair(lambda: lap(own), lambda: lap(bare), per=round(INTERVAL / STEP))


def on_its_surface(name: str, body: shapes.Shape, *, goal: float | None = None, after: float = 0.0, **sections: Any) -> None:
    """Adds a row for a scene whose obstacles meet the vertices of this body, measured from the start or from a time `after` [s] on."""

    @row(GROUP, name, ALONE, goal=goal)
    def with_surface() -> Iterator[Pair]:
        with tempfile.TemporaryDirectory() as folder:
            mesh = {"file": shapes.write(Path(folder) / "body.obj", body)}
            with Simulation(box(mesh=mesh, contact={"of": "surface"}, **sections)) as own, Simulation(box()) as bare:
                while own.time < after:
                    own.step(INTERVAL)
                yield Pair(lambda: own.step(INTERVAL) if after else lap(own), lambda: lap(bare), per=round(INTERVAL / STEP))


def against_a_plane(name: str, side: int, *, material: dict[str, float], **initial: Any) -> None:
    """Adds a row for a cube with side^2 squares per face on the face of a box, against the cube on a plane."""

    @row(GROUP, f"{6 * side * side + 2:,} vertices {name}", "the same on a plane", goal=1.5)
    def on_a_box() -> Iterator[Pair]:
        with tempfile.TemporaryDirectory() as folder:
            mesh = {"file": shapes.write(Path(folder) / "body.obj", shapes.cube(side, 0.0))}
            sections = {
                "mesh": mesh,
                "contact": {"of": "surface"},
                "material": material,
                "initial": AT_REST["initial"] | initial,
                **GRAVITY,
            }
            table = {"name": "table", "friction": 0.4, "size": [9.0, 9.0, 1.0], "point": [0.5, 0.5, -0.5]}
            beside = {"solver": {"method": "auto", "step": 0.0}, "experiment": {"stop_time": LONG}}
            with Simulation(box(**sections | beside, box=[table])) as own, Simulation(box(**sections | beside, **ground(0.0))) as base:
                yield Pair(lambda: run_through(own), lambda: run_through(base))


def run_through(simulation: Simulation) -> float:
    """Returns the processor time [s] of a run in communication steps of 10 ms."""
    simulation.restart()
    began = time.process_time()
    while simulation.time < LONG - 1e-9:
        simulation.step(0.01)
    return time.process_time() - began


def on_feet() -> shapes.Shape:
    """Returns a body with three vertices below."""
    below, above = [(0.2, 0.2, 0.0), (0.8, 0.25, 0.0), (0.5, 0.8, 0.0)], [(0.3, 0.3, 0.9), (0.7, 0.3, 0.9), (0.5, 0.7, 0.9)]
    return np.array(below + above), np.array([(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)])


def on_a_face(side: int) -> shapes.Shape:
    """Returns a pyramid with side x side vertices below."""
    along = np.linspace(0, 1, side)
    below = np.stack([*np.meshgrid(along, along), np.zeros((side, side))], -1).reshape(-1, 3)
    number = np.arange(side * side).reshape(side, side)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    rim = np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])
    sides = np.stack([rim, np.roll(rim, -1), np.full(len(rim), side * side)], -1)
    return np.vstack([below, (0.5, 0.5, 1.0)]), np.vstack([np.stack([a, b, c], -1), np.stack([a, c, d], -1), sides])


def lap(simulation: Simulation) -> float:
    """Returns the processor time [s] of the second communication step of a restarted run, so that every repetition does the same."""
    simulation.restart()
    simulation.step(INTERVAL)
    began = time.process_time()
    simulation.step(INTERVAL)
    return time.process_time() - began


part("damping", material={"damping": 0.01})
part("internal damping", material={"internal_damping": 1e-4})
part("gravity", **GRAVITY)
part("a load", load=[{"name": "push", "points": "x+"}])
part("64 force inputs", inputs={"forces": "all"})
part("energy outputs", outputs={"energy": True})
part("a plane out of reach", **ground(-9.0))
part("16 points resting on a plane", goal=1.4, **GRAVITY, **AT_REST, **ground(0.0))
on_its_surface("a surface out of reach", on_feet(), goal=1.1, **ground(-9.0))
for vertices, body, most in (("3 vertices", on_feet(), 1.6), ("5,041 vertices", on_a_face(71), 4.0)):
    on_its_surface(f"{vertices} resting on a plane", body, goal=most, after=SETTLING, **GRAVITY, **SETTLES, **AT_REST, **ground(0.0))
    on_its_surface(f"{vertices} on a plane, swaying", body, **GRAVITY, **AT_REST, **ground(0.0))
for squares in (4, 8, 16):
    against_a_plane("resting on a box", squares, material={"stiffness": 2e3, "damping": 0.05})
    against_a_plane("sliding on a box", squares, material={"stiffness": 2e3, "damping": 0.05}, **SLIDING)
    against_a_plane("dropped on a box", squares, material={"stiffness": 2e3, "damping": 0.05}, offset=[0.0, 0.0, 0.01])
for squares in (4, 8):
    against_a_plane("of rubber, sliding on a box", squares, material={"stiffness": 1e4, "internal_damping": 1e-3}, **SLIDING)
on_its_surface("386 vertices sliding on a plane", shapes.cube(8, 0.0), **GRAVITY, **ground(0.0), initial=SLIDING)
ball = {"name": "ball", "friction": 0.4, "radius": 2.0, "point": [0.5, 0.5, -2.0]}
on_its_surface("386 vertices resting on a sphere", shapes.cube(8, 0.0), after=SETTLING, **GRAVITY, **SETTLES, **AT_REST, sphere=[ball])
part("volume stiffness, body in shape", material={"volume_stiffness": 9e3})
too_soft_to_unfold = {"volume_stiffness": 1e-6}
part("volume stiffness, all corners folded", material=too_soft_to_unfold, initial={"stretch": [1.02, 1.0, -1.0]})
part("a pinned face", pin=[{"name": "base", "points": "z-"}], outputs={"reactions": True})
