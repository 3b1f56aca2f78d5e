"""Forces, loads, probes and regional overrides act as stated."""

from dataclasses import replace

import numpy as np
import pytest

import reference
from readings import points, vector, velocities
from scenes import box
from softffd import deform, simulate


def loaded(stiffness):
    return box(
        points=[3, 4, 2], mass={"total": 4.8}, stiffness=stiffness, damping=0.0,
        load=[{"name": "push", "points": "x+"}, {"name": "lift", "points": [[0, 0, 0], [2, 3, 1]]}], forces=[[2, 3, 1], [0, 1, 0]],
        velocities="all", step=5e-4, stop_time=0.5, communication_step=0.1,
    )  # fmt: skip


VALUES = {
    "load.push.x": 8.0, "load.push.z": -4.0, "load.lift.y": 3.0,
    "force[2,3,1].x": 0.5, "force[2,3,1].y": -1.5, "force[0,1,0].z": 2.5,
}  # fmt: skip


def external():
    """The same forces on the 24 points, put together by hand, N."""
    force = np.zeros((2, 4, 3, 3))  # [k, j, i]
    force[:, :, 2] += np.array([8.0, 0.0, -4.0]) / 8
    force[0, 0, 0] += np.array([0.0, 3.0, 0.0]) / 2
    force[1, 3, 2] += np.array([0.0, 3.0, 0.0]) / 2
    force[1, 3, 2] += [0.5, -1.5, 0.0]
    force[0, 1, 0] += [0.0, 0.0, 2.5]
    return force.reshape(-1, 3)


def test_loads_are_shared_equally_and_forces_act_on_their_points():
    result = simulate(loaded(0.0), start_values=VALUES)
    assert velocities(result)[-1] == pytest.approx(external() / 0.2 * 0.5, rel=1e-12, abs=1e-14)  # sums of 1000 kicks


def test_loads_and_forces_move_the_lattice_as_the_reference_says():
    result = simulate(loaded(800.0), start_values=VALUES)
    model = reference.cube(stiffness=800.0, counts=(3, 4, 2), total=4.8)
    x, _ = reference.leapfrog(model, model.rest, np.zeros_like(model.rest), 5e-4, 1000, external=external())
    assert points(result)[-1] == pytest.approx(x, abs=1e-12)


CORNER = {"origin": [-1.0, 0.5, 2.0], "size": [1.5, 0.8, 2.0]}


def regional(topology="distinct"):
    return box(
        lattice={"points": [4, 3, 5], "springs": topology, **CORNER},
        mass={"total": 6.0},
        stiffness=1e3,
        damping=0.02,
        region=[
            {"points": "z-", "stiffness": 4e3, "damping": 0.3},
            {"points": {"i": [0, 1]}, "stiffness": 200.0, "mass": 0.3},
            {"points": [[3, 2, 4], [3, 1, 4], [0, 0, 0]], "mass": 0.05, "damping": 0.0},
        ],
        stretch=[1.1, 0.9, 1.05],
        angular_velocity=[1.0, 2.0, 3.0],
        velocities="all",
        energy=True,
        step=5e-4,
        stop_time=0.2,
        communication_step=0.02,
    )


def model_with_regions(topology):
    counts = (4, 3, 5)
    rest = reference.rest_lattice(counts, **CORNER)
    springs = reference.spring_list(counts, topology=topology)
    low, left, spots = np.arange(60) < 12, np.arange(60) % 4 <= 1, np.isin(np.arange(60), [3 + 4 * 2 + 48, 3 + 4 * 1 + 48, 0])
    stiffness = np.full(len(springs), 1e3)
    stiffness[low[springs].all(axis=1)] = 4e3
    stiffness[left[springs].all(axis=1)] = 200.0  # the later one wins
    mass, damping = np.full(60, 0.1), np.full(60, 0.02)
    mass[left], mass[spots] = 0.3, 0.05
    damping[low], damping[spots] = 0.3, 0.0
    return reference.Model(rest, springs, stiffness, mass, damping)


def state_after(model, result):
    """Positions and velocities of the reference at the end of the run, from its start."""
    return reference.leapfrog(model, points(result)[0], velocities(result)[0], 5e-4, 400)


@pytest.mark.parametrize("topology", ["distinct", "paper"])
def test_regional_stiffness_mass_and_damping_are_the_references(topology):
    result, model = simulate(regional(topology)), model_with_regions(topology)
    corner, middle = np.array([-1.0, 0.5, 2.0]), np.array([0.75, 0.4, 1.0]) * [1.1, 0.9, 1.05] + [-1.0, 0.5, 2.0]
    x = corner + (model.rest - corner) * [1.1, 0.9, 1.05]
    assert points(result)[0] == pytest.approx(x, abs=1e-15)
    assert velocities(result)[0] == pytest.approx(np.cross([1.0, 2.0, 3.0], x - middle), abs=1e-14)
    assert result.outputs["energy.elastic"][0] == pytest.approx(model.elastic_energy(x), rel=1e-12)
    x, v = state_after(model, result)
    assert points(result)[-1] == pytest.approx(x, abs=1e-12)
    assert velocities(result)[-1] == pytest.approx(v, abs=1e-10)


def test_another_mass_scales_every_point():
    result, model = simulate(regional(), start_values={"mass": 2.0}), model_with_regions("distinct")
    assert result.parameters["mass"] == 2.0
    scaled = replace(model, mass=model.mass * 2.0 / model.mass.sum())
    assert points(result)[-1] == pytest.approx(state_after(scaled, result)[0], abs=1e-12)


def test_other_stiffness_and_damping_leave_the_overrides_as_they_are():
    values = {"stiffness.edge": 700.0, "stiffness.face": 700.0, "stiffness.body": 700.0, "damping": 0.1}
    result, model = simulate(regional(), start_values=values), model_with_regions("distinct")
    stiffness, damping = np.where(model.stiffness == 1e3, 700.0, model.stiffness), np.where(model.damping == 0.02, 0.1, model.damping)
    changed = replace(model, stiffness=stiffness, damping=damping)
    assert points(result)[-1] == pytest.approx(state_after(changed, result)[0], abs=1e-12)


PROBES = {"inside": [1.3, 2.85, 5.9], "corner": [3.0, 3.0, 7.0], "middle": [2.0, 2.5, 5.0]}


def probed(**lattice):
    return box(
        lattice={"points": [4, 3, 5], "origin": [1.0, 2.0, 3.0], "size": [2.0, 1.0, 4.0], **lattice}, stretch=[1.2, 0.9, 1.0],
        velocity=[0.1, 0.2, -0.3], angular_velocity=[1.0, -2.0, 0.5], probe=[{"name": name, "at": at} for name, at in PROBES.items()],
        stop_time=0.5, communication_step=0.05,
    )  # fmt: skip


def test_probes_follow_the_bezier_volume():
    result = simulate(probed())
    for name, at in PROBES.items():
        u = (np.array(at) - [1.0, 2.0, 3.0]) / [2.0, 1.0, 4.0]
        expected = [reference.bezier_point(grid, u) for grid in result.positions]
        assert vector(result, f"probe.{name}") == pytest.approx(np.array(expected), abs=1e-14)
        assert np.ptp(vector(result, f"probe.{name}"), axis=0).max() > 1e-3


def test_probes_in_bsplines_are_the_points_that_the_object_has_there():
    """Of a fine lattice, against the Python package's own deformation of these points."""
    result = simulate(probed(basis="bspline", points=[9, 6, 12]))
    lattice = result.scene.lattice
    assert lattice.points == (9, 6, 12)
    expected = deform(np.array(list(PROBES.values())), result.positions, origin=lattice.origin, size=lattice.size, basis="bspline")
    for number, name in enumerate(PROBES):
        assert vector(result, f"probe.{name}") == pytest.approx(expected[:, number], abs=1e-13)
        assert np.ptp(vector(result, f"probe.{name}"), axis=0).max() > 1e-3
