"""Variables that are set or got together, and the conversion of a user's values to numbers."""

from collections.abc import Callable, Mapping, Sequence
from ctypes import POINTER, c_char_p, c_double, c_int, c_size_t, c_uint
from typing import Any

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.interface import ScalarVariable
from softffd.names import listed
from softffd.spelling import did_you_mean, nearest_of, number_in, wanted_one_of

KINDS: dict[str, tuple[Any, Any]] = {
    "Real": (np.float64, c_double), "Integer": (np.int32, c_int), "Boolean": (np.int32, c_int), "String": (object, c_char_p),
}  # fmt: skip
"""Kinds of variables, with the numpy type and the C type of their values"""
TRUTHS = {"true": 1, "1": 1, "false": 0, "0": 0}  # words that are accepted for a Boolean


Calls = Mapping[str, Callable[..., None]]  # an instance's functions of the standard, by name


class Block:
    """Variables of one kind that are set or got together. `values` is the buffer (m,) that the library reads from and writes to; a
    Boolean is 0 or 1 in it. For Strings `values` is a copy."""

    def __init__(self, calls: Calls, variables: Sequence[ScalarVariable]):
        """variables: all of one kind; raises FmuError otherwise."""
        self.names = tuple(variable.name for variable in variables)
        self.kind = variables[0].kind if variables else "Real"
        if mixed := next((v for v in variables if v.kind != self.kind), None):
            raise FmuError(f"{mixed.name}: wanted variables of one type in a block, got a {mixed.type} beside a {variables[0].type}")
        array, item = KINDS[self.kind]
        self.values: np.ndarray = np.zeros(len(variables), dtype=array)
        self.references = (c_uint * len(variables))(*(variable.reference for variable in variables))
        self.count = c_size_t(len(variables))
        self.pointer = (c_char_p * len(variables))() if self.kind == "String" else self.values.ctypes.data_as(POINTER(item))
        self._calls = calls
        self._output = next((variable.name for variable in variables if variable.causality == "output"), None)

    def __repr__(self) -> str:
        what = {"Real": "numbers", "Integer": "integers"}.get(self.kind, f"{self.kind}s")
        return f"Block of {len(self.names)} {what}: {listed(self.names)}"

    def get(self) -> np.ndarray:
        """Fills `values` from the component and returns `values`, the block's own buffer, which the next call overwrites."""
        if self.names:
            self._calls[f"fmi2Get{self.kind}"](self.references, self.count, self.pointer)
        if self.kind == "String":
            self.values[:] = [(each or b"").decode("utf-8", "replace") for each in self.pointer]
        return self.values

    def set(self, values: Any = None) -> None:
        """Passes `values` to the component. values (m,): copied into the buffer before. Raises FmuError for outputs, for values that the
        component refuses, and for fractions where integers are wanted."""
        if self._output:
            raise FmuError(f"{self._output}: wanted an input or a parameter, got an output")
        if values is not None:
            if self.kind in ("Integer", "Boolean"):
                self._require_whole(np.broadcast_to(values, self.values.shape))
            self.values[:] = values
        if self.kind == "String":
            self.pointer[:] = [str(each).encode() for each in self.values]
        if self.names:
            self._calls[f"fmi2Set{self.kind}"](self.references, self.count, self.pointer)

    def _require_whole(self, values: np.ndarray) -> None:
        wanted, least, most = ("0 or 1", 0, 1) if self.kind == "Boolean" else ("an integer", *_RANGE)
        for name, value in zip(self.names, values, strict=True):
            if not (least <= value <= most and value == int(value)):
                raise FmuError(f"{name}: wanted {wanted}, got {value:.10g}")

    def set_rates(self, rates: Any) -> None:
        """Sets the time derivatives of these m Real inputs, which hold for the next step only.

        rates: (m,) of first order [unit / s], or (n, m) of orders 1 to n [unit / s^order]; zeros of higher orders are not sent.
        Raises FmuError if the FMU does not interpolate its inputs, or not to this order.
        """
        rates = np.atleast_2d(np.asarray(rates, dtype=float))
        sent = rates != 0
        sent[0] = True
        rows, columns = np.nonzero(sent)
        values = rates[sent]
        references = (c_uint * len(values))(*(self.references[int(column)] for column in columns))
        orders = (c_int * len(values))(*(int(row) + 1 for row in rows))
        self._calls["fmi2SetRealInputDerivatives"](references, c_size_t(len(values)), orders, values.ctypes.data_as(POINTER(c_double)))


class Blocks:
    """Variables of any kinds as one row of numbers, in a block for each kind."""

    def __init__(self, calls: Calls, variables: Sequence[ScalarVariable]):
        self.names = tuple(variable.name for variable in variables)
        self.values = np.zeros(len(variables))
        kinds = {kind: [n for n, v in enumerate(variables) if v.kind == kind] for kind in dict.fromkeys(v.kind for v in variables)}
        self._blocks = [(Block(calls, [variables[n] for n in places]), places) for places in kinds.values()]
        self.real = Block(calls, variables) if set(kinds) <= {"Real"} else None  # one block of all variables if all are Reals, else None

    def set(self, values: np.ndarray) -> None:
        """Passes values (m,) to the component."""
        self.values[:] = values
        for block, places in self._blocks:
            block.set(self.values[places])


_RANGE = (np.iinfo(np.int32).min, np.iinfo(np.int32).max)


def number_of(variable: ScalarVariable, value: Any) -> Any:
    """Returns the value that a block takes for a user's value: a number, 0 or 1 for a Boolean, the number of a name of an enumeration, or
    the text of a String. An integer must be a whole number. Raises FmuError that says what was wanted."""
    if variable.kind == "String":
        if not isinstance(value, str):
            raise FmuError(f"{variable.name}: wanted text, got {value!r:.70}")
        return value
    if variable.kind == "Boolean":
        return _truth(variable.name, value)
    if variable.items is not None and isinstance(value, str):
        if value in variable.items:
            return variable.items[value]
        if not value.lstrip("-").isdigit():
            raise FmuError(f"{variable.name}: {wanted_one_of(variable.items, value)}")
    real = variable.type == "Real"
    try:
        number = number_in(value) if isinstance(value, str) else float(value)
        if real or not np.isfinite(number) or (number == round(number) and _RANGE[0] <= number <= _RANGE[1]):
            return number if real or not np.isfinite(number) else round(number)
    except (TypeError, ValueError):
        pass
    raise FmuError(f"{variable.name}: wanted {'a number' if real else 'an integer'}, got {value!r:.70}")


def _truth(name: str, value: Any) -> int:
    word = str(value.item() if isinstance(value, np.generic) else value).strip().lower()
    word = {"1.0": "1", "0.0": "0"}.get(word, word)
    if word not in TRUTHS:
        raise FmuError(f"{name}: wanted true, false, 1 or 0, got {value!r:.70}{did_you_mean(nearest_of(word, ['true', 'false']))}")
    return TRUTHS[word]
