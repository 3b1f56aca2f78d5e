"""Outputs are read by name, by part and as grids."""

import numpy as np
import pytest

from host_scenes import HELD, scene, step
from softffd import FmuError, Simulation


def test_positions_and_velocities_are_grids_that_stay_as_they_were_read(sim, held):
    before = held.positions
    kept = before.copy()
    assert before.shape == (3, 4, 5, 3)
    np.testing.assert_allclose(before[2, 3, 4], [1.0, 1.0, 1.0])
    np.testing.assert_allclose(before[1, 0, 0], [0.5, 0.0, 0.0])
    held.pin["grip"].velocity = (0, 0, -1)
    step(held)
    np.testing.assert_array_equal(before, kept)
    assert held["position[1,2,3].y"] == held.positions[1, 2, 3, 1]
    step(sim)
    assert sim.velocities.shape == (4, 4, 4, 3) and sim.velocities[3, 0, 3, 2] == sim["velocity[3,0,3].z"] < 0


def test_what_is_not_among_the_outputs_is_nan_or_refused(held):
    with Simulation(scene(HELD, outputs={"positions": [[2, 3, 4]]})) as one:
        assert np.isnan(one.positions[0, 0, 0]).all() and np.isfinite(one.positions[2, 3, 4]).all()
    with pytest.raises(FmuError, match=r"outputs\.velocities"):
        _ = held.velocities


def test_names_give_numbers_items_and_vectors(sim):
    assert isinstance(sim["plane.ground.contacts"], int)
    assert sim["solver.method"] == "auto"
    np.testing.assert_array_equal(sim["plane.plate.point"], [0.0, 0.0, 1.2])
    assert "energy.kinetic" in sim and "plane.plate.point" in sim and "nobody" not in sim
    assert sim.variables["mass"].unit == "kg"


def test_energies_and_reactions_balance_by_name(sim):
    start = sim["energy.kinetic"] + sim["energy.elastic"] + sim["energy.gravity"]
    step(sim, 10)
    now = sum(sim[f"energy.{kind}"] for kind in ("kinetic", "elastic", "gravity", "dissipated")) - sim["energy.work"]
    assert now == pytest.approx(start, abs=1e-4)  # J; the balance closes to the integration error
    np.testing.assert_array_equal(sim.plane["ground"].reaction, [sim[f"plane.ground.reaction.{c}"] for c in "xyz"])
    assert sim.plane["ground"].reaction[2] < 0 and sim.plane["ground"].contacts == sim["plane.ground.contacts"] == 16
    assert sim.plane["ground"].torque.shape == (3,)


def test_parts_are_listed_in_the_order_of_the_scene(sim, held):
    assert [*sim.plane] == ["ground", "plate"] and len(sim.plane) == 2
    assert [*held.pin] == ["grip", "wall"] and [*held.plane] == []
    assert [*sim.load] == ["push"] and [*sim.probe] == ["top"]
    np.testing.assert_allclose(sim.probe["top"], [0.5, 0.5, 1.0])
