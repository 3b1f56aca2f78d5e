"""The order of control points: flat, and by their indices."""

import numpy as np
import pytest

from softffd.lattice import all_points, index_grid, point_at, to_flat, to_grid

COUNTS = (3, 2, 4)


def flat_index(i, j, k):
    return i + 3 * (j + 2 * k)


def test_i_runs_fastest_then_j_then_k():
    assert list(all_points(COUNTS))[:4] == [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0)]
    assert [flat_index(*point) for point in all_points(COUNTS)] == list(range(24))
    assert [point_at(p, COUNTS) for p in range(24)] == list(all_points(COUNTS))
    grid = index_grid(COUNTS)
    assert grid.shape == COUNTS and all(grid[point] == flat_index(*point) for point in all_points(COUNTS))


@pytest.mark.parametrize("before", [(), (5,)])
def test_flat_and_grid_hold_the_same_rows(before):
    flat = np.random.default_rng(1).normal(size=(*before, 24, 3))
    grid = to_grid(flat, COUNTS)
    assert grid.shape == (*before, *COUNTS, 3)
    for i, j, k in all_points(COUNTS):
        np.testing.assert_array_equal(grid[..., i, j, k, :], flat[..., flat_index(i, j, k), :])
    np.testing.assert_array_equal(to_flat(grid), flat)
