"""Pictures of a run: its telling moments in a row, and the curves of its reactions and energies below."""

from io import BytesIO
from itertools import cycle
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter
from PIL import Image

from softffd.files import write_bytes
from softffd.run.history import energies, heights, reactions
from softffd.show.moments import first_contact, largest_deformation, telling_moments
from softffd.show.panel import Panels, Shape
from softffd.show.stage import stage_of, up_direction
from softffd.show.tension import tension_of
from softffd.show.touch import touch_of

CURVES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d00", "#56b4e9")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)))
INK, SOFT = "#1b2430", "#5b6675"
GAP = 0.004
"""Between images, as a share of the figure's width."""

COMPRESSION = 3
"""Of the PNG: half the time of the usual 6, a tenth more bytes."""

CAPTION = 0.32
"""Height of the line below the images, inches."""


class Picture(Figure):
    """A figure that a notebook shows as it is; its images have the pixels of its own resolution."""

    def _repr_png_(self):
        return png_of(self)


def draw_run(result, path, *, mesh=None, origin=None, size=None, colour=None):
    """Draw what run_figure makes of `result` to `path` (PNG). Returns the path."""
    return save_figure(run_figure(result, mesh=mesh, origin=origin, size=size, colour=colour), path)


def run_figure(result, *, mesh=None, origin=None, size=None, colour=None):
    """The figure of `result`: start, first contact, largest deformation, end; and the history.

    mesh: the object at rest, or None for the boundary of the volume. origin, size: its box (3,) [m] if not the scene's.
    colour: a name of `tension.COLOURS`, in place of the object's own colours.
    Raises SoftffdError when positions of control points were not recorded.
    """
    stage = stage_of(result, mesh=mesh, origin=origin, size=size)
    moments = telling_moments(result)
    tension = tension_of(result, stage, moments, colour) if colour else None
    figure = new_figure(13.0, 7.6, dpi=130)
    figure.text(0.02, 0.965, stage.title, fontsize=15, fontweight="bold", color=INK, va="center")
    if (error := result.summary.get("estimated_error_m")) is not None:
        time, length = (EngFormatter(unit=unit, places=1) for unit in "sm")
        words = f"run time {time(result.summary['run_time_s'])}, estimated error {length(error)}"
        figure.text(0.98, 0.965, words, fontsize=10.5, color=SOFT, va="center", ha="right")
    captions = [f"{what}, t = {stage.time[frame]:.4g} s" for frame, what in moments.items()]
    low = 0.45 if tension else 0.40
    touch = touch_of(result, stage)
    _draw_panels(figure, stage, list(moments), captions, box=(0.02, low, 0.96, 0.93 - low), tension=tension, touch=touch)
    if touch.ways.any():
        words = "yellow: where it touches, and the force on each obstacle, twice as long for 4 times as much"
        figure.text(0.98, 0.014, words, fontsize=9.5, color=SOFT, va="center", ha="right")
    if tension:
        tension.draw_scale(figure, (0.40, 0.425, 0.40, 0.012))
    for axes in _draw_curves(figure, result, bottom=0.085, top=0.345):
        for frame in moments:
            axes.axvline(stage.time[frame], color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)), zorder=0)
    return figure


def draw_strip(result, path, *, mesh=None, moments=None, labels=None, origin=None, size=None):
    """Draw a wide strip to `path` (PNG), as the paper's figure 3: the object with its lattice at several moments.

    moments: times [s], each shown by the nearest recorded frame, or None for the shape at rest; by default rest, just
    before the first contact, the largest deformation, and the end. labels: a caption for each. Returns the path.
    Raises SoftffdError when positions of control points were not recorded.
    """
    stage = stage_of(result, mesh=mesh, origin=origin, size=size)
    if moments is None:
        frames, labels = _four_frames(result), labels or ("at rest", "before", "during", "after")
    else:
        frames = [None if t is None else int(np.abs(stage.time - t).argmin()) for t in moments]
    if labels is None:
        labels = ["at rest" if frame is None else f"t = {stage.time[frame]:.4g} s" for frame in frames]
    figure = new_figure(3.6 * len(frames), 3.2, dpi=170)
    _draw_panels(figure, stage, frames, labels, box=(0.0, 0.0, 1.0, 1.0), touch=touch_of(result, stage))
    return save_figure(figure, path)


def draw_history(result, path):
    """Draw the curves alone to `path` (PNG): reactions [N] and energies [J]; without either the lattice's height."""
    figure = new_figure(13.0, 4.0, dpi=110)
    _draw_curves(figure, result, bottom=0.15, top=0.89)
    return save_figure(figure, path)


def _four_frames(result):
    """None for rest, the frame before the first contact, the one of the largest deformation, the last."""
    worst, contact = largest_deformation(result), first_contact(result)
    before = worst // 2 if contact is None or contact >= worst else contact - 1
    return [None, max(0, before), worst, len(result.time) - 1]


def _draw_panels(figure, stage, frames, captions, *, box, touch, tension=None):
    """Images side by side, their captions below, in `box` (left, bottom, width, height; shares of the figure)."""
    left, bottom, width, height = box
    pitch = (width + GAP) / len(frames)
    across, up = figure.get_size_inches() * figure.dpi
    caption_height = CAPTION * figure.dpi / up
    bottom, height = bottom + caption_height, height - caption_height
    shapes = [Shape(stage, frame) for frame in frames]
    tints = tension.tints if tension else {}
    panels = Panels(stage, shapes, round((pitch - GAP) * across), round(height * up), tints=tints, touch=touch)
    for i, (shape, caption) in enumerate(zip(shapes, captions, strict=True)):
        image = (255 * panels.image(shape) + 0.5).astype(np.uint8)
        figure.figimage(image, round((left + i * pitch) * across), round(bottom * up), origin="upper")
        middle = left + i * pitch + (pitch - GAP) / 2
        figure.text(middle, bottom - caption_height / 2, caption, ha="center", va="center", fontsize=11.5, color=INK)


def _draw_curves(figure, result, *, bottom, top):
    """One axes per kind of curve, side by side; returns them."""
    forces = {part.name: np.linalg.norm(force, axis=1) for part, force in reactions(result).items()}
    kinds = [("reaction", "N", forces, "steps-pre"), ("energy", "J", energies(result), "default")]
    fallback = ("height of the lattice", "m", heights(result, up_direction(result.scene)), "default")
    kinds = [kind for kind in kinds if kind[2]] or [fallback]
    width = 0.96 / len(kinds)
    every = []
    for i, (label, unit, curves, style) in enumerate(kinds):
        axes = figure.add_axes((0.075 + i * width, bottom, width - 0.085, top - bottom))
        for (name, values), colour, dash in zip(curves.items(), cycle(CURVES), cycle(DASHES), strict=False):
            look = {"color": colour, "linestyle": dash, "linewidth": 1.8, "drawstyle": style}
            axes.plot(result.time, values, label=name, **look)
        _dress(axes, result.time, label, unit)
        every.append(axes)
    return every


def _dress(axes, time, label, unit):
    axes.set_xlabel("time [s]")
    axes.set_ylabel(label)
    if time[-1] > time[0]:
        axes.set_xlim(time[0], time[-1])
    axes.grid(color="#e3e7ed", linewidth=0.8)
    axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=5, frameon=False, fontsize=9.5, borderpad=0.2, columnspacing=1.2)
    axes.spines[["top", "right"]].set_visible(False)
    axes.yaxis.set_major_formatter(EngFormatter(unit=unit, sep=" "))


def new_figure(width, height, *, dpi):
    """A figure of `width` x `height` inches, without the global state of pyplot."""
    figure = Picture(figsize=(width, height), dpi=dpi, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def png_of(figure):
    """The figure as the bytes of a PNG: drawn once, where savefig first asks what it takes, and without transparency."""
    canvas, stream = figure.canvas, BytesIO()
    canvas.draw()
    image = Image.frombuffer("RGBA", canvas.get_width_height(), canvas.buffer_rgba()).convert("RGB")
    image.save(stream, format="png", dpi=(figure.dpi, figure.dpi), compress_level=COMPRESSION)
    return stream.getvalue()


def save_figure(figure, path):
    """Write the figure to `path` (PNG); returns the path."""
    write_bytes(path, png_of(figure))
    return Path(path)
