"""PLY, text and binary: the header says what follows, and is held to its word.

Read here and not by trimesh, which takes faces that refer to no vertex, and numbers that the header does not
announce, without a word, and gives up on binary files that mix triangles with other polygons.
"""

from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

import numpy as np

from softffd.mesh.polygons import Triangles, assemble, damaged, first_outside, open_texture

_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "int64": "i8", "uint64": "u8", "float": "f4", "double": "f8", "float32": "f4", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_BYTES = {type_: int(type_[1]) for type_ in _TYPES.values()}
_TOO_SHORT = "the file ends within the data that the header promises"
_UV_NAMES = [("s", "t"), ("u", "v"), ("texture_u", "texture_v")]


class _Property(NamedTuple):
    name: str
    type: str
    count_type: str | None


class _Element(NamedTuple):
    name: str
    records: int
    properties: list[_Property]


class _Header(NamedTuple):
    order: str
    elements: list[_Element]
    texture: str | None


class _Lists(NamedTuple):
    """A list property of all records: `counts` (N,) and the `values` of all of them one after another."""

    counts: np.ndarray
    values: np.ndarray


def read_ply(path: Path, data: bytes) -> Triangles:
    """Return the triangles of a PLY file, with the texture coordinates of vertices or of faces' corners.

    Raises MeshError where the data are fewer or more than the header says, or a face refers to no vertex.
    """
    try:
        header, body = _read_header(data)
        reader = _TextBody(body) if header.order == "" else _BinaryBody(body, header.order)
        records = {element.name: _read_element(reader, element) for element in header.elements}
        reader.require_end()
        return _triangles(path, header, records)
    except ValueError as fault:
        raise damaged(path, str(fault)) from None


def _read_header(data: bytes) -> tuple[_Header, bytes]:
    head, end, rest = data.partition(b"end_header")
    if not data.startswith(b"ply") or not end:
        raise ValueError("a PLY file begins with the line 'ply' and a header that ends with 'end_header'")
    body = rest.partition(b"\n")[2] if b"\n" in head else rest.partition(b"\r")[2]
    order, elements, texture = None, [], None
    for line in head.decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", name, _] if name in _ORDERS:
                order = _ORDERS[name]
            case ["comment" | "obj_info", "TextureFile", *words]:
                texture = " ".join(words)
            case ["comment" | "obj_info", *_] | []:
                pass
            case ["element", name, count] if count.isdigit():
                elements.append(_Element(name, int(count), []))
            case ["property", "list", count_type, kind, name] if elements and {count_type, kind} <= set(_TYPES):
                elements[-1].properties.append(_Property(name, _TYPES[kind], _TYPES[count_type]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[kind], None))
            case _:
                raise ValueError(f"the header's line {line[:60]!r} means nothing")
    if order is None:
        raise ValueError(f"the header names none of the formats {', '.join(_ORDERS)}")
    return _Header(order, elements, texture), body


class _TextBody:
    def __init__(self, body: bytes):
        self.words, self.at = body.split(), 0

    def room(self, _properties: list[_Property]) -> int:
        """Records that could follow at the most: one word for each property."""
        return (len(self.words) - self.at) // len(_properties)

    def take(self, _type: str, count: int) -> np.ndarray:
        """The next `count` numbers of one type."""
        words = self.words[self.at : self.at + count]
        if len(words) < count:
            raise ValueError(_TOO_SHORT)
        self.at += count
        try:
            return np.array([float(word) for word in words])
        except ValueError:
            raise ValueError("the data hold something that is not a number") from None

    def take_table(self, types: list[str], counts: list[int], records: int) -> list[np.ndarray]:
        """The next `records` records, each of len(counts) groups of numbers; arrays (records, count)."""
        table = self.take(types[0], records * sum(counts)).reshape(records, -1)
        return np.split(table, list(accumulate(counts))[:-1], axis=1)

    def require_end(self) -> None:
        if self.at < len(self.words):
            raise ValueError(f"{len(self.words) - self.at} numbers follow after all that the header describes")


class _BinaryBody:
    def __init__(self, body: bytes, order: str):
        self.body, self.order, self.at = body, order, 0

    def room(self, properties: list[_Property]) -> int:
        """Records that could follow at the most: every list empty."""
        return (len(self.body) - self.at) // sum(_BYTES[p.count_type or p.type] for p in properties)

    def take(self, type_: str, count: int) -> np.ndarray:
        """As for a text."""
        start = self._advance(_BYTES[type_] * count)
        return np.frombuffer(self.body, self.order + type_, count=count, offset=start)

    def take_table(self, types: list[str], counts: list[int], records: int) -> list[np.ndarray]:
        """As for a text."""
        groups = list(zip(types, counts, strict=True))
        start = self._advance(records * sum(_BYTES[type_] * count for type_, count in groups))
        record = np.dtype([(f"f{n}", self.order + type_, (count,)) for n, (type_, count) in enumerate(groups)])
        table = np.frombuffer(self.body, record, count=records, offset=start)
        return [table[f"f{n}"] for n in range(len(groups))]

    def _advance(self, size: int) -> int:
        if size > len(self.body) - self.at:
            raise ValueError(_TOO_SHORT)
        self.at += size
        return self.at - size

    def require_end(self) -> None:
        if self.at < len(self.body):
            raise ValueError(f"{len(self.body) - self.at} bytes follow after all that the header describes")


def _read_element(reader, element: _Element) -> dict[str, np.ndarray | _Lists]:
    """The element's properties by name: (N,) for a number, _Lists for a list."""
    if element.records == 0 or not element.properties:
        return {}
    if element.records > reader.room(element.properties):
        raise ValueError(f"the header promises {element.records} records '{element.name}', more than the file has room for")
    if all(p.count_type is None for p in element.properties):
        types = [p.type for p in element.properties]
        columns = reader.take_table(types, [1] * len(types), element.records)
        return {p.name: column[:, 0] for p, column in zip(element.properties, columns, strict=True)}
    return _read_alike(reader, element) or _read_one_by_one(reader, element)


def _read_alike(reader, element: _Element) -> dict | None:
    """All records at once if their lists are as long as the first one's; else None, with nothing consumed."""
    start = reader.at
    sizes = [len(values) for values in _read_record(reader, element)]
    reader.at = start
    types, counts = [], []
    for p, size in zip(element.properties, sizes, strict=True):
        types += [p.type] if p.count_type is None else [p.count_type, p.type]
        counts += [1] if p.count_type is None else [1, size]
    try:
        columns = iter(reader.take_table(types, counts, element.records))
    except ValueError:
        reader.at = start
        return None
    found = {}
    for p, size in zip(element.properties, sizes, strict=True):
        lengths = next(columns)[:, 0]
        if p.count_type is None:
            found[p.name] = lengths
        elif (lengths == size).all():
            found[p.name] = _Lists(lengths.astype(np.int64), next(columns).reshape(-1))
        else:
            reader.at = start
            return None
    return found


def _read_one_by_one(reader, element: _Element) -> dict[str, np.ndarray | _Lists]:
    found: list[list[np.ndarray]] = [[] for _ in element.properties]
    for _ in range(element.records):
        for values, record in zip(found, _read_record(reader, element), strict=True):
            values.append(record)
    columns = {}
    for p, values in zip(element.properties, found, strict=True):
        joined = np.concatenate(values)
        columns[p.name] = joined if p.count_type is None else _Lists(np.array([len(v) for v in values]), joined)
    return columns


def _read_record(reader, element: _Element) -> list[np.ndarray]:
    values = []
    for p in element.properties:
        length = 1.0 if p.count_type is None else float(reader.take(p.count_type, 1)[0])
        if not (length >= 0 and length.is_integer()):
            raise ValueError(f"a list '{p.name}' of the element '{element.name}' has the length {length:g}")
        values.append(reader.take(p.type, int(length)))
    return values


def _triangles(path: Path, header: _Header, records: dict) -> Triangles:
    vertex, face = records.get("vertex", {}), records.get("face", {})
    if vertex and not {"x", "y", "z"} <= vertex.keys():
        raise ValueError("its vertices have no x, y and z")
    axes = [vertex[axis] for axis in "xyz"] if vertex else [[], [], []]
    positions = np.stack(axes, axis=1).astype(float)
    lists = face.get("vertex_indices", face.get("vertex_index"))
    if not isinstance(lists, _Lists):
        return Triangles(positions, np.zeros((0, 3), dtype=np.int64))
    corners = _checked_corners(lists, len(positions))
    texels, texel_corners = _texels(vertex, face, corners, lists.counts)
    texture = open_texture(path.parent / header.texture) if header.texture and texels is not None else None
    return assemble(positions, corners, lists.counts, texels=texels, texel_corners=texel_corners, texture=texture)


def _checked_corners(lists: _Lists, vertices: int) -> np.ndarray:
    if (lists.counts < 3).any():
        raise ValueError(f"face {int((lists.counts < 3).argmax())} (from 0) has fewer than 3 corners")
    corners = lists.values.astype(np.int64)
    place = first_outside(corners, vertices)
    if place >= 0:
        number = np.searchsorted(np.cumsum(lists.counts), place, side="right")
        raise ValueError(f"face {number} (from 0) refers to vertex {corners[place]} (from 0), but there are {vertices}")
    return corners


def _texels(vertex: dict, face: dict, corners: np.ndarray, counts: np.ndarray) -> tuple:
    """Texture coordinates, of the corners (rare) or of the vertices, and each corner's index into them."""
    wedge = face.get("texcoord")
    if isinstance(wedge, _Lists) and (wedge.counts == 2 * counts).all():
        texels, index = np.unique(wedge.values.astype(float).reshape(-1, 2), axis=0, return_inverse=True)
        return texels, index.reshape(-1)
    for u, v in _UV_NAMES:
        if u in vertex and v in vertex:
            return np.stack([vertex[u], vertex[v]], axis=1).astype(float), corners
    return None, None
