"""The two scenes, opened."""

import pytest

from host_scenes import HELD, scene
from softffd import Simulation


@pytest.fixture
def sim():
    with Simulation(scene()) as opened:
        yield opened


@pytest.fixture
def held():
    with Simulation(scene(HELD)) as opened:
        yield opened
