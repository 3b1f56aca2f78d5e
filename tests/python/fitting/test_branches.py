"""Curves of runs at the places of data, over time and over displacements that go back and forth."""

import numpy as np
import pytest

from softffd import FmuError
from softffd.fitting.branches import OverAnother, at_middles, branches, over_time

GOES = np.interp(np.linspace(0, 4, 401), [0, 1, 1.5, 2.5, 4], [0, 2, 2, 0.5, 3])
"""Up, a rest, down, up"""


def test_a_column_is_cut_where_it_turns():
    assert [(branch.first, branch.last, branch.sign) for branch in branches(GOES, 0.1)] == [(0, 100, 1), (100, 250, -1), (250, 400, 1)]
    noisy = GOES + np.random.default_rng(1).uniform(-0.04, 0.04, len(GOES))
    assert [branch.sign for branch in branches(noisy, 0.1)] == [1, -1, 1]
    assert branches(np.full(5, 2.0), 0.1) == []


def test_each_way_has_its_own_values_and_a_rest_ends_the_way_before_it():
    force = np.gradient(GOES) * 10 + GOES + np.linspace(0, 1, len(GOES)) * (GOES == 2)  # relaxes in its rest
    rows = np.array([3, 50, 90, 170, 220, 240, 300, 390])
    over = OverAnother("x", GOES[rows])
    assert over(GOES, force) == pytest.approx(force[rows], abs=1e-12)
    first = OverAnother("x", np.array([0.0, 1.0, 2.0]))
    assert first(GOES, force)[-1] == pytest.approx(force[100])


def test_data_end_before_the_run_does_but_not_behind_it():
    up = np.linspace(0, 1, 11)
    assert OverAnother("x", np.array([0.1, 0.55]))(up, 2 * up, strict=True) == pytest.approx([0.2, 1.1])
    with pytest.raises(FmuError, match=r"x: the run goes from 0 to 1 there, row 1 of the data has 1\.5"):
        OverAnother("x", np.array([0.1, 1.5]))(up, up, strict=True)


def test_other_ways_are_refused_in_words():
    with pytest.raises(FmuError, match="x: in the data it grows, falls, in the run it grows"):
        OverAnother("x", np.array([0, 1, 0.5]))(np.linspace(0, 1, 5), np.zeros(5))
    with pytest.raises(FmuError, match="x: in the data it falls, in the run it rests"):
        OverAnother("x", np.array([1, 0.5]))(np.ones(5), np.zeros(5))
    with pytest.raises(FmuError, match=r"x: wanted a column that changes, .* got 2 in all rows"):
        OverAnother("x", np.full(3, 2.0))


def test_the_mean_of_a_step_belongs_to_its_middle():
    times = np.linspace(0, 1, 11)
    means = np.append(0, (times[1:] ** 2 - times[:-1] ** 2) / (2 * 0.1))  # of the function t
    middles = at_middles(times, times, mean=False, means=True)
    wanted = np.array([0.0, 0.33, 1.0])
    assert over_time(middles, at_middles(times, means, mean=True, means=True), wanted) == pytest.approx(wanted)
    assert over_time(times, at_middles(times, times, mean=False, means=False), wanted) == pytest.approx(wanted)
