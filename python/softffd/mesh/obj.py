"""Wavefront OBJ: runs of similar records are read at once, all other records line by line.

trimesh is not used, since it takes index 0 for vertex 1, counts relative indices from the end of the file, ignores faces of two corners
and unknown lines, and splits vertices by their normals.
"""

import sys
from array import array
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TypeVar

import numpy as np

from softffd.mesh.looks import Group, Looks, as_shares
from softffd.mesh.mtl import Library, without_comment
from softffd.mesh.polygons import Triangles, assemble, damaged, decoded, plain_text


def read_obj(path: Path, data: bytes) -> Triangles:
    """Returns the triangles of an OBJ file, with materials, groups, and colours of vertices (six numbers after `v`).

    Corners without texture coordinates get (0, 0) if other corners have some. Raises MeshError with the line of the fault.
    """
    records, number = _Records(path), 1
    data = plain_text(data).removesuffix(b"\0").removesuffix(b"\x1a")
    lines = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines()
    for key, run in groupby(lines, lambda line: line.partition(b" ")[0]):
        same = list(run)
        if not records.read_alike(key, number, same):
            for place, line in enumerate(same, number):
                records.read_line(place, line)
        number += len(same)
    return records.triangles()


T = TypeVar("T")

_NAMING = {b"mtllib", b"usemtl", b"o", b"g"}
"""Records in which the rest of the line is a name, which may contain `#` and blanks."""

_FACE = bytes.maketrans(b"f/", b"0 ")
"""Turns the text of faces into numbers: each face begins with 0, which is no valid index."""

_MARKS = {bytes([mark]) for mark in b"$!%&*;@~"}
"""Lines that begin with one of these characters are comments of other programs."""


class _Records:
    """The records read so far. Stored indices count from 0; a corner without texture coordinates has -1."""

    def __init__(self, path: Path):
        self.path = path
        self.vertices, self.texels = array("d"), array("d")  # flat: three numbers for each vertex, two for each texel
        self.corners: list[int] = []
        self.texel_corners: list[int] = []
        self.counts: list[int] = []
        self.face_lines: list[int] = []
        self.colours: dict[int, list[float]] = {}
        self.library = Library(path.parent)
        self.passed_over: list[int] = []
        self.material, self.group = "", Group()  # apply to the faces that follow
        self.materials: list[str] = []
        self.groups: list[Group] = []

    def _name(self, key: bytes, rest: str) -> None:
        name = " ".join(rest.split())
        if key == b"mtllib":
            self.library.read(rest)
        elif key == b"usemtl":
            self.material = name
        elif key == b"o":
            self.group = Group(object=without_comment(name))
        else:
            self.group = self.group._replace(group=without_comment(name))

    def read_alike(self, key: bytes, first: int, lines: list[bytes]) -> bool:
        """Reads lines of one key at once, which start at line `first`. Returns False, with nothing read, if their forms differ."""
        if key == b"f":
            return self._read_faces(first, lines)
        if key not in (b"v", b"vt") or (rows := _rows(lines, 3 if key == b"v" else 2)) is None:
            return key == b"vn"
        if key == b"vt":
            self.texels.frombytes(rows[:, :2].tobytes())
            return True
        if rows.shape[1] in (6, 7):
            self.colours.update(enumerate(rows[:, 3:6].tolist(), len(self.vertices) // 3))
        self.vertices.frombytes(rows[:, :3].tobytes())
        return True

    def _read_faces(self, first: int, lines: list[bytes]) -> bool:
        """Reads faces whose corners all have one form: "1", "1/1", "1//1" or "1/1/1". Returns False, with nothing read, otherwise."""
        text = b" ".join(lines)
        marks, corners = text.translate(None, b"0123456789").split(), len(text.split()) - len(lines)
        slashes = {*marks} - {b"f"}
        if slashes not in (set(), {b"/"}, {b"//"}) or len(marks) - len(lines) not in (0, corners):
            return False
        numbers, double = np.fromstring(text.translate(_FACE), dtype=np.int64, sep=" "), text.count(b"//")
        each = 1 + len(b"".join(slashes)) - (double > 0)
        starts = np.flatnonzero(numbers == 0)
        counts = (np.diff(starts, append=len(numbers)) - 1) // each
        if len(starts) != len(lines) or len(numbers) - len(lines) != each * corners or double not in (0, corners) or counts.min() < 3:
            return False
        if numbers.max() == np.iinfo(np.int64).max:
            return False
        table = numbers[numbers > 0].reshape(corners, each) - 1
        self.corners += table[:, 0].tolist()
        self.texel_corners += [-1] * corners if each == 1 or double else table[:, 1].tolist()
        self._add_faces(range(first, first + len(lines)), counts.tolist())
        return True

    def _add_faces(self, lines: Sequence[int], counts: list[int]) -> None:
        self.counts += counts
        self.face_lines += lines
        self.materials += [self.material] * len(counts)
        self.groups += [self.group] * len(counts)

    def read_line(self, number: int, line: bytes) -> None:
        key, *rest = line.split(None, 1)[:2] or [b"#"]
        if key in _NAMING:
            self._name(key, decoded(b"".join(rest)).strip())
        elif words := line.partition(b"#")[0].split():
            self._read(number, words)

    def _read(self, number: int, words: list[bytes]) -> None:
        key = words[0]
        try:
            if key == b"v":
                if len(words) in (7, 8):  # the last of 8 words is the opacity
                    self.colours[len(self.vertices) // 3] = _numbers(words[4:7], 3)
                self.vertices.extend(_numbers(words[1:4], 3))
            elif key == b"f":
                self._read_face(number, words[1:])
            elif key == b"vt":
                self.texels.extend([*_numbers(words[1:3], 1), 0.0][:2])
            elif key[:1] in _MARKS and decoded(b" ".join(words)).isprintable():
                self.passed_over.append(number)
            elif not key.replace(b"_", b"").isalnum() or key[:1].isdigit():
                raise ValueError("no record of an OBJ file starts like this")
        except (ValueError, OverflowError) as fault:
            text = b" ".join(words)[:60].decode(errors="replace")
            raise damaged(self.path, f"line {number}, {text!r}: {fault}") from None

    def _read_face(self, number: int, words: list[bytes]) -> None:
        if len(words) < 3:
            raise ValueError(f"a face needs at least 3 corners, this one has {len(words)}")
        for word in words:
            vertex, _, rest = word.partition(b"/")
            texel = rest.partition(b"/")[0]
            self.corners.append(_from_zero(vertex, len(self.vertices) // 3))
            self.texel_corners.append(_from_zero(texel, len(self.texels) // 2) if texel else -1)
        self._add_faces([number], [len(words)])

    def triangles(self) -> Triangles:
        positions, corners = np.array(self.vertices).reshape(-1, 3), np.array(self.corners, dtype=np.int64)
        texels = texel_corners = None
        if self.texels:
            texels, texel_corners = np.array(self.texels).reshape(-1, 2), np.array(self.texel_corners, dtype=np.int64)
            if (texel_corners < 0).any():
                texel_corners[texel_corners < 0] = len(texels)
                texels = np.vstack([texels, [0.0, 0.0]])
        try:
            return assemble(
                positions, corners, self.counts, texels=texels, texel_corners=texel_corners, looks=self._looks(),
                called=lambda face: f"line {self.face_lines[face]}: a face", first=1,
            )  # fmt: skip
        except ValueError as fault:
            raise damaged(self.path, str(fault)) from None

    def _looks(self) -> Looks:
        names, material_of = _numbered(self.materials, "")
        groups, group_of = _numbered(self.groups, Group())
        looks = Looks(self.library.materials(names), material_of, self._vertex_colours(), groups, group_of, tuple(self.library.notes))
        if not self.passed_over:
            return looks
        return looks.and_notes(f"lines that are no records of OBJ: {len(self.passed_over)}, the first is line {self.passed_over[0]}")

    def _vertex_colours(self) -> np.ndarray | None:
        """Returns colours (V, 3), 0 .. 1, white for vertices without a colour, or None; files may also count 0 .. 255."""
        if not self.colours:
            return None
        colours = np.ones((len(self.vertices) // 3, 3))
        colours[list(self.colours)] = as_shares(list(self.colours.values()))
        return colours


def _numbered(values: list[T], nothing: T) -> tuple[tuple[T, ...], np.ndarray | None]:
    """Returns the distinct values in order of appearance, and the index of each value; ((), None) if all values are `nothing`."""
    numbers: dict[T, int] = {}
    index = np.array([numbers.setdefault(value, len(numbers)) for value in values], dtype=np.int64)
    return (tuple(numbers), index) if set(numbers) - {nothing} else ((), None)


def _rows(lines: list[bytes], least: int) -> np.ndarray | None:
    """Returns the numbers after the key of each line, (lines, >= least); None if the lines differ, or have words that are no numbers."""
    words = b" ".join(lines).split()
    each = len(words) // len(lines)
    if len(words) % len(lines) or each <= least or len({*words[::each]}) > 1:
        return None
    del words[::each]
    try:
        return np.array(list(map(float, words))).reshape(len(lines), each - 1)
    except ValueError:
        return None


def _numbers(words: list[bytes], least: int) -> list[float]:
    if len(words) < least:
        raise ValueError(f"wanted {least} numbers, got {len(words)}")
    try:
        return [float(word) for word in words]
    except ValueError:
        raise ValueError("wanted numbers") from None


def _from_zero(word: bytes, count: int) -> int:
    """Returns the index from 0 of a reference that counts from 1, or backwards (< 0) from the end of the `count` records read so far."""
    try:
        index = int(word)
    except ValueError:
        raise ValueError("wanted corners as in 'f 1 2 3' or 'f 1/1 2/2 3/3'") from None
    if index == 0 or index < -count:
        raise ValueError(f"a face refers to record {index}; wanted 1 and up, or -1 down to -{count}")
    if index > sys.maxsize:
        raise ValueError("a face refers to a record beyond all files")
    return index - 1 if index > 0 else count + index
