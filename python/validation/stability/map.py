"""The map: stiffness against communication step. Each cell is run with the FMU and judged by an exact solution.

Four scenes are a box of 2 x 2 x 2 points, 1 m, 1 kg, with all springs of stiffness k, undamped:

vibration   The box is released from a stretch of 1 % along every axis. By the cube's symmetry the box keeps its shape: the points are
            exactly at centre + s (rest - centre) with s = 1 + 0.01 cos(omega t), omega = 8 sqrt(k / (1 kg)), at any amplitude. omega is
            the lattice's highest frequency. Every method has to resolve the vibration, or to report that it does not.
damping     The same box has dashpots along the springs, tau omega from 0.01 to 1000. Every point moves on one line, so that s is exactly
            that of the damped oscillator. Strong damping makes the box creep.
rotation    The box spins at 1 rad/s without stress. Angular momentum and energy are exactly constant.
contact     The slightly damped box rests on a plane that is drawn away under it with friction, under gravity g = min(9.81 m/s2,
            k / (50 kg)), which a soft box can carry. Exactly: the friction impulse is mu times the normal impulse; impulses, gravity and
            damping give the momentum; the centre finally sinks by the static sag, and before not much beyond twice the static sag.

The module also measures the border of the raw explicit scheme, the central difference of eq. (13) without division of steps.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from itertools import groupby
from typing import Any

import numpy as np

from validation.mechanics import Body
from validation.stability import rebound
from validation.stability.answers import static_sag
from validation.stability.cell import GAIN, STATED, Cell, Judged, Panel, Trial, omega, settings
from validation.stability.drive import Drive, Refused, StateTouched

STRETCH, TOLERANCE = 0.01, 1e-5
SPIN = 1.0  # rad/s
TURNED = 1e-3  # relative error of angular momentum and energy that counts as accurate

FRICTION, GRAVITY = 0.4, 9.81
DAMPING = 0.4  # damping rate of the contact scene in units of sqrt(k / (1 kg)): a few per cent of the critical one
SETTLED = 12.0  # damping rate times time after which the box must be at rest

MOMENTUM, LOOSE = 1e-3, 20.0
"""Limits of soundness: missing momentum relative to the impulse of the weight (with damping an integration error), and inner energy
relative to weight times static sag."""

RIGHT = 10 * TOLERANCE  # error of a position that counts as accurate [m]
SLIDE = 1e-3  # relative error of the friction impulse that counts as accurate
BEHIND = 1e-12  # penetration that rounding explains, relative to the box


def run_cells(cells: Sequence[Cell]) -> Iterator[Judged]:
    """Runs cells one after the other, each in the scene of its panel, and yields the results."""
    for scene, some in groupby(cells, lambda cell: cell.panel.scene):
        with Drive(document(scene)) as drive:
            for cell in some:
                began = clock.perf_counter()
                try:
                    judged = SCENES[scene](Trial(drive, cell, began))
                except Refused as refusal:
                    judged = Judged("refused", why=str(refusal), run_time=clock.perf_counter() - began)
                except StateTouched as fault:
                    judged = Judged("WRONG", why=str(fault), run_time=clock.perf_counter() - began)
                yield judged


def document(scene: str) -> dict[str, Any]:
    """Returns the document of a panel's scene."""
    if scene == "rebound":
        return rebound.DOCUMENT
    box = {"lattice": {"points": [2, 2, 2]}, "material": {"stiffness": 1.0, "damping": 1.0 if scene == "contact" else 0.0}}
    solver = {"tolerance": TOLERANCE, "error_estimate": True}
    if scene == "vibration":
        return box | {"initial": {"stretch": [1 + STRETCH] * 3}, "solver": solver}
    if scene == "damping":
        material = {"stiffness": 1.0, "damping": 0.0, "internal_damping": 1.0}
        return box | {"material": material, "initial": {"stretch": [1 + STRETCH] * 3}, "solver": solver}
    if scene == "rotation":
        return box | {"initial": {"angular_velocity": [0.0, 0.0, SPIN]}, "solver": solver}
    ground = {"name": "ground", "friction": FRICTION, "motion": "input"}
    return box | {"plane": [ground], "environment": {"gravity": [0.0, 0.0, -GRAVITY]}, "solver": solver}


def _oscillation(ratio: float, phase: float) -> float:
    """Returns the remaining part of a unit stretch at omega t = phase, after release from rest. ratio: twice the damping ratio."""
    damping = ratio / 2
    if damping < 1:
        root = math.sqrt(1 - damping**2)
        return math.exp(-damping * phase) * (math.cos(root * phase) + damping / root * math.sin(root * phase))
    if damping == 1:
        return (1 + phase) * math.exp(-phase)
    root = math.sqrt(damping**2 - 1)
    slow, fast = 1 / (damping + root), damping + root
    return (fast * math.exp(-slow * phase) - slow * math.exp(-fast * phase)) / (fast - slow)


def _vibration(trial: Trial) -> Judged:
    drive, frequency = trial.drive, omega(trial.cell.stiffness)
    trial.start()
    middle, error, far = drive.rest.mean(axis=0), 0.0, 0.0
    centre = middle + STRETCH / 2
    for _ in trial.steps():
        x = drive.x
        exact = centre + (1 + STRETCH * _oscillation(trial.cell.ratio, frequency * drive.time)) * (drive.rest - middle)
        error = max(error, float(np.linalg.norm(x - exact, axis=1).max()))
        far = max(far, float(np.linalg.norm(x - centre, axis=1).max()))
    if not drive.finite():
        return trial.judged("WRONG", math.inf, "not finite")
    if error <= RIGHT:
        return trial.judged("accurate", error)
    if far > math.sqrt(3) / 2 * (1 + 1.5 * STRETCH):
        return trial.judged("WRONG", error, "the vibration grows without end")
    if error <= STATED * trial.stated:
        return trial.judged("bounded", error)
    kind = "unstated" if trial.cell.panel.given else "WRONG"
    return trial.judged(kind, error, f"error {error:.1e} m, but the estimate says {trial.stated:.1e} m")


def _rotation(trial: Trial) -> Judged:
    drive = trial.drive
    trial.start()
    error, gain = 0.0, 0.0
    for _ in trial.steps():
        gained = drive.energy() / drive.start_energy - 1
        gain, error = max(gain, gained), max(error, drive.turning_change(), abs(gained))
    if not drive.finite():
        return trial.judged("WRONG", math.inf, "not finite")
    if error <= TURNED:
        return trial.judged("accurate", error)
    stated, way = trial.stated, error * SPIN * drive.time * math.sqrt(0.5)
    if gain <= GAIN and way <= STATED * stated:
        return trial.judged("bounded", error)
    why = f"energy gained {gain:.1e}, energy or angular momentum wrong by {error:.1e}, {way:.1e} m; the estimate says {stated:.1e} m"
    return trial.judged("WRONG", error, why)


def _contact(trial: Trial) -> Judged:
    drive, cell = trial.drive, trial.cell
    gravity, rate, mass = min(GRAVITY, cell.stiffness / 50), DAMPING * math.sqrt(cell.stiffness), drive.mass.sum()
    pull = 100 * FRICTION * gravity * trial.wanted * cell.step
    trial.start(**{"gravity.z": -gravity, "plane.ground.velocity.x": pull, "damping": rate * drive.mass[0]})
    start, sag = drive.centre, gravity / cell.stiffness * unit_sag()
    behind = off = loose = 0.0
    for _ in trial.steps():
        behind = max(behind, -float(drive.x[:, 2].min()))
        sunk = start[2] - drive.centre[2]
        off = max(off, sunk - 2.5 * sag, -sunk)
        loose = max(loose, _inner_energy(drive) / (mass * gravity * sag))
    if rate * drive.time > SETTLED:
        off = max(off, abs(sunk - sag) - 0.2 * sag)
    given, weight = drive.impulse, mass * gravity * drive.time
    missing = drive.momentum - given + rate * mass * (drive.centre - start) + np.array([0.0, 0.0, weight])
    found = {
        "behind": behind,
        "slide": float(np.hypot(given[0] - FRICTION * given[2], given[1])) / (FRICTION * weight),
        "off": off,
        "loose": loose,
        "missing": float(np.abs(missing).max()) / weight,
    }
    return _contact_judged(trial, found)


def _contact_judged(trial: Trial, found: dict[str, float]) -> Judged:
    """Returns the verdict on the contact scene. A run is sound if no point is behind the plane, momentum balances, and the inner energy
    stays below twenty times weight times static sag."""
    published = trial.cell.panel.method == "central_difference"
    words = ", ".join(f"{name} {value:.1e}" for name, value in found.items())
    error = found["slide"]
    balanced = found["behind"] <= BEHIND and found["missing"] <= MOMENTUM
    if not ((published or balanced) and found["loose"] <= LOOSE and trial.drive.finite()):
        return trial.judged("WRONG", error, words)
    if error <= SLIDE and found["off"] <= RIGHT and balanced:
        return trial.judged("accurate", error)
    if published or (error <= SLIDE and found["off"] <= STATED * trial.stated):
        return trial.judged("bounded", error, words)
    return trial.judged("WRONG", error, words)


def _inner_energy(drive: Drive) -> float:
    """Returns the elastic energy plus the kinetic energy of the motion about the centre [J]."""
    return drive.body.elastic_energy(drive.x) + drive.body.kinetic_energy(drive.v - drive.momentum / drive.mass.sum())


SCENES = {"vibration": _vibration, "damping": _vibration, "rotation": _rotation, "contact": _contact, "rebound": rebound.rebound}


@cache
def unit_sag() -> float:
    """Returns the static sag [m] of the centre of the box on a plane by linear theory, for a gravity of 1 m/s2 and a stiffness of 1 N/m."""
    with Drive(document("contact")) as drive:
        return static_sag(drive)


STEPS = 2000  # steps of one trial
NOISE = 1e-9  # disturbance of the rest shape, m
GROWN = 1e3  # growth of a disturbance that counts as unbounded; below the border a disturbance grows to about ten times at most


@dataclass(frozen=True)
class Border:
    """Steps at the border for one stiffness [s]."""

    stiffness: float  # N/m
    theory: float  # 2 / omega
    raw: float  # largest step without growth, by bisection
    bound: float  # the component's `solver.stable_step`
    divided: float  # smallest given `solver.step` that the component divides, by bisection


def borders(stiffnesses: Sequence[float], rounds: int = 14) -> list[Border]:
    """Returns the borders of the box of the map at rest. Each bisection narrows a factor of 4 to 2^-rounds of it."""
    found = []
    with Drive(document("vibration") | {"initial": {}}) as drive:
        for stiffness in stiffnesses:
            theory = 2 / omega(stiffness)
            drive.body.stiffness[:] = stiffness
            raw = _bisected(theory, rounds, partial(grows, drive.body, drive.rest))
            drive.restart(settings(Panel("vibration", "leapfrog", True), stiffness, 0.0))
            bound = drive.value("solver.stable_step")
            divided = _bisected(theory, rounds, partial(_divides, drive, stiffness))
            found.append(Border(stiffness, theory, raw, bound, divided))
    return found


def _bisected(theory: float, rounds: int, beyond: Callable[[float], bool]) -> float:
    low, high = theory / 2, 2 * theory
    for _ in range(rounds):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return math.sqrt(low * high)


def grows(body: Body, rest: np.ndarray, h: float) -> bool:
    """True if a small disturbance of the rest shape grows without bound in leapfrog with the step h [s]."""
    noise = NOISE * np.random.default_rng(0).standard_normal(rest.shape)
    x, v = rest + noise, np.zeros_like(rest)
    for _ in range(STEPS):
        v = v + h * body.spring_force(x) / body.mass[:, None]
        x = x + h * v
        if not np.abs(x - rest).max() < GROWN * NOISE:
            return True
    return False


def _divides(drive: Drive, stiffness: float, h: float) -> bool:
    drive.restart(settings(Panel("vibration", "leapfrog", True), stiffness, h))
    drive.step(h)
    return "above the stability bound" in drive.warned
