"""Free motion of the lattice: order, equality with the published recurrence, long-time behaviour."""

import numpy as np
import pytest

import reference
from readings import orders, points, velocities
from scenes import OBSERVED, box
from softffd import simulate
from stepping import Stepper


def cube(stretch=(1.1, 1.0, 1.0), outputs=OBSERVED):
    return box(stiffness=1e3, damping=0.0, stretch=list(stretch), method="leapfrog", stop_time=1.0, communication_step=0.1, **outputs)


STRETCHED = cube()
DAMPED_AND_MOVING = box(
    stiffness={"edge": 1e3, "face": 700.0, "body": 400.0}, damping=0.05, gravity=[1.0, -2.0, -9.81], stretch=[1.1, 0.95, 1.0],
    offset=[0.3, 0.2, 0.1], velocity=[1.0, 0.0, -0.5], angular_velocity=[2.0, -1.0, 3.0], velocities="all", stop_time=0.2,
    communication_step=0.05,
)  # fmt: skip


def reference_of_damped_and_moving():
    """The model, its state at the start and its external force, assembled here from the keys above."""
    model = reference.cube(damping=0.05)
    length = np.linalg.norm(model.rest[model.springs[:, 0]] - model.rest[model.springs[:, 1]], axis=1)
    kind = np.rint((length * 3) ** 2).astype(int)  # 1, 2, 3: edge, face diagonal, body diagonal
    model = reference.Model(model.rest, model.springs, np.array([0, 1e3, 700.0, 400.0])[kind], model.mass, model.damping)
    x = model.rest * [1.1, 0.95, 1.0] + [0.3, 0.2, 0.1]
    middle = np.array([0.5, 0.5, 0.5]) * [1.1, 0.95, 1.0] + [0.3, 0.2, 0.1]
    v = np.array([1.0, 0.0, -0.5]) + np.cross([2.0, -1.0, 3.0], x - middle)
    return model, x, v, model.mass[:, None] * np.array([1.0, -2.0, -9.81])


def stretched(h, **settings):
    return simulate(STRETCHED, start_values={"solver.step": h, **settings})


def test_order_is_two_on_the_stretched_box(golden):
    stored, steps = golden("S1")["x"], [2.5e-4 / 2**n for n in range(5)]
    errors = [np.linalg.norm(points(stretched(h))[1:] - stored, axis=2).max() for h in steps]
    assert orders(errors) == pytest.approx([2.0] * 4, abs=0.1)
    assert errors[0] == pytest.approx(9.357e-3, rel=1e-3)  # of the scheme itself: the numpy reference has it too


@pytest.mark.parametrize("method", ["leapfrog", "auto", "central_difference"])
def test_damping_gravity_and_initial_motion_are_the_references_to_rounding(method):
    """In the published recurrence rounding of a position, 1e-16, is one of a velocity, 1e-16 / h; some hundreds of such add up."""
    result = simulate(DAMPED_AND_MOVING, start_values={"solver.step": 5e-4, "solver.method": method})
    model, x, v, external = reference_of_damped_and_moving()
    if method == "central_difference":
        course = reference.central_difference(model, x, v, 5e-4, 401, external=external)
        x, v, rounding = course[400], (course[401] - course[399]) / 1e-3, (1e-11, 1e-8)
    else:
        (x, v), rounding = reference.leapfrog(model, x, v, 5e-4, 400, external=external), (1e-12, 1e-10)
    assert points(result)[-1] == pytest.approx(x, abs=rounding[0])
    assert velocities(result)[-1] == pytest.approx(v, abs=rounding[1])


def test_central_difference_restarts_with_the_force_of_that_moment():
    """The stable step changes as the box swings, and the recurrence starts anew within a communication step."""
    push = {"name": "push", "points": "all"}
    swinging = box(damping=0.0, stretch=[1.3, 1.0, 1.0], load=[push], velocities="all", method="central_difference")
    with Stepper(swinging) as stepper:
        for n in range(5):
            stepper.set({"load.push.x": 2.0 * n})
            stepper.set_rates({"load.push.x": 10.0})
            stepper.step(0.2)
        assert stepper.point_velocities()[:, 0].mean() == pytest.approx(0.5 * 10, abs=1e-8)  # of 10 t N on 1 kg


def test_a_run_taken_back_by_the_reference_returns_to_its_start():
    result, model = stretched(1e-3), reference.cube()
    x, v = reference.leapfrog(model, points(result)[-1], -velocities(result)[-1], 1e-3, 1000)
    assert x == pytest.approx(points(result)[0], abs=1e-12)
    assert v == pytest.approx(np.zeros_like(v), abs=1e-10)


@pytest.mark.full
def test_a_million_steps_at_nine_tenths_of_the_bound_stay_bounded():
    quiet = cube(outputs={"energy": True, "outputs": {"positions": "none", "solver": True}})
    with Stepper(quiet) as stepper:
        step = 0.9 * stepper.read("solver.stable_step")[0]
    with Stepper(quiet, start_values={"solver.step": step}) as stepper:
        start = stepper.energy()
        totals = []
        for _ in range(200):
            stepper.step(5000 * step)
            totals.append(stepper.energy())
        steps = stepper.number("solver.steps")
    assert steps == 1_000_000  # none was shortened
    assert np.max(totals) < 1.1 * start  # the energy of the scheme's own motion differs by (h omega)^2
    assert np.min(totals) > 0.75 * start
    assert np.mean(totals[100:]) == pytest.approx(np.mean(totals[:100]), rel=0.02)  # no drift


@pytest.mark.parametrize("counts", [2, 4])
def test_the_automatic_step_does_not_feed_a_light_undamped_point(counts):
    """The bound is tight for a light point, and stable by the linear bound is not enough: near h omega = sqrt 3 and sqrt 2 every
    third or fourth step comes back in phase with the nonlinear part of the springs, and energy grows without limit."""
    light = [{"points": [[0, 0, 0]], "mass": 1e-5}]
    scene = box(lattice={"points": [counts] * 3}, stiffness=1e3, damping=0.0, region=light, stretch=[1.1, 1.0, 1.0], energy=True)
    energy = simulate(scene).outputs
    total = energy["energy.kinetic"] + energy["energy.elastic"]
    assert total.max() < 2 * total[0]


@pytest.mark.parametrize(("stretch", "share"), [([1, 1, 1], 1 / 1.2), ([1.1, 1, 1], 0.75), ([2.0, 0.7, 1], 0.75), ([3, 3, 3], 0.75)])
def test_the_stable_step_is_a_bound_and_not_much_too_short(stretch, share):
    """A stretched spring is stiff across its length as well, by k (1 - l / r)."""
    with Stepper(cube(stretch)) as stepper:
        bound = stepper.read("solver.stable_step")[0]
    exact = 2 / reference.cube().highest_frequency(reference.rest_lattice() * stretch)
    assert share * exact < bound <= exact * (1 + 1e-9)  # 0.87, 0.83, 0.76 of the stretched ones; the frequency is by differences


def test_a_given_step_beyond_stability_is_shortened_and_said_so():
    result = stretched(5e-3)
    assert np.abs(points(result)).max() < 2
    assert result.outputs["solver.steps"][-1] > 400
    (warning,) = result.summary["warnings"]
    assert "internal step 0.00125 s, a fraction of solver.step = 0.005 s, which is above the stability bound" in warning
