"""The shipped scene car_post: what it says to expect."""

import numpy as np
import pytest

from readings import vector
from softffd import load_scene, simulate


def test_the_car_bends_around_the_post():
    result = simulate(load_scene("car_post"))
    assert [message.text for message in result.log if message.status] == []
    force = np.linalg.norm(vector(result, "plane.post.reaction"), axis=1)
    assert force.max() == pytest.approx(2.14e5, rel=0.01) and force.argmax() == np.flatnonzero(force)[0]
    assert result.time[np.flatnonzero(force)[[0, -1]]] == pytest.approx([0.10, 0.35], abs=0.011)
    assert result.deformation().max() == pytest.approx(0.74, abs=0.01)
    assert result.time[result.deformation().argmax()] == pytest.approx(0.24, abs=0.011)
    places = result.deformed(row=slice(None))
    (post,) = result.scene.cylinder
    beside = np.hypot(places[..., 0] - post.point[0], places[..., 1] - post.point[1]) - post.radius
    inside = np.minimum(-beside, post.length - places[..., 2])  # depth below the mantle and the upper end
    assert inside.max() <= 4e-12
