"""The problems between keys, and those of the mesh; found beside all others in one go."""

import pytest

from softffd.errors import SceneError
from softffd.scene.scene import scene_from

CLOSED = "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
OPEN = CLOSED.removesuffix("f 2 3 4\n")
FLAT = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture
def folder(tmp_path):
    for name, text in {"closed": CLOSED, "open": OPEN, "flat": FLAT}.items():
        (tmp_path / f"{name}.obj").write_text(text)
    return tmp_path


def problems(document, path="scene.toml"):
    with pytest.raises(SceneError) as caught:
        scene_from(document, path=path)
    return caught.value.problems


def with_mesh(folder, name, **document):
    return problems({"mesh": {"file": f"{name}.obj"}} | document, folder / "scene.toml")


@pytest.mark.parametrize("points", [[8, 8, 8], [9, 9, 8], [2, 32, 32], [32, 32, 32]])
@pytest.mark.parametrize("method", ["ros34pw2", "backward_euler"])
def test_every_lattice_has_implicit_methods(points, method):
    assert scene_from({"lattice": {"points": points}, "solver": {"method": method}})


@pytest.mark.parametrize("basis", ["bezier", "bspline"])
def test_the_finest_lattice_is_allowed_with_either_basis(basis):
    assert len(scene_from({"lattice": {"points": [32, 32, 32], "basis": basis}}).rest_positions()) == 32**3


@pytest.mark.parametrize("section", ["plane", "pin", "load", "probe"])
def test_a_name_used_twice_is_refused_at_the_second(section):
    rest = {"pin": [{"points": [[0, 0, 0]]}, {"points": [[1, 0, 0]]}], "load": [{"points": "x+"}] * 2}
    rest |= {"plane": [{}, {}], "probe": [{"at": [0, 0, 0]}] * 2}
    (line,) = problems({section: [item | {"name": "same"} for item in rest[section]]})
    assert line == f'{section}[1].name: wanted a name of its own, got "same", already the name of {section}[0]'


def test_different_kinds_may_share_a_name():
    assert scene_from({"plane": [{"name": "a"}], "load": [{"name": "a", "points": "all"}]})


@pytest.mark.parametrize("section", ["pin", "load"])
@pytest.mark.parametrize(("points", "got"), [("none", '"none"'), ([], "[]")])
def test_an_empty_pin_or_load_is_refused(section, points, got):
    expected = [f"{section}[0].points: wanted at least one control point, got {got}"]
    assert problems({section: [{"name": "a", "points": points}]}) == expected


def test_an_empty_region_is_allowed():
    assert scene_from({"region": [{"points": "none"}]})


def test_a_selection_outside_the_lattice_is_refused_wherever_it_stands():
    outside = [[4, 0, 0]]
    document = {
        "region": [{"points": outside}],
        "pin": [{"name": "a", "points": outside}],
        "load": [{"name": "a", "points": outside}],
        "inputs": {"forces": outside},
        "outputs": {"positions": outside, "velocities": {"k": [0, 7]}},
    }
    lines = problems(document)
    wanted = "wanted control points of the 4 x 4 x 4 lattice (i 0..3, j 0..3, k 0..3), got "
    assert len(lines) == 6 and all(wanted in line for line in lines)
    assert lines[-1].endswith("got k = [0, 7]")


def test_a_point_held_by_two_pins_is_refused():
    pins = [{"name": "a", "points": "x-"}, {"name": "b", "points": "z-"}]
    text = "wanted control points that no other pin holds, got [0, 0, 0] and 3 more, held by pin[0] too"
    assert problems({"pin": pins}) == [f"pin[1].points: {text}"]


def test_total_and_density_exclude_each_other(folder):
    (line,) = with_mesh(folder, "closed", mass={"total": 3, "density": 5})
    assert line == "mass: wanted total or density, got total = 3 and density = 5"


@pytest.mark.parametrize(
    ("mass", "line"),
    [
        (
            {"distribution": "volume"},
            'mass.distribution: "volume" needs a closed mesh, but the scene has no [mesh]',
        ),
        (
            {"distribution": "surface"},
            'mass.distribution: "surface" needs a mesh, but the scene has no [mesh]',
        ),
        (
            {"distribution": "vertices"},
            'mass.distribution: "vertices" needs a mesh, but the scene has no [mesh]',
        ),
    ],
)
def test_mass_from_a_mesh_needs_one(mass, line):
    assert problems({"mass": mass}) == [line]


@pytest.mark.parametrize(("key", "value", "instead"), [("density", 5.0, "total"), ("distribution", "volume", "surface")])
def test_mass_of_a_volume_needs_a_closed_mesh_and_says_that_this_one_is_open(folder, key, value, instead):
    (line,) = with_mesh(folder, "open", mass={key: value})
    assert line.startswith(f"mass.{key}: ") and "needs a closed mesh, but open.obj is open (" in line
    assert instead in line.rpartition(";")[2]


def test_mass_on_the_surface_of_an_open_mesh_is_allowed(folder):
    document = {"mesh": {"file": "open.obj"}, "mass": {"distribution": "surface"}}
    assert scene_from(document, path=folder / "scene.toml")


def test_a_flat_mesh_is_refused(folder):
    (line,) = with_mesh(folder, "flat")
    assert line.startswith("mesh.file: ") and "flat along z" in line


def test_a_box_that_does_not_hold_the_mesh_is_refused(folder):
    (line,) = with_mesh(folder, "closed", lattice={"size": [2, 1, 3.9]})
    assert line.startswith("lattice.size: wanted a box that holds the mesh ([0, 0, 0] to [2, 1, 4] m), got ")
    assert line.endswith("which does not along z; leave out size: the box then follows the mesh")
    (line,) = with_mesh(folder, "closed", lattice={"origin": [0, 0, 1], "size": [2, 1, 4]})
    assert line.endswith("; leave out origin and size: the box then follows the mesh")


@pytest.mark.parametrize("lattice", [{"margin": 0.1}])
def test_a_margin_without_a_mesh_is_refused(lattice):
    (line,) = problems({"lattice": lattice})
    assert line == "lattice.margin: wanted 0, for there is no [mesh] whose box it would grow, got 0.1"


def test_a_margin_on_a_given_box_is_refused(folder):
    lattice = {"origin": [0, 0, 0], "size": [2, 1, 4], "margin": 0.1}
    (line,) = with_mesh(folder, "closed", lattice=lattice)
    assert line == "lattice.margin: wanted 0, for origin and size are both given, got 0.1"


def test_a_mesh_that_cannot_be_read_is_a_problem_of_its_file(folder):
    (line,) = with_mesh(folder, "missing", probe=[{"name": "p", "at": [9, 9, 9]}], mass={"density": 1.0})
    assert line.startswith("mesh.file: ") and "missing.obj" in line


def test_a_probe_outside_the_box_is_refused_and_one_on_its_face_is_not():
    probes = [{"name": "in", "at": [1, 0, 0.5]}, {"name": "out", "at": [0.5, 0.5, 1.001]}]
    (line,) = problems({"probe": probes})
    assert line == "probe[1].at: wanted a place in the box [0, 0, 0] to [1, 1, 1] m, got [0.5, 0.5, 1.001]"


@pytest.mark.parametrize("box", [{"origin": [1e20, 0, 0], "size": [1, 1, 1]}, {"origin": [1.7e308, 0, 0], "size": [1.7e308, 1, 1]}])
def test_control_points_that_fall_together_in_double_precision_are_refused(box):
    (line,) = problems({"lattice": box})
    assert line.startswith("lattice: wanted control points that differ along x, got origin")


def test_all_problems_come_at_once_also_beside_faulty_values():
    document = {
        "titel": "x",
        "lattice": {"points": [4, 3, 3], "size": [1, -1, 1], "basis": "splines"},
        "material": {"damping": -1, "stifness": 3},
        "plane": [{"name": "a", "normal": [0, 0, 0]}, {"name": "a", "frction": 0.1}],
        "pin": [{"name": "b", "points": "z-"}, {"points": [[0, 0, 0], [0, 3, 0]]}],
        "load": [{"name": "l", "points": "none"}],
        "probe": [{"name": "p", "at": [9, 9, 9]}],
        "solver": {"step": -1},
    }
    assert [line.split(": ")[0] for line in problems(document)] == [
        "titel",
        "lattice.size[1]",
        "lattice.basis",
        "material.damping",
        "material.stifness",
        "plane[0].normal",
        "plane[1].frction",
        "plane[1].name",
        "pin[1].name",
        "pin[1].points",
        "load[0].points",
        "solver.step",
    ]


def test_a_check_does_not_blame_a_value_that_was_never_given():
    assert problems({"lattice": {"points": [4, 4, 99]}, "inputs": {"forces": [[0, 0, 50]]}}) == ["lattice.points[2]: wanted <= 32, got 99"]
    assert problems({"lattice": {"size": [0, 1, 1]}, "probe": [{"name": "p", "at": [5, 5, 5]}]}) == ["lattice.size[0]: wanted > 0 m, got 0"]
