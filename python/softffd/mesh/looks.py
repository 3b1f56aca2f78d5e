"""How a mesh looks: materials and groups of its faces, colours of its vertices."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

Colour = tuple[float, float, float]
"""As on a screen (sRGB), 0 .. 1."""


class Picture(Protocol):
    """An image of Pillow, which is imported with files that have one."""

    def convert(self, mode: str) -> Any: ...

    def save(self, fp: Any, format: str) -> None: ...


class Material(NamedTuple):
    """What faces are made of. colour: times the texture's; None: the file says none. opacity: 0 .. 1, written but not shown."""

    name: str = ""
    colour: Colour | None = None
    texture: Picture | None = None
    opacity: float = 1.0


class Group(NamedTuple):
    """A part of the mesh by the names that its file gives; without a name ""."""

    object: str = ""
    group: str = ""


@dataclass(frozen=True, eq=False)
class Looks:
    """materials and groups, with the index that each face has of them, (F,), or None without any. colours: (V, 3) of the
    vertices, sRGB, 0 .. 1, times those of the materials, or None. notes: what of the file's looks was not kept, a line each."""

    materials: tuple[Material, ...] = ()
    material_of: np.ndarray | None = field(default=None, repr=False)
    colours: np.ndarray | None = field(default=None, repr=False)
    groups: tuple[Group, ...] = ()
    group_of: np.ndarray | None = field(default=None, repr=False)
    notes: tuple[str, ...] = ()

    def and_notes(self, *notes: str) -> Looks:
        """These with more notes, those that say something."""
        return replace(self, notes=(*self.notes, *filter(None, notes)))

    def with_vertices(self, chosen: np.ndarray) -> Looks:
        """Those of the mesh with the chosen vertices, indices (W,), in place of its own."""
        return self if self.colours is None else replace(self, colours=self.colours[chosen])

    def with_faces(self, chosen: np.ndarray) -> Looks:
        """Those of the mesh with the chosen faces, indices (G,), in place of its own."""
        materials, groups = (None if index is None else index[chosen] for index in (self.material_of, self.group_of))
        return replace(self, material_of=materials, group_of=groups)

    @property
    def textures(self) -> list[Picture]:
        """The images in use, each once."""
        return list({id(each.texture): each.texture for each in self.materials if each.texture is not None}.values())

    def apart(self, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray | None, np.ndarray]:
        """Vertices that each have one material: which vertex (W,) each copies, its material (W,) or None, and the faces (F, 3) of them."""
        if self.material_of is None:
            return np.arange(faces.max(initial=-1) + 1), None, faces
        pairs = faces * len(self.materials) + self.material_of[:, None]
        pairs, index = np.unique(pairs, return_inverse=True)
        return pairs // len(self.materials), pairs % len(self.materials), index.reshape(-1, 3)


PLAIN = Looks()
"""Nothing is said of looks."""


def from_face_colours(colours: np.ndarray) -> Looks:
    """Looks of faces with a colour each, (F, 3), 0 .. 1: a material for each colour, called after it."""
    shades, index = np.unique(np.round(255 * colours).clip(0, 255).astype(np.int64), axis=0, return_inverse=True)
    names = ["colour_" + "".join(f"{channel:02x}" for channel in shade) for shade in shades.tolist()]
    materials = tuple(Material(name, tuple((shade / 255).tolist())) for name, shade in zip(names, shades, strict=True))
    return Looks(materials, index.reshape(-1))


def as_shares(numbers: ArrayLike, whole: float | None = None) -> np.ndarray:
    """Colours 0 .. 1 of numbers up to `whole`, by default up to 255 where any is above 1; what is no number counts 0."""
    given = np.nan_to_num(np.asarray(numbers, dtype=float))
    return (given / (whole or (255.0 if given.max(initial=0) > 1 else 1.0))).clip(0, 1)


def to_screen(linear: np.ndarray) -> np.ndarray:
    """sRGB of amounts of light, 0 .. 1."""
    linear = np.asarray(linear, dtype=float).clip(0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def to_light(screen: np.ndarray) -> np.ndarray:
    """Amounts of light of sRGB, 0 .. 1."""
    screen = np.asarray(screen, dtype=float).clip(0, 1)
    return np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)
