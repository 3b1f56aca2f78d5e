"""The centre that a body spins about at the start: that of its box, or that of mass."""

import re

import numpy as np
import pytest

from readings import points
from scenes import box
from softffd import simulate
from softffd.fmu.notes import spin_note
from softffd.fmu.package import scene_masses

VELOCITY = np.array([0.1, 0.0, -0.2])


def uneven(**start):
    """A body of which one side is heavy, in free flight."""
    heavy = {"points": "x+", "mass": 0.2}
    motion = {"velocity": VELOCITY.tolist(), "angular_velocity": [1.0, 0.5, 3.0], "stretch": [1.2, 1.0, 0.9], "offset": [0.5, 0.0, 0.2]}
    return box(region=[heavy], stiffness=500.0, damping=0.0, stop_time=0.2, method="leapfrog", step=1e-3, initial=motion | start)


def speed_of_the_centre(scene):
    """Of mass, over the run [m/s]."""
    result = simulate(scene)
    centre = np.einsum("p,tpa->ta", scene_masses(scene).mass / scene_masses(scene).mass.sum(), points(result))
    assert np.abs(np.diff(centre, n=2, axis=0)).max() < 1e-12
    return (centre[-1] - centre[0]) / result.time[-1]


@pytest.mark.parametrize("rotation", [{}, {"rotation": {"axis": [1.0, -2.0, 0.5], "degrees": 35.0}}], ids=["upright", "turned"])
def test_about_its_centre_of_mass_a_body_goes_where_its_velocity_says(rotation):
    scene = uneven(spin_about="mass", **rotation)
    np.testing.assert_allclose(speed_of_the_centre(scene), VELOCITY, rtol=0, atol=1e-12)
    assert spin_note(scene, scene_masses(scene)) is None


@pytest.mark.parametrize("rotation", [{}, {"rotation": {"axis": [1.0, -2.0, 0.5], "degrees": 35.0}}], ids=["upright", "turned"])
def test_about_its_box_the_centre_of_mass_has_a_velocity_too_which_is_told(rotation):
    scene = uneven(**rotation)
    told = spin_note(scene, scene_masses(scene))
    given = np.array(re.search(r"gives the centre of mass \((.*)\) m/s", told)[1].split(","), float)
    np.testing.assert_allclose(speed_of_the_centre(scene) - VELOCITY, given, rtol=0, atol=0.005 * np.linalg.norm(given))
    assert np.linalg.norm(given) > 0.1
    assert spin_note(box(angular_velocity=[0.0, 0.0, 3.0]), scene_masses(box())) is None
