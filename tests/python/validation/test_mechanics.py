"""The mechanics in numpy that the component is checked against: springs, forces and starts."""

import json

import numpy as np
import pytest

from measured_scenes import DRIVEN
from softffd import load_scene
from softffd.validation.mechanics import Body, outside_force, spring_list, start
from softffd.validation.resolved import resolved
from softffd.validation.stability.drive import Drive


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
