"""A rigid sphere and a block: Hertz's contact, pressed at rest and hit by it as a mass."""

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
"""m, Pa"""
SIDE = 0.04
"""Of the block, a cube that is held below [m]"""
GIVES = -0.1088
"""How much more than a half-space the block gives way, far from the contact: its displacement times Young's modulus times its side by the
force; for Poisson's ratio 1/4"""
MASS, SPEED, LIGHT = 0.03686, 1.0, 10.0
"""Of a sphere that hits [kg], [m/s], and the density of the block [kg/m3], which follows without waves"""
LOOKS = 400
"""In the time of an impact"""
DEPTHS = (0.025, 0.05, 0.1)
"""By the radius"""


def hertz(ratio: float, depth: float) -> float:
    """Force [N] at a depth [m] in a half-space."""
    return 4 / 3 * MODULUS / (1 - ratio**2) * math.sqrt(RADIUS) * depth**1.5


def pressed_sphere(body: Body) -> Iterator[Row]:
    """The sphere goes as deep as in a half-space, and by what the block gives way."""
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
    """The sphere is a mass of the host, which takes the block's reaction on it after each communication step."""
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
    """Contact time [s] and largest force [N] of Hertz's impact on the block, which takes its part of the energy."""
    stiffness, gives = hertz(ratio, 1.0), GIVES / (MODULUS * SIDE)

    def energy(depth: float) -> float:
        return stiffness * 2 / 5 * depth**2.5 + gives / 2 * (stiffness * depth**1.5) ** 2

    low, high = 0.0, 2 * (5 / 4 * MASS * SPEED**2 / stiffness) ** 0.4
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if energy(middle) < MASS * SPEED**2 / 2 else (low, middle)
    period = 0.0
    for angle in math.pi / 2 * (np.arange(points) + 0.5) / points:  # depth = deepest sin2(angle), so that what is summed is smooth
        depth = low * math.sin(angle) ** 2
        way = low * 2 * math.sin(angle) * math.cos(angle) * (1 + gives * stiffness * 1.5 * math.sqrt(depth))
        period += 2 * way / math.sqrt(SPEED**2 - 2 * energy(depth) / MASS) * math.pi / 2 / points
    return period, stiffness * low**1.5


def _slowest(density: float) -> float:
    """Of the block's vibrations, about [rad/s]"""
    return 1.5 / SIDE * math.sqrt(MODULUS / 2.5 / density)


def _scene(body: Body, density: float, folder: str) -> Scene:
    """The sphere touches the top of the block, whose surface has a vertex every 0.75 mm under it."""
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
