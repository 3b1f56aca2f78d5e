"""Soft bodies in MuJoCo's loop: weight, frequency, energy and momentum against closed forms, substeps, states."""

import warnings

import numpy as np
import pytest

import softffd
from robots import CUBE, FREE, MASS, ROUND, SLIDER, STIFF, TURNED, mujoco, robot, spring
from scenes import GRAVITY, LED, MOVED, box, meshed
from softffd import FmuError
from softffd.bridges.mujoco import couple
from validation import shapes

UNIT = {"origin": [0.0, 0.0, 0.0], "size": [1.0, 1.0, 1.0]}


def stiffness() -> float:
    """Of the cube between its pins [N/m], by a static run: its top moved by 1 mm and held until damping has brought it to rest."""
    scene = spring(damping=1.0)
    with softffd.Simulation(scene) as cube:
        forces = []
        for height in (1.0, 0.999):
            cube["pin.top.position.z"], cube["pin.top.velocity.z"] = height, 0.0
            for _ in range(20):
                cube.step(0.05)
            forces.append(cube["pin.top.reaction"][2])
    return (forces[1] - forces[0]) / 1e-3


@pytest.mark.parametrize("option", ["", 'integrator="implicitfast"', 'integrator="RK4"'])
def test_a_mass_on_a_soft_body_swings_at_the_frequency_of_its_stiffness_about_its_weight_and_keeps_its_energy(option):
    k, h = stiffness(), 2e-3
    model, data = robot(SLIDER, timestep=h, option=option)
    frequency = np.sqrt(k / (MASS + 0.027 / 3))  # a third of the mass of the spring, as Rayleigh has it
    with softffd.Simulation(spring()) as cube:
        bridge = couple(model, data, {cube: {"pin.top": "load"}})
        heights, forces, energies = [], [], []
        for _ in range(round(4 * 2 * np.pi / frequency / h)):
            bridge.step()
            heights.append(data.qpos[0])
            forces.append(cube["pin.top.reaction"][2])
            back = 0.0 if "RK4" in option else h / 2 * data.qvel[0]
            soft = sum(cube.number(f"energy.{kind}") for kind in ("kinetic", "elastic", "gravity"))
            energies.append(soft + MASS * (data.qvel[0] ** 2 / 2 + 9.81 * (data.qpos[0] - back)))
    sag = MASS * 9.81 / k
    assert np.mean(forces) == pytest.approx(MASS * 9.81, rel=0.01)
    assert -np.mean(heights) == pytest.approx(sag, rel=0.01)
    assert -np.min(heights) == pytest.approx(2 * sag, rel=0.01)  # it was laid on: the overshoot is its sag
    rising = np.array(heights) - np.mean(heights)
    falls = [n + rising[n] / (rising[n] - rising[n + 1]) for n in np.nonzero((rising[:-1] > 0) & (rising[1:] <= 0))[0]]
    period = np.diff(falls).mean() * h
    assert 2 * np.pi / period == pytest.approx(frequency, rel=0.005)
    assert np.ptp(energies) < 0.01 * MASS * 9.81 * sag


def test_a_box_that_lies_on_a_soft_body_presses_with_its_weight_where_it_lies(tmp_path):
    slab = '<geom name="slab" type="box" size="0.4 0.6 0.1" pos="0.1 0 0" mass="3"/>'
    model, data = robot(f'<body pos="0.4 0.5 1.1"><joint type="slide" axis="0 0 1"/>{slab}</body>', timestep=5e-3)
    solid = [{"name": "slab", "size": [0.8, 1.2, 0.2], **TURNED}]
    lattice, base = {**UNIT, "points": [3, 3, 3]}, [{"name": "base", "points": "z-"}]
    scene = meshed(tmp_path, shapes.cube(3, 0.0), lattice=lattice, box=solid, pin=base, stiffness=STIFF, damping=10.0, gravity=GRAVITY)
    with softffd.Simulation(scene) as soft:
        bridge = couple(model, data, {soft: {"box.slab": "slab"}})
        for _ in range(200):
            bridge.step()
        np.testing.assert_allclose(soft["box.slab.reaction"], [0.0, 0.0, -GRAVITY[2] * 3], atol=0.02)
        assert abs(data.qvel[0]) < 1e-4 and data.qpos[0] < -1e-4
        np.testing.assert_allclose(soft["box.slab.centre"], [0.5, 0.5, 1.0 + data.qpos[0]], atol=1e-3)


def momenta(model, data, cube, mass: float):
    """Linear and angular momentum about the world's origin of a robot of one body, and of a cube of uniform masses."""
    mujoco.mj_forward(model, data)
    mujoco.mj_subtreeVel(model, data)
    linear, weight = data.subtree_linvel[1] * 1.0, model.body_mass[1]
    angular = data.subtree_angmom[1] + weight * np.cross(data.subtree_com[1], linear)
    x, v = cube.positions.reshape(-1, 3), cube.velocities.reshape(-1, 3)
    each = mass / len(x)
    return weight * linear + each * v.sum(axis=0), angular + each * np.cross(x, v).sum(axis=0)


def flight(h: float) -> tuple[np.ndarray, np.ndarray]:
    """How far linear and angular momentum drift while a turning body carries a soft cube on an arm for 0.2 s, without gravity."""
    model, data = robot(FREE, timestep=h, gravity="0 0 0")
    data.qvel[:] = [0.1, -0.2, 0.3, 1.0, -2.0, 1.5]
    scene = box(**CUBE, velocities="all", pin=[{"name": "top", "points": "z+", **LED}], initial={"velocity": [0.1, -0.2, 0.3]})
    with softffd.Simulation(scene) as cube:
        bridge = couple(model, data, {cube: {"pin.top": "load"}}, tolerance=1e-6)
        bridge.step()
        before = momenta(model, data, cube, 0.027)
        for _ in range(round(0.2 / h)):
            bridge.step()
        after = momenta(model, data, cube, 0.027)
    return after[0] - before[0], after[1] - before[1]


FIRST_TOUCH = pytest.mark.filterwarnings("ignore:of the largest wrench")
"""The wrenches of a first step, or of a first touch, are small, and agree less"""


@FIRST_TOUCH
def test_a_turning_body_and_the_soft_body_on_its_arm_keep_their_momentum():
    coarse, fine = flight(4e-3), flight(2e-3)
    assert abs(fine[0]).max() < 1e-12 and abs(coarse[0]).max() < 1e-12
    assert abs(fine[1]).max() < 0.3 * abs(coarse[1]).max() < 1e-3


@FIRST_TOUCH
def test_a_capsule_that_hits_a_soft_cube_off_centre_takes_the_momentum_that_the_cube_loses(tmp_path):
    capsule = '<geom name="capsule" type="capsule" size="0.15 0.3" pos="-0.1 -0.05 0"/>'
    inertial = '<inertial pos="0 0 0" mass="2" diaginertia="0.05 0.05 0.05"/>'
    model, data = robot(
        f'<body pos="0.6 0.45 1.25" euler="80 20 10"><freejoint/>{capsule}{inertial}</body>', timestep=2e-3, gravity="0 0 0"
    )
    data.qvel[:3] = [0.3, 0.1, -1.0]
    solids = {
        "sphere": [{"name": name, "radius": 0.15, "friction": 0.3, **ROUND} for name in ("up", "down")],
        "cylinder": [{"name": "middle", "radius": 0.15, "length": 0.6, "friction": 0.3, **MOVED}],
    }
    mass = {"total": 1.0, "distribution": "uniform"}
    cube = meshed(tmp_path, shapes.cube(3, 0.0), lattice={**UNIT, "points": [3, 3, 3]}, mass=mass, velocities="all", damping=0.0, **solids)
    with softffd.Simulation(cube) as soft:
        bridge = couple(model, data, {soft: dict.fromkeys(("sphere.up", "sphere.down", "cylinder.middle"), "capsule")})
        before = momenta(model, data, soft, 1.0)
        for _ in range(100):
            bridge.step()
        after, spin = momenta(model, data, soft, 1.0), data.qvel[3:]
    assert np.linalg.norm(spin) > 0.5  # it was hit off its centre
    np.testing.assert_allclose(after[0], before[0], atol=1e-12)
    np.testing.assert_allclose(after[1], before[1], atol=2e-4)


@pytest.mark.parametrize("mass", [0.3, 0.001])
def test_a_body_lighter_than_the_points_that_it_holds_is_stepped_too(mass):
    model, data = robot(SLIDER.replace('mass="3"', f'mass="{mass}"'))
    with softffd.Simulation(spring()) as cube:
        bridge, trials, forces = couple(model, data, {cube: {"pin.top": "load"}}), [], []
        for _ in range(100):
            bridge.step()
            trials.append(bridge.trials)
            forces.append(cube["pin.top.reaction"][2])
    assert max(trials) < bridge.most and np.mean(trials) < 3.1
    impulse = model.opt.timestep * (np.sum(forces) - len(forces) * mass * 9.81)
    assert mass * data.qvel[0] == pytest.approx(impulse, abs=1e-12)


def test_the_first_step_that_does_not_come_to_its_tolerance_says_so():
    model, data = robot(SLIDER)
    with softffd.Simulation(spring()) as cube:
        bridge = couple(model, data, {cube: {"pin.top": "load"}}, tolerance=1e-16, trials=2)
        with pytest.warns(UserWarning, match="of the largest wrench the step at 0 s leaves .* after 2 trials") as said:
            for _ in range(3):
                bridge.step()
        assert len(said) == 1 and bridge.residual > 1e-16


def test_wrenches_that_are_rounding_alone_take_one_trial_and_give_no_warning():
    wide = FREE.replace('size="0.1" mass="1"', 'size="0.5" mass="3"')
    model, data = robot(wide, timestep=2e-3, gravity="0 0 0")
    data.qvel[:3] = [0.1, -0.2, 0.3]
    scene = box(**CUBE, pin=[{"name": "top", "points": "z+", **LED}], initial={"velocity": [0.1, -0.2, 0.3]})
    with softffd.Simulation(scene) as cube, warnings.catch_warnings():
        warnings.simplefilter("error")
        bridge, trials = couple(model, data, {cube: {"pin.top": "load"}}, tolerance=1e-9), set()
        for _ in range(20):
            bridge.step()
            trials.add(bridge.trials)
    assert trials == {1}


@pytest.mark.parametrize("timestep, step", [(1e-3, 4e-3), (4e-3, 1e-3)])
def test_substeps_of_either_side_go_the_way_of_equal_steps(timestep, step):
    ends = []
    for steps in ((4e-3, 4e-3), (timestep, step)):
        model, data = robot(SLIDER, timestep=steps[0])
        with softffd.Simulation(spring()) as cube:
            bridge = couple(model, data, {cube: {"pin.top": "load"}}, step=steps[1])
            while data.time < 0.2 - 1e-6:
                bridge.step()
            assert cube.time == pytest.approx(0.2)
        ends.append(data.qpos[0] - data.qvel[0] * steps[0] / 2)
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)


def test_set_back_it_goes_on_with_the_same_bits(tmp_path):
    model, data = robot(SLIDER + '<body name="other" pos="2 0 0.1"><freejoint/><geom size="0.2"/></body><geom type="plane" size="1 1 1"/>')
    with softffd.Simulation(spring()) as cube:
        bridge = couple(model, data, {cube: {"pin.top": "load"}})

        def on() -> bytes:
            for _ in range(20):
                bridge.step()
            return data.qpos.tobytes() + data.qvel.tobytes() + cube.positions.tobytes() + cube["pin.top.reaction"].tobytes()

        on()
        moment = bridge.save()
        first = on()
        on()
        bridge.restore(moment)
        assert on() == first
        mujoco.mj_resetData(model, data)
        with pytest.raises(FmuError, match="go back by restore"):
            bridge.step()
        bridge.restore(moment)
        assert on() == first


def test_an_fmu_goes_the_way_of_its_scene(tmp_path):
    ends = []
    for source in (spring(), softffd.package_fmu(spring(), tmp_path / "cube.fmu")):
        model, data = robot(SLIDER)
        with softffd.Simulation(source) as cube:
            bridge = couple(model, data, {cube: {"pin.top": "load"}})
            for _ in range(20):
                bridge.step()
        ends.append(data.qpos[0])
    assert ends[0] == ends[1] < 0


def test_a_refused_step_leaves_all_as_they_were():
    model, data = robot(SLIDER)
    with softffd.Simulation(spring(), stop_time=0.01) as cube:
        bridge = couple(model, data, {cube: {"pin.top": "load"}})
        for _ in range(10):
            bridge.step()
        time, height = data.time, data.qpos[0]
        with pytest.raises(FmuError):
            bridge.step()
        assert (data.time, data.qpos[0], cube.time) == (time, height, pytest.approx(0.01))


@pytest.mark.parametrize(
    "given, said",
    [
        ({"step": 1.5e-3}, "a multiple or a whole fraction of the engine's step, 0.001 s, got 0.0015"),
        ({"step": 0}, "got 0"),
        ({"step": -1e-3}, "got -0.001"),
        ({"step": float("inf")}, "got inf"),
        ({"step": "1 ms"}, "step: wanted one number"),
        ({"trials": 0}, "trials >= 1"),
        ({"tolerance": 0}, "tolerance > 0"),
    ],
)
def test_settings_out_of_range_are_refused(given, said):
    model, data = robot(SLIDER)
    with softffd.Simulation(spring()) as cube, pytest.raises(FmuError, match=said):
        couple(model, data, {cube: {"pin.top": "load"}}, **given)
