"""Scenes that twin and component are compared on, and the courses of their inputs."""

import numpy as np

FREE = """
[lattice]
points = [5, 3, 4]
size = [1.0, 0.5, 0.8]
springs = "paper"
[material]
stiffness = { edge = 1e3, face = 500.0, body = 200.0 }
damping = DAMPING
[initial]
stretch = [1.1, 0.9, 1.0]
angular_velocity = [1.0, 2.0, 0.5]
[outputs]
velocities = "all"
[solver]
method = "METHOD"
step = 5e-4
[experiment]
stop_time = 0.5
"""

STIFF = """
[material]
stiffness = 1e7
damping = 0.5
[environment]
gravity = [0.0, 0.0, -9.81]
[inputs]
forces = "all"
[solver]
step = 1e-5
[experiment]
stop_time = 0.03
communication_step = 1e-3
"""

PATCHED = """
[[region]]
points = "z-"
stiffness = 4e3
mass = 2e-3
damping = 30.0
[[region]]
points = { i = [0, 1] }
stiffness = 2e3
[[load]]
name = "push"
points = "x+"
[[probe]]
name = "nose"
at = [0.3, 0.5, 0.9]
[solver]
step = 2.5e-4
[experiment]
stop_time = 0.3
"""

FINE = """
[lattice]
points = [7, 5, 4]
basis = "bspline"
"""

DROP = """
[material]
stiffness = 2e3
damping = 0.1
[environment]
gravity = [0.0, 0.0, -9.81]
[initial]
offset = [0.0, 0.0, 0.2]
velocity = [1.0, 0.0, 0.0]
angular_velocity = [0.5, 1.0, 0.0]
[[plane]]
name = "ground"
friction = 0.4
[solver]
method = "METHOD"
step = 1e-3
[experiment]
stop_time = 1.0
"""

INCLINE = """
[material]
stiffness = 1e4
damping = 0.0
[environment]
gravity = [4.1458852, 0.0, -8.8908794]
[[plane]]
name = "ground"
friction = 0.3
[solver]
step = 5e-4
[experiment]
stop_time = 0.6
"""

CONVEYOR = """
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
friction = 0.5
velocity = [0.5, 0.2, 0.0]
angular_velocity = [0.0, 0.0, 0.3]
[solver]
step = 1e-3
[experiment]
stop_time = 0.8
"""

CRADLE = """
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
point = [0.3, 0.4, 0.0]
motion = "input"
[solver]
step = 1e-3
[experiment]
stop_time = 0.8
"""

PRESS = """
[material]
damping = 0.1
[environment]
gravity = [0.0, 0.0, -9.81]
[[plane]]
name = "ground"
[[plane]]
name = "press"
point = [0.3, 0.4, 1.05]
normal = [0.0, 0.0, -1.0]
motion = "input"
[solver]
step = 1e-3
[experiment]
stop_time = 1.2
"""

TUMBLE = """
[material]
stiffness = 2e3
damping = 0.0
[environment]
gravity = [0.0, 0.0, -9.81]
[initial]
offset = [OFFSET, 0.0, 0.2]
velocity = [1.0, 0.3, 0.0]
angular_velocity = [6.0, 4.0, 5.0]
[[plane]]
name = "ground"
[solver]
step = 1e-3
[experiment]
stop_time = 2.6
"""


HELD = """
[material]
stiffness = 2e3
damping = 0.05
[environment]
gravity = [0.0, 0.0, -9.81]
[[pin]]
name = "base"
points = "x-"
[[pin]]
name = "grip"
points = { i = [3, 3], j = [0, 1] }
motion = "input"
[solver]
method = "METHOD"
step = 5e-4
[experiment]
stop_time = 0.5
"""

HELD_IN_CONTACT = """
[material]
stiffness = 2e3
damping = 0.1
[environment]
gravity = [0.0, 0.0, -9.81]
[initial]
offset = [0.0, 0.0, 0.05]
[[plane]]
name = "ground"
friction = 0.4
[[pin]]
name = "grip"
points = "z+"
motion = "input"
[solver]
method = "METHOD"
step = 1e-3
[experiment]
stop_time = 0.8
"""


def pull(time):
    sides = ((0, -1e4), (3, 1e4))
    return {f"force[{i},{j},{k}].x": f * (1 + j / 3) * time / 0.03 for i, f in sides for j in range(4) for k in range(4)}


def push(time):
    return {"load.push.x": np.sin(9 * time), "load.push.z": 1.0}


def rock(time):
    tilt = 0.2 * np.sin(3 * time)
    pose = {
        "point.z": 0.05 * np.sin(5 * time),
        "normal.x": np.sin(tilt),
        "normal.y": 0.0,
        "normal.z": np.cos(tilt),
    }
    return {f"plane.ground.{name}": value for name, value in pose.items()}


def jump(time):
    still = {f"plane.ground.velocity.{axis}": 0.0 for axis in "xyz"}
    return {"plane.ground.point.z": 0.02 * (int(time / 0.1 + 1e-6) % 2), **still}


def crush(time):
    return {"plane.press.point.z": np.interp(time, [0.1, 0.6, 0.8, 0.9], [1.05, 0.6, 0.6, 1.3])}


def wave(time):
    """A pin that swings and turns, with velocities that make its pose jump a little at each exchange."""
    angle = 0.3 * np.sin(4 * time)
    turn = {"orientation.w": 2 * np.cos(angle / 2), "orientation.y": 2 * np.sin(angle / 2), "angular_velocity.y": 1.2 * np.cos(4 * time)}
    place = {"position.z": 0.5 + 0.1 * np.sin(6 * time), "velocity.z": 0.6 * np.cos(6 * time)}
    return {f"pin.grip.{name}": value for name, value in (turn | place).items()}


def carry(time):
    """Down onto the ground, along it and up."""
    down = {"position.z": np.interp(time, [0.0, 0.2, 0.5, 0.8], [1.05, 0.95, 0.95, 1.2]), "velocity.z": 0.0}
    along = {"position.x": 0.5 + 0.3 * time, "velocity.x": 0.3}
    return {f"pin.grip.{name}": value for name, value in (down | along).items()}


SMOOTH = {
    # velocities carry omega times the rounding of positions, 1e3/s; forces on pins the stiffness, 1e3 N/m
    "undamped": (FREE.replace("DAMPING", "0.0").replace("METHOD", "leapfrog"), None, 1e-12),
    "damped": (FREE.replace("DAMPING", "0.02").replace("METHOD", "leapfrog"), None, 1e-12),
    # a recurrence in positions divides their rounding by h and sums it up: 1e-16 m / 5e-4 s over 0.5 s
    "published": (FREE.replace("DAMPING", "0.02").replace("METHOD", "central_difference"), None, 1e-11),
    "stiff, under held forces": (STIFF, pull, 1e-12),
    "regions, a load, strong damping": (PATCHED, push, 1e-12),
    "a probe in B-splines": (PATCHED.replace("damping = 30.0", "damping = 3.0") + FINE, push, 1e-12),
    "pins, one moving": (HELD.replace("METHOD", "leapfrog"), wave, 1e-12),
    "pins, published": (HELD.replace("METHOD", "central_difference"), wave, 1e-11),
}
"""Name: text, inputs, how far positions may part [m]."""

CONTACT = {
    "drop with friction": (DROP.replace("METHOD", "leapfrog"), None),
    "drop by the published rule": (DROP.replace("METHOD", "central_difference"), None),
    "incline": (INCLINE, None),
    "conveyor that turns": (CONVEYOR, None),
    "plane that rocks and heaves": (CRADLE, rock),
    "plane that jumps": (CRADLE, jump),
    "press": (PRESS, crush),
    "pinned and dragged": (HELD_IN_CONTACT.replace("METHOD", "leapfrog"), carry),
    "pinned and dragged, by the published rule": (HELD_IN_CONTACT.replace("METHOD", "central_difference"), carry),
}
"""Name: text, inputs."""
