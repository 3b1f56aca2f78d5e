"""The stored solutions are those of the equations, solved again by other people's methods."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import reference

SCRIPT = Path(__file__).resolve().parents[2] / "data" / "made_again.py"


@pytest.fixture(scope="module")
def made_again():
    spec = importlib.util.spec_from_file_location("made_again", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.full
@pytest.mark.parametrize(("name", "allowed"), [("S1", 1e-9), ("S2", 1e-8), ("G_ZOH", 1e-9)])
def test_trajectories_are_those_of_scipy(made_again, golden, name, allowed):
    """m; SciPy's tolerance is 1e-11 a step, of which some hundred add up."""
    again, stored = made_again.MADE[name](), golden(name)
    assert again["t"] == pytest.approx(stored["t"], abs=1e-12)
    assert np.abs(again["x"] - stored["x"]).max() < allowed


@pytest.mark.full
def test_states_of_rest_are_those_of_newton_s_method(made_again, golden):
    again, stored = made_again.states_of_rest(), golden("static")
    assert set(again) == set(stored)
    assert all(np.abs(again[name] - stored[name]).max() < 1e-11 for name in again)  # m and N; rounding of 1e3 N/m * 1 m


@pytest.mark.parametrize(("topology", "count"), [("distinct", 468), ("paper", 504)])
def test_stored_shapes_vibrate_with_their_frequencies(golden, topology, count):
    modes, model = golden("modes"), reference.cube(topology=topology)
    for number, shape in zip(modes["numbers"], modes[f"modes_{count}"].T, strict=True):
        bent = 1e-5 * shape.reshape(-1, 3) / np.abs(shape).max()
        force = (model.spring_force(model.rest + bent) - model.spring_force(model.rest - bent)) / 2
        wanted = -(modes[f"omega_{count}"][number] ** 2) * model.mass[:, None] * bent
        assert np.abs(force - wanted).max() < 1e-6 * np.abs(wanted).max()  # what is of third order in a bend of 1e-5
