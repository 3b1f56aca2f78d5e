"""modelDescription.xml of a scene's FMU: for FMI 2.0, which lists the elements of the variables, and for FMI 3.0 (co-simulation)."""

from __future__ import annotations

import os
from collections.abc import Container, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from itertools import accumulate
from typing import TYPE_CHECKING, Any, Final
from xml.etree import ElementTree as Xml

from softffd import __version__
from softffd.errors import SoftffdError
from softffd.fmu.interface import IDENTIFIER, TIME, TYPES3
from softffd.fmu.variables import Variable
from softffd.installed import data_folder, table

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

GUID_PLACE = "{softffd-guid}"  # placeholder of the guid, which is a hash of everything else but the date
DATE_PLACE = "{softffd-date}"  # placeholder of the date
AUTHOR: Final = "the softffd authors"
COPYRIGHT: Final = f"Copyright (c) 2026, {AUTHOR}"  # as the licence says it
LAST: Final = 253402300799  # the last second of the year 9999
SIMULATION = {
    "modelIdentifier": IDENTIFIER, "canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "1", "canNotUseMemoryManagementFunctions": "true", "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}  # fmt: skip
SIMULATION3 = {
    "modelIdentifier": IDENTIFIER, "canHandleVariableCommunicationStepSize": "true", "maxOutputDerivativeOrder": "1",
    "canGetAndSetFMUState": "true", "canSerializeFMUState": "true",
}  # fmt: skip

_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})


def model_description(scene: Scene, variables: Sequence[Variable]) -> str:
    """Returns the XML text for FMI 2.0, with GUID_PLACE in the place of the guid and DATE_PLACE in the place of the date.

    A large lattice has a hundred thousand elements, so each element is written as one line of text, with as little as the standard
    allows.
    """
    root = _head(scene, {"fmiVersion": "2.0", "guid": GUID_PLACE}, SIMULATION, {variable.family.get("unit") for variable in variables})
    begin, end = xml_text(root).rsplit("</", 1)
    lines = [line for variable in variables for line in _elements(variable, flat=scene.fmu.names == "flat")]
    return "\n".join([begin.rstrip(), "<ModelVariables>", *lines, "</ModelVariables>", *_structure(variables), f"</{end}"])


def _elements(variable: Variable, *, flat: bool) -> Iterator[str]:
    kind = variable.family.get("type", "Real")
    starts = [[start] for start in variable.start] or [[]]
    values = [f"<{kind}{_attributes_text(_its_values(variable, start))}/></ScalarVariable>" for start in starts]
    causality = _attributes_text(_causality(variable))
    for n, (name, description) in enumerate(variable.elements(flat=flat)):
        attributes = f'name="{name}" valueReference="{variable.reference + n}"{causality} description={_quoted(description)}'
        yield f"<ScalarVariable {attributes}>{values[n % len(values)]}"


def _structure(variables: Sequence[Variable]) -> Iterator[str]:
    first = accumulate((variable.count for variable in variables), initial=1)
    outputs = _dependencies(variables, [range(place, place + variable.count) for place, variable in zip(first, variables, strict=False)])
    if not outputs:
        yield "<ModelStructure/>"
        return
    yield "<ModelStructure>\n<Outputs>"
    yield from (f'<Unknown index="{index}" dependencies=""/>' for index, _ in outputs)
    yield "</Outputs>\n<InitialUnknowns>"
    yield from (f'<Unknown index="{index}" dependencies="{known}"/>' for index, known in outputs)
    yield "</InitialUnknowns>\n</ModelStructure>"


def model_description3(scene: Scene, variables: Sequence[Variable]) -> str:
    """Returns the XML text for FMI 3.0, with GUID_PLACE in the place of the instantiation token."""
    units = {"s", *(variable.family.get("unit") for variable in variables)}
    identity = {"fmiVersion": "3.0", "instantiationToken": GUID_PLACE}
    root = _head(scene, identity, SIMULATION3, units, leave_out={"logStatusPending"})
    listed = Xml.SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": str(TIME), "causality": "independent", "variability": "continuous", "unit": "s"}
    Xml.SubElement(listed, "Float64", time, description="Time of the communication point")
    for variable in variables:
        name = {"name": variable.name(flat=scene.fmu.names == "flat"), "valueReference": str(variable.reference)}
        attributes = name | _causality(variable) | {"description": variable.description} | _its_values(variable, variable.start)
        element = Xml.SubElement(listed, TYPES3[variable.family.get("type", "Real")], attributes)
        for side in variable.shape:
            Xml.SubElement(element, "Dimension", start=str(side))
    structure, outputs = Xml.SubElement(root, "ModelStructure"), _dependencies(variables, [[each.reference] for each in variables])
    for reference, _ in outputs:
        Xml.SubElement(structure, "Output", valueReference=reference, dependencies="")
    for reference, known in outputs:
        Xml.SubElement(structure, "InitialUnknown", valueReference=reference, dependencies=known)
    return xml_text(root)


def completed(description: str, guid: str) -> str:
    """Returns the text with its guid and the time of the sources. The date is no part of the guid, so that installations can exchange
    states."""
    return description.replace(GUID_PLACE, guid).replace(DATE_PLACE, generation_time())


def generation_time() -> str:
    """Returns the time of the sources, as xs:dateTime: the same scene gives the same FMU whenever it is made.

    The time is SOURCE_DATE_EPOCH if the environment has it, else that of the newest file that the installation puts into FMUs. Raises
    SoftffdError if SOURCE_DATE_EPOCH is not a number of seconds.
    """
    given = os.environ.get("SOURCE_DATE_EPOCH")
    if given is None:
        seconds = int(max(file.stat().st_mtime for file in data_folder().rglob("*") if file.is_file()))
    elif given.isascii() and given.isdigit() and int(given) <= LAST:
        seconds = int(given)
    else:
        raise SoftffdError(f"SOURCE_DATE_EPOCH: wanted seconds since 1970, got {given!r}")
    return datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def xml_text(root: Xml.Element) -> str:
    """Returns the document as indented text."""
    Xml.indent(root, space="  ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def _quoted(text: str) -> str:
    """Returns an attribute's value quoted for XML. The standard library's function for this loads 40 modules, those of the web among
    them."""
    return f'"{text.translate(_ESCAPES)}"'


def _attributes_text(attributes: Mapping[str, str]) -> str:
    """Returns the attributes as text of an element, with a space before each."""
    return "".join(f" {name}={_quoted(value)}" for name, value in attributes.items())


def _causality(variable: Variable) -> dict[str, str]:
    """Returns the attributes `causality` and `variability`. Attributes with the standards' default values are left out, such as `initial`
    of all outputs and parameters."""
    causality, variability = variable.family["causality"], variable.family["variability"]
    return {"causality": causality} | ({} if variability == "continuous" else {"variability": variability})


def _its_values(variable: Variable, start: Sequence[float | int]) -> dict[str, str]:
    """Returns the attributes of the variable's type: unit, bounds, nominal value and start values. start: may be empty."""
    family, attributes = variable.family, {}
    if "unit" in family:
        attributes["unit"] = family["unit"]
    if "min" in family:
        attributes["min"] = repr(family["min"])
    if variable.most is not None:
        attributes["max"] = repr(variable.most)
    if variable.nominal is not None:
        attributes["nominal"] = repr(float(variable.nominal))
    if start:
        real = family.get("type", "Real") == "Real"
        attributes["start"] = " ".join(repr(float(value) if real else value) for value in start)
    return attributes


def _dependencies(variables: Sequence[Variable], numbers: Sequence[Sequence[int]]) -> list[tuple[str, str]]:
    """Returns for every output its number, and the numbers of the variables on which its initial value depends.

    numbers: of each variable, one or one for each element. Outputs do not depend on inputs of the same moment, which act during the step
    that follows. Some initial values of outputs do depend on inputs.
    """
    by_family: dict[str, list[int]] = {}
    rows: dict[str, dict[str, Any]] = {}
    for variable, own in zip(variables, numbers, strict=True):
        by_family.setdefault(variable.family["key"], []).extend(own)
        rows[variable.family["key"]] = variable.family
    known = {
        key: " ".join(map(str, sorted(number for other in row["initial_from"] for number in by_family.get(other, []))))
        for key, row in rows.items()
        if row["causality"] == "output"
    }
    pairs = zip(variables, numbers, strict=True)
    return [(str(number), known[key]) for variable, own in pairs if (key := variable.family["key"]) in known for number in own]


def _head(
    scene: Scene, identity: Mapping[str, str], simulation: Mapping[str, str], units: Container[str | None], leave_out: Container[str] = ()
) -> Xml.Element:
    """Returns the root element with everything that comes before the variables.

    identity: version of the standard and guid, by the standard's names. simulation: attributes of the CoSimulation element. units: names
    of the units to define. leave_out: names of log categories that are left out.
    """
    origin = {
        "modelName": scene.name, "description": scene.title, "author": AUTHOR, "version": __version__, "copyright": COPYRIGHT,
        "license": "BSD-2-Clause", "generationTool": f"softffd {__version__}", "generationDateAndTime": DATE_PLACE,
        "variableNamingConvention": scene.fmu.names,
    }  # fmt: skip
    root = Xml.Element("fmiModelDescription", {**identity, **origin})
    Xml.SubElement(root, "CoSimulation", dict(simulation))
    defined = Xml.SubElement(root, "UnitDefinitions")
    for unit in table()["unit"]:
        if unit["name"] in units:
            element = Xml.SubElement(defined, "Unit", name=unit["name"])
            Xml.SubElement(element, "BaseUnit", {key: str(power) for key, power in unit["base"].items()})
    categories = Xml.SubElement(root, "LogCategories")
    for category in (each for each in table()["log_category"] if each["name"] not in leave_out):
        Xml.SubElement(categories, "Category", name=category["name"], description=category["description"])
    experiment = scene.experiment
    given = {"stopTime": experiment.stop_time, "tolerance": scene.solver.tolerance, "stepSize": experiment.communication_step}
    Xml.SubElement(root, "DefaultExperiment", {"startTime": "0"} | {key: repr(value) for key, value in given.items()})
    return root
