"""Colours of a surface by a quantity of the lattice's cells or by contact pressure on taxels: tints for pictures; for the page, values of
the cells and an atlas of all grids of taxels."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from softffd.errors import SoftffdError
from softffd.run.parts import require_name
from softffd.run.pressure import surface_pressure, taxel_pressure, with_pressure
from softffd.run.result import Result
from softffd.show.stage import Stage, surface_of

RAMP, FOLDED = "viridis", (0.5, 0.5, 0.5)  # FOLDED: colour of inverted cells, which have no stress

CELLS_AT_A_TIME = 200_000
PRESSED = "contact_pressure"
FACING = 0.2  # a vertex belongs to a grid if its normal has a larger cosine with the side that the grid faces


def _von_mises(result: Result, frame: Any) -> np.ndarray:
    stress = result.stress(frame)
    apart = stress - np.trace(stress, axis1=-2, axis2=-1)[..., None, None] / 3 * np.eye(3)
    return np.asarray(np.sqrt(1.5 * (apart**2).sum(axis=(-2, -1))))


def _stretch(result: Result, frame: Any) -> np.ndarray:
    return np.asarray(np.sqrt(np.linalg.eigvalsh(2 * result.strain(frame) + np.eye(3))[..., -1].clip(0)))


COLOURS = {
    "von_mises": ("von Mises stress at the cells' centres", "Pa", _von_mises),
    "stretch": ("largest principal stretch at the cells' centres", "", _stretch),
}
"""By name: description, unit, and a function that returns the values of all cells (T, nx - 1, ny - 1, nz - 1) at rows (T,) of a result."""


@dataclass(frozen=True, eq=False)
class Cells:
    """A quantity over the frames, of all cells (T, nx - 1, ny - 1, nz - 1), NaN where a cell is inverted, or of all taxels, as an atlas
    (T, W, H, S); `ends` of its colour scale."""

    name: str
    words: str
    unit: str
    values: np.ndarray
    ends: tuple[float, float]


def cells_of(result: Result, frames: np.ndarray) -> list[Cells]:
    """Returns the Cells at these rows for every name in COLOURS that the result can provide."""
    found = []
    for name in COLOURS:
        with suppress(SoftffdError):
            found.append(_cells(name, result, frames))
    return found


def pressure_of(result: Result, frames: np.ndarray) -> Cells | None:
    """Returns the contact pressure at these rows, or None where no taxels have a recorded pressure."""
    if not with_pressure(result.taxels, result.outputs):
        return None
    values = _atlas(result, frames)
    return Cells(PRESSED, "contact pressure on taxels, mean of the communication step", "Pa", values, _ends(PRESSED, values))


def tension_of(result: Result, stage: Stage, frames: Sequence[int], colour: str) -> tuple[Cells, dict[int, np.ndarray]]:
    """Returns the Cells of a name in COLOURS, or of contact pressure, in `frames`, and by frame the tints (V, 3) of the stage's vertices.
    Values are linear between the centres of cells, beyond them that of the nearest. Raises SoftffdError where the result has none."""
    from matplotlib import colormaps

    require_name("colour", colour, [*COLOURS, PRESSED])
    rows, tints = np.array(frames), {}
    if colour == PRESSED:
        parts = result.covered_by_taxels(surface_of(result, stage))
        of_surface = surface_pressure(result.outputs, parts, rows)  # raises SoftffdError where pressure_of returns None
        all_of_vertices: Iterable[np.ndarray] = of_surface[:, _source(result, stage)]
        cells = pressure_of(result, rows)
        assert cells is not None
    else:
        cells, places = _cells(colour, result, rows), (stage.vertices - stage.origin) / stage.size
        all_of_vertices = (at_places(values, places) for values in cells.values)
    low, high = cells.ends
    for frame, of_vertices in zip(frames, all_of_vertices, strict=True):
        tints[frame] = colormaps[RAMP]((of_vertices - low) / (high - low))[:, :3]
        tints[frame][~np.isfinite(of_vertices)] = FOLDED
    return cells, tints


def _cells(name: str, result: Result, frames: np.ndarray) -> Cells:
    words, unit, measure = COLOURS[name]
    values = np.concatenate([measure(result, some) for some in _parts(result, frames)])
    return Cells(name, words, unit, values, _ends(name, values[np.isfinite(values)]))


def _parts(result: Result, frames: np.ndarray) -> list[np.ndarray]:
    """Splits the frames into parts with so few cells that the temporary arrays of the stress computation stay small."""
    cells = np.prod(np.array(result.positions.shape[1:4]) - 1)
    return np.array_split(frames, max(1, int(len(frames) * cells / CELLS_AT_A_TIME)))


def _ends(name: str, values: np.ndarray) -> tuple[float, float]:
    """Returns the ends of the scale, low before high. Stress and pressure begin at 0, stretch at its least value, but at 1 at most."""
    low, high = (0.0 if name != "stretch" else values.min(initial=1.0)), values.max(initial=1e-300)
    return float(low), float(high if high > low else low + 1)


def at_places(values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Returns the values of the cells (nx - 1, ny - 1, nz - 1), which are linear between the cells' centres, at places (V, 3) of the box,
    0 .. 1 along each side, as (V,)."""
    most = np.array(values.shape) - 1
    place = (places * values.shape - 0.5).clip(0, most)
    low = np.minimum(place.astype(int), np.maximum(most - 1, 0))
    share = place - low
    total = np.zeros(len(place))
    for corner in np.ndindex(2, 2, 2):
        weight = np.where(corner, share, 1 - share).prod(axis=1)
        total += np.where(weight > 0, weight * values[tuple(np.minimum(low + corner, most).T)], 0.0)
    return total


def outward(result: Result) -> np.ndarray:
    """Returns the unit vector (3,) that the first grid faces at rest."""
    grid = with_pressure(result.taxels, result.outputs)[0]
    return grid.side * np.eye(3)[grid.axis]


def _atlas(result: Result, frames: np.ndarray) -> np.ndarray:
    """Returns pressures (T, W, H, S) [Pa], one layer for each of S sensors; a grid smaller than a layer is padded with its edge values."""
    grids = with_pressure(result.taxels, result.outputs)
    sides = _sides(result)
    layers = [taxel_pressure(result.outputs, grid, frames) for grid in grids]
    fills = [[(0, 0), *((0, side - count) for side, count in zip(sides, grid.counts, strict=True))] for grid in grids]
    return np.stack([np.pad(layer, fill, mode="edge") for layer, fill in zip(layers, fills, strict=True)], axis=-1)


@dataclass(frozen=True, eq=False)
class AtlasPlaces:
    """Places (V, 3) of a stage's vertices in the atlas, 0 .. 1, and axes (V,) and sides (V,) of the vertices' grids; side 0: in no grid."""

    places: np.ndarray
    axes: np.ndarray
    sides: np.ndarray

    def of(self, source: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Returns (W, 4) for copies of vertices (W,) with normals (W, 3): the place in the atlas, and 1 on taxels, 0 beside them."""
        towards = self.sides[source] * np.take_along_axis(normals, self.axes[source, None], axis=1)[:, 0]
        return np.column_stack([self.places[source], towards > FACING])


def atlas_places(result: Result, stage: Stage) -> AtlasPlaces | None:
    """Returns the places of a stage's vertices in the atlas; None where no taxels have pressures."""
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
    """Returns for each of the stage's vertices (V,) the vertex of the mesh that it copies."""
    mesh = result.loaded_mesh
    return np.arange(len(stage.vertices)) if mesh is None else mesh.looks.apart(mesh.faces)[0]
