"""Cases with extreme ratios, forces, initial states and motions."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from softffd.errors import FmuError
from validation.stability.cases_standard import conserves, turns_on, undisturbed
from validation.stability.drive import DOWN, GRAVITY, Drive, Refused, box
from validation.stability.verdict import Case, Findings


def _mass_ratio(ratio: float, step: float, findings: Findings) -> None:
    """A body with one corner lighter than the other points by the ratio is released from a stretch."""
    region = [{"points": [[0, 0, 0]], "mass": 1 / 64 / ratio}]
    with Drive(box(1e3, region=region, initial={"stretch": [1.02, 1.0, 1.0]})) as drive:
        drive.run(5 * step, step)
        findings.sound(drive)
        undisturbed(findings, drive, gain=1e-2)


def _stiffness_ratio(findings: Findings) -> None:
    """The lowest layer has 1e9 N/m, the others have 1e-3 N/m."""
    region = [{"points": "z-", "stiffness": 1e9}]
    with Drive(box(1e-3, region=region, initial={"stretch": [1.0, 1.0, 1.1], "angular_velocity": [0.0, 0.0, 1.0]})) as drive:
        drive.run(1.0, 0.1)
        findings.sound(drive)
        undisturbed(findings, drive, gain=1e-2, spin=False)
        turns_on(findings, drive, 1e-3, bound=0.1)


def _force(newton: float, findings: Findings) -> None:
    """A force acts on one corner; the momentum is force times time."""
    with Drive(box(1e3, load=[{"name": "push", "points": [[3, 3, 3]]}])) as drive:
        drive.set(load__push=(newton, 0.0, 0.0))
        drive.run(0.01, 1e-3)
        findings.sound(drive)
        exact = newton * drive.time
        scale = max(exact, 1e-15)
        findings.check("error of the momentum / (F t)", abs(drive.momentum[0] - exact) / scale, 1e-6)
        findings.check("energy out of nothing / work", abs(drive.balance()) / max(drive.value("energy.work"), 1e-15), 1e-2)


def _pulled(step: float, findings: Findings) -> None:
    """A body held at one face is pulled at the other. Within a given step the springs grow by half, and the stability bound divides the
    step. So near the stability limit the energy of leapfrog oscillates by some per cent."""
    document = box(1e3, 0.05, pin=[{"name": "left", "points": "x-"}], load=[{"name": "push", "points": "x+"}], method="leapfrog")
    with Drive(document, {"solver.step": step}) as drive:
        drive.set(load__push=(3e3, 0.0, 0.0))
        drive.run(0.8, 0.16)
        findings.sound(drive)
        findings.check("energy out of nothing / work", abs(drive.balance()) / abs(drive.value("energy.work")), 5e-2)


def _stretched(stretch: list[float], still: bool, findings: Findings) -> None:
    """A body starts stretched by these factors. still: the springs have no force in this shape, so that nothing moves."""
    with Drive(box(1e3, initial={"stretch": stretch})) as drive:
        start = drive.x
        drive.run(0.1, 1e-2)
        findings.sound(drive)
        folded = drive.value("solver.folded_cells")
        findings.notes.append(f"{folded:.0f} folded cells")
        if still:
            findings.check("moved / box", np.abs(drive.x - start).max(), 1e-12)
        else:
            undisturbed(findings, drive, gain=1e-2)
        for axis, factor in enumerate(stretch):
            if factor == 0:
                findings.check(f"left the plane along {'xyz'[axis]} / box", np.ptp(drive.x[:, axis]), 1e-12)
        if math.prod(stretch) < 0:
            findings.check("cells inside out that are not counted", 27 - folded, 0)
            findings.check("folded, without a warning", 0.0 if "inverted" in drive.warned else 1.0, 0.0)


def _spun(stiffness: float, rate: float, step: float, steps: int, findings: Findings) -> None:
    with Drive(box(stiffness, initial={"angular_velocity": [0.0, 0.0, rate]})) as drive:
        drive.run(steps * step, step)
        findings.sound(drive)
        undisturbed(findings, drive, gain=1e-2, spin=False)
        turns_on(findings, drive, 1e-5)


def _reversed_gravity(findings: Findings) -> None:
    """Gravity acts up and down by turns; a body without stresses moves up and down rigidly."""
    with Drive(box(1e3, environment=DOWN)) as drive:
        speed = height = 0.0
        for n in range(200):
            pull = -GRAVITY if n % 2 else GRAVITY
            drive.set(**{"gravity.z": pull})
            drive.step(1e-2)
            height += speed * 1e-2 + pull * 1e-4 / 2
            speed += pull * 1e-2
            findings.at_most("error of the height, m", np.abs(drive.x - drive.rest - [0, 0, height]).max(), 1e-10)
        findings.sound(drive)


def _torn(findings: Findings) -> None:
    """Two pinned faces are drawn apart at 100 m/s to a hundred times the length."""
    pins = [{"name": "left", "points": "x-"}, {"name": "right", "points": "x+", "motion": "input"}]
    with Drive(box(1e3, 0.1, pin=pins)) as drive:
        home = drive.rest[drive.rest[:, 0] == 1].mean(axis=0)
        for n in range(100):
            drive.set(pin__right__position=home + np.array([n, 0, 0]), pin__right__velocity=(100.0, 0.0, 0.0))
            drive.step(1e-2)
            findings.sound(drive)
        drive.set(pin__right__position=home + np.array([100, 0, 0]), pin__right__velocity=(0.0, 0.0, 0.0))
        drive.run(2.0, 1e-2)
        findings.sound(drive)
        held = drive.net_force()[drive.rest[:, 0] == 1].sum(axis=0)
        findings.check("reaction / springs' force - 1", abs(drive.reaction("pin.right")[0] / held[0] - 1), 1e-3, bound=0.1)
        findings.check("energy out of nothing / work", abs(drive.balance()) / drive.value("energy.work"), 1e-3)


def _damped(findings: Findings) -> None:
    """With 1e9 N s/m per point, a stretched body creeps back and gains no energy."""
    with Drive(box(1e3, 1e9, initial={"stretch": [1.1, 1.0, 1.0]})) as drive:
        drive.run(1.0, 0.1, lambda: conserves(findings, drive, gain=1e-9))
        findings.sound(drive)
        velocity = drive.net_force() / 1e9
        findings.check("error of the creep, relative", np.abs(drive.v - velocity).max() / np.abs(velocity).max(), 1e-6)


def _endless(findings: Findings) -> None:
    """A body of 1e12 N/m is released from a stretch and makes a single step of 100 s: 1.5e9 vibrations of the lattice."""
    with Drive(box(1e12, initial={"stretch": [1.01, 1.0, 1.0]})) as drive:
        drive.step(100.0)
        findings.sound(drive)
        undisturbed(findings, drive, gain=1e-2)


def _not_a_number(findings: Findings) -> None:
    with Drive(box(1e3, load=[{"name": "push", "points": "x+"}])) as drive:
        drive.step(1e-3)
        try:
            drive.set(load__push=(math.nan, 0.0, 0.0))
        except FmuError as error:
            raise Refused(str(error)) from None
        drive.step(1e-3)
        findings.sound(drive)


def _overflow(findings: Findings) -> None:
    """A force so large that the motion overflows double precision."""
    with Drive(box(1e3, load=[{"name": "push", "points": [[0, 0, 0]]}])) as drive:
        drive.set(load__push=(1e308, 0.0, 0.0))
        drive.run(1.0, 0.1)
        findings.sound(drive)


def cases() -> list[Case]:
    """Returns the extreme cases."""
    free = "energy and momentum conserved"
    return [
        Case("mass ratio 1e6", "one corner of 1.6e-8 kg, k = 1e3 N/m, five steps of 10 ms", free, partial(_mass_ratio, 1e6, 1e-2)),
        Case("mass ratio 1e12", "one corner of 1.6e-14 kg, five steps of 10 us", free, partial(_mass_ratio, 1e12, 1e-5), quick=True),
        Case("stiffness ratio 1e12", "a layer of 1e9 N/m in 1e-3 N/m, turning", f"{free}; angular momentum", _stiffness_ratio),
        Case("force 1e12 N", "on one corner, k = 1e3 N/m", "momentum = F t; energy = work", partial(_force, 1e12), quick=True),
        Case("force 1e-300 N", "on one corner", "momentum = F t; energy = work", partial(_force, 1e-300), quick=True),
        Case("force 1e308 N", "on one corner, ten steps of 0.1 s", "refused: the result is not finite", _overflow,
             refusal="finite|most_work", quick=True),
        Case("force not a number", "as input", "refused", _not_a_number, refusal="finite|NaN|nan", quick=True),
        Case("pulled at once, given step 0.16 s", "with 3e3 N, k = 1e3 N/m: the step is divided anew as the body stiffens", free,
             partial(_pulled, 0.16), quick=True),
        Case("all points at one place", "started so", "zero-length springs have no force: nothing moves",
             partial(_stretched, [0.0, 0.0, 0.0], True), quick=True),
        Case("coplanar", "started flat", "springs without length push in no direction", partial(_stretched, [1.0, 1.0, 0.0], False),
             refusal="springs have zero length", quick=True),
        Case("nearly coplanar", "started at a thickness of 1e-9", free, partial(_stretched, [1.0, 1.0, 1e-9], False)),
        Case("mirrored", "started turned inside out", "nothing moves; 27 folded cells, warned of",
             partial(_stretched, [-1.0, 1.0, 1.0], True), quick=True),
        Case("stretched 100 times", "k = 1e3 N/m, 0.1 s", free, partial(_stretched, [100.0, 1.0, 1.0], False), quick=True),
        Case("spin 1e3 rad/s, soft", "k = 1e3 N/m: flies apart", f"{free}; angular momentum", partial(_spun, 1e3, 1e3, 1e-3, 100),
             quick=True),
        Case("spin 1e3 rad/s, stiff", "k = 1e9 N/m", f"{free}; angular momentum", partial(_spun, 1e9, 1e3, 1e-3, 100)),
        Case("slow spin, k = 1e5", "0.1 rad/s, ten steps of 0.1 s", f"{free}; angular momentum", partial(_spun, 1e5, 0.1, 0.1, 10),
             quick=True),
        Case("slow spin, k = 1e9", "1 rad/s, ten steps of 0.1 s", f"{free}; angular momentum", partial(_spun, 1e9, 1.0, 0.1, 10)),
        Case("slow spin, k = 1e11", "0.1 rad/s, ten steps of 10 ms", f"{free}; angular momentum", partial(_spun, 1e11, 0.1, 0.01, 10)),
        Case("gravity reversed each step", "200 steps of 10 ms", "exact: up and down as one", _reversed_gravity, quick=True),
        Case("pins tear the body apart", "100 m/s, to 100 m", "reaction as numpy's springs say; energy = work", _torn),
        Case("damping 1e9 N s/m", "stretched by 10 %", "no energy gained; creeps with v = f / d", _damped, quick=True),
        Case("a step of 100 s at k = 1e12", "1.5e9 vibrations in one communication step", f"{free}, or refused", _endless,
             patience=200),
    ]  # fmt: skip
