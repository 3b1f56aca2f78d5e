"""Pictures of a run: images of its telling moments in a row, and the curves of its reactions and energies below."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softffd.errors import SoftffdError
from softffd.names import components_in, unit_of
from softffd.run.findings import energies, heights, reactions
from softffd.run.result import Columns, Result
from softffd.show.figure import SOFT, Box, Picture, draw_curves, draw_scale, draw_words, new_figure, quantity
from softffd.show.panel import Panels
from softffd.show.sight import sight_onto
from softffd.show.stage import Stage, stage_of, up_direction
from softffd.show.tension import PRESSED, RAMP, outward, tension_of
from softffd.show.touch import Touch, touch_of

GAP = 0.004  # gap between images, as a fraction of the figure's width
CAPTION = 0.32  # height of the caption line below the images [inches]


def run_picture(result: Result, *, colour: str | None = None, lattice: bool | None = None) -> Picture:
    """Draws the picture of `result`: images at the start, first contact, largest deformation and end, and curves over time below.

    colour: a name in `tension.COLOURS`, or contact_pressure, in place of the object's own colours. The picture of contact pressure looks
    at the side that the first grid of taxels faces, and omits obstacles and contacts, which would hide that side. lattice: draw the
    lattice; by default the lattice is drawn where there is no mesh that it would hide.
    Raises SoftffdError when positions of control points were not recorded.
    """
    stage = stage_of(result)
    moments = telling_moments(result)
    cells, tints = tension_of(result, stage, list(moments), colour) if colour else (None, {})
    touch, view = touch_of(result, stage), None
    if colour == PRESSED:
        stage, view = replace(stage, planes=(), solids=()), sight_onto(stage.up, outward(result))
    shown = stage.is_cage if lattice is None else lattice
    low = 0.45 if cells else 0.40
    figure, box = new_figure(13.0, 7.6, dpi=130), (0.02, low, 0.96, 0.93 - low)
    captions = [f"{what}, t = {stage.time[frame]:.4g} s" for frame, what in moments.items()]
    _draw_images(figure, stage, list(moments), captions, box=box, tints=tints, touch=None if view else touch, lattice=shown, view=view)
    draw_words(figure, stage.title, (0.02, 0.965), 15, "left", weight="bold")
    draw_words(figure, _time_and_error(result.summary), (0.98, 0.965), 10.5, "right", SOFT)
    if view:
        draw_words(figure, "seen onto the taxels, without the obstacles, which hide them", (0.98, 0.014), 9.5, "right", SOFT)
    elif touch.ways.any():
        words = "yellow: where it touches, and the force on each obstacle; an arrow twice as long is four times the force"
        draw_words(figure, words, (0.98, 0.014), 9.5, "right", SOFT)
    _draw_history(figure, result, bottom=0.085, top=0.345, marks=[stage.time[frame] for frame in moments])
    if cells:
        draw_scale(figure, (0.40, 0.425, 0.40, 0.012), RAMP, cells.ends, cells.unit, cells.words)
    return figure


def _time_and_error(summary: Mapping[str, Any]) -> str:
    """Returns run time and estimated error as text; "" without an estimate. What is missing from an edited summary is left out."""
    kinds = {"run time": ("run_time_s", "s"), "estimated error": ("estimated_error_m", "m")}
    if summary.get("estimated_error_m") is None:
        return ""
    numbers = {what: (summary.get(key), unit) for what, (key, unit) in kinds.items()}
    return ", ".join(f"{what} {quantity(value, unit)}" for what, (value, unit) in numbers.items() if isinstance(value, int | float))


def curve_picture(result: Result, *, x: str = "time", y: str | Iterable[str]) -> Picture:
    """Draws outputs or inputs `y` over another variable or over time; variables of one unit share axes. A vector's name means its
    components.

    Raises UnknownName with the nearest name, SoftffdError where `x` is a vector or `y` is empty.
    """
    columns = Columns({"time": result.time, **result.columns(), **result.inputs}, "output or input")
    over, *more = _names_of(columns, x)
    if more:
        raise SoftffdError(f"x: wanted one output or input, got the vector {x}; take {', '.join([over, *more])}")
    kinds: dict[str, dict[str, np.ndarray]] = {}
    for name in (each for given in ([y] if isinstance(y, str) else y) for each in _names_of(columns, given)):
        kinds.setdefault(unit_of(name), {})[name] = columns[name]
    if not kinds:
        raise SoftffdError("y: wanted at least one output or input, got none")
    figure = new_figure(1.0 + 6.5 * len(kinds), 5.0, dpi=120)
    draw_words(figure, result.title, (0.02, 0.95), 13, "left", weight="bold")
    across = (over, "s" if over == "time" else unit_of(over))
    for box, (unit, values) in zip(_boxes(len(kinds), bottom=0.14, top=0.8), kinds.items(), strict=True):
        draw_curves(figure, box, next(iter(values)) if len(values) == 1 else "", unit, columns[over], values, across=across)
    return figure


def _names_of(columns: Columns[np.ndarray], name: str) -> list[str]:
    """Returns the name of the variable, or the names of the components of a vector. Raises UnknownName."""
    if name not in columns and (parts := list(components_in(columns, name).values())):
        return parts
    columns[name]  # raises UnknownName if the name is unknown
    return [name]


def telling_moments(result: Result) -> dict[int, str]:
    """Returns start, first contact, largest deformation and end, in the order of time: {frame: words}.

    The first contact is left out if it is within 2 % of the number of frames from another of these moments.
    """
    found = {0: "start", len(result.time) - 1: "end"}
    found.setdefault(int(result.deformation().argmax()), "largest deformation")
    contact = first_contact(result)
    if contact is not None and min(abs(contact - frame) for frame in found) > 0.02 * len(result.time):
        found[contact] = "first contact"
    return dict(sorted(found.items()))


def first_contact(result: Result) -> int | None:
    """Returns the first frame in which an obstacle reports a reaction, or None."""
    forces = [force.any(axis=1) for part, force in reactions(result).items() if part.is_obstacle]
    touching = np.any(forces, axis=0) if forces else np.zeros(1, bool)
    return int(touching.argmax()) if touching.any() else None


def _draw_images(
    figure: Figure, stage: Stage, frames: Sequence[int], captions: Sequence[str], *, box: Box, touch: Touch | None,
    tints: Mapping[int, np.ndarray] | None = None, lattice: bool = True, view: tuple[float, float] | None = None,
) -> None:  # fmt: skip
    """Draws the object in `frames`, side by side in `box` of the figure, with a caption below each image."""
    left, bottom, wide, height = box
    inches = figure.get_size_inches()
    (across, up), low, pitch = inches * figure.dpi, CAPTION / inches[1], (wide + GAP) / len(frames)
    width = pitch - GAP
    panels = Panels(stage, frames, round(width * across), round((height - low) * up), tints=tints, touch=touch, lattice=lattice, view=view)
    for number, (frame, caption) in enumerate(zip(frames, captions, strict=True)):
        begin = left + number * pitch
        pixels = (255 * panels.image(frame) + 0.5).astype(np.uint8)
        figure.figimage(pixels, round(begin * across), round((bottom + low) * up), origin="upper")
        draw_words(figure, caption, (begin + width / 2, bottom + low / 2), 11.5)


def _draw_history(figure: Figure, result: Result, *, bottom: float, top: float, marks: Sequence[float] = ()) -> None:
    """Draws axes for each kind of curve, side by side: reactions and energies, or where there are neither the height of the lattice."""
    forces = {part.name: np.linalg.norm(force, axis=1) for part, force in reactions(result).items()}
    kinds = [each for each in (("reaction", "N", forces), ("energy", "J", energies(result))) if each[2]]
    kinds = kinds or [("height of the lattice", "m", heights(result, up_direction(result)))]
    for box, (label, unit, values) in zip(_boxes(len(kinds), bottom=bottom, top=top), kinds, strict=True):
        draw_curves(figure, box, label, unit, np.asarray(result.time), values, steps=label == "reaction", marks=marks)


def _boxes(count: int, *, bottom: float, top: float) -> list[Box]:
    """Returns `count` boxes for axes side by side, as fractions of the figure."""
    width = 0.96 / count
    return [(0.075 + i * width, bottom, width - 0.085, top - bottom) for i in range(count)]
