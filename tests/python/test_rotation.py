"""Rotations as vectors."""

import numpy as np
import pytest

from softffd.rotation import between_directions, between_orientations, quaternion, quaternions, turned

X, Y, Z = np.eye(3)


def test_each_row_has_its_own_turn_and_no_turn_changes_nothing():
    vectors = np.random.default_rng(2).normal(size=(3, 3))
    moved = turned(vectors, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, np.pi], [2 * np.pi, 0.0, 0.0]]))
    expected = [vectors[0], vectors[1] * [-1, -1, 1], vectors[2]]
    assert moved == pytest.approx(np.array(expected), abs=1e-14)
    np.testing.assert_array_equal(moved[0], vectors[0])
    assert turned(X, Z * np.pi / 2) == pytest.approx(Y, abs=1e-15)


def test_quaternions_of_matrices_are_those_of_the_turns_without_a_change_of_sign():
    turns = np.linspace(0.0, 7.0, 30)[:, None] * np.array([0.48, -0.6, 0.64])  # over half a turn and a whole one
    matrices = np.stack([turned(np.broadcast_to(axis, turns.shape), turns) for axis in np.eye(3)], axis=-1)
    found = quaternions(matrices)
    assert found == pytest.approx(np.stack([quaternion(turn) for turn in turns]), abs=1e-12)


def test_the_turn_between_two_directions_takes_one_to_the_other_and_there_is_none_from_nothing():
    first, last = np.array([1.0, 2.0, -0.5]), np.array([-0.3, 0.1, 4.0])
    moved = turned(first / np.linalg.norm(first), between_directions(first, last))
    assert moved == pytest.approx(last / np.linalg.norm(last), abs=1e-15)
    assert between_directions(first, 3 * first) == pytest.approx(np.zeros(3))
    assert not between_directions(np.zeros(3), X).any() and not between_orientations(np.zeros(4), np.eye(4)[1]).any()


@pytest.mark.parametrize("angle", [0.3, -0.3, 3.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_turn_between_two_orientations_is_the_shortest(angle, sign):
    last = sign * 2.5 * np.array([np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0])
    assert between_orientations(np.array([1.0, 0.0, 0.0, 0.0]), last) == pytest.approx(angle * Y, abs=1e-15)


def test_the_turn_between_two_orientations_is_in_the_world_frame():
    about_z, about_x = np.array([np.cos(0.4), 0, 0, np.sin(0.4)]), np.array([np.cos(0.1), np.sin(0.1), 0, 0])
    w, v = about_x[0] * about_z[0], about_x[0] * about_z[1:] + about_z[0] * about_x[1:] + np.cross(about_x[1:], about_z[1:])
    assert between_orientations(about_z, np.array([w, *v])) == pytest.approx(0.2 * X, abs=1e-15)


def test_a_rotation_vector_and_its_quaternion_turn_alike():
    turn = np.array([0.3, -1.2, 0.7])
    assert between_orientations(np.array([1.0, 0.0, 0.0, 0.0]), quaternion(turn)) == pytest.approx(turn, abs=1e-15)
    np.testing.assert_array_equal(quaternion(np.zeros(3)), [1.0, 0.0, 0.0, 0.0])
