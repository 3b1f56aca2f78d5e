"""An independent twin of a scene's component: the same variables, the same model written once more in numpy.

Run the two side by side and compare: where they part, one of them is wrong, or the motion is chaotic. The
twin is packaged with pythonfmu, is some fifty times slower, needs a host with Python and numpy, and has no
points that two planes hold at a time, no volume stiffness and no internal damping.
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
from softffd.fmu.interface import elements
from softffd.fmu.model_description import completed, model_description
from softffd.fmu.package import fmu_path, scene_masses
from softffd.fmu.variables import has_damping, variables
from softffd.installed import table
from softffd.lattice import LatticeBox, point_at
from softffd.names import variable_name
from softffd.scene.scene import Scene
from softffd.scene.selection import Selection
from validation.resolved import resolved

__all__ = ["build_twin", "resolved_scene"]

PACKAGE, SCRIPT = "softffd_twin", "softffd_twin_slave"
"""Names of the twin's own package and of pythonfmu's script inside the FMU, which does not need softffd."""

PARTS = ("mechanics.py", *(f"twin/{name}.py" for name in ("fixtures", "methods", "model", "slave")))
"""Files beside `softffd.rotation` that run in the FMU; they import that, each other, relatively, and numpy."""

SCRIPT_TEXT = f"""from {PACKAGE}.twin.slave import TwinSlave  # noqa: F401
from {MENDING.stem} import mend

mend(globals())
"""


def build_twin(scene: Scene, path: str | Path) -> Path:
    """Writes the twin of a scene as an FMU and returns its path.

    Its variables are those of the component, references, units and starts included, but for the outputs
    energy.* and solver.*. With solver.step = 0 it takes a step that is stable in any configuration; a
    solver.step that is given is taken as it is, where the component shortens one above its bound.
    Raises SoftffdError where pythonfmu is not installed and for scenes with a volume stiffness, internal damping, solids or contact of the
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
    path = fmu_path(path)
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
    """Copies of the files that run in the FMU, in the places where their imports find each other."""
    (folder / "twin").mkdir(parents=True)
    copy(rotation.__file__, folder)
    for part in PARTS:
        text = (Path(__file__).parents[1] / part).read_text(encoding="utf-8")
        (folder / part).write_text(text.replace("from softffd.rotation", f"from {PACKAGE}.rotation"), encoding="utf-8")
    for package in (folder, folder / "twin"):
        (package / "__init__.py").touch()
    return folder


def resolved_scene(scene: Scene, mass: np.ndarray) -> dict[str, Any]:
    """What `twin.model.Model` needs of a scene, as it stands in the FMU's resources.

    mass: (n,) kg, region overrides included.
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
    """The control points that count at a place of the rest shape, eq. (1), and how much."""
    shares = (np.array(at) - lattice.origin) / lattice.size
    u, v, w = (weights(t, n, lattice.basis)[0] for t, n in zip(shares, lattice.points, strict=True))
    product = np.einsum("k,j,i->kji", w, v, u).ravel()
    points = np.flatnonzero(product)
    return points.tolist(), product[points].tolist()


def _description(scene: Scene, mass: np.ndarray, content: str) -> str:
    """The component's own description, but for pythonfmu's binary, capabilities and log categories."""
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
    """The builder imports the script by name from a folder that it leaves on the path; so does a run."""
    path = list(sys.path)
    sys.modules.pop(SCRIPT, None)
    try:
        yield
    finally:
        sys.path[:] = path
        sys.modules.pop(SCRIPT, None)
