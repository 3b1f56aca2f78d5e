"""modelDescription.xml of a scene's FMU (FMI 2.0, co-simulation)."""

from __future__ import annotations

from collections.abc import Iterator
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from softffd.fmu.description_parts import GUID_PLACE, attributes_text, causality, dependencies, head, its_values, quoted, xml_text
from softffd.fmu.interface import IDENTIFIER
from softffd.fmu.variables import Variable

if TYPE_CHECKING:
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
    """The XML text with GUID_PLACE in the place of the guid and DATE_PLACE in that of the date.

    A large lattice has a hundred thousand variables: each is written as one line of text, and as little of it as the standard allows.
    """
    root = head(scene, {"fmiVersion": "2.0", "guid": GUID_PLACE}, SIMULATION, {variable.family.get("unit") for variable in variables})
    begin, end = xml_text(root).rsplit("</", 1)
    return "\n".join([begin.rstrip(), "<ModelVariables>", *_listed(variables), "</ModelVariables>", *_structure(variables), f"</{end}"])


def _listed(variables: list[Variable]) -> Iterator[str]:
    """The elements of the variables, which have most in common within a family."""
    common: dict[tuple[str, Any, Any, Any], tuple[str, str]] = {}
    for variable in variables:
        like = (variable.family["key"], variable.start, variable.most, variable.nominal)
        if like not in common:
            start = () if variable.start is None else (variable.start,)
            values = attributes_text(its_values(variable, start))
            common[like] = attributes_text(causality(variable)), f"<{variable.family.get('type', 'Real')}{values}/></ScalarVariable>"
        kind, values = common[like]
        words = quoted(variable.description)
        yield f'<ScalarVariable name="{variable.name}" valueReference="{variable.reference}"{kind} description={words}>{values}'


def _structure(variables: list[Variable]) -> Iterator[str]:
    outputs = dependencies(variables, attrgetter("place"))
    if not outputs:
        yield "<ModelStructure/>"
        return
    yield "<ModelStructure>\n<Outputs>"
    yield from (f'<Unknown index="{index}" dependencies=""/>' for index, _ in outputs)
    yield "</Outputs>\n<InitialUnknowns>"
    yield from (f'<Unknown index="{index}" dependencies="{known}"/>' for index, known in outputs)
    yield "</InitialUnknowns>\n</ModelStructure>"
