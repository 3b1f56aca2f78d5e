"""The problems between keys, and those of the mesh; found beside all others in one go."""

import re

import pytest

from scenes import TETRAHEDRON, problems
from softffd.scene.scene import scene_from

FLAT = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
LOW = TETRAHEDRON.replace("v 0 0 4", "v 0 0 0.01")
TWO = {
    "plane": [{}, {}],
    "pin": [{"points": [[0, 0, 0]]}, {"points": [[1, 0, 0]]}],
    "load": [{"points": "x+"}] * 2,
    "probe": [{"at": [0, 0, 0]}] * 2,
}
RUBBER = {"youngs_modulus": 1e6}
CUBE = {"i": [0, 1], "j": [0, 1], "k": [0, 1]}
SPRINGS = {"edge": 1.0, "face": 2.0, "body": 3.0}
HOLDS = "lattice.size: wanted a box that holds the mesh ([0, 0, 0] to [2, 1, 4] m), got "
FOLLOWS = ": the box then follows the mesh"
NO_LONGER = (
    "wanted nearly cubic cells, for springs of a given modulus: one long side at most 1.22 times the other two, or two long sides at most "
    "1.41 times the third; got cells of "
)
ON_SURFACE = {"mesh": {"file": "closed.obj"}, "plane": [{"name": "ground"}], "contact": {"of": "surface"}}
METHODS = 'wanted "auto", "leapfrog", "bm4", "rkn12", "dop853", "ros34pw2"'


def mesh(name, **document):
    return {"mesh": {"file": f"{name}.obj"}} | document


def mass(**keys):
    return {"mass": keys}


def lattice(**keys):
    return {"lattice": keys}


def rubber(**document):
    return {"material": RUBBER} | document


def region(**keys):
    return {"region": [{"points": "all", **keys}]}


# fmt: off
REFUSED = [
    *(({section: [item | {"name": "same"} for item in items]},
       f'{section}[1].name: wanted a unique name, got "same", already the name of {section}[0]') for section, items in TWO.items()),
    *(({section: [{"name": "a", "points": points}]}, f"{section}[0].points: wanted at least one control point, got {got}")
      for section in ("pin", "load") for points, got in (("none", '"none"'), ([], "[]"))),
    ({"pin": [{"name": "a", "points": "x-"}, {"name": "b", "points": "z-"}]},
     "pin[1].points: wanted control points that no other pin holds, got [0, 0, 0] and 3 more, held by pin[0] too"),
    ({"plane": [{"name": "a", "inputs": ["normal"]}]},
     'plane[0].inputs: wanted none with motion = "fixed", got ["normal"]; they need motion = "input"'),
    # mass
    (mesh("closed") | mass(total=3, density=5), "mass: wanted total or density, got total = 3 and density = 5"),
    *((mass(distribution=word), f'mass.distribution: "{word}" needs a {kind}, but the scene has no [mesh]')
      for word, kind in (("volume", "closed mesh"), ("surface", "mesh"), ("vertices", "mesh"))),
    *((mesh("open") | mass(**{key: value}),
       f"mass.{key}: {got} needs a closed mesh, but open.obj is open (holes in its surface, or faces turned inside out); {instead} instead")
      for key, value, got, instead in (("density", 5.0, "5.0", 'give "total"'), ("distribution", "volume", '"volume"', 'take "surface"'))),
    (mass(distribution="box", uniform_share=0.2),
     'mass.uniform_share: wanted 0 with distribution = "box", which leaves no point without mass, got 0.2'),
    (mass(inertia="matched") | lattice(points=[2, 4, 4]),
     'mass.inertia: "matched" wants 3 control points or more along each axis, got [2, 4, 4]; take "lumped" instead'),
    (mass(inertia="matched") | region(mass=2.0),
     'region[0].mass: wanted none beside mass.inertia = "matched", which chooses the masses, got 2'),
    # the box and its mesh
    (mesh("flat"), "mesh.file: ...flat along z..."),
    (mesh("missing", probe=[{"name": "p", "at": [9, 9, 9]}]) | mass(density=1.0), "mesh.file: ...missing.obj..."),
    (mesh("closed") | lattice(size=[2, 1, 3.9]),
     f"{HOLDS}[0, 0, 0] to [2, 1, 3.9] m, which does not along z; leave out size{FOLLOWS}"),
    (mesh("closed") | lattice(origin=[0, 0, 1], size=[2, 1, 4]),
     f"{HOLDS}[0, 0, 1] to [2, 1, 5] m, which does not along z; leave out origin and size{FOLLOWS}"),
    (lattice(margin=0.1), "lattice.margin: wanted 0, because there is no [mesh] to enlarge, got 0.1"),
    (mesh("closed") | lattice(origin=[0, 0, 0], size=[2, 1, 4], margin=0.1),
     "lattice.margin: wanted 0, because origin and size are both given, got 0.1"),
    ({"probe": [{"name": "in", "at": [1, 0, 0.5]}, {"name": "out", "at": [0.5, 0.5, 1.001]}]},
     "probe[1].at: wanted a position in the box [0, 0, 0] to [1, 1, 1] m, got [0.5, 0.5, 1.001]"),
    *((lattice(**box), "lattice: wanted control points that differ along x, got origin...")
      for box in ({"origin": [1e20, 0, 0], "size": [1, 1, 1]}, {"origin": [1.7e308, 0, 0], "size": [1.7e308, 1, 1]},
                  {"size": [1e300, 1, 1]}, {"size": [1e-142, 1, 1]})),
    # control points
    (lattice(points=[3, 3, 3], cells=2), "lattice: wanted points or cells, got points = [3, 3, 3] and cells = 2"),
    (lattice(cells=2, spacing=0.5), "lattice: wanted cells or spacing, got cells = 2 and spacing = 0.5"),
    (lattice(points="cubic"), 'lattice.points: wanted cells or spacing beside "cubic", got neither'),
    (lattice(points="cubik", cells=3), 'lattice.points: wanted "cubic", got "cubik", did you mean "cubic"?'),
    (lattice(cells=32), "lattice.cells: wanted <= 31, got 32"),
    (lattice(cells=0), "lattice.cells: wanted >= 1, got 0"),
    (lattice(spacing=0.0), "lattice.spacing: wanted > 0 m, got 0.0"),
    (lattice(spacing=1e-9), "lattice.spacing: wanted >= 0.0323 m, because a side has at most 31 cells, got 1e-09"),
    (lattice(points="cubic", cells=99), "lattice.cells: wanted <= 31, got 99"),
    # material
    (rubber(material=RUBBER | {"stiffness": 2e3}),
     "material: wanted stiffness or youngs_modulus, got stiffness = 2000 and youngs_modulus = 1e+06"),
    (rubber(material=RUBBER | {"stiffness": SPRINGS}),
     "material: wanted stiffness or youngs_modulus, got stiffness = { edge = 1.0, face = 2.0, body = 3.0 } and youngs_modulus = 1e+06"),
    (region(youngs_modulus=1.0) | {"material": {"youngs_modulus": 0}}, "material.youngs_modulus: wanted > 0 Pa, got 0"),
    ({"material": {"internal_damping": -1}}, "material.internal_damping: wanted >= 0 s, got -1"),
    (rubber(lattice={"springs": "paper"}), 'lattice.springs: wanted "distinct", as springs of a youngs_modulus are, got "paper"'),
    (rubber() | region(stiffness=4e3), "region[0].stiffness: wanted youngs_modulus, because the material has one, got stiffness = 4000"),
    (region(youngs_modulus=4e3), "region[0].youngs_modulus: wanted stiffness, because the material has one, got youngs_modulus = 4000"),
    (region(density=200.0),
     'region[0].density: wanted no density without mass.distribution = "box", got 200 with "uniform"'),
    *((rubber(region=[{"points": "z-", key: 1e3}]),
       f'region[0].points: wanted all eight corners of one cell at least, in which {key} would hold, got "z-"')
      for key in ("youngs_modulus", "internal_damping", "density")),
    (rubber(lattice={"size": [0.3, 0.3, 1.2]}),
     f"lattice.points: {NO_LONGER}0.1 x 0.1 x 0.4 m; points = [4, 4, 13] gives 0.1 x 0.1 x 0.1"),
    (rubber(lattice={"size": [1.0, 1.0, 0.05], "cells": 3}), "lattice.cells: ...cells = 15 gives..."),
    (rubber(lattice={"size": [1.0, 1.0, 0.05], "spacing": 0.2}), "lattice.spacing: ...spacing = 0.06667 gives..."),
    (mesh("low") | rubber(), "...; the box is too flat or too long for nearly cubic ones, of which a side has at most 31"),
    # contact
    (ON_SURFACE | {"solver": {"method": "central_difference"}},
     f'solver.method: {METHODS}, "backward_euler" or "sdirk2" with contact.of = "surface", got "central_difference"'),
    (ON_SURFACE | {"contact": {"of": "lattice", "penetration": 0.01}},
     'contact.penetration: wanted none with of = "lattice", got 0.01; it needs of = "surface"'),
    ({"contact": {"of": "surface"}}, 'contact.of: "surface" needs a mesh, but the scene has no [mesh]; take "lattice" instead'),
    ({"contact": {"of": "surface"}, "sphere": [{"name": "ball", "radius": 1.0}]},
     'contact.of: "surface" needs a mesh, but the scene has no [mesh]; add one, which the [[sphere]] needs too'),
    ({"sphere": [{"name": "ball", "radius": 1.0}]},
     'contact.of: "lattice" supports only planes, but the scene has a [[sphere]]; take "surface", which needs a [mesh]'),
    (ON_SURFACE | {"contact": {"of": "surfaces"}}, 'contact.of: wanted "surface" or "lattice", got "surfaces", did you mean "surface"?'),
    # what nobody gave is not blamed
    (lattice(points=[4, 4, 99]) | {"inputs": {"forces": [[0, 0, 50]]}}, "lattice.points[2]: wanted <= 32, got 99"),
    (lattice(cells=0) | {"inputs": {"forces": [[9, 0, 0]]}}, "lattice.cells: wanted >= 1, got 0"),
    (lattice(size=[0, 1, 1]) | {"probe": [{"name": "p", "at": [5, 5, 5]}]}, "lattice.size[0]: wanted > 0 m, got 0"),
    ({"plane": [{"name": "ground"}, {"nam": "a"}]}, 'plane[1].nam: unknown key, did you mean "name"?'),
]
ALLOWED = [
    *({"lattice": {"points": points}, "solver": {"method": method}}
      for points in ([8, 8, 8], [9, 9, 8], [2, 32, 32], [32, 32, 32]) for method in ("ros34pw2", "backward_euler", "sdirk2")),
    *(lattice(points=[32, 32, 32], basis=basis) for basis in ("bezier", "bspline")),
    {"plane": [{"name": "a"}], "load": [{"name": "a", "points": "all"}]},
    {"region": [{"points": "none"}]},
    mesh("open") | mass(distribution="surface"),
    {key: value for key, value in ON_SURFACE.items() if key != "plane"} | {"solver": {"method": "central_difference"}},  # nothing is met
    *(rubber(region=[{"points": CUBE, key: 1e3}]) for key in ("youngs_modulus", "internal_damping", "density")),
    {"region": [{"points": "z-", "internal_damping": 1e-3}]},
    rubber(lattice={"size": [0.3, 0.3, 1.2], "points": [4, 4, 13]}),
    lattice(size=[0.3, 0.3, 1.2]),
]
# fmt: on


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("checks")
    for name, text in {"closed": TETRAHEDRON, "open": TETRAHEDRON.removesuffix("f 2 3 4\n"), "flat": FLAT, "low": LOW}.items():
        (folder / f"{name}.obj").write_text(text)
    return folder


@pytest.mark.parametrize(("document", "line"), REFUSED, ids=[line[:40] for _, line in REFUSED])
def test_keys_that_do_not_go_together_are_one_problem(document, line, folder):
    (found,) = problems(document, folder / "scene.toml")
    assert re.fullmatch(".*".join(map(re.escape, line.split("..."))), found), found


@pytest.mark.parametrize("document", ALLOWED, ids=str)
def test_what_is_allowed_is_a_scene(document, folder):
    scene = scene_from(document, path=folder / "scene.toml")
    assert len(scene.rest_positions()) == scene.lattice.points[0] * scene.lattice.points[1] * scene.lattice.points[2]
    assert scene.contact.of == ("surface" if "contact" in document or "mesh" in document else "lattice")


def test_a_sphere_that_looks_alike_from_all_sides_has_no_normal_to_move():
    found = problems({"sphere": [{"name": "ball", "radius": 1.0, "motion": "input", "inputs": ["point", "normal"]}]})
    wanted = 'wanted a list of point, velocity, angular_velocity or their components, such as "point.z"'
    assert found[0] == f'sphere[0].inputs: {wanted}, got ["point", "normal"]'


def test_a_selection_outside_the_lattice_is_refused_wherever_it_stands():
    outside = {"points": [[4, 0, 0]]}
    parts = {section: [{"name": "a", **outside}] for section in ("pin", "load")} | {"region": [outside]}
    selections = {"inputs": {"forces": [[4, 0, 0]]}, "outputs": {"positions": [[4, 0, 0]], "velocities": {"k": [0, 7]}}}
    lines = problems(parts | selections)
    wanted = "wanted control points of the 4 x 4 x 4 lattice (i 0..3, j 0..3, k 0..3), got "
    assert len(lines) == 6 and all(wanted in line for line in lines)
    assert lines[-1].endswith("got k = [0, 7]")


def test_all_problems_come_at_once_in_the_order_of_the_file_also_beside_faulty_values():
    document = {
        "solver": {"step": -1},
        "titel": "x",
        "lattice": {"points": [4, 3, 3], "size": [1, -1, 1], "basis": "splines"},
        "material": {"damping": -1, "stifness": 3},
        "plane": [{"name": "a", "normal": [0, 0, 0]}, {"name": "a", "frction": 0.1}],
        "pin": [{"name": "b", "points": "z-"}, {"points": [[0, 0, 0], [0, 3, 0]]}],
        "load": [{"name": "l", "points": "none"}],
        "probe": [{"name": "p", "at": [9, 9, 9]}],
        "mass": {"total": -1},
    }
    assert " ".join(line.split(": ")[0] for line in problems(document)) == (
        "solver.step titel lattice.size[1] lattice.basis material.damping material.stifness plane[0].normal plane[1].frction "
        "plane[1].name pin[1].name pin[1].points load[0].points mass.total"
    )
