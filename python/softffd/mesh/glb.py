"""GLB (binary glTF 2.0), read by trimesh: what it would pass over in silence is looked for first."""

import json
import logging
import warnings
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np

from softffd.errors import MeshError
from softffd.mesh.polygons import Triangles, damaged

_COMPRESSED = {
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
}
_FLOAT, _TRIANGLE_FAN = 5126, 6


def read_glb(path: Path, data: bytes) -> Triangles:
    """Return the triangles of all bodies of the file's scene, each in its place.

    Texture coordinates are kept where a body has a material; the texture where all bodies with one share it.
    Raises MeshError for damaged files, and for compressed or sparse ones, which are not read.
    """
    _require_readable(path, _read_json(path, data))
    bodies = _read_bodies(path, data)
    for body in bodies:
        if body.faces.min() < 0 or body.faces.max() >= len(body.vertices):
            fault = f"a face refers to vertex {body.faces.max()} (from 0) of a body that has {len(body.vertices)}"
            raise damaged(path, fault)
    return _joined(bodies)


@contextmanager
def quiet_trimesh():
    """Keep trimesh's log and warnings to itself: what matters is said by an error."""
    logger = logging.getLogger("trimesh")
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)  # its modules' loggers inherit the level
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.setLevel(level)


def _read_json(path: Path, data: bytes) -> dict:
    """The header's JSON of a container whose parts are all there."""
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
    try:
        header = json.loads(data[20:end])
    except (ValueError, RecursionError):
        header = None
    if not isinstance(header, dict):
        raise damaged(path, "its JSON cannot be read")
    return header


def _require_readable(path: Path, header: dict) -> None:
    """Refuse what trimesh would read as zeros or leave out."""
    try:
        used = _COMPRESSED & set(header.get("extensionsUsed", []))
        accessors = header.get("accessors", [])
        primitives = [p for mesh in header.get("meshes", []) for p in mesh["primitives"]]
        attributes = [p["attributes"] for p in primitives]
        coordinates = [a[key] for a in attributes for key in ("POSITION", "TEXCOORD_0") if key in a]
        whole_numbers = any(accessors[index]["componentType"] != _FLOAT for index in coordinates)
        sparse = any("sparse" in accessor for accessor in accessors)
        fans = any(p.get("mode") == _TRIANGLE_FAN for p in primitives)
    except (AttributeError, KeyError, IndexError, TypeError) as fault:
        text = f"its JSON is not that of a glTF scene ({type(fault).__name__}: {fault})"
        raise damaged(path, text) from None
    faults = {
        ", ".join(sorted(used)): used,
        "quantized coordinates": whole_numbers,
        "sparse accessors": sparse,
        "triangle fans": fans,
    }
    found = [name for name, present in faults.items() if present]
    if found:
        raise MeshError(f"{path}: uses {' and '.join(found)}, which is not read. Wanted plain triangles; export it without compression.")


def _read_bodies(path: Path, data: bytes) -> list[Triangles]:
    import trimesh  # imported here, as it takes longer than reading most files

    resolver = trimesh.resolvers.FilePathResolver(str(path))
    with quiet_trimesh():
        try:
            scene = trimesh.load_scene(BytesIO(data), file_type="glb", resolver=resolver, process=False)
            bodies = [_body(scene, node) for node in scene.graph.nodes_geometry]
            return [body for body in bodies if body is not None and len(body.faces)]
        except Exception as fault:  # trimesh raises whatever the damaged place happens to cause
            text = f"{type(fault).__name__}: {fault}".rstrip(": ")
            raise damaged(path, f"its data do not fit their description ({text[:200]})") from None


def _body(scene, node: str) -> Triangles | None:
    """The node's triangles in the scene's frame, mirrored ones right side out; None for points and lines."""
    matrix, name = scene.graph[node]
    geometry = scene.geometry[name]
    faces = getattr(geometry, "faces", None)
    if faces is None:
        return None
    vertices = np.asarray(geometry.vertices, dtype=float) @ matrix[:3, :3].T + matrix[:3, 3]
    faces = np.asarray(faces, dtype=np.int64)
    uv = getattr(geometry.visual, "uv", None)
    uv = np.asarray(uv, dtype=float) if uv is not None and np.shape(uv) == (len(vertices), 2) else None
    mirrored = np.linalg.det(matrix[:3, :3]) < 0
    return Triangles(vertices, faces[:, ::-1] if mirrored else faces, uv, _texture(geometry.visual))


def _texture(visual):
    material = getattr(visual, "material", None)
    image = getattr(material, "baseColorTexture", None)
    return image if image is not None else getattr(material, "image", None)


def _joined(bodies: list[Triangles]) -> Triangles:
    if not bodies:
        return Triangles(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    starts = np.cumsum([0, *(len(body.vertices) for body in bodies)])
    faces = np.vstack([body.faces + start for body, start in zip(bodies, starts, strict=False)])
    uv = None
    if any(body.uv is not None for body in bodies):
        uv = np.vstack([np.zeros((len(body.vertices), 2)) if body.uv is None else body.uv for body in bodies])
    textures = {id(body.texture): body.texture for body in bodies if body.texture is not None}
    texture = next(iter(textures.values())) if len(textures) == 1 else None
    return Triangles(np.vstack([body.vertices for body in bodies]), faces, uv, texture)
