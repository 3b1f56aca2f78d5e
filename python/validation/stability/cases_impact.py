"""Cases of impacts, sliding and rest of stiff bodies, with communication steps from far below to far above the duration of the contact.

The references of A1 to A12 come from an independent program (a separate prototype, leapfrog with steps down to 1/128 of the stable step,
known to the digits given). Other references are closed forms, conservation laws, or `after_impact` in numpy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from validation.stability.answers import after_impact, static_sag
from validation.stability.cases_standard import GROUND, held
from validation.stability.drive import DOWN, GRAVITY, Drive, box, plane, tilted
from validation.stability.verdict import STATED, Case, Findings, stated_length

STEPS = (1e-3, 1e-2, 5e-2)  # communication steps [s]
TOLERANCE, RIGHT = 1e-4, 3e-4  # tolerance relative to the box; permitted position error of a control point [m]
FRICTION = 0.4
UNIT_INERTIA = 5 / 18  # of 4 x 4 x 4 equal points, 1 kg and 1 m in total, about any axis [kg m2]


@dataclass(frozen=True)
class Scene:
    """A scene with the known quantities of its final state."""

    name: str
    what: str
    document: Mapping[str, Any]
    duration: float  # s
    centre: Mapping[str, float] = field(default_factory=dict)  # of mass, by axis [m]
    corner: Mapping[str, float] = field(default_factory=dict)  # point (0, 0, 0) [m]
    opposite: Mapping[str, float] = field(default_factory=dict)  # point (3, 3, 3) [m]
    velocity: Mapping[str, float] = field(default_factory=dict)  # of the centre [m/s]
    limit: float = RIGHT  # m
    scale: float = GRAVITY  # energy scale [J], about the largest energy in the scene
    more: Callable[[Findings, Drive, float, float], None] | None = None
    """Further checks at the end, called with the communication step [s] and the number of internal steps of the last communication step"""


def _dropped(stiffness: float, damping: float, spin: float, *, offset: float = 0.5) -> dict[str, Any]:
    initial = {"offset": [0.0, 0.0, offset], "angular_velocity": [spin, 0.0, 0.0]}
    return box(stiffness, damping, plane=[plane(friction=FRICTION)], environment=DOWN, initial=initial)


def _light() -> dict[str, Any]:
    """Returns a box of 1 kg in total that falls by 0.2 m. One corner has 1e-6 kg; the other points have equal masses."""
    corner = {"points": [[0, 0, 0]], "mass": 1e-6}
    return _dropped(1e3, 0.0, 0.0, offset=0.2) | {"mass": {"total": 64 * (1 - 1e-6) / 63}, "region": [corner]}


def _past(stiffness: float, clearance: float, spin: float = 22.43995) -> dict[str, Any]:
    """Returns a box that spins over a plane, so that its corners come nearer to the plane than its faces."""
    initial = {"offset": [0.0, 0.0, clearance], "angular_velocity": [0.0, spin, 0.0]}
    return box(stiffness, plane=[plane(friction=0.3)], initial=initial)


def _spin_about_y(findings: Findings, drive: Drive, _step: float, _spent: float) -> None:
    """Checks the spin of the attitude, L / I with the present moment of inertia."""
    arms = drive.x - drive.centre
    inertia = float(drive.mass @ (arms[:, 0] ** 2 + arms[:, 2] ** 2))
    # the spin oscillates by about 1e-3 with the width of the body
    findings.check("error of the spin, relative", abs(drive.angular_momentum[1] / inertia / 19.69506 - 1), 3e-3)


def _at_rest(findings: Findings, drive: Drive, step: float, spent: float) -> None:
    weight = drive.mass.sum() * GRAVITY
    ringing = 2e-3 if step < 5e-3 else 1e-4  # small leapfrog steps also leave some vibration in the mean over the step
    findings.check("weight error in the end, relative", abs(-drive.reaction("plane.ground")[2] / weight - 1), ringing)
    if step >= 1e-2:
        findings.check("internal steps of a communication step at rest", spent, 1)


SCENES = (
    Scene("A1", "falls flat by 0.5 m, undamped, k = 1e7 N/m", _dropped(1e7, 0.0, 0.0), 0.4, {"z": 0.6176278}, velocity={"z": 1.06544}),
    Scene("A2", "falls by 0.5 m with 0.5 rad/s, hardly damped, k = 1e6", _dropped(1e6, 1e-3, 0.5), 0.4, {"y": 0.6292702, "z": 0.6421043},
          {"x": -0.0001326, "y": 0.0496083, "z": 0.2373682}, {"x": 1.0, "y": 1.2090617, "z": 1.0468847}),
    Scene("A3", "falls by 0.5 m with 0.5 rad/s, damped, k = 1e9 N/m", _dropped(1e9, 0.05, 0.5), 0.45, {"y": 0.5708908, "z": 0.5680790},
          {"y": 0.0296639, "z": 0.1130285}),
    Scene("A4", "falls by 0.5 m with 5 rad/s, damped, k = 1e8 N/m", _dropped(1e8, 0.05, 5.0), 0.4, {"y": 0.3894143, "z": 0.7780038},
          {"y": 0.5181225, "z": 0.0827049}),
    Scene("A5", "the same with 0.5 rad/s, k = 1e7 N/m: two impacts", _dropped(1e7, 0.05, 0.5), 0.6, {"y": 0.621512, "z": 0.601605},
          {"y": 0.06276, "z": 0.16823}),
    Scene("A6", "undamped, k = 1e6 N/m: two impacts", _dropped(1e6, 0.0, 0.5), 0.6, {"y": 0.9077456, "z": 0.758194}),
    Scene("A7", "falls by 0.5 m with 5 rad/s, much damped, k = 1e6 N/m: fall, bounces, rocking, rest", _dropped(1e6, 0.5, 5.0), 2.5,
          {"x": 0.49999, "y": 0.5694338, "z": 0.4999998}, more=_at_rest),
    Scene("A8", "slides at 1 m/s, k = 1e9 N/m", box(1e9, plane=[plane(friction=FRICTION)], environment=DOWN,
          initial={"velocity": [1.0, 0.0, 0.0]}), 0.5, {"x": 0.6274210}, limit=1e-4),
    Scene("A10", "spins past a plane without gravity, which its corners touch, k = 1e7 N/m", _past(1e7, 0.2035), 0.2,
          {"x": 0.6382258, "z": 1.1644624}, scale=50.0, more=_spin_about_y),
    Scene("A11", "falls by 0.2 m, undamped, k = 1e3 N/m, with a corner of 1e-6 kg", _light(), 0.6, {"x": 0.4890417, "z": 0.5193556},
          limit=1e-4),
)  # fmt: skip


@contextmanager
def run_to_end(scene: Scene, step: float, findings: Findings) -> Iterator[tuple[Drive, float]]:
    """Yields the scene at its end and the internal steps of the last communication step. Checks during the run what always holds."""
    with Drive(scene.document) as drive:
        drive.restart({}, scene.duration, tolerance=TOLERANCE)
        steps, sound = [0.0], held(findings, drive, scale=scene.scale)

        def each() -> None:
            sound()
            steps.append(drive.value("solver.steps"))

        drive.run(scene.duration, step, each)
        yield drive, steps[-1] - steps[-2]


def _known_end(scene: Scene, step: float, findings: Findings) -> None:
    """Checks the final state. Errors up to five times the length that a warning states count as bounded."""
    with run_to_end(scene, step, findings) as (drive, spent):
        said = STATED * stated_length(drive.warned) or None
        places = {"centre": (scene.centre, drive.centre), "point (0,0,0)": (scene.corner, drive.x[0]),
                  "point (3,3,3)": (scene.opposite, drive.x[-1])}  # fmt: skip
        for what, (known, found) in places.items():
            for axis, value in known.items():
                findings.check(f"error of the {what}, {axis}, m", abs(found["xyz".index(axis)] - value), scene.limit, bound=said)
        for axis, value in scene.velocity.items():
            error = abs(drive.momentum["xyz".index(axis)] / drive.mass.sum() - value)
            findings.check(f"error of the velocity, {axis}, m/s", error, 10 * scene.limit, bound=said and 10 * said)
        if scene.more:
            scene.more(findings, drive, step, spent)


def _same_end(scene: Scene, findings: Findings) -> None:
    ends, said = [], 0.0
    for step in STEPS:
        with run_to_end(scene, step, findings) as (drive, _):
            ends.append(drive.x)
            said = max(said, STATED * stated_length(drive.warned))
    apart = max(float(np.linalg.norm(one - other, axis=1).max()) for one in ends for other in ends)
    findings.check("how far points part, m", apart, scene.limit, bound=said or None)


def _creep(stiffness: float, degrees: float, settled: float, step: float, findings: Findings) -> None:
    """The body sticks: there is no slip after the body has sagged, from the time `settled` [s] on."""
    with Drive(box(stiffness, 0.5, plane=[plane(friction=FRICTION)], environment=tilted(degrees))) as drive:
        drive.restart({}, 3.0, tolerance=TOLERANCE)
        drive.run(settled, step)
        begun = drive.x
        drive.run(3.0 - settled, step, lambda: findings.sound(drive, [GROUND]))
        lowest = drive.rest[:, 2] == 0
        findings.check(f"slip after {settled:g} s, m", np.abs(drive.x - begun)[lowest].max(), 1e-8)


def _slide(step: float, findings: Findings) -> None:
    with Drive(box(1e9, plane=[plane(friction=FRICTION)], environment=tilted(25.0))) as drive:
        drive.restart({}, 1.0, tolerance=TOLERANCE)
        drive.run(1.0, step, lambda: findings.sound(drive, [GROUND]))
        angle = math.radians(25.0)
        pull = GRAVITY * (math.sin(angle) - FRICTION * math.cos(angle))
        findings.check("error of the way, m", abs(drive.centre[0] - 0.5 - pull / 2), RIGHT)
        findings.check("error of the speed, m/s", abs(drive.momentum[0] / drive.mass.sum() - pull), 10 * RIGHT)


def _lost_phase(step: float, findings: Findings) -> None:
    """The trajectory is one of many possible ones, and a warning has to state the error as a number."""
    with Drive(_dropped(1e9, 0.05, 0.5)) as drive:
        drive.restart({}, 2.5, tolerance=TOLERANCE)
        drive.run(2.5, step, held(findings, drive, scale=GRAVITY))
        findings.check("0.01 m / the error that a warning states", 1e-2 / max(stated_length(drive.warned), 1e-12), 1.0)


def _throw(stiffness: float, step: float, findings: Findings) -> None:
    """The box lands flat and friction turns it. Checks the flight of the centre and the angular momentum afterwards."""
    document = box(stiffness, plane=[plane(friction=FRICTION)], environment=DOWN,
                   initial={"offset": [0.0, 0.0, 0.1], "velocity": [2.0, 0.5, 0.0]})  # fmt: skip
    with Drive(document) as drive:
        drive.restart({}, 0.2, tolerance=TOLERANCE)
        drive.run(0.2, step, held(findings, drive, scale=1.0))
        known = after_impact(document, drive.time)
        said = STATED * stated_length(drive.warned) or None
        findings.check("error of the centre, m", np.abs(drive.centre - known.centre).max(), RIGHT, bound=said)
        speed = drive.momentum / drive.mass.sum() - known.velocity
        findings.check("error of the velocity, m/s", np.abs(speed).max(), 10 * RIGHT, bound=said and 10 * said)
        turning = np.linalg.norm(drive.angular_momentum - known.angular_momentum) / UNIT_INERTIA * (drive.time - known.touched)
        findings.check("error of a corner by the angle, m", turning * math.sqrt(3) / 2, RIGHT, bound=said)
        findings.check("friction impulse / (mu normal impulse) - 1", np.hypot(*drive.impulse[:2]) / (FRICTION * drive.impulse[2]) - 1, 1e-6)


def _passes(step: float, findings: Findings) -> None:
    """The corners come within 0.4 mm of the plane without contact, so nothing is lost."""
    with Drive(_past(1e7, 0.2075)) as drive:
        drive.restart({}, 0.2, tolerance=TOLERANCE)
        drive.run(0.2, step, lambda: findings.sound(drive, [GROUND]))
        findings.check("way of the centre, m", np.abs(drive.centre - drive.start_centre).max(), 1e-9)
        findings.check("change of angular momentum, relative", drive.turning_change(), 1e-6)


def _rests(points: tuple[int, int, int], stiffness: float, findings: Findings) -> None:
    """The box starts unstressed on the ground, damped by 20 / s. After 2 s nothing moves, and the sag agrees with the linear theory."""
    count = math.prod(points)
    for step in STEPS:
        with Drive(box(stiffness, 40 / count, points=points, plane=[plane(friction=FRICTION)], environment=DOWN)) as drive:
            drive.restart({}, 2.0, tolerance=TOLERANCE)
            drive.run(1.75, step)
            weight = drive.mass.sum() * GRAVITY
            forces: list[float] = []
            heights: list[float] = []

            def each(drive: Drive = drive, forces: list[float] = forces, heights: list[float] = heights) -> None:
                findings.sound(drive, [GROUND])
                forces.append(-drive.reaction("plane.ground")[2])
                heights.append(drive.centre[2])

            drive.run(0.25, step, each)
            at = f", H = {step:g} s"
            findings.check(f"weight error, relative{at}", np.abs(np.array(forces) / weight - 1).max(), 1e-6)
            findings.check(f"height that still changes, m{at}", np.ptp(heights), 1e-9)
            findings.check(f"speed of a point, m/s{at}", np.abs(drive.v).max(), 1e-6)
            most, least = (GRAVITY * static_sag(drive, held=held) / stiffness for held in (False, True))
            sag = 0.5 - drive.centre[2]
            findings.check(f"sag beyond that with a free or a held lower face, relative{at}", max(sag / most - 1, 1 - sag / least), 1e-2)


def _light_rest(step: float, findings: Findings) -> None:
    with Drive(_light() | {"initial": {}, "material": {"stiffness": 1e3, "damping": 0.3}}) as drive:
        drive.restart({}, 2.0, tolerance=TOLERANCE)
        drive.run(2.0, step, lambda: findings.sound(drive, [GROUND]))
        weight = drive.mass.sum() * GRAVITY
        findings.check("weight error, relative", abs(-drive.reaction("plane.ground")[2] / weight - 1), 1e-4)
        findings.check("speed of a point, m/s", np.abs(drive.v).max(), 1e-4)


def _each_step(name: str, what: str, oracle: str, run: Callable[..., None], *given: Any, steps: Sequence[float] = STEPS) -> list[Case]:
    return [Case(f"{name}, H = {step:g} s", what, oracle, partial(run, *given, step)) for step in steps]


def cases() -> list[Case]:
    """Returns the cases of impacts, sliding and rest."""
    sound = "no penetration, no energy out of nothing"
    found: list[Case] = []
    for scene in SCENES:
        found += _each_step(scene.name, scene.what, f"{sound}; an independent program", _known_end, scene)
        found.append(Case(f"{scene.name}, the three H", scene.what, "the same end", partial(_same_end, scene)))
    found += _each_step("A9", "on an incline of 20 deg, friction 0.4, k = 1e9 N/m", "exact: sticks", _creep, 1e9, 20.0, 0.1)
    found += _each_step("A9 slides", "on an incline of 25 deg, friction 0.4, k = 1e9 N/m", "exact: g (sin - mu cos)", _slide)
    found += _each_step("A12", "as A3 until it rests: the vibration's phase is lost", f"{sound}; a warning says by how much", _lost_phase)
    for stiffness, degrees in ((1e9, 10.0), (1e9, 21.5), (1e5, 20.0), (1e5, 21.5)):
        found += _each_step(f"creep {degrees:g} deg, k = {stiffness:g}", "on an incline, friction 0.4", "exact: sticks below 21.8 deg",
                            _creep, stiffness, degrees, 1.5)  # fmt: skip
    for stiffness in (1e5, 1e7, 1e9):
        found += _each_step(f"throw, k = {stiffness:g}", "thrown obliquely onto a plane, friction 0.4, undamped",
                            f"{sound}; flight after the impact by numpy", _throw, stiffness)  # fmt: skip
    found += _each_step("corners pass a plane", "spins over it at a distance of 0.4 mm, k = 1e7 N/m", "exact: nothing happens", _passes)
    found += _each_step("light corner at rest", "k = 1e3 N/m, a corner of 1e-6 kg", "weight; at rest", _light_rest)
    for points in ((2, 2, 2), (2, 2, 3), (2, 3, 2), (2, 3, 3), (3, 2, 2), (3, 2, 3), (3, 3, 2), (3, 3, 3), (2, 2, 4)):
        for stiffness in (1e3, 1e6, 1e9):
            name = f"rest {points[0]} x {points[1]} x {points[2]}, k = {stiffness:g}"
            found.append(Case(name, "on the ground, damped, H = 1, 10, 50 ms", "weight; sag; nothing moves",
                              partial(_rests, points, stiffness)))  # fmt: skip
    return found
