import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from softffd.scene.selection import FACES, Selection, flat_indices

COUNTS = (4, 3, 2)


def selected(raw, counts=COUNTS):
    return flat_indices(TypeAdapter(Selection).validate_python(raw), counts)


def flat(i, j, k, counts=COUNTS):
    return i + counts[0] * (j + counts[1] * k)


@pytest.mark.parametrize(
    "raw, points",
    [
        *[(everything, range(24)) for everything in ("all", {})],
        *[(nothing, []) for nothing in ("none", [])],
        ([[3, 2, 1], [0, 0, 0], [1, 0, 1]], [flat(3, 2, 1), 0, flat(1, 0, 1)]),
        ({"i": [1, 2], "k": [1, 1]}, sorted(flat(i, j, 1) for i in (1, 2) for j in range(3))),
    ],
)
def test_a_list_keeps_its_order_ranges_include_both_ends_and_an_absent_axis_is_all_of_it(raw, points):
    found = selected(raw)
    assert found.tolist() == list(points) and found.dtype == np.int64 and found.ndim == 1


@pytest.mark.parametrize("face", FACES)
def test_a_face_holds_the_points_at_its_end_of_the_axis(face):
    axis, end = "xyz".index(face[0]), 0 if face[1] == "-" else COUNTS["xyz".index(face[0])] - 1
    everything = [(i, j, k) for k in range(2) for j in range(3) for i in range(4)]
    assert selected(face).tolist() == [flat(*point) for point in everything if point[axis] == end]


LIMITS = r"4 x 3 x 2 lattice \(i 0..3, j 0..2, k 0..1\), got"


@pytest.mark.parametrize(
    "raw, words",
    [
        *[(outside, LIMITS) for outside in ([[4, 0, 0]], [[0, 0, 0], [0, 3, 0]], {"i": [0, 4]}, {"k": [2, 2]})],
        ([[1, 1, 1], [0, 0, 0], [1, 1, 1]], r"once, got \[1, 1, 1\] again"),
    ],
)
def test_points_outside_the_lattice_or_named_twice_are_refused(raw, words):
    with pytest.raises(ValueError, match=words):
        selected(raw)


@pytest.mark.parametrize("raw", ["top", 3, [[0, 0]], [0, 0, 0], [[0, 0, -1]], [[0, 0, 1.0]], {"i": 1}, {"i": [2, 1]}, {"x": [0, 1]}])
def test_what_is_no_selection_is_refused(raw):
    with pytest.raises(ValidationError):
        selected(raw)
