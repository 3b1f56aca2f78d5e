"""A plane or pin that inputs move has the inputs that its scene names; the rest of its pose and motion are parameters."""

import numpy as np
import pytest
from fmpy import read_model_description

from scenes import GRAVITY, LED, MOVED, box
from softffd import FmuError, Result, Scene, SceneError, Simulation, package_fmu, simulate
from softffd.fmu.component import Component
from softffd.fmu.package import write_folder
from softffd.obstacles import Obstacles
from softffd.show.stage import stage_of
from validation import shapes as bodies

POSES = {"plane": ("point", "normal", "velocity", "angular_velocity"), "pin": ("position", "orientation", "velocity", "angular_velocity")}
LID = {"name": "lid", "point": [0.1, 0.2, 1.3], "normal": [0.1, 0.0, -1.0], "velocity": [0.3, 0.0, 0.0], "motion": "input"}
ONE_WAY = ["point.z", "velocity.z"]


def names_of(section, causality, interface):
    """Of the part called `lid`, without its beginning."""
    begin = f"{section}.lid."
    return [name.removeprefix(begin) for name, v in interface.variables.items() if name.startswith(begin) and v.causality == causality]


def each(vector):
    return [f"{vector}.{c}" for c in ("wxyz" if vector == "orientation" else "xyz")]


def starts_of(component) -> dict[str, float]:
    """Of inputs and parameters that are Real, by name, as the description and the library have them."""
    described = {name: v.start for name, v in component.by_name.items() if v.causality in ("input", "parameter") and v.type == "Real"}
    assert dict(zip(described, component.block(list(described)).get(), strict=True)) == described
    return described


@pytest.mark.parametrize(
    "section, given, inputs",
    [
        ("plane", None, [*each("point"), *each("velocity")]),
        ("plane", ONE_WAY, ONE_WAY),
        ("plane", ["velocity.z", "normal", "point.z", "normal.x"], ["point.z", *each("normal"), "velocity.z"]),
        ("plane", list(POSES["plane"]), [name for vector in POSES["plane"] for name in each(vector)]),
        ("pin", None, [*each("position"), *each("velocity")]),
        ("pin", ["orientation.w", "position.x"], ["position.x", "orientation.w"]),
        ("pin", list(POSES["pin"]), [name for vector in POSES["pin"] for name in each(vector)]),
    ],
)
def test_what_the_scene_names_are_inputs_and_the_rest_are_parameters(section, given, inputs, tmp_path):
    part = {"name": "lid", "motion": "input"} | ({"points": "z-"} if section == "pin" else {}) | ({"inputs": given} if given else {})
    interface = write_folder(box(**{section: [part]}), tmp_path)
    assert names_of(section, "input", interface) == inputs
    rest = [name for vector in POSES[section] for name in each(vector) if name not in inputs]
    assert names_of(section, "parameter", interface) == rest + ["friction"] * (section == "plane")


def test_a_fixed_part_has_no_inputs(tmp_path):
    interface = write_folder(box(plane=[{"name": "lid"}], pin=[{"name": "lid", "points": "z-"}]), tmp_path)
    assert not names_of("pin", "input", interface) and not names_of("pin", "parameter", interface)


def test_starts_references_and_names_are_those_of_the_library():
    parts = {"plane": [LID | {"inputs": ONE_WAY}, {"name": "floor", "point": [0, 0, -0.5]}, {"name": "wall", **MOVED}]}
    pins = [
        {"name": "arm", "points": [[0, 0, 0]], "motion": "input", "inputs": ["orientation"]},
        {"name": "hand", "points": [[3, 3, 3]], **LED},
    ]
    with Component(box(**parts, pin=pins)) as component:
        component.set_up()
        described = starts_of(component)
        for number, name in enumerate(described):
            if name.startswith(("plane.", "pin.")) and not name.endswith("friction") and ".normal." not in name:
                component.set_start_values({name: 0.25 + number})
                with pytest.raises(FmuError, match=f"^.*{name.replace('.', '[.]')}: wanted a finite number"):
                    component.set_start_values({name: float("nan")})
                component.reset()
                component.set_up()


def test_parts_are_listed_in_the_order_of_the_scene_whatever_their_inputs():
    pins = [
        {"name": name, "points": [[n, 0, 0]], "motion": "input", "inputs": inputs}
        for n, (name, inputs) in enumerate({"c": ["orientation"], "a": ["position.x"], "b": ["velocity"]}.items())
    ]
    planes = [{"name": "lid"}, {"name": "floor", "motion": "input"}, {"name": "cap", **MOVED}]
    with Simulation(box(plane=planes, pin=pins, reactions=False)) as sim:
        assert list(sim.pin) == ["c", "a", "b"] and list(sim.plane) == ["lid", "floor", "cap"]


def drop(**plane):
    return box(stiffness=2e3, damping=0.1, gravity=GRAVITY, plane=[{"name": "ground", **plane}], offset=[0, 0, 0.05], stop_time=0.3)


def course(time):
    return {"plane.ground.point.z": 0.2 * time}


def test_a_plane_moves_by_its_inputs_as_one_of_which_all_are_inputs():
    start = {"normal": [0.1, 0.0, 1.0], "velocity": [0.5, 0.0, 0.0], "angular_velocity": [0.0, 0.2, 0.0]}
    driven = simulate(drop(motion="input", inputs=ONE_WAY, **start), inputs=course)
    given = {"plane.ground.velocity.x": 0.5, "plane.ground.velocity.y": 0.0, "plane.ground.velocity.z": 0.2}
    whole = simulate(drop(**MOVED, **start), inputs=lambda time: course(time) | given)
    assert list(driven.inputs) == ["plane.ground.point.z", "plane.ground.velocity.z"]
    np.testing.assert_allclose(driven.positions, whole.positions, rtol=0, atol=1e-12)
    for ours, theirs in zip(driven.plane("ground"), whole.plane("ground"), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_a_rate_of_a_point_leaves_the_velocities_that_are_parameters():
    """A belt that is lifted goes on running: as one whose velocity is an input."""
    ends = {}
    for inputs in (["point.z"], MOVED["inputs"]):
        with Simulation(drop(motion="input", inputs=inputs, velocity=[0.5, 0.0, 0.0])) as sim:
            for n in range(20):
                sim["plane.ground.point.z"] = 0.002 * n
                rates = {"plane.ground.point.z": 0.2} | ({"plane.ground.point.x": 0.5} if len(inputs) > 1 else {})
                sim.set_rates(rates)
                if len(inputs) > 1:
                    sim["plane.ground.point.x"] = 0.0
                sim.step(0.01)
            ends[len(inputs)] = sim.positions
            assert sim.plane["ground"].reaction[0] < -0.1
    np.testing.assert_array_equal(*ends.values())


def test_what_is_no_input_is_refused_with_what_makes_it_one(tmp_path):
    fmu = package_fmu(drop(motion="input"), tmp_path / "drop.fmu")
    with pytest.raises(
        FmuError, match=r"plane\.ground\.normal\.x: wanted an input of the FMU, got its fixed parameter .* `inputs` of a plane"
    ):
        simulate(fmu, inputs=lambda time: {"plane.ground.normal.x": time})


@pytest.mark.parametrize(
    "part, words",
    [
        (
            {"inputs": ["point.w"]},
            "plane[0].inputs: wanted a list of point, normal, velocity, angular_velocity or their components, such as",
        ),
        ({"inputs": ["velocty"]}, 'got ["velocty"], did you mean "velocity"'),
        ({"inputs": ["angular_velocity.zz"]}, 'did you mean "angular_velocity.z"'),
        ({"inputs": []}, "got []"),
        ({"inputs": "point"}, 'got "point"'),
    ],
)
def test_names_that_are_none_are_refused(part, words):
    with pytest.raises(SceneError) as refused:
        box(plane=[{"name": "lid", "motion": "input", **part}])
    assert words in str(refused.value)


def test_a_pin_has_names_of_its_own():
    with pytest.raises(SceneError, match=r"wanted a list of position, orientation, .* got .*point\.z"):
        box(pin=[{"name": "lid", "points": "z-", "motion": "input", "inputs": ["point.z"]}])


def beside_solids(folder) -> Scene:
    """A body above a plane, with a ball, a log and two boxes around."""
    mesh = {"file": bodies.write(folder / "body.obj", bodies.cube(2, 0.0))}
    turned = {"rotation": {"axis": [0, 0, 2], "degrees": 90.0}, "size": [1.0, 2.0, 3.0]}
    solids = {
        "sphere": [{"name": "ball", "radius": 1.0, "point": [0, 0, -9]}],
        "cylinder": [{"name": "log", "radius": 1.0, "length": 2.0, "point": [0, 0, -5], "normal": [0, 1, 0], "motion": "input"}],
        "box": [
            {"name": "crate", "point": [9, 0, 0], **turned, "motion": "input", "inputs": ["rotation.z", "point.x"]},
            {"name": "shelf", "point": [0, 9, 0], **turned},
        ],
    }
    return box(plane=[LID], mesh=mesh, lattice={"origin": [0, 0, 0], "size": [1, 1, 1]}, contact={"of": "surface"}, **solids)


def test_boxes_beside_other_obstacles_have_rotations_where_these_have_normals(tmp_path):
    """The library and the description agree on what each reference stands for."""
    with Component(beside_solids(tmp_path)) as component:
        component.set_up()
        described = starts_of(component)
        assert described["box.crate.rotation.z"] == described["box.shelf.rotation.z"] == pytest.approx(np.pi / 2)
        assert "box.crate.normal.z" not in described and "cylinder.log.rotation.z" not in described
        inputs = [name for name in described if component.by_name[name].causality == "input" and "crate" in name]
        assert inputs == ["box.crate.point.x", "box.crate.rotation.z"]


def test_obstacles_of_all_kinds_go_by_their_names(tmp_path):
    with Simulation(beside_solids(tmp_path)) as sim:
        assert [*sim.obstacle] == ["lid", "ball", "log", "crate", "shelf"] and [*sim.plane] == ["lid"]
        assert [repr(sim.obstacle[name]) for name in ("lid", "ball")] == ["<plane.lid>", "<sphere.ball>"]
        assert "sphere ball" in repr(sim) and "box crate, shelf" in repr(sim)
        sim.obstacle["log"].friction = 0.7
        assert sim["cylinder.log.friction"] == 0.7
        for path in ("sphere.ball", "cylinder.log", "box.crate"):  # the library calls them so too
            with pytest.raises(FmuError, match=rf"{path}\.friction: wanted >= 0, got -1"):
                sim[f"{path}.friction"] = -1
            sim.restart()
        with pytest.raises(FmuError, match='obstacle bal: there is no such obstacle, did you mean "ball"'):
            sim.obstacle["bal"]
        with pytest.raises(FmuError, match=r"plane\.ball\.point: the FMU has no such variable"):
            sim["plane.ball.point"]


def test_an_fmu_alone_knows_its_solids_and_says_what_they_are(tmp_path):
    """So that pictures of its runs, kept ones too, show them."""
    scene = beside_solids(tmp_path)
    fmu = package_fmu(scene, tmp_path / "solids.fmu")
    result = simulate(fmu, stop_time=0.1)
    assert result.scene is None and result.obstacles == Obstacles("surface", tuple(solid.shape() for solid in scene.solids))
    assert [solid.kind for solid in result.obstacles.solids] == ["sphere", "cylinder", "box", "box"]
    result.save(tmp_path / "run.npz")
    stage = stage_of(Result.load(tmp_path / "run.npz"))
    assert [solid.name for solid in stage.solids] == ["ball", "log", "crate", "shelf"]
    assert [plane.name for plane in stage.planes] == ["lid"]
    said = {v.name: v.description for v in read_model_description(fmu).modelVariables}
    assert said["sphere.ball.point.x"].startswith("Centre of the sphere ball of radius 1 m, x")
    assert said["sphere.ball.normal.x"].startswith("Has no effect on the sphere ball")
    assert said["cylinder.log.normal.x"].startswith("Axis of the cylinder log of radius 1 m and length 2 m")
    assert said["box.crate.point.x"].startswith("Centre of the box crate of 1 x 2 x 3 m at the communication point, x")
    assert said["plane.lid.normal.z"].startswith("Normal of the obstacle plane lid, out of the solid")
