"""PLY, text and binary: the header describes the data, and the data must agree with the header.

trimesh is not used, since it silently accepts faces that refer to no vertex and numbers that the header does not announce, and fails on
binary files that mix triangles with other polygons.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from softffd.mesh.looks import PLAIN, Looks, Material, as_shares, from_face_colours
from softffd.mesh.polygons import Triangles, assemble, damaged, found_beside, open_texture, plain_text

_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "int64": "i8", "uint64": "u8", "float": "f4", "double": "f8", "float32": "f4", "float64": "f8",
}  # fmt: skip
_COLOUR_NAMES = [("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b")]
_UV_NAMES = [("s", "t"), ("u", "v"), ("texture_u", "texture_v")]


class _Property(NamedTuple):
    name: str
    type: str
    count_type: str | None


class _Element(NamedTuple):
    name: str
    records: int
    properties: list[_Property]


class _Lists(NamedTuple):
    """A list property of all records: `counts` (N,), and the `values` of all records one after another."""

    counts: np.ndarray
    values: np.ndarray


class _Header(NamedTuple):
    order: str
    elements: list[_Element]
    textures: tuple[str, ...]


def read_ply(path: Path, data: bytes) -> Triangles:
    """Returns the triangles of a PLY file, faces and strips, with the texture coordinates of its vertices or of the corners of its faces.

    Colours are those of vertices multiplied by those of faces, or pictures that lie beside the file.

    Raises MeshError if the data are fewer than the header says, if a text has more, or if a face refers to no vertex.
    """
    try:
        header, rest = _read_header(plain_text(data))
        numbers = _Numbers(rest, header.order)
        records = {element.name: _read_element(numbers, element) for element in header.elements}
        if header.order == "" and numbers.left:
            raise ValueError(f"{numbers.left // 8} numbers follow after all that the header describes")
        triangles = _triangles(path, header, records)
        note = f"{numbers.left} bytes that follow after all that the header describes" if numbers.left else ""  # padding
        return triangles.and_notes(note)
    except ValueError as fault:
        raise damaged(path, str(fault)) from None


def _read_header(data: bytes) -> tuple[_Header, bytes]:
    head, end, rest = data.partition(b"end_header")
    if not data.startswith(b"ply") or not end:
        raise ValueError("a PLY file begins with the line 'ply' and a header that ends with 'end_header'")
    body = rest.partition(b"\n")[2] if b"\n" in head else rest.partition(b"\r")[2]
    order, elements, textures = None, [], []
    for line in head.decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", name, _] if name in _ORDERS:
                order = _ORDERS[name]
            case ["comment" | "obj_info", "TextureFile", *words]:
                textures.append(" ".join(words))
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
    return _Header(order, elements, tuple(textures)), body


class _Numbers:
    """The data after the header, read from the front to the back; all numbers of a text are doubles."""

    def __init__(self, body: bytes, order: str):
        self._body, self._order, self._at = body, order, 0
        if not order:
            try:
                self._body = np.array(list(map(float, body.split()))).tobytes()
            except ValueError:
                raise ValueError("the data hold something that is not a number") from None

    @property
    def left(self) -> int:
        """Number of bytes not yet read."""
        return len(self._body) - self._at

    def kind(self, type_: str) -> str:
        """Returns the numpy type in which a number of a type of the header is stored here."""
        return self._order + type_ if self._order else "f8"

    def size(self, type_: str) -> int:
        return int(self.kind(type_)[-1])

    def take(self, types: list[str], counts: list[int], records: int) -> list[np.ndarray]:
        """Reads the next `records` records. A record has one group of `count` numbers for each type; returns arrays (records, count)."""
        groups = list(zip(types, counts, strict=True))
        size, start = records * sum(self.size(type_) * count for type_, count in groups), self._at
        if size > self.left:
            raise ValueError("the file ends within the data that the header promises")
        self._at += size
        record = np.dtype([(f"f{n}", self.kind(type_), (count,)) for n, (type_, count) in enumerate(groups)])
        table = np.frombuffer(self._body, record, count=records, offset=start)
        return [table[f"f{n}"] for n in range(len(groups))]

    def go_back(self, to_left: int) -> None:
        """Moves back to the position at which `to_left` bytes were left."""
        self._at = len(self._body) - to_left


def _read_element(numbers: _Numbers, element: _Element) -> dict[str, np.ndarray | _Lists]:
    """Returns the properties of the element by name: (N,) for a number, _Lists for a list."""
    if element.records == 0 or not element.properties:
        return {}
    if element.records > numbers.left // sum(numbers.size(p.count_type or p.type) for p in element.properties):  # empty lists
        raise ValueError(f"the header promises {element.records} records '{element.name}', more than the file has room for")
    return _read_alike(numbers, element) or _read_one_by_one(numbers, element)


def _read_alike(numbers: _Numbers, element: _Element) -> dict[str, np.ndarray | _Lists] | None:
    """Reads all records at once if their lists are as long as those of the first record; else returns None, with nothing read."""
    start = numbers.left
    sizes = [len(values) for values in _read_record(numbers, element)]
    numbers.go_back(start)
    types, counts = [], []
    for p, size in zip(element.properties, sizes, strict=True):
        types += [p.type] if p.count_type is None else [p.count_type, p.type]
        counts += [1] if p.count_type is None else [1, size]
    found: dict[str, np.ndarray | _Lists] = {}
    try:
        columns = iter(numbers.take(types, counts, element.records))
    except ValueError:
        return None
    for p, size in zip(element.properties, sizes, strict=True):
        lengths = next(columns)[:, 0]
        if p.count_type is None:
            found[p.name] = lengths
        elif (lengths == size).all():
            found[p.name] = _Lists(lengths.astype(np.int64), next(columns).reshape(-1))
        else:
            numbers.go_back(start)
            return None
    return found


def _read_one_by_one(numbers: _Numbers, element: _Element) -> dict[str, np.ndarray | _Lists]:
    records = [_read_record(numbers, element) for _ in range(element.records)]
    columns: dict[str, np.ndarray | _Lists] = {}
    for p, values in zip(element.properties, zip(*records, strict=True), strict=True):
        joined = np.concatenate(values)
        columns[p.name] = joined if p.count_type is None else _Lists(np.array([len(v) for v in values]), joined)
    return columns


def _read_record(numbers: _Numbers, element: _Element) -> list[np.ndarray]:
    values = []
    for p in element.properties:
        length = 1.0 if p.count_type is None else float(numbers.take([p.count_type], [1], 1)[0][0, 0])
        if not (length >= 0 and length.is_integer()):
            raise ValueError(f"a list '{p.name}' of the element '{element.name}' has the length {length:g}")
        values.append(numbers.take([p.type], [int(length)], 1)[0].reshape(-1))
    return values


def _triangles(path: Path, header: _Header, records: dict[str, Any]) -> Triangles:
    vertex, face = records.get("vertex", {}), records.get("face", {})
    if vertex and not {"x", "y", "z"} <= vertex.keys():
        raise ValueError("its vertices have no x, y and z")
    axes = [vertex[axis] for axis in "xyz"] if vertex else [[], [], []]
    positions = np.stack(axes, axis=1).astype(float)
    faces = _faces(face, records.get("tristrips", {}))
    texels, texel_corners = _texels(vertex, face, faces)
    looks = replace(
        _face_looks(path.parent, header, face, len(faces.counts), texels is not None), colours=_colours(header, "vertex", vertex)
    )
    return assemble(positions, faces.values, faces.counts, texels=texels, texel_corners=texel_corners, looks=looks)


def _faces(face: dict[str, Any], strips: dict[str, Any]) -> _Lists:
    """Returns the corners of the polygons, followed by those of the triangles of strips."""
    found = [records.get("vertex_indices", records.get("vertex_index")) for records in (face, strips)]
    polygons, strip = (each if isinstance(each, _Lists) else _Lists(np.zeros(0, np.int64), np.zeros(0)) for each in found)
    values = np.concatenate([polygons.values.astype(np.int64), _unstripped(strip).reshape(-1)])
    return _Lists(np.append(polygons.counts, np.full((len(values) - len(polygons.values)) // 3, 3)), values)


def _unstripped(strips: _Lists) -> np.ndarray:
    """Returns the triangles (T, 3) of strips: every three consecutive corners, each second triangle reversed; -1 starts a new strip."""
    corners = strips.values.astype(np.int64)
    begins = np.zeros(len(corners) + 1, dtype=bool)
    begins[0], begins[np.cumsum(strips.counts)] = True, True
    begins[1:][corners == -1] = True
    begin = np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))[:-1]
    first = np.arange(max(0, len(corners) - 2))
    first = first[(begin[first] == begin[first + 2]) & (corners[first + 2] != -1)]
    turned = (first - begin[first]) % 2
    triangles = np.stack([corners[first], corners[first + 1 + turned], corners[first + 2 - turned]], axis=1)
    a, b, c = triangles.T
    return triangles[(a != b) & (b != c) & (c != a)]  # a repeated corner only reverses the strip


def _texels(vertex: dict[str, Any], face: dict[str, Any], faces: _Lists) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Returns the texture coordinates of the corners (rare) or of the vertices, and the index of each corner into them."""
    wedge = face.get("texcoord")
    if isinstance(wedge, _Lists) and np.array_equal(wedge.counts, 2 * faces.counts):
        texels, index = np.unique(wedge.values.astype(float).reshape(-1, 2), axis=0, return_inverse=True)
        return texels, index.reshape(-1)
    for u, v in _UV_NAMES:
        if u in vertex and v in vertex:
            return np.stack([vertex[u], vertex[v]], axis=1).astype(float), faces.values
    return None, None


def _face_looks(folder: Path, header: _Header, face: dict[str, Any], faces: int, placed: bool) -> Looks:
    """Returns the materials of the faces: pictures, if texture coordinates exist (`placed`), else the colours of the faces."""
    colours = _colours(header, "face", face)
    if header.textures and placed:
        files = [found_beside(folder, name, anywhere=True) for name in header.textures]
        images = [None if file is None else open_texture(file) for file in files]
        materials = tuple(Material(Path(name).stem, None, image) for name, image in zip(header.textures, images, strict=True))
        lost = [name for name, image in zip(header.textures, images, strict=True) if image is None]
        notes = (f"pictures missing beside it or not readable: {', '.join(lost)}",) if lost else ()
        numbers = np.asarray(face.get("texnumber", np.zeros(faces)), dtype=float)
        whole = len(numbers) == faces and np.isin(numbers, np.arange(len(images))).all()
        return Looks(materials, numbers.astype(np.int64) if whole else np.zeros(faces, dtype=np.int64), notes=notes)
    return from_face_colours(colours) if colours is not None and len(colours) == faces else PLAIN


def _colours(header: _Header, element: str, records: dict[str, Any]) -> np.ndarray | None:
    """Returns the colours (N, 3), 0 .. 1, of the records of an element; None if they have none."""
    for names in _COLOUR_NAMES:
        if set(names) <= records.keys() and not any(isinstance(records[name], _Lists) for name in names):
            kind = next(p.type for e in header.elements if e.name == element for p in e.properties if p.name == names[0])
            whole = 65535.0 if kind == "u2" else 255.0 if kind[0] in "iu" else None
            return as_shares(np.stack([records[name] for name in names], axis=1), whole)
    return None
