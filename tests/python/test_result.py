"""Results: planes over time, files."""

import numpy as np
import pytest

from softffd import Result, load_scene, simulate

TURNING = """
[[plane]]
name = "mill"
point = [0.5, 0.5, -3.0]
normal = [0.0, 0.6, 0.8]
velocity = [0.0, 0.0, 0.1]
angular_velocity = [0.0, 0.0, 2.0]
[[plane]]
name = "hand"
point = [0.0, 0.0, -5.0]
motion = "input"
[experiment]
stop_time = 0.5
"""


@pytest.fixture
def result(tmp_path) -> Result:
    (tmp_path / "turning.toml").write_text(TURNING)
    scene = load_scene(tmp_path / "turning.toml")
    return simulate(scene, inputs=lambda t: {"plane.hand.point.z": -5.0 + t})


def test_a_fixed_plane_with_a_motion_moves_on_from_its_start(result):
    points, normals = result.plane("mill")
    np.testing.assert_allclose(points[-1], [0.5, 0.5, -2.95], atol=1e-15)
    np.testing.assert_allclose(normals[-1], [-0.6 * np.sin(1.0), 0.6 * np.cos(1.0), 0.8], atol=1e-15)


def test_an_input_plane_is_where_its_inputs_put_it(result):
    points, normals = result.plane("hand")
    np.testing.assert_allclose(points[:, 2], -5.0 + result.time)
    np.testing.assert_allclose(normals, np.tile([0.0, 0.0, 1.0], (len(result.time), 1)))
    np.testing.assert_allclose(result.inputs["plane.hand.velocity.z"][:-1], 1.0)  # derived from the course of the point


def test_planes_are_listed_in_the_order_of_the_scene(result):
    assert sorted(result.plane_names()) == ["hand", "mill"]


def test_saved_arrays_come_back(result, tmp_path):
    result.save(tmp_path)
    loaded = np.load(tmp_path / "result.npz")
    np.testing.assert_array_equal(loaded["positions"], result.positions)
    np.testing.assert_array_equal(loaded["plane.mill.reaction.z"], result.outputs["plane.mill.reaction.z"])
