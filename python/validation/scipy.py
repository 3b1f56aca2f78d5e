"""External reference for accuracy: SciPy's solvers on the same equations, as a user would write the equations with numpy.

    m_i a_i = sum over springs of k (1 - l / r) (x_j - x_i) - d_i v_i + m_i g + F_i(t)        Xia & Wang 2009, eq. (3) and (6)

Dashpots add c ((v_j - v_i) . (x_j - x_i) / r^2) (x_j - x_i) for each spring.

The spring forces use a sparse incidence matrix, with one product to the springs and one product back, which is the fastest of the usual
ways in numpy. F is a cubic between communication points, as in the runs of the FMU. Obstacles and pins are not supported.
"""

from __future__ import annotations

import os
import time as clock
import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from softffd.accuracy.records import Record, Records
from softffd.accuracy.rig import Rig, Setting
from softffd.errors import SoftffdError
from softffd.run.progress import Note, silent
from softffd.scene.scene import Scene
from validation.mechanics import Body, outside_force, start
from validation.resolved import resolved

SOLVERS = ("DOP853", "RK45", "Radau", "LSODA")
IMPLICIT_WITH_PATTERN = ("Radau",)  # solvers that accept the sparsity pattern of the Jacobian; LSODA builds its own dense Jacobian

TOLERANCES = tuple(10.0**-n for n in range(1, 12))
MOST, QUICK_MOST = 5.0, 1.0  # limit of the CPU time of one run [s]; the sweep of a solver ends at the first run above the limit


class _TooLong(Exception):
    """Raised in the right-hand side to stop a solver that exceeds its time limit."""


def sweep_scipy(rig: Rig, records: Records, quick: bool = False, note: Note = silent) -> Iterator[Record]:
    """Yields a record for every solver and tolerance. Scenes with obstacles, pins or a volume stiffness yield none; `records.left_out` then
    states why. Raises SoftffdError if SciPy is not installed.
    """
    solve_ivp = solver()
    if rig.contact or rig.scene.pin:
        records.left_out |= {f"SciPy {name}": "has no contact and no pins" for name in SOLVERS}
        return
    if rig.scene.material.volume_stiffness > 0:
        records.left_out |= {f"SciPy {name}": "has no volume stiffness" for name in SOLVERS}
        return
    equations = Equations(rig.scene)
    forces = nodal_forces(rig)
    for name in SOLVERS:
        for tolerance in TOLERANCES[:: 2 if quick else 1]:
            note(f"{records.scene}: SciPy {name}, tolerance {tolerance:.3g}")
            setting, most = Setting(name, tolerance=tolerance), QUICK_MOST if quick else MOST
            record = _measured(solve_ivp, equations, forces, rig, records, setting, most)
            yield record
            if record.failure or record.error < records.floor:
                break


def solver() -> Callable[..., Any]:
    """Returns scipy.integrate.solve_ivp. Raises SoftffdError if SciPy is not installed."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one core, like the FMU; OpenBLAS reads it when SciPy is loaded
    try:
        from scipy.integrate import solve_ivp
    except ImportError:
        raise SoftffdError("SciPy is not installed here: pip install 'softffd[comparisons]'") from None
    return solve_ivp


def _measured(
    solve_ivp: Callable[..., Any], equations: Equations, forces: Any, rig: Rig, records: Records, setting: Setting, most: float
) -> Record:
    began = clock.process_time()
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            positions, evaluations = integrate(solve_ivp, equations, forces, rig, setting, deadline=began + most)
    except _TooLong:
        return Record(setting, "scipy", failure=f"given up: more than {most:g} s of CPU time")
    except (ValueError, FloatingPointError, np.linalg.LinAlgError, RuntimeError) as error:
        return Record(setting, "scipy", failure=" ".join(str(error).split()))
    elapsed = clock.process_time() - began
    return Record(setting, "scipy", elapsed, 1, evaluations, None, records.reference.errors(positions, rig.side))


def integrate(
    solve_ivp: Callable[..., Any], equations: Equations, forces: Any, rig: Rig, setting: Setting, *, deadline: float = np.inf
) -> tuple[np.ndarray, int]:
    """Returns the positions (T, n, 3) [m] at the communication points and the number of evaluations of the right-hand side.

    Raises RuntimeError with the solver's message if the solver gives up, and _TooLong past the deadline (CPU time of the process, s).
    """
    options = {"method": setting.method, "rtol": max(setting.tolerance, 3e-14), "atol": setting.tolerance * rig.side}
    if setting.method in IMPLICIT_WITH_PATTERN:
        options["jac_sparsity"] = equations.pattern()
    times = rig.times

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        if clock.process_time() > deadline:
            raise _TooLong
        row = np.searchsorted(times[1:-1], t, side="right")
        return equations.rate(y, at(forces[row], t - times[row]))

    solution = solve_ivp(rate, (times[0], times[-1]), equations.start(), t_eval=times, **options)
    if not solution.success:
        raise RuntimeError(solution.message)
    count = len(solution.y) // 2
    return solution.y[:count].T.reshape(len(times), -1, 3), solution.nfev


class Equations:
    """The right-hand side of a scene without obstacles and pins. The flat state holds all positions, then all velocities."""

    def __init__(self, scene: Scene):
        from scipy import sparse

        self._resolved = resolved(scene)
        body = Body.of(self._resolved)
        self.mass, self.stiffness, self.length, self.damping = body.mass[:, None], body.stiffness, body.length, body.damping[:, None]
        count = len(body.pairs)
        ends = np.repeat([-1.0, 1.0], count)
        places = np.tile(np.arange(count), 2), body.pairs.T.ravel()
        self._to_springs = sparse.csr_array((ends, places), shape=(count, len(body.mass)))
        self._to_points = sparse.csr_array(-self._to_springs.T)
        self._constant = body.weight[:, None] * np.array(scene.environment.gravity or (0.0, 0.0, 0.0))
        self._damped, self._dashpots = bool(self.damping.any()), body.dashpot if body.dashpot.any() else None

    def start(self) -> np.ndarray:
        """Returns the state at time 0, (6 n,)."""
        return np.concatenate([each.ravel() for each in start(self._resolved)])

    def rate(self, state: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Returns the time derivative of the state (6 n,). force: external forces besides gravity (n, 3) [N]."""
        x, v = state.reshape(2, -1, 3)
        way = self._to_springs @ x
        square = (way * way).sum(axis=1)
        pull = self.stiffness * (1.0 - self.length / np.sqrt(square))
        if self._dashpots is not None:
            pull += self._dashpots * (way * (self._to_springs @ v)).sum(axis=1) / square
        total = self._to_points @ (pull[:, None] * way) + self._constant + force
        if self._damped:
            total -= self.damping * v
        return np.concatenate([v.ravel(), (total / self.mass).ravel()])

    def pattern(self) -> Any:
        """Returns the sparsity pattern of the Jacobian of the rate, a sparse array (6 n, 6 n)."""
        from scipy import sparse

        neighbours = sparse.csr_array(abs(self._to_springs.T) @ abs(self._to_springs))
        stiff = sparse.kron(neighbours, np.ones((3, 3)))
        unit = sparse.eye_array(stiff.shape[0])
        return sparse.csr_array(sparse.block_array([[None, unit], [stiff, unit]]))


def nodal_forces(rig: Rig) -> np.ndarray:
    """Returns the external forces besides gravity and their first to third time derivatives at every communication point but the last,
    (T - 1, 4, n, 3), in N and s, from the inputs of the rig."""
    courses = np.concatenate([rig.input_values[:, None], rig.input_rates], axis=1)  # (T - 1, 4, inputs)
    forces = outside_force(resolved(rig.scene), dict(zip(rig.driven_names, np.moveaxis(courses, 2, 0), strict=True)))
    return np.broadcast_to(forces, (*courses.shape[:2], *forces.shape[-2:]))


def at(course: np.ndarray, time: float) -> np.ndarray:
    """Returns the forces (n, 3) at `time` after a communication point. course: forces and derivatives (4, n, 3) at that point."""
    return course[0] + time * (course[1] + time * (course[2] / 2 + time * course[3] / 6))
