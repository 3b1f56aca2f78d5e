"""The springs of a scene: their end points, their stiffness, and the part of the stiffness that each cell has."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from softffd.lattice import cells_within, index_grid

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

WAYS = [way for way in product((-1, 0, 1), repeat=3) if way > (0, 0, 0)]
"""Offsets from a control point to half of its neighbours, in numbers of cells."""
KINDS = ("edge", "face", "body")

Way = tuple[int, ...]


def springs(scene: Scene) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yields the springs along each of WAYS: flat indices of both ends, two (s,) arrays of unique indices each; stiffness (s,) [N/m]."""
    cells = cell_stiffness(scene, {}) if scene.material.youngs_modulus is not None else None
    for number, way in enumerate(WAYS):
        here, there = _ends(scene, way)
        stiffness = _given(scene, way, {}) if cells is None else _gathered(cells[..., number], way)
        yield here.ravel(), there.ravel(), stiffness.ravel()


def cell_stiffness(scene: Scene, parameters: Mapping[str, float]) -> np.ndarray:
    """Returns the total stiffness of the springs along WAYS in each cell, (nx - 1, ny - 1, nz - 1, 13) [N/m].

    The cells around a spring share its stiffness equally. parameters: values of the run that differ from the scene.
    """
    if scene.material.youngs_modulus is not None:
        return _of_modulus(scene, parameters.get("youngs_modulus", scene.material.youngs_modulus))
    return np.stack([_shared(_given(scene, way, parameters), way) for way in WAYS], axis=-1)


def _ends(scene: Scene, way: Way) -> tuple[np.ndarray, np.ndarray]:
    """Returns the flat indices of both ends of the springs along a way, as grids."""
    counts, points = scene.lattice.points, index_grid(scene.lattice.points)
    here = points[tuple(slice(max(0, -d), n - max(0, d)) for d, n in zip(way, counts, strict=True))]
    return here, points[tuple(slice(max(0, d), n + min(0, d)) for d, n in zip(way, counts, strict=True))]


def _given(scene: Scene, way: Way, parameters: Mapping[str, float]) -> np.ndarray:
    """Returns the stiffness of the springs along a way, as a grid; it is doubled for springs that "paper" creates twice."""
    given, kind = scene.material.stiffness, KINDS[np.abs(way).sum() - 1]
    assert given is not None  # filled in
    here, there = _ends(scene, way)
    stiffness = np.full(here.shape, float(parameters.get(f"stiffness.{kind}", getattr(given, kind))))
    for region in scene.region:
        if region.stiffness is not None:
            inside = scene.select(region.points)
            stiffness[np.isin(here, inside) & np.isin(there, inside)] = region.stiffness
    if scene.lattice.springs == "paper" and kind == "edge":
        stiffness[_outer(stiffness.shape, way) == 2] *= 2
    return stiffness


def _of_modulus(scene: Scene, modulus: float) -> np.ndarray:
    counts = np.array(scene.lattice.points)
    sides = np.array(scene.lattice_box.size) / (counts - 1)
    moduli = np.full(counts - 1, modulus)
    for region in scene.region:
        if region.youngs_modulus is not None:
            moduli[cells_within(scene.select(region.points), scene.lattice.points)] = region.youngs_modulus
    shares = []
    for way in np.abs(WAYS):
        along, across = ((1 / sides[way == step] ** 2).sum() for step in (1, 0))
        shares.append({1: 1.2 * along - 0.4 * across, 2: 0.2 * along, 3: 0.0}[way.sum()] * np.prod(sides))
    return moduli[..., None] * np.array(shares)


def _across(way: Way) -> list[int]:
    return [axis for axis in range(3) if way[axis] == 0]


def _outer(shape: tuple[int, ...], way: Way) -> np.ndarray:
    """Returns the number of outer faces of the box on which each spring along a way lies."""
    outer = np.zeros(shape, int)
    for axis in _across(way):
        np.moveaxis(outer, axis, 0)[[0, -1]] += 1
    return outer


def _shared(springs: np.ndarray, way: Way) -> np.ndarray:
    springs = springs / 2.0 ** (len(_across(way)) - _outer(springs.shape, way))
    for axis in _across(way):
        layers = np.moveaxis(springs, axis, 0)
        springs = np.moveaxis(layers[:-1] + layers[1:], 0, axis)
    return springs


def _gathered(cells: np.ndarray, way: Way) -> np.ndarray:
    """Returns the stiffness of the springs along a way: each cell divides its stiffness equally among its springs along the way."""
    for axis in _across(way):
        layers = np.pad(np.moveaxis(cells, axis, 0) / 2, [(1, 1), (0, 0), (0, 0)])
        cells = np.moveaxis(layers[:-1] + layers[1:], 0, axis)
    return cells
