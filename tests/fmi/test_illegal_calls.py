"""Illegal calls of either standard: each is an error with one message, changes nothing, and a reset runs as new."""

import os
import subprocess
import sys
from ctypes import byref, c_bool, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint, c_uint32, c_void_p, create_string_buffer
from tempfile import TemporaryDirectory

import pytest

from c_host import DISCARD, ERROR, STEP, Host, check_message, doubles, ints, uints
from c_host3 import Host3
from illegal_calls import (
    ALIVE,
    ENDED,
    FAILED,
    FRESH,
    INITIALIZING,
    PHASES,
    RUNNING,
    SETTABLE,
    bring_to,
    check_random_calls,
    require_refusal,
)
from signatures import ABSENT, OTHER_TYPES
from straight_run import RICH, check_as_new, check_straight, straight

NAN, INF = float("nan"), float("inf")
UNSET, DONE, OVER = (FRESH, INITIALIZING), (RUNNING, ENDED), (ENDED, FAILED)
POSITION, STIFFNESS, METHOD = 60 << 24, 25 << 24, 31 << 24


def mixed(host: Host, bad: str, value: float) -> int:
    """A good value and a bad one in one call."""
    return host.put_by_name({"stiffness.edge": 5e3, bad: value})


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
    host.forget(state)
    return status


EITHER = [
    ((FRESH, RUNNING, *OVER), "fmi2ExitInitializationMode: not allowed", lambda h: h("ExitInitializationMode")),
    ((*UNSET, *OVER), "fmi2Terminate: not allowed", lambda h: h("Terminate")),
    ((*UNSET, *OVER), "fmi2DoStep: not allowed", lambda h: h("DoStep", STEP, STEP, 1)),
    (OVER, "fmi2SetReal: not allowed", lambda h: h.put_by_name({"damping": 1.0})),
    (OVER, "fmi2SetInteger: not allowed", lambda h: h.set_integer("solver.method", 1)),
    (UNSET, "fmi2GetRealOutputDerivatives: not allowed", lambda h: h.ask_slope("energy.work")),
    *[((FRESH,), f"startTime: wanted a finite number, got {t}", lambda h, t=t: h.enter(start=t)) for t in (NAN, INF)],
    *[((FRESH,), f"tolerance: wanted a finite number > 0, got {t:g}", lambda h, t=t: h.enter(tolerance=t)) for t in (NAN, -1.0, 0.0, INF)],
    *[((FRESH,), f"above startTime, got {t:g}", lambda h, t=t: h.enter(start=1.0, stop=t)) for t in (NAN, 1.0, 0.5, INF)],
    (SETTABLE, "damping: wanted a finite number, got nan", lambda h: mixed(h, "damping", NAN)),
    (SETTABLE, "damping: wanted >= 0 N.s/m, got -1", lambda h: mixed(h, "damping", -1.0)),
    (SETTABLE, "energy.kinetic: cannot be set", lambda h: mixed(h, "energy.kinetic", 1.0)),
    (UNSET, "mass: wanted > 0 kg, got 0", lambda h: mixed(h, "mass", 0.0)),
    ((RUNNING,), "mass: cannot be set after initialization", lambda h: mixed(h, "mass", 2.0)),
    *[(UNSET, "method: wanted one of 1 auto, 2 central_difference, ", lambda h, n=n: h.set_integer("solver.method", n)) for n in (10, 99)],
    (DONE, "damping: is no output", lambda h: h.ask_slope("damping")),
    *[(DONE, f"energy.work: wanted a derivative of order 1, got {n}", lambda h, n=n: h.ask_slope("energy.work", n)) for n in (-1, 0, 2)],
    *[((RUNNING,), "fmi2DoStep: currentCommunicationPoint", lambda h, t=t: h("DoStep", t, STEP, 1)) for t in (0.0, 0.02, NAN, INF, -INF)],
    *[((RUNNING,), "fmi2DoStep: communicationStepSize", lambda h, s=s: h("DoStep", STEP, s, 1)) for s in (0.0, -STEP, NAN, INF, -0.0)],
    ((RUNNING,), "fmi2DoStep: a step to 10.01 s goes past the stop time 10 s", lambda h: h("DoStep", STEP, 10.0, 1)),
    (PHASES, "fmi2SetDebugLogging: categories: wanted an array of 2, got null", lambda h: h("SetDebugLogging", 1, 2, None)),
    (PHASES, "fmi2GetFMUstate: FMU", lambda h: h("GetFMUstate", None)),
    (PHASES, "fmi2GetFMUstate: FMUstate: wanted a state", lambda h: h("GetFMUstate", byref(c_void_p(64)))),
    (PHASES, "fmi2SetFMUstate: FMUstate: wanted a state", lambda h: h("SetFMUstate", None)),
    (PHASES, "fmi2SetFMUstate: FMUstate: wanted a state", lambda h: h("SetFMUstate", h.component)),
    (PHASES, "fmi2FreeFMUstate: FMUstate: wanted a state", lambda h: h("FreeFMUstate", byref(c_void_p(h.component)))),
    (PHASES, "fmi2SerializedFMUstateSize: FMUstate: wanted a state", lambda h: h("SerializedFMUstateSize", None, byref(c_size_t()))),
    (PHASES, "fmi2SerializeFMUstate: FMUstate: wanted a state", lambda h: h("SerializeFMUstate", None, None, 0)),
    (PHASES, "fmi2SerializeFMUstate: size: wanted", too_small),
    (
        PHASES,
        "fmi2DeSerializeFMUstate: serializedState: wanted an array of 8, got null",
        lambda h: h("DeSerializeFMUstate", None, 8, byref(c_void_p())),
    ),
    (PHASES, "fmi2DeSerializeFMUstate: FMU", lambda h: h("DeSerializeFMUstate", b"12345678", 8, None)),
    (PHASES, "fmi2DeSerializeFMUstate: the state is too short", lambda h: h("DeSerializeFMUstate", b"12345678", 8, byref(c_void_p()))),
    (PHASES, "fmi2DeSerializeFMUstate: the state is damaged", damaged),
]


def call(function: str, *references: int, kind=doubles, values: int | None = None):
    """Asks for these references of FMI 2.0, or sets them to 0."""
    return lambda h: h(function, uints(list(references)), len(references), kind([0] * (values or len(references))))


def rates(host: Host, name: str, order: int, value: float) -> int:
    return host("SetRealInputDerivatives", uints([host.fmu.names[name]]), 1, ints([order]), doubles([value]))


def asked(host: Host, name: str, function: str, kind=doubles) -> int:
    return call(function, host.fmu.names[name], kind=kind)(host)


OF_FMI2 = [
    (SETTABLE, "mass: is of type Real, got a call for Integer", lambda h: h.set_integer("mass", 1)),
    (SETTABLE, "solver.method: is of type Integer, got a call for Real", lambda h: h.put_by_name({"solver.method": 1.0})),
    ((RUNNING,), "plane.wall.point.x: cannot be set", lambda h: mixed(h, "plane.wall.point.x", 2.0)),
    ((INITIALIZING, *DONE, FAILED), "fmi2SetupExperiment: not allowed", lambda h: h("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)),
    ((INITIALIZING, *DONE, FAILED), "fmi2EnterInitializationMode: not allowed", lambda h: h("EnterInitializationMode")),
    ((FRESH,), "fmi2GetReal: not allowed", lambda h: asked(h, "mass", "GetReal")),
    ((FRESH,), "fmi2GetInteger: not allowed", lambda h: asked(h, "solver.method", "GetInteger", ints)),
    (OVER, "fmi2SetRealInputDerivatives: not allowed", lambda h: rates(h, "load.push.x", 1, 1.0)),
    ((FAILED,), "fmi2CancelStep: not allowed", lambda h: h("CancelStep")),
    (UNSET, "fmi2GetRealStatus: not allowed", lambda h: h("GetRealStatus", 2, doubles([0]))),
    (UNSET, "fmi2GetStatus: not allowed", lambda h: h("GetStatus", 0, ints([0]))),
    (DONE, "fmi2GetRealStatus: value: wanted a pointer, got null", lambda h: h("GetRealStatus", 2, None)),
    (DONE, "fmi2GetBooleanStatus: value: wanted a pointer, got null", lambda h: h("GetBooleanStatus", 3, None)),
    (ALIVE, "fmi2GetReal: vr: wanted a pointer, got null", lambda h: h("GetReal", None, 1, doubles([0]))),
    (ALIVE, "fmi2GetReal: value: wanted a pointer, got null", lambda h: h("GetReal", uints([STIFFNESS]), 1, None)),
    (ALIVE, "fmi2GetInteger: vr: wanted a pointer, got null", lambda h: h("GetInteger", None, 1, ints([0]))),
    (SETTABLE, "fmi2SetReal: vr: wanted a pointer, got null", lambda h: h("SetReal", None, 1, doubles([0]))),
    (SETTABLE, "fmi2SetReal: value: wanted an array of 3, got null", lambda h: h("SetReal", uints([STIFFNESS]), 3, None)),
    (SETTABLE, "fmi2SetInteger: value: wanted", lambda h: h("SetInteger", uints([METHOD]), 1, None)),
    (SETTABLE, "SetRealInputDerivatives: order: wanted", lambda h: h("SetRealInputDerivatives", uints([2 << 24]), 1, None, doubles([0]))),
    (
        (RUNNING,),
        "fmi2GetRealOutputDerivatives: value: wanted",
        lambda h: h("GetRealOutputDerivatives", uints([POSITION]), 1, ints([1]), None),
    ),
    (ALIVE, "value reference 0: this scene has no such", call("GetReal", 0)),
    (ALIVE, f"value reference {POSITION + 81}", call("GetReal", POSITION, POSITION + 81)),
    (SETTABLE, f"value reference {(1 << 24) + 3}", call("SetReal", 2 << 24, (1 << 24) + 3)),
    (ALIVE, "plane.ground.contacts: is of type Integer, got a call for Real", lambda h: asked(h, "plane.ground.contacts", "GetReal")),
    (SETTABLE, "there are no Boolean variables", lambda h: asked(h, "mass", "SetBoolean", ints)),
    (ALIVE, "there are no String variables", lambda h: h("GetString", uints([STIFFNESS]), 1, (c_char_p * 1)())),
    *[(SETTABLE, f"push.x: wanted a derivative of order 1 to 3, got {n}", lambda h, n=n: rates(h, "load.push.x", n, 1)) for n in (0, 4)],
    (SETTABLE, "plane.ground.point.x: wanted a derivative of order 1, got 2", lambda h: rates(h, "plane.ground.point.x", 2, 1.0)),
    *[
        (DONE, f"{name}: wanted a derivative of order 1, got {n}", lambda h, name=name, n=n: h.ask_slope(name, n))
        for name in ("position[0,0,0].x", "velocity[0,0,0].x", "plane.wall.reaction.z")
        for n in (-1, 0, 2)
    ],
    (SETTABLE, "load.push.x: wanted a finite derivative", lambda h: rates(h, "load.push.x", 1, NAN)),
    (SETTABLE, "damping: is no input", lambda h: rates(h, "damping", 1, 1.0)),
    (
        PHASES,
        "fmi2GetDirectionalDerivative: not available",
        lambda h: h("GetDirectionalDerivative", uints([0]), 1, uints([0]), 1, doubles([0]), doubles([0])),
    ),
]  # fmt: skip


def one(reference: int) -> tuple:
    return (c_uint32 * 1)(reference), 1


def reals(count: int = 1):
    return (c_double * count)()


def counts(count: int = 1):
    return (c_int64 * count)()


RESULTS = {"eventHandlingNeeded": c_bool, "terminateSimulation": c_bool, "earlyReturn": c_bool, "lastSuccessfulTime": c_double}


def without_room(host: Host3, missing: str) -> int:
    return host("DoStep", STEP, STEP, True, *(None if name == missing else byref(kind()) for name, kind in RESULTS.items()))


def blanks(kinds) -> list:
    return [0.0 if kind is c_double else 0 if kind in (c_int, c_bool, c_size_t, c_uint) else None for kind in kinds]


SIZE = "nValues: wanted {}, one for each element of the variables, got {}".format
OF_FMI3 = [
    (SETTABLE, "mass: is of type Float64, got a call for Int64", lambda h: h.set_integer("mass", 1)),
    (SETTABLE, "solver.method: is of type Int64, got a call for Float64", lambda h: h.put_by_name({"solver.method": 1.0})),
    ((RUNNING,), "element 1 of plane.wall.point: cannot be set", lambda h: mixed(h, "plane.wall.point.x", 2.0)),
    (SETTABLE, "element 2 of gravity: wanted a finite number, got nan", lambda h: h.put_by_name({"gravity.y": NAN})),
    ((INITIALIZING, *DONE, FAILED), "fmi3EnterInitializationMode: not allowed", lambda h: h.enter()),
    ((FRESH,), "element 1 of position: has no value yet", lambda h: h("GetFloat64", *one(POSITION), reals(81), 81)),
    (PHASES, "fmi3GetFloat64: valueReferences: wanted a pointer, got null", lambda h: h("GetFloat64", None, 1, reals(), 1)),
    (PHASES, "fmi3GetFloat64: values: wanted", lambda h: h("GetFloat64", *one(STIFFNESS), None, 1)),
    (SETTABLE, "fmi3SetFloat64: values: wanted", lambda h: h("SetFloat64", *one(STIFFNESS), None, 1)),
    (PHASES, "fmi3GetInt64: values: wanted", lambda h: h("GetInt64", *one(METHOD), None, 1)),
    (PHASES, "value reference 7: this scene has no such variable", lambda h: h("GetFloat64", *one(7), reals(), 1)),
    (PHASES, f"value reference {POSITION + 1}: this", lambda h: h("GetFloat64", *one(POSITION + 1), reals(), 1)),
    (PHASES, "value reference 4294967295", lambda h: h("GetInt64", *one(4294967295), counts(), 1)),
    *[(PHASES, SIZE(81, n), lambda h, n=n: h("GetFloat64", *one(POSITION), reals(82), n)) for n in (0, 1, 80, 82)],
    (SETTABLE, SIZE(3, 4), lambda h: h("SetFloat64", *h.references(["gravity"]), reals(4), 4)),
    (SETTABLE, SIZE(1, 2), lambda h: h("SetInt64", *h.references(["solver.method"]), counts(2), 2)),
    (SETTABLE, "time: cannot be set", lambda h: h("SetFloat64", *one(0), reals(), 1)),
    (PHASES, "time: is of type Float64, got a call for Int64", lambda h: h("GetInt64", *one(0), counts(), 1)),
    (PHASES, "solver.method: is of type Int64", lambda h: h("GetFloat64", *h.references(["solver.method"]), reals(), 1)),
    (UNSET, "solver.method: wanted one of 1", lambda h: h.set_integer("solver.method", 2**62)),
    (DONE, "wanted a derivative of order 1, got 2", lambda h: h.ask_slope("position", 2)),
    (DONE, "time: is no output", lambda h: h.ask_slope("time")),
    *[((RUNNING,), f"fmi3DoStep: {n}: wanted a pointer, got null", lambda h, n=n: without_room(h, n)) for n in RESULTS],
    *[
        (SETTABLE if n.startswith("Set") else PHASES, f"fmi3{n}: there are no variables", lambda h, name=n: h(name, *one(0), None, 1))
        for n in OTHER_TYPES
    ],
    (PHASES, "fmi3GetClock: there are no variables", lambda h: h("GetClock", *one(0), None)),
    (PHASES, "fmi3GetBinary: there are no variables", lambda h: h("GetBinary", *one(0), None, None, 1)),
    *[
        (PHASES, f"fmi3{name}: not available; modelDescription.xml does not claim it", lambda h, name=name: h(name, *blanks(ABSENT[name])))
        for name in ABSENT
    ],
]  # fmt: skip
ILLEGAL = {"fmi2": EITHER + OF_FMI2, "fmi3": EITHER + OF_FMI3}


def seen(host: Host, phase: str) -> bytes:
    """All that can be read in this phase."""
    readable = phase in (RUNNING, ENDED, FAILED)
    settings = host.settings() if readable or host.fmu.standard == "fmi3" else b""
    return settings + (host.outputs() if readable else b"")


def test_every_illegal_call_is_an_error_with_one_message_and_changes_nothing(rich_of_each):
    expected, host = straight(rich_of_each, 3), rich_of_each.host()
    for phases, wanted, call in ILLEGAL[rich_of_each.standard]:
        for phase in phases:
            host.must("Reset")
            bring_to(host, phase)
            before = seen(host, phase)
            require_refusal(host, wanted, call)
            assert seen(host, phase) == before, (phase, wanted)
            if rich_of_each.standard == "fmi2":  # the other reads arrays, which takes longer
                check_as_new(host, expected)
    check_as_new(host, expected)
    host.free()


def test_random_illegal_calls_between_legal_ones_leave_a_reset_as_new(rich_of_each):
    seed, lives = (7, 300) if rich_of_each.standard == "fmi2" else (3, 100)
    check_random_calls(rich_of_each.host(), ILLEGAL[rich_of_each.standard], seed=seed, lives=lives)


def test_a_refused_foreign_state_leaves_the_run_as_it_was(rich_of_each):
    host = rich_of_each.host()

    def refuse() -> None:
        assert host("SetFMUstate", host.component) == damaged(host) == ERROR

    host.begin()
    check_straight(host, straight(rich_of_each), refuse)
    host.free()


def test_a_state_of_another_scene_in_the_same_library_is_refused_though_its_size_fits(rich_of_each, tmp_path):
    stiffer = type(rich_of_each)(RICH.replace({"material.stiffness": 3e3}), tmp_path / "stiffer", rich_of_each.library)
    host, other = rich_of_each.host(), stiffer.host()
    host.begin()
    other.begin()
    foreign, before = other.save(), host.outputs()
    blob = other.serialized(foreign)
    assert len(blob) == len(host.serialized(host.save()))
    for call, arguments in [("SetFMUstate", (foreign,)), ("DeSerializeFMUstate", (blob, len(blob), byref(c_void_p())))]:
        assert host(call, *arguments) == ERROR
        check_message(host, "the state belongs to another scene")
    assert host.outputs() == before
    host.free()
    other.free()


def test_dead_and_foreign_handles_are_errors(rich_of_each, rich, rich3):
    host, library = rich_of_each.host(), rich_of_each.library
    dead, other = host.component, (rich3 if rich_of_each.standard == "fmi2" else rich).host()
    host.free()
    for handle in (None, dead, 64, other.component):  # the last of the other standard
        for name, kinds in rich_of_each.signatures.items():
            assert getattr(library, f"{rich_of_each.standard}{name}")(handle, *blanks(kinds)) == ERROR, name
        getattr(library, f"{rich_of_each.standard}FreeInstance")(handle)
    other.must("Reset")
    other.free()


def test_getters_answer_in_the_error_state_before_initialization(rich):
    script = """
import sys
from pathlib import Path
import c_host as c, straight_run
fmu = c.Fmu(straight_run.RICH, Path(sys.argv[1]) / "again")
for reference in fmu.reals:
    host = c.Host(fmu)
    assert host.set({"mass": -1.0}) == c.ERROR
    print(reference, flush=True)
    host.reals([reference])
    host.free()
print("done")
"""
    with TemporaryDirectory() as folder:
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
        done = subprocess.run([sys.executable, "-c", script, folder], env=environment, capture_output=True, text=True)
    last = done.stdout.splitlines()[-1] if done.stdout else done.stderr[-300:]
    name = next((n for n, r in rich.names.items() if str(r) == last), last)
    assert done.returncode == 0, f"{name}: ended with {done.returncode}"


@pytest.mark.parametrize("values", [{"stiffness.edge": 1e60, "solver.step": STEP}, {"mass": 5e-324}], ids=["stiff", "light"])
def test_a_step_that_no_count_of_internal_steps_can_do_is_discarded(rich_of_each, values):
    """The quotient of the step and its limit is beyond any integer, or not a number."""
    host = rich_of_each.host(logging=True)
    host.begin(lambda h: h.set({"stiffness.face": 1e3, **values}))
    before = host.outputs()
    assert host.step(0) == DISCARD
    assert host.messages[-1][2:4] == (DISCARD, b"logStatusDiscard")
    assert host.outputs() == before and host.reached() == 0.0
    host.must("Reset")
    host.free()


def test_a_zero_normal_is_refused_by_the_step(rich_of_each):
    host = rich_of_each.host()
    host.begin()
    assert host.set({"plane.ground.normal.y": 0.0, "plane.ground.normal.z": 0.0}) == 0
    require_refusal(host, "plane.ground: the normal is the zero vector; wanted any other vector", lambda h: h.step(0))
    host.free()
