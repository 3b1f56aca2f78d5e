"""Contact converges with second order, impacts, friction and dashpots included: the error against a run with a small step, by the step."""

import numpy as np
import pytest

from readings import assert_nothing_is_behind, orders, points
from scenes import GRAVITY, box
from softffd import simulate
from softffd.rotation import turned
from validation import shapes as bodies

GROUND = {"name": "ground", "friction": 0.4}
TILTED = np.array([np.sin(np.radians(20)), 0.5 * np.sin(np.radians(20)), np.cos(np.radians(20))])
TILTED /= np.linalg.norm(TILTED)


@pytest.mark.short("4e-06-flat")
@pytest.mark.parametrize("normal", [np.array([0.0, 0.0, 1.0]), TILTED], ids=["flat", "askew"])
@pytest.mark.parametrize("true", [4e-6, 2e-6])
def test_a_dropped_sliding_box(normal, true):
    """Of control points, at all communication points."""
    dropped = box(
        stiffness=2e3, damping=0.1, gravity=(-9.81 * normal).tolist(), plane=[GROUND | {"normal": normal.tolist()}], method="leapfrog",
        offset=[0.0, 0.0, 0.2], velocity=[1.0, 0.0, 0.0], stop_time=2.0, communication_step=0.1,
    )  # fmt: skip
    exact = points(simulate(dropped, start_values={"solver.step": true}))
    runs = [simulate(dropped, start_values={"solver.step": h}) for h in (1e-4, 5e-5, 2.5e-5)]
    for run in runs:
        assert_nothing_is_behind(run)
    errors = [np.linalg.norm(points(run) - exact, axis=2).max() for run in runs]
    assert orders(errors).mean() > 1.8  # over both halvings; a rule of first order has 1
    assert orders(errors).min() > 1.6  # single halvings scatter with the times of the impacts
    assert errors[0] < 1e-4


def thrown(body):
    """A sphere, low above the ground."""
    shape, axis = bodies.sphere(3), np.array([1.0, 0.3, 0.0]) / np.hypot(1.0, 0.3)
    low = (0.5 + turned(shape[0] - 0.5, 0.5 * axis))[:, 2].min()
    return body(
        shape, gravity=GRAVITY, damping=0.1, plane=[GROUND], rotation={"axis": axis.tolist(), "degrees": float(np.degrees(0.5))},
        offset=[0.0, 0.0, 0.1 - low], velocity=[1.0, 0.0, 0.0], stop_time=0.2,
    )  # fmt: skip


def damped(rubber, shape, of, offset, friction):
    """Dashpots feel a landing from its own moment on, not from the end of its step: that would be of first order."""
    return rubber(
        shape, contact={"of": of}, plane=[GROUND | {"friction": friction}], rotation={"axis": [1.0, 0.3, 0.0], "degrees": 28.0},
        offset=[0.0, 0.0, offset], velocity=[1.0, 0.0, 0.0], material={"youngs_modulus": 4e2, "internal_damping": 5e-4}, stop_time=0.2,
    )  # fmt: skip


def sliding(body, kind, friction):
    """A cube on four of its corners, on top of a solid."""
    ball = {"name": "under", "radius": 2.0, "point": [0.5, 0.5, -np.sqrt(4 - 0.5)]}
    log = ball | {"length": 10.0, "normal": [0.0, 1.0, 0.0], "point": [0.5, 0.5, -np.sqrt(4 - 0.25)]}
    tilt, up = {"axis": [0, 1, 0], "degrees": 10.0}, np.array([np.sin(np.radians(10)), 0.0, np.cos(np.radians(10))])
    slope = {"name": "under", "size": [10.0, 10.0, 1.0], "rotation": tilt, "point": (np.full(3, 0.5) - up).tolist()}
    solid = {"sphere": ball, "cylinder": log, "box": slope}[kind] | {"friction": friction}
    start = {"rotation": tilt} if kind == "box" else {}
    keys = {"gravity": GRAVITY, "velocity": [0.5, 0.2, 0.0], "damping": 0.5, "stop_time": 0.2, **start}
    return body(bodies.cube(2, 0.0), **{kind: [solid]}, **keys)


LANDING, SLIDING = ((1.6e-4, 8e-5, 4e-5, 2e-5), (4e-6, 2e-6)), ((4e-4, 2e-4), (2e-5, 5e-6))
CASES = {
    "a thrown sphere": (lambda body, _: thrown(body), (1e-4, 5e-5, 2e-5), (4e-6, 1e-6), 1.8, 4.5e-6),
    "damped, of the surface": (lambda _, rubber: damped(rubber, bodies.sphere(3), "surface", 0.0, 0.0), *LANDING, 1.8, 2e-6),
    "damped, of control points": (lambda _, rubber: damped(rubber, bodies.cube(2, 0.0), "lattice", 0.35, 0.4), *LANDING, 1.8, 1e-7),
} | {
    f"sliding on a {kind}, {word}": (lambda body, _, kind=kind, f=f: sliding(body, kind, f), *SLIDING, np.log2(ratio), 5e-6)
    for kind in ("sphere", "cylinder", "box")
    for word, f, ratio in (("smooth", 0.0, 3.5), ("rough", 0.3, 1.8))
}
"""Name: the scene, the steps whose ends are compared and the true steps, coarse and fine [s], the least order, the largest error [m].
In lasting contact friction leaves first order."""


@pytest.mark.short("coarse-*")
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("true", [0, 1], ids=["coarse", "fine"])
def test_the_order_of(body, rubber, case, true):
    make, steps, smallest, order, most = CASES[case]
    scene = make(body, rubber)
    exact, *ends = (points(simulate(scene.replace({"solver.step": h})))[-1] for h in (smallest[true], *steps))
    errors = [np.abs(end - exact).max() for end in ends]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] > order
    assert errors[0] < most
    if case == "a thrown sphere":
        assert errors[0] > 3.3 * errors[1]
        assert [errors[0], errors[2]] == pytest.approx([3.0e-6, 1.3e-7], rel=0.5)
