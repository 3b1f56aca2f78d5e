"""The shipped scene car_ball: what it says to expect."""

import numpy as np
import pytest

from readings import vector
from softffd import load_scene, simulate
from validation.shapes import gap


@pytest.fixture(scope="module")
def result():
    scene = load_scene("car_ball")
    return simulate(scene, inputs=scene.default_inputs)


def test_the_ball_shoves_the_car_against_the_log(result):
    first = {
        name: result.time[np.flatnonzero(vector(result, f"{name}.reaction").any(axis=1))[0]] for name in ("sphere.ball", "cylinder.log")
    }
    assert first == pytest.approx({"sphere.ball": 0.48, "cylinder.log": 0.87}, abs=0.011)
    held = (result.time > 1.3) & (result.time < 1.5)
    assert vector(result, "sphere.ball.reaction")[held, 1].mean() == pytest.approx(-34e3, rel=0.05)
    assert vector(result, "cylinder.log.reaction")[held, 1].mean() == pytest.approx(30e3, rel=0.05)
    assert result.deformation().max() == pytest.approx(0.42, abs=0.02)
    assert not [message.text for message in result.log if "warning" in str(message.status)]


def test_no_vertex_is_ever_inside_ball_or_log(result):
    places = result.deformed(row=slice(None))
    for kind, solid in (("sphere", result.scene.sphere[0]), ("cylinder", result.scene.cylinder[0])):
        points, axes = result.plane(solid.name)
        least = min(gap(kind, solid.model_dump(), *each).min() for each in zip(places, points, axes, strict=True))
        assert -4e-12 <= least < 1e-9
