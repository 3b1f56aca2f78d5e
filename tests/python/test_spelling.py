"""The nearest right word to a wrong one."""

import pytest

from softffd.spelling import did_you_mean, nearest_of


@pytest.mark.parametrize("given, nearest", [("stifness", "stiffness"), ("STIFNESS", "stiffness"), ("-z", "z-"), ("unrelated", None)])
def test_the_nearest_word_is_near_in_spelling_or_has_the_same_letters(given, nearest):
    assert nearest_of(given, ["stiffness", "damping", "z-"]) == nearest


def test_the_choice_keeps_its_own_capitals():
    assert nearest_of("solver.Method", ["Solver.method"]) == "Solver.method"


def test_no_nearest_word_is_no_question():
    assert did_you_mean(None) == "" and did_you_mean("press") == ', did you mean "press"?'
