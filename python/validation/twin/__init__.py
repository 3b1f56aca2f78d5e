"""An independent twin of a scene's component: an FMU with the same variables and the same model, implemented again in numpy.

Run the component and the twin side by side and compare. Where the results differ, one of them is wrong, or the motion is
chaotic. The twin is packaged with pythonfmu, is about fifty times slower and needs a host with Python and numpy. The twin
supports no point that two planes hold at the same time, no volume stiffness and no internal damping.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree as Xml

import numpy as np

from softffd import rotation
from softffd.drivers import MENDING
from softffd.embedding.basis import weights
from softffd.errors import SoftffdError
from softffd.files import path_with
from softffd.fmu.interface import elements
from softffd.fmu.model_description import completed, model_description
from softffd.fmu.package import scene_masses
from softffd.fmu.variables import has_damping, variables
from softffd.installed import table
from softffd.lattice import LatticeBox, point_at
from softffd.names import variable_name
from softffd.scene.scene import Scene
from softffd.scene.selection import Selection
from validation.resolved import resolved

__all__ = ["build_twin", "resolved_scene"]

PACKAGE, SCRIPT = "softffd_twin", "softffd_twin_slave"
"""Names of the twin's package and of pythonfmu's script inside the FMU. The FMU does not need softffd."""

PARTS = ("mechanics.py", *(f"twin/{name}.py" for name in ("fixtures", "methods", "model", "slave")))
"""Files besides `softffd.rotation` that run in the FMU. They import `softffd.rotation`, each other (relatively) and numpy."""

SCRIPT_TEXT = f"""from {PACKAGE}.twin.slave import TwinSlave  # noqa: F401
from {MENDING.stem} import mend

mend(globals())
"""


def build_twin(scene: Scene, path: str | Path) -> Path:
    """Writes the twin of a scene as an FMU and returns its path.

    The twin has the variables of the component, with the same references, units and start values, except for the outputs
    energy.* and solver.*. With solver.step = 0 the twin uses a step that is stable in any configuration. The twin uses any
    other solver.step unchanged, whereas the component shortens a step above its stability bound.
    Raises SoftffdError if pythonfmu is not installed, and for scenes with a volume stiffness, internal damping, solids or contact of the
    surface.
    """
    if scene.material.volume_stiffness > 0:
        raise SoftffdError(f"material.volume_stiffness: the twin has none, wanted 0 Pa, got {scene.material.volume_stiffness:g}")
    if scene.solids:
        names = ", ".join(solid.name for solid in scene.solids)
        raise SoftffdError(f"sphere, cylinder, box: the twin has planes alone, wanted none of these, got {names}")
    if scene.contact.of != "lattice" and scene.plane:
        raise SoftffdError('contact.of: the twin meets control points, wanted "lattice", got "surface"')
    if has_damping(scene, "internal_damping"):
        raise SoftffdError(
            f"material.internal_damping: the twin has none, wanted 0 s in it and all regions, got {_internal_damping(scene):g}"
        )
    builder = _pythonfmu().FmuBuilder
    path = path_with(".fmu", path)
    scene = scene.replace({"outputs.energy": False, "outputs.solver": False})
    mass = scene_masses(scene).mass
    content = resolved_scene(scene, mass)
    text = json.dumps(content)
    with TemporaryDirectory(prefix="softffd-") as name, _imports_undone():
        folder = Path(name)
        package, script = _travelling_package(folder / PACKAGE), folder / f"{SCRIPT}.py"
        script.write_text(SCRIPT_TEXT, encoding="utf-8")
        files = {"scene.json": text, "description.xml": _description(scene, mass, text), MENDING.name: MENDING.read_text(encoding="utf-8")}
        for file, words in files.items():
            (folder / file).write_text(words, encoding="utf-8")
        builder.build_FMU(script, path, project_files=[package, *(folder / file for file in files)])
    return path


def _internal_damping(scene: Scene) -> float:
    return max(scene.material.internal_damping, *(region.internal_damping or 0.0 for region in scene.region), 0.0)


def _travelling_package(folder: Path) -> Path:
    """Copies the files that run in the FMU to a folder, laid out so that their imports work. Returns the folder."""
    (folder / "twin").mkdir(parents=True)
    copy(rotation.__file__, folder)
    for part in PARTS:
        text = (Path(__file__).parents[1] / part).read_text(encoding="utf-8")
        (folder / part).write_text(text.replace("from softffd.rotation", f"from {PACKAGE}.rotation"), encoding="utf-8")
    for package in (folder, folder / "twin"):
        (package / "__init__.py").touch()
    return folder


def resolved_scene(scene: Scene, mass: np.ndarray) -> dict[str, Any]:
    """Returns the data of a scene that `twin.model.Model` needs, as stored in the FMU's resources.

    mass: (n,) [kg], region overrides included.
    """

    def at_points(family: str, selection: Selection) -> dict[str, int]:
        return {variable_name(family, point_at(p, scene.lattice.points)): p for p in scene.select(selection).tolist()}

    return resolved(scene, mass) | {
        "planes": [{"name": plane.name, "motion": plane.motion} for plane in scene.plane],
        "pins": [
            {"name": pin.name, "motion": pin.motion, "points": scene.select(pin.points).tolist(), "origin": scene.pin_origin(pin)}
            for pin in scene.pin
        ],
        "probes": {probe.name: _embedded(probe.at, scene.lattice_box) for probe in scene.probe},
        "position": at_points("position", scene.outputs.positions),
        "velocity": at_points("velocity", scene.outputs.velocities),
        "reactions": scene.outputs.reactions,
        "methods": {str(method["value"]): method["key"] for method in table()["method"]},
        "variables": [
            {"name": element.name, "reference": element.reference, "start": element.start}
            for variable in variables(scene, mass)
            for element in elements(variable)
        ],
    }


def _embedded(at: Sequence[float], lattice: LatticeBox) -> tuple[list[int], list[float]]:
    """Returns the control points that affect a place of the rest shape, eq. (1), and their weights."""
    shares = (np.array(at) - lattice.origin) / lattice.size
    u, v, w = (weights(t, n, lattice.basis)[0] for t, n in zip(shares, lattice.points, strict=True))
    product = np.einsum("k,j,i->kji", w, v, u).ravel()
    points = np.flatnonzero(product)
    return points.tolist(), product[points].tolist()


def _description(scene: Scene, mass: np.ndarray, content: str) -> str:
    """Returns the component's model description with the binary, capabilities and log categories of pythonfmu."""
    text = model_description(scene, variables(scene, mass))
    guid = hashlib.sha256((text + content).encode()).hexdigest()[:32]
    root = Xml.fromstring(completed(text, guid))
    root.set("generationTool", f"{root.get('generationTool')}, twin in numpy")
    simulation, categories = (next(root.iter(tag)) for tag in ("CoSimulation", "LogCategories"))
    simulation.attrib.clear()
    simulation.attrib |= {
        "modelIdentifier": PACKAGE,
        "needsExecutionTool": "true",
        "canHandleVariableCommunicationStepSize": "true",
        "canNotUseMemoryManagementFunctions": "true",
    }
    categories.clear()
    for category, words in _pythonfmu().Fmi2Slave.log_categories.items():
        Xml.SubElement(categories, "Category", name=category, description=words)
    return Xml.tostring(root, encoding="unicode")


def _pythonfmu() -> Any:
    try:
        return importlib.import_module("pythonfmu")
    except ImportError:
        raise SoftffdError("the twin is packaged with pythonfmu, which is not installed here: pip install pythonfmu") from None


@contextmanager
def _imports_undone() -> Iterator[None]:
    """Restores sys.path and forgets the script on exit: the builder imports the script by name and leaves its folder on sys.path."""
    path = list(sys.path)
    sys.modules.pop(SCRIPT, None)
    try:
        yield
    finally:
        sys.path[:] = path
        sys.modules.pop(SCRIPT, None)
