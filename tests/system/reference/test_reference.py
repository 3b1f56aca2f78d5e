"""Facts about the numpy reference and the stored data: they agree, and may judge the component."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "data" / "made_again.py"


@pytest.fixture(scope="module")
def made_again():
    spec = importlib.util.spec_from_file_location("made_again", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
