"""Wavefront MTL: the colour (Kd), picture (map_Kd) and opacity of each material; read and written for OBJ files."""

import re
from collections.abc import Iterable
from math import isnan, nan
from pathlib import Path

from softffd.mesh.looks import Colour, Material, Picture
from softffd.mesh.polygons import beside, decoded, found_beside, open_texture, plain_text
from softffd.spelling import few

_PLACING = {"-s", "-o", "-t"}
_TAKES_A_WORD = {"-colorspace", "-imfchan", "-type"}
_COMMENT = re.compile(r"\s+#(?!\d+$).*")
"""`Material #25` is a name, `red # of the roof` is a name with a comment."""


class Library:
    """The materials of the libraries of an OBJ file, read from the folder of that file, and notes on what cannot be kept."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._records: dict[str, dict[str, str]] = {}
        self._images: dict[Path, Picture | None] = {}
        self._missing: list[str] = []
        self.notes: list[str] = []

    def read(self, names: str) -> None:
        """Reads the files that a `mtllib` record names: one file, or several."""
        whole = (names.strip('"'), without_comment(names).strip('"'))
        several = next(([name] for name in whole if found_beside(self._folder, name, anywhere=True)), whole[1].split())
        for name in several:
            file = found_beside(self._folder, name, anywhere=True)
            if file is None:
                self._missing.append(name if beside(self._folder, name) else f"{name}, which is outside of its folder,")
            else:
                self._read_lines(decoded(plain_text(file.read_bytes())).splitlines())

    def _read_lines(self, lines: list[str]) -> None:
        record: dict[str, str] = {}
        for line in lines:
            key, _, value = line.strip().replace("\t", " ").partition(" ")
            if key.lower() == "newmtl":
                record = {}
                name = " ".join(value.split())
                self._records[name] = record
                self._records.setdefault(without_comment(name), record)
            else:
                record[key.lower()] = value.strip()

    def materials(self, names: Iterable[str]) -> tuple[Material, ...]:
        """Returns the materials of these names; adds to `notes` what they lack."""
        names = [name if name in self._records else without_comment(name) for name in names]
        materials = tuple(self._material(name) for name in names)
        unknown = [name for name in names if name and name not in self._records]
        if unknown:
            why = f"{' and '.join(self._missing)} cannot be read" if self._missing else "no material library (MTL) describes them"
            self.notes.append(f"materials without a colour ({few(unknown)}): {why}")
        given = {key for name in names for key in self._records.get(name, {}) if key.startswith(("map_", "bump", "norm", "disp"))}
        if lost := sorted(given - {"map_kd"}):
            self.notes.append(f"pictures other than map_Kd are not kept: {few(lost)}")
        if clear := [material.name for material in materials if material.opacity < 1]:
            self.notes.append(f"transparent materials are shown opaque: {few(clear)}")
        return materials

    def _material(self, name: str) -> Material:
        record = self._records.get(name, {})
        texture = self._texture(name, record["map_kd"]) if record.get("map_kd") else None
        colour = _colour(record.get("kd", "")) if texture is None else None  # exporters leave Kd black under a picture
        opacity = _number(record["d"]) if "d" in record else 1.0 - _number(record.get("tr", "0"))
        return Material(name, colour, texture, 1.0 if isnan(opacity) else min(max(opacity, 0.0), 1.0))

    def _texture(self, material: str, value: str) -> Picture | None:
        words = value.split()
        while words and words[0].startswith("-"):
            option = words.pop(0)
            if option in _TAKES_A_WORD:
                del words[:1]
            if option in _PLACING:
                self.notes.append(f"material {material}: its picture is taken without being moved or scaled (map_Kd {value})")
            while len(words) > 1 and (not isnan(_number(words[0])) or words[0] in ("on", "off")):
                words.pop(0)
        name = " ".join(words)
        names = (name.strip('"'), without_comment(name).strip('"'))
        file = next(filter(None, (found_beside(self._folder, each, anywhere=True) for each in names)), None)
        if file is None:
            if beside(self._folder, names[1]) is None:
                why = "is outside of the mesh's folder: it is not opened"
            else:
                why = "is missing or cannot be read"
            self.notes.append(f"material {material}: its picture {names[1]} {why}")
            return None
        if file not in self._images:
            self._images[file] = open_texture(file)
            if self._images[file] is None:
                self.notes.append(f"material {material}: its picture {file.name} is missing or cannot be read")
        return self._images[file]


def without_comment(name: str) -> str:
    """Returns the name without a comment that follows."""
    return _COMMENT.sub("", name)


def mtl_text(materials: Iterable[tuple[str, Material]], files: dict[int, str]) -> str:
    """Returns the text of an MTL file of materials with names. files: file name of each texture by its id()."""
    lines = []
    for name, material in materials:
        lines.append(f"newmtl {name}")
        if material.colour is not None or material.texture is not None:
            lines.append("Kd " + " ".join(f"{channel:.6g}" for channel in material.colour or (1, 1, 1)))
        if material.opacity < 1:
            lines.append(f"d {material.opacity:.6g}")
        if material.texture is not None:
            lines.append(f"map_Kd {files[id(material.texture)]}")
    return "\n".join(lines) + "\n"


def _colour(value: str) -> Colour | None:
    """Returns a colour from three numbers, or one number for all three; None for other values, such as a spectrum."""
    numbers = [_number(word) for word in value.split()[:3]]
    if not numbers or any(map(isnan, numbers)):
        return None
    red, green, blue = (min(max(number, 0.0), 1.0) for number in (numbers * 3)[:3])
    return red, green, blue


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return nan
