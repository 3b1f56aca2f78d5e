"""Facts about the numpy reference itself, against stored data: it may judge the component."""

import numpy as np
import pytest

import reference


@pytest.mark.parametrize(("topology", "count"), [("distinct", 468), ("paper", 504)])
def test_the_lattice_has_the_published_number_of_springs(topology, count):
    assert len(reference.spring_list(topology=topology)) == count


@pytest.mark.parametrize(("topology", "count"), [("distinct", 468), ("paper", 504)])
def test_frequencies_are_the_stored_ones(golden, topology, count):
    frequencies, _ = reference.cube(topology=topology).eigenmodes()
    assert frequencies[:6] == pytest.approx(0, abs=1e-3)  # rigid motions; rounding of the squares is 1e-16 * 930^2
    assert frequencies[6:] == pytest.approx(golden("modes")[f"omega_{count}"][6:], rel=1e-12)


def test_stored_static_states_are_in_equilibrium(golden):
    static = golden("static")
    pulled = reference.cube().spring_force(static["pull_x"]) + static["pull_F"]
    resting = reference.cube(stiffness=2e3).spring_force(static["rest_x"])
    resting[:, 2] += static["rest_lambda"] - 9.81 / 64
    assert np.abs(pulled).max() < 1e-11  # N; rounding of 1e3 N/m * 1 m
    assert np.abs(resting).max() < 1e-11


def test_leapfrog_and_central_difference_are_one_scheme():
    model = reference.cube(damping=0.05)
    start, rest = model.rest * [1.1, 1.0, 0.97], np.zeros_like(model.rest)
    x, v = reference.leapfrog(model, start, rest, 5e-4, 200)
    course = reference.central_difference(model, start, rest, 5e-4, 201)
    assert x == pytest.approx(course[200], abs=1e-12)  # round-off of the recurrence in positions
    assert v == pytest.approx((course[201] - course[199]) / 1e-3, abs=1e-9)
