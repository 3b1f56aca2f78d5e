"""Contact pressure of taxels over time, and on a surface between them.

The pressure of a taxel is the force on it towards the object, along the axis that the patch faces most, divided by the area at rest seen
along this axis. On the surface the pressure is linear between the taxels' centres, beyond the outer centres that of the nearest taxel, and
0 where there are no taxels.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from softffd.embedding.patches import Where, vertices_on
from softffd.errors import SoftffdError
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import area_vectors
from softffd.names import Cell, variable_name
from softffd.run.parts import require_name
from softffd.taxels import TaxelGrid

Outputs = Mapping[str, np.ndarray]
Rows = int | slice | np.ndarray


def grid_of(grids: Iterable[TaxelGrid], name: str) -> TaxelGrid:
    """Returns the taxels of a sensor; SoftffdError with the nearest name for an unknown sensor, or if the patch faces both ways."""
    known = {grid.name: grid for grid in grids}
    require_name("sensor with taxels", name, list(known))
    if not known[name].side:
        raise SoftffdError(f"contact pressure: the patch of sensor {name} faces both ways; wanted one of which most faces one way")
    return known[name]


def with_pressure(grids: Iterable[TaxelGrid], outputs: Outputs) -> list[TaxelGrid]:
    """Returns the grids that face one way and whose taxels were recorded."""
    return [grid for grid in grids if grid.side and all(name in outputs for name in _names(grid))]


def taxel_pressure(outputs: Outputs, grid: TaxelGrid, row: Rows = slice(None)) -> np.ndarray:
    """Returns the pressures (T, n, m) [Pa] at rows of the outputs, (n, m) at one row."""
    forces = np.stack([outputs[name][row] for name in _names(grid)], axis=-1)
    return grid.pressures(forces.reshape(*forces.shape[:-1], *grid.counts))


def _names(grid: TaxelGrid) -> list[str]:
    return [variable_name("sensor_taxel", Cell(grid.name, i, j), "xyz"[grid.axis]) for i, j in np.ndindex(*grid.counts)]


@dataclass(frozen=True, eq=False)
class Covered:
    """What a grid of taxels covers of a surface: which vertices (V,), and their positions along the grid's sides (V, 2), 0 .. 1."""

    grid: TaxelGrid
    inside: np.ndarray
    shares: np.ndarray

    def at_vertices(self, pressure: np.ndarray) -> np.ndarray:
        """Returns the pressures at the vertices (..., V) [Pa] from the pressures of the taxels (..., n, m) [Pa]."""
        count = np.array(self.grid.counts)
        place = (self.shares * count - 0.5).clip(0, count - 1)
        low = np.minimum(place.astype(int), np.maximum(count - 2, 0))
        (i, j), (p, q) = low.T, (place - low).T
        after, beside = np.minimum(low + 1, count - 1).T
        near = pressure[..., i, j] * (1 - p) + pressure[..., after, j] * p
        far = pressure[..., i, beside] * (1 - p) + pressure[..., after, beside] * p
        return np.where(self.inside, near * (1 - q) + far * q, 0.0)


def covered(grids: Iterable[TaxelGrid], outputs: Outputs, surface: Mesh, patches: Mapping[str, Where]) -> list[Covered]:
    """Returns what each grid with recorded pressures covers of a surface at rest.

    patches: by sensor name, if `surface` is the mesh that the patches are on. The grid then covers the vertices of its patch that face
        the same way as the grid. On any other surface, such as that of the box, the grid covers the vertices over it that face that
        way."""
    facing, found = np.zeros((len(surface.vertices), 3)), []
    np.add.at(facing, surface.faces.ravel(), np.repeat(area_vectors(surface.vertices[surface.faces]), 3, axis=0))
    for grid in with_pressure(grids, outputs):
        shares, inside = grid.shares(surface.vertices), grid.side * facing[:, grid.axis] > 0
        if grid.name in patches:
            inside &= vertices_on(patches[grid.name], surface) > 0
        else:
            inside &= ((shares > -1e-9) & (shares < 1 + 1e-9)).all(axis=1)
        found.append(Covered(grid, inside, shares))
    return found


def surface_pressure(outputs: Outputs, parts: Iterable[Covered], row: Rows) -> np.ndarray:
    """Returns the pressures (T, V) [Pa] at rows, (V,) at one row; where several sensors overlap, the largest."""
    found = [each.at_vertices(taxel_pressure(outputs, each.grid, row)) for each in parts]
    if not found:
        raise SoftffdError("contact pressure: wanted a run with all taxels of a [[sensor]] whose patch mostly faces one way")
    return np.asarray(np.max(found, axis=0))
