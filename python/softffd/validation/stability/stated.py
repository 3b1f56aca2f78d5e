"""What the component's warnings say of its error, in metres."""

from __future__ import annotations

import math
import re

from softffd.validation.stability.drive import Drive

STATED = 5.0
"""An error up to so many times what a warning states has been stated."""

NUMBER = r"([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)"
WRONG_BY = re.compile(rf"(?:wrong|off) by (?:up to |about |some )*{NUMBER}")
GAINED = re.compile(rf"has gained {NUMBER} J")
TURNS = re.compile(rf"omega = {NUMBER} rad/s in implicit steps .* omega h / 2 = {NUMBER} a radian")


def stated_length(text: str) -> float:
    """By how much something is wrong, in its own words [m]; 0 where nothing is said."""
    return max((float(number) for number in WRONG_BY.findall(text)), default=0.0)


def stated_error(warning: str, drive: Drive, duration: float) -> float:
    """The error of a position that a warning gives a number for [m]; 0 for one that gives none.

    A length stands for itself. An energy gained is the speed of the whole body, for the time [s] of the run; a share of a rotation, taken
    for each radian, is that of the angle, at the side of the box.
    """
    if WRONG_BY.search(warning):
        return stated_length(warning)
    if found := GAINED.search(warning):
        return math.sqrt(2 * max(0.0, float(found[1])) / drive.mass.sum()) * duration
    if found := TURNS.search(warning):
        angle = float(found[1]) * duration
        return float(found[2]) * angle**2 * drive.side
    return 0.0


def stated_errors(drive: Drive, duration: float) -> float:
    """The largest that has been stated so far [m]."""
    return max((stated_error(text, drive, duration) for text in drive.simulation.warnings), default=0.0)
