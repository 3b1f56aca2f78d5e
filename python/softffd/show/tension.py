"""Colours of what happens inside, a quantity of the lattice's cells, and of contact pressure, on the surface of a picture."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from softffd.errors import SoftffdError
from softffd.run.parts import require_name
from softffd.run.pressure import with_pressure
from softffd.run.result import Result
from softffd.show import pressed
from softffd.show.stage import Stage

RAMP, FOLDED = "viridis", (0.5, 0.5, 0.5)  # the second: inverted cells, which have no stress

CELLS_AT_A_TIME = 200_000


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
"""By name: in words, unit, and the values of all cells (T, nx - 1, ny - 1, nz - 1) at rows (T,) of a result."""


@dataclass(frozen=True, eq=False)
class Cells:
    """A quantity of all cells over the frames (T, nx - 1, ny - 1, nz - 1), NaN where a cell is inverted, or of all taxels, an atlas; ends
    of its scale."""

    name: str
    words: str
    unit: str
    values: np.ndarray
    ends: tuple[float, float]


def cells_of(result: Result, frames: np.ndarray) -> list[Cells]:
    """The Cells of every name of COLOURS that the result knows, at these rows."""
    found = []
    for name in COLOURS:
        with suppress(SoftffdError):
            found.append(_cells(name, result, frames))
    return found


def pressure_of(result: Result, frames: np.ndarray) -> Cells | None:
    """The contact pressure at these rows; None where there are no taxels that have it."""
    if not with_pressure(result.taxels, result.outputs):
        return None
    values = pressed.atlas(result, frames)
    return Cells(pressed.NAME, pressed.WORDS, "Pa", values, _ends(pressed.NAME, values))


def tension_of(result: Result, stage: Stage, frames: Sequence[int], colour: str) -> tuple[Cells, dict[int, np.ndarray]]:
    """The Cells of a name of COLOURS, or of contact pressure, in `frames`, and by frame the tints (V, 3) of the stage's vertices. Between
    the centres of cells these are linear, beyond them that of the nearest. SoftffdError where the result does not know it."""
    from matplotlib import colormaps

    require_name("colour", colour, [*COLOURS, pressed.NAME])
    rows, tints = np.array(frames), {}
    if colour == pressed.NAME:
        all_of_vertices: Iterable[np.ndarray] = pressed.stage_pressure(result, stage, rows)  # refuses what pressure_of has not
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
    """Of the frames, each with so many cells that what stress needs on the way stays small."""
    cells = np.prod(np.array(result.positions.shape[1:4]) - 1)
    return np.array_split(frames, max(1, int(len(frames) * cells / CELLS_AT_A_TIME)))


def _ends(name: str, values: np.ndarray) -> tuple[float, float]:
    """Of the scale, low before high; stress and pressure begin at nothing, stretch where it is least, at 1 at most."""
    low, high = (0.0 if name != "stretch" else values.min(initial=1.0)), values.max(initial=1e-300)
    return float(low), float(high if high > low else low + 1)


def at_places(values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Values of the cells (nx - 1, ny - 1, nz - 1) at places (V, 3) of the box, 0 .. 1 along each side, (V,): linear between
    the centres."""
    most = np.array(values.shape) - 1
    place = (places * values.shape - 0.5).clip(0, most)
    low = np.minimum(place.astype(int), np.maximum(most - 1, 0))
    share = place - low
    total = np.zeros(len(place))
    for corner in np.ndindex(2, 2, 2):
        weight = np.where(corner, share, 1 - share).prod(axis=1)
        total += np.where(weight > 0, weight * values[tuple(np.minimum(low + corner, most).T)], 0.0)
    return total
