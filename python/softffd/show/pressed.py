"""Contact pressure of taxels as pictures and page have it: on the surface that is shown, and as an atlas of all grids."""

from dataclasses import dataclass

import numpy as np

from softffd.run.pressure import surface_pressure, taxel_pressure, with_pressure
from softffd.run.result import Result
from softffd.show.stage import Stage, surface_of

NAME, WORDS = "contact_pressure", "contact pressure on taxels, mean of the communication step"
FACES = 0.2
"""Least cosine between the normal of a vertex and the side that a grid faces, for it to be of the grid"""


def outward(result: Result) -> np.ndarray:
    """Unit vector (3,) that the first grid faces at rest."""
    grid = with_pressure(result.taxels, result.outputs)[0]
    return grid.side * np.eye(3)[grid.axis]


def stage_pressure(result: Result, stage: Stage, frames: np.ndarray) -> np.ndarray:
    """At the vertices of the stage (T, V) [Pa]."""
    return surface_pressure(result.outputs, result.covered_by_taxels(surface_of(result, stage)), frames)[:, _source(result, stage)]


def atlas(result: Result, frames: np.ndarray) -> np.ndarray:
    """Pressures (T, W, H, S) [Pa], a layer for each of S sensors; a grid smaller than a layer goes on as it ends."""
    grids = with_pressure(result.taxels, result.outputs)
    sides = _sides(result)
    layers = [taxel_pressure(result.outputs, grid, frames) for grid in grids]
    fills = [[(0, 0), *((0, side - count) for side, count in zip(sides, grid.counts, strict=True))] for grid in grids]
    return np.stack([np.pad(layer, fill, mode="edge") for layer, fill in zip(layers, fills, strict=True)], axis=-1)


@dataclass(frozen=True, eq=False)
class AtlasPlaces:
    """Where the vertices of a stage are in the atlas (V, 3), 0 .. 1, the axes (V,) and sides (V,) of their grids; a side of 0: in none."""

    places: np.ndarray
    axes: np.ndarray
    sides: np.ndarray

    def of(self, source: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """(W, 4) of copies of vertices, by the vertices (W,) and their normals (W, 3): place, and 1 on taxels, 0 beside them."""
        towards = self.sides[source] * np.take_along_axis(normals, self.axes[source, None], axis=1)[:, 0]
        return np.column_stack([self.places[source], towards > FACES])


def atlas_places(result: Result, stage: Stage) -> AtlasPlaces | None:
    """None where there are no taxels with pressures."""
    parts = result.covered_by_taxels(surface_of(result, stage))
    if not parts:
        return None
    source, sides, count = _source(result, stage), np.array(_sides(result)), len(parts)
    inside = np.stack([part.inside for part in parts])
    chosen = inside.argmax(axis=0)
    shares = np.stack([part.shares.clip(0, 1) * np.array(part.grid.counts) / sides for part in parts])
    places = np.column_stack([shares[chosen, np.arange(len(chosen))], (chosen + 0.5) / count])
    axes, ways = np.array([part.grid.axis for part in parts]), np.array([part.grid.side for part in parts])
    return AtlasPlaces(places[source], axes[chosen][source], np.where(inside.any(axis=0), ways[chosen], 0)[source])


def _sides(result: Result) -> tuple[int, int]:
    counts = [grid.counts for grid in with_pressure(result.taxels, result.outputs)]
    return max(n for n, _ in counts) + 1, max(m for _, m in counts) + 1


def _source(result: Result, stage: Stage) -> np.ndarray:
    """Which vertex of the mesh (V,) each of the stage's copies."""
    mesh = result.loaded_mesh
    return np.arange(len(stage.vertices)) if mesh is None else mesh.looks.apart(mesh.faces)[0]
