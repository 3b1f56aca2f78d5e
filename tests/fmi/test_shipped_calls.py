"""Random calls on every shipped scene: legal ones end without an error, any others without a crash, and a reset is as new after either."""

import math
import random
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p, create_string_buffer

import fmpy
import pytest

from c_host import ERROR, OK, WARNING, Fmu, Host, doubles, ints, uints
from signatures import SIGNATURES
from softffd import load_scene
from softffd.scene.document import shipped_scenes

CALLS = {"some": 200, "many": 10_000}
LENGTHS = (1e-3, 2e-3, 5e-3)
"""Of communication steps [s]"""
few = pytest.mark.short(*(f"{name}-some" for name in ("car_drop", "flat_pad", "hanging", "light_bounce", "press", "spin", "stiff_layer")))


@pytest.fixture(scope="module", params=shipped_scenes())
def shipped(request, tmp_path_factory) -> Fmu:
    folder = tmp_path_factory.mktemp("shipped")
    scene = load_scene(request.param)
    fmu = Fmu(scene, folder / "fmu_of")
    fmu.experiment = scene.experiment
    fmu.variables = fmpy.read_model_description(str(folder / "fmu_of" / "box.fmu"), validate=False).modelVariables
    return fmu


class Lawful:
    """A host that makes only calls that the standard allows where its instance stands, with values near the starts and within bounds."""

    def __init__(self, fmu: Fmu, generator: random.Random):
        self.fmu, self.random = fmu, generator
        reals = [v for v in fmu.variables if v.type == "Real"]
        self.inputs = [v for v in reals if v.causality == "input"]
        self.tunable = [v for v in reals if v.variability == "tunable"]
        self.states: list[tuple[c_void_p, float]] = []  # with their times
        self.host = Host(fmu, logging=True)
        self.begin()

    def begin(self) -> None:
        self.time = self.random.choice([0.0, 0.0, 7.5, -3.0])
        self.host.must("SetupExperiment", 0, 0.0, self.time, 0, 0.0)
        self.set_inputs()
        self.host.must("EnterInitializationMode")
        self.look()
        self.host.must("ExitInitializationMode")

    def near(self, variable) -> float:
        start = float(variable.start)
        if variable.causality == "parameter":
            return min(start * self.random.uniform(0.9, 1.1), float(variable.max or math.inf))
        return start + 0.01 * float(variable.nominal or 1.0) * self.random.uniform(-1.0, 1.0)

    def _set(self, variables) -> None:
        chosen = [v for v in variables if self.random.random() < 0.3]
        self.host.must("SetReal", uints([v.valueReference for v in chosen]), len(chosen), doubles([self.near(v) for v in chosen]))

    def set_inputs(self) -> None:
        self._set(self.inputs)

    def set_tunable(self) -> None:
        self._set(self.tunable)

    def set_rates(self) -> None:
        chosen = [v for v in self.inputs if self.random.random() < 0.2]
        rates = doubles([0.01 * float(v.nominal or 1.0) * self.random.uniform(-1.0, 1.0) for v in chosen])
        self.host.must("SetRealInputDerivatives", uints([v.valueReference for v in chosen]), len(chosen), ints([1] * len(chosen)), rates)

    def step(self) -> None:
        length = self.random.choice(LENGTHS)
        status = self.host("DoStep", self.time, length, self.random.randrange(2))
        assert status in (OK, WARNING), self.host.messages[-1:]
        self.time += length

    def look(self) -> None:
        self.host.outputs()

    def slopes(self) -> None:
        self.host.slopes()

    def ask(self) -> None:
        value = c_double()
        self.host.must("GetRealStatus", 2, byref(value))
        assert value.value == pytest.approx(self.time, abs=1e-9)

    def log(self) -> None:
        category = self.random.choice(sorted(self.fmu.categories))
        self.host.must("SetDebugLogging", self.random.randrange(2), 1, (c_char_p * 1)(category))

    def save(self) -> None:
        if len(self.states) < 8:
            self.states.append((self.host.save(), self.time))

    def restore(self) -> None:
        if self.states:
            state, self.time = self.random.choice(self.states)
            self.host.must("SetFMUstate", state)

    def copy(self) -> None:
        """A state by its bytes."""
        if self.states:
            state, time = self.states.pop(self.random.randrange(len(self.states)))
            blob = self.host.serialized(state)
            self.host.forget(state)
            self.states.append((self.host.received(blob), time))

    def drop(self) -> None:
        if self.states:
            self.host.forget(self.states.pop(self.random.randrange(len(self.states)))[0])

    def restart(self) -> None:
        if self.random.random() < 0.5:
            self.host.must("Terminate")
            self.look()
        self.host.must("Reset")
        self.begin()


MOVES = {
    "step": 30, "set_inputs": 15, "set_tunable": 3, "set_rates": 8, "look": 15, "slopes": 8, "ask": 4, "log": 2, "save": 5, "restore": 5,
    "copy": 3, "drop": 3, "restart": 1,
}  # fmt: skip


@few
@pytest.mark.parametrize("calls", CALLS)
def test_random_legal_calls_end_without_an_error(shipped, calls):
    generator = random.Random(calls)
    walker = Lawful(shipped, generator)
    for _ in range(CALLS[calls]):
        if not walker.time < 100.0:
            walker.restart()
        getattr(walker, generator.choices(list(MOVES), MOVES.values())[0])()
    assert [message for message in walker.host.messages if message[2] > WARNING] == []
    check_as_new(walker.host, shipped)


def check_as_new(host: Host, fmu: Fmu) -> None:
    """A reset instance runs as a fresh one does, bit by bit."""
    fresh = Host(fmu)
    host.must("Reset")
    for each in (host, fresh):
        each.begin()
        assert each("DoStep", 0.0, LENGTHS[0], 1) in (OK, WARNING)
    assert host.outputs() == fresh.outputs()
    for each in (host, fresh):
        each.free()


class Lawless:
    """Arguments by their types: right ones, wrong ones, none."""

    NUMBERS = (0.0, -0.0, 1e-3, 5e-3, 1.0, -1.0, 1e-300, 1e300, math.nan, math.inf, -math.inf)
    SIZE = 4

    def __init__(self, fmu: Fmu, generator: random.Random):
        self.fmu, self.random = fmu, generator
        self.references = [v.valueReference for v in fmu.variables]
        self.host = Host(fmu)
        self.states: list[c_void_p] = []

    def argument(self, kind):
        pick = self.random.choice
        by_value = {
            c_double: lambda: pick(self.NUMBERS),
            c_int: lambda: pick([0, 1, 2, 3, -1, 77]),
            c_size_t: lambda: self.random.randrange(self.SIZE + 1),
            c_void_p: lambda: pick([None, self.host.component, 64, *self.states]),
            c_char_p: lambda: create_string_buffer(self.random.randbytes(64), 64),
        }
        by_pointer = {
            POINTER(c_uint): lambda: uints([pick([pick(self.references), self.random.getrandbits(32)]) for _ in range(self.SIZE)]),
            POINTER(c_double): lambda: doubles([pick(self.NUMBERS) for _ in range(self.SIZE)]),
            POINTER(c_int): lambda: ints([pick([0, 1, 2, -5]) for _ in range(self.SIZE)]),
            POINTER(c_char_p): lambda: (c_char_p * self.SIZE)(*[pick([b"solver", b"", b"\xff\xfe", b"logAll"]) for _ in range(self.SIZE)]),
            POINTER(c_size_t): lambda: byref(c_size_t()),
            POINTER(c_void_p): lambda: byref(pick([c_void_p(), c_void_p(64), *self.states])),
        }
        if kind in by_value:
            return by_value[kind]()
        return None if self.random.random() < 0.1 else by_pointer[kind]()

    def call(self) -> int:
        name = self.random.choice(list(SIGNATURES))
        if name == "SerializeFMUstate":  # the size that it is told must be that of the memory
            size = self.random.randrange(65)
            return self.host(name, self.argument(c_void_p), create_string_buffer(64), size)
        status = self.host(name, *map(self.argument, SIGNATURES[name]))
        if name == "FreeFMUstate":
            self.states = [state for state in self.states if state.value]
        return status

    def lawful(self) -> None:
        """Now and then what the standard wants, so that every phase is come to."""
        self.host("Reset")
        self.host("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        for name in ("EnterInitializationMode", "ExitInitializationMode")[: self.random.randrange(3)]:
            self.host(name)
        state = c_void_p()
        if len(self.states) < 4 and self.host("GetFMUstate", byref(state)) == OK:
            self.states.append(state)


@few
@pytest.mark.parametrize("calls", CALLS)
def test_random_calls_of_any_kind_end_without_a_crash(shipped, calls):
    generator = random.Random(f"any {calls}")
    host = Lawless(shipped, generator)
    refused = 0
    for n in range(CALLS[calls]):
        if n % 10 == 0:
            host.lawful()
        status = host.call()
        assert 0 <= status <= ERROR
        refused += status == ERROR
    assert refused > CALLS[calls] / 4
    check_as_new(host.host, shipped)


@pytest.mark.short("car_drop", "incline", "stiff_bounce")
def test_a_host_that_gives_the_scenes_stop_time_and_one_that_gives_none_end_with_the_same_bits(shipped):
    stop, step = shipped.experiment.stop_time, shipped.experiment.communication_step
    ends = []
    for given in (stop, None):
        host = Host(shipped)
        host.begin(stop=given)
        for n in range(round(stop / step)):
            host.must("DoStep", n * step, step, 1)
        ends.append(host.outputs())
        host.free()
    assert ends[0] == ends[1]
