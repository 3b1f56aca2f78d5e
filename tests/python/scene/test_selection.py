import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from softffd.scene.selection import FACES, Selection, flat_indices

COUNTS = (4, 3, 2)


def selected(raw, counts=COUNTS):
    return flat_indices(TypeAdapter(Selection).validate_python(raw), counts)


def flat(i, j, k, counts=COUNTS):
    return i + counts[0] * (j + counts[1] * k)


def test_all_is_every_point_in_ascending_order():
    assert selected("all").tolist() == list(range(24))


def test_none_is_empty_and_still_an_index_array():
    assert selected("none").shape == (0,) and selected("none").dtype == np.int64
    assert selected([]).shape == (0,) and selected([]).dtype == np.int64


@pytest.mark.parametrize("face", FACES)
def test_a_face_holds_the_points_at_its_end_of_the_axis(face):
    axis, end = "xyz".index(face[0]), 0 if face[1] == "-" else COUNTS["xyz".index(face[0])] - 1
    everything = [(i, j, k) for k in range(2) for j in range(3) for i in range(4)]
    assert selected(face).tolist() == [flat(*point) for point in everything if point[axis] == end]


def test_a_list_keeps_its_order():
    assert selected([[3, 2, 1], [0, 0, 0], [1, 0, 1]]).tolist() == [flat(3, 2, 1), 0, flat(1, 0, 1)]


def test_ranges_include_both_ends_and_an_absent_axis_is_all_of_it():
    expected = sorted(flat(i, j, k) for i in (1, 2) for j in range(3) for k in (1,))
    assert selected({"i": [1, 2], "k": [1, 1]}).tolist() == expected
    assert selected({}).tolist() == list(range(24))


@pytest.mark.parametrize("raw", [[[4, 0, 0]], [[0, 0, 0], [0, 3, 0]], {"i": [0, 4]}, {"k": [2, 2]}])
def test_a_selection_outside_the_lattice_names_the_limits(raw):
    with pytest.raises(ValueError, match=r"4 x 3 x 2 lattice \(i 0..3, j 0..2, k 0..1\), got"):
        selected(raw)


def test_a_point_named_twice_is_refused():
    with pytest.raises(ValueError, match=r"once, got \[1, 1, 1\] again"):
        selected([[1, 1, 1], [0, 0, 0], [1, 1, 1]])


@pytest.mark.parametrize("raw", ["top", 3, [[0, 0]], [0, 0, 0], [[0, 0, -1]], [[0, 0, 1.0]], {"i": 1}, {"i": [2, 1]}, {"x": [0, 1]}])
def test_what_is_no_selection_is_refused(raw):
    with pytest.raises(ValidationError):
        selected(raw)
