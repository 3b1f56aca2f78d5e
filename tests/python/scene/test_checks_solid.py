"""Solids of finite elements in a scene: what is filled in, the records, and every refusal with its text."""

import re

import numpy as np
import pytest

from scenes import TETRAHEDRON, problems
from softffd.embedding.nodes import PLACES
from softffd.fmu.package import scene_masses
from softffd.fmu.records import scene_records
from softffd.scene.cells import fit_solid, nearest_fit
from softffd.scene.scene import scene_from

SOLID = {"model": "solid", "youngs_modulus": 1e6}
BESIDE = 'beside material.model = "solid"'
SPRINGS = 'beside material.model = "springs"'
NARROWER = "; at most 400 points across the longest axis, as 19 x 19, have it too"
SLENDER = "cells of a solid at most 2.5 times as long in one direction as in another (4 times with a single patch)"


def solid(material=(), **document):
    return {"material": SOLID | dict(material), **document}


def lattice(**keys):
    return solid(lattice=keys)


def region(**keys):
    return solid(region=[{"points": "all", **keys}])


# fmt: off
REFUSED = [
    ({"material": {"model": "solid"}}, f"material.youngs_modulus: wanted one in Pa {BESIDE}, got none"),
    ({"material": {"model": "soild", "poissons_ratio": 0.3}},
     'material.model: wanted "springs" or "solid", got "soild", did you mean "solid"?'),
    # numbers
    (solid({"poissons_ratio": 0.499}), "material.poissons_ratio: wanted <= 0.495, got 0.499"),
    (solid({"poissons_ratio": -0.1}), "material.poissons_ratio: wanted >= 0, got -0.1"),
    (solid({"density": 0}), "material.density: wanted > 0 kg/m3, got 0"),
    # keys of springs
    (solid({"stiffness": 2e3}),
     f"material.stiffness: wanted none {BESIDE}, got 2000; youngs_modulus and poissons_ratio say how stiff it is"),
    (solid({"volume_stiffness": 0.0}),
     f"material.volume_stiffness: wanted none {BESIDE}, got 0.0; poissons_ratio says how it resists a change of its volume"),
    (lattice(springs="distinct"), f'lattice.springs: wanted none {BESIDE}, got "distinct"; it has no springs'),
    (solid(mass={"uniform_share": 0.1}), f"mass.uniform_share: wanted none {BESIDE}, got 0.1; none of its nodes is nearly massless"),
    *((solid(mass={"inertia": word}),
       f'mass.inertia: wanted none {BESIDE}, got "{word}"; its masses match the inertia of the object where that is possible')
      for word in ("lumped", "matched")),
    *((region(**{key: 1e3}), f"region[0].{key}: wanted none {BESIDE}, got 1000.0; {instead}") for key, instead in (
        ("stiffness", "all of it has material.youngs_modulus"), ("youngs_modulus", "all of it has material.youngs_modulus"),
        ("internal_damping", "all of it has material.internal_damping"), ("density", "give mass, of each of the points"))),
    (region(stiffness=0.0), f"region[0].stiffness: wanted none {BESIDE}, got 0.0; all of it has material.youngs_modulus"),
    # words
    (solid(mass={"distribution": "uniform"}),
     f'mass.distribution: wanted "box", "vertices", "surface" or "volume" {BESIDE}, got "uniform"'),
    (lattice(basis="bspline", points=[7, 7, 7]), f'lattice.basis: wanted "patches" {BESIDE}, got "bspline"'),
    (lattice(basis="bezier", points=[4, 7, 4]), f'lattice.basis: wanted "patches" {BESIDE}, got "bezier"'),
    (lattice(basis="bspline"), f'lattice.basis: wanted "bezier" or "patches" {BESIDE}, got "bspline"'),
    *((solid(solver={"method": word}),
       'solver.method: wanted "auto", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2", "backward_euler" or "sdirk2" '
       f'{BESIDE}, got "{word}"')
      for word in ("central_difference",)),
    *((solid(solver={"method": word}, lattice={"points": [22, 22, 22]}),
       f'solver.method: wanted "auto", "leapfrog", "bm4", "rkn12" or "dop853" {BESIDE}, got "{word}"{narrower}')
      for word, narrower in (("central_difference", ""), *dict.fromkeys(("ros34pw2", "backward_euler", "sdirk2"), NARROWER).items())),
    # density
    (solid({"density": 5.0}, mass={"density": 5.0}), "material.density: wanted none beside mass.density = 5, got 5"),
    (solid({"density": 5.0}, mass={"total": 2.0}), "material.density: wanted none beside mass.total = 2, got 5"),
    (solid({"density": 5.0}, mesh={"file": "open.obj"}, lattice={"cells": 3}),
     "material.density: 5.0 needs a closed mesh, but open.obj is open (holes in its surface, or faces turned inside out); "
     'give "total" instead'),
    # the lattice
    (lattice(points=[5, 4, 6]), f"lattice.points: wanted 4, 7, 10, .. or 31 along each axis {BESIDE}, got [5, 4, 6]; [4, 4, 7] is nearest"),
    (lattice(points=[2, 3, 32]),
     f"lattice.points: wanted 4, 7, 10, .. or 31 along each axis {BESIDE}, got [2, 3, 32]; [4, 4, 31] is nearest"),
    (lattice(size=[4.1, 1.0, 1.0]),
     f"lattice.points: wanted {SLENDER}; got cells of 1.367 x 0.3333 x 0.3333 m; points = [13, 4, 4] gives 0.3417 x 0.3333 x 0.3333"),
    (lattice(size=[6.0, 2.0, 2.0], points=[4, 7, 4]),
     "lattice.points: ...got cells of 2 x 0.3333 x 0.6667 m; points = [10, 4, 4] gives..."),
    (lattice(size=[10.0, 1.0, 1.0], cells=4), "lattice.cells: ...; cells = 30 gives 0.3333 x 0.3333 x 0.3333"),
    (lattice(size=[10.0, 1.0, 1.0], spacing=3.0), "lattice.spacing: ...; spacing = 0.3333 gives 0.3333 x 0.3333 x 0.3333"),
    (lattice(size=[26.0, 1.0, 1.0]), "...; the box is too flat or too long for nearly cubic ones, of which a side has at most 30"),
    (lattice(spacing=0.01), "lattice.spacing: wanted >= 0.0333 m, because a side has at most 30 cells, got 0.01"),
    # what springs have not
    ({"material": {"poissons_ratio": 0.3}}, f"material.poissons_ratio: wanted none {SPRINGS}, got 0.3; that of springs is 1/4"),
    ({"material": {"youngs_modulus": 1e6, "density": 1100.0}}, f"material.density: wanted none {SPRINGS}, got 1100.0; give mass.density"),
    ({"lattice": {"basis": "patches"}}, f'lattice.basis: wanted "bezier" or "bspline" {SPRINGS}, got "patches"; a solid has them'),
]
ALLOWED = [
    lattice(size=[4.0, 1.0, 1.0]), lattice(size=[5.0, 1.0, 1.0], points=[7, 4, 4]), lattice(points=[31, 31, 31]),
    lattice(basis="bezier"), lattice(basis="patches", points=[7, 4, 7]), solid({"poissons_ratio": 0.0}), solid({"poissons_ratio": 0.495}),
    solid(mass={"density": 2.0}), region(mass=2.0, damping=0.1),
    *(solid(solver={"method": word}) for word in ("leapfrog", "bm4", "rkn12", "dop853")),
]
# fmt: on


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("solids")
    closed = TETRAHEDRON.replace("v 0 0 4", "v 0 0 2")
    for name, text in {"closed": closed, "open": closed.removesuffix("f 2 3 4\n")}.items():
        (folder / f"{name}.obj").write_text(text)
    return folder


@pytest.mark.parametrize(("document", "line"), REFUSED, ids=[line[:50] for _, line in REFUSED])
def test_what_a_solid_has_not_is_one_problem(document, line, folder):
    (found,) = problems(document, folder / "scene.toml")
    assert re.fullmatch(".*".join(map(re.escape, line.split("..."))), found), found


@pytest.mark.parametrize("document", ALLOWED, ids=str)
def test_what_is_allowed_is_a_scene(document, folder):
    assert scene_from(document, path=folder / "scene.toml").is_solid


def test_what_is_left_open_is_filled_in():
    scene = scene_from({"material": SOLID | {"density": 1100.0}})
    material, mass = scene.material, scene.mass
    assert (material.poissons_ratio, material.damping, material.internal_damping, material.stiffness) == (0.45, 0.0, 0.0, None)
    assert scene.lattice.basis == "patches" and scene.lattice.points == (4, 4, 4)
    assert (mass.density, mass.total, mass.distribution) == (1100.0, None, "box")
    springs = scene.replace({"material.model": None, "material.density": None})
    assert springs.lattice.basis == "bezier" and springs.mass.total == 1.0 and springs.material.poissons_ratio is None


@pytest.mark.parametrize("mesh, distribution", [("closed", "volume"), ("open", "box")])
def test_the_mass_goes_through_a_closed_mesh_else_through_the_box(folder, mesh, distribution):
    scene = scene_from(solid(mesh={"file": f"{mesh}.obj"}, lattice={"cells": 6}), path=folder / "scene.toml")
    assert scene.mass.distribution == distribution and scene.lattice.points == (7, 4, 7)


@pytest.mark.parametrize(
    "keys, points",
    [({"cells": 1}, (4, 4, 4)), ({"cells": 5}, (7, 4, 4)), ({"cells": 31}, (31, 16, 13)), ({"spacing": 0.05}, (22, 10, 10)),
     ({"points": "cubic", "cells": 9}, (10, 7, 4))],
)  # fmt: skip
def test_cells_are_those_of_whole_patches(keys, points):
    assert scene_from(lattice(size=[1.0, 0.5, 0.4], **keys)).lattice.points == points


def test_the_counts_named_fit_boxes_of_any_shape():
    rng = np.random.default_rng(5)
    for size in rng.uniform(0.1, 1.0, (200, 3)):
        found = nearest_fit(size, (3 * rng.integers(1, 10, 3)).tolist(), fit_solid, 3)
        assert fit_solid(size, found) and not any(count % 3 for count in found)


def test_nodes_at_joints_stand_where_patches_meet_and_a_pin_at_the_mean_of_those_it_holds():
    scene = scene_from(lattice(size=[3.0, 3.0, 3.0]) | {"pin": [{"name": "a", "points": {"i": [0, 1]}}, {"name": "b", "points": "x+"}]})
    np.testing.assert_allclose(scene.pin_origin(scene.pin[0]), [1.5 * PLACES[1], 1.5, 1.5], rtol=1e-15)
    np.testing.assert_allclose(scene.pin_origin(scene.pin[1]), [3.0, 1.5, 1.5], rtol=1e-15)
    nodes = scene.mass_positions()
    assert nodes.shape == (64, 3)
    np.testing.assert_allclose(nodes[:4, 0], 3 * PLACES, rtol=1e-15)
    np.testing.assert_allclose(nodes.mean(axis=0), 1.5)
    joined = scene_from(lattice(points=[7, 4, 10], size=[1.0, 1.0, 1.5]))
    assert joined.mass_positions()[3 + 7 * (0 + 4 * 6)] == pytest.approx([0.5, 0.0, 1.0])


def test_the_records_are_those_of_a_solid():
    scene = scene_from(lattice(points=[7, 4, 4]) | {"pin": [{"name": "held", "points": "z-", "motion": "input"}]})
    masses = scene_masses(scene)
    records = {key: values for key, *values in (line.split() for line in scene_records(scene, masses).splitlines())}
    assert records["basis"] == ["patches"] and records["poissons_ratio"] == ["0.45"] and records["youngs_modulus"] == ["1000000.0"]
    assert not records.keys() & {"topology", "stiffness", "weight", "volume_stiffness"}
    assert len(records["mass"]) == 7 * 16 and list(map(float, records["pin_origin"])) == pytest.approx([0.5, 0.5, 0.0])
    given = scene_records(scene_from(lattice(basis="bezier")), scene_masses(scene_from(solid())))
    assert "basis patches\n" in given
