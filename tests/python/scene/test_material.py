"""Materials by their modulus: keys that go together, defaults that depend on others, and the cells that springs can fill."""

import numpy as np
import pytest

from softffd.errors import SceneError
from softffd.fmu.package import scene_masses
from softffd.lattice import cells_within, shared_by_corners, to_grid
from softffd.scene.cells import cubic, cubic_along, nearest_solid, solid
from softffd.scene.scene import scene_from

CLOSED = "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
RUBBER = {"youngs_modulus": 1e6}
CUBE = {"i": [0, 1], "j": [0, 1], "k": [0, 1]}


def problems(document, path="scene.toml"):
    with pytest.raises(SceneError) as caught:
        scene_from(document, path=path)
    return caught.value.problems


def masses(**document):
    scene = scene_from(document)
    return to_grid(scene_masses(scene).mass[:, None], scene.lattice.points)[..., 0]


def test_a_modulus_has_no_stiffness_no_drag_and_the_box_for_its_mass():
    scene = scene_from({"material": RUBBER, "mass": {"density": 1100.0}})
    assert scene.material.stiffness is None and scene.material.damping == 0 and scene.material.internal_damping == 0
    assert scene.mass.distribution == "box" and scene.mass.uniform_share == 0
    assert scene_from({"material": RUBBER | {"damping": 0.3}, "mass": {"distribution": "uniform"}}).material.damping == 0.3


def test_without_a_modulus_the_defaults_are_those_of_springs():
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
    "material, got",
    [
        (RUBBER | {"stiffness": 2e3}, "stiffness = 2000 and youngs_modulus = 1e+06"),
        (
            RUBBER | {"stiffness": {"edge": 1.0, "face": 2.0, "body": 3.0}},
            "stiffness = { edge = 1.0, face = 2.0, body = 3.0 } and youngs_modulus = 1e+06",
        ),
    ],
)
def test_stiffness_and_modulus_exclude_each_other(material, got):
    assert problems({"material": material}) == [f"material: wanted stiffness or youngs_modulus, got {got}"]


@pytest.mark.parametrize(
    "material, line",
    [
        ({"youngs_modulus": 0}, "material.youngs_modulus: wanted > 0 Pa, got 0"),
        ({"internal_damping": -1}, "material.internal_damping: wanted >= 0 s, got -1"),
    ],
)
def test_values_out_of_range_are_refused(material, line):
    assert problems({"material": material, "region": [{"points": "z-", "youngs_modulus": 1.0}][: "youngs_modulus" in material]}) == [line]


def test_springs_of_a_modulus_are_not_those_of_the_paper():
    (line,) = problems({"material": RUBBER, "lattice": {"springs": "paper"}})
    assert line == 'lattice.springs: wanted "distinct", as springs of a youngs_modulus are, got "paper"'


@pytest.mark.parametrize(
    "material, region, line",
    [
        (RUBBER, {"stiffness": 4e3}, "region[0].stiffness: wanted youngs_modulus, for the material has one, got stiffness = 4000"),
        ({}, {"youngs_modulus": 4e3}, "region[0].youngs_modulus: wanted stiffness, for the material has one, got youngs_modulus = 4000"),
        (
            {},
            {"density": 200.0},
            'region[0].density: wanted it with mass.distribution = "box" only, whose cells have masses, got 200 with "uniform"',
        ),
    ],
)
def test_a_region_overrides_what_the_scene_has(material, region, line):
    assert problems({"material": material, "region": [{"points": "all", **region}]}) == [line]


@pytest.mark.parametrize("key", ["youngs_modulus", "internal_damping", "density"])
def test_a_region_without_a_whole_cell_is_refused_where_a_key_holds_in_cells(key):
    (line,) = problems({"material": RUBBER, "region": [{"points": "z-", key: 1e3}]})
    assert line == f'region[0].points: wanted all eight corners of one cell at least, in which {key} would hold, got "z-"'
    assert scene_from({"material": RUBBER, "region": [{"points": CUBE, key: 1e3}]})


def test_internal_damping_of_springs_holds_in_a_region_without_a_cell():
    assert scene_from({"region": [{"points": "z-", "internal_damping": 1e-3}]})


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


@pytest.mark.parametrize(
    "lattice, line",
    [
        ({"points": [3, 3, 3], "cells": 2}, "lattice: wanted points or cells, got points = [3, 3, 3] and cells = 2"),
        ({"cells": 2, "spacing": 0.5}, "lattice: wanted cells or spacing, got cells = 2 and spacing = 0.5"),
        ({"points": "cubic"}, 'lattice.points: wanted cells or spacing beside "cubic", got neither'),
        ({"points": "cubik", "cells": 3}, 'lattice.points: wanted "cubic", got "cubik", did you mean "cubic"?'),
        ({"cells": 32}, "lattice.cells: wanted <= 31, got 32"),
        ({"cells": 0}, "lattice.cells: wanted >= 1, got 0"),
        ({"spacing": 0.0}, "lattice.spacing: wanted > 0 m, got 0.0"),
        ({"spacing": 1e-9}, "lattice.spacing: wanted >= 0.0323 m, for a side has at most 31 cells, got 1e-09"),
        ({"points": "cubic", "cells": 99}, "lattice.cells: wanted <= 31, got 99"),
    ],
)
def test_ways_to_count_that_do_not_fit_are_refused(lattice, line):
    assert problems({"lattice": lattice}) == [line]


def test_selections_are_not_blamed_where_the_counts_are_not_known():
    assert problems({"lattice": {"cells": 0}, "inputs": {"forces": [[9, 0, 0]]}}) == ["lattice.cells: wanted >= 1, got 0"]


def test_cells_too_long_for_springs_are_refused_with_counts_that_work():
    box = {"size": [0.3, 0.3, 1.2]}
    (line,) = problems({"material": RUBBER, "lattice": box})
    assert line == (
        "lattice.points: wanted nearly cubic cells, for springs of a given modulus: one long side at most 1.22 times the other two, "
        "or two long sides at most 1.41 times the third; got cells of 0.1 x 0.1 x 0.4 m; "
        "points = [4, 4, 13] gives 0.1 x 0.1 x 0.1"
    )
    assert scene_from({"material": RUBBER, "lattice": {**box, "points": [4, 4, 13]}}) and scene_from({"lattice": box})


@pytest.mark.parametrize("lattice, instead", [({"cells": 3}, "cells = 15 gives"), ({"spacing": 0.2}, "spacing = 0.06667 gives")])
def test_the_counts_that_work_are_named_by_the_key_that_was_given(lattice, instead):
    (line,) = problems({"material": RUBBER, "lattice": {"size": [1.0, 1.0, 0.05], **lattice}})
    assert line.startswith(f"lattice.{next(iter(lattice))}: ") and instead in line


def test_a_box_that_no_cells_fill_is_refused(tmp_path):
    (tmp_path / "flat.obj").write_text(CLOSED.replace("v 0 0 2", "v 0 0 0.01"))
    (line,) = problems({"material": RUBBER, "mesh": {"file": "flat.obj"}}, tmp_path / "scene.toml")
    assert line.endswith("; the box is too flat or too long for nearly cubic ones, of which a side has at most 31")


@pytest.mark.parametrize("sides", [(1.0, 1.0, 1.0), (1.0, 1.0, 2**-0.5), (1.5**0.5, 1.0, 1.0), (3e-200, 3e-200, 3e-200)])
def test_cells_up_to_the_limit_are_allowed_and_those_beyond_are_not(sides):
    assert solid(sides, (1, 1, 1)) and solid(sides[::-1], (1, 1, 1))
    longest = 1.001 * max(sides)
    beyond = [longest if side == max(sides) else side for side in sides]
    assert solid(beyond, (1, 1, 1)) == (len(set(sides)) == 1)


def test_the_counts_named_work_for_boxes_of_any_shape():
    rng = np.random.default_rng(5)
    for size in rng.uniform(0.1, 1.0, (200, 3)):
        given = rng.integers(1, 10, 3).tolist()
        assert solid(size, nearest_solid(size, given))


def test_a_box_of_one_density_has_an_eighth_of_an_inner_points_mass_at_its_corners():
    mass = masses(lattice={"size": [3.0, 3.0, 3.0]}, mass={"density": 80.0, "distribution": "box"})
    assert (mass[0, 0, 0], mass[1, 0, 0], mass[1, 1, 0], mass[1, 1, 1]) == pytest.approx((10, 20, 40, 80), rel=1e-14)
    assert mass.sum() == pytest.approx(80 * 27, rel=1e-14) and (mass == mass[::-1]).all()


def test_a_share_spread_evenly_over_a_box_is_refused():
    (line,) = problems({"mass": {"distribution": "box", "uniform_share": 0.2}})
    assert line == 'mass.uniform_share: wanted 0 where the distribution is "box", which leaves no point without mass, got 0.2'


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
