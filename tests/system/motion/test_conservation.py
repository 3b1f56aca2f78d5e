"""Momentum, angular momentum, and free flight."""

import numpy as np
import pytest

import reference
from readings import centre, points, velocities
from scenes import box
from softffd import simulate

PLACED = {"origin": [1.0, -2.0, 30.0], "size": [0.5, 1.0, 2.0]}


def tumbling(method="leapfrog", *, step=0.0):
    return box(
        mass={"total": 2.0},
        stiffness=1e3,
        damping=0.0,
        region=[{"points": {"i": [0, 1], "j": [0, 2]}, "mass": 0.07}],
        stretch=[1.1, 0.95, 1.05],
        velocity=[3.0, -1.0, 2.0],
        angular_velocity=[5.0, -20.0, 10.0],
        velocities="all",
        energy=True,
        method=method,
        step=step,
        stop_time=2.0,
        communication_step=0.02,
    )


def falling(damping, *, stiffness=1e3):
    return box(
        lattice={"points": [2, 3, 4], **PLACED},
        mass={"total": 3.0},
        stiffness=stiffness,
        damping=damping,
        gravity=[0.3, 0.1, -9.81],
        velocity=[1.0, 2.0, 3.0],
        velocities="all",
        step=1e-3,
        stop_time=1.0,
        communication_step=0.1,
    )


def masses_of_tumbling():
    mass = np.full((4, 4, 4), 2.0 / 64)  # [k, j, i]
    mass[:, 0:3, 0:2] = 0.07
    return mass.reshape(-1, 1)


@pytest.mark.parametrize("method", ["leapfrog", "bm4", "rkn12", "dop853", "auto"])
def test_momentum_is_kept(method):
    momentum = (masses_of_tumbling() * velocities(simulate(tumbling(method)))).sum(axis=1)
    size = (masses_of_tumbling() * np.abs(velocities(simulate(tumbling(method))))).sum(axis=1).max()
    assert np.abs(momentum - momentum[0]).max() < 1e-12 * size


@pytest.mark.parametrize(("method", "share"), [("leapfrog", 1e-12), ("bm4", 1e-12), ("rkn12", 1e-8), ("dop853", 1e-7), ("auto", 1e-8)])
def test_angular_momentum_is_kept(method, share):
    """By the splittings to rounding, by the methods with error control (auto may take one) to a small part of the tolerance of 1e-4."""
    result = simulate(tumbling(method))
    x, v, mass = points(result), velocities(result), masses_of_tumbling()
    turning = (mass * np.cross(x, v)).sum(axis=1)
    size = (mass * np.abs(np.cross(x, v))).sum(axis=(1, 2)).max()
    assert np.abs(turning - turning[0]).max() < share * size


def test_central_difference_keeps_both_to_its_round_off():
    result = simulate(tumbling("central_difference", step=1e-3))
    x, v, mass = points(result), velocities(result), masses_of_tumbling()
    momentum, turning = (mass * v).sum(axis=1), (mass * np.cross(x, v)).sum(axis=1)
    assert np.abs(momentum - momentum[0]).max() < 1e-10
    assert np.abs(turning - turning[0]).max() < 1e-10


def test_the_centre_of_mass_moves_uniformly():
    result = simulate(tumbling())
    mass = masses_of_tumbling() / masses_of_tumbling().sum()
    place, speed = (mass * points(result)).sum(axis=1), (mass * velocities(result)).sum(axis=1)
    assert place == pytest.approx(place[0] + np.outer(result.time, speed[0]), abs=1e-12)


def test_free_fall_is_exact():
    result = simulate(falling(damping=0.0))
    t = result.time[:, None, None]
    rest = reference.rest_lattice((2, 3, 4), **PLACED)
    gravity, start = np.array([0.3, 0.1, -9.81]), np.array([1.0, 2.0, 3.0])
    assert points(result) == pytest.approx(rest + t * start + 0.5 * t**2 * gravity, abs=1e-12)
    assert centre(velocities(result)) == pytest.approx(start + t[:, 0] * gravity, abs=1e-12)
    # single points feel the rounding of positions near 30 m as stretch: 1e3 N/m * 4e-15 m / 0.125 kg
    assert velocities(result) == pytest.approx(np.broadcast_to(start + t * gravity, (11, 24, 3)), abs=1e-10)


def damped_fall_error(h):
    result = simulate(falling(damping=0.25), start_values={"solver.step": h})
    gravity, start, rate, t = np.array([0.3, 0.1, -9.81]), np.array([1.0, 2.0, 3.0]), 0.25 / 0.125, result.time[:, None]
    final = gravity / rate
    exact = final * t + (start - final) * (1 - np.exp(-rate * t)) / rate
    return np.abs(centre(points(result)) - centre(points(result))[0] - exact).max()


def test_damped_fall_is_the_exact_solution_to_second_order():
    errors = [damped_fall_error(h) for h in (2e-3, 1e-3, 5e-4)]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.02)
    assert errors[1] < 5e-6  # m in 10 m


@pytest.mark.parametrize("h", [1e-2, 1e-3])
def test_heavy_damping_gives_the_terminal_velocity(h):
    """d h / m is 80 and 8: steps much longer than the time in which damping stops a point."""
    speed = velocities(simulate(falling(damping=1000.0, stiffness=0.0), start_values={"solver.step": h}))[1:]
    terminal = 0.125 * np.array([0.3, 0.1, -9.81]) / 1000.0
    assert speed == pytest.approx(np.broadcast_to(terminal, speed.shape), rel=1e-12)


def test_no_energy_is_lost_without_damping():
    result = simulate(tumbling(), start_values={"solver.step": 1e-4})
    total = result.outputs["energy.kinetic"] + result.outputs["energy.elastic"]
    assert total == pytest.approx(np.full_like(total, total[0]), rel=1e-3)  # (h omega)^2 / 8 of what vibrates
    finer = simulate(tumbling(), start_values={"solver.step": 5e-5})
    finer_total = finer.outputs["energy.kinetic"] + finer.outputs["energy.elastic"]
    assert np.log2(np.abs(total - total[0]).max() / np.abs(finer_total - finer_total[0]).max()) == pytest.approx(2, abs=0.15)


def test_energies_are_those_of_the_positions_and_velocities():
    result = simulate(tumbling())
    kinetic = 0.5 * (masses_of_tumbling() * velocities(result) ** 2).sum(axis=(1, 2))
    elastic = [reference.cube(stiffness=1e3).elastic_energy(x) for x in points(result)]
    assert result.outputs["energy.kinetic"] == pytest.approx(kinetic, rel=1e-13)
    assert result.outputs["energy.elastic"] == pytest.approx(elastic, rel=1e-12)
