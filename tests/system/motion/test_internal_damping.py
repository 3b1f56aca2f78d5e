"""Dashpots along the springs: a mode of frequency omega has the damping ratio tau omega / 2, and rigid motion is not braked."""

import numpy as np
import pytest

from softffd import Scene, simulate
from softffd.fmu.package import scene_masses
from softffd.scene.scene import scene_from
from stepping import Stepper
from validation.mechanics import Body
from validation.resolved import resolved

FOLLOWING = ["auto", "leapfrog", "dop853", "ros34pw2", "backward_euler"]
"""The methods that take internal damping themselves."""
AMPLITUDE = 1e-5
"""m: springs are linear to some 1e-5 of it"""


def slowest_mode(scene: Scene) -> tuple[float, np.ndarray]:
    """Frequency [rad/s] and shape (n, 3) of the slowest vibration about rest of a body that is free, largest displacement 1."""
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
    return np.sqrt(squares[6]), shape / np.abs(shape).max()


@pytest.mark.parametrize("method", FOLLOWING)
@pytest.mark.parametrize("points", [[4, 4, 4], [7, 3, 3]], ids=["cube", "beam"])
def test_a_mode_decays_by_its_damping_ratio(method, points):
    """A constant force along a mode moves the rest shape; the vibration about it turns back once a period, smaller by the decrement."""
    time = 5e-4
    scene = scene_from(
        {
            "lattice": {"points": points, "size": [0.2 * (n - 1) for n in points]},
            "material": {"youngs_modulus": 1e4, "internal_damping": time},
            "mass": {"density": 1.0},
            "inputs": {"forces": "all"},
            "solver": {"method": method, "tolerance": 1e-9},
        }
    )
    omega, shape = slowest_mode(scene)
    ratio = time * omega / 2
    period = 2 * np.pi / omega / np.sqrt(1 - ratio**2)
    weighted = scene_masses(scene).mass[:, None] * shape
    with Stepper(scene, stop_time=3 * period) as stepper:
        rest = stepper.positions()
        stepper.set_forces(AMPLITUDE * omega**2 * weighted)
        stepper.step(period, times=3)
        amplitude = 1 - (weighted * (stepper.positions() - rest)).sum() / (weighted * shape).sum() / AMPLITUDE
    assert -np.log(amplitude) / (3 * omega * period) == pytest.approx(ratio, rel=1e-3)


@pytest.mark.parametrize("time", [1e-3, 0.1])
@pytest.mark.parametrize("method", FOLLOWING)
def test_a_thrown_and_spinning_body_is_not_braked(method, time):
    scene = scene_from(
        {
            "material": {"youngs_modulus": 1e6, "internal_damping": time},
            "mass": {"density": 100.0},
            "initial": {"velocity": [1.0, 2.0, 3.0], "angular_velocity": [0.3, 0.5, -0.4]},
            "outputs": {"velocities": "all", "energy": True},
            "solver": {"method": method},
        }
    )
    mass = scene_masses(scene).mass

    def moved(stepper) -> tuple[np.ndarray, np.ndarray, float]:
        x, v = stepper.positions(), stepper.velocities()
        momentum = mass @ v
        spin = (mass[:, None] * np.cross(x - mass @ x / mass.sum(), v)).sum(axis=0)
        return momentum, spin, sum(stepper.read("energy.kinetic", "energy.elastic"))

    with Stepper(scene, stop_time=1.0) as stepper:
        before = moved(stepper)
        stepper.step(0.1, times=10)
        after = moved(stepper)
    assert after[0] == pytest.approx(before[0], rel=1e-12)
    assert np.abs(after[1] - before[1]).max() < 1e-12 * np.linalg.norm(before[1])
    assert abs(after[2] / before[2] - 1) < 1e-7  # 3e-8 goes into the stretch of the spin and the vibration that it starts


def turning(ratio: float, **solver) -> Scene:
    """Thrown, turning by 3 rad/s; the fastest vibration times the dashpots' time is the ratio."""
    return scene_from(
        {
            "material": {"stiffness": 1e3, "damping": 0.0, "internal_damping": ratio / 800},
            "mass": {"total": 1.0},
            "initial": {"velocity": [0.5, 0.0, 0.0], "angular_velocity": [0.0, 3.0, 1.0]},
            "outputs": {"energy": True},
            "solver": solver,
            "experiment": {"stop_time": 0.3, "communication_step": 0.02},
        }
    )


@pytest.mark.parametrize("ratio", [10, 100])
def test_strong_damping_does_not_hold_a_body_back_that_turns_and_grows(ratio):
    """A step's drift goes along the tangents: dashpots so strong that the springs cannot bring the body back must not let it grow."""
    exact = simulate(turning(ratio, method="dop853", tolerance=1e-9))
    given = simulate(turning(ratio, method="leapfrog", step=1e-3))
    chosen = simulate(turning(ratio, method="leapfrog", tolerance=1e-5))
    implicit = simulate(turning(ratio, method="ros34pw2", tolerance=1e-6))
    assert np.abs(given.positions - exact.positions).max() < 1e-4
    assert np.abs(chosen.positions - exact.positions).max() < 1e-4
    assert np.abs(implicit.positions - exact.positions).max() < 1e-6
    energies = given.columns()
    assert np.abs(np.diff(energies["energy.kinetic"] + energies["energy.elastic"])).max() < 2e-4
    assert np.abs(energies["energy.dissipated"]).max() < 1e-3
