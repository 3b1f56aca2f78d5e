"""glTF 2.0, binary (GLB) and text. The JSON is simplified before trimesh reads the file; content that would be read wrongly is refused.

Content that is left out is reported in a note.
"""

import json
import math
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from softffd.errors import MeshError
from softffd.mesh.bodies import Surface, read_bodies
from softffd.mesh.polygons import Triangles, damaged, found_beside
from softffd.spelling import few

_COMPRESSED = {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_mesh_quantization"}
_READ = {
    *("KHR_texture_transform", "KHR_texture_basisu", "EXT_texture_webp"),
    *("KHR_lights_punctual", "KHR_xmp_json_ld", "KHR_animation_pointer"),
}
"""Extensions that a file may require beside those of materials: they are read, or reported, or change neither shape nor colour."""

_GLOSSY, _TRANSFORM, _INSTANCES = "KHR_materials_pbrSpecularGlossiness", "KHR_texture_transform", "EXT_mesh_gpu_instancing"
_FLOAT, _TRIANGLES, _TRIANGLE_FAN = 5126, 4, 6


def read_glb(path: Path, data: bytes) -> Triangles:
    """Returns the triangles of all bodies of the scene of the file, each in its place.

    Raises MeshError for damaged files, and for content that is not read: compressed or sparse data, skins, morph targets and instances.
    """
    end = _end_of_json(path, data)
    header = _parsed(path, data[20:end])
    return _read(path, header, lambda: glb_file(header, data[end:]))


def read_gltf(path: Path, data: bytes) -> Triangles:
    """Like read_glb, for the text form, whose data lie inside or in files beside it."""
    header = _parsed(path, data)
    version = header.get("asset", {}).get("version") if isinstance(header.get("asset"), dict) else None
    if not str(version).startswith("2"):
        raise MeshError(f"{path}: wanted glTF version 2, got {f'version {version}' if version else 'no version'}")
    return _read(path, header, lambda: json.dumps(header).encode())


def _read(path: Path, header: dict[str, Any], packed: Callable[[], bytes]) -> Triangles:
    surfaces, names, notes = _made_plain(path, header)
    return read_bodies(path, packed(), surfaces, names).and_notes(*notes)


def glb_file(header: dict[str, Any], rest: bytes) -> bytes:
    """Returns the bytes of a GLB file. rest: the blocks that follow the block of the JSON."""
    text = json.dumps(header, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON") + text + rest


def _end_of_json(path: Path, data: bytes) -> int:
    """Returns the position of the end of the JSON in a GLB container. Raises MeshError if the container is not complete."""
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


def _parsed(path: Path, text: bytes) -> dict[str, Any]:
    try:
        header = json.loads(text)  # UTF-8, UTF-16 or UTF-32, with or without a byte order mark
    except (ValueError, RecursionError):
        header = None
    if not isinstance(header, dict):
        raise damaged(path, "its JSON cannot be read")
    return header


def _made_plain(path: Path, header: dict[str, Any]) -> tuple[list[Surface], list[str], list[str]]:
    """Changes the header into one that trimesh reads correctly; returns surfaces of materials, names of nodes, notes on what is left out.

    Each material and node is renamed to its number in the list. Raises MeshError for content that is not read, or if this is no glTF scene.
    """
    try:
        _require_readable(path, header)
        _give_scene(header)
        _require_tree(path, header)
        names = [str(node.get("name", number)) for number, node in enumerate(header.get("nodes", []))]
        for number, node in enumerate(header.get("nodes", [])):
            node["name"] = str(number)  # trimesh adds a random end to the name of a node with several primitives
        surfaces = [_plain_material(number, material) for number, material in enumerate(header.get("materials", []))]
        primitives = [p for mesh in header.get("meshes", []) for p in mesh["primitives"]]
        for primitive in primitives:
            _use_coordinates(primitive, surfaces)
        _require_plain_numbers(path, header, primitives)
        return surfaces, names, _left_out(path, header, primitives)
    except (AttributeError, KeyError, IndexError, TypeError, ValueError, OverflowError) as fault:
        raise damaged(path, f"its JSON is not that of a glTF scene ({type(fault).__name__}: {fault})") from None


def _require_readable(path: Path, header: dict[str, Any]) -> None:
    """Refuses content that determines the positions of vertices in ways that are not read."""
    used, required = (set(header.get(key, [])) for key in ("extensionsUsed", "extensionsRequired"))
    nodes, meshes = [node for node in header.get("nodes", []) if "mesh" in node], header.get("meshes", [])
    weights = [(meshes[node["mesh"]], node.get("weights", meshes[node["mesh"]].get("weights", []))) for node in nodes]
    compressed = sorted((used | required) & _COMPRESSED)
    unknown = sorted(name for name in required - _READ - _COMPRESSED - {_INSTANCES} if not name.startswith("KHR_materials_"))
    faults = [
        (compressed, ", ".join(compressed), "export it without compression"),
        (any("skin" in node for node in nodes), "skins (bones)", "apply the armature, or export without it"),
        (
            any(any(given) and any("targets" in p for p in mesh["primitives"]) for mesh, given in weights),
            "morph targets (shape keys) whose weights are not 0",
            "apply the shape keys",
        ),
        (any(_INSTANCES in node.get("extensions", {}) for node in nodes), _INSTANCES, "make the instances real"),
        (unknown, f"{', '.join(unknown)} (extensionsRequired)", "export it without"),
    ]
    _refuse(path, {name: advice for present, name, advice in faults if present})


def _require_plain_numbers(path: Path, header: dict[str, Any], primitives: list[dict[str, Any]]) -> None:
    """Refuses vertices and corners that trimesh would read as zeros, or in other units."""
    accessors = header.get("accessors", [])
    drawn = [p for p in primitives if p.get("mode", _TRIANGLES) >= _TRIANGLES]
    attributes = [p["attributes"] for p in drawn]
    coordinates = [accessors[a[key]] for a in attributes for key in ("POSITION", "TEXCOORD_0") if key in a]
    others = [accessors[a["COLOR_0"]] for a in attributes if "COLOR_0" in a] + [accessors[p["indices"]] for p in drawn if "indices" in p]
    faults = {
        "quantized coordinates": any(each["componentType"] != _FLOAT for each in coordinates),
        "sparse accessors": any("sparse" in each for each in coordinates + others),
        "numbers without a bufferView": any("bufferView" not in each and "sparse" not in each for each in coordinates + others),
        "primitives without POSITION": any("POSITION" not in a for a in attributes),
        "triangle fans": any(p.get("mode") == _TRIANGLE_FAN for p in drawn),
    }
    _refuse(path, {name: "export plain triangles without compression" for name, present in faults.items() if present})


def _refuse(path: Path, found: dict[str, str]) -> None:
    if found:
        advice = "; ".join(dict.fromkeys(found.values()))
        raise MeshError(f"{path}: uses {' and '.join(found)}, which is not read. Wanted plain triangles; {advice}.")


def _give_scene(header: dict[str, Any]) -> None:
    """Makes all root nodes the scene if there is none. Removes cameras, since trimesh would misplace the children of their nodes."""
    nodes = header.get("nodes", [])
    for node in nodes:
        node.pop("camera", None)
    if not header.get("scenes"):
        inner = {child for node in nodes for child in node.get("children", [])}
        header["scenes"], header["scene"] = [{"nodes": [number for number in range(len(nodes)) if number not in inner]}], 0


def _require_tree(path: Path, header: dict[str, Any]) -> None:
    """Refuses a scene or a node that is not there, and a node that the scene reaches twice, as in a cycle."""
    scene, scenes, nodes = header.get("scene", 0), header["scenes"], header.get("nodes", [])
    if not 0 <= scene < len(scenes):
        raise damaged(path, f"scene: wanted the number of one of its {len(scenes)} scenes, from 0, got {scene}")
    reached: set[int] = set()
    ahead = list(scenes[scene].get("nodes", []))
    while ahead:
        number = ahead.pop()
        if not 0 <= number < len(nodes):
            raise damaged(path, f"nodes: wanted the number of one of its {len(nodes)} nodes, from 0, got {number}")
        if number in reached:
            raise damaged(path, f"nodes[{number}]: wanted one parent for each node at most, got a node that its scene reaches twice")
        reached.add(number)
        ahead += nodes[number].get("children", [])


def _plain_material(number: int, material: dict[str, Any]) -> Surface:
    glossy = material.get("extensions", {}).pop(_GLOSSY, None)
    if glossy is not None:
        wanted = {"baseColorFactor": "diffuseFactor", "baseColorTexture": "diffuseTexture"}
        material["pbrMetallicRoughness"] = {key: glossy[old] for key, old in wanted.items() if old in glossy}
    name, material["name"] = material.get("name", ""), str(number)
    texture = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    if texture is None:
        return Surface(name)
    given = texture.get("extensions", {}).get(_TRANSFORM, {})
    turn, (across, down) = float(given.get("rotation", 0.0)), map(float, given.get("scale", (1.0, 1.0)))
    moved = np.array(given.get("offset", (0.0, 0.0)), dtype=float).reshape(2)
    cos, sin = math.cos(turn), math.sin(turn)
    # texture coordinates (v down) are scaled first, then turned counter-clockwise as seen
    matrix = np.array([[cos * across, sin * down], [-sin * across, cos * down]])
    return Surface(name, matrix, moved, int(given.get("texCoord", texture.get("texCoord", 0))))


def _use_coordinates(primitive: dict[str, Any], surfaces: list[Surface]) -> None:
    """Makes the texture coordinates of the base colour's picture the first set, since trimesh reads only the first set."""
    attributes = primitive["attributes"]
    wanted = surfaces[primitive["material"]].coordinates if "material" in primitive else 0
    if wanted != 0:
        attributes.pop("TEXCOORD_0", None)
        if f"TEXCOORD_{wanted}" in attributes:
            attributes["TEXCOORD_0"] = attributes[f"TEXCOORD_{wanted}"]


def _left_out(path: Path, header: dict[str, Any], primitives: list[dict[str, Any]]) -> list[str]:
    images = header.get("images", [])
    names = [image.get("uri", "data:") for image in images]
    missing = [name for name in names if not name.startswith("data:") and not found_beside(path.parent, name)]
    textures = [texture for texture in header.get("textures", []) if "KHR_texture_basisu" in texture.get("extensions", {})]
    compressed = any("source" not in t or images[t["source"]].get("mimeType") == "image/ktx2" for t in textures)
    lines = any(p.get("mode", _TRIANGLES) < _TRIANGLES for p in primitives)
    notes = {
        f"pictures that are not beside it: {few(missing)}": missing,
        "pictures in KTX2 (KHR_texture_basisu) are not read; PNG and JPEG are": compressed,
        "points and lines": lines,
    }
    return [note for note, present in notes.items() if present]
