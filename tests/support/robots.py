"""Robots of MuJoCo and soft bodies on them; tests that import this are skipped where there is no mujoco."""

import pytest

from scenes import GRAVITY, LED, box

mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed: pip install 'softffd[mujoco]'")

MASS, STIFF = 3.0, 2000.0
"""Of the mass on the soft cube [kg], and of each of its springs [N/m]"""
CUBE = {"points": [3, 3, 3], "stiffness": STIFF, "damping": 0.0, "mass": {"total": 0.027}, "tolerance": 1e-5}
SLIDER = '<body name="load" pos="0.5 0.5 1"><joint type="slide" axis="0 0 1"/><geom type="sphere" size="0.1" mass="3"/></body>'
FREE = """<body name="load" pos="0.2 0.3 1.4"><freejoint/><geom type="sphere" size="0.1" mass="1"/></body>"""
TURNED = {"motion": "input", "inputs": ["point", "rotation", "velocity", "angular_velocity"]}
ROUND = {"motion": "input", "inputs": ["point", "velocity", "angular_velocity"]}


def robot(bodies: str, *, timestep: float = 1e-3, gravity: str = "0 0 -9.81", option: str = ""):
    text = f'<mujoco><option timestep="{timestep}" gravity="{gravity}" {option}/><worldbody>{bodies}</worldbody></mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


def spring(**keys):
    """A cube on the ground, whose top holds on to what lies on it."""
    pins = [{"name": "ground", "points": "z-"}, {"name": "top", "points": "z+", **LED}]
    return box(**{**CUBE, "gravity": GRAVITY, "pin": pins, "energy": True, **keys})
