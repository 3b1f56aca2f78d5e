"""The first view of a scene: the usual view, or the nearest view from which obstacles are seen from their free side and hide nothing."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from softffd.show.raster import Camera
from softffd.show.stage import VIEW, Stage

TURNS = np.radians([0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180])
LIFTS = (VIEW[1], 0.18, 0.1, 0.05, 0.02, -0.02, 0.45, 0.7, -0.2)
DISTANCES = (4.0, 8.0)
"""Distance of the eye from the middle of the scene, in halves of the scene's diagonal: for a broad page, and for a narrow page"""
GLANCES = 12  # number of evenly chosen frames in which the view is checked
SAMPLES = 40  # sample points between eye and object, at which a solid would hide the object
ONTO = 0.7  # wanted cosine between the normal of a side to look at and the direction to the eye
TURNED = 0.02  # a turn of 1 rad from the usual view costs as much as this fraction of the run behind an obstacle


def first_sight(stages: Sequence[Stage]) -> tuple[float, float]:
    """Returns the view (turn about the up direction, lift above the horizon) [rad] with the least cost: the fraction of the run in which
    the eye is behind planes, or has solids before the object, plus TURNED for each radian of turning away from the usual view.

    stages: scenes seen by one camera, each about its own centre.
    """
    views = np.array(list(product(VIEW[0] + TURNS, LIFTS)))
    behind = sum(_behind(stage, np.array([back_of(stage.up, *view) for view in views])) for stage in stages)
    away = np.abs(views - VIEW).sum(axis=1)
    turn, lift = views[np.argmin(behind + TURNED * away)]
    return float(turn), float(lift)


def sight_onto(up: np.ndarray, outward: np.ndarray) -> tuple[float, float]:
    """Returns the view (turn, lift) [rad] onto a side of the object that faces `outward` (3,), whatever obstacles are in front of it."""
    views = np.array(list(product(VIEW[0] + TURNS, (*LIFTS, ONTO + 0.1, -ONTO - 0.1))))
    towards = np.array([back_of(up, *view) for view in views]) @ outward
    turn, lift = views[np.argmin(np.abs(towards - ONTO) + TURNED * np.abs(views - VIEW).sum(axis=1))]
    return float(turn), float(lift)


def _behind(stage: Stage, backs: np.ndarray) -> np.ndarray:
    """Returns for directions (N, 3) from the middle to the eye the number (N,) of obstacles in the way, averaged over the run: a plane
    with the eye on its solid side, or a solid between the eye and the object's middle."""
    frames = np.unique(np.linspace(0, len(stage.time) - 1, GLANCES).astype(int))
    counted = np.zeros(len(backs))
    for distance, frame in product(DISTANCES, frames):
        eyes, middle = stage.centre + distance * stage.radius * backs, stage.positions[frame].mean(axis=(0, 1, 2))
        between = middle + (eyes - middle) * np.linspace(0, 1, SAMPLES)[:, None, None]
        hidden: list[np.ndarray] = [plane.gap(frame, eyes) < 0 for plane in stage.planes]
        hidden += [(solid.gap(frame, between.reshape(-1, 3)).reshape(SAMPLES, -1).min(axis=0) < 0) for solid in stage.solids]
        counted += np.sum(hidden, axis=0) / (len(frames) * len(DISTANCES))
    return counted


def view_axes(up: np.ndarray, view: tuple[float, float] = VIEW) -> np.ndarray:
    """Returns the rows right, above, back (3, 3) of a view."""
    return Camera(back_of(up, *view), np.zeros(3), up).axes


def back_of(up: np.ndarray, turn: float, lift: float) -> np.ndarray:
    """Returns the unit vector (3,) from the middle to the eye."""
    east = np.cross([0.0, 1.0, 0.0] if abs(up[1]) < 0.9 else [0.0, 0.0, 1.0], up)
    east /= np.linalg.norm(east)
    flat = np.cos(turn) * east + np.sin(turn) * np.cross(up, east)
    return np.asarray(np.cos(lift) * flat + np.sin(lift) * np.asarray(up))
