"""Cases of the standard scenes S1 to S7, and cases with exact limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from softffd.run.inputs import Inputs
from softffd.scene.scene import load_scene
from validation.mechanics import outside_force
from validation.stability.drive import DOWN, GRAVITY, ORIGIN, Drive, Vector, Z, box, plane
from validation.stability.verdict import Case, Findings, Run

GROUND = (ORIGIN, Z)


def conserves(findings: Findings, drive: Drive, *, scale: float | None = None, gain: float = 1e-3) -> None:
    """Checks that no energy is gained: mechanical energy minus work minus start energy, divided by the start energy or a scale [J]."""
    scale = scale or max(drive.start_energy, 1e-300)
    findings.at_most("energy gained / energy", (drive.energy() - drive.value("energy.work") - drive.start_energy) / scale, gain)


def held(findings: Findings, drive: Drive, planes: Sequence[tuple[Vector, Vector]] = (GROUND,), **energy: float) -> Callable[[], None]:
    """Returns a check to call after every step: the state is sound with these planes and gains no energy. energy: scale, gain."""

    def each() -> None:
        findings.sound(drive, planes)
        conserves(findings, drive, **energy)

    return each


def undisturbed(findings: Findings, drive: Drive, *, gain: float = 1e-3, spin: bool = True) -> None:
    """Checks a free, undamped body: no energy gained or lost, zero momentum and, if `spin`, zero angular momentum."""
    conserves(findings, drive, gain=gain)
    findings.at_most("energy lost / energy", (drive.start_energy - drive.energy()) / drive.start_energy, gain, bound=0.05)
    speed = math.sqrt(2 * drive.start_energy * drive.mass.sum())
    findings.at_most("momentum / sqrt(2 E M)", np.linalg.norm(drive.momentum) / speed, 1e-10)
    if spin:
        findings.at_most("angular momentum / (L sqrt(2 E M))", np.linalg.norm(drive.angular_momentum) / (drive.side * speed), 1e-9)


def turns_on(findings: Findings, drive: Drive, limit: float, *, bound: float | None = None) -> None:
    """Checks that the angular momentum equals that at the start."""
    findings.check("change of angular momentum, relative", drive.turning_change(), limit, bound=bound)


def slides(findings: Findings, drive: Drive, *, missing: float, beyond: float) -> None:
    """Checks a body on the ground with friction 0.4: momentum balances, and friction stays within Coulomb's cone."""
    weight = drive.mass.sum() * drive.time * GRAVITY
    findings.check("missing momentum / that of the weight", np.abs(drive.missing_momentum()).max() / weight, missing)
    findings.check("friction impulse / (mu normal impulse) - 1", np.hypot(*drive.impulse[:2]) / (0.4 * drive.impulse[2]) - 1, beyond)


def _free(name: str, findings: Findings) -> None:
    scene = load_scene(name)
    with Drive(scene) as drive:
        drive.run(scene.experiment.stop_time, scene.experiment.communication_step)
        findings.sound(drive)
        if drive.body.damping.any():
            conserves(findings, drive)
            findings.check("energy out of nothing / energy", abs(drive.balance()) / drive.start_energy, 1e-3)
        else:
            undisturbed(findings, drive)


def _pulled(name: str, findings: Findings) -> None:
    """A slow load acts. Finally the springs carry the load, and the only remaining motion is the common fall."""
    scene = load_scene(name)
    with Drive(scene) as drive:
        inputs = Inputs(scene.default_inputs)
        drive.run(scene.experiment.stop_time, scene.experiment.communication_step, inputs=inputs)
        findings.sound(drive)
        load = outside_force(drive.resolved, dict(zip(inputs.names, inputs.values(drive.time, drive.time), strict=False)))
        left_over = drive.net_force() + load
        findings.check("unbalanced force / load", np.abs(left_over).max() / np.abs(load).max(), 1e-2, bound=0.1)
        findings.check("momentum of the fall, relative", abs(drive.momentum[2] / _fall(drive) - 1), 1e-6)


def _fall(drive: Drive) -> float:
    """Returns the momentum [kg m/s] of a body that falls from rest with the damping rate of its points, equal for all points."""
    rate = drive.body.damping[0] / drive.body.mass[0]
    return float(drive.mass.sum() * -GRAVITY * (1 - math.exp(-rate * drive.time)) / rate)


def _sliding_drop(findings: Findings) -> None:
    scene = load_scene("sliding_drop")
    with Drive(scene) as drive:
        drive.run(scene.experiment.stop_time, scene.experiment.communication_step, held(findings, drive))
        slides(findings, drive, missing=1e-5, beyond=1e-9)


def _spin(turns: int, findings: Findings) -> None:
    scene = load_scene("spin")
    with Drive(scene) as drive:
        drive.run(turns * scene.experiment.communication_step, scene.experiment.communication_step)
        findings.sound(drive)
        undisturbed(findings, drive, spin=False)
        turns_on(findings, drive, 1e-6)


def _spin_long(steps: float, findings: Findings) -> None:
    """The scene runs for this number of fixed steps of half the stability bound."""
    scene = load_scene("spin")
    with Drive(scene) as drive:
        h = 0.5 * drive.value("solver.stable_step")
        drive.restart({"solver.method": "leapfrog", "solver.step": h})
        per_call = 1000
        for _ in range(round(steps / per_call)):
            drive.step(per_call * h)
            undisturbed(findings, drive, spin=False)
        findings.sound(drive)
        turns_on(findings, drive, 1e-9)
        findings.notes.append(f"{drive.value('solver.steps'):.0f} internal steps")


def crush(share: float, *, stiffness: float = 1e3, volume: float = 0.0, step: float = 0.01, method: str = "auto") -> Run:
    """Returns the run of a case: a lid presses a box to a fraction of its height, waits and moves away. The run checks the end state."""

    def run(findings: Findings) -> None:
        lid = plane("lid", point=(0, 0, 1), normal=(0, 0, -1), motion="input")
        material = {"stiffness": stiffness, "damping": 0.1, **({"volume_stiffness": volume} if volume else {})}
        with Drive(box(material=material, method=method, plane=[plane(), lid])) as drive:
            down, hold, away = 1.0, 0.2, 3.0
            while drive.time < down + hold + away - step / 2:
                speed = (share - 1) / down if drive.time < down - step / 2 else 2.0 if drive.time > down + hold - step / 2 else 0.0
                height = max(share, 1 - (1 - share) * drive.time / down) + 2.0 * max(0.0, drive.time - down - hold)
                drive.set(plane__lid__point=(0, 0, height), plane__lid__velocity=(0, 0, speed))
                drive.step(step)
                now = (0, 0, height + speed * step)
                findings.sound(drive, [GROUND, (now, (0, 0, -1))])
                findings.at_most("energy out of nothing / energy put in", _gain(drive), 1e-3)
            folded, strain = drive.value("solver.folded_cells"), _strain(drive)
            findings.notes.append(f"largest strain in the end {strain:.2g}, {folded:.0f} folded cells")
            if volume:
                findings.check("largest strain of a spring in the end", strain, 1e-2)
                findings.check("folded cells", folded, 0)
            elif folded:
                findings.check("folded, without a warning", 0.0 if "inverted" in drive.warned else 1.0, 0.0)

    return run


def _strain(drive: Drive) -> float:
    return float(np.abs(drive.body.stretch(drive.x) / drive.body.length).max())


def _gain(drive: Drive) -> float:
    return drive.balance() / max(abs(drive.value("energy.work")), drive.start_energy, 1e-9)


def _free_fall(step: float, steps: int, findings: Findings) -> None:
    """A body without stresses falls; the exact position is x + v t + g t^2 / 2."""
    with Drive(box(1.0, environment=DOWN, initial={"velocity": [0.3, 0.0, 1.0]})) as drive:
        start = drive.x
        for _ in range(steps):
            drive.step(step)
        exact = start + np.array([0.3, 0.0, 1.0]) * drive.time - np.array([0.0, 0.0, GRAVITY / 2]) * drive.time**2
        findings.sound(drive)
        findings.check("error / way", np.abs(drive.x - exact).max() / max(1.0, np.abs(exact - start).max()), 1e-10)


def _static_stretch(findings: Findings) -> None:
    """A body is pulled by 20 N per point at both ends (k = 1e3 N/m). The extents of the static solution are exact."""
    loads = [{"name": "right", "points": "x+"}, {"name": "left", "points": "x-"}]
    with Drive(box(1e3, 0.5, load=loads)) as drive:
        drive.set(load__right=(320.0, 0.0, 0.0), load__left=(-320.0, 0.0, 0.0))
        drive.run(4.0, 0.1)
        findings.sound(drive)
        error = np.abs(np.ptp(drive.x, axis=0) - [1.02981507, 0.99369468, 0.99369468]).max()
        findings.check("error of the extents, m", error, 1e-5)


def _terminal_velocity(damping: float, findings: Findings) -> None:
    """A damped body falls; v = m g / d (1 - exp(-d t / m)) for every point."""
    with Drive(box(1e3, damping, environment=DOWN)) as drive:
        drive.run(1.0, 0.01)
        rate = damping * len(drive.mass) / drive.mass.sum()
        exact = -GRAVITY / rate * -math.expm1(-rate * drive.time)
        findings.sound(drive)
        findings.check("error of the velocity, relative", np.abs(drive.v[:, 2] / exact - 1).max(), 1e-4)


def _vibration(points: tuple[int, int, int], findings: Findings) -> None:
    with Drive(box(1e3, points=points, initial={"stretch": [1.05, 1.0, 0.97]})) as drive:
        drive.run(1.0, 0.05)
        findings.sound(drive)
        undisturbed(findings, drive)


def cases() -> list[Case]:
    """Returns the cases of the standard scenes and the exact limits."""
    free = "energy, momentum and angular momentum conserved"
    pull = "spring forces balance the load in the end; momentum of the fall exact"
    found = [
        Case("S1 free vibration", "shipped scene free_vibration: 10 % stretch, k = 1e3 N/m, undamped, 1 s", free,
             partial(_free, "free_vibration"), quick=True),
        Case("S2 stiff pull", "shipped scene stiff_pull: k = 1e7 N/m, slow load", pull, partial(_pulled, "stiff_pull")),
        Case("S3 stiff layer", "shipped scene stiff_layer: one layer 1e8, the others 1e3 N/m", pull, partial(_pulled, "stiff_layer")),
        Case("S4 sliding drop", "shipped scene sliding_drop: falls, slides, rests; friction 0.4",
             "no penetration, no energy gained, momentum balances, friction within Coulomb's cone", _sliding_drop),
        Case("S5 light corner", "shipped scene light_corner: a corner of 1e-6 kg beside points of 1 kg", "energy balances",
             partial(_free, "light_corner")),
        Case("S6 spin", "shipped scene spin: k = 1e5 N/m, 20 rad/s, ten turns", free, partial(_spin, 10)),
        Case("spin, 1e7 steps", "the same with leapfrog, 1e7 steps of half the stability bound", free,
             partial(_spin_long, 1e7), patience=300),
        Case("static stretch", "k = 1e3 N/m pulled by 320 N", "exact extents of the static solution", _static_stretch, quick=True),
    ]  # fmt: skip
    for share in (0.4, 0.2, 0.05):
        found.append(Case(f"S7 crush to {share:.0%}", "a lid comes down within 1 s, waits, goes; k = 1e3 N/m",
                          "no penetration, energy balances, folding is warned of", crush(share)))  # fmt: skip
        found.append(Case(f"S7 crush to {share:.0%}, volume", "the same with volume_stiffness = 9e3 Pa (3 k / cell)",
                          "recovers its shape, no folded cells", crush(share, volume=9e3)))  # fmt: skip
    found.append(Case("S7 crush to 5%, stiff, volume", "k = 1e7 N/m, volume_stiffness = 9e7 Pa",
                      "recovers its shape, no folded cells", crush(0.05, stiffness=1e7, volume=9e7)))  # fmt: skip
    found.append(Case("S7 crush to 40%, very stiff", "k = 1e10 N/m: snaps through within a microsecond",
                      "no penetration, energy balances, folding is warned of", crush(0.4, stiffness=1e10)))  # fmt: skip
    for step in (1e-9, 1e-6, 1e-3, 1.0, 100.0):
        found.append(Case(f"free fall, steps of {step:g} s", "a soft body thrown and falling, ten steps", "exact: x + v t + g t^2 / 2",
                          partial(_free_fall, step, 10), quick=step in (1e-9, 1.0)))  # fmt: skip
    for damping in (1e-9, 1.0, 1e9):
        found.append(Case(f"terminal velocity, damping {damping:g}", f"falls with {damping:g} N s/m per point, 1 s",
                          "exact: m g / d (1 - exp(-d t / m))", partial(_terminal_velocity, damping), quick=damping == 1e9))  # fmt: skip
    for points in ((2, 2, 2), (2, 3, 8)):
        found.append(Case(f"lattice {points[0]} x {points[1]} x {points[2]}", "free vibration, 1 s", free,
                          partial(_vibration, points), quick=points == (2, 2, 2)))  # fmt: skip
    return found
