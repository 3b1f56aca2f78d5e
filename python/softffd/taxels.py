"""Grids of taxels as results and pictures need them: where they lie at rest, and the areas by which forces become pressures."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class TaxelGrid:
    """The taxels of a sensor, a grid seen along one axis of the rest shape; the first side of the grid is along the first other axis."""

    name: str
    axis: int  # 0, 1, 2: the axis that the patch faces most
    side: int  # +1 or -1: which way along it the patch faces; 0: its areas face both ways, so that its taxels have no pressure
    lower: tuple[float, float]  # along the other two axes, where the grid begins [m]
    upper: tuple[float, float]  # where it ends [m]
    areas: tuple[tuple[float, ...], ...]  # (n, m) m2: at rest, seen along the axis, of all places that count for a taxel

    @property
    def counts(self) -> tuple[int, int]:
        return len(self.areas), len(self.areas[0])

    @property
    def along(self) -> list[int]:
        """The two axes of the grid."""
        return [axis for axis in range(3) if axis != self.axis]

    def pressures(self, forces: np.ndarray) -> np.ndarray:
        """Pa (..., n, m) of forces on the taxels along the axis (..., n, m) [N]: towards the object by the area; 0 where there is none."""
        areas = np.array(self.areas)
        return np.where(areas > 0, -self.side * forces / np.where(areas > 0, areas, 1.0), 0.0) + 0.0  # no -0.0

    def shares(self, places: np.ndarray) -> np.ndarray:
        """Where places (N, 3) [m] of the rest shape lie along the sides of the grid, 0 .. 1 within it, (N, 2)."""
        lower, upper = np.array(self.lower), np.array(self.upper)
        length = np.where(upper > lower, upper - lower, 1.0)
        return np.asarray((places[:, self.along] - lower) / length)
