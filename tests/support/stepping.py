"""An FMU driven step by step, for tests that change something on the way."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from softffd import Scene, package_fmu
from softffd.fmu.component import Component


class Stepper:
    """One instance of a scene's FMU between initialization and the end; use as a context manager."""

    def __init__(
        self, scene: Scene, *, start_values: dict[str, Any] | None = None, start_time: float = 0.0, stop_time: float | None = None
    ):
        with TemporaryDirectory(prefix="softffd-") as folder:
            self._component = Component(package_fmu(scene, Path(folder) / "scene.fmu"))
        nx, ny, nz = scene.lattice.points
        self._grid = [f"[{i},{j},{k}].{axis}" for k in range(nz) for j in range(ny) for i in range(nx) for axis in "xyz"]
        self.begin(start_values or {}, start_time, stop_time)

    def begin(
        self, start_values: dict[str, Any], start_time: float = 0.0, stop_time: float | None = None, *, tolerance: float | None = None
    ) -> None:
        """Initializes. stop_time, tolerance: for fmi2SetupExperiment."""
        self.time = start_time
        if tolerance is None:
            self._component.initialize(start_values, start_time=start_time, stop_time=stop_time)
        else:
            self._component.set_start_values(start_values)
            self._component._slave.setupExperiment(tolerance=tolerance, startTime=start_time, stopTime=stop_time)
            self._component._slave.enterInitializationMode()
        self._component.exit_initialization()

    def restart(self, start_values: dict[str, Any], start_time: float = 0.0, stop_time: float | None = None, **setup: float | None) -> None:
        """Resets and initializes once more, as `begin` does; forgets the messages so far."""
        self._component.reset()
        self._component.messages.clear()
        self.begin(start_values, start_time, stop_time, **setup)

    @property
    def messages(self) -> list[str]:
        """What the component has said so far."""
        return [message.text for message in self._component.messages]

    def methods(self) -> list[tuple[str, str]]:
        """The methods that took over and why, in their order, from the messages "method: reason; internal step ..."."""
        said = [text.split("; internal step")[0] for text in self.messages if "; internal step" in text]
        return [tuple(text.split(": ", 1)) for text in said]

    def save(self) -> Any:
        """The FMU state of this moment."""
        return self.time, self._component._slave.getFMUstate()

    def restore(self, state: Any) -> None:
        """Back to a saved moment."""
        self.time = state[0]
        self._component._slave.setFMUstate(state[1])

    def set(self, values: dict[str, float]) -> None:
        """Sets Real inputs or tunable parameters by name."""
        block = self._component.block(list(values))
        block.values[:] = list(values.values())
        self._component.set(block)

    def set_rates(self, rates: dict[str, float | list[float]]) -> None:
        """Sets the first time derivatives of Real inputs for the next step, or lists of derivatives from the first."""
        block = self._component.block(list(rates))
        self._component.set_rates(block, np.array(list(rates.values()), dtype=float).T)

    def step(self, length: float, *, times: int = 1) -> None:
        """Communication steps of this length [s]."""
        for _ in range(times):
            self._component.do_step(self.time, length)
            self.time += length

    def read(self, *names: str) -> np.ndarray:
        """Values of Real variables by name."""
        block = self._component.block(list(names))
        self._component.get(block)
        return block.values.copy()

    def outputs(self) -> list[float]:
        """The values of all Real outputs."""
        return self.read(*(variable.name for variable in self._component.variables("output"))).tolist()

    def integer(self, name: str) -> int:
        """The value of an Integer variable."""
        block = self._component.block([name], real=False)
        self._component.get(block)
        return int(block.values[0])

    def vector(self, name: str) -> np.ndarray:
        """The components .x .y .z of a variable."""
        return self.read(*(f"{name}.{axis}" for axis in "xyz"))

    def positions(self) -> np.ndarray:
        """(n, 3) m, flat order."""
        return self.read(*(f"position{place}" for place in self._grid)).reshape(-1, 3)

    def velocities(self) -> np.ndarray:
        """(n, 3) m/s, flat order."""
        return self.read(*(f"velocity{place}" for place in self._grid)).reshape(-1, 3)

    def set_forces(self, forces: np.ndarray) -> None:
        """Sets the force inputs of all control points, (n, 3) N, flat order."""
        self.set(dict(zip((f"force{place}" for place in self._grid), forces.ravel().tolist(), strict=True)))

    def __enter__(self) -> Stepper:
        return self

    def __exit__(self, *_exception) -> None:
        self._component.close()
