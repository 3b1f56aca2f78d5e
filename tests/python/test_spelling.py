"""The nearest right word to a wrong one, and the numbers that values mean."""

import numpy as np
import pytest

from softffd.errors import FmuError, MeshError, SoftffdError
from softffd.spelling import did_you_mean, nearest_of, one_number, whole_number


@pytest.mark.parametrize("given, nearest", [("stifness", "stiffness"), ("STIFNESS", "stiffness"), ("-z", "z-"), ("unrelated", None)])
def test_the_nearest_word_is_near_in_spelling_or_has_the_same_letters(given, nearest):
    assert nearest_of(given, ["stiffness", "damping", "z-"]) == nearest


def test_the_choice_keeps_its_own_capitals():
    assert nearest_of("solver.Method", ["Solver.method"]) == "Solver.method"


def test_no_nearest_word_is_no_question():
    assert did_you_mean(None) == "" and did_you_mean("press") == ', did you mean "press"?'


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
