"""How far places are from an obstacle of a scene: what no sample of the surface may be short of."""

from collections.abc import Mapping
from typing import Any

import numpy as np

KINDS = ("plane", "sphere", "cylinder", "box")
"""Sections of a scene file"""


def gap(
    kind: str, keys: Mapping[str, Any], places: np.ndarray, point: np.ndarray, normal: np.ndarray, across: np.ndarray | None = None
) -> np.ndarray:
    """Signed distance of places (.., 3) [m] from the obstacle of a section's keys, (..) [m]; negative behind or in it.

    point: of the plane, or the solid's centre [m]; normal: the plane's, a cylinder's axis, or a box's third one, whose first one is
    `across`, of unit length.
    """
    arm = places - point
    if kind == "plane":
        return arm @ normal
    if kind == "sphere":
        return np.linalg.norm(arm, axis=-1) - keys["radius"]
    if kind == "box":
        off = np.abs(arm @ np.stack([across, np.cross(normal, across), normal], axis=1)) - np.array(keys["size"]) / 2
        return np.minimum(off.max(axis=-1), 0.0) + np.linalg.norm(np.maximum(off, 0.0), axis=-1)
    height = arm @ normal
    beside = np.linalg.norm(arm - height[..., None] * normal, axis=-1) - keys["radius"]
    above = np.abs(height) - keys["length"] / 2
    return np.minimum(np.maximum(beside, above), 0.0) + np.hypot(np.maximum(beside, 0.0), np.maximum(above, 0.0))
