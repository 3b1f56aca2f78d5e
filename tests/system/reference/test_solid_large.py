"""Solids at large strains, by runs that drag takes to rest: a slender beam against the elastica, a bonded block against another program."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from scenes import box
from softffd import simulate


def elastica(force):
    """Deflection and shortening of the tip of an inextensible cantilever, by its length, under a force across it of `force` times EI / L^2:
    theta'' = -force cos theta (Bisshopp & Drucker 1945)."""
    s = np.linspace(0.0, 1.0, 401)
    found = solve_bvp(
        lambda _, y: np.stack([y[1], -force * np.cos(y[0])]),
        lambda start, end: np.array([start[0], end[1]]),
        s,
        np.stack([np.minimum(force, 1.5) * (s - s**2 / 2), np.minimum(force, 1.5) * (1 - s)]),
        tol=1e-8,
    )
    angle = found.sol(s)[0]
    return np.trapezoid(np.sin(angle), s), 1 - np.trapezoid(np.cos(angle), s)


@pytest.mark.short("10")
@pytest.mark.parametrize("force", [1, 2, 5, 10])
def test_a_slender_cantilever_bends_as_the_elastica(force):
    """What it bends more is shear and stretch of a beam twenty times as long as high."""
    modulus, length = 1e6, 20.0
    beam = box(
        lattice={"points": [25, 4, 4], "size": [length, 1.0, 1.0]},
        material={"model": "solid", "youngs_modulus": modulus, "poissons_ratio": 0.0, "damping": 0.25},
        mass={"density": 1.0},
        pin=[{"name": "wall", "points": "x-"}],
        load=[{"name": "tip", "points": "x+"}],
        solver={"method": "leapfrog"},
        stop_time=10.0,
        communication_step=0.1,
    )
    result = simulate(beam, inputs=lambda _time: {"load.tip.z": force * modulus / 12 / length**2})
    tip = result.positions[-1, -1].mean(axis=(0, 1))
    deflection, shortening = elastica(force)
    assert (tip[2] - 0.5) / length == pytest.approx(deflection, rel=6e-3)
    assert 1 - tip[0] / length == pytest.approx(shortening, rel=6e-3)


def pressed(points, ratio, height):
    """The force [modulus times side squared] on the faces of a unit cube that are bonded to plates `height` apart."""
    block = box(
        lattice={"points": [points] * 3},
        material={"model": "solid", "youngs_modulus": 1e4, "poissons_ratio": ratio, "damping": 200.0 / points**3},
        mass={"density": 1.0},
        pin=[
            {"name": "below", "points": "z-"},
            {"name": "above", "points": "z+", "motion": "input", "inputs": ["position.z", "velocity.z"]},
        ],
        solver={"method": "leapfrog"},
        stop_time=3.0,
        communication_step=0.02,
    )
    fall = height - 1
    moved = simulate(block, inputs=lambda t: {"pin.above.position.z": 1 + fall * min(t, 1.0), "pin.above.velocity.z": fall * (t < 1)})
    return moved.outputs["pin.above.reaction.z"][-1] / 1e4


def test_a_bonded_block_presses_as_in_another_program():
    """27-node bricks of degree 2 with full integration on a graded grid, of 125 in an eighth: 0.10954."""
    assert pressed(7, 0.25, 0.9) == pytest.approx(0.10954, rel=1.5e-3)


@pytest.mark.parametrize(
    ("ratio", "height", "coarse", "fine"), [(0.25, 0.7, 2e-3, 1e-3), (0.45, 0.9, 0.04, 3e-3)], ids=["0.25", "0.45"]
)  # fmt: skip
def test_the_force_of_a_bonded_block_settles_with_its_patches(ratio, height, coarse, fine):
    forces = [pressed(points, ratio, height) for points in (4, 7, 10)]
    assert abs(forces[0] / forces[2] - 1) < coarse and abs(forces[1] / forces[2] - 1) < fine
