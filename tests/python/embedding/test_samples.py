"""Samples of a surface: every place once, of many those that the others follow, and a bound on how far they are behind."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from scenes import box
from softffd import load_scene
from softffd.embedding.basis import weights
from softffd.embedding.deform import deform
from softffd.embedding.samples import MOST, axis_weights, farthest_first, most_behind, surface_samples
from softffd.fmu.notes import samples_note
from softffd.fmu.package import scene_masses, scene_samples
from softffd.fmu.records import scene_records
from softffd.lattice import LatticeBox
from softffd.mesh.mesh import Mesh
from validation import shapes as bodies

BOX = LatticeBox((4, 4, 4), (0.1, 0.1, 0.1), (0.8, 0.8, 0.8), "bezier")
GROUND = {"name": "ground"}


@pytest.fixture(scope="module")
def sphere():
    return Mesh(*bodies.sphere(5))


@pytest.fixture(scope="module")
def reduced(sphere):
    return surface_samples(sphere, BOX, 1e-3)


def test_all_places_of_a_small_mesh_are_samples_once():
    vertices, faces = bodies.cube(5, 0.1)
    found = surface_samples(Mesh(np.vstack([vertices, [[0.5, 0.5, 0.5]]]), faces), BOX, 1e-3)
    wanted = np.unique(vertices, axis=0)
    assert len(vertices) == 150 and len(wanted) == 98 == found.vertices and found.behind == 0.0
    np.testing.assert_array_equal(np.unique(found.places, axis=0), wanted)
    assert samples_note(found) == "surface contact: 98 samples, every vertex"
    assert samples_note(None) is None


def test_of_many_vertices_some_are_taken_and_the_others_follow(sphere, reduced):
    assert len(sphere.vertices) == reduced.vertices == 10242 and len(reduced.places) == MOST
    assert 1e-3 < reduced.behind < 4e-3  # 3.4e-3 with 3,000
    assert (
        samples_note(reduced) == "surface contact: 5,000 of 10,242 vertices; the others penetrate by at most 0.27 % of the lattice's height"
    )
    place = {tuple(vertex): n for n, vertex in enumerate(sphere.vertices)}
    assert np.all(np.diff([place[tuple(each)] for each in reduced.places]) > 0)


def test_no_deformation_takes_others_further_behind_a_plane_than_is_said(sphere):
    axes = axis_weights(sphere.vertices, BOX)
    order = farthest_first(axes, int(sphere.vertices[:, 2].argmin()), 300)
    bound = most_behind(axes, order)
    assert 0.02 < bound < 0.035
    assert 0.02 < most_behind(axes, order, 0.02) <= bound == most_behind(axes, order, 0.035)
    random, worst = np.random.default_rng(7), 0.0
    for size in (0.02, 0.1, 0.3, 1.0):
        for _ in range(20):
            points = BOX.rest() + size * random.normal(size=(4, 4, 4, 3))
            up = random.normal(size=3)
            heights = deform(sphere, points, origin=BOX.origin, size=BOX.size) @ (up / np.linalg.norm(up))
            lattice = points.reshape(-1, 3) @ (up / np.linalg.norm(up))
            worst = max(worst, (heights[order].min() - heights.min()) / np.ptp(lattice))
    assert 0.01 * bound < worst <= bound


def test_the_worst_vertices_are_compared_with_the_samples_nearest_to_them():
    vertices, _faces = bodies.sphere(5)
    x, y, z = (vertices - 0.5).T / 0.4
    bumpy = 0.5 + (vertices - 0.5) * (0.8 + 0.2 * np.sin(5 * x) * np.cos(7 * y) * np.sin(6 * z))[:, None]
    axes = axis_weights(bumpy, BOX)
    samples = farthest_first(axes, 0, 2500)
    left = np.setdiff1d(np.arange(len(bumpy)), samples)
    dense = np.einsum("ip,jp,kp->pijk", *axes).reshape(len(bumpy), -1)
    bound = most_behind(axes, samples)
    nearest = cdist(dense[left], dense[samples], "cityblock").min(axis=1) / 2
    assert 0.3 < bound / nearest.max() < 0.5


@pytest.mark.full
def test_fewer_samples_are_taken_where_more_may_be_behind(sphere):
    found = surface_samples(sphere, BOX, 0.01)
    assert 0.005 < found.behind <= 0.01 and 700 < len(found.places) < 1500
    assert len(surface_samples(sphere, BOX, 0.0).places) == 10242


def test_the_farthest_first_is_what_a_search_through_all_weights_finds():
    count = 1000  # in 16 blocks
    vertices = np.random.default_rng(3).uniform(0.1, 0.9, size=(count, 3))
    lattice = LatticeBox((5, 3, 6), (0.1, 0.1, 0.1), (0.8, 0.8, 0.8), "bspline")
    axes = axis_weights(vertices, lattice)
    at = (vertices - lattice.origin) / np.array(lattice.size)
    x, y, z = (weights(t, n, lattice.basis).T for t, n in zip(at.T, lattice.points, strict=True))
    dense = np.einsum("iv,jv,kv->vijk", x, y, z).reshape(count, -1)
    chosen, distance = [4], np.full(count, np.inf)
    for _ in range(199):
        distance = np.minimum(distance, np.linalg.norm(dense - dense[chosen[-1]], axis=1))
        chosen.append(int(distance.argmax()))
    np.testing.assert_array_equal(farthest_first(axes, 4, 200), chosen)
    assert most_behind(axes, np.arange(count)) == 0.0


def test_the_resources_carry_samples_only_where_planes_meet_the_surface(tmp_path):
    keys = {"mesh": {"file": bodies.write(tmp_path / "cube.obj", bodies.cube(3, 0.0))}}
    on_lattice, meeting, nothing = (box(plane=[GROUND], contact={"of": "lattice"}, **keys), box(plane=[GROUND], **keys), box(**keys))

    def lines(scene):
        return scene_records(scene, scene_masses(scene), scene_samples(scene)).splitlines()

    found = [line for line in lines(meeting) if line.startswith("sample ")]
    assert len(found) == 26 and found[0] == "sample 0.0 0.0 0.0"
    assert [line for line in lines(meeting) if line not in found] == lines(on_lattice)
    assert not [line for line in lines(nothing) if line.startswith("sample ")]


def test_five_thousand_samples_take_less_than_400_kb(reduced):
    scene = load_scene("car_drop").replace({"contact.of": "surface"})
    records = scene_records(scene, scene_masses(scene), reduced)
    assert sum(len(line) + 1 for line in records.splitlines() if line.startswith("sample ")) < 400_000
