"""Standard errors and correlations of fitted parameters, and the parameters that the data cannot distinguish.

The standard errors are those of least squares with independent noise of one size (Seber & Wild 1989, section 2.1). The covariance of the
parameters' coordinates is s^2 (J^T J)^-1, with s^2 the sum of squares over rows less parameters. The data do not show a direction along
which the curve changes, over half of the parameters' scale, by less than the noise, or by less than the accuracy of the Jacobian.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from softffd.fitting.curve import Curve
from softffd.fitting.parameters import Parameter, values_of
from softffd.fitting.result import Fit
from softffd.spelling import few

WIDE = 0.5  # the data do not show a direction with a standard error of at least this, in units of the parameters' scale
TAKES_PART = 0.1  # a parameter belongs to a direction (a unit vector) if the square of its component exceeds this
LEAST = 1e-12  # least ratio of a singular value to the size of the curve, and to the largest singular value
KNOWN = 3.0  # a singular value counts if it is greater than this multiple of the Jacobian's error
CORRELATED = 3.0  # residuals are no noise if their correlation from row to row is above so many standard deviations of that of noise


class Jacobian(NamedTuple):
    """Derivatives of the curves by the coordinates of the parameters, the point where they were taken, and their accuracy."""

    point: np.ndarray  # (n,)
    columns: np.ndarray  # (m, n)
    errors: np.ndarray  # norms (n,) of the columns' errors


def estimate(
    parameters: Sequence[Parameter], jacobian: Jacobian, residuals: np.ndarray, curves: tuple[Curve, ...], *, runs: int, noise: float,
    converged: bool,
) -> Fit:  # fmt: skip
    """Returns the result at the best point. residuals: (m,), weighted, in the unit of the matched variable."""
    names, count = [parameter.name for parameter in parameters], len(parameters)
    deviation = float(np.sqrt(residuals @ residuals / (len(residuals) - count)))
    _, singular, directions = np.linalg.svd(jacobian.columns, full_matrices=False)
    known = np.sqrt(directions**2 @ jacobian.errors**2)  # error of each direction's singular value
    size = float(np.linalg.norm(np.concatenate([curve.fitted for curve in curves])))
    hidden = (singular <= np.maximum(KNOWN * known, LEAST * size)) | (deviation >= WIDE * singular)
    singular = np.maximum(singular, max(LEAST * singular[0], 1e-100))
    together = tuple(
        tuple(name for name, part in zip(names, direction, strict=True) if part**2 > TAKES_PART) for direction in directions[hidden]
    )
    lost = np.array([any(name in each for each in together) for name in names])
    covariance = (directions.T * (deviation / singular) ** 2) @ directions
    sizes = np.sqrt(np.diag(covariance))
    with np.errstate(divide="ignore", invalid="ignore"):
        correlations = covariance / np.outer(sizes, sizes)
    correlations[lost], correlations[:, lost] = np.nan, np.nan
    errors = {
        parameter.name: math.inf if gone else parameter.error(float(x), float(size))
        for parameter, x, size, gone in zip(parameters, jacobian.point, sizes, lost, strict=True)
    }
    values = values_of(list(parameters), jacobian.point)
    warnings = [*map(_undetermined, together), *_at_ends(parameters, values), *_correlated(curves, noise)]
    if not converged:
        warnings.append("the parameters still moved when the runs were ended: start nearer")
    warnings += [f"columns of the data that are not used: {few(curve.unused)}" for curve in curves if curve.unused]
    return Fit(
        values, errors, correlations, together, deviation, tuple(dict.fromkeys(warnings)), curves,
        {parameter.name: parameter.unit for parameter in parameters}, {parameter.name: parameter.start for parameter in parameters},
        runs, noise,
    )  # fmt: skip


def _undetermined(names: tuple[str, ...]) -> str:
    if len(names) == 1:
        return f"{names[0]} cannot be told from these data: it has no effect on them, or one within the noise"
    return f"{', '.join(names[:-1])} and {names[-1]} cannot be told apart from these data: other values together give the same curve"


def _at_ends(parameters: Sequence[Parameter], values: dict[str, float]) -> list[str]:
    found = []
    for each in parameters:
        for end in (each.least, each.most):
            if math.isfinite(each.scale) and not each.positive and abs(values[each.name] - end) < 1e-6 * each.scale:
                found.append(f"{each.name} is at the end of its range, {end:g}, where its standard error does not hold")
    return found


def _correlated(curves: tuple[Curve, ...], noise: float) -> list[str]:
    """Returns warnings for correlated residuals, which show that the model misses something: noise is not correlated, except the
    solver's."""
    found = []
    for curve in curves:
        rest = curve.measured - curve.fitted
        size = rest @ rest
        if len(rest) > 10 and size > len(rest) * noise**2 and rest[1:] @ rest[:-1] / size > CORRELATED / math.sqrt(len(rest)):
            found.append(
                "the residuals go up and down over many rows: the model does not follow the data, and standard errors are too small"
            )
    return found
