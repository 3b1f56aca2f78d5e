"""What tests of contact start from."""

import pytest

from scenes import GRAVITY, meshed
from softffd import Scene

RUBBER = {"youngs_modulus": 6e3, "internal_damping": 5e-4}
"""The fastest vibrations have their critical damping."""


@pytest.fixture
def body(tmp_path):
    """body(vertices and faces, keys) is a scene of a body in the unit box, with contact of its surface and steps of 1 ms."""

    def made(shape, **keys) -> Scene:
        material = {} if "material" in keys else {"stiffness": 2e3}
        start = {"method": "leapfrog", "step": 1e-3, "communication_step": 0.02, "probe": [{"name": "centre", "at": [0.5, 0.5, 0.5]}]}
        return meshed(tmp_path, shape, **{**material, **start, **keys})

    return made


@pytest.fixture
def rubber(body):
    """Such a body of 1 kg/m3 with internal damping, under gravity."""
    return lambda shape, **keys: body(shape, **{"material": RUBBER, "mass": {"density": 1.0}, "gravity": GRAVITY, **keys})
