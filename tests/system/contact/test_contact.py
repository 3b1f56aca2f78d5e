"""Contact with obstacle planes: no penetration, exact balance of momentum, planes that move, several planes at once."""

import numpy as np
import pytest

import reference
from readings import assert_nothing_is_behind, gaps, plane_poses, points, vector, velocities
from scenes import GRAVITY, MOVED, box
from softffd import FmuError, simulate
from softffd.rotation import turned
from stepping import Stepper

FREE = {"gravity": [0.0, 0.0, 0.0]}
EACH_STEP = {"velocities": "all", "method": "leapfrog", "step": 5e-4, "communication_step": 5e-4}


def bouncing(*, internal=0.0, damping=0.0, method="leapfrog", **arguments):
    thrown = {"offset": [0.0, 0.0, 0.1], "velocity": [1.0, 0.5, 0.0], "angular_velocity": [1.0, 2.0, 0.5]}
    keys = {"plane": [{"name": "ground", "friction": 0.4}], "velocities": "all", "method": method, "step": internal}
    result = simulate(box(stiffness=2e3, damping=damping, gravity=GRAVITY, **thrown, **keys), **arguments)
    assert_nothing_is_behind(result)
    return result


def lifted(*, gravity=GRAVITY, stiffness=2e3, height=-0.05, **motion):
    """A box over a lift that moves like this."""
    lift = {"name": "lift", "point": [0.0, 0.0, height], "friction": 0.5, **motion}
    return box(stiffness=stiffness, damping=0.05, gravity=gravity, plane=[lift], stop_time=0.5, **EACH_STEP)


def thrown_at(planes, **keys):
    """A box among planes, with every internal step to be looked at."""
    return box(**{"stiffness": 2e3, "plane": planes, "stop_time": 3.0, **EACH_STEP, **keys})


def corner(friction):
    normals = {"left": [1.0, 0.0, 0.0], "back": [0.0, 1.0, 0.0], "ground": [0.0, 0.0, 1.0]}
    return [{"name": name, "normal": normal, "friction": friction} for name, normal in normals.items()]


def cornered(*, friction, damping=0.5):
    result = simulate(thrown_at(corner(friction), damping=damping, gravity=[-3.0, -4.0, -9.81], offset=[0.05, 0.03, 0.1]))
    assert_nothing_is_behind(result)
    return result


def squeezed():
    press = {"name": "press", "point": [0.0, 0.0, 1.0], "normal": [0.0, 0.0, -1.0], "velocity": [0.0, 0.0, -0.5]}
    side = {"name": "side", "point": [-0.05, 0.0, 0.0], "normal": [1.0, 0.0, 0.1]}
    return box(stiffness=1e3, damping=0.1, plane=[{"name": "table"}, press, side], method="leapfrog", stop_time=1.6)


def reactions(result):
    return sum(vector(result, f"plane.{name}.reaction") for name in result.plane_names())


def test_a_box_at_rest_presses_with_its_weight():
    result = bouncing(damping=3.0, stop_time=5.0)
    assert vector(result, "plane.ground.reaction")[-1] == pytest.approx([0, 0, -9.81], abs=1e-6)
    assert result.outputs["plane.ground.contacts"][-1] == 16


def test_the_impulses_on_the_plane_are_the_momentum_that_the_body_lost():
    """Sum of reaction H = M (g T - (v(T) - v(0))), component by component, to rounding."""
    result = bouncing()
    momentum = velocities(result).mean(axis=1)  # 1 kg
    lost = np.outer(result.time, [0.0, 0.0, -9.81]) - (momentum - momentum[0])
    received = np.cumsum(0.01 * vector(result, "plane.ground.reaction"), axis=0)
    assert np.abs(received[-1, 2]) > 5
    assert received == pytest.approx(lost, abs=1e-12)


def test_the_torque_impulses_are_the_angular_momentum_that_the_body_lost():
    """About the plane's point; gravity's own torque is summed at every internal step."""
    place = {"plane.ground.point.x": 0.7, "plane.ground.point.y": -0.3}
    result = bouncing(internal=2e-4, step=2e-4, stop_time=0.4, start_values=place)
    x, v = points(result) - np.array([0.7, -0.3, 0.0]), velocities(result)
    turning = np.cross(x, v).sum(axis=1) / 64
    by_gravity = np.cross(x.mean(axis=1), [0.0, 0.0, -9.81])
    by_gravity = np.cumsum(1e-4 * (by_gravity + np.roll(by_gravity, 1, axis=0)), axis=0)
    lost = by_gravity - by_gravity[0] - (turning - turning[0])
    received = np.cumsum(2e-4 * vector(result, "plane.ground.torque"), axis=0)
    # an impact within a step is booked at the point's place at the step's end, a step's travel (2e-4 m) away at most
    assert np.abs(received[-1]).max() > 0.5
    assert received == pytest.approx(lost, abs=3e-4)


@pytest.mark.parametrize("method", ["leapfrog", "auto"])
def test_at_every_internal_step_momentum_balances_with_damping_and_no_point_is_behind_the_ground(method):
    """Damping takes h d (v_n + v_{n+1}) / 2, the centred difference of eq. (13)."""
    h, d = 5e-4, 0.4
    result = bouncing(method=method, damping=d, internal=h, step=h)
    total = velocities(result).sum(axis=1)
    gained = (total[1:] - total[:-1]) / 64
    drag = d * (total[1:] + total[:-1]) / 2
    expected = h * (np.array([0.0, 0.0, -9.81]) - drag - vector(result, "plane.ground.reaction")[1:])
    assert gained == pytest.approx(expected, abs=1e-13)
    assert gaps(result, "ground").min() >= -1e-15 and (gaps(result, "ground") == 0).sum() > 500  # they did touch


def test_reactions_are_means_over_the_communication_step():
    fine, coarse = (bouncing(damping=0.1, internal=2.5e-4, step=length) for length in (5e-3, 2e-2))
    means = vector(fine, "plane.ground.reaction")[1:].reshape(-1, 4, 3).mean(axis=1)
    assert vector(coarse, "plane.ground.reaction")[1:] == pytest.approx(means, abs=1e-11)


@pytest.mark.parametrize(
    "motion",
    [
        {"velocity": [0.2, 0.0, 0.4]},
        {"angular_velocity": [0.0, -0.8, 0.0]},
        {"velocity": [0.0, 0.1, 0.3], "angular_velocity": [0.3, -0.4, 0.5]},
    ],
    ids=["lift", "tilt", "screw"],
)
def test_points_in_contact_have_the_velocity_of_the_plane(motion):
    result = simulate(lifted(**motion))
    assert_nothing_is_behind(result)
    places, normals = plane_poses(result, "lift")
    turn = np.array([result.parameters[f"plane.lift.angular_velocity.{axis}"] for axis in "xyz"])
    speed = np.array([result.parameters[f"plane.lift.velocity.{axis}"] for axis in "xyz"])
    material = speed + np.cross(turn, points(result) - places[:, None])
    closing = np.einsum("tnc,tc->tn", velocities(result) - material, normals)
    touching = gaps(result, "lift") <= 1e-12
    held = touching[:-2] & touching[1:-1] & touching[2:]  # in contact before and after: not leaving
    assert held.sum() > 1000
    assert np.abs(closing[1:-1][held]).max() < 1e-10  # rounding of gaps, 1e-16 m, over a step of 5e-4 s, and of rotations
    assert closing[touching].min() > -1e-10


def lift_raised(time):
    return {"plane.lift.point.x": 0.2 * time, "plane.lift.point.z": 0.4 * time - 0.05}


def lift_turned(time):
    normal = turned(np.array([0.0, 0.0, 1.0]), np.array([0.3, -0.4, 0.5]) * time)
    named = {"normal": normal, "angular_velocity": (0.3, -0.4, 0.5)}
    return {f"plane.lift.{what}.{c}": v for what, values in named.items() for c, v in zip("xyz", values, strict=True)}


@pytest.mark.parametrize(
    ("motion", "moved", "inputs"),
    [({"velocity": [0.2, 0.0, 0.4]}, {"motion": "input"}, lift_raised), ({"angular_velocity": [0.3, -0.4, 0.5]}, MOVED, lift_turned)],
    ids=["raised", "turned"],
)
def test_a_plane_moved_by_input_is_the_plane_of_the_scene(motion, moved, inputs):
    fixed, led = simulate(lifted(**motion), step=5e-3), simulate(lifted(**moved), step=5e-3, inputs=inputs)
    assert_nothing_is_behind(led)
    assert points(led) == pytest.approx(points(fixed), abs=1e-11)  # poses differ by the rounding of their sums
    assert vector(led, "plane.lift.reaction") == pytest.approx(vector(fixed, "plane.lift.reaction"), abs=1e-7)


def test_a_plane_that_jumps_into_the_body_moves_points_without_giving_them_velocity():
    with Stepper(lifted(motion="input", stiffness=0.0, **FREE)) as stepper:
        stepper.step(5e-4)
        stepper.set({"plane.lift.point.z": 0.05})
        stepper.step(5e-4)
        assert stepper.points()[:16, 2] == pytest.approx(np.full(16, 0.05), abs=1e-15)
        assert stepper.points()[16:, 2].min() > 0.3
        assert np.all(stepper.point_velocities() == 0)
        assert np.all(stepper.vector("plane.lift.reaction") == 0)


def test_a_jump_compresses_the_springs_which_then_push_back():
    h = 5e-4
    with Stepper(lifted(motion="input", **FREE)) as stepper:
        jumped = stepper.points()
        jumped[:16, 2] = 0.05
        stepper.set({"plane.lift.point.z": 0.05})
        stepper.step(h)
        x, v, reaction = stepper.points(), stepper.point_velocities(), stepper.vector("plane.lift.reaction")
    model, share = reference.cube(stiffness=2e3, damping=0.05), 0.05 * 64 * h / 2
    before = 32 * h * model.spring_force(jumped)  # half a kick of leapfrog, then the next one where the points are now
    after = ((1 - share) * before + 64 * h * model.spring_force(x)) / (1 + share)
    assert x[:16, 2] == pytest.approx(np.full(16, 0.05), abs=1e-15) and np.all(v[:16, 2] == 0)
    assert x[16:] == pytest.approx((jumped + h * before)[16:], abs=1e-15)
    assert v[16:] == pytest.approx((0.5 * (before + after))[16:], abs=1e-12)  # up to 12 m/s; rounding
    assert -reaction[2] == pytest.approx(-0.5 * (model.spring_force(jumped) + model.spring_force(x))[:16, 2].sum(), rel=1e-9)


def test_a_plane_behind_the_body_at_the_start_lifts_it_out():
    result = simulate(lifted(height=0.1))
    assert_nothing_is_behind(result)
    assert points(result)[0, :16, 2] == pytest.approx(np.full(16, 0.1), abs=1e-15)
    assert np.all(velocities(result)[0] == 0)


def test_a_box_in_a_corner_presses_on_each_wall_with_its_share_of_the_weight():
    result = cornered(friction=0.0)
    for name, share in (("left", [-3.0, 0, 0]), ("back", [0, -4.0, 0]), ("ground", [0, 0, -9.81])):
        assert vector(result, f"plane.{name}.reaction")[-1] == pytest.approx(share, abs=1e-9)
    assert np.all(np.abs(points(result)[-1, 0]) < 1e-15)
    assert np.abs(velocities(result)[-1]).max() < 1e-12


def test_friction_in_a_corner_takes_part_of_the_weight_and_no_penetration_follows():
    result = cornered(friction=0.5)
    assert reactions(result)[-1] == pytest.approx([-3.0, -4.0, -9.81], abs=1e-6)
    for name in result.plane_names():
        normal = np.array([result.parameters[f"plane.{name}.normal.{axis}"] for axis in "xyz"])
        reaction = vector(result, f"plane.{name}.reaction")
        pressing = -reaction @ normal
        rubbing = np.linalg.norm(reaction + pressing[:, None] * normal, axis=1)
        assert (rubbing - 0.5 * pressing).max() < 1e-9 * (1 + pressing.max())


def test_momentum_balances_over_several_planes():
    result = cornered(friction=0.5, damping=0.0)
    momentum = velocities(result).mean(axis=1)
    received = np.cumsum(5e-4 * reactions(result), axis=0)
    assert received == pytest.approx(np.outer(result.time, [-3.0, -4.0, -9.81]) - (momentum - momentum[0]), abs=1e-11)


def test_points_meeting_three_orthogonal_planes_lose_exactly_the_three_approaching_components():
    thrown = thrown_at(corner(friction=0.0), stiffness=0.0, damping=0.0, velocity=[-1.0, 0.5, -2.0])
    v = velocities(simulate(thrown, stop_time=0.1))[-1].reshape(4, 4, 4, 3)  # [k, j, i]
    expected = np.tile([-1.0, 0.5, -2.0], (4, 4, 4, 1))
    expected[:, :, 0, 0] = 0.0
    expected[0, :, :, 2] = 0.0
    assert np.array_equal(v, expected)


@pytest.mark.parametrize("half_angle", [20.0, 45.0, 70.0])
def test_a_groove_of_any_angle_holds_the_box_without_penetration(half_angle):
    c, s = np.cos(np.radians(half_angle)), np.sin(np.radians(half_angle))
    bottom = 0.75 - 0.5 * c / s
    sides = [
        {"name": name, "point": [0.5, 0.0, bottom], "normal": [sign * c, 0.05, s], "friction": 0.2}
        for name, sign in (("left", 1), ("right", -1))
    ]
    result = simulate(thrown_at(sides, damping=0.1, gravity=GRAVITY, offset=[0.02, 0.0, 0.8]), stop_time=1.5)
    assert_nothing_is_behind(result)
    assert result.outputs["plane.left.contacts"][-1] > 0
    assert result.outputs["plane.right.contacts"][-1] > 0


def test_a_press_crushes_the_box_without_penetration():
    result = simulate(squeezed())
    assert_nothing_is_behind(result)
    assert points(result)[-1, :, 2].max() <= 0.2 + 1e-12


def test_planes_that_close_completely_are_refused_and_leave_the_component_where_it_was():
    with Stepper(squeezed()) as stepper:
        stepper.step(0.01, times=199)
        before = stepper.points()
        with pytest.raises(FmuError, match=r"at time 1\.99 s.*no feasible position"):
            stepper.step(0.05)
        assert np.array_equal(stepper.points(), before)


@pytest.mark.short("0")
@pytest.mark.parametrize("seed", range(6))
def test_nothing_is_ever_behind_planes_in_any_motion(seed):
    """Five obstacles of random pose, motion and friction around a thrown box, looked at after every internal step."""
    draw = np.random.default_rng(seed)
    planes = []
    for number in range(5):
        normal = draw.normal(size=3)
        normal /= np.linalg.norm(normal)
        gravity = -9.81 * normal  # in the end towards the last of them
        place = 0.5 - normal * draw.uniform(0.9, 1.4)
        motion = {name: (0.3 * draw.normal(size=3)).tolist() for name in ("velocity", "angular_velocity")}
        pose = {"name": f"p{number}", "point": place.tolist(), "normal": normal.tolist()}
        planes.append({**pose, **motion, "friction": float(draw.choice([0.0, 0.3, 0.6]))})
    stiffness = float(draw.choice([0.0, 100.0, 2e3]))
    throw = {"velocity": draw.normal(size=3).tolist(), "angular_velocity": (3 * draw.normal(size=3)).tolist()}
    result = simulate(thrown_at(planes, stiffness=stiffness, damping=0.05, gravity=gravity.tolist(), **throw, stop_time=1.2))
    assert_nothing_is_behind(result)
    assert sum((gaps(result, name) <= 1e-12).sum() for name in result.plane_names()) > 200
