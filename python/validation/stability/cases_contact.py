"""Cases of stiff bodies in contact, moving obstacles, corners and wedges."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from functools import partial

import numpy as np

from validation.stability.cases_standard import GROUND, held, slides
from validation.stability.drive import DOWN, GRAVITY, ORIGIN, Drive, Z, box, plane, tilted
from validation.stability.verdict import Case, Findings

CLOSED = "no feasible position"


def _timed(findings: Findings, drive: Drive, duration: float, step: float, each: Callable[[], None] | None = None) -> None:
    began = clock.perf_counter()
    drive.run(duration, step, each)
    findings.notes.append(f"{duration / (clock.perf_counter() - began):.3g} times faster than real time")


def _rest(stiffness: float, step: float, duration: float, findings: Findings) -> None:
    """A slightly damped body starts without stress; the mean reaction of the last third of the run is the weight."""
    with Drive(box(stiffness, 0.02, plane=[plane(friction=0.4)], environment=DOWN)) as drive:
        force, sound = [], held(findings, drive, scale=GRAVITY)

        def each() -> None:
            force.append(-drive.reaction("plane.ground")[2])
            sound()

        _timed(findings, drive, duration, step, each)
        weight = drive.mass.sum() * GRAVITY
        findings.check("weight error, N", abs(np.mean(force[-max(1, len(force) // 3) :]) - weight), 1e-6, bound=1e-2 * weight)
        findings.check("missing momentum / that of the weight", abs(drive.missing_momentum()[2]) / (weight * drive.time), 1e-6)
        findings.check("sunk / box", 0.5 - drive.centre[2], 1e-3 if stiffness >= 1e6 else 0.1)


def _drop(stiffness: float, step: float, findings: Findings) -> None:
    document = box(
        stiffness, 0.02, plane=[plane(friction=0.4)], environment=DOWN, initial={"offset": [0, 0, 0.02], "velocity": [0.5, 0, 0]}
    )
    with Drive(document) as drive:
        _timed(findings, drive, 1.0, step, held(findings, drive, scale=1.0))
        slides(findings, drive, missing=1e-3, beyond=1e-6)
        findings.check("mean speed in the end, m/s", abs(drive.momentum[0]), 1e-6, bound=0.05)


def _tumble(stiffness: float, step: float, findings: Findings) -> None:
    """A box lands on a corner. The plane and gravity are tilted instead of the box."""
    normal = np.array([math.sin(0.5), math.sin(0.3), 1.0])
    normal /= np.linalg.norm(normal)
    initial = {"velocity": [1.0, 0.0, 0.0], "angular_velocity": [0.0, 2.0, 0.0]}
    document = box(stiffness, 0.02, plane=[plane(point=(0, 0, -0.2), normal=normal, friction=0.4)], initial=initial,
                   environment={"gravity": list(-GRAVITY * normal)})  # fmt: skip
    with Drive(document) as drive:
        force, sound = [], held(findings, drive, [((0, 0, -0.2), normal)], scale=GRAVITY)

        def each() -> None:
            force.append(-normal @ drive.reaction("plane.ground"))
            sound()

        _timed(findings, drive, 4.0, step, each)
        weight = drive.mass.sum() * GRAVITY
        error = abs(np.mean(force[-round(1 / step) :]) - weight)
        findings.check("mean weight error of the last second, N", error, 1e-3, bound=0.1 * weight)


def _squeeze(stiffness: float, step: float, findings: Findings) -> None:
    """Without friction, the lid finally carries the force of numpy's springs, and spring forces balance at every unconstrained point."""
    lid = plane("lid", point=(0, 0, 1), normal=(0, 0, -1), motion="input")
    with Drive(box(stiffness, 0.02, plane=[plane(), lid])) as drive:

        def each() -> None:
            height = max(0.9, 1 - 0.1 * drive.time)
            findings.sound(drive, [GROUND, ((0, 0, height - 1e-15), (0, 0, -1))])
            drive.set(plane__lid__point=(0, 0, height), plane__lid__velocity=(0, 0, -0.1 if drive.time < 1 - step / 2 else 0.0))

        drive.set(plane__lid__velocity=(0, 0, -0.1))
        _timed(findings, drive, 1.5, step, each)
        top, force = drive.reaction("plane.lid")[2], drive.net_force()
        carried = force[drive.rest[:, 2] == 1, 2].sum()
        findings.check("force on the lid / springs' force - 1", abs(top / carried - 1), 1e-3, bound=1e-2)
        force[np.isin(drive.rest[:, 2], (0, 1)), 2] = 0.0
        findings.check("unbalanced force / force on the lid", np.abs(force).max() / abs(top), 1e-3, bound=1e-2)


def _incline(stiffness: float, step: float, degrees: float, findings: Findings) -> None:
    with Drive(box(stiffness, plane=[plane(friction=0.4)], environment=tilted(degrees))) as drive:
        _timed(findings, drive, 1.0, step, lambda: findings.sound(drive, [GROUND]))
        angle = math.radians(degrees)
        exact = GRAVITY * max(0.0, math.sin(angle) - 0.4 * math.cos(angle)) * drive.time
        findings.check("error of the speed, m/s", abs(drive.momentum[0] / drive.mass.sum() - exact), 1e-3, bound=1e-2)


def _dragged(method: str, share: float, findings: Findings) -> None:
    """share: internal step divided by the component's stability bound for an undamped body at rest; 0: the component chooses the step.

    Friction excites vibrations with given steps near the bound. The component has to warn, and the answer then counts as bounded.
    """
    ground = plane(friction=0.4, motion="input")
    with Drive(box(1e6, points=(2, 2, 2), plane=[ground], environment=DOWN, method=method)) as drive:
        drive.restart({"solver.method": method, "solver.step": share * drive.value("solver.stable_step")})
        drive.set(plane__ground__velocity=(150.0, 0.0, 0.0))
        drive.run(4.0, 1.0)
        findings.sound(drive, [GROUND])
        warned = 10.0 if "friction can excite" in drive.warned else None
        findings.check("energy out of nothing / (weight times height)", abs(drive.balance()) / (GRAVITY * drive.side), 1e-3, bound=warned)
        findings.check("risen or sunk / box", abs(drive.centre[2] - 0.5), 1e-3, bound=warned)
        findings.check(
            "error of the speed, relative", abs(drive.momentum[0] / (0.4 * GRAVITY * drive.time) - 1), 1e-3, bound=warned or 1e-2
        )


def _landing(method: str, step: float, findings: Findings) -> None:
    """step: given internal step [s], longer than the limit of leapfrog, 1.9e-4 s. Leapfrog takes over at the ground."""
    height = 0.05
    ground = plane(point=(0.0, 0.0, -height))
    with Drive(box(1e5, 0.1, plane=[ground], environment=DOWN, method=method), {"solver.step": step}) as drive:
        drive.run(0.4, 2 * step, held(findings, drive, [((0.0, 0.0, -height), Z)], scale=GRAVITY * height, gain=2e-2))


def _hang(stiffness: float, step: float, findings: Findings) -> None:
    """The body hangs from its upper face, without contact."""
    with Drive(box(stiffness, 0.02, pin=[{"name": "hook", "points": "z+"}], environment=DOWN)) as drive:
        force, sound = [], held(findings, drive, [], scale=GRAVITY)

        def each() -> None:
            force.append(-drive.reaction("pin.hook")[2])
            sound()

        _timed(findings, drive, max(1.0, 5 * step), step, each)
        weight = drive.mass.sum() * GRAVITY
        findings.check("mean weight error, relative", abs(np.mean(force) / weight - 1), 1e-3)


def _hit(findings: Findings) -> None:
    """A plane comes from 1 m below at 1e3 m/s, which would take it through the body within a step."""
    with Drive(box(1e5, plane=[plane(point=(0, 0, -1), motion="input")])) as drive:
        for n in range(5):
            drive.set(plane__ground__point=(0, 0, -1 + n), plane__ground__velocity=(0, 0, 1e3))
            drive.step(1e-3)
            findings.sound(drive, [((0, 0, float(n)), Z)])
            findings.at_most("energy out of nothing / work", drive.balance() / 1e6, 1e-2)


def _jump(findings: Findings) -> None:
    """The plane jumps into the middle of the body. Points are moved, and only the springs then accelerate the points."""
    with Drive(box(1e3, plane=[plane(point=(0, 0, -1), motion="input")])) as drive:
        drive.step(1e-3)
        drive.set(plane__ground__point=(0, 0, 0.5))
        drive.step(1e-6)
        findings.sound(drive, [((0, 0, 0.5), Z)])
        findings.check("speed at once, m/s", np.abs(drive.v).max(), 0.2)
        drive.run(1.0, 1e-2, lambda: findings.sound(drive, [((0, 0, 0.5), Z)]))
        findings.check("energy out of nothing, J", drive.balance(), 1e-3 * drive.value("energy.work"))


def _turn(findings: Findings) -> None:
    """The normal is reversed from one step to the next. The whole body is then behind the plane and is moved onto the plane."""
    with Drive(box(1e3, 0.1, plane=[plane(point=(0, 0, -0.1), motion="input", inputs=["normal"])])) as drive:
        drive.step(1e-2)
        drive.set(plane__ground__normal=(0, 0, -1))
        drive.run(0.2, 1e-2, lambda: findings.sound(drive, [((0, 0, -0.1), (0, 0, -1))]))


def _turning(findings: Findings) -> None:
    """The plane makes half a turn below the body, at pi rad per step of 0.1 s."""
    with Drive(box(1e3, 0.1, plane=[plane(point=(0.5, 0.5, -0.5), motion="input", inputs=["angular_velocity"])])) as drive:
        drive.set(plane__ground__angular_velocity=(0, 10 * math.pi, 0))
        drive.step(0.1)
        findings.sound(drive, [((0.5, 0.5, -0.5), (0, 0, -1))])


def _shake(findings: Findings) -> None:
    """A plane vibrates by 1 mm at 1 kHz, with inputs every 10 ms: always the same position, and a speed of 6.3 m/s."""
    with Drive(box(1e4, 0.05, plane=[plane(motion="input")], environment=DOWN)) as drive:
        for n in range(100):
            speed = 2 * math.pi * (1 if n % 2 else -1)
            drive.set(plane__ground__point=ORIGIN, plane__ground__velocity=(0, 0, speed))
            drive.step(1e-2)
            findings.sound(drive, [((0, 0, 1e-2 * speed), Z)])
            findings.at_most("energy out of nothing / work", drive.balance() / max(1.0, abs(drive.value("energy.work"))), 1e-2)


def _corner(stiffness: float, findings: Findings) -> None:
    """A body falls into a corner of three planes, which finally carry the weight."""
    gravity = np.array([-1.0, -1.0, -1.0]) * GRAVITY / math.sqrt(3)
    planes = [plane(name, normal=normal, friction=0.3) for name, normal in (("a", (1, 0, 0)), ("b", (0, 1, 0)), ("c", (0, 0, 1)))]
    document = box(stiffness, 0.1, plane=planes, environment={"gravity": list(gravity)}, initial={"offset": [0.1, 0.1, 0.1]})
    with Drive(document) as drive:
        force, sound = [], held(findings, drive, [(ORIGIN, each["normal"]) for each in planes], scale=GRAVITY)

        def each() -> None:
            sound()
            force.append(np.sum([drive.reaction(f"plane.{name}") for name in "abc"], axis=0))

        drive.run(3.0, 1e-2, each)
        error = np.abs(np.mean(force[-100:], axis=0) - gravity * drive.mass.sum()).max()
        findings.check("weight error, N", error, 1e-3, bound=0.1 * GRAVITY)


def _wedge(degrees: float, findings: Findings) -> None:
    """A body falls between two planes that form an acute angle, without friction."""
    half = math.radians(degrees) / 2
    planes = [plane(name, point=(0.5, 0, -1), normal=(sign * math.cos(half), 0, math.sin(half))) for name, sign in (("a", 1), ("b", -1))]
    with Drive(box(1e3, 0.1, plane=planes, environment=DOWN, material={"stiffness": 1e3, "damping": 0.1})) as drive:
        seen = [(each["point"], each["normal"]) for each in planes]
        drive.run(2.0, 1e-2, lambda: findings.sound(drive, seen))
        findings.at_most("energy out of nothing / energy", abs(drive.balance()) / drive.start_energy, 1e-2)


def _closing(opposite: bool, findings: Findings) -> None:
    """Two planes close until no space is left between them."""
    lid = plane("lid", point=(0.5, 0.5, 1), normal=(0, 0, -1) if opposite else (0.1, 0, -1), motion="input")
    with Drive(box(1e3, 0.1, plane=[plane(), lid], pin=[] if opposite else [{"name": "held", "points": "x+"}])) as drive:
        for n in range(200):
            drive.set(plane__lid__point=(0.5, 0.5, 1 - 0.01 * n), plane__lid__velocity=(0, 0, -1))
            drive.step(1e-2)
            findings.sound(drive, [GROUND])


def cases() -> list[Case]:
    """Returns the contact cases."""
    sound = "no penetration, no energy out of nothing"
    found = []
    for k, H, duration in ((1e3, 1e-2, 3.0), (1e9, 1e-3, 1.0), (1e9, 1e-2, 1.0), (1e9, 1e-1, 3.0), (1e10, 1e-2, 1.0), (1e12, 1e-3, 0.3)):
        found.append(Case(f"rest, k = {k:g}, H = {H:g} s", "a box resting on the ground, friction 0.4", f"{sound}; weight, momentum",
                          partial(_rest, k, H, duration), quick=k == 1e3))  # fmt: skip
    for k, H in ((1e9, 1e-2), (1e10, 1e-2), (1e12, 1e-3)):
        found.append(Case(f"drop, k = {k:g}, H = {H:g} s", "falls 20 mm, slides at 0.5 m/s, friction 0.4, rests",
                          f"{sound}; momentum balances, Coulomb's cone, comes to rest", partial(_drop, k, H)))  # fmt: skip
    for k, H in ((1e5, 1e-2), (1e9, 1e-2), (1e10, 1e-2)):
        found.append(Case(f"tumble, k = {k:g}, H = {H:g} s", "lands on a corner, turning at 2 rad/s", f"{sound}; weight in the end",
                          partial(_tumble, k, H)))  # fmt: skip
    for k, H in ((1e5, 1e-2), (1e9, 1e-2), (1e12, 1e-2)):
        found.append(Case(f"squeeze, k = {k:g}, H = {H:g} s", "between two planes, to 90 % within 1 s",
                          "no penetration; force on the lid as numpy's springs say; balance", partial(_squeeze, k, H)))  # fmt: skip
    for k, H in ((1e5, 1e-2), (1e9, 1e-2), (1e9, 1e-1), (1e10, 1e-2), (1e12, 1e-3)):
        for degrees in (20.0, 25.0):
            found.append(Case(f"incline {degrees:g} deg, k = {k:g}, H = {H:g} s", "friction 0.4: sticks at 20 degrees, slides at 25",
                              "exact: v = g (sin - mu cos) t, or 0", partial(_incline, k, H, degrees),
                              quick=k == 1e5 and degrees == 25))  # fmt: skip
    for k, H in ((1e9, 1e-1), (1e10, 1e-2), (1e12, 1e-3)):
        found.append(Case(f"hang, k = {k:g}, H = {H:g} s", "hung up by its upper face", "no energy out of nothing; weight",
                          partial(_hang, k, H)))  # fmt: skip
    for words, method, share in (("auto", "auto", 0.0), ("leapfrog, 0.68 of the bound given", "leapfrog", 0.68),
                                 ("leapfrog, 1000 times the bound given", "leapfrog", 1e3)):  # fmt: skip
        found.append(Case(f"dragged: {words}", "a plane at 150 m/s under an undamped box, k = 1e6 N/m, friction 0.4, H = 1 s",
                          "energy balances; height; exact: v = mu g t", partial(_dragged, method, share),
                          quick=method == "auto"))  # fmt: skip
    for method, step in (("bm4", 3.5e-4), ("ros34pw2", 5e-3)):
        found.append(Case(f"landing: {method}, given step {step:g} s", "falls by 5 cm with a step that suits free flight, k = 1e5 N/m",
                          "no penetration at communication points; energy", partial(_landing, method, step),
                          quick=method == "bm4"))  # fmt: skip
    planes = "no penetration at communication points"
    found += [
        Case("plane at 1e3 m/s", "comes from 1 m below, k = 1e5 N/m, H = 1 ms", planes, _hit, quick=True),
        Case("plane jumps", "from below into the middle of the body, without a velocity", f"{planes}; no speed but by springs", _jump,
             quick=True),
        Case("plane reversed", "its normal is turned round from one step to the next", planes, _turn, quick=True),
        Case("plane turns by 180 deg", "at pi rad per step of 0.1 s", planes, _turning),
        Case("plane at 1 kHz", "1 mm, told every 10 ms", f"{planes}; no energy out of nothing", _shake, quick=True),
        Case("corner of three planes", "falls in along the diagonal, friction 0.3, k = 1e3 N/m", f"{sound}; weight",
             partial(_corner, 1e3)),
        Case("corner of three planes, stiff", "the same with k = 1e9 N/m", f"{sound}; weight", partial(_corner, 1e9)),
        Case("wedge of 60 deg", "falls in, without friction", sound, partial(_wedge, 60.0)),
        Case("wedge of 10 deg", "falls in, without friction", sound, partial(_wedge, 10.0)),
        Case("opposite planes meet", "a lid comes down to the ground and beyond", "refused", partial(_closing, True), refusal=CLOSED,
             quick=True),
        Case("closing wedge on a pinned face", "a slanted lid closes on points that are held", "refused", partial(_closing, False),
             refusal=f"{CLOSED}|behind an obstacle"),
    ]  # fmt: skip
    return found
