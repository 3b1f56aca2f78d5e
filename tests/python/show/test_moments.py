from dataclasses import replace

import numpy as np

from made_up_run import made_up_run, rest_points
from softffd.show.moments import first_contact, telling_moments


def rigid_run():
    result = made_up_run(frames=9)
    turns = [np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) for a in result.time]
    moved = [rest_points((4, 4, 4)) @ turn.T + [3, 4, height] for height, turn in enumerate(turns)]
    return replace(result, positions=np.stack(moved))


def test_a_rigid_motion_is_no_deformation():
    assert rigid_run().deformation().max() < 1e-7


def test_a_stretch_is_a_deformation_of_its_size():
    result = rigid_run()
    result.positions[4] = rest_points((4, 4, 4)) * [1.5, 1, 1]
    x = rest_points((4, 4, 4))[..., 0]
    assert np.isclose(result.deformation()[4], 0.5 * abs(x - x.mean()).max())


def test_a_mirrored_lattice_is_deformed():
    result = rigid_run()
    result.positions[4] = rest_points((4, 4, 4)) * [-1, 1, 1]
    assert result.deformation()[4] > 0.1


def test_telling_moments_are_start_contact_largest_deformation_and_end():
    result = made_up_run()
    assert telling_moments(result) == {
        0: "start",
        17: "first contact",
        24: "largest deformation",
        40: "end",
    }


def test_a_contact_from_the_start_needs_no_picture_of_its_own():
    result = made_up_run(frames=201)
    touching = {name: np.where(result.time > 0, 1.0, 0.0) for name in result.outputs if "reaction" in name}
    assert list(telling_moments(replace(result, outputs=touching)).values()) == [
        "start",
        "largest deformation",
        "end",
    ]


def test_without_planes_there_is_no_contact():
    assert first_contact(replace(made_up_run(), outputs={})) is None
