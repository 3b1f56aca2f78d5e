"""The mechanics in numpy that the component is checked against: springs, forces and starts."""

import json

import numpy as np
import pytest

from measured_scenes import DRIVEN
from scenes import box
from softffd import load_scene
from validation.mechanics import Body, outside_force, solid_shares, spring_list, start
from validation.resolved import resolved
from validation.stability.drive import Drive


@pytest.fixture
def driven(tmp_path):
    (tmp_path / "driven.toml").write_text(DRIVEN)
    return load_scene(tmp_path / "driven.toml")


@pytest.mark.parametrize("topology, edges, all_springs", [("distinct", 144, 468), ("paper", 180, 504)])
def test_the_paper_counts_the_edges_of_the_box_twice(topology, edges, all_springs):
    pairs, kinds = spring_list((4, 4, 4), topology)
    assert (len(pairs), (kinds == 1).sum()) == (all_springs, edges)


def test_spring_forces_are_what_the_elastic_energy_falls_by(driven):
    body, x, h = Body.of(resolved(driven)), start(resolved(driven))[0], 1e-6
    force = body.spring_force(x)
    for p, axis in np.ndindex(x.shape):
        step = np.zeros_like(x)
        step[p, axis] = h
        slope = (body.elastic_energy(x + step) - body.elastic_energy(x - step)) / (2 * h)
        assert force[p, axis] == pytest.approx(-slope, abs=1e-6)  # differences: rounding of 1e2 J over 1e-6 m is 1e-8 N
    assert force.sum(axis=0) == pytest.approx(0, abs=1e-12 * np.abs(force).max())


def test_a_region_keeps_its_own_stiffness_and_damping(driven):
    body = Body.of(resolved(driven), total=2.0, stiffness=(1.0, 2.0, 3.0), damping=0.5)
    inside = np.isin(np.arange(12), driven.select("x-"))
    assert set(body.stiffness[inside[body.pairs].all(axis=1)]) == {4e3}
    assert set(body.stiffness[~inside[body.pairs].all(axis=1)]) == {1.0, 2.0, 3.0}
    assert set(body.damping[inside]) == {0.2} and set(body.damping[~inside]) == {0.5}
    assert body.mass.sum() == pytest.approx(2.0, rel=1e-15)


def test_loads_are_shared_and_forces_go_to_their_point_for_one_time_and_for_many(driven):
    values = {"load.push.x": 6.0, "force[1,1,0].z": -2.0}
    force, last = outside_force(resolved(driven), values), driven.select("x+")
    assert force[last, 0] == pytest.approx(6.0 / len(last), rel=1e-15) and force[4, 2] == -2.0
    assert force.sum(axis=0) == pytest.approx([6.0, 0.0, -2.0], rel=1e-15)
    many = outside_force(resolved(driven), {name: np.array([value, 2 * value, 0.0]) for name, value in values.items()})
    assert np.array_equal(many, [force, 2 * force, 0 * force])


def test_the_start_is_the_components(driven):
    with Drive(driven) as drive:
        x, v = start(drive.resolved)
        assert drive.x == pytest.approx(x, abs=1e-15) and drive.v == pytest.approx(v, abs=1e-15)


def test_the_resolved_scene_survives_its_file_bit_by_bit(driven):
    content = resolved(driven)
    again = json.loads(json.dumps(content))
    for one, other in zip(start(content), start(again), strict=True):
        assert np.array_equal(one, other)
    assert np.array_equal(Body.of(content).mass, Body.of(again).mass)


SOLID = {"points": [4, 3, 5], "size": [0.3, 0.22, 0.36]}


@pytest.mark.parametrize("lattice", [SOLID, {"points": [2, 2, 2]}, {"cells": 6, "size": [0.2, 0.3, 0.1]}])
def test_springs_of_a_modulus_store_what_a_solid_does_in_any_homogeneous_strain(lattice):
    scene = box(lattice=lattice, material={"youngs_modulus": 2e5})
    body, x, rng = Body.of(resolved(scene)), scene.rest_positions(), np.random.default_rng(3)
    a, b = body.pairs.T
    way = (x[b] - x[a]) / body.length[:, None]
    for _ in range(5):
        strain = rng.normal(size=(3, 3))
        strain = strain + strain.T
        stored = 0.5 * body.stiffness @ (body.length * ((way @ strain) * way).sum(axis=1)) ** 2
        lame = 0.4 * 2e5  # both constants, of Poisson's ratio 1/4
        wanted = (lame / 2 * np.trace(strain) ** 2 + lame * (strain**2).sum()) * np.prod(scene.lattice_box.size)
        assert stored == pytest.approx(wanted, rel=1e-12)
    assert (body.stiffness >= 0).all() and np.count_nonzero(body.stiffness == 0) == 4 * np.prod(np.array(scene.lattice.points) - 1)


def test_shares_of_a_solid_are_the_formulas():
    a, b, c = sides = 0.11, 0.12, 0.1
    shares, volume = solid_shares(sides), a * b * c
    assert shares[1, 0, 0] == pytest.approx(volume / a**2 * (1.2 - 0.4 * a**2 / b**2 - 0.4 * a**2 / c**2), rel=1e-12)
    assert shares[0, 1, 1] == pytest.approx(0.2 * volume * (b**2 + c**2) / (b**2 * c**2), rel=1e-12)


def test_a_region_keeps_the_modulus_and_the_internal_damping_of_its_cells():
    half = {"points": {"k": [0, 1]}, "youngs_modulus": 4e5, "internal_damping": 2e-3}
    scene = box(lattice={"points": [3, 3, 3]}, material={"youngs_modulus": 1e5, "internal_damping": 1e-3}, region=[half])
    whole = Body.of(resolved(box(lattice={"points": [3, 3, 3]}, material={"youngs_modulus": 1e5})))
    body, heights = Body.of(resolved(scene)), scene.rest_positions()[whole.pairs, 2]
    factor = np.where((heights <= 0.5).all(axis=1), 4.0, 1.0)  # below, above, and both in the middle
    factor[(heights == 0.5).all(axis=1)] = 2.5
    has = whole.stiffness > 0
    assert body.stiffness[has] == pytest.approx((whole.stiffness * factor)[has], rel=1e-14)
    time = np.select([factor == 4, factor == 2.5], [2e-3, (4 * 2e-3 + 1e-3) / 5], 1e-3)
    assert body.dashpot[has] == pytest.approx((body.stiffness * time)[has], rel=1e-14)


def test_dashpots_leave_rigid_motion_alone_and_keep_both_momenta():
    scene = box(lattice={"points": [3, 2, 2]}, material={"internal_damping": 1e-3}, region=[{"points": "x-", "internal_damping": 0.0}])
    body, rng = Body.of(resolved(scene)), np.random.default_rng(2)
    x = scene.rest_positions() + rng.normal(0, 0.1, (12, 3))
    assert np.abs(body.dashpot_force(x, np.array([4.0, 0.0, 1.0]) + np.cross([1.0, 2.0, 3.0], x))).max() < 1e-12
    v = rng.normal(size=x.shape)
    force = body.dashpot_force(x, v)
    assert np.abs(force.sum(axis=0)).max() < 1e-12 and np.abs(np.cross(x, force).sum(axis=0)).max() < 1e-12
    assert (force * v).sum() < -0.01
    length = np.linalg.norm(x[body.pairs[:, 1]] - x[body.pairs[:, 0]], axis=1)
    later = np.linalg.norm((x + 1e-7 * v)[body.pairs[:, 1]] - (x + 1e-7 * v)[body.pairs[:, 0]], axis=1)
    assert -(force * v).sum() == pytest.approx(body.dashpot @ ((later - length) / 1e-7) ** 2, rel=1e-5)
