"""The picture of scenes over lattices: error of the continuum's answer against run time, a curve for each scene."""

import textwrap
from collections.abc import Sequence
from itertools import cycle

from matplotlib.ticker import LogLocator, NullFormatter

from softffd.accuracy.picture import SMALLEST, label_times
from softffd.accuracy.records import ALIKE, CLAIM, Record, Records
from softffd.show.figure import CURVES, INK, PLAIN, SOFT, new_figure, png_of

MARKS = "os^Dvp"
WIDTH = 30
"""Letters of a line of the legend."""

WORDS = """a point for each lattice, the fastest of its most accurate runs; dots: its other runs; lower left is better
hollow: not told apart from what is unknown of the continuum's answer, to which finer lattices tend"""


def space_picture(scenes: Sequence[Records]) -> bytes:
    """PNG: error, of the kind of outputs that has the largest, against CPU time, both logarithmic."""
    figure = new_figure(13.0, 6.6, dpi=120)
    axes = figure.add_axes((0.07, 0.1, 0.68, 0.73))
    figure.text(0.02, 0.96, "Error of the continuum's answer against run time", fontsize=15, fontweight="bold", color=INK, va="center")
    figure.text(0.02, 0.93, WORDS, fontsize=10.5, color=SOFT, va="top")
    for records, colour, mark in zip(scenes, cycle(CURVES), cycle(MARKS), strict=False):
        runs = _chosen(records)
        axes.plot(*_points(records.good(), records), color=colour, linestyle="none", marker=".", alpha=0.4)
        label = textwrap.fill(f"{records.title} ({records.stop_time:.4g} s)", WIDTH)
        axes.plot(*_points(runs, records), color=colour, linewidth=2.4, marker=mark, markersize=8, label=label)
        hollow = [run for run in runs if run.error < CLAIM * records.reference.uncertainty]
        axes.plot(*_points(hollow, records), color=colour, linestyle="none", marker=mark, markersize=8, markerfacecolor="white")
        for run, time, error in zip(runs, *_points(runs, records), strict=True):
            axes.annotate(run.name, (time, error), xytext=(9, 7), textcoords="offset points", fontsize=9, color=colour)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(x=0.13, y=0.09)
    label_times(axes)
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=20))
    axes.yaxis.set_major_formatter(lambda error, _place: f"{100 * error:.3g} %")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(color="#e3e7ed", linewidth=0.8)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlabel("CPU time of the run")
    axes.set_ylabel("largest error / largest change")
    legend = axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), frameon=False, fontsize=10.5, labelspacing=1.2)
    for text in legend.get_texts():
        text.set(**PLAIN)
    return png_of(figure)


def _chosen(records: Records) -> list[Record]:
    """Of each lattice the fastest run of those whose error is within a tenth of the smallest."""
    chosen = []
    for name in dict.fromkeys(run.name for run in records.good()):
        runs = records.good(name)
        least = min(run.error for run in runs)
        chosen.append(min((run for run in runs if run.error <= ALIKE * least), key=lambda run: run.cpu_time))
    return chosen


def _points(runs: Sequence[Record], records: Records) -> tuple[list[float], list[float]]:
    least = max(SMALLEST, records.reference.uncertainty / CLAIM)
    return [run.cpu_time for run in runs], [max(run.error, least) for run in runs]
