"""What tests of contact start from."""

import pytest

from scenes import box
from softffd import Scene
from validation import shapes as bodies

UNIT = {"origin": [0.0, 0.0, 0.0], "size": [1.0, 1.0, 1.0]}
CENTRE = {"name": "centre", "at": [0.5, 0.5, 0.5]}


@pytest.fixture
def body(tmp_path):
    """body(vertices and faces, keys) is a scene of a body in the unit box, with contact of its surface and steps of 1 ms."""

    def made(shape, **keys) -> Scene:
        keys = {"contact": {"of": "surface"}, "lattice": UNIT, "method": "leapfrog", "step": 1e-3, "communication_step": 0.02, **keys}
        return box(mesh={"file": bodies.write(tmp_path / "body.obj", shape)}, stiffness=keys.pop("stiffness", 2e3), probe=[CENTRE], **keys)

    return made
