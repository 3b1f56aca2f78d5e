"""A mesh alone is a scene: what its file leaves open is taken by habit and size, and said."""

import re
import tomllib
import zipfile

import numpy as np
import pytest
import trimesh

from mesh_files import saved, two_colours, unit_box, written
from softffd import simulate
from softffd.errors import MeshError, SoftffdError
from softffd.fmu.notes import fill_note
from softffd.mesh.files import load_mesh, save_mesh
from softffd.mesh.habits import Habit, habit_of
from softffd.mesh.mesh import Mesh
from softffd.scene.new import scene_of_mesh, template
from softffd.scene.scene import scene_from


def box_file(folder, name, sides, faces=12):
    body = trimesh.creation.box(sides)
    save_mesh(Mesh(body.vertices, body.faces[:faces]), folder / name)
    return folder / name


def scene_of(file, **options):
    return scene_from(tomllib.loads(scene_of_mesh(file, folder=file.parent, **options).text), path=file.with_suffix(".toml"))


# fmt: off
SAID = [
    ("a.obj", (0.5, 2, 19), {}, "0.5 x 2 x 19, no unit in the file: taken as metres, --unit mm otherwise; "
                                "y up as usual for OBJ, --up z otherwise"),
    ("a.stl", (155, 154, 120), {}, "155 x 154 x 120, no unit in the file: taken as millimetres, --unit m otherwise; "
                                   "z up as usual for STL, --up y otherwise"),
    ("a.ply", (1, 2, 3), {"unit": "in", "up": "x"}, "1 x 2 x 3, in inches; x up"),
    ("a.glb", (100, 2, 3), {}, "100 x 2 x 3, in metres; y up"),
]
# fmt: on


@pytest.mark.parametrize(("name", "sides", "options", "words"), SAID)
def test_what_was_read_is_said_in_a_line(name, sides, options, words, tmp_path):
    file = box_file(tmp_path, name, sides)
    made = scene_of_mesh(file, folder=tmp_path, **options)
    assert made.said.splitlines()[0] == f"{file}: 8 vertices, {words}; fills 100 % of its box"


@pytest.mark.parametrize(
    ("name", "sides", "options", "words"),
    [
        ("a.stl", (210, 150, 50), {}, "210 × 150 × 50 m (likely in millimetres: load_mesh(..., scale=0.001))"),
        ("a.stl", (210, 150, 50), {"scale": 1e-3}, "0.21 × 0.15 × 0.05 m"),
        ("a.stl", (2, 3, 4), {}, "2 × 3 × 4 m"),
        ("a.glb", (100, 2, 3), {}, "100 × 2 × 3 m"),
    ],
)
def test_a_mesh_read_in_metres_says_the_likely_unit_where_it_is_printed(name, sides, options, words, tmp_path):
    assert repr(load_mesh(box_file(tmp_path, name, sides), **options)) == f"Mesh a: 8 vertices, 12 faces, {words}"


@pytest.mark.parametrize(
    ("name", "options", "extent"),
    [
        ("a.obj", {}, (2, 4, 3)),
        ("a.obj", {"up": "z"}, (2, 3, 4)),
        ("a.obj", {"unit": "cm"}, (0.02, 0.04, 0.03)),
        ("a.stl", {}, (2, 3, 4)),
        ("a.stl", {"up": "x", "unit": "ft"}, (4 * 0.3048, 3 * 0.3048, 2 * 0.3048)),
    ],
)
def test_the_box_of_the_lattice_is_left_to_the_mesh_in_its_unit_and_upright(name, options, extent, tmp_path):
    file = box_file(tmp_path, name, (2, 3, 4))
    scene = scene_of(file, **options)
    assert not {"origin", "size"} & scene.lattice.model_fields_set
    np.testing.assert_allclose(scene.lattice.size, extent, rtol=1e-6)
    assert scene.plane[0].point[2] < scene.lattice.origin[2]


def test_the_mass_is_that_of_the_density_or_of_half_the_box_where_the_surface_is_open(tmp_path):
    closed, opened = box_file(tmp_path, "a.obj", (2, 3, 4)), box_file(tmp_path, "b.obj", (2, 3, 4), faces=10)
    assert (scene_of(closed).mass.total, scene_of(closed).mass.distribution) == (2400, "volume")
    assert (scene_of(closed, density=1000.0).mass.total, scene_of(opened).mass.total) == (24000, 1200)
    assert scene_of(opened).mass.distribution == "surface"
    made = scene_of_mesh(opened, folder=tmp_path)
    half = "half of the mesh's box at 100 kg/m3, since it is not closed: 4 edges belong to holes or to faces turned inside out"
    assert made.said.splitlines()[1] == f"  mass 1200 kg: {half}; lattice 4 x 4 x 4, stiffness 4700 N/m, internal damping 0.11 s"
    assert f"kg: {half}\n" in made.text and "\n  mass 2400 kg: the mesh at 100 kg/m3; " in scene_of_mesh(closed, folder=tmp_path).said


def test_ground_mass_and_scale_are_as_precise_as_the_mesh(tmp_path):
    body, file = trimesh.creation.box((1, 1, 1)), tmp_path / "a.obj"
    save_mesh(Mesh(body.vertices + np.array([4e5, 5237.4, 0.0]), body.faces), file)  # y is up
    text = scene_of_mesh(file, folder=tmp_path, density=1049.0).text
    assert "point = [0.0, 0.0, 5236.65]" in text and "total = 1049.0 " in text
    assert "scale = 0.3048 " in scene_of_mesh(file, folder=tmp_path, unit="ft").text


ASSETS = {
    '<asset><unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset>': Habit(0.0254, "z", True),
    "<asset><unit meter='0.01'/><up_axis>X_UP</up_axis></asset>": Habit(0.01, "x", True),
    '<asset><unit meter="0,010000"/><up_axis> z_up </up_axis></asset>': Habit(0.01, "z", True),
    '<!-- <unit meter="3"/> --><library/><asset><unit name="metre"/></asset>': Habit(1.0, "y", True),
    '<library><geometry><asset><unit meter="7"/><up_axis>Z_UP</up_axis></asset></geometry></library>': Habit(1.0, "y", True),
    '<asset><unit meter="1e"/><up_axis>UP</up_axis></asset>': Habit(None, "y", False, "1e"),
    '<asset><unit meter="-0.1"/></asset>': Habit(None, "y", True, "-0.1"),
    "": Habit(1.0, "y", True),
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("asset", ASSETS)
def test_unit_and_axis_of_collada_are_those_of_its_own_asset(asset, encoding, tmp_path):
    text = f'<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema">{asset}</COLLADA>'
    assert habit_of(written(tmp_path, "a.dae", text.encode(encoding))) == ASSETS[asset]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("quote", "'\"")
def test_the_unit_of_a_3mf_is_read_in_any_quotes_and_encoding(quote, encoding, tmp_path):
    units = {"unit=!inch!": Habit(0.0254, "z", True), "": Habit(0.001, "z", True), "unit=!furlong!": Habit(None, "z", True, "furlong")}
    for attribute, habit in units.items():
        with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
            archive.writestr("3D/3dmodel.model", f"<model {attribute.replace('!', quote)}><build/></model>".encode(encoding))
        assert habit_of(tmp_path / "a.3mf") == habit


def test_a_unit_that_is_none_is_said(tmp_path):
    pytest.importorskip("collada", reason="pycollada is not installed")
    text = trimesh.exchange.dae.export_collada(unit_box(0.0)).decode()
    text = re.sub("<up_axis>", '<unit meter="1e"/><up_axis>', re.sub("<unit[^>]*>", "", text))
    said = scene_of_mesh(written(tmp_path, "a.dae", text), folder=tmp_path).said
    assert "the file's unit '1e' is none: taken as metres, --unit mm otherwise" in said


def test_the_unit_of_a_3mf_is_that_of_the_scene(tmp_path):
    pytest.importorskip("networkx", reason="networkx is not installed")
    data = trimesh.Scene([unit_box(0.0)]).export(file_type="3mf")
    file = written(tmp_path, "a.3mf", data)
    assert habit_of(file) == Habit(0.001, "z", True)
    np.testing.assert_allclose(scene_of(file).lattice.size, [1e-3] * 3)
    assert repr(load_mesh(file)).endswith("1 × 1 × 1 m (the file is in millimetres: load_mesh(..., scale=0.001))")


def test_a_mesh_lies_on_the_ground_in_the_end(tmp_path):
    """It was above it, stays on it to a rounding, presses with its weight, and is at rest."""
    scene = scene_of(two_colours(tmp_path, "kd.obj"), up="z")
    result = simulate(scene)
    ground = scene.plane[0].point[2]
    heights = [result.deformed(row=row)[:, 2].min() - ground for row in (0, -1)]
    weight = 9.81 * scene.mass.total
    assert heights[0] > 0.5 and 0 <= heights[1] + 1e-9 < 0.02
    assert result.outputs["plane.ground.reaction.z"][-1] == pytest.approx(-weight, rel=0.01)
    assert np.abs(result.positions[-1] - result.positions[-10]).max() < 1e-3  # in a 25th of the time in which one falls 1.5 m
    finer = simulate(scene.replace({"solver.tolerance": scene.solver.tolerance / 20}))
    assert np.abs(finer.positions[-1] - result.positions[-1]).max() < scene.solver.tolerance * max(scene.lattice.size)


def test_a_mesh_falls_as_fast_as_a_stone(tmp_path):
    """All but a hundredth of what its weight did is motion before it lands: nothing brakes the fall."""
    scene = scene_of(two_colours(tmp_path, "kd.obj"), up="z")
    result = simulate(scene, stop_time=0.3)
    height, way = scene.lattice.origin[2] - scene.plane[0].point[2], 9.81 * result.time**2 / 2
    kinetic, flying = result.outputs["energy.kinetic"], (way > 0) & (way < 0.9 * height)
    assert flying.sum() > 3
    np.testing.assert_allclose(kinetic[flying], 9.81 * scene.mass.total * way[flying], rtol=0.01)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"unit": "mn"}, r"--unit: wanted one of m, cm, mm, in, ft, got 'mn'"),
        ({"up": "w"}, "--up: wanted one of x, y, z, got 'w'"),
        ({"density": 0.0}, "--density: wanted > 0 kg/m3, got 0"),
        ({"density": float("nan")}, "--density: wanted > 0 kg/m3, got nan"),
    ],
)
def test_unfit_options_are_refused(options, message, tmp_path):
    with pytest.raises(SoftffdError, match=message):
        scene_of_mesh(box_file(tmp_path, "a.obj", (1, 1, 1)), folder=tmp_path, **options)


def test_a_mesh_that_is_not_there_is_answered_with_the_nearest(tmp_path):
    written(tmp_path, "cow.obj", saved(tmp_path, "obj"))
    with pytest.raises(MeshError, match=r'cwo.obj: no such file; .*did you mean "cow.obj"\?'):
        scene_of_mesh(tmp_path / "cwo.obj", folder=tmp_path)


def test_names_with_blanks_and_quotes_and_other_folders_stand_in_the_scene(tmp_path):
    (tmp_path / "my meshes").mkdir()
    file = box_file(tmp_path / "my meshes", 'a "b" TITLE.obj', (1, 1, 1))
    document = tomllib.loads(scene_of_mesh(file, folder=tmp_path).text)
    assert document["mesh"]["file"] == 'my meshes/a "b" TITLE.obj' and document["title"] == 'a "b" TITLE dropped on the ground'


@pytest.mark.parametrize("name", ["a\x7fb", "a\tb", "a\\b", 'a"b', "a\udcffb", "\u2028"])
def test_any_name_makes_a_scene_that_can_be_read(name):
    assert tomllib.loads(template(name).encode().decode())["title"].startswith(name.encode(errors="replace").decode())


def test_a_mesh_whose_name_no_scene_can_hold_is_refused(tmp_path):
    with pytest.raises(SoftffdError, match="not text in UTF-8"):
        scene_of_mesh(tmp_path / "a\udcff.obj", folder=tmp_path)


@pytest.mark.parametrize(
    ("wall", "words"), [(None, "fills 100 % of its box"), (0.1, "fills 49 % of its box; the elastic body is the whole box")]
)
def test_how_much_of_its_box_a_closed_mesh_fills_is_said(wall, words, tmp_path):
    box = trimesh.creation.box()
    if wall:
        hollow = trimesh.creation.box([1 - 2 * wall] * 3)
        hollow.invert()
        box = trimesh.util.concatenate([box, hollow])
    box.export(tmp_path / "a.obj")
    scene = scene_of_mesh(tmp_path / "a.obj", folder=tmp_path)
    assert scene.said.splitlines()[0].endswith(f"; {words}")
    made = scene_from(tomllib.loads(scene.text), path=tmp_path / "a.toml")
    assert fill_note(made) == f"the mesh {words}"
