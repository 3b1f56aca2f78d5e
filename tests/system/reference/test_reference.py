"""Facts about the numpy reference and the stored data: they agree, and may judge the component."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import reference

SCRIPT = Path(__file__).resolve().parents[2] / "data" / "made_again.py"
TOPOLOGIES = pytest.mark.parametrize(("topology", "count"), [("distinct", 468), ("paper", 504)])


@pytest.fixture(scope="module")
def made_again():
    spec = importlib.util.spec_from_file_location("made_again", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@TOPOLOGIES
def test_the_published_number_of_springs_has_the_stored_modes(golden, topology, count):
    """Frequencies, and shapes that vibrate with them."""
    modes, model = golden("modes"), reference.cube(topology=topology)
    assert len(model.springs) == count
    frequencies, _ = model.eigenmodes()
    assert frequencies[:6] == pytest.approx(0, abs=1e-3)  # rigid motions; rounding of the squares is 1e-16 * 930^2
    assert frequencies[6:] == pytest.approx(modes[f"omega_{count}"][6:], rel=1e-12)
    for number, shape in zip(modes["numbers"], modes[f"modes_{count}"].T, strict=True):
        bent = 1e-5 * shape.reshape(-1, 3) / np.abs(shape).max()
        force = (model.spring_force(model.rest + bent) - model.spring_force(model.rest - bent)) / 2
        wanted = -(modes[f"omega_{count}"][number] ** 2) * model.mass[:, None] * bent
        assert np.abs(force - wanted).max() < 1e-6 * np.abs(wanted).max()  # what is of third order in a bend of 1e-5


def test_stored_static_states_are_in_equilibrium(golden):
    static = golden("static")
    pulled = reference.cube().spring_force(static["pull_x"]) + static["pull_F"]
    resting = reference.cube(stiffness=2e3).spring_force(static["rest_x"])
    resting[:, 2] += static["rest_lambda"] - 9.81 / 64
    assert np.abs(pulled).max() < 1e-11  # N; rounding of 1e3 N/m * 1 m
    assert np.abs(resting).max() < 1e-11


@pytest.mark.full
def test_stored_static_states_are_those_of_newton_s_method(made_again, golden):
    again, stored = made_again.states_of_rest(), golden("static")
    assert set(again) == set(stored)
    assert all(np.abs(again[name] - stored[name]).max() < 1e-11 for name in again)  # m and N; rounding of 1e3 N/m * 1 m


@pytest.mark.full
@pytest.mark.parametrize(("name", "allowed"), [("S1", 1e-9), ("S2", 1e-8), ("G_ZOH", 1e-9)])
def test_stored_trajectories_are_those_of_scipy(made_again, golden, name, allowed):
    """m; SciPy's tolerance is 1e-11 a step, of which some hundred add up."""
    again, stored = made_again.MADE[name](), golden(name)
    assert again["t"] == pytest.approx(stored["t"], abs=1e-12)
    assert np.abs(again["x"] - stored["x"]).max() < allowed


def test_leapfrog_and_central_difference_are_one_scheme():
    model = reference.cube(damping=0.05)
    start, rest = model.rest * [1.1, 1.0, 0.97], np.zeros_like(model.rest)
    x, v = reference.leapfrog(model, start, rest, 5e-4, 200)
    course = reference.central_difference(model, start, rest, 5e-4, 201)
    assert x == pytest.approx(course[200], abs=1e-12)  # round-off of the recurrence in positions
    assert v == pytest.approx((course[201] - course[199]) / 1e-3, abs=1e-9)
