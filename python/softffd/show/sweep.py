"""The picture of a sweep: lines over one variable; for two, a line for each value of the one with fewer, or maps where both have many."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from softffd.errors import SoftffdError
from softffd.show.figure import PLAIN, kept_at, new_figure

LARGEST = 30
"""Largest number of outputs in one picture"""
MOST_LINES = 8
"""Largest number of lines in one panel; two variables with more values each make a map"""
LETTERS = 30
"""Number of letters that fit side by side below a panel; longer labels are slanted"""
ROOM = 1 / 14
"""Fraction of an axis that a label takes across its line; values closer than this have a tick without a label"""


def draw(
    title: str, values: Mapping[str, np.ndarray], outputs: Mapping[str, np.ndarray], units: Mapping[str, str], failed: np.ndarray,
    file: str | Path | None,
) -> Figure:  # fmt: skip
    """Draws a panel for each output, side by side and below each other; failed runs are crosses.

    values: (n,) of each varied variable; outputs, failed: over their grid. units: by name. file: path of the picture, or None. Raises
    SoftffdError for more than two variables, no or more than LARGEST outputs, or another ending than a picture has.
    """
    if not 1 <= len(values) <= 2:
        raise SoftffdError(f"plot: wanted one or two varied variables, got {len(values)}; to_xarray takes any number")
    if not 1 <= len(outputs) <= LARGEST:
        raise SoftffdError(f"plot: wanted 1 to {LARGEST} outputs, got {len(outputs)}; choose with outputs=[...]")
    columns = min(3, len(outputs))
    rows = math.ceil(len(outputs) / columns)
    axes = [_Axis(name, units[name], given) for name, given in values.items()]
    turned = len(axes) == 2 and len(axes[0].places) < len(axes[1].places)
    axes, failed = (axes[::-1], failed.T) if turned else (axes, failed)
    as_map = len(axes) == 2 and len(axes[1].places) > MOST_LINES
    with_legend = len(axes) == 2 and not as_map
    figure = new_figure(1 + 4.2 * columns + 2 * with_legend, 0.5 + 3.2 * rows, dpi=120)
    figure.set_layout_engine("constrained")
    figure.suptitle(title, **PLAIN)
    for number, (name, output) in enumerate(outputs.items(), 1):
        panel = figure.add_subplot(rows, columns, number)
        (_map if as_map else _lines)(panel, axes, output.T if turned else output, failed, _label(name, units.get(name, "")))
    if with_legend:
        lines = panel.get_lines()[: len(axes[1].places)]
        legend = figure.legend(lines, axes[1].words, title=axes[1].label, loc="outside right upper", frameon=False)
        for text in (*legend.get_texts(), legend.get_title()):
            text.set(**PLAIN)
    return kept_at(file, figure)


class _Axis:
    """A varied variable as an axis with ticks at its values: names are placed at integers; values that grow by a factor are logarithmic."""

    def __init__(self, name: str, unit: str, values: np.ndarray):
        self.label, self._named = _label(name, unit), values.dtype.kind in "UO"
        self.places = np.arange(len(values)) if self._named else values.astype(float)
        short = [f"{value:g}" for value in self.places]
        self.words = list(map(str, values)) if self._named else short if len({*short}) == len(values) else [f"{v:.10g}" for v in values]
        self.order = np.argsort(self.places, kind="stable")
        sorted_places = self.places[self.order]
        ratios = sorted_places[1:] / sorted_places[:-1] if len(values) > 2 and (self.places > 0).all() else np.array([])
        self._logarithmic = bool(not self._named and ratios.size and np.allclose(ratios, ratios[0]) and ratios[0] > 1.2)

    def dress(self, axis: Any, scale: Any) -> None:
        """Sets label, scale and ticks. axis: xaxis or yaxis of a panel; scale: the panel's set_xscale or set_yscale."""
        axis.set_label_text(self.label, **PLAIN)
        if self._logarithmic:
            scale("log")
        places = np.log(self.places) if self._logarithmic else self.places
        shares = (places - places.min()) / (np.ptp(places) or 1.0)
        tight = np.diff(shares[self.order]).min(initial=1.0) < max(map(len, self.words)) / LETTERS
        look = {"rotation": 60, "ha": "right", "rotation_mode": "anchor"} if tight and axis.axis_name == "x" else {}
        axis.set_ticks(self.places, labels=self.words if self._named else self._words_with_room(shares), **look, **PLAIN)
        axis.set_minor_locator(NullLocator())

    def _words_with_room(self, shares: np.ndarray) -> list[str]:
        """Returns the labels of both ends and of the values between that are not too close to another labelled value; "" for the others."""
        kept: list[float] = []
        for n in [self.order[0], self.order[-1], *self.order[1:-1]]:
            if all(abs(shares[n] - other) >= ROOM for other in kept):
                kept.append(shares[n])
        return [word if share in kept else "" for word, share in zip(self.words, shares, strict=True)]


def _lines(panel: Any, axes: list[_Axis], values: np.ndarray, failed: np.ndarray, label: str) -> None:
    """Draws a line, in its own colour, for each value of the second variable, and the crosses of its failed runs."""
    x = axes[0]
    count = len(axes[1].places) if len(axes) == 2 else 1
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, count)) if count > 1 else ["#1f5fa8"]
    columns, missing = values.reshape(len(x.places), -1), failed.reshape(len(x.places), -1)
    for column, colour in zip(columns.T, colours, strict=True):
        panel.plot(x.places[x.order], column[x.order], ".-", color=colour)
    for n, (column, colour) in enumerate(zip(missing.T, colours if count > 1 else ["#b03030"], strict=True), 1):
        where = x.places[column]
        panel.plot(where, np.full(len(where), 0.03 * n), "x", color=colour, transform=panel.get_xaxis_transform())
    x.dress(panel.xaxis, panel.set_xscale)
    panel.set_ylabel(label, **PLAIN)
    panel.grid(color="#e3e7ed")


def _map(panel: Any, axes: list[_Axis], values: np.ndarray, failed: np.ndarray, label: str) -> None:
    x, y = axes
    grid = np.ma.masked_invalid(values[np.ix_(x.order, y.order)].T)
    mesh = panel.pcolormesh(x.places[x.order], y.places[y.order], grid, shading="nearest")
    i, j = np.nonzero(failed)
    panel.plot(x.places[i], y.places[j], "x", color="#b03030")
    x.dress(panel.xaxis, panel.set_xscale)
    y.dress(panel.yaxis, panel.set_yscale)
    panel.figure.colorbar(mesh, ax=panel).set_label(label, **PLAIN)


def _label(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit and unit != "1" else name
