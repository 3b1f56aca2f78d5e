"""Inputs and parameters are set by name, by part and as a whole; what cannot be set is refused."""

import numpy as np
import pytest

from host_scenes import STEP, scene, step
from softffd import FmuError, Simulation, simulate


def test_scalars_vectors_and_components_are_set(sim):
    sim["plane.plate.point.z"] = 0.9
    assert sim.plane["plate"].point[2] == 0.9
    sim["plane.plate.point.x"] = 0.5
    np.testing.assert_array_equal(sim.plane["plate"].point, [0.5, 0.0, 0.9])
    sim.plane["plate"].normal = np.array([0.0, 0.6, -0.8])
    sim["plane.plate.velocity"] = (0, 0, -1)
    sim.plane["plate"].angular_velocity = [0, 0, 2]
    sim.plane["ground"].friction = 0.7
    np.testing.assert_array_equal(sim["plane.plate.normal"], [0.0, 0.6, -0.8])
    np.testing.assert_array_equal(sim.plane["plate"].velocity, [0, 0, -1])
    assert sim["plane.plate.angular_velocity.z"] == 2 and sim["plane.ground.friction"] == 0.7
    sim.plane["plate"].velocity += (1, 0, 0)
    np.testing.assert_array_equal(sim.plane["plate"].velocity, [1, 0, -1])


def test_a_plate_that_comes_down_presses(sim):
    plate = sim.plane["plate"]
    for n in range(20):
        plate.point, plate.velocity = (0, 0, 1.2 - 2.0 * n * STEP), (0, 0, -2.0)
        step(sim)
    assert plate.reaction[2] > 10 and sim.positions[..., 2].max() <= 0.8 + 1e-12


def test_pins_move_what_they_hold(held):
    grip = held.pin["grip"]
    held["pin.grip.position.z"] = -0.1
    grip.orientation = (np.cos(0.1), 0, 0, np.sin(0.1))
    grip.velocity, grip.angular_velocity = (0, 0, -1), (0, 0, 0.5)
    np.testing.assert_allclose(grip.orientation, [np.cos(0.1), 0, 0, np.sin(0.1)])
    step(held)
    assert held.positions[0, 0, 0, 2] == pytest.approx(-0.1 - STEP)
    assert grip.reaction[2] > 0 > held.pin["wall"].reaction[2] and grip.torque.shape == (3,)
    with pytest.raises(FmuError, match="no such variable"):
        _ = held.pin["wall"].position


def test_loads_and_forces_act_on_the_points(sim):
    sim.load["push"] = (16.0, 0, 0)
    sim["load.push.y"] = 8.0
    np.testing.assert_array_equal(sim["load.push"], [16.0, 8.0, 0.0])
    sim.force[3, 3, 3] = (0, 0, 5.0)
    assert sim["force[3,3,3].z"] == 5.0 and sim.force[3, 3, 3][2] == 5.0
    step(sim)
    v = sim.velocities
    assert v[3, 0, 0, 0] > 0.1 and v[3, 3, 3, 2] > v[0, 3, 3, 2] + 0.1


def test_forces_are_set_as_a_whole_where_they_are_inputs(sim):
    forces = np.zeros((4, 4, 4, 3))
    forces[:, :, 3, 0] = np.arange(16).reshape(4, 4)
    sim.forces = forces
    assert sim["force[2,1,3].x"] == 9.0 and np.isnan(sim.forces[0, 0, 0]).all()
    forces[0, 0, 0, 2] = 1.0
    with pytest.raises(FmuError, match="zeros or NaN"):
        sim.forces = forces


def test_everything_can_be_set_before_the_first_step_then_inputs_and_tunables(sim):
    sim["mass"] = 2.0
    sim["gravity"] = (0, 0, -1.0)
    assert sim.initializing
    step(sim)
    assert not sim.initializing and sim["mass"] == 2.0
    sim["stiffness.edge"] = 2e3
    with pytest.raises(FmuError, match="mass: a fixed parameter can be set before the first step only"):
        sim["mass"] = 3.0
    step(sim)
    sim.restart()
    for _ in range(2):
        sim.initialize()  # ends the settings without a step
        assert sim.time == 0.0
        with pytest.raises(FmuError, match="fixed parameter"):
            sim["mass"] = 3.0


def test_start_values_are_numbers_words_or_vectors():
    with Simulation(scene(), start_values={"mass": "2", "solver.method": "leapfrog", "plane.plate.point": (0, 0, 1.5)}) as opened:
        assert opened["mass"] == 2.0 and opened["solver.method"] == "leapfrog" and opened.plane["plate"].point[2] == 1.5
    result = simulate(scene(), stop_time=STEP, start_values={"gravity": (0, 0, -1.0), "plane.plate.point": (0, 0, 1.5)})
    assert result.parameters["gravity.z"] == -1.0 and result.inputs["plane.plate.point.z"][0] == 1.5


@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), "fast", None])
def test_what_is_no_finite_number_is_refused_and_changes_nothing(sim, wrong):
    with pytest.raises(FmuError, match=r"plane\.plate\.point\.z: wanted a"):
        sim["plane.plate.point.z"] = wrong
    with pytest.raises(FmuError, match=r"plane\.plate\.point\.y: wanted a"):
        sim.plane["plate"].point = (0, wrong, 0)
    np.testing.assert_array_equal(sim.plane["plate"].point, [0.0, 0.0, 1.2])
    step(sim)


def test_outputs_cannot_be_set(sim):
    for name, value in (("position[0,0,0].x", 1.0), ("plane.plate.reaction", (0, 0, 1)), ("energy.work", 0.0)):
        with pytest.raises(FmuError, match="wanted an input or a parameter, got an output"):
            sim[name] = value
    with pytest.raises(FmuError, match="got an output"):
        sim.plane["plate"].reaction = (0, 0, 1.0)
    with pytest.raises(FmuError, match="got an output"):
        sim.block(["energy.work"]).set()
    step(sim)


def test_a_vector_wants_its_components(sim):
    for wrong in ((1, 2), 1.0, (1, 2, 3, 4)):
        with pytest.raises(FmuError, match=r"plane\.plate\.point: wanted 3 numbers"):
            sim.plane["plate"].point = wrong


def test_what_is_read_is_a_copy(sim):
    with pytest.raises(ValueError, match="read-only"):
        sim.positions[1, 1, 1] = 0
    point, reaction = sim.plane["plate"].point, sim.plane["ground"].reaction
    assert type(point) is np.ndarray and type(sim.load["push"]) is type(sim.force[3, 3, 3]) is type(sim["gravity"]) is np.ndarray
    before = point.copy()
    point += (0, 0, 1)
    point[0] = 5
    np.testing.assert_array_equal(sim.plane["plate"].point, before)
    sim.plane["plate"].point = point
    np.testing.assert_array_equal(sim.plane["plate"].point, point)
    sim.plane["plate"].point -= (1, 0, 0)
    assert sim["plane.plate.point.x"] == 4
    step(sim, 2)
    assert reaction[2] == 0.0 and sim.plane["ground"].reaction[2] < 0
