"""What an FMU offers its host: its name and guid, its variables, its default experiment.

A host of this package uses the variables of FMI 2.0, in which scalar elements take the place of the arrays of FMI 3.0. The library
supports both standards, whatever the description says.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from softffd.fmu.records import Resources
from softffd.fmu.variables import OF_POINTS, Variable, listed_values
from softffd.installed import table
from softffd.names import ByName, variable_names

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

IDENTIFIER = "softffd"  # modelIdentifier of this package's FMUs
TIME = 0  # value reference of the independent variable of FMI 3.0; no family has the id 0
TYPES3 = {"Real": "Float64", "Integer": "Int64"}  # FMI 3.0 names of the types of the table


@dataclass(frozen=True, slots=True)
class ScalarVariable:
    """One variable as modelDescription.xml declares it."""

    name: str
    reference: int  # its value reference
    type: str  # "Real" or "Integer"; in FMUs of other programs, and in older ones, also "Enumeration", "Boolean" or "String"
    causality: str  # "input", "output", "parameter", ...
    variability: str  # "fixed", "tunable", "continuous", "discrete", ...
    start: float | int | str | None
    unit: str | None
    description: str
    items: dict[str, int] | None = None  # numbers of its values by name, if its values have names: of solver.method, and of enumerations

    @property
    def kind(self) -> str:
        """ "Real", "Integer", "Boolean" or "String", whose calls get and set the variable. Value references are unique within a kind
        only."""
        return "Integer" if self.type == "Enumeration" else self.type


@dataclass(frozen=True)
class Interface:
    """The part of a model description that a run needs."""

    name: str  # modelName
    title: str  # the model's description, else its name
    identifier: str  # modelIdentifier: the library's name
    guid: str
    variables: ByName[ScalarVariable]  # by name, in the description's order
    flat: bool  # whether its names are flat (softffd.names)
    stop_time: float | None  # of the default experiment [s]
    step: float | None  # its communication step [s]
    interpolates: bool = True  # whether the FMU accepts derivatives of inputs
    saves: bool = True  # whether states can be got and set
    serializes: bool = True  # whether states can be turned into bytes and back


def scene_interface(scene: Scene, variables: Iterable[Variable], guid: str) -> Interface:
    """Returns the interface of a scene's FMU, without reading its XML."""
    flat = scene.fmu.names == "flat"
    listed = ByName({element.name: element for variable in variables for element in elements(variable, flat=flat)})
    experiment = scene.experiment
    return Interface(scene.name, scene.title, IDENTIFIER, guid, listed, flat, experiment.stop_time, experiment.communication_step)


def elements(variable: Variable, *, flat: bool = False) -> Iterator[ScalarVariable]:
    """Yields the elements of a scene's variable as scalar variables. flat: the form of their names."""
    family, starts = variable.family, variable.start or (None,)
    for n, (name, description) in enumerate(variable.elements(flat=flat)):
        yield ScalarVariable(
            name, variable.reference + n, family.get("type", "Real"), family["causality"], family["variability"],
            starts[n % len(starts)], family.get("unit"), description, listed_values(description) if family.get("named") else None,
        )  # fmt: skip


def read_interface(description: Any, resources: Resources | None = None) -> Interface:
    """Returns the interface from a modelDescription.xml that fmpy has read: of a co-simulation FMU of FMI 2.0, or of an FMU of this
    package for FMI 3.0, whose `resources` list the control points of its arrays."""
    simulation, experiment, three = description.coSimulation, description.defaultExperiment, description.fmiVersion.startswith("3.")
    own = simulation.modelIdentifier == IDENTIFIER
    flat = own and description.variableNamingConvention == "flat"
    if three and resources:
        arrays = (array for array in description.modelVariables if array.valueReference != TIME)
        declared = [element for array in arrays for element in _elements_of(array, resources, flat=flat)]
    else:
        declared = [_declared(variable, own) for variable in description.modelVariables]
    title, variables = description.description or description.modelName, ByName({variable.name: variable for variable in declared})
    stop_time, step = (_number(experiment.stopTime), _number(experiment.stepSize)) if experiment else (None, None)
    interface = Interface(description.modelName, title, simulation.modelIdentifier, description.guid, variables, flat, stop_time, step)
    if three:
        return interface
    return replace(
        interface, interpolates=bool(simulation.canInterpolateInputs), saves=bool(simulation.canGetAndSetFMUstate),
        serializes=bool(simulation.canSerializeFMUstate),
    )  # fmt: skip


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


def _elements_of(array: Any, resources: Resources, *, flat: bool) -> list[ScalarVariable]:
    """Returns the elements of an array in the order of their value references: for control points the order of the scene's list, not the
    array's."""
    family = next(family for family in table()["family"] if family["id"] == array.valueReference >> 24)
    if family["part"] in OF_POINTS:
        names = variable_names(family["key"], resources.points(family["part"]), flat=flat)
    else:
        between = "_" if flat else "."
        names = [f"{array.name}{between}{component}" for component in family["components"]] if array.dimensions else [array.name]
    kind = next(kind for kind, word in TYPES3.items() if word == array.type)
    starts: list[Any] = [float(word) if kind == "Real" else int(word) for word in (array.start or "").split()] or [None]
    items = listed_values(array.description) if family.get("named") else None
    return [
        ScalarVariable(
            name, array.valueReference + n, kind, array.causality, array.variability, starts[n % len(starts)], array.unit,
            array.description, items,
        )
        for n, name in enumerate(names)
    ]  # fmt: skip
