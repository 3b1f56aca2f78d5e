"""A stiff box and a rigid body of its own mass that meet without gravity: what they exchange is kept, and `auto` comes to what short
explicit steps come to, with friction and spin."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from readings import points, vector, velocities
from scenes import meshed
from softffd import Scene, simulate
from softffd.fmu.package import scene_masses
from softffd.rotation import matrices
from solids import node_velocities, nodes
from textbook import TOLERANCE, right, stated
from validation import shapes

AGAINST = {
    "ball, straight": ("sphere", 0.0, {"radius": 0.3, "point": [0.5, 0.5, 1.35], "velocity": [0.0, 0.0, -1.0]}),
    "ball, off centre": (
        "sphere", 0.4,
        {"radius": 0.3, "point": [0.62, 0.55, 1.35], "velocity": [0.3, 0.1, -1.0], "angular_velocity": [1.0, 2.0, 5.0]},
    ),
    "box, flat": ("box", 0.4, {"size": [0.4, 0.5, 0.2], "point": [0.5, 0.5, 1.15], "velocity": [0.0, 0.0, -1.0]}),
    "box, corner": (
        "box", 0.4,
        {"size": [0.6, 0.5, 0.3], "point": [0.55, 0.45, 1.4], "velocity": [0.2, -0.1, -1.0], "angular_velocity": [1.0, -0.5, 2.0],
         "rotation": {"axis": [1.0, 2.0, 0.5], "degrees": 30.0}},
    ),
    "roller": (
        "cylinder", 0.3,
        {"radius": 0.2, "length": 0.5, "normal": [1.0, 0.3, 0.2], "point": [0.55, 0.45, 1.35], "velocity": [0.2, -0.1, -1.0],
         "angular_velocity": [1.0, -0.5, 2.0]},
    ),
}  # fmt: skip


def meeting(folder, against: str, material: dict[str, Any], mass: float, **keys) -> tuple[Scene, str]:
    """The scene of a box of 1 m and 1 kg at rest, and the name of the body that comes at it."""
    kind, friction, solid = AGAINST[against]
    body = {"name": "free", "motion": "free", "mass": mass, "friction": friction, **solid}
    scene = meshed(
        folder, shapes.cube(4, 0.0), points=[4, 4, 4], material=material, mass={"total": 1.0},
        velocities="all", energy=True, reactions=True, outputs={"solver": True}, **{kind: [body]}, **keys,
    )  # fmt: skip
    return scene, f"{kind}.free"


@dataclass(frozen=True)
class Both:
    """Of the object and the body over time."""

    places: np.ndarray  # of points of both (T, n, 3) [m]
    momentum: np.ndarray  # (T, 3)
    angular: np.ndarray  # about the origin (T, 3)
    exchanged: float  # kg m/s
    energy: np.ndarray  # (T,) J
    stated: float  # m
    stable_step: float  # s


def run(scene: Scene, name: str, **start) -> Both:
    result = simulate(scene, start_values={f"solver.{key}": value for key, value in start.items()})
    body = next(each for each in scene.obstacles if each.motion == "free")
    places, speeds = (nodes, node_velocities) if scene.material.model == "solid" else (points, velocities)
    x, v, mass = places(result), speeds(result), scene_masses(scene).mass
    place, speed, spin = (vector(result, f"{name}.{what}") for what in ("position", "velocity", "angular_velocity"))
    axes = matrices(np.stack([result.outputs[f"{name}.orientation.{c}"] for c in "wxyz"], axis=1))
    turning = np.einsum("tij,j,tkj,tk->ti", axes, np.array(body.own_inertia()), axes, spin)
    own = body.own_mass() * speed
    kinetic = 0.5 * (np.einsum("p,tpc->t", mass, v**2) + (own * speed).sum(axis=1) + (turning * spin).sum(axis=1))
    assert result.outputs["energy.kinetic"] == pytest.approx(kinetic, rel=1e-12)
    corners = place[:, None] + 0.3 * np.swapaxes(axes, 1, 2)
    return Both(
        places=np.concatenate([x, place[:, None], corners], axis=1),
        momentum=np.einsum("p,tpc->tc", mass, v) + own,
        angular=np.einsum("p,tpc->tc", mass, np.cross(x, v)) + np.cross(place, own) + turning,
        exchanged=float(np.linalg.norm(own[-1] - own[0])),
        energy=kinetic + result.outputs["energy.elastic"],
        stated=float(stated(result)[-1]),
        stable_step=float(result.outputs["solver.stable_step"].min()),
    )  # fmt: skip


def off(values: np.ndarray) -> float:
    """From the start's."""
    return float(np.linalg.norm(values - values[0], axis=1).max())


CASES = [(against, *what) for against in AGAINST for what in ((1e6, 1.0, 0.01), (1e7, 0.2, 0.001), (1e7, 5.0, 0.05))]


@pytest.mark.short("ball, off centre-1000000.0-*")
@pytest.mark.parametrize(("against", "stiffness", "mass", "step"), CASES)
def test_auto_comes_to_what_short_steps_come_to_and_nothing_is_lost(against, stiffness, mass, step, tmp_path):
    scene, name = meeting(tmp_path, against, {"stiffness": stiffness, "damping": 0.0}, mass, stop_time=0.2, communication_step=step)
    auto = run(scene, name)
    exact = run(scene, name, method="leapfrog", step=auto.stable_step / 32)
    for each in (auto, exact):
        assert each.exchanged > 0.1 * min(mass, 1.0)
        assert off(each.momentum) < 1e-12 * each.exchanged
        most = 3e-12 if each is auto else 1e-10  # in up to 3e4 steps, or 1e6, each of which rounds the place
        assert off(each.angular) < most * each.exchanged
        assert each.energy.max() <= each.energy[0] * (1 + 1e-12)
    error = np.linalg.norm(auto.places[-1] - exact.places[-1], axis=1).max()
    assert right(error / TOLERANCE, auto.stated / TOLERANCE), (error, auto.stated)


MATERIALS = {
    "springs": {"stiffness": 1e6, "damping": 0.0, "internal_damping": 1e-4},
    "elements": {"model": "solid", "youngs_modulus": 1e5, "poissons_ratio": 0.4, "damping": 0.0, "internal_damping": 1e-3},
}


@pytest.mark.short("0.001-elements-box, corner", "0.0-springs-roller")
@pytest.mark.parametrize("against", AGAINST)
@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("step", [0.0, 1e-3, 1e-2])
def test_implicit_steps_keep_the_angular_momentum(step, material, against, tmp_path):
    """Of themselves they lose some, 5e-4 of it at 1 ms."""
    scene, name = meeting(tmp_path, against, MATERIALS[material], 1.0, stop_time=0.2, communication_step=0.01)
    both = run(scene, name, method="sdirk2", step=step)
    rounding = 1e-12 if material == "springs" else 1e-11  # elements' nodes come from the control points
    assert both.exchanged > 0.1
    assert off(both.momentum) < 1e-12 * both.exchanged
    assert off(both.angular) < rounding * both.exchanged
    assert both.energy.max() <= both.energy[0] * (1 + rounding)
