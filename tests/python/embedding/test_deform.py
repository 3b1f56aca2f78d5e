"""Facts about the free-form deformation, Xia & Wang 2009, eq. (1)."""

import tracemalloc
from importlib import import_module
from itertools import product

import numpy as np
import pytest

from softffd.embedding.basis import weights
from softffd.embedding.deform import Embedding, deform
from softffd.errors import MeshError, SoftffdError
from softffd.installed import library_function
from softffd.mesh.mesh import Mesh

ORIGIN, SIZE = np.array([-1.0, 2.0, 0.5]), np.array([2.0, 0.7, 1.3])
COUNTS = [(2, 2, 2), (4, 4, 4), (3, 5, 2), (32, 2, 7)]
VOLUMES = [*((counts, "bezier") for counts in COUNTS), ((3, 5, 2), "bspline"), ((32, 4, 7), "bspline"), ((12, 12, 12), "bspline")]
VOLUMES += [((4, 4, 4), "patches"), ((7, 4, 10), "patches"), ((31, 7, 7), "patches")]


def rest_grid(counts):
    axes = [o + s * np.arange(n) / (n - 1) for o, s, n in zip(ORIGIN, SIZE, counts, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)


def cloud(m=200, seed=1):
    return ORIGIN + SIZE * np.random.default_rng(seed).random((m, 3))


def moved_grid(counts, seed=2):
    grid = rest_grid(counts)
    return grid + np.random.default_rng(seed).normal(size=grid.shape)


@pytest.mark.parametrize(("counts", "basis"), VOLUMES)
def test_affine_maps_are_reproduced_and_the_rest_grid_leaves_every_point_where_it_is(counts, basis):
    points, random = cloud(), np.random.default_rng(3).normal(size=(3, 3))
    for matrix, offset, rounding in ((np.eye(3), np.zeros(3), 1e-14), (random, np.array([5.0, -1.0, 2.0]), 1e-13)):
        moved = deform(points, rest_grid(counts) @ matrix.T + offset, origin=ORIGIN, size=SIZE, basis=basis)
        np.testing.assert_allclose(moved, points @ matrix.T + offset, atol=rounding)


@pytest.mark.parametrize(("counts", "basis"), VOLUMES)
def test_it_is_the_triple_sum_of_equation_1_inside_and_on_corners_edges_and_faces_of_the_box(counts, basis):
    ends = np.array([*product((0.0, 0.4, 1.0), repeat=3)])
    points, positions = np.vstack([cloud(20), ORIGIN + SIZE * ends]), moved_grid(counts)
    u, v, w = (weights(t, n, basis) for t, n in zip(((points - ORIGIN) / SIZE).T, counts, strict=True))
    expected = np.einsum("mi,mj,mk,ijkx->mx", u, v, w, positions)
    np.testing.assert_allclose(deform(points, positions, origin=ORIGIN, size=SIZE, basis=basis), expected, atol=1e-13)


@pytest.mark.parametrize(("counts", "basis"), [((4, 4, 4), "bezier"), ((9, 5, 12), "bspline"), ((7, 10, 4), "patches")])
def test_the_object_stays_in_the_convex_hull_of_the_control_points(counts, basis):
    positions = moved_grid(counts)
    moved = deform(cloud(500), positions, origin=ORIGIN, size=SIZE, basis=basis)
    for direction in np.random.default_rng(4).normal(size=(50, 3)):
        assert (moved @ direction).max() <= (positions @ direction).max()


def test_patches_follow_a_motion_that_is_quadratic_in_each():
    """Of t^2 a cubic Bezier curve has the control points 0, 0, 1/3, 1: in a patch that begins at b and is L long those of
    (b + L t)^2. A quadratic of x that has a kink at the joint is followed exactly by two patches."""

    def bent(x):
        return np.where(x < 0.5, x**2, 0.25 + 3 * (x - 0.5) - (x - 0.5) ** 2)

    left = np.array([0.0, 0.0, 0.25 / 3, 0.25])
    right = 0.25 + 1.5 * np.array([0.0, 1 / 3, 2 / 3, 1.0]) - 0.25 * np.array([0.0, 0.0, 1 / 3, 1.0])
    positions = rest_grid((7, 4, 4))
    positions[..., 2] += np.append(left, right[1:])[:, None, None]
    points = cloud()
    moved = deform(points, positions, origin=ORIGIN, size=SIZE, basis="patches")
    wanted = points + np.outer(bent((points[:, 0] - ORIGIN[0]) / SIZE[0]), [0.0, 0.0, 1.0])
    np.testing.assert_allclose(moved, wanted, rtol=0, atol=1e-14)


@pytest.mark.parametrize(("counts", "basis"), VOLUMES)
def test_a_vertex_has_the_same_bits_whichever_others_and_instants_are_deformed_with_it(counts, basis, monkeypatch):
    points, positions = cloud(), np.stack([moved_grid(counts, seed) for seed in range(3)])
    box = {"origin": ORIGIN, "size": SIZE, "basis": basis}
    whole = deform(points, positions, **box)
    np.testing.assert_array_equal(whole, [deform(points, each, **box) for each in positions])
    np.testing.assert_array_equal(whole[1], [deform(points[p : p + 1], positions[1], **box)[0] for p in range(len(points))])
    monkeypatch.setattr(import_module("softffd.embedding.deform"), "_BLOCK", 1)  # the package's attribute of this name is the function
    np.testing.assert_array_equal(deform(points, positions, **box), whole)


def test_points_in_any_memory_are_the_same_points():
    points, grid, box = cloud(500), moved_grid((4, 4, 4)), {"origin": ORIGIN, "size": SIZE}
    short = points.astype(np.float32)
    expected = deform(short.astype(float), grid, **box)
    np.testing.assert_array_equal(deform(short, grid, **box), expected)
    np.testing.assert_array_equal(deform(np.asfortranarray(short), grid, **box), expected)
    np.testing.assert_array_equal(deform(np.repeat(short, 2, axis=0)[::2], np.asfortranarray(grid), **box), expected)
    np.testing.assert_array_equal(deform(short.astype(">f8"), grid.tolist(), **box), expected)


def test_no_points_stay_none():
    assert deform(np.zeros((0, 3)), rest_grid((4, 4, 4)), origin=ORIGIN, size=SIZE).shape == (0, 3)
    assert deform(cloud(), np.zeros((0, 4, 4, 4, 3)), origin=ORIGIN, size=SIZE).shape == (0, 200, 3)
    with pytest.raises(ValueError, match="origin, size: wanted both where there are no vertices"):
        deform(np.zeros((0, 3)), rest_grid((4, 4, 4)))


def test_the_weights_of_24_control_points_an_axis_are_no_array_of_their_own():
    """The numbers of 13,824 control points at each of 3,000 vertices would take 330 MB."""
    points, grid = cloud(3000), moved_grid((24, 24, 24))
    deform(points[:1], grid, origin=ORIGIN, size=SIZE)
    tracemalloc.start()
    deform(points, grid, origin=ORIGIN, size=SIZE)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 1e6


def test_an_embedding_is_used_again_and_again():
    points = cloud()
    embedding = Embedding(points, ORIGIN, SIZE, (4, 4, 4))
    for seed in range(3):
        positions = moved_grid((4, 4, 4), seed)
        expected = deform(points, positions, origin=ORIGIN, size=SIZE)
        np.testing.assert_array_equal(embedding.deform(positions), expected)


def test_the_box_is_by_default_the_bounding_box():
    points = np.vstack([cloud(), ORIGIN[None], (ORIGIN + SIZE)[None]])
    mesh = Mesh(points, np.array([[0, 1, 2]]))
    np.testing.assert_allclose(deform(mesh, rest_grid((4, 4, 4))), points, atol=1e-14)


def test_points_outside_the_box_are_refused_with_a_box_that_holds_them():
    points = cloud()
    with pytest.raises(MeshError, match=r"points lie outside .* leave both keys out .* use origin = \[") as refusal:
        deform(points, rest_grid((4, 4, 4)), origin=ORIGIN, size=0.9 * SIZE)
    box = str(refusal.value).split("use origin = ")[1].rstrip(".").split(" and size = ")
    origin, size = (np.array(eval(text)) for text in box)
    assert deform(points, rest_grid((4, 4, 4)), origin=origin, size=size).shape == points.shape


def test_a_box_rounded_to_six_digits_still_holds_its_mesh():
    points = np.vstack([cloud(), (ORIGIN + SIZE)[None]])
    moved = deform(points, rest_grid((4, 4, 4)), origin=ORIGIN, size=SIZE * (1 - 5e-7))
    np.testing.assert_allclose(moved, points, atol=2e-6)


def test_points_that_are_not_numbers_and_a_flat_box_are_refused():
    points = cloud()
    points[3, 1] = np.nan
    with pytest.raises(MeshError, match=r"1 of the 200 points are not finite; the first is number 3 .* Wanted finite"):
        Embedding(points, ORIGIN, SIZE, (4, 4, 4))
    with pytest.raises(MeshError, match=r"lattice\.size: wanted three sides > 0 m, got \[2, 0, 1\.3\]"):
        Embedding(cloud(), ORIGIN, [2.0, 0.0, 1.3], (4, 4, 4))


@pytest.mark.parametrize(
    "shape, basis, words",
    [
        *[(shape, "bezier", "wanted") for shape in ((64, 3), (4, 4, 4), (4, 4, 4, 2), (4, 4, 33, 3), (1, 4, 4, 3))],
        ((4, 5, 4, 3), "patches", r'lattice.points: wanted 4, 7, 10, .. or 31 along each axis of "patches", got \(4, 5, 4\)'),
    ],
)
def test_wrong_shapes_of_control_points_are_refused(shape, basis, words):
    with pytest.raises(ValueError, match=words):
        deform(cloud(), np.zeros(shape), origin=ORIGIN, size=SIZE, basis=basis)


def test_an_embedding_refuses_another_lattice():
    with pytest.raises(ValueError, match=r"wanted the shape \(4, 4, 4, 3\)"):
        Embedding(cloud(), ORIGIN, SIZE, (4, 4, 4)).deform(np.zeros((3, 4, 4, 3)))


@pytest.mark.parametrize("basis", ["Bspline", "bsplin", "xyz", None])
def test_an_unknown_basis_is_refused_with_the_choices(basis):
    near = ', did you mean "bspline"\\?' if basis in ("Bspline", "bsplin") else "$"
    with pytest.raises(ValueError, match=f'basis: wanted "bezier", "bspline" or "patches", got {basis!r}{near}'):
        deform(cloud(), rest_grid((4, 4, 4)), origin=ORIGIN, size=SIZE, basis=basis)


def test_a_library_of_another_version_is_told():
    with pytest.raises(SoftffdError, match="wanted this version's library, got one without softffd_nothing; reinstall the package"):
        library_function("softffd_nothing", None)
