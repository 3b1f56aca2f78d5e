"""Contact with obstacle planes: no penetration, exact balance of momentum, planes that move, several planes at once."""

import numpy as np
import pytest
from readings import assert_nothing_is_behind, gaps, plane_poses, points, rotation, vector, velocities
from stepping import Stepper

from softffd import FmuError, simulate

BOUNCING = """
[material]
stiffness = 2e3
damping = DAMPING
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
friction = 0.4
[initial]
offset = [0.0, 0.0, 0.1]
velocity = [1.0, 0.5, 0.0]
angular_velocity = [1.0, 2.0, 0.5]
[outputs]
velocities = "all"
[solver]
method = "METHOD"
STEP
[experiment]
stop_time = 1.0
communication_step = 0.01
"""

LIFTED = """
[material]
stiffness = 2e3
damping = 0.05
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "lift"
point = [0.0, 0.0, -0.05]
friction = 0.5
MOTION
[outputs]
velocities = "all"
[solver]
method = "leapfrog"
step = 5e-4
[experiment]
stop_time = 0.5
communication_step = 5e-4
"""

CORNER = """
[material]
stiffness = 2e3
damping = DAMPING
[environment]
gravity = [-3.0, -4.0, -9.81]
[[plane]]
name = "left"
normal = [1.0, 0.0, 0.0]
friction = FRICTION
[[plane]]
name = "back"
normal = [0.0, 1.0, 0.0]
friction = FRICTION
[[plane]]
name = "ground"
normal = [0.0, 0.0, 1.0]
friction = FRICTION
[initial]
offset = [0.05, 0.03, 0.1]
[outputs]
velocities = "all"
[solver]
method = "leapfrog"
step = 5e-4
[experiment]
stop_time = 3.0
communication_step = 5e-4
"""

SQUEEZED = """
[material]
stiffness = 1e3
damping = 0.1
[[plane]]
name = "table"
[[plane]]
name = "press"
point = [0.0, 0.0, 1.0]
normal = [0.0, 0.0, -1.0]
velocity = [0.0, 0.0, -0.5]
[[plane]]
name = "side"
point = [-0.05, 0.0, 0.0]
normal = [1.0, 0.0, 0.1]
[solver]
method = "leapfrog"
[experiment]
stop_time = 1.6
communication_step = 0.01
"""


def bouncing(scene, *, damping=0.0, method="leapfrog", step=None, **arguments):
    text = BOUNCING.replace("DAMPING", str(damping)).replace("METHOD", method)
    result = simulate(scene(text.replace("STEP", f"step = {step}" if step else "")), **arguments)
    assert_nothing_is_behind(result)
    return result


def cornered(scene, *, friction, damping=3.0, **arguments):
    text = CORNER.replace("FRICTION", str(friction)).replace("DAMPING", str(damping))
    result = simulate(scene(text), **arguments)
    assert_nothing_is_behind(result)
    return result


def reactions(result):
    return sum(vector(result, f"plane.{name}.reaction") for name in result.plane_names())


@pytest.mark.parametrize("method", ["leapfrog", "auto"])
def test_no_point_is_behind_the_ground_at_any_internal_step(scene, method):
    result = bouncing(scene, method=method, step=5e-4, **{"step": 5e-4})
    assert gaps(result, "ground").min() >= -1e-15
    assert (gaps(result, "ground") == 0).sum() > 1000  # and they did touch
