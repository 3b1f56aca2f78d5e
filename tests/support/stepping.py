"""A simulation driven step by step, read as tests compare it: in flat order, all outputs at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from softffd import Scene, Simulation
from softffd.lattice import to_flat


class Stepper(Simulation):
    """A Simulation of a scene or an FMU after its initialization, and readings of it."""

    def __init__(self, scene: Scene | Path, **given: Any):
        super().__init__(scene, **given)
        try:
            self.initialize()
        except BaseException:
            self.close()
            raise

    def restart(self, start_values: dict[str, Any], **setup: float | None) -> None:
        """Resets and initializes once more; forgets the messages so far."""
        super().restart(start_values=start_values, **setup)
        self.initialize()

    @property
    def messages(self) -> list[str]:
        """What the component has said so far."""
        return [message.text for message in self.log]

    def said(self, words: str) -> list[str]:
        """The messages that have these words."""
        return [text for text in self.messages if words in text]

    def energy(self, *parts: str) -> float:
        """The sum of energy.PART, kinetic and elastic by default [J]."""
        return float(self.read(*(f"energy.{part}" for part in parts or ("kinetic", "elastic"))).sum())

    def set(self, values: dict[str, float]) -> None:
        """Sets Real inputs or tunable parameters by name, all in one call."""
        self.block(values).set(list(values.values()))

    def step(self, length: float, *, times: int = 1) -> None:
        """Communication steps of this length [s]."""
        for _ in range(times):
            super().step(length)

    def read(self, *names: str) -> np.ndarray:
        """Values of Real variables by name."""
        return self.block(names).get().copy()

    def outputs(self) -> list[float]:
        """The values of all Real outputs."""
        return self.read(*(v.name for v in self.variables.values() if v.causality == "output" and v.type == "Real")).tolist()

    def points(self) -> np.ndarray:
        """(n, 3) m, flat order."""
        return to_flat(self.positions)

    def point_velocities(self) -> np.ndarray:
        """(n, 3) m/s, flat order."""
        return to_flat(self.velocities)

    def set_forces(self, forces: np.ndarray) -> None:
        """Sets the force inputs of all control points, (n, 3) N, flat order."""
        nx, ny, nz = self.lattice.points
        self.forces = forces.reshape(nz, ny, nx, 3).transpose(2, 1, 0, 3)


def require_same_continuation(scene: Scene) -> None:
    """A run of the scene, in contact where it has obstacles, goes on with the same bits from a saved state, in another instance too."""
    H = scene.experiment.communication_step
    with Stepper(scene) as first, Stepper(scene) as second:
        first.step(H, times=20)
        contacts = [name for name in first.variables if name.endswith(".contacts")]
        while contacts and not any(map(first.number, contacts)):
            assert first.time < 100 * H
            first.step(H)
        state = bytes(first.save())
        second.restore(state)
        assert second.outputs() == first.outputs()
        ends = []
        for stepper in (first, second, first):
            stepper.step(H, times=10)
            ends.append(stepper.outputs())
            stepper.restore(state)
        assert ends[0] == ends[1] == ends[2]
