import json
import re
import tomllib

import numpy as np
import pytest

from scenes import TETRAHEDRON
from softffd.scene.document import SHIPPED, shipped_scenes
from softffd.scene.keys import schema
from softffd.scene.new import template
from softffd.scene.scene import Scene, load_scene, scene_from


@pytest.fixture
def tetrahedron(tmp_path):
    (tmp_path / "tetrahedron.obj").write_text(TETRAHEDRON)
    return tmp_path / "scene.toml"


def test_an_empty_file_is_the_documented_default_scene(tmp_path):
    (tmp_path / "plain.toml").write_text("")
    scene = load_scene(tmp_path / "plain.toml")
    assert scene.name == "plain" and scene.path == tmp_path / "plain.toml"
    assert scene.lattice.points == (4, 4, 4)
    assert scene.lattice.origin == (0, 0, 0) and scene.lattice.size == (1, 1, 1)
    assert scene.mass.total == 1.0 and scene.mass.density is None
    assert (scene.material.stiffness.edge, scene.material.stiffness.body) == (1e3, 1e3)
    assert scene.material.damping == 0.01
    assert scene.environment.gravity is None and scene.mesh is None and scene.loaded_mesh is None
    assert scene.plane == () and scene.outputs.reactions is True and scene.default_inputs is None


def test_a_table_of_stiffness_and_a_mirrored_and_collapsed_start_are_kept():
    stiffness, stretch = {"edge": 1, "face": 2.5, "body": 0}, (-1.0, 0.0, 1e3)
    scene = scene_from({"material": {"stiffness": stiffness}, "initial": {"stretch": list(stretch)}})
    assert dict(scene.material.stiffness) == stiffness and scene.initial.stretch == stretch


def test_rest_positions_lie_on_the_grid_in_flat_order():
    scene = scene_from({"lattice": {"points": [3, 2, 4], "origin": [1, 2, 3], "size": [4, 5, 6]}})
    positions = scene.rest_positions()
    assert positions.shape == (24, 3)
    for i, j, k in [(0, 0, 0), (2, 1, 3), (1, 0, 2)]:
        expected = [1 + 4 * i / 2, 2 + 5 * j / 1, 3 + 6 * k / 3]
        np.testing.assert_allclose(positions[i + 3 * (j + 2 * k)], expected, rtol=1e-15)


def test_select_follows_the_lattice_of_the_scene():
    scene = scene_from({"lattice": {"points": [2, 2, 3]}, "pin": [{"name": "top", "points": "z+"}]})
    assert scene.select(scene.pin[0].points).tolist() == [8, 9, 10, 11]


def test_the_box_follows_the_mesh_in_its_scale_with_its_margin_unless_it_is_given(tetrahedron):
    def scene(mesh=(), **lattice):
        return scene_from({"mesh": {"file": "tetrahedron.obj", **dict(mesh)}, "lattice": lattice}, path=tetrahedron)

    wider = scene(margin=0.5)
    assert wider.lattice.origin == (-1.0, -0.5, -2.0) and wider.lattice.size == (4.0, 2.0, 8.0)
    assert wider.mesh.file == tetrahedron.parent / "tetrahedron.obj" and wider.mesh.file.is_absolute()
    assert len(wider.loaded_mesh.vertices) == 4
    assert scene({"scale": 0.5, "up": "x"}).lattice.size[2] == pytest.approx(1.0, rel=1e-12)
    given = scene(origin=[-1, -1, -1], size=[5, 5, 6])
    assert given.lattice.origin == (-1, -1, -1) and given.lattice.size == (5, 5, 6)


def test_a_csv_beside_the_scene_is_its_default_input(tmp_path):
    (tmp_path / "pushed.toml").write_text("")
    (tmp_path / "pushed.csv").write_text("time\n")
    assert load_scene(tmp_path / "pushed.toml").default_inputs == tmp_path / "pushed.csv"


def test_the_shipped_scenes_are_all_there():
    promised = {"standard", "free_vibration", "car_ball", "car_bump", "car_drop", "press", "incline", "hanging", "spin"}
    assert promised <= set(shipped_scenes())
    assert len(shipped_scenes()) == len([*SHIPPED.rglob("*.toml")]), "a name stands in two folders"


@pytest.mark.parametrize("name", shipped_scenes())
def test_every_shipped_scene_says_what_to_expect_and_is_the_same_again_when_it_is_dumped_or_copied(name):
    scene = load_scene(name)
    text = scene.path.read_text()
    assert scene.name == name and scene.title != Scene.model_fields["title"].default
    assert "# See:" in text and "# Expect:" in text
    dumped = json.loads(scene.model_dump_json(exclude_none=True, exclude_unset=True))
    assert scene_from(dumped, path=scene.path).model_dump() == scene.model_dump()
    assert scene.replace({}) == scene


@pytest.mark.parametrize("name", ["car_drop", "press"])
def test_default_inputs_drive_inputs_of_their_scene(name):
    scene = load_scene(name)
    head, *rows = scene.default_inputs.read_text().splitlines()
    time, *variables = head.split(",")
    driven = {f"plane.{plane.name}.point.{axis}" for plane in scene.plane if plane.motion == "input" for axis in "xyz"}
    assert time == "time" and variables and set(variables) <= driven
    course = np.array([row.split(",") for row in rows], dtype=float)
    assert np.all(np.diff(course[:, 0]) > 0) and course[0, 0] == 0
    assert course[-1, 0] >= scene.experiment.stop_time
    for column, variable in enumerate(variables, start=1):
        _, plane_name, _, axis = variable.split(".")
        (plane,) = (plane for plane in scene.plane if plane.name == plane_name)
        assert course[0, column] == plane.point["xyz".index(axis)]


@pytest.mark.parametrize("name", shipped_scenes())
def test_no_shipped_scene_starts_inside_an_obstacle(name):
    scene = load_scene(name)
    origin, initial = np.array(scene.lattice.origin), scene.initial
    start = origin + np.array(initial.stretch) * (scene.rest_positions() - origin) + np.array(initial.offset)
    for plane in scene.plane:
        assert np.min((start - plane.point) @ plane.normal) >= 0


def test_nothing_touches_the_standard_component_at_the_start():
    scene = load_scene("standard")
    assert {plane.motion for plane in scene.plane} == {"input"}
    for plane in scene.plane:
        assert np.min((scene.rest_positions() - plane.point) @ plane.normal) > 0.4


def test_free_vibration_is_the_reference_scene():
    scene = load_scene("free_vibration")
    assert scene.initial.stretch == (1.1, 1, 1) and scene.material.damping == 0 and not scene.plane
    assert scene.environment.gravity is None and scene.mass.total == 1 and scene.material.stiffness.face == 1e3


def test_the_template_is_a_scene_of_that_title(tmp_path):
    (tmp_path / "mine.toml").write_text(template('my "soft" \\ box'), encoding="utf-8")
    scene = load_scene(tmp_path / "mine.toml")
    assert scene.title.startswith('my "soft" \\ box') and scene.plane[0].name == "ground"


def keys_of(node, definitions, path=()):
    node = definitions[node["$ref"].rpartition("/")[2]] if "$ref" in node else node.get("items", node)
    node = definitions[node["$ref"].rpartition("/")[2]] if "$ref" in node else node
    for key, value in node.get("properties", {}).items():
        yield (*path, key)
        yield from keys_of(value, definitions, (*path, key))


def template_with_every_key_in_force():
    text = re.sub(r"^#(?=\S)", "", template("full"), flags=re.MULTILINE)
    return tomllib.loads(text)


def test_the_template_shows_every_key_of_the_schema():
    definition, full = schema(), template_with_every_key_in_force()
    for path in keys_of(definition, definition["$defs"]):
        table = full
        for key in path:
            table = table[0] if isinstance(table, list) else table
            assert key in table, f"{'.'.join(path)} is not in the template"
            table = table[key]


def test_the_template_with_every_key_in_force_has_only_the_problems_it_must_have(tmp_path):
    (tmp_path / "object.obj").write_text(TETRAHEDRON.replace("2", "1").replace("4", "1"))
    full = template_with_every_key_in_force()
    del full["mesh"], full["lattice"]["margin"], full["mass"]["density"]
    del full["lattice"]["cells"], full["lattice"]["spacing"], full["material"]["youngs_modulus"]
    del full["material"]["poissons_ratio"], full["material"]["density"]
    del full["region"][0]["youngs_modulus"], full["region"][0]["density"], full["contact"]["penetration"]
    del full["sphere"], full["cylinder"], full["box"]
    del full["pin"][0]["mass"], full["pin"][0]["inertia"], full["pin"][0]["guide"]
    assert isinstance(scene_from(full), Scene)


def test_the_values_of_the_template_are_defaults_unless_it_says_otherwise():
    defaults = scene_from({})
    for line in template("x").splitlines():
        if line.startswith("["):
            section = line.split("]")[0].strip("[]")
        elif "=" in line and not line.startswith("#") and "(default" not in line and not line.startswith("title"):
            key, value = next(iter(tomllib.loads(line).items()))
            table = getattr(defaults, section)
            default = getattr(table, key) if table else schema_default(section, key)
            as_json = json.loads(json.dumps(default, default=lambda stiffness: stiffness.edge))
            assert "must be given" in line or as_json == value, line


def schema_default(section, key):
    definition = schema()
    table = definition["properties"][section]["items"]["$ref"].rpartition("/")[2]
    return definition["$defs"][table]["properties"][key].get("default")


def test_the_schema_has_no_null_and_describes_every_key():
    definition = schema()
    assert definition["$schema"].endswith("draft-07/schema#") and definition["title"] == "softffd scene"
    assert "null" not in json.dumps(definition)
    for table in [definition, *definition["$defs"].values()]:
        assert table["additionalProperties"] is False
        for key, value in table["properties"].items():
            assert value.get("description"), key


def test_the_schema_accepts_the_shipped_scenes_and_refuses_a_misspelt_key():
    import jsonschema

    check = jsonschema.Draft7Validator(schema())
    for name in shipped_scenes():
        document = tomllib.loads(load_scene(name).path.read_text())
        assert check.is_valid(document), name
        assert not check.is_valid(document | {"titel": "x"})
