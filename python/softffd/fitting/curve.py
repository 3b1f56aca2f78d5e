"""A measured curve beside the fitted one."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Curve:
    """A measured curve and the one of the fitted run."""

    title: str
    match: str
    against: str
    """ "time", or the name of what is in its place"""
    units: dict[str, str]
    """Of both, by name"""
    at: np.ndarray
    """(m,)"""
    measured: np.ndarray
    fitted: np.ndarray
    unused: tuple[str, ...]
    """Columns of the data that nothing was done with"""
