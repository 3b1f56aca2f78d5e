"""The picture of a sensor: maps of the contact pressure on its taxels at telling moments, and its largest and mean value over time."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, MaxNLocator

from softffd.run.pressure import grid_of
from softffd.run.result import Result
from softffd.show.figure import PLAIN, Box, draw_curves, draw_scale, draw_words, new_figure, quantity
from softffd.show.tension import RAMP
from softffd.taxels import TaxelGrid

PRESSED = 0.01
"""A map of the end is drawn if its largest pressure exceeds this fraction of the run's largest pressure"""

LABEL = 0.5
"""Least distance of the labels of ticks [inches]"""


def taxel_picture(result: Result, name: str) -> Figure:
    """Draws the picture of Result.plot_taxels."""
    grid, pressure = grid_of(result.taxels, name), result.taxel_pressure(name)
    moments = pressed_moments(grid, pressure)
    figure, ends = new_figure(13.0, 6.8, dpi=120), (0.0, float(pressure.max()) or 1.0)
    draw_words(figure, f"{result.title}: contact pressure on the taxels of {name}", (0.02, 0.965), 14, "left", weight="bold")
    width = 0.96 / len(moments)
    for number, (frame, words) in enumerate(moments.items()):
        caption = f"{words}, t = {result.time[frame]:.4g} s: {quantity(float(pressure[frame].max()), 'Pa')}"
        _draw_map(figure, (0.02 + (number + 0.2) * width, 0.53, 0.76 * width, 0.33), grid, pressure[frame], ends, caption)
    draw_scale(figure, (0.40, 0.435, 0.40, 0.014), RAMP, ends, "Pa", "mean of the communication step")
    means = (pressure * np.array(grid.areas)).sum(axis=(1, 2)) / np.sum(grid.areas)
    curves = {"largest of a taxel": pressure.max(axis=(1, 2)), "mean over all taxels": means}
    marks = [result.time[frame] for frame in moments]
    draw_curves(figure, (0.075, 0.09, 0.905, 0.24), "contact pressure", "Pa", np.asarray(result.time), curves, steps=True, marks=marks)
    return figure


def pressed_moments(grid: TaxelGrid, pressure: np.ndarray) -> dict[int, str]:
    """Returns {frame: words} of half of the largest force, largest pressure of a taxel, largest force, and the end if it is pressed, in
    the order of time. Moments of one frame are merged; without contact there is only the end."""
    force = (pressure * np.array(grid.areas)).sum(axis=(1, 2))
    last, largest = len(pressure) - 1, pressure.max(axis=(1, 2))
    if largest.max() <= 0:
        return {last: "end"}
    found: dict[int, list[str]] = {}
    for frame, words in (
        (int((force >= force.max() / 2).argmax()), "half of the largest force"),
        (int(largest.argmax()), "largest pressure"),
        (int(force.argmax()), "largest force"),
        (last, "end"),
    ):
        if words != "end" or largest[last] > PRESSED * largest.max():
            found.setdefault(frame, []).append(words)
    return {frame: " and ".join(found[frame]) for frame in sorted(found)}


def _draw_map(figure: Figure, box: Box, grid: TaxelGrid, pressure: np.ndarray, scale: Sequence[float], caption: str) -> None:
    """Draws the map of one grid over its two axes at rest."""
    axes = figure.add_axes(box)
    lower, upper = np.array(grid.lower), np.array(grid.upper)
    half = np.where(upper > lower, 0.0, np.sqrt(np.sum(grid.areas)) / 2)  # half the side of a patch without extent along that side
    (left, low), (right, high) = lower - half, upper + half
    axes.imshow(
        pressure.T, cmap=RAMP, vmin=scale[0], vmax=scale[1], origin="lower", extent=(left, right, low, high), interpolation="nearest",
    )  # fmt: skip
    room, extent = np.array(box[2:]) * figure.get_size_inches(), np.array([right - left, high - low])
    lengths = extent * (room / extent).min()  # of the sides as drawn [inches]
    for side, ends, axis, length in zip((axes.xaxis, axes.yaxis), ((left, right), (low, high)), grid.along, lengths, strict=True):
        side.set_major_formatter(EngFormatter(unit="m", sep=" "))
        ticks = MaxNLocator(4).tick_values(*ends)
        every = math.ceil(LABEL / length * (ends[1] - ends[0]) / (ticks[1] - ticks[0]))
        side.set_ticks([tick for tick in ticks if ends[0] <= tick <= ends[1]][::every])
        side.set_label_text("xyz"[axis])
    axes.tick_params(labelsize=8)
    axes.set_title(caption, fontsize=10, **PLAIN)
