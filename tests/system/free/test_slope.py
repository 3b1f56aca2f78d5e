"""A free plate on the top of a block under a gravity that leans: it slides and sticks as Coulomb says, and a slender one falls over."""

import numpy as np
import pytest

from rigid import G, fall_over, slide
from scenes import meshed
from softffd import simulate
from softffd.rotation import matrices
from textbook import TOLERANCE, tilted
from validation import shapes

SIDE = 0.2
"""m, of the block that is held below"""
PLATE = [1.0, 0.4, 0.05]
"""m; its edges meet no vertex of the block"""
MATERIALS = {"stiff": {"stiffness": 1e7, "damping": 0.0}, "damped": {"stiffness": 1e9, "internal_damping": 1e-5}}


def laid(folder, size, degrees, *, friction, material, **keys):
    """A body of 1 kg on the block, whose upper face is z = 0 and falls towards x."""
    body = {"name": "free", "size": size, "point": [0.0, 0.0, size[2] / 2], "motion": "free", "mass": 1.0, "friction": friction}
    vertices, faces = shapes.cube(4, 0.0)
    return meshed(
        folder, (vertices * SIDE - [SIDE / 2, SIDE / 2, SIDE], faces), gravity=tilted(degrees), mass={"total": 1.0},
        lattice={"origin": [-SIDE / 2, -SIDE / 2, -SIDE], "size": [SIDE] * 3}, points=[4, 4, 4], material=MATERIALS[material],
        pin=[{"name": "base", "points": "z-"}], box=[body | keys.pop("body", {})], stop_time=0.3, **keys,
    )  # fmt: skip


CASES = [
    (material, step, *slope)
    for material, step in (("damped", 0.01), ("damped", 0.1), ("damped", 0.001), ("stiff", 0.01))
    for slope in ((0.2, 0.0), (0.3, 0.0), (0.4, 0.0), (0.5, -0.7), (0.2, -0.5))
]


@pytest.mark.short("damped-0.1-0.3-0.0", "damped-0.1-0.5--0.7")
@pytest.mark.parametrize(("material", "step", "friction", "speed"), CASES)
def test_a_plate_slides_and_sticks_as_a_rigid_one(material, step, friction, speed, tmp_path):
    """Down a slope of 20 degrees, or up and back. What vibrates at the start, when the weight comes at once, carries it a little further
    than a rigid block does: by 1 / sqrt(stiffness), and more where nothing damps it."""
    scene = laid(tmp_path, PLATE, 20.0, friction=friction, material=material, communication_step=step, body={"velocity": [speed, 0.0, 0.0]})
    result = simulate(scene)
    pull, grip = G * np.sin(np.radians(20)), friction * G * np.cos(np.radians(20))
    way = result.outputs["box.free.position.x"]
    most = 3e-4 if material == "stiff" else 10 * TOLERANCE * SIDE
    assert way == pytest.approx(slide(result.time, speed=speed, grip=grip, push=pull), abs=most)
    assert np.abs(result.outputs["box.free.position.y"]).max() < 1e-6
    assert material == "stiff" or not result.summary["warnings"]  # what it leaves swinging can make a plate that sticks creep


SLENDER = [0.24, 0.24, 0.4]
"""m: wider than the block, over whose edge it falls"""
BALANCE = np.degrees(np.arctan2(SIDE / 2, SLENDER[2] / 2))


@pytest.mark.parametrize("past", [-1.0, 1.0, 4.0])
def test_a_slender_box_falls_over_past_its_balance_and_stands_before_it(past, tmp_path):
    scene = laid(tmp_path, SLENDER, BALANCE + past, friction=1.5, material="damped", communication_step=0.02)
    result = simulate(scene)
    turns = matrices(np.stack([result.outputs[f"box.free.orientation.{c}"] for c in "wxyz"], axis=1))
    angle = np.arctan2(turns[:, 0, 2], turns[:, 2, 2])
    if past < 0:
        assert np.abs(angle).max() < 1e-4
        return
    arm = np.hypot(SIDE / 2, SLENDER[2] / 2)
    inertia = arm**2 + (SLENDER[0] ** 2 + SLENDER[2] ** 2) / 12
    fallen = fall_over(result.time, lean=np.radians(past), arm=arm, inertia=inertia) - np.radians(past)
    assert angle == pytest.approx(fallen, abs=1.2e-3)  # 0.15 m from the edge it is off by nine tolerances


@pytest.mark.short("*-damped")
@pytest.mark.parametrize(("friction", "material"), [(0.3, "stiff"), (0.3, "damped"), (0.7, "damped")])
def test_a_box_slides_within_the_top(friction, material, tmp_path):
    """Down 30 degrees, over rows of vertices that come under it and are left: its edges are rounded, or they would stop it."""
    vertices, faces = shapes.cube(21, 0.0)
    size = np.array([1.0, 0.4, 0.2])
    body = {"name": "free", "size": [0.2, 0.2, 0.1], "point": [-0.2, 0.0, 0.05], "motion": "free", "mass": 1.0, "friction": friction}
    scene = meshed(
        tmp_path, ((vertices - [0.5, 0.5, 1.0]) * size, faces), gravity=tilted(30.0), mass={"total": 10.0}, contact={"penetration": 0.0},
        lattice={"origin": [-0.5, -0.2, -0.2], "size": size.tolist()}, points=[4, 4, 4], material=MATERIALS[material],
        pin=[{"name": "base", "points": "z-"}], box=[body], stop_time=0.3, communication_step=0.02,
    )  # fmt: skip
    result = simulate(scene)
    way = result.outputs["box.free.position.x"] + 0.2
    expected = slide(result.time, grip=friction * G * np.cos(np.radians(30)), push=G * np.sin(np.radians(30)))
    assert way == pytest.approx(expected, abs=10 * TOLERANCE)
