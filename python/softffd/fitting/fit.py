"""Fits parameters of a scene or an FMU to measured curves by least squares (SciPy), with the uncertainty that the data leave.

The Jacobian comes from differences of runs. The curve of a run is right to the solver's tolerance only, and its error jumps where a
solver chooses other steps. So the noise of the curves is measured first, by fourth-order differences of five runs close together (More &
Wild 2011). A difference quotient then takes the step that balances the noise with the curvature, 2 sqrt(noise / slope).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from softffd.errors import FmuError, SoftffdError
from softffd.fitting.curve import Curve
from softffd.fitting.estimate import Jacobian, estimate
from softffd.fitting.experiment import Experiment, experiment_of
from softffd.fitting.measured import Data
from softffd.fitting.parameters import Parameter, values_of
from softffd.fitting.result import Fit
from softffd.run.inputs import Source
from softffd.run.sweep import require_workers
from softffd.run.sweep_runs import Make, runner
from softffd.run.tables import package
from softffd.spelling import one_number

if TYPE_CHECKING:
    from softffd.scene.scene import Scene

Progress = Callable[[int, float], object]

FIRST_STEP = 1e-2  # step of the first differences, in coordinates of the parameters: the root of the usual tolerance, 1e-4
LEAST_STEP, MOST_STEP = 1e-5, 0.1  # bounds of the steps of all other differences
CLOSE = 1e-4
"""The fit ends if an iteration changes the sum of squares by less than this fraction over the number of rows: a hundredth of a standard
error"""
SHORT = 1e-7  # or if the step is shorter than this fraction of the coordinates
MOST_ITERATIONS = 50


def fit(
    scene_or_fmu: Scene | str | Path | Sequence[Scene | str | Path], data: Data | Sequence[Data], match: str,
    vary: Iterable[str] | Mapping[str, float | None], *, against: str | None = None, recorded: bool = False,
    noise: float | Sequence[float] | None = None, stop_time: float | None = None, step: float | None = None,
    start_values: Mapping[str, Any] | None = None, inputs: Source | None = None, tolerance: float | None = None, method: str | None = None,
    jobs: int | None = None, executor: Executor | None = None, progress: Progress | None = None,
) -> Fit:  # fmt: skip
    """Returns the parameters with which runs come nearest to a measured curve, by the sum of squares, with their standard errors.

    scene_or_fmu: a scene, the path of its file, the name of a shipped one, or the path of an FMU; or a list of them, one for each test of
        a list in `data`: all tests share the parameters.
    data: the measured columns in the units of the FMU's variables and by their names: a CSV file, a structured array, a DataFrame, or a
        dict; or a list with an item for each test. The column `time` [s] is the time of the run. Columns that are inputs of the FMU drive
        the runs; if there are none, `inputs` drives them.
    match: the output that was measured, which is also the name of its column.
    vary: names of fixed or tunable parameters, or start values by name. A missing start value is the FMU's own, for several tests the
        first FMU's.
    against: an input or output that replaces time, such as a displacement. Its column must follow the branches of the run, loading and
        unloading, but needs no time.
    recorded: whether the data are outputs of a run, as in result.csv. Reactions and torques in such data are means of the steps that end
        at their times. The values of an instrument belong to their times; the means of the runs then count in the middle of their steps.
    noise: standard deviations of the tests, if they differ, or the one of one test; only their ratios count.
    stop_time: of the runs [s]; by default the communication point of the last row or the next one, for data without times the FMU's.
    step, start_values, inputs, tolerance, method: for all runs, as for `simulate`.
    jobs, executor: how the runs of a Jacobian are made, as for `sweep`.
    progress: called as progress(runs so far, root mean square of the residuals [unit of match]).
    Raises FmuError if names, values or data cannot be used, and if the first run fails; SoftffdError if SciPy is missing. Ctrl-C raises
    KeyboardInterrupt with the best parameters so far.
    """
    optimize = package("scipy.optimize", "fit", "fit")
    require_workers(jobs, executor)
    scenes, tests = _paired(scene_or_fmu, data)
    vary = vary if isinstance(vary, Mapping) else dict.fromkeys([vary] if isinstance(vary, str) else vary)
    with TemporaryDirectory(prefix="softffd-") as folder, runner(jobs or 1, executor) as make:
        how: dict[str, Any] = {"stop_time": stop_time, "step": step, "start_values": start_values, "tolerance": tolerance, "method": method}
        asked = match, vary, against, recorded, inputs
        named = [(str(n), what, one) for n, (what, one) in enumerate(zip(scenes, tests, strict=True))]
        made = [experiment_of(what, Path(folder) / n, one, *asked, **how) for n, what, one in named]
        experiments, parameters = [experiment for experiment, _ in made], made[0][1]
        rows = sum(len(each.measured) for each in experiments)
        if rows <= len(parameters):
            raise FmuError(f"data: wanted more rows than the {len(parameters)} parameters, got {rows}")
        runs = _Runs(experiments, parameters, _weights(experiments, noise), make, progress)
        try:
            runs.begin()
            with np.errstate(divide="ignore", invalid="ignore"):  # where a parameter has no effect at all
                solved = optimize.least_squares(
                    runs.residuals, np.ones(len(parameters)), runs.jacobian, bounds=runs.bounds, method="trf", x_scale=1.0,
                    ftol=CLOSE / rows, xtol=SHORT, gtol=None, max_nfev=MOST_ITERATIONS,
                )  # fmt: skip
            return runs.fit(solved.x, converged=solved.status > 0)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(runs.so_far()) from None


def _paired(scene_or_fmu: Any, data: Any) -> tuple[list[Any], list[Any]]:
    scenes = list(scene_or_fmu) if isinstance(scene_or_fmu, list | tuple) else [scene_or_fmu]
    tests = list(data) if isinstance(data, list | tuple) else [data]
    if len(scenes) != len(tests) or not tests:
        raise SoftffdError(f"data: wanted one for each scene or FMU, got {len(tests)} for {len(scenes)}")
    return scenes, tests


def _weights(experiments: Sequence[Experiment], noise: float | Sequence[float] | None) -> np.ndarray:
    """Returns the weight of each row: 1 in the test of least noise, less in other tests."""
    given = [1.0] * len(experiments) if noise is None else [one_number("noise", each) for each in np.atleast_1d(noise)]
    if len(given) != len(experiments) or not all(0 < each < math.inf for each in given):
        raise SoftffdError(f"noise: wanted a number > 0 for each of {len(experiments)} tests, got {given}")
    return np.concatenate([np.full(len(each.measured), min(given) / own) for each, own in zip(experiments, given, strict=True)])


class _Runs:
    """Residuals and Jacobian at coordinates (n,) of the parameters, from runs. The rows are those of all tests, one test after the other,
    in the unit of the matched variable."""

    def __init__(
        self, experiments: list[Experiment], parameters: list[Parameter], weights: np.ndarray, make: Make, progress: Progress | None
    ):
        self._experiments, self._parameters, self._weights, self._make = experiments, parameters, weights, make
        self._progress = progress
        self._measured = np.concatenate([each.measured for each in experiments])
        self._at, self._curve = np.full(len(parameters), np.nan), np.empty(0)  # point and curve of the last single run
        self._best: tuple[float, np.ndarray] = math.inf, np.ones(len(parameters))
        self._steps = np.full(len(parameters), FIRST_STEP)
        self.bounds = self._low, self._high = np.transpose([each.bounds for each in parameters])
        self._last: Jacobian | None = None
        self.noise = 0.0
        self.count = 0

    def begin(self) -> None:
        """Makes the first run, whose failure is reported, and the runs close to it that show the noise of the curves."""
        ones = np.ones(len(self._parameters))
        sides = np.array([1.0 if high > 1 + 5 * FIRST_STEP else -1.0 for _, high in (each.bounds for each in self._parameters)])
        curves = self._curves([ones + n * FIRST_STEP * sides for n in range(5)], strict=True)
        if isinstance(curves[0], str):
            raise FmuError(f"the first run, with {_told(self._parameters, ones)}: {curves[0]}")
        kept = [curve for curve in curves if not isinstance(curve, str)]
        self._at, self._curve = ones, kept[0]
        if len(kept) == 5:
            self.noise = float(np.sqrt(np.mean(np.diff(kept, 4, axis=0) ** 2) / 70))  # 70: sum of squares of the binomials 1, 4, 6, 4, 1

    def residuals(self, point: np.ndarray) -> np.ndarray:
        """Returns the weighted residuals (m,). They are infinite if the run fails, so that the next one is tried closer by."""
        if not np.array_equal(point, self._at):
            (curve,) = self._curves([point])
            self._at, self._curve = point.copy(), np.full(len(self._measured), np.inf) if isinstance(curve, str) else curve
        residuals = self._curve - self._measured
        rms = float(np.sqrt(np.mean(residuals**2)))
        if rms < self._best[0]:
            self._best = rms, point.copy()
        if self._progress:
            self._progress(self.count, self._best[0])
        result: np.ndarray = self._weights * residuals
        return result

    def jacobian(self, point: np.ndarray) -> np.ndarray:
        """Returns the Jacobian (m, n) by differences from the run at this point, to the other side if a run fails or the range ends."""
        centre = self.residuals(point)
        assert np.isfinite(centre).all()
        columns, words = np.empty((len(centre), len(point))), ""
        missing = list(range(len(point)))
        for sign in (1.0, -1.0):
            moves = {j: sign * self._steps[j] for j in missing}
            moves = {j: move for j, move in moves.items() if self._low[j] <= point[j] + move <= self._high[j]}
            curves = self._curves([point + move * np.eye(len(point))[j] for j, move in moves.items()])
            for (j, move), curve in zip(moves.items(), curves, strict=True):
                if isinstance(curve, str):
                    words = curve
                else:
                    columns[:, j] = self._weights * (curve - self._curve) / move
                    missing.remove(j)
        if missing:
            raise FmuError(f"runs near {_told(self._parameters, point)} fail: {words or 'the ranges of parameters are too narrow'}")
        self._last = Jacobian(point.copy(), columns, self.noise * math.sqrt(2 * len(centre)) / self._steps)
        slopes = np.sqrt(np.mean(columns**2, axis=0))
        with np.errstate(divide="ignore", invalid="ignore"):
            self._steps = np.clip(np.nan_to_num(2 * np.sqrt(self.noise / slopes), nan=FIRST_STEP), LEAST_STEP, MOST_STEP)
        return columns

    def fit(self, point: np.ndarray, *, converged: bool) -> Fit:
        """Returns the result at the best point."""
        residuals = self.residuals(point)
        if self._last is None or not np.array_equal(self._last.point, point):
            self.jacobian(point)
        assert self._last is not None
        ends = np.cumsum([len(each.measured) for each in self._experiments])[:-1]
        curves = tuple(
            Curve(each.title, each.match, each.against, each.units, each.at, each.measured, fitted, tuple(each.unused))
            for each, fitted in zip(self._experiments, np.split(self._curve, ends), strict=True)
        )
        return estimate(self._parameters, self._last, residuals, curves, runs=self.count, noise=self.noise, converged=converged)

    def so_far(self) -> str:
        """Returns the message of an interrupt."""
        if math.isinf(self._best[0]):
            return "before the first run had ended; nothing was written"
        return f"after {self.count} runs; best so far: {_told(self._parameters, self._best[1])}; nothing was written"

    def _curves(self, points: Sequence[np.ndarray], *, strict: bool = False) -> list[np.ndarray | str]:
        """Returns for each point the curves (m,) of all tests, or the message of what failed."""
        values = [values_of(self._parameters, point) for point in points]
        found: list[list[np.ndarray]] = [[] for _ in points]
        words: dict[int, str] = {}
        for experiment in self._experiments:
            indices = [(n,) for n in range(len(points))]
            with closing(self._make(experiment.at_points(values), indices)) as made:
                readings = dict(made)
            self.count += len(points)
            for n in range(len(points)):
                read = readings[(n,)]
                try:
                    if isinstance(read, str):
                        raise FmuError(read)
                    if not np.isfinite(read).all():
                        raise FmuError(f"{experiment.match}: the run gives numbers that are not finite")
                    found[n].append(experiment.curve(read, strict=strict and n == 0))
                except FmuError as error:
                    words[n] = str(error)
        return [words.get(n) or np.concatenate(curves) for n, curves in enumerate(found)]


def _told(parameters: list[Parameter], point: np.ndarray) -> str:
    values = values_of(parameters, point)
    units = {each.name: each.unit if each.unit != "1" else "" for each in parameters}
    return ", ".join(f"{name} = {value:.6g} {units[name]}".rstrip() for name, value in values.items())
