"""Facts about the car that the project makes itself."""

from pathlib import Path

import numpy as np
import pytest

import softffd
from softffd.embedding.mass import enclosed_volume, point_masses
from softffd.mesh.files import load_mesh
from softffd.mesh.normals import merge_by_position
from validation.car import PALETTE, car_mesh

SHIPPED = Path(softffd.__file__).parent / "scenes" / "car" / "car.obj"


@pytest.fixture(scope="module")
def car():
    return car_mesh()


def colours(car):
    return np.array(list(PALETTE))[(car.uv[:, 0] * len(PALETTE)).astype(int)]


def test_it_has_the_stated_size_stands_on_the_ground_and_is_symmetric_in_y(car):
    np.testing.assert_allclose(car.bounds, [[-2.0, -0.85, 0.0], [2.0, 0.85, 1.4]], atol=1e-9)
    assert len(car.vertices) >= 2000
    _, positions = merge_by_position(car.vertices)
    mirrored = positions * [1, -1, 1]
    order, other = (np.lexsort(np.round(p + 0.0, 3).T) for p in (positions, mirrored))
    np.testing.assert_allclose(positions[order], mirrored[other], atol=2e-4)


def test_every_part_is_closed_looks_outwards_and_has_no_degenerate_triangle(car):
    assert car.closed
    assert np.linalg.det(car.vertices[car.faces]).sum() > 0
    box = np.prod(np.ptp(car.bounds, axis=0))
    assert 0.4 * box < enclosed_volume(car) < 0.6 * box
    a, b, c = car.vertices[car.faces].transpose(1, 0, 2)
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 1e-6


def test_it_stands_on_four_wheels(car):
    tyres = car.vertices[colours(car) == "tyre"]
    for x in (-1, 1):
        for y in (-1, 1):
            wheel = tyres[(np.sign(tyres[:, 0]) == x) & (np.sign(tyres[:, 1]) == y)]
            assert wheel[:, 2].min() == 0.0 and 0.5 < np.ptp(wheel[:, 2]) < 0.7 and np.ptp(wheel[:, 0]) < 0.7
    assert car.vertices[colours(car) == "paint"][:, 2].min() > 0.1


def test_the_cabin_is_set_back_from_both_ends(car):
    paint = car.vertices[colours(car) == "paint"]
    roof = paint[paint[:, 2] > 1.3]
    assert roof[:, 0].max() < 0.4 and roof[:, 0].min() > -1.2
    assert paint[paint[:, 0] > 1.7][:, 2].max() < 0.85 and paint[paint[:, 0] < -1.7][:, 2].max() < 1.0


def test_its_colours_are_places_in_its_texture(car):
    texture = np.asarray(car.texture)
    place = (car.uv * [texture.shape[1], texture.shape[0]]).astype(int)
    seen = {tuple(pixel) for pixel in texture[place[:, 1], place[:, 0]].tolist()}
    assert seen == set(PALETTE.values())


@pytest.mark.parametrize("distribution", ["surface", "volume"])
def test_its_mass_can_be_distributed(car, distribution):
    low, high = car.bounds
    keys = {"counts": (4, 4, 4), "origin": low, "size": high - low, "mesh": car}
    found = point_masses(distribution, **keys, total=1000.0)
    assert found.mass.min() > 1.0
    assert abs(found.shift[1]) < 1e-4 and abs(found.shift).max() < 0.05


def test_the_shipped_file_is_the_car(car):
    """The coordinates are rounded to 0.1 mm; another machine's sines may round the other way."""
    shipped = load_mesh(SHIPPED)
    np.testing.assert_array_equal(shipped.faces, car.faces)
    np.testing.assert_allclose(shipped.vertices, car.vertices, rtol=0, atol=1.01e-4)
    np.testing.assert_allclose(shipped.uv, car.uv, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(np.asarray(shipped.texture), np.asarray(car.texture))
    assert SHIPPED.stat().st_size < 300_000
