"""Beams: the elastica under an end load and under its own weight, roll-up by a moment, Turek and Hron's strip."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np

from validation.published.cases import Body, Row
from validation.published.runs import WALL, Course, Size, drag, scene_of, slowest_bending
from validation.published.vibration import frequency

MODULUS, DENSITY, HEIGHT = 1e6, 1000.0, 0.01
"""Pa, kg/m3 and m, of the elasticas, whose results are dimensionless"""
END_LOAD = {1: (0.30172, 0.05643), 2: (0.49346, 0.16064), 10: (0.81061, 0.55500)}
"""P L2 / (E I): deflection and shortening, each divided by the length"""
OWN_WEIGHT = {1: (0.12347, 0.00875), 4: (0.42516, 0.10989), 10: (0.70020, 0.34365)}
"""q L3 / (E I): deflection and shortening, each divided by the length"""


def _beam(body: Body) -> Size:
    """Returns the size of the beam. A solid of fewer than 31 points is 20 times as long as high; the cells of other beams are cubes."""
    slenderness = 20.0 if body.model == "solid" and body.points[0] < 31 else (body.points[0] - 1) / (body.points[1] - 1)
    return slenderness * HEIGHT, HEIGHT, HEIGHT


def _elastica(body: Body, references: dict[int, tuple[float, float]], weight: bool) -> Iterator[Row]:
    size = _beam(body)
    length, inertia = size[0], HEIGHT**4 / 12
    slowest = slowest_bending(size, MODULUS, DENSITY)
    acting = {"environment": {"gravity": [0.0, 0.0, 0.0]}} if weight else {"load": [{"name": "end", "points": "x+"}]}
    scene = scene_of(
        body, size, MODULUS, DENSITY, material=drag(body, size, DENSITY, 2 * slowest), pin=[WALL], solver={"method": "leapfrog"}, **acting
    )
    with Course(scene) as course:
        start, steps, seconds = course.end(), 0, 0.0
        for load, (deflection, shortening) in references.items():
            if weight:
                course.sim["gravity.z"] = load * MODULUS * inertia / length**3 / (DENSITY * HEIGHT**2)
            else:
                course.sim["load.end.z"] = load * MODULUS * inertia / length**2
            course.rest(lambda: float(course.end()[2] - start[2]), 1 / slowest)
            moved = (course.end() - start) / length
            spent = course.steps - steps, course.seconds - seconds
            steps, seconds = course.steps, course.seconds
            yield Row(body, f"deflection / L at {load}", deflection, float(moved[2]), *spent)
            yield Row(body, f"shortening / L at {load}", shortening, float(-moved[0]), *spent)


def end_load(body: Body) -> Iterator[Row]:
    return _elastica(body, END_LOAD, weight=False)


def own_weight(body: Body) -> Iterator[Row]:
    return _elastica(body, OWN_WEIGHT, weight=True)


TURNS = {"a quarter turn": math.pi / 2, "half a turn": math.pi, "a whole turn": 2 * math.pi}
"""M L / (E I) by the name of the bend"""
FOLLOWS = 100
"""Updates of the couple's direction per radian of phase of the slowest bending mode; with 20 the couple excites vibrations of the end"""


def roll_up(body: Body) -> Iterator[Row]:
    """Bends a beam by a couple: forces on two edges of the end, normal to the line between the edges, turn with that line. The couple does
    not turn out of the plane, so the beam would leave the plane before a whole turn. Walls beside the beam prevent that."""
    size = (2.5 * HEIGHT * (body.points[0] - 1) / (body.points[2] - 1), HEIGHT, HEIGHT)
    slowest, stiffness = slowest_bending(size, MODULUS, DENSITY), MODULUS * HEIGHT**4 / 12 / size[0]
    last, high = body.points[0] - 1, body.points[2] - 1
    edges = [{"name": f"edge{k}", "points": {"i": [last, last], "k": [k, k]}} for k in (0, high)]
    walls = [
        {"name": f"side{way}", "point": [0.0, y, 0.0], "normal": [0.0, float(1 - 2 * way), 0.0], "friction": 0.0}
        for way, y in enumerate((0.0, HEIGHT))
    ]
    scene = scene_of(
        body, size, MODULUS, DENSITY, material=drag(body, size, DENSITY, 2 * slowest), pin=[WALL], load=edges, plane=walls,
        solver={"method": "leapfrog"},
    )  # fmt: skip
    with Course(scene) as course:
        start, before, steps, seconds = course.end(), 0.0, 0, 0.0

        def follow(angle: float) -> float:
            low_edge, high_edge = course.sim.positions[last, :, [0, high]].mean(axis=1)
            arm = high_edge - low_edge
            force = angle * stiffness / (arm @ arm) * np.array([arm[2], 0.0, -arm[0]])
            course.sim.load[f"edge{high}"], course.sim.load["edge0"] = -force, force
            course.step(1 / slowest / FOLLOWS)
            return float(course.end()[0])

        def settle(angle: float) -> float:
            return [follow(angle) for _ in range(FOLLOWS)][-1]

        for name, angle in TURNS.items():
            for part in np.linspace(before, angle, 10 * FOLLOWS):
                follow(float(part))
            course.rest(partial(settle, angle), 1 / slowest / FOLLOWS)
            moved = (course.end() - start) / size[0]
            spent = course.steps - steps, course.seconds - seconds
            if name != "a whole turn":  # has no deflection
                yield Row(body, f"deflection / L at {name}", (1 - math.cos(angle)) / angle, float(moved[2]), *spent)
            yield Row(body, f"shortening / L at {name}", 1 - math.sin(angle) / angle, float(-moved[0]), *spent)
            before, steps, seconds = angle, course.steps, course.seconds


STRIP: Size = (0.35, 0.02, 0.02)


def strip(body: Body) -> Iterator[Row]:
    """Releases a strip under its own weight. Middle and amplitude of the displacement of the free end follow from its extremes, as in the
    source."""
    plane_strain = 1.4e6 / (1 - 0.4**2)
    scene = scene_of(
        body, STRIP, plane_strain, 1000.0, pin=[WALL], environment={"gravity": [0.0, 0.0, -2.0]}, solver={"method": "leapfrog"},
    )  # fmt: skip
    with Course(scene) as course:
        start, ways = course.end(), []
        for _ in range(2000):
            course.step(0.005)
            ways.append(course.end() - start)
            spent = course.steps, course.seconds
    way = np.array(ways)
    for axis, name, middle, amplitude in ((0, "x", -14.279e-3, 14.280e-3), (2, "y", -63.541e-3, 65.094e-3)):
        high, low = way[:, axis].max(), way[:, axis].min()
        yield Row(body, f"middle of u_{name} [m]", middle, (high + low) / 2, *spent)
        yield Row(body, f"amplitude of u_{name} [m]", amplitude, (high - low) / 2, *spent)
    moving = way[:, 2] - way[:, 2].mean()
    yield Row(body, "frequency [Hz]", 1.0995, frequency(moving, 0.005), *spent)
