"""The car that the demonstration deforms. The car is made of formulas, so that the project needs no third-party model.

The shipped car.obj is written from this mesh by `save_mesh`. The body is a loft (car_body.py); wheels, lamps and mirrors are
closed solids of revolution. A colour is a position in a small palette image, with one texture coordinate for each face.
"""

import numpy as np
from PIL import Image

from softffd.lattice import bounding_box
from softffd.mesh.mesh import Mesh
from validation.car_body import AXLE_X, AXLE_Z, body, cells

LENGTH, WIDTH, HEIGHT = 4.0, 1.7, 1.4
"""Bounding box, m."""

PALETTE = {
    "paint": (198, 40, 40),
    "glass": (40, 54, 70),
    "tyre": (36, 36, 38),
    "rim": (192, 196, 202),
    "trim": (60, 60, 64),
    "lamp": (255, 244, 206),
    "tail": (255, 122, 70),
}

Part = tuple[np.ndarray, np.ndarray, list[str]]
"""Vertices, faces, and the colour of each face"""
_TREAD = [(0.275, -0.10), (0.303, -0.075), (0.31, -0.03), (0.31, 0.03), (0.303, 0.075), (0.275, 0.10)]
_TYRE = [(0.0, -0.10), (0.20, -0.10), *_TREAD, (0.215, 0.095)]
_RIM = [(0.20, 0.06), (0.09, 0.05), (0.06, 0.085), (0.0, 0.09)]
"""Section of a wheel from inside to outside: (radius, position along the axle)."""


def car_mesh() -> Mesh:
    """Returns the car: 4 m long, 1.7 m wide and 1.4 m high, with its front at +x and its wheels on z = 0.

    The car is centred in x and y and has about 4,500 vertices (4,000 positions). Every part is a closed surface, so the whole
    has a volume. The coordinates are rounded to 0.1 mm.
    """
    parts = [body(), *_wheels(), *_fittings()]
    starts = np.cumsum([0, *(len(vertices) for vertices, _, _ in parts)])
    vertices = _fitted(np.vstack([vertices for vertices, _, _ in parts]))
    faces = np.vstack([faces + start for (_, faces, _), start in zip(parts, starts, strict=False)])
    return _coloured(np.round(vertices, 4), faces, [name for _, _, names in parts for name in names])


def _fitted(vertices: np.ndarray) -> np.ndarray:
    """Returns the vertices scaled, by at most two hundredths, to the stated bounding box."""
    low, high = bounding_box(vertices)
    return (vertices - low) / (high - low) * [LENGTH, WIDTH, HEIGHT] - [LENGTH / 2, WIDTH / 2, 0.0]


def _coloured(vertices: np.ndarray, faces: np.ndarray, names: list[str]) -> Mesh:
    """Returns the mesh with the palette as texture. A vertex where colours meet is duplicated for each colour."""
    n = len(PALETTE)
    place = {name: number for number, name in enumerate(PALETTE)}
    colours = np.array([place[name] for name in names])
    pairs, index = np.unique(faces * n + colours[:, None], return_inverse=True)
    uv = np.stack([np.round((pairs % n + 0.5) / n, 4), np.full(len(pairs), 0.5)], axis=1)
    swatches = np.array([list(PALETTE.values())], dtype=np.uint8).repeat(16, axis=1).repeat(16, axis=0)
    return Mesh(vertices[pairs // n], index.reshape(-1, 3), uv, "car", Image.fromarray(swatches))


def _wheels() -> list[Part]:
    tyre, rim = ["tyre"] * (len(_TYRE) - 1), ["rim"] * len(_RIM)
    vertices, faces, names = _revolved(_TYRE + _RIM, tyre + rim, segments=20)
    wheels = []
    for x in (AXLE_X, -AXLE_X):
        left = vertices + np.array([x, 0.70, AXLE_Z])
        wheels += [(left, faces, names), (left * [1, -1, 1], faces[:, ::-1], names)]
    return wheels


def _fittings() -> list[Part]:
    """Returns headlamps and mirrors, which are ellipsoids set into the body."""
    arc = [(np.sin(t), -np.cos(t)) for t in np.linspace(0, np.pi, 8)]
    vertices, faces, _ = _revolved(arc, ["paint"] * 7, segments=12)
    shapes = [
        ([1.985, 0.50, 0.525], [0.07, 0.105, 0.07], "lamp"),
        ([0.60, 0.80, 0.945], [0.045, 0.085, 0.055], "paint"),
    ]
    return [
        (vertices * radii + np.array(centre) * [1, side, 1], faces, [name] * len(faces))
        for centre, radii, name in shapes
        for side in (1, -1)
    ]


def _revolved(profile: list[tuple[float, float]], colours: list[str], *, segments: int) -> Part:
    """Returns a closed solid of revolution about y. `profile` runs from pole to pole, with a colour for each step."""
    radii, places = np.array(profile).T
    angles = 2 * np.pi * np.arange(segments) / segments
    x, z = np.outer(radii, np.sin(angles)), np.outer(radii, -np.cos(angles))
    rings = np.stack(np.broadcast_arrays(x, places[:, None], z), axis=-1)
    index = np.arange(rings.shape[0] * segments).reshape(-1, segments)
    index[0], index[-1] = index[0, 0], index[-1, 0]
    drawn = np.array(colours, dtype=object)[:, None].repeat(segments, axis=1)
    return rings.reshape(-1, 3), *cells(index[:, ::-1], drawn, closed=True)
