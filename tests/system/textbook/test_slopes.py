"""A block on a slope: thrown up it slides to a stop, stays or slides down again; let go it stays below the angle of friction."""

import numpy as np
import pytest

from rigid import G, slide
from textbook import BRICK, CUBE, SMALL, Case, along, block, called, tilted

SOLIDS = ("surface", "box", "disk", "rails")
BODIES = {"cube": CUBE, "brick": BRICK, "small": SMALL}


def thrown(body, on, stiffness, step, *, degrees=30.0, friction=0.25, speed=-1.0, stop=1.0, **keys):
    """Along the line of the slope's fall; a negative speed is upwards."""
    name = f"{body}-{on}-k{stiffness:.0e}-H{step:g}-{degrees:g}deg-mu{friction:g}-v{speed:g}" + (
        "-damped" if "internal_damping" in keys else ""
    )
    scene = block(
        BODIES[body], stiffness=stiffness, step=step, on=on, below={"friction": friction}, velocity=[speed, 0.0, 0.0],
        gravity=tilted(degrees), stop_time=stop, **keys,
    )  # fmt: skip
    a = np.radians(degrees)
    return Case(called(name, keys), scene, lambda t, b: along(slide(t, speed=speed, grip=friction * G * np.cos(a), push=G * np.sin(a)), b))


CASES = [
    *(thrown("brick", "plane", 1e8, H) for H in (0.1, 0.02, 0.001)),
    *(thrown("brick", "plane", k, H) for k in (1e7, 1e9) for H in (0.01, 0.05, 0.2)),
    *(thrown("brick", "plane", k, H, kilograms=k / 1e7) for k in (1e4, 1e6) for H in (0.002, 0.1)),
    *(thrown("small", on, 1e5, H, degrees=20.0, stop=0.6, kilograms=2e-3) for on in SOLIDS for H in (0.02, 0.1)),
    *(thrown("small", on, 1e8, H, degrees=20.0, stop=0.6) for on in ("surface", "rails") for H in (0.02, 0.1)),
    *(thrown("cube", "plane", k, H, degrees=20.0, friction=0.45, speed=-2.0) for k in (1e5, 1e9) for H in (0.01, 0.2)),
    *(thrown("small", "plane", 1e8, 0.1, degrees=d, friction=0.4, speed=0.0) for d in (21.5, 22.2)),
    *(thrown("small", "disk", 1e6, 0.05, degrees=d, friction=0.4, speed=0.0, stop=0.5, internal_damping=1e-4) for d in (21.0, 23.0)),
    *(thrown("small", on, 1e5, 0.02, degrees=25.0, stop=0.5, kilograms=0.05, internal_damping=1e-3) for on in ("plane", "surface", "box")),
]


@pytest.mark.short("brick-plane-k1e+08-H0.1*", "brick-plane-k1e+08-H0.02*", "small-plane-k1e+08-H0.1-22.2deg*")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_block_on_a_slope_goes_up_and_down_as_a_rigid_one(case, holds):
    holds(case)
