"""Data classes of a published case: its source, its parameters, and the numbers that are compared."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Body:
    """A bar, beam or block: model "springs" (of a modulus) or "solid", points along each axis, and Poisson's ratio (1/4 for springs)."""

    model: str
    points: tuple[int, int, int]
    ratio: float = 0.25

    def __str__(self) -> str:
        ratio = "" if self.model == "springs" else f", ratio {self.ratio:g}"
        return f"{self.model} {' x '.join(map(str, self.points))}{ratio}"


@dataclass(frozen=True)
class Row:
    """One number of a case: the body, the quantity with its unit, the reference value, the value found, the number of internal steps, and
    the run time without set-up [s]."""

    body: Body
    quantity: str
    reference: float
    found: float
    steps: int
    seconds: float

    @property
    def error(self) -> float:
        """Error relative to the reference [1]"""
        return self.found / self.reference - 1


@dataclass(frozen=True)
class Case:
    """A case: its title, its source, its parameters, the uncertainty of the reference, the function that runs it, and its bodies."""

    title: str
    source: str
    parameters: str
    certainty: str
    rows: Callable[[Body], Iterator[Row]]
    bodies: tuple[Body, ...]
