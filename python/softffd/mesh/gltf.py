"""glTF 2.0, binary (GLB) and text: what trimesh would pass over in silence is looked for before it reads them."""

import json
from pathlib import Path
from urllib.parse import unquote

from softffd.errors import MeshError
from softffd.mesh.bodies import read_bodies
from softffd.mesh.polygons import Triangles, beside, damaged, plain_text

_COMPRESSED = {
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
}
_FLOAT, _TRIANGLE_FAN = 5126, 6
_HARMLESS = ("KHR_lights_punctual", "KHR_animation_pointer", "KHR_xmp_json_ld", "KHR_xmp", "KHR_materials_variants")
"""Required or not, what they add is neither shape nor base colour; so is that of KHR_materials_*, but for one."""

_SPECULAR = "KHR_materials_pbrSpecularGlossiness"


def read_glb(path: Path, data: bytes) -> Triangles:
    """Return the triangles of all bodies of the file's scene, each in its place.

    Raises MeshError for damaged files, and for what is not read: compressed or sparse data, bones, shapes that are blended in,
    copies made by an extension, and every other extension that the file requires.
    """
    return _read(path, data, _read_json(path, data))


def read_gltf(path: Path, data: bytes) -> Triangles:
    """As read_glb, for the text with its data inside or in files beside it."""
    data = plain_text(data)
    header = _parsed(path, data)
    version = header.get("asset", {}).get("version") if isinstance(header.get("asset"), dict) else None
    if not str(version).startswith("2"):
        raise MeshError(f"{path}: wanted glTF version 2, got {f'version {version}' if version else 'no version'}")
    return _read(path, data, header)


def _read(path: Path, data: bytes, header: dict) -> Triangles:
    _require_readable(path, header)
    triangles = read_bodies(path, data, gltf=True)
    missing = _missing_images(path.parent, header)
    notes = [f"pictures that are not beside it: {', '.join(missing[:4])}"] if missing else []
    try:
        notes += _lost_looks(header)
    except (AttributeError, TypeError, ValueError) as fault:
        raise damaged(path, f"its JSON is not that of a glTF scene ({type(fault).__name__}: {fault})") from None
    return triangles._replace(looks=triangles.looks.and_notes(*notes))


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
    return _parsed(path, data[20:end])


def _parsed(path: Path, text: bytes) -> dict:
    try:
        header = json.loads(text)
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
        nodes = header.get("nodes", [])
        skinned = any("skin" in node and "mesh" in node for node in nodes)
        blended = any(any(each.get("weights", [])) for each in header.get("meshes", []) + nodes)
        copied = any("EXT_mesh_gpu_instancing" in node.get("extensions", {}) for node in nodes)
        required = {name for name in header.get("extensionsRequired", []) if name == _SPECULAR or not _harmless(name)} - used
        required |= {"EXT_mesh_gpu_instancing"} if copied else set()
        hidden = bool(primitives) and not header.get("scenes")
        away = [each["uri"] for each in header.get("buffers", []) if _leads_away(path.parent, each.get("uri", ""))]
    except (AttributeError, KeyError, IndexError, TypeError) as fault:
        text = f"its JSON is not that of a glTF scene ({type(fault).__name__}: {fault})"
        raise damaged(path, text) from None
    faults = {
        ", ".join(sorted(used)): used,
        "quantized coordinates": whole_numbers,
        "sparse accessors": sparse,
        "triangle fans": fans,
        "skins (bones)": skinned,
        "morph targets": blended,
        ", ".join(sorted(required)): required,
    }
    found = [name for name, present in faults.items() if present]
    if found:
        raise MeshError(f"{path}: uses {' and '.join(found)}, which is not read. Wanted plain triangles in place; export it without.")
    if hidden:
        raise MeshError(f"{path}: has {len(header['meshes'])} meshes but no scene that shows one; wanted a scene with them")
    if away:
        raise MeshError(f"{path}: its data lie outside of its folder ({away[0]}), where nothing is opened; wanted them beside it")


def _missing_images(folder: Path, header: dict) -> list[str]:
    images = header.get("images", [])
    names = [image.get("uri") for image in images if isinstance(image, dict)] if isinstance(images, list) else []
    names = [name for name in names if isinstance(name, str) and not name.startswith("data:")]
    return [name for name in names if (file := beside(folder, unquote(name))) is None or not file.is_file()]


def _leads_away(folder: Path, uri: str) -> bool:
    return not uri.startswith("data:") and beside(folder, unquote(uri)) is None


def _harmless(extension: str) -> bool:
    return extension in _HARMLESS or extension.startswith("KHR_materials_")


def _lost_looks(header: dict) -> list[str]:
    """What of the materials that are used is not kept, where it changes the base colour."""
    notes = []
    for material in header.get("materials", []):
        picture = material.get("pbrMetallicRoughness", {}).get("baseColorTexture", {})
        placing = picture.get("extensions", {}).get("KHR_texture_transform")
        if picture.get("texCoord", 0) or (placing or {}).get("texCoord", 0):
            notes.append("pictures placed by other texture coordinates than the first (texCoord) are placed by the first")
        if placing:
            notes.append("pictures are taken without being moved or scaled (KHR_texture_transform)")
        if _SPECULAR in material.get("extensions", {}):
            notes.append(f"colours by {_SPECULAR} are not read")
        textures = header.get("textures", [])
        texture = textures[picture["index"]] if picture.get("index", len(textures)) < len(textures) else {}
        if texture and texture.get("extensions"):
            notes.append(f"pictures by {', '.join(sorted(texture['extensions']))} are not read")
    return list(dict.fromkeys(notes))
