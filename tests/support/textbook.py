"""Cases of textbook mechanics: a block, how a rigid one moves, and the verdict on a run beside it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from readings import points
from rigid import G
from scenes import box
from softffd import Result, Scene, simulate
from softffd.fmu.package import scene_masses
from softffd.lattice import to_flat
from softffd.rotation import turned
from validation import shapes as bodies

TOLERANCE = 1e-4
"""The default one: of the box's largest side."""
PROMISED = 10
"""Tolerances within which a run is right without a word."""
HONEST = 5
"""A stated error may be so many times too small or too large."""
STATED = re.compile(r"at time (\S+) s: .*may be wrong by (\S+) m")


@dataclass(frozen=True)
class Body:
    """What a rigid body has of the scene's: control points (n, 3) [m] and their masses (n,) [kg]."""

    rest: np.ndarray
    mass: np.ndarray

    @property
    def centre(self) -> np.ndarray:
        """Of mass (3,) [m]"""
        return self.mass @ self.rest / self.mass.sum()

    def at(self, x: float) -> Body:
        """Moved along x [m]."""
        return Body(self.rest + np.array([x, 0.0, 0.0]), self.mass)

    def inertia(self, axis: int) -> float:
        """About an axis of the world through the centre, per mass [m2]."""
        arms = np.delete(self.rest - self.centre, axis, axis=1)
        return float(self.mass @ (arms**2).sum(axis=1) / self.mass.sum())


@dataclass(frozen=True)
class Motion:
    """How a rigid body goes: the place of its centre of mass (T, 3) [m], NaN along what is not compared, and its turn, a rotation vector
    (T, 3) [rad] from the rest shape; None: not compared."""

    centre: np.ndarray
    turn: np.ndarray | None = None


@dataclass(frozen=True)
class Case:
    """A scene by its keys and how a rigid body moves in it."""

    name: str
    keys: dict[str, Any]
    motion: Callable[[np.ndarray, Body], Motion]
    """At times (T,) [s], of a body"""
    inputs: Callable[[float], dict[str, float]] | None = None
    interpolation: str = "linear"

    def scene(self, folder: Path) -> Scene:
        """With the mesh, where it has one, written to a folder."""
        keys = dict(self.keys)
        if shape := keys.pop("shape", None):
            keys["mesh"] = {"file": bodies.write(folder / "block.obj", shape)}
        return box(**keys)


def require_right(case: Case, folder: Path) -> None:
    """At every communication point the block is where a rigid one is, or a warning has said by how much it is not."""
    scene = case.scene(folder)
    result = simulate(scene, inputs=case.inputs, interpolation=case.interpolation)
    allowed = TOLERANCE * max(scene.lattice_box.size)
    errors, words = error(case, scene, result) / allowed, stated(result) / allowed
    wrong = [each for each in zip(errors, result.time, words, strict=True) if not right(each[0], each[2])]
    assert not wrong, "off by {:.1f} tolerances at {:g} s; stated: {:.1f}".format(*max(wrong))


def error(case: Case, scene: Scene, result: Result) -> np.ndarray:
    """By how much the rigid motion of the control points is off at each communication point (T,) [m]."""
    body, x = Body(to_flat(scene.lattice_box.rest()), scene_masses(scene).mass), to_flat(result.positions)
    motion, weight = case.motion(result.time, body), body.mass / body.mass.sum()
    centre = np.einsum("p,tpc->tc", weight, x)
    off = np.where(np.isnan(motion.centre), 0.0, centre - motion.centre)
    if motion.turn is None:
        return np.linalg.norm(off, axis=1)
    arms = body.rest - body.centre
    u, _, vt = np.linalg.svd(np.einsum("tpi,p,pj->tij", x - centre[:, None], weight, arms))
    u[..., -1] *= np.linalg.det(u @ vt)[:, None]
    found = np.einsum("tij,pj->tpi", u @ vt, arms)
    wanted = turned(arms[None], motion.turn[:, None])
    return np.linalg.norm(found - wanted + off[:, None], axis=2).max(axis=1)


def stated(result: Result) -> np.ndarray:
    """The largest error that warnings stated up to each communication point (T,) [m]."""
    words = np.zeros(len(result.time))
    for found in filter(None, (STATED.search(message.text) for message in result.log)):
        words[result.time >= float(found[1]) - 1e-6] = float(found[2])
    return words


def beside_short_steps(scene: Scene, parts: int) -> tuple[float, float]:
    """Of auto, what it is off by at the end from leapfrog at so small a part of the stable step, and what it has stated, in tolerances of a
    box of 1 m."""
    auto = simulate(scene)
    h = float(auto.outputs["solver.stable_step"].min()) / parts
    exact = simulate(scene, start_values={"solver.method": "leapfrog", "solver.step": h})
    error = np.linalg.norm(points(auto)[-1] - points(exact)[-1], axis=1).max()
    return float(error) / TOLERANCE, float(stated(auto)[-1]) / TOLERANCE


def right(error: float, stated: float) -> bool:
    """Of errors in tolerances."""
    return bool(error <= PROMISED or error / HONEST <= stated <= error * HONEST)


CUBE = ((1.0, 1.0, 1.0), (4, 4, 4))
BRICK = ((0.4, 0.3, 0.2), (4, 4, 4))
SMALL = ((0.3, 0.2, 0.2), (3, 3, 3))
TOWER = ((0.2, 0.3, 0.5), (3, 3, 4))
FAR = 60.0
"""m; the size of obstacles that are as good as planes"""

OBSTACLES: dict[str, Callable[..., dict[str, Any]]] = {
    "plane": lambda **k: {"plane": [{"name": "ground", **k}]},
    "surface": lambda **k: {"plane": [{"name": "ground", **k}]},
    "box": lambda **k: {"box": [{"name": "ground", "size": [FAR, FAR, 1.0], "point": [0.0, 0.0, -0.5], **k}]},
    "disk": lambda **k: {"cylinder": [{"name": "ground", "radius": FAR, "length": 1.0, "point": [0.0, 0.0, -0.5], **k}]},
}
"""What lies below z = 0, met by control points (plane) and by the surface of a block"""


def rails(size, **keys) -> dict[str, Any]:
    """Two cylinders along x under the lower edges of a block."""
    far = {"radius": 0.3, "length": FAR, "normal": [1.0, 0.0, 0.0]}
    return {"cylinder": [{"name": n, **far, "point": [0.0, s * size[1] / 2, -0.3], **keys} for n, s in (("left", 1), ("right", -1))]}


def block(
    body: tuple = CUBE,
    *,
    stiffness: float,
    step: float,
    on: str = "plane",
    count: int = 2,
    kilograms: float = 1.0,
    below: dict[str, Any] | None = None,
    **keys: Any,
) -> dict[str, Any]:
    """Keys of an undamped block, its lower face around the origin, under gravity; `on` an obstacle with the keys `below`."""
    size, points = body
    origin = [-size[0] / 2, -size[1] / 2, 0.0]
    found = {"points": list(points), "stiffness": stiffness, "damping": 0.0, "communication_step": step, "gravity": [0.0, 0.0, -G]}
    found |= {"mass": {"total": kilograms}, **keys}
    if on in ("plane", None):
        found |= {"origin": origin, "size": list(size)}
    else:
        vertices, faces = bodies.cube(count, 0.0)
        found |= {"shape": (vertices * size + origin, faces), "contact": {"of": "surface"}}
    if on is not None:
        found |= rails(size, **(below or {})) if on == "rails" else OBSTACLES[on](**(below or {}))
    return found


def called(name: str, keys: dict[str, Any]) -> str:
    """The name of a case, which says whether it is damped."""
    return name + ("-damped" if "internal_damping" in keys else "")


def along(way: np.ndarray, body: Body, axis: int = 0) -> Motion:
    """The centre goes this way (T,) [m] along an axis, and not to the side."""
    centre = np.full((len(way), 3), np.nan)
    centre[:, :2] = body.centre[:2]
    centre[:, axis] = body.centre[axis] + way
    return Motion(centre)


def tilted(degrees: float) -> list[float]:
    """Gravity over a slope that is z = 0 and falls towards x [m/s2]."""
    a = np.radians(degrees)
    return [float(G * np.sin(a)), 0.0, float(-G * np.cos(a))]
