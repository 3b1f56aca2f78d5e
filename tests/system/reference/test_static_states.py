"""States of rest reached by damping are the stored equilibria."""

import numpy as np
import pytest

import reference
from readings import assert_nothing_is_behind, points, vector
from scenes import GRAVITY, box
from softffd import simulate

SLOW = {"method": "leapfrog", "damping": 4.0, "communication_step": 0.5}
PULLED = SLOW | {"stiffness": 1e3, "stop_time": 1.0, "load": [{"name": "right", "points": "x+"}, {"name": "left", "points": "x-"}]}
RESTING = SLOW | {"stiffness": 2e3, "stop_time": 1.5, "gravity": GRAVITY, "plane": [{"name": "ground", "friction": 0.0}]}


def test_a_pulled_box_comes_to_rest_in_the_stored_shape(golden):
    result = simulate(box(**PULLED), start_values={"load.right.x": 16 * 20.0, "load.left.x": -16 * 20.0})
    x = points(result)[-1]
    assert x == pytest.approx(golden("static")["pull_x"], abs=1e-14)  # rounding of positions; transients are e^-100 by now
    assert np.ptp(x, axis=0) == pytest.approx([1.02981507, 0.99369468, 0.99369468], abs=5e-9)


def test_a_box_settles_on_a_plane_in_the_stored_shape_each_point_with_its_share_of_the_weight(golden):
    result, static = simulate(box(**RESTING)), golden("static")
    x = points(result)[-1]
    assert x == pytest.approx(static["rest_x"], abs=1e-14)
    assert x[48:, 2].mean() == pytest.approx(0.99984, abs=1e-4)
    assert_nothing_is_behind(result)
    assert vector(result, "plane.ground.reaction")[-1] == pytest.approx([0, 0, -9.81], abs=1e-10)
    assert vector(result, "plane.ground.torque")[-1] == pytest.approx([-4.905, 4.905, 0], abs=1e-10)  # about the origin, a corner
    assert result.outputs["plane.ground.contacts"][-1] == 16
    carried = (9.81 / 64 - reference.cube(stiffness=2e3).spring_force(x)[:, 2]).reshape(4, 16)  # equilibrium of each point of a layer
    assert carried[0] == pytest.approx(static["rest_lambda"][:16], abs=1e-10)
    assert carried[1:] == pytest.approx(np.zeros((3, 16)), abs=1e-10)
    assert carried[0, [0, 1, 5]] == pytest.approx([0.52003692, 0.61262668, 0.70720971], abs=5e-9)  # corner, edge, middle
