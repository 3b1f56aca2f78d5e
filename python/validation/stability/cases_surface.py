"""Cases in which obstacles meet the surface of the object, a sphere of 642 vertices or a cube of 8 x 8 on each face, in a larger box."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from validation.shapes import cube, sphere
from validation.stability.cases_standard import held, slides
from validation.stability.drive import DOWN, GRAVITY, ORIGIN, Drive, Z, box, plane, tilted
from validation.stability.verdict import Case, Findings

MARGIN = 0.05  # margin of the cube in the box, on all sides [m]; the margin of the sphere is 0.1
LATTICES: dict[str, dict[str, Any]] = {
    "3^3": {"points": (3, 3, 3)},
    "4^3": {"points": (4, 4, 4)},
    "8^3": {"points": (8, 8, 8), "lattice": {"basis": "bspline"}},
}


def _rest(lattice: str, stiffness: float, findings: Findings) -> None:
    """A sphere starts slightly above the ground; the centre of pressure is below the centre of mass."""
    start = {"offset": [0.0, 0.0, -0.095]}
    document = box(stiffness, **LATTICES[lattice], plane=[plane(friction=0.4)], environment=DOWN, initial=start)
    document["material"]["damping"] = 20.0 / np.prod(document["lattice"]["points"])
    with Drive(document, surface=sphere(3)) as drive:
        force, apart, sound = [], [], held(findings, drive, scale=GRAVITY)

        def each() -> None:
            force.append(-drive.reaction("plane.ground")[2])
            apart.append(np.hypot(*(drive.simulation.plane["ground"].centre - drive.centre)[:2]))
            sound()

        drive.run(2.0, 1e-2, each)
        weight = drive.mass.sum() * GRAVITY
        findings.check("weight error, N", abs(np.mean(force[-50:]) - weight), 1e-2 * weight, bound=0.1 * weight)
        findings.check("centre of pressure beside that of mass / box", np.mean(apart[-50:]), 2e-2, bound=0.1)
        missing = abs(drive.missing_momentum()[2]) / (weight * drive.time)
        findings.check("missing momentum / that of the weight", missing, 1e-4)  # from the sum of the damping over steps


def _drop(lattice: str, stiffness: float, findings: Findings) -> None:
    start = {"offset": [0, 0, 0.02 - MARGIN], "velocity": [0.5, 0, 0]}
    document = box(stiffness, 0.02, **LATTICES[lattice], plane=[plane(friction=0.4)], environment=DOWN, initial=start)
    with Drive(document, surface=cube(8, MARGIN)) as drive:
        drive.run(0.5, 1e-2, held(findings, drive, scale=1.0))
        slides(findings, drive, missing=1e-3, beyond=1e-6)


def _incline(stiffness: float, degrees: float, findings: Findings) -> None:
    document = box(stiffness, 0.02, plane=[plane(point=(0, 0, MARGIN), friction=0.4)], environment=tilted(degrees))
    with Drive(document, surface=cube(8, MARGIN)) as drive:
        drive.run(0.5, 1e-2, lambda: findings.sound(drive, [((0, 0, MARGIN), Z)]))
        angle, damping = math.radians(degrees), 64 * 0.02
        pull = GRAVITY * max(0.0, math.sin(angle) - 0.4 * math.cos(angle))
        exact = pull * (1 - math.exp(-damping * drive.time)) / damping
        findings.check("error of the speed, m/s", abs(drive.momentum[0] / drive.mass.sum() - exact), 1e-2, bound=0.1)


def _thrown(stiffness: float, friction: float, findings: Findings) -> None:
    """A spinning sphere is thrown into a corner of three planes."""
    planes = [plane(name, normal=normal, friction=friction) for name, normal in (("a", (1, 0, 0)), ("b", (0.1, 1, 0)), ("c", (0, 0, 1)))]
    start = {"offset": [0.05, 0.05, 0.05], "velocity": [-2.0, -1.5, -1.0], "angular_velocity": [3.0, -2.0, 4.0]}
    with Drive(box(stiffness, 0.02, plane=planes, environment=DOWN, initial=start), surface=sphere(3)) as drive:
        drive.run(0.6, 1e-2, held(findings, drive, [(ORIGIN, each["normal"]) for each in planes], scale=GRAVITY))


def _squeezed(stiffness: float, findings: Findings) -> None:
    """A sphere is pressed between the ground and a lid that comes down and moves sideways."""
    lid = plane("lid", point=(0.5, 0.5, 0.9), normal=(0, 0, -1), motion="input", friction=0.3, inputs=["point", "velocity"])
    ground = (0, 0, 0.1)
    with Drive(box(stiffness, 0.1, plane=[plane(point=ground, friction=0.3), lid]), surface=sphere(3)) as drive:
        for n in range(50):
            drive.set(plane__lid__point=(0.5 + 1e-3 * n, 0.5, 0.9 - 2e-3 * n), plane__lid__velocity=(0.1, 0.0, -0.2))
            drive.step(1e-2)
            findings.sound(drive, [(ground, Z), ((0.5, 0.5, 0.9 - 2e-3 * (n + 1)), (0, 0, -1))])
        lower, upper = (abs(drive.reaction(f"plane.{name}")[2]) for name in ("ground", "lid"))
        findings.check("difference of the forces / larger one", abs(upper - lower) / max(upper, lower), 0.1, bound=1.0)


def cases() -> list[Case]:
    """Returns the cases of surface contact."""
    sound = "no vertex behind a plane, no energy out of nothing"
    found = []
    for lattice, k in (("4^3", 1e3), ("4^3", 1e5), ("4^3", 1e7), ("3^3", 1e4), ("8^3", 1e4)):
        found.append(Case(f"surface: rest, {lattice}, k = {k:g}", "a sphere comes to rest on the ground, friction 0.4",
                          f"{sound}; weight, momentum, centre of pressure below that of mass", partial(_rest, lattice, k),
                          quick=k == 1e3))  # fmt: skip
    for lattice, k in (("4^3", 1e3), ("4^3", 1e5), ("3^3", 1e6), ("8^3", 1e4)):
        found.append(Case(f"surface: drop, {lattice}, k = {k:g}", "a cube falls 20 mm, slides at 0.5 m/s, friction 0.4",
                          f"{sound}; momentum balances, Coulomb's cone", partial(_drop, lattice, k)))  # fmt: skip
    for k in (1e4, 1e6):
        for degrees in (20.0, 25.0):
            found.append(Case(f"surface: incline {degrees:g} deg, k = {k:g}", "a cube, friction 0.4: sticks at 20 degrees, slides at 25",
                              "exact: speed on the incline with its damping", partial(_incline, k, degrees),
                              quick=k == 1e4 and degrees == 25))  # fmt: skip
    for k, friction in ((1e3, 0.0), (1e3, 0.5), (1e5, 0.5)):
        found.append(Case(f"surface: corner, k = {k:g}, friction {friction:g}", "a spinning sphere is thrown into a corner of three planes",
                          sound, partial(_thrown, k, friction)))  # fmt: skip
    for k in (1e3, 1e5):
        found.append(Case(f"surface: press, k = {k:g}", "a sphere between the ground and a lid that comes down and aside, friction 0.3",
                          f"{sound}; both press alike", partial(_squeezed, k)))  # fmt: skip
    return found
