"""OFF, text: vertices, then polygons, either with colours.

trimesh is not used, since it reads a file that is cut off as a smaller mesh, and ignores colours.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from softffd.mesh.looks import PLAIN, Looks, as_shares, from_face_colours
from softffd.mesh.polygons import Triangles, assemble, damaged, plain_text

_KIND = re.compile(rb"(ST)?(C)?(N)?(4)?(n)?(?:OFF|off)(?=[\s\d])")


def read_off(path: Path, data: bytes) -> Triangles:
    """Returns the triangles of an OFF file with one record a line, with its colours (COFF, or numbers after a polygon).

    Raises MeshError if the file ends early, has wrong numbers, or has a face that refers to no vertex.
    """
    try:
        return _triangles(re.sub(rb"#[^\n\r]*", b"", plain_text(data)).lstrip())
    except ValueError as fault:
        raise damaged(path, str(fault)) from None


def _triangles(text: bytes) -> Triangles:
    kind = _KIND.match(text)
    if kind is None or kind[4] or kind[5] or b"BINARY" in text[:20]:
        raise ValueError("wanted a text whose first word is OFF, or COFF with colours of vertices")
    rows = [line.split() for line in text[kind.end() :].splitlines() if line.strip()]
    counts = _whole(_numbers(rows[:1] or [[]], 0, 2, "the numbers of vertices and of faces"))[0]
    vertices, faces = rows[1 : counts[0] + 1], rows[counts[0] + 1 : counts.sum() + 1]
    if len(rows) < counts.sum() + 1:
        raise ValueError(f"it promises {counts[0]} vertices and {counts[1]} faces, but ends after {len(rows) - 1} lines of them")
    positions = _numbers(vertices, 0, 3, "the coordinates of each vertex")
    sizes = _whole(_numbers(faces, 0, 1, "the number of corners of a face"))[:, 0]
    corners = [_numbers([row], 1, size, "the corners of each face")[0] for row, size in zip(faces, sizes.tolist(), strict=True)]
    corners = np.nan_to_num(np.concatenate([np.zeros(0), *corners]), nan=-1, posinf=-1).astype(np.int64)
    looks = _face_looks([row[size + 1 :] for row, size in zip(faces, sizes, strict=True)])
    if kind[2]:
        skipped = 6 if kind[3] else 3
        looks = replace(looks, colours=as_shares(_numbers(vertices, skipped, 3, "the colour of each vertex")))
    return assemble(positions, corners, sizes, looks=looks)


def _face_looks(words: list[list[bytes]]) -> Looks:
    """Reads colours of three or four numbers after a face; other faces are white. One number would be an index into an unknown table."""
    coloured = [number for number, row in enumerate(words) if len(row) in (3, 4)]
    if not coloured:
        return PLAIN
    colours = np.ones((len(words), 3))
    colours[coloured] = as_shares(_numbers([words[number] for number in coloured], 0, 3, "the colour of a face"))
    return from_face_colours(colours)


def _whole(numbers: np.ndarray) -> np.ndarray:
    """Returns the numbers as integers. Raises ValueError if one is no whole number >= 0."""
    if not ((numbers >= 0) & (numbers < 2**40) & (numbers == np.round(numbers))).all():
        raise ValueError("a count is no whole number from 0 on")
    return numbers.astype(np.int64)


def _numbers(rows: list[list[bytes]], start: int, count: int, what: str) -> np.ndarray:
    try:
        return np.array([[float(word) for word in row[start : start + count]] for row in rows]).reshape(len(rows), count)
    except (ValueError, OverflowError):
        raise ValueError(f"{what}: wanted {count} numbers, in every row") from None
