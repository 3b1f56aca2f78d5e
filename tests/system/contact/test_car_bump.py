"""The shipped scene car_bump: what it says to expect."""

import numpy as np
import pytest

from readings import vector
from softffd import load_scene, simulate


def run(of):
    return simulate(load_scene("car_bump").replace({"contact.of": of}))


def struck(result):
    """Time of the first force on the wall [s]."""
    return result.time[np.flatnonzero(vector(result, "plane.wall.reaction")[:, 0])[0]]


def above(result, plane):
    """Least height of a vertex above a plane, over time (T,) [m]."""
    (found,) = (each for each in result.scene.plane if each.name == plane)
    normal = np.array(found.normal) / np.linalg.norm(found.normal)
    return ((result.deformed(row=slice(None)) - found.point) @ normal).min(axis=1)


def test_the_nose_strikes_the_wall_and_not_the_corners_of_its_box():
    surface, lattice = run("surface"), run("lattice")
    assert struck(surface) == pytest.approx(0.24, abs=0.011) and struck(lattice) == pytest.approx(0.14, abs=0.011)
    for plane in ("road", "wall"):
        assert -1e-12 < above(surface, plane).min() < 1e-12
    assert above(lattice, "wall").min() > 0.1
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
