"""Patches of the surface whose contact forces are read: their places, the area around each, and the weight of each in a grid of taxels.

A place is a point that touches obstacles: a sample of the surface (samples.py), a control point of the lattice, or a node of a solid. The
area around a place at rest is a vector, outward. For a sample it is a third of the triangles at the vertices to which this sample is
nearest; for a control point the integral of its weight over the sides of the box on which it lies; for a node its part of the quadrature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from softffd.embedding.mass_pieces import control_axis
from softffd.embedding.nodes import axis_shares, rest_nodes
from softffd.lattice import LatticeBox, to_flat
from softffd.mesh.normals import area_vectors

if TYPE_CHECKING:
    from softffd.mesh.mesh import Mesh

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Corner = tuple[float, float, float]
Where = str | tuple[Corner, Corner]
"""A side of the box, the name of a group of the mesh, or the lower and the upper corner of a box [m]"""

FACES = {f"{'xyz'[axis]}{side}": (axis, sign) for axis in range(3) for side, sign in (("-", -1), ("+", 1))}
TURNED = 1e-9
"""A triangle faces a side if the component of its area there is at least 1 - TURNED of its largest component"""
BLOCK = 1 << 24
"""Distances that are computed at a time"""


@dataclass(frozen=True, eq=False)
class Patch:
    """A patch. places (m,): indices. weights (m,): areas of the patch around them [m2]. shares: (place, taxel, fraction of the force on
    the place that counts for the taxel), taxels row by row; empty without taxels."""

    name: str
    places: NDArray[np.int64]
    weights: Array
    taxels: tuple[int, int] | None
    shares: list[tuple[int, int, float]]


@dataclass(frozen=True, eq=False)
class Patches:
    """All patches. areas: (P, 3) m2 at rest, outward, of every place."""

    areas: Array
    patches: list[Patch]


def lattice_places(box: LatticeBox, *, solid: bool) -> Array:
    """Returns the control points, or nodes of a solid, at rest (n, 3) m."""
    return to_flat(rest_nodes(box.points, np.asarray(box.origin), np.asarray(box.size)) if solid else box.rest())


def lattice_areas(box: LatticeBox, *, solid: bool) -> Array:
    """Returns the areas (n, 3) m2 around these places, outward; 0 for places inside."""
    shares = [axis_shares(n) if solid else control_axis(n, box.basis).whole for n in box.points]
    areas = np.zeros((*box.points, 3))
    for axis, (one, other) in enumerate(((1, 2), (0, 2), (0, 1))):
        face = np.outer(shares[one], shares[other]) * box.size[one] * box.size[other]
        for end, sign in ((0, -1), (-1, 1)):
            np.moveaxis(areas[..., axis], axis, 0)[end] += sign * face
    return to_flat(areas)


def points_on(where: Where, areas: Array, places: Array) -> Array:
    """Returns the area (n,) m2 of a patch around each control point or node, 0 for those outside the patch."""
    if isinstance(where, str):
        axis, sign = FACES[where]
        return np.asarray(np.maximum(sign * areas[:, axis], 0.0))
    return np.where(_inside(where, places), np.linalg.norm(areas, axis=1), 0.0)


def vertices_on(where: Where, mesh: Mesh) -> Array:
    """Returns the area (V,) m2 of a patch around each vertex of the mesh, a third of each triangle, 0 for vertices outside the patch. A
    side of the box has the triangles that face it, a group has its own, and a box has those at the vertices in it."""
    if isinstance(where, str):
        mine = _facing(where, mesh) if where in FACES else _of_group(where, mesh)
    else:
        mine = np.ones(len(mesh.faces), dtype=bool)
    sizes = np.repeat(np.linalg.norm(area_vectors(mesh.vertices[mesh.faces[mine]]), axis=1) / 6, 3)
    around: Array = np.bincount(mesh.faces[mine].ravel(), weights=sizes, minlength=len(mesh.vertices)).astype(np.float64)
    return around if isinstance(where, str) else np.where(_inside(where, mesh.vertices), around, 0.0)


def areas_around(mesh: Mesh, of_vertex: NDArray[np.int64], count: int) -> Array:
    """Returns the areas (count, 3) m2 of the mesh, outward, by the place that each vertex (V,) belongs to."""
    areas = np.zeros((count, 3))
    np.add.at(areas, of_vertex[mesh.faces.ravel()], np.repeat(area_vectors(mesh.vertices[mesh.faces]) / 6, 3, axis=0))
    return areas


def _facing(side: str, mesh: Mesh) -> Mask:
    axis, sign = FACES[side]
    normals = area_vectors(mesh.vertices[mesh.faces])
    return sign * normals[:, axis] >= (1 - TURNED) * np.maximum(abs(normals).max(axis=1), np.finfo(float).tiny)


def group_names(mesh: Mesh | None) -> list[str]:
    """Returns the possible names of groups of faces: the names of groups and of objects."""
    groups = mesh.looks.groups if mesh is not None else ()
    return list(dict.fromkeys(name for group in groups for name in (group.group, group.object) if name))


def _of_group(name: str, mesh: Mesh) -> Mask:
    assert mesh.looks.group_of is not None
    wanted = [number for number, group in enumerate(mesh.looks.groups) if name in group]
    return np.isin(mesh.looks.group_of, wanted)


def _inside(corners: tuple[Corner, Corner], places: Array) -> Mask:
    lower, upper = np.array(corners)
    return np.asarray(((places >= lower) & (places <= upper)).all(axis=1))


def nearest(places: Array, among: Array) -> NDArray[np.int64]:
    """Returns for each place (n, 3) the index of the nearest of other places (m, 3); the first one of those that are equally near."""
    found = np.empty(len(places), dtype=np.int64)
    rows = max(1, BLOCK // len(among))
    middle = among.mean(axis=0)
    places, among = places - middle, among - middle
    own = (among**2).sum(axis=1)
    for start in range(0, len(places), rows):
        block = slice(start, start + rows)
        found[block] = (own - 2 * places[block] @ among.T).argmin(axis=1)
    return found


def taxel_shares(places: NDArray[np.int64], at: Array, areas: Array, taxels: tuple[int, int]) -> list[tuple[int, int, float]]:
    """Returns (place, taxel, fraction). A place stands for a square of its area about it: each taxel gets the fraction that lies on it,
    along the two axes that the patch lies along."""
    across = int(abs(areas[places].sum(axis=0)).argmax())
    along = [axis for axis in range(3) if axis != across]
    width = np.sqrt(np.linalg.norm(areas[places], axis=1))
    parts = [_overlaps(at[places, axis], width, count) for axis, count in zip(along, taxels, strict=True)]
    shares = parts[0][:, :, None] * parts[1][:, None, :]
    return [(int(places[n]), int(i * taxels[1] + j), float(shares[n, i, j])) for n, i, j in zip(*shares.nonzero(), strict=True)]


def _overlaps(at: Array, width: Array, count: int) -> Array:
    """Returns the fraction of the interval of this width [m] about each place (n,) that lies on each of `count` cells from the first
    place to the last."""
    lower, upper = at.min(), at.max()
    if not upper > lower:
        return np.full((len(at), count), 1 / count)
    edges = np.linspace(lower, upper, count + 1)
    half = np.maximum(width / 2, 1e-9 * (upper - lower))[:, None]
    begin, end = np.maximum(at[:, None] - half, edges[:-1]), np.minimum(at[:, None] + half, edges[1:])
    parts = np.maximum(end - begin, 0.0)
    return np.asarray(parts / parts.sum(axis=1, keepdims=True))
