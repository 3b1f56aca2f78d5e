"""The picture of a sweep: lines over one variable, for two a line for each value of the one with fewer, or maps where both have many."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from softffd.errors import SoftffdError
from softffd.files import replacing

LARGEST = 30
"""Outputs in one picture"""
MOST_LINES = 8
"""In one panel; more values than these of two variables make a map"""
FORMATS = (".png", ".svg", ".pdf")
PLAIN = {"parse_math": False}
"""Of words that are not this program's: two dollars in them make no formula"""
WIDE, TALL = 2.3, 2.2
"""Inches that an axis of a panel has for its ticks, at least"""
LETTER, LINE = 0.09, 0.2
"""Of a tick's words: width of a letter and height of a line [inches]"""


def draw(
    title: str, values: Mapping[str, np.ndarray], outputs: Mapping[str, np.ndarray], units: Mapping[str, str], failed: np.ndarray,
    file: str | Path | None,
) -> Figure:  # fmt: skip
    """A panel for each output, beside and below each other; failed runs are crosses.

    values: (n,) of each varied variable; outputs, failed: over their grid. units: by name. file: where it is written, if anywhere.
    """
    if not 1 <= len(values) <= 2:
        raise SoftffdError(f"plot: wanted one or two varied variables, got {len(values)}; to_xarray takes any number")
    if not 1 <= len(outputs) <= LARGEST:
        raise SoftffdError(f"plot: wanted 1 to {LARGEST} outputs, got {len(outputs)}; choose with outputs=[...]")
    if file is not None and Path(file).suffix not in FORMATS:
        raise SoftffdError(f"{file}: wanted a picture's name that ends with {', '.join(FORMATS)}")
    columns = min(3, len(outputs))
    rows = math.ceil(len(outputs) / columns)
    axes = [_Axis(name, units[name], given) for name, given in values.items()]
    turned = len(axes) == 2 and len(axes[0].places) < len(axes[1].places)
    axes, failed = (axes[::-1], failed.T) if turned else (axes, failed)
    as_map = len(axes) == 2 and len(axes[1].places) > MOST_LINES
    with_legend = len(axes) == 2 and not as_map
    figure = Figure(figsize=(1 + 4.2 * columns + 2 * with_legend, 0.5 + 3.2 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, **PLAIN)
    for number, (name, output) in enumerate(outputs.items(), 1):
        panel = figure.add_subplot(rows, columns, number)
        (_map if as_map else _lines)(panel, axes, output.T if turned else output, failed, _label(name, units.get(name, "")))
    if with_legend:
        lines = panel.get_lines()[: len(axes[1].places)]
        legend = figure.legend(lines, axes[1].words, title=axes[1].label, loc="outside right upper", frameon=False)
        for text in (*legend.get_texts(), legend.get_title()):
            text.set(**PLAIN)
    if file is not None:
        with replacing(file) as stream:
            figure.savefig(stream, format=Path(file).suffix[1:], dpi=120)
    return figure


class _Axis:
    """A varied variable as an axis with its values as ticks: names at whole numbers; a logarithmic scale where they grow by a factor."""

    def __init__(self, name: str, unit: str, values: np.ndarray):
        self.label, self.named = _label(name, unit), values.dtype.kind in "UO"
        self.places = np.arange(len(values)) if self.named else values.astype(float)
        self.words = list(map(str, values)) if self.named else _told_apart(self.places)
        self.order = np.argsort(self.places, kind="stable")
        sorted_places = self.places[self.order]
        ratios = sorted_places[1:] / sorted_places[:-1] if len(values) > 2 and (self.places > 0).all() else np.array([])
        self.logarithmic = bool(not self.named and ratios.size and np.allclose(ratios, ratios[0]) and ratios[0] > 1.2)

    def dress(self, axis: Any, scale: Any) -> None:
        """axis: xaxis or yaxis of a panel; scale: its set_xscale or set_yscale."""
        axis.set_label_text(self.label, **PLAIN)
        if self.logarithmic:
            scale("log")
        across = axis.axis_name == "x"
        kept = self._that_fit(WIDE, [LETTER * (len(words) + 2) for words in self.words]) if across else []
        aslant = across and self.named and len(kept) < len(self.places)
        if aslant or not across:
            kept = self._that_fit(WIDE if across else TALL, [LINE] * len(self.places))
        look = {"rotation": 60, "ha": "right", "rotation_mode": "anchor"} if aslant else {}
        axis.set_ticks(self.places[kept], labels=[self.words[n] for n in kept], **look, **PLAIN)
        axis.set_minor_locator(NullLocator())

    def _that_fit(self, room: float, sizes: Sequence[float]) -> list[int]:
        """The values, from the first to the last, whose words of these sizes do not overlap on an axis with so much room [inches]."""
        places = np.log(self.places) if self.logarithmic else self.places
        at = (places - places.min()) / (np.ptp(places) or 1.0) * room

        def apart(one: int, other: int) -> bool:
            return abs(float(at[one] - at[other])) >= (sizes[one] + sizes[other]) / 2

        order = self.order.tolist()
        kept, last = order[:1], order[-1]
        for n in order[1:]:
            if apart(kept[-1], n) and (n == last or apart(n, last)):
                kept.append(n)
        return kept


def _told_apart(values: np.ndarray) -> list[str]:
    """The numbers in as few digits as leave them different, 4 at least."""
    for digits in range(4, 18):
        words = [f"{value:.{digits}g}" for value in values]
        if len(set(words)) == len(set(values.tolist())):
            break
    return words


def _lines(panel: Any, axes: list[_Axis], values: np.ndarray, failed: np.ndarray, label: str) -> None:
    """A line for each value of the second variable, in its colour, crosses too."""
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
