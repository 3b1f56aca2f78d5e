"""A block at rest that is pushed: it breaks loose where the push passes mu m g, stops and turns round with the push."""

import numpy as np
import pytest

from rigid import G, slide
from textbook import BRICK, CUBE, SMALL, Case, along, block, called

BODIES = {"cube": CUBE, "brick": BRICK, "small": SMALL}
PUSHES = {
    "growing": lambda t: 12.0 * t,
    "fading": lambda t: 9.0 - 12.0 * t,
    "to and fro": lambda t: 8.0 * np.sin(2 * np.pi * t / 0.8),
}
"""N a kilogram"""


def linear(push, step):
    """What an input that is linear between communication points makes of it."""

    def between(t):
        n = np.floor(t / step + 1e-9)
        part = t / step - n
        return (1 - part) * push(n * step) + part * push((n + 1) * step)

    return between


def pushed(body, on, stiffness, step, push, *, friction=0.4, stop=0.6, kilograms=1.0, **keys):
    name = f"{body}-{on}-k{stiffness:.0e}-H{step:g}-{push}"
    scene = block(
        BODIES[body], stiffness=stiffness, step=step, on=on, below={"friction": friction}, load=[{"name": "push", "points": "all"}],
        stop_time=stop, kilograms=kilograms, **keys,
    )  # fmt: skip
    force = PUSHES[push]
    motion = lambda t, b: along(slide(t, grip=friction * G, push=linear(force, step)), b)  # noqa: E731
    return Case(called(name, keys), scene, motion, inputs=lambda t: {"load.push.x": kilograms * force(t)})


CASES = [
    pushed("cube", "plane", 1e6, 0.1, "growing"),
    *(pushed("cube", "plane", k, H, "growing") for k in (1e5, 1e7, 1e9) for H in (0.02, 0.1, 0.2)),
    *(pushed("cube", "plane", 1e4, H, "growing", kilograms=0.1) for H in (0.005, 0.2)),
    *(pushed("small", on, 1e6, 0.05, "growing", internal_damping=1e-4) for on in ("surface", "box", "disk", "rails")),
    *(pushed("small", on, 1e5, 0.1, "growing", kilograms=0.02, internal_damping=5e-5) for on in ("surface", "box", "disk", "rails")),
    *(pushed("brick", "plane", k, H, "fading", stop=0.8) for k in (1e6, 1e8) for H in (0.01, 0.1)),
    *(pushed("brick", "plane", 1e9, H, "to and fro", stop=1.2) for H in (0.005, 0.02, 0.1)),
    *(pushed("brick", "plane", 1e7, H, "to and fro", stop=0.8, internal_damping=1e-5) for H in (0.02, 0.1)),
    *(pushed("small", on, 1e6, 0.05, "to and fro", stop=0.8, kilograms=0.1, internal_damping=1e-4) for on in ("plane", "disk")),
    *(pushed("small", on, 1e5, 0.05, "growing", stop=0.5, kilograms=0.2, internal_damping=1e-3) for on in ("plane", "box")),
]


@pytest.mark.short("cube-plane-k1e+06-H0.1-growing", "brick-plane-k1e+09-H0.1-to and fro")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_block_breaks_loose_and_goes_with_what_the_push_has_left(case, holds):
    holds(case)
