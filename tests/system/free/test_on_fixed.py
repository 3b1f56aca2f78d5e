"""Free obstacles on fixed and moved ones, the object being elsewhere or between them: they rest, slide, roll, tip and are carried as rigid
bodies do, in explicit steps and in implicit ones."""

from typing import Any

import numpy as np
import pytest

from rigid import G, fall_over, slide
from scenes import GRAVITY, meshed
from softffd import Simulation, simulate
from softffd.rotation import matrices
from textbook import TOLERANCE
from validation import shapes

SIDE = 0.2
"""m, of the object"""
MATERIALS = {"explicit": {"stiffness": 1e4, "damping": 0.0}, "implicit": {"stiffness": 1e5, "internal_damping": 1e-3}}
FRICTION = 0.4
RAILS = [{"name": f"rail{i}", "size": [0.1, 2.0, 0.1], "point": [x, 0.0, -0.05], "friction": FRICTION} for i, x in enumerate((-0.2, 0.2))]
"""Boxes along y, whose tops are z = 0"""
FLOOR = {"name": "floor", "friction": FRICTION}
WAYS = [(material, step) for material in MATERIALS for step in (0.01, 0.1)]


def beside(folder, material, step, *, kind: str, body: dict[str, Any], **keys: Any):
    """What a free body of 1 kg does where the object, which is held 5 m from it, does not touch it."""
    vertices, faces = shapes.cube(4, 0.0)
    origin = np.array([-5.0, 0.0, 0.0])
    free = {"name": "free", "motion": "free", "mass": 1.0, "friction": 0.0, **body}
    scene = meshed(
        folder, (vertices * SIDE + origin, faces), mass={"total": 1.0}, points=[4, 4, 4], reactions=True, energy=True, stop_time=0.6,
        lattice={"origin": origin.tolist(), "size": [SIDE] * 3}, pin=[{"name": "held", "points": "z-"}], material=MATERIALS[material],
        gravity=keys.pop("gravity", GRAVITY), communication_step=step, **{kind: [*keys.pop(kind, []), free]}, **keys,
    )  # fmt: skip
    result = simulate(scene)
    assert not result.summary["warnings"]
    return result


def axis(result, name: str, kind: str = "box") -> Any:
    return result.outputs[f"{kind}.free.{name}"]


@pytest.mark.short("explicit-0.01", "implicit-0.1")
@pytest.mark.parametrize(("material", "step"), WAYS)
def test_a_box_falls_on_the_floor_and_rests(material, step, tmp_path):
    result = beside(tmp_path, material, step, kind="box", body={"size": [0.1] * 3, "point": [0.0, 0.0, 0.1]}, plane=[FLOOR])
    height = 0.05 + np.maximum(0.05 - 0.5 * G * result.time**2, 0.0)
    assert axis(result, "position.z") == pytest.approx(height, abs=10 * TOLERANCE * SIDE)
    assert axis(result, "position.z")[-1] == pytest.approx(0.05, abs=1e-11)
    assert result.outputs["plane.floor.reaction.z"][-1] == pytest.approx(-G, rel=1e-6)
    assert axis(result, "reaction.z")[-1] == 0.0  # that is the object's alone
    assert result.outputs["energy.dissipated"][-1] == pytest.approx(0.05 * G, rel=1e-3)


@pytest.mark.short("explicit-0.01-0.4", "implicit-0.1-0.45")
@pytest.mark.parametrize("friction", [0.4, 0.38, 0.42, 0.35, 0.45])
@pytest.mark.parametrize(("material", "step"), WAYS)
def test_a_box_slides_until_it_stops(friction, material, step, tmp_path):
    body = {"size": [0.1] * 3, "point": [0.0, 0.0, 0.05], "velocity": [1.0, 0.0, 0.0]}
    result = beside(tmp_path, material, step, kind="box", body=body, plane=[FLOOR | {"friction": friction}])
    way = slide(result.time, speed=1.0, grip=friction * G, push=0.0)
    assert axis(result, "position.x") == pytest.approx(way, abs=10 * TOLERANCE * SIDE)
    assert result.outputs["plane.floor.reaction.x"][1] == pytest.approx(friction * G, rel=1e-3)


@pytest.mark.parametrize(("material", "step"), WAYS)
def test_a_belt_takes_a_box_along(material, step, tmp_path):
    belt = FLOOR | {"motion": "input", "inputs": ["velocity"], "velocity": [1.0, 0.0, 0.0]}
    result = beside(tmp_path, material, step, kind="box", body={"size": [0.1] * 3, "point": [0.0, 0.0, 0.05]}, plane=[belt])
    slipped = slide(result.time, speed=1.0, grip=FRICTION * G, push=0.0)
    assert axis(result, "position.x") == pytest.approx(result.time - slipped, abs=10 * TOLERANCE * SIDE)
    given = 0.5 + 0.5  # to the box, and to friction
    assert result.outputs["energy.work"][-1] == pytest.approx(given, rel=2e-3)


@pytest.mark.short("explicit-0.01", "implicit-0.1")
@pytest.mark.parametrize(("material", "step"), WAYS)
def test_a_ball_and_a_roller_begin_to_roll(material, step, tmp_path):
    """From slipping on; then 5/7 and 2/3 of the speed are left."""
    for kind, body, left in (("sphere", {}, 5 / 7), ("cylinder", {"length": 0.3, "normal": [0.0, 1.0, 0.0]}, 2 / 3)):
        start = {"radius": 0.1, "point": [0.0, 0.0, 0.1], "velocity": [0.5, 0.0, 0.0], **body}
        result = beside(tmp_path, material, step, kind=kind, body=start, plane=[FLOOR])
        until = 0.5 * (1 - left) / (FRICTION * G)
        way = np.where(result.time < until, 0.5 * result.time - 0.5 * FRICTION * G * result.time**2, 0.0)
        rolls = 0.5 * until - 0.5 * FRICTION * G * until**2 + 0.5 * left * (result.time - until)
        way = np.where(result.time < until, way, rolls)
        assert axis(result, "position.x", kind) == pytest.approx(way, abs=10 * TOLERANCE * SIDE)
        assert axis(result, "angular_velocity.y", kind)[-1] == pytest.approx(0.5 * left / 0.1, rel=1e-3)
        assert axis(result, "position.z", kind) == pytest.approx(0.1, abs=1e-8)


@pytest.mark.short("implicit")
@pytest.mark.parametrize(("material", "step"), [("implicit", 0.1), ("explicit", 0.01)], ids=["implicit", "explicit"])
def test_a_box_on_a_slope_hardly_creeps(material, step, tmp_path):
    """In a step by less than a millionth of what its weight would move it by."""
    lean = np.radians(15)
    gravity = [G * np.sin(lean), 0.0, -G * np.cos(lean)]
    body = {"size": [0.1] * 3, "point": [0.0, 0.0, 0.05]}
    result = beside(tmp_path, material, step, kind="box", body=body, plane=[FLOOR], gravity=gravity, outputs={"solver": True})
    later = slice(len(result.time) // 2, None)
    steps, way = (np.ptp(result.outputs[name][later]) for name in ("solver.steps", "box.free.position.x"))
    assert 0 < way < 1e-6 * 0.5 * G * np.ptp(result.time[later]) ** 2 / steps


STANDS = {
    "drum on rails": ("cylinder", {"radius": 0.3, "length": 0.1, "point": [0.0, 0.0, 0.08]}, {"box": RAILS}, 0.05),
    "roller on rails": (
        "cylinder", {"radius": 0.1, "length": 0.8, "normal": [1.0, 0.0, 0.0], "point": [0.0, 0.0, 0.12]}, {"box": RAILS}, 0.1,
    ),
    "ball in a groove": ("sphere", {"radius": 0.25, "point": [0.0, 0.0, 0.22]}, {"box": RAILS}, 0.2),
    "plank on rails": ("box", {"size": [1.0, 0.1, 0.1], "point": [0.02, 0.0, 0.07]}, {"box": RAILS}, 0.05),
    "plate on a post": (
        "box", {"size": [1.0, 1.0, 0.1], "point": [0.02, 0.0, 0.07]},
        {"cylinder": [{"name": "post", "radius": 0.1, "length": 0.5, "point": [0.0, 0.0, -0.25], "friction": FRICTION}]}, 0.05,
    ),
    "plate on a block": (
        "box", {"size": [1.0, 1.0, 0.1], "point": [0.02, 0.0, 0.07]},
        {"box": [{"name": "block", "size": [0.2, 0.2, 0.2], "point": [0.0, 0.0, -0.1], "friction": FRICTION}]}, 0.05,
    ),
    "ball on a ball's top": (
        "sphere", {"radius": 0.1, "point": [0.0, 0.0, 0.12], "guide": [0.0, 0.0, 1.0]},
        {"sphere": [{"name": "other", "radius": 0.3, "point": [0.0, 0.0, -0.3]}]}, 0.1,
    ),
}  # fmt: skip


@pytest.mark.short("implicit-0.1-*on rails", "explicit-0.01-plate on*")
@pytest.mark.parametrize("case", STANDS)
@pytest.mark.parametrize(("material", "step"), WAYS)
def test_it_stands_on_whatever_part_of_it_is_below(case, material, step, tmp_path):
    kind, body, keys, height = STANDS[case]
    result = beside(tmp_path, material, step, kind=kind, body=body, **keys)
    assert axis(result, "position.z", kind)[-1] == pytest.approx(height, abs=1e-7)
    pressed = sum(
        each[-1] for name, each in result.outputs.items() if name.endswith(".reaction.z") and ".free" not in name and "pin" not in name
    )
    assert pressed == pytest.approx(-G, rel=1e-5)


SLENDER = [0.2, 0.2, 0.4]
"""m"""


@pytest.mark.short("explicit-0.01-4.0", "implicit-0.1-4.0")
@pytest.mark.parametrize("past", [-2.0, 2.0, 4.0])
@pytest.mark.parametrize(("material", "step"), WAYS)
def test_a_box_that_leans_falls_over_its_edge_or_back(past, material, step, tmp_path):
    balance = np.degrees(np.arctan2(SLENDER[0], SLENDER[2]))
    lean = np.radians(balance + past)
    edge = np.array([SLENDER[0] / 2, 0.0, -SLENDER[2] / 2])
    turn = np.array([[np.cos(lean), 0.0, np.sin(lean)], [0.0, 1.0, 0.0], [-np.sin(lean), 0.0, np.cos(lean)]])
    body = {"size": SLENDER, "point": (-turn @ edge).tolist(), "rotation": {"axis": [0.0, 1.0, 0.0], "degrees": float(np.degrees(lean))}}
    result = beside(tmp_path, material, step, kind="box", body=body, plane=[FLOOR | {"friction": 1.5}])
    turns = matrices(np.stack([axis(result, f"orientation.{c}") for c in "wxyz"], axis=1))
    angle = np.arctan2(turns[:, 0, 2], turns[:, 2, 2])
    arm = np.hypot(*edge[[0, 2]])
    inertia = arm**2 + (SLENDER[0] ** 2 + SLENDER[2] ** 2) / 12
    falls = result.time <= 0.4
    fallen = fall_over(result.time[falls], lean=np.radians(abs(past)), arm=arm, inertia=inertia)
    assert angle[falls] == pytest.approx(np.radians(balance) + np.copysign(fallen, past), abs=10 * TOLERANCE * SIDE / arm)


@pytest.mark.short("0.01")
@pytest.mark.parametrize("step", [0.01, 0.001])
def test_a_weight_that_presses_a_pad_on_to_stops_rests_on_all(step, tmp_path):
    """What the pad does not carry, pressed by 6 mm, the stops do."""
    vertices, faces = shapes.cube(4, 0.0)
    stops = [{"name": f"stop{i}", "size": [0.1, 0.4, 0.2], "point": [x, 0.1, 0.094]} for i, x in enumerate((-0.1, 0.3))]
    weight = {"name": "free", "motion": "free", "mass": 20.0, "size": [0.6, 0.3, 0.05], "point": [0.1, 0.1, 0.235]}
    scene = meshed(
        tmp_path, (vertices * SIDE, faces), gravity=GRAVITY, mass={"total": 1.0}, points=[4, 4, 4], reactions=True, stop_time=0.5,
        lattice={"size": [SIDE] * 3}, pin=[{"name": "held", "points": "z-"}], communication_step=step, box=[*stops, weight],
        material={"model": "solid", "youngs_modulus": 5e4, "poissons_ratio": 0.3, "internal_damping": 1e-2},
    )  # fmt: skip
    result = simulate(scene)
    assert axis(result, "position.z")[-1] == pytest.approx(0.219, abs=1e-8)
    left, right, pad = (result.outputs[f"box.{name}.reaction.z"][-1] for name in ("stop0", "stop1", "free"))
    assert left + right == pytest.approx(pad - 20 * G, rel=1e-4)
    assert max(left, right) < -0.1 * 20 * G
    assert 0.5 * 20 * G > pad > 0.1 * 20 * G


@pytest.mark.parametrize("step", [0.01, 0.001])
def test_a_floor_that_jumps_up_takes_a_box_with_it(step, tmp_path):
    """Without a velocity, as it does the object."""
    floor = FLOOR | {"motion": "input", "inputs": ["point"]}
    vertices, faces = shapes.cube(4, 0.0)
    free = {"name": "free", "motion": "free", "mass": 1.0, "size": [0.1] * 3, "point": [0.5, 0.0, 0.05]}
    scene = meshed(
        tmp_path, (vertices * SIDE + [0.0, 0.0, 1.0], faces), gravity=GRAVITY, mass={"total": 1.0}, points=[4, 4, 4], stop_time=0.1,
        lattice={"origin": [0.0, 0.0, 1.0], "size": [SIDE] * 3}, pin=[{"name": "held", "points": "z-"}], communication_step=step,
        material=MATERIALS["implicit"], box=[free], plane=[floor],
    )  # fmt: skip
    result = simulate(scene, inputs=lambda t: {"plane.floor.point.z": 0.01 if t > 0.05 else 0.0})
    assert axis(result, "position.z")[-1] == pytest.approx(0.06, abs=1e-9)
    assert axis(result, "velocity.z")[-1] == pytest.approx(0.0, abs=1e-8)


@pytest.mark.short("implicit")
@pytest.mark.parametrize("material", MATERIALS)
def test_a_state_continues_with_the_same_bits(material, tmp_path):
    """A box that slides on a floor, from a moment in which it does."""
    vertices, faces = shapes.cube(4, 0.0)
    free = {"name": "free", "motion": "free", "mass": 1.0, "size": [0.1] * 3, "point": [0.5, 0.0, 0.06], "velocity": [1.0, 0.2, 0.0]}
    scene = meshed(
        tmp_path, (vertices * SIDE + [0.0, 0.0, 1.0], faces), gravity=GRAVITY, mass={"total": 1.0}, points=[4, 4, 4], box=[free],
        lattice={"origin": [0.0, 0.0, 1.0], "size": [SIDE] * 3}, pin=[{"name": "held", "points": "z-"}], communication_step=0.01,
        material=MATERIALS[material], plane=[FLOOR], stop_time=0.4,
    )  # fmt: skip
    with Simulation(scene) as sim, Simulation(scene) as other:
        for _ in range(15):
            sim.step()
        other.restore(bytes(sim.save()))
        for each in (sim, other):
            for _ in range(15):
                each.step()
        assert bytes(sim.save()) == bytes(other.save())
        assert sim["box.free.position.z"] == pytest.approx(0.05, abs=1e-9)
