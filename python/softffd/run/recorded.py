"""Which outputs a run records: all, or those that are named."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from softffd.errors import FmuError, UnknownName
from softffd.names import meant_by, structured
from softffd.spelling import did_you_mean, nearest_of

if TYPE_CHECKING:
    from softffd.fmu.component import Component


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
