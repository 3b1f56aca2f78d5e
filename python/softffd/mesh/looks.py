"""The looks of a mesh: materials and groups of its faces, colours of its vertices."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

Colour = tuple[float, float, float]
"""Red, green and blue (sRGB), 0 .. 1."""


class Picture(Protocol):
    """An image of Pillow, which is imported only for files that have one."""

    def convert(self, mode: str) -> Any: ...

    def save(self, fp: Any, format: str) -> None: ...


class Material(NamedTuple):
    """A material of faces. colour: multiplies the texture; None if the file gives none. opacity: 0 .. 1, written but not shown."""

    name: str = ""
    colour: Colour | None = None
    texture: Picture | None = None
    opacity: float = 1.0


class Group(NamedTuple):
    """The names of a part of the mesh in its file; "" for a missing name."""

    object: str = ""
    group: str = ""


@dataclass(frozen=True, eq=False)
class Looks:
    """materials and groups, and for each face the index of its material and its group, (F,), or None. colours: (V, 3), sRGB, 0 .. 1, of the
    vertices, multiplied by those of the materials, or None. notes: one line for each part of the looks of the file that was not kept."""

    materials: tuple[Material, ...] = ()
    material_of: np.ndarray | None = field(default=None, repr=False)
    colours: np.ndarray | None = field(default=None, repr=False)
    groups: tuple[Group, ...] = ()
    group_of: np.ndarray | None = field(default=None, repr=False)
    notes: tuple[str, ...] = ()

    def and_notes(self, *notes: str) -> Looks:
        """Returns the looks with more notes; empty notes are dropped."""
        return replace(self, notes=(*self.notes, *filter(None, notes)))

    def with_vertices(self, chosen: np.ndarray) -> Looks:
        """Returns the looks of the mesh whose vertices are replaced by the chosen ones, given by indices (W,)."""
        return self if self.colours is None else replace(self, colours=self.colours[chosen])

    def with_faces(self, chosen: np.ndarray) -> Looks:
        """Returns the looks of the mesh whose faces are replaced by the chosen ones, given by indices (G,)."""
        materials, groups = (None if index is None else index[chosen] for index in (self.material_of, self.group_of))
        return replace(self, material_of=materials, group_of=groups)

    @property
    def textures(self) -> list[Picture]:
        """The images that the materials use, each once."""
        return list({id(each.texture): each.texture for each in self.materials if each.texture is not None}.values())

    def apart(self, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray | None, np.ndarray]:
        """Splits vertices so that each has one material. Returns original vertices (W,), materials (W,) or None, faces (F, 3)."""
        if self.material_of is None:
            return np.arange(faces.max(initial=-1) + 1), None, faces
        pairs = faces * len(self.materials) + self.material_of[:, None]
        pairs, index = np.unique(pairs, return_inverse=True)
        return pairs // len(self.materials), pairs % len(self.materials), index.reshape(-1, 3)


PLAIN = Looks()
"""Looks without any information."""


def from_face_colours(colours: np.ndarray) -> Looks:
    """Returns looks with one material, named after its colour, for each different face colour (F, 3), 0 .. 1."""
    shades, index = np.unique(np.round(255 * colours).clip(0, 255).astype(np.int64), axis=0, return_inverse=True)
    names = ["colour_" + "".join(f"{channel:02x}" for channel in shade) for shade in shades.tolist()]
    materials = tuple(Material(name, tuple((shade / 255).tolist())) for name, shade in zip(names, shades, strict=True))
    return Looks(materials, index.reshape(-1))


def as_shares(numbers: ArrayLike, whole: float | None = None) -> np.ndarray:
    """Returns colours 0 .. 1 from numbers up to `whole`, by default 255 if any number exceeds 1, else 1. NaN counts as 0."""
    given = np.nan_to_num(np.asarray(numbers, dtype=float))
    return (given / (whole or (255.0 if given.max(initial=0) > 1 else 1.0))).clip(0, 1)


def to_screen(linear: np.ndarray) -> np.ndarray:
    """Converts linear light, 0 .. 1, into sRGB, 0 .. 1."""
    linear = np.asarray(linear, dtype=float).clip(0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def to_light(screen: np.ndarray) -> np.ndarray:
    """Converts sRGB, 0 .. 1, into linear light, 0 .. 1."""
    screen = np.asarray(screen, dtype=float).clip(0, 1)
    return np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
