"""Stress, von Mises' stress and stretch at probes of a solid: outputs of the FMU beside what the package finds from control points."""

import numpy as np
import pytest

from softffd import Scene, simulate

CELL = (2, 1, 0)


@pytest.fixture(scope="module")
def pulled():
    """A bar that hangs on one end and is pulled askew, and a probe at the centre of one of its cells."""
    side = np.array([2.0, 0.7, 1.1]) / (6, 3, 3)
    centre = (side * (np.array(CELL) + 0.5)).tolist()
    scene = Scene(
        lattice={"points": [7, 4, 4], "size": [2.0, 0.7, 1.1]},
        material={"model": "solid", "youngs_modulus": 1e5, "poissons_ratio": 0.4, "density": 1e3, "internal_damping": 0.01},
        pin=[{"name": "wall", "points": "x-"}], load=[{"name": "end", "points": "x+"}],
        probe=[{"name": "cell", "at": centre, "stress": True, "von_mises": True, "stretch": True}, {"name": "tip", "at": [2.0, 0.0, 0.0]}],
        experiment={"stop_time": 0.3, "communication_step": 0.1},
    )  # fmt: skip
    return simulate(scene, start_values={"load.end.x": 1e4, "load.end.z": 2e3})


def test_it_is_that_of_the_cell(pulled):
    wanted = pulled.stress(slice(None))[:, *CELL]
    for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        found = pulled.outputs[f"probe.cell.stress.{'xyz'[a]}{'xyz'[b]}"]
        assert np.abs(found - wanted[:, a, b]).max() < 1e-9 * np.abs(wanted).max()
    shape = wanted - np.trace(wanted, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    assert np.allclose(pulled.outputs["probe.cell.von_mises"], np.sqrt(1.5 * (shape**2).sum(axis=(1, 2))), rtol=1e-9)
    assert pulled.outputs["probe.cell.von_mises"].max() > 1e4


def test_the_largest_stretch_is_of_the_cell_and_one_at_rest(pulled):
    strain = pulled.strain(slice(None))[:, *CELL]
    largest = np.sqrt(1 + 2 * np.linalg.eigvalsh(strain)[:, -1])
    assert np.allclose(pulled.outputs["probe.cell.stretch"], largest, rtol=1e-12)
    assert pulled.outputs["probe.cell.stretch"][0] == pytest.approx(1, abs=1e-12)


def test_a_probe_that_asks_for_nothing_has_its_position_alone(pulled):
    assert [name for name in pulled.outputs if name.startswith("probe.tip")] == [f"probe.tip.{c}" for c in "xyz"]
