"""The picture of a scene's records: error against run time."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter

from softffd.accuracy.records import CHOSEN, CLAIM, LEVELS, PUBLISHED, Record, Records
from softffd.show.figure import CURVES, INK, PLAIN, SOFT, new_figure, png_of

LOOKS: dict[str, dict[str, Any]] = {
    CHOSEN: {"color": INK, "linewidth": 3.4, "marker": "o", "markersize": 5, "zorder": 5},
    PUBLISHED: {"color": "#d55e00", "linewidth": 2.2, "marker": "X", "markersize": 7, "linestyle": (0, (4, 2)), "zorder": 4},
    "leapfrog": {"color": CURVES[0], "marker": "s"},
    "bm4": {"color": CURVES[2], "marker": "D"},
    "rkn12": {"color": CURVES[3], "marker": "^"},
    "dop853": {"color": CURVES[4], "marker": "v"},
    "ros34pw2": {"color": CURVES[5], "marker": "P"},
    "sdirk2": {"color": CURVES[2], "marker": "p"},  # bm4 leaves the scenes that have it
}
"""Of the methods by name; others get what is left."""

LABELS = {CHOSEN: "auto", PUBLISHED: "central_difference\n(published scheme)"}
OTHER_COLOURS = ("#7a5195", "#a05d2c", "#3c7a89", "#b0413e")
ANCHOR_MARKS = {"SciPy DOP853": "v", "SciPy RK45": "<", "SciPy Radau": ">", "SciPy LSODA": "d"}
LARGEST, LEAST, SMALLEST = 0.5, 1e-9, 1e-13
"""Errors shown, relative to the box: up to the first, or to twice the smallest if all are larger; down to the second at least."""

BAND = "#f0e2b6"


def front_picture(records: Records) -> bytes:
    """PNG: error against CPU time, both logarithmic, one line per method; the front is the pale band behind the lines."""
    figure = new_figure(13.0, 6.6, dpi=120)
    axes = figure.add_axes((0.07, 0.1, 0.68, 0.76))
    figure.text(0.02, 0.96, records.title, fontsize=15, fontweight="bold", color=INK, va="center", **PLAIN)
    words = "error against run time, lower left is better; pale: the front"
    words += f"; {records.stop_time:.4g} s with communication steps of {records.communication_step:.4g} s"
    figure.text(0.02, 0.915, words, fontsize=10.5, color=SOFT, va="center")
    largest = max(LARGEST, 2 * min((run.error for run in records.good()), default=0.0))
    front = [run for run in records.front() if run.error <= largest]
    axes.plot(*_points(front), color=BAND, linewidth=17, zorder=1, solid_capstyle="round", solid_joinstyle="round")
    for name in drawn_order(records):
        runs = [run for run in records.good(name) if run.error <= largest]
        if runs:
            axes.plot(*_points(runs), label=LABELS.get(name, name), **_look(name, records))
    _dress_errors(axes, records, largest)
    axes.set_xscale("log")
    label_times(axes)
    axes.set_xlabel("CPU time of the run")
    axes.set_ylabel("largest error / largest side of the box")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), frameon=False, fontsize=10.5, labelspacing=0.8)
    return png_of(figure)


def setting_words(run: Record) -> str:
    """The setting without the method: "tolerance 1e-06", "step 2.5e-05 s"."""
    return str(run.setting).partition(", ")[2]


def _points(runs: list[Record]) -> tuple[list[float], list[float]]:
    return [run.cpu_time for run in runs], [max(run.error, SMALLEST) for run in runs]


def drawn_order(records: Records) -> list[str]:
    """Methods in the order of legends and tables: auto, the published scheme, the others."""
    return sorted(records.names(), key=lambda name: (name not in (CHOSEN, PUBLISHED), name != CHOSEN))


def _look(name: str, records: Records) -> dict[str, Any]:
    if name in ANCHOR_MARKS:
        return {"color": "#98a2b0", "linewidth": 1.1, "linestyle": ":", "marker": ANCHOR_MARKS[name], "markersize": 4.5}
    others = [each for each in records.names("softffd") if each not in LOOKS]
    plain = {"color": OTHER_COLOURS[others.index(name) % len(OTHER_COLOURS)], "marker": "*"} if name in others else LOOKS[name]
    return {"linewidth": 1.7, "markersize": 5} | plain


def label_times(axes: Axes) -> None:
    """1, 10, 100 ms; also 2 and 5 where the axis is shorter than a factor of 30."""
    low, high = axes.get_xlim()
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 30 * low else (1.0,)))
    axes.xaxis.set_major_formatter(EngFormatter(unit="s", sep=" "))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _dress_errors(axes: Axes, records: Records, largest: float) -> None:
    axes.set_yscale("log")
    shown = [run.error for run in records.runs if run.error > 0]
    axes.set_ylim(max(SMALLEST, min([LEAST, *shown]) / 4), largest)
    axes.yaxis.set_major_locator(LogLocator(numticks=20))
    axes.grid(color="#e3e7ed", linewidth=0.8)
    for level in LEVELS:
        axes.axhline(level, color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)), zorder=0)
    unclaimed = CLAIM * records.reference.uncertainty
    if unclaimed > axes.get_ylim()[0]:
        axes.axhspan(axes.get_ylim()[0], unclaimed, color="#eef0f4", zorder=0)
        words = "  not resolved by the reference"
        axes.text(0.0, axes.get_ylim()[0], words, transform=axes.get_yaxis_transform(), fontsize=9, color=SOFT, va="bottom")
    axes.spines[["top", "right"]].set_visible(False)
