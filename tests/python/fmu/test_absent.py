"""A variable that an FMU does not have: the message says what its scene needs for it."""

import pytest

from scenes import GRAVITY, box, meshed
from softffd import package_fmu, simulate, sweep
from softffd.cli.command import main
from softffd.errors import FmuError
from softffd.fmu.absent import SCENE_NEEDS
from softffd.fmu.component import Component
from validation import shapes

PIN = {"name": "base", "points": "z-"}
PROBE, SENSOR = {"name": "tip", "at": [0.5, 0.5, 1.0]}, {"name": "foot", "on": "z-"}
FREE = {"motion": "free", "mass": 1.0, "guide": [0.0, 0.0, 1.0]}
MOVED = {"pin": [PIN | FREE], "plane": [], "sensor": []}
NO_PIN = 'a [[pin]] with name = "base" and '
BARE = {
    "damping": 0.0, "outputs": {"positions": "none"}, "plane": [{"name": "ground"}], "pin": [PIN], "probe": [PROBE], "sensor": [SENSOR],
}  # fmt: skip
"""A scene with as few variables as may be"""
CASES = {
    "force[1,0,0].x": ("[inputs] forces with this control point", {"forces": "all"}),
    "position[1,0,0].x": ("[outputs] positions with this control point", {"outputs": {"positions": "all"}}),
    "velocity[1,0,0]": ("[outputs] velocities with this control point", {"velocities": "all"}),
    "pin.base.position.z": ('motion = "input" of the pin', {"pin": [PIN | {"motion": "input"}]}),
    "pin.base.mass": (f'{NO_PIN}motion = "free" of the part', MOVED),
    "pin.base.reaction_torque": (f'{NO_PIN}motion = "free" of the part and [outputs] reactions = true', MOVED | {"reactions": True}),
    "probe.tip.velocity.x": ("velocity = true of the probe", {"probe": [PROBE | {"velocity": True}]}),
    "probe.tip.acceleration": ("acceleration = true of the probe", {"probe": [PROBE | {"acceleration": True}]}),
    "sensor.foot.taxel[0,0].z": ("taxels of the sensor", {"sensor": [SENSOR | {"taxels": [2, 2]}]}),
    "plane.ground.reaction": ("[outputs] reactions = true", {"reactions": True}),
    "pin.base.torque.x": (f"{NO_PIN}[outputs] reactions = true", {"reactions": True}),
    "youngs_modulus": ("[material] youngs_modulus in place of stiffness", {"material": {"youngs_modulus": 1e5}}),
    "poissons_ratio": ('[material] model = "solid"', {"material": {"model": "solid", "youngs_modulus": 1e5}}),
    "damping": ("[material] damping above 0", {"damping": 0.1}),
    "internal_damping": ("[material] internal_damping above 0", {"internal_damping": 0.1}),
    "gravity": ("[environment] gravity", {"gravity": GRAVITY}),
    "initial.rotation.x": ("[initial] rotation", {"rotation": {"axis": [0, 0, 1], "degrees": 10}}),
    "energy.kinetic": ("[outputs] energy = true", {"energy": True}),
    "energy": ("[outputs] energy = true", {"energy": True}),
    "energy.gravity": ("[outputs] energy = true and [environment] gravity", {"energy": True, "gravity": GRAVITY}),
    "solver.steps": ("[outputs] solver = true", {"outputs": {"solver": True}}),
    "solver.error_estimate": ("[solver] error_estimate = true", {"error_estimate": True}),
}


def hint(name, **keys):
    scene = box(**{**BARE, "reactions": name == "pin.base.position.z", **keys})
    with Component(scene, running=False) as component:
        there = [each for each in component.by_name if each.startswith(name)]
        return component.hint(name), there


@pytest.mark.parametrize("name", CASES)
def test_the_scene_needs_what_then_brings_it(name):
    needed, keys = CASES[name]
    assert hint(name) == (f": its scene needs {needed} for it", [])
    assert hint(name, **keys)[1]


def test_a_stiffness_is_that_of_springs_without_a_modulus():
    said, there = hint("stiffness", material={"youngs_modulus": 1e5, "damping": 0.0})
    assert (said, there) == (": its scene needs [material] stiffness in place of youngs_modulus for it", [])


def test_a_body_on_a_guide_has_no_spin_to_start_with(tmp_path):
    scene = meshed(tmp_path, shapes.cube(2, 0.1), sphere=[{"name": "ball", "radius": 0.1, "point": [0.0, 0.0, 9.0], **FREE}])
    with Component(scene, running=False) as component:
        hint = component.hint("sphere.ball.start_angular_velocity")
    assert hint == ': its scene needs motion = "free" of the part, without a guide for it'


def test_every_need_is_seen():
    elsewhere = {"[material] stiffness in place of youngs_modulus", 'motion = "free" of the part, without a guide'}
    assert {needed.removeprefix(NO_PIN) for needed, _ in CASES.values()} | elsewhere >= set(SCENE_NEEDS.values())


A_KEY = "; it is a key of the scene and no variable: set "


@pytest.mark.parametrize(
    "name, said",
    [
        *[(name, f"{A_KEY}volume_stiffness in [material] of the scene") for name in ("volume_stiffness", "material.volume_stiffness")],
        ("most_work", f"{A_KEY}most_work in [solver] of the scene"),
        ("load.push.x", ': its scene needs a [[load]] with name = "push" for it'),
        ("plane.groun.friction", ', did you mean "plane.ground.friction"?'),
        ("tolerance", ', did you mean "solver.tolerance"?'),
        ("stiffness", "; it has stiffness.edge, stiffness.face, stiffness.body"),
        ("plane.ground.point", "; it has plane.ground.point.x, plane.ground.point.y, plane.ground.point.z"),
        ("nothing", ""),
    ],
)
def test_other_names_are_keys_parts_or_misspelt(name, said):
    assert hint(name)[0] == said


def test_a_control_point_that_is_not_there_has_a_near_one():
    assert hint("position[9,0,0].x", outputs={"positions": "all"})[0].startswith(', did you mean "position[')


def test_whoever_asks_is_told(tmp_path, capsys):
    scene = box(**BARE)
    needs = r"its scene needs \[material\] damping above 0"
    for ask, words in (
        (lambda: simulate(scene, start_values={"damping": 1}), needs),
        (lambda: simulate(scene, inputs={"damping": 1}), needs),
        (lambda: sweep(scene, {"damping": [1, 2]}), needs),
        (lambda: simulate(scene, output=["energy"]), r"its scene needs \[outputs\] energy = true"),
        (lambda: sweep(scene, {"mass": [1]}, outputs="energy.kinetic"), r"its scene needs \[outputs\] energy = true"),
    ):
        with pytest.raises(FmuError, match=words):
            ask()
    fmu = package_fmu(scene, tmp_path / "bare.fmu")
    assert main(["run", str(fmu), "--set", "volume_stiffness=1"]) == 1
    assert "set volume_stiffness in [material] of the scene" in capsys.readouterr().err
