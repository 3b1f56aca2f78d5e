from dataclasses import replace

import numpy as np
import pytest

from made_up_run import ORIGIN, SIZE, made_up_run, rest_points, with_mesh
from softffd.errors import SoftffdError
from softffd.mesh.mesh import Mesh
from softffd.run.findings import energies, heights, reactions
from softffd.show.stage import round_length, stage_of

TRIANGLE = Mesh(ORIGIN + SIZE * np.array([[0.1, 0.2, 0.3], [0.9, 0.2, 0.4], [0.5, 0.8, 0.6]]), np.array([[0, 1, 2]]))


def test_box_without_lattice_and_mesh_is_that_of_the_first_frame():
    result = replace(made_up_run(), lattice=None)
    stage = stage_of(replace(result, positions=result.positions + 5.0))
    assert np.allclose(stage.origin, ORIGIN + 5.0 + [0, 0, 0.8]) and np.allclose(stage.size, SIZE)


def test_surface_at_rest_is_the_mesh_in_the_box_of_the_lattice():
    stage = stage_of(with_mesh(made_up_run(), TRIANGLE))
    assert stage.origin.tolist() == ORIGIN.tolist()
    assert np.allclose(stage.deformed(stage.rest), TRIANGLE.vertices)
    assert np.allclose(stage.rest, rest_points((4, 4, 4)))


def test_edges_join_neighbours_along_the_axes():
    stage = stage_of(made_up_run(counts=(4, 3, 2)))
    flat = stage.rest.transpose(2, 1, 0, 3).reshape(-1, 3)
    steps = (flat[stage.edges[:, 1]] - flat[stage.edges[:, 0]]) / (SIZE / [3, 2, 1])
    assert len(stage.edges) == 3 * 3 * 2 + 4 * 2 * 2 + 4 * 3 * 1
    assert np.allclose(np.sort(steps, axis=1), [0, 0, 1])


def test_normals_and_tangents_of_planes_are_orthonormal_while_a_plane_tumbles():
    result = made_up_run()
    turn = 5 * result.time
    swing = {f"plane.press.normal.{a}": v for a, v in zip("xyz", (np.cos(turn), np.sin(turn), 0 * turn), strict=True)}
    press = stage_of(replace(result, inputs=result.inputs | swing)).planes[1]
    assert np.allclose(np.linalg.norm(press.tangents, axis=1), 1)
    assert np.allclose(np.einsum("ta,ta->t", press.normals, press.tangents), 0)
    assert np.abs(np.diff(press.tangents, axis=0)).max() < 0.5


def test_up_is_against_gravity():
    result = made_up_run()
    result.scene.environment.gravity = (0.0, -5.0, 0.0)
    assert stage_of(result).up.tolist() == [0, 1, 0]


UNRECORDED = r'1 of its 64 control points.*outputs.positions = "all", and "position" in output= where'
TOO_FAR = r"its control points go as far as .* m. Wanted: 1e[+]15 m at most"


@pytest.mark.parametrize("place, words", [(np.nan, UNRECORDED), (np.inf, TOO_FAR), (1e200, TOO_FAR)])
def test_places_that_were_not_recorded_or_that_no_picture_holds_are_refused(place, words):
    result = made_up_run()
    result.positions[:, 1, 2, 3] = place
    with pytest.raises(SoftffdError, match=words):
        stage_of(result)


def test_a_run_without_control_points_is_refused():
    result = made_up_run()
    with pytest.raises(SoftffdError, match="its FMU has no control points"):
        stage_of(replace(result, lattice=None, positions=result.positions[:, :0, :0, :0]))


def test_the_surface_follows_the_basis_of_the_lattice():
    """One control point moved: all of a Bezier volume moves, of B-splines only what is near, of patches its own."""
    result = made_up_run(counts=(10, 4, 4))
    moved = result.positions[0].copy()
    moved[0, 0, 0, 2] += 1.0
    reach = []
    for basis in ("bezier", "bspline", "patches"):
        stage = stage_of(replace(result, lattice=replace(result.lattice, basis=basis)))
        change = (stage.deformed(moved) - stage.deformed(result.positions[0]))[:, 2]
        reach.append(((stage.vertices[change > 1e-12] - ORIGIN) / SIZE).max(axis=0)[0])
    assert reach[0] > 0.9 and 0.1 < reach[1] < 2 / 9 and 0.25 < reach[2] < 1 / 3


@pytest.mark.parametrize(("length", "rounded"), [(1.0, 1.0), (0.99, 0.5), (7.0, 5.0), (0.021, 0.02), (300.0, 200.0)])
def test_round_lengths_are_one_two_or_five(length, rounded):
    assert np.isclose(round_length(length), rounded)


def test_history_finds_reactions_and_energies_by_name():
    result = made_up_run()
    on_pin = {f"pin.base.reaction.{c}": np.full(len(result.time), force) for c, force in zip("xyz", (1.0, 2.0, 3.0), strict=True)}
    found = reactions(replace(result, outputs=on_pin | result.outputs))
    assert [str(part) for part in found] == ["plane.ground", "plane.press", "pin.base"]
    assert found["plane", "press"][:, 2].max() > 1900 and found["pin", "base"][-1].tolist() == [1, 2, 3]
    assert list(energies(result)) == ["kinetic", "elastic"]


def test_heights_are_measured_along_up():
    found = heights(made_up_run(), [0, 0, 1])
    assert np.isclose(found["lowest point"][0], ORIGIN[2] + 0.8)
    assert np.isclose(found["highest point"][0], ORIGIN[2] + 0.8 + SIZE[2])


def test_a_deformation_is_what_a_rigid_motion_leaves():
    result, rest = made_up_run(frames=9), rest_points((4, 4, 4))
    turns = [np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) for a in result.time]
    result = replace(result, positions=np.stack([rest @ turn.T + [3, 4, height] for height, turn in enumerate(turns)]))
    assert result.deformation().max() < 1e-7
    result.positions[4] = rest * [1.5, 1, 1]
    x = rest[..., 0]
    assert np.isclose(result.deformation()[4], 0.5 * abs(x - x.mean()).max())
    result.positions[4] = rest * [-1, 1, 1]  # mirrored
    assert result.deformation()[4] > 0.1
