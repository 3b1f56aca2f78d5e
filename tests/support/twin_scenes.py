"""Scenes that twin and component are compared on, and the courses of their inputs."""

import numpy as np

from scenes import GRAVITY, LED, MOVED, box
from softffd.rotation import turned

GRIP = {"name": "grip", **LED}
STIFFNESSES = {"edge": 1e3, "face": 500.0, "body": 200.0}


def free(*, damping=0.0, method="leapfrog", step=5e-4, stop_time=0.5):
    return box(
        lattice={"points": [5, 3, 4], "size": [1.0, 0.5, 0.8], "springs": "paper"}, stiffness=STIFFNESSES, damping=damping,
        stretch=[1.1, 0.9, 1.0], angular_velocity=[1.0, 2.0, 0.5], velocities="all", method=method, step=step, stop_time=stop_time,
    )  # fmt: skip


def stiff():
    return box(stiffness=1e7, damping=0.5, gravity=GRAVITY, forces="all", step=1e-5, stop_time=0.03, communication_step=1e-3)


def solid():
    regions = [{"points": {"k": [0, 2]}, "youngs_modulus": 4e4, "density": 500.0}]
    return box(
        lattice={"points": [4, 3, 5], "size": [0.3, 0.22, 0.36]}, material={"youngs_modulus": 1e4}, mass={"density": 1100.0},
        region=regions, gravity=GRAVITY, pin=[{"name": "base", "points": "x-"}], step=5e-4, stop_time=0.3,
    )  # fmt: skip


def patched(*, damping=30.0, **keys):
    regions = [{"points": "z-", "stiffness": 4e3, "mass": 2e-3, "damping": damping}, {"points": {"i": [0, 1]}, "stiffness": 2e3}]
    nose = {"name": "nose", "at": [0.3, 0.5, 0.9]}
    return box(region=regions, load=[{"name": "push", "points": "x+"}], probe=[nose], step=2.5e-4, stop_time=0.3, **keys)


def drop(method="auto", *, step=1e-3, stop_time=1.0):
    return box(
        stiffness=2e3, damping=0.1, gravity=GRAVITY, offset=[0.0, 0.0, 0.2], velocity=[1.0, 0.0, 0.0], angular_velocity=[0.5, 1.0, 0.0],
        plane=[{"name": "ground", "friction": 0.4}], method=method, step=step, stop_time=stop_time,
    )  # fmt: skip


def incline():
    ground = {"name": "ground", "friction": 0.3}
    return box(stiffness=1e4, damping=0.0, gravity=[4.1458852, 0.0, -8.8908794], plane=[ground], step=5e-4, stop_time=0.6)


def conveyor(*others):
    belt = {"name": "ground", "friction": 0.5, "velocity": [0.5, 0.2, 0.0], "angular_velocity": [0.0, 0.0, 0.3]}
    return box(gravity=GRAVITY, plane=[belt, *others], step=1e-3, stop_time=0.8)


def cradle():
    moved = {"name": "ground", "point": [0.3, 0.4, 0.0], **MOVED}
    return box(gravity=GRAVITY, plane=[moved], step=1e-3, stop_time=0.8)


def press(**keys):
    plate = {"name": "press", "point": [0.3, 0.4, 1.05], "normal": [0.0, 0.0, -1.0], **MOVED}
    return box(damping=0.1, gravity=GRAVITY, plane=[{"name": "ground"}, plate], step=1e-3, stop_time=1.2, **keys)


def tumble(offset=0.0):
    return box(
        stiffness=2e3, damping=0.0, gravity=GRAVITY, offset=[offset, 0.0, 0.2], velocity=[1.0, 0.3, 0.0], angular_velocity=[6.0, 4.0, 5.0],
        plane=[{"name": "ground"}], step=1e-3, stop_time=2.6,
    )  # fmt: skip


def held(method="leapfrog"):
    pins = [{"name": "base", "points": "x-"}, {**GRIP, "points": {"i": [3, 3], "j": [0, 1]}}]
    return box(stiffness=2e3, damping=0.05, gravity=GRAVITY, pin=pins, method=method, step=5e-4, stop_time=0.5)


def thrown(**keys):
    """Stretched, turned and thrown; one side is heavy."""
    motion = {"velocity": [0.1, 0.0, -0.2], "angular_velocity": [1.0, 0.5, 3.0], "stretch": [1.2, 1.0, 0.9], "offset": [0.5, 0.0, 0.2]}
    heavy = {"points": "x+", "mass": 0.2}
    return box(region=[heavy], stiffness=500.0, damping=0.05, **motion, **keys, method="leapfrog", step=1e-3, stop_time=0.1)


TURNED = {"rotation": {"axis": [1.0, -2.0, 0.5], "degrees": 35.0}}
ENDS = [{"name": "hook", "points": "z+"}, {**GRIP, "points": "z-"}]
LANDING = {"gravity": GRAVITY, "plane": [{"name": "ground", "point": [0.0, 0.0, -0.02]}], "angular_velocity": [0.5, 0.0, 0.0]}


FLANGE, CENTROID = np.array([-0.5, 0.25, 1.5]), np.array([0.0, 0.5, 0.5])
AROUND = {"pin.grip.orientation.w": np.cos(0.3), "pin.grip.orientation.z": np.sin(0.3)}


def flanged():
    flange = [{**GRIP, "points": "x-", "origin": FLANGE.tolist()}]
    return box(stiffness=500.0, damping=0.3, gravity=GRAVITY, pin=flange, method="leapfrog", step=1e-3, stop_time=0.2)


def matched():
    return box(stiffness=1e3, mass={"inertia": "matched"}, **LANDING, method="leapfrog", step=1e-3, stop_time=0.1)


def held_in_contact(method="leapfrog"):
    return box(
        stiffness=2e3, damping=0.1, gravity=GRAVITY, offset=[0.0, 0.0, 0.05], plane=[{"name": "ground", "friction": 0.4}],
        pin=[{**GRIP, "points": "z+"}], method=method, step=1e-3, stop_time=0.8,
    )  # fmt: skip


def pull(time):
    sides = ((0, -1e4), (3, 1e4))
    return {f"force[{i},{j},{k}].x": f * (1 + j / 3) * time / 0.03 for i, f in sides for j in range(4) for k in range(4)}


def push(time):
    return {"load.push.x": np.sin(9 * time), "load.push.z": 1.0}


def rock(time):
    tilt = 0.2 * np.sin(3 * time)
    pose = {"point.z": 0.05 * np.sin(5 * time), "normal.x": np.sin(tilt), "normal.y": 0.0, "normal.z": np.cos(tilt)}
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


def lead(time):
    """The flange of a pin whose points go along a path, turned."""
    place = CENTROID + np.array([0.2 * time, 0.3 * np.sin(3 * time), 0.0]) + turned(FLANGE - CENTROID, np.array([0.0, 0.0, 0.6]))
    return {f"pin.grip.position.{axis}": value for axis, value in zip("xyz", place, strict=True)}


def carry(time):
    """Down onto the ground, along it and up."""
    down = {"position.z": np.interp(time, [0.0, 0.2, 0.5, 0.8], [1.05, 0.95, 0.95, 1.2]), "velocity.z": 0.0}
    along = {"position.x": 0.5 + 0.3 * time, "velocity.x": 0.3}
    return {f"pin.grip.{name}": value for name, value in (down | along).items()}


SMOOTH = {
    # velocities carry omega times the rounding of positions, 1e3/s; forces on pins the stiffness, 1e3 N/m
    "undamped": (free(), None, 1e-12),
    "damped": (free(damping=0.02), None, 1e-12),
    # a recurrence in positions divides their rounding by h and sums it up: 1e-16 m / 5e-4 s over 0.5 s
    "published": (free(damping=0.02, method="central_difference"), None, 1e-11),
    "stiff, under held forces": (stiff(), pull, 1e-12),
    "regions, a load, strong damping": (patched(), push, 1e-12),
    "a probe in B-splines": (patched(damping=3.0, lattice={"points": [7, 5, 4], "basis": "bspline"}), push, 1e-12),
    "two materials by their modulus": (solid(), None, 1e-12),
    "pins, one moving": (held(), wave, 1e-12),
    "pins, published": (held("central_difference"), wave, 1e-11),
    "pins of a body that starts turned": (thrown(pin=ENDS, **TURNED), None, 1e-12),
    "pins of a body that is turned at the start": (thrown(pin=ENDS, **TURNED), None, 1e-12, {"initial.rotation.x": 0.3}),
    "a pin told about another point": (flanged(), lead, 1e-11, AROUND),
    "a spin about the centre of mass": (thrown(initial={"spin_about": "mass"}), None, 1e-12),
    "masses of matched inertia, landing": (matched(), None, 1e-12, {"mass": 1.5}),
}
"""Name: scene, inputs, how far positions may part [m], start values."""

CONTACT = {
    "drop with friction": (drop("leapfrog"), None),
    "drop by the published rule": (drop("central_difference"), None),
    "incline": (incline(), None),
    "conveyor that turns": (conveyor(), None),
    "plane that rocks and heaves": (cradle(), rock),
    "plane that jumps": (cradle(), jump),
    "press": (press(), crush),
    "pinned and dragged": (held_in_contact(), carry),
    "pinned and dragged, by the published rule": (held_in_contact("central_difference"), carry),
}
"""Name: scene, inputs."""
