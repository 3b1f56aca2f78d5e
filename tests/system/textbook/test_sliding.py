"""A block that was thrown along the ground slides to rest after v^2 / (2 mu g), whatever it is pressed on."""

import pytest

from rigid import G, slide
from textbook import BRICK, CUBE, SMALL, Case, along, block, called

SOLIDS = ("surface", "box", "disk", "rails")
BODIES = {"cube": CUBE, "brick": BRICK, "small": SMALL}


def sliding(body, on, stiffness, step, *, friction=0.3, speed=1.0, stop=0.6, **keys):
    name = f"{body}-{on}-k{stiffness:.0e}-H{step:g}-mu{friction:g}-v{speed:g}"
    scene = block(
        BODIES[body],
        stiffness=stiffness,
        step=step,
        on=on,
        below={"friction": friction},
        velocity=[speed, 0.0, 0.0],
        stop_time=stop,
        **keys,
    )
    return Case(called(name, keys), scene, lambda t, b: along(slide(t, speed=speed, grip=friction * G), b))


CASES = [
    sliding("cube", "plane", 1e8, 0.1, stop=1.0),
    sliding("cube", "plane", 1e8, 0.2, stop=1.0),
    *(sliding("cube", "plane", k, H, stop=1.0) for k in (1e4, 1e5, 1e6, 1e7, 1e9) for H in (0.01, 0.1, 0.2)),
    *(sliding("brick", "plane", k, H, friction=0.5, speed=2.0) for k in (1e7, 1e9) for H in (0.001, 0.02, 0.05, 0.2)),
    *(sliding("brick", "plane", 1e6, H, friction=0.5, speed=2.0, kilograms=0.1) for H in (0.001, 0.02, 0.05, 0.2)),
    *(sliding("brick", "plane", 1e4, H, kilograms=0.05) for H in (0.005, 0.1)),
    *(sliding("small", on, k, H, friction=0.25, kilograms=k / 5e6) for on in SOLIDS for k in (1e4, 1e6) for H in (0.02, 0.2)),
    *(sliding("small", on, k, 0.1, friction=0.4, stop=0.4) for on in SOLIDS for k in (1e7, 1e8)),
    *(sliding("small", on, 1e5, H, internal_damping=1e-3) for on in ("plane", "surface", "disk") for H in (0.005, 0.05)),
    sliding("brick", "plane", 1e6, 0.1, internal_damping=1e-4),
]


@pytest.mark.short("cube-plane-k1e+08*", "brick-plane-k1e+09-H0.05*")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_thrown_block_slides_to_rest(case, holds):
    holds(case)
