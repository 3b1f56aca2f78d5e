"""A run as VTK's unstructured grids: the object's surface, its lattice, and each obstacle. The points move, the cells stay.

    mesh           displacement at the points; the quantities of show/tension.py, interpolated between the centres of cells as in pictures;
                   where the scene has taxels, contact_pressure in Pa, interpolated between the taxels' centres
    lattice        displacement of the control points (of a solid, of its material); for each cell strain (Green-Lagrange), stress (Cauchy)
                   in Pa, and these quantities. Tensors are xx, yy, zz, xy, yz, xz. Inverted cells have a stress of NaN.
    KIND_NAME      an obstacle in its pose

Stress is written if the result has its scene.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from softffd.errors import SoftffdError
from softffd.export.take import Rigid, Take
from softffd.lattice import index_grid, to_flat
from softffd.run.pressure import Covered, surface_pressure
from softffd.show.tension import COLOURS, PRESSED, at_places

TRIANGLE, HEXAHEDRON = 5, 12
"""VTK's numbers of the cell types"""
SIX = (0, 1, 2, 0, 1, 0), (0, 1, 2, 1, 2, 2)
"""Rows and columns of a symmetric tensor's components, in VTK's order"""

Arrays = dict[str, np.ndarray]
Measured = Callable[[int], Arrays]


@dataclass(frozen=True, eq=False)
class Grid:
    """`cells` (C, 3) or (C, 8): indices of points; `at`: function that returns for a row the points (N, 3) [m], the arrays at the points
    (N, ..) and those of the cells (C, ..)."""

    name: str
    cells: np.ndarray
    at: Callable[[int], tuple[np.ndarray, Arrays, Arrays]]

    @property
    def kind(self) -> int:
        return TRIANGLE if self.cells.shape[1] == 3 else HEXAHEDRON


def grids_of(take: Take) -> list[Grid]:
    """Returns all grids of a take, with unique names."""
    stage = take.stage
    measures = [name for name in COLOURS if _known(take, name)]
    rest = to_flat(stage.rest)
    places = (take.mesh.vertices - stage.origin) / stage.size
    measured = lru_cache(maxsize=1)(partial(_measured, take, measures))  # one row, used by surface and lattice
    parts = take.result.covered_by_taxels(take.mesh)
    surface, lattice = partial(_surface, take, places, measured, parts), partial(_lattice, take, rest, measured)
    kinds = {part.name: str(part).replace(".", "_") for part in take.result.obstacle_parts()}
    obstacles = [Grid(kinds[each.name], each.faces, partial(_obstacle, each)) for each in take.obstacles]
    return [Grid("mesh", take.mesh.faces, surface), Grid("lattice", _hexahedra(stage.counts), lattice), *obstacles]


def _known(take: Take, name: str) -> bool:
    with suppress(SoftffdError):
        COLOURS[name][2](take.result, 0)
        return True
    return False


def _measured(take: Take, measures: list[str], row: int) -> Arrays:
    """Returns the values of all cells (nx - 1, ny - 1, nz - 1) by name."""
    return {name: COLOURS[name][2](take.result, row) for name in measures}


def _surface(take: Take, places: np.ndarray, measured: Measured, parts: list[Covered], row: int) -> tuple[np.ndarray, Arrays, Arrays]:
    points = take.deformed(row)
    between = {name: at_places(values, places) for name, values in measured(row).items()}
    if parts:
        between[PRESSED] = surface_pressure(take.result.outputs, parts, row)
    return points, {"displacement": points - take.mesh.vertices, **between}, {}


def _lattice(take: Take, rest: np.ndarray, measured: Measured, row: int) -> tuple[np.ndarray, Arrays, Arrays]:
    points, scalars = take.lattice(row), measured(row)
    tensors = {"strain": take.result.strain(row)}
    if "von_mises" in scalars:
        tensors["stress"] = take.result.stress(row)
    cells = {name: to_flat(values[..., *SIX]) for name, values in tensors.items()}
    return points, {"displacement": points - rest}, cells | {name: to_flat(values[..., None])[:, 0] for name, values in scalars.items()}


def _obstacle(obstacle: Rigid, row: int) -> tuple[np.ndarray, Arrays, Arrays]:
    return obstacle.at(row), {}, {}


def _hexahedra(counts: tuple[int, ...]) -> np.ndarray:
    """Returns the corners (C, 8) of the cells in flat order, in VTK's order around the bottom and the top."""
    index = index_grid(counts)
    nx, ny, nz = (count - 1 for count in counts)
    around = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = [index[i : nx + i, j : ny + j, k : nz + k] for k in (0, 1) for i, j in around]
    return to_flat(np.stack(corners, axis=-1))
