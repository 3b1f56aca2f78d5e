"""Writes the FMU of a scene, a file `.fmu`."""

from __future__ import annotations

import hashlib
import math
import uuid
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from softffd.embedding import patches
from softffd.embedding.mass import Masses, point_masses
from softffd.embedding.mass_solid import node_masses
from softffd.embedding.samples import Samples, surface_samples
from softffd.errors import SoftffdError
from softffd.files import path_with
from softffd.fmu.archive import write_archive
from softffd.fmu.interface import Interface, scene_interface
from softffd.fmu.model_description import completed, model_description, model_description3, xml_text
from softffd.fmu.notes import NAME as NOTES
from softffd.fmu.notes import body_notes
from softffd.fmu.records import NAME, scene_records, scene_text
from softffd.fmu.terminals import PLACE as TERMINALS
from softffd.fmu.terminals import terminals
from softffd.fmu.variables import Variable, variables
from softffd.installed import data_folder, libraries
from softffd.lattice import cells_within, shared_by_corners, to_flat

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

PLATFORMS3 = {"linux64": "x86_64-linux", "win64": "x86_64-windows", "darwin64": "x86_64-darwin"}
"""FMI 3.0 names of the platforms, where they differ from those of FMI 2.0."""
ARM, X86 = "aarch64-linux", "linux64"


def binary_folders(platforms: Iterable[str], fmi: int) -> dict[str, str]:
    """Returns the folders of an FMU's `binaries`, each with the platform whose library it holds.

    In FMI 2.0 linux64 is x86-64, and ARM has the name aarch64-linux of FMI 3.0 (FMI 2.0.4, section 2.3). But importers of FMI 2.0 look
    for ARM's library in linux64 (docs/platforms.md). So ARM's library is put there too, unless the FMU has one for x86-64.
    """
    found = {name if fmi == 2 else PLATFORMS3.get(name, name): name for name in platforms}
    return found | ({X86: ARM} if fmi == 2 and ARM in found and X86 not in found else {})


def platform_notes(platforms: Collection[str], fmi: int) -> list[str]:
    """Returns notes for the user on the folders in which importers look for libraries."""
    if fmi != 2 or ARM not in platforms:
        return []
    if X86 in platforms:
        return [
            f"on ARM, importers that look in binaries/{X86} find the library of x86-64 there, which they cannot load: for FMPy, FMI "
            f"Library, fmi4c, rust-fmi and fmusim on ARM, build with --platform {ARM} alone"
        ]
    return [f"binaries/{X86} has the library of ARM, where importers on ARM look for it: no machine with x86-64 can load this FMU"]


_point_masses, _node_masses = lru_cache(maxsize=1)(point_masses), lru_cache(maxsize=1)(node_masses)
"""Cached, with the last result kept: over a fine lattice and mesh the masses take minutes, and an FMU, its summary and a run need the
same"""


def scene_masses(scene: Scene) -> Masses:
    """Returns the masses (n,) [kg] of the control points, or of a solid's nodes, including overrides by regions, and the shift (3,) [m]
    of the centre of mass by mass.uniform_share."""
    lattice, given = scene.lattice, scene.mass
    body: dict[str, Any] = {"counts": lattice.points, "origin": lattice.origin, "size": lattice.size, "mesh": scene.loaded_mesh}
    body |= {"total": given.total, "density": given.density}
    if scene.is_solid:
        masses = _node_masses(given.distribution, **body)
    else:
        how: dict[str, Any] = {"uniform_share": given.uniform_share, "basis": lattice.basis, "inertia": given.inertia}
        masses = _point_masses(given.distribution, **body, **how)
    mass = masses.mass.copy()
    if any(region.density is not None for region in scene.region):
        mass = _of_cells(scene, masses.mass.sum())
    for region in scene.region:
        if region.mass is not None:
            mass[scene.select(region.points)] = region.mass
    return replace(masses, mass=mass)


_surface_samples = lru_cache(maxsize=1)(surface_samples)


def scene_samples(scene: Scene) -> Samples | None:
    """Returns the samples of the surface that the scene's obstacles meet; None if they meet the control points, and without obstacles."""
    if scene.contact.of == "lattice" or not scene.obstacles:
        return None
    assert scene.loaded_mesh is not None
    return _surface_samples(scene.loaded_mesh, scene.lattice_box, scene.contact.penetration)


def scene_patches(scene: Scene, samples: Samples | None) -> patches.Patches | None:
    """Returns the patches of the scene's sensors, and the areas around all places that obstacles may touch; None without sensors.

    samples: those of the surface that the scene's obstacles meet; None if the obstacles meet the control points."""
    if not scene.sensor:
        return None
    if samples is None:
        places, areas = (find(scene.lattice_box, solid=scene.is_solid) for find in (patches.lattice_places, patches.lattice_areas))
        around = [patches.points_on(sensor.where, areas, places) for sensor in scene.sensor]
    else:
        mesh, places = scene.loaded_mesh, samples.places
        assert mesh is not None
        of_vertex = patches.nearest(mesh.vertices, places)
        areas = patches.areas_around(mesh, of_vertex, len(places))
        around = [
            np.bincount(of_vertex, patches.vertices_on(sensor.where, mesh), len(places)).astype(np.float64) for sensor in scene.sensor
        ]
    found = []
    for sensor, weights in zip(scene.sensor, around, strict=True):
        mine = weights.nonzero()[0]
        shares = patches.taxel_shares(mine, places, areas, sensor.taxels) if sensor.taxels else []
        found.append(patches.Patch(sensor.name, mine, weights[mine], sensor.taxels, shares))
    return patches.Patches(areas, found)


def _of_cells(scene: Scene, total: float) -> np.ndarray:
    """Returns the points' masses (n,) [kg] if regions give cells a density of their own. The other cells have the mass that an even
    spread of `total` over all cells gives them."""
    counts = scene.lattice.points
    cells = np.full([count - 1 for count in counts], total / math.prod(count - 1 for count in counts))
    for region in scene.region:
        if region.density is not None:
            cells[cells_within(scene.select(region.points), counts)] = region.density * math.prod(scene.lattice_box.size) / cells.size
    return to_flat(shared_by_corners(cells)[..., None])[:, 0]


def package_fmu(
    scene: Scene | str | Path, path: str | Path, *, platforms: Iterable[str] | str | None = None, fmi: Literal[2, 3] = 2,
    extra: Mapping[str, bytes] | None = None,
) -> Path:  # fmt: skip
    """Writes the scene's FMU and returns its path. The same scene gives the same bytes.

    scene: a scene, the path of its file, or the name of a shipped one.
    path: a file name ending in .fmu; missing folders are made.
    platforms: FMI names (linux64, ...) of the platforms whose libraries the FMU contains; by default all that this installation has.
        SoftffdError if one is missing.
    fmi: 2 for FMI 2.0, 3 for FMI 3.0, whose variables are arrays.
    extra: further files by their names in the FMU, such as those of softffd.run.reference.
    """
    from softffd.scene.scene import scene_of  # imports pydantic, which opening an FMU does not need

    scene = scene_of(scene, "package_fmu")
    path = path_with(".fmu", path)
    if fmi not in (2, 3):
        raise SoftffdError(f"fmi: wanted 2 or 3, got {fmi!r:.70}")
    found = libraries([platforms] if isinstance(platforms, str) else platforms)
    texts, listed, _ = scene_texts(scene, fmi)
    if (document := terminals(listed, fmi, flat=scene.fmu.names == "flat")) is not None:
        texts[TERMINALS] = xml_text(document).encode()
    icon = "model.png" if fmi == 2 else "terminalsAndIcons/icon.png"
    files = {
        **{file.relative_to(data_folder()).as_posix(): file for file in (data_folder() / "documentation").rglob("*") if file.is_file()},
        icon: data_folder() / "model.png",
        **{f"binaries/{folder}/{found[name].name}": found[name] for folder, name in binary_folders(found, fmi).items()},
    }
    write_archive(path, texts | {name: file.read_bytes() for name, file in files.items()} | dict(extra or {}))
    return path


def write_folder(scene: Scene, folder: Path) -> Interface:
    """Writes the files that a run of the scene's FMU reads into an existing folder, unpacked; the library stays where it is installed."""
    texts, listed, guid = scene_texts(scene)
    (folder / "resources").mkdir()
    for name, text in texts.items():
        (folder / name).write_bytes(text)
    return scene_interface(scene, listed, guid)


def scene_texts(scene: Scene, fmi: int = 2) -> tuple[dict[str, bytes], list[Variable], str]:
    """Returns the files of an FMU that differ from scene to scene, its variables, and its guid, which is a hash of description and
    records."""
    masses, samples = scene_masses(scene), scene_samples(scene)
    listed = variables(scene, masses.mass)
    description = (model_description if fmi == 2 else model_description3)(scene, listed)
    records = scene_records(scene, masses, samples, scene_patches(scene, samples))
    guid = f"{{{uuid.UUID(hashlib.sha256((description + records).encode()).hexdigest()[:32])}}}"
    texts = {"modelDescription.xml": completed(description, guid).encode(), f"resources/{NAME}": scene_text(records, guid).encode()}
    if notes := body_notes(scene, masses, samples):
        texts[f"resources/{NOTES}"] = "".join(f"{note}\n" for note in notes).encode()
    return texts, listed, guid
