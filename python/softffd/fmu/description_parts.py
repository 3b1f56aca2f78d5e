"""What modelDescription.xml of a scene's FMU says in any version of the standard."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping, Sequence
from typing import TYPE_CHECKING, TypeVar
from xml.etree import ElementTree as Xml

from softffd import __version__
from softffd.fmu.arrays import ArrayVariable
from softffd.fmu.origin import AUTHOR, COPYRIGHT, generation_time
from softffd.fmu.variables import Variable
from softffd.installed import table

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

GUID_PLACE = "{softffd-guid}"
"""Stands where the guid goes; the guid is a hash of everything else but the date."""
DATE_PLACE = "{softffd-date}"
"""Stands where the date goes."""
CONVENTIONS = {"structured": "structured", "plain": "flat"}
"""variableNamingConvention by fmu.names"""

_ESCAPES = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})

OneOf = TypeVar("OneOf", Variable, ArrayVariable)


def completed(description: str, guid: str) -> str:
    """The text with its guid, and with the time of the sources: states go from one installation to another whatever their dates."""
    return description.replace(GUID_PLACE, guid).replace(DATE_PLACE, generation_time())


def head(
    scene: Scene, identity: Mapping[str, str], simulation: Mapping[str, str], units: Container[str | None], leave_out: Container[str] = ()
) -> Xml.Element:
    """The root with all that comes before the variables.

    identity: version of the standard and guid, by the standard's names. simulation: attributes of the CoSimulation element. units, and
    leave_out of the log categories: names.
    """
    root = Xml.Element("fmiModelDescription", {**identity, **_origin(scene)})
    Xml.SubElement(root, "CoSimulation", dict(simulation))
    _add_units(root, units)
    _add_log_categories(root, leave_out)
    _add_default_experiment(root, scene)
    return root


def xml_text(root: Xml.Element) -> str:
    """The document."""
    Xml.indent(root, space="  ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def quoted(text: str) -> str:
    """An attribute's value as it stands in XML. The standard library's own way to write it loads 40 modules, the web's among them."""
    return f'"{text.translate(_ESCAPES)}"'


def attributes_text(attributes: Mapping[str, str]) -> str:
    """As they stand in an element, with a space before each."""
    return "".join(f" {name}={quoted(value)}" for name, value in attributes.items())


def what_it_is(variable: Variable | ArrayVariable) -> dict[str, str]:
    """Attributes of a variable of any type."""
    return {
        "name": variable.name,
        "valueReference": str(variable.reference),
        **causality(variable),
        "description": variable.description,
    }


def causality(variable: Variable | ArrayVariable) -> dict[str, str]:
    """Attributes of how it is used: without those that have the standards' default values, as `initial` of all outputs and parameters."""
    causality, variability = variable.family["causality"], variable.family["variability"]
    return {"causality": causality} | ({} if variability == "continuous" else {"variability": variability})


def its_values(variable: Variable | ArrayVariable, start: Sequence[float | int]) -> dict[str, str]:
    """Attributes of its type: unit, bounds, usual size and start values, which may be none."""
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


def dependencies(variables: Sequence[OneOf], number: Callable[[OneOf], int]) -> list[tuple[str, str]]:
    """For every output its number, and the numbers of what its initial value depends on.

    Outputs do not depend on inputs of the same moment: they act during the step that follows. Initially some do.
    """
    by_family: dict[str, list[int]] = {}
    for variable in variables:
        by_family.setdefault(variable.family["key"], []).append(number(variable))
    rows = {variable.family["key"]: variable.family for variable in variables if variable.family["causality"] == "output"}
    known = {
        key: " ".join(map(str, sorted(other for part in row["initial_from"] for other in by_family.get(part, []))))
        for key, row in rows.items()
    }
    return [(str(number(variable)), known[key]) for variable in variables if (key := variable.family["key"]) in known]


def _origin(scene: Scene) -> dict[str, str]:
    """What the FMU is and who made it."""
    return {
        "modelName": scene.name,
        "description": scene.title,
        "author": AUTHOR,
        "version": __version__,
        "copyright": COPYRIGHT,
        "license": "BSD-2-Clause",
        "generationTool": f"softffd {__version__}",
        "generationDateAndTime": DATE_PLACE,
        "variableNamingConvention": CONVENTIONS[scene.fmu.names],
    }


def _add_units(root: Xml.Element, used: Container[str | None]) -> None:
    parent = Xml.SubElement(root, "UnitDefinitions")
    for unit in table()["unit"]:
        if unit["name"] in used:
            element = Xml.SubElement(parent, "Unit", name=unit["name"])
            Xml.SubElement(element, "BaseUnit", {key: str(power) for key, power in unit["base"].items()})


def _add_log_categories(root: Xml.Element, leave_out: Container[str]) -> None:
    parent = Xml.SubElement(root, "LogCategories")
    for category in (each for each in table()["log_category"] if each["name"] not in leave_out):
        Xml.SubElement(parent, "Category", name=category["name"], description=category["description"])


def _add_default_experiment(root: Xml.Element, scene: Scene) -> None:
    """The run that the scene describes."""
    Xml.SubElement(
        root,
        "DefaultExperiment",
        startTime="0",
        stopTime=repr(scene.experiment.stop_time),
        tolerance=repr(scene.solver.tolerance),
        stepSize=repr(scene.experiment.communication_step),
    )
