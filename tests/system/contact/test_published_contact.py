"""The published collision rule, kept for reproduction: an elastic bounce that penetrates by up to one step's travel."""

import numpy as np
import pytest

import reference
from readings import points
from scenes import GRAVITY, box
from softffd import simulate


def dropped(stiffness, **settings):
    scene = box(
        lattice={"points": [2, 2, 2], "size": [0.1, 0.1, 0.1]}, mass={"total": 0.8}, stiffness=stiffness, damping=0.0, gravity=GRAVITY,
        plane=[{"name": "ground", "friction": 0.0}], offset=[0.0, 0.0, 0.2], method="central_difference", step=1e-4, stop_time=0.5,
        communication_step=1e-4,
    )  # fmt: skip
    return simulate(scene, start_values=settings)


def test_points_without_springs_retrace_their_fall_and_are_behind_by_no_more_than_one_steps_travel():
    heights = points(dropped(0.0))[:, :, 2]
    rebound = int(0.41 / 1e-4)  # the lower points fall 0.202 s and rise as long; the upper ones 0.247 s each
    assert heights.argmin(axis=0)[:4] == pytest.approx(np.full(4, 2020), abs=2)
    assert heights[3000:rebound, :4].max(axis=0) == pytest.approx(np.full(4, 0.2), abs=2e-4)  # 2 m/s * 1e-4 s: one step's travel
    assert heights[4000:, 4:].max(axis=0) == pytest.approx(np.full(4, 0.3), abs=3e-4)
    assert -np.sqrt(2 * 9.81 * 0.3) * 1e-4 <= heights.min() < 0
    one = heights[:, 0]
    inside = int(np.flatnonzero(one < 0)[0])
    assert one[inside + 1] == pytest.approx(one[inside - 1], abs=1e-15)  # eq. (17)
    # and so is the whole fall before it, mirrored at the contact
    assert one[inside + 1 : 2 * inside + 1] == pytest.approx(one[inside - 1 :: -1], abs=1e-10)


def test_the_bouncing_lattice_is_the_references():
    result = dropped(500.0)
    rest = reference.rest_lattice((2, 2, 2), size=(0.1, 0.1, 0.1))
    springs = reference.spring_list((2, 2, 2))
    model = reference.Model(rest, springs, np.full(len(springs), 500.0), np.full(8, 0.1), np.zeros(8))
    external = np.tile([0.0, 0.0, -0.981], (8, 1))
    ground = (np.zeros(3), np.array([0.0, 0.0, 1.0]))
    course = reference.central_difference(
        model, rest + np.array([0.0, 0.0, 0.2]), np.zeros((8, 3)), 1e-4, 3000, external=external, plane=ground
    )
    # round-off in positions is multiplied at every bounce, so that agreement is followed over the first of them
    assert points(result)[:3000] == pytest.approx(course[:3000], abs=1e-9)
    assert course[:3000, :, 2].min() < 0


def test_the_published_rule_presses_with_twice_the_impulse_of_an_inelastic_landing():
    impulses = {
        method: -1e-4 * dropped(0.0, **{"solver.method": method}).outputs["plane.ground.reaction.z"][2000:2040].sum()
        for method in ("central_difference", "leapfrog")
    }
    landing = 0.4 * np.sqrt(2 * 9.81 * 0.2)  # kg m/s of the four lower points
    weight = 0.4 * 9.81 * 20e-4  # their weight carried after the landing, at most
    assert impulses["leapfrog"] == pytest.approx(landing, abs=weight)
    assert impulses["central_difference"] == pytest.approx(2 * landing, rel=1e-2)
