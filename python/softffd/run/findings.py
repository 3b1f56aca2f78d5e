"""The findings of a run, in numbers and in words: methods and the reasons for them, reactions, energies, the largest deformation."""

from typing import Any

import numpy as np

from softffd.names import OBSTACLES, Part, parts_of, variable_name, vector_names
from softffd.run.result import Result

ENERGIES = ("kinetic", "elastic", "gravity", "dissipated", "work")


def reactions(result: Result) -> dict[Part, np.ndarray]:
    """Returns the forces of the object on its obstacles and fixtures, (T, 3) [N] each; a part as text is "plane.ground" or "pin.base"."""
    parts = [*parts_of(result.outputs, *OBSTACLES), *parts_of(result.outputs, "pin")]
    recorded = {part: vector_names("plane_reaction" if part.is_obstacle else "pin_reaction", part) for part in parts}
    whole = {part: names for part, names in recorded.items() if all(name in result.outputs for name in names)}
    return {part: np.stack([result.outputs[name] for name in names], axis=1) for part, names in whole.items()}


def energies(result: Result) -> dict[str, np.ndarray]:
    """Returns the recorded energies: "kinetic", "elastic", ... -> (T,) [J]."""
    names = {kind: variable_name(f"energy_{kind}") for kind in ENERGIES}
    return {kind: result.outputs[name] for kind, name in names.items() if name in result.outputs}


def heights(result: Result, up: np.ndarray) -> dict[str, np.ndarray]:
    """Returns the lattice's highest and lowest position along `up` (3,): words -> (T,) [m]."""
    along = result.positions @ np.asarray(up)
    return {"highest point": along.max(axis=(1, 2, 3)), "lowest point": along.min(axis=(1, 2, 3))}


ESTIMATE = "solver.error_estimate"  # the output that estimates the error so far [m]
SLOW = 0.01  # ratio of simulated time to run time, below which the findings say what makes a run slow
ROUNDING = 1e-9  # a deformation below this fraction of the lattice's size counts as none


def findings(result: Result) -> dict[str, Any]:
    """Returns entries for the summary: numbers by name, and `findings`, lines to read, without lines about what did not occur."""
    numbers: dict[str, Any] = {}
    lines: list[str] = []
    if ESTIMATE in result.outputs:
        numbers["estimated_error_m"] = float(result.outputs[ESTIMATE][-1])
    if result.has_positions:
        depths = result.deformation()
        row = int(np.argmax(depths))
        numbers |= {"largest_deformation_m": float(depths[row]), "largest_deformation_at_s": float(result.time[row])}
        if depths[row] > ROUNDING * float(np.ptp(result.positions[0].reshape(-1, 3), axis=0).max()):
            lines.append(f"largest deformation {depths[row]:.4g} m at {result.time[row]:.4g} s")
    for name, force in reactions(result).items():
        size = np.linalg.norm(force, axis=1)
        peak = int(np.argmax(size))
        numbers[f"{name}.reaction_peak_N"] = float(size[peak])
        if size[peak] > 0:
            lines.append(f"reaction peak on {name}: {size[peak]:.4g} N (mean of the communication step to {result.time[peak]:.4g} s)")
    if slow := _slowness(result):
        lines.append(slow)
    if parts := energies(result):
        gap = energy_gap(parts)
        turned_over = max(float(np.ptp(values)) for values in parts.values())
        numbers |= {"energy_gap_J": gap, "energy_turned_over_J": turned_over}
        if turned_over > 0:
            lines.append(f"energy balance closes to {gap:.3g} J of {turned_over:.4g} J turned over")
    if result.scene and result.scene.mesh and (mesh := result.scene.loaded_mesh):
        lines += [f"{result.scene.mesh.file.name}: {note}" for note in mesh.looks.notes]
    return numbers | {"findings": lines}


def _slowness(result: Result) -> str:
    """Returns what makes a run slow, and what to try; empty for a run that is not slow."""
    if not result.summary.get("real_time_factor", 1.0) < SLOW:
        return ""
    method = next((f"; most of it by {row['method']}: {row['reason']}" for row in result.summary.get("methods", [])), "")
    tries = []
    if tolerance := result.parameters.get("solver.tolerance"):
        tries.append(f"a larger tolerance (--tolerance, now {tolerance:g})")
    if result.lattice:
        tries.append(f"a coarser lattice (now {' x '.join(map(str, result.lattice.points))})")
    return f"slower than a hundredth of real time{method}" + (f"; to try: {' or '.join(tries)}" if tries else "")


def energy_gap(parts: dict[str, np.ndarray]) -> float:
    """Returns the largest departure of kinetic + elastic + gravity + dissipated - work from its start [J]."""
    total = np.asarray(sum(values * (-1 if name == "work" else 1) for name, values in parts.items()))
    return float(np.abs(total - total[0]).max())
