"""An FMU opened for a run: fmpy unpacks, reads and loads it; the calls of the loop go straight to its library with kept buffers."""

from __future__ import annotations

import shutil
from ctypes import POINTER, c_double, c_int, c_size_t, c_uint, c_void_p
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import fmpy
import numpy as np
from fmpy import calloc, free
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

from softffd.errors import FmuError
from softffd.fmu.records import read_lattice
from softffd.spelling import did_you_mean, nearest_of

WARNING, DISCARD = 1, 2
LIFE_CYCLE = ("fmi2EnterInitializationMode", "fmi2ExitInitializationMode", "fmi2Terminate", "fmi2Reset")


@dataclass(frozen=True)
class Block:
    """Variables of one type that are set or got together; `values` is the buffer that the library writes to or reads from."""

    names: tuple[str, ...]
    real: bool
    references: Any
    values: np.ndarray
    pointer: Any

    @classmethod
    def of(cls, variables: list[Any], real: bool) -> Block:
        references = (c_uint * len(variables))(*(variable.valueReference for variable in variables))
        values = np.zeros(len(variables), dtype=np.float64 if real else np.int32)
        pointer = values.ctypes.data_as(POINTER(c_double if real else c_int))
        return cls(tuple(variable.name for variable in variables), real, references, values, pointer)


class Component:
    """One instance of one FMU. Use as a context manager; every failing call raises FmuError with the component's own message."""

    def __init__(self, path: str | Path):
        path = Path(path)
        if not path.is_file():
            raise FmuError(f"{path}: there is no such FMU")
        self._folder = mkdtemp(prefix="softffd-")
        try:
            self._open(path)
        except BaseException:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise

    def _open(self, path: Path) -> None:
        self.messages: list[tuple[int, str]] = []
        self._slave = None
        try:
            fmpy.extract(str(path), unzipdir=self._folder)
            self.description = fmpy.read_model_description(self._folder, validate=False)
            simulation = self.description.coSimulation
            if simulation is None or self.description.fmiVersion != "2.0":
                raise FmuError(f"{path}: wanted an FMI 2.0 co-simulation FMU")
            slave = FMU2Slave(
                guid=self.description.guid,
                unzipDirectory=self._folder,
                modelIdentifier=simulation.modelIdentifier,
                instanceName=self.description.modelName,
            )
        except FmuError:
            raise
        except Exception as error:
            raise FmuError(f"{path}: cannot be opened as an FMU: {error}") from error
        self._callbacks = self._make_callbacks()
        self._library = slave.dll
        try:
            slave.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:
            raise FmuError(f"{path}: {self._last_message() or error}") from error
        self._slave = slave
        self.lattice = read_lattice(Path(self._folder) / "resources")
        self.by_name = {variable.name: variable for variable in self.description.modelVariables}
        self._prepare_calls()

    def _make_callbacks(self) -> fmi2CallbackFunctions:
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(self._note)
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        return callbacks

    def _note(self, _environment, _instance, status: int, _category, message: bytes) -> None:
        self.messages.append((status, message.decode("utf-8", "replace").replace("%%", "%").replace("##", "#")))

    def _last_message(self) -> str:
        return self.messages[-1][1] if self.messages else ""

    def _prepare_calls(self) -> None:
        """The loop's calls, bound once to the library's functions and the instance."""
        instance, library = c_void_p(self._slave.component), self._library

        def bound(function):
            return lambda *arguments: self._check(function(instance, *arguments))

        self._do_step = bound(library.fmi2DoStep)
        self._set_real, self._get_real = bound(library.fmi2SetReal), bound(library.fmi2GetReal)
        self._set_integer, self._get_integer = bound(library.fmi2SetInteger), bound(library.fmi2GetInteger)
        self._set_rates = bound(library.fmi2SetRealInputDerivatives)
        self._life = {name: bound(getattr(library, name)) for name in LIFE_CYCLE}

    def variables(self, causality: str, *, real: bool = True) -> list[Any]:
        """The description's variables of a causality, Reals or the others."""
        return [v for v in self.description.modelVariables if v.causality == causality and (v.type == "Real") == real]

    def block(self, names: list[str], *, real: bool = True) -> Block:
        """A block of the named variables; FmuError with the nearest spelling for an unknown name."""
        return Block.of([self.variable(name) for name in names], real)

    def variable(self, name: str) -> Any:
        """The description's variable of this name; FmuError with the nearest spelling otherwise."""
        if name not in self.by_name:
            raise FmuError(f"{name}: the FMU has no such variable{did_you_mean(nearest_of(str(name), self.by_name))}")
        return self.by_name[name]

    def set_start_values(self, values: dict[str, Any]) -> None:
        """Sets variables by name; numbers, or the item's name for an enumeration."""
        for name, value in values.items():
            variable = self.variable(name)
            real = variable.type == "Real"
            block = Block.of([variable], real)
            block.values[0] = self._number(variable, value)
            self.set(block)

    def _number(self, variable: Any, value: Any) -> float | int:
        if variable.type == "Enumeration" and isinstance(value, str):
            items = {item.name: int(item.value) for item in variable.declaredType.items}
            if value in items:
                return items[value]
            if not value.lstrip("-").isdigit():
                raise FmuError(f"{variable.name}: wanted one of {', '.join(items)}, got {value!r}{did_you_mean(nearest_of(value, items))}")
        try:
            return float(value) if variable.type == "Real" else int(value)
        except (TypeError, ValueError):
            kind = "a number" if variable.type == "Real" else "an integer"
            raise FmuError(f"{variable.name}: wanted {kind}, got {value!r}") from None

    def initialize(self, start_values: dict[str, Any], *, start_time: float = 0.0, stop_time: float | None = None) -> None:
        """From instantiated to ready for a step, with start values (by name) set before."""
        self.set_start_values(start_values)
        self._slave.setupExperiment(startTime=start_time, stopTime=stop_time)
        self._life["fmi2EnterInitializationMode"]()

    def exit_initialization(self) -> None:
        """fmi2ExitInitializationMode."""
        self._life["fmi2ExitInitializationMode"]()

    def terminate(self) -> None:
        """fmi2Terminate."""
        self._life["fmi2Terminate"]()

    def reset(self) -> None:
        """fmi2Reset: as right after opening."""
        self._life["fmi2Reset"]()

    def set(self, block: Block) -> None:
        """Hands the block's values to the component."""
        call = self._set_real if block.real else self._set_integer
        call(block.references, c_size_t(len(block.names)), block.pointer)

    def get(self, block: Block) -> None:
        """Fills the block's values."""
        call = self._get_real if block.real else self._get_integer
        call(block.references, c_size_t(len(block.names)), block.pointer)

    def set_rates(self, block: Block, rates: np.ndarray) -> None:
        """Time derivatives of a block of m Real inputs; they hold for the next step only.

        rates: (m,) of first order [unit / s], or (n, m) of orders 1 to n [unit / s^order]; zeros of higher orders are not sent.
        FmuError for an FMU that does not interpolate its inputs, or not to this order.
        """
        if not self.description.coSimulation.canInterpolateInputs:
            raise FmuError(f"{self.description.modelName}: this FMU does not interpolate its inputs; hold them over each step instead")
        rates = np.atleast_2d(rates)
        sent = rates != 0
        sent[0] = True
        rows, columns = np.nonzero(sent)
        values = rates[sent]
        references = (c_uint * len(values))(*(block.references[column] for column in columns))
        orders = (c_int * len(values))(*(int(row) + 1 for row in rows))
        self._set_rates(references, c_size_t(len(values)), orders, values.ctypes.data_as(POINTER(c_double)))

    def do_step(self, time: float, step: float) -> None:
        """One communication step [s]."""
        self._do_step(c_double(time), c_double(step), c_int(1))

    def warnings(self) -> list[str]:
        """What the component warned of so far."""
        return [message for status, message in self.messages if status >= WARNING]

    def _check(self, status: int) -> None:
        if status >= DISCARD:
            word = "discarded the step" if status == DISCARD else "reported an error"
            raise FmuError(f"the component {word}: {self._last_message() or 'no message'}")

    def close(self) -> None:
        """Frees the instance and the unpacked files."""
        if self._slave is not None:
            self._slave.freeInstance()
            self._slave = None
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> Component:
        return self

    def __exit__(self, *_exception) -> None:
        self.close()
