"""The free bodies of a scene under test, by their outputs: where they are, and what energy they have."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from softffd.fmu.block import Block
from softffd.rotation import matrices
from softffd.scene.rigid import Solid
from softffd.scene.scene import Scene


class FreeBodies:
    """Those of a scene, obstacles first; block: of the variables of a name."""

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
        """Its own (3, 3), in rows."""
        return matrices(self._get(name, "orientation")[None])[0].T

    def place(self, name: str) -> np.ndarray:
        """Of its centre (3,) [m]."""
        return self._get(name, "position")

    @property
    def marks(self) -> np.ndarray:
        """Of each its centre and points on its three axes, half the largest side of the object's box away (4 n, 3) [m]."""
        each = [self.place(name) + self._reach * np.vstack([np.zeros(3), self.axes(name)]) for name in self.names]
        return np.concatenate(each) if each else np.zeros((0, 3))

    def energy(self) -> float:
        """Kinetic, and of their weight [J]."""
        total = 0.0
        for name, mass, inertia, guided in zip(self.names, self._mass, self._inertia, self._guided, strict=True):
            velocity = self._get(name, "velocity")
            total += mass * (velocity @ velocity / 2 - self._gravity @ self.place(name))
            if not guided:
                spin = self.axes(name) @ self._get(name, "angular_velocity")
                total += inertia @ spin**2 / 2
        return float(total)
