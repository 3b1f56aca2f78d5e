"""A body in contact goes on from a saved state with the same bits, in another instance, which has its outputs at once."""

import pytest

from scenes import GRAVITY
from solids import solid
from stepping import require_same_continuation
from validation import shapes as bodies

GROUND = {"name": "ground", "friction": 0.4}
FALLING = {"gravity": GRAVITY, "damping": 0.1, "offset": [0.0, 0.0, -0.05], "angular_velocity": [2.0, 1.0, 0.0], "step": 0.0}
SLIDING = {"gravity": GRAVITY, "damping": 1.0, "velocity": [0.5, 0.0, 0.0], "method": "auto", "step": 0.0, "plane": [GROUND]}
BALL = {"name": "under", "radius": 1.0, "point": [0.5, 0.5, -1.0]}
CRATE = {"name": "under", "size": [0.5, 0.4, 0.2], "point": [0.6, 0.5, -0.05]}


def rubber_cube(velocity):
    """Of 1 MPa, a cube of 0.1 m, damped so that implicit steps take it."""
    rubber = {"modulus": 1e6, "ratio": 0.45, "density": 1e3, "internal_damping": 1e-3}
    box = {"size": [0.1] * 3, "origin": [0.0] * 3, "plane": [GROUND], "gravity": GRAVITY, "velocity": velocity}
    return solid(4, **rubber, **box, communication_step=5e-3, outputs={"solver": True})


CASES = {
    "surface": lambda body, _: body(bodies.sphere(2), plane=[GROUND], **FALLING),
    "surface, with an error estimate": lambda body, _: body(bodies.sphere(2), plane=[GROUND], error_estimate=True, **FALLING),
    "damped": lambda _, rubber: rubber(bodies.sphere(2), plane=[GROUND], **FALLING),
    "on a sphere": lambda body, _: body(bodies.sphere(2), gravity=GRAVITY, sphere=[BALL]),
    "on a box": lambda body, _: body(bodies.sphere(2), gravity=GRAVITY, box=[CRATE]),
    "sliding, by auto": lambda body, _: body(bodies.cube(4, 0.0), **SLIDING),
    "of a solid that rests, with the matrix of the steps before": lambda *_: rubber_cube([0.0, 0.0, 0.0]),
    "of a solid that slides, the same": lambda *_: rubber_cube([0.2, 0.0, 0.0]),
    "of control points, by auto": lambda body, _: body(bodies.cube(4, 0.0), contact={"of": "lattice"}, **SLIDING),
}


@pytest.mark.parametrize("case", CASES)
def test_a_state_continues_with_the_same_bits(body, rubber, case):
    require_same_continuation(CASES[case](body, rubber))
