"""Illegal calls: each is an error with one message, changes nothing, and a reset runs as new."""

import os
import subprocess
import sys
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_void_p, create_string_buffer
from tempfile import TemporaryDirectory

import pytest

from c_host import DISCARD, ERROR, SIGNATURES, STEP, STEPS, TIMES, Fmu, Host, check_message, doubles, ints, uints
from illegal_calls import ALIVE, ENDED, FAILED, FRESH, INITIALIZING, PHASES, RUNNING, SETTABLE, check_random_calls
from straight_run import RICH, apply, check_as_new, straight

NAN, INF = float("nan"), float("inf")


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


ILLEGAL = [
    ((INITIALIZING, RUNNING, ENDED, FAILED), "fmi2SetupExperiment: not allowed", lambda h: h("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)),
    ((INITIALIZING, RUNNING, ENDED, FAILED), "fmi2EnterInitializationMode: not allowed", lambda h: h("EnterInitializationMode")),
    ((FRESH, RUNNING, ENDED, FAILED), "fmi2ExitInitializationMode: not allowed", lambda h: h("ExitInitializationMode")),
    ((FRESH, INITIALIZING, ENDED, FAILED), "fmi2Terminate: not allowed", lambda h: h("Terminate")),
    ((FRESH, INITIALIZING, ENDED, FAILED), "fmi2DoStep: not allowed", lambda h: h("DoStep", STEP, STEP, 1)),
    ((FRESH,), "fmi2GetReal: not allowed", lambda h: number(h, "mass", 0.0, "GetReal")),
    ((FRESH,), "fmi2GetInteger: not allowed", lambda h: number(h, "solver.method", 0, "GetInteger", ints)),
    ((ENDED, FAILED), "fmi2SetReal: not allowed", lambda h: number(h, "damping", 1.0)),
    ((ENDED, FAILED), "fmi2SetInteger: not allowed", lambda h: number(h, "solver.method", 1, "SetInteger", ints)),
    ((ENDED, FAILED), "fmi2SetRealInputDerivatives: not allowed", lambda h: rates(h, "load.push.x", 1, 1.0)),
    (
        (FRESH, INITIALIZING),
        "fmi2GetRealOutputDerivatives: not allowed",
        lambda h: h("GetRealOutputDerivatives", uints([0]), 1, ints([1]), doubles([0])),
    ),
    ((FAILED,), "fmi2CancelStep: not allowed", lambda h: h("CancelStep")),
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
    (SETTABLE, "fmi2SetRealInputDerivatives: got a null", lambda h: h("SetRealInputDerivatives", uints([2 << 24]), 1, None, doubles([0]))),
    (
        (RUNNING,),
        "fmi2GetRealOutputDerivatives: got a null",
        lambda h: h("GetRealOutputDerivatives", uints([60 << 24]), 1, ints([1]), None),
    ),
    (PHASES, "fmi2SetDebugLogging: got a null", lambda h: h("SetDebugLogging", 1, 2, None)),
    (ALIVE, "value reference 0: this scene has no such", lambda h: h("GetReal", uints([0]), 1, doubles([0]))),
    (ALIVE, "value reference 4294967295", lambda h: h("GetReal", uints([4294967295]), 1, doubles([0]))),
    (ALIVE, "value reference 1006633041", lambda h: h("GetReal", uints([60 << 24, (60 << 24) + 81]), 2, doubles([0, 0]))),
    (SETTABLE, "value reference 16777219", lambda h: h("SetReal", uints([2 << 24, (1 << 24) + 3]), 2, doubles([5, 5]))),
    (SETTABLE, "mass: is of type Real, got a call for Integer", lambda h: number(h, "mass", 1, "SetInteger", ints)),
    (SETTABLE, "solver.method: is of type Integer, got a call for Real", lambda h: number(h, "solver.method", 1.0)),
    (ALIVE, "plane.ground.contacts: is of type Integer, got a call for Real", lambda h: number(h, "plane.ground.contacts", 1.0, "GetReal")),
    (SETTABLE, "there are no Boolean variables", lambda h: number(h, "mass", 1, "SetBoolean", ints)),
    (ALIVE, "there are no String variables", lambda h: h("GetString", uints([25 << 24]), 1, (c_char_p * 1)())),
    (SETTABLE, "damping: wanted a finite number, got nan", lambda h: mixed(h, "damping", NAN)),
    (SETTABLE, "load.push.x: wanted a finite number, got inf", lambda h: mixed(h, "load.push.x", INF)),
    (SETTABLE, "gravity.y: wanted a finite number, got -inf", lambda h: mixed(h, "gravity.y", -INF)),
    (SETTABLE, "damping: wanted >= 0 N.s/m, got -1", lambda h: mixed(h, "damping", -1.0)),
    (SETTABLE, "plane.wall.friction: wanted >= 0, got -0.5", lambda h: mixed(h, "plane.wall.friction", -0.5)),
    (SETTABLE, "energy.kinetic: cannot be set", lambda h: mixed(h, "energy.kinetic", 1.0)),
    ((FRESH, INITIALIZING), "mass: wanted > 0 kg, got 0", lambda h: mixed(h, "mass", 0.0)),
    ((RUNNING,), "mass: cannot be set after initialization", lambda h: mixed(h, "mass", 2.0)),
    ((RUNNING,), "plane.wall.point.x: cannot be set", lambda h: mixed(h, "plane.wall.point.x", 2.0)),
    ((FRESH, INITIALIZING), "solver.method: wanted one of 1 auto, 2 ", lambda h: number(h, "solver.method", 99, "SetInteger", ints)),
    (SETTABLE, "load.push.x: wanted a derivative of order 1 to 3, got 4", lambda h: rates(h, "load.push.x", 4, 1.0)),
    (SETTABLE, "load.push.x: wanted a derivative of order 1 to 3, got 0", lambda h: rates(h, "load.push.x", 0, 1.0)),
    (SETTABLE, "load.push.x: wanted a finite derivative", lambda h: rates(h, "load.push.x", 1, NAN)),
    (SETTABLE, "damping: is no input", lambda h: rates(h, "damping", 1, 1.0)),
    (
        (RUNNING,),
        "damping: is no output",
        lambda h: h("GetRealOutputDerivatives", uints([h.fmu.names["damping"]]), 1, ints([1]), doubles([0])),
    ),
    *[
        (
            (RUNNING, ENDED),
            f"energy.work: wanted a derivative of order 1, got {order}",
            lambda h, order=order: h("GetRealOutputDerivatives", uints([h.fmu.names["energy.work"]]), 1, ints([order]), doubles([0])),
        )
        for order in (0, 2)
    ],
    *[((RUNNING,), "fmi2DoStep: currentCommunicationPoint", lambda h, t=t: h("DoStep", t, STEP, 1)) for t in (0.0, 0.02, NAN, INF, -INF)],
    *[((RUNNING,), "fmi2DoStep: communicationStepSize", lambda h, s=s: h("DoStep", STEP, s, 1)) for s in (0.0, -STEP, NAN, INF, -0.0)],
    ((RUNNING,), "fmi2DoStep: a step to 10.01 s goes past the stop time 10 s", lambda h: h("DoStep", STEP, 10.0, 1)),
    *[
        ((FRESH,), f"startTime: wanted a finite number, got {t}", lambda h, t=t: h("SetupExperiment", 0, 0.0, t, 0, 0.0))
        for t in (NAN, INF)
    ],
    *[
        ((FRESH,), f"tolerance: wanted a finite number > 0, got {t:g}", lambda h, t=t: h("SetupExperiment", 1, t, 0.0, 0, 0.0))
        for t in (NAN, -1.0, 0.0, INF)
    ],
    *[((FRESH,), f"above startTime, got {t:g}", lambda h, t=t: h("SetupExperiment", 0, 0.0, 1.0, 1, t)) for t in (NAN, 1.0, 0.5, INF)],
    (PHASES, "fmi2GetFMUstate: got a null", lambda h: h("GetFMUstate", None)),
    (PHASES, "fmi2GetFMUstate: FMUstate: wanted a state", lambda h: h("GetFMUstate", byref(c_void_p(64)))),
    (PHASES, "fmi2SetFMUstate: FMUstate: wanted a state", lambda h: h("SetFMUstate", None)),
    (PHASES, "fmi2SetFMUstate: FMUstate: wanted a state", lambda h: h("SetFMUstate", h.component)),
    (PHASES, "fmi2FreeFMUstate: FMUstate: wanted a state", lambda h: h("FreeFMUstate", byref(c_void_p(h.component)))),
    (PHASES, "fmi2SerializedFMUstateSize: FMUstate: wanted a state", lambda h: h("SerializedFMUstateSize", None, byref(c_size_t()))),
    (PHASES, "fmi2SerializeFMUstate: FMUstate: wanted a state", lambda h: h("SerializeFMUstate", None, None, 0)),
    (PHASES, "fmi2SerializeFMUstate: size: wanted", too_small),
    (PHASES, "fmi2DeSerializeFMUstate: got a null", lambda h: h("DeSerializeFMUstate", None, 8, byref(c_void_p()))),
    (PHASES, "fmi2DeSerializeFMUstate: got a null", lambda h: h("DeSerializeFMUstate", b"12345678", 8, None)),
    (PHASES, "fmi2DeSerializeFMUstate: the state is too short", lambda h: h("DeSerializeFMUstate", b"12345678", 8, byref(c_void_p()))),
    (PHASES, "fmi2DeSerializeFMUstate: the state is damaged", damaged),
    (
        PHASES,
        "fmi2GetDirectionalDerivative: not available",
        lambda h: h("GetDirectionalDerivative", uints([0]), 1, uints([0]), 1, doubles([0]), doubles([0])),
    ),
]


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
    check_random_calls(Host(rich), bring_to, ILLEGAL, seed=7, lives=300)


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


def test_a_state_of_another_scene_in_the_same_library_is_refused_though_its_size_fits(rich, tmp_path):
    stiffer = Fmu(RICH.replace({"material.stiffness": 3e3}), tmp_path / "stiffer", rich.library)
    host, other = Host(rich), Host(stiffer)
    host.begin()
    other.begin()
    foreign = other.save()
    before = host.outputs()
    assert len(other.serialized(foreign)) == len(host.serialized(host.save()))
    assert host("SetFMUstate", foreign) == ERROR
    check_message(host, "the state belongs to another scene")
    assert host.outputs() == before
    host.free()
    other.free()


def test_dead_and_foreign_handles_are_errors(rich):
    host = Host(rich)
    dead = host.component
    host.free()
    for handle in (None, dead, 64):
        for name, arguments in SIGNATURES.items():
            blanks = [0 if kind in (c_int, c_size_t) else 0.0 if kind is c_double else None for kind in arguments]
            assert getattr(rich.library, f"fmi2{name}")(handle, *blanks) == ERROR, name
        rich.library.fmi2FreeInstance(handle)


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
def test_a_step_that_no_count_of_internal_steps_can_do_is_discarded(rich, values):
    """The quotient of the step and its limit is beyond any integer, or not a number."""
    host = Host(rich, logging=True)
    host.begin(lambda h: h.set({"stiffness.face": 1e3, **values}))
    before = host.outputs()
    assert host.step(0) == DISCARD
    assert host.messages[-1][2:4] == (DISCARD, b"logStatusDiscard")
    assert host.outputs() == before
    host.must("Reset")
    host.free()
