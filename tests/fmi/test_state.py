"""FMU states: what they hold, taken to other processes, refused when damaged. That runs go on from them with the same bits, in other
instances too, is seen by test_sequences.py.
"""

import itertools
import subprocess
import sys
import zlib
from ctypes import byref, c_void_p
from pathlib import Path

import numpy as np
import pytest

from c_host import ERROR, OK, Fmu, Host, doubles, ints, uints

METHODS = {"leapfrog": 3, "central_difference": 2}


def begun(fmu: Fmu, method: str) -> Host:
    host = fmu.host()
    assert host.set_integer("solver.method", METHODS[method]) == OK
    host.begin()
    return host


def advance(host: Host, first: int, last: int) -> bytes:
    """Steps number first to last - 1 of 10 ms, with inputs that move; the outputs after them."""
    for n in range(first, last):
        inputs = {"load.push.y": 3.0 * np.sin(n), "pin.grip.velocity.x": 0.2 + 0.01 * n, "plane.ground.point.z": 0.001 * n}
        assert host.set(inputs) == host.step(n) == OK
    return host.outputs()


@pytest.fixture(params=METHODS)
def host(request, rich_of_each):
    host = begun(rich_of_each, request.param)
    yield host
    host.free()


@pytest.mark.parametrize("name, value", [("stiffness.edge", 5e3), ("damping", 0.9), ("gravity.z", -3.0)])
def test_a_pending_parameter_change_is_part_of_the_state_and_not_yet_in_effect(host, name, value):
    advance(host, 0, 10)
    assert host.set({name: value}) == OK
    before, state = host.outputs(), host.save()
    straight = advance(host, 10, 20)
    host.must("SetFMUstate", state)
    assert host.outputs() == before
    assert advance(host, 10, 20) == straight


@pytest.mark.parametrize("method", METHODS)
def test_pending_derivatives_of_inputs_are_part_of_the_state(rich, method):
    host = begun(rich, method)
    advance(host, 0, 10)
    names = [rich.names["load.push.y"], rich.names["pin.grip.velocity.x"]]
    host.must("SetRealInputDerivatives", uints(names), 2, ints([1, 1]), doubles([500.0, 2.0]))
    state = host.save()
    straight = advance(host, 10, 12)
    host.must("SetFMUstate", state)
    assert advance(host, 10, 12) == straight
    host.free()


@pytest.mark.short("leapfrog-central_difference")
@pytest.mark.parametrize(("method", "other"), [tuple(METHODS), tuple(METHODS)[::-1]])
def test_a_serialized_state_continues_in_another_process(rich, tmp_path, method, other):
    host = begun(rich, method)
    advance(host, 0, 20)
    (tmp_path / "blob").write_bytes(host.serialized(host.save()))
    script = f"""
import sys
sys.path[:0] = {[str(Path(__file__).parent), *sys.path]!r}
from pathlib import Path
from c_host import Fmu
from straight_run import RICH
from test_state import advance, begun
host = begun(Fmu(RICH, Path({str(tmp_path / "fmu")!r})), {other!r})
host.must("SetFMUstate", host.received(Path({str(tmp_path / "blob")!r}).read_bytes()))
print(advance(host, 20, 50).hex())
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == advance(host, 20, 50).hex()
    host.free()


def test_a_state_taken_in_initialization_mode_starts_the_same_run(host):
    host.must("Reset")
    assert host.enter() == host.set({"plane.ground.point.z": -0.01}) == OK
    state, ends = host.save(), []
    for _ in range(2):
        host.must("SetFMUstate", state)
        host.must("ExitInitializationMode")
        ends.append(advance(host, 0, 20))
    assert ends[0] == ends[1]


def received(host: Host, blob: bytes) -> int:
    return host("DeSerializeFMUstate", blob, len(blob), byref(c_void_p()))


def test_every_damaged_or_truncated_state_is_refused_and_harmless_and_a_sound_one_leads_out_of_the_error_state(host):
    before = advance(host, 0, 5)
    state = host.save()
    blob = host.serialized(state)
    places = [*range(0, 80), *np.random.default_rng(1).integers(0, len(blob), 200)]
    damaged = [blob[:at] + bytes([blob[at] ^ 0x10]) + blob[at + 1 :] for at in places]
    truncated = [blob[:size] for size in (0, 1, 31, 32, 69, 70, len(blob) - 1)]
    assert all(received(host, bad) == ERROR for bad in [*damaged, *truncated, blob + b"\0", bytes(len(blob))])
    assert host.outputs() == before and advance(host, 5, 6)
    assert host("DoStep", 99.0, 0.01, 1) == host("DoStep", 0.06, 0.01, 1) == ERROR
    host.must("SetFMUstate", state)
    assert host.outputs() == before and advance(host, 5, 6)


def sealed(payload: bytes, head: bytes) -> bytes:
    """A payload under a head whose checksum, CRC-32, fits it."""
    return head[:24] + zlib.crc32(payload).to_bytes(8, "little") + head[32:] + payload


@pytest.mark.parametrize("method", METHODS)
def test_values_that_no_setter_takes_are_refused_under_a_sound_checksum(rich, method):
    host = begun(rich, method)
    assert host.set({"stiffness.edge": 4321.5}) == OK
    before = advance(host, 0, 3)
    host.set_rates({"load.push.x": 1234.5})
    blob = host.serialized(host.save())
    size = int.from_bytes(blob[16:24], "little")
    head, payload = blob[:-size], blob[-size:]
    assert sealed(payload, head) == blob
    for number, count, wrong in [(4321.5, 2, (-4321.5, np.inf, np.nan)), (1234.5, 1, (np.inf, np.nan))]:
        places = [at for at in range(0, len(payload), 8) if payload[at : at + 8] == np.float64(number).tobytes()]
        assert len(places) == count, "the stiffness given and in effect; the rate"
        for at, value in itertools.product(places, wrong):
            forged = sealed(payload[:at] + np.float64(value).tobytes() + payload[at + 8 :], head)
            assert received(host, forged) == ERROR or host("SetFMUstate", host.received(forged)) == ERROR
            assert host.outputs() == before
    advance(host, 3, 4)
    host.free()
