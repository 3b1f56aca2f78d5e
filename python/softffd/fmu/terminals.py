"""terminalsAndIcons.xml: the variables of each obstacle, pin, load, probe and sensor as a terminal, for tools that connect whole parts.

FMI 3.0 defines the file (section 2.4.9), and FMI 2.0.4 adopts it unchanged, with the version that it states. The names of the variables
tell which part they belong to: `plane.press.reaction.z` is the member `reaction.z` of the terminal `plane.press`, and in FMI 3.0
`reaction`, an array. So a new kind of part needs no change here.

    matching rule   bus: members are matched by name, and some may be missing: a partner without angular velocity is connected too
    kind of member  signal: an output of one side is an input of the other. A reaction is connected to a partner's force; it is no flow
                    with a sum of zero
    members         inputs and outputs; parameters, such as friction, are no part of a connection
"""

from collections.abc import Sequence
from xml.etree import ElementTree as Xml

from softffd.fmu.variables import OF_POINTS, Variable
from softffd.names import Cell, Part, flat_form, parse_name

PLACE = "terminalsAndIcons/terminalsAndIcons.xml"  # in the FMU
WHOLE = "value"  # member name of a variable whose name is its part's: in FMI 3.0 the three components of a load or a probe


def terminals(variables: Sequence[Variable], fmi: int, *, flat: bool) -> Xml.Element | None:
    """Returns the document; None if no part has inputs or outputs. fmi: 2, where variables are elements, or 3. flat: the names' form."""
    form = flat_form if flat else str
    members: dict[Part, list[tuple[str, str]]] = {}
    for variable in variables:
        if variable.family["causality"] in ("input", "output") and variable.family["part"] not in OF_POINTS:
            for name in [name for name, _ in variable.elements()] if fmi == 2 else [variable.name()]:
                if part := _part_of(name):
                    members.setdefault(part, []).append((name, name.removeprefix(f"{part}").lstrip(".") or WHOLE))
    if not members:
        return None
    root = Xml.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    listed = Xml.SubElement(root, "Terminals")
    for part, pairs in members.items():
        own = {"name": form(str(part)), "matchingRule": "bus", "terminalKind": f"_softffd_{part.kind}"}
        own["description"] = f"{part.kind} {part.name}"
        terminal = Xml.SubElement(listed, "Terminal", own)
        for name, member in pairs:
            names = {"variableName": form(name), "memberName": form(member), "variableKind": "signal"}
            Xml.SubElement(terminal, "TerminalMemberVariable", names)
    return root


def _part_of(name: str) -> Part | None:
    """Returns the part of a variable, or of an array by its name; the part of a taxel is its sensor."""
    found = next((found for rest in ("", ".x", "[0,0].x") if (found := parse_name(name + rest))), None)
    if found and isinstance(found.instance, Cell):
        return Part("sensor", found.instance.name)
    return found.instance if found and isinstance(found.instance, Part) else None
