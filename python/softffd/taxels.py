"""Grids of taxels as results and pictures need them: places at rest, and the areas by which forces are converted to pressures."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class TaxelGrid:
    """The taxels of a sensor: a grid seen along one axis of the rest shape; its first side is along the first of the other axes."""

    name: str
    axis: int  # 0, 1, 2: the axis that the patch faces most
    side: int  # +1 or -1: the direction along the axis that the patch faces; 0: its areas face both ways, and its taxels have no pressure
    lower: tuple[float, float]  # where the grid begins along the other two axes [m]
    upper: tuple[float, float]  # where the grid ends along the other two axes [m]
    areas: tuple[tuple[float, ...], ...]  # (n, m) [m2]: areas at rest, seen along the axis, of all places that count for a taxel

    @property
    def counts(self) -> tuple[int, int]:
        return len(self.areas), len(self.areas[0])

    @property
    def along(self) -> list[int]:
        """The two axes along the sides of the grid."""
        return [axis for axis in range(3) if axis != self.axis]

    def pressures(self, forces: np.ndarray) -> np.ndarray:
        """Returns pressures (..., n, m) [Pa] from forces on the taxels along the axis (..., n, m) [N]: the force towards the object
        divided by the area; 0 where there is no area."""
        areas = np.array(self.areas)
        return np.where(areas > 0, -self.side * forces / np.where(areas > 0, areas, 1.0), 0.0) + 0.0  # turns -0.0 into 0.0

    def shares(self, places: np.ndarray) -> np.ndarray:
        """Returns relative positions (N, 2) of places (N, 3) [m] of the rest shape along the grid's sides, 0 .. 1 within the grid."""
        lower, upper = np.array(self.lower), np.array(self.upper)
        length = np.where(upper > lower, upper - lower, 1.0)
        return np.asarray((places[:, self.along] - lower) / length)
