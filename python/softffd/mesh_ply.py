"""PLY, text and binary: the header says what follows, and is held to its word."""

from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

import numpy as np

from softffd.mesh_polygons import Triangles, assemble, damaged, first_outside, open_texture

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "int64": "i8", "uint64": "u8",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_UV_NAMES = [("s", "t"), ("u", "v"), ("texture_u", "texture_v")]


class _Property(NamedTuple):
    name: str
    type: str
    count_type: str | None


class _Element(NamedTuple):
    name: str
    count: int
    properties: list[_Property]


class _Header(NamedTuple):
    order: str | None
    elements: list[_Element]
    texture: str | None


class _Lists(NamedTuple):
    """A list property of all records: `counts` (N,) and the `values` of all of them one after another."""

    counts: np.ndarray
    values: np.ndarray


def read_ply(path: Path, data: bytes) -> Triangles:
    """Return the triangles of a PLY file, with the texture coordinates of its vertices or of its faces'
    corners.

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
            case ["property", "list", count_type, kind, name] if (
                elements and {count_type, kind} <= _TYPES.keys()
            ):
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

    def take(self, _types: list[str], counts: list[int], records: int) -> list[np.ndarray]:
        """The next `records` records, each of len(counts) groups of numbers; arrays (records, count)."""
        width = sum(counts)
        words = self.words[self.at : self.at + records * width]
        if len(words) < records * width:
            raise ValueError("the file ends within the data that the header promises")
        self.at += records * width
        try:
            table = np.array([float(word) for word in words]).reshape(records, width)
        except ValueError:
            raise ValueError("the data hold something that is not a number") from None
        return np.split(table, list(accumulate(counts))[:-1], axis=1)

    def require_end(self) -> None:
        if self.at < len(self.words):
            raise ValueError(
                f"{len(self.words) - self.at} numbers follow after all that the header describes"
            )


class _BinaryBody:
    def __init__(self, body: bytes, order: str):
        self.body, self.order, self.at = body, order, 0

    def room(self, properties: list[_Property]) -> int:
        """Records that could follow at the most: every list empty."""
        least = sum(np.dtype(p.count_type or p.type).itemsize for p in properties)
        return (len(self.body) - self.at) // least

    def take(self, types: list[str], counts: list[int], records: int) -> list[np.ndarray]:
        """As for a text."""
        fields = [
            (f"f{n}", self.order + kind, (count,))
            for n, (kind, count) in enumerate(zip(types, counts, strict=True))
        ]
        record = np.dtype(fields)
        if len(self.body) - self.at < records * record.itemsize:
            raise ValueError("the file ends within the data that the header promises")
        table = np.frombuffer(self.body, record, count=records, offset=self.at)
        self.at += records * record.itemsize
        return [table[name] for name in record.names]

    def require_end(self) -> None:
        if self.at < len(self.body):
            raise ValueError(f"{len(self.body) - self.at} bytes follow after all that the header describes")


def _read_element(reader, element: _Element) -> dict[str, np.ndarray | _Lists]:
    """The element's properties by name: (N,) for a number, _Lists for a list."""
    if element.count == 0 or not element.properties:
        return {}
    if element.count > reader.room(element.properties):
        raise ValueError(
            f"the header promises {element.count} records '{element.name}', more than the file has room for"
        )
    if all(p.count_type is None for p in element.properties):
        columns = reader.take(
            [p.type for p in element.properties], [1] * len(element.properties), element.count
        )
        return {p.name: column[:, 0] for p, column in zip(element.properties, columns, strict=True)}
    return _read_alike(reader, element) or _read_one_by_one(reader, element)


def _read_alike(reader, element: _Element) -> dict | None:
    """All records at once where their lists are as long as the first one's; None, nothing consumed, where
    they are not."""
    start = reader.at
    sizes = [len(values) for values in _read_record(reader, element)]
    reader.at = start
    types, counts = [], []
    for p, size in zip(element.properties, sizes, strict=True):
        types += [p.type] if p.count_type is None else [p.count_type, p.type]
        counts += [1] if p.count_type is None else [1, size]
    try:
        columns = iter(reader.take(types, counts, element.count))
    except ValueError:
        reader.at = start
        return None
    found = {}
    for p, size in zip(element.properties, sizes, strict=True):
        lengths = next(columns)[:, 0]
        found[p.name] = (
            lengths if p.count_type is None else _Lists(lengths.astype(np.int64), next(columns).reshape(-1))
        )
        if p.count_type is not None and not (lengths == size).all():
            reader.at = start
            return None
    return found


def _read_one_by_one(reader, element: _Element) -> dict[str, np.ndarray | _Lists]:
    found = [[] for _ in element.properties]
    for _ in range(element.count):
        for values, record in zip(found, _read_record(reader, element), strict=True):
            values.append(record)
    return {
        p.name: np.concatenate(values)
        if p.count_type is None
        else _Lists(np.array([len(record) for record in values]), np.concatenate(values))
        for p, values in zip(element.properties, found, strict=True)
    }


def _read_record(reader, element: _Element) -> list[np.ndarray]:
    values = []
    for p in element.properties:
        length = 1 if p.count_type is None else float(reader.take([p.count_type], [1], 1)[0][0, 0])
        if not (length >= 0 and length == int(length)):
            raise ValueError(f"a list '{p.name}' of the element '{element.name}' has the length {length:g}")
        values.append(reader.take([p.type], [int(length)], 1)[0][0])
    return values


def _triangles(path: Path, header: _Header, records: dict) -> Triangles:
    vertex, face = records.get("vertex", {}), records.get("face", {})
    if vertex and not {"x", "y", "z"} <= vertex.keys():
        raise ValueError("its vertices have no x, y and z")
    positions = (
        np.stack([vertex[axis].astype(float) for axis in "xyz"], axis=1) if vertex else np.zeros((0, 3))
    )
    lists = face.get("vertex_indices", face.get("vertex_index"))
    if not isinstance(lists, _Lists):
        return Triangles(positions, np.zeros((0, 3), dtype=np.int64))
    corners = _checked_corners(lists, len(positions))
    texels, texel_corners = _texels(vertex, face, corners, lists.counts)
    texture = open_texture(path.parent / header.texture) if header.texture and texels is not None else None
    return assemble(
        positions, corners, lists.counts, texels=texels, texel_corners=texel_corners, texture=texture
    )


def _checked_corners(lists: _Lists, vertices: int) -> np.ndarray:
    if (lists.counts < 3).any():
        raise ValueError(f"face {int((lists.counts < 3).argmax())} (from 0) has fewer than 3 corners")
    corners = lists.values.astype(np.int64)
    place = first_outside(corners, vertices)
    if place >= 0:
        number = np.searchsorted(np.cumsum(lists.counts), place, side="right")
        raise ValueError(
            f"face {number} (from 0) refers to vertex {corners[place]} (from 0), but there are {vertices}"
        )
    return corners


def _texels(vertex: dict, face: dict, corners: np.ndarray, counts: np.ndarray) -> tuple:
    """Texture coordinates and each corner's index into them; they belong to the corners (rare) or to the
    vertices."""
    wedge = face.get("texcoord")
    if isinstance(wedge, _Lists) and (wedge.counts == 2 * counts).all():
        texels, index = np.unique(wedge.values.astype(float).reshape(-1, 2), axis=0, return_inverse=True)
        return texels, index.reshape(-1)
    for u, v in _UV_NAMES:
        if u in vertex and v in vertex:
            return np.stack([vertex[u], vertex[v]], axis=1).astype(float), corners
    return None, None
