"""Control points on rigid frames: fixed, led along a path, turned; and the forces on their fixtures."""

import numpy as np
import pytest

import reference
from readings import points, vector, velocities
from scenes import GRAVITY, LED, box
from softffd import FmuError, Simulation, simulate
from softffd.rotation import turned

PLACED = {"origin": [0.2, -0.3, 0.4], "size": [0.6, 0.9, 1.2]}
HAND = {"name": "hand", "points": "x-", **LED}


CENTROID = np.array([0.2, 0.15, 1.0])
HELD = np.arange(64) % 4 == 0
REST = reference.rest_lattice(**PLACED)
METHODS = ["leapfrog", "auto", "central_difference"]


def place(time):
    return CENTROID + np.array([0.3 * np.sin(4 * time), 0.2 * time, 0.1 * (1 - np.cos(5 * time))])


def path(time):
    """Position over time; the velocity that leads from one communication point to the next is derived from it."""
    return {f"pin.hand.position.{axis}": value for axis, value in zip("xyz", place(time), strict=True)}


SPIN = np.array([0.5, -1.0, 2.0])


def spin(time):
    """Orientation and angular velocity of a frame that turns evenly."""
    rate = np.linalg.norm(SPIN)
    quaternion = 3.0 * np.array([np.cos(0.5 * rate * time), *(np.sin(0.5 * rate * time) * SPIN / rate)])  # of any length
    pose = {f"pin.hand.orientation.{c}": value for c, value in zip("wxyz", quaternion, strict=True)}
    return pose | {f"pin.hand.angular_velocity.{axis}": value for axis, value in zip("xyz", SPIN, strict=True)}


def hanging(*, damping=2.0, method="leapfrog", step=5e-4):
    """A box of 2 kg on a hook."""
    hook = [{"name": "hook", "points": "z+"}]
    return box(mass={"total": 2.0}, stiffness=1e3, damping=damping, gravity=GRAVITY, pin=hook, method=method, step=step, stop_time=4.0)


def held(*, damping=0.0, method="leapfrog", hand=HAND, **keys):
    """A box in a hand."""
    keys = {"gravity": GRAVITY, "velocities": "all", "stop_time": 0.5, **keys}
    return box(lattice=PLACED, stiffness=1e3, damping=damping, pin=[hand], method=method, step=5e-4, **keys)


@pytest.mark.parametrize(("method", "step"), [*((method, 5e-4) for method in METHODS), ("leapfrog", 0.0)])
def test_a_box_hangs_in_equilibrium_and_the_pin_carries_its_weight(method, step):
    result = simulate(hanging(method=method, step=step), step=0.5)
    assert vector(result, "pin.hook.reaction")[-1] == pytest.approx([0, 0, -2 * 9.81], abs=1e-8)
    assert vector(result, "pin.hook.torque")[-1] == pytest.approx([0, 0, 0], abs=1e-8)
    assert np.array_equal(points(result)[:, 48:], np.broadcast_to(points(result)[0, 48:], (9, 16, 3)))
    x = points(result)[-1]
    force = reference.cube(stiffness=1e3).spring_force(x) + np.array([0.0, 0.0, -2 * 9.81 / 64])
    assert np.abs(force[:48]).max() < 1e-8
    assert x[:16, 2].max() < 0  # it hangs down


def test_an_undamped_hanging_box_swings_about_its_equilibrium():
    """The reference with the held points put back after every step is the same recurrence."""
    result = simulate(hanging(damping=0.0), stop_time=0.5)
    model = reference.cube(stiffness=1e3, total=2.0)
    free = (np.arange(64) < 48)[:, None]
    gravity = np.array([0.0, 0.0, -2 * 9.81 / 64])
    x, half = model.rest, 0.5 * 5e-4 * free * (gravity / model.mass[:, None])
    for _ in range(1000):
        x = x + 5e-4 * half
        half = half + 5e-4 * free * (model.spring_force(x) + gravity) / model.mass[:, None]
    assert points(result)[-1] == pytest.approx(x, abs=1e-12)


def led_motion(time):
    """Of the held points along the path: places (T, h, 3) [m], velocities in each communication step (T - 1, h, 3) [m/s]."""
    frame = np.array([place(t) for t in time])
    speed = np.diff(frame, axis=0) / np.diff(time)[:, None]  # constant over each
    return REST[HELD] - CENTROID + frame[:, None], np.broadcast_to(speed[:, None], (len(speed), HELD.sum(), 3))


def turned_motion(time):
    """Likewise, with velocities at the start too (T, h, 3)."""
    places = np.array([turned(REST[HELD] - CENTROID, SPIN * t) for t in time])
    return places + CENTROID, np.cross(SPIN, places)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("inputs", "motion", "rounding"), [(path, led_motion, (2e-15, 1e-12)), (spin, turned_motion, (1e-14, 1e-13))], ids=["led", "turned"]
)
def test_held_points_move_with_the_frame_which_takes_exactly_the_momentum_that_is_missing(inputs, motion, rounding, method):
    """Sum of reaction H = M g T - (P(T) - P(0)), with every change of the frame's velocity between steps included."""
    result = simulate(held(method=method), inputs=inputs)
    places, speeds = motion(result.time)
    assert points(result)[:, HELD] == pytest.approx(places, abs=rounding[0])
    assert np.abs(points(result)[:, ~HELD] - REST[~HELD]).max() > 0.1  # the others follow
    if method != "central_difference":
        assert velocities(result)[-len(speeds) :, HELD] == pytest.approx(speeds, abs=rounding[1])
        momentum = velocities(result).mean(axis=1)
        received = np.cumsum(0.01 * vector(result, "pin.hand.reaction"), axis=0)
        assert received == pytest.approx(np.outer(result.time, [0, 0, -9.81]) - (momentum - momentum[0]), abs=1e-12)


def test_a_frame_that_turns_steadily_ends_in_rigid_rotation():
    result = simulate(held(damping=0.5, gravity=[0.0, 0.0, 0.0]), inputs=spin, stop_time=2.0)
    radius = np.linalg.norm(points(result)[-100:] - CENTROID, axis=2)
    assert np.ptp(radius, axis=0).max() < 1e-3  # seen from the frame nothing moves any more


def test_the_pin_takes_exactly_the_momentum_that_is_missing_with_damping():
    result = simulate(held(damping=0.3), inputs=path, step=5e-4)
    total = velocities(result).sum(axis=1)
    # velocities at the start of a step are those of the frame in that step, which follow from the path
    start = velocities(result)[:-1].copy()
    start[:, HELD] = led_motion(result.time)[1]
    drag = 0.3 * 5e-4 * (start.sum(axis=1) + total[1:]) / 2
    missing = 5e-4 * np.array([0, 0, -9.81]) - drag - (total[1:] - total[:-1]) / 64
    assert 5e-4 * vector(result, "pin.hand.reaction")[1:] == pytest.approx(missing, abs=1e-13)


@pytest.mark.parametrize("material", [{"stiffness": 1e7}, {"model": "solid", "youngs_modulus": 1e8}])
@pytest.mark.parametrize("centre", [[0.5, 0.5, 0.0], [2.5, 0.5, 0.0]])
def test_a_stiff_body_with_internal_damping_that_a_pin_turns_steadily_feels_no_torque_and_loses_no_energy(centre, material):
    rate, step, middle = 3.0, 0.1, np.array([0.5, 0.5, 0.5])
    axis, arm = np.array([0.0, 0.0, rate]), middle - centre
    hand = {"name": "hand", "points": "z-", "motion": "input", "origin": centre, "inputs": ["orientation", "angular_velocity"]}
    scene = box(mass={"total": 1.0}, material={"internal_damping": 1e-5, "damping": 0.0, **material}, pin=[hand], velocities="all",
                energy=True, initial={"velocity": list(np.cross(axis, arm)), "angular_velocity": list(axis)})  # fmt: skip

    def turning(time):
        half = 0.5 * rate * time
        pose = dict(zip([f"pin.hand.orientation.{c}" for c in "wxyz"], (np.cos(half), 0.0, 0.0, np.sin(half)), strict=True))
        return pose | {"pin.hand.angular_velocity.z": rate}

    result = simulate(scene, inputs=turning, stop_time=0.5, step=step)
    momentum = velocities(result).mean(axis=1)  # of 1 kg
    right = np.cross(axis, points(result) - centre)
    turned_momentum = 1.25 * rate / 4.5 + rate * (arm @ arm - 0.25)
    assert abs(velocities(result) - right).max() < 2e-3 * abs(right).max()
    assert vector(result, "pin.hand.reaction")[1:] == pytest.approx(-np.diff(momentum, axis=0) / step, abs=1e-9)
    assert abs(vector(result, "pin.hand.torque")[1:, 2]).max() < 2e-3 * turned_momentum * rate
    kinetic = result.outputs["energy.kinetic"]
    assert np.ptp(kinetic) < 3e-3 * kinetic[0]
    assert abs(result.outputs["energy.dissipated"][-1]) < 2e-3 * kinetic[0]


def test_the_torque_that_turns_a_stiff_body_faster_is_of_second_order_in_implicit_steps():
    right = -20.0 * (1 + 5 / 18)  # 20 rad/s2 times the moment of inertia of 1 kg about an axis at 1 m from the middle
    hand = {"name": "hand", "points": "z-", "motion": "input", "origin": [1.5, 0.5, 0.0], "inputs": ["angular_velocity"]}
    off = []
    for steps in (10, 20, 40):
        scene = box(stiffness=1e6, internal_damping=1e-4, damping=0.0, mass={"total": 1.0}, pin=[hand], method="sdirk2", step=0.2 / steps)
        with Simulation(scene) as sim:
            sim.set_rates({"pin.hand.angular_velocity.z": 20.0})
            sim.step(0.2)
            off.append(abs(sim["pin.hand.torque"][2] - right))
    assert off[0] < 1e-3 * abs(right)
    assert np.log2(np.divide(off[:-1], off[1:])) == pytest.approx([2.0, 2.0], abs=0.15)


def test_the_torque_on_the_fixture_balances_the_weight_of_a_cantilever():
    result = simulate(held(damping=0.8, hand={"name": "hand", "points": "x-"}), stop_time=6.0, step=0.5)
    lever = points(result)[-1].mean(axis=0) - CENTROID
    assert vector(result, "pin.hand.reaction")[-1] == pytest.approx([0, 0, -9.81], abs=1e-8)
    assert vector(result, "pin.hand.torque")[-1] == pytest.approx(np.cross(lever, [0, 0, -9.81]), abs=1e-8)
    assert lever[0] > 0.25


def test_a_pinned_point_driven_into_a_plane_is_refused():
    walled = held(plane=[{"name": "wall", "point": [0.1, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]}])
    with pytest.raises(FmuError, match=r"a control point of pin\.hand is behind plane\.wall"):
        simulate(walled, inputs=lambda time: {"pin.hand.position.x": 0.2 - time})
