"""Internal damping from hardly any to far above critical: every method keeps its tolerance, or gives way and says so."""

import numpy as np
import pytest

from scenes import GRAVITY, box
from softffd import simulate
from stepping import Stepper

STIFFNESS = 1e3
FASTEST = 700.0  # rad/s; about the highest frequency of the box below
GIVES_WAY = "the method asked for is not for bodies damped like this one"


def stretched(times_frequency, **more):
    """A box of 1 kg let go of 10 % extension; its fastest mode has half of `times_frequency` as damping ratio."""
    damping = {"internal_damping": times_frequency / FASTEST}
    return box(
        stiffness=STIFFNESS, damping=0.0, material=damping, stretch=[1.1, 1.0, 1.0], outputs={"solver": True, "energy": True}, **more
    )


def end(scene, method, tolerance):
    return simulate(scene, start_values={"solver.method": method, "solver.tolerance": tolerance}).positions[-1]


@pytest.mark.short("auto-*", "leapfrog-1", "ros34pw2-1", "dop853-1")
@pytest.mark.parametrize("ratio", [0.01, 1, 30, 1000])
@pytest.mark.parametrize("method", ["auto", "leapfrog", "ros34pw2", "dop853"])
def test_the_tolerance_is_kept(method, ratio):
    if method == "dop853" and ratio == 1000:
        pytest.skip("explicit steps without stages for damping: a million of them")
    body = stretched(ratio, stop_time=0.1, communication_step=0.05)
    exact = end(body, "ros34pw2" if ratio >= 30 else "dop853", 1e-8)
    assert np.abs(end(body, method, 1e-4) - exact).max() < 1e-4


@pytest.mark.parametrize("ratio", [0.3, 100])
def test_energy_is_accounted_for(ratio):
    result = simulate(stretched(ratio, stop_time=0.1, communication_step=0.05), start_values={"solver.tolerance": 1e-5})
    energies = result.columns()
    total = energies["energy.kinetic"] + energies["energy.elastic"] + energies["energy.dissipated"]
    assert energies["energy.dissipated"][-1] > 0.01 * total[0]
    assert np.ptp(total) < 1e-3 * total[0]


@pytest.mark.parametrize(("asked", "taken"), [("bm4", "dop853"), ("rkn12", "dop853"), ("central_difference", "leapfrog")])
def test_methods_that_cannot_follow_it_give_way_and_say_so(asked, taken):
    with Stepper(stretched(0.1), start_values={"solver.method": asked}) as stepper:
        stepper.step(0.01, times=3)
        assert stepper.methods() == [(taken, GIVES_WAY)]


def test_a_dropped_box_loses_nothing_before_it_lands_and_comes_to_rest():
    body = box(
        stiffness=STIFFNESS,
        damping=0.0,
        material={"internal_damping": 3e-3},
        gravity=GRAVITY,
        offset=[0.0, 0.0, 0.1],
        plane=[{"name": "ground"}],
        outputs={"energy": True, "reactions": True},
        stop_time=1.5,
        communication_step=0.05,
    )
    result = simulate(body)
    energies, flying = result.columns(), result.time < 0.14  # 0.1 m of fall take 0.143 s
    total = energies["energy.kinetic"] + energies["energy.elastic"] + energies["energy.gravity"]
    assert np.ptp(total[flying]) < 1e-9 * total[0]
    assert energies["energy.kinetic"][-1] < 1e-6
    assert energies["plane.ground.reaction.z"][-1] == pytest.approx(-9.81, rel=1e-3)


@pytest.mark.parametrize("ratio", [100, 300])
def test_implicit_steps_are_found_where_strong_damping_makes_explicit_ones_inaccurate(ratio):
    """Turning, to 1e-6: leapfrog needs a hundred steps where implicit ones need three, though its stability asks for fewer of them."""
    body = box(
        stiffness=STIFFNESS,
        material={"internal_damping": ratio / 800},
        velocity=[0.5, 0.0, 0.0],
        angular_velocity=[0.0, 3.0, 1.0],
        outputs={"solver": True},
        stop_time=0.3,
        communication_step=0.02,
    )
    result = simulate(body, start_values={"solver.tolerance": 1e-6})
    assert result.outputs["solver.steps"][-1] < 10_000
    assert np.abs(result.positions[-1] - end(body, "ros34pw2", 1e-7)).max() < 1e-5
