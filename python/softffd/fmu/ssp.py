"""A system of coupled FMUs as a file `.ssp` (SSP 1.0): SystemStructure.ssd and the FMUs in resources/.

The start values of each component are a parameter set `start`, which libcosim applies by itself and Ecos by its name. They stand once
more, as COMPONENT.VARIABLE, in resources/start.ssv for fmpy, which applies no set by itself: read_ssv(path, "resources/start.ssv").
"""

import json
import re
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree as Xml

import fmpy

from softffd.errors import SoftffdError
from softffd.files import path_with, replacing, seen_from
from softffd.fmu.archive import require_no_bomb
from softffd.fmu.interface import read_interface
from softffd.fmu.model_description import xml_text
from softffd.fmu.package import package_fmu
from softffd.fmu.wiring import Element, Wiring, read_units
from softffd.scene.kept import KeptScene
from softffd.scene.scene import Scene, scene_of

SSP = "http://ssp-standard.org/SSP1/SystemStructure"
SPACES = {"ssd": f"{SSP}Description", "ssc": f"{SSP}Common", "ssv": f"{SSP}ParameterValues"}
FMU, START = "application/x-fmu-sharedlibrary", "resources/start.ssv"
KEPT = "extra/softffd/{}.json"  # the scene that a component was made from
for _prefix, _space in SPACES.items():
    Xml.register_namespace(_prefix, _space)


def write_ssp(
    path: str | Path, components: Mapping[str, Scene | str | Path], connections: Iterable[Sequence[Any]], *,
    start_values: Mapping[str, Any] | None = None, record: Iterable[str] | str = (),
) -> Path:  # fmt: skip
    """Writes a system of FMUs for SSP hosts and returns its path. For a plate from `softffd drivers` that rests on a scene's box:

        write_ssp("pressed.ssp", {"box": scene, "plate": "plate.fmu"},
                  [(f"plate.{name}", f"box.plane.plate.{name}") for name in ("point", "velocity", "reaction")])

    path: a file name ending in .ssp; missing folders are made.
    components: by name, scenes, scene files, names of shipped scenes, or FMUs (FMI 2.0 co-simulation).
    connections: pairs of ends `component.variable`, an output and an input in either order; two vectors are connected in all components.
        A third item is a factor and a fourth an offset [unit of the input]: the input gets factor * output + offset. fmpy ignores both.
    start_values: of inputs and parameters, by end; numbers or vectors.
    record: further outputs that hosts record, because they become connectors: ends, or parts that ends belong to, such as
        "box.probe.top", "box.energy", "box".
    Raises SoftffdError that lists every unknown name, mismatch of causality, type or unit, and input that is connected twice.
    """
    return _write(Path(path), components, connections, start_values or {}, record)[0]


def told_ssp(path: Path, *asked: Any) -> list[str]:
    """Writes a system as write_ssp does, and returns lines that inform the user about it."""
    _, wiring = _write(path, *asked)
    names, count = ", ".join(wiring.elements), len(wiring.connections)
    recorded = len({str(end) for end in wiring.recorded})
    lines = [f"{path}: {names}; {count} connection{'s' * (count != 1)}" + (f", {recorded} outputs to record" if recorded else "")]
    lines += [f"  {doubt}" for doubt in wiring.doubts()]
    if elsewhere := wiring.starts_elsewhere():
        lines.append(f"  fmpy sets connected inputs to 0 in its first step; here they start from {', '.join(elsewhere)}")
    if any(each[2:] != (1.0, 0.0) for each in wiring.connections):
        lines.append("  fmpy passes over factors and offsets of connections")
    if wiring.starts:
        lines.append(f'  start values: Ecos takes parameter_set="start", fmpy parameter_set=read_ssv("{path}", "{START}")')
    return lines


def _write(
    path: Path, components: Mapping[str, Any], connections: Iterable[Sequence[Any]], start_values: Mapping[str, Any], record: Iterable[str]
) -> tuple[Path, Wiring]:
    path_with(".ssp", path)
    if not isinstance(components, Mapping) or not components:
        raise SoftffdError(f"components: wanted scenes and FMUs by name, as {{'box': scene, 'plate': 'plate.fmu'}}, got {components!r:.70}")
    with TemporaryDirectory(prefix="softffd-") as folder:
        given = {_checked_name(name): _fmu_or_scene(name, what) for name, what in components.items()}
        scenes = {name: what for name, what in given.items() if isinstance(what, Scene)}
        made = {name: package_fmu(scene, Path(folder) / f"{name}.fmu") for name, scene in scenes.items()}
        files = {name: made.get(name) or Path(what) for name, what in given.items()}
        wiring = Wiring({name: _element(name, file) for name, file in files.items()})
        wiring.connect(connections)
        wiring.start(start_values)
        wiring.record([record] if isinstance(record, str) else record)
        if problems := wiring.problems:
            raise SoftffdError("\n".join([f"{path}: {len(problems)} problem{'s' * (len(problems) > 1)}", *(f"  {p}" for p in problems)]))
        with replacing(path) as stream, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("SystemStructure.ssd", xml_text(_structure(path.stem, wiring)))
            if wiring.starts:
                named = {f"{name}.{key}": value for name, starts in wiring.starts.items() for key, value in starts.items()}
                archive.writestr(START, xml_text(_parameter_set(named, wiring)))
            for name, file in files.items():
                archive.write(file, f"resources/{name}.fmu", zipfile.ZIP_STORED)
            for name, scene in scenes.items():
                archive.writestr(KEPT.format(name), json.dumps(_kept(scene, path), default=str))
    return path, wiring


def _checked_name(name: str) -> str:
    if not re.fullmatch(r"\w[\w-]*", str(name)):
        raise SoftffdError(f'component: wanted a name of letters, digits, "_" and "-", got "{name}"; NAME=FILE gives a file another')
    return name


def _fmu_or_scene(name: str, what: Scene | str | Path) -> Any:
    """Returns the path of an FMU that exists, or a scene."""
    if not isinstance(what, str | Path) or Path(what).suffix.lower() != ".fmu":
        return scene_of(what, name, "a Scene, the path or name of one, or the path of an FMU")
    if not Path(what).is_file():
        raise SoftffdError(f"{what}: there is no such FMU")
    return what


def _kept(scene: Scene, path: Path) -> dict[str, Any]:
    """Returns what a system at this path stores of a scene, so that its runs can be shown again with the mesh."""
    kept = vars(KeptScene.of(scene)) | {"path": scene.path.name}
    if scene.mesh:
        kept["keys"]["mesh"]["file"] = seen_from(path.parent, scene.mesh.file)
    return kept


def _element(name: str, file: Path) -> Element:
    try:
        with zipfile.ZipFile(file) as archive:
            require_no_bomb(archive, file.stat().st_size)
            units = read_units(archive.read("modelDescription.xml"))
        description = fmpy.read_model_description(str(file), validate=False)
    except Exception as error:
        raise SoftffdError(f"{file}: cannot be read as an FMU: {error}") from error
    if description.coSimulation is None or description.fmiVersion != "2.0":
        raise SoftffdError(f"{file}: wanted an FMI 2.0 co-simulation FMU, got FMI {description.fmiVersion}")
    return Element(name, read_interface(description), units)


def _structure(name: str, wiring: Wiring) -> Xml.Element:
    root = _node(None, "ssd:SystemStructureDescription", version="1.0", name=name)
    system = _node(root, "ssd:System", name=name)
    elements = _node(system, "ssd:Elements")
    for element in wiring.elements.values():
        _component(elements, element, wiring)
    connections = _node(system, "ssd:Connections") if wiring.connections else None
    for source, target, factor, offset in wiring.connections:
        ends = {"startElement": source.element.name, "startConnector": source.variable.name}
        node = _node(connections, "ssd:Connection", **ends, endElement=target.element.name, endConnector=target.variable.name)
        if (factor, offset) != (1.0, 0.0):
            _node(node, "ssc:LinearTransformation", factor=repr(factor), offset=repr(offset))
    used = {end.variable.unit: end for end in wiring.ends().values() if end.variable.unit}
    units = _node(root, "ssd:Units") if used else None
    for unit, end in sorted(used.items()):
        _node(_node(units, "ssc:Unit", name=unit), "ssc:BaseUnit", **end.element.units.get(unit, {}))
    stops = [stop for element in wiring.elements.values() if (stop := element.interface.stop_time)]
    _node(root, "ssd:DefaultExperiment", startTime="0.0", **({"stopTime": repr(stops[0])} if stops else {}))
    return root


def _component(parent: Xml.Element, element: Element, wiring: Wiring) -> None:
    component = _node(parent, "ssd:Component", name=element.name, type=FMU, source=f"resources/{element.name}.fmu")
    ends = [end for end in wiring.ends().values() if end.element is element]
    connectors = _node(component, "ssd:Connectors") if ends else None
    for end in ends:
        connector = _node(connectors, "ssd:Connector", name=end.variable.name, kind=end.variable.causality)
        kind = "Integer" if end.variable.type == "Enumeration" else end.variable.type
        _node(connector, f"ssc:{kind}", **({"unit": end.variable.unit} if end.variable.unit else {}))
    if starts := wiring.starts.get(element.name):
        binding = _node(_node(component, "ssd:ParameterBindings"), "ssd:ParameterBinding")
        _node(binding, "ssd:ParameterValues").append(_parameter_set(starts, wiring, element.name))


def _parameter_set(starts: Mapping[str, float], wiring: Wiring, element: str | None = None) -> Xml.Element:
    """Returns the parameter set of start values. starts: by variable of the element, or by end if there is no element."""
    root = _node(None, "ssv:ParameterSet", version="1.0", name="start")
    parameters = _node(root, "ssv:Parameters")
    for name, value in starts.items():
        owner, _, variable = (name if element is None else f"{element}.{name}").partition(".")
        kind = wiring.elements[owner].interface.variables[variable].type
        text = {"Real": repr(float(value)), "Boolean": str(bool(value)).lower()}.get(kind, str(int(value)))
        _node(_node(parameters, "ssv:Parameter", name=name), f"ssv:{'Integer' if kind == 'Enumeration' else kind}", value=text)
    return root


def _node(parent: Xml.Element | None, kind: str, /, **attributes: str) -> Xml.Element:
    prefix, _, tag = kind.partition(":")
    full = f"{{{SPACES[prefix]}}}{tag}"
    return Xml.Element(full, attributes) if parent is None else Xml.SubElement(parent, full, attributes)
