"""The same inputs give the same bits, however the run is cut and whatever runs beside it."""

import numpy as np
import pytest

from readings import points, vector
from scenes import GRAVITY, box
from softffd import simulate
from stepping import Stepper

METHODS = ["leapfrog", "auto", "central_difference"]


GROUND = {"name": "ground", "velocity": [0.1, 0.0, 0.05], "angular_velocity": [0.02, 0.01, 0.3], "friction": 0.4}
WALL = {"name": "wall", "point": [1.3, 0.0, 0.0], "normal": [-1.0, 0.0, 0.2], "velocity": [-0.3, 0.0, 0.0], "friction": 0.2}
CORNER = {"name": "corner", "points": [[0, 0, 3]]}


def lively(*, method="leapfrog", internal=2.5e-4, planes=(GROUND, WALL), pins=(CORNER,)):
    return box(
        stiffness=2e3,
        damping=0.05,
        gravity=GRAVITY,
        plane=planes,
        pin=pins,
        load=[{"name": "push", "points": "y+"}],
        offset=[0.0, 0.0, 0.1],
        velocity=[0.8, 0.3, 0.0],
        velocities="all",
        energy=True,
        outputs={"solver": True},
        method=method,
        step=internal,
        stop_time=0.6,
        communication_step=0.01,
    )


def assert_same(one, other):
    assert np.array_equal(one.positions, other.positions)
    assert one.outputs.keys() == other.outputs.keys()
    for name, values in one.outputs.items():
        assert np.array_equal(values, other.outputs[name]), name


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("internal", [2.5e-4, 0.0], ids=["fixed step", "automatic step"])
def test_a_run_repeats_to_the_bit(method, internal):
    body = lively(method=method, internal=internal, pins=())
    assert_same(simulate(body), simulate(body))


def test_two_instances_in_turn_are_two_runs():
    one = lively()
    other = lively(method="auto", internal=0.0, planes=(GROUND,), pins=())
    alone = [points(simulate(body, stop_time=0.2)) for body in (one, other)]
    with Stepper(one, stop_time=0.2) as first, Stepper(other, stop_time=0.2) as second:
        for row in range(1, 21):
            first.step(0.01)
            second.step(0.01)
            assert np.array_equal(first.positions(), alone[0][row])
            assert np.array_equal(second.positions(), alone[1][row])


def test_a_reset_instance_runs_as_a_new_one():
    with Stepper(lively()) as stepper:
        stepper.step(0.01, times=20)
        once = stepper.positions()
        stepper.set({"load.push.y": 5.0})
        stepper.step(0.01)
        stepper.restart({})
        stepper.step(0.01, times=20)
        assert np.array_equal(stepper.positions(), once)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("without", [{"planes": (), "pins": ()}, {"pins": ()}, {"planes": ()}], ids=["free", "contact", "pinned"])
def test_cutting_the_communication_step_changes_no_bit_with_a_fixed_step(method, without):
    body = lively(method=method, **without)
    push = {"load.push.y": 3.0}
    coarse, middle, fine = (points(simulate(body, step=length, start_values=push)) for length in (0.02, 0.01, 0.005))
    assert np.array_equal(coarse, middle[::2])
    assert np.array_equal(middle, fine[::2])


def test_uneven_communication_steps_change_no_bit_with_a_fixed_step():
    body = lively()
    expected = points(simulate(body))[-1]
    with Stepper(body) as stepper:
        for count in (1, 7, 300, 2, 90, 800, 1200):
            stepper.step(count * 2.5e-4)
        assert np.array_equal(stepper.positions(), expected)


def test_cutting_changes_no_bit_where_stability_shortens_the_given_step():
    """A step just below the limit at rest is too long for the stretched box, which goes to and fro between both."""
    swinging = box(stiffness=1e3, damping=0.0, stretch=[1.2, 1.0, 1.0], outputs={"solver": True}, step=1.7e-3, stop_time=0.816)
    coarse, fine = (simulate(swinging, step=length) for length in (0.0204, 0.0017))
    assert fine.outputs["solver.steps"][-1] > 480  # shortened at times, not always
    assert fine.outputs["solver.steps"][-1] < 960
    assert np.array_equal(points(coarse), points(fine)[::12])


def test_reactions_and_energies_do_not_depend_on_how_the_run_is_cut():
    body = lively()
    coarse, fine = simulate(body, step=0.02), simulate(body, step=0.005)
    for name in ("plane.ground.reaction", "plane.ground.torque", "plane.wall.reaction", "pin.corner.reaction"):
        mean = vector(fine, name)[1:].reshape(-1, 4, 3).mean(axis=1)
        assert vector(coarse, name)[1:] == pytest.approx(mean, abs=1e-9), name
    for name in ("energy.kinetic", "energy.elastic", "energy.gravity", "energy.dissipated", "energy.work"):
        assert coarse.outputs[name] == pytest.approx(fine.outputs[name][::4], abs=1e-9), name


def test_looking_at_outputs_changes_nothing():
    body = lively(internal=0.0, pins=())
    with Stepper(body) as looked, Stepper(body) as alone:
        for _ in range(30):
            looked.step(0.01)
            looked.read("solver.stable_step", "energy.elastic", "plane.ground.reaction.z")
            alone.step(0.01)
        assert np.array_equal(looked.positions(), alone.positions())
