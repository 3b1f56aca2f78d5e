"""The picture of a sweep: lines over one variable, maps over two."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from softffd.errors import SoftffdError
from softffd.files import replacing

if TYPE_CHECKING:
    from softffd.run.sweep.table import Sweep

LARGEST = 30
"""Outputs in one picture"""
FORMATS = (".png", ".svg", ".pdf")


def draw(table: Sweep, file: str | Path | None, outputs: Iterable[str] | None) -> Figure:
    """A panel for each output, beside and below each other; failed runs are crosses."""
    names = list(table.outputs if outputs is None else outputs)
    if not 1 <= len(table.values) <= 2:
        raise SoftffdError(f"plot: wanted one or two varied variables, got {len(table.values)}; to_xarray takes any number")
    if not 1 <= len(names) <= LARGEST:
        raise SoftffdError(f"plot: wanted 1 to {LARGEST} outputs, got {len(names)}; choose with outputs=[...]")
    if file is not None and Path(file).suffix not in FORMATS:
        raise SoftffdError(f"{file}: wanted a picture's name that ends with {', '.join(FORMATS)}")
    columns = min(3, len(names))
    rows = math.ceil(len(names) / columns)
    figure = Figure(figsize=(1 + 4.2 * columns, 0.5 + 3.2 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(table.about["title"])
    axes = [_Axis(name, table.about["units"][name], values) for name, values in table.values.items()]
    for number, name in enumerate(names, 1):
        panel = figure.add_subplot(rows, columns, number)
        label = _label(name, table.about["units"].get(name, ""))
        (_line if len(axes) == 1 else _map)(panel, axes, table.outputs[name], table.messages != "", label)
    if file is not None:
        with replacing(file) as stream:
            figure.savefig(stream, format=Path(file).suffix[1:], dpi=120)
    return figure


class _Axis:
    """A varied variable as an axis: names at whole numbers; a logarithmic scale where the values grow by a factor."""

    def __init__(self, name: str, unit: str, values: np.ndarray):
        self.label, self.words = _label(name, unit), values if values.dtype.kind in "UO" else None
        self.places = np.arange(len(values)) if self.words is not None else values.astype(float)
        self.order = np.argsort(self.places, kind="stable")
        sorted_places = self.places[self.order]
        ratios = sorted_places[1:] / sorted_places[:-1] if len(values) > 2 and (self.places > 0).all() else np.array([])
        self.logarithmic = bool(self.words is None and ratios.size and np.allclose(ratios, ratios[0]) and ratios[0] > 1.2)

    def dress(self, axis: Any, scale: Any) -> None:
        """axis: xaxis or yaxis of a panel; scale: its set_xscale or set_yscale."""
        axis.set_label_text(self.label)
        if self.words is not None:
            axis.set_ticks(self.places, labels=list(self.words))
        elif self.logarithmic:
            scale("log")


def _line(panel: Any, axes: list[_Axis], values: np.ndarray, failed: np.ndarray, label: str) -> None:
    (x,) = axes
    panel.plot(x.places[x.order], values[x.order], ".-", color="#1f5fa8")
    for place in x.places[failed]:
        panel.plot([place], [0.03], "x", color="#b03030", transform=panel.get_xaxis_transform())
    x.dress(panel.xaxis, panel.set_xscale)
    panel.set_ylabel(label)
    panel.grid(color="#e3e7ed")


def _map(panel: Any, axes: list[_Axis], values: np.ndarray, failed: np.ndarray, label: str) -> None:
    x, y = axes
    grid = np.ma.masked_invalid(values[np.ix_(x.order, y.order)].T)
    mesh = panel.pcolormesh(x.places[x.order], y.places[y.order], grid, shading="nearest")
    i, j = np.nonzero(failed)
    panel.plot(x.places[i], y.places[j], "x", color="#b03030")
    x.dress(panel.xaxis, panel.set_xscale)
    y.dress(panel.yaxis, panel.set_yscale)
    panel.figure.colorbar(mesh, ax=panel, label=label)


def _label(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit and unit != "1" else name
