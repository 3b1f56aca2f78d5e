"""A plate and a soft body as one system: an SSP 1.0 file with both FMUs, connected both ways.

    body.plane.NAME.reaction  ->  plate.reaction
    plate.point, .velocity    ->  body.plane.NAME.point, .velocity

The normal is not connected: the plate does not turn, and both FMUs start with the same one. The plate's own start values are written
into its FMU, so a host need not read parameters. Hosts that step all components and then exchange (Jacobi: fmpy, libcosim, Ecos with a
fixed step) run it as it is.

fmpy's `simulate_ssp` sets every connected input to zero in its first step instead of reading start values. A plate that starts at rest
with its point at the world's origin, as in the shipped scene, means just that; another start needs another host.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree as Xml

from softffd.drivers import build_driver
from softffd.errors import SoftffdError
from softffd.files import replacing
from softffd.fmu.package import package_fmu
from softffd.names import variable_name
from softffd.scene.scene import Scene, load_scene

SCENE = Path(__file__).with_name("plate_on_box.toml")
SSD, SSC = "http://ssp-standard.org/SSP1/SystemStructureDescription", "http://ssp-standard.org/SSP1/SystemStructureCommon"
UNIT = {"reaction": "N", "point": "m", "velocity": "m/s"}
"""What plate and body exchange: the reaction goes to the plate, its motion to the body"""


def write_ssp(
    path: str | Path, scene: Scene | str | Path | None = None, *, plane: str | None = None, plate: Mapping[str, Any] | None = None
) -> Path:
    """Writes a system of a scene's FMU (`body`) and a plate (`plate`) and returns its path.

    scene: a scene, its file or shipped name; by default a box of 1 kg that the plate rests on.
    plane: the input plane that is the plate's surface; by default the scene's only one. The plate starts with its pose and velocity.
    plate: further start values of the plate, e.g. {"mass": 2.0}; see softffd/drivers/plate.py.
    Raises SoftffdError where the scene has no such plane or no reactions.
    """
    path = Path(path)
    scene = scene if isinstance(scene, Scene) else load_scene(scene or SCENE)
    surface = _surface(scene, plane)
    start = {f"initial.{key}": getattr(surface, key) for key in ("point", "velocity", "normal")} | dict(plate or {})
    with TemporaryDirectory(prefix="softffd-") as folder:
        files = {"plate": build_driver("plate", folder, start_values=start), "body": package_fmu(scene, Path(folder) / "body.fmu")}
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as stream, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("SystemStructure.ssd", _structure(scene, surface.name))
            for name, file in files.items():
                archive.write(file, f"resources/{name}.fmu")
    return path


def _surface(scene: Scene, name: str | None) -> Any:
    inputs = {plane.name: plane for plane in scene.plane if plane.motion == "input"}
    if not scene.outputs.reactions:
        raise SoftffdError(f"{scene.name}: a coupled plate needs outputs.reactions = true")
    if name is None and len(inputs) == 1:
        return next(iter(inputs.values()))
    if name not in inputs:
        raise SoftffdError(f'{scene.name}: plane: wanted one with motion = "input" ({", ".join(inputs) or "there is none"}), got {name}')
    return inputs[name]


def _structure(scene: Scene, plane: str) -> str:
    """SystemStructure.ssd."""
    Xml.register_namespace("ssd", SSD)
    Xml.register_namespace("ssc", SSC)
    inputs = next(each.input_components() for each in scene.plane if each.name == plane)
    root = Xml.Element(f"{{{SSD}}}SystemStructureDescription", version="1.0", name=scene.name)
    system = Xml.SubElement(root, f"{{{SSD}}}System", name=scene.name, description=scene.title)
    elements = Xml.SubElement(system, f"{{{SSD}}}Elements")
    exchanged = [(what, f"{what}.{axis}", variable_name(f"plane_{what}", plane, axis)) for what in UNIT for axis in "xyz"]
    taken = {what: what == "reaction" for what in UNIT}  # by the plate; the others by the body, where they are its inputs
    exchanged = [each for each in exchanged if taken[each[0]] or each[1] in inputs]
    _component(elements, "plate", [(own, "input" if taken[what] else "output", UNIT[what]) for what, own, _ in exchanged])
    _component(elements, "body", [(variable, "output" if taken[what] else "input", UNIT[what]) for what, _, variable in exchanged])
    connections = Xml.SubElement(system, f"{{{SSD}}}Connections")
    for what, own, variable in exchanged:
        ends = [("plate", own), ("body", variable)]
        (source, out), (target, into) = reversed(ends) if taken[what] else ends
        attributes = {"startElement": source, "startConnector": out, "endElement": target, "endConnector": into}
        Xml.SubElement(connections, f"{{{SSD}}}Connection", attributes)
    _units(root)
    Xml.SubElement(root, f"{{{SSD}}}DefaultExperiment", startTime="0.0", stopTime=repr(scene.experiment.stop_time))
    Xml.indent(root, space="  ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _component(parent: Xml.Element, name: str, connectors: list[tuple[str, str, str]]) -> None:
    """connectors: variable, "input" or "output", unit."""
    source = {"type": "application/x-fmu-sharedlibrary", "source": f"resources/{name}.fmu"}
    component = Xml.SubElement(parent, f"{{{SSD}}}Component", {"name": name, **source})
    listed = Xml.SubElement(component, f"{{{SSD}}}Connectors")
    for variable, kind, unit in connectors:
        connector = Xml.SubElement(listed, f"{{{SSD}}}Connector", name=variable, kind=kind)
        Xml.SubElement(connector, f"{{{SSC}}}Real", unit=unit)


def _units(root: Xml.Element) -> None:
    units = Xml.SubElement(root, f"{{{SSD}}}Units")
    for name, powers in {"N": {"kg": "1", "m": "1", "s": "-2"}, "m": {"m": "1"}, "m/s": {"m": "1", "s": "-1"}}.items():
        Xml.SubElement(Xml.SubElement(units, f"{{{SSC}}}Unit", name=name), f"{{{SSC}}}BaseUnit", powers)
