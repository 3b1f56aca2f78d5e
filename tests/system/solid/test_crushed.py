"""A solid that is let go of a shape that nothing real survives comes back to rest: steps follow its frequency, nothing is lost."""

import numpy as np
import pytest

from softffd import Simulation
from softffd.embedding.nodes import node_positions
from softffd.lattice import to_flat
from solids import Patches, braked, solid

CASES = [(n, ratio, stretch) for n, ratio in ((4, 0.25), (4, 0.45), (7, 0.25), (7, 0.45)) for stretch in (0.3, 0.05, -1.0)]


@pytest.mark.short("4-*", "7-0.25-*")
@pytest.mark.parametrize(("n", "ratio", "stretch"), CASES)
def test_a_crushed_solid_comes_back(n, ratio, stretch):
    """To a part of its height, or mirrored, and shaken at the start so that no symmetry holds it."""
    scene = solid(
        n, ratio=ratio, modulus=1e4, stretch=[1.0, 1.0, stretch], region=braked(n, 100.0), forces="all", solver={"most_work": 1e8},
        stop_time=1.2, communication_step=0.02, energy=True,
    )  # fmt: skip
    shaking = 0.01 * np.random.default_rng(1).standard_normal((n, n, n, 3))
    with Simulation(scene) as sim:
        sim.forces = shaking - shaking.mean(axis=(0, 1, 2))
        for _ in range(60):
            sim.step()
            sim.forces = np.zeros_like(shaking)
            assert np.isfinite(sim.positions).all()
        volumes = Patches(scene).volumes(to_flat(node_positions(sim.positions)))
        assert volumes == pytest.approx(1, abs=1e-3)
        assert abs(sim["energy.elastic"]) < 1e-9
        assert not any("springs" in message.text for message in sim.log)


def test_nodes_that_are_inside_out_are_counted():
    """A cube whose ends are held is pressed to 30 %: J comes below 0 at the held edges."""
    plate = {"name": "plate", "points": "z+", "motion": "input", "inputs": ["position.z", "velocity.z"]}
    scene = solid(4, ratio=0.45, pin=[{"name": "wall", "points": "z-"}, plate], region=braked(4, 1.5), outputs={"solver": True})
    with Simulation(scene) as sim:
        for step in range(80):
            sim["pin.plate.position.z"], sim["pin.plate.velocity.z"] = 1 - 0.035 * 0.25 * step, -0.035
            sim.step(0.25)
        assert Patches(scene).volumes(to_flat(node_positions(sim.positions))).min() < -0.1
        assert sim.number("solver.folded_cells") > 0
