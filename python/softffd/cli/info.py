"""`softffd info`: the variables of a scene or an FMU, and where the frames of its pins are."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from softffd.cli.told import told_body
from softffd.fmu.component import Component
from softffd.fmu.interface import ScalarVariable
from softffd.names import parse_name, variable_name

HEAD = ("name", "causality", "variability", "unit", "start")


def told_info(component: Component, *, every: bool = False) -> str:
    """Title, body, default experiment, pins, and a table of variables. every: those of each control point in lines of their own."""
    interface = component.interface
    lines = [interface.title, f"  {told_body(component, None)}"]
    if interface.stop_time and interface.step:
        lines.append(f"  {interface.stop_time:g} s in communication steps of {interface.step:g} s")
    lines += [f"  {line}" for line in (*component.notes, *_pins(component))]
    variables = list(interface.variables.values())
    rows = [HEAD, *(map(_row, variables) if every else _grouped(variables, interface.flat))]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    table = ("  ".join(f"{word:{width}}" for word, width in zip(row, widths, strict=True)).rstrip() for row in rows)
    return "\n".join([*lines, "", *table])


def _pins(component: Component) -> Iterator[str]:
    for pin in component.pins:
        at = ", ".join(f"{value:.6g}" for value in pin.origin)
        moved = "moved by its inputs" if pin.moved else "fixed"
        yield f"pin {pin.name}, {moved}: the frame at rest is at ({at}) m with the world's axes; it holds {pin.points} points"


def _row(variable: ScalarVariable) -> tuple[str, ...]:
    return (variable.name, variable.causality, variable.variability or "", variable.unit or "", _start(variable))


def _start(variable: ScalarVariable) -> str:
    """As a user would set it: by its name where the value has one."""
    if variable.start is None or variable.type not in ("Real", "Integer", "Enumeration"):
        return str(variable.start or "")
    value = float(variable.start)
    named = next((name for name, each in (variable.items or {}).items() if each == value), None)
    return named or f"{value:.10g}"


def _grouped(variables: list[ScalarVariable], flat: bool) -> Iterator[tuple[str, ...]]:
    """Rows; those of control points of one family are one."""
    for family, group in groupby(variables, _family_of_points):
        listed = list(group)
        if family is None:
            yield from map(_row, listed)
            continue
        components = dict.fromkeys(variable.name[-2:] for variable in listed)
        stem = variable_name(family, (0, 0, 0), flat=flat).replace("0,0,0", "i,j,k").replace("0_0_0", "i_j_k")
        name = f"{stem} {' '.join(components)} ({len(listed) // len(components)} control points)"
        yield (name, *_row(listed[0])[1:])


def _family_of_points(variable: ScalarVariable) -> str | None:
    found = parse_name(variable.name)
    return found.family if found and found.at_point else None
