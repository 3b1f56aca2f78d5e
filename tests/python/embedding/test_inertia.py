"""Moments of inertia: of meshes against formulas, of lumped masses, and of masses that match the object's to rounding."""

import numpy as np
import pytest
import trimesh

from scenes import box
from softffd import load_scene
from softffd.embedding.inertia import covariance
from softffd.embedding.mass import point_masses
from softffd.errors import SoftffdError
from softffd.fmu.notes import inertia_note
from softffd.fmu.package import scene_masses
from softffd.lattice import rest_grid, to_flat
from softffd.mesh.mesh import Mesh

SIZE, ORIGIN = np.array([1.0, 0.8, 1.2]), np.array([0.3, -0.2, 5.0])


def moments(mass, counts):
    """Total, centre (3,) and covariance (3, 3) of masses (n,) of a lattice."""
    places = to_flat(rest_grid(counts, ORIGIN, SIZE))
    centre = mass @ places / mass.sum()
    return mass.sum(), centre, np.einsum("p,px,py->xy", mass, places - centre, places - centre) / mass.sum()


def as_mesh(shape):
    return Mesh(shape.vertices, shape.faces)


def slanted(turn):
    """A closed body, off the middle of the box and aligned with none of its axes."""
    shape = trimesh.creation.box([0.8, 0.5, 0.9])
    shape.apply_transform(trimesh.transformations.rotation_matrix(turn, [1.0, 0.5, 0.2]))
    shape.apply_translation(ORIGIN + 0.5 * SIZE + [0.03, 0.0, -0.05])
    return shape


def test_a_solids_covariance_is_that_of_its_inertia():
    shape = slanted(0.7)
    inertia = shape.moment_inertia / shape.volume
    wanted = np.trace(inertia) / 2 * np.eye(3) - inertia
    np.testing.assert_allclose(covariance("volume", as_mesh(shape), SIZE), wanted, rtol=0, atol=1e-12)  # trimesh's own rounding, 5 m off


def test_a_surfaces_covariance_is_the_mean_over_its_area():
    shape = slanted(0.7)
    fine = shape
    for _ in range(6):
        fine = fine.subdivide()
    centres, areas = fine.triangles_center, fine.area_faces
    middle = areas @ centres / areas.sum()
    wanted = np.einsum("f,fx,fy->xy", areas, centres - middle, centres - middle) / areas.sum()
    np.testing.assert_allclose(covariance("surface", as_mesh(shape), SIZE), wanted, rtol=0, atol=2e-5)


def test_vertices_count_once_and_a_box_is_even():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    mesh = Mesh(corners, np.arange(6).reshape(2, 3))
    np.testing.assert_allclose(covariance("vertices", mesh, SIZE), np.diag([0.25, 0.25, 0.0]), atol=1e-16)
    np.testing.assert_allclose(covariance("box", None, SIZE), np.diag(SIZE**2 / 12))


@pytest.mark.parametrize("distribution", ["uniform", "box", "vertices", "surface", "volume"])
@pytest.mark.parametrize(("counts", "basis"), [((4, 4, 4), "bezier"), ((3, 5, 4), "bezier"), ((8, 6, 9), "bspline")])
def test_matched_masses_have_the_moments_of_the_object(distribution, counts, basis):
    mesh = None if distribution in ("uniform", "box") else as_mesh(slanted(0.15))
    share = 0.0 if distribution == "box" else 0.01
    what = {"counts": counts, "origin": ORIGIN, "size": SIZE, "mesh": mesh, "total": 2.5, "uniform_share": share, "basis": basis}
    found = point_masses(distribution, inertia="matched", **what)
    _, centre, _ = moments(found.weight, counts)
    total, middle, second = moments(found.mass, counts)
    assert total == pytest.approx(2.5, rel=1e-12) and found.weight.sum() == pytest.approx(2.5, rel=1e-14)
    np.testing.assert_allclose(middle, centre, rtol=0, atol=1e-12)
    np.testing.assert_allclose(second, covariance(distribution, mesh, SIZE), rtol=0, atol=1e-12)
    assert found.mass.min() >= 2.5 * share / len(found.mass) * (1 - 1e-12) and found.mass.min() > 0
    np.testing.assert_array_equal(found.shift, 0.0)
    np.testing.assert_array_equal(found.inertia, 1.0)


def test_lumped_masses_of_a_cube_have_five_thirds_of_its_inertia():
    found = scene_masses(box())
    np.testing.assert_allclose(found.inertia, 5 / 3, rtol=1e-14)
    assert found.weight is None
    assert inertia_note(box(), found).startswith("lumped masses have 1.67 times the inertia of the box; mass.inertia = ")
    matched = box(mass={"inertia": "matched"})
    assert inertia_note(matched, scene_masses(matched)) is None
    heavy = box(region=[{"points": "z-", "mass": 1.0}])
    assert inertia_note(heavy, scene_masses(heavy)) is None


def test_the_nearest_masses_are_found():
    """Of masses with these moments none are nearer to the lumped ones: to move along what the moments leave free pays in no direction."""
    scene = load_scene("car_drop").replace({"mass.inertia": "matched", "mass.uniform_share": 0.02})
    lumped, found = (scene_masses(each).mass for each in (scene.replace({"mass.inertia": "lumped"}), scene))
    places = to_flat(scene.lattice_box.rest())
    places = (places - places.mean(axis=0)) / scene.lattice_box.size
    rows = np.stack([np.ones(64), *places.T, *(places[:, a] * places[:, b] for a in range(3) for b in range(a + 1))])
    least = found.sum() * 0.02 / 64
    held = found < least * (1 + 1e-9)
    slope = (found - lumped) / lumped
    multipliers = np.linalg.lstsq(rows[:, ~held].T, slope[~held], rcond=None)[0]
    np.testing.assert_allclose(rows[:, ~held].T @ multipliers, slope[~held], rtol=0, atol=1e-9)
    assert held.any() and np.all(slope[held] >= rows[:, held].T @ multipliers)


def test_what_is_not_possible_is_refused_with_what_is():
    shape = trimesh.creation.box([1.0, 0.8, 0.01])
    shape.apply_translation(ORIGIN + 0.5 * SIZE)
    what = {"counts": (4, 4, 4), "origin": ORIGIN, "size": SIZE, "mesh": as_mesh(shape), "total": 1.0, "inertia": "matched"}
    with pytest.raises(SoftffdError, match='"matched" is not possible: no masses of these'):
        point_masses("volume", **what)
    what["mesh"] = as_mesh(slanted(0.15))
    with pytest.raises(SoftffdError, match=r"wanted at most ([0-9.]+) beside inertia") as told:
        point_masses("volume", uniform_share=0.9, **what)
    most = float(str(told.value).split("at most ")[1].split()[0])
    assert point_masses("volume", uniform_share=most, **what).mass.min() >= most / 64 * (1 - 1e-12) > 0
    with pytest.raises(SoftffdError, match="leaves control points without mass"):
        scene_masses(box(mass={"inertia": "matched", "uniform_share": 0.0}))
