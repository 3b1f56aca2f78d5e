"""Blocks that are bonded to two plates, under small strain."""

from __future__ import annotations

from collections.abc import Iterator

from validation.published.cases import Body, Row
from validation.published.runs import WALL, Course, Size, drag, scene_of

SMALL = 1e-6
"""Strain of a block"""
CUBE = {0.25: 1.04262, 0.45: 1.1729, 0.49: 1.2201}
"""Apparent modulus divided by Young's modulus, from hp-refined finite elements, for each Poisson's ratio"""


def apparent_modulus(body: Body, height: float) -> tuple[float, tuple[int, float]]:
    """Returns the apparent modulus of a block of sides 1 between plates, divided by Young's modulus, and the steps and time [s] spent."""
    size: Size = (height, 1.0, 1.0)
    slowest = 1.5 / height  # rad/s, approximate shear frequency for modulus 1 and density 1
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
    """Compresses a block whose height makes its cells cubes. Gent and Lindley give 1 + 2 S2 for constant volume. The volume of a flat block
    changes, as if a spring of the bulk modulus were in series."""
    height = (body.points[0] - 1) / (body.points[1] - 1)
    shape = 1 / (4 * height)
    reference = 1 + 2 * shape**2
    if shape > 1:
        reference = 1 / (1 / reference + 3 * (1 - 2 * body.ratio))
    found, spent = apparent_modulus(body, height)
    yield Row(body, f"apparent modulus / E at S = {shape:g}", reference, found, *spent)
