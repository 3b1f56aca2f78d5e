"""Soft bodies in the loop of a physics engine: the motion of its bodies goes in, mean wrenches over the step come back.

A step is repeated from saved states until motion and wrenches agree. In each trial the engine does the step under constant wrenches. The
soft bodies do the step while their pins and obstacles move at constant velocity, from where the last step left them to the engine's poses.
The next trial takes wrenches from Anderson acceleration (Walker & Ni 2011). At the end the engine does the step under the wrenches that
the soft bodies gave. Impulses are therefore equal and opposite whatever the tolerance; the next step takes in the difference of motion
that the tolerance leaves.
"""

import warnings
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Protocol

import numpy as np

from softffd.errors import FmuError
from softffd.rotation import matrix_of, quaternions, turned, vector_of
from softffd.run.simulation import Simulation, State
from softffd.spelling import one_number

Push = tuple[int, np.ndarray, np.ndarray]
"""A body of the engine, a point (3,) in its frame [m], and the force and torque about it (6,) [N, N.m], world axes"""
Moment = tuple[Any, list[State], np.ndarray, np.ndarray]
"""The states of engine and soft bodies, the poses of all parts (m, 4, 4), and the wrenches on them (m, 6)"""
ROUNDING = 1e-14
"""Difference of poses that rounding leaves, relative to their largest number [1]"""


class Engine(Protocol):
    """What a bridge asks of a physics engine. Poses are matrices (4, 4) from a body's frame to the world [m]; bodies are numbered."""

    step: float  # the engine's own step [s]

    @property
    def time(self) -> float: ...  # current time [s]
    def pose(self, body: int) -> np.ndarray: ...  # moves by the mean of the velocities before and after a step
    def advance(self, pushes: Sequence[Push]) -> None: ...  # does one of the engine's own steps under these pushes
    def save(self) -> Any: ...  # returns the state of this moment
    def restore(self, state: Any) -> None: ...  # returns to this state; the engine continues with the same bits


class Part:
    """A pin or an obstacle of a soft body whose motion is prescribed by a body of the engine.

    path: "pin.NAME", "box.NAME". at: frame of the part (4, 4) in the body's frame; None: a pin is attached to the body as both lie now.
        FmuError if the scene has no such part, or if not all of the part's pose and velocities are inputs.
    """

    POSE: ClassVar = {"plane": ["point", "normal"], "sphere": ["point"], "cylinder": ["point", "normal"], "box": ["point", "rotation"],
                      "pin": ["position", "orientation"]}  # fmt: skip

    def __init__(self, simulation: Simulation, path: str, engine: Engine, body: int, at: np.ndarray | None):
        self.body, self.words = body, [*self.POSE[path.partition(".")[0]], "velocity", "angular_velocity"]
        self.inputs = simulation.block([f"{path}.{word}" for word in self.words])
        if fixed := [name for name in self.inputs.names if simulation.variables[name].causality != "input"]:
            wanted = str(self.words).replace("'", '"')
            raise FmuError(f'{fixed[0]}: wanted an input: give {path} motion = "input" and inputs = {wanted} in the scene')
        self.wrench = simulation.block([f"{path}.reaction", f"{path}.torque"])
        if at is None:
            now = np.eye(4)
            now[:3, 3], now[:3, :3] = simulation[f"{path}.position"], matrix_of(simulation[f"{path}.orientation"])
            at = np.linalg.inv(engine.pose(body)) @ now
        self.at = at
        self.put(engine.pose(body) @ at, np.zeros(6))

    def put(self, pose: np.ndarray, velocity: np.ndarray) -> None:
        """Sets the inputs of the part: a pose (4, 4) [m], and velocities (6,) [m/s, rad/s]."""
        turn = pose[:3, :3]
        told = {"normal": turn[:, 2], "rotation": vector_of(turn), "orientation": quaternions(turn[None])[0]}
        self.inputs.set(np.concatenate([told.get(word, pose[:3, 3]) for word in self.words[:-2]] + [velocity]))


class Bridge:
    """Soft bodies and an engine as one system: `step` does a step of all, `save` and `restore` keep and bring back the states of all.

    parts: parts of each soft body. step: communication step [s] of the soft bodies, a multiple or a whole fraction of the engine's step;
        the step of the bridge is the longer of the two. tolerance: a trial of a step is kept if the wrenches that it takes and gives
        differ by at most this, relative to the largest, > 0, or if they move the engine alike but for rounding. trials: most trials of a
        step, >= 1; the last one is kept, and the first step that does not meet the tolerance gives a warning.
    """

    def __init__(self, engine: Engine, parts: Mapping[Simulation, Sequence[Part]], step: float, tolerance: float, trials: int):
        step, tolerance = one_number("step", step), one_number("tolerance", tolerance)
        ratios = (step / engine.step, engine.step / step) if 0 < step < np.inf else (0.0, 0.0)
        self._longer, self._shorter = (max(1, round(ratio)) for ratio in ratios)
        if not (any(ratios) and np.isclose(step * self._shorter, engine.step * self._longer, rtol=1e-9, atol=0)):
            raise FmuError(f"step: wanted a multiple or a whole fraction of the engine's step, {engine.step:g} s, got {step:g}")
        if not (tolerance > 0 and trials >= 1):
            raise FmuError(f"wanted tolerance > 0 and trials >= 1, got {tolerance:g} and {trials}")
        self.engine, self.parts, self._step, self.tolerance, self.most = engine, parts, step, tolerance, trials
        self._all = [part for each in parts.values() for part in each]
        self._poses, self._wrenches, self._time = self._reached(), np.zeros((len(self._all), 6)), engine.time
        self.length = step * self._shorter
        """Length of a step of the bridge [s]"""
        self._told = False
        self.trials, self.residual = 0, 0.0
        """Of the last step: the number of trials, and the difference of wrenches that was left, relative to the largest wrench"""

    def step(self) -> None:
        """Does one step. FmuError if a soft body or the engine refuses it, or if the engine alone was set back; all are then as before."""
        if self.engine.time != self._time:
            raise FmuError(f"wanted the engine at {self._time:g} s as the soft bodies are, got {self.engine.time:g} s: go back by restore")
        before, pushes, answers, misses = self.save(), self._wrenches, list[np.ndarray](), list[np.ndarray]()
        try:
            for trial in range(self.most):
                if trial:
                    pushes = _accelerated(answers, misses)
                    self.restore(before)
                self._advance(pushes)
                poses = self._reached()
                answers.append(self._answer(poses))
                misses.append(answers[-1] - pushes)
                self.trials, self.residual = trial + 1, abs(misses[-1]).max(initial=0) / (abs(answers[-1]).max(initial=0) or 1)
                self.engine.restore(before[0])
                self._advance(answers[-1])
                if self.residual <= self.tolerance or abs(self._reached() - poses).max(initial=0) <= ROUNDING * abs(poses).max(initial=0):
                    break
            else:
                self._tell()
        except BaseException:
            self.restore(before)
            raise
        self._poses, self._wrenches, self._time = poses, answers[-1], self.engine.time

    def save(self) -> Moment:
        """Returns the state of this moment, which can be restored as often as wanted."""
        return self.engine.save(), [simulation.save() for simulation in self.parts], self._poses, self._wrenches

    def restore(self, moment: Moment) -> None:
        """Returns to a saved moment; the run continues with the same bits."""
        state, states, self._poses, self._wrenches = moment
        self.engine.restore(state)
        for simulation, each in zip(self.parts, states, strict=True):
            simulation.restore(each)
        self._time = self.engine.time

    def _tell(self) -> None:
        """Warns, once, that the trials did not meet the tolerance; not with one trial alone, which is asked for where they need not."""
        if self.most > 1 and not self._told:
            text = f"of the largest wrench the step at {self._time:g} s leaves {self.residual:.2g} after {self.most} trials"
            warnings.warn(f"{text}: take a shorter step, or more trials; bridge.residual has that of each step", stacklevel=3)
            self._told = True

    def _reached(self) -> np.ndarray:
        return np.array([self.engine.pose(part.body) @ part.at for part in self._all]).reshape(-1, 4, 4)

    def _advance(self, wrenches: np.ndarray) -> None:
        for _ in range(self._longer):
            self.engine.advance([(part.body, part.at[:3, 3], wrench) for part, wrench in zip(self._all, wrenches, strict=True)])

    def _answer(self, poses: np.ndarray) -> np.ndarray:
        """Returns the mean wrenches (m, 6) of the soft bodies on the way to these poses."""
        found = np.zeros((len(poses), 6))
        for k in range(self._shorter):
            for part, start, end in zip(self._all, self._poses, poses, strict=True):
                way = np.append(end[:3, 3] - start[:3, 3], vector_of(end[:3, :3] @ start[:3, :3].T))
                pose = start.copy()
                pose[:3, 3] += way[:3] * (k / self._shorter)
                pose[:3, :3] = turned(start[:3, :3].T, way[3:] * (k / self._shorter)).T
                part.put(pose, way / self.length)
            for simulation in self.parts:
                simulation.step(self._step)
            found += [part.wrench.get() for part in self._all]
        return found / self._shorter


def _accelerated(answers: Sequence[np.ndarray], misses: Sequence[np.ndarray]) -> np.ndarray:
    if len(answers) == 1:
        return answers[0]
    changes, of_misses = (np.transpose([(each[-1] - other).ravel() for other in each[:-1]]) for each in (answers, misses))
    return answers[-1] - (changes @ np.linalg.lstsq(of_misses, misses[-1].ravel(), rcond=None)[0]).reshape(answers[-1].shape)
