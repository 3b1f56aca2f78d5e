"""Measurement of the rows: the program and its baseline run in turn, several times; the results are medians and quartiles of the ratios.

A row of the table is a function that prepares and yields both calls:

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
"""A measured call. If the call returns a number, this is its time [s], for a call of which only a part counts."""

LEAST, MOST, ENOUGH = 4, 25, 1.2
"""Least and most repetitions, and the time [s] after which the least number is enough"""


class NotMeasured(Exception):
    """Raised with the reason why a row has no numbers."""


@dataclass(frozen=True)
class Pair:
    """A measured call and its baseline."""

    own: Call
    base: Call
    per: float = 1
    """Pieces (steps, vertices) that a call processes; times are those of one piece"""
    per_base: float | None = None
    """Pieces that the baseline processes, if the number differs"""


@dataclass(frozen=True)
class Row:
    """A line of the table."""

    group: str
    name: str
    against: str
    prepare: Callable[[], Iterator[Pair]]
    goal: float | None
    """Largest ratio that meets the goal"""
    seconds: float | None
    """Longest time [s] that meets the goal"""
    every_set: bool
    """True if the result depends on the instruction set"""
    long: bool
    """True if the row takes too long for --quick"""


ROWS: dict[str, Row] = {}
"""Rows by name, in the order of measurement"""


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
    """Returns a decorator that makes a row of a function that yields one Pair."""

    def add(prepare: Callable[[], Iterator[Pair]]) -> Callable[[], Iterator[Pair]]:
        ROWS[name] = Row(group, name, against, prepare, goal, seconds, every_set, long)
        return prepare

    return add


def measure(row: Row, *, quick: bool) -> dict[str, Any]:
    """Returns the times [s] of call and baseline per repetition, with medians and quartiles, or the reason why there are none."""
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
    """Returns the times [s] of call and baseline in each repetition. An additional repetition before is for warming up."""
    laps: list[tuple[float, float]] = []
    began = time.perf_counter()
    while not laps or (not quick and (len(laps) <= LEAST or (len(laps) <= MOST and time.perf_counter() - began < ENOUGH))):
        laps.append((_taken(pair.own), _taken(pair.base)))
    own, base = zip(*(laps if quick else laps[1:]), strict=True)
    return list(own), list(base)


def _taken(call: Call) -> float:
    """Returns the processor time [s] of a call, in which other processes of the machine do not count."""
    began = time.process_time()
    told = call()
    return told if isinstance(told, float) else time.process_time() - began


def _spread(values: np.ndarray) -> dict[str, Any]:
    low, middle, high = np.quantile(values, (0.25, 0.5, 0.75))
    return {"median": middle, "quartiles": [low, high], "all": values.tolist()}


def require_alike(what: str, own: np.ndarray, base: np.ndarray, most: float) -> None:
    """Raises NotMeasured if the results differ by more than `most` [m], because a baseline must compute the same."""
    if not (difference := float(np.abs(own - base).max())) <= most:
        raise NotMeasured(f"{what}: the baseline comes to something else, by {difference:.1e} m")
