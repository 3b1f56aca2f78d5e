"""A body with more drag at some points than at others: drag on its vibrations turns it and moves it as a whole."""

import numpy as np
import pytest

from readings import points
from scenes import GRAVITY, box
from softffd import simulate

TOLERANCE = 1e-4


@pytest.mark.parametrize(("drag", "stretch"), [(3.0, 0.9995), (3.0, 0.999), (10.0, 0.9995)])
def test_a_body_that_rings_beside_an_obstacle_moves_as_its_drag_lets_it(drag, stretch):
    corner = {"points": [[0, 2, 0]], "damping": drag}
    floor = {"name": "floor", "point": [0.0, 0.0, -1.2]}
    scene = box(
        points=[3, 3, 3],
        stiffness=3e5,
        damping=0.02,
        region=[corner],
        stretch=[stretch, 1.0, 1.0],
        gravity=GRAVITY,
        plane=[floor],
        outputs={"solver": True},
        tolerance=TOLERANCE,
        stop_time=0.4,
        communication_step=5e-3,
    )
    run = simulate(scene)
    step = run.outputs["solver.stable_step"].min() / 60
    exact = simulate(scene, start_values={"solver.method": "leapfrog", "solver.step": step})
    assert np.linalg.norm(points(run)[-1] - points(exact)[-1], axis=1).max() < TOLERANCE
