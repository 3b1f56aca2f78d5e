"""modelDescription.xml of a scene's FMU (FMI 3.0, co-simulation)."""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING
from xml.etree import ElementTree as Xml

from softffd.fmu.arrays import TIME, ArrayVariable
from softffd.fmu.description_parts import GUID_PLACE, dependencies, head, its_values, what_it_is, xml_text
from softffd.fmu.interface import IDENTIFIER

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

KINDS = {"Real": "Float64", "Integer": "Int64"}
"""The standard's word for a type of the table."""
SIMULATION = {
    "modelIdentifier": IDENTIFIER,
    "canHandleVariableCommunicationStepSize": "true",
    "maxOutputDerivativeOrder": "1",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
}


def model_description3(scene: Scene, variables: list[ArrayVariable]) -> str:
    """The XML text with GUID_PLACE in the place of the instantiation token and DATE_PLACE in that of the date."""
    units = {"s", *(variable.family.get("unit") for variable in variables)}
    identity = {"fmiVersion": "3.0", "instantiationToken": GUID_PLACE}
    root = head(scene, identity, SIMULATION, units, leave_out={"logStatusPending"})
    listed = Xml.SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": str(TIME), "causality": "independent", "variability": "continuous", "unit": "s"}
    Xml.SubElement(listed, "Float64", time, description="Time of the communication point")
    for variable in variables:
        attributes = what_it_is(variable) | its_values(variable, variable.start)
        element = Xml.SubElement(listed, KINDS[variable.family.get("type", "Real")], attributes)
        for side in variable.shape:
            Xml.SubElement(element, "Dimension", start=str(side))
    _structure(Xml.SubElement(root, "ModelStructure"), variables)
    return xml_text(root)


def _structure(parent: Xml.Element, variables: list[ArrayVariable]) -> None:
    outputs = dependencies(variables, attrgetter("reference"))
    for reference, _ in outputs:
        Xml.SubElement(parent, "Output", valueReference=reference, dependencies="")
    for reference, known in outputs:
        Xml.SubElement(parent, "InitialUnknown", valueReference=reference, dependencies=known)
