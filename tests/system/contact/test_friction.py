"""Coulomb friction: inclines, sliding stops, belts and turntables. A slope is the plane z = 0 under tilted gravity."""

import numpy as np
import pytest

from readings import assert_nothing_is_behind, centre, plane_poses, points, vector, velocities
from scenes import GRAVITY, box
from softffd import simulate

G = 9.81
NONE: dict = {}
BELT = {"velocity": [0.8, 0.0, 0.0]}
OBSERVED = {"velocities": "all", "method": "leapfrog"}


def on_slope(degrees, *, stiffness=2e4, speed=0.0, **arguments):
    slope = np.radians(degrees)
    keys = {"gravity": [G * np.sin(slope), 0.0, -G * np.cos(slope)], "plane": [{"name": "slope", "friction": 0.4}], "stiffness": stiffness}
    scene = box(damping=0.0, velocity=[speed, 0.0, 0.0], step=1e-4, stop_time=2.0, communication_step=0.02, **keys, **OBSERVED)
    result = simulate(scene, **arguments)
    assert_nothing_is_behind(result)
    return result, G * (np.sin(slope) - 0.4 * np.cos(slope))


def level(*, velocity=(0.0, 0.0, 0.0), floor=NONE, stiffness=1e5, damping=0.0):
    """A scene with a floor of this motion."""
    keys = {"stiffness": stiffness, "damping": damping, "velocity": velocity, "plane": [{"name": "floor", "friction": 0.3, **floor}]}
    return box(gravity=GRAVITY, energy=True, **keys, **OBSERVED)


def on_level(*, speed=0.0, floor=NONE, **arguments):
    result = simulate(level(velocity=[speed, 0.0, 0.0], floor=floor), **arguments)
    assert_nothing_is_behind(result)
    return result


def assert_friction_is_in_coulombs_disk(result, name, coefficient):
    reaction, (_, normals) = vector(result, f"plane.{name}.reaction"), plane_poses(result, name)
    pressing = -np.einsum("tc,tc->t", reaction, normals)
    rubbing = np.linalg.norm(reaction + pressing[:, None] * normals, axis=1)
    assert pressing.min() >= -1e-12  # N; rounding
    assert (rubbing - coefficient * pressing).max() <= 1e-10 * (1 + pressing.max())


@pytest.mark.parametrize("degrees", [10.0, 20.0, 21.0])
def test_below_the_friction_angle_the_box_sticks(degrees):
    result, _ = on_slope(degrees)
    assert np.abs(centre(velocities(result))[-1, 0]) < 1e-3  # the lattice rings on
    assert np.abs(points(result)[-1, :16] - points(result)[0, :16]).max() < 2e-3


@pytest.mark.parametrize("degrees", [25.0, 30.0, 35.0])
def test_above_the_friction_angle_the_box_slides_with_the_remaining_pull(degrees):
    result, acceleration = on_slope(degrees)
    assert centre(velocities(result))[-1, 0] == pytest.approx(2 * acceleration, rel=0.01)
    assert centre(points(result))[-1, 0] - 0.5 == pytest.approx(2 * acceleration, rel=0.015)


def test_points_without_springs_keep_the_invariant_of_sliding_exactly():
    """v_x + mu v_z of the centre of mass grows with g (sin - mu cos) through rest, fall and impact."""
    result, acceleration = on_slope(25.0, stiffness=0.0)
    v = centre(velocities(result))
    assert v[:, 0] + 0.4 * v[:, 2] == pytest.approx(acceleration * result.time, abs=1e-11)
    assert v[:, 1] == pytest.approx(np.zeros(len(v)), abs=0)


def test_a_sliding_lattice_keeps_the_invariant_but_for_friction_spent_sideways():
    """Points that bulge sideways turn their friction by v_y / v_x; the part along x can only be less than mu N."""
    result, acceleration = on_slope(25.0, speed=10.0)
    v = centre(velocities(result))
    spare = v[:, 0] + 0.4 * v[:, 2] - 10.0 - acceleration * result.time
    assert spare.min() > -1e-12
    assert spare.max() < 3e-5  # m/s in 2 s: (0.003)^2 / 2 of mu g


@pytest.mark.parametrize(("degrees", "speed"), [(15.0, 0.0), (25.0, 0.0), (35.0, 1.0)])
def test_friction_stays_in_coulombs_disk_at_every_internal_step(degrees, speed):
    result, _ = on_slope(degrees, speed=speed, stop_time=0.3, step=1e-4)
    assert_friction_is_in_coulombs_disk(result, "slope", 0.4)


own_and_fine_steps = pytest.mark.parametrize("step", [0.0, 5e-5], ids=["own steps", "fine steps"])
"""Fine ones resolve the ringing of the lattice, which takes a part of the energies."""


@own_and_fine_steps
def test_a_stiff_box_slides_to_a_stop_within_the_rigid_distance_and_time_and_friction_takes_its_energy(step):
    result = on_level(speed=1.5, start_values={"solver.step": step})
    distance, duration = 1.5**2 / (2 * 0.3 * G), 1.5 / (0.3 * G)
    way, speed = centre(points(result))[:, 0] - 0.5, centre(velocities(result))[:, 0]
    assert way[-1] == pytest.approx(distance, rel=1e-4)  # measured: 3.5e-5
    assert np.interp(0.5 * duration, result.time, speed) == pytest.approx(0.75, rel=1e-3)  # 2e-4
    assert np.abs(speed[result.time > 1.2 * duration]).max() < 2e-3  # the lattice rocks on, at 5e-4 m/s
    assert_friction_is_in_coulombs_disk(result, "floor", 0.3)
    if step:
        assert result.outputs["energy.dissipated"][-1] == pytest.approx(0.5 * 1.5**2, rel=5e-5)  # 6e-6; the rest is in the lattice
    assert result.outputs["energy.work"][-1] == pytest.approx(0, abs=1e-12)  # a plane at rest does no work


@own_and_fine_steps
def test_a_belt_drags_the_box_to_its_speed_and_does_twice_the_work_that_the_box_keeps(step):
    result = on_level(floor=BELT, start_values={"solver.step": step})
    speed = centre(velocities(result))[:, 0]
    assert np.interp(0.2, result.time, speed) == pytest.approx(0.2 * 0.3 * G, rel=1e-3)  # 1.2e-4
    assert speed[result.time > 0.8 / (0.3 * G) * 1.3] == pytest.approx(0.8, rel=5e-3)  # it rocks on, at 1e-3
    if step:
        assert result.outputs["energy.work"][-1] == pytest.approx(0.8**2, rel=2e-3)  # 5e-4, the last of the rocking
        assert result.outputs["energy.dissipated"][-1] == pytest.approx(0.5 * 0.8**2, rel=2e-4)  # 2.3e-5


@pytest.mark.parametrize(("spin", "friction", "damping", "rounding"), [(2.0, 1.0, 0.0, 1e-12), (0.5, 3.0, 0.2, 1e-14)])
def test_points_that_stick_move_exactly_with_the_turntable(spin, friction, damping, rounding):
    table = {"point": [0.5, 0.5, 0.0], "angular_velocity": [0.0, 0.0, spin]}
    result = simulate(
        level(floor=table, damping=damping), start_values={"plane.floor.friction": friction}, stop_time=3.0 if damping else 1.0
    )
    assert_nothing_is_behind(result)
    v, arm = velocities(result)[-1, :16], points(result)[-1, :16] - [0.5, 0.5, 0.0]
    expected = np.cross([0.0, 0.0, spin], arm)
    assert v[:, :2] == pytest.approx(expected[:, :2], abs=rounding)  # of 1.4 m/s at the corners
    assert vector(result, "plane.floor.torque")[1:10, 2].max() < 0  # the object holds the table back
    if damping:
        assert result.outputs["plane.floor.contacts"][-1] == 16 and np.abs(v[:, 2]).max() < rounding


def test_friction_opposes_the_slip_and_not_the_axes():
    thrown = level(velocity=[1.2, 0.9, 0.0], stiffness=0.0)
    v = velocities(simulate(thrown, start_values={"solver.step": 1e-3}))[:, 0]
    speed = np.hypot(v[:, 0], v[:, 1])
    moving = speed > 0.01
    assert v[moving, 1] / v[moving, 0] == pytest.approx(np.full(moving.sum(), 0.75), rel=1e-12)
    sliding = speed[moving]
    assert sliding == pytest.approx(1.5 - 0.3 * G * np.arange(len(sliding)) * 0.01, abs=1e-12)
    assert np.all(v[-1] == 0)
