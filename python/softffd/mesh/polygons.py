"""What a mesh file holds, polygons with their texture coordinates apart, and how triangles are made of it."""

from __future__ import annotations

import os
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from softffd.errors import MeshError
from softffd.mesh.ears import cut_concave
from softffd.mesh.looks import PLAIN, Looks, Picture


class Triangles(NamedTuple):
    """What every reader returns: vertices (V, 3), faces (F, 3), uv (V, 2) or None, looks."""

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None = None
    looks: Looks = PLAIN


def assemble(
    positions: np.ndarray,
    corners: ArrayLike,
    counts: ArrayLike,
    *,
    texels: np.ndarray | None = None,
    texel_corners: ArrayLike | None = None,
    looks: Looks = PLAIN,
) -> Triangles:
    """Return triangles that share a vertex where position and texture coordinate are the same.

    positions: (P, 3). corners: (C,) indices of positions, one polygon after another. counts: (F,) corners of
    each, >= 3. texels: (Q, 2) texture coordinates and texel_corners: (C,) indices of them, or both None.
    looks: of the polygons and positions.
    A polygon of c corners becomes c - 2 triangles: a fan about its first corner where that covers it, else ears.
    The vertices keep the order of `positions`.
    """
    sizes, places = np.asarray(counts, dtype=np.int64), np.asarray(corners, dtype=np.int64)
    fans, crossed = _fans(sizes), 0
    if (sizes > 3).any():
        fans, crossed = cut_concave(positions[places], sizes, fans)
    looks = looks.with_faces(np.repeat(np.arange(len(sizes)), sizes - 2))
    if crossed:
        looks = looks.and_notes(f"polygons that cross themselves: {crossed}; what of them is filled is a guess")
    if texels is None:
        return Triangles(positions, places[fans], None, looks)
    pairs = places * len(texels) + np.asarray(texel_corners, dtype=np.int64)
    pairs, vertex_of_corner = np.unique(pairs, return_inverse=True)
    vertices, uv = positions[pairs // len(texels)], texels[pairs % len(texels)]
    return Triangles(vertices, vertex_of_corner[fans], uv, looks.with_vertices(pairs // len(texels)))


def plain_text(data: bytes) -> bytes:
    """A text without its byte order mark; one in UTF-16 becomes UTF-8."""
    if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        return data.decode("utf-16", errors="replace").encode()
    return data.removeprefix(BOM_UTF8)


def decoded(name: bytes) -> str:
    """A name in UTF-8, else in Latin-1, which has a letter for every byte."""
    try:
        return name.decode()
    except UnicodeDecodeError:
        return name.decode("latin-1")


def beside(folder: Path, name: str) -> Path | None:
    """The file that a mesh in the folder names; None where that lies neither in the folder nor below it."""
    file = Path(os.path.normpath(folder / name.replace("\\", "/")))
    return file if "\0" not in name and file.is_relative_to(os.path.normpath(folder)) else None


def open_texture(file: Path) -> Picture | None:
    """Return the image, or None where it is missing or damaged: a mesh without its picture still deforms."""
    from PIL import Image  # only files with a texture pay for the import

    try:
        with Image.open(file) as image:
            image.load()
            return image.copy()
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return None


def first_outside(indices: np.ndarray, count: int) -> int:
    """Return the place of the first index that is not one of `count`, or -1."""
    wrong = (indices < 0) | (indices >= count)
    return int(wrong.argmax()) if wrong.any() else -1


def damaged(path: Path, fault: str) -> MeshError:
    """Return the error for a file that contradicts itself; `fault` says where and how."""
    kind = path.suffix[1:].upper()
    return MeshError(f"{path}: damaged or cut off: {fault}. Wanted a complete {kind} file; export it again.")


def _fans(counts: np.ndarray) -> np.ndarray:
    """Corner numbers of the triangles of all polygons, shape (T, 3)."""
    each = counts - 2
    first = np.repeat(np.cumsum(counts) - counts, each)
    step = np.arange(len(first)) - np.repeat(np.cumsum(each) - each, each)
    return np.stack([first, first + step + 1, first + step + 2], axis=1)
