"""A solid on planes that its nodes touch: rest, sliding, a drop, and a bar that strikes a wall, by textbook mechanics."""

import numpy as np
import pytest

from readings import imbalance, vector
from scenes import GRAVITY, meshed
from softffd import Result, simulate
from solids import node_masses, node_velocities, nodes, solid
from validation import shapes

SIDE, G = 0.1, 9.81


def block(n: int = 4, **keys):
    """Of 1 kg."""
    keys = {"ratio": 0.45, "gravity": GRAVITY, "velocities": "all", "energy": True, **keys}
    return solid(n, modulus=1e5, density=1000.0, size=[SIDE] * 3, **keys)


def gap(result: Result) -> float:
    """Of the lowest node at any communication point from the ground z = 0 [m]."""
    return nodes(result)[..., 2].min()


@pytest.mark.short("4-0.25", "4-0.45")
@pytest.mark.parametrize("ratio", [0.25, 0.45])
@pytest.mark.parametrize("n", [4, 7])
def test_at_rest_it_presses_with_its_weight(n, ratio):
    scene = block(n, ratio=ratio, plane=[{"name": "ground", "friction": 0.4}], internal_damping=5e-3)
    result = simulate(scene, stop_time=0.8, step=0.05)
    weight = node_masses(scene).sum() * G
    assert gap(result) >= -1e-12
    assert vector(result, "plane.ground.reaction")[-1] == pytest.approx([0.0, 0.0, -weight], abs=1e-6 * weight)
    height = nodes(result)[-1, :, 2] @ node_masses(scene) / node_masses(scene).sum()
    assert height == pytest.approx(SIDE / 2 * (1 - weight / SIDE**2 / 1e5 * 2 / 3), abs=0.1 * SIDE * weight / SIDE**2 / 1e5)


@pytest.mark.short("4-0.45")
@pytest.mark.parametrize("ratio", [0.25, 0.45])
@pytest.mark.parametrize("n", [4, 7])
def test_on_its_surface_at_rest_it_presses_with_its_weight(n, ratio, tmp_path):
    """25 vertices a face touch in place of the nodes."""
    material = {"model": "solid", "youngs_modulus": 1e6, "poissons_ratio": ratio, "density": 1000.0, "internal_damping": 0.02}
    scene = meshed(
        tmp_path, shapes.cube(5, 0.0), points=[n] * 3, material=material, gravity=GRAVITY, plane=[{"name": "ground", "friction": 0.4}]
    )
    result = simulate(scene, stop_time=0.8, step=0.05)
    weight = node_masses(scene).sum() * G
    assert result.deformed(row=slice(None))[..., 2].min() >= -1e-12
    assert vector(result, "plane.ground.reaction")[-1] == pytest.approx([0.0, 0.0, -weight], abs=1e-6 * weight)


def test_thrown_along_the_ground_it_stops_where_a_rigid_one_would():
    """It sinks in first, and at the end rocks on what friction holds: some per cent of the way."""
    speed, friction = 0.5, 0.4
    ground = {"name": "ground", "friction": friction}
    scene = block(velocity=[speed, 0.0, 0.0], plane=[ground], internal_damping=1e-2, stop_time=0.5, communication_step=0.01)
    result = simulate(scene)
    mass = node_masses(scene)
    way = (nodes(result)[..., 0] @ mass) / mass.sum()
    assert gap(result) >= -1e-12
    assert way[-1] - way[0] == pytest.approx(speed**2 / (2 * friction * G), rel=0.02)
    assert np.abs(node_velocities(result)[-1]).max() < 1e-3  # m/s
    force = vector(result, "plane.ground.reaction")
    assert np.hypot(force[:, 0], force[:, 1]).max() <= friction * np.abs(force[:, 2]).max() * (1 + 1e-9)
    lost = mass @ (node_velocities(result)[0] - node_velocities(result)[-1])
    assert 0.01 * force[1:].sum(axis=0) + [0.0, 0.0, 0.5 * G] == pytest.approx(lost, abs=1e-10)  # of 1 kg in 0.5 s


@pytest.mark.parametrize("method", ["auto", "leapfrog"])
def test_dropped_and_turning_it_gets_the_planes_impulse(method):
    motion = {"offset": [0.0, 0.0, 0.05], "velocity": [0.3, 0.2, 0.0], "angular_velocity": [1.0, 2.0, 0.0]}
    scene = block(plane=[{"name": "ground", "friction": 0.3}], method=method, stop_time=0.3, communication_step=1e-3, **motion)
    result = simulate(scene)
    mass, x, v = node_masses(scene)[:, None], nodes(result), node_velocities(result)
    momentum, spin = (mass * v).sum(axis=1), (mass * np.cross(x, v)).sum(axis=1)
    weight = np.array(GRAVITY) * mass.sum()
    given = 1e-3 * (weight - vector(result, "plane.ground.reaction")[1:])
    assert gap(result) >= -1e-12
    assert vector(result, "plane.ground.reaction")[:, 2].min() < -10  # N
    assert np.diff(momentum, axis=0) == pytest.approx(given, abs=1e-12)
    centre = (mass * x).sum(axis=1) / mass.sum()
    middle = 0.5 * (centre[1:] + centre[:-1])
    torque = 1e-3 * (np.cross(middle, weight) - vector(result, "plane.ground.torque")[1:])
    assert np.diff(spin, axis=0) == pytest.approx(torque, abs=1e-4 * np.abs(spin).max())  # the centre's mean place in a step
    assert np.abs(imbalance(result)).max() < 0.01 * result.outputs["energy.gravity"].max()


LENGTH, SPEED, MODULUS, DENSITY = 0.2, 0.2, 1e6, 1000.0


@pytest.mark.parametrize(("counts", "rebound"), [([16, 4, 4], 0.97), ([31, 4, 4], 0.98)], ids=["5 patches", "10 patches"])
def test_a_bar_that_strikes_a_wall_stays_for_two_passages_of_its_wave(counts, rebound):
    """c = sqrt(E / rho), as its sides are free and Poisson's ratio is 0: force rho c A v for 2 L / c. It leaves with less than its speed:
    what strikes in a step has the mass of the face's nodes, which stops."""
    wave = np.sqrt(MODULUS / DENSITY)
    time, side = 2 * LENGTH / wave, 3 * LENGTH / (counts[0] - 1)
    scene = solid(
        counts, ratio=0.0, modulus=MODULUS, density=DENSITY, size=[LENGTH, side, side], velocity=[-SPEED, 0.0, 0.0], velocities="all",
        plane=[{"name": "wall", "normal": [1.0, 0.0, 0.0], "friction": 0.0}], stop_time=1.5 * time, communication_step=time / 50,
    )  # fmt: skip
    result = simulate(scene)
    force = -vector(result, "plane.wall.reaction")[:, 0]
    pressed = np.flatnonzero(force > 0.05 * force.max())
    assert nodes(result)[..., 0].min() >= -1e-12
    assert result.time[pressed[-1]] == pytest.approx(time, rel=0.021)  # a communication step
    assert force[5:40].mean() == pytest.approx(DENSITY * wave * side**2 * SPEED, rel=0.01)
    speed = (node_velocities(result)[-1, :, 0] @ node_masses(scene)) / node_masses(scene).sum()
    assert rebound < speed / SPEED < 1


def test_what_rings_creeps_though_friction_would_hold_it_at_rest():
    """On 93 % of the slope that it slides on, and let go unstrained. By explicit steps that follow all that rings."""
    scene = solid(
        4, ratio=0.3324, modulus=257e3, density=1.087, size=[1.064, 0.6148, 0.7603], internal_damping=2e-6,
        gravity=[-4.077968, -2.293313, -8.62247], plane=[{"name": "ground", "friction": 0.5819}], stop_time=0.36, communication_step=0.018,
    )  # fmt: skip
    tolerance = 1e-3
    by_itself = simulate(scene, tolerance=tolerance)
    explicit = simulate(scene, start_values={"solver.method": "leapfrog", "solver.step": 2e-5})
    allowed = tolerance * 1.064
    assert np.linalg.norm(nodes(explicit)[-1] - nodes(explicit)[0], axis=1).min() > 15 * allowed
    assert np.linalg.norm(nodes(by_itself)[-1] - nodes(explicit)[-1], axis=1).max() < 10 * allowed
