"""Matplotlib figures in the style of softffd's pictures (text, curves, images, a colour scale), and their files."""

from collections.abc import Iterable, Mapping
from io import BytesIO
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, MaxNLocator

from softffd.errors import SoftffdError
from softffd.files import write_bytes
from softffd.spelling import did_you_mean

INK, SOFT = "#1b2430", "#5b6675"  # colours of text and lines
PLAIN: dict[str, Any] = {"parse_math": False}  # for texts from outside: matplotlib must not read two dollar signs as a formula

CURVES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d00", "#56b4e9")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))

COMPRESSION = 3  # level of the PNG: half the time of the usual level 6, a tenth more bytes

FORMATS = (".png", ".svg", ".pdf")  # endings of pictures' files

Box = tuple[float, float, float, float]  # left, bottom, width and height, as fractions of the figure


class Picture(Figure):
    """A figure that a notebook displays as it is, as a PNG at the figure's own resolution; images in the figure keep their pixels."""

    def _repr_png_(self) -> bytes:
        return png_of(self)


def new_figure(width: float, height: float, *, dpi: float) -> Picture:
    """Returns an empty figure of `width` x `height` inches, made without the global state of pyplot."""
    figure = Picture(figsize=(width, height), dpi=dpi, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def draw_words(
    figure: Figure, text: str, place: tuple[float, float], size: float, across: str = "center", colour: str = INK, weight: str = "normal"
) -> None:
    """Draws a line of uninterpreted text at `place`, in fractions of the figure, which is the text's "left", "center" or "right"."""
    figure.text(*place, text, ha=across, va="center", fontsize=size, color=colour, fontweight=weight, **PLAIN)


def draw_curves(
    figure: Figure, box: Box, label: str, unit: str, time: np.ndarray, values: Mapping[str, np.ndarray], *, steps: bool = False,
    marks: Iterable[float] = (), across: tuple[str, str] = ("time", "s"),
) -> None:  # fmt: skip
    """Draws axes in `box` with one curve per name, of values (T,) over `time` (T,) [s], or over the quantity that `across` gives as
    (name, unit). marks: times [s] marked by a vertical line. steps: each value holds over the time before it."""
    axes = figure.add_axes(box)
    lines = [
        axes.plot(time, curve, color=colour, linestyle=dash, linewidth=1.8, drawstyle="steps-pre" if steps else "default")[0]
        for curve, colour, dash in zip(values.values(), cycle(CURVES), cycle(DASHES), strict=False)
    ]
    for moment in marks:
        axes.axvline(moment, color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)), zorder=0)
    name, of_name = across
    axes.set_ylabel(label, **PLAIN)
    if name == "time":
        axes.set_xlabel(f"time [{of_name}]")
        if time[-1] > time[0]:
            axes.set_xlim(time[0], time[-1])
    else:
        axes.set_xlabel(name, **PLAIN)
        axes.xaxis.set_major_formatter(EngFormatter(unit=of_name, sep=" "))
    axes.grid(color="#e3e7ed", linewidth=0.8)
    look: dict[str, Any] = {"bbox_to_anchor": (-0.01, 1.0), "ncols": 5, "frameon": False, "borderpad": 0.2, "columnspacing": 1.2}
    legend = axes.legend(lines, list(values), loc="lower left", fontsize=9.5, **look)  # a line's own label must not begin with "_"
    for text in legend.get_texts():
        text.set(**PLAIN)
    axes.spines[["top", "right"]].set_visible(False)
    axes.yaxis.set_major_formatter(EngFormatter(unit=unit, sep=" "))


def draw_scale(figure: Figure, box: Box, colours: str, ends: tuple[float, float], unit: str, words: str) -> None:
    """Draws a bar in `box` of the colour map `colours`, from one of the `ends` to the other; the text `words` stands before the bar."""
    bar = figure.colorbar(ScalarMappable(Normalize(*ends), colours), cax=figure.add_axes(box), orientation="horizontal")
    bar.ax.xaxis.set_major_formatter(EngFormatter(unit=unit, sep=" "))
    bar.ax.xaxis.set_major_locator(MaxNLocator(6))
    bar.ax.tick_params(labelsize=8.5, length=2)
    left, bottom, _, height = box
    figure.text(left - 0.01, bottom + height / 2, words, fontsize=9.5, ha="right", va="center")


def quantity(value: float, unit: str) -> str:
    """Returns the value as text, with an SI prefix to its unit and one decimal: "1.0 mm"."""
    return str(EngFormatter(unit=unit, places=1)(value))


def png_of(figure: Figure) -> bytes:
    """Returns the figure as the bytes of a PNG."""
    return _bytes_of(figure, ".png")


def kept_at(file: str | Path | None, figure: Figure) -> Figure:
    """Writes the figure in the format of the file's ending, if there is a file, and returns the figure. Raises SoftffdError for another
    ending than FORMATS has."""
    if file is not None:
        if (ending := Path(file).suffix.lower()) not in FORMATS:
            nearest = did_you_mean(str(Path(file).with_suffix(".png")) if Path(file).name else None)
            raise SoftffdError(f"{file}: wanted a picture's name that ends with {', '.join(FORMATS)}{nearest}")
        write_bytes(file, _bytes_of(figure, ending))
    return figure


def _bytes_of(figure: Figure, ending: str) -> bytes:
    stream = BytesIO()
    settings: dict[str, Any] = {"pil_kwargs": {"compress_level": COMPRESSION}} if ending == ".png" else {}
    figure.savefig(stream, format=ending[1:], **settings)
    return stream.getvalue()
