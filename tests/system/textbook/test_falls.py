"""A block over its edge: past its balance it falls as a rigid one does about the edge; before it, it stands."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rigid import EXACT, G, fall_over
from textbook import BRICK, SMALL, TOWER, Case, Motion, along, block, called, require_right

BODIES = {"tower": TOWER, "brick": BRICK}


def balance(size):
    """The lean of the diagonal: where the centre of mass is above the lower edge [rad]."""
    return float(np.arctan2(size[0], size[2]))


def about_the_edge(leans, upright, body, edge, arm):
    """The motion of the block about an edge along y, of its centre's leans (T,) [rad]: `edge` is where it holds, (3,) [m], `upright` the
    lean of the block that is not turned."""
    place = edge + arm * np.stack([np.sin(leans), 0 * leans, np.cos(leans)], axis=1)
    place[:, 1] = body.centre[1]
    return Motion(place, (leans - upright)[:, None] * [0.0, 1.0, 0.0])


def leant(body, on, stiffness, step, past, *, stop, **keys):
    """On its edge, some degrees past its balance."""
    size, _ = BODIES[body]
    name = f"{body}-{on}-k{stiffness:.0e}-H{step:g}-past{past:g}"
    a, arm = balance(size) + np.radians(past), np.hypot(size[0], size[2]) / 2
    up = arm * np.cos(np.radians(past)) - size[2] / 2
    scene = block(
        BODIES[body], stiffness=stiffness, step=step, on=on, below={"friction": 1.5}, offset=[0.0, 0.0, float(up)], stop_time=stop,
        rotation={"axis": [0.0, 1.0, 0.0], "degrees": float(np.degrees(a))}, **keys,
    )  # fmt: skip
    edge = np.array([-arm * np.sin(np.radians(past)), 0.0, 0.0])

    def motion(times, b):
        leans = fall_over(times, lean=np.radians(past), arm=arm, inertia=b.inertia(1) + arm**2)
        return about_the_edge(leans, np.radians(past) - a, b, edge, arm)

    return Case(called(name, keys), scene, motion)


def shoved(body, on, stiffness, step, growth, *, limit=1e9, stop, kilograms=1.0, **keys):
    """Standing, pushed at its upper face along x by so many N/s a kilogram, up to a share `limit` of what its weight can hold."""
    size, _ = BODIES[body]
    name = f"{body}-{on}-k{stiffness:.0e}-H{step:g}-" + ("stands" if limit < 1 else "shoved")
    holds = G * size[0] / 2 / size[2]
    push = lambda t: min(growth * t, limit * holds)  # noqa: E731
    scene = block(
        BODIES[body], stiffness=stiffness, step=step, on=on, below={"friction": 1.5}, stop_time=stop, kilograms=kilograms,
        load=[{"name": "push", "points": "z+"}], **keys,
    )  # fmt: skip

    def motion(times, b):
        if limit < 1:
            return along(0 * times, b)
        edge, arm, begin = np.array([size[0] / 2, 0.0, 0.0]), np.hypot(size[0], size[2]) / 2, holds / growth
        lever, upper = np.hypot(size[0] / 2, size[2]), np.arctan2(-size[0] / 2, size[2])
        lower = b.inertia(1) + arm**2

        def rate(t, y):
            return [y[1], (G * arm * np.sin(y[0]) + growth * t * lever * np.cos(y[0] + balance(size) + upper)) / lower]

        leans = np.full(len(times), -balance(size))
        later = times > begin
        fall = solve_ivp(rate, (begin, times[-1]), [-balance(size), 0.0], t_eval=times[later], **EXACT)
        leans[later] = fall.y[0]
        return about_the_edge(leans, -balance(size), b, edge, arm)

    return Case(called(name, keys), scene, motion, inputs=lambda t: {"load.push.x": kilograms * push(t)})


def overhanging(on, stiffness, step, *, degrees=5.0, stop=0.25, **keys):
    """Over the edge of a table, or a log, of which it touches one row of vertices, a third of its length from one end."""
    size, _ = SMALL
    name = f"over-{on}-k{stiffness:.0e}-H{step:g}"
    a, pivot = np.radians(degrees), np.array([-size[0] / 6, 0.0, -size[2] / 2])
    turn = np.array([[np.cos(a), 0.0, np.sin(a)], [0.0, 1.0, 0.0], [-np.sin(a), 0.0, np.cos(a)]])
    lean, arm = a + np.arctan2(size[0] / 6, size[2] / 2), np.hypot(pivot[0], pivot[2])
    centre = -turn @ pivot
    scene = block(
        SMALL, stiffness=stiffness, step=step, on="surface", count=4, stop_time=stop,
        rotation={"axis": [0.0, 1.0, 0.0], "degrees": degrees},
        offset=(centre - [0.0, 0.0, size[2] / 2]).tolist(), **keys,
    )  # fmt: skip
    log = {"radius": 0.02, "length": 1.0, "normal": [0.0, 1.0, 0.0], "point": [0.0, 0.0, -0.02]}
    table = {"size": [1.01, 1.0, 0.5], "point": [-0.495, 0.0, -0.25]}
    scene |= {
        "plane": [],
        "box" if on == "table" else "cylinder": [{"name": "under", "friction": 1.5, **(table if on == "table" else log)}],
    }

    def motion(times, b):
        leans = fall_over(times, lean=lean, arm=arm, inertia=b.inertia(1) + arm**2)
        return about_the_edge(leans, lean - a, b, np.zeros(3), arm)

    return Case(called(name, keys), scene, motion)


CASES = [
    leant("tower", "plane", 1e8, 0.05, 1.0, stop=0.9),
    *(leant("tower", "plane", k, H, 1.0, stop=0.8) for k in (1e7, 1e9) for H in (0.01, 0.05, 0.2)),
    *(leant("tower", "plane", k, H, 5.0, stop=0.5) for k in (1e6, 1e8) for H in (0.001, 0.02, 0.1)),
    *(leant("brick", on, k, H, 5.0, stop=0.4) for on in ("surface", "box", "disk") for k in (1e6, 1e8) for H in (0.02, 0.1)),
    *(shoved("tower", "plane", k, H, 4.0, stop=1.0) for k in (1e7, 1e9) for H in (0.02, 0.1)),
    *(shoved("tower", "plane", k, H, 4.0, limit=0.95, stop=1.0) for k in (1e6, 1e9) for H in (0.02, 0.1)),
    *(shoved("tower", on, 1e7, 0.05, 6.0, stop=0.6) for on in ("surface", "box", "disk")),
    *(shoved("tower", on, 1e7, 0.05, 6.0, limit=0.95, stop=0.5) for on in ("surface", "box", "disk")),
    *(overhanging(on, k, H) for on in ("table", "log") for k in (1e6, 1e8) for H in (0.01, 0.05)),
    *(overhanging(on, 1e6, 0.05, internal_damping=1e-4) for on in ("table", "log")),
    *(leant("tower", on, 1e6, 0.05, 5.0, stop=0.4, internal_damping=1e-4) for on in ("plane", "box")),
    *(shoved("tower", "plane", 1e6, 0.05, 6.0, limit=limit, stop=0.6, internal_damping=1e-4) for limit in (0.95, 1e9)),
]


@pytest.mark.short("tower-plane-k1e+08-H0.05-past1")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_block_stands_or_falls_over_its_edge_as_a_rigid_one(case, tmp_path):
    require_right(case, tmp_path)
