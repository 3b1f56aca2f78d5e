"""Materials by their modulus: keys that go together, defaults that depend on others, and the cells that springs can fill."""

import numpy as np
import pytest

from scenes import TETRAHEDRON
from softffd.fmu.package import scene_masses
from softffd.lattice import cells_within, shared_by_corners, to_grid
from softffd.scene.cells import cubic, cubic_along, fit_springs, nearest_fit
from softffd.scene.scene import scene_from

CLOSED = TETRAHEDRON.replace("v 0 0 4", "v 0 0 2")
RUBBER = {"youngs_modulus": 1e6}
CUBE = {"i": [0, 1], "j": [0, 1], "k": [0, 1]}


def masses(**document):
    scene = scene_from(document)
    return to_grid(scene_masses(scene).mass[:, None], scene.lattice.points)[..., 0]


def test_a_modulus_has_no_stiffness_no_drag_and_the_box_for_its_mass_and_without_one_they_are_those_of_springs():
    scene = scene_from({"material": RUBBER, "mass": {"density": 1100.0}})
    assert scene.material.stiffness is None and scene.material.damping == 0 and scene.material.internal_damping == 0
    assert scene.mass.distribution == "box" and scene.mass.uniform_share == 0
    assert scene_from({"material": RUBBER | {"damping": 0.3}, "mass": {"distribution": "uniform"}}).material.damping == 0.3
    scene = scene_from({"material": {"internal_damping": 1e-3}})
    assert scene.material.stiffness.model_dump() == {"edge": 1e3, "face": 1e3, "body": 1e3} and scene.material.damping == 0.01
    assert (scene.mass.distribution, scene.mass.uniform_share) == ("uniform", 0.1)


@pytest.mark.parametrize("mesh, distribution", [(CLOSED, "volume"), (CLOSED.removesuffix("f 2 3 4\n"), "box")], ids=["closed", "open"])
def test_the_mass_of_a_modulus_is_spread_through_a_closed_mesh_else_through_the_box(tmp_path, mesh, distribution):
    (tmp_path / "body.obj").write_text(mesh)
    scene = scene_from({"mesh": {"file": "body.obj"}, "material": RUBBER, "lattice": {"cells": 4}}, path=tmp_path / "scene.toml")
    assert scene.mass.distribution == distribution and scene.lattice.points == (5, 3, 5)


def test_what_was_filled_in_follows_the_change_to_a_modulus_and_back():
    scene = scene_from({"material": RUBBER, "lattice": {"points": "cubic", "cells": 2, "size": [1.0, 2.0, 1.0]}})
    assert scene.lattice.points == (2, 3, 2)
    springs = scene.replace({"material.youngs_modulus": None, "lattice.cells": 4})
    assert springs.material.stiffness.edge == 1e3 and springs.material.damping == 0.01 and springs.lattice.points == (3, 5, 3)
    assert springs.mass.distribution == "uniform" and springs.mass.uniform_share == 0.1


@pytest.mark.parametrize(
    "size, spacing, cells", [([1, 1, 1], 0.25, (4, 4, 4)), ([0.3, 0.1, 0.02], 0.1, (3, 1, 1)), ([1.45, 1.4, 2.46], 1.0, (2, 1, 3))]
)
def test_cells_of_a_spacing_are_as_nearly_cubes_as_the_box_allows(size, spacing, cells):
    assert cubic(size, spacing) == cells
    if max(cells) * spacing == pytest.approx(max(size)):
        assert cubic_along(size, max(cells)) == cells


@pytest.mark.parametrize("longest", range(1, 32))
def test_cells_along_the_longest_side_are_as_many_as_asked_for(longest):
    assert cubic_along([0.7, 0.7, 0.1], longest)[:2] == (longest, longest)


@pytest.mark.parametrize(
    "lattice, points", [({"cells": 10}, (11, 6, 2)), ({"spacing": 0.1}, (11, 6, 2)), ({"points": "cubic", "spacing": 0.05}, (21, 11, 3))]
)
def test_a_lattice_follows_cells_or_spacing(lattice, points):
    scene = scene_from({"lattice": {"size": [1.0, 0.5, 0.1], **lattice}})
    assert scene.lattice.points == points and len(scene.rest_positions()) == np.prod(points)
    assert scene.replace({}) == scene


@pytest.mark.parametrize("sides", [(1.0, 1.0, 1.0), (1.0, 1.0, 2**-0.5), (1.5**0.5, 1.0, 1.0), (3e-200, 3e-200, 3e-200)])
def test_cells_up_to_the_limit_are_allowed_and_those_beyond_are_not(sides):
    assert fit_springs(sides, (1, 1, 1)) and fit_springs(sides[::-1], (1, 1, 1))
    longest = 1.001 * max(sides)
    beyond = [longest if side == max(sides) else side for side in sides]
    assert fit_springs(beyond, (1, 1, 1)) == (len(set(sides)) == 1)


def test_the_counts_named_work_for_boxes_of_any_shape():
    rng = np.random.default_rng(5)
    for size in rng.uniform(0.1, 1.0, (200, 3)):
        given = rng.integers(1, 10, 3).tolist()
        assert fit_springs(size, nearest_fit(size, given, fit_springs))


def test_a_box_of_one_density_has_an_eighth_of_an_inner_points_mass_at_its_corners():
    mass = masses(lattice={"size": [3.0, 3.0, 3.0]}, mass={"density": 80.0, "distribution": "box"})
    assert (mass[0, 0, 0], mass[1, 0, 0], mass[1, 1, 0], mass[1, 1, 1]) == pytest.approx((10, 20, 40, 80), rel=1e-14)
    assert mass.sum() == pytest.approx(80 * 27, rel=1e-14) and (mass == mass[::-1]).all()


def test_a_region_gives_its_cells_a_density_and_a_points_mass_wins():
    lower = {"points": {"k": [0, 1]}, "density": 160.0}
    document = {"lattice": {"size": [3.0, 3.0, 3.0]}, "mass": {"density": 80.0, "distribution": "box"}}
    mass = masses(**document, region=[lower])
    assert (mass[0, 0, 0], mass[1, 1, 0], mass[1, 1, 1], mass[1, 1, 2]) == pytest.approx((20, 80, 120, 80), rel=1e-14)
    assert mass.sum() == pytest.approx(80 * 18 + 160 * 9, rel=1e-14)
    assert masses(**document, region=[{"points": [[0, 0, 0]], "mass": 7.0}, lower])[0, 0, 0] == 7.0


def test_whole_cells_and_shares_of_corners_know_which_way_the_axes_run():
    counts = (2, 3, 4)
    points = np.setdiff1d(np.arange(24), [1 + 2 * (2 + 3 * 3)])  # all but the last corner
    assert np.argwhere(~cells_within(points, counts)).tolist() == [[0, 1, 2]]
    cells = np.zeros((1, 2, 3))
    cells[0, 1, 2] = 8.0
    assert np.argwhere(shared_by_corners(cells)).tolist() == [[i, j, k] for i in (0, 1) for j in (1, 2) for k in (2, 3)]
