"""glTF 2.0, binary (GLB) and text: trimesh gets its JSON made plain, and reads that."""

import json
import struct
from collections.abc import Callable
from pathlib import Path

from softffd.errors import MeshError
from softffd.mesh.bodies import read_bodies
from softffd.mesh.gltf_header import made_plain
from softffd.mesh.polygons import Triangles, damaged


def read_glb(path: Path, data: bytes) -> Triangles:
    """Return the triangles of all bodies of the file's scene, each in its place.

    Raises MeshError for damaged files, and for what is not read: compressed or sparse ones, skins, morphs and instances.
    """
    end = _end_of_json(path, data)
    header = _parsed(path, data[20:end])

    def packed() -> bytes:
        text = _text(header)
        return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(data) - end, len(text), b"JSON") + text + data[end:]

    return _read(path, header, packed)


def read_gltf(path: Path, data: bytes) -> Triangles:
    """As read_glb, for the text with its data inside or in files beside it."""
    header = _parsed(path, data)
    version = header.get("asset", {}).get("version") if isinstance(header.get("asset"), dict) else None
    if not str(version).startswith("2"):
        raise MeshError(f"{path}: wanted glTF version 2, got {f'version {version}' if version else 'no version'}")
    return _read(path, header, lambda: _text(header))


def _read(path: Path, header: dict, packed: Callable[[], bytes]) -> Triangles:
    surfaces, notes = made_plain(path, header)
    triangles = read_bodies(path, packed(), surfaces)
    return triangles._replace(looks=triangles.looks.and_notes(*notes))


def _text(header: dict) -> bytes:
    text = json.dumps(header).encode()
    return text + b" " * (-len(text) % 4)


def _end_of_json(path: Path, data: bytes) -> int:
    """Where the JSON ends in a container whose parts are all there."""
    version, length, chunk = (int.from_bytes(data[at : at + 4], "little") for at in (4, 8, 12))
    if data[:4] != b"glTF":
        raise MeshError(f"{path}: not a GLB file: wanted one that begins with b'glTF', got {data[:4]!r}")
    if version != 2:
        raise MeshError(f"{path}: wanted glTF version 2, got version {version}")
    if length != len(data):
        raise damaged(path, f"its header promises {length} bytes, but it has {len(data)}")
    end = 20 + chunk
    if data[16:20] != b"JSON" or end > len(data):
        raise damaged(path, "its first part is not a whole block of JSON")
    return end


def _parsed(path: Path, text: bytes) -> dict:
    try:
        header = json.loads(text)  # in UTF-8, UTF-16 or UTF-32, with a byte order mark or without
    except (ValueError, RecursionError):
        header = None
    if not isinstance(header, dict):
        raise damaged(path, "its JSON cannot be read")
    return header
