"""Strain and stress of the cells: the solid's in small strains, the energy's derivative in large ones, and the load's in a run."""

import dataclasses

import numpy as np
import pytest

from scenes import box
from softffd import SoftffdError, simulate
from softffd.run.stress import cauchy_stress, gradients, green_strain
from softffd.scene.springs import WAYS, cell_stiffness, springs
from validation.mechanics import Body
from validation.resolved import resolved

SOLID = {"points": [4, 3, 5], "size": [0.3, 0.22, 0.36]}
HALF = {"points": {"k": [0, 2]}}
MATERIALS = {
    "modulus": {"lattice": SOLID, "material": {"youngs_modulus": 2e5}, "region": [{**HALF, "youngs_modulus": 5e5}]},
    "stiffness": {"lattice": SOLID, "stiffness": {"edge": 1e3, "face": 700.0, "body": 300.0}, "region": [{**HALF, "stiffness": 4e3}]},
    "paper": {"lattice": SOLID | {"springs": "paper"}, "stiffness": 1e3},
}


def sides_of(scene):
    return np.array(scene.lattice_box.size) / (np.array(scene.lattice.points) - 1)


def moved(scene, gradient):
    return scene.lattice_box.rest() @ np.transpose(gradient)


@pytest.mark.parametrize("gradient", [np.eye(3), [[1.2, 0.1, 0.0], [0.3, 0.9, -0.2], [0.0, 0.4, 1.1]]])
def test_the_gradient_of_a_homogeneous_deformation_is_its_own_in_every_cell(gradient):
    scene = box(lattice=SOLID)
    found = gradients(moved(scene, gradient), sides_of(scene))
    assert found.shape == (3, 2, 4, 3, 3) and found == pytest.approx(np.broadcast_to(gradient, found.shape), abs=1e-14)
    strain = (np.transpose(gradient) @ np.array(gradient) - np.eye(3)) / 2
    assert green_strain(found) == pytest.approx(np.broadcast_to(strain, found.shape), abs=1e-14)


def test_a_small_strain_has_the_stress_of_the_solid():
    scene = box(lattice=SOLID, material={"youngs_modulus": 2e5})
    rng = np.random.default_rng(4)
    strain = rng.normal(size=(3, 3)) * 1e-7
    strain = strain + strain.T
    found = cauchy_stress(gradients(moved(scene, np.eye(3) + strain), sides_of(scene)), cell_stiffness(scene, {}), sides_of(scene))
    lame = 0.4 * 2e5
    wanted = lame * np.trace(strain) * np.eye(3) + 2 * lame * strain
    assert found == pytest.approx(np.broadcast_to(wanted, found.shape), abs=1e-5 * np.abs(wanted).max())


@pytest.mark.parametrize("material", MATERIALS)
def test_springs_have_the_ends_and_the_stiffness_of_the_twins(material):
    scene = box(**MATERIALS[material])
    body = Body.of(resolved(scene))
    wanted = np.zeros((len(body.mass), len(body.mass)))
    np.add.at(wanted, tuple(np.sort(body.pairs, axis=1).T), body.stiffness)
    found = np.zeros_like(wanted)
    for here, there, stiffness in springs(scene):
        found[np.minimum(here, there), np.maximum(here, there)] += stiffness
    assert found == pytest.approx(wanted, rel=1e-13, abs=1e-9)


@pytest.mark.parametrize("material", MATERIALS)
def test_cells_have_all_springs_among_them_and_their_stress_is_what_the_energy_rises_by(material):
    scene = box(**MATERIALS[material])
    body, sides, stiffness = Body.of(resolved(scene)), sides_of(scene), cell_stiffness(scene, {})
    assert stiffness.shape[-1] == len(WAYS) == 13 and stiffness.sum() == pytest.approx(body.stiffness.sum(), rel=1e-13)
    gradient, rng = np.array([[1.2, 0.1, 0.0], [0.3, 0.9, -0.2], [0.0, 0.4, 1.1]]), np.random.default_rng(1)
    change = rng.normal(size=(3, 3)) * 1e-6
    above, below = (body.elastic_energy(moved(scene, gradient + sign * change).swapaxes(0, 2).reshape(-1, 3)) for sign in (1, -1))
    stress = cauchy_stress(gradients(moved(scene, gradient), sides), stiffness, sides).sum(axis=(0, 1, 2))
    volume = np.prod(sides) * np.linalg.det(gradient)
    assert (above - below) / 2 == pytest.approx((stress * (change @ np.linalg.inv(gradient))).sum() * volume, rel=1e-6)
    assert stress == pytest.approx(stress.T, rel=1e-13)


def test_a_cell_that_is_turned_inside_out_has_no_stress():
    scene = box(lattice=SOLID)
    found = cauchy_stress(gradients(moved(scene, np.diag([1.0, -1.0, 1.0])), sides_of(scene)), cell_stiffness(scene, {}), sides_of(scene))
    assert np.isnan(found).all()


def pulled():
    bar = {"lattice": {"points": [7, 4, 4], "size": [0.2, 0.1, 0.1]}, "mass": {"density": 1000.0}}
    ends = {"pin": [{"name": "wall", "points": "x-"}], "load": [{"name": "pull", "points": "x+"}]}
    return box(**bar, **ends, material={"youngs_modulus": 1e5, "damping": 0.2}, stop_time=1.0, communication_step=0.05)


def test_a_bar_carries_its_load_through_every_section():
    result = simulate(pulled(), inputs=lambda _time: {"load.pull.x": 10.0})
    assert result.strain(slice(None)).shape == (len(result.time), 6, 3, 3, 3, 3)
    stress = result.stress()
    gradient = gradients(result.positions[-1], np.full(3, 0.1 / 3))
    areas = np.linalg.det(gradient) / gradient[..., 0, 0] * (0.1 / 3) ** 2
    carried = (stress[..., 0, 0] * areas).sum(axis=(1, 2))
    assert carried == pytest.approx(10.0, rel=0.02)  # springs within a cell differ from those of its middle
    assert stress[3, 1, 1, 0, 0] == pytest.approx(1000.0, rel=0.1) and abs(stress[3, 1, 1, 1, 1]) < 50


def test_parameters_of_the_start_count():
    soft, hard = (simulate(pulled(), start_values={"youngs_modulus": modulus}, stop_time=0.05) for modulus in (1e5, 2e5))
    shape = dataclasses.replace(hard, positions=np.broadcast_to(moved(hard.scene, np.diag([1.1, 1.0, 1.0])), hard.positions.shape))
    same = dataclasses.replace(soft, positions=shape.positions)
    assert shape.stress() == pytest.approx(2 * same.stress(), rel=1e-13)


def test_what_is_missing_is_said():
    result = simulate(pulled(), stop_time=0.05)
    with pytest.raises(SoftffdError, match="stress: wanted a run with its scene, which defines the material; gone"):
        dataclasses.replace(result, scene=None, sceneless="gone").stress()
    with pytest.raises(SoftffdError, match=r'strain: wanted a run of an FMU of softffd with outputs\.positions = "all"'):
        dataclasses.replace(result, lattice=None).strain()
