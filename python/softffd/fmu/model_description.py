"""modelDescription.xml of a scene's FMU (FMI 2.0, co-simulation)."""

from __future__ import annotations

from operator import attrgetter
from xml.etree import ElementTree as Xml

from softffd.fmu.description_parts import GUID_PLACE, dependencies, head, its_values, what_it_is, xml_text
from softffd.fmu.interface import IDENTIFIER
from softffd.fmu.variables import Variable
from softffd.scene.scene import Scene

SIMULATION = {
    "modelIdentifier": IDENTIFIER,
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "1",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}


def model_description(scene: Scene, variables: list[Variable]) -> str:
    """The XML text with GUID_PLACE in the place of the guid and DATE_PLACE in that of the date."""
    root = head(scene, {"fmiVersion": "2.0", "guid": GUID_PLACE}, SIMULATION, {variable.family.get("unit") for variable in variables})
    listed = Xml.SubElement(root, "ModelVariables")
    for variable in variables:
        scalar = Xml.SubElement(listed, "ScalarVariable", what_it_is(variable))
        start = () if variable.start is None else (variable.start,)
        Xml.SubElement(scalar, variable.family.get("type", "Real"), its_values(variable, start))
    _structure(Xml.SubElement(root, "ModelStructure"), variables)
    return xml_text(root)


def _structure(parent: Xml.Element, variables: list[Variable]) -> None:
    outputs = dependencies(variables, attrgetter("index"))
    if not outputs:
        return
    direct = Xml.SubElement(parent, "Outputs")
    initial = Xml.SubElement(parent, "InitialUnknowns")
    for index, known in outputs:
        Xml.SubElement(direct, "Unknown", index=index, dependencies="")
        Xml.SubElement(initial, "Unknown", index=index, dependencies=known)
