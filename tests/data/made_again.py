"""The stored solutions, made again from the equations: `python tests/data/made_again.py FOLDER` writes them there.

SciPy's integrators reach 1e-9 m, where the stored files have 1e-12: they are compared, not replaced.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import reference

TIMES = np.linspace(0.1, 1.0, 10)
NUMBERS = np.array([6, 7, 8, 11, 20, 50, 99, 150, 190, 191])
FACES = [np.arange(64) % 4 == 3, np.arange(64) % 4 == 0]
"""Points of i = 3 and of i = 0."""


def motion(model: reference.Model, start: np.ndarray, force, *, method: str, pieces=(0.0, 1.0)) -> dict[str, np.ndarray]:
    """Positions and velocities at TIMES; `force(time)` (64, 3) [N] is smooth, or constant, from each of `pieces` [s] to the next."""
    from scipy.integrate import solve_ivp

    state, rows = np.concatenate([start.ravel(), np.zeros(start.size)]), []
    for begin, end in pairwise(pieces):

        def rate(time, y, begin=begin, end=end):
            x, v = y.reshape(2, -1, 3)
            total = model.spring_force(x) + force(begin if len(pieces) > 2 else time) - model.damping[:, None] * v
            return np.concatenate([v.ravel(), (total / model.mass[:, None]).ravel()])

        wanted = TIMES[(begin + 1e-9 < TIMES) & (end + 1e-9 > TIMES)]
        solved = solve_ivp(rate, (begin, end), state, method=method, t_eval=[*wanted[wanted < end - 1e-9], end], rtol=1e-11, atol=1e-11)
        rows += list(solved.y.T[: len(wanted)])
        state = solved.y[:, -1]
    x, v = np.array(rows).reshape(-1, 2, 64, 3).transpose(1, 0, 2, 3)
    return {"t": TIMES, "x": x, "v": v}


def ramp(u: float) -> float:
    u = min(max(u, 0.0), 1.0)
    return u**3 * (10 - 15 * u + 6 * u**2)


def released() -> dict[str, np.ndarray]:
    """S1: a stretched cube is let go."""
    model = reference.cube()
    return motion(model, model.rest * [1.1, 1, 1], lambda time: 0.0, method="DOP853")


def slowly_pulled() -> dict[str, np.ndarray]:
    """S2: a stiff cube under a slow load."""
    model = reference.cube(stiffness=1e7, damping=0.5)
    pull = np.zeros((64, 3))
    for sign, points in zip((1, -1), FACES, strict=True):
        pull[points, 0] = sign * 1e5 * (1 + np.arange(64)[points] // 4 % 4 / 3)
    weight = np.outer(model.mass, [0, 0, -9.81])
    return motion(model, model.rest, lambda time: weight + ramp(time / 0.5) * pull, method="DOP853")


def shaken() -> dict[str, np.ndarray]:
    """G_ZOH: a corner is shaken by a force that is held for 10 ms."""
    model = reference.cube(damping=0.02)

    def force(time):
        turn, held = 2 * np.pi * time, np.zeros((64, 3))
        held[63] = 3 * np.sin(3 * turn), -2 * np.sin(5 * turn), 4 * np.cos(2 * turn)
        return held

    return motion(model, model.rest, force, method="DOP853", pieces=np.arange(101) / 100)


def at_rest(model: reference.Model, external: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Newton's method for the positions at which the forces on what is not held vanish."""
    x, free = model.rest.copy(), ~held.ravel()
    for _ in range(30):
        nudges = 1e-6 * np.eye(x.size).reshape(-1, *x.shape)
        columns = [(model.spring_force(x + nudge) - model.spring_force(x - nudge)).ravel() / 2e-6 for nudge in nudges]
        matrix, force = np.array(columns).T, (model.spring_force(x) + external).ravel()
        step = np.linalg.lstsq(matrix[np.ix_(free, free)], -force[free], rcond=1e-9)[0]  # turning and sliding are free
        x.ravel()[free] += step
        if np.abs(step).max() < 1e-14:
            break
    return x


def states_of_rest() -> dict[str, np.ndarray]:
    pulled, resting = reference.cube(), reference.cube(stiffness=2e3)
    pull, weight = np.zeros((64, 3)), np.outer(resting.mass, [0, 0, -9.81])
    pull[FACES[0], 0], pull[FACES[1], 0] = 20.0, -20.0
    on_the_plane = np.zeros((64, 3), dtype=bool)
    on_the_plane[:16, 2] = True
    x = at_rest(resting, weight, on_the_plane)
    carried = np.where(on_the_plane[:, 2], -(resting.spring_force(x) + weight)[:, 2], 0.0)
    return {"pull_x": at_rest(pulled, pull, np.zeros((64, 3), dtype=bool)), "pull_F": pull, "rest_x": x, "rest_lambda": carried}


def modes() -> dict[str, np.ndarray]:
    found = {"numbers": NUMBERS}
    for count, topology in ((468, "distinct"), (504, "paper")):
        omega, shapes = reference.cube(topology=topology).eigenmodes()
        found |= {f"omega_{count}": omega, f"modes_{count}": shapes[:, NUMBERS]}
    return found


MADE = {"S1": released, "S2": slowly_pulled, "G_ZOH": shaken, "static": states_of_rest, "modes": modes}

if __name__ == "__main__":
    for name, make in MADE.items():
        np.savez_compressed(Path(sys.argv[1]) / f"{name}.npz", **make())
