"""The scene in the form that its live page simulates, and the recordings that the page saves."""

from pathlib import Path

import numpy as np

from softffd.scene.scene import Scene, scene_of

STEP = 1 / 480
"""Longest communication step [s]: with longer steps, what is pulled by hand feels slack"""
RECORDED = "# recorded by softffd live"
"""Beginning of the first line of a recording"""


def live_scene(scene: Scene | str | Path) -> Scene:
    """Returns the scene with what a hand needs: forces on all control points, obstacles and pins that move, outputs to look at.

    scene: a scene, the path of its file, or the name of a shipped one.
    The communication step is 1/480 s, or the scene's own step where that is shorter. An obstacle that turns keeps its motion. An obstacle
    that inputs move rests until it is taken hold of. A free body moves by itself, and a hand pulls it by a force on the body.
    """
    scene = scene_of(scene, "live_scene")
    changes: dict[str, object] = {"inputs.forces": "all", "outputs.positions": "all", "outputs.reactions": True, "outputs.energy": True}
    for part in (*scene.obstacles, *scene.pin):
        if part.motion != "free" and not np.any(getattr(part, "angular_velocity", 0.0)):
            changes |= {f"{part.part}.motion": "input", f"{part.part}.inputs": list(part.POSE)}
            if part.motion == "input" and part.part.is_obstacle:
                changes[f"{part.part}.velocity"] = None
    step = min(scene.experiment.communication_step, STEP)
    return scene.replace(changes | {"experiment.communication_step": step})


def is_recording(path: str | Path) -> bool:
    """True if a file of inputs is a recording of a live page. A pipe, which can be read only once, is none."""
    if not Path(path).is_file():
        return False
    try:
        with Path(path).open(encoding="utf-8-sig") as stream:
            return stream.readline().startswith(RECORDED)
    except (OSError, UnicodeDecodeError):
        return False
