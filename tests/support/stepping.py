"""A simulation driven step by step, read as tests compare it: in flat order, all outputs at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from softffd import Scene, Simulation
from softffd.lattice import to_flat


class Stepper:
    """`sim`, a Simulation of a scene or an FMU after its initialization, and readings of it; use as a context manager."""

    def __init__(self, scene: Scene | Path, *, start_values: dict[str, Any] | None = None, **setup: float | None):
        """setup: start_time, stop_time, tolerance."""
        self.sim = Simulation(scene, start_values=start_values, **setup)
        try:
            self.sim.initialize()
        except BaseException:
            self.sim.close()
            raise

    def restart(self, start_values: dict[str, Any], start_time: float = 0.0, stop_time: float | None = None, **setup: float | None) -> None:
        """Resets and initializes once more; forgets the messages so far."""
        self.sim.restart(start_values=start_values, start_time=start_time, stop_time=stop_time, **setup)
        self.sim.initialize()

    @property
    def time(self) -> float:
        """s; may be set, to a wrong one too"""
        return self.sim.time

    @time.setter
    def time(self, time: float) -> None:
        self.sim.time = time

    @property
    def messages(self) -> list[str]:
        """What the component has said so far."""
        return [message.text for message in self.sim.log]

    def said(self, words: str) -> list[str]:
        """The messages that have these words."""
        return [text for text in self.messages if words in text]

    def energy(self, *parts: str) -> float:
        """The sum of energy.PART, kinetic and elastic by default [J]."""
        return float(self.read(*(f"energy.{part}" for part in parts or ("kinetic", "elastic"))).sum())

    def methods(self) -> list[tuple[str, str]]:
        """The methods that took over and why, in their order."""
        return self.sim.methods()

    def save(self) -> Any:
        """This moment."""
        return self.sim.save()

    def restore(self, state: Any) -> None:
        """Back to a saved moment."""
        self.sim.restore(state)

    def set(self, values: dict[str, float]) -> None:
        """Sets Real inputs or tunable parameters by name, all in one call."""
        self.sim.block(values).set(list(values.values()))

    def set_rates(self, rates: dict[str, float | list[float]]) -> None:
        """Sets the first time derivatives of Real inputs for the next step, or lists of derivatives from the first."""
        self.sim.set_rates(rates)

    def step(self, length: float, *, times: int = 1) -> None:
        """Communication steps of this length [s]."""
        for _ in range(times):
            self.sim.step(length)

    def read(self, *names: str) -> np.ndarray:
        """Values of Real variables by name."""
        return self.sim.block(names).get().copy()

    def outputs(self) -> list[float]:
        """The values of all Real outputs."""
        return self.read(*(v.name for v in self.sim.variables.values() if v.causality == "output" and v.type == "Real")).tolist()

    def integer(self, name: str) -> int:
        """The value of an Integer variable."""
        return self.sim.number(name)

    def vector(self, name: str) -> np.ndarray:
        """The components .x .y .z of a variable."""
        return np.array(self.sim.vector(name))

    def positions(self) -> np.ndarray:
        """(n, 3) m, flat order."""
        return to_flat(self.sim.positions)

    def velocities(self) -> np.ndarray:
        """(n, 3) m/s, flat order."""
        return to_flat(self.sim.velocities)

    def set_forces(self, forces: np.ndarray) -> None:
        """Sets the force inputs of all control points, (n, 3) N, flat order."""
        nx, ny, nz = self.sim.lattice.points
        self.sim.forces = forces.reshape(nz, ny, nx, 3).transpose(2, 1, 0, 3)

    def __enter__(self) -> Stepper:
        return self

    def __exit__(self, *_exception) -> None:
        self.sim.close()


def require_same_continuation(scene: Scene) -> None:
    """A run of the scene, in contact where it has obstacles, goes on with the same bits from a saved state, in another instance too."""
    H = scene.experiment.communication_step
    with Stepper(scene) as first, Stepper(scene) as second:
        first.step(H, times=20)
        contacts = [name for name in first.sim.variables if name.endswith(".contacts")]
        while contacts and not any(map(first.integer, contacts)):
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
