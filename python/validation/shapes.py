"""Bodies with a surface, made in code and written as OBJ, and distances of points from obstacles."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from softffd.rotation import turned

X, _, Z = np.eye(3)

Shape = tuple[np.ndarray, np.ndarray]  # vertices (V, 3) [m] and faces (F, 3)


def sphere(halvings: int, radius: float = 0.4, centre: float = 0.5) -> Shape:
    """Returns the vertices (10 * 4^halvings + 2, 3) [m] and faces of a sphere, an icosahedron whose edges are halved `halvings` times. No
    vertex is a pole."""
    golden = (1 + np.sqrt(5)) / 2
    ends = [np.roll([0.0, a, b * golden], shift) for shift in range(3) for a in (-1, 1) for b in (-1, 1)]
    vertices = np.array(ends) / np.hypot(1, golden)
    near = np.linalg.norm(vertices[:, None] - vertices[None], axis=2) < 1.1
    faces = np.array(
        [(a, b, c) for a in range(12) for b in range(a + 1, 12) for c in range(b + 1, 12) if near[a, b] and near[b, c] and near[a, c]]
    )
    for _ in range(halvings):
        vertices, faces = _halved(vertices, faces)
    inward = np.einsum("fi,fi->f", np.cross(*(vertices[faces[:, n]] - vertices[faces[:, 0]] for n in (1, 2))), vertices[faces[:, 0]]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return centre + radius * turned(turned(vertices, 0.7 * Z), 0.3 * X), faces


def _halved(vertices: np.ndarray, faces: np.ndarray) -> Shape:
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    found, place = np.unique(edges, axis=0, return_inverse=True)
    middles = vertices[found].sum(axis=1)
    a, b, c = faces.T
    ab, bc, ca = (place.reshape(-1, 3) + len(vertices)).T
    parts = [np.stack(part, axis=1) for part in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return np.vstack([vertices, middles / np.linalg.norm(middles, axis=1, keepdims=True)]), np.concatenate(parts)


def cube(count: int, margin: float) -> Shape:
    """Returns a cube of side 1 - 2 margin in the unit cube, with count x count vertices on each face."""
    along = np.linspace(margin, 1 - margin, count)
    square = np.arange(count * count).reshape(count, count)
    a, b, c, d = square[:-1, :-1].ravel(), square[1:, :-1].ravel(), square[1:, 1:].ravel(), square[:-1, 1:].ravel()
    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []
    for axis in range(3):
        for high in (False, True):
            u, v = np.meshgrid(along, along, indexing="ij")
            places = np.stack([np.full(u.size, along[-1 if high else 0]), u.ravel(), v.ravel()], axis=1)
            triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
            faces.append((triangles if high else triangles[:, ::-1]) + count * count * len(vertices))
            vertices.append(np.roll(places, axis, axis=1))
    return np.concatenate(vertices), np.concatenate(faces)


def write(path: Path, body: Shape) -> str:
    """Writes vertices and faces as OBJ, to all digits, and returns the path as text."""
    vertices, faces = body
    path.write_text(
        "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in vertices.tolist()) + "".join(f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist())
    )
    return str(path)


FREE_EDGE = 5e-3  # edge radius of a free box divided by its smallest side, as in the core
KINDS = ("plane", "sphere", "cylinder", "box")  # sections of a scene file


def gap(
    kind: str, keys: Mapping[str, Any], places: np.ndarray, point: np.ndarray, normal: np.ndarray, across: np.ndarray | None = None
) -> np.ndarray:
    """Returns the signed distances (..) [m] of places (.., 3) [m] from the obstacle of a section's keys, negative behind or in it.

    point: of the plane, or the centre of the solid [m]. normal: of the plane, or the axis of a cylinder, or the third axis of a box.
    across: first axis of a box, of unit length.
    """
    arm = places - point
    if kind == "plane":
        return arm @ normal
    if kind == "sphere":
        return np.linalg.norm(arm, axis=-1) - keys["radius"]
    if kind == "box" and across is not None:
        edge = FREE_EDGE * min(keys["size"]) if keys.get("motion") == "free" else 0.0
        off = np.abs(arm @ np.stack([across, np.cross(normal, across), normal], axis=1)) - np.array(keys["size"]) / 2 + edge
        return np.minimum(off.max(axis=-1), 0.0) + np.linalg.norm(np.maximum(off, 0.0), axis=-1) - edge
    height = arm @ normal
    beside = np.linalg.norm(arm - height[..., None] * normal, axis=-1) - keys["radius"]
    above = np.abs(height) - keys["length"] / 2
    return np.minimum(np.maximum(beside, above), 0.0) + np.hypot(np.maximum(beside, 0.0), np.maximum(above, 0.0))
