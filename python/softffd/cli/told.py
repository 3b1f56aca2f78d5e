"""Messages of `softffd run`: before the first step what runs and what drives it, after the last step what was found; and `softffd info`."""

from collections.abc import Iterator
from itertools import groupby
from typing import Any

from softffd.fmu.component import Component
from softffd.fmu.interface import ScalarVariable
from softffd.names import parse_name, variable_name
from softffd.run.inputs import Inputs
from softffd.run.simulation import Simulation
from softffd.spelling import few


def told_before(simulation: Simulation, inputs: Inputs) -> str:
    """Returns title, lattice, mass, number of variables, and which inputs are driven by what."""
    component = simulation.component
    mass = simulation.number("mass") if "mass" in simulation.variables else None
    return "\n".join([component.interface.title, *(f"  {line}" for line in (told_body(component, mass), *_driven(simulation, inputs)))])


def told_body(component: Component, mass: float | None) -> str:
    """Returns lattice, mass [kg] and number of variables as text; mass: None for its start value."""
    variables = component.interface.variables
    words = []
    if box := component.lattice:
        words.append(f"lattice {' x '.join(map(str, box.points))} over {' x '.join(f'{side:.4g}' for side in box.size)} m")
    if mass is None and component.lattice and "mass" in variables:
        mass = float(variables["mass"].start or 0.0)
    if mass is not None:
        words.append(f"mass {mass:.6g} kg")
    counts = {what: sum(v.causality == what for v in variables.values()) for what in ("input", "parameter", "output")}
    listed = ", ".join(f"{count} {what}{'s' * (count != 1)}" for what, count in counts.items())
    return "; ".join([", ".join(words), listed] if words else [listed])


def _driven(simulation: Simulation, inputs: Inputs) -> list[str]:
    there = [variable.name for variable in simulation.component.variables("input")]
    driven = {*inputs.names, *inputs.derived_names}
    given = [*inputs.names, *inputs.tuned]
    lines = []
    if given:
        derived = inputs.derived_names
        follows = f"; {few(derived)} {'follow' if len(derived) > 1 else 'follows'} from that" if derived else ""
        lines.append(f"{inputs.where}drives {few(given)}{follows}")
    if held := [name for name in there if name not in driven]:
        lines.append(f"nothing drives {few(held)}: {'they keep their start values' if len(held) > 1 else 'it keeps its start value'}")
    return lines


def told_after(summary: dict[str, Any]) -> str:
    """Returns time, methods, findings and warnings of a run's summary."""
    error, methods = summary.get("estimated_error_m"), summary.get("methods", [])
    estimate = "" if error is None else f" with an estimated error of {error:.2g} m"
    lines = [
        f"{summary['simulated_time_s']:g} s simulated in {summary['run_time_s']:.3g} s{estimate}, "
        f"{pace(summary['real_time_factor'])}, {summary['communication_steps']} communication steps",
        *(f"{format(row['share'], '.0%') if len(methods) > 1 else 'all'} of it by {row['method']}: {row['reason']}" for row in methods),
        *summary.get("findings", []),
        *(f"warning: {warning}" for warning in summary["warnings"]),
    ]
    return "\n".join(f"  {line}" for line in lines)


def pace(factor: float) -> str:
    """Returns a ratio of simulated time to run time in words."""
    times = factor if factor >= 1 else 1 / factor if factor > 0 else float("inf")
    if times < 1.05:
        return "as fast as real time"
    number = f"{times:.2g}" if times < 9.95 else f"{times:.0f}"
    return f"{number} times {'faster' if factor > 1 else 'slower'} than real time"


# ---- softffd info ----

HEAD = ("name", "causality", "variability", "unit", "start")


def told_info(component: Component, *, every: bool = False) -> str:
    """Returns title, body, default experiment, pins, and a table of variables. every: list each control point's in lines of their own."""
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
    for pin in component.resources.pins():
        at = ", ".join(f"{value:.6g}" for value in pin.origin)
        moved = "moved by its inputs" if pin.moved else "fixed"
        yield f"pin {pin.name}, {moved}: the frame at rest is at ({at}) m with the world's axes; it holds {pin.points} points"


def _row(variable: ScalarVariable) -> tuple[str, ...]:
    return (variable.name, variable.causality, variable.variability or "", variable.unit or "", _start(variable))


def _start(variable: ScalarVariable) -> str:
    """Returns the start value as a user would set it: by its name where the value has a name."""
    if variable.start is None or variable.type not in ("Real", "Integer", "Enumeration"):
        return str(variable.start or "")
    value = float(variable.start)
    named = next((name for name, each in (variable.items or {}).items() if each == value), None)
    return named or f"{value:.10g}"


def _grouped(variables: list[ScalarVariable], flat: bool) -> Iterator[tuple[str, ...]]:
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
