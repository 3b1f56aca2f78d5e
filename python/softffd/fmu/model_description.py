"""modelDescription.xml of a scene's FMU (FMI 2.0, co-simulation)."""

from __future__ import annotations

from collections.abc import Container
from xml.etree import ElementTree as Xml

from softffd import __version__
from softffd.fmu.interface import IDENTIFIER
from softffd.fmu.origin import AUTHOR, COPYRIGHT, generation_time
from softffd.fmu.variables import Variable
from softffd.installed import table
from softffd.scene.scene import Scene

GUID_PLACE = "{softffd-guid}"
"""Stands where the guid goes; the guid is a hash of everything else but the date."""
DATE_PLACE = "{softffd-date}"
"""Stands where the date goes."""
CONVENTIONS = {"structured": "structured", "plain": "flat"}
"""variableNamingConvention by fmu.names"""


def model_description(scene: Scene, variables: list[Variable]) -> str:
    """The XML text with GUID_PLACE in the place of the guid and DATE_PLACE in that of the date."""
    root = Xml.Element("fmiModelDescription", {"fmiVersion": "2.0", "guid": GUID_PLACE} | origin_attributes(scene))
    Xml.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=IDENTIFIER,
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs="true",
        maxOutputDerivativeOrder="1",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )
    add_units(root, {variable.family.get("unit") for variable in variables})
    add_log_categories(root)
    add_default_experiment(root, scene)
    listed = Xml.SubElement(root, "ModelVariables")
    for variable in variables:
        _variable(listed, variable)
    _structure(Xml.SubElement(root, "ModelStructure"), variables)
    return xml_text(root)


def completed(description: str, guid: str) -> str:
    """The text with its guid, and with the time of the sources: states go from one installation to another whatever their dates."""
    return description.replace(GUID_PLACE, guid).replace(DATE_PLACE, generation_time())


def origin_attributes(scene: Scene) -> dict[str, str]:
    """Attributes of the root, of any standard: what the FMU is and who made it."""
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


def xml_text(root: Xml.Element) -> str:
    """The document."""
    Xml.indent(root, space="  ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + Xml.tostring(root, encoding="unicode") + "\n"


def add_default_experiment(root: Xml.Element, scene: Scene) -> None:
    """The run that the scene describes."""
    Xml.SubElement(
        root,
        "DefaultExperiment",
        startTime="0",
        stopTime=repr(scene.experiment.stop_time),
        tolerance=repr(scene.solver.tolerance),
        stepSize=repr(scene.experiment.communication_step),
    )


def add_units(root: Xml.Element, used: set[str | None]) -> None:
    """The units of these names."""
    parent = Xml.SubElement(root, "UnitDefinitions")
    for unit in table()["unit"]:
        if unit["name"] in used:
            element = Xml.SubElement(parent, "Unit", name=unit["name"])
            Xml.SubElement(element, "BaseUnit", {key: str(power) for key, power in unit["base"].items()})


def add_log_categories(root: Xml.Element, leave_out: Container[str] = ()) -> None:
    """The table's categories."""
    parent = Xml.SubElement(root, "LogCategories")
    for category in (each for each in table()["log_category"] if each["name"] not in leave_out):
        Xml.SubElement(parent, "Category", name=category["name"], description=category["description"])


def _variable(parent: Xml.Element, variable: Variable) -> None:
    family = variable.family
    kind = family.get("type", "Real")
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": family["causality"],
        "variability": family["variability"],
        "description": variable.description,
    }
    if family["causality"] == "parameter":
        attributes["initial"] = "exact"
    if family["causality"] == "output":
        attributes["initial"] = "calculated"
    scalar = Xml.SubElement(parent, "ScalarVariable", attributes)
    typed: dict[str, str] = {}
    if "unit" in family:
        typed["unit"] = family["unit"]
    if "min" in family:
        typed["min"] = repr(family["min"])
    if variable.most is not None:
        typed["max"] = repr(variable.most)
    if variable.nominal is not None:
        typed["nominal"] = repr(float(variable.nominal))
    if variable.start is not None:
        typed["start"] = repr(variable.start if kind != "Real" else float(variable.start))
    Xml.SubElement(scalar, kind, typed)


def _structure(parent: Xml.Element, variables: list[Variable]) -> None:
    """Outputs do not depend on inputs of the same moment: they act during the step that follows. Initially some do."""
    outputs = [variable for variable in variables if variable.family["causality"] == "output"]
    if not outputs:
        return
    by_family: dict[str, list[int]] = {}
    for variable in variables:
        by_family.setdefault(variable.family["key"], []).append(variable.index)
    direct = Xml.SubElement(parent, "Outputs")
    initial = Xml.SubElement(parent, "InitialUnknowns")
    for variable in outputs:
        Xml.SubElement(direct, "Unknown", index=str(variable.index), dependencies="")
        known = sorted(index for key in variable.family["initial_from"] for index in by_family.get(key, []))
        Xml.SubElement(initial, "Unknown", index=str(variable.index), dependencies=" ".join(map(str, known)))
