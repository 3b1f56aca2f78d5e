"""What a kind of mesh file says, or its habit is, of unit and up axis."""

from io import BytesIO
from math import inf
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree
from zipfile import BadZipFile, ZipFile

from softffd.errors import MeshError

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres per unit."""

WORDS = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "in": "inches", "ft": "feet"}

_UP = {".obj": "y", ".ply": "y", ".glb": "y", ".gltf": "y", ".dae": "y"}
"""Of the others it is z."""

_3MF = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}

_HEAD = 2**16
"""Bytes of a 3MF's model that are looked at for its first element."""


class Habit(NamedTuple):
    """metres: per unit of the file, where it or its kind says so, else None. up: its up axis; said: whether the file says that."""

    metres: float | None
    up: str
    said: bool


def habit_of(path: Path) -> Habit:
    """The habit of a mesh file that can be read."""
    kind = path.suffix.lower()
    if kind == ".3mf":
        model = _first_tags(_model(path), "model")
        return Habit(_3MF.get(model.get("model", ("", {}))[1].get("unit", "millimeter"), 1e-3), "z", True)
    if kind == ".dae":
        tags = _first_tags(path.read_bytes(), "unit", "up_axis")
        metres = _number(tags.get("unit", ("", {}))[1].get("meter", "1"))
        if metres is None:
            raise MeshError(f"{path}: <unit meter={tags['unit'][1]['meter']!r}>: wanted a number of metres > 0, as in 0.01")
        return Habit(metres, (tags.get("up_axis", ("", {}))[0].strip()[:1] or "y").lower(), True)
    gltf = kind in (".glb", ".gltf")
    return Habit(1.0 if gltf else None, _UP.get(kind, "z"), gltf)


def _model(path: Path) -> bytes:
    try:
        with ZipFile(path) as archive:
            name = next((name for name in archive.namelist() if name.lower().endswith("3dmodel.model")), None)
            if name is None:
                return b""
            with archive.open(name) as stream:
                return stream.read(_HEAD)
    except BadZipFile:
        return b""


def _first_tags(text: bytes, *names: str) -> dict[str, tuple[str, dict[str, str]]]:
    """Text and attributes of the first element of each name, whatever its namespace; what is damaged ends the search."""
    found: dict[str, tuple[str, dict[str, str]]] = {}
    try:
        for event, element in ElementTree.iterparse(BytesIO(text), ("start", "end")):
            name = element.tag.rpartition("}")[2]
            if name in names and (event == "end" or name == "model"):
                found.setdefault(name, (element.text or "", dict(element.attrib)))
            if len(found) == len(names) or (event == "end" and name == "asset"):
                break
    except ElementTree.ParseError:
        pass
    return found


def _number(word: str) -> float | None:
    """A finite number > 0; a comma may stand for its point."""
    try:
        number = float(word.replace(",", "."))
    except ValueError:
        return None
    return number if 0 < number < inf else None
