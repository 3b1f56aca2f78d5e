"""What pictures and page show of contact."""

from dataclasses import replace

import numpy as np
import pytest

from made_up_run import ORIGIN, SIZE, made_up_run, with_mesh
from softffd.embedding.nodes import rest_nodes
from softffd.lattice import to_flat
from softffd.mesh.mesh import Mesh
from softffd.obstacles import Obstacles
from softffd.show.skin import cage_surface
from softffd.show.stage import stage_of
from softffd.show.touch import LONGEST, MOST, narrow_contact, touch_of


def seen(*, of="lattice", divisions=None, **changes):
    """The contacts of the made-up run; with `divisions` its object is a mesh that fills the box."""
    result = replace(made_up_run(), obstacles=Obstacles(of), **changes)
    mesh = None if divisions is None else Mesh(*cage_surface(ORIGIN, SIZE, divisions=divisions))
    return result, touch_of(result, stage_of(with_mesh(result, mesh)))


def test_arrows_go_from_the_centre_of_pressure_along_the_force_on_the_obstacle():
    result, touch = seen()
    forces = np.abs(result.outputs["plane.ground.reaction.z"])
    for frame in np.flatnonzero(forces > 1e-6 * forces.max()):
        (low, low_end), (high, high_end) = touch.arrows(frame)
        np.testing.assert_allclose(low, [0.1, 0.05, 0.2])
        np.testing.assert_allclose(high[:2], [-0.1, 0.0])
        length = LONGEST * np.linalg.norm(SIZE) * np.sqrt(forces[frame] / forces.max())
        np.testing.assert_allclose(low_end - low, [0.0, 0.0, -length], atol=1e-12)
        np.testing.assert_allclose(high_end - high, [0.0, 0.0, length], atol=1e-12)
    assert touch.arrows(0).shape == (0, 2, 3)


@pytest.mark.parametrize("missing", [".centre.", ".reaction."])
def test_without_centres_or_reactions_there_are_no_arrows(missing):
    outputs = {name: values for name, values in made_up_run().outputs.items() if missing not in name}
    result, touch = seen(outputs=outputs)
    assert not any(len(touch.arrows(frame)) for frame in range(len(result.time)))
    assert len(touch.places(40)[0]) == 16


def test_control_points_or_vertices_touch_as_the_scene_says():
    for frame, touches in ((0, False), (24, True), (40, True)):
        points, vertices = seen(divisions=6)[1].places(frame)
        assert (len(points), len(vertices)) == (16 * touches, 0)
        points, vertices = seen(of="surface", divisions=6)[1].places(frame)
        assert (len(points), len(vertices)) == (0, 49 * touches)
        np.testing.assert_allclose(vertices[:, 2], 0.2, atol=1e-6)


def test_of_many_vertices_some_are_shown():
    _, vertices = seen(of="surface", divisions=40)[1].places(40)
    assert len(vertices) == MOST and np.ptp(vertices, axis=0)[:2] == pytest.approx(SIZE[:2], rel=0.05)


def test_of_another_fmu_whatever_is_on_an_obstacle_touches():
    result = replace(made_up_run(), obstacles=None)
    mesh = Mesh(*cage_surface(ORIGIN, SIZE, divisions=6))
    assert [len(each) for each in touch_of(result, stage_of(with_mesh(result, mesh))).places(40)] == [16, 49]


@pytest.mark.parametrize(("counts", "cells", "narrow"), [((4, 4, 4), 3.0, False), ((3, 4, 4), 2.0, True), ((2, 2, 2), 1.0, True)])
def test_a_patch_that_is_narrower_than_three_cells_is_told_once(counts, cells, narrow):
    found = narrow_contact(made_up_run(counts=counts))
    assert found["plane.ground.contact_cells"] == pytest.approx(cells)
    assert len(found["findings"]) == narrow
    if narrow:
        assert f"contact is narrower than 3 cells (ground: {cells:.2g}" in found["findings"][0]


def test_a_patch_without_width_is_a_point_or_a_line_and_a_run_that_touches_nothing_has_none():
    result = made_up_run()
    still = replace(result, outputs={name: 0 * values for name, values in result.outputs.items()})
    assert narrow_contact(still) == {"findings": []}
    lifted = result.positions.copy()
    lifted[:, 1:, ..., 2] += 0.1
    assert "(ground: a point or a line" in narrow_contact(replace(result, positions=lifted))["findings"][0]


def test_of_a_solid_its_nodes_touch():
    """They are where the faces are, and control points need not be: one that is far behind the ground does not touch it."""
    result = replace(made_up_run(), obstacles=Obstacles("lattice"))
    solid = replace(result, lattice=replace(result.lattice, basis="patches"))
    nodes = to_flat(rest_nodes((4, 4, 4), ORIGIN, SIZE))
    low = nodes[nodes[:, 2] < nodes[:, 2].min() + 1e-9]
    points, _ = touch_of(solid, stage_of(solid)).places(40)
    np.testing.assert_allclose(np.sort(points[:, 0] - points[:, 0].min()), np.sort(low[:, 0] - low[:, 0].min()), atol=1e-6)
    moved = solid.positions.copy()
    moved[40, 1, 1, 0, 2] -= 0.01
    stage = stage_of(replace(solid, positions=moved))
    assert len(touch_of(solid, stage).places(40)[0]) == 12
    np.testing.assert_allclose(stage.contact_points(stage.rest), nodes, atol=1e-14)
