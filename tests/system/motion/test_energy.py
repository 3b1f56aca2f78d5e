"""The energy balance closes: kinetic + elastic + gravity + dissipated - work stays what it was, to second order in the step."""

import numpy as np
import pytest

from readings import points, vector, velocities
from softffd import simulate

STEPS = (5e-4, 2.5e-4, 1.25e-4)

BASE = """
[material]
stiffness = 2e3
damping = DAMPING
[environment]
gravity = [0.0, 0.0, -9.81]
[outputs]
velocities = "all"
energy = true
[solver]
method = "leapfrog"
[experiment]
stop_time = 0.5
communication_step = 0.01
"""

FLOOR = '[[plane]]\nname = "floor"\nfriction = 0.1\n'

HAND = [f"pin.hand.position.{axis}" for axis in "xyz"]

CASES = {
    "damped flight": ("0.2", "[initial]\nstretch = [1.1, 1.0, 0.95]\nangular_velocity = [3.0, 4.0, 5.0]\n", None),
    "heavily damped flight": ("5.0", "[initial]\nstretch = [1.1, 1.0, 0.95]\nvelocity = [3.0, 4.0, 5.0]\n", None),
    "sliding with friction": ("0.0", FLOOR + "[initial]\nvelocity = [1.0, 0.2, 0.0]\n", None),
    "sliding with friction and damping": ("0.3", FLOOR + "[initial]\nvelocity = [1.0, 0.2, 0.0]\n", None),
    "pressed by a plane that starts at once": (
        "0.3",
        FLOOR + '[[plane]]\nname = "press"\npoint = [0, 0, 1]\nnormal = [0, 0, -1]\nvelocity = [0, 0, -0.2]\n',
        None,
    ),
    "dragged by a belt": ("0.05", FLOOR.replace("friction", "velocity = [0.5, 0.0, 0.0]\nfriction"), None),
    "hanging": ("0.1", '[[pin]]\nname = "hook"\npoints = "z+"\n[initial]\nstretch = [1.05, 1.0, 1.0]\n', None),
    "led": (
        "0.1",
        '[[pin]]\nname = "hand"\npoints = "z+"\nmotion = "input"\n',
        lambda time: dict(zip(HAND, (0.5 + 0.2 * np.sin(6 * time), 0.5, 1.0), strict=True)),
    ),
    "pushed": (
        "0.1",
        '[[load]]\nname = "push"\npoints = "x-"\n[inputs]\nforces = [[3, 3, 3]]\n',
        lambda time: {"load.push.x": 20.0 * np.sin(6 * time), "force[3,3,3].z": 3.0 * np.cos(9 * time)},
    ),
}


def energy_gap(result):
    parts = {name: result.outputs[f"energy.{name}"] for name in ("kinetic", "elastic", "gravity", "dissipated", "work")}
    total = sum(parts.values()) - 2 * parts["work"]
    return np.abs(total - total[0]).max()


def gap_of(scene, damping, extra, inputs, h, **arguments):
    body = scene(BASE.replace("DAMPING", damping) + extra)
    return energy_gap(simulate(body, start_values={"solver.step": h}, inputs=inputs, **arguments))


@pytest.mark.parametrize("case", CASES)
def test_the_balance_closes_to_second_order(scene, case):
    gaps = [gap_of(scene, *CASES[case], h) for h in STEPS]
    assert np.log2(np.array(gaps[:-1]) / gaps[1:]) == pytest.approx([2.0, 2.0], abs=0.15)


@pytest.mark.parametrize("theta", [0.1, 0.5, 0.9])
def test_an_impact_costs_exactly_the_energy_of_the_approach(scene, theta):
    """Points without springs or friction land after a share theta of a step; what they had is what is lost, up to rounding."""
    h, speed = 1e-3, 2.0
    text = BASE.replace("DAMPING", "0.0").replace("stiffness = 2e3", "stiffness = 0.0").replace("-9.81", "0.0")
    fall = f"[initial]\noffset = [0.0, 0.0, {speed * h * (20 + theta)}]\nvelocity = [0.0, 0.0, {-speed}]\n"
    result = simulate(scene(text + FLOOR + fall), start_values={"solver.step": h}, stop_time=0.1)
    assert result.outputs["energy.dissipated"][-1] == pytest.approx(0.5 * 16 / 64 * speed**2, rel=1e-12)
    assert energy_gap(result) < 1e-12


@pytest.mark.parametrize("theta", [0.1, 0.5, 0.9])
def test_an_impact_under_gravity_is_booked_to_second_order(scene, theta):
    """A force f that acts while the velocity jumps by dv must not count as (theta - 1/2) h f dv: here up to 2 mJ of 0.5 J."""
    h, speed = 1e-3, 2.0
    text = BASE.replace("DAMPING", "0.0").replace("stiffness = 2e3", "stiffness = 0.0")
    fall = f"[initial]\noffset = [0.0, 0.0, {speed * h * (20 + theta)}]\nvelocity = [0.0, 0.0, {-speed}]\n"
    result = simulate(scene(text + FLOOR + fall), start_values={"solver.step": h}, stop_time=0.1)
    assert energy_gap(result) < 1e-5


@pytest.mark.parametrize("damping", ["0.0", "0.1"])
def test_the_balance_of_a_bouncing_rubbing_box_closes_to_second_order(scene, damping):
    """Some hundred impacts with friction; damping counts the velocities before and after an impact for their own times."""
    throw = "[initial]\noffset = [0.0, 0.0, 0.2]\nvelocity = [1.0, 0.0, 0.0]\nangular_velocity = [1.0, 2.0, 0.0]\n"
    extra = FLOOR.replace("0.1", "0.4") + throw
    gaps = [gap_of(scene, damping, extra, None, h, stop_time=2.0) for h in (1e-4, 5e-5, 2.5e-5)]
    assert np.log2(np.array(gaps[:-1]) / gaps[1:]) == pytest.approx([2.0, 2.0], abs=0.15)


def test_a_piston_that_presses_does_the_work_that_is_stored_and_lost(scene):
    text = BASE.replace("-9.81", "0.0")
    motion = "point = [0.0, 0.0, 1.01]\nnormal = [0.0, 0.0, -1.0]\nvelocity = [0.0, 0.0, -0.4]\n"
    piston = FLOOR + f'[[plane]]\nname = "piston"\n{motion}friction = 0.2\n'
    result = simulate(scene(text.replace("DAMPING", "0.3") + piston), start_values={"solver.step": 5e-5})
    by_force = np.cumsum(0.01 * -0.4 * -vector(result, "plane.piston.reaction")[:, 2])
    assert result.outputs["energy.work"] == pytest.approx(by_force, rel=1e-9, abs=1e-12)  # reaction times velocity
    assert result.outputs["energy.work"][-1] > 20
    assert energy_gap(result) < 1e-4 * result.outputs["energy.work"][-1]


def test_damping_dissipates_d_v_squared(scene):
    flight = scene(BASE.replace("DAMPING", "0.2") + CASES["damped flight"][1])
    result = simulate(flight, step=1e-4, start_values={"solver.step": 1e-4})
    v = velocities(result)
    power = 0.2 * (((v[1:] + v[:-1]) / 2) ** 2).sum(axis=(1, 2))
    lost = np.concatenate([[0.0], np.cumsum(1e-4 * power)])
    assert result.outputs["energy.dissipated"] == pytest.approx(lost, rel=1e-10, abs=1e-12)


def test_gravity_energy_is_that_of_the_centre_of_mass(scene):
    result = simulate(scene(BASE.replace("DAMPING", "0.2") + "[initial]\nvelocity = [1.0, 2.0, 3.0]\n"))
    assert result.outputs["energy.gravity"] == pytest.approx(9.81 * points(result)[:, :, 2].mean(axis=1), abs=1e-12)


def test_work_of_forces_is_force_times_way(scene):
    pushed = scene(BASE.replace("DAMPING", "0.2") + '[[load]]\nname = "push"\npoints = "x-"\n')
    result = simulate(pushed, start_values={"load.push.x": 20.0})
    way = points(result)[:, ::4, 0].mean(axis=1)
    assert result.outputs["energy.work"] == pytest.approx(20.0 * way, abs=1e-11)
