"""Accurate ends of the shipped scenes, stored in tests/data/ends.npz: `python tests/support/end_states.py FILE` makes them again."""

import sys

import numpy as np

from readings import points
from softffd import load_scene, simulate

REFERENCES = {
    "free_vibration": [("dop853", {"solver.tolerance": 1e-12}), ("rkn12", {"solver.tolerance": 1e-12})],
    "light_corner": [("dop853", {"solver.tolerance": 1e-12}), ("bm4", {"solver.step": 5e-6})],
    "spin": [("dop853", {"solver.tolerance": 1e-12}), ("rkn12", {"solver.tolerance": 1e-12})],
    "hanging": [("dop853", {"solver.tolerance": 1e-12}), ("bm4", {"solver.step": 2e-4})],
    "stiff_pull": [("bm4", {"solver.step": 1e-5}), ("dop853", {"solver.tolerance": 1e-12})],
    "stiff_layer": [("bm4", {"solver.step": 1e-5}), ("dop853", {"solver.tolerance": 1e-12})],
    "sliding_drop": [("leapfrog", {"solver.step": 2e-6})],
    "incline": [("leapfrog", {"solver.step": 2e-6})],
    "press": [("leapfrog", {"solver.step": 2e-6})],
    "car_drop": [("leapfrog", {"solver.step": 1e-5})],
    "stiff_bounce": [("leapfrog", {"solver.step": 4e-8})],
    "light_bounce": [("leapfrog", {"solver.step": 4e-7})],
}
"""Two for every scene, so that there is one by another method for each; they agree as the test below says"""


def end(name: str, method: str, settings: dict[str, float]) -> np.ndarray:
    """Positions (n, 3) at the end, relative to the largest side of the box.

    Loads of the stiff scenes have no kinks: jumps of held ones would set them ringing.
    """
    scene, course = load_scene(name), "cubic" if name.startswith("stiff") else "held"
    result = simulate(scene, start_values={"solver.method": method} | settings, inputs=scene.default_inputs, interpolation=course)
    return points(result)[-1] / max(scene.lattice.size)


if __name__ == "__main__":
    made = {f"{name}-{method}": end(name, method, settings) for name in REFERENCES for method, settings in REFERENCES[name]}
    np.savez_compressed(sys.argv[1], **made)
