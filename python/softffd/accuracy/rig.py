"""A scene's FMU on the test rig: packaged once, then run again and again as a host would run it, with various settings of its solver."""

from __future__ import annotations

import math
import re
import time as clock
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from softffd.errors import FmuError
from softffd.fmu.block import Block
from softffd.fmu.variables import has_damping
from softffd.lattice import all_points
from softffd.names import variable_names
from softffd.run.drive import Drive, communication_points, positive
from softffd.run.inputs import Inputs
from softffd.run.simulation import Simulation
from softffd.scene.scene import Scene

ENOUGH = 0.4  # repeats of a run end when their CPU times add up to this [s]
SHORT = 0.02  # a run of less CPU time [s] is repeated up to three times as often
ROUNDING = 1e-13  # fraction of the largest coordinate by which rounding alone may move places at rest; 2e-14 in 5 s
OBSERVED = {"outputs.positions": "all", "outputs.solver": True, "solver.error_estimate": False}
"""Keys of the scene that is run: it has all positions and the solver's counts, and no second run beside it that estimates the error."""
NOTHING_MOVES = "nothing moves; wanted a load, gravity, a start that is not at rest, or a pin or obstacle that moves"


class TooLong(FmuError):
    """A run that took more time than allowed."""


@dataclass(frozen=True)
class Setting:
    """How the solver is set: a method, with a fixed internal step, or with a tolerance."""

    method: str
    step: float = 0.0  # fixed internal step [s]; 0: the step follows the tolerance
    tolerance: float = 0.0  # `solver.tolerance`, relative to the box's largest side; 0: as in the scene

    def __str__(self) -> str:
        return f"{self.method}, {'step' if self.step else 'tolerance'} {self.step or self.tolerance:.3g}{' s' * (self.step > 0)}"


@dataclass(frozen=True, eq=False)
class Run:
    """Result of one setting, run once or several times."""

    positions: np.ndarray  # (T, n, 3) m at the communication points, control points in flat order; or watched outputs (T, w)
    cpu_time: float  # CPU time of the loop over the communication steps, smallest of the repeats [s]
    repeats: int
    steps: int  # internal steps
    rejected: int | None  # rejected internal steps; None where the FMU does not count them


class _Course(Drive):
    """Steps with inputs that follow curves between the communication points: the block `moving` with its `rates` (T - 1, 3, m)."""

    rates: np.ndarray
    moving: Block

    def apply(self, row: int) -> None:
        super().apply(row)
        if self.moving.names:
            self.moving.set_rates(self.rates[row])


class Rig:
    """The test rig, a context manager. Inputs come from the CSV beside the scene, cubic between the communication points."""

    def __init__(self, scene: Scene, *, step: float | None = None, watched: str = ""):
        """step: communication step [s], > 0, by default the scene's own. watched: pattern of the outputs that runs keep instead of
        positions.

        Raises FmuError, and SoftffdError as `package_fmu` does.
        """
        self.communication_step = positive("communication step", step, scene.experiment.communication_step)
        self.stop_time = scene.experiment.stop_time
        self.scene, self._watched = scene, watched
        box = scene.lattice_box
        self.side = max(box.size)
        self.rounding = ROUNDING * max(self.side, *(max(abs(o), abs(o + size)) for o, size in zip(box.origin, box.size, strict=True)))
        self.dashpots = has_damping(scene, "internal_damping")
        self.damped = has_damping(scene, "damping") or self.dashpots
        self.contact = bool(scene.obstacles)
        self.free = any(part.motion == "free" for part in (*scene.solids, *scene.pin))
        self.times = communication_points(self.stop_time, self.communication_step, bytes_each=24 * math.prod(scene.lattice.points))
        source = self._source = Inputs(scene.default_inputs)
        self.driven_names = source.names
        self.input_rates = np.array([source.bends(*pair) for pair in pairwise(self.times)]).reshape(len(self.times) - 1, 3, -1)
        self._open()
        try:
            self._begin(Setting(scene.solver.method))
            self.stable_step = float(self._simulation.number("solver.stable_step"))
        except BaseException:
            self.close()
            raise

    def _open(self) -> None:
        simulation = self._simulation = Simulation(self.scene if self._watched else self.scene.replace(OBSERVED))
        self.methods = list(simulation.variables["solver.method"].items or {})
        component, names = simulation.component, variable_names("position", all_points(self.scene.lattice.points))
        if self._watched:
            names = [name for name in simulation.variables if re.search(self._watched, name)]
        self.names = names
        driven, kept = self._source.driven(component), [component.variable(name) for name in names]
        self._drive = _Course(simulation, self.times, self.communication_step, driven, kept, single=bool(driven))
        self.input_values = self._drive.input_rows[:-1]
        self.input_values[:] = self._source.rows(self.times)
        self._drive.rates, self._drive.moving = self.input_rates, component.block(self.driven_names)

    def _begin(self, setting: Setting) -> None:
        values = {"solver.step": setting.step} | ({"solver.tolerance": setting.tolerance} if setting.tolerance else {})
        self._simulation.restart(method=setting.method, start_values=values, stop_time=self.stop_time)
        self._drive.apply(0)
        self._simulation.initialize()

    def run(self, setting: Setting, *, repeats: int = 1, most: float = math.inf, before: Run | None = None) -> Run:
        """Runs from 0 to the stop time up to `repeats` times (three times as often if short, fewer times if long); keeps the smallest
        time.

        before: a run that this one may turn out to repeat bit by bit (a tolerance that changes nothing); then one run is enough. Raises
        FmuError with the component's own message, and TooLong if a run has taken more than `most` CPU time [s] at a communication point.
        """
        try:
            times: list[float] = []
            while not times or (len(times) < repeats * (3 if times[0] < SHORT else 1) and sum(times) + min(times) < ENOUGH):
                self._begin(setting)
                positions, elapsed = self._timed(most)
                times.append(elapsed)
                if before is not None and np.array_equal(positions, before.positions):
                    break
            number, rejected = self._simulation.number, "solver.rejected"
            counted = int(number(rejected)) if rejected in self._simulation else None
            return Run(positions, min(times), len(times), int(number("solver.steps")), counted)
        except FmuError:
            self._simulation.close()
            self._open()
            raise

    def _timed(self, most: float) -> tuple[np.ndarray, float]:
        began = clock.process_time()
        for done in self._drive.run():
            if clock.process_time() - began > most:
                raise TooLong(f"given up at {self.times[done]:.3g} s: more than {most:.3g} s of CPU time")
        elapsed = clock.process_time() - began
        _, rows = self._drive.outputs["Real"]
        if not np.isfinite(rows).all():
            raise FmuError("the outputs are not finite" if self._watched else "the positions are not finite")
        return rows.reshape((len(rows), -1) if self._watched else (len(rows), -1, 3)).copy(), elapsed

    def close(self) -> None:
        """Frees the FMU and its files."""
        self._simulation.close()

    def __enter__(self) -> Rig:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()
