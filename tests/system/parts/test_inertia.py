"""Masses that match the inertia of the object: swings on a hinge, weight, twin, and no trace where they are not asked for."""

import numpy as np
import pytest
import trimesh

from readings import imbalance, points, vector
from scenes import GRAVITY, box
from softffd import simulate
from softffd.fmu.package import scene_masses
from softffd.scene.scene import scene_from

G = -GRAVITY[2]
TILT = 0.02
HINGE = {"name": "hinge", "points": {"i": [2, 2], "k": [4, 4]}}


def swinging(**body):
    """A stiff cube that hangs from a hinge along y in the middle of its top, under gravity that leans."""
    return box(
        gravity=[G * np.sin(TILT), 0.0, -G * np.cos(TILT)], probe=[{"name": "centre", "at": [0.5, 0.5, 0.5]}],
        outputs={"positions": "none"}, stop_time=1.6, **body,
    )  # fmt: skip


def period(scene):
    """Of the swing, from where the centre is half-way between its two ends, on its way there and back [s]."""
    result = simulate(scene)
    x, t = result.outputs["probe.centre.x"] - 0.5, result.time
    above = x > 0.5 * np.sin(TILT)
    there, back = np.flatnonzero(above)[[0, -1]]
    middle, first = 0.5 * np.sin(TILT), np.array([there - 1, back])
    cross = t[first] + (middle - x[first]) / (x[first + 1] - x[first]) * (t[first + 1] - t[first])
    return 2 * (cross[1] - cross[0])


@pytest.mark.parametrize(("inertia", "own"), [("matched", 1 / 6), ("lumped", 1.5 / 6)])
def test_a_body_on_a_hinge_swings_with_the_inertia_of_its_masses(inertia, own):
    """The true one is 1/6 of a cube; lumped masses of five points along an axis have 1.5 times that."""
    springs = {"points": [5, 5, 5], "stiffness": 3e5, "damping": 0.0, "pin": [HINGE]}
    found = period(swinging(**springs, mass={"inertia": inertia}))
    assert found == pytest.approx(2 * np.pi * np.sqrt((own + 0.25) / (0.5 * G)), rel=2e-3)


def test_a_solid_on_a_hinge_swings_with_the_inertia_of_its_box():
    material = {"model": "solid", "youngs_modulus": 3e5, "poissons_ratio": 0.25}
    hinge = {"name": "hinge", "points": {"i": [3, 3], "k": [6, 6]}}
    found = period(swinging(points=[7, 7, 7], material=material, pin=[hinge]))
    assert found == pytest.approx(2 * np.pi * np.sqrt((1 / 6 + 0.25) / (0.5 * G)), rel=2e-3)


def test_a_solid_of_a_mesh_spins_with_the_energy_of_the_object(tmp_path):
    shape = trimesh.creation.icosphere(2)
    shape.apply_scale([0.5, 0.3, 0.4])
    shape.apply_transform(trimesh.transformations.rotation_matrix(0.3, [1.0, 0.5, 0.2]))
    shape.export(tmp_path / "body.obj", digits=17)
    spin = np.array([0.3, -0.5, 0.7])
    document = {
        "mesh": {"file": "body.obj"},
        "lattice": {"cells": 9},
        "material": {"model": "solid", "youngs_modulus": 1e5},
        "mass": {"total": 2.0},
        "initial": {"angular_velocity": spin.tolist(), "spin_about": "mass"},
        "outputs": {"energy": True},
        "experiment": {"stop_time": 0.01, "communication_step": 0.01},
    }
    found = simulate(scene_from(document, path=tmp_path / "scene.toml"))
    wanted = spin @ (2.0 / shape.volume * shape.moment_inertia) @ spin / 2
    assert found.outputs["energy.kinetic"][0] == pytest.approx(wanted, rel=1e-9)


def test_gravity_pulls_at_the_lumped_masses():
    hung = box(
        stiffness=1e3, gravity=GRAVITY, damping=2.0, mass={"inertia": "matched", "total": 2.0}, pin=[{"name": "hook", "points": "z+"}],
        energy=True, stop_time=4.0, communication_step=0.05, method="leapfrog", step=1e-3,
    )  # fmt: skip
    masses, result = scene_masses(hung), simulate(hung)
    assert np.abs(masses.mass - masses.weight).max() > 0.02
    assert vector(result, "pin.hook.reaction")[-1] == pytest.approx([0.0, 0.0, -2.0 * G], abs=1e-6)
    wanted = G * points(result)[:, :, 2] @ masses.weight
    np.testing.assert_allclose(result.outputs["energy.gravity"], wanted, rtol=1e-13)
    assert np.abs(imbalance(result)).max() < 1e-4


def test_another_mass_scales_masses_and_weights_alike():
    fall = box(gravity=GRAVITY, damping=0.0, stiffness=0.0, mass={"inertia": "matched"}, stop_time=0.1)
    one, other = (points(simulate(fall, start_values={"mass": mass})) for mass in (1.0, 3.0))
    np.testing.assert_allclose(other, one, rtol=0, atol=1e-14)
