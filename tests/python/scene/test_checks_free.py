"""Free bodies in a scene: what they may have, and what is refused, by name."""

import math

import pytest

from scenes import problems
from softffd.obstacles import SolidShape
from softffd.scene.scene import scene_from

BALL = {"name": "ball", "radius": 0.1, "point": [0.0, 0.0, 2.0]}
DISK = {"name": "disk", "radius": 0.2, "length": 0.1}
BLOCK = {"name": "block", "size": [0.1, 0.2, 0.3]}
FREE = {"motion": "free", "mass": 2.0}
HAND = {"name": "hand", "points": "z+", "motion": "free"}
INERTIA = {"mass": 2.0, "inertia": [1.0, 2.0, 2.5]}
ALONG = {"guide": [0.0, 0.0, -2.0]}


def sphere(**keys):
    return {"sphere": [BALL | keys]}


def pin(**keys):
    return {"pin": [HAND | keys]}


# fmt: off
REFUSED = [
    (sphere(mass=2.0), 'sphere[0].mass: wanted none with motion = "fixed", got 2.0; it needs motion = "free"'),
    (sphere(motion="input", guide=[0, 0, 1]),
     'sphere[0].guide: wanted none with motion = "input", got [0.0, 0.0, 1.0]; it needs motion = "free"'),
    (pin(motion="fixed", inertia=[1, 1, 1]),
     'pin[0].inertia: wanted none with motion = "fixed", got [1.0, 1.0, 1.0]; it needs motion = "free"'),
    (sphere(motion="free"), 'sphere[0]: wanted mass or density beside motion = "free", got none'),
    (sphere(**FREE, density=5.0), "sphere[0]: wanted mass or density, got mass = 2 and density = 5"),
    (sphere(motion="free", mass=0.0), "sphere[0].mass: wanted > 0 kg, got 0.0"),
    (sphere(motion="free", density=1e-322), "sphere[0].density: wanted a mass and moments of inertia > 0, got 0"),
    (sphere(**FREE, inertia=[1, 2, 3.01]),
     "sphere[0].inertia: wanted moments of a rigid body, of which none exceeds the sum of the other two, got [1.0, 2.0, 3.01]"),
    (sphere(**FREE, guide=[0, 0, 0]),
     "sphere[0].guide: wanted a vector of length > 0 (in double precision: 1e-100 to 1e100), got [0, 0, 0]"),
    (sphere(**FREE, **ALONG, angular_velocity=[0, 0, 1]),
     "sphere[0].angular_velocity: wanted none beside guide, along which the body does not turn, got [0.0, 0.0, 1.0]"),
    (sphere(**FREE, **ALONG, inertia=[1, 1, 1]),
     "sphere[0].inertia: wanted none beside guide, along which the body does not turn, got [1.0, 1.0, 1.0]"),
    (sphere(**FREE, **ALONG, velocity=[1, 0, -3]),
     "sphere[0].velocity: wanted a velocity along guide = [0.0, 0.0, -2.0], got [1.0, 0.0, -3.0]; [0.0, 0.0, -3.0] is nearest"),
    (sphere(**FREE, inputs=["point.z"]), 'sphere[0].inputs: wanted none with motion = "free", got ["point.z"]; they need motion = "input"'),
    (pin(inertia=[1, 1, 1]), 'pin[0]: wanted mass beside motion = "free", got none'),
    (pin(mass=2.0), 'pin[0]: wanted inertia beside motion = "free", or a guide, along which it does not turn, got neither'),
    (pin(mass=2.0, inertia=[1, -1, 1]), "pin[0].inertia[1]: wanted > 0 kg m2, got -1"),
    (pin(**INERTIA) | {"plane": [{"name": "a"}]},
     'pin[0].motion: wanted "fixed" or "input" where control points meet obstacles, got "free"; it needs a [mesh], and [contact] of = '
     '"surface"'),
    (pin(**INERTIA, points=[[0, 0, 3], [3, 0, 3]]),
     "pin[0].points: wanted control points that are not on one line, or a guide, got [[0, 0, 3], [3, 0, 3]]: they do not hold the part "
     "against turning"),
    ({"plane": [{"name": "a", "motion": "free"}]}, 'plane[0].motion: wanted "fixed" or "input", got "free"'),
    *((pin(**INERTIA) | {"solver": {"method": method}},
       f'solver.method: wanted "auto", "leapfrog" or "sdirk2" beside a body with motion = "free", got "{method}"')
      for method in ("central_difference", "bm4", "rkn12", "dop853", "ros34pw2", "backward_euler")),
]
# fmt: on


def found(document):
    """Without what a scene without a mesh has to say of solid obstacles."""
    return [problem for problem in problems(document) if not problem.startswith("contact.of")]


@pytest.mark.parametrize("document, problem", REFUSED, ids=[problem for _, problem in REFUSED])
def test_what_makes_no_free_body_is_refused_by_name(document, problem):
    assert found(document) == [problem]


@pytest.mark.parametrize("method", ["auto", "leapfrog", "sdirk2"])
@pytest.mark.parametrize("keys", [INERTIA, {"mass": 2.0, **ALONG}])
def test_a_free_pin_has_a_mass_and_turns_or_has_a_guide(method, keys):
    assert scene_from(pin(**keys) | {"solver": {"method": method, "step": 1e-4}}).pin[0].mass == 2.0


# of 1 kg: two fifths of r2; l2 / 12 + r2 / 4 and r2 / 2; the others' squares / 12
HOMOGENEOUS = {
    "sphere": ((0.2, 0.2, 0.2), 4 / 3 * math.pi * 0.1**3, [0.4 * 0.1**2] * 3),
    "cylinder": ((0.4, 0.4, 0.1), math.pi * 0.2**2 * 0.1, [0.1**2 / 12 + 0.2**2 / 4] * 2 + [0.2**2 / 2]),
    "box": ((0.1, 0.2, 0.3), 0.1 * 0.2 * 0.3, [(0.2**2 + 0.3**2) / 12, (0.1**2 + 0.3**2) / 12, (0.1**2 + 0.2**2) / 12]),
}


@pytest.mark.parametrize("kind", HOMOGENEOUS)
def test_volume_and_inertia_are_those_of_the_homogeneous_shape(kind):
    size, volume, inertia = HOMOGENEOUS[kind]
    shape = SolidShape("a", kind, size)
    assert shape.volume == pytest.approx(volume, rel=1e-14) and shape.inertia(3.0) == pytest.approx([3 * i for i in inertia], rel=1e-14)
