"""FMU states: rolled back, moved to other instances and processes, refused when damaged."""

import subprocess
import sys
from ctypes import byref, c_char, c_double, c_size_t, c_void_p
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from callbacks import own_callbacks
from softffd import Simulation, load_scene, package_fmu
from straight_run import RICH


@pytest.fixture(scope="module", params=["leapfrog", "central_difference"])
def fmu(request, tmp_path_factory) -> Path:
    return package_fmu(RICH.replace({"solver.method": request.param}), tmp_path_factory.mktemp("state") / "box.fmu")


class Slave:
    """fmpy's slave and the few calls that the tests repeat."""

    def __init__(self, fmu: Path, folder: Path):
        fmpy.extract(str(fmu), unzipdir=str(folder))
        self.description = fmpy.read_model_description(str(fmu), validate=False)
        self.fmi = FMU2Slave(guid=self.description.guid, unzipDirectory=str(folder), modelIdentifier="softffd", instanceName="box")
        self.names = {v.name: v.valueReference for v in self.description.modelVariables}
        self.reals = [v.valueReference for v in self.description.modelVariables if v.causality == "output" and v.type == "Real"]
        self.messages: list[str] = []
        self.instantiate(callbacks=own_callbacks(self.messages))
        self.begin()

    def __getattr__(self, name: str):
        return getattr(self.fmi, name)

    def begin(self) -> None:
        self.setupExperiment()
        self.enterInitializationMode()
        self.exitInitializationMode()

    def set(self, name: str, value: float) -> None:
        self.setReal([self.names[name]], [value])

    def advance(self, first: int, last: int) -> None:
        """Steps number first to last - 1 of 10 ms, with inputs that move."""
        for n in range(first, last):
            self.set("load.push.y", 3.0 * np.sin(n))
            self.set("pin.grip.velocity.x", 0.2 + 0.01 * n)
            self.set("plane.ground.point.z", 0.001 * n)
            self.doStep(n * 0.01, 0.01)

    def outputs(self) -> list[float]:
        return self.getReal(self.reals)


@pytest.fixture
def slave(fmu, tmp_path):
    slave = Slave(fmu, tmp_path / "fmu")
    yield slave
    slave.freeInstance()


def test_a_rolled_back_run_continues_with_the_same_bits(slave):
    slave.advance(0, 20)
    state = slave.getFMUstate()
    slave.advance(20, 50)
    straight = slave.outputs()
    slave.setFMUstate(state)
    slave.advance(20, 50)
    assert slave.outputs() == straight
    slave.freeFMUstate(state)


def test_outputs_right_after_rolling_back_are_those_of_the_saved_moment(slave):
    slave.advance(0, 20)
    before, state = slave.outputs(), slave.getFMUstate()
    slave.set("stiffness.edge", 9e3)
    slave.advance(20, 25)
    slave.setFMUstate(state)
    assert slave.outputs() == before


@pytest.mark.parametrize("name, value", [("stiffness.edge", 5e3), ("damping", 0.9), ("gravity.z", -3.0)])
def test_a_pending_parameter_change_is_part_of_the_state_and_not_yet_in_effect(slave, name, value):
    slave.advance(0, 10)
    slave.set(name, value)
    before, state = slave.outputs(), slave.getFMUstate()
    slave.advance(10, 20)
    straight = slave.outputs()
    slave.setFMUstate(state)
    assert slave.outputs() == before
    slave.advance(10, 20)
    assert slave.outputs() == straight


def test_light_points_keep_the_mass_that_they_were_made_with():
    """Gravity chose it at the start; what is restored takes that one, and not the gravity of now."""
    ends = []
    with Simulation(load_scene("light_bounce")) as simulation:
        for through_state in (False, True):
            simulation.restart()
            for n in range(30):
                if n == 10:
                    simulation["gravity.z"] = -40.0
                if n == 16 and through_state:
                    simulation.restore(bytes(simulation.save()))
                simulation.step(0.01)
            ends.append(simulation.positions.copy())
    assert np.array_equal(*ends)


def test_pending_derivatives_of_inputs_are_part_of_the_state(slave):
    slave.advance(0, 10)
    slave.setRealInputDerivatives([slave.names["load.push.y"], slave.names["pin.grip.velocity.x"]], [1, 1], [500.0, 2.0])
    state = slave.getFMUstate()
    slave.advance(10, 12)
    straight = slave.outputs()
    slave.setFMUstate(state)
    slave.advance(10, 12)
    assert slave.outputs() == straight


def test_a_serialized_state_continues_in_another_instance(fmu, slave, tmp_path):
    slave.advance(0, 20)
    blob = bytes(slave.serializeFMUstate(slave.getFMUstate()))
    slave.advance(20, 50)
    other = Slave(fmu, tmp_path / "other")
    other.setFMUstate(other.deSerializeFMUstate(blob))
    other.advance(20, 50)
    assert other.outputs() == slave.outputs()
    other.freeInstance()


def test_a_serialized_state_continues_in_another_process(fmu, slave, tmp_path):
    slave.advance(0, 20)
    (tmp_path / "blob").write_bytes(bytes(slave.serializeFMUstate(slave.getFMUstate())))
    slave.advance(20, 50)
    script = f"""
import sys
sys.path[:0] = {[str(Path(__file__).parent), *sys.path]!r}
from pathlib import Path
from test_state import Slave
slave = Slave(Path({str(fmu)!r}), Path({str(tmp_path / "process")!r}))
slave.setFMUstate(slave.deSerializeFMUstate(Path({str(tmp_path / "blob")!r}).read_bytes()))
slave.advance(20, 50)
print(repr(slave.outputs()))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert eval(done.stdout.splitlines()[-1]) == slave.outputs()


def test_a_state_taken_in_initialization_mode_starts_the_same_run(fmu, slave, tmp_path):
    slave.reset()
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.set("plane.ground.point.z", -0.01)
    state = slave.getFMUstate()
    slave.exitInitializationMode()
    slave.advance(0, 20)
    straight = slave.outputs()
    slave.setFMUstate(state)
    slave.exitInitializationMode()
    slave.advance(0, 20)
    assert slave.outputs() == straight


def refused(slave: Slave, blob: bytes) -> bool:
    """Deserializing raises and the instance goes on as if nothing had been tried."""
    try:
        slave.deSerializeFMUstate(blob)
    except Exception:
        return True
    return False


def test_every_damaged_truncated_or_foreign_state_is_refused_and_harmless(slave):
    slave.advance(0, 5)
    blob, before = bytes(slave.serializeFMUstate(slave.getFMUstate())), slave.outputs()
    random = np.random.default_rng(1)
    places = [*range(0, 48), *random.integers(0, len(blob), 200)]
    assert all(refused(slave, blob[:at] + bytes([blob[at] ^ 0x10]) + blob[at + 1 :]) for at in places)
    assert all(refused(slave, blob[:size]) for size in (0, 1, 39, 40, len(blob) - 1))
    assert refused(slave, blob + b"\0") and refused(slave, bytes(len(blob)))
    assert slave.outputs() == before
    slave.advance(5, 6)


def sealed(payload: bytes, head: bytes) -> bytes:
    """A payload under a head whose checksum, FNV-1a, fits it."""
    check = 14695981039346656037
    for byte in payload:
        check = (check ^ byte) * 1099511628211 % 2**64
    return head[:32] + check.to_bytes(8, "little") + payload


@pytest.mark.parametrize("value", [-4321.5, np.inf, np.nan], ids=str)
def test_values_that_no_setter_takes_are_refused_under_a_sound_checksum(slave, value):
    slave.set("stiffness.edge", 4321.5)
    slave.advance(0, 3)
    blob, before = bytes(slave.serializeFMUstate(slave.getFMUstate())), slave.outputs()
    head, payload = blob[:40], blob[40:]
    assert sealed(payload, head) == blob
    number = np.float64(4321.5).tobytes()
    places = [at for at in range(0, len(payload), 8) if payload[at : at + 8] == number]
    assert len(places) == 2, "the value given and the value in effect"
    for at in places:
        forged = payload[:at] + np.float64(value).tobytes() + payload[at + 8 :]
        with pytest.raises(Exception, match="FMUstate"):
            slave.setFMUstate(slave.deSerializeFMUstate(sealed(forged, head)))
        assert slave.outputs() == before
    slave.advance(3, 4)


def test_a_foreign_pointer_is_refused(slave):
    number = c_double(1.0)
    assert slave.dll.fmi2SetFMUstate(c_void_p(slave.component), byref(number)) == 3
    wild = c_void_p(12345)
    assert slave.dll.fmi2FreeFMUstate(c_void_p(slave.component), byref(wild)) == 3
    slave.advance(0, 1)


def test_a_state_of_another_scene_is_refused(slave, tmp_path):
    other_fmu = package_fmu(load_scene("free_vibration"), tmp_path / "other.fmu")
    other = Slave(other_fmu, tmp_path / "other")
    blob = bytes(other.serializeFMUstate(other.getFMUstate()))
    assert refused(slave, blob)
    other.freeInstance()


def test_too_small_a_buffer_is_refused(slave):
    state = slave.getFMUstate()
    size = c_size_t()
    assert slave.dll.fmi2SerializedFMUstateSize(c_void_p(slave.component), state, byref(size)) == 0
    buffer = (c_char * size.value)()
    call = slave.dll.fmi2SerializeFMUstate
    assert call(c_void_p(slave.component), state, buffer, c_size_t(size.value)) == 0


def test_a_state_leads_out_of_the_error_state(slave):
    slave.advance(0, 3)
    state = slave.getFMUstate()
    with pytest.raises(Exception, match="fmi2DoStep"):
        slave.doStep(99.0, 0.01)
    with pytest.raises(Exception, match="fmi2DoStep"):
        slave.doStep(0.03, 0.01)
    slave.setFMUstate(state)
    slave.advance(3, 4)


def test_saving_thousands_of_states_leaves_no_trace(slave):
    for _ in range(3000):
        slave.freeFMUstate(slave.getFMUstate())
    state = slave.getFMUstate()
    for _ in range(3000):
        assert slave.dll.fmi2GetFMUstate(c_void_p(slave.component), byref(state)) == 0
