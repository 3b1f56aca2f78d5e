"""What a published case is: its source, its parameters, and the numbers that it is compared by."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Body:
    """A bar, beam or block: "springs" of a modulus or a "solid", its points along each axis, Poisson's ratio (of springs 1/4)."""

    model: str
    points: tuple[int, int, int]
    ratio: float = 0.25

    def __str__(self) -> str:
        ratio = "" if self.model == "springs" else f", ratio {self.ratio:g}"
        return f"{self.model} {' x '.join(map(str, self.points))}{ratio}"


@dataclass(frozen=True)
class Row:
    """One number of a case: what it is with its unit, the reference, what came out, of which body, by how many internal steps in what
    time [s], the set-up left out."""

    body: Body
    quantity: str
    reference: float
    found: float
    steps: int
    seconds: float

    @property
    def error(self) -> float:
        """Relative to the reference [1]"""
        return self.found / self.reference - 1


@dataclass(frozen=True)
class Case:
    """A case by its title: where it is from, its parameters, how certain the reference is, and what runs it."""

    title: str
    source: str
    parameters: str
    certainty: str
    rows: Callable[[Body], Iterator[Row]]
    bodies: tuple[Body, ...]
