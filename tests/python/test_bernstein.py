"""Facts about the Bernstein polynomials."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest

from softffd.bernstein import weights

COUNTS = [2, 3, 4, 9, 32]
T = np.linspace(0.0, 1.0, 101)


@pytest.mark.parametrize("n", COUNTS)
def test_weights_sum_to_one(n):
    np.testing.assert_allclose(weights(T, n).sum(axis=1), 1.0, atol=n * 4e-16, rtol=0)


@pytest.mark.parametrize("n", COUNTS)
def test_weights_reproduce_positions(n):
    grid = np.arange(n) / (n - 1)
    np.testing.assert_allclose(weights(T, n) @ grid, T, atol=n * 4e-16, rtol=0)


@pytest.mark.parametrize("n", COUNTS)
def test_weights_are_not_negative_in_the_box(n):
    assert weights(T, n).min() >= 0


@pytest.mark.parametrize("n", COUNTS)
def test_the_ends_belong_to_the_end_points_alone(n):
    np.testing.assert_array_equal(weights(np.array([0.0, 1.0]), n), np.eye(n)[[0, -1]])


def test_cubic_weights_are_those_of_equation_2():
    t = 0.3
    np.testing.assert_allclose(weights([t], 4)[0], [0.343, 0.441, 0.189, 0.027], rtol=1e-15)


@pytest.mark.parametrize("t", [2.0**-40, 0.25, 0.7001, 1.0 - 2.0**-20])
def test_weights_of_degree_31_are_exact_to_rounding(t):
    """Every factor is a rounded product, so the relative error is below 2 n units in the last place."""
    u, v = Fraction(t), 1 - Fraction(t)
    exact = [float(comb(31, i) * u**i * v ** (31 - i)) for i in range(32)]
    np.testing.assert_allclose(weights([t], 32)[0], exact, rtol=64 * 2.2e-16, atol=1e-300)


def test_weights_extrapolate_the_polynomial():
    np.testing.assert_allclose(weights([1.5], 3)[0], [0.25, -1.5, 2.25], rtol=1e-15)
