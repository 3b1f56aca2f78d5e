"""STL, binary and text: the triangles share no vertices, so the caller merges equal corners."""

import re
from pathlib import Path

import numpy as np

from softffd.mesh.polygons import Triangles, damaged, plain_text

_HEAD = 84
_TEXT = re.compile(rb"\A(\s|#[^\n]*\n)*solid(?=\s|\Z)", re.IGNORECASE)
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: Path, data: bytes) -> Triangles:
    """Returns the triangles of an STL file, with three vertices each.

    Colours, and data after the promised triangles, are left out with a note.
    Raises MeshError if there are fewer triangles than the header promises, or if a facet of a text is not complete.
    """
    promised = int.from_bytes(data[80:_HEAD], "little") if len(data) >= _HEAD else None
    rest = -1 if promised is None else len(data) - _HEAD - promised * _RECORD.itemsize
    text = plain_text(data)
    if rest != 0 and b"\0" not in text and _TEXT.search(text):
        return _text_triangles(path, text)
    if promised is None:
        raise damaged(path, f"it has {len(data)} bytes, and every binary STL file begins with {_HEAD}")
    if rest == 0 or (rest > 0 and promised):
        return _binary(data, promised, rest)
    size = _HEAD + promised * _RECORD.itemsize
    fault = f"its header promises {promised} triangles, which makes {size} bytes, but it has {len(data)} bytes"
    raise damaged(path, fault)


def _binary(data: bytes, promised: int, rest: int) -> Triangles:
    records = np.frombuffer(data, _RECORD, promised, _HEAD)
    coloured = b"COLOR=" in data[:80] or ((records["attribute"] & 0x8000) != 0).any()
    notes = ["colours of an STL file are not read; OBJ, PLY and GLB keep theirs"] * bool(coloured)
    notes += [f"{rest} bytes that follow after the {promised} triangles of its header"] * bool(rest)
    return _soup(records["corners"]).and_notes(*notes)


def _soup(corners: np.ndarray) -> Triangles:
    vertices = corners.astype(float).reshape(-1, 3)
    return Triangles(vertices, np.arange(len(vertices)).reshape(-1, 3))


def _text_triangles(path: Path, data: bytes) -> Triangles:
    """Returns the triangles of a text file. Raises MeshError if a facet is not complete."""
    rows = [words for words in (line.split() for line in data.lower().splitlines()) if words]
    keys = [words[0] for words in rows]
    facets, ends = keys.count(b"facet"), keys.count(b"endfacet")
    corners = [words[1:] for words in rows if words[0] == b"vertex"]
    ended = keys.count(b"endsolid") + sum(words[:2] == [b"end", b"solid"] for words in rows)
    if facets != ends or len(corners) != 3 * facets:
        fault = f"{facets} facets begin and {ends} end, with {len(corners)} vertices; each facet has 3"
        raise damaged(path, fault)
    try:
        triangles = _soup(np.array([(float(x), float(y), float(z)) for x, y, z in corners]))
    except ValueError:
        raise damaged(path, "a vertex is not three numbers") from None
    note = "no line 'endsolid' at its end, though all facets are whole" if keys.count(b"solid") != ended else ""
    return triangles.and_notes(note)
