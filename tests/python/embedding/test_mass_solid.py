"""Masses of a solid's nodes: those of a box exactly, those of an object with its moments, and the nearest where it has none."""

import numpy as np
import pytest
import trimesh

from scenes import TETRAHEDRON
from softffd.embedding.inertia import covariance
from softffd.embedding.mass_solid import FLOORS, hat_shares, node_masses
from softffd.embedding.nodes import PLACES, WEIGHTS, axis_nodes, axis_shares, rest_nodes, volume_shares
from softffd.errors import SoftffdError
from softffd.fmu.notes import inertia_note, light_note
from softffd.fmu.package import scene_masses
from softffd.lattice import to_flat
from softffd.mesh.files import load_mesh
from softffd.mesh.mesh import Mesh
from softffd.scene.scene import scene_from

SIZE, ORIGIN = np.array([1.0, 0.8, 1.2]), np.array([0.3, -0.2, 5.0])
SOLID = {"model": "solid", "youngs_modulus": 1e6}


def plate():
    """A thin one, turned in its box."""
    shape = trimesh.creation.box([1.0, 1.0, 0.05])
    shape.apply_transform(trimesh.transformations.rotation_matrix(0.6, [1.0, 0.5, 0.2]))
    return Mesh(shape.vertices, shape.faces, name="plate")


def ball():
    shape = trimesh.creation.icosphere(3)
    return Mesh(shape.vertices * [1.0, 0.6, 0.8] + [3.0, 0.0, -1.0], shape.faces, name="ball")


def of_mesh(distribution, mesh, n, **keys):
    low, high = mesh.bounds
    body = {"counts": (n,) * 3, "origin": low, "size": high - low, "mesh": mesh, "total": 2.5}
    return node_masses(distribution, **{**body, **keys}), to_flat(rest_nodes((n,) * 3, low, high - low))


def hats_of(distribution, mesh, n):
    """Shares of the nodes by hat functions (n^3,), in flat order."""
    low, high = mesh.bounds
    return to_flat(hat_shares(distribution, (n,) * 3, low, high - low, mesh)[..., None])[:, 0]


def box_of(n):
    """Shares of the nodes in a full box (n^3,)."""
    return to_flat(volume_shares((n,) * 3)[..., None])[:, 0]


def moments(mass, places):
    """Total, centre (3,) and covariance (3, 3)."""
    centre = mass @ places / mass.sum()
    return mass.sum(), centre, np.einsum("p,px,py->xy", mass, places - centre, places - centre) / mass.sum()


def rows_of(places, box):
    """The ten moments (10, n) of points, in units of the box about its middle."""
    at = (places - places.mean(axis=0)) / box
    return np.stack([np.ones(len(at)), *at.T, *(at[:, a] * at[:, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))])


def test_nodes_and_weights_are_those_of_gauss_and_lobatto():
    zeros = np.polynomial.Legendre([0, 0, 0, 1]).deriv().roots()
    np.testing.assert_allclose(PLACES[1:3], (zeros + 1) / 2, rtol=1e-15)
    for degree in range(6):
        assert WEIGHTS @ PLACES**degree == pytest.approx(1 / (degree + 1), rel=1e-15)
    assert abs(WEIGHTS @ PLACES**6 - 1 / 7) > 1e-4


@pytest.mark.parametrize("n", [4, 7, 31])
def test_an_axis_of_patches_integrates_to_degree_5_too(n):
    nodes, shares = axis_nodes(n), axis_shares(n)
    assert nodes[0] == 0 and nodes[-1] == 1 and (np.diff(nodes) > 0).all() and (shares > 0).all()
    np.testing.assert_allclose(nodes[::3], np.arange(n // 3 + 1) / (n // 3), rtol=1e-15)
    for degree in range(6):
        assert shares @ nodes**degree == pytest.approx(1 / (degree + 1), rel=1e-14)


def test_the_masses_of_a_box_have_its_moments_exactly():
    counts = (7, 4, 10)
    found = node_masses("box", counts=counts, origin=ORIGIN, size=SIZE, mesh=None, density=3.0)
    total, centre, second = moments(found.mass, to_flat(rest_nodes(counts, ORIGIN, SIZE)))
    assert total == pytest.approx(3 * SIZE.prod(), rel=1e-14)
    np.testing.assert_allclose(centre, ORIGIN + SIZE / 2, rtol=1e-14)
    np.testing.assert_allclose(second, np.diag(SIZE**2) / 12, rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.inertia, 1.0, rtol=1e-14)
    assert found.weight is None and not found.shift.any()


@pytest.mark.parametrize("distribution", ["vertices", "surface", "volume"])
@pytest.mark.parametrize("counts", [(4, 4, 4), (7, 4, 10)])
def test_hat_functions_give_no_negative_share_and_the_objects_centre(distribution, counts):
    mesh = ball()
    low, high = mesh.bounds
    shares = hat_shares(distribution, counts, low, high - low, mesh)
    assert shares.min() >= 0
    centre = np.einsum("xyz,xyzc->c", shares, rest_nodes(counts, low, high - low)) / shares.sum()
    whole = trimesh.Trimesh(mesh.vertices, mesh.faces)
    wanted = {"vertices": whole.vertices.mean(axis=0), "surface": whole.centroid, "volume": whole.center_mass}[distribution]
    np.testing.assert_allclose(centre, wanted, rtol=0, atol=1e-13)


def test_hat_functions_are_integrated_exactly():
    """Of a box that is full, and of one that ends within a cell of the nodes."""
    shape = trimesh.creation.box([1.0, 1.0, 1.0])
    shape.apply_translation([0.5, 0.5, 0.5])
    nodes = axis_nodes(7)
    spans = np.diff(nodes)
    wanted = (np.append(spans, 0) + np.append(0, spans)) / 2
    shares = hat_shares("volume", (7, 7, 7), np.zeros(3), np.ones(3), Mesh(shape.vertices, shape.faces))
    np.testing.assert_allclose(shares, wanted[:, None, None] * wanted[:, None] * wanted, rtol=0, atol=1e-15)
    half = Mesh(shape.vertices * [1.0, 1.0, 0.4], shape.faces)
    below = hat_shares("volume", (7, 7, 7), np.zeros(3), np.ones(3), half).sum(axis=(0, 1))
    assert below[:3].sum() + below[3:].sum() == pytest.approx(1.0, rel=1e-14) and (below[4:] == 0).all()
    height = 0.4 - nodes[2]
    third = (spans[1] / 2 + height - height**2 / (2 * spans[2])) / 0.4
    assert below[2] == pytest.approx(third, rel=1e-13)


@pytest.mark.parametrize(
    ("name", "distribution", "n", "floor", "held"),
    [("beetle", "surface", 4, 0.3, 24), ("beetle", "surface", 7, 0.3, 150), ("spot", "volume", 7, 0.2, 302)],
)
def test_masses_have_the_ten_moments_of_the_object_and_a_floor(real_meshes, name, distribution, n, floor, held):
    mesh = load_mesh(real_meshes / f"{name}.obj")
    found, places = of_mesh(distribution, mesh, n)
    low, high = mesh.bounds
    total, centre, second = moments(found.mass, places)
    hats = hats_of(distribution, mesh, n)
    scale = (high - low).max()
    assert total == pytest.approx(2.5, rel=1e-13)
    np.testing.assert_allclose(centre, hats @ places / hats.sum(), rtol=0, atol=1e-12 * scale)
    np.testing.assert_allclose(second, covariance(distribution, mesh, high - low), rtol=0, atol=1e-12 * scale**2)
    least = floor * 2.5 * box_of(n)
    assert floor in FLOORS and (found.mass >= least * (1 - 1e-12)).all()
    assert (found.mass <= least * (1 + 1e-9)).sum() == held
    np.testing.assert_allclose(found.inertia, 1.0, rtol=0, atol=1e-12)


@pytest.mark.parametrize("n", [4, 7])
def test_the_nearest_masses_are_found(real_meshes, n):
    """To move along what the moments leave free pays in no direction, and nodes at the floor would only lose."""
    mesh = load_mesh(real_meshes / "beetle.obj")
    found, places = of_mesh("surface", mesh, n)
    low, high = mesh.bounds
    hats, box = hats_of("surface", mesh, n), box_of(n)
    slope = (found.mass / 2.5 - hats / hats.sum()) / box
    rows, held = rows_of(places, high - low), found.mass <= 0.3 * 2.5 * box * (1 + 1e-9)
    multipliers = np.linalg.lstsq(rows[:, ~held].T, slope[~held], rcond=None)[0]
    np.testing.assert_allclose(rows[:, ~held].T @ multipliers, slope[~held], rtol=0, atol=1e-9)
    assert held.any() and np.all(slope[held] >= rows[:, held].T @ multipliers - 1e-9)


@pytest.mark.parametrize("body", ["spot", "plate"])
def test_where_no_masses_have_the_inertia_mass_and_centre_are_exact_and_it_is_nearest(real_meshes, body):
    """Nearest: of masses with the total, the centre and the floor none have second moments that are nearer by more than a hundredth."""
    mesh = plate() if body == "plate" else load_mesh(real_meshes / "spot.obj")
    found, places = of_mesh("volume", mesh, 4)
    low, high = mesh.bounds
    hats, box = hats_of("volume", mesh, 4), box_of(4)
    total, centre, _ = moments(found.mass, places)
    assert total == pytest.approx(2.5, rel=1e-12)
    np.testing.assert_allclose(centre, hats @ places / hats.sum(), rtol=0, atol=1e-12 * (high - low).max())
    assert (found.mass >= FLOORS[-1] * 2.5 * box * (1 - 1e-12)).all()
    assert 1.01 < found.inertia.max() < 1.2 and found.inertia.min() > 1.02
    rows = rows_of(places, high - low)
    at = hats @ ((places - places.mean(axis=0)) / (high - low)) / hats.sum()
    second = covariance("volume", mesh, high - low) / np.outer(high - low, high - low) + np.outer(at, at)
    error = rows[4:] @ found.mass / 2.5 - [second[a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    assert _least_error(rows, box, at, rows[4:] @ found.mass / 2.5 - error) > 0.99 * np.linalg.norm(error)


def _least_error(rows, box, centre, second):
    """The smallest error of second moments with this total and centre, by SciPy's least squares with bounds."""
    from scipy.optimize import lsq_linear

    heavy = 1e4
    least = FLOORS[-1] * box
    matrix = np.vstack([heavy * rows[:4], rows[4:]])
    wanted = np.append(heavy * np.append(1.0, centre), second) - matrix @ least
    return np.sqrt(2 * lsq_linear(matrix, wanted, bounds=(0, np.inf), method="bvls", tol=1e-14, max_iter=1000).cost)


def test_an_object_at_the_rim_of_its_box_is_refused():
    keys = {"origin": [2.0, -0.6, -1.8], "size": [100.0, 100.0, 100.0]}
    with pytest.raises(SoftffdError, match='"volume" is not possible: no masses of these nodes have the centre of the object'):
        of_mesh("volume", ball(), 4, **keys)


def test_the_notes_of_a_solid_say_what_its_masses_cost(tmp_path):
    (tmp_path / "body.obj").write_text(TETRAHEDRON)
    body = {"mesh": {"file": "body.obj"}, "lattice": {"points": [7, 4, 10]}, "material": SOLID, "mass": {"total": 2.0}}
    scene = scene_from(body, path=tmp_path / "scene.toml")
    found = scene_masses(scene)
    assert found.inertia.max() > 1.01
    times = f"{found.inertia.min():.3g} to {found.inertia.max():.3g} times"
    said = f"masses of nodes come no nearer than {times} the inertia of the mesh (volume); more control points do"
    assert inertia_note(scene, found) == said
    assert light_note(scene, found).endswith('makes explicit steps up to 3.2 times shorter; mass.distribution = "box" makes them longer')
    even = scene.replace({"mass.distribution": "box"})
    assert inertia_note(even, scene_masses(even)) is None and light_note(even, scene_masses(even)) is None


def test_a_light_node_of_a_region_is_said_with_its_key():
    scene = scene_from({"material": SOLID, "region": [{"points": [[0, 0, 0]], "mass": 1e-6}]})
    assert light_note(scene, scene_masses(scene)) == (
        "node [0, 0, 0] with 1e-06 kg, where the box has 0.000578 kg, makes explicit steps up to 24 times shorter; "
        "a larger region[0].mass makes them longer"
    )
    pinned = scene.replace({"pin": [{"name": "held", "points": "x-"}]})
    assert light_note(pinned, scene_masses(pinned)) is None
