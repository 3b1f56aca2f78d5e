"""Unit and up axis of a mesh file: as given in the file, else as usual for its kind."""

import math
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree
from zipfile import ZipFile

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres per unit."""

WORDS = {"m": "metres", "cm": "centimetres", "mm": "millimetres", "in": "inches", "ft": "feet"}

LONGEST_IN_METRES = 20.0
"""A mesh without a given unit is taken to be in millimetres if its longest side exceeds this number of units."""

_UP = {".obj": "y", ".ply": "y", ".glb": "y", ".gltf": "y", ".dae": "y"}
"""Usual up axis by kind of file; z for other kinds."""

_3MF = {"micron": 1e-6, "millimeter": 1e-3, "centimeter": 1e-2, "inch": 0.0254, "foot": 0.3048, "meter": 1.0}


class Habit(NamedTuple):
    """metres: metres per unit, if the file or its kind defines the unit, else None. up: the up axis. said: True if the file gives the axis.

    wrong: the text of an unknown unit in the file, else empty.
    """

    metres: float | None
    up: str
    said: bool
    wrong: str = ""


def likely_unit(longest: float) -> str:
    """Returns the likely unit, "m" or "mm", of a file without a unit, from the longest side of its mesh [units]."""
    return "m" if longest <= LONGEST_IN_METRES else "mm"


def words_of(metres: float) -> str:
    """Returns the name of a unit of `metres` metres."""
    return next((WORDS[key] for key, each in UNITS.items() if each == metres), f"units of {metres:g} m")


def doubt(habit: Habit, longest: float) -> str:
    """Returns a hint, with the unit and the `scale` to give, if the file was read as metres but is likely in another unit; else "".

    longest: longest side of the mesh [units].
    """
    metres = habit.metres or UNITS[likely_unit(longest)]
    if metres == 1.0:
        return ""
    return f"{'the file is' if habit.metres else 'likely'} in {words_of(metres)}: load_mesh(..., scale={metres:g})"


def usual_up(path: Path) -> str:
    """Returns the usual up axis of this kind of file."""
    return _UP.get(path.suffix.lower(), "z")


def habit_of(path: Path) -> Habit:
    """Returns the habit of a mesh file that load_mesh has read."""
    kind = path.suffix.lower()
    if kind == ".3mf":
        unit = _unit_of_3mf(path)
        return Habit(_3MF.get(unit), "z", True, "" if unit in _3MF else unit)
    if kind == ".dae":
        return _collada(path.read_bytes())
    gltf = kind in (".glb", ".gltf")
    return Habit(1.0 if gltf else None, usual_up(path), gltf)


def _collada(data: bytes) -> Habit:
    """Reads the <asset> element; without it the unit is the metre and y is up. Some programs write a decimal comma."""
    root = ElementTree.fromstring(data)
    unit = root.find("{*}asset/{*}unit")
    text = "1" if unit is None else unit.attrib.get("meter", "1")
    up = (root.findtext("{*}asset/{*}up_axis") or "Y_UP").strip().upper()
    try:
        metres = float(text.replace(",", "."))
    except ValueError:
        metres = 0.0
    metres = metres if 0 < metres < math.inf else 0.0
    known = up in ("X_UP", "Y_UP", "Z_UP")
    return Habit(metres or None, up[0].lower() if known else "y", known, "" if metres else text)


def _unit_of_3mf(path: Path) -> str:
    with ZipFile(path) as archive:
        name = next(name for name in archive.namelist() if name.lower().endswith("3dmodel.model"))
        with archive.open(name) as stream:  # only the root element is read
            _, root = next(ElementTree.iterparse(stream, ("start",)))
            return root.attrib.get("unit", "millimeter")
