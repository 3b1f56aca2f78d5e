"""Obstacles as pictures need them."""

import math
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class SolidShape:
    """A solid obstacle's form, along its own axes."""

    name: str
    kind: Literal["sphere", "cylinder", "box"]
    size: tuple[float, float, float]  # edges of the box about it; a cylinder's length is the third [m]

    @property
    def radius(self) -> float:
        """Of what is round [m]."""
        return self.size[0] / 2

    @property
    def length(self) -> float:
        """Of a cylinder [m]."""
        return self.size[2]

    @property
    def volume(self) -> float:
        """[m3]"""
        x, y, z = self.size
        return {"sphere": math.pi / 6, "cylinder": math.pi / 4, "box": 1.0}[self.kind] * x * y * z

    def inertia(self, mass: float) -> tuple[float, float, float]:
        """Moments of inertia of this mass [kg], spread evenly, about its own axes through its centre [kg m2]."""
        each = {"sphere": (1 / 20,) * 3, "cylinder": (1 / 16, 1 / 16, 1 / 12), "box": (1 / 12,) * 3}[self.kind]
        x, y, z = (mass * factor * side**2 for factor, side in zip(each, self.size, strict=True))
        return y + z, x + z, x + y

    def __str__(self) -> str:
        """As in "sphere ball of radius 0.6 m"."""
        x, y, z = self.size
        sizes = {
            "sphere": f"radius {self.radius:g} m",
            "cylinder": f"radius {self.radius:g} m and length {z:g} m",
            "box": f"{x:g} x {y:g} x {z:g} m",
        }
        return f"{self.kind} {self.name} of {sizes[self.kind]}"


@dataclass(frozen=True)
class Obstacles:
    """What an FMU says of its obstacles."""

    meet: Literal["surface", "lattice"] = "lattice"  # what of the object they meet
    solids: tuple[SolidShape, ...] = ()  # those with an inside, in the scene's order
