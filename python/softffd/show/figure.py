"""A sheet as a figure of matplotlib, and a figure as a PNG."""

from io import BytesIO
from itertools import cycle
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import FigureImage
from matplotlib.ticker import EngFormatter, MaxNLocator
from PIL import Image

from softffd.files import write_bytes
from softffd.show.sheet import PLAIN, SOFT

CURVES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d00", "#56b4e9")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))

COMPRESSION = 3
"""Of the PNG: half the time of the usual 6, a tenth more bytes."""


class Picture(Figure):
    """A figure that a notebook shows as it is; its images have the pixels of its own resolution."""

    def _repr_png_(self):
        return png_of(self)


class Pixels(FigureImage):
    """An image that goes as it is into a figure of its own resolution: to resample it takes as long as to draw the words of a sheet."""

    def __init__(self, figure, image):
        super().__init__(figure, offsetx=image.left, offsety=image.bottom, origin="upper")
        self.set_data(np.dstack([image.pixels, np.full(image.pixels.shape[:2], 255, np.uint8)]))

    def make_image(self, renderer, magnification=1.0, unsampled=False):
        """As matplotlib asks for it: RGBA from the lowest row up, and the place of its lower left corner."""
        if renderer.dpi * magnification != self.get_figure(root=True).dpi:
            return super().make_image(renderer, magnification, unsampled)
        return self.get_array()[::-1], self.ox, self.oy, None


def figure_of(sheet):
    """The sheet as a Picture."""
    figure = new_figure(sheet.width, sheet.height, dpi=sheet.dpi)
    for image in sheet.images:
        figure.add_artist(Pixels(figure, image))
    for words in sheet.words:
        told = (f"{before}{EngFormatter(unit=unit, places=1)(value)}" for before, value, unit in words.quantities)
        look = {"fontsize": words.size, "color": words.colour, "fontweight": words.weight}
        figure.text(*words.place, words.text + "".join(told), ha=words.across, va="center", **look, **PLAIN)
    for curves in sheet.curves:
        _draw_curves(figure, curves)
    if sheet.scale:
        _draw_scale(figure, sheet.scale)
    return figure


def _draw_curves(figure, curves):
    axes = figure.add_axes(curves.box)
    style = "steps-pre" if curves.steps else "default"
    lines = [
        axes.plot(curves.time, values, color=colour, linestyle=dash, linewidth=1.8, drawstyle=style)[0]
        for values, colour, dash in zip(curves.values.values(), cycle(CURVES), cycle(DASHES), strict=False)
    ]
    for moment in curves.marks:
        axes.axvline(moment, color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)), zorder=0)
    name, unit = curves.across
    axes.set_ylabel(curves.label, **PLAIN)
    if name == "time":
        axes.set_xlabel(f"time [{unit}]")
        if curves.time[-1] > curves.time[0]:
            axes.set_xlim(curves.time[0], curves.time[-1])
    else:
        axes.set_xlabel(name, **PLAIN)
        axes.xaxis.set_major_formatter(EngFormatter(unit=unit, sep=" "))
    axes.grid(color="#e3e7ed", linewidth=0.8)
    look = {"loc": "lower left", "bbox_to_anchor": (-0.01, 1.0), "ncols": 5, "frameon": False, "borderpad": 0.2, "columnspacing": 1.2}
    legend = axes.legend(lines, list(curves.values), fontsize=9.5, **look)  # as given: a label of a line must not begin with "_"
    for text in legend.get_texts():
        text.set(**PLAIN)
    axes.spines[["top", "right"]].set_visible(False)
    axes.yaxis.set_major_formatter(EngFormatter(unit=curves.unit, sep=" "))


def _draw_scale(figure, scale):
    colours = ScalarMappable(Normalize(*scale.ends), scale.map)
    bar = figure.colorbar(colours, cax=figure.add_axes(scale.box), orientation="horizontal")
    bar.ax.xaxis.set_major_formatter(EngFormatter(unit=scale.unit, sep=" "))
    bar.ax.xaxis.set_major_locator(MaxNLocator(6))
    bar.ax.tick_params(labelsize=8.5, length=2)
    left, bottom, _, height = scale.box
    figure.text(left - 0.01, bottom + height / 2, scale.words, fontsize=9.5, ha="right", va="center")


def new_figure(width, height, *, dpi):
    """A figure of `width` x `height` inches, without the global state of pyplot."""
    figure = Picture(figsize=(width, height), dpi=dpi, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def png_of(figure):
    """The figure as the bytes of a PNG: drawn once, where savefig first asks what it takes, and without transparency."""
    figure.canvas.draw()
    canvas, stream = figure.canvas, BytesIO()
    image = Image.frombuffer("RGBA", canvas.get_width_height(), canvas.buffer_rgba()).convert("RGB")
    image.save(stream, format="png", dpi=(figure.dpi, figure.dpi), compress_level=COMPRESSION)
    return stream.getvalue()


def save_figure(figure, path):
    """Write the figure to `path` (PNG); returns the path."""
    write_bytes(path, png_of(figure))
    return Path(path)


def save_sheet(sheet, path):
    """Draw the sheet and write it to `path` (PNG); returns the path."""
    return save_figure(figure_of(sheet), path)
