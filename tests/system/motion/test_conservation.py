"""Momentum, angular momentum, and free flight."""

import numpy as np
import pytest

import reference
from readings import centre, orders, points, velocities
from scenes import box
from softffd import simulate

PLACED = {"origin": [1.0, -2.0, 30.0], "size": [0.5, 1.0, 2.0]}
FALL, START = np.array([0.3, 0.1, -9.81]), np.array([1.0, 2.0, 3.0])
"""m/s2 and m/s"""


def tumbling(method="leapfrog", *, step=0.0):
    """Stretched, and light on one side."""
    motion = {"stretch": [1.1, 0.95, 1.05], "velocity": [3.0, -1.0, 2.0], "angular_velocity": [5.0, -20.0, 10.0]}
    keys = {"velocities": "all", "energy": True, "method": method, "step": step, "stop_time": 2.0, "communication_step": 0.02}
    light = {"points": {"i": [0, 1], "j": [0, 2]}, "mass": 0.07}
    return box(mass={"total": 2.0}, stiffness=1e3, damping=0.0, region=[light], **motion, **keys)


def falling(damping, *, stiffness=1e3):
    keys = {"lattice": {"points": [2, 3, 4], **PLACED}, "mass": {"total": 3.0}, "stiffness": stiffness, "damping": damping}
    motion = {"gravity": FALL.tolist(), "velocity": START.tolist(), "velocities": "all"}
    return box(**keys, **motion, step=1e-3, stop_time=1.0, communication_step=0.1)


def masses_of_tumbling():
    mass = np.full((4, 4, 4), 2.0 / 64)  # [k, j, i]
    mass[:, 0:3, 0:2] = 0.07
    return mass.reshape(-1, 1)


LOST = {"leapfrog": 1e-12, "bm4": 1e-12, "rkn12": 1e-8, "dop853": 1e-7, "auto": 1e-8, "central_difference": 0.0}
"""Share of the angular momentum: by splittings rounding, by methods with error control (auto may take one) a small part of the tolerance of
1e-4; the published recurrence has the round-off of its positions."""


@pytest.mark.parametrize("method", LOST)
def test_momentum_and_angular_momentum_are_kept(method):
    published = method == "central_difference"
    result = simulate(tumbling(method, step=1e-3 if published else 0.0))
    x, v, mass = points(result), velocities(result), masses_of_tumbling()
    momentum, turning = mass * v, mass * np.cross(x, v)
    sizes = np.abs(momentum).sum(axis=1).max(), np.abs(turning).sum(axis=(1, 2)).max()
    for each, size, share in zip((momentum, turning), sizes, (1e-12, LOST[method]), strict=True):
        total = each.sum(axis=1)
        assert np.abs(total - total[0]).max() < (1e-10 if published else share * size)
    place, speed = (mass * x).sum(axis=1) / mass.sum(), (mass * v).sum(axis=1) / mass.sum()
    assert published or place == pytest.approx(place[0] + np.outer(result.time, speed[0]), abs=1e-12)


def test_free_fall_is_exact():
    result = simulate(falling(damping=0.0))
    t = result.time[:, None, None]
    rest = reference.rest_lattice((2, 3, 4), **PLACED)
    assert points(result) == pytest.approx(rest + t * START + 0.5 * t**2 * FALL, abs=1e-12)
    assert centre(velocities(result)) == pytest.approx(START + t[:, 0] * FALL, abs=1e-12)
    # single points feel the rounding of positions near 30 m as stretch: 1e3 N/m * 4e-15 m / 0.125 kg
    assert velocities(result) == pytest.approx(np.broadcast_to(START + t * FALL, (11, 24, 3)), abs=1e-10)


def damped_fall_error(h):
    result = simulate(falling(damping=0.25), start_values={"solver.step": h})
    rate, t = 0.25 / 0.125, result.time[:, None]
    final = FALL / rate
    exact = final * t + (START - final) * (1 - np.exp(-rate * t)) / rate
    return np.abs(centre(points(result)) - centre(points(result))[0] - exact).max()


def test_damped_fall_is_the_exact_solution_to_second_order():
    errors = [damped_fall_error(h) for h in (2e-3, 1e-3, 5e-4)]
    assert orders(errors) == pytest.approx([2.0, 2.0], abs=0.02)
    assert errors[1] < 5e-6  # m in 10 m


@pytest.mark.parametrize("h", [1e-2, 1e-3])
def test_heavy_damping_gives_the_terminal_velocity(h):
    """d h / m is 80 and 8: steps much longer than the time in which damping stops a point."""
    speed = velocities(simulate(falling(damping=1000.0, stiffness=0.0), start_values={"solver.step": h}))[1:]
    assert speed == pytest.approx(np.broadcast_to(0.125 * FALL / 1000.0, speed.shape), rel=1e-12)


def test_no_energy_is_lost_without_damping():
    off = []
    for h in (1e-4, 5e-5):
        energy = simulate(tumbling(), start_values={"solver.step": h}).outputs
        total = energy["energy.kinetic"] + energy["energy.elastic"]
        off.append(np.abs(total / total[0] - 1).max())
    assert off[0] < 1e-3  # (h omega)^2 / 8 of what vibrates
    assert orders(off) == pytest.approx(2, abs=0.15)


def test_energies_are_those_of_the_positions_and_velocities():
    result = simulate(tumbling())
    kinetic = 0.5 * (masses_of_tumbling() * velocities(result) ** 2).sum(axis=(1, 2))
    springs = reference.cube(stiffness=1e3)
    elastic = [springs.elastic_energy(x) for x in points(result)]
    assert result.outputs["energy.kinetic"] == pytest.approx(kinetic, rel=1e-13)
    assert result.outputs["energy.elastic"] == pytest.approx(elastic, rel=1e-12)
