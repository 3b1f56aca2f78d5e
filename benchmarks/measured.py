"""How things are measured: what is measured and its baseline in turn, several times over; medians and quartiles of their ratios.

A row of the table is a function that prepares both and yields them:

    @row("steps", "an internal step", "the same in numba", goal=0.35)
    def internal_step() -> Iterator[Pair]:
        with Simulation(scene) as simulation:
            yield Pair(lambda: simulation.step(0.1), lambda: loop.run(1000), per=1000)
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

Call = Callable[[], Any]
"""Does something. A number that it returns is the time [s] that it took, where not all of it counts."""

LEAST, MOST, ENOUGH = 4, 25, 1.2
"""Repetitions: at least, at most, and the time [s] after which the least is enough."""


class NotMeasured(Exception):
    """Why a row has no numbers here."""


@dataclass(frozen=True)
class Pair:
    """What is measured, and its baseline."""

    own: Call
    base: Call
    per: float = 1
    """Pieces (steps, vertices) that a call does; times are those of one"""
    per_base: float | None = None
    """The same of the baseline, where it does another number of them"""


@dataclass(frozen=True)
class Row:
    """A line of the table."""

    group: str
    name: str
    against: str
    prepare: Callable[[], Iterator[Pair]]
    goal: float | None
    """The ratio that is aimed at, at most"""
    seconds: float | None
    """The time [s] that is aimed at, at most"""
    every_set: bool
    """Whether instruction sets make a difference"""
    long: bool
    """Too long for --quick"""


ROWS: dict[str, Row] = {}
"""By name, in the order in which they are measured."""


def row(
    group: str,
    name: str,
    against: str,
    *,
    goal: float | None = None,
    seconds: float | None = None,
    every_set: bool = True,
    long: bool = False,
) -> Callable:
    """Makes a row of a function that yields one Pair."""

    def add(prepare: Callable[[], Iterator[Pair]]) -> Callable[[], Iterator[Pair]]:
        ROWS[name] = Row(group, name, against, prepare, goal, seconds, every_set, long)
        return prepare

    return add


def measure(row: Row, *, quick: bool) -> dict[str, Any]:
    """Times [s] of both by repetition, medians and quartiles; or the reason why there are none."""
    if quick and row.long:
        return {"missing": "left out by --quick"}
    try:
        with contextmanager(row.prepare)() as pair:
            own, base = _times(pair, quick)
    except NotMeasured as reason:
        return {"missing": str(reason)}
    except ImportError as error:
        return {"missing": f"{(error.name or str(error)).partition('.')[0]} is not installed"}
    own, base = np.array(own) / pair.per, np.array(base) / (pair.per_base or pair.per)
    return {"own": _spread(own), "base": _spread(base), "ratio": _spread(own / base)}


def _times(pair: Pair, quick: bool) -> tuple[list[float], list[float]]:
    """Of each repetition; one more before them is for warming up."""
    laps: list[tuple[float, float]] = []
    began = time.perf_counter()
    while not laps or (not quick and (len(laps) <= LEAST or (len(laps) <= MOST and time.perf_counter() - began < ENOUGH))):
        laps.append((_taken(pair.own), _taken(pair.base)))
    own, base = zip(*(laps if quick else laps[1:]), strict=True)
    return list(own), list(base)


def _taken(call: Call) -> float:
    """Processor time [s]: what else runs on the machine does not count."""
    began = time.process_time()
    told = call()
    return told if isinstance(told, float) else time.process_time() - began


def _spread(values: np.ndarray) -> dict[str, Any]:
    low, middle, high = np.quantile(values, (0.25, 0.5, 0.75))
    return {"median": middle, "quartiles": [low, high], "all": values.tolist()}


def require_alike(what: str, own: np.ndarray, base: np.ndarray, most: float) -> None:
    """A baseline that does something else is none: the largest difference [m] of what comes out has to be small."""
    if not (difference := float(np.abs(own - base).max())) <= most:
        raise NotMeasured(f"{what}: the baseline comes to something else, by {difference:.1e} m")
