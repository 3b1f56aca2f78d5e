"""Hertz's contact of a rigid sphere and a block: the sphere is pressed into the block at rest, or hits the block as a mass."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from softffd import Scene
from validation.published.cases import Body, Row
from validation.published.runs import Course, Size, drag, scene_of
from validation.shapes import cube, write

RADIUS, MODULUS = 0.02, 1e6
"""Radius of the sphere [m], Young's modulus of the block [Pa]"""
SIDE = 0.04
"""Side of the block [m], a cube that is held at its base"""
GIVES = -0.1088
"""Additional compliance of the block, relative to a half-space, far from the contact: displacement times Young's modulus times side,
divided by the force; for Poisson's ratio 1/4"""
MASS, SPEED, LIGHT = 0.03686, 1.0, 10.0
"""Mass [kg] and speed [m/s] of the sphere that hits, and density [kg/m3] of the block, which is light enough to follow without waves"""
LOOKS = 400
"""Samples in the contact time of an impact"""
DEPTHS = (0.025, 0.05, 0.1)
"""Depths divided by the radius"""


def hertz(ratio: float, depth: float) -> float:
    """Returns the force [N] on a sphere at a depth [m] in a half-space."""
    return 4 / 3 * MODULUS / (1 - ratio**2) * math.sqrt(RADIUS) * depth**1.5


def pressed_sphere(body: Body) -> Iterator[Row]:
    """Presses the sphere to its depth in a half-space plus the additional displacement of the block, and reads the force at rest."""
    density = 1000.0
    slowest = _slowest(density)
    with TemporaryDirectory() as folder, Course(_scene(body, density, folder)) as course:
        before, steps, seconds = 0.0, 0, 0.0
        for part in DEPTHS:
            reference = hertz(body.ratio, part * RADIUS)
            way = part * RADIUS + GIVES * reference / (MODULUS * SIDE)
            course.sim["sphere.ball.velocity.z"] = -(way - before) * slowest / 2
            course.step(2 / slowest)
            course.sim["sphere.ball.point.z"], course.sim["sphere.ball.velocity.z"] = SIDE + RADIUS - way, 0.0
            force = course.rest(lambda: float(course.sim.number("sphere.ball.reaction.z")), 1 / slowest)
            yield Row(body, f"force at d / R = {part:g} [N]", reference, force, course.steps - steps, course.seconds - seconds)
            before, steps, seconds = way, course.steps, course.seconds


def hitting_sphere(body: Body) -> Iterator[Row]:
    """Lets the sphere hit the block. The host moves the sphere as a mass, with the block's reaction after each communication step."""
    period, force = impact(body.ratio)
    with TemporaryDirectory() as folder, Course(_scene(body, LIGHT, folder)) as course:
        step, place, speed, forces = period / LOOKS, SIDE + RADIUS, -SPEED, [0.0]
        while speed < 0 or forces[-1] > 0:
            course.sim["sphere.ball.point.z"], course.sim["sphere.ball.velocity.z"] = place, speed
            course.step(step)
            forces.append(float(course.sim.number("sphere.ball.reaction.z")))
            place += step * speed
            speed += step * forces[-1] / MASS
        spent = course.steps, course.seconds
    yield Row(body, "contact time [s]", period, step * (len(forces) - 2), *spent)
    yield Row(body, "largest force [N]", force, max(forces), *spent)
    yield Row(body, "rebound / speed", 1.0, speed / SPEED, *spent)


def impact(ratio: float, points: int = 400) -> tuple[float, float]:
    """Returns contact time [s] and largest force [N] of Hertz's impact, with the energy of the block's additional compliance included."""
    stiffness, gives = hertz(ratio, 1.0), GIVES / (MODULUS * SIDE)

    def energy(depth: float) -> float:
        return stiffness * 2 / 5 * depth**2.5 + gives / 2 * (stiffness * depth**1.5) ** 2

    low, high = 0.0, 2 * (5 / 4 * MASS * SPEED**2 / stiffness) ** 0.4
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if energy(middle) < MASS * SPEED**2 / 2 else (low, middle)
    period = 0.0
    for angle in math.pi / 2 * (np.arange(points) + 0.5) / points:  # depth = deepest sin2(angle) makes the integrand smooth
        depth = low * math.sin(angle) ** 2
        way = low * 2 * math.sin(angle) * math.cos(angle) * (1 + gives * stiffness * 1.5 * math.sqrt(depth))
        period += 2 * way / math.sqrt(SPEED**2 - 2 * energy(depth) / MASS) * math.pi / 2 / points
    return period, stiffness * low**1.5


def _slowest(density: float) -> float:
    """Returns the approximate lowest frequency of the block [rad/s]."""
    return 1.5 / SIDE * math.sqrt(MODULUS / 2.5 / density)


def _scene(body: Body, density: float, folder: str) -> Scene:
    """Returns the scene in which the sphere touches the top of the block. Under the sphere the surface has a vertex every 0.75 mm."""
    size: Size = (SIDE, SIDE, SIDE)
    vertices, faces = cube(25, 0.0)
    middle = SIDE / 2
    under = (vertices - [0.5, 0.5, 1.0]) * 0.9 * RADIUS + [middle, middle, SIDE]
    basis = {} if body.model == "solid" else {"basis": "bspline"}
    ball = {"name": "ball", "point": [middle, middle, SIDE + RADIUS], "radius": RADIUS, "friction": 0.0}
    return scene_of(
        body, size, MODULUS, density, material=drag(body, size, density, 2 * _slowest(density)),
        lattice={"points": list(body.points), "size": list(size), "origin": [0.0, 0.0, 0.0]} | basis,
        mass={"total": density * math.prod(size), "distribution": "box"},
        mesh={"file": write(Path(folder) / "top.obj", (under, faces))}, pin=[{"name": "base", "points": "z-"}],
        sphere=[ball | {"motion": "input", "inputs": ["point.z", "velocity.z"]}], solver={"method": "leapfrog"},
    )  # fmt: skip
