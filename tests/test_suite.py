"""The long tests are shared out among groups that rotate."""

from pathlib import Path

from rotation import GROUP_SECONDS, LONGEST, chosen_group, groups, renewed

TESTS = [f"tests/a.py::test_{number}" for number in range(700)]
SECONDS = {test: 1.0 + 37 * number % 23 for number, test in enumerate(TESTS[:600])}


def test_every_long_test_is_in_one_group():
    assert sorted(test for part in groups(TESTS, SECONDS) for test in part) == sorted(TESTS)


def test_groups_are_evenly_filled_and_short_enough():
    filled = [sum(SECONDS.get(test, 3.0) for test in part) for part in groups(TESTS, SECONDS)]
    assert len(filled) > 4 and max(filled) <= GROUP_SECONDS and max(filled) - min(filled) <= 23.0  # s; the longest test


def test_what_is_longer_than_a_group_is_in_none():
    slow, together = TESTS[5], dict.fromkeys(TESTS[::10], "built together")
    seconds = SECONDS | {slow: LONGEST + 1} | dict.fromkeys(together, GROUP_SECONDS / len(together) + 1)
    assert {test for part in groups(TESTS, seconds, together) for test in part} == set(TESTS) - {slow, *together}


def test_a_bundle_stays_in_one_group():
    bundle = dict.fromkeys(TESTS[::20], "built together")
    assert sum(bool(set(part) & set(bundle)) for part in groups(TESTS, SECONDS)) > 1
    (holding,) = (part for part in groups(TESTS, SECONDS, bundle) if set(part) & set(bundle))
    assert set(bundle) <= set(holding)


def test_the_same_key_chooses_the_same_group_and_keys_reach_every_group():
    chosen = {frozenset(chosen_group(TESTS, SECONDS, f"commit {number}")[0]) for number in range(200)}
    assert chosen == {frozenset(part) for part in groups(TESTS, SECONDS)}
    assert chosen_group(TESTS, SECONDS, "abc") == chosen_group(TESTS, SECONDS, "abc")


def test_recorded_times_are_of_tests_that_there_are():
    here, moved = "tests/test_suite.py::test_a_bundle_stays_in_one_group", "tests/gone.py::test_a_bundle_stays_in_one_group"
    other, ran = "tests/test_suite.py::test_nobody_knows", "tests/test_suite.py::test_that_ran"
    kept = renewed({here: 2.0, moved: 1.0, other: 1.0, f"{ran}[old]": 3.0}, {f"{ran}[new]": 4.04}, Path(__file__).parents[1])
    assert kept == {here: 2.0, f"{ran}[new]": 4.0}
