"""The rebound of the map: a box that falls flat and rebounds, judged by the flight computed in numpy."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

from validation.stability.answers import Flight, after_impact
from validation.stability.cell import GAIN, STATED, Judged, Trial
from validation.stability.drive import DOWN, box, plane
from validation.stability.verdict import stated_errors

FALL, FALL_TIME = 0.2, 0.4  # height [m] and length of the run [s], at whose end the box has not come down again
TOLERANCE, RIGHT = 1e-4, 3e-4  # tolerance relative to the box; largest accurate error of the centre [m]
STIFFNESSES = tuple(10.0**n for n in range(4, 11))  # N/m
STEPS = (1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2)  # s
PATIENCE = 3.5  # time of a cell [s], longer than elsewhere because only the end of the run counts

DOCUMENT: dict[str, Any] = box(
    1.0, plane=[plane(friction=0.4)], environment=DOWN, initial={"offset": [0.0, 0.0, FALL]},
    solver={"tolerance": TOLERANCE, "error_estimate": True},
)  # fmt: skip
"""Document of the box, with a stiffness of 1 N/m, which the cells change."""


def rebound(trial: Trial) -> Judged:
    """Runs a cell and returns its verdict."""
    drive, step = trial.drive, trial.cell.step
    trial.patience = PATIENCE
    trial.wanted = max(1, round(FALL_TIME / step))
    trial.start()
    gain, highest = 0.0, drive.start_energy
    for _ in trial.steps():
        gain = max(gain, drive.energy() / highest - 1)
    if trial.done < trial.wanted:
        return trial.judged("slow", math.nan, f"{drive.time:.2g} s of {FALL_TIME:g} s in the time")
    known = _flight(trial.cell.stiffness, drive.time)
    error, speed = float(np.abs(drive.centre - known.centre).max()), float(drive.momentum[2] / drive.mass.sum() - known.velocity[2])
    words = f"height wrong by {drive.centre[2] - known.centre[2]:.1e} m, velocity of {known.velocity[2]:.3f} m/s by {speed:.1e} m/s"
    if not drive.finite():
        return trial.judged("WRONG", math.inf, "not finite")
    if gain > GAIN:
        return trial.judged("WRONG", error, f"energy gained {gain:.1e}; {words}")
    if error <= RIGHT:
        return trial.judged("accurate", error, words)
    stated = max(trial.stated, stated_errors(drive, drive.time))
    return trial.judged("bounded" if error <= STATED * stated else "WRONG", error, f"{words}; {stated:.1e} m is stated")


@cache
def _flight(stiffness: float, time: float) -> Flight:
    """Returns the flight of the box after the rebound at a time [s], computed in numpy."""
    return after_impact(DOCUMENT | {"material": {"stiffness": stiffness, "damping": 0.0}}, time)
