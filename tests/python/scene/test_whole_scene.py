"""Whatever makes a scene checks all of it and leaves nothing open."""

import copy
import json
import pickle

import pytest

from scenes import TETRAHEDRON
from softffd import Scene, SceneError, load_scene, package_fmu
from softffd.scene.rigid import Plane
from softffd.scene.scene import scene_from
from softffd.scene.sections import Material

DAMPED = {"material": {"damping": -5}}
REFUSAL = "material.damping: wanted >= 0 N.s/m, got -5"

NO_ENTRY = "wanted the name of one (table, press) or a number below 2 in plane"

WAYS = {
    "Scene(...)": lambda document: Scene(**document),
    "model_validate": Scene.model_validate,
    "model_validate_json": lambda document: Scene.model_validate_json(json.dumps(document)),
    "scene_from": scene_from,
    "model_copy": lambda document: Scene().model_copy(update=document),
    "replace": lambda document: Scene().replace(document),
}


@pytest.fixture
def embedded(tmp_path):
    (tmp_path / "tetrahedron.obj").write_text(TETRAHEDRON)
    (tmp_path / "embedded.toml").write_text('[mesh]\nfile = "tetrahedron.obj"\n[lattice]\nmargin = 0.5\n[[plane]]\nname = "ground"\n')
    return load_scene(tmp_path / "embedded.toml")


@pytest.fixture(params=WAYS)
def made(request):
    return WAYS[request.param]


def test_a_scene_of_nothing_is_the_unit_box_and_runs(tmp_path):
    scene = Scene()
    assert scene.name == "scene" and scene.lattice.origin == (0, 0, 0) and scene.lattice.size == (1, 1, 1) and scene.mass.total == 1
    assert package_fmu(scene, tmp_path / "scene.fmu").is_file()


def test_every_way_refuses_a_value_out_of_range_with_the_same_words(made):
    with pytest.raises(SceneError) as caught:
        made(DAMPED)
    assert caught.value.problems == [REFUSAL] and str(caught.value) == f"scene: 1 problem\n  {REFUSAL}"


def test_every_way_reports_all_problems_at_once(made):
    parts = {"plane": [{"name": "a"}, {"name": "a"}], "pin": [{"name": "b", "points": [[9, 0, 0]]}], "solver": {"metod": "auto"}}
    with pytest.raises(SceneError) as caught:
        made({**DAMPED, **parts})
    places = [problem.partition(":")[0] for problem in caught.value.problems]
    assert places == ["material.damping", "plane[1].name", "pin[0].points", "solver.metod"]


def test_every_way_fills_in_the_box_and_the_mass(made, tmp_path):
    (tmp_path / "tetrahedron.obj").write_text(TETRAHEDRON)
    scene = made({"mesh": {"file": str(tmp_path / "tetrahedron.obj")}})
    assert scene.lattice.size == (2, 1, 4) and scene.mass.total == 1 and len(scene.loaded_mesh.vertices) == 4


def test_sections_are_as_good_as_tables_and_as_closely_looked_at():
    of_sections = Scene(plane=[Plane(name="ground", point=(0, 0, -1))], material=Material(stiffness=2e3))
    assert of_sections == Scene(plane=[{"name": "ground", "point": [0, 0, -1]}], material={"stiffness": 2e3})
    for wrong, words in (({"damping": -5}, r"material\.damping"), ({"dampin": 5}, 'dampin: unknown key, did you mean "damping"')):
        with pytest.raises(SceneError, match=words):
            Scene(material=Material().model_copy(update=wrong))


def test_what_is_no_table_is_no_scene():
    with pytest.raises(SceneError, match="wanted a table of sections, got 5"):
        Scene.model_validate(5)


def test_a_scene_is_valid_as_it_is(embedded):
    assert Scene.model_validate(embedded) is embedded


def test_neither_a_scene_nor_its_sections_can_be_changed(embedded):
    for part, key in ((embedded, "title"), (embedded.plane[0], "friction"), (embedded.material, "damping")):
        with pytest.raises(ValueError, match="frozen"):
            setattr(part, key, 1.0)


def test_replace_takes_dotted_keys():
    changes = {"material.stiffness": 2e3, "plane.press.friction": 0.1, "plane[0].friction": 0.2, "title": "Pressed"}
    scene = load_scene("press").replace(changes)
    assert scene.material.stiffness.face == 2e3 and scene.title == "Pressed"
    assert [(plane.name, plane.friction) for plane in scene.plane] == [("table", 0.2), ("press", 0.1)]
    before = load_scene("press")
    assert scene.material.damping == before.material.damping and scene.name == "press" and scene.path == before.path
    assert scene.replace({"material.stiffness.edge": 5}).material.stiffness.model_dump() == {"edge": 5, "face": 2e3, "body": 2e3}


def test_none_takes_a_key_away(embedded):
    assert load_scene("press").replace({"environment.gravity": None}).environment.gravity is None
    assert embedded.replace({"plane.ground": None}).plane == ()
    assert embedded.replace({"mesh": None, "lattice.margin": None}).lattice.size == (1, 1, 1)


def test_what_was_filled_in_follows_a_change(embedded):
    assert embedded.replace({"mesh.scale": 0.5}).lattice.size == tuple(side / 2 for side in embedded.lattice.size)
    assert embedded.replace({"mass.density": 3.0}).mass.total is None
    copied = embedded.model_copy(update={"lattice": embedded.lattice.model_copy(update={"margin": 0.0})})
    assert copied.lattice.size == (2, 1, 4)


@pytest.mark.parametrize(
    "changes, problem",
    [
        ({"materal.stiffness": 1}, 'materal: unknown key, did you mean "material"?'),
        ({"plane.tabel.friction": 1}, f'plane.tabel.friction: {NO_ENTRY}, got "tabel", did you mean "table"?'),
        ({"plane[2].friction": 1}, f'plane[2].friction: {NO_ENTRY}, got "2"'),
        ({"lattice.points.2": 6}, "lattice.points: wanted 3 whole numbers [nx, ny, nz], got { 2 = 6 }"),
        ({"plane.press.friction": -1}, "plane[1].friction: wanted >= 0, got -1"),
        ({"experiment.stop_time.s": 1}, "experiment.stop_time: wanted a number (s), got { s = 1 }"),
    ],
)
def test_replace_says_what_is_wrong_with_a_key(changes, problem):
    with pytest.raises(SceneError) as caught:
        load_scene("press").replace(changes)
    assert caught.value.problems == [problem]


def test_copies_are_equal_and_changes_are_not(embedded):
    for same in (pickle.loads(pickle.dumps(embedded)), copy.deepcopy(embedded), embedded.model_copy(), embedded.replace({})):
        assert same == embedded and hash(same) == hash(embedded) and same.name == "embedded"
        assert same.loaded_mesh is not None and same.lattice.model_fields_set == {"margin"}
    assert embedded.replace({"title": "x"}) != embedded != "embedded"
    other = scene_from({}, path="other.toml")
    assert other != Scene() and other.model_dump() == Scene().model_dump()


def test_scenes_with_other_meshes_are_not_equal(embedded):
    (embedded.path.parent / "tetrahedron.obj").write_text(TETRAHEDRON.replace("v 0 1 0", "v 0.5 1 0"))
    other = load_scene(embedded.path)
    assert other != embedded and other.model_dump() == embedded.model_dump()


def test_what_was_refused_in_another_process_is_told_in_full():
    with pytest.raises(SceneError) as caught:
        Scene(**DAMPED)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value) and again.problems == [REFUSAL]
