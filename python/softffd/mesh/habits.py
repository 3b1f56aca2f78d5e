"""What a kind of mesh file says, or its habit is, of unit and up axis."""

import re
from pathlib import Path
from typing import NamedTuple
from zipfile import BadZipFile, ZipFile

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres per unit."""

WORDS = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "in": "inches", "ft": "feet"}

_UP = {".obj": "y", ".ply": "y", ".glb": "y", ".gltf": "y", ".dae": "y"}
"""Of the others it is z."""

_3MF = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}


class Habit(NamedTuple):
    """metres: per unit of the file, where it or its kind says so, else None. up: its up axis; said: whether the file says that."""

    metres: float | None
    up: str
    said: bool


def habit_of(path: Path) -> Habit:
    """The habit of a mesh file that can be read."""
    kind = path.suffix.lower()
    if kind == ".3mf":
        return Habit(_3MF.get(_found(rb'<model[^>]*\sunit="(\w+)"', _model(path)) or "millimeter"), "z", True)
    if kind == ".dae":
        head = path.read_bytes()
        metres, up = _found(rb'<unit[^>]*\smeter="([0-9.eE+-]+)"', head), _found(rb"<up_axis>\s*([XYZ])_UP", head)
        return Habit(float(metres) if metres else 1.0, (up or "Y").lower(), True)
    gltf = kind in (".glb", ".gltf")
    return Habit(1.0 if gltf else None, _UP.get(kind, "z"), gltf)


def _model(path: Path) -> bytes:
    try:
        with ZipFile(path) as archive:
            return next((archive.read(name) for name in archive.namelist() if name.lower().endswith("3dmodel.model")), b"")
    except BadZipFile:
        return b""


def _found(pattern: bytes, text: bytes) -> str | None:
    match = re.search(pattern, text)
    return match[1].decode() if match else None
