"""Runs that the tests of exports share."""

import pytest

from made_up_run import made_up_run, with_solids
from scenes import meshed
from softffd import Result, simulate
from softffd.scene.rigid import Box, Cylinder, Sphere
from solids import solid as block
from validation.shapes import sphere


@pytest.fixture(scope="session")
def thrown(tmp_path_factory) -> Result:
    """A ball of a mesh that spins, falls on the ground and is squashed."""
    falls = {"initial": {"angular_velocity": [0.0, 6.0, 1.0]}, "environment": {"gravity": [0.0, 0.0, -9.81]}, "stop_time": 0.6}
    ground = {"name": "ground", "point": [0.0, 0.0, -0.3]}
    folder = tmp_path_factory.mktemp("thrown")
    return simulate(meshed(folder, sphere(2), plane=[ground], stiffness=400.0, communication_step=0.02, **falls))


@pytest.fixture(scope="session")
def pressed() -> Result:
    """A box without a mesh between planes, beside a ball and a log that move, and a block that turns."""
    ball = Sphere(name="ball", radius=0.3, point=(2.0, 0.0, 0.5), velocity=(-0.5, 0.0, 0.0))
    log = Cylinder(name="log", radius=0.2, length=1.0, point=(-2.0, 0.0, 0.5), normal=(1.0, 1.0, 0.0), angular_velocity=(0.0, 0.0, 1.0))
    block = Box(name="block", size=(0.5, 0.4, 0.3), point=(0.0, 2.0, 0.5), angular_velocity=(1.0, 2.0, 0.0))
    return with_solids(made_up_run(frames=11), ball, log, block)


@pytest.fixture(scope="session")
def solid() -> Result:
    """A pad of finite elements under a load, on patches."""
    return simulate("pad", stop_time=0.05)


@pytest.fixture(scope="session")
def felt() -> Result:
    """A block of finite elements that lands on the ground with taxels on its foot."""
    foot = {"name": "foot", "on": "z-", "taxels": [3, 2]}
    falls = {"gravity": [0.0, 0.0, -9.81], "plane": [{"name": "ground"}], "sensor": [foot]}
    return simulate(block(modulus=1e5, density=1000.0, size=[0.1] * 3, internal_damping=5e-3, **falls), stop_time=0.3, step=0.05)


@pytest.fixture(scope="session", params=["thrown", "pressed"])
def run(request) -> Result:
    return request.getfixturevalue(request.param)
