"""Facts about the basis functions: Bernstein polynomials, clamped uniform cubic B-splines, and patches of cubic Bernstein polynomials."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest
from scipy.interpolate import BSpline

from softffd.embedding.basis import bsplines, local_weights, parameter, weights

COUNTS = [2, 3, 4, 5, 6, 7, 9, 32]
AXES = [*((n, basis) for basis in ("bezier", "bspline") for n in COUNTS), *((n, "patches") for n in (4, 7, 10, 31))]
T = np.linspace(0.0, 1.0, 101)


@pytest.mark.parametrize(("n", "basis"), AXES)
class TestEveryBasis:
    def test_weights_sum_to_one(self, n, basis):
        np.testing.assert_allclose(weights(T, n, basis).sum(axis=1), 1.0, atol=n * 4e-16, rtol=0)

    def test_weights_reproduce_positions(self, n, basis):
        grid = np.arange(n) / (n - 1)
        np.testing.assert_allclose(weights(T, n, basis) @ grid, T, atol=n * 4e-16, rtol=0)

    def test_weights_are_not_negative_in_the_box(self, n, basis):
        assert weights(T, n, basis).min() >= 0

    def test_the_ends_belong_to_the_end_points_alone(self, n, basis):
        np.testing.assert_array_equal(weights(np.array([0.0, 1.0]), n, basis), np.eye(n)[[0, -1]])

    def test_both_ends_are_alike(self, n, basis):
        np.testing.assert_allclose(weights(1 - T, n, basis)[:, ::-1], weights(T, n, basis), atol=1e-14, rtol=0)

    def test_as_many_points_count_at_a_place_as_the_basis_says(self, n, basis):
        first, values = local_weights(T, n, basis)
        assert values.shape == (len(T), n if basis == "bezier" else min(n, 4))
        assert first.min() == 0 and (first + values.shape[1]).max() == n
        assert (np.count_nonzero(weights(T, n, basis), axis=1) <= values.shape[1]).all()

    def test_a_place_just_outside_is_reproduced_too(self, n, basis):
        outside, grid = np.array([-1e-6, 1 + 1e-6]), np.arange(n) / (n - 1)
        np.testing.assert_allclose(weights(outside, n, basis) @ grid, outside, atol=n * 4e-16, rtol=0)


def test_a_patch_has_the_bezier_weights_of_its_own_points():
    inside = T[(T > 1 / 3) & (T < 2 / 3)]
    expected = np.zeros((len(inside), 10))
    expected[:, 3:7] = weights(3 * inside - 1, 4)
    np.testing.assert_allclose(weights(inside, 10, "patches"), expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize("side", [-1e-15, 0.0, 1e-15])
def test_at_a_joint_both_patches_give_the_same(side):
    np.testing.assert_allclose(weights([0.5 + side], 7, "patches")[0], np.eye(7)[3], rtol=0, atol=1e-14)


@pytest.mark.parametrize("t, wanted", [(0.3, [0.343, 0.441, 0.189, 0.027]), (1.5, [0.25, -1.5, 2.25])], ids=["inside", "outside"])
def test_weights_are_those_of_equation_2_and_extrapolate_its_polynomial(t, wanted):
    np.testing.assert_allclose(weights([t], len(wanted))[0], wanted, rtol=1e-15)


@pytest.mark.parametrize("t", [2.0**-40, 0.25, 0.7001, 1.0 - 2.0**-20])
def test_weights_of_degree_31_are_exact_to_rounding(t):
    """Every factor is a rounded product, so the relative error is below 2 n units in the last place."""
    u, v = Fraction(t), 1 - Fraction(t)
    exact = [float(comb(31, i) * u**i * v ** (31 - i)) for i in range(32)]
    np.testing.assert_allclose(weights([t], 32)[0], exact, rtol=64 * 2.2e-16, atol=1e-300)


@pytest.mark.parametrize("n, basis", [(2, "bspline"), (3, "bspline"), (4, "bspline"), (4, "patches")])
def test_up_to_four_points_all_bases_are_one(n, basis):
    np.testing.assert_array_equal(weights(T, n, basis), weights(T, n, "bezier"))


@pytest.mark.parametrize("n", [5, 6, 8, 32])
def test_bsplines_are_those_of_scipy(n):
    s = np.linspace(0, n - 3, 200)[:-1]
    knots = np.r_[[0] * 3, np.arange(n - 2), [n - 3] * 3]
    first, values, slope = bsplines(s, n)
    every = BSpline.design_matrix(s, knots.astype(float), 3).toarray()
    np.testing.assert_allclose(np.take_along_axis(every, first[:, None] + np.arange(4), axis=1), values, atol=1e-14)
    np.testing.assert_allclose(BSpline(knots, np.arange(n), 3).derivative()(s), slope, rtol=1e-13)


def test_inside_the_lattice_weights_are_the_uniform_ones():
    """Two cells from the ends the parameter is the place; at a control point the weights are 1/6, 4/6, 1/6."""
    np.testing.assert_allclose(weights([0.5], 9, "bspline")[0, 3:6], np.array([1, 4, 1]) / 6, rtol=1e-14)
    np.testing.assert_allclose(parameter([0.4, 0.55], 21, "bspline"), [7.0, 10.0], rtol=1e-14)


def test_a_control_point_moves_only_what_is_near():
    near = np.abs(T[:, None] - np.arange(12) / 11) * 11
    assert (weights(T, 12, "bspline")[near > 3] == 0).all()
    assert (weights(T, 12, "bspline")[:, 5:7][near[:, 5:7] > 2] == 0).all()


def test_the_weights_bend_without_a_jump():
    """The second difference across the knots of the end spans is as smooth as elsewhere: its jumps fall with the step."""
    jumps = []
    for steps in (400, 800, 1600):
        second = np.diff(weights(np.linspace(0, 1, steps * 7 + 1), 8, "bspline"), 2, axis=0) * (steps * 7) ** 2
        jumps.append(np.abs(np.diff(second, axis=0)).max())
    assert jumps[2] < 0.6 * jumps[1] < 0.6 * 0.6 * jumps[0]
