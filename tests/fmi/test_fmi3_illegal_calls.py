"""Illegal calls of FMI 3.0: each is an error with one message, changes nothing, and a reset runs as new."""

from ctypes import byref, c_bool, c_char_p, c_double, c_int64, c_size_t, c_uint32, c_void_p

import pytest

from c_host import ERROR, STEP, check_message, ints
from c_host3 import Fmu3, Host3
from illegal_calls import ENDED, FAILED, FRESH, INITIALIZING, PHASES, RUNNING, SETTABLE, check_random_calls
from signatures3 import ABSENT, OTHER_TYPES, SIGNATURES
from straight_run import RICH, apply, check_as_new, straight

NAN, INF = float("nan"), float("inf")


@pytest.fixture(scope="module")
def rich(tmp_path_factory) -> Fmu3:
    return Fmu3(RICH, tmp_path_factory.mktemp("rich") / "fmi3")


def bring_to(host: Host3, phase: str) -> None:
    if phase == FRESH:
        return
    assert host.enter(stop=10.0) == 0
    if phase == INITIALIZING:
        return
    host.must("ExitInitializationMode")
    apply(host, 0)
    host.must("DoStep", 0.0, STEP, True)
    if phase == ENDED:
        host.must("Terminate")
    if phase == FAILED:
        assert host("DoStep", 77.0, STEP, True) == ERROR
        host.messages.clear()


def one(reference: int) -> tuple:
    return (c_uint32 * 1)(reference), 1


def reals(count: int = 1):
    return (c_double * count)()


def slope(host: Host3, name: str, order: int = 1) -> int:
    count = host.size([name])
    return host("GetOutputDerivatives", *host.references([name]), ints([order]), reals(count), count)


def damaged(host: Host3) -> int:
    blob = bytearray(host.serialized(host.save()))
    blob[len(blob) // 2] ^= 1
    return host("DeserializeFMUState", bytes(blob), len(blob), byref(c_void_p()))


def without_room(host: Host3, missing: int) -> int:
    places = [byref(c_bool()), byref(c_bool()), byref(c_bool()), byref(c_double())]
    places[missing] = None
    return host("DoStep", STEP, STEP, True, *places)


def blanks(kinds) -> list:
    return [0.0 if kind is c_double else False if kind is c_bool else 0 if kind in (c_size_t, c_uint32) else None for kind in kinds]


POSITION = 60 << 24
ILLEGAL = [
    ((INITIALIZING, RUNNING, ENDED, FAILED), "fmi3EnterInitializationMode: not allowed", lambda h: h.enter()),
    ((FRESH, RUNNING, ENDED, FAILED), "fmi3ExitInitializationMode: not allowed", lambda h: h("ExitInitializationMode")),
    ((FRESH, INITIALIZING, ENDED, FAILED), "fmi3Terminate: not allowed", lambda h: h("Terminate")),
    ((FRESH, INITIALIZING, ENDED, FAILED), "fmi3DoStep: not allowed", lambda h: h("DoStep", STEP, STEP, True)),
    ((ENDED, FAILED), "fmi3SetFloat64: not allowed", lambda h: h.put({"damping": [1.0]})),
    ((FRESH, INITIALIZING), "fmi3GetOutputDerivatives: not allowed", lambda h: slope(h, "position")),
    *[((FRESH,), f"startTime: wanted a finite number, got {t:g}", lambda h, t=t: h.enter(start=t)) for t in (NAN, INF)],
    *[((FRESH,), f"tolerance: wanted a finite number > 0, got {t:g}", lambda h, t=t: h.enter(tolerance=t)) for t in (NAN, -1.0, INF)],
    *[((FRESH,), f"above startTime, got {t:g}", lambda h, t=t: h.enter(start=1.0, stop=t)) for t in (NAN, 1.0, 0.5, INF)],
    ((FRESH,), "position[0,0,0].x: has no value yet", lambda h: h("GetFloat64", *one(POSITION), reals(81), 81)),
    (PHASES, "fmi3GetFloat64: got a null", lambda h: h("GetFloat64", None, 1, reals(), 1)),
    (PHASES, "fmi3GetFloat64: got a null", lambda h: h("GetFloat64", *one(25 << 24), None, 1)),
    (SETTABLE, "fmi3SetFloat64: got a null", lambda h: h("SetFloat64", *one(25 << 24), None, 1)),
    (PHASES, "fmi3GetInt64: got a null", lambda h: h("GetInt64", *one(31 << 24), None, 1)),
    (PHASES, "value reference 7: this scene has no such variable", lambda h: h("GetFloat64", *one(7), reals(), 1)),
    (PHASES, f"value reference {POSITION + 1}: this", lambda h: h("GetFloat64", *one(POSITION + 1), reals(), 1)),
    (PHASES, "value reference 4294967295", lambda h: h("GetInt64", *one(4294967295), (c_int64 * 1)(), 1)),
    (PHASES, "nValues: wanted 81, one for each element of the variables, got 1", lambda h: h("GetFloat64", *one(POSITION), reals(), 1)),
    (PHASES, "nValues: wanted 81, one for each element of the variables, got 0", lambda h: h("GetFloat64", *one(POSITION), reals(), 0)),
    (SETTABLE, "nValues: wanted 3, one for each", lambda h: h("SetFloat64", *h.references(["gravity"]), reals(4), 4)),
    (SETTABLE, "nValues: wanted 1, one for each", lambda h: h("SetInt64", *h.references(["solver.method"]), (c_int64 * 2)(), 2)),
    (SETTABLE, "time: cannot be set", lambda h: h("SetFloat64", *one(0), reals(), 1)),
    (PHASES, "time: is of type Real", lambda h: h("GetInt64", *one(0), (c_int64 * 1)(), 1)),
    (PHASES, "solver.method: is of type Integer", lambda h: h("GetFloat64", *h.references(["solver.method"]), reals(), 1)),
    (SETTABLE, "mass: is of type Real", lambda h: h("SetInt64", *h.references(["mass"]), (c_int64 * 1)(), 1)),
    (SETTABLE, "gravity.y: wanted a finite number, got nan", lambda h: h.put({"damping": [5.0], "gravity": [0.0, NAN, 0.0]})),
    (SETTABLE, "damping: wanted >= 0 N.s/m, got -1", lambda h: h.put({"gravity": [1.0, 1.0, 1.0], "damping": [-1.0]})),
    (SETTABLE, "energy.kinetic: cannot be set", lambda h: h.put({"damping": [5.0], "energy.kinetic": [1.0]})),
    ((RUNNING,), "plane.wall.point.x: cannot be set after initialization", lambda h: h.put({"plane.wall.point": [2.0, 0.0, 0.0]})),
    (
        (FRESH, INITIALIZING),
        "solver.method: wanted one of 1",
        lambda h: h("SetInt64", *h.references(["solver.method"]), (c_int64 * 1)(2**62), 1),
    ),
    ((RUNNING, ENDED), "wanted a derivative of order 1, got 2", lambda h: slope(h, "position", 2)),
    ((RUNNING, ENDED), "damping: is no output", lambda h: slope(h, "damping")),
    ((RUNNING, ENDED), "time: is no output", lambda h: slope(h, "time")),
    *[((RUNNING,), "fmi3DoStep: currentCommunicationPoint", lambda h, t=t: h("DoStep", t, STEP, True)) for t in (0.0, 0.02, NAN, INF)],
    *[((RUNNING,), "fmi3DoStep: communicationStepSize", lambda h, s=s: h("DoStep", STEP, s, True)) for s in (0.0, -STEP, NAN)],
    ((RUNNING,), "fmi3DoStep: a step to 10.01 s goes past the stop time 10 s", lambda h: h("DoStep", STEP, 10.0, True)),
    *[((RUNNING,), "fmi3DoStep: got a null", lambda h, n=n: without_room(h, n)) for n in range(4)],
    (PHASES, "fmi3GetFMUState: got a null", lambda h: h("GetFMUState", None)),
    (PHASES, "fmi3SetFMUState: FMUstate: wanted a state", lambda h: h("SetFMUState", h.component)),
    (PHASES, "fmi3FreeFMUState: FMUstate: wanted a state", lambda h: h("FreeFMUState", byref(c_void_p(h.component)))),
    (PHASES, "fmi3SerializedFMUStateSize: FMUstate: wanted", lambda h: h("SerializedFMUStateSize", None, byref(c_size_t()))),
    (PHASES, "fmi3DeserializeFMUState: the state is damaged", damaged),
    (PHASES, "fmi3SetDebugLogging: got a null", lambda h: h("SetDebugLogging", True, 2, None)),
    *[
        (
            SETTABLE if name.startswith("Set") else PHASES,
            f"fmi3{name}: there are no variables",
            lambda h, name=name: h(name, *one(0), None, 1),
        )
        for name in OTHER_TYPES
    ],
    (PHASES, "fmi3GetClock: there are no variables", lambda h: h("GetClock", *one(0), None)),
    (PHASES, "fmi3GetBinary: there are no variables", lambda h: h("GetBinary", *one(0), None, None, 1)),
    *[
        (PHASES, f"fmi3{name}: not available; modelDescription.xml does not claim it", lambda h, name=name: h(name, *blanks(ABSENT[name])))
        for name in ABSENT
    ],
]


def test_every_illegal_call_is_an_error_with_one_message_and_changes_nothing(rich):
    expected, host = straight(rich, 3), rich.host()
    for phases, wanted, call in ILLEGAL:
        for phase in phases:
            host.must("Reset")
            bring_to(host, phase)
            readable = phase in (RUNNING, ENDED, FAILED)
            before = host.settings() + host.outputs() if readable else host.settings()
            assert call(host) == ERROR, (phase, wanted)
            check_message(host, wanted)
            assert (host.settings() + host.outputs() if readable else host.settings()) == before, (phase, wanted)
    check_as_new(host, expected)
    host.free()


def test_random_illegal_calls_between_legal_ones_leave_a_reset_as_new(rich):
    check_random_calls(rich.host(), bring_to, ILLEGAL, seed=3, lives=100)


def test_dead_and_foreign_handles_are_errors(rich):
    host = rich.host()
    dead = host.component
    host.free()
    for handle in (None, dead, 64):
        for name, kinds in (SIGNATURES | ABSENT).items():
            assert getattr(rich.library, f"fmi3{name}")(handle, *blanks(kinds)) == ERROR, name
        rich.library.fmi3FreeInstance(handle)


def test_calls_about_no_variables_are_fine(rich):
    host = rich.host()
    for name in (*OTHER_TYPES, "GetFloat64", "SetFloat64", "GetInt64", "SetInt64"):
        host.must(name, None, 0, None, 0)
    assert not host.messages
    host.free()


def test_an_unknown_log_category_is_passed_over_with_a_warning(rich):
    host = rich.host()
    assert host("SetDebugLogging", True, 2, (c_char_p * 2)(b"solver", b"weather")) == 1
    assert b"passed over weather" in host.messages[-1][-1]
    host.free()
