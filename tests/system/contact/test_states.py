"""A body in contact goes on from a saved state with the same bits, in another instance, which has its outputs at once."""

import pytest

from scenes import GRAVITY
from stepping import require_same_continuation
from validation import shapes as bodies

GROUND = {"name": "ground", "friction": 0.4}
FALLING = {"gravity": GRAVITY, "damping": 0.1, "offset": [0.0, 0.0, -0.05], "angular_velocity": [2.0, 1.0, 0.0], "step": 0.0}
SLIDING = {"gravity": GRAVITY, "damping": 1.0, "velocity": [0.5, 0.0, 0.0], "method": "auto", "step": 0.0, "plane": [GROUND]}
BALL = {"name": "under", "radius": 1.0, "point": [0.5, 0.5, -1.0]}
CRATE = {"name": "under", "size": [0.5, 0.4, 0.2], "point": [0.6, 0.5, -0.05]}
CASES = {
    "surface": lambda body, _: body(bodies.sphere(2), plane=[GROUND], **FALLING),
    "surface, with an error estimate": lambda body, _: body(bodies.sphere(2), plane=[GROUND], error_estimate=True, **FALLING),
    "damped": lambda _, rubber: rubber(bodies.sphere(2), plane=[GROUND], **FALLING),
    "on a sphere": lambda body, _: body(bodies.sphere(2), gravity=GRAVITY, sphere=[BALL]),
    "on a box": lambda body, _: body(bodies.sphere(2), gravity=GRAVITY, box=[CRATE]),
    "sliding, by auto": lambda body, _: body(bodies.cube(4, 0.0), **SLIDING),
    "of control points, by auto": lambda body, _: body(bodies.cube(4, 0.0), contact={"of": "lattice"}, **SLIDING),
}


@pytest.mark.parametrize("case", CASES)
def test_a_state_continues_with_the_same_bits(body, rubber, case):
    require_same_continuation(CASES[case](body, rubber))
