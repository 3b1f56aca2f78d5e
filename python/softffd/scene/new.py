"""New scene files: a commented template with every key, and the scene of a mesh that falls on the ground."""

import json
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from softffd.embedding.mass import filled_words, point_masses
from softffd.errors import SoftffdError
from softffd.files import seen_from
from softffd.mesh.files import load_mesh, placed
from softffd.mesh.habits import UNITS, habit_of, likely_unit, words_of
from softffd.mesh.mesh import Mesh
from softffd.mesh.normals import merge_by_position
from softffd.spelling import wanted_one_of

TEMPLATE, MESH_TEMPLATE = (Path(__file__).parent / f"{name}.toml" for name in ("template", "mesh_template"))
GRAVITY = 9.81
DENSITY = 100.0  # density of soft foam [kg/m3]
FALL, STIFFNESS, DAMPING, STOP = 0.25, 1.2, 0.2, 7.0
"""Ratios: fall height to longest side; stiffness to weight over height; internal damping to the time of a free fall through half the
height; stop time to that through half the longest side. Meshes of many shapes then bend visibly, keep the tolerance and come to rest."""


def template(name: str) -> str:
    """Returns the text of a new scene called `name`, with every section and key and their units, ready to run.

    A line that begins with `#` without a blank is a key that is not in force; removing the `#` puts the key in force.
    """
    title = toml_string(f"{name}: a soft box dropped on the ground")
    return TEMPLATE.read_text(encoding="utf-8").replace('"TITLE"', title)


def toml_string(text: str) -> str:
    """Returns the text as a TOML string; parts that are no Unicode, as in file names of other encodings, become "?"."""
    text = text.encode(errors="replace").decode()
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


@dataclass(frozen=True)
class MeshScene:
    """text: the scene file (TOML). said: lines that report what was read and what was assumed."""

    text: str
    said: str


def scene_of_mesh(
    file: str | Path, *, folder: str | Path, unit: str | None = None, up: str | None = None, density: float | None = None
) -> MeshScene:
    """Returns the scene of a mesh that falls on the ground.

    folder: future folder of the scene file. unit: of the mesh file, m, cm, mm, in or ft. up: the axis of the file that becomes +z. For
    None the file decides, else the custom for its kind and size. density: kg/m3. Raises MeshError (mesh), SoftffdError (options).
    """
    file = Path(file)
    if unit is not None and unit not in UNITS:
        raise SoftffdError(f"--unit: {wanted_one_of(UNITS, unit)}")
    if up is not None and up not in ("x", "y", "z"):
        raise SoftffdError(f"--up: {wanted_one_of('xyz', up)}")
    if density is not None and not (np.isfinite(density) and density > 0):
        raise SoftffdError(f"--density: wanted > 0 kg/m3, got {density:g}")
    if str(file).encode(errors="replace") != os.fsencode(file):
        raise SoftffdError(f"{str(file)!a}: the name is not text in UTF-8, which a scene needs to name it; wanted another name")
    mesh, habit = load_mesh(file), habit_of(file)
    extent = np.ptp(mesh.bounds, axis=0)
    guess = likely_unit(extent.max())
    metres, axis = UNITS[unit] if unit else habit.metres or UNITS[guess], up or habit.up
    named = words_of(metres)
    lack = f"the file's unit {habit.wrong!r} is none" if habit.wrong else "no unit in the file"
    guessed = f"{lack}: taken as {named}, --unit {'m' if guess == 'mm' else 'mm'} otherwise"
    other = "z" if axis == "y" else "y"
    upright = f"{axis} up" if up or habit.said else f"{axis} up as usual for {file.suffix[1:].upper()}, --up {other} otherwise"
    places = len(merge_by_position(mesh.vertices)[1])
    size = f"{places:,} vertices, " + " x ".join(f"{side:.4g}" for side in extent)
    said = f"{file}: {size}, {f'in {named}' if unit or habit.metres else guessed}; {upright}"
    if filled := filled_words(mesh, extent):
        said += f"; {filled}"
    keys = {
        "TITLE": toml_string(f"{file.stem} dropped on the ground"), "FILE": toml_string(seen_from(folder, file)),
        "MEASURED": size, "SCALE": repr(metres), "METRES": named, "UP": axis,
    }  # fmt: skip
    keys |= _physics(placed(mesh, scale=metres, up=axis), DENSITY if density is None else density)
    said += (
        f"\n  mass {float(keys['TOTAL']):.6g} kg: {keys['WHY']}; lattice 4 x 4 x 4, "
        f"stiffness {float(keys['STIFFNESS']):g} N/m, internal damping {keys['DAMPING']} s"
    )
    return MeshScene(re.sub("[A-Z]{2,}", lambda word: keys.get(word[0], word[0]), MESH_TEMPLATE.read_text(encoding="utf-8")), said)


def _physics(mesh: Mesh, density: float) -> dict[str, str]:
    """Returns values for a fall from at most the height of the mesh that bends the mesh visibly and is over at the stop time."""
    height, longest = np.ptp(mesh.bounds, axis=0)[2], np.ptp(mesh.bounds, axis=0).max()
    ground = mesh.bounds[0, 2] - min(FALL * longest, height)
    spread, mass, why = _mass(mesh, density)
    pace = np.sqrt(longest / GRAVITY)
    return {
        "TOTAL": _precise(mass, mass), "SPREAD": spread, "WHY": why,
        "STIFFNESS": _short(STIFFNESS * mass * GRAVITY / height), "DAMPING": _short(DAMPING * np.sqrt(height / GRAVITY)),
        "GROUND": _precise(ground, longest), "STOP": _short(STOP * pace), "STEP": _short(STOP * pace / 250),
    }  # fmt: skip


def _mass(mesh: Mesh, density: float) -> tuple[str, float, str]:
    low, high = mesh.bounds
    try:
        masses = point_masses("volume", counts=(4, 4, 4), origin=low, size=high - low, mesh=mesh, density=density)
    except SoftffdError:
        half = density * float(np.prod(high - low)) / 2
        edges = f"it is not closed: {mesh.open_edges} edges belong to holes or to faces turned inside out"
        fault = "a body of it is inside out, or it encloses nothing" if mesh.closed else edges
        return "surface", half, f"half of the mesh's box at {density:g} kg/m3, since {fault}"
    return "volume", float(masses.mass.sum()), f"the mesh at {density:g} kg/m3"


def _precise(value: float, size: float) -> str:
    """Returns the value with as many decimals as are a millionth of `size`."""
    return repr(round(float(value), 6 - math.floor(math.log10(size))))


def _short(value: float) -> str:
    return f"{value:.2g}"
