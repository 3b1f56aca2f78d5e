"""From where one looks first: no obstacle is seen from its solid side, where there is such a place."""

from dataclasses import replace

import numpy as np
import pytest

from made_up_run import made_up_run, with_solids
from softffd.scene.rigid import Sphere
from softffd.show.sight import DISTANCES, back_of, first_sight
from softffd.show.stage import VIEW, PlaneTrack, stage_of


def plane(normal, distance, frames, centre):
    normal = np.array(normal) / np.linalg.norm(normal)
    across = np.cross(normal, [0.36, 0.48, 0.8])
    rows = (np.tile(each, (frames, 1)) for each in (centre - distance * normal, normal, across / np.linalg.norm(across)))
    return PlaneTrack("wall", (0.5, 0.5, 0.5), *rows, is_floor=False)


def with_planes(*walls):
    stage = stage_of(made_up_run())
    return replace(stage, planes=tuple(plane(*wall, len(stage.time), stage.centre) for wall in walls))


def test_the_usual_view_where_nothing_is_in_the_way():
    assert first_sight([with_planes()]) == VIEW and first_sight([with_planes(((0, 0, 1), 0.6))]) == VIEW


@pytest.mark.parametrize("normal", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (1, 1, 0.2), (-1, 0.5, -0.3), (0, 0, -1)])
def test_the_eye_is_on_the_free_side_of_a_wall_and_above_the_ground(normal):
    stage = with_planes((normal, 1.5), ((0, 0, 1), 0.9))
    back = back_of(stage.up, *first_sight([stage]))
    for distance in DISTANCES:
        eye = stage.centre + distance * stage.radius * back
        assert all(each.gap(0, eye[None])[0] > 0 for each in stage.planes)


def test_a_solid_does_not_hide_the_object():
    """One that stands where the usual view is from, so near that it hides the middle."""
    usual = stage_of(made_up_run())
    place = usual.centre + 0.7 * usual.radius * back_of(usual.up, *VIEW)
    stage = stage_of(with_solids(made_up_run(), Sphere(name="ball", radius=0.4, point=tuple(place))))
    stage = replace(stage, planes=())
    turn, lift = first_sight([stage])
    way = back_of(stage.up, turn, lift)
    places = stage.positions[20].mean(axis=(0, 1, 2)) + np.linspace(0, 4, 200)[:, None] * stage.radius * way
    assert (turn, lift) != VIEW and lift > 0 and stage.solids[0].gap(20, places).min() > 0


def test_a_press_is_seen_from_below_and_its_table_from_above():
    """While it goes down: from behind for less than half of the time, where the usual view is behind it all the time."""
    stage = stage_of(made_up_run())
    press = next(each for each in stage.planes if each.name == "press")

    def behind(view):
        eye = stage.centre + 4 * stage.radius * back_of(stage.up, *view)
        return np.mean([press.gap(frame, eye[None])[0] < 0 for frame in range(41)])

    assert behind(VIEW) == 1 and behind(first_sight([stage])) < 0.5
