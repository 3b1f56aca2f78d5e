"""Reads and sets the variables of a component by name: single variables and vectors; and blocks of variables."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from softffd.errors import FmuError, UnknownName
from softffd.fmu.block import Block, number_of
from softffd.fmu.component import Component
from softffd.fmu.interface import ScalarVariable
from softffd.names import MEMBERS, components_in, vectors_in


class Variables:
    """Reads and sets a component's variables by name; the name of a vector means its components."""

    initializing = True
    """True if the first step is still to come, so that everything can be set"""

    def __init__(self, component: Component):
        self.component = component
        """The thin layer below, whose calls are those of the standard"""
        self._blocks: dict[str, Block] = {}

    @property
    def variables(self) -> dict[str, ScalarVariable]:
        """All scalar variables by name: type, causality, variability, start, unit, description."""
        return self.component.by_name

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and bool(self._components(name))

    def __getitem__(self, name: str) -> Any:
        """Returns a variable's value: a number, the name of the value if it has one (`solver.method`), for a Boolean True or False, for
        a String its text; or, if `name` has components .x .y .z, an array of these."""
        if name not in self.variables:
            return self.vector(name)
        variable, value = self.variables[name], self._block(name).get().tolist()[0]
        if variable.type == "Boolean":
            return bool(value)
        return next((item for item, number in (variable.items or {}).items() if number == value), value)

    def __setitem__(self, name: str, value: Any) -> None:
        """Sets a variable, or all components of a vector. FmuError for outputs and numbers that are not finite."""
        variables = [self.variables[each] for each in self._named(name)]
        for variable in variables:
            if variable.causality not in ("input", "parameter"):
                raise FmuError(f"{variable.name}: wanted an input or a parameter, got an {variable.causality}")
            if variable.variability == "fixed" and not self.initializing:
                when = "can be set before the first step only; `restart` takes other start values"
                raise FmuError(f"{variable.name}: a fixed parameter {when}")
        values = [value] if name in self.variables else _components_of(name, value, len(variables))
        given = [number_of(variable, each) for variable, each in zip(variables, values, strict=True)]
        for variable, number in zip(variables, given, strict=True):
            if not (isinstance(number, str) or math.isfinite(number)):
                raise FmuError(f"{variable.name}: wanted a finite number, got {number:g}")
        self._block(name).set(given)

    def number(self, name: str) -> float | int:
        """Returns the value of one scalar variable, 0 or 1 for a Boolean. FmuError for a String."""
        if self.component.variable(name).type == "String":
            raise FmuError(f"{name}: wanted a number, got a String")
        return self._block(name).get().tolist()[0]

    def vector(self, name: str) -> np.ndarray:
        """Returns the components (3,) or (4,) of a vector, a copy."""
        if name in self.variables:
            raise FmuError(f"{name}: wanted a vector, got a single number of that name")
        return self._block(name).get().astype(float)

    def _components(self, name: str) -> list[str]:
        """Returns the scalar variables that a name means: itself, or its components; for `stiffness` those of the kinds of springs."""
        if name in self.variables:
            return [name]
        return list(components_in(self.variables, name, MEMBERS).values())

    def _named(self, name: str) -> list[str]:
        if found := self._components(name) if isinstance(name, str) else []:
            return found
        hint = self.component.hint(str(name), [*self.variables, *vectors_in(self.variables)])
        raise UnknownName(f"{name}: the FMU has no such variable{hint}")

    def _block(self, name: str) -> Block:
        if name not in self._blocks:
            self._blocks[name] = self.component.block(self._named(name))
        return self._blocks[name]

    def block(self, names: Iterable[str] | str) -> Block:
        """Returns variables that are set or read together, the fastest way: `block.values` is a kept buffer (m,), `block.get()` fills
        and returns the buffer, `block.set()` hands it over, `block.set_rates(...)` takes derivatives of inputs. A vector's name means
        all its components."""
        return self.component.block([each for name in ([names] if isinstance(names, str) else names) for each in self._named(name)])

    def set_rates(self, rates: Mapping[str, Any]) -> None:
        """Sets time derivatives of inputs for the next step, by name: the inputs are not held, but move from the values that are set.

        For a number, its rate [unit / s], or a list of its first to third derivatives [unit / s, unit / s2, unit / s3]; for a vector, an
        array (3,), or (orders, 3). Forces and loads take orders 1 to 3, poses and velocities order 1.
        """
        columns: dict[str, np.ndarray] = {}
        for name, given in rates.items():
            names = self._named(name)
            table = np.atleast_1d(np.asarray(given, dtype=float))
            table = table[:, None] if name in self.variables else np.atleast_2d(table)
            if table.ndim != 2 or table.shape[1] != len(names):
                raise FmuError(f"{name}: wanted derivatives of {len(names)} components, got the shape {np.shape(given)}")
            columns |= dict(zip(names, table.T, strict=True))
        orders = max((len(column) for column in columns.values()), default=1)
        block = self.component.block(list(columns))
        block.set_rates(np.stack([np.pad(column, (0, orders - len(column))) for column in columns.values()], axis=1))


def _components_of(name: str, value: Any, count: int) -> list[Any]:
    """Returns as many values as there are components; a text has them between commas, and one number is the stiffness of all springs."""
    try:
        values = value.strip("[]() ").split(",") if isinstance(value, str) else list(value)
    except TypeError:
        values = [value]
    if len(values) == 1 and name == "stiffness":
        values *= count
    if len(values) != count:
        raise FmuError(f"{name}: wanted {count} numbers, got {value!r:.70}")
    return values
