"""The numpy solid under small strains, whose energy is the component's (tests/system/solid): frequencies, locking, a clamped bar.

References: Legendre polynomials of degree 14 and 16 in one brick for free bodies, to six digits; hp-refined elements for clamped ones, to
5e-5, 2e-4, 3e-4 and 3e-4 at Poisson's ratios .25, .45, .49 and .499 for the cube, to 6e-4 and 1e-3 at .45 and .49 for the bar. Errors in
per cent are those of this discretisation in another program. Modulus, density and height are 1; a bar is four times as long as high.
"""

import numpy as np
import pytest

from softffd.embedding.nodes import axis_shares
from solids import Patches, counts_of, node_masses, solid

BAR, FINE_BAR = (13, 4, 4), (13, 7, 7)


def body(points, ratio: float) -> Patches:
    """Of any Poisson's ratio, also one above those of a scene."""
    made = Patches(scene(points))
    made.mu = 1 / (2 * (1 + ratio))
    made.la = 2 * made.mu * ratio / (1 - 2 * ratio)
    return made


def scene(points):
    return solid(points, size=[4.0 if points in (BAR, FINE_BAR) else 1.0, 1.0, 1.0])


FREE = {
    "cube": {0.25: (1.80619, 2.42368, 2.47119), 0.45: (1.67746, 2.27819, 2.30233), 0.49: (1.65488, 2.25170, 2.27242)},
    "bar": {0.25: (0.33994, 0.45610, 0.75964, 0.78276), 0.45: (0.33741, 0.42349, 0.74437), 0.49: (0.33690, 0.41777, 0.74132)},
}
"""rad/s, of the first three families: two, three and three vibrations of the cube; bending (two), torsion, bending (two) of the bar"""
FAMILIES = {"cube": (0, 0, 1, 1, 1, 2, 2, 2), "bar": (0, 0, 1, 2, 2, 3)}


@pytest.mark.short("cube-*")
@pytest.mark.parametrize("ratio", [0.25, 0.45, 0.49])
@pytest.mark.parametrize(("kind", "points"), [("cube", 7), ("bar", FINE_BAR)], ids=["cube-7", "bar-13x7x7"])
def test_a_free_solid_has_the_frequencies_of_the_continuum(kind, points, ratio):
    found = body(points, ratio).modes(node_masses(scene(points)))[0][6:]
    wanted = [FREE[kind][ratio][family] for family in FAMILIES[kind] if family < len(FREE[kind][ratio])]
    assert found[: len(wanted)] == pytest.approx(wanted, rel=1.5e-3)


@pytest.mark.parametrize("ratio", [0.25, 0.45])
def test_the_frequencies_of_a_bar_of_one_patch_across_are_off_by_torsion(ratio):
    found = body(BAR, ratio).modes(node_masses(scene(BAR)))[0][[6, 8, 9]]
    assert 100 * (found / FREE["bar"][ratio][:3] - 1) == pytest.approx([0.04, 0.84, 0.13], abs=0.006)


def deflections(points, ratio: float) -> dict[str, float]:
    """Mean displacements [m] of the free end x+ of a body whose end x- is held, under 1 N."""
    (nx, *across), patches, mass = counts_of(points), body(points, ratio), node_masses(scene(points))
    end = np.arange(len(mass)).reshape(-1, nx)[:, -1]
    face = np.einsum("k,j->kj", *map(axis_shares, reversed(across))).ravel()
    free = np.tile(np.arange(len(mass)) % nx > 0, 3)
    loads = np.zeros((3, 3, len(mass)))
    loads[0, 0, end] = loads[1, 2, end] = face
    loads[2, 2] = mass / mass.sum()
    moved = np.zeros((3, 3 * len(mass)))
    moved[:, free] = np.linalg.solve(patches.stiffness()[np.ix_(free, free)], loads.reshape(3, -1)[:, free].T).T
    ends = moved.reshape(3, 3, -1)[..., end] @ face
    return {"pull": ends[0, 0], "shear": ends[1, 2], "weight across": ends[2, 2]}


CUBE = {0.25: (0.979972, 6.82476), 0.45: (0.927749, 6.85048), 0.49: (0.911641, 6.81387), 0.499: (0.907668, 6.80316)}
"""m, by pull and shear"""
LOCKING = {
    4: {0.25: (-0.21, -1.98), 0.45: (0.04, -2.96), 0.49: (0.33, -3.03), 0.499: (0.42, -3.04)},
    7: {0.25: (-0.09, -0.37), 0.45: (-0.09, -0.53), 0.49: (0.00, -0.49), 0.499: (0.02, -0.47)},
    10: {0.25: (-0.06, -0.19), 0.45: (-0.09, -0.29), 0.49: (-0.06, -0.25), 0.499: (-0.05, -0.24)},
}
CASES = [(n, ratio) for n, of in LOCKING.items() for ratio in of]


@pytest.mark.short("4-*", "7-*", "10-0.499")
@pytest.mark.parametrize(("n", "ratio"), CASES)
def test_a_clamped_cube_does_not_lock(n, ratio):
    found = deflections(n, ratio)
    errors = [100 * (found[load] / wanted - 1) for load, wanted in zip(("pull", "shear"), CUBE[ratio], strict=True)]
    assert errors == pytest.approx(LOCKING[n][ratio], abs=0.006)


CLAMPED_BAR = {0.25: (3.97989, 264.980, 100.521), 0.45: (3.92725, 259.589, 97.938), 0.49: (3.91094, 257.785, 97.064)}
OF_PATCHES = {0.25: (-0.05, -0.30, -0.40), 0.45: (-0.01, -0.58, -0.76), 0.49: (0.05, -0.56, -0.74)}
"""By the loads of `deflections`"""


@pytest.mark.parametrize("ratio", CLAMPED_BAR)
def test_a_clamped_bar_deflects_as_the_solid_does(ratio):
    errors = 100 * (np.array(list(deflections(BAR, ratio).values())) / CLAMPED_BAR[ratio] - 1)
    assert errors == pytest.approx(OF_PATCHES[ratio], abs=0.006)
