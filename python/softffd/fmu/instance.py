"""An instance of an FMU's library, which fmpy loads: its functions, its saved states, its messages, and how it is freed."""

import hashlib
import weakref
from collections.abc import Callable
from contextlib import chdir
from ctypes import byref, c_char, c_double, c_int, c_size_t, c_void_p, cast, create_string_buffer
from pathlib import Path
from typing import Any, NamedTuple, Self

from softffd.errors import FmuError
from softffd.fmu.archive import of_another_machine
from softffd.fmu.interface import Interface
from softffd.fmu.interrupts import Undisturbed

WARNING, DISCARD, FATAL = 1, 2, 4
RATES = "fmi2SetRealInputDerivatives"
CALLS = (
    *("fmi2SetupExperiment", "fmi2EnterInitializationMode", "fmi2ExitInitializationMode", "fmi2Reset", "fmi2DoStep"),
    *("fmi2SetReal", "fmi2GetReal", "fmi2SetInteger", "fmi2GetInteger", RATES),
    *("fmi2SetBoolean", "fmi2GetBoolean", "fmi2SetString", "fmi2GetString"),
    *("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2FreeFMUstate"),
    *("fmi2SerializedFMUstateSize", "fmi2SerializeFMUstate", "fmi2DeSerializeFMUstate"),
)


class Message(NamedTuple):
    """A message of a component; its str is its text."""

    status: int
    """fmi2Status: 0 ok, 1 warning, 2 discard, 3 error, 4 fatal"""
    category: str
    """Log category: "solver", "logStatusWarning", "logStatusError\""""
    text: str

    def __str__(self) -> str:
        return self.text


class Instance:
    """One instance. Every failing call raises FmuError with the instance's own message. An unclosed instance is freed with its last
    reference."""

    def __init__(self) -> None:
        self.messages: list[Message] = []  # messages since the instance was opened; may be cleared
        self.listener: Callable[[Message], object] | None = None  # called with every message
        self._raised: BaseException | None = None  # what the listener raised in the present call of the library
        self._undisturbed = False
        self.calls = dict.fromkeys(CALLS, _refused("there is no instance to call"))
        """The functions of the standard, bound to the instance; a function that the FMU does not have raises FmuError"""
        self._states: set[int] = set()
        self._slave: Any = None

    def _instantiate(self, interface: Interface, folder: str, library: str | None, file: str) -> None:
        """Loads and instantiates. folder: of the unpacked FMU. library: its path, if not where FMI 2.0 puts it. file: the FMU's name in
        messages."""
        from fmpy.fmi2 import FMU2Slave  # takes a sixth of a second, which is saved if nothing is run

        self._callbacks = self._make_callbacks()
        try:
            with chdir(Path.cwd()):  # fmpy changes the folder, and changes back only if it could load the library
                slave = FMU2Slave(
                    guid=interface.guid, unzipDirectory=folder, modelIdentifier=interface.identifier, instanceName=interface.name,
                    libraryPath=library,
                )  # fmt: skip
        except Exception as error:
            why = of_another_machine(file, Path(folder), interface.identifier) or error
            raise FmuError(f"{file}: cannot be opened as an FMU: {why}") from error
        try:
            slave.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:
            slave.freeLibrary()
            raise FmuError(f"{file}: {self._last_message() or error}") from error
        self._slave, self._library = slave, slave.dll
        self._end = weakref.finalize(self, _freed, slave, self._states, self._callbacks)
        self._end.atexit = False  # at the end of the process the system frees everything
        instance = c_void_p(slave.component)
        self.calls.update({name: _bound(getattr(slave.dll, name), instance, self.check) for name in CALLS})
        self.calls.update({name: _refused(f"{interface.name}: this FMU {why}") for name, why in _missing(interface).items()})

    def _make_callbacks(self) -> Any:
        from fmpy import calloc, fmi2, free

        callbacks = fmi2.fmi2CallbackFunctions()
        me = weakref.ref(self)  # the library may send its last messages after this object is gone

        def note(_environment: Any, _instance: Any, status: int, category: bytes | None, text: bytes) -> None:
            if (instance := me()) is None:
                return
            words = text.decode("utf-8", "replace").replace("%%", "%").replace("##", "#")
            instance.messages.append(message := Message(status, (category or b"").decode("utf-8", "replace"), words))
            if instance.listener and not instance._raised:
                try:
                    instance.listener(message)
                except BaseException as error:  # raised through the library it would be lost
                    instance._raised = error

        callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(note)
        callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(free)
        return callbacks

    def _last_message(self) -> str:
        return self.messages[-1].text if self.messages else ""

    @property
    def instance(self) -> int:
        """The fmi2Component."""
        return int(self._slave.component)

    def library_hash(self) -> str:
        """SHA-256 of the component's library."""
        return hashlib.sha256(Path(self._library._name).read_bytes()).hexdigest()

    def address(self, call: str) -> int | None:
        """Returns the address of a function of the component's library."""
        return cast(getattr(self._library, call), c_void_p).value

    def check(self, status: int) -> None:
        """Raises FmuError with the component's last message if the fmi2Status of a call says that the call discarded or failed, and
        what the listener has raised in the call."""
        if status == FATAL:
            self._abandon()
        if not self._undisturbed:
            self._raise()
        if status >= DISCARD:
            word = "discarded the step" if status == DISCARD else "reported an error"
            raise FmuError(f"the component {word}: {self._last_message() or 'no message'}")

    def undisturbed(self) -> Undisturbed:
        """A block of calls that take long, and of what the host notes of them: Ctrl-C and what the listener raises wait until its end."""
        self._undisturbed = True
        return Undisturbed(self._raise)

    def _raise(self) -> None:
        """Raises what the listener has raised; then calls are disturbed again."""
        self._undisturbed, error, self._raised = False, self._raised, None
        if error is not None:
            raise error

    def _abandon(self) -> None:
        """Keeps the instance unfreed: after fmi2Fatal no call is allowed, not even to free it (FMI 2.0.4, section 2.1.3); pythonfmu would
        free twice."""
        self._end.detach()
        _ABANDONED.append((self._slave, self._callbacks))
        self._slave = None
        self._states.clear()
        self._answer_with("the component has failed for good in an earlier call: open it again")

    def set_up(self, *, start_time: float = 0.0, stop_time: float | None = None, tolerance: float | None = None) -> None:
        """Calls fmi2SetupExperiment and fmi2EnterInitializationMode. tolerance: relative to the box's largest side."""
        tolerance_defined, stop_time_defined = c_int(tolerance is not None), c_int(stop_time is not None)
        self.calls["fmi2SetupExperiment"](
            tolerance_defined, c_double(tolerance or 0.0), c_double(start_time), stop_time_defined, c_double(stop_time or 0.0)
        )
        self.calls["fmi2EnterInitializationMode"]()

    def exit_initialization(self) -> None:
        """Calls fmi2ExitInitializationMode."""
        self.calls["fmi2ExitInitializationMode"]()

    def do_step(self, time: float, step: float) -> None:
        """Makes one communication step from `time` to `time` + `step` [s]."""
        self.calls["fmi2DoStep"](c_double(time), c_double(step), c_int(1))

    def reset(self) -> None:
        """Calls fmi2Reset, after which the instance is as right after opening."""
        self.calls["fmi2Reset"]()

    def warnings(self) -> list[str]:
        """Returns the texts of all messages so far that are warnings or errors."""
        return [message.text for message in self.messages if message.status >= WARNING]

    # ---- states ----

    def get_state(self) -> int:
        """Returns a handle of a snapshot of the FMU's present state; `free_state`, or closing the component, frees the snapshot."""
        state = c_void_p()
        self.calls["fmi2GetFMUstate"](byref(state))
        return self._kept(state)

    def _kept(self, state: c_void_p) -> int:
        assert state.value is not None
        self._states.add(state.value)
        return state.value

    def set_state(self, handle: int) -> None:
        """Restores a state of this component. Raises FmuError if the state was freed or belongs to another component."""
        if handle not in self._states:
            raise FmuError("the state was freed, or belongs to another component")
        self.calls["fmi2SetFMUstate"](c_void_p(handle))

    def free_state(self, handle: int) -> None:
        """Frees a state; a state that is already freed is ignored."""
        if handle in self._states:
            self._states.remove(handle)
            self.calls["fmi2FreeFMUstate"](byref(c_void_p(handle)))

    def state_bytes(self, handle: int) -> bytes:
        """Returns a state as bytes that any component of the same scene accepts, in another process too."""
        if handle not in self._states:
            raise FmuError("the state was freed, or belongs to another component")
        size = c_size_t()
        self.calls["fmi2SerializedFMUstateSize"](c_void_p(handle), byref(size))
        data = (c_char * size.value)()
        self.calls["fmi2SerializeFMUstate"](c_void_p(handle), data, size)
        return data.raw

    def state_from(self, data: bytes) -> int:
        """Returns the handle of a state made from its bytes. Raises FmuError for bytes that are damaged or of another scene."""
        state = c_void_p()
        buffer = create_string_buffer(data, len(data))
        self.calls["fmi2DeSerializeFMUstate"](buffer, c_size_t(len(data)), byref(state))
        return self._kept(state)

    # ---- end ----

    def close(self) -> None:
        """Frees the states, the instance and the unpacked files. A closed component answers every call with FmuError."""
        if self._slave is not None:
            for handle in list(self._states):
                self.free_state(handle)
            self._end()
            self._slave = None
            self._answer_with("the component is closed")

    def _answer_with(self, words: str) -> None:
        self.calls.update(dict.fromkeys(CALLS, _refused(words)))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()


def _freed(slave: Any, states: set[int], _callbacks: Any) -> None:
    """Frees the states and the instance. _callbacks: kept alive for the library until then."""
    while states:
        slave.dll.fmi2FreeFMUstate(c_void_p(slave.component), byref(c_void_p(states.pop())))
    slave.freeInstance()


def _bound(function: Callable[..., int], instance: c_void_p, check: Callable[[int], None]) -> Callable[..., None]:
    return lambda *arguments: check(function(instance, *arguments))


def _refused(words: str) -> Callable[..., None]:
    def refuse(*_arguments: object) -> None:
        raise FmuError(words)

    return refuse


def _missing(interface: Interface) -> dict[str, str]:
    """Returns the functions that an FMU does not have according to its description, with the words of the error for each."""
    return {
        **({} if interface.interpolates else {RATES: "does not interpolate its inputs; hold them over each step instead"}),
        **({} if interface.saves else {"fmi2GetFMUstate": "cannot save and restore its state"}),
        **({} if interface.serializes else {CALLS[-3]: "cannot turn its states into bytes", CALLS[-1]: "cannot make states from bytes"}),
    }


_ABANDONED: list[tuple[Any, ...]] = []  # instances after fmi2Fatal, with the callbacks that their libraries may still call
