"""Blocks between plates that they are bonded to, under small strain."""

from __future__ import annotations

from collections.abc import Iterator

from validation.published.cases import Body, Row
from validation.published.runs import WALL, Course, Size, drag, scene_of

SMALL = 1e-6
"""Strain"""
CUBE = {0.25: 1.04262, 0.45: 1.1729, 0.49: 1.2201}
"""Of hp-refined finite elements: apparent modulus by Young's modulus, by Poisson's ratio"""


def apparent_modulus(body: Body, height: float) -> tuple[float, tuple[int, float]]:
    """Of a block of sides 1 between plates, by its Young's modulus; steps and time [s]."""
    size: Size = (height, 1.0, 1.0)
    slowest = 1.5 / height  # rad/s, about, of shear; modulus and density are 1
    plate = {"name": "plate", "points": "x+", "motion": "input", "inputs": ["position.x", "velocity.x"]}
    scene = scene_of(
        body, size, 1.0, 1.0, material=drag(body, size, 1.0, slowest), pin=[WALL, plate], solver={"method": "leapfrog", "tolerance": 1e-9}
    )
    with Course(scene, {"pin.plate.velocity.x": -SMALL * height}) as course:
        course.step(1.0)
        course.sim["pin.plate.position.x"], course.sim["pin.plate.velocity.x"] = height * (1 - SMALL), 0.0
        force = course.rest(lambda: float(course.sim.number("pin.plate.reaction.x")), 2 / slowest)
        return force / SMALL, (course.steps, course.seconds)


def bonded_cube(body: Body) -> Iterator[Row]:
    found, spent = apparent_modulus(body, 1.0)
    yield Row(body, "apparent modulus / E", CUBE[body.ratio], found, *spent)


def bonded_block(body: Body) -> Iterator[Row]:
    """As flat as its cells are cubes. Gent and Lindley: 1 + 2 S2 where the volume cannot change; in flat blocks it does, as if a spring of
    the bulk modulus stood in a row with that."""
    height = (body.points[0] - 1) / (body.points[1] - 1)
    shape = 1 / (4 * height)
    reference = 1 + 2 * shape**2
    if shape > 1:
        reference = 1 / (1 / reference + 3 * (1 - 2 * body.ratio))
    found, spent = apparent_modulus(body, height)
    yield Row(body, f"apparent modulus / E at S = {shape:g}", reference, found, *spent)
