"""What a run found, in numbers and in words: indentation, reaction peaks, energy balance."""

from __future__ import annotations

from typing import Any

import numpy as np

from softffd.run.history import energies, reactions
from softffd.run.result import Result

ESTIMATE = "solver.error_estimate"
"""The output that estimates the error so far [m]."""

ROUNDING = 1e-9
"""A depth that is less, as a share of the lattice's size, is none."""


def findings(result: Result) -> dict[str, Any]:
    """Entries for the summary: numbers by name, and `findings`, the same as lines to read, without those that are about nothing."""
    numbers: dict[str, Any] = {}
    lines: list[str] = []
    if ESTIMATE in result.outputs:
        numbers["estimated_error_m"] = float(result.outputs[ESTIMATE][-1])
    if np.isfinite(result.positions).all() and result.positions.size:
        depth, frame = largest_indentation(result)
        numbers |= {"largest_indentation_m": depth, "largest_indentation_at_s": float(result.time[frame])}
        if depth > ROUNDING * float(np.ptp(result.positions[0].reshape(-1, 3), axis=0).max()):
            lines.append(f"largest indentation {depth:.4g} m at {result.time[frame]:.4g} s")
    for name, force in reactions(result).items():
        size = np.linalg.norm(force, axis=1)
        peak = int(np.argmax(size))
        numbers[f"{name}.reaction_peak_N"] = float(size[peak])
        if size[peak] > 0:
            lines.append(f"reaction peak on {name}: {size[peak]:.4g} N (mean of the communication step to {result.time[peak]:.4g} s)")
    if parts := energies(result):
        gap = energy_gap(parts)
        turned_over = max(float(np.ptp(values)) for values in parts.values())
        numbers |= {"energy_gap_J": gap, "energy_turned_over_J": turned_over}
        if turned_over > 0:
            lines.append(f"energy balance closes to {gap:.3g} J of {turned_over:.4g} J turned over")
    if result.scene and result.scene.mesh and (mesh := result.scene.loaded_mesh):
        lines += [f"{result.scene.mesh.file.name}: {note}" for note in mesh.looks.notes]
    return numbers | {"findings": lines}


def largest_indentation(result: Result) -> tuple[float, int]:
    """Largest departure of a control point from the best-fitting rigid motion of the lattice [m], and its row in time."""
    rows, *_, _ = result.positions.shape
    x = result.positions.reshape(rows, -1, 3)
    rest = x[0] if result.lattice is None else result.lattice.rest().reshape(-1, 3)
    depths = [_departure(rest, now) for now in x]
    frame = int(np.argmax(depths))
    return float(depths[frame]), frame


def _departure(rest: np.ndarray, now: np.ndarray) -> float:
    a, b = rest - rest.mean(axis=0), now - now.mean(axis=0)
    u, _, vt = np.linalg.svd(a.T @ b)
    u[:, -1] *= np.sign(np.linalg.det(u @ vt)) or 1.0
    return float(np.linalg.norm(b - a @ (u @ vt), axis=1).max())


def energy_gap(parts: dict[str, np.ndarray]) -> float:
    """Largest departure of kinetic + elastic + gravity + dissipated - work from its start [J]."""
    total = np.asarray(sum(values * (-1 if name == "work" else 1) for name, values in parts.items()))
    return float(np.abs(total - total[0]).max())
