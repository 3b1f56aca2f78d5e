"""The energy balance closes: kinetic + elastic + gravity + dissipated - work stays what it was, to second order in the step."""

import numpy as np
import pytest

from readings import imbalance, orders, points, vector, velocities
from scenes import GRAVITY, box
from softffd import simulate

STEPS = (5e-4, 2.5e-4, 1.25e-4)

FLOOR = {"name": "floor", "friction": 0.1}


def watched(**keys):
    base = {"stiffness": 2e3, "damping": 0.0, "gravity": GRAVITY, "velocities": "all", "energy": True, "method": "leapfrog"}
    return box(**{**base, "stop_time": 0.5, "communication_step": 0.01, **keys})


FLIGHT = {"damping": 0.2, "stretch": [1.1, 1.0, 0.95], "angular_velocity": [3.0, 4.0, 5.0]}
SLIDING = {"plane": [FLOOR], "velocity": [1.0, 0.2, 0.0]}
PRESS = {"name": "press", "point": [0, 0, 1], "normal": [0, 0, -1], "velocity": [0, 0, -0.2]}
BELT = {**FLOOR, "velocity": [0.5, 0.0, 0.0]}
PUSH = {"name": "push", "points": "x-"}
HAND = [f"pin.hand.position.{axis}" for axis in "xyz"]

CASES = {
    "damped flight": (FLIGHT, None),
    "heavily damped flight": ({"damping": 5.0, "stretch": [1.1, 1.0, 0.95], "velocity": [3.0, 4.0, 5.0]}, None),
    "sliding with friction": (SLIDING, None),
    "sliding with friction and damping": ({"damping": 0.3, **SLIDING}, None),
    "pressed by a plane that starts at once": ({"damping": 0.3, "plane": [FLOOR, PRESS]}, None),
    "dragged by a belt": ({"damping": 0.05, "plane": [BELT]}, None),
    "hanging": ({"damping": 0.1, "pin": [{"name": "hook", "points": "z+"}], "stretch": [1.05, 1.0, 1.0]}, None),
    "led": (
        {"damping": 0.1, "pin": [{"name": "hand", "points": "z+", "motion": "input"}]},
        lambda time: dict(zip(HAND, (0.5 + 0.2 * np.sin(6 * time), 0.5, 1.0), strict=True)),
    ),
    "pushed": (
        {"damping": 0.1, "load": [PUSH], "forces": [[3, 3, 3]]},
        lambda time: {"load.push.x": 20.0 * np.sin(6 * time), "force[3,3,3].z": 3.0 * np.cos(9 * time)},
    ),
}
"""Name: keys, inputs."""


def energy_gap(result):
    return np.abs(imbalance(result)).max()


def gap_of(keys, inputs, h, **arguments):
    return energy_gap(simulate(watched(**keys), start_values={"solver.step": h}, inputs=inputs, **arguments))


def landing(speed, height, h, **keys):
    """Points without springs that fall on the floor."""
    fall = watched(stiffness=0.0, plane=[FLOOR], offset=[0.0, 0.0, height], velocity=[0.0, 0.0, -speed], **keys)
    return simulate(fall, start_values={"solver.step": h}, stop_time=0.1)


@pytest.mark.parametrize("case", CASES)
def test_the_balance_closes_to_second_order(case):
    gaps = [gap_of(*CASES[case], h) for h in STEPS]
    assert orders(gaps) == pytest.approx([2.0, 2.0], abs=0.15)


@pytest.mark.parametrize("theta", [0.1, 0.5, 0.9])
def test_an_impact_costs_exactly_the_energy_of_the_approach(theta):
    """Points without springs or friction land after a share theta of a step; what they had is what is lost, up to rounding."""
    h, speed = 1e-3, 2.0
    result = landing(speed, speed * h * (20 + theta), h, gravity=[0.0, 0.0, 0.0])
    assert result.outputs["energy.dissipated"][-1] == pytest.approx(0.5 * 16 / 64 * speed**2, rel=1e-12)
    assert energy_gap(result) < 1e-12


@pytest.mark.parametrize("theta", [0.1, 0.5, 0.9])
def test_an_impact_under_gravity_is_booked_to_second_order(theta):
    """A force f that acts while the velocity jumps by dv must not count as (theta - 1/2) h f dv: here up to 2 mJ of 0.5 J."""
    h, speed = 1e-3, 2.0
    assert energy_gap(landing(speed, speed * h * (20 + theta), h)) < 1e-5


@pytest.mark.parametrize("damping", [0.0, 0.1])
def test_the_balance_of_a_bouncing_rubbing_box_closes_to_second_order(damping):
    """Some hundred impacts with friction; damping counts the velocities before and after an impact for their own times."""
    throw = {"offset": [0.0, 0.0, 0.2], "velocity": [1.0, 0.0, 0.0], "angular_velocity": [1.0, 2.0, 0.0]}
    bouncing = {"damping": damping, "plane": [{**FLOOR, "friction": 0.4}], **throw}
    gaps = [gap_of(bouncing, None, h, stop_time=2.0) for h in (1e-4, 5e-5, 2.5e-5)]
    assert orders(gaps) == pytest.approx([2.0, 2.0], abs=0.15)


def test_a_piston_that_presses_does_the_work_that_is_stored_and_lost():
    motion = {"point": [0.0, 0.0, 1.01], "normal": [0.0, 0.0, -1.0], "velocity": [0.0, 0.0, -0.4]}
    piston = {"name": "piston", "friction": 0.2, **motion}
    result = simulate(watched(damping=0.3, gravity=[0.0, 0.0, 0.0], plane=[FLOOR, piston]), start_values={"solver.step": 5e-5})
    by_force = np.cumsum(0.01 * -0.4 * -vector(result, "plane.piston.reaction")[:, 2])
    assert result.outputs["energy.work"] == pytest.approx(by_force, rel=1e-9, abs=1e-12)  # reaction times velocity
    assert result.outputs["energy.work"][-1] > 20
    assert energy_gap(result) < 1e-4 * result.outputs["energy.work"][-1]


def test_damping_dissipates_d_v_squared():
    result = simulate(watched(**FLIGHT), step=1e-4, start_values={"solver.step": 1e-4})
    v = velocities(result)
    power = 0.2 * (((v[1:] + v[:-1]) / 2) ** 2).sum(axis=(1, 2))
    lost = np.concatenate([[0.0], np.cumsum(1e-4 * power)])
    assert result.outputs["energy.dissipated"] == pytest.approx(lost, rel=1e-10, abs=1e-12)


def test_gravity_energy_is_that_of_the_centre_of_mass():
    result = simulate(watched(damping=0.2, velocity=[1.0, 2.0, 3.0]))
    assert result.outputs["energy.gravity"] == pytest.approx(9.81 * points(result)[:, :, 2].mean(axis=1), abs=1e-12)


def test_work_of_forces_is_force_times_way():
    result = simulate(watched(damping=0.2, load=[PUSH]), start_values={"load.push.x": 20.0})
    way = points(result)[:, ::4, 0].mean(axis=1)
    assert result.outputs["energy.work"] == pytest.approx(20.0 * way, abs=1e-11)


def test_strong_drag_takes_the_kinetic_energy_and_no_more():
    """Drag stops each point within a thirtieth of an internal step."""
    result = simulate(watched(points=[3, 3, 3], damping=100.0, gravity=[0.0, 0.0, 0.0], velocity=[3.0, 0.0, 0.0], step=0.01, stop_time=0.1))
    assert result.outputs["energy.dissipated"][-1] == pytest.approx(4.5, rel=1e-12)
