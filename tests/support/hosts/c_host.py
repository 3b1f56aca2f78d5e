"""A host in Python on the C functions of the standard themselves, without an importer between: careless, but lawful."""

from ctypes import CDLL, CFUNCTYPE, Structure, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p, create_string_buffer
from pathlib import Path

import fmpy

from signatures import SIGNATURES
from softffd import Scene, package_fmu

OK, WARNING, DISCARD, ERROR = range(4)
STEP, STEPS = 0.01, 25
TIMES = [n * STEP for n in range(STEPS + 1)]

Logger = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
Allocate, Free = CFUNCTYPE(c_void_p, c_size_t, c_size_t), CFUNCTYPE(None, c_void_p)


class Callbacks(Structure):
    _fields_ = [("logger", Logger), ("allocate", Allocate), ("free", Free), ("finished", c_void_p), ("environment", c_void_p)]


class Fmu:
    """An unpacked FMU: its library, guid, resources and value references by name."""

    standard, signatures, platform = "fmi2", SIGNATURES, fmpy.platform
    instantiation = ("Instantiate", [c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int])
    interpolates = True
    """Whether inputs take derivatives"""

    def __init__(self, scene: Scene, folder: Path, library: CDLL | None = None):
        folder.mkdir()
        self.package = package_fmu(scene, folder / "box.fmu", fmi=int(self.standard[-1]))
        self.unpacked = folder / "fmu"
        fmpy.extract(str(self.package), unzipdir=str(self.unpacked))
        self.description = fmpy.read_model_description(str(self.package), validate=False)
        self.path = str(next(self.unpacked.glob(f"binaries/{self.platform}/softffd.*")))
        self.library = library or self.opened(self.path)
        self.guid = self.description.guid.encode()
        self.categories = {category.name.encode() for category in self.description.logCategories}
        self.find_variables(scene)

    @classmethod
    def opened(cls, path: str) -> CDLL:
        """The FMU's library with the signatures of the standard's header."""
        library, (instantiate, arguments) = CDLL(path), cls.instantiation
        others = {name: [c_void_p, *kinds] for name, kinds in cls.signatures.items()}
        for name, kinds in (others | {instantiate: arguments, "FreeInstance": [c_void_p]}).items():
            getattr(library, cls.standard + name).argtypes = kinds
        getattr(library, cls.standard + instantiate).restype = c_void_p
        getattr(library, f"{cls.standard}FreeInstance").restype = None
        return library

    def find_variables(self, scene: Scene) -> None:
        described = self.description.modelVariables
        self.uri = (self.unpacked / "resources").as_uri().encode()
        self.names = {v.name: v.valueReference for v in described}
        outputs = [v for v in described if v.causality == "output"]
        self.reals = [v.valueReference for v in outputs if v.type == "Real"]
        self.integers = [v.valueReference for v in outputs if v.type == "Integer"]
        self.parameters = [v.valueReference for v in described if v.causality != "output" and v.type == "Real"]

    def host(self, **options) -> "Host":
        return Host(self, **options)

    def spelled(self, function: str) -> str:
        """A function's name in this standard."""
        return function


def doubles(values):
    return (c_double * len(values))(*values)


def uints(values):
    return (c_uint * len(values))(*values)


def ints(values):
    return (c_int * len(values))(*values)


class Host:
    """One instance as a careless but lawful host holds it; keeps every message."""

    def __init__(self, fmu: Fmu, *, logging: bool = False, name: bytes = b"host", logger: bool = True, **given):
        self.fmu, self.messages = fmu, []
        self._logger = Logger(self._note) if logger else Logger()
        arguments = {"type": 1, "guid": fmu.guid, "uri": fmu.uri} | given
        strings = [create_string_buffer(text) if text is not None else None for text in (name, arguments["guid"], arguments["uri"])]
        callbacks = Callbacks(self._logger, Allocate(), Free(), None, 4711)
        self.component = fmu.library.fmi2Instantiate(strings[0], arguments["type"], strings[1], strings[2], byref(callbacks), 0, logging)
        for memory in (*strings, callbacks):  # valid during the call only
            if memory is not None:
                bytes_of(memory)[:] = b"\xee" * len(bytes_of(memory))

    def _note(self, environment, instance, status, category, message) -> None:
        self.messages.append((environment, instance, status, category, message))

    def __call__(self, function: str, *arguments) -> int:
        return getattr(self.fmu.library, self.fmu.standard + function)(self.component, *arguments)

    def must(self, function: str, *arguments) -> None:
        status = self(function, *arguments)
        assert status == OK, (function, status, self.messages[-1:])

    def enter(self, start: float = 0.0, stop: float | None = None, tolerance: float | None = None) -> int:
        """Sets the run up and enters initialization mode."""
        status = self("SetupExperiment", tolerance is not None, tolerance or 0.0, start, stop is not None, stop or 0.0)
        return status or self("EnterInitializationMode")

    def begin(self, initialize=lambda host: None, **given) -> None:
        assert self.enter(**given) == OK, self.messages[-1:]
        initialize(self)
        self.must("ExitInitializationMode")

    def set(self, values: dict[str, float]) -> int:
        return self("SetReal", uints([self.fmu.names[name] for name in values]), len(values), doubles(list(values.values())))

    put_by_name = set
    """Whatever the names are"""

    def set_integer(self, name: str, value: int) -> int:
        return self("SetInteger", uints([self.fmu.names[name]]), 1, ints([value]))

    def set_rates(self, rates: dict[str, float]) -> None:
        references = uints([self.fmu.names[name] for name in rates])
        self.must("SetRealInputDerivatives", references, len(rates), ints([1] * len(rates)), doubles(list(rates.values())))

    def reached(self) -> float:
        """The last time that a step led to."""
        time = c_double()
        self.must("GetRealStatus", 2, byref(time))
        return time.value

    def reals(self, references) -> bytes:
        values = (c_double * len(references))()
        self.must("GetReal", uints(references), len(references), values)
        return bytes(values)

    def settings(self) -> bytes:
        """All inputs and parameters that are Reals, bit by bit."""
        return self.reals(self.fmu.parameters)

    def outputs(self) -> bytes:
        """All outputs, bit by bit."""
        counts = (c_int * len(self.fmu.integers))()
        self.must("GetInteger", uints(self.fmu.integers), len(self.fmu.integers), counts)
        return self.reals(self.fmu.reals) + bytes(counts)

    def slopes(self) -> bytes:
        """First derivatives of all Real outputs, bit by bit."""
        references, count = self.fmu.reals, len(self.fmu.reals)
        values = (c_double * count)()
        self.must("GetRealOutputDerivatives", uints(references), count, ints([1] * count), values)
        return bytes(values)

    def ask_slope(self, name: str, order: int = 1) -> int:
        return self("GetRealOutputDerivatives", uints([self.fmu.names[name]]), 1, ints([order]), doubles([0.0]))

    def step(self, n: int) -> int:
        return self("DoStep", n * STEP, STEP, 1)

    def save(self) -> c_void_p:
        state = c_void_p()
        self.must("GetFMUstate", byref(state))
        return state

    def serialized(self, state: c_void_p) -> bytes:
        size = c_size_t()
        self.must("SerializedFMUstateSize", state, byref(size))
        buffer = create_string_buffer(size.value)
        self.must("SerializeFMUstate", state, buffer, size)
        return buffer.raw

    def received(self, blob: bytes) -> c_void_p:
        state = c_void_p()
        self.must("DeSerializeFMUstate", blob, len(blob), byref(state))
        return state

    def forget(self, state: c_void_p) -> None:
        self.must("FreeFMUstate", byref(state))
        assert not state.value

    def free(self) -> None:
        getattr(self.fmu.library, f"{self.fmu.standard}FreeInstance")(self.component)
        self.component = None


def bytes_of(memory):
    return memoryview(memory).cast("B")


def check_message(host: Host, wanted: str) -> None:
    """Exactly one, by the contract."""
    assert len(host.messages) == 1, host.messages
    environment, instance, status, category, message = host.messages.pop()
    text = message.decode("utf-8")
    assert (environment, instance, status, category) == (4711, b"host", ERROR, b"logStatusError")
    assert category in host.fmu.categories
    assert wanted in text
    assert text == text.strip() and "%" not in text.replace("%%", "") and "#" not in text.replace("##", "")
