"""COLLADA: trimesh reads the bodies; the XML is searched for what trimesh skips, and this is reported."""

from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from softffd.errors import MeshError
from softffd.mesh.bodies import read_bodies, require_package
from softffd.mesh.polygons import Triangles, damaged, found_beside
from softffd.spelling import few

_PRIMITIVES = ("triangles", "polylist", "polygons", "tristrips", "trifans")


def read_dae(path: Path, data: bytes) -> Triangles:
    """Like read_bodies; notes report the bodies and looks that are not read. Raises MeshError, with the reason, if no body can be read."""
    require_package(path)
    try:
        elements = list(ElementTree.fromstring(data).iter())
    except (ElementTree.ParseError, ValueError, LookupError) as fault:
        raise damaged(path, f"its XML cannot be read ({fault})") from None
    if not _named(elements, "instance_visual_scene"):
        raise MeshError(f"{path}: has no scene, so no vertices are placed; wanted <scene> with a visual scene")
    _require_points(path, elements)
    lost = _lost_bodies(elements)
    triangles = read_bodies(path, data)
    if lost and not len(triangles.faces):
        raise MeshError(f"{path}: none of its bodies can be read: {'; '.join(lost)}. Wanted meshes that are placed in the scene directly.")
    return triangles.and_notes(*lost, *_lost_looks(path, elements, triangles))


def _require_points(path: Path, elements: list[Element]) -> None:
    """Refuses numbers with the decimal comma of some countries, which would end the list of numbers."""
    number = next((word for each in _named(elements, "float_array") for word in (each.text or "").split() if "," in word), None)
    if number:
        raise MeshError(f"{path}: has numbers with a decimal comma, such as {number}; wanted decimal points (export in an English locale)")


def _lost_bodies(elements: list[Element]) -> list[str]:
    known = {each.attrib["id"] for each in elements if "id" in each.attrib}
    skins = [each.get("url", "") for each in _named(elements, "instance_controller")]
    geometries = _named(elements, "instance_geometry", "instance_node", "instance_visual_scene")
    outside = sorted({url for url in (each.get("url", "") for each in geometries) if not url.startswith("#")})
    named = [each.get("url", "") for each in geometries] + [each.get("source", "") for each in _named(elements, "input")]
    broken = sorted({name for name in named if name.startswith("#") and unquote(name[1:]) not in known and name[1:] not in known})
    notes = {
        f"bodies on a skin or morph ({few(skins)}), which are not read: apply the armature, or export without it": skins,
        f"bodies in other files ({few(outside)}), which are not read": outside,
        f"broken references ({few(broken)})": broken,
    }
    return [note for note, present in notes.items() if present]


def _lost_looks(path: Path, elements: list[Element], triangles: Triangles) -> list[str]:
    files = [each.text or "" for image in _named(elements, "image") for each in image.iter() if _name(each) in ("init_from", "ref")]
    missing = [name for name in map(str.strip, files) if name and not found_beside(path.parent, name)]
    drawn = _named(elements, *_PRIMITIVES)
    bound = {each.get("symbol") for each in _named(elements, "instance_material")}
    coloured = any(each.get("semantic") == "COLOR" and body.get("material") in bound for body in drawn for each in body)
    notes = {
        "the names of its materials are not read": triangles.looks.materials,
        f"pictures that are not beside it: {few(missing)}": missing,
        "colours of vertices of bodies that have a material": coloured,
    }
    return [note for note, present in notes.items() if present]


def _named(elements: list[Element], *names: str) -> list[Element]:
    return [each for each in elements if _name(each) in names]


def _name(element: Element) -> str:
    return element.tag.rpartition("}")[2]
