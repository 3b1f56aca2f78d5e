"""What a picture is made of before it is drawn: words, curves and images, as plain data."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

INK, SOFT = "#1b2430", "#5b6675"
"""Colours of words and lines."""

PLAIN = {"parse_math": False}
"""Of words that are not this program's: two dollars in them make no formula."""

Box = tuple[float, float, float, float]
"""Left, bottom, width and height, as shares of the sheet."""


@dataclass(frozen=True, eq=False)
class Image:
    """`pixels` (height, width, 3), 0 .. 255, with the lower left corner so many pixels from that of the sheet."""

    pixels: np.ndarray
    left: int
    bottom: int


@dataclass(frozen=True)
class Words:
    """A line of `text`, as it is, at a place, as shares of the sheet: `across` it is "left", "center" or "right" of the line. After it come
    `quantities`: each the words before it, a number and its unit."""

    text: str
    place: tuple[float, float]
    size: float
    across: str = "center"
    colour: str = INK
    weight: str = "normal"
    quantities: tuple[tuple[str, float, str], ...] = ()


@dataclass(frozen=True, eq=False)
class Curves:
    """Axes in `box` with a curve for each name over `time` (T,) [s], or over what `across` names with its unit; `marks`: moments [s] that
    have a line; `steps`: each value holds over the time before it."""

    box: Box
    label: str
    unit: str
    time: np.ndarray
    values: Mapping[str, np.ndarray]
    steps: bool = False
    marks: tuple[float, ...] = ()
    across: tuple[str, str] = ("time", "s")


@dataclass(frozen=True)
class Scale:
    """A bar in `box` of all colours of the map of this name, from one of the `ends` to the other; `words` stand before it."""

    box: Box
    map: str
    ends: tuple[float, float]
    unit: str
    words: str


@dataclass(frozen=True, eq=False)
class Sheet:
    """A picture of `width` x `height` inches with `dpi` pixels to the inch."""

    width: float
    height: float
    dpi: int
    images: tuple[Image, ...] = ()
    words: tuple[Words, ...] = ()
    curves: tuple[Curves, ...] = ()
    scale: Scale | None = None
