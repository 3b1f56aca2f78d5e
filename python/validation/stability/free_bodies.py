"""The free bodies of a scene under test. Their outputs give positions and energies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from softffd.fmu.block import Block
from softffd.rotation import matrices
from softffd.scene.rigid import Solid
from softffd.scene.scene import Scene


class FreeBodies:
    """The free bodies of a scene, obstacles first. block: returns the block of the variables with a name."""

    def __init__(self, scene: Scene, block: Callable[[str], Block]):
        solids = [each for each in scene.obstacles if isinstance(each, Solid) and each.motion == "free"]
        pins = [pin for pin in scene.pin if pin.motion == "free"]
        self.names = [str(each.part) for each in (*solids, *pins)]
        self._guided = [each.guide is not None for each in (*solids, *pins)]
        self._mass = [*(each.own_mass() for each in solids), *(pin.mass or 0.0 for pin in pins)]
        moments = [*(each.own_inertia() for each in solids), *(pin.inertia or (0.0, 0.0, 0.0) for pin in pins)]
        self._inertia = [np.array(each) for each in moments]
        self._gravity = np.array(scene.environment.gravity or (0.0, 0.0, 0.0))
        self._reach = max(scene.lattice_box.size) / 2
        self._block = block

    def _get(self, name: str, what: str) -> np.ndarray:
        return self._block(f"{name}.{what}").get().copy()

    def axes(self, name: str) -> np.ndarray:
        """Returns the axes of a free body as rows (3, 3)."""
        return matrices(self._get(name, "orientation")[None])[0].T

    def place(self, name: str) -> np.ndarray:
        """Returns the position of the centre of a free body (3,) [m]."""
        return self._get(name, "position")

    @property
    def marks(self) -> np.ndarray:
        """Positions (4 n, 3) [m]: for each body the centre, and a point on each axis at half the largest side of the object's box."""
        each = [self.place(name) + self._reach * np.vstack([np.zeros(3), self.axes(name)]) for name in self.names]
        return np.concatenate(each) if each else np.zeros((0, 3))

    def energy(self) -> float:
        """Returns the kinetic and gravity energy of all free bodies [J]."""
        total = 0.0
        for name, mass, inertia, guided in zip(self.names, self._mass, self._inertia, self._guided, strict=True):
            velocity = self._get(name, "velocity")
            total += mass * (velocity @ velocity / 2 - self._gravity @ self.place(name))
            if not guided:
                spin = self.axes(name) @ self._get(name, "angular_velocity")
                total += inertia @ spin**2 / 2
        return float(total)
