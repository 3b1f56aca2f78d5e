"""Dashpots along the springs, from hardly any to far above critical: a mode of frequency omega has the damping ratio tau omega / 2, rigid
motion is not braked, every method keeps its tolerance, or gives way and says so."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from readings import imbalance, points
from scenes import GRAVITY, box
from softffd import Scene, simulate
from softffd.fmu.package import scene_masses
from stepping import Stepper
from validation.mechanics import Body
from validation.resolved import resolved

FOLLOWING = ["auto", "leapfrog", "dop853", "ros34pw2", "backward_euler", "sdirk2"]
"""The methods that take internal damping themselves."""
AMPLITUDE, TAU = 1e-5, 5e-4
"""m: springs are linear to some 1e-5 of it; s"""
FASTEST = 700.0
"""rad/s; about the highest frequency of the box of 1e3 N/m, times which the dashpots' time is a ratio: twice a damping ratio"""


@cache
def vibrating(points: tuple[int, int, int]) -> tuple[Scene, float, np.ndarray]:
    """A free body, frequency [rad/s] and shape (n, 3) of its slowest vibration about rest, largest displacement 1."""
    scene = box(
        lattice={"points": points, "size": [0.2 * (n - 1) for n in points]}, material={"youngs_modulus": 1e4, "internal_damping": TAU},
        mass={"density": 1.0}, forces="all", tolerance=1e-9,
    )  # fmt: skip
    document = resolved(scene)
    body, rest = Body.of(document), np.array(document["rest"])
    a, b = body.pairs.T
    along = (rest[b] - rest[a]) / body.length[:, None]
    block = body.stiffness[:, None, None] * along[:, :, None] * along[:, None, :]
    matrix = np.zeros((len(rest), 3, len(rest), 3))
    for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
        np.add.at(matrix, (i, slice(None), j), sign * block)
    root = np.sqrt(np.repeat(body.mass, 3))
    squares, shapes = np.linalg.eigh(matrix.reshape(len(root), -1) / np.outer(root, root))
    shape = (shapes[:, 6] / root).reshape(-1, 3)
    return scene, np.sqrt(squares[6]), shape / np.abs(shape).max()


@pytest.mark.parametrize("method", FOLLOWING)
@pytest.mark.parametrize("points", [(4, 4, 4), (7, 3, 3)], ids=["cube", "beam"])
def test_a_mode_decays_by_its_damping_ratio(method, points):
    """A constant force along a mode moves the rest shape; the vibration about it turns back once a period, smaller by the decrement."""
    scene, omega, shape = vibrating(points)
    ratio = TAU * omega / 2
    period = 2 * np.pi / omega / np.sqrt(1 - ratio**2)
    weighted = scene_masses(scene).mass[:, None] * shape
    with Stepper(scene, start_values={"solver.method": method}, stop_time=3 * period) as stepper:
        rest = stepper.points()
        stepper.set_forces(AMPLITUDE * omega**2 * weighted)
        stepper.step(period, times=3)
        amplitude = 1 - (weighted * (stepper.points() - rest)).sum() / (weighted * shape).sum() / AMPLITUDE
    assert -np.log(amplitude) / (3 * omega * period) == pytest.approx(ratio, rel=1e-3)


@pytest.mark.short("*-0.001", "[!d]*-0.1")
@pytest.mark.parametrize("time", [1e-3, 0.1])
@pytest.mark.parametrize("method", FOLLOWING)
def test_a_thrown_and_spinning_body_is_not_braked(method, time):
    scene = box(
        material={"youngs_modulus": 1e6, "internal_damping": time}, mass={"density": 100.0}, velocity=[1.0, 2.0, 3.0],
        angular_velocity=[0.3, 0.5, -0.4], velocities="all", energy=True, method=method,
    )  # fmt: skip
    mass = scene_masses(scene).mass

    def moved(stepper) -> tuple[np.ndarray, np.ndarray, float]:
        x, v = stepper.points(), stepper.point_velocities()
        spin = (mass[:, None] * np.cross(x - mass @ x / mass.sum(), v)).sum(axis=0)
        return mass @ v, spin, stepper.energy()

    with Stepper(scene, stop_time=1.0) as stepper:
        before = moved(stepper)
        stepper.step(0.1, times=10)
        after = moved(stepper)
    assert after[0] == pytest.approx(before[0], rel=1e-12)
    spin, energy = (1e-3, 1e-5) if method == "sdirk2" else (1e-12, 1e-7)  # second order, within the tolerance of the places
    assert np.abs(after[1] - before[1]).max() < spin * np.linalg.norm(before[1])
    assert abs(after[2] / before[2] - 1) < energy  # 3e-8 goes into the stretch of the spin and the vibration that it starts


def damped(ratio, **keys):
    """A box of 1 kg and 1e3 N/m."""
    return box(stiffness=1e3, damping=0.0, material={"internal_damping": ratio / FASTEST}, energy=True, outputs={"solver": True}, **keys)


def course(scene, method, tolerance):
    return simulate(scene, start_values={"solver.method": method, "solver.tolerance": tolerance}).positions


THROWN = {"velocity": [0.5, 0.0, 0.0], "angular_velocity": [0.0, 3.0, 1.0], "stop_time": 0.3, "communication_step": 0.02}
EXACT = [
    (10, ("dop853", 1e-9)),
    (100, ("ros34pw2", 1e-7)),
    pytest.param(300, ("ros34pw2", 1e-7), marks=pytest.mark.full),
    pytest.param(100, ("dop853", 1e-9), marks=pytest.mark.full),
]


@pytest.mark.short("10-*")
@pytest.mark.parametrize(("ratio", "reference"), EXACT)
def test_strong_damping_does_not_hold_a_body_back_that_turns_and_grows(ratio, reference):
    """A step's drift goes along the tangents: dashpots so strong that the springs cannot bring the body back must not let it grow. Where a
    tolerance is wanted, leapfrog needs a hundred steps where implicit ones, which auto finds, need three."""
    scene = damped(ratio, **THROWN)
    exact = course(scene, *reference)
    auto = simulate(scene, start_values={"solver.tolerance": 1e-6})
    assert auto.outputs["solver.steps"][-1] < 10_000
    assert np.abs(auto.positions - exact).max() < 1e-5
    if ratio < 300:
        given = simulate(scene, start_values={"solver.method": "leapfrog", "solver.step": 1e-3})
        assert np.abs(given.positions - exact).max() < 1e-4
        assert np.abs(np.diff(given.outputs["energy.kinetic"] + given.outputs["energy.elastic"])).max() < 2e-4
        assert np.abs(given.outputs["energy.dissipated"]).max() < 1e-3
        assert np.abs(course(scene, "leapfrog", 1e-5) - exact).max() < 1e-4
        assert np.abs(course(scene, "ros34pw2", 1e-6) - exact).max() < 1e-6


def stretched(ratio, **keys):
    """Let go of 10 % extension."""
    return damped(ratio, stretch=[1.1, 1.0, 1.0], stop_time=0.1, communication_step=0.05, **keys)


@pytest.mark.short("auto-*", "leapfrog-1", "ros34pw2-1", "dop853-1")
@pytest.mark.parametrize("ratio", [0.01, 1, 30, 1000])
@pytest.mark.parametrize("method", ["auto", "leapfrog", "ros34pw2", "dop853"])
def test_the_tolerance_is_kept(method, ratio):
    if method == "dop853" and ratio == 1000:
        pytest.skip("explicit steps without stages for damping: a million of them")
    exact = course(stretched(ratio), "ros34pw2" if ratio >= 30 else "dop853", 1e-8)
    assert np.abs(course(stretched(ratio), method, 1e-4) - exact).max() < 1e-4


@pytest.mark.parametrize("ratio", [0.3, 100])
def test_energy_is_accounted_for(ratio):
    result = simulate(stretched(ratio), start_values={"solver.tolerance": 1e-5})
    stored = result.outputs["energy.elastic"][0]
    assert result.outputs["energy.dissipated"][-1] > 0.01 * stored
    assert np.ptp(imbalance(result)) < 1e-3 * stored


@pytest.mark.parametrize(("asked", "taken"), [("bm4", "dop853"), ("rkn12", "dop853"), ("central_difference", "leapfrog")])
def test_methods_that_cannot_follow_it_give_way_and_say_so(asked, taken):
    with Stepper(stretched(0.1), start_values={"solver.method": asked}) as stepper:
        stepper.step(0.01, times=3)
        assert stepper.methods() == [(taken, "the method that was set does not handle this damping")]


def test_a_dropped_box_loses_nothing_before_it_lands_and_comes_to_rest():
    fall = {"gravity": GRAVITY, "offset": [0.0, 0.0, 0.1], "plane": [{"name": "ground"}], "stop_time": 1.5, "communication_step": 0.05}
    out, time = (result := simulate(damped(3e-3 * FASTEST, reactions=True, **fall))).outputs, result.time
    total = out["energy.kinetic"] + out["energy.elastic"] + out["energy.gravity"]
    assert np.ptp(total[time < 0.14]) < 1e-9 * total[0]  # 0.1 m of fall take 0.143 s
    assert out["energy.kinetic"][-1] < 1e-6
    assert out["plane.ground.reaction.z"][-1] == pytest.approx(-9.81, rel=1e-3)


@pytest.mark.parametrize(("stiffness", "time", "length"), [(1e8, 1e-5, 0.1), (1e9, 1e-4, 0.1), (1e8, 1e-5, 0.01)])
def test_implicit_steps_do_not_brake_a_stiff_pendulum(stiffness, time, length):
    """It hangs on an edge, starts level and swings for 2 s; nothing strains it."""
    swinging = box(
        points=[2, 2, 2], size=[0.2, 0.1, 1.0], stiffness=stiffness, damping=0.0, internal_damping=time, gravity=GRAVITY,
        pin=[{"name": "hinge", "points": {"i": [0, 0], "k": [0, 0]}}], rotation={"axis": [0, 1, 0], "degrees": 90.0},
        stop_time=2.0, communication_step=length,
    )  # fmt: skip
    place = points(simulate(swinging))
    arm = place[0] - place[0][0] * [1, 0, 1]
    inertia, centre = np.mean(arm[:, 0] ** 2 + arm[:, 2] ** 2), arm.mean(axis=0)

    def motion(_, state):
        angle, rate = state
        return [rate, -GRAVITY[2] / inertia * (np.cos(angle) * centre[0] + np.sin(angle) * centre[2])]

    angle = solve_ivp(motion, (0, 2.0), [0.0, 0.0], rtol=1e-11, atol=1e-12).y[0, -1]
    end = place[0][0] * [1, 0, 1] + arm @ np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
    assert np.abs(place[-1] - end).max() < 10 * swinging.solver.tolerance
