"""The surface of an object as a page holds it: integers in one compressed block, which `page/unpack.js` unpacks.

Places have 20 bits along each side of the box: their error is 5e-7 of the side at most, below a pixel at any zoom that the page allows.
Normals have 12 bits on each side of an octahedron (0.03 degrees, below a step of grey), tints the 8 bits that screens have. Vertices are
sorted along a curve that fills the box, and triangles by their vertices, so that neighbours have close numbers with small differences.
"""

import base64
import gzip
from typing import Any

import numpy as np

from softffd.embedding.basis import parameter
from softffd.lattice import bounding_box
from softffd.mesh.normals import split_at_creases
from softffd.show.stage import Stage
from softffd.show.tension import AtlasPlaces

PLACE_BITS, NORMAL_BITS = 20, 12


def surface(stage: Stage, taxels: AtlasPlaces | None = None) -> dict[str, Any]:
    """Returns the packed arrays of a stage's W vertices and F triangles: parameters, normals, tints, places in pictures and, with
    `taxels`, places in their atlas; three numbers per triangle.

    Triangles with one picture are consecutive: `parts` are pairs of a picture's number and the number of its triangles.
    """
    source, normals, faces = split_at_creases(stage.vertices, stage.faces)
    places = zip(((stage.vertices[source] - stage.origin) / stage.size).T, stage.counts, strict=True)
    coordinates, scales = _whole(np.stack([parameter(t, n, stage.basis) for t, n in places], axis=1))
    order = np.argsort(_along_a_curve(coordinates), kind="stable")
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    faces, picture = number[faces], stage.skin.picture_of
    faces = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)  # smallest index first, winding unchanged
    sequence = np.lexsort((faces[:, 2], faces[:, 1], faces[:, 0], picture))
    faces, (pictures, counts) = faces[sequence], np.unique(picture, return_counts=True)
    uv, uv_scales = _whole(stage.skin.uv[source] if stage.skin.pictures else np.zeros((len(source), 2)))
    arrays = {
        "coordinates": coordinates[order],
        "normals": _on_octahedron(normals[order]),
        "tints": (stage.skin.tints[source[order]] * 255.0).round().astype(np.int64),
        "uv": uv[order],
    }
    held, atlas_scales = _whole(taxels.of(source, normals)) if taxels else (np.zeros((len(source), 0), dtype=np.int64), [])
    arrays["atlas"] = held[order]
    columns = [np.diff(column, prepend=0) for each in arrays.values() for column in each.T]
    columns += [np.diff(faces[:, 0], prepend=0), faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]]
    scaled = {"scales": scales, "uv_scales": uv_scales} | ({"atlas_scales": atlas_scales} if taxels else {})
    return {**scaled, "parts": np.stack([pictures, counts], axis=1).tolist(), **_block(columns)}


def _whole(values: np.ndarray) -> tuple[np.ndarray, list[list[float]]]:
    """Returns values (N, K) as integers of 20 bits, and for each of the K columns the value that 0 means and the step between integers."""
    low, high = bounding_box(values)
    step = np.where(high > low, high - low, 1.0) / (2**PLACE_BITS - 1)
    return ((values - low) / step).round().astype(np.int64), np.stack([low, step], axis=1).tolist()


def _along_a_curve(places: np.ndarray) -> np.ndarray:
    """Returns the Morton numbers (N,) of places (N, 3) of up to 21 bits: the bits of the three coordinates in turn."""
    bits = np.unpackbits(places[:, ::-1].astype(">u4").view(np.uint8).reshape(-1, 3, 4), axis=2)
    in_turn = bits.transpose(0, 2, 1).reshape(-1, 96)
    return np.packbits(in_turn[:, -64:], axis=1).view(">u8")[:, 0]


def _on_octahedron(normals: np.ndarray) -> np.ndarray:
    """Returns unit normals (N, 3) as integers (N, 2) on the unfolded octahedron (Cigolle et al. 2014); a zero normal becomes the middle."""
    size = np.abs(normals).sum(axis=1, keepdims=True)
    flat = normals / np.where(size > 0, size, 1.0)
    folded = (1 - np.abs(flat[:, 1::-1])) * np.where(flat[:, :2] < 0, -1.0, 1.0)
    place = np.where(flat[:, 2:] < 0, folded, flat[:, :2])
    return (place * (2 ** (NORMAL_BITS - 1) - 1)).round().astype(np.int64)


def _block(columns: list[np.ndarray]) -> dict[str, Any]:
    """Returns columns of signed integers as bytes, of each column all lowest bytes, then the next; and the columns' lengths and bytes."""
    planes, pieces = [], []
    for column in columns:
        number = np.where(column < 0, -2 * column - 1, 2 * column).astype("<u4")
        count = max(1, (int(number.max(initial=0)).bit_length() + 7) // 8)
        planes.append([len(column), count])
        pieces += [(number >> np.uint32(8 * k)).astype(np.uint8).tobytes() for k in range(count)]
    return {"columns": planes, "block": base64.b64encode(gzip.compress(b"".join(pieces), 6, mtime=0)).decode("ascii")}
