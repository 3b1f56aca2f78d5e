"""Facts about the masses of the control points."""

import os
import subprocess
import sys
from math import factorial

import numpy as np
import pytest
import trimesh

from softffd.embedding import mass_pieces
from softffd.embedding.basis import weights
from softffd.embedding.mass import enclosed_volume, point_masses
from softffd.embedding.quadrature import sufficient_degrees, triangle_rule
from softffd.errors import SoftffdError
from softffd.mesh.files import load_mesh
from softffd.mesh.mesh import Mesh

COUNTS = [(2, 2, 2), (4, 4, 4), (3, 6, 2), (9, 4, 12)]
VOLUMES = [*((counts, "bezier") for counts in COUNTS), ((5, 6, 7), "bspline"), ((9, 4, 12), "bspline"), ((12, 8, 3), "bspline")]


def sphere(subdivisions=2):
    ball = trimesh.creation.icosphere(subdivisions)
    return Mesh(ball.vertices * [1.0, 0.6, 0.8] + [3.0, 0.0, -1.0], ball.faces, name="ball")


def wedge():
    """A closed body without symmetry."""
    vertices = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [0.5, 0.2, 1.5]])
    return Mesh(vertices, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]), name="wedge")


def box(size=(2.0, 1.0, 0.5)):
    cube = trimesh.creation.box(extents=size)
    return Mesh(cube.vertices, cube.faces, name="box")


def masses(distribution, mesh, *, counts=(4, 4, 4), margin=0.0, **keys):
    low, high = mesh.bounds
    grow = margin * (high - low)
    box = {"counts": counts, "origin": low - grow, "size": high - low + 2 * grow, "mesh": mesh}
    return point_masses(distribution, **box, **{"total": 1.0, "uniform_share": 0.0, **keys})


def centre_of_mass(found, mesh, counts, margin=0.0):
    low, high = mesh.bounds
    grow = margin * (high - low)
    axes = [np.linspace(a, b, n) for a, b, n in zip(low - grow, high + grow, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).transpose(2, 1, 0, 3).reshape(-1, 3)
    return found.mass @ grid / found.mass.sum()


def centroid(distribution, mesh):
    """Of the vertices, the surface or the solid, by other formulas than the masses'."""
    corners = mesh.vertices[mesh.faces]
    if distribution == "vertices":
        return mesh.vertices.mean(axis=0)
    if distribution == "surface":
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        return areas @ corners.mean(axis=1) / areas.sum()
    volumes = np.linalg.det(corners)
    return volumes @ corners.sum(axis=1) / 4 / volumes.sum()


@pytest.mark.short("*-bezier-*", "*-counts6-bspline-wedge")
@pytest.mark.parametrize("make", [sphere, wedge, box])
@pytest.mark.parametrize(("counts", "basis"), VOLUMES)
@pytest.mark.parametrize("distribution", ["vertices", "surface", "volume"])
def test_total_and_centre_of_mass_are_kept(distribution, counts, basis, make):
    """Far from a vertex a B-spline's control point has no mass: there the even share, whose shift is known, fills in."""
    mesh, share = make(), 1e-3 if basis == "bspline" else 0.0
    found = masses(distribution, mesh, counts=counts, margin=0.05, total=7.0, basis=basis, uniform_share=share)
    assert found.mass.sum() == pytest.approx(7.0, rel=1e-14)
    assert centre_of_mass(found, mesh, counts, 0.05) - found.shift == pytest.approx(centroid(distribution, mesh), abs=1e-13)
    assert found.mass.min() > 0
    if share == 0:
        np.testing.assert_array_equal(found.shift, 0.0)


@pytest.mark.parametrize("counts", COUNTS)
def test_a_solid_that_fills_the_box_gives_every_point_the_same(counts):
    """The integral of each Bernstein polynomial of degree n - 1 over 0 to 1 is 1/n."""
    found = masses("volume", box(), counts=counts)
    np.testing.assert_allclose(found.mass, 1 / np.prod(counts), rtol=1e-12)


def test_the_surface_of_the_box_gives_what_its_six_faces_give():
    """A face's points share its area equally: B_i is one or zero on it, the other two integrals are 1/n."""
    counts, (a, b, c) = (4, 3, 5), (2.0, 1.0, 0.5)
    expected = np.zeros(counts)
    for axis, area in enumerate([b * c, a * c, a * b]):
        each = area * counts[axis] / np.prod(counts)
        np.moveaxis(expected, axis, 0)[[0, -1]] += each
    found = masses("surface", box((a, b, c)), counts=counts, uniform_share=1e-3)
    share = (1 - 1e-3) * expected / expected.sum() + 1e-3 / expected.size
    np.testing.assert_allclose(found.mass, share.transpose(2, 1, 0).reshape(-1), rtol=1e-12)


def test_the_vertices_of_the_box_give_all_to_the_corners():
    found = masses("vertices", box(), uniform_share=0.5)
    grid = found.mass.reshape(4, 4, 4)
    np.testing.assert_allclose(grid[::3, ::3, ::3], 0.5 / 8 + 0.5 / 64, rtol=1e-13)
    np.testing.assert_allclose(grid[1:3], 0.5 / 64, rtol=1e-13)


@pytest.mark.parametrize("degree", [1, 2, 5, 9, 30])
def test_the_triangle_rule_is_exact_to_its_degree_and_not_beyond(degree):
    rule = triangle_rule(degree)
    a, b = rule.corner_weights[:, 1], rule.corner_weights[:, 2]
    for i in range(degree + 1):
        j = degree - i
        exact = 2 * factorial(i) * factorial(j) / factorial(i + j + 2)
        assert rule.share @ (a**i * b**j) == pytest.approx(exact, rel=1e-13)
    beyond = 2 * (degree // 2 + 1)
    if degree > 10:
        return  # the error of so high a rule is below rounding
    assert rule.share @ b**beyond != pytest.approx(2 / ((beyond + 1) * (beyond + 2)), rel=1e-12)


@pytest.mark.short("sphere-counts0-bezier-volume", "wedge-counts2-bspline-surface")
@pytest.mark.parametrize("distribution", ["surface", "volume"])
@pytest.mark.parametrize(
    ("counts", "basis"), [((4, 4, 4), "bezier"), ((9, 4, 12), "bezier"), ((9, 4, 12), "bspline"), ((5, 6, 7), "bspline")]
)
@pytest.mark.parametrize("make", [sphere, wedge])
def test_a_much_finer_quadrature_changes_nothing(distribution, counts, basis, make, monkeypatch):
    keys = {"counts": counts, "basis": basis, "uniform_share": 1e-9}
    found = masses(distribution, make(), **keys)
    monkeypatch.setattr(mass_pieces, "sufficient_degrees", lambda reach, exact: np.full(len(reach), 2 * exact))
    finer = masses(distribution, make(), **keys)
    np.testing.assert_allclose(found.mass, finer.mass, rtol=0, atol=1e-13 * found.mass.mean())


@pytest.mark.parametrize("counts", [(5, 6, 7), (12, 3, 9)])
def test_a_solid_of_bsplines_that_fills_the_box_gives_each_point_the_integrals_of_its_weights(counts):
    t, share = (part[None] for part in np.polynomial.legendre.leggauss(200))
    axes = []
    for n in counts:
        ends = mass_pieces.control_axis(n, "bspline").cuts
        half = np.diff(ends)[:, None] / 2
        axes.append((half * share).reshape(-1) @ weights((ends[:-1, None] + half * (1 + t)).reshape(-1), n, "bspline"))
    expected = np.einsum("i,j,k->kji", *axes).reshape(-1)
    np.testing.assert_allclose(masses("volume", box(), counts=counts, basis="bspline").mass, expected, rtol=1e-11)


def test_a_small_body_gives_mass_to_the_control_points_near_it_alone():
    ball = sphere()
    found = point_masses(
        "volume", counts=(12, 12, 12), origin=[0, -2, -3], size=[6, 4, 4], mesh=ball, total=1.0, uniform_share=1e-6, basis="bspline"
    )
    heavy = found.mass.reshape(12, 12, 12) > 2e-6 / 12**3
    at = np.stack(np.meshgrid(*[np.linspace(a, b, 12) for a, b in ((-3, 1), (-2, 2), (0, 6))], indexing="ij"), axis=-1)[..., ::-1][heavy]
    cell = np.array([6, 4, 4]) / 11
    assert (at >= ball.bounds[0] - 2.1 * cell).all() and (at <= ball.bounds[1] + 2.1 * cell).all()


def test_small_triangles_need_fewer_samples():
    corners = np.array([[[0.5, 0.5, 0.5], [0.51, 0.5, 0.5], [0.5, 0.51, 0.5]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    small, large = sufficient_degrees(15 * np.ptp(corners, axis=1).sum(axis=1), 45)
    assert small < 20 < large == 45


@pytest.mark.parametrize("distribution", ["surface", "volume"])
def test_cutting_the_triangles_changes_nothing(distribution):
    mesh = wedge()
    vertices, faces = trimesh.remesh.subdivide(mesh.vertices, mesh.faces)
    coarse, fine = masses(distribution, mesh), masses(distribution, Mesh(vertices, faces))
    np.testing.assert_allclose(coarse.mass, fine.mass, atol=1e-15)


def require_means(found, points, mesh, counts=(4, 4, 4), basis="bezier", share=0.0):
    """The masses are the means of the weights over random points, within five standard errors and an even share of this size."""
    low, high = mesh.bounds
    axes = [weights(t, n, basis) for t, n in zip(((points - low) / (high - low)).T, counts, strict=True)]
    mean, square = (np.einsum("pi,pj,pk->kji", *each, optimize=True).ravel() / len(points) for each in (axes, [a**2 for a in axes]))
    error = np.sqrt(np.maximum(square - mean**2, 0) / len(points)) + share
    assert (np.abs(found.mass - mean) < 5 * error).all()


@pytest.mark.short("counts0-bezier")
@pytest.mark.parametrize(("counts", "basis"), [((4, 4, 4), "bezier"), ((6, 5, 8), "bspline")])
def test_the_volume_distribution_is_that_of_random_points_in_the_solid(counts, basis):
    mesh = wedge()
    points = np.random.default_rng(5).dirichlet(np.ones(4), 200_000) @ mesh.vertices
    require_means(masses("volume", mesh, counts=counts, basis=basis, uniform_share=1e-9), points, mesh, counts, basis, share=1e-9)


def test_the_surface_distribution_is_that_of_random_points_on_it():
    mesh = wedge()
    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    points, _ = trimesh.sample.sample_surface(body, 200_000, seed=6)
    require_means(masses("surface", mesh), points, mesh)


def test_control_points_are_in_flat_order_with_x_fastest():
    """All the mass near the corner (x+, y-, z-) of the box goes to point 3, 0, 0."""
    mesh = wedge()
    heavy = Mesh(np.vstack([mesh.vertices] + [mesh.vertices[1:2] - k * 1e-3 * np.eye(3)[[0]] for k in range(99)]),
                 np.vstack([mesh.faces, np.column_stack([np.arange(4, 103)] * 3)]))  # fmt: skip
    assert masses("vertices", heavy, uniform_share=0.01).mass.argmax() == 3


def test_seams_of_the_texture_do_not_weigh_twice_and_vertices_without_faces_weigh_nothing():
    mesh = wedge()
    split = Mesh(np.vstack([mesh.vertices, mesh.vertices[:1]]), [[4, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    stray = Mesh(np.vstack([mesh.vertices, [[0.5, 0.5, 0.5]]]), mesh.faces)
    expected, *found = (masses("vertices", each, uniform_share=0.1).mass for each in (mesh, split, stray))
    np.testing.assert_array_equal(found, [expected, expected])


def test_uniform_masses_are_equal_need_no_mesh_and_are_those_of_a_share_of_one():
    whole = {"counts": (4, 3, 5), "origin": [5, 6, 7], "size": [2, 0.5, 3], "mesh": None}
    found = point_masses("uniform", **whole, total=6.0)
    np.testing.assert_array_equal(found.mass, np.full(60, 6.0 / 60))
    np.testing.assert_array_equal(found.shift, 0.0)
    np.testing.assert_allclose(point_masses("uniform", **whole, density=30.0).mass, np.full(60, 90.0 / 60), rtol=1e-14)
    np.testing.assert_allclose(masses("surface", wedge(), uniform_share=1.0).mass, 1 / 64, rtol=1e-15)


@pytest.mark.parametrize("distribution", ["vertices", "surface", "volume"])
def test_the_uniform_share_moves_the_centre_of_mass_by_the_shift(distribution):
    mesh = wedge()
    found = masses(distribution, mesh, uniform_share=0.1)
    before, after = centroid(distribution, mesh), centre_of_mass(found, mesh, (4, 4, 4))
    assert found.shift == pytest.approx(after - before, abs=1e-14)
    assert found.shift == pytest.approx(0.1 * (mesh.bounds.mean(axis=0) - before), abs=1e-14)
    assert found.mass.sum() == pytest.approx(1.0, rel=1e-14)
    assert found.mass.min() >= 0.1 / 64


def test_density_makes_the_total_of_the_volume():
    mesh = wedge()
    assert enclosed_volume(mesh) == pytest.approx(0.5, rel=1e-15)
    for distribution in ("uniform", "box", "vertices", "surface", "volume"):
        found = masses(distribution, mesh, total=None, density=800.0, uniform_share=0.1)
        assert found.mass.sum() == pytest.approx(400.0, rel=1e-14)


def test_a_mesh_inside_out_has_the_same_masses():
    mesh = wedge()
    turned = Mesh(mesh.vertices, mesh.faces[:, ::-1])
    np.testing.assert_allclose(masses("volume", turned).mass, masses("volume", mesh).mass, rtol=1e-13)


def test_a_body_inside_out_among_others_is_refused():
    ball = sphere()
    both = Mesh(
        np.vstack([ball.vertices, ball.vertices + np.array([5, 0, 0])]),
        np.vstack([ball.faces, ball.faces[:, ::-1] + len(ball.vertices)]),
        name="pair",
    )
    with pytest.raises(SoftffdError, match=r"encloses no volume|inside out"):
        masses("volume", both, uniform_share=0.1)
    smaller = Mesh(np.vstack([ball.vertices, 0.7 * ball.vertices + [5, 0, 0]]), both.faces, name="pair")
    with pytest.raises(SoftffdError, match="'pair': some of its bodies are inside out"):
        masses("volume", smaller, uniform_share=0.1)


def test_a_cavity_counts_as_empty():
    ball = sphere()
    inner = 0.5 * (ball.vertices - [3, 0, -1]) + [3, 0, -1]
    hollow = Mesh(np.vstack([ball.vertices, inner]), np.vstack([ball.faces, ball.faces[:, ::-1] + len(inner)]))
    assert enclosed_volume(hollow) == pytest.approx(0.875 * enclosed_volume(ball), rel=1e-12)
    assert masses("volume", hollow).mass.sum() == pytest.approx(1.0)


def test_points_without_mass_and_a_mesh_outside_the_box_are_refused():
    with pytest.raises(SoftffdError, match=r"mass\.uniform_share: with 0, control point \[0, 0, 1\] .*0\.1 is usual"):
        masses("vertices", box(), uniform_share=0.0)
    with pytest.raises(SoftffdError, match="lie outside the lattice's box"):
        point_masses("surface", counts=(4, 4, 4), origin=[0, 0, 0], size=[1, 1, 1], mesh=wedge(), total=1.0)


def test_an_open_mesh_has_no_volume():
    mesh = wedge()
    leaky = Mesh(mesh.vertices, mesh.faces[:3], name="leaky")
    for keys in ({"total": 1.0}, {"total": None, "density": 1.0}):
        with pytest.raises(SoftffdError, match=r"mesh 'leaky' is not closed: 3 edges .* 'surface'"):
            masses("volume", leaky, **keys)
    with pytest.raises(SoftffdError, match="not closed"):
        masses("surface", leaky, total=None, density=1.0)
    assert masses("surface", leaky).mass.sum() == pytest.approx(1.0)


@pytest.mark.parametrize(("name", "closed"), [("beetle.obj", False), ("spot.obj", True)])
def test_real_meshes_keep_total_and_centre_of_mass(name, closed, real_meshes):
    mesh = load_mesh(real_meshes / name, up="y")
    for distribution in ["surface", "volume"][: 1 + closed]:
        found = masses(distribution, mesh, total=1200.0)
        assert found.mass.sum() == pytest.approx(1200.0, rel=1e-13)
        assert centre_of_mass(found, mesh, (4, 4, 4)) == pytest.approx(centroid(distribution, mesh), abs=1e-12)


MASSES = """
from softffd import load_scene
from softffd.fmu.package import scene_masses
for scene in ("car_drop", "drop_weight"):
    print(scene_masses(load_scene(scene)).mass.tobytes().hex())
"""


def test_masses_have_the_same_bits_on_every_processor():
    """The matrix products of numpy's library take sums in another order on each kind of processor; it can be told which to act for."""
    found = set()
    for processor in ("Prescott", "Haswell"):
        environment = os.environ | {"OPENBLAS_CORETYPE": processor}
        found.add(subprocess.run([sys.executable, "-c", MASSES], env=environment, capture_output=True, check=True).stdout)
    assert len(found) == 1 and found != {b""}
