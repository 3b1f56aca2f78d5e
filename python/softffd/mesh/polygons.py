"""Triangles from the contents of a mesh file, which are polygons with separate texture coordinates; files beside a mesh."""

import os
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote

import numpy as np
from numpy.typing import ArrayLike

from softffd.errors import MeshError
from softffd.mesh.looks import PLAIN, Looks, Picture
from softffd.mesh.normals import area_vectors

SMALL = 1e-9
"""A smaller area, as a fraction of that of the polygon, counts as zero."""


class Triangles(NamedTuple):
    """The result of every reader: vertices (V, 3), faces (F, 3), uv (V, 2) or None, looks."""

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray | None = None
    looks: Looks = PLAIN

    def and_notes(self, *notes: str) -> "Triangles":
        return self._replace(looks=self.looks.and_notes(*notes))


def assemble(
    positions: np.ndarray, corners: ArrayLike, counts: ArrayLike, *, texels: np.ndarray | None = None,
    texel_corners: ArrayLike | None = None, looks: Looks = PLAIN, called: Callable[[int], str] = "face {} (from 0)".format, first: int = 0,
) -> Triangles:  # fmt: skip
    """Returns triangles; corners with equal position index and texture coordinate index share a vertex.

    positions: (P, 3). corners: (C,) indices of positions, one polygon after another. counts: (F,) corners of each polygon, >= 3.
    texels: (Q, 2) texture coordinates and texel_corners: (C,) indices of texels, or both None. looks: of the polygons and positions.
    For messages: called(n) names the n-th polygon in the file, and first is the number of the first record of the file.
    Raises ValueError if a polygon has fewer than three corners, or refers to a missing vertex or texture coordinate.
    A polygon of c corners becomes c - 2 triangles: a fan about its first corner if the fan covers the polygon, else ears.
    The vertices keep the order of `positions`.
    """
    sizes, places = np.asarray(counts, dtype=np.int64), np.asarray(corners, dtype=np.int64)
    if (sizes < 3).any():
        raise ValueError(f"{called(int((sizes < 3).argmax()))} has fewer than 3 corners")

    def require(what: str, indices: np.ndarray, count: int) -> None:
        wrong = np.flatnonzero((indices < 0) | (indices >= count))
        if len(wrong):
            name = called(int(np.searchsorted(np.cumsum(sizes), wrong[0], side="right")))
            raise ValueError(f"{name} refers to {what} {indices[wrong[0]] + first} (from {first}), but there are {count}")

    require("vertex", places, len(positions))
    fans, crossed = _fans(sizes), 0
    if (sizes > 3).any():
        fans, crossed = _cut_concave(positions[places], sizes, fans)
    looks = looks.with_faces(np.repeat(np.arange(len(sizes)), sizes - 2))
    if crossed:
        looks = looks.and_notes(f"polygons that cross themselves: {crossed}; what of them is filled is a guess")
    if texels is None:
        return Triangles(positions, places[fans], None, looks)
    texel_places = np.asarray(texel_corners, dtype=np.int64)
    require("texture coordinate", texel_places, len(texels))
    pairs = places * len(texels) + texel_places
    pairs, vertex_of_corner = np.unique(pairs, return_inverse=True)
    vertices, uv = positions[pairs // len(texels)], texels[pairs % len(texels)]
    return Triangles(vertices, vertex_of_corner[fans], uv, looks.with_vertices(pairs // len(texels)))


def plain_text(data: bytes) -> bytes:
    """Returns a text without its byte order mark; a text in UTF-16 is converted to UTF-8."""
    if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        return data.decode("utf-16", errors="replace").encode()
    return data.removeprefix(BOM_UTF8)


def decoded(name: bytes) -> str:
    """Decodes a name from UTF-8, else from Latin-1, which has a character for every byte."""
    try:
        return name.decode()
    except UnicodeDecodeError:
        return name.decode("latin-1")


def beside(folder: Path, name: str) -> Path | None:
    """Returns the path of a file that a mesh in the folder names; None if the path lies neither in the folder nor below it."""
    file = Path(os.path.normpath(folder / name.replace("\\", "/")))
    return file if "\0" not in name and file.is_relative_to(os.path.normpath(folder)) else None


def found_beside(folder: Path, name: str, *, anywhere: bool = False) -> Path | None:
    """Returns the path of `beside` if the file exists under its name or its URL-decoded name (%20 for a blank), else None. With `anywhere`
    the last part of the name, without its folders, is tried instead of the decoded name."""
    names = (name, name.replace("\\", "/").rpartition("/")[2]) if anywhere else (name, unquote(name))
    files = (beside(folder, each) for each in names)
    return next((file for file in files if file is not None and file.is_file()), None)


def open_texture(file: Path) -> Picture | None:
    """Returns the image, or None if it is missing or damaged: a mesh without its picture can still be deformed."""
    from PIL import Image  # imported only for files with a texture

    try:
        with Image.open(file) as image:
            image.load()
            return image.copy()
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return None


def damaged(path: Path, fault: str) -> MeshError:
    """Returns the error for a damaged or inconsistent file; `fault` says where and how."""
    kind = path.suffix[1:].upper()
    return MeshError(f"{path}: damaged or cut off: {fault}. Wanted a complete {kind} file; export it again.")


def _fans(counts: np.ndarray) -> np.ndarray:
    """Returns the corner numbers (T, 3) of the triangles of the fans of all polygons."""
    each = counts - 2
    first = np.repeat(np.cumsum(counts) - counts, each)
    step = np.arange(len(first)) - np.repeat(np.cumsum(each) - each, each)
    return np.stack([first, first + step + 1, first + step + 2], axis=1)


def _cut_concave(positions: np.ndarray, counts: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, int]:
    """Returns the triangles (T, 3) of all polygons, and the number of polygons that cross themselves, so that no cutting covers them.

    positions: (C, 3) of the corners, one polygon after another. counts: (F,) corners of each polygon. triangles: (T, 3) corner numbers of
    the fans. A fan is kept if all its triangles point the way of the polygon, since their areas then sum to its area; fans of polygons
    without area or with non-finite corners are kept too. Other polygons are cut into ears; for n corners this may take n^2 time.
    """
    each = counts - 2
    many = np.flatnonzero(np.repeat(each > 1, each))
    owner, areas = np.repeat(np.arange(len(counts)), each)[many], area_vectors(positions[triangles[many]])
    whole = np.stack([np.bincount(owner, axis, len(counts)) for axis in areas.T], axis=1)
    against = np.einsum("ij,ij->i", areas, whole[owner]) < -SMALL * np.einsum("ij,ij->i", whole, whole)[owner]
    first, begins, crossed = np.cumsum(counts) - counts, np.cumsum(each) - each, 0
    for polygon in np.unique(owner[against]):
        corners = positions[first[polygon] : first[polygon] + counts[polygon]]
        ears, sound = _ears(_seen_along(whole[polygon], corners))
        crossed += not sound
        triangles[begins[polygon] : begins[polygon] + each[polygon]] = first[polygon] + np.array(ears)
    return triangles, crossed


def _seen_along(normal: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Projects the corners onto a plane, (n, 2), in which they run counter-clockwise; the result is scaled to sides of order 1."""
    normal = normal / np.linalg.norm(normal)
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    across /= np.linalg.norm(across)
    places = (corners - corners[0]) @ np.stack([across, np.cross(normal, across)], axis=1)
    return places / np.abs(places).max()


def _ears(places: np.ndarray) -> tuple[list[tuple[int, int, int]], bool]:
    """Returns the triangles of the polygon, and whether each triangle was an ear: it turns left and no corner lies inside it.

    If no ear is left, corners without area are cut first (spikes, and ends of bridges to holes), then the corner that turns left the most.
    """
    n = len(places)
    after, before, here = [*range(1, n), 0], [n - 1, *range(n - 1)], np.ones(n, dtype=bool)
    turn = _turns(places[before], places, places[after])
    least = SMALL * np.abs(turn).sum()
    ears = {i for i in range(n) if _is_ear(i, before, after, places, turn, here, least)}
    triangles: list[tuple[int, int, int]] = []
    sound, corner = True, 0
    while len(triangles) < n - 2:
        if ears:
            while corner not in ears:
                corner = (corner + 1) % n
        else:
            left = np.flatnonzero(here)
            flat = left[np.abs(turn[left]) <= least]
            corner = int(flat[0]) if len(flat) else int(left[turn[left].argmax()])
            sound &= len(flat) > 0
        a, c = before[corner], after[corner]
        triangles.append((a, corner, c))
        here[corner], after[a], before[c] = False, c, a
        ears.discard(corner)
        for end in (a, c):
            turn[end] = _turns(places[before[end]], places[end], places[after[end]])
        for end in (a, c):
            (ears.add if _is_ear(end, before, after, places, turn, here, least) else ears.discard)(end)
        corner = after[c]  # skips the neighbour; otherwise a circle would become a fan of slivers
    return triangles, sound


def _is_ear(corner: int, before: list[int], after: list[int], places: np.ndarray, turn: np.ndarray, here: np.ndarray, least: float) -> bool:
    a, b, c = places[before[corner]], places[corner], places[after[corner]]
    if turn[corner] <= least:
        return False
    other = here & (places != a).any(axis=1) & (places != b).any(axis=1) & (places != c).any(axis=1)
    points, straight = places[other], turn[other] <= least
    inside = np.minimum(np.minimum(_turns(a, b, points), _turns(b, c, points)), _turns(c, a, points))
    return not ((inside > least) | (straight & (inside >= -least))).any()


def _turns(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Returns twice the signed areas of the triangles, > 0 where they turn left."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])
