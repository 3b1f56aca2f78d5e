"""Stress of a solid: closed forms of homogeneous deformations, what the projection keeps and what it drops, small strains, folded cells."""

import numpy as np
import pytest

from softffd import simulate
from softffd.lattice import LatticeBox
from softffd.run.stress import green_strain, lattice_gradients, lattice_stress, solid_stress
from softffd.scene.scene import scene_from
from solids import solid

COUNTS, SIZE = (7, 4, 10), (0.3, 0.22, 0.36)
LATTICE = LatticeBox(COUNTS, (0.0, 0.0, 0.0), SIZE, "patches")
RATIOS = [0.25, 0.45, 0.49]


def lame(ratio, modulus=1.0):
    return modulus / (2 * (1 + ratio)), modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))


def stress_of(gradient, ratio, modulus=1.0):
    """Of a homogeneous deformation, which every cell has alike, (3, 3)."""
    positions = LATTICE.rest() @ np.transpose(gradient) + [5.0, 1.0, -2.0]
    found = solid_stress(positions, SIZE, modulus, ratio)
    assert found.shape == (6, 3, 9, 3, 3)
    assert np.ptp(found, axis=(0, 1, 2)) == pytest.approx(0.0, abs=1e-12 * modulus * np.abs(gradient).max() ** 2 / (1 - 2 * ratio))
    return found[0, 0, 0]


@pytest.mark.parametrize("gradient", [np.eye(3), [[1.2, 0.1, 0.0], [0.3, 0.9, -0.2], [0.0, 0.4, 1.1]]])
def test_the_gradient_of_a_homogeneous_deformation_is_its_own_in_every_cell(gradient):
    found = lattice_gradients(LATTICE.rest() @ np.transpose(gradient), LATTICE)
    assert found == pytest.approx(np.broadcast_to(gradient, (6, 3, 9, 3, 3)), abs=1e-14)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("stretch", [0.5, 0.7, 1.5, 2.0])
def test_a_bar_that_is_stretched_with_free_sides_has_the_force_of_the_closed_form(ratio, stretch):
    """The sides are free where mu + (mu (J - 2) + lambda (J - 1)) s = 0, J = s t^2; P = mu s + (mu (J - 2) + lambda (J - 1)) t^2."""
    mu, lam = lame(ratio)
    volume = (2 * mu + lam - mu / stretch) / (mu + lam)
    side = np.sqrt(volume / stretch)
    force = mu * stretch + (mu * (volume - 2) + lam * (volume - 1)) * side**2
    found = stress_of(np.diag([stretch, side, side]), ratio)
    assert found == pytest.approx(np.diag([force / side**2, 0.0, 0.0]), abs=1e-11)
    if (ratio, stretch) in ((0.45, 0.5), (0.45, 2.0)):
        assert force == pytest.approx({0.5: -1.068965517, 2.0: 0.599137931}[stretch], abs=1e-9)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("shear", [0.1, 1.0])
def test_simple_shear_needs_the_shear_modulus_and_no_normal_force_in_the_first_stress(ratio, shear):
    gradient = np.eye(3)
    gradient[0, 2] = shear
    mu, _ = lame(ratio)
    first = stress_of(gradient, ratio) @ np.linalg.inv(gradient).T
    wanted = np.zeros((3, 3))
    wanted[0, 2] = wanted[2, 0] = mu * shear
    assert first == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("ratio", [0.0, 0.25, 0.495])
def test_a_small_strain_has_the_modulus_and_the_ratio_exactly(ratio):
    rng = np.random.default_rng(4)
    strain = rng.normal(size=(3, 3)) * 1e-7
    strain = strain + strain.T
    mu, lam = lame(ratio, 2e5)
    wanted = lam * np.trace(strain) * np.eye(3) + 2 * mu * strain
    assert stress_of(np.eye(3) + strain, ratio, 2e5) == pytest.approx(wanted, abs=1e-5 * np.abs(wanted).max())


def changed_along_x(derivative, amount):
    """Control points of one patch whose volume changes by amount times a polynomial of place along x, of which these are the values of its
    integral at 0, 1/3, 2/3, 1."""
    box = LatticeBox((4, 4, 4), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), "patches")
    places = np.arange(4) / 3
    bernstein = np.stack([[1, 3, 3, 1][i] * places**i * (1 - places) ** (3 - i) for i in range(4)], axis=1)
    positions = box.rest()
    positions[..., 0] += amount * np.linalg.solve(bernstein, derivative(places))[:, None, None]
    return positions


def test_pressure_follows_a_linear_change_of_volume_and_no_quadratic_one():
    """2 x - 1 is kept at the centres of the cells, -2/3, 0 and 2/3; Legendre's polynomial 6 x^2 - 6 x + 1 is dropped."""
    mu, lam = lame(0.45)
    for integral, values in ((lambda x: x**2 - x, np.array([-2.0, 0.0, 2.0]) / 3), (lambda x: 2 * x**3 - 3 * x**2 + x, np.zeros(3))):
        positions = changed_along_x(integral, 0.1)
        gradient = lattice_gradients(positions, LatticeBox((4, 4, 4), (0, 0, 0), (1, 1, 1), "patches"))
        change = np.linalg.det(gradient)
        local = mu * (gradient[..., 0, 0] ** 2 / change + change - 2)
        pressure = solid_stress(positions, (1.0, 1.0, 1.0), 1.0, 0.45)[..., 0, 0] - local
        assert pressure == pytest.approx(lam * 0.1 * np.broadcast_to(values[:, None, None], (3, 3, 3)), abs=1e-13)


def test_a_nearly_folded_cell_is_pushed_apart_and_a_folded_one_has_none():
    mu, lam = lame(0.45)
    for squeeze in (0.3, 0.2):
        pressure = mu * (squeeze - 2) + lam * (squeeze - 1) - lam * (0.3 - squeeze) ** 2 / 0.3
        wanted = mu * np.diag([squeeze, 1 / squeeze, 1 / squeeze]) + pressure * np.eye(3)
        assert stress_of(np.diag([squeeze, 1.0, 1.0]), 0.45) == pytest.approx(wanted, rel=1e-12)
    assert np.isnan(solid_stress(LATTICE.rest() * [1.0, -1.0, 1.0], SIZE, 1.0, 0.45)).all()


def test_patches_side_by_side_have_their_own_strain():
    """Stretched in the first patch, at rest in the second, 0.15 m each."""
    positions = LATTICE.rest()
    positions[..., 0] = 1.2 * positions[..., 0] - 0.2 * np.maximum(positions[..., 0] - 0.15, 0)
    strain = green_strain(lattice_gradients(positions, LATTICE))
    assert strain[:3, ..., 0, 0] == pytest.approx(np.full((3, 3, 9), 0.22), abs=1e-13)
    assert strain[3:] == pytest.approx(np.zeros((3, 3, 9, 3, 3)), abs=1e-13)


def test_the_material_is_the_scenes_unless_the_run_had_another():
    scene = scene_from({"lattice": {"points": list(COUNTS), "size": list(SIZE)}, "material": {"model": "solid", "youngs_modulus": 2e5}})
    positions = np.stack([LATTICE.rest() * stretch for stretch in (1.0, 1.1)])
    found = lattice_stress(positions, LATTICE, scene, {})
    rounding = 1e-14 * 2e5  # 2e-16 of strains, by 7e5 Pa, a dozen times over
    assert found.shape == (2, 6, 3, 9, 3, 3) and found[0] == pytest.approx(0.0, abs=rounding)
    assert found[1] == pytest.approx(solid_stress(positions[1], SIZE, 2e5, 0.45), rel=1e-15)
    harder = lattice_stress(positions, LATTICE, scene, {"youngs_modulus": 4e5, "poissons_ratio": 0.3})
    assert harder[1] == pytest.approx(solid_stress(positions[1], SIZE, 4e5, 0.3), rel=1e-15)


def test_a_bar_carries_its_load_through_every_section():
    """A run: sections of the first stress have the load but for what cubes of strain miss between the centres, and a quarter of the way
    from the wall the bar is pulled as it would be alone."""
    ends = {"pin": [{"name": "wall", "points": "x-"}], "load": [{"name": "pull", "points": "x+"}]}
    keys = {"modulus": 1e5, "ratio": 0.3, "density": 1000.0, "size": [0.4, 0.1, 0.1], "damping": 0.3}
    bar = solid([13, 4, 4], **keys, **ends, method="leapfrog", stop_time=6.0, communication_step=0.1)
    result = simulate(bar, inputs=lambda _time: {"load.pull.x": 1.0})
    stress, gradient = result.stress(), lattice_gradients(result.positions[-1], result.lattice)
    first = np.linalg.det(gradient)[..., None, None] * stress @ np.swapaxes(np.linalg.inv(gradient), -1, -2)
    assert first[..., 0, 0].mean(axis=(1, 2)) * 0.01 == pytest.approx(np.ones(12), rel=0.01)
    assert result.outputs["pin.wall.reaction.x"][-1] == pytest.approx(1.0, rel=1e-6)
    assert stress[6:] == pytest.approx(np.broadcast_to(np.diag([100.0, 0.0, 0.0]), (6, 3, 3, 3, 3)), abs=1.0)
    strain = result.strain()[6:, 1, 1]
    assert strain[:, 0, 0] == pytest.approx(np.full(6, 1e-3), rel=0.01) and strain[:, 1, 1] == pytest.approx(np.full(6, -3e-4), rel=0.02)
