"""The wording of what pydantic finds: path, what was wanted, what was given, the nearest valid choice."""

import datetime
import math

import numpy as np
import pytest

from scenes import problems
from softffd.errors import SceneError
from softffd.scene.scene import Scene, scene_from

PLANE = {"name": "ground"}
TWENTY = "a" * 200

# fmt: off
CASES = [
    ({"titel": "x"}, 'titel: unknown key, did you mean "title"?'),
    ({"material": {"stifness": 1.0}}, 'material.stifness: unknown key, did you mean "stiffness"?'),
    ({"material": {"friction": 1.0}},
     "material.friction: unknown key here; it belongs in [[plane]] or [[sphere]] or [[cylinder]] or [[box]]"),
    ({"solver": {"": 1}}, 'solver."": unknown key, wanted "method", "tolerance", "step", "most_work", "threads" or "error_estimate"'),
    ({"material": {"stiffness": -5}}, "material.stiffness: wanted >= 0 N/m, got -5"),
    ({"material": {"stiffness": "soft"}},
     'material.stiffness: wanted a number or a table { edge = , face = , body = } (N/m), got "soft"'),
    ({"material": {"stiffness": {"edge": 1, "face": 1}}},
     "material.stiffness.body: wanted stiffness of the body diagonals [N/m; >= 0], got nothing"),
    ({"material": {"damping": math.nan}}, "material.damping: wanted a finite number (N.s/m), got nan"),
    ({"material": {"damping": True}}, "material.damping: wanted a number (N.s/m), got true"),
    ({"mass": {"total": 0}}, "mass.total: wanted > 0 kg, got 0"),
    ({"mass": {"uniform_share": 1.5}}, "mass.uniform_share: wanted <= 1, got 1.5"),
    ({"mass": {"distribution": "vertex"}},
     'mass.distribution: wanted "uniform", "box", "vertices", "surface" or "volume", got "vertex", did you mean "vertices"?'),
    ({"lattice": {"size": [1, 0, 1]}}, "lattice.size[1]: wanted > 0 m, got 0"),
    ({"lattice": {"points": [4, 4]}}, "lattice.points: wanted 3 whole numbers [nx, ny, nz], got [4, 4]"),
    ({"lattice": {"points": [4, 4.0, 4]}}, "lattice.points[1]: wanted a whole number, got 4.0"),
    ({"lattice": {"points": [1, 4, 4]}}, "lattice.points[0]: wanted >= 2, got 1"),
    ({"lattice": {"points": [4, 4, 33]}}, "lattice.points[2]: wanted <= 32, got 33"),
    ({"lattice": {"origin": TWENTY}}, f'lattice.origin: wanted 3 numbers [x, y, z] (m), got "{TWENTY[:66]}...'),
    ({"environment": {"gravity": -9.81}}, "environment.gravity: wanted 3 numbers [x, y, z] (m/s2), got -9.81"),
    ({"initial": {"offset": datetime.date(2020, 1, 1)}}, "initial.offset: wanted 3 numbers [x, y, z] (m), got 2020-01-01"),
    ({"initial": {"rotation": 35}}, "initial.rotation: wanted a table { axis = [x, y, z], degrees = }, got 35"),
    ({"initial": {"rotation": {"axis": [0, 0, 0], "degrees": 35}}},
     "initial.rotation.axis: wanted a vector of length > 0 (in double precision: 1e-100 to 1e100), got [0, 0, 0]"),
    ({"initial": {"rotation": {"axis": [0, 1, 0], "degree": 35}}}, 'initial.rotation.degree: unknown key, did you mean "degrees"?'),
    ({"initial": {"rotation": {"axis": [0, 1, 0], "radians": 0.5}}},
     "initial.rotation: wanted { axis = [x, y, z], degrees = }, got { axis = [0, 1, 0], radians = 0.5 }, "
     'did you mean "degrees = 28.64788976"?'),
    ({"plane": [PLANE | {"friction": -0.1}]}, "plane[0].friction: wanted >= 0, got -0.1"),
    ({"plane": [PLANE, {"name": "b", "normal": [0, 0, 0]}]},
     "plane[1].normal: wanted a vector of length > 0 (in double precision: 1e-100 to 1e100), got [0, 0, 0]"),
    ({"plane": [PLANE | {"point": [0, math.inf, 0]}]}, "plane[0].point[1]: wanted a finite number (m), got inf"),
    ({"plane": [{"name": "my plane"}]},
     'plane[0].name: wanted a name of letters A-Z a-z, digits and underscores, no digit first, got "my plane", did you mean "my_plane"?'),
    ({"plane": [{}]}, "plane[0].name: wanted a name for the FMU's variables: letters, digits, underscores, got nothing"),
    ({"plane": PLANE}, 'plane: wanted tables, each under a head [[plane]] in double brackets, got { name = "ground" }'),
    *(({"plane": several}, "plane[0]: wanted a table, got 3") for several in ([3], {3}, np.array([3]))),
    ({"mass": [{"total": 1}]}, "mass: wanted one table under the head [mass] in single brackets, got [{ total = 1 }]"),
    ({"mesh": {}},
     "mesh.file: wanted a mesh file: OBJ, STL, PLY, GLB, glTF, OFF, COLLADA (.dae) or 3MF, relative to the scene file, got nothing"),
    ({"mesh": {"file": ""}}, 'mesh.file: wanted the name of a mesh file in quotes, got ""'),
    ({"outputs": {"energy": 1}}, "outputs.energy: wanted true or false, got 1"),
    ({"outputs": {"positions": "X+"}},
     'outputs.positions: wanted "all", "none", "x-", "x+", "y-", "y+", "z-" or "z+", got "X+", did you mean "x+"?'),
    ({"outputs": {"positions": "-z"}},
     'outputs.positions: wanted "all", "none", "x-", "x+", "y-", "y+", "z-" or "z+", got "-z", did you mean "z-"?'),
    ({"inputs": {"forces": 3}},
     'inputs.forces: wanted "all", "none", a face such as "z-", [[i, j, k], ...] or { i = [first, last] }, got 3'),
    ({"inputs": {"forces": [[0, 0]]}}, "inputs.forces[0]: wanted 3 whole numbers [i, j, k], got [0, 0]"),
    ({"inputs": {"forces": {"i": [2, 1]}}}, "inputs.forces.i: wanted [first, last] with first <= last, got [2, 1]"),
    ({"inputs": {"forces": {"x": [0, 1]}}}, 'inputs.forces.x: unknown key, wanted "i", "j" or "k"'),
    ({"title": 5}, "title: wanted text in quotes, got 5"),
    ({"title": "a\0b"}, 'title: wanted text without control characters, got "a\\u0000b"'),
    ({"experiment": {"stop_time": 10**400}}, f"experiment.stop_time: wanted a number (s), got 1{'0' * 66}..."),
    ({"lattice": {"points": [1 << 20_000, 4, 4]}}, f"lattice.points[0]: wanted <= 32, got 0x1{'0' * 64}..."),
]
# fmt: on


@pytest.mark.parametrize(("document", "line"), CASES, ids=[line.split(" ")[0] + str(n) for n, (_, line) in enumerate(CASES)])
def test_one_mistake_gives_one_line(document, line):
    assert problems(document) == [line]


def test_a_misspelt_key_does_not_hide_a_fault_of_the_right_one():
    found = problems({"plane": [{"nam": "a", "name": 3}]})
    assert len(found) == 2 and any(line.startswith("plane[0].name: wanted text") for line in found)


def test_tables_that_a_script_uses_twice_are_mended_one_by_one():
    shared = {}
    found = problems({"mesh": shared, "lattice": shared, "plane": [shared, shared]})
    assert [line.split(":")[0] for line in found] == ["mesh.file", "plane[0].name", "plane[1].name"]
    assert shared == {}


def test_numbers_and_arrays_of_numpy_are_numbers_and_lists():
    document = {"lattice": {"points": np.array([3, 4, 5]), "size": np.ones(3)}, "mass": {"total": np.float32(2)}, "plane": [PLANE]}
    scene = scene_from(document | {"outputs": {"positions": [[np.int64(0), 0, 0]]}})
    assert scene.lattice.points == (3, 4, 5) and scene.mass.total == 2.0


@pytest.mark.parametrize(
    "document, problem",
    [
        ({"pin": [{"name": "a", "points": {1: 2}}]}, 'pin[0].points.1: unknown key, wanted "i", "j" or "k"'),
        ({1: 2}, '1: unknown key, wanted "title"'),
        ({"lattice": {None: 2}}, "lattice.None: unknown key"),
        ({"plane": [{"name": "a", (1, 2): 3}]}, 'plane[0]."(1, 2)": unknown key'),
        ({"mesh": {"file": "x.obj", b"scale": 1}}, "mesh.\"b'scale'\": unknown key"),
        ({"<table>": 1}, '"<table>": unknown key, wanted "title", '),
        ({"material": {"<number>": 1}}, 'material."<number>": unknown key, wanted '),
    ],
)
def test_a_key_that_is_no_word_or_looks_like_a_tag_of_a_union_is_an_unknown_key(document, problem):
    with pytest.raises(SceneError) as refused:
        Scene.model_validate(document)
    assert refused.value.problems[0].startswith(problem)
