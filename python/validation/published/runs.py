"""Runs of bars, beams and blocks. Builds scenes of springs and of solids from the same numbers, and brings a body to rest on demand."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from typing import Any

import numpy as np

from softffd import Scene, Simulation
from softffd.errors import SoftffdError
from softffd.scene.scene import scene_from
from validation.published.cases import Body

Size = tuple[float, float, float]
WALL = {"name": "wall", "points": "x-"}
AT_REST = 1e-6
"""Largest relative change of the quantity read, between two readings, of a body that counts as at rest"""


def scene_of(body: Body, size: Size, modulus: float, density: float, **sections: Any) -> Scene:
    """Returns a scene of a box with this size [m], modulus [Pa] and density [kg/m3]. sections: further sections, as in a scene file."""
    material = {"model": body.model, "youngs_modulus": modulus} | sections.pop("material", {})
    if body.model == "solid":
        material |= {"poissons_ratio": body.ratio}
    always = {
        "lattice": {"points": list(body.points), "size": list(size)},
        "material": material,
        "mass": {"density": density},
        "outputs": {"solver": True},
        "solver": {"most_work": 1e9} | sections.pop("solver", {}),
    }
    return scene_from(always | sections)


def drag(body: Body, size: Size, density: float, rate: float) -> dict[str, float]:
    """Returns the material key "damping" [N s/m], with which nodal viscous drag slows a body at about `rate` [1/s]."""
    return {"damping": rate * density * math.prod(size) / math.prod(body.points)}


def slowest_bending(size: Size, modulus: float, density: float) -> float:
    """Returns the lowest Euler-Bernoulli frequency [rad/s] of a beam along x, clamped at one end and bent along z."""
    length, _, height = size
    return 1.87510406871**2 / length**2 * height * math.sqrt(modulus / density / 12)


class Course:
    """A simulation that counts its internal steps and the time of the step calls [s]."""

    def __init__(self, scene: Scene, start_values: dict[str, float] | None = None):
        self.sim = Simulation(scene, start_values=start_values)
        self.seconds = 0.0
        self._scene = scene

    def __enter__(self) -> Course:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.sim.close()

    @property
    def steps(self) -> int:
        return int(self.sim.number("solver.steps"))

    def step(self, length: float) -> None:
        """Makes a communication step of this length [s]."""
        begin = clock.perf_counter()
        self.sim.step(length)
        self.seconds += clock.perf_counter() - begin

    def rest(self, read: Callable[[], float], length: float, most: int = 400) -> float:
        """Makes steps of this length [s] until a reading equals the two before it within AT_REST, and returns it. Raises SoftffdError after
        `most` steps."""
        before = [math.inf, math.inf]
        for _ in range(most):
            self.step(length)
            value = read()
            if all(abs(value - each) <= AT_REST * abs(value) for each in before):
                return value
            before = [before[1], value]
        raise SoftffdError(f"not at rest after {most} steps of {length:g} s: {before[0]:g}, {before[1]:g}")

    def end(self) -> np.ndarray:
        """Returns the mean position (3,) [m] of the face at the far end along x."""
        _, across, along = self._shares()
        mean: np.ndarray = np.einsum("j,k,jkc->c", across, along, self.sim.positions[-1])
        return mean

    def centre(self) -> np.ndarray:
        """Returns the centre of the volume (3,) [m]."""
        mean: np.ndarray = np.einsum("i,j,k,ijkc->c", *self._shares(), self.sim.positions)
        return mean

    def _shares(self) -> list[np.ndarray]:
        return [shares(n, self._scene.is_solid) for n in self._scene.lattice_box.points]


def shares(n: int, of_solid: bool) -> np.ndarray:
    """Returns the weights (n,) of the n control points of an edge in the mean over the edge. Without a solid, the end points have half the
    weight of the others, like point masses. An edge of a solid consists of Bezier curves of four points each, with equal weights."""
    points = 4 if of_solid else 2
    patches = (n - 1) // (points - 1)
    found: np.ndarray = np.zeros(n)
    for patch in range(patches):
        first = patch * (points - 1)
        found[first : first + points] += 1 / (points * patches)
    return found
