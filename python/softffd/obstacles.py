"""The data of obstacles that pictures need."""

import math
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class SolidShape:
    """The shape of a solid obstacle, along its own axes."""

    name: str
    kind: Literal["sphere", "cylinder", "box"]
    size: tuple[float, float, float]  # edges of the bounding box; the third is a cylinder's length [m]

    @property
    def radius(self) -> float:
        """Radius of a sphere or cylinder [m]."""
        return self.size[0] / 2

    @property
    def length(self) -> float:
        """Length of a cylinder [m]."""
        return self.size[2]

    @property
    def volume(self) -> float:
        """Volume [m3]."""
        x, y, z = self.size
        return {"sphere": math.pi / 6, "cylinder": math.pi / 4, "box": 1.0}[self.kind] * x * y * z

    def inertia(self, mass: float) -> tuple[float, float, float]:
        """Returns the moments of inertia [kg m2] about the solid's own axes through its centre, for this mass [kg] spread evenly."""
        each = {"sphere": (1 / 20,) * 3, "cylinder": (1 / 16, 1 / 16, 1 / 12), "box": (1 / 12,) * 3}[self.kind]
        x, y, z = (mass * factor * side**2 for factor, side in zip(each, self.size, strict=True))
        return y + z, x + z, x + y

    def __str__(self) -> str:
        """Returns a description such as "sphere ball of radius 0.6 m"."""
        x, y, z = self.size
        sizes = {
            "sphere": f"radius {self.radius:g} m",
            "cylinder": f"radius {self.radius:g} m and length {z:g} m",
            "box": f"{x:g} x {y:g} x {z:g} m",
        }
        return f"{self.kind} {self.name} of {sizes[self.kind]}"


@dataclass(frozen=True)
class Obstacles:
    """The obstacles as an FMU describes them."""

    meet: Literal["surface", "lattice"] = "lattice"  # the part of the object that obstacles touch
    solids: tuple[SolidShape, ...] = ()  # obstacles with an inside, in the scene's order
