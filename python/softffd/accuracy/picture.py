"""Pictures of records, error against run time: of the methods on a scene, and of scenes over lattices."""

import textwrap
from collections.abc import Sequence
from itertools import cycle
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter

from softffd.accuracy.records import ALIKE, CHOSEN, CLAIM, LEVELS, PUBLISHED, Record, Records
from softffd.show.figure import CURVES, INK, PLAIN, SOFT, new_figure, png_of

LOOKS: dict[str, dict[str, Any]] = {
    CHOSEN: {"color": INK, "linewidth": 3.4, "marker": "o", "markersize": 5, "zorder": 5},
    PUBLISHED: {"color": "#d55e00", "linewidth": 2.2, "marker": "X", "markersize": 7, "linestyle": (0, (4, 2)), "zorder": 4},
    "leapfrog": {"color": CURVES[0], "marker": "s"},
    "bm4": {"color": CURVES[2], "marker": "D"},
    "rkn12": {"color": CURVES[3], "marker": "^"},
    "dop853": {"color": CURVES[4], "marker": "v"},
    "ros34pw2": {"color": CURVES[5], "marker": "P"},
    "sdirk2": {"color": CURVES[2], "marker": "p"},  # bm4 is left out where sdirk2 is measured
}  # looks of the methods by name; other methods get the remaining ones
LABELS = {CHOSEN: "auto", PUBLISHED: "central_difference\n(published scheme)"}
OTHER_COLOURS = ("#7a5195", "#a05d2c", "#3c7a89", "#b0413e")
ANCHOR_MARKS = {"SciPy DOP853": "v", "SciPy RK45": "<", "SciPy Radau": ">", "SciPy LSODA": "d"}
LARGEST, LEAST, SMALLEST = 0.5, 1e-9, 1e-13
"""Errors shown, relative to the box: up to LARGEST, or to twice the smallest error if all are larger; down to LEAST at least."""
BAND = "#f0e2b6"

MARKS = "os^Dvp"
WIDTH = 30  # most characters of a line of the legend
WORDS = """a point for each lattice, the fastest of its most accurate runs; dots: its other runs; lower left is better
hollow: not told apart from what is unknown of the continuum's answer, to which finer lattices tend"""


def front_picture(records: Records) -> bytes:
    """Returns a PNG of error against CPU time, both logarithmic, with one line per method; the front is the pale band behind the
    lines."""
    words = "error against run time, lower left is better; pale: the front"
    words += f"; {records.stop_time:.4g} s with communication steps of {records.communication_step:.4g} s"
    figure, axes = _framed(records.title, words, 0.76, "largest error / largest side of the box")
    largest = max(LARGEST, 2 * min((run.error for run in records.good()), default=0.0))
    front = [run for run in records.front() if run.error <= largest]
    axes.plot(*_points(front), color=BAND, linewidth=17, zorder=1, solid_capstyle="round", solid_joinstyle="round")
    for name in drawn_order(records):
        runs = [run for run in records.good(name) if run.error <= largest]
        if runs:
            axes.plot(*_points(runs), label=LABELS.get(name, name), **_look(name, records))
    _dress_errors(axes, records, largest)
    _label_times(axes)
    _legend(axes, 0.8)
    return png_of(figure)


def _framed(title: str, words: str, height: float, what: str) -> tuple[Figure, Axes]:
    """Returns a figure with axes, both logarithmic, below a title and words. what: the label of the errors."""
    figure = new_figure(13.0, 6.6, dpi=120)
    axes = figure.add_axes((0.07, 0.1, 0.68, height))
    figure.text(0.02, 0.96, title, fontsize=15, fontweight="bold", color=INK, va="center", **PLAIN)
    figure.text(0.02, 0.93, words, fontsize=10.5, color=SOFT, va="top")
    axes.set(xscale="log", yscale="log", xlabel="CPU time of the run", ylabel=what)
    axes.grid(color="#e3e7ed", linewidth=0.8)
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _legend(axes: Axes, spacing: float) -> None:
    legend = axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), frameon=False, fontsize=10.5, labelspacing=spacing)
    for text in legend.get_texts():
        text.set(**PLAIN)


def setting_words(run: Record) -> str:
    """Returns the setting in words without the method: "tolerance 1e-06", "step 2.5e-05 s"."""
    return str(run.setting).partition(", ")[2]


def _points(runs: list[Record]) -> tuple[list[float], list[float]]:
    return [run.cpu_time for run in runs], [max(run.error, SMALLEST) for run in runs]


def drawn_order(records: Records) -> list[str]:
    """Returns the methods in the order of legends and tables: auto, the published scheme, the others."""
    return sorted(records.names(), key=lambda name: (name not in (CHOSEN, PUBLISHED), name != CHOSEN))


def _look(name: str, records: Records) -> dict[str, Any]:
    if name in ANCHOR_MARKS:
        return {"color": "#98a2b0", "linewidth": 1.1, "linestyle": ":", "marker": ANCHOR_MARKS[name], "markersize": 4.5}
    others = [each for each in records.names("softffd") if each not in LOOKS]
    plain = {"color": OTHER_COLOURS[others.index(name) % len(OTHER_COLOURS)], "marker": "*"} if name in others else LOOKS[name]
    return {"linewidth": 1.7, "markersize": 5} | plain


def _label_times(axes: Axes) -> None:
    """Labels 1, 10, 100 ms; also 2 and 5 if the axis is shorter than a factor of 30."""
    low, high = axes.get_xlim()
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 30 * low else (1.0,)))
    axes.xaxis.set_major_formatter(EngFormatter(unit="s", sep=" "))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _dress_errors(axes: Axes, records: Records, largest: float) -> None:
    shown = [run.error for run in records.runs if run.error > 0]
    axes.set_ylim(max(SMALLEST, min([LEAST, *shown]) / 4), largest)
    axes.yaxis.set_major_locator(LogLocator(numticks=20))
    for level in LEVELS:
        axes.axhline(level, color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)), zorder=0)
    unclaimed = CLAIM * records.reference.uncertainty
    if unclaimed > axes.get_ylim()[0]:
        axes.axhspan(axes.get_ylim()[0], unclaimed, color="#eef0f4", zorder=0)
        words = "  not resolved by the reference"
        axes.text(0.0, axes.get_ylim()[0], words, transform=axes.get_yaxis_transform(), fontsize=9, color=SOFT, va="bottom")


# ---- over lattices ----


def space_picture(scenes: Sequence[Records]) -> bytes:
    """Returns a PNG of the error, for the kind of outputs with the largest, against CPU time, both logarithmic."""
    figure, axes = _framed("Error of the continuum's answer against run time", WORDS, 0.73, "largest error / largest change")
    for records, colour, mark in zip(scenes, cycle(CURVES), cycle(MARKS), strict=False):
        runs = _chosen(records)
        axes.plot(*_shown_points(records.good(), records), color=colour, linestyle="none", marker=".", alpha=0.4)
        label = textwrap.fill(f"{records.title} ({records.stop_time:.4g} s)", WIDTH)
        axes.plot(*_shown_points(runs, records), color=colour, linewidth=2.4, marker=mark, markersize=8, label=label)
        hollow = [run for run in runs if run.error < CLAIM * records.reference.uncertainty]
        axes.plot(*_shown_points(hollow, records), color=colour, linestyle="none", marker=mark, markersize=8, markerfacecolor="white")
        for run, time, error in zip(runs, *_shown_points(runs, records), strict=True):
            axes.annotate(run.name, (time, error), xytext=(9, 7), textcoords="offset points", fontsize=9, color=colour)
    axes.margins(x=0.13, y=0.09)
    _label_times(axes)
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=20))
    axes.yaxis.set_major_formatter(lambda error, _place: f"{100 * error:.3g} %")
    axes.yaxis.set_minor_formatter(NullFormatter())
    _legend(axes, 1.2)
    return png_of(figure)


def _chosen(records: Records) -> list[Record]:
    """Returns, for each lattice, the fastest of the runs whose error is within a tenth of the smallest."""
    chosen = []
    for name in dict.fromkeys(run.name for run in records.good()):
        runs = records.good(name)
        least = min(run.error for run in runs)
        chosen.append(min((run for run in runs if run.error <= ALIKE * least), key=lambda run: run.cpu_time))
    return chosen


def _shown_points(runs: Sequence[Record], records: Records) -> tuple[list[float], list[float]]:
    least = max(SMALLEST, records.reference.uncertainty / CLAIM)
    return [run.cpu_time for run in runs], [max(run.error, least) for run in runs]
