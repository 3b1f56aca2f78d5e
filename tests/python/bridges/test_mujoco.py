"""What the bridge says to MuJoCo: wrenches at points, bodies and geoms by name, and what is refused."""

import numpy as np
import pytest

import softffd
from robots import FREE, ROUND, SLIDER, TURNED, mujoco, robot
from scenes import LED, MOVED, meshed
from softffd import FmuError
from softffd.bridges.mujoco import MuJoCo, couple
from validation import shapes

SOLIDS = {
    "sphere": [
        {"name": "ball", "radius": 0.1, **ROUND},
        {"name": "up", "radius": 0.05, **ROUND},
        {"name": "down", "radius": 0.05, **ROUND},
    ],
    "cylinder": [{"name": "rod", "radius": 0.1, "length": 0.4, **MOVED}, {"name": "middle", "radius": 0.05, "length": 0.3, **MOVED}],
    "box": [{"name": "brick", "size": [0.2, 0.4, 0.6], **TURNED}],
}
GEOMS = """<geom name="floor" type="plane" size="1 1 1" pos="0 0 -3"/>
<body pos="3 4 5" euler="10 20 30"><freejoint/>
<geom name="ball" type="sphere" size="0.1" pos="0.3 0 0"/> <geom name="rod" type="cylinder" size="0.1 0.2" pos="0 0.5 0" euler="40 0 0"/>
<geom name="brick" type="box" size="0.1 0.2 0.3" pos="0 0 0.7" euler="0 50 0"/>
<geom name="capsule" type="capsule" size="0.05 0.15" pos="1 0 0" /> <geom name="egg" type="ellipsoid" size=".1 .2 .3"/></body>"""
STAND_FOR = {"plane.floor": "floor", "sphere.ball": "ball", "cylinder.rod": "rod", "box.brick": "brick",
             "sphere.up": "capsule", "cylinder.middle": "capsule", "sphere.down": "capsule"}  # fmt: skip


def among_solids(tmp_path, **keys):
    return meshed(tmp_path, shapes.cube(2, 0.0), plane=[{"name": "floor", **MOVED}], **{**SOLIDS, **keys})


def test_a_wrench_about_a_point_of_a_turned_body_is_what_mujoco_applies_there():
    text = '<body name="a" pos="1 2 3" euler="20 30 40"><freejoint/><geom type="box" size=".1 .2 .3" pos=".3 .1 -.2"/></body>'
    point, wrench = np.array([0.2, -0.4, 0.1]), np.array([1.0, 2.0, 3.0, -0.5, 0.7, 0.2])
    (model, data), (_, other) = robot(text), robot(text)
    MuJoCo(model, data).advance([(1, point, wrench)])
    mujoco.mj_forward(model, other)
    place = other.xpos[1] + other.xmat[1].reshape(3, 3) @ point
    mujoco.mj_applyFT(model, other, wrench[:3], wrench[3:], place, 1, other.qfrc_applied)
    mujoco.mj_step(model, other)
    np.testing.assert_allclose(data.qvel, other.qvel, rtol=1e-12, atol=1e-15)


def test_forces_of_the_caller_stay_and_act_too():
    model, data = robot(FREE, gravity="0 0 0")
    data.xfrc_applied[1, 2] = 5.0
    MuJoCo(model, data).advance([(1, np.zeros(3), np.array([0.0, 0.0, -2.0, 0.0, 0.0, 0.0]))])
    assert data.qvel[2] == pytest.approx(3.0 * model.opt.timestep) and data.xfrc_applied[1, 2] == 5.0


def test_obstacles_lie_and_move_as_their_geoms_do(tmp_path):
    model, data = robot(GEOMS, gravity="0 0 0")
    data.qvel[3:] = [1.0, -2.0, 3.0]
    with softffd.Simulation(among_solids(tmp_path)) as soft:
        bridge = couple(model, data, {soft: STAND_FOR})
        for _ in range(3):
            begin = data.qpos.copy()
            mujoco.mj_integratePos(model, begin, data.qvel, -model.opt.timestep / 2)
            bridge.step()
        data.qpos[:] = begin
        mujoco.mj_kinematics(model, data)
        for path, name in STAND_FOR.items():
            geom, middle = data.geom(name), name == "capsule" and 0.15 * {"up": 1, "middle": 0, "down": -1}[path.partition(".")[2]]
            turn = geom.xmat.reshape(3, 3)
            np.testing.assert_allclose(soft[f"{path}.point"], geom.xpos + middle * turn[:, 2], atol=1e-9)
            if path.startswith(("plane", "cylinder")):
                np.testing.assert_allclose(soft[f"{path}.normal"], turn[:, 2], atol=1e-9)
        x, y, z = soft["box.brick.rotation"]
        angle = np.linalg.norm([x, y, z])
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) / angle
        turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        np.testing.assert_allclose(turn, data.geom("brick").xmat.reshape(3, 3), atol=1e-9)


@pytest.mark.parametrize(
    "names, said",
    [
        ({"box.brik": "brick"}, 'box.brik: the scene has no such part; wanted one of .*did you mean "box.brick"'),
        ({"box.brick": "brik"}, 'geom brik: the model has no such geom, did you mean "brick"'),
        ({"pin.top": "lod"}, 'body lod: the model has no such body, did you mean "load"'),
        ({"box.brick": "egg"}, "geom egg: wanted one of plane, sphere, cylinder, box, capsule, got ellipsoid; the nearest is a sphere"),
        ({"sphere.ball": "brick"}, "geom brick: wanted box of the scene for a box, got sphere"),
        ({"cylinder.middle": "capsule"}, "geom capsule: wanted cylinder, sphere, sphere of the scene for a capsule, got cylinder"),
        ({"sphere.up": "ball"}, "sphere.up: wanted 0.2 x 0.2 x 0.2 m as of geom ball, got sphere up of radius 0.05 m"),
        ({"pin.held": "load"}, 'pin.held.position: .*its scene needs motion = "input" of the pin'),
        ({"pin.shoved": "load"}, 'pin.shoved.orientation.w: wanted an input: give pin.shoved .*"orientation", "velocity"'),
        ({"pin.top": "lod", "box.brick": "ball"}, r"the coupling has 2 problems\n  geom ball.*\n  body lod"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path, names, said):
    pins = [
        {"name": "top", "points": "z+", **LED},
        {"name": "held", "points": "z-"},
        {"name": "shoved", "points": [[0, 0, 1]], "motion": "input"},
    ]
    model, data = robot(GEOMS + SLIDER)
    with softffd.Simulation(among_solids(tmp_path, pin=pins)) as soft, pytest.raises(FmuError, match=said):
        couple(model, data, {soft: names})


def test_a_robot_that_mujoco_resets_is_reported(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where MuJoCo puts its log
    model, data = robot(FREE)
    data.qvel[0] = 1e200
    with pytest.raises(FmuError, match="take a shorter timestep"):
        MuJoCo(model, data).advance([])
