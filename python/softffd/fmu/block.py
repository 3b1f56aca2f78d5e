"""Variables that are set or got together, and the numbers that stand for what a user gives."""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import POINTER, c_double, c_int, c_size_t, c_uint
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.interface import ScalarVariable
from softffd.names import listed
from softffd.spelling import did_you_mean, nearest_of

if TYPE_CHECKING:
    from softffd.fmu.component import Component


class Block:
    """Variables of one type that are set or got together; `values` is the buffer (m,) that the library reads from and writes to."""

    def __init__(self, component: Component, variables: Sequence[ScalarVariable]):
        """variables: all Reals, or none of them; FmuError otherwise."""
        self.names = tuple(variable.name for variable in variables)
        self.real = all(variable.type == "Real" for variable in variables)
        if not self.real and (mixed := next((v.name for v in variables if v.type == "Real"), None)):
            raise FmuError(f"{mixed}: wanted variables of one type in a block, got a Real beside others")
        self.values: np.ndarray = np.zeros(len(variables), dtype=np.float64 if self.real else np.int32)
        self.references = (c_uint * len(variables))(*(variable.reference for variable in variables))
        self.count = c_size_t(len(variables))
        self.pointer = self.values.ctypes.data_as(POINTER(c_double if self.real else c_int))
        self._component = component
        self._output = next((variable.name for variable in variables if variable.causality == "output"), None)

    def __repr__(self) -> str:
        return f"Block of {len(self.names)} {'numbers' if self.real else 'integers'}: {listed(self.names)}"

    def get(self) -> np.ndarray:
        """Fills `values` from the component and returns it: the kept buffer, which the next call changes."""
        self._component.get(self)
        return self.values

    def set(self, values: Any = None) -> None:
        """Hands `values` to the component; values (m,): to be put there before. FmuError for outputs and for what the component refuses."""
        if self._output:
            raise FmuError(f"{self._output}: wanted an input or a parameter, got an output")
        if values is not None:
            self.values[:] = values
        self._component.set(self)

    def set_rates(self, rates: Any) -> None:
        """Time derivatives of these inputs, which hold for the next step only; shapes as in Component.set_rates."""
        self._component.set_rates(self, np.asarray(rates, dtype=float))


def number_of(variable: ScalarVariable, value: Any) -> float | int:
    """The number that stands for a value of a variable, which may be given by its name where it has one; FmuError says what was wanted."""
    if variable.items is not None and isinstance(value, str):
        if value in variable.items:
            return variable.items[value]
        if not value.lstrip("-").isdigit():
            nearest = did_you_mean(nearest_of(value, variable.items))
            raise FmuError(f"{variable.name}: wanted one of {', '.join(variable.items)}, got {value!r}{nearest}")
    try:
        return float(value) if variable.type == "Real" else int(value)
    except (TypeError, ValueError):
        kind = "a number" if variable.type == "Real" else "an integer"
        raise FmuError(f"{variable.name}: wanted {kind}, got {value!r}") from None
