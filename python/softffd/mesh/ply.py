"""PLY, text and binary: the header says what follows, and is held to its word.

Read here and not by trimesh, which takes faces that refer to no vertex, and numbers that the header does not
announce, without a word, and gives up on binary files that mix triangles with other polygons.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from softffd.mesh.looks import PLAIN, Looks, Material, from_face_colours
from softffd.mesh.ply_records import TYPES, BinaryBody, Element, Lists, Property, TextBody, read_element
from softffd.mesh.polygons import Triangles, assemble, beside, damaged, first_outside, open_texture, plain_text

_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_COLOUR_NAMES = [("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b")]
_UV_NAMES = [("s", "t"), ("u", "v"), ("texture_u", "texture_v")]


class _Header(NamedTuple):
    order: str
    elements: list[Element]
    textures: tuple[str, ...]


def read_ply(path: Path, data: bytes) -> Triangles:
    """Return the triangles of a PLY file, faces and strips, with the texture coordinates of vertices or of faces' corners.

    Colours are those of vertices times those of faces, or pictures that lie beside it.

    Raises MeshError where the data are fewer than the header says, or a text's are more, or a face refers to no vertex.
    """
    try:
        header, body = _read_header(plain_text(data))
        reader = TextBody(body) if header.order == "" else BinaryBody(body, header.order)
        records = {element.name: read_element(reader, element) for element in header.elements}
        rest = reader.rest()
        triangles = _triangles(path, header, records)
        return triangles._replace(looks=triangles.looks.and_notes(rest)) if rest else triangles
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
                elements.append(Element(name, int(count), []))
            case ["property", "list", count_type, kind, name] if elements and {count_type, kind} <= set(TYPES):
                elements[-1].properties.append(Property(name, TYPES[kind], TYPES[count_type]))
            case ["property", kind, name] if elements and kind in TYPES:
                elements[-1].properties.append(Property(name, TYPES[kind], None))
            case _:
                raise ValueError(f"the header's line {line[:60]!r} means nothing")
    if order is None:
        raise ValueError(f"the header names none of the formats {', '.join(_ORDERS)}")
    return _Header(order, elements, tuple(textures)), body


def _triangles(path: Path, header: _Header, records: dict[str, Any]) -> Triangles:
    vertex, face = records.get("vertex", {}), records.get("face", {})
    if vertex and not {"x", "y", "z"} <= vertex.keys():
        raise ValueError("its vertices have no x, y and z")
    axes = [vertex[axis] for axis in "xyz"] if vertex else [[], [], []]
    positions = np.stack(axes, axis=1).astype(float)
    faces = _checked(_faces(face, records.get("tristrips", {})), len(positions))
    texels, texel_corners = _texels(vertex, face, faces)
    looks = replace(
        _face_looks(path.parent, header, face, len(faces.counts), texels is not None), colours=_colours(header, "vertex", vertex)
    )
    return assemble(positions, faces.values, faces.counts, texels=texels, texel_corners=texel_corners, looks=looks)


def _faces(face: dict[str, Any], strips: dict[str, Any]) -> Lists:
    """The corners of the polygons, and of the triangles of strips, which follow them."""
    found = [records.get("vertex_indices", records.get("vertex_index")) for records in (face, strips)]
    polygons, strip = (each if isinstance(each, Lists) else Lists(np.zeros(0, np.int64), np.zeros(0)) for each in found)
    values = np.concatenate([polygons.values.astype(np.int64), _unstripped(strip).reshape(-1)])
    return Lists(np.append(polygons.counts, np.full((len(values) - len(polygons.values)) // 3, 3)), values)


def _unstripped(strips: Lists) -> np.ndarray:
    """Triangles (T, 3) of strips: each three neighbours in a row, every second one turned round; -1 begins a strip anew."""
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
    return triangles[(a != b) & (b != c) & (c != a)]  # corners given twice only turn the strip


def _checked(lists: Lists, vertices: int) -> Lists:
    if (lists.counts < 3).any():
        raise ValueError(f"face {int((lists.counts < 3).argmax())} (from 0) has fewer than 3 corners")
    corners = lists.values
    place = first_outside(corners, vertices)
    if place >= 0:
        number = np.searchsorted(np.cumsum(lists.counts), place, side="right")
        raise ValueError(f"face {number} (from 0) refers to vertex {corners[place]} (from 0), but there are {vertices}")
    return lists


def _texels(vertex: dict[str, Any], face: dict[str, Any], faces: Lists) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Texture coordinates, of the corners (rare) or of the vertices, and each corner's index into them."""
    wedge = face.get("texcoord")
    if isinstance(wedge, Lists) and np.array_equal(wedge.counts, 2 * faces.counts):
        texels, index = np.unique(wedge.values.astype(float).reshape(-1, 2), axis=0, return_inverse=True)
        return texels, index.reshape(-1)
    for u, v in _UV_NAMES:
        if u in vertex and v in vertex:
            return np.stack([vertex[u], vertex[v]], axis=1).astype(float), faces.values
    return None, None


def _face_looks(folder: Path, header: _Header, face: dict[str, Any], faces: int, placed: bool) -> Looks:
    """Materials of the faces: pictures, where they are `placed` by texture coordinates, or the faces' own colours."""
    colours = _colours(header, "face", face)
    if header.textures and placed:
        files = [beside(folder, name) or beside(folder, name.replace("\\", "/").rpartition("/")[2]) for name in header.textures]
        images = [None if file is None else open_texture(file) for file in files]
        materials = tuple(Material(Path(name).stem, None, image) for name, image in zip(header.textures, images, strict=True))
        lost = [name for name, image in zip(header.textures, images, strict=True) if image is None]
        notes = (f"pictures missing beside it or not readable: {', '.join(lost)}",) if lost else ()
        numbers = np.asarray(face.get("texnumber", np.zeros(faces)), dtype=float)
        whole = len(numbers) == faces and np.isin(numbers, np.arange(len(images))).all()
        return Looks(materials, numbers.astype(np.int64) if whole else np.zeros(faces, dtype=np.int64), notes=notes)
    return from_face_colours(colours) if colours is not None and len(colours) == faces else PLAIN


def _colours(header: _Header, element: str, records: dict[str, Any]) -> np.ndarray | None:
    """Colours (N, 3), 0 .. 1, of an element's records; None where they have none."""
    for names in _COLOUR_NAMES:
        if set(names) <= records.keys() and not any(isinstance(records[name], Lists) for name in names):
            kind = next(p.type for e in header.elements if e.name == element for p in e.properties if p.name == names[0])
            whole = {"u1": 255.0, "u2": 65535.0}.get(kind, 255.0 if kind[0] in "iu" else 1.0)
            shades = np.nan_to_num(np.stack([records[name] for name in names], axis=1).astype(float))
            whole = 255.0 if whole == 1.0 and shades.max(initial=0) > 1 else whole
            return (shades / whole).clip(0, 1)
    return None
