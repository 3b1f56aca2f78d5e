"""The numpy twin beside the component: the same variables, the same motion to rounding."""

import subprocess
import sys

import numpy as np
import pytest

from readings import points, vector
from softffd import simulate
from softffd.errors import FmuError
from softffd.fmu.component import Component
from softffd.fmu.package import package_fmu
from twin_scenes import CONTACT, SMOOTH, conveyor, drop, free, held_in_contact, press, tumble
from validation.twin import build_twin

pytest.importorskip("pythonfmu", reason="the twin is packaged with pythonfmu")


@pytest.fixture(autouse=True)
def path_restored():
    """A running twin puts its folder on the path and leaves it there."""
    kept = list(sys.path)
    yield
    sys.path[:] = kept


@pytest.fixture
def both(tmp_path):
    """both(scene, inputs, start values, share of the run) runs component and twin alike and returns their results."""

    def run(scene, inputs=None, start=None, share=1.0):
        times = {"step": scene.experiment.communication_step, "stop_time": share * scene.experiment.stop_time}
        twin = build_twin(scene, tmp_path / "twin.fmu")
        theirs, ours = (simulate(each, inputs=inputs, start_values=start, **times) for each in (twin, scene))
        return ours, theirs

    return run


def parting(component, twin):
    """The largest difference of a coordinate at each communication point (T,) [m]."""
    return np.abs(component.positions - twin.positions).max(axis=(1, 2, 3, 4))


def described(description):
    """What a description says of each variable that the twin shares, by name."""
    shown = {}
    for v in description.modelVariables:
        if v.causality != "output" or not v.name.startswith(("energy.", "solver.")):
            shown[v.name] = (v.valueReference, v.type, v.causality, v.variability, v.initial, v.unit, v.start, v.min)
    return shown


def test_the_twin_has_the_components_variables(tmp_path):
    scene = press(forces="x+", energy=True, outputs={"solver": True}, velocities="all")
    own, twins = package_fmu(scene, tmp_path / "component.fmu"), build_twin(scene, tmp_path / "twin.fmu")
    with Component(own) as component, Component(twins) as twin:
        assert described(twin.description) == described(component.description)
        assert len(twin.description.modelVariables) == len(described(component.description)) > 400


def test_the_twin_is_a_valid_fmu(tmp_path):
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(build_twin(press(points=[2, 2, 2]), tmp_path / "twin.fmu"))) == []


def whole_and_half(names, *halved):
    """Runs of all scenes, and of some of them the first half."""
    cases = [(name, 1.0) for name in names] + [(name, 0.5) for name in halved]
    return pytest.mark.parametrize(("name", "share"), cases, ids=[f"half of {name}" if share < 1 else name for name, share in cases])


@pytest.mark.short("half of *", "regions*", "a pin*", "a spin*", "pins of a body that is*", "masses*")
@whole_and_half(SMOOTH, "damped", "stiff, under held forces", "a probe in B-splines", "two materials by their modulus", "pins, one moving")
def test_smooth_motions_agree_to_rounding(both, name, share):
    scene, inputs, tolerance, *start = SMOOTH[name]
    component, twin = both(scene, inputs, *start, share=share)
    assert np.ptp(points(component), axis=0).max() > 1e-3  # it moves
    assert parting(component, twin).max() < tolerance
    for output, values in component.outputs.items():
        allowed = tolerance * (1e3 if output.startswith(("velocity", "pin", "plane")) else 1)
        assert np.abs(values - twin.outputs[output]).max() < allowed, output


@pytest.mark.short("half of conveyor that turns", "drop with friction", "half of plane that jumps")
@whole_and_half(CONTACT, "conveyor that turns", "plane that jumps", "press")
def test_motions_in_contact_agree_to_the_end(both, name, share):
    """Impacts and friction leave less than they find; rounding is not multiplied as it is in a fast tumble.

    Measured: 1e-12 m by the published rule, 1e-14 m otherwise, 1e-10 N. Asserted: a hundred times the first,
    and 1e4 N/m times that.
    """
    component, twin = both(*CONTACT[name], share=share)
    held = [f"pin.grip.{what}" for what in ("reaction", "torque") if "pin.grip.reaction.x" in component.outputs]
    assert component.outputs["plane.ground.contacts"].max() >= 4
    assert parting(component, twin).max() < 1e-10
    for plane in component.plane_names():
        for output in (f"plane.{plane}.reaction", f"plane.{plane}.torque", *held):
            assert np.abs(vector(component, output)).max() > 1
            assert vector(twin, output) == pytest.approx(vector(component, output), abs=1e-6), output
        pressed = np.linalg.norm(vector(component, f"plane.{plane}.reaction"), axis=1) > 1e-3
        centres = [vector(run, f"plane.{plane}.centre")[pressed] for run in (twin, component)]
        assert centres[0] == pytest.approx(centres[1], abs=1e-6)
        assert np.array_equal(twin.outputs[f"plane.{plane}.contacts"], component.outputs[f"plane.{plane}.contacts"])


@pytest.mark.full
def test_a_fast_tumble_parts_them_no_sooner_than_rounding_parts_the_component_from_itself(both):
    """Undamped, at 9 rad/s, landing on one corner after another: differences grow 1e5-fold in 2 s.

    Measured: 2e-13 m at 1.5 s, 1e-11 m at 2 s, 4e-10 m at 2.6 s. Asserted with room for the rounding of
    another compiler or numpy.
    """
    component, twin = both(tumble())
    shifted = points(simulate(tumble(1e-13))) - [1e-13, 0.0, 0.0]
    own = np.abs(points(component) - shifted).max(axis=(1, 2))
    apart, time = parting(component, twin), component.time
    assert apart[time <= 1.5].max() < 1e-11
    assert apart[time <= 2.0].max() < 1e-9
    assert own[time > 2.3].max() > 1e3 * 1e-13  # chaos: the component leaves itself
    assert np.all(apart <= 1e-12 + 10 * np.maximum.accumulate(own))


def test_values_changed_between_steps_act_alike(tmp_path):
    changes = {
        5: {"gravity.x": 3.0, "stiffness.face": 500.0},
        15: {"damping": 2.0},
        25: {"plane.ground.friction": 0.0},
        35: {"stiffness.edge": 4e3, "damping": 0.0},
    }
    course = []
    for fmu in (package_fmu(drop(), tmp_path / "component.fmu"), build_twin(drop(), tmp_path / "twin.fmu")):
        with Component(fmu) as component:
            component.initialize({"mass": 2.0, "plane.ground.point.z": 0.05}, start_time=3.0)
            component.exit_initialization()
            read = component.block([v.name for v in component.variables("output")])
            rows = []
            for n in range(45):
                component.set_start_values(changes.get(n, {}))
                component.do_step(3.0 + n * 0.01, 0.01)
                read.get()
                rows.append(read.values.copy())
            course.append(np.array(rows))
    assert course[1] == pytest.approx(course[0], abs=1e-8)


@pytest.mark.short("0.4")
@pytest.mark.parametrize("seconds", [0.4, 1.0])
def test_without_a_given_step_the_twin_takes_a_stable_one(both, seconds):
    """Steps near the stability bound, different ones: they differ by their errors, 8e-4 m of the twin and 2e-4 m of the component."""
    component, twin = both(drop(step=0.0, stop_time=seconds))
    assert 1e-9 < parting(component, twin).max() < 1e-3


def test_a_reset_twin_runs_again_alike(tmp_path):
    with Component(build_twin(drop(), tmp_path / "twin.fmu")) as twin:
        ends = []
        for _ in range(2):
            twin.initialize({})
            twin.exit_initialization()
            for n in range(30):
                twin.do_step(n * 0.01, 0.01)
            ends.append(twin.block([v.name for v in twin.variables("output")]).get().copy())
            twin.reset()
    assert np.array_equal(*ends)


def test_a_pin_behind_a_plane_is_refused(both):
    with pytest.raises(FmuError, match="a pin holds a control point behind a plane"):
        both(held_in_contact(), lambda time: {"pin.grip.position.z": 1.05 - 4 * time})


def test_a_method_that_the_twin_has_not_is_refused(tmp_path):
    with Component(build_twin(drop("dop853"), tmp_path / "twin.fmu")) as twin:
        twin.initialize({})
        with pytest.raises(FmuError, match="the twin has auto, leapfrog, central_difference, got dop853"):
            twin.exit_initialization()


def test_a_point_between_two_planes_is_refused(both):
    wall = {"name": "wall", "point": [1.0, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]}
    with pytest.raises(FmuError, match="two planes hold one control point"):
        both(conveyor(wall))


def test_a_motion_that_blows_up_is_reported(both):
    with pytest.raises(FmuError, match=r"not finite: solver.step is too long"):
        both(free(step=1e-2, stop_time=5.0))


ALONE = """
import gc, sys
sys.modules["softffd"] = None
import fmpy
for _ in range(int(sys.argv[2])):
    result = fmpy.simulate_fmu(sys.argv[1], stop_time=0.05, output=["position[0,0,0].z"])
    gc.collect()
print(len(result), result["position[0,0,0].z"][-1])
"""


@pytest.mark.short("4")
@pytest.mark.parametrize("times", [4, 12])
def test_the_twin_runs_without_the_package_and_many_times(tmp_path, times):
    twin = build_twin(drop(), tmp_path / "twin.fmu")
    done = subprocess.run([sys.executable, "-c", ALONE, twin, str(times)], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    rows, height = done.stdout.split()
    assert int(rows) >= 5
    assert 0.15 < float(height) < 0.25
