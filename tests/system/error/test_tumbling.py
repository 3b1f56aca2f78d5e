"""A free body that turns about its middle axis of inertia flips over, and tiny errors decide when: the error at the end of the run keeps
the promise all the same."""

import numpy as np
import pytest

from readings import points
from scenes import box
from softffd import simulate

TOLERANCE = 1e-4
SLAB = {"lattice": {"size": [1.0, 0.4, 0.1]}, "mass": {"total": 1.0, "distribution": "box", "uniform_share": 0.0}}
"""Moments of inertia of 0.17, 1.01 and 1.16 kg m2 / 12"""


def tumbling(points, stiffness, internal_damping, spin, stop):
    material = {"stiffness": stiffness, "damping": 0.0, "internal_damping": internal_damping}
    slab = {**SLAB, "lattice": {**SLAB["lattice"], "points": points}}
    return box(**slab, material=material, angular_velocity=spin, stop_time=stop, communication_step=0.01, tolerance=TOLERANCE)


@pytest.mark.short("stiff")
@pytest.mark.parametrize(
    ("body", "method", "tolerance"),
    [
        pytest.param(([3, 3, 3], 1e6, 0.0, [0.01, 12.0, 0.01], 8.8), "leapfrog", 1e-4, id="stiff"),
        pytest.param(([4, 4, 4], 3e5, 0.0, [0.01, 12.0, 0.01], 8.8), "leapfrog", 1e-4, id="less stiff"),
        pytest.param(([4, 4, 4], 1e5, 1e-3, [0.01, 20.0, 0.01], 1.5), "dop853", 1e-4, id="damped"),
    ],
)
def test_a_body_that_flips_over_keeps_ten_tolerances(body, method, tolerance):
    """In the floating frame and with leapfrog's dashpots, errors far below the tolerance became hundreds of tolerances."""
    scene = tumbling(*body)
    found, exact = simulate(scene), simulate(scene, method=method, tolerance=tolerance)
    assert np.abs(points(found)[-1] - points(exact)[-1]).max() < 10 * TOLERANCE


def test_a_run_in_which_rounding_decides_on_flips_says_so():
    """About the middle axis to the last bit, the exact motion never flips over."""
    run = simulate(tumbling([3, 3, 3], 1e5, 0.0, [0.0, 12.0, 0.0], 8.8))
    off = np.abs(points(run)[..., 1] - points(run)[0, :, 1]).max()
    warnings = [each for each in run.summary["warnings"] if "rounding grows while the body tumbles" in str(each)]
    assert off > 0.1 and len(warnings) == 1


@pytest.mark.parametrize("spin", [[12.0, 0.0, 0.1], [0.1, 0.0, 12.0], [0.1, 0.1, 0.1]])
def test_a_stable_turn_warns_of_nothing(spin):
    assert not simulate(tumbling([3, 3, 3], 1e4, 0.0, spin, 1.0)).summary["warnings"]
