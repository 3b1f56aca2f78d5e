"""modelDescription.xml of a scene's FMU (FMI 3.0, co-simulation)."""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from softffd.fmu.arrays import TIME, ArrayVariable
from softffd.fmu.interface import IDENTIFIER
from softffd.fmu.model_description import (
    GUID_PLACE,
    add_default_experiment,
    add_log_categories,
    add_units,
    origin_attributes,
    xml_text,
)  # fmt: skip
from softffd.scene.scene import Scene

KINDS = {"Real": "Float64", "Integer": "Int64"}
"""The standard's word for a type of the table."""


def model_description3(scene: Scene, variables: list[ArrayVariable]) -> str:
    """The XML text with GUID_PLACE in the place of the instantiation token and DATE_PLACE in that of the date."""
    root = Xml.Element("fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": GUID_PLACE} | origin_attributes(scene))
    Xml.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=IDENTIFIER,
        canHandleVariableCommunicationStepSize="true",
        maxOutputDerivativeOrder="1",
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
    )
    add_units(root, {"s", *(variable.family.get("unit") for variable in variables)})
    add_log_categories(root, leave_out={"logStatusPending"})
    add_default_experiment(root, scene)
    listed = Xml.SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": str(TIME), "causality": "independent", "variability": "continuous", "unit": "s"}
    Xml.SubElement(listed, "Float64", time, description="Time of the communication point")
    for variable in variables:
        _variable(listed, variable)
    _structure(Xml.SubElement(root, "ModelStructure"), variables)
    return xml_text(root)


def _variable(parent: Xml.Element, variable: ArrayVariable) -> None:
    family = variable.family
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": family["causality"],
        "variability": family["variability"],
        "description": variable.description,
    }
    if family["causality"] != "input":
        attributes["initial"] = "calculated" if family["causality"] == "output" else "exact"
    if "unit" in family:
        attributes["unit"] = family["unit"]
    if "min" in family:
        attributes["min"] = repr(family["min"])
    if variable.most is not None:
        attributes["max"] = repr(variable.most)
    if variable.nominal is not None:
        attributes["nominal"] = repr(float(variable.nominal))
    kind = KINDS[family.get("type", "Real")]
    if variable.start:
        attributes["start"] = " ".join(repr(float(value) if kind == "Float64" else value) for value in variable.start)
    element = Xml.SubElement(parent, kind, attributes)
    for side in variable.shape:
        Xml.SubElement(element, "Dimension", start=str(side))


def _structure(parent: Xml.Element, variables: list[ArrayVariable]) -> None:
    """Outputs do not depend on inputs of the same moment: they act during the step that follows. Initially some do."""
    outputs = [variable for variable in variables if variable.family["causality"] == "output"]
    by_family: dict[str, list[int]] = {}
    for variable in variables:
        by_family.setdefault(variable.family["key"], []).append(variable.reference)
    for variable in outputs:
        Xml.SubElement(parent, "Output", valueReference=str(variable.reference), dependencies="")
    for variable in outputs:
        known = sorted(reference for key in variable.family["initial_from"] for reference in by_family.get(key, []))
        Xml.SubElement(parent, "InitialUnknown", valueReference=str(variable.reference), dependencies=" ".join(map(str, known)))
