"""Measured curves beside the fitted ones, and their picture: data, curve and residuals, a column for each test."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

from softffd.show.figure import CURVES, PLAIN, SOFT, kept_at, new_figure


@dataclass(frozen=True)
class Curve:
    """A measured curve and the one of the fitted run."""

    title: str
    match: str
    against: str  # "time", or the name of the quantity that replaces it
    units: dict[str, str]  # units of both, by name
    at: np.ndarray  # (m,)
    measured: np.ndarray
    fitted: np.ndarray
    unused: tuple[str, ...]  # columns of the data that are not used


def draw(title: str, curves: Sequence[Curve], file: str | Path | None) -> Figure:
    """Draws, for each test, a panel of data and curve above one of residuals. file: where the figure is written, if anywhere."""
    count = len(curves)
    figure = new_figure(2 + 5.2 * count, 5.4, dpi=120)
    figure.set_layout_engine("constrained")
    figure.suptitle(title, fontsize=11, **PLAIN)
    panels = figure.subplots(2, count, squeeze=False, sharex="col", height_ratios=[3, 1])
    for (above, below), curve in zip(panels.T, curves, strict=True):
        _column(above, below, curve)
    return kept_at(file, figure)


def _column(above: Any, below: Any, curve: Curve) -> None:
    unit = curve.units[curve.match]
    above.plot(curve.at, curve.measured, ".", color=CURVES[0], markersize=4, label="measured")
    above.plot(curve.at, curve.fitted, color=CURVES[1], linewidth=1.8, label="fitted")
    below.plot(curve.at, curve.measured - curve.fitted, ".", color=CURVES[0], markersize=4)
    below.axhline(0.0, color=CURVES[1], linewidth=1.2)
    above.set_title(curve.title, fontsize=9.5, color=SOFT, **PLAIN)
    above.set_ylabel(curve.match, **PLAIN)
    below.set_ylabel("residual", **PLAIN)
    across = f"{curve.against} [{curve.units[curve.against]}]" if curve.against == "time" else curve.against
    below.set_xlabel(across, **PLAIN)
    if curve.against != "time":
        below.xaxis.set_major_formatter(EngFormatter(unit=curve.units[curve.against], sep=" "))
    above.legend(frameon=False, fontsize=9.5)
    for panel in (above, below):
        panel.yaxis.set_major_formatter(EngFormatter(unit=unit, sep=" "))
        panel.grid(color="#e3e7ed", linewidth=0.8)
        panel.spines[["top", "right"]].set_visible(False)
