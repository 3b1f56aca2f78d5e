"""Random sequences of calls of the C functions: legal ones keep a straight run, illegal ones are named."""

import os
import random
import re
import struct
import subprocess
import sys
from ctypes import (
    CDLL,
    CFUNCTYPE,
    POINTER,
    Structure,
    byref,
    c_char_p,
    c_double,
    c_int,
    c_size_t,
    c_uint,
    c_void_p,
    create_string_buffer,
)
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import pytest

from softffd import load_scene, package_fmu

OK, WARNING, DISCARD, ERROR = range(4)
STEP, STEPS = 0.01, 25
TIMES = [n * STEP for n in range(STEPS + 1)]
LINUX = sys.platform == "linux"

RICH = """
[lattice]
points = [3, 3, 3]
[material]
stiffness = 2e3
damping = 0.05
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
normal = [0.0, 0.1, 1.0]
friction = 0.4
motion = "input"
[[plane]]
name = "wall"
point = [1.3, 0.0, 0.0]
normal = [-1.0, 0.0, 0.0]
[[pin]]
name = "grip"
points = [[0, 0, 2]]
motion = "input"
[[load]]
name = "push"
points = "x+"
[inputs]
forces = [[1, 1, 1]]
[initial]
offset = [0.0, 0.0, 0.1]
velocity = [1.0, 0.0, 0.0]
[[probe]]
name = "tip"
at = [0.5, 0.5, 1.0]
[outputs]
velocities = "all"
energy = true
solver = true
"""
BARE = """
[lattice]
points = [2, 2, 2]
[material]
damping = 0.0
[initial]
stretch = [1.1, 1.0, 0.9]
[solver]
method = "central_difference"
"""

Logger = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
Allocate, Free = CFUNCTYPE(c_void_p, c_size_t, c_size_t), CFUNCTYPE(None, c_void_p)


class Callbacks(Structure):
    _fields_ = [
        ("logger", Logger),
        ("allocate", Allocate),
        ("free", Free),
        ("finished", c_void_p),
        ("environment", c_void_p),
    ]


REFERENCES, REALS, INTEGERS = POINTER(c_uint), POINTER(c_double), POINTER(c_int)
SIGNATURES = {
    "SetDebugLogging": [c_int, c_size_t, POINTER(c_char_p)],
    "SetupExperiment": [c_int, c_double, c_double, c_int, c_double],
    "EnterInitializationMode": [],
    "ExitInitializationMode": [],
    "Terminate": [],
    "Reset": [],
    "CancelStep": [],
    "GetReal": [REFERENCES, c_size_t, REALS],
    "SetReal": [REFERENCES, c_size_t, REALS],
    "GetInteger": [REFERENCES, c_size_t, INTEGERS],
    "SetInteger": [REFERENCES, c_size_t, INTEGERS],
    "GetBoolean": [REFERENCES, c_size_t, INTEGERS],
    "SetBoolean": [REFERENCES, c_size_t, INTEGERS],
    "GetString": [REFERENCES, c_size_t, POINTER(c_char_p)],
    "SetString": [REFERENCES, c_size_t, POINTER(c_char_p)],
    "DoStep": [c_double, c_double, c_int],
    "GetStatus": [c_int, INTEGERS],
    "GetRealStatus": [c_int, REALS],
    "GetIntegerStatus": [c_int, INTEGERS],
    "GetBooleanStatus": [c_int, INTEGERS],
    "GetStringStatus": [c_int, POINTER(c_char_p)],
    "GetFMUstate": [POINTER(c_void_p)],
    "SetFMUstate": [c_void_p],
    "FreeFMUstate": [POINTER(c_void_p)],
    "SerializedFMUstateSize": [c_void_p, POINTER(c_size_t)],
    "SerializeFMUstate": [c_void_p, c_char_p, c_size_t],
    "DeSerializeFMUstate": [c_char_p, c_size_t, POINTER(c_void_p)],
    "GetDirectionalDerivative": [REFERENCES, c_size_t, REFERENCES, c_size_t, REALS, REALS],
    "SetRealInputDerivatives": [REFERENCES, c_size_t, INTEGERS, REALS],
    "GetRealOutputDerivatives": [REFERENCES, c_size_t, INTEGERS, REALS],
}


def opened(path: str) -> CDLL:
    """The FMU's library with the signatures of the standard's header."""
    library = CDLL(path)
    for name, arguments in SIGNATURES.items():
        getattr(library, f"fmi2{name}").argtypes = [c_void_p, *arguments]
    library.fmi2Instantiate.argtypes = [c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int]
    library.fmi2Instantiate.restype = c_void_p
    library.fmi2FreeInstance.argtypes = [c_void_p]
    library.fmi2FreeInstance.restype = None
    return library


class Fmu:
    """An unpacked FMU: its library, guid, resources and value references by name."""

    def __init__(self, text: str, folder: Path, library: CDLL | None = None):
        folder.mkdir()
        (folder / "box.toml").write_text(text)
        package = package_fmu(load_scene(folder / "box.toml"), folder / "box.fmu")
        unpacked = folder / "fmu"
        fmpy.extract(str(package), unzipdir=str(unpacked))
        description = fmpy.read_model_description(str(package), validate=False)
        self.path = str(next(unpacked.glob(f"binaries/{fmpy.platform}/softffd.*")))
        self.library = library or opened(self.path)
        self.guid, self.uri = description.guid.encode(), (unpacked / "resources").as_uri().encode()
        self.names = {v.name: v.valueReference for v in description.modelVariables}
        self.categories = {category.name.encode() for category in description.logCategories}
        outputs = [v for v in description.modelVariables if v.causality == "output"]
        self.reals = [v.valueReference for v in outputs if v.type == "Real"]
        self.integers = [v.valueReference for v in outputs if v.type == "Integer"]
        self.parameters = [
            v.valueReference
            for v in description.modelVariables
            if v.causality != "output" and v.type == "Real"
        ]


@pytest.fixture(scope="module")
def fmus(tmp_path_factory) -> list[Fmu]:
    folder = tmp_path_factory.mktemp("sequences")
    rich = Fmu(RICH, folder / "rich")
    return [rich, Fmu(BARE, folder / "bare", rich.library)]


@pytest.fixture(scope="module")
def rich(fmus) -> Fmu:
    return fmus[0]


def doubles(values):
    return (c_double * len(values))(*values)


def uints(values):
    return (c_uint * len(values))(*values)


def ints(values):
    return (c_int * len(values))(*values)


class Host:
    """One instance as a careless but lawful host holds it; keeps every message."""

    def __init__(
        self, fmu: Fmu, *, logging: bool = False, name: bytes = b"host", logger: bool = True, **given
    ):
        self.fmu, self.messages = fmu, []
        self._logger = Logger(self._note) if logger else Logger()
        arguments = {"type": 1, "guid": fmu.guid, "uri": fmu.uri} | given
        strings = [
            create_string_buffer(text) if text is not None else None
            for text in (name, arguments["guid"], arguments["uri"])
        ]
        callbacks = Callbacks(self._logger, Allocate(), Free(), None, 4711)
        self.component = fmu.library.fmi2Instantiate(
            strings[0], arguments["type"], strings[1], strings[2], byref(callbacks), 0, logging
        )
        for memory in (*strings, callbacks):  # valid during the call only
            if memory is not None:
                bytes_of(memory)[:] = b"\xee" * len(bytes_of(memory))

    def _note(self, environment, instance, status, category, message) -> None:
        self.messages.append((environment, instance, status, category, message))

    def __call__(self, function: str, *arguments) -> int:
        return getattr(self.fmu.library, f"fmi2{function}")(self.component, *arguments)

    def must(self, function: str, *arguments) -> None:
        status = self(function, *arguments)
        assert status == OK, (function, status, self.messages[-1:])

    def begin(self, initialize=lambda host: None) -> None:
        self.must("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        self.must("EnterInitializationMode")
        initialize(self)
        self.must("ExitInitializationMode")

    def set(self, values: dict[str, float]) -> int:
        return self(
            "SetReal",
            uints([self.fmu.names[name] for name in values]),
            len(values),
            doubles(list(values.values())),
        )

    def reals(self, references) -> bytes:
        values = (c_double * len(references))()
        self.must("GetReal", uints(references), len(references), values)
        return bytes(values)

    def outputs(self) -> bytes:
        """All outputs, bit by bit."""
        counts = (c_int * len(self.fmu.integers))()
        self.must("GetInteger", uints(self.fmu.integers), len(self.fmu.integers), counts)
        return self.reals(self.fmu.reals) + bytes(counts)

    def step(self, n: int) -> int:
        return self("DoStep", TIMES[n], STEP, 1)

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
        self.fmu.library.fmi2FreeInstance(self.component)
        self.component = None


def bytes_of(memory):
    return memoryview(memory).cast("B")


# ---- legal sequences ----


@cache
def schedule(fmu: Fmu, n: int) -> list[dict[str, float]]:
    """What step n is taken with; each part is one call. Depends on n alone: any route to n is the same.
    Kept, because under another rounding mode the test's own arithmetic gives other numbers."""
    if "load.push.x" not in fmu.names:
        return [{"stiffness.edge": 1000.0 + n}] if n % 7 == 3 else []
    parts = [
        {"load.push.y": 3.0 * (n % 5), "load.push.z": -0.5 * n},
        {"pin.grip.velocity.x": 0.2 + 0.01 * n, "force[1,1,1].z": 0.1 * n},
        {"plane.ground.point.z": 0.001 * n, "plane.ground.velocity.z": 0.1},
    ]
    return parts + (
        [{"stiffness.face": 2000.0 + n, "gravity.z": -9.0 - 0.1 * n}, {"damping": 0.01 * n}]
        if n % 6 == 5
        else []
    )


def apply(host: Host, n: int, generator: random.Random | None = None) -> None:
    parts = list(schedule(host.fmu, n))
    if generator:
        generator.shuffle(parts)
    for values in parts:
        assert host.set(values) == OK
    if "load.push.x" in host.fmu.names and n % 3 == 1:
        names = ["load.push.x", "plane.ground.velocity.z"]
        rates = [10.0 * n, -0.5]
        host.must(
            "SetRealInputDerivatives",
            uints([host.fmu.names[name] for name in names]),
            2,
            ints([1, 1]),
            doubles(rates),
        )


def straight(fmu: Fmu, steps: int = STEPS) -> list[bytes]:
    """Outputs at every communication point of an undisturbed run."""
    host = Host(fmu)
    host.begin()
    points = [host.outputs()]
    for n in range(steps):
        apply(host, n)
        host.must("DoStep", TIMES[n], STEP, 1)
        points.append(host.outputs())
    host.free()
    return points


class Walker:
    """An instance that takes detours; `at` is its place on the straight run."""

    def __init__(self, fmu: Fmu, generator: random.Random):
        self.fmu, self.random = fmu, generator
        self.states: list[tuple[c_void_p, int]] = []  # with their places
        self.renew()

    def renew(self) -> None:
        self.host, self.at = Host(self.fmu, logging=self.random.random() < 0.5), 0
        self.host.begin()

    def advance(self) -> None:
        if self.at < STEPS:
            if "load.push.x" in self.fmu.names:
                self.host.set(
                    {"load.push.y": 99.0, "plane.ground.point.z": -7.0}
                )  # taken back before the step
            apply(self.host, self.at, self.random)
            self.host.must("DoStep", TIMES[self.at], STEP, self.random.randrange(2))
            self.at += 1

    def restart(self) -> None:
        if self.random.random() < 0.5:
            self.host.must("Terminate")
        self.host.must("Reset")
        self.host.begin()
        self.at = 0

    def replace(self) -> None:
        """Another instance; what states it still held go with the old one."""
        self.host.free()
        self.states.clear()
        self.renew()

    def save(self) -> None:
        self.states.append((self.host.save(), self.at))

    def drop(self) -> None:
        if self.states:
            self.host.forget(self.states.pop(self.random.randrange(len(self.states)))[0])

    def overwrite(self) -> None:
        """Saves into a state that is there already."""
        if self.states:
            place = self.random.randrange(len(self.states))
            state = self.states[place][0]
            self.host.must("GetFMUstate", byref(state))
            self.states[place] = state, self.at

    def take(self, other: "Walker") -> None:
        """Another instance's state, as bytes."""
        if other.states and other.fmu is self.fmu:
            state, at = self.random.choice(other.states)
            self.states.append((self.host.received(other.host.serialized(state)), at))

    def look(self) -> None:
        self.host.outputs()
        self.host.reals(self.fmu.parameters)

    def discard(self) -> None:
        """A step that is too long for its stiffness, then back."""
        state = self.host.save()
        assert self.host.set({"stiffness.edge": 1e19}) == OK
        assert self.host("DoStep", TIMES[self.at], 1.0, 1) == DISCARD
        time = c_double()
        self.host.must("GetRealStatus", 2, byref(time))
        assert time.value == pytest.approx(TIMES[self.at], abs=1e-12)
        self.host.must("SetFMUstate", state)
        self.host.forget(state)

    def restore(self) -> None:
        if self.states:
            state, self.at = self.random.choice(self.states)
            self.host.must("SetFMUstate", state)


MOVES = {
    "advance": 60,
    "save": 12,
    "restore": 10,
    "look": 6,
    "discard": 3,
    "restart": 1,
    "replace": 1,
    "drop": 6,
    "take": 6,
    "overwrite": 3,
}


def wander(fmus: list[Fmu], seed: int, moves: int) -> int:
    """Random moves of four instances of two scenes; returns how often the straight run was met."""
    generator = random.Random(seed)
    expected = {id(fmu): straight(fmu) for fmu in fmus}
    walkers = [Walker(fmus[i % 2], generator) for i in range(4)]
    met = 0
    for _ in range(moves):
        walker = generator.choice(walkers)
        move = generator.choices(list(MOVES), MOVES.values())[0]
        getattr(walker, move)(*[generator.choice(walkers)] * (move == "take"))
        assert walker.host.outputs() == expected[id(walker.fmu)][walker.at], (seed, move, walker.at)
        met += move in ("advance", "restore")
    for walker in walkers:
        for state, _ in walker.states:
            walker.host.forget(state)
        walker.host.free()
    return met


@pytest.mark.parametrize("seed", range(4))
def test_thousands_of_random_legal_calls_stay_on_the_straight_run(fmus, seed):
    assert wander(fmus, seed, 1200) > 500


def test_the_straight_run_depends_on_what_the_schedule_sets(fmus):
    for fmu in fmus:
        host = Host(fmu)
        host.begin()
        for n in range(STEPS):
            assert host.step(n) == OK
        assert host.outputs() != straight(fmu)[-1]
        host.free()


# ---- illegal calls ----

NAN, INF = float("nan"), float("inf")
FRESH, INITIALIZING, RUNNING, FAILED, ENDED = "fresh", "initializing", "running", "failed", "ended"


def bring_to(host: Host, phase: str) -> None:
    if phase == FRESH:
        return
    host.must("SetupExperiment", 0, 0.0, 0.0, 1, 10.0)
    host.must("EnterInitializationMode")
    if phase == INITIALIZING:
        return
    host.must("ExitInitializationMode")
    apply(host, 0)
    host.must("DoStep", 0.0, STEP, 1)
    if phase == ENDED:
        host.must("Terminate")
    if phase == FAILED:
        assert host("DoStep", 77.0, STEP, 1) == ERROR
        host.messages.clear()


def number(host: Host, name: str, value: float, function: str = "SetReal", kind=doubles) -> int:
    return host(function, uints([host.fmu.names[name]]), 1, kind([value]))


def mixed(host: Host, bad: str, value: float) -> int:
    """A good value and a bad one in one call."""
    return host.set({"stiffness.edge": 5e3, bad: value})


def rates(host: Host, name: str, order: int, value: float) -> int:
    return host("SetRealInputDerivatives", uints([host.fmu.names[name]]), 1, ints([order]), doubles([value]))


def damaged(host: Host) -> int:
    """A serialized state with one bit turned."""
    state = host.save()
    blob = bytearray(host.serialized(state))
    host.forget(state)
    blob[len(blob) // 2] ^= 1
    return host("DeSerializeFMUstate", bytes(blob), len(blob), byref(c_void_p()))


def too_small(host: Host) -> int:
    state = host.save()
    status = host("SerializeFMUstate", state, create_string_buffer(40), 40)
    host("FreeFMUstate", byref(state))
    return status


ANY = (FRESH, INITIALIZING, RUNNING, ENDED, FAILED)
ALIVE = (INITIALIZING, RUNNING)
SETTABLE = (FRESH, INITIALIZING, RUNNING)
# phases in which the call is illegal; what the message must hold; the call
ILLEGAL = [
    (
        (INITIALIZING, RUNNING, ENDED, FAILED),
        "fmi2SetupExperiment: not allowed",
        lambda h: h("SetupExperiment", 0, 0.0, 0.0, 0, 0.0),
    ),
    (
        (INITIALIZING, RUNNING, ENDED, FAILED),
        "fmi2EnterInitializationMode: not allowed",
        lambda h: h("EnterInitializationMode"),
    ),
    (
        (FRESH, RUNNING, ENDED, FAILED),
        "fmi2ExitInitializationMode: not allowed",
        lambda h: h("ExitInitializationMode"),
    ),
    ((FRESH, INITIALIZING, ENDED, FAILED), "fmi2Terminate: not allowed", lambda h: h("Terminate")),
    ((FRESH, INITIALIZING, ENDED, FAILED), "fmi2DoStep: not allowed", lambda h: h("DoStep", STEP, STEP, 1)),
    ((FRESH,), "fmi2GetReal: not allowed", lambda h: number(h, "mass", 0.0, "GetReal")),
    ((FRESH,), "fmi2GetInteger: not allowed", lambda h: number(h, "solver.method", 0, "GetInteger", ints)),
    ((ENDED, FAILED), "fmi2SetReal: not allowed", lambda h: number(h, "damping", 1.0)),
    (
        (ENDED, FAILED),
        "fmi2SetInteger: not allowed",
        lambda h: number(h, "solver.method", 1, "SetInteger", ints),
    ),
    ((ENDED, FAILED), "fmi2SetRealInputDerivatives: not allowed", lambda h: rates(h, "load.push.x", 1, 1.0)),
    (
        (FRESH, INITIALIZING),
        "fmi2GetRealOutputDerivatives: not allowed",
        lambda h: h("GetRealOutputDerivatives", uints([0]), 1, ints([1]), doubles([0])),
    ),
    (ANY, "fmi2CancelStep: not allowed", lambda h: h("CancelStep")),
    ((FRESH, INITIALIZING), "fmi2GetRealStatus: not allowed", lambda h: h("GetRealStatus", 2, doubles([0]))),
    ((FRESH, INITIALIZING), "fmi2GetStatus: not allowed", lambda h: h("GetStatus", 0, ints([0]))),
    ((RUNNING, ENDED), "fmi2GetRealStatus: got a null", lambda h: h("GetRealStatus", 2, None)),
    ((RUNNING, ENDED), "fmi2GetBooleanStatus: got a null", lambda h: h("GetBooleanStatus", 3, None)),
    (ALIVE, "fmi2GetReal: got a null", lambda h: h("GetReal", None, 1, doubles([0]))),
    (ALIVE, "fmi2GetReal: got a null", lambda h: h("GetReal", uints([25 << 24]), 1, None)),
    (ALIVE, "fmi2GetInteger: got a null", lambda h: h("GetInteger", None, 1, ints([0]))),
    (SETTABLE, "fmi2SetReal: got a null", lambda h: h("SetReal", None, 1, doubles([0]))),
    (SETTABLE, "fmi2SetReal: got a null", lambda h: h("SetReal", uints([25 << 24]), 3, None)),
    (SETTABLE, "fmi2SetInteger: got a null", lambda h: h("SetInteger", uints([31 << 24]), 1, None)),
    (
        SETTABLE,
        "fmi2SetRealInputDerivatives: got a null",
        lambda h: h("SetRealInputDerivatives", uints([2 << 24]), 1, None, doubles([0])),
    ),
    (
        (RUNNING,),
        "fmi2GetRealOutputDerivatives: got a null",
        lambda h: h("GetRealOutputDerivatives", uints([60 << 24]), 1, ints([1]), None),
    ),
    (ANY, "fmi2SetDebugLogging: got a null", lambda h: h("SetDebugLogging", 1, 2, None)),
    (
        ANY,
        "fmi2SetDebugLogging: wanted categories",
        lambda h: h("SetDebugLogging", 1, 1, (c_char_p * 1)(b"logAll")),
    ),
    (
        ANY,
        "fmi2SetDebugLogging: wanted categories",
        lambda h: h("SetDebugLogging", 1, 1, (c_char_p * 1)(None)),
    ),
    (ALIVE, "value reference 0: this scene has no such", lambda h: h("GetReal", uints([0]), 1, doubles([0]))),
    (ALIVE, "value reference 4294967295", lambda h: h("GetReal", uints([4294967295]), 1, doubles([0]))),
    (
        ALIVE,
        "value reference 1006633041",
        lambda h: h("GetReal", uints([60 << 24, (60 << 24) + 81]), 2, doubles([0, 0])),
    ),
    (
        SETTABLE,
        "value reference 16777219",
        lambda h: h("SetReal", uints([2 << 24, (1 << 24) + 3]), 2, doubles([5, 5])),
    ),
    (SETTABLE, "mass: is a Real variable", lambda h: number(h, "mass", 1, "SetInteger", ints)),
    (SETTABLE, "solver.method: is a Enumeration variable", lambda h: number(h, "solver.method", 1.0)),
    (
        ALIVE,
        "plane.ground.contacts: is a Integer variable",
        lambda h: number(h, "plane.ground.contacts", 1.0, "GetReal"),
    ),
    (SETTABLE, "there are no Boolean variables", lambda h: number(h, "mass", 1, "SetBoolean", ints)),
    (
        ALIVE,
        "there are no String variables",
        lambda h: h("GetString", uints([25 << 24]), 1, (c_char_p * 1)()),
    ),
    (SETTABLE, "damping: wanted a finite number, got nan", lambda h: mixed(h, "damping", NAN)),
    (SETTABLE, "load.push.x: wanted a finite number, got inf", lambda h: mixed(h, "load.push.x", INF)),
    (SETTABLE, "gravity.y: wanted a finite number, got -inf", lambda h: mixed(h, "gravity.y", -INF)),
    (SETTABLE, "damping: wanted >= 0 N.s/m, got -1", lambda h: mixed(h, "damping", -1.0)),
    (SETTABLE, "plane.wall.friction: wanted >= 0, got -0.5", lambda h: mixed(h, "plane.wall.friction", -0.5)),
    (SETTABLE, "energy.kinetic: cannot be set", lambda h: mixed(h, "energy.kinetic", 1.0)),
    ((FRESH, INITIALIZING), "mass: wanted > 0 kg, got 0", lambda h: mixed(h, "mass", 0.0)),
    ((RUNNING,), "mass: cannot be set after initialization", lambda h: mixed(h, "mass", 2.0)),
    ((RUNNING,), "plane.wall.point.x: cannot be set", lambda h: mixed(h, "plane.wall.point.x", 2.0)),
    (
        (FRESH, INITIALIZING),
        "solver.method: wanted 1 to",
        lambda h: number(h, "solver.method", 99, "SetInteger", ints),
    ),
    (
        SETTABLE,
        "load.push.x: wanted a derivative of order 1, got 2",
        lambda h: rates(h, "load.push.x", 2, 1.0),
    ),
    (SETTABLE, "load.push.x: wanted a finite derivative", lambda h: rates(h, "load.push.x", 1, NAN)),
    (SETTABLE, "damping: is no input", lambda h: rates(h, "damping", 1, 1.0)),
    (
        (RUNNING,),
        "energy.work: has no output derivative",
        lambda h: h(
            "GetRealOutputDerivatives", uints([h.fmu.names["energy.work"]]), 1, ints([1]), doubles([0])
        ),
    ),
    *[
        ((RUNNING,), "fmi2DoStep: currentCommunicationPoint", lambda h, t=t: h("DoStep", t, STEP, 1))
        for t in (0.0, 0.02, NAN, INF, -INF)
    ],
    *[
        ((RUNNING,), "fmi2DoStep: communicationStepSize", lambda h, s=s: h("DoStep", STEP, s, 1))
        for s in (0.0, -STEP, NAN, INF, -0.0)
    ],
    (
        (RUNNING,),
        "fmi2DoStep: a step to 10.01 s goes past the stop time 10 s",
        lambda h: h("DoStep", STEP, 10.0, 1),
    ),
    *[
        ((FRESH,), "fmi2SetupExperiment: startTime", lambda h, t=t: h("SetupExperiment", 0, 0.0, t, 0, 0.0))
        for t in (NAN, INF)
    ],
    *[
        ((FRESH,), "fmi2SetupExperiment: tolerance", lambda h, t=t: h("SetupExperiment", 1, t, 0.0, 0, 0.0))
        for t in (NAN, -1.0, 0.0, INF)
    ],
    *[
        ((FRESH,), "fmi2SetupExperiment: stopTime", lambda h, t=t: h("SetupExperiment", 0, 0.0, 1.0, 1, t))
        for t in (NAN, 1.0, 0.5, INF)
    ],
    (ANY, "fmi2GetFMUstate: got a null", lambda h: h("GetFMUstate", None)),
    (ANY, "fmi2GetFMUstate: FMUstate: wanted a state", lambda h: h("GetFMUstate", byref(c_void_p(64)))),
    (ANY, "fmi2SetFMUstate: FMUstate: wanted a state", lambda h: h("SetFMUstate", None)),
    (ANY, "fmi2SetFMUstate: FMUstate: wanted a state", lambda h: h("SetFMUstate", h.component)),
    (
        ANY,
        "fmi2FreeFMUstate: FMUstate: wanted a state",
        lambda h: h("FreeFMUstate", byref(c_void_p(h.component))),
    ),
    (
        ANY,
        "fmi2SerializedFMUstateSize: FMUstate: wanted a state",
        lambda h: h("SerializedFMUstateSize", None, byref(c_size_t())),
    ),
    (ANY, "fmi2SerializeFMUstate: FMUstate: wanted a state", lambda h: h("SerializeFMUstate", None, None, 0)),
    (ANY, "fmi2SerializeFMUstate: size: wanted", too_small),
    (
        ANY,
        "fmi2DeSerializeFMUstate: got a null",
        lambda h: h("DeSerializeFMUstate", None, 8, byref(c_void_p())),
    ),
    (ANY, "fmi2DeSerializeFMUstate: got a null", lambda h: h("DeSerializeFMUstate", b"12345678", 8, None)),
    (
        ANY,
        "fmi2DeSerializeFMUstate: the state is too short",
        lambda h: h("DeSerializeFMUstate", b"12345678", 8, byref(c_void_p())),
    ),
    (ANY, "fmi2DeSerializeFMUstate: the state is damaged", damaged),
    (
        ANY,
        "fmi2GetDirectionalDerivative: not available",
        lambda h: h("GetDirectionalDerivative", uints([0]), 1, uints([0]), 1, doubles([0]), doubles([0])),
    ),
]


def check_message(host: Host, wanted: str) -> None:
    """Exactly one, by the contract."""
    assert len(host.messages) == 1, host.messages
    environment, instance, status, category, message = host.messages.pop()
    text = message.decode("utf-8")
    assert (environment, instance, status, category) == (4711, b"host", ERROR, b"logStatusError")
    assert category in host.fmu.categories
    assert wanted in text
    assert text == text.strip() and "%" not in text.replace("%%", "") and "#" not in text.replace("##", "")


def check_as_new(host: Host, expected: list[bytes]) -> None:
    host.must("Reset")
    host.begin()
    assert host.outputs() == expected[0]
    for n in range(3):
        apply(host, n)
        host.must("DoStep", TIMES[n], STEP, 1)
        assert host.outputs() == expected[n + 1]


def test_every_illegal_call_is_an_error_with_one_message_and_changes_nothing(rich):
    expected = straight(rich, 3)
    host = Host(rich, logging=False)
    for phases, wanted, call in ILLEGAL:
        for phase in phases:
            host.must("Reset")
            bring_to(host, phase)
            readable = phase in (RUNNING, ENDED, FAILED)
            before = host.reals(rich.parameters) + host.outputs() if readable else b""
            assert call(host) == ERROR, (phase, wanted)
            check_message(host, wanted)
            assert not readable or host.reals(rich.parameters) + host.outputs() == before, (phase, wanted)
            check_as_new(host, expected)
    host.free()


def test_random_illegal_calls_between_legal_ones_leave_a_reset_as_new(rich):
    generator, expected = random.Random(7), straight(rich, 3)
    host = Host(rich)
    for _ in range(300):
        host.must("Reset")
        phase = generator.choice(ANY)
        bring_to(host, phase)
        for _ in range(generator.randrange(1, 5)):
            fitting = [(wanted, call) for phases, wanted, call in ILLEGAL if phase in phases]
            wanted, call = generator.choice(fitting)
            assert call(host) == ERROR
            check_message(host, wanted)
            if not any(word in wanted for word in ("FMUstate: wanted", "the state is")):
                phase = FAILED
        check_as_new(host, expected)
    host.free()


def test_a_refused_foreign_state_leaves_the_run_as_it_was(rich):
    expected, host = straight(rich), Host(rich)
    host.begin()
    for n in range(STEPS):
        apply(host, n)
        assert host("SetFMUstate", host.component) == ERROR
        assert damaged(host) == ERROR
        host.must("DoStep", TIMES[n], STEP, 1)
        assert host.outputs() == expected[n + 1]
    host.free()


def test_dead_and_foreign_handles_are_errors(rich):
    host = Host(rich)
    dead = host.component
    host.free()
    for handle in (None, dead, 64):
        for name, arguments in SIGNATURES.items():
            blanks = [
                0 if kind in (c_int, c_size_t) else 0.0 if kind is c_double else None for kind in arguments
            ]
            assert getattr(rich.library, f"fmi2{name}")(handle, *blanks) == ERROR, name
        rich.library.fmi2FreeInstance(handle)


def test_getters_answer_in_the_error_state_before_initialization(rich):
    script = """
import sys
sys.path.insert(0, sys.argv[1])
import test_sequences as t
from pathlib import Path
fmu = t.Fmu(t.RICH, Path(sys.argv[2]) / "again")
for reference in fmu.reals:
    host = t.Host(fmu)
    assert host.set({"mass": -1.0}) == t.ERROR
    print(reference, flush=True)
    host.reals([reference])
    host.free()
print("done")
"""
    with TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-c", script, str(Path(__file__).parent), folder], capture_output=True, text=True
        )
    last = done.stdout.splitlines()[-1] if done.stdout else done.stderr[-300:]
    name = next((n for n, r in rich.names.items() if str(r) == last), last)
    assert done.returncode == 0, f"{name}: ended with {done.returncode}"


@pytest.mark.parametrize(
    "values", [{"stiffness.edge": 1e60, "solver.step": STEP}, {"mass": 5e-324}], ids=["stiff", "light"]
)
def test_a_step_that_no_count_of_internal_steps_can_do_is_discarded(rich, values):
    """The quotient of the step and its limit is beyond any integer, or not a number."""
    host = Host(rich, logging=True)
    host.begin(lambda h: h.set({"stiffness.face": 1e3, **values}))
    before = host.outputs()
    assert host.step(0) == DISCARD
    assert host.messages[-1][2:4] == (DISCARD, b"logStatusWarning")
    assert host.outputs() == before
    host.must("Reset")
    host.free()


# ---- instantiation and the logger ----


@pytest.mark.parametrize(
    "given, wanted",
    [
        ({"type": 0}, "fmuType: wanted fmi2CoSimulation"),
        ({"guid": None}, "fmuGUID: wanted a text, got null"),
        ({"guid": b"{no%s#n}"}, "fmuGUID: wanted {"),
        ({"uri": None}, "fmuResourceLocation: wanted the URI"),
        ({"uri": b""}, "fmuResourceLocation: wanted the URI"),
        ({"uri": b"http://x/%20#y"}, "wanted a file: URI, got http://x/%%20##y"),
        ({"uri": b"file:///no/such%20folder"}, "cannot read /no/such folder/scene.txt"),
        ({"name": b""}, "instanceName: wanted a text"),
        ({"name": None}, "instanceName: wanted a text"),
    ],
)
def test_a_refused_instantiation_says_why_once(rich, given, wanted):
    host = Host(rich, **given)
    assert not host.component
    assert len(host.messages) == 1
    environment, instance, status, category, message = host.messages[0]
    assert (environment, instance) == (4711, given.get("name", b"host") or b"")
    assert (status, category) == (ERROR, b"logStatusError")
    assert wanted in message.decode()
    assert "%" not in message.decode().replace("%%", "")


@pytest.mark.parametrize(
    "given", [{"guid": b"{no}\n"}, {"uri": b"http://x\n"}, {"uri": b"file:///no\xff\xfe"}, {"guid": b"\xff"}]
)
def test_what_a_message_repeats_of_the_host_leaves_it_one_clean_line(rich, given):
    host = Host(rich, **given)
    text = host.messages[0][4].decode("utf-8")
    assert not host.component and text == text.strip() and "\n" not in text


def test_no_callbacks_and_no_logger_are_survived(rich):
    assert not rich.library.fmi2Instantiate(b"x", 1, rich.guid, rich.uri, None, 0, 1)
    host = Host(rich, logger=False, logging=True)
    host.begin()
    assert host.step(0) == OK
    assert host.step(0) == ERROR
    assert host.set({"mass": -1.0}) == ERROR
    host.must("Reset")
    host.free()
    assert not Host(rich, logger=False, guid=b"{no}").component


def test_a_message_is_the_format_that_a_host_prints(rich):
    """Printed as a format, doubled percent signs come out single and nothing is expanded."""
    host = Host(rich, uri=b"http://x/%d%s%n#25")
    message = host.messages[0][4]
    buffer = create_string_buffer(1000)
    library = CDLL(None)
    library.snprintf(buffer, c_size_t(1000), message)
    assert buffer.value.endswith(b"got http://x/%d%s%n##25")


def talkative(host: Host) -> None:
    """A run with solver messages, a warning and a discarded step."""
    host.begin(lambda h: h.set({"solver.step": 0.5}))
    host.must("DoStep", 0.0, STEP, 1)
    host.must("SetReal", uints([host.fmu.names["stiffness.edge"]]), 1, doubles([4e4]))
    host.must("DoStep", STEP, STEP, 1)
    assert host.set({"stiffness.edge": 1e19}) == OK
    assert host("DoStep", 2 * STEP, 1.0, 1) == DISCARD


def test_messages_come_only_where_they_were_asked_for_and_in_declared_categories(rich):
    quiet, loud = Host(rich), Host(rich, logging=True)
    for host in (quiet, loud):
        talkative(host)
    assert quiet.messages == []
    assert {message[3] for message in loud.messages} >= {b"logStatusWarning"}
    for environment, instance, _, category, message in loud.messages:
        assert (environment, instance) == (4711, b"host")
        assert category in rich.categories
        assert message and message == message.strip()
    assert quiet("DoStep", 9.0, STEP, 1) == ERROR
    assert len(quiet.messages) == 1
    for host in (quiet, loud):
        host.free()


def test_categories_are_switched_one_by_one_and_errors_always_come(rich):
    host = Host(rich)
    host.must("SetDebugLogging", 1, 1, (c_char_p * 1)(b"logStatusWarning"))
    talkative(host)
    assert {message[3] for message in host.messages} == {b"logStatusWarning"}
    host.must("SetDebugLogging", 0, 0, None)
    host.messages.clear()
    host.must("Reset")
    talkative(host)
    assert host.messages == []
    assert host("CancelStep") == ERROR
    check_message(host, "fmi2CancelStep")
    host.free()


# ---- nothing is left behind ----


def resident() -> tuple[int, int]:
    """Resident memory [kB] and open files."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE") // 1024, len(os.listdir("/proc/self/fd"))


@pytest.mark.skipif(not LINUX, reason="reads /proc")
def test_ten_thousand_instances_and_a_million_steps_leave_memory_and_files_as_they_were(fmus):
    bare = fmus[1]

    def live_and_die() -> None:
        host = Host(bare)
        host.begin()
        host.step(0)
        host.forget(host.save())
        host.free()

    for _ in range(500):
        live_and_die()
    before = resident()
    for _ in range(10_000):
        live_and_die()
    after = resident()
    assert after[0] - before[0] < 1000, "kB grown over 10,000 instances"
    assert after[1] == before[1]
    host, step = Host(bare), bare.library.fmi2DoStep
    host.begin()
    before = resident()
    for n in range(1_000_000):
        if step(host.component, n * 1e-4, 1e-4, 1):
            pytest.fail(f"step {n}")
    after = resident()
    assert after[0] - before[0] < 500, "kB grown over 1,000,000 steps"
    assert after[1] == before[1]
    host.free()


@pytest.mark.skipif(not LINUX, reason="reads /proc")
def test_states_that_a_host_never_freed_go_with_their_instance(rich):
    def cycle(times: int) -> None:
        for _ in range(times):
            host = Host(rich)
            host.begin()
            for _ in range(10):
                host.save()
            host.free()

    cycle(50)
    before = resident()[0]
    cycle(300)
    assert resident()[0] - before < 1000, "kB grown by 3,000 forgotten states of some 10 kB"


# ---- the host's floating-point environment and locale ----


class Environment:
    """glibc's floating-point environment on x86-64: control words that can be looked at and changed."""

    def __init__(self):
        self.libm = CDLL("libm.so.6")

    def words(self) -> tuple[int, int]:
        """x87 control word and MXCSR without its flags of past exceptions."""
        buffer = create_string_buffer(32)
        self.libm.fegetenv(buffer)
        return struct.unpack_from("<H", buffer.raw, 0)[0], struct.unpack_from("<I", buffer.raw, 28)[0] & ~0x3F

    def raw(self):
        buffer = create_string_buffer(32)
        self.libm.fegetenv(buffer)
        return buffer

    def change(self, mxcsr_bits: int, rounding: int, traps: int) -> None:
        self.libm.fesetround(rounding)
        buffer = self.raw()
        struct.pack_into("<I", buffer, 28, struct.unpack_from("<I", buffer.raw, 28)[0] | mxcsr_bits)
        self.libm.fesetenv(buffer)
        if traps:
            self.libm.feenableexcept(traps)


@pytest.mark.skipif(not LINUX or os.uname().machine != "x86_64", reason="control words of x86-64 with glibc")
@pytest.mark.parametrize(
    "mxcsr, rounding, traps",
    [
        (0, 0x400, 0),
        (0, 0x800, 0),
        (0, 0xC00, 0),
        (0x8000, 0, 0),
        (0x8040, 0, 0),
        (0, 0, 0x1D),
        (0x8040, 0xC00, 0x0D),
    ],
    ids=["down", "up", "to zero", "flush to zero", "denormals are zero too", "traps", "all of it"],
)
def test_the_hosts_floating_point_environment_neither_matters_nor_changes(fmus, mxcsr, rounding, traps):
    environment = Environment()
    for fmu in fmus:
        expected, collected, seen = straight(fmu), [], []
        own = environment.raw()
        environment.change(mxcsr, rounding, traps)
        try:
            wanted = environment.words()
            host = Host(fmu, logging=True)
            host.begin()
            collected.append(host.outputs())
            for n in range(STEPS):
                apply(host, n)
                host.must("DoStep", TIMES[n], STEP, 1)
                seen.append(environment.words())
                collected.append(host.outputs())
            host.must("SetFMUstate", host.received(host.serialized(host.save())))
            host("DoStep", 99.0, STEP, 1)
            host.must("Reset")
            host.free()
            seen.append(environment.words())
        finally:
            environment.libm.fesetenv(own)
        assert wanted != (0x37F, 0x1F80) and set(seen) == {wanted}
        assert collected == expected


LOCALE_SCRIPT = """
import locale, sys
sys.path.insert(0, sys.argv[1])
from pathlib import Path
import test_sequences as t
fmu = t.Fmu(t.RICH, Path(sys.argv[2]))
expected = t.straight(fmu)
locale.setlocale(locale.LC_ALL, sys.argv[3])
point = locale.localeconv()["decimal_point"]
assert point != ".", point
assert t.straight(fmu) == expected
host = t.Host(fmu)
host.begin()
assert host("DoStep", 0.125, 0.01, 1) == t.ERROR
sys.stdout.buffer.write(host.messages[0][4] + b"\\n")
assert locale.localeconv()["decimal_point"] == point
"""


@pytest.mark.skipif(not LINUX, reason="localedef of glibc")
@pytest.mark.parametrize("name", ["de_DE", "ps_AF"])
def test_the_hosts_locale_neither_matters_nor_changes(tmp_path, name):
    """A comma and a decimal point of two bytes."""
    target = tmp_path / f"{name}.UTF-8"
    try:
        done = subprocess.run(["localedef", "-i", name, "-f", "UTF-8", str(target)], capture_output=True)
    except FileNotFoundError:
        pytest.skip("no localedef")
    if not target.is_dir():
        pytest.skip(f"localedef has no {name}: {done.stderr.decode(errors='replace')[:200]}")
    arguments = [
        sys.executable,
        "-c",
        LOCALE_SCRIPT,
        str(Path(__file__).parent),
        str(tmp_path / "fmu"),
        f"{name}.UTF-8",
    ]
    done = subprocess.run(arguments, capture_output=True, env=os.environ | {"LOCPATH": str(tmp_path)})
    if b"unsupported locale setting" in done.stderr:
        pytest.skip(f"localedef could not make {name} here: the sources of locales are not on this machine")
    assert done.returncode == 0, done.stderr.decode()
    text = done.stdout.decode("utf-8").strip()
    assert re.search(r"wanted 0 s, got 0\.125$", text), text
