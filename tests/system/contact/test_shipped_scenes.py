"""The shipped scenes car_bump and car_ball: what they say to expect."""

import numpy as np
import pytest

from readings import deepest, vector
from softffd import load_scene, simulate


def struck(result, obstacle):
    """Time of the first force on an obstacle [s]."""
    return result.time[np.flatnonzero(vector(result, f"{obstacle}.reaction").any(axis=1))[0]]


def test_the_ball_shoves_the_car_against_the_log_and_no_vertex_is_ever_inside_either():
    result = simulate("car_ball")
    assert [struck(result, solid) for solid in ("sphere.ball", "cylinder.log")] == pytest.approx([0.48, 0.87], abs=0.011)
    held = (result.time > 1.3) & (result.time < 1.5)
    assert vector(result, "sphere.ball.reaction")[held, 1].mean() == pytest.approx(-34e3, rel=0.05)
    assert vector(result, "cylinder.log.reaction")[held, 1].mean() == pytest.approx(30e3, rel=0.05)
    assert result.deformation().max() == pytest.approx(0.42, abs=0.02)
    assert not result.summary["warnings"]
    for solid in ("ball", "log"):
        assert -1e-9 < deepest(result, solid) <= 4e-12


def test_the_nose_strikes_the_wall_and_not_the_corners_of_its_box():
    surface, lattice = (simulate(load_scene("car_bump").replace({"contact.of": of})) for of in ("surface", "lattice"))
    assert [struck(result, "plane.wall") for result in (surface, lattice)] == pytest.approx([0.24, 0.14], abs=0.011)
    for plane in ("road", "wall"):
        assert abs(deepest(surface, plane)) < 1e-12
    assert deepest(lattice, "wall") < -0.1
    ends = [result.outputs["probe.nose.x"][-1] for result in (surface, lattice)]
    assert ends == pytest.approx([3.82, 3.42], abs=0.03)
    assert np.linalg.norm(vector(surface, "plane.wall.reaction"), axis=1).max() == pytest.approx(7e4, rel=0.1)
    assert surface.deformation().max() == pytest.approx(0.4, abs=0.02)


def test_the_wheels_carry_the_car_where_they_stand():
    """On the way to the wall the centre of pressure is among the vertices on the road, some of every wheel at first."""
    result = simulate(load_scene("car_bump"), stop_time=0.2)
    centre, vertices = vector(result, "plane.road.centre"), result.deformed(row=slice(None))
    low = [frame[frame[:, 2] < 0.02] for frame in vertices[1:]]
    for at, wheels in zip(centre[1:], low, strict=True):
        assert (wheels.min(axis=0)[:2] < at[:2]).all() and (at[:2] < wheels.max(axis=0)[:2]).all()
    assert result.outputs["plane.road.contacts"][0] >= 4
