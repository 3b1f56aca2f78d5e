"""Pictures of a run: its telling moments in a row, and the curves of its reactions and energies below."""

from dataclasses import replace

import numpy as np

from softffd.errors import SoftffdError
from softffd.names import unit_of
from softffd.run.findings import energies, heights, reactions
from softffd.run.result import Columns
from softffd.show.moments import first_contact, largest_deformation, telling_moments
from softffd.show.panel import Panels, Shape
from softffd.show.sheet import SOFT, Curves, Image, Sheet, Words
from softffd.show.stage import stage_of, up_direction
from softffd.show.tension import tension_of
from softffd.show.touch import touch_of

GAP = 0.004
"""Between images, as a share of the sheet's width."""

CAPTION = 0.32
"""Height of the line below the images, inches."""


def run_sheet(result, *, mesh=None, origin=None, size=None, colour=None, lattice=False):
    """The picture of `result`: start, first contact, largest deformation, end; and the history.

    mesh: the object at rest, or None for the boundary of the volume. origin, size: its box (3,) [m] if not the scene's.
    colour: a name of `tension.COLOURS`, in place of the object's own colours. lattice: draw the lattice over a mesh too, which it
    would hide.
    Raises SoftffdError when positions of control points were not recorded.
    """
    stage = stage_of(result, mesh=mesh, origin=origin, size=size)
    moments = telling_moments(result)
    tension = tension_of(result, stage, moments, colour) if colour else None
    touch = touch_of(result, stage)
    captions = [f"{what}, t = {stage.time[frame]:.4g} s" for frame, what in moments.items()]
    low = 0.45 if tension else 0.40
    sheet = Sheet(13.0, 7.6, dpi=130)
    box = (0.02, low, 0.96, 0.93 - low)
    images = _images(sheet, stage, list(moments), box=box, tension=tension, touch=touch, lattice=lattice or mesh is None)
    words = [Words(stage.title, (0.02, 0.965), 15, "left", weight="bold"), *_captions(sheet, captions, box)]
    if (error := result.summary.get("estimated_error_m")) is not None:
        quantities = (("run time ", result.summary["run_time_s"], "s"), (", estimated error ", error, "m"))
        words.append(Words("", (0.98, 0.965), 10.5, "right", SOFT, quantities=quantities))
    if touch.ways.any():
        said = "yellow: where it touches, and the force on each obstacle; an arrow twice as long is four times the force"
        words.append(Words(said, (0.98, 0.014), 9.5, "right", SOFT))
    curves = _curves(result, bottom=0.085, top=0.345, marks=[stage.time[frame] for frame in moments])
    scale = tension.scale((0.40, 0.425, 0.40, 0.012)) if tension else None
    return replace(sheet, images=images, words=tuple(words), curves=curves, scale=scale)


def strip_sheet(result, *, mesh=None, moments=None, labels=None, origin=None, size=None):
    """A wide strip, as the paper's figure 3: the object with its lattice at several moments.

    moments: times [s], each shown by the nearest recorded frame, or None for the shape at rest; by default rest, just
    before the first contact, the largest deformation, and the end. labels: a caption for each.
    Raises SoftffdError when positions of control points were not recorded.
    """
    stage = stage_of(result, mesh=mesh, origin=origin, size=size)
    if moments is None:
        frames, labels = _four_frames(result), labels or ("at rest", "before", "during", "after")
    else:
        frames = [None if t is None else int(np.abs(stage.time - t).argmin()) for t in moments]
    if labels is None:
        labels = ["at rest" if frame is None else f"t = {stage.time[frame]:.4g} s" for frame in frames]
    sheet = Sheet(3.6 * len(frames), 3.2, dpi=170)
    box = (0.0, 0.0, 1.0, 1.0)
    images = _images(sheet, stage, frames, box=box, touch=touch_of(result, stage))
    return replace(sheet, images=images, words=tuple(_captions(sheet, labels, box)))


def history_sheet(result):
    """The curves alone: reactions [N] and energies [J]; without either the lattice's height."""
    return Sheet(13.0, 4.0, dpi=110, curves=_curves(result, bottom=0.15, top=0.89))


def curve_sheet(result, *, x="time", y):
    """Outputs or inputs `y` over another one or over time; those of one unit share their axes. A vector's name means its components.

    Raises UnknownName with the nearest name, SoftffdError where `x` is a vector.
    """
    columns = Columns({"time": result.time, **result.columns(), **result.inputs}, "output or input")
    across = _names_of(columns, x)
    if len(across) != 1:
        raise SoftffdError(f"x: wanted one output or input, got the vector {x}; take {', '.join(across)}")
    (across,) = across
    kinds: dict[str, dict[str, np.ndarray]] = {}
    for name in (each for given in ([y] if isinstance(y, str) else y) for each in _names_of(columns, given)):
        kinds.setdefault(unit_of(name), {})[name] = columns[name]
    if not kinds:
        raise SoftffdError("y: wanted at least one output or input, got none")
    over = (across, "s" if across == "time" else unit_of(across))
    curves = tuple(
        Curves(box, next(iter(values)) if len(values) == 1 else "", unit, columns[across], values, across=over)
        for box, (unit, values) in zip(_boxes(len(kinds), bottom=0.14, top=0.8), kinds.items(), strict=True)
    )
    words = (Words(result.title, (0.02, 0.95), 13, "left", weight="bold"),)
    return Sheet(1.0 + 6.5 * len(kinds), 5.0, dpi=120, words=words, curves=curves)


def _names_of(columns, name):
    """The variable of this name, or the components of the vector."""
    if name not in columns and (parts := [full for c in "wxyz" if (full := f"{name}.{c}") in columns]):
        return parts
    columns[name]  # UnknownName where it is not there
    return [name]


def _four_frames(result):
    """None for rest, the frame before the first contact, the one of the largest deformation, the last."""
    worst, contact = largest_deformation(result), first_contact(result)
    before = worst // 2 if contact is None or contact >= worst else contact - 1
    return [None, max(0, before), worst, len(result.time) - 1]


def _images(sheet, stage, frames, *, box, touch, tension=None, lattice=True):
    """The object in `frames`, side by side in `box` of the sheet."""
    _, bottom, _, height = box
    across, up, low = sheet.width * sheet.dpi, sheet.height * sheet.dpi, CAPTION / sheet.height
    lefts, width = _columns(box, len(frames))
    shapes = [Shape(stage, frame) for frame in frames]
    tints = tension.tints if tension else {}
    panels = Panels(stage, shapes, round(width * across), round((height - low) * up), tints=tints, touch=touch, lattice=lattice)
    return tuple(
        Image((255 * panels.image(shape) + 0.5).astype(np.uint8), round(left * across), round((bottom + low) * up))
        for shape, left in zip(shapes, lefts, strict=True)
    )


def _captions(sheet, captions, box):
    """A line below each of the images in `box`."""
    lefts, width = _columns(box, len(captions))
    middle = box[1] + CAPTION / sheet.height / 2
    return [Words(caption, (left + width / 2, middle), 11.5) for caption, left in zip(captions, lefts, strict=True)]


def _columns(box, count):
    """The left edges of images side by side in `box`, and their width, as shares of the sheet."""
    left, _, width, _ = box
    pitch = (width + GAP) / count
    return [left + i * pitch for i in range(count)], pitch - GAP


def _curves(result, *, bottom, top, marks=()):
    """One axes per kind of curve, side by side."""
    forces = {part.name: np.linalg.norm(force, axis=1) for part, force in reactions(result).items()}
    kinds = [("reaction", "N", forces, True), ("energy", "J", energies(result), False)]
    fallback = ("height of the lattice", "m", heights(result, up_direction(result.scene)), False)
    kinds = [kind for kind in kinds if kind[2]] or [fallback]
    return tuple(
        Curves(box, label, unit, np.asarray(result.time), values, steps, tuple(marks))
        for box, (label, unit, values, steps) in zip(_boxes(len(kinds), bottom=bottom, top=top), kinds, strict=True)
    )


def _boxes(count, *, bottom, top):
    """Of axes side by side, as shares of the sheet."""
    width = 0.96 / count
    return [(0.075 + i * width, bottom, width - 0.085, top - bottom) for i in range(count)]
