"""A block spins to rest on its four corners, goes round with a turntable, slides off a table that tilts, and is thrown up and down."""

import numpy as np
import pytest

from rigid import G, slide_on_table, spin_down
from textbook import Case, Motion, block, called, require_right

QUARTER = ((0.2, 0.2, 0.1), (2, 2, 2))
"""m; of a lattice with four points below, each of which carries a quarter of the weight while it spins"""


def spinning(on, stiffness, step, *, spin=8.0, table=0.0, friction=0.3, stop=0.4, **keys):
    """About its upright axis over the origin, on a table that turns too: friction has the arm of a corner."""
    size, _ = QUARTER
    name = f"spin-{on}-k{stiffness:.0e}-H{step:g}-{spin:g}-{table:g}"
    below = {"friction": friction, "angular_velocity": [0.0, 0.0, table]}
    scene = block(QUARTER, stiffness=stiffness, step=step, on=on, below=below, angular_velocity=[0.0, 0.0, spin], stop_time=stop, **keys)

    def motion(t, b):
        turn = spin_down(t, spin=spin, table=table, grip=friction * G * np.hypot(*size[:2]) / 2 / b.inertia(2))
        return Motion(np.where([1, 1, 0], b.centre, np.nan) + 0 * t[:, None], turn[:, None] * [0.0, 0.0, 1.0])

    return Case(called(name, keys), scene, motion)


def carried(on, stiffness, step, *, table=1.5, away=0.5, friction=0.4, stop=0.8, **keys):
    """Round with a turntable on which it sticks."""
    name = f"round-{on}-k{stiffness:.0e}-H{step:g}"
    scene = block(
        QUARTER, stiffness=stiffness, step=step, on=on, below={"friction": friction, "angular_velocity": [0.0, 0.0, table]},
        offset=[away, 0.0, 0.0], velocity=[0.0, table * away, 0.0], angular_velocity=[0.0, 0.0, table], stop_time=stop, **keys,
    )  # fmt: skip

    def motion(t, b):
        centre = np.stack([away * np.cos(table * t), away * np.sin(table * t), np.full(len(t), np.nan)], axis=1)
        return Motion(centre, (table * t)[:, None] * [0.0, 0.0, 1.0])

    return Case(called(name, keys), scene, motion)


def tipped(on, stiffness, step, *, tilt=0.5, away=0.25, friction=0.3, stop=0.9, **keys):
    """On a table that tilts about a level axis, until it slides down."""
    below = 0.5 if on in ("box", "disk") else 0.0  # their axis is below the upper face
    size, _ = QUARTER
    height = below + size[2] / 2
    scene = block(
        QUARTER, stiffness=stiffness, step=step, on=on, below={"friction": friction, "angular_velocity": [0.0, tilt, 0.0]},
        offset=[away, 0.0, 0.0], velocity=[tilt * height, 0.0, -tilt * away], angular_velocity=[0.0, tilt, 0.0], stop_time=stop, **keys,
    )  # fmt: skip

    def motion(t, b):
        along = slide_on_table(t, spin=tilt, radius=away, height=height, friction=friction)
        sine, cosine = np.sin(tilt * t), np.cos(tilt * t)
        place = [along * cosine + height * sine, 0 * t, height * cosine - along * sine - below]
        return Motion(np.stack(place, axis=1), (tilt * t)[:, None] * [0.0, 1.0, 0.0])

    return Case(called(f"tipped-{on}-k{stiffness:.0e}-H{step:g}", keys), scene, motion)


def thrown(on, stiffness, step, *, speed=3.0, spin=0.0, stop=0.6, **keys):
    """Up from a place above the ground, and down again before it lands; with a spin about an axis of inertia."""
    name = f"thrown-{on}-k{stiffness:.0e}-H{step:g}-{spin:g}"
    scene = block(
        QUARTER, stiffness=stiffness, step=step, on=on, below={"friction": 0.3}, offset=[0.0, 0.0, 0.3], velocity=[0.4, 0.0, speed],
        angular_velocity=[0.0, 0.0, spin], stop_time=stop, **keys,
    )  # fmt: skip

    def motion(t, b):
        centre = b.centre + [0.0, 0.0, 0.3] + t[:, None] * [0.4, 0.0, speed] - t[:, None] ** 2 * [0.0, 0.0, G / 2]
        return Motion(centre, (spin * t)[:, None] * [0.0, 0.0, 1.0])

    return Case(called(name, keys), scene, motion)


CASES = [
    *(spinning("plane", k, H) for k in (1e5, 1e7, 1e9) for H in (0.002, 0.02, 0.1)),
    *(spinning(on, 1e6, 0.05) for on in ("surface", "box", "disk")),
    *(spinning(on, 1e6, 0.05, spin=-3.0, table=4.0) for on in ("plane", "surface", "disk")),
    *(spinning(on, 1e5, 0.05, internal_damping=1e-4) for on in ("plane", "box")),
    *(carried(on, k, 0.05) for on in ("plane", "surface", "disk") for k in (1e5, 1e7)),
    *(carried("plane", 1e9, H) for H in (0.01, 0.1)),
    *(tipped(on, 1e7, H, internal_damping=1e-3) for on in ("plane", "surface", "box") for H in (0.01, 0.1)),
    *(tipped("plane", k, 0.05, internal_damping=1e-4) for k in (1e6, 1e8)),
    *(thrown(on, k, H) for on in ("plane", "surface") for k in (1e4, 1e6, 1e9) for H in (0.01, 0.2)),
    *(thrown("box", 1e5, 0.1, spin=s) for s in (0.0, 2.0)),
    *(thrown("plane", k, 0.1, spin=2.0) for k in (1e6, 1e9)),
]


@pytest.mark.short("spin-plane-k1e+09-H0.1*", "round-plane-k1e+09-H0.1", "tipped-*-H0.1-damped", "thrown-plane-k1e+09-H0.2*")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_block_turns_and_flies_as_a_rigid_one(case, tmp_path):
    require_right(case, tmp_path)
