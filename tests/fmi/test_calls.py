"""The C interface through fmpy: messages, states, refusals."""

import subprocess
import sys
from ctypes import byref, c_double, c_void_p
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

from callbacks import own_callbacks
from scenes import GRAVITY, MOVED, box
from softffd import FmuError, load_scene, package_fmu, simulate
from softffd.fmu.component import Component


@pytest.fixture(scope="module")
def fmu(tmp_path_factory) -> Path:
    ground = {"name": "ground", "friction": 0.4, **MOVED}
    scene = box(damping=0.05, gravity=GRAVITY, plane=[ground], offset=[0.0, 0.0, 0.1], stop_time=0.5)
    return package_fmu(scene, tmp_path_factory.mktemp("calls") / "box.fmu")


def started(fmu, **values) -> Component:
    component = Component(fmu)
    component.initialize({name.replace("__", "."): value for name, value in values.items()})
    component.exit_initialization()
    return component


@pytest.mark.parametrize(
    "name, value, message",
    [
        ("mass", -1.0, "mass: wanted > 0 kg, got -1"),
        ("mass", 0.0, "mass: wanted > 0 kg, got 0"),
        ("stiffness.edge", -2.0, "stiffness.edge: wanted >= 0 N/m, got -2"),
        ("plane.ground.point.z", float("nan"), "plane.ground.point.z: wanted a finite number, got nan"),
        ("plane.ground.normal.x", float("inf"), "plane.ground.normal.x: wanted a finite number, got inf"),
        ("solver.method", 9, "solver.method: wanted one of 1 auto, 2 central_difference, "),
        ("position[0,0,0].x", 1.0, "position[0,0,0].x: wanted an input or a parameter, got an output"),
    ],
)
def test_a_refused_value_is_named_with_what_was_wanted(fmu, name, value, message):
    with Component(fmu) as component, pytest.raises(FmuError) as error:
        component.set_start_values({name: value})
    assert message in str(error.value)


def test_a_fixed_parameter_cannot_be_set_after_initialization(fmu):
    with started(fmu) as component, pytest.raises(FmuError, match="mass: cannot be set after initialization"):
        component.set_start_values({"mass": 2.0})


def test_a_zero_normal_is_refused_by_the_step(fmu):
    with started(fmu) as component:
        component.set_start_values({"plane.ground.normal.z": 0.0})
        with pytest.raises(FmuError, match="normal is the zero vector"):
            component.do_step(0.0, 0.01)


@pytest.mark.parametrize("time, step", [(0.0, 0.0), (0.0, -1.0), (0.0, float("nan")), (0.5, 0.01), (float("inf"), 0.01)])
def test_an_impossible_step_is_refused(fmu, time, step):
    with started(fmu) as component, pytest.raises(FmuError, match="fmi2DoStep"):
        component.do_step(time, step)


def test_a_step_past_the_stop_time_is_refused(fmu):
    with Component(fmu) as component:
        component.initialize({}, stop_time=0.02)
        component.exit_initialization()
        component.do_step(0.0, 0.02)
        with pytest.raises(FmuError, match="past the stop time"):
            component.do_step(0.02, 0.01)


def test_too_much_work_is_discarded_with_the_state_kept(fmu):
    with started(fmu, stiffness__edge=1e18) as component:
        block = component.block(["position[0,0,0].z"])
        component.get(block)
        before = block.values[0]
        with pytest.raises(FmuError, match=r"discarded the step.*most_work = 5000000;"):
            component.do_step(0.0, 1.0)
        component.get(block)
        assert block.values[0] == before


def test_a_discarded_step_tells_the_last_successful_time(fmu):
    with started(fmu) as component:
        component.do_step(0.0, 0.25)
        component.set_start_values({"stiffness.edge": 1e18})
        with pytest.raises(FmuError, match="discarded"):
            component.do_step(0.25, 0.25)
        last, instance = c_double(), c_void_p(component._slave.component)
        assert component._library.fmi2GetRealStatus(instance, 2, byref(last)) == 0
        assert last.value == 0.25


def test_reset_after_an_error_runs_as_new(fmu):
    fresh = simulate(fmu, step=0.01).positions
    with Component(fmu) as component:
        with pytest.raises(FmuError):
            component.set_start_values({"mass": -1.0})
        component.reset()
        component.initialize({}, stop_time=0.5)
        component.exit_initialization()
        block = component.block(["position[3,3,3].z"])
        for row in range(50):
            component.do_step(row * 0.01, 0.01)
        component.get(block)
    assert block.values[0] == fresh[-1, 3, 3, 3, 2]


def test_unclaimed_functions_answer_with_an_error(fmu, tmp_path):
    fmpy.extract(str(fmu), unzipdir=str(tmp_path))
    description = fmpy.read_model_description(str(fmu), validate=False)
    simulation = description.coSimulation
    assert not simulation.providesDirectionalDerivative
    slave = FMU2Slave(guid=description.guid, unzipDirectory=str(tmp_path), modelIdentifier="softffd", instanceName="x")
    slave.instantiate(callbacks=own_callbacks([]))
    with pytest.raises(Exception, match="fmi2GetDirectionalDerivative"):
        slave.getDirectionalDerivative([1006632960], [16777216], [1.0])
    slave.freeInstance()


def test_a_foreign_guid_is_refused_with_a_message(fmu, tmp_path):
    fmpy.extract(str(fmu), unzipdir=str(tmp_path))
    slave = FMU2Slave(guid="{no}", unzipDirectory=str(tmp_path), modelIdentifier="softffd", instanceName="x")
    messages: list[str] = []
    with pytest.raises(Exception, match="instantiate"):
        slave.instantiate(callbacks=own_callbacks(messages))
    slave.freeLibrary()
    assert "fmuGUID: wanted {" in messages[0]


def test_a_damaged_resource_is_refused(fmu, tmp_path):
    fmpy.extract(str(fmu), unzipdir=str(tmp_path))
    resource = tmp_path / "resources" / "scene.txt"
    resource.write_text(resource.read_text().replace("friction", "frictio") + "step 0.0\n")
    description = fmpy.read_model_description(str(fmu), validate=False)
    slave = FMU2Slave(guid=description.guid, unzipDirectory=str(tmp_path), modelIdentifier="softffd", instanceName="x")
    messages: list[str] = []
    with pytest.raises(Exception, match="instantiate"):
        slave.instantiate(callbacks=own_callbacks(messages))
    slave.freeLibrary()
    assert "checksum" in messages[0]


def test_two_scenes_run_side_by_side_in_one_process(fmu):
    other = load_scene("free_vibration")
    alone = simulate(fmu).positions
    with Component(fmu) as box:
        box.initialize({}, stop_time=0.5)
        box.exit_initialization()
        simulate(other)
        for row in range(50):
            box.do_step(row * 0.01, 0.01)
        block = box.block(["position[0,3,3].z"])
        box.get(block)
    assert block.values[0] == alone[-1, 0, 3, 3, 2]


def test_fmpys_own_loop_agrees_with_ours(fmu):
    values = {"solver.step": 1e-3}  # counted internal steps: rounding in the host's step lengths does not matter
    ours = simulate(fmu, step=0.01, start_values=values)
    theirs = fmpy.simulate_fmu(str(fmu), output_interval=0.01, step_size=0.01, stop_time=0.5, start_values=values)
    np.testing.assert_array_equal(theirs["position[3,3,3].z"], ours.positions[:, 3, 3, 3, 2])
    np.testing.assert_allclose(theirs["plane.ground.reaction.z"], ours.outputs["plane.ground.reaction.z"], rtol=1e-13)


def test_hundreds_of_instances_leave_memory_as_it_was(fmu, tmp_path):
    script = """
import resource, sys
import fmpy
from fmpy.fmi2 import FMU2Slave
folder = fmpy.extract(sys.argv[1], unzipdir=sys.argv[2])
guid = fmpy.read_model_description(sys.argv[1], validate=False).guid
slave = FMU2Slave(guid=guid, unzipDirectory=folder, modelIdentifier="softffd", instanceName="x")
def cycle(times):
    for _ in range(times):
        slave.instantiate()
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slave.doStep(0.0, 0.01)
        slave.fmi2FreeInstance(slave.component)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
first = cycle(300)
print(cycle(700) - first)
"""
    done = subprocess.run([sys.executable, "-c", script, fmu, tmp_path], capture_output=True, text=True, check=True)
    assert int(done.stdout.splitlines()[-1]) < 1000, "kB grown over 700 instances of some 60 kB each"


@pytest.mark.parametrize("name", ["car_drop", "incline", "stiff_bounce"])
def test_a_host_that_gives_the_scenes_stop_time_and_one_that_gives_none_end_with_the_same_bits(name, tmp_path):
    scene = load_scene(name)
    stop, step = scene.experiment.stop_time, scene.experiment.communication_step
    fmu = package_fmu(scene, tmp_path / f"{name}.fmu")
    description = fmpy.read_model_description(str(fmu))
    positions = [v.valueReference for v in description.modelVariables if v.name.startswith("position[")]
    ends = []
    for given in (stop, None):
        folder = fmpy.extract(str(fmu), unzipdir=str(tmp_path / str(given)))
        slave = FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier="softffd", instanceName="one")
        slave.instantiate()
        slave.setupExperiment(startTime=0.0, stopTime=given)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        for n in range(round(stop / step)):
            slave.doStep(n * step, step)
        ends.append(slave.getReal(positions))
        slave.freeInstance()
    assert len(positions) >= 192 and ends[0] == ends[1]
