"""Which inputs of an FMU a source drives over time, and which outputs a run records."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from softffd.errors import FmuError, UnknownName
from softffd.names import is_pose, meant_by, structured
from softffd.spelling import did_you_mean, nearest_of

if TYPE_CHECKING:
    from softffd.fmu.component import Component
    from softffd.fmu.interface import ScalarVariable
    from softffd.run.inputs import Inputs
    from softffd.run.simulation import Simulation


def driven_inputs(component: Component, source: Inputs) -> list[ScalarVariable]:
    """The inputs that a source gives, in the order of its names, and then the velocities that follow from them, where the FMU has these as
    inputs. FmuError, which tells the source, where it names what is no input."""
    given = [_input(component, source, name) for name in source.names]
    source.derive_only({variable.name for variable in component.variables("input")})
    source.hold([variable.name for variable in given if variable.kind != "Real"])
    return given + [component.variable(name) for name in source.derived_names]


def require_undriven(simulation: Simulation, source: Inputs, start_values: Mapping[str, Any], driven: Sequence[str]) -> None:
    """FmuError where a start value has no effect, for the inputs give that variable from the first communication point on."""
    for given in start_values:
        if lost := [name for name in simulation.block([given]).names if name in driven]:
            follows = "" if lost[0] in source.names else " with its pose"
            other = "; inputs={} goes without the file, as softffd run --no-input does" if source.is_file else ""
            raise FmuError(
                f"{source.where}{lost[0]} comes from here over time{follows}, so its start value has no effect: "
                f"leave out one of the two{other}"
            )


def _input(component: Component, source: Inputs, name: str) -> ScalarVariable:
    """The input of this name; FmuError that tells the source otherwise."""
    try:
        variable = component.variable(name)
    except FmuError as error:
        raise FmuError(f"{source.where}{error}") from None
    if variable.causality != "input":
        hint = "; the scene names it in `inputs` of a plane or pin to make it one" if is_pose(name) else ""
        raise FmuError(f"{source.where}{name}: wanted an input of the FMU, got its {variable.causality} of that name{hint}")
    if variable.type == "String":
        raise FmuError(f"{source.where}{name}: wanted an input that is a number, got a String; start values set it")
    return variable


def recorded_outputs(component: Component, wanted: Iterable[str] | str | None) -> set[str]:
    """The names of the outputs to record; all without a choice but Strings, which no result has.

    A name means the output that has it and all that belong to it: plane.press.reaction.z, plane.press.reaction, plane.press, energy,
    position[0,0,1], position. FmuError, with the nearest name, where no output is meant.
    """
    by_name: dict[str, list[str]] = {}
    for variable in component.by_name.values():
        if variable.causality == "output" and variable.kind != "String":
            for name in meant_by(variable.name):
                by_name.setdefault(name, []).append(variable.name)
    if wanted is None:
        wanted = list(by_name)
    names: set[str] = set()
    for name in [wanted] if isinstance(wanted, str) else wanted:
        if (key := structured(str(name))) not in by_name:
            raise _unknown(str(name), component, by_name)
        names.update(by_name[key])
    return names


def _unknown(name: str, component: Component, choices: Iterable[str]) -> FmuError:
    if found := component.by_name.get(name):
        if found.type == "String":
            return FmuError(f"output: {name}: wanted an output of the FMU that is a number, got a String")
        return FmuError(f"output: {name}: wanted an output of the FMU, got its {found.causality} of that name")
    return UnknownName(f"output: {name}: the FMU has no such output{did_you_mean(nearest_of(name, choices))}")
