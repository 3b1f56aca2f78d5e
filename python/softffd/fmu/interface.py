"""What an FMU offers its host: its name and guid, its variables, its default experiment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from softffd.fmu.values import listed_values
from softffd.names import ByName

if TYPE_CHECKING:
    from softffd.fmu.variables import Variable
    from softffd.scene.scene import Scene

IDENTIFIER = "softffd"
"""modelIdentifier of this package's FMUs"""


@dataclass(frozen=True, slots=True)
class ScalarVariable:
    """One variable as modelDescription.xml declares it."""

    name: str
    reference: int
    """Its value reference"""
    type: str
    """ "Real", "Integer"; of other programs' FMUs, and of older ones, "Enumeration", "Boolean" or "String" too"""
    causality: str
    """ "input", "output", "parameter", ..."""
    variability: str
    """ "fixed", "tunable", "continuous", "discrete", ..."""
    start: float | int | str | None
    unit: str | None
    description: str
    items: dict[str, int] | None = None
    """Its values by their names, where they have names: of solver.method, and of enumerations"""

    @property
    def kind(self) -> str:
        """ "Real", "Integer", "Boolean" or "String": whose calls get and set it. Value references are unique within a kind only."""
        return "Integer" if self.type == "Enumeration" else self.type


@dataclass(frozen=True)
class Interface:
    """The part of a model description that a run needs."""

    name: str
    """modelName"""
    title: str
    """Its description, else its name"""
    identifier: str
    """modelIdentifier: the library's name"""
    guid: str
    variables: ByName[ScalarVariable]
    """By name, in the description's order"""
    plain: bool
    """Whether names at control points are plain"""
    stop_time: float | None
    """Of the default experiment [s]"""
    step: float | None
    """Its communication step [s]"""
    interpolates: bool
    """Whether derivatives of inputs are taken"""
    saves: bool
    """Whether states can be got and set"""
    serializes: bool
    """Whether states can be turned into bytes and back"""

    def of(self, causality: str, kind: str = "Real") -> list[ScalarVariable]:
        """The variables of a causality and a kind."""
        return [v for v in self.variables.values() if v.causality == causality and v.kind == kind]


def scene_interface(scene: Scene, variables: list[Variable], guid: str) -> Interface:
    """The interface of a scene's FMU, without a look at its XML."""
    return Interface(
        name=scene.name,
        title=scene.title,
        identifier=IDENTIFIER,
        guid=guid,
        variables=ByName({variable.name: _scalar(variable) for variable in variables}),
        plain=scene.fmu.names == "plain",
        stop_time=scene.experiment.stop_time,
        step=scene.experiment.communication_step,
        interpolates=True,
        saves=True,
        serializes=True,
    )


def _scalar(variable: Variable) -> ScalarVariable:
    family = variable.family
    items = listed_values(variable.description) if family.get("named") else None
    return ScalarVariable(
        variable.name, variable.reference, family.get("type", "Real"), family["causality"], family["variability"],
        variable.start, family.get("unit"), variable.description, items,
    )  # fmt: skip


def read_interface(description: Any) -> Interface:
    """The interface from fmpy's reading of a modelDescription.xml (FMI 2.0, co-simulation)."""
    simulation, experiment = description.coSimulation, description.defaultExperiment
    own = simulation.modelIdentifier == IDENTIFIER
    return Interface(
        name=description.modelName,
        title=description.description or description.modelName,
        identifier=simulation.modelIdentifier,
        guid=description.guid,
        variables=ByName({variable.name: _declared(variable, own) for variable in description.modelVariables}),
        plain=own and description.variableNamingConvention == "flat",
        stop_time=_number(experiment.stopTime) if experiment else None,
        step=_number(experiment.stepSize) if experiment else None,
        interpolates=bool(simulation.canInterpolateInputs),
        saves=bool(simulation.canGetAndSetFMUstate),
        serializes=bool(simulation.canSerializeFMUstate),
    )


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _declared(variable: Any, own: bool) -> ScalarVariable:
    items = listed_values(variable.description or "") if own and variable.type == "Integer" else None
    if variable.type == "Enumeration" and variable.declaredType is not None:
        items = {item.name: int(item.value) for item in variable.declaredType.items}
    return ScalarVariable(
        variable.name, variable.valueReference, variable.type, variable.causality, variable.variability,
        variable.start, variable.unit, variable.description or "", items,
    )  # fmt: skip
