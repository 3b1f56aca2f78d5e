"""Obstacles as pictures need them."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class SolidShape:
    """A solid obstacle's form, along its own axes."""

    name: str
    kind: Literal["sphere", "cylinder", "box"]
    size: tuple[float, float, float]
    """Edges of the box about it; a cylinder's length is the third [m]"""

    @property
    def radius(self) -> float:
        """Of what is round [m]."""
        return self.size[0] / 2

    @property
    def length(self) -> float:
        """Of a cylinder [m]."""
        return self.size[2]

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

    meet: Literal["surface", "lattice"] = "lattice"
    """What of the object they meet"""
    solids: tuple[SolidShape, ...] = ()
    """Those with an inside, in the scene's order"""
