"""Bars loaded along their axis: bars that hang from one end, and a bar that strikes a wall."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from validation.published.cases import Body, Row
from validation.published.runs import WALL, Course, Size, drag, scene_of


def _hanging(body: Body, size: Size, modulus: float, density: float, gravity: float) -> tuple[float, float, tuple[int, float]]:
    """Returns elongation [m] and force on the wall per area [Pa] of a hanging bar at rest, and the steps and time [s] spent."""
    period = 4 * size[0] * math.sqrt(density / modulus)
    scene = scene_of(
        body, size, modulus, density, material=drag(body, size, density, 8 / period), pin=[WALL],
        environment={"gravity": [gravity, 0.0, 0.0]}, solver={"method": "leapfrog"},
    )  # fmt: skip
    with Course(scene) as course:
        start = float(course.end()[0])
        elongation = course.rest(lambda: float(course.end()[0]) - start, period)
        pulls = course.sim.number("pin.wall.reaction.x") / (size[1] * size[2])
        return elongation, pulls, (course.steps, course.seconds)


def hanging_bar(body: Body) -> Iterator[Row]:
    modulus, density, gravity, length = 210e9, 7800.0, 9.80665, 1.0
    elongation, stress, spent = _hanging(body, (length, 0.1, 0.1), modulus, density, gravity)
    yield Row(body, "elongation [m]", density * gravity * length**2 / (2 * modulus), elongation, *spent)
    yield Row(body, "stress at the top [Pa]", density * gravity * length, stress, *spent)


def soft_hanging_bar(body: Body) -> Iterator[Row]:
    modulus, density, gravity, length = 125e3, 1000.0, 9.81, 1.0
    elongation, _, spent = _hanging(body, (length, 0.2, 0.2), modulus, density, gravity)
    yield Row(body, "elongation [m]", density * gravity * length**2 / (2 * modulus), elongation, *spent)


def striking_bar(body: Body) -> Iterator[Row]:
    modulus, density, length, speed = 1e6, 1000.0, 0.2, 0.2
    side = length * (body.points[1] - 1) / (body.points[0] - 1)
    wave = math.sqrt(modulus / density)
    contact, looks = 2 * length / wave, 50
    scene = scene_of(
        body, (length, side, side), modulus, density, initial={"velocity": [-speed, 0.0, 0.0]},
        plane=[{"name": "wall", "normal": [1.0, 0.0, 0.0], "friction": 0.0}],
        outputs={"solver": True, "velocities": "all"},
    )  # fmt: skip
    with Course(scene) as course:
        forces, places = [], []
        for _ in range(int(1.5 * looks)):
            course.step(contact / looks)
            forces.append(-course.sim.number("plane.wall.reaction.x"))
            places.append(float(course.centre()[0]))
        spent = course.steps, course.seconds
    force = np.array(forces)
    last = int(np.flatnonzero(force > 0.05 * force.max())[-1])
    step = contact / looks
    free = looks // 4  # number of samples after the contact
    rebound = (places[-1] - places[-1 - free]) / (step * free)
    yield Row(body, "contact time [s]", contact, step * (last + 1), *spent)
    yield Row(body, "force [N]", density * wave * side**2 * speed, float(force[looks // 10 : -looks // 10 - looks // 2].mean()), *spent)
    yield Row(body, "rebound / speed", 1.0, rebound / speed, *spent)
