"""The parameters of a fit as coordinates of one scale: logarithms if they are positive, fractions of their range if it has two ends."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from softffd.errors import FmuError, UnknownName
from softffd.fmu.block import number_of
from softffd.fmu.component import Component
from softffd.fmu.interface import ScalarVariable
from softffd.names import range_of
from softffd.run.parts import at_point
from softffd.spelling import few


@dataclass(frozen=True)
class Parameter:
    """A fitted parameter. Its coordinate is 1 at the start. An increase by 1 multiplies the parameter by e, or adds `scale` to it."""

    name: str
    unit: str
    start: float
    least: float
    most: float  # ends of its range, infinite if there are none

    @property
    def positive(self) -> bool:
        """True if the coordinate is a logarithm."""
        return self.least >= 0 and math.isinf(self.most)

    @property
    def scale(self) -> float:
        """Change of the parameter per unit of a coordinate that is no logarithm."""
        return self.most - self.least if math.isfinite(self.most - self.least) else abs(self.start) or 1.0

    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds of the coordinate."""
        if self.positive:
            return -math.inf, math.inf
        return 1 + (self.least - self.start) / self.scale, 1 + (self.most - self.start) / self.scale

    def value(self, coordinate: float) -> float:
        """Returns the parameter's value at a coordinate."""
        if self.positive:
            return self.start * math.exp(min(coordinate - 1, 600.0))
        return min(max(self.start + self.scale * (coordinate - 1), self.least), self.most)

    def error(self, coordinate: float, error: float) -> float:
        """Returns the parameter's standard error from that of its coordinate, to first order."""
        return error * (self.value(coordinate) if self.positive else self.scale)


def parameters_of(component: Component, vary: Mapping[str, Any]) -> list[Parameter]:
    """Returns the parameters to be fitted with their start values, by default those of the FMU. Raises FmuError, which lists all
    parameters that can be fitted, for anything but a fixed or tunable parameter, and FmuError for start values out of range."""
    if not vary:
        raise FmuError("vary: wanted at least one parameter, such as 'youngs_modulus', got none")
    found: dict[str, Parameter] = {}
    for name, start in vary.items():
        variable = component.by_name.get(name)
        if variable is None or not _fits(variable):
            raise UnknownName(_not_fitted(component, str(name), variable))
        if variable.name in found:
            raise FmuError(f"vary: {name}: wanted each parameter once")
        found[variable.name] = _parameter(component, variable, start)
    return list(found.values())


def _fits(variable: ScalarVariable) -> bool:
    return variable.causality == "parameter" and variable.variability in ("fixed", "tunable") and variable.kind == "Real"


def _parameter(component: Component, variable: ScalarVariable, given: Any) -> Parameter:
    least, most = (math.inf * sign if end is None else end for sign, end in zip((-1, 1), _range(component, variable), strict=True))
    start = float(number_of(variable, variable.start or 0.0 if given is None else given))
    parameter = Parameter(variable.name, variable.unit or "", start, least, most)
    how = f"; give another start: --vary {variable.name}=VALUE, in Python vary={{'{variable.name}': VALUE}}"
    if parameter.positive and not (0 < start < math.inf and start >= least):
        raise FmuError(f"vary: {variable.name}: wanted a start > 0, for it is positive, got {start:g}{how}")
    if not least <= start <= most:
        raise FmuError(f"vary: {variable.name}: wanted a start from {least:g} to {most:g}, got {start:g}{how}")
    return parameter


def _range(component: Component, variable: ScalarVariable) -> tuple[float | None, float | None]:
    if component.lattice:
        return range_of(variable.name)
    declared = next(each for each in component.description.modelVariables if each.name == variable.name)
    least, most = (None if end is None else float(end) for end in (declared.min, declared.max))
    return least, most


def _not_fitted(component: Component, name: str, variable: ScalarVariable | None) -> str:
    free = [each.name for each in component.by_name.values() if _fits(each) and not at_point(each.name)]
    why = "the FMU has no such parameter" + component.hint(name, free)
    if variable is not None:
        what = variable.causality if variable.causality != "parameter" else f"{variable.variability} parameter of type {variable.type}"
        why = f"wanted a fixed or tunable parameter that is a Real, got an {what}" if what[0] in "aeiou" else f"wanted a Real, got a {what}"
    return f"vary: {name}: cannot be fitted: {why}; those that can: {few(free) or 'none'}"


def values_of(parameters: list[Parameter], point: np.ndarray) -> dict[str, float]:
    """Returns the parameters' values at coordinates (n,)."""
    return {parameter.name: parameter.value(float(x)) for parameter, x in zip(parameters, point, strict=True)}
