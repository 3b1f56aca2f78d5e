"""The border of the raw explicit scheme, measured: the central difference of eq. (13), without anybody to divide its steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.mechanics import Body
from validation.stability.cell import Panel, omega, settings
from validation.stability.drive import Drive
from validation.stability.map import document

STEPS = 2000
"""Of one trial."""

NOISE = 1e-9
"""Disturbance of the rest shape, m."""

GROWN = 1e3
"""A disturbance that has grown so much grows for ever: below the border it stays within about ten times itself."""


@dataclass(frozen=True)
class Border:
    """Steps at the border for one stiffness [s]."""

    stiffness: float
    """N/m"""
    theory: float
    """2 / omega"""
    raw: float
    """Largest step without growth, by bisection"""
    bound: float
    """The component's `solver.stable_step`"""
    divided: float
    """Smallest given `solver.step` that the component divides, by bisection"""


def borders(stiffnesses: Sequence[float], rounds: int = 14) -> list[Border]:
    """For the box of the map, at rest; each bisection within 2^-rounds of its start, a factor of 4."""
    found = []
    with Drive(document("vibration") | {"initial": {}}) as drive:
        for stiffness in stiffnesses:
            theory = 2 / omega(stiffness)
            drive.body.stiffness[:] = stiffness
            body, rest = drive.body, drive.rest
            raw = _bisected(theory, rounds, lambda h, body=body, rest=rest: grows(body, rest, h))
            drive.restart(settings(Panel("vibration", "leapfrog", True), stiffness, 0.0))
            bound = drive.value("solver.stable_step")
            divided = _bisected(theory, rounds, lambda h, stiffness=stiffness: _divides(drive, stiffness, h))
            found.append(Border(stiffness, theory, raw, bound, divided))
    return found


def _bisected(theory: float, rounds: int, beyond) -> float:
    low, high = theory / 2, 2 * theory
    for _ in range(rounds):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return math.sqrt(low * high)


def grows(body: Body, rest: np.ndarray, h: float) -> bool:
    """Whether a small disturbance of the rest shape grows without end in leapfrog with the step h [s]."""
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
