"""An FMU opened for a run: fmpy loads its library; the calls of the loop go straight to it with kept buffers.

This is the thin layer over the C functions, which a host drives through softffd.Simulation.
"""

from __future__ import annotations

import hashlib
import weakref
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import chdir
from ctypes import POINTER, byref, c_char, c_double, c_int, c_size_t, c_uint, c_void_p, cast, create_string_buffer
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from softffd.errors import FmuError, UnknownName
from softffd.fmu.absent import hint_for
from softffd.fmu.archive import library_in_tuple, of_another_machine, on_x86, unpack
from softffd.fmu.block import KINDS, Block, number_of
from softffd.fmu.interface import ScalarVariable, read_interface
from softffd.fmu.notes import read_notes
from softffd.fmu.records import PinRecord, read_lattice, read_obstacles, read_pins, read_taxels
from softffd.installed import loaded_library
from softffd.lattice import LatticeBox

if TYPE_CHECKING:
    from fmpy.fmi2 import fmi2CallbackFunctions

    from softffd.scene.scene import Scene

WARNING, DISCARD, FATAL = 1, 2, 4
CALLS = (
    *("fmi2SetupExperiment", "fmi2EnterInitializationMode", "fmi2ExitInitializationMode", "fmi2Reset", "fmi2DoStep"),
    *("fmi2SetReal", "fmi2GetReal", "fmi2SetInteger", "fmi2GetInteger", "fmi2SetRealInputDerivatives"),
    *("fmi2SetBoolean", "fmi2GetBoolean", "fmi2SetString", "fmi2GetString"),
    *("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2FreeFMUstate"),
    *("fmi2SerializedFMUstateSize", "fmi2SerializeFMUstate", "fmi2DeSerializeFMUstate"),
)


class Message(NamedTuple):
    """What a component said; its text is its str."""

    status: int
    """fmi2Status: 0 ok, 1 warning, 2 discard, 3 error, 4 fatal"""
    category: str
    """Log category: "solver", "logStatusWarning", "logStatusError\""""
    text: str

    def __str__(self) -> str:
        return self.text


class Component:
    """One instance of one FMU. Use as a context manager; every failing call raises FmuError with the component's own message.

    source: the path of an FMU; or a scene, whose FMU is written unpacked and whose library is the installed one.
    running: without it the description and the resources are read and nothing of the FMU is run: there is no instance to call.
    One that nobody closes is freed with the last reference to it.
    """

    def __init__(self, source: Scene | str | Path, *, running: bool = True):
        if isinstance(source, str | Path) and not Path(source).is_file():
            raise FmuError(f"{source}: there is no such FMU")
        self.messages: list[Message] = []
        """What the component has said since it was opened; may be cleared"""
        self.listener: Callable[[Message], object] | None = None
        """Is called with every message"""
        self._states: set[int] = set()
        self._slave: Any = None
        self._unpacked = TemporaryDirectory(prefix="softffd-", ignore_cleanup_errors=True)
        self._folder = self._unpacked.name
        try:
            self._open(source, running)
        except BaseException:
            self.close()
            raise

    def _open(self, source: Scene | str | Path, running: bool) -> None:
        library = self._unpack(Path(source)) if isinstance(source, str | Path) else self._write(source)
        self.lattice: LatticeBox | None = read_lattice(Path(self._folder) / "resources")
        """Of an FMU of this package; so are these:"""
        self.obstacles = read_obstacles(Path(self._folder) / "resources")
        self.taxels = read_taxels(Path(self._folder) / "resources")
        if not running:
            return
        from fmpy.fmi2 import FMU2Slave  # takes a sixth of a second, which those who have a scene and run nothing do without

        self._callbacks = self._make_callbacks()
        try:
            with chdir(Path.cwd()):  # which fmpy leaves, and returns to where it could load the library only
                slave = FMU2Slave(
                    guid=self.interface.guid, unzipDirectory=self._folder, modelIdentifier=self.interface.identifier,
                    instanceName=self.interface.name, libraryPath=library,
                )  # fmt: skip
        except Exception as error:
            why = of_another_machine(Path(self._folder), self.interface.identifier) or error
            raise FmuError(f"{self._name}: cannot be opened as an FMU: {why}") from error
        try:
            slave.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:
            slave.freeLibrary()
            raise FmuError(f"{self._name}: {self._last_message() or error}") from error
        self._slave, self._library = slave, slave.dll
        self._end = weakref.finalize(self, _freed, slave, self._states, self._callbacks)
        self._end.atexit = False  # the end of the process takes all
        instance = c_void_p(slave.component)
        self._calls = {name: _bound(getattr(slave.dll, name), instance, self.check) for name in CALLS}
        self._keep_loop_calls()

    def _unpack(self, path: Path) -> str | None:
        """Unpacks and reads an FMU; returns the path of its library where that is not where FMI 2.0 says: the installed one if it is the
        same."""
        self._name = str(path)
        try:
            library = unpack(path, self._folder)
            description = self.description
            resources = Path(self._folder) / "resources"
            if description.fmiVersion.startswith("3.") and read_lattice(resources):
                self.interface = read_interface(description, resources)
                return library or library_in_tuple(Path(self._folder), self.interface.identifier)
            if description.coSimulation is None or description.fmiVersion != "2.0":
                raise FmuError(f"{path}: wanted an FMI 2.0 co-simulation FMU, or one of this package for FMI 3.0")
            self.interface = read_interface(description, resources)
            return library or (None if on_x86() else library_in_tuple(Path(self._folder), self.interface.identifier))
        except FmuError:
            raise
        except Exception as error:
            raise FmuError(f"{path}: cannot be opened as an FMU: {error}") from error

    def _write(self, scene: Scene) -> str:
        """Writes a scene's FMU unpacked and returns the path of the library, which stays where it is installed."""
        from softffd.fmu.package import write_folder  # brings pydantic along, which those who have an FMU do without

        self.interface = write_folder(scene, Path(self._folder))
        self._name = scene.name
        return str(loaded_library()._name)

    @cached_property
    def description(self) -> Any:
        """fmpy's reading of the modelDescription.xml."""
        import fmpy

        return fmpy.read_model_description(self._folder, validate=False)

    @cached_property
    def pins(self) -> list[PinRecord]:
        """The pins, fixed ones too; none in an FMU that is not of this package."""
        return read_pins(Path(self._folder) / "resources")

    @cached_property
    def notes(self) -> list[str]:
        """What a user should know of the body; none in an FMU that is not of this package."""
        return list(read_notes(Path(self._folder) / "resources"))

    def _make_callbacks(self) -> fmi2CallbackFunctions:
        from fmpy import calloc, fmi2, free

        callbacks = fmi2.fmi2CallbackFunctions()
        me = weakref.ref(self)  # the library's last words may come when there is nobody to hear them

        def note(_environment: Any, _instance: Any, status: int, category: bytes | None, text: bytes) -> None:
            if component := me():
                component._note(status, category, text)

        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(note)
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        return callbacks

    def _note(self, status: int, category: bytes | None, text: bytes) -> None:
        said = text.decode("utf-8", "replace").replace("%%", "%").replace("##", "#")
        message = Message(status, (category or b"").decode("utf-8", "replace"), said)
        self.messages.append(message)
        if self.listener:
            self.listener(message)

    def _last_message(self) -> str:
        return self.messages[-1].text if self.messages else ""

    def _keep_loop_calls(self) -> None:
        calls = self._calls
        self._do_step, self._set_rates = calls["fmi2DoStep"], calls["fmi2SetRealInputDerivatives"]
        self._setters, self._getters = ({kind: calls[f"fmi2{way}{kind}"] for kind in KINDS} for way in ("Set", "Get"))

    @property
    def instance(self) -> int:
        """The fmi2Component."""
        return int(self._slave.component)

    def library_hash(self) -> str:
        """SHA-256 of the component's library."""
        return hashlib.sha256(Path(self._library._name).read_bytes()).hexdigest()

    def address(self, call: str) -> int | None:
        """Of a function of the component's library."""
        return cast(getattr(self._library, call), c_void_p).value

    def check(self, status: int) -> None:
        """FmuError with the component's words for the fmi2Status of a call that discarded or failed."""
        if status == FATAL:
            self._abandon()
        if status >= DISCARD:
            word = "discarded the step" if status == DISCARD else "reported an error"
            raise FmuError(f"the component {word}: {self._last_message() or 'no message'}")

    def _abandon(self) -> None:
        """After fmi2Fatal no call is allowed, not even to free the instance (FMI 2.0.4, section 2.1.3): pythonfmu's would free twice."""
        self._end.detach()
        _ABANDONED.append((self._slave, self._callbacks))
        self._slave = None
        self._states.clear()
        self._answer_with(_failed)

    # ---- variables ----

    @property
    def by_name(self) -> dict[str, ScalarVariable]:
        """All variables by name."""
        return self.interface.variables

    def variables(self, causality: str, kind: str = "Real") -> list[ScalarVariable]:
        """The variables of a causality and a kind: "Real", "Integer", "Boolean" or "String"."""
        return self.interface.of(causality, kind)

    def variable(self, name: str) -> ScalarVariable:
        """The variable of this name; FmuError with the nearest spelling otherwise."""
        if name not in self.by_name:
            raise UnknownName(f"{name}: the FMU has no such variable{self.hint(str(name))}")
        return self.by_name[name]

    def hint(self, name: str, choices: Collection[str] | None = None) -> str:
        """What to say of a name that is not there: what the scene needs for it, else the nearest of the choices, by default of all."""
        return hint_for(name, self.by_name, choices, own=self.lattice is not None)

    def block(self, names: Sequence[str]) -> Block:
        """A block of the named variables; FmuError with the nearest spelling for an unknown name."""
        return self.block_of([self.variable(name) for name in names])

    def block_of(self, variables: Sequence[ScalarVariable]) -> Block:
        """A block of variables of this component."""
        return Block(self, variables)

    def set(self, block: Block) -> None:
        """Hands the block's values to the component."""
        self._setters[block.kind](block.references, block.count, block.pointer)

    def get(self, block: Block) -> None:
        """Fills the block's values."""
        self._getters[block.kind](block.references, block.count, block.pointer)

    def set_rates(self, block: Block, rates: np.ndarray) -> None:
        """Time derivatives of a block of m Real inputs; they hold for the next step only.

        rates: (m,) of first order [unit / s], or (n, m) of orders 1 to n [unit / s^order]; zeros of higher orders are not sent.
        FmuError for an FMU that does not interpolate its inputs, or not to this order.
        """
        if not self.interface.interpolates:
            raise FmuError(f"{self.interface.name}: this FMU does not interpolate its inputs; hold them over each step instead")
        rates = np.atleast_2d(rates)
        sent = rates != 0
        sent[0] = True
        rows, columns = np.nonzero(sent)
        values = rates[sent]
        references = (c_uint * len(values))(*(block.references[int(column)] for column in columns))
        orders = (c_int * len(values))(*(int(row) + 1 for row in rows))
        self._set_rates(references, c_size_t(len(values)), orders, values.ctypes.data_as(POINTER(c_double)))

    def set_start_values(self, values: Mapping[str, Any]) -> None:
        """Sets variables by name; numbers, or names where the values have names."""
        for name, value in values.items():
            variable = self.variable(name)
            Block(self, [variable]).set([number_of(variable, value)])

    # ---- life ----

    def set_up(self, *, start_time: float = 0.0, stop_time: float | None = None, tolerance: float | None = None) -> None:
        """fmi2SetupExperiment and fmi2EnterInitializationMode. tolerance: relative to the box's largest side."""
        tolerance_defined, stop_time_defined = c_int(tolerance is not None), c_int(stop_time is not None)
        self._calls["fmi2SetupExperiment"](
            tolerance_defined, c_double(tolerance or 0.0), c_double(start_time), stop_time_defined, c_double(stop_time or 0.0)
        )
        self._calls["fmi2EnterInitializationMode"]()

    def initialize(self, start_values: Mapping[str, Any], *, start_time: float = 0.0) -> None:
        """From instantiated to ready for a step, with start values (by name) set before."""
        self.set_start_values(start_values)
        self.set_up(start_time=start_time)

    def exit_initialization(self) -> None:
        """fmi2ExitInitializationMode."""
        self._calls["fmi2ExitInitializationMode"]()

    def do_step(self, time: float, step: float) -> None:
        """One communication step [s]."""
        self._do_step(c_double(time), c_double(step), c_int(1))

    def reset(self) -> None:
        """fmi2Reset: as right after opening."""
        self._calls["fmi2Reset"]()

    def warnings(self) -> list[str]:
        """What the component warned of so far."""
        return [message.text for message in self.messages if message.status >= WARNING]

    # ---- states ----

    def get_state(self) -> int:
        """A handle of the FMU's state of this moment; `free_state` or closing the component frees it."""
        if not self.interface.saves:
            raise FmuError(f"{self.interface.name}: this FMU cannot save and restore its state")
        state = c_void_p()
        self._calls["fmi2GetFMUstate"](byref(state))
        return self._kept(state)

    def _kept(self, state: c_void_p) -> int:
        assert state.value is not None
        self._states.add(state.value)
        return state.value

    def set_state(self, handle: int) -> None:
        """Back to the moment of a state of this component."""
        if handle not in self._states:
            raise FmuError("the state was freed, or belongs to another component")
        self._calls["fmi2SetFMUstate"](c_void_p(handle))

    def free_state(self, handle: int) -> None:
        """Frees a state; one that is freed already is passed over."""
        if handle in self._states:
            self._states.remove(handle)
            self._calls["fmi2FreeFMUstate"](byref(c_void_p(handle)))

    def state_bytes(self, handle: int) -> bytes:
        """A state as bytes that any component of the same scene takes, in another process too."""
        if not self.interface.serializes:
            raise FmuError(f"{self.interface.name}: this FMU cannot turn its states into bytes")
        if handle not in self._states:
            raise FmuError("the state was freed, or belongs to another component")
        size = c_size_t()
        self._calls["fmi2SerializedFMUstateSize"](c_void_p(handle), byref(size))
        data = (c_char * size.value)()
        self._calls["fmi2SerializeFMUstate"](c_void_p(handle), data, size)
        return data.raw

    def state_from(self, data: bytes) -> int:
        """The handle of a state from its bytes; FmuError for bytes that are damaged or of another scene."""
        if not self.interface.serializes:
            raise FmuError(f"{self.interface.name}: this FMU cannot make states from bytes")
        state = c_void_p()
        buffer = create_string_buffer(data, len(data))
        self._calls["fmi2DeSerializeFMUstate"](buffer, c_size_t(len(data)), byref(state))
        return self._kept(state)

    # ---- end ----

    def close(self) -> None:
        """Frees the states, the instance and the unpacked files. A closed component answers every call with FmuError."""
        if self._slave is not None:
            for handle in list(self._states):
                self.free_state(handle)
            self._end()
            self._slave = None
            self._answer_with(_closed)
        self._unpacked.cleanup()

    def _answer_with(self, call: Callable[..., None]) -> None:
        self._calls = dict.fromkeys(CALLS, call)
        self._keep_loop_calls()

    def __enter__(self) -> Component:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()


def _freed(slave: Any, states: set[int], _callbacks: Any) -> None:
    """Frees states and instance. _callbacks: are kept for the library until then."""
    while states:
        slave.dll.fmi2FreeFMUstate(c_void_p(slave.component), byref(c_void_p(states.pop())))
    slave.freeInstance()


def _bound(function: Callable[..., int], instance: c_void_p, check: Callable[[int], None]) -> Callable[..., None]:
    return lambda *arguments: check(function(instance, *arguments))


def _closed(*_arguments: object) -> None:
    raise FmuError("the component is closed")


def _failed(*_arguments: object) -> None:
    raise FmuError("the component has failed for good in an earlier call: open it again")


_ABANDONED: list[tuple[Any, ...]] = []
"""Instances after fmi2Fatal, with the callbacks that their libraries may still call"""
