"""What `softffd run` says: before the first step what runs and what drives it, after the last one what it came to."""

from __future__ import annotations

from typing import Any

from softffd.fmu.component import Component
from softffd.run.inputs import Inputs
from softffd.run.simulation import Simulation
from softffd.spelling import few


def told_before(simulation: Simulation, inputs: Inputs) -> str:
    """Title, lattice, mass, variables, and which of the inputs are driven by what."""
    component = simulation.component
    mass = simulation.number("mass") if "mass" in simulation.variables else None
    return "\n".join([component.interface.title, *(f"  {line}" for line in (told_body(component, mass), *_driven(simulation, inputs)))])


def told_body(component: Component, mass: float | None) -> str:
    """Lattice, mass [kg] and number of variables; mass: None for its start value."""
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
        follows = f"; {few(inputs.derived_names)} {_verb(inputs.derived_names, 'follow')} from that" if inputs.derived_names else ""
        lines.append(f"{inputs.where}drives {few(given)}{follows}")
    if held := [name for name in there if name not in driven]:
        lines.append(f"nothing drives {few(held)}: {'they keep their start values' if len(held) > 1 else 'it keeps its start value'}")
    return lines


def _verb(names: list[str], verb: str) -> str:
    return verb if len(names) > 1 else f"{verb}s"


def told_after(summary: dict[str, Any]) -> str:
    """Time, methods, findings and warnings of a run's summary."""
    lines = [
        f"{summary['simulated_time_s']:g} s simulated in {summary['run_time_s']:.3g} s{_estimate(summary)}, "
        f"{pace(summary['real_time_factor'])}, {summary['communication_steps']} communication steps",
        *_methods(summary.get("methods", [])),
        *summary.get("findings", []),
        *(f"warning: {warning}" for warning in summary["warnings"]),
    ]
    return "\n".join(f"  {line}" for line in lines)


def _methods(rows: list[dict[str, Any]]) -> list[str]:
    part = "all" if len(rows) == 1 else ""
    return [f"{part or format(row['share'], '.0%')} of it by {row['method']}: {row['reason']}" for row in rows]


def pace(factor: float) -> str:
    """A ratio of simulated time to run time in words."""
    times = factor if factor >= 1 else 1 / factor if factor > 0 else float("inf")
    if times < 1.05:
        return "as fast as real time"
    number = f"{times:.2g}" if times < 9.95 else f"{times:.0f}"
    return f"{number} times {'faster' if factor > 1 else 'slower'} than real time"


def _estimate(summary: dict[str, Any]) -> str:
    error = summary.get("estimated_error_m")
    return "" if error is None else f" with an estimated error of {error:.2g} m"
