"""The nearest right word to a wrong one, and the numbers that values mean."""

import numpy as np
import pytest

from softffd.errors import FmuError, MeshError, SoftffdError
from softffd.spelling import did_you_mean, nearest_of, one_number, whole_number


@pytest.mark.parametrize(
    "given, nearest, question",
    [
        ("stifness", "stiffness", ', did you mean "stiffness"?'),
        ("STIFNESS", "stiffness", ', did you mean "stiffness"?'),
        ("solver.Method", "Solver.method", ', did you mean "Solver.method"?'),
        ("-z", "z-", ', did you mean "z-"?'),
        ("unrelated", None, ""),
    ],
)
def test_the_nearest_word_is_near_in_spelling_or_has_the_same_letters_and_keeps_its_capitals(given, nearest, question):
    assert nearest_of(given, ["stiffness", "damping", "z-", "Solver.method"]) == nearest and did_you_mean(nearest) == question


@pytest.mark.parametrize("value", [2, 2.0, np.float32(2), np.array(2), True + True])
def test_any_kind_of_number_is_one(value):
    assert one_number("scale", value) == 2.0


@pytest.mark.parametrize("value", ["2", b"2", [2], np.array([2]), None, 2j])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(FmuError, match="scale: wanted one number, got "):
        one_number("scale", value)
    with pytest.raises(MeshError):
        one_number("scale", value, MeshError)


def test_whole_numbers_have_a_least():
    assert [whole_number("frames", value, 2) for value in (2, np.int64(7))] == [2, 7]
    for value in (1, 2.0, "2", None):
        with pytest.raises(SoftffdError, match=f"frames: wanted a whole number of at least 2, got {value!r}"):
            whole_number("frames", value, 2)
