"""What contact of the surface needs of a scene, and what it does not go with."""

import pytest

from softffd.errors import SceneError
from softffd.scene.scene import scene_from
from validation import shapes as bodies

MEETING = {"plane": [{"name": "ground"}], "contact": {"of": "surface"}}


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ({"solver": {"method": "central_difference"}},
         'solver.method: wanted "auto", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2" or "backward_euler" beside contact.of = '
         '"surface", which it does not know, got "central_difference"'),
        ({"contact": {"of": "lattice", "penetration": 0.01}},
         'contact.penetration: wanted it beside of = "surface" only, got 0.01 with of = "lattice"'),
        ({"mesh": None}, 'contact.of: "surface" needs a mesh, but the scene has no [mesh]; take "lattice" instead'),
        ({"contact": {"of": "surfaces"}}, 'contact.of: wanted "surface" or "lattice", got "surfaces", did you mean "surface"?'),
    ],
)  # fmt: skip
def test_what_contact_of_the_surface_does_not_go_with_is_refused_by_name(tmp_path, keys, line):
    mesh = {"file": bodies.write(tmp_path / "cube.obj", bodies.cube(2, 0.0))}
    document = {key: value for key, value in (MEETING | {"mesh": mesh} | keys).items() if value is not None}
    with pytest.raises(SceneError) as told:
        scene_from(document)
    assert told.value.problems == [line]
    if "solver" in keys:  # without planes nothing is met
        assert scene_from({key: value for key, value in document.items() if key != "plane"}).contact.of == "surface"


def test_a_sphere_that_looks_alike_from_all_sides_has_no_normal_to_move():
    with pytest.raises(SceneError) as told:
        scene_from({"sphere": [{"name": "ball", "radius": 1.0, "motion": "input", "inputs": ["point", "normal"]}]})
    wanted = 'wanted a list of point, velocity, angular_velocity or their components, such as "point.z"'
    assert told.value.problems[0] == f'sphere[0].inputs: {wanted}, got ["point", "normal"]'
