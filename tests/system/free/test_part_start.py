"""A free pin begins where the start of the object takes its points: stretched and moved along with it."""

import numpy as np
import pytest

from scenes import box
from softffd import simulate

FACE = {"name": "part", "points": "z+", "motion": "free", "mass": 2.0, "inertia": [0.1, 0.1, 0.1]}


def hanging(**initial):
    return box(
        points=[3, 3, 3], material={"stiffness": 1e4, "damping": 0.0}, mass={"total": 1.0}, gravity=[0, 0, -9.81], pin=[FACE],
        initial=initial, outputs={"energy": True, "solver": True}, stop_time=0.05, communication_step=0.01,
    )  # fmt: skip


@pytest.mark.parametrize("turn", [{}, {"rotation": {"axis": [1, 2, 0], "degrees": 35.0}}], ids=["straight", "turned"])
def test_an_object_that_is_moved_falls_undeformed_with_its_part(turn):
    offset = np.array([0.3, -0.2, 1.5])
    run, at_rest = simulate(hanging(offset=offset.tolist(), **turn)), simulate(hanging(**turn))
    for result, place in ((run, offset), (at_rest, 0 * offset)):
        assert result.outputs["energy.elastic"].max() < 1e-12
        fallen = np.array([result.outputs[f"pin.part.position.{axis}"] for axis in "xyz"]).T - place
        assert fallen[-1] - fallen[0] == pytest.approx([0, 0, -9.81 / 2 * 0.05**2], abs=1e-9)
        assert fallen[0] == pytest.approx([at_rest.outputs[f"pin.part.position.{axis}"][0] for axis in "xyz"], abs=1e-12)


def test_a_stretched_object_takes_the_part_along():
    run = simulate(hanging(stretch=[1.0, 1.0, 1.2]))
    assert run.outputs["pin.part.position.z"][0] == pytest.approx(1.2)
