"""Solid obstacles as pictures and page draw them: shaded surfaces of triangles, which move as the obstacle does."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from softffd.scene.obstacle import gap

LEAST_SIDES, MOST_SIDES = 48, 256
"""Of a circle."""

FLAT = 1e-3
"""How far a side may be from its arc, as a share of the scene's radius."""


@dataclass(frozen=True, eq=False)
class SolidTrack:
    """A solid obstacle over time.

    `vertices` (V, 3) [m] about its centre with its axis along z, those of a box along x, y and z, their unit `normals` (V, 3) and `faces`
    (F, 3): its surface; `tint` its colour. `points` (T, 3) [m]: its centre; unit `axes` and, across them, unit `tangents` (T, 3), of a box
    its third axis and its first. `kind`, `keys`: its section in the scene.
    """

    name: str
    tint: tuple[float, float, float]
    kind: str
    keys: Mapping[str, Any]
    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    points: np.ndarray
    axes: np.ndarray
    tangents: np.ndarray

    def gap(self, places, frame):
        """Signed distance (N,) [m] of places (N, 3) [m] in a frame; negative inside."""
        return gap(self.kind, self.keys, places, self.points[frame], self.axes[frame], self.tangents[frame])

    def placed(self, frame):
        """Vertices (V, 3) [m] and normals (V, 3) in a frame."""
        turn = np.stack([self.tangents[frame], np.cross(self.axes[frame], self.tangents[frame]), self.axes[frame]])
        return self.points[frame] + self.vertices @ turn, self.normals @ turn

    @property
    def size(self):
        """Distance of its furthest point from its centre, m."""
        return float(np.linalg.norm(self.vertices, axis=1).max())


def solid_surface(kind, keys, radius):
    """Vertices (V, 3) [m], normals (V, 3) and faces (F, 3) of a solid about the origin; radius: of the scene that it is seen in [m]."""
    if kind == "box":
        return _box(np.array(keys["size"]) / 2)
    sides = int(np.clip(np.pi * np.sqrt(keys["radius"] / (2 * FLAT * radius)), LEAST_SIDES, MOST_SIDES))
    if kind == "sphere":
        lean = np.linspace(0, np.pi, sides // 2 + 1)
        along = np.stack([np.sin(lean), np.cos(lean)], axis=1)
        return _turned(keys["radius"] * along, along, sides)
    half, out = keys["length"] / 2, keys["radius"]
    ends = np.array([(0, half), (out, half), (out, half), (out, -half), (out, -half), (0, -half)])
    normals = np.array([(0, 1), (0, 1), (1, 0), (1, 0), (0, -1), (0, -1)])
    return _turned(ends, normals, sides)


def _box(half):
    """A box of these half sides (3,) [m]."""
    vertices, normals, faces = [], [], []
    for axis in range(3):
        for side in (-1, 1):
            u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
            out = side * np.eye(3)[axis]
            first = len(vertices)
            vertices += [half * (out + a * u + b * v) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            normals += 4 * [out]
            faces += [first + np.array(corners) for corners in ([(0, 1, 2), (0, 2, 3)] if side > 0 else [(0, 2, 1), (0, 3, 2)])]
    return np.array(vertices), np.array(normals), np.array(faces)


def _turned(profile, normals, sides):
    """The surface of a profile (P, 2), distances from the axis and places on it, that is turned about z, with its normals (P, 2)."""
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    vertices, directions = (
        np.concatenate([np.multiply.outer(circle, each[:, 0]).swapaxes(1, 2), np.broadcast_to(each[:, 1:], (sides, len(each), 1))], axis=2)
        for each in (profile, normals)
    )
    number = np.arange(sides * len(profile)).reshape(sides, -1)
    a, b = number[:, :-1], np.roll(number, -1, axis=0)[:, :-1]
    faces = np.concatenate([np.stack([a, a + 1, b], axis=-1), np.stack([b, a + 1, b + 1], axis=-1)]).reshape(-1, 3)
    return vertices.reshape(-1, 3), directions.reshape(-1, 3), faces
