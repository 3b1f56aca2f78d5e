"""The checks of a material: stiffness or modulus, what of it regions may override, and the cells that a modulus needs."""

from collections.abc import Iterator
from typing import Any

from softffd.lattice import cells_within
from softffd.scene.cells import FLATTEST, LONGEST, MOST, nearest_solid, solid
from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, toml_text
from softffd.scene.sections import Stiffness
from softffd.scene.selection import flat_indices
from softffd.scene.sound import box_is_sound, counts_are_sound

OTHER = {"stiffness": "youngs_modulus", "youngs_modulus": "stiffness"}
OF_CELLS = ("youngs_modulus", "internal_damping", "density")
"""Keys of a region that hold in its cells; `internal_damping` where the material has a modulus."""


def material_check(draft: Draft) -> Iterator[Fault]:
    """The problems of a draft's material, of what regions say of it, and of the lattice it needs."""
    material = draft.scene.material
    if not draft.sound("material", "stiffness") or not draft.sound("material", "youngs_modulus"):
        return
    of_modulus = material.youngs_modulus is not None
    if of_modulus and material.stiffness is not None:
        got = f"stiffness = {_stiffness_text(material.stiffness)} and youngs_modulus = {material.youngs_modulus:g}"
        yield Fault(("material",), f"wanted stiffness or youngs_modulus, got {got}")
        return
    if of_modulus and draft.scene.lattice.springs == "paper":
        yield Fault(("lattice", "springs"), 'wanted "distinct", as springs of a youngs_modulus are, got "paper"')
    yield from _regions(draft, of_modulus)
    if of_modulus and box_is_sound(draft) and counts_are_sound(draft):
        yield from _cells(draft)


def _stiffness_text(stiffness: Stiffness) -> str:
    kinds = stiffness.model_dump()
    return f"{stiffness.edge:g}" if len(set(kinds.values())) == 1 else toml_text(kinds)


def _regions(draft: Draft, of_modulus: bool) -> Iterator[Fault]:
    for number, region in enumerate(draft.scene.region):
        given = {key for key in region.model_fields_set if getattr(region, key) is not None and draft.sound("region", number, key)}
        wrong = "stiffness" if of_modulus else "youngs_modulus"
        if wrong in given:
            text = f"wanted {OTHER[wrong]}, for the material has one, got {wrong} = {getattr(region, wrong):g}"
            yield Fault(("region", number, wrong), text)
        distribution = draft.scene.mass.distribution
        if "density" in given and distribution != "box" and draft.sound("mass", "distribution"):
            text = f'wanted it with mass.distribution = "box" only, whose cells have masses, got {region.density:g} with "{distribution}"'
            yield Fault(("region", number, "density"), text)
        held = [key for key in OF_CELLS if key in given - {wrong} and (of_modulus or key == "density")]
        if held and counts_are_sound(draft) and draft.sound("region", number, "points"):
            yield from _whole_cells(draft, number, region, held)


def _whole_cells(draft: Draft, number: int, region: Any, held: list[str]) -> Iterator[Fault]:
    counts = draft.scene.lattice.points
    try:
        chosen = flat_indices(region.points, counts)
    except ValueError:
        return  # said of all selections
    if not cells_within(chosen, counts).any():
        keys = " and ".join(held)
        text = f"wanted all eight corners of one cell at least, in which {keys} would hold, got {toml_text(_points_text(region.points))}"
        yield Fault(("region", number, "points"), text)


def _points_text(points: Any) -> Any:
    return points if isinstance(points, str | tuple) else points.model_dump(exclude_none=True)


def _cells(draft: Draft) -> Iterator[Fault]:
    lattice = draft.scene.lattice
    counts = [count - 1 for count in lattice.points]
    if solid(lattice.size, counts):
        return
    key = next((each for each in ("cells", "spacing") if getattr(lattice, each) is not None), "points")
    sides = " x ".join(f"{side / count:.4g}" for side, count in zip(lattice.size, counts, strict=True))
    wanted = (
        f"wanted nearly cubic cells, for springs of a given modulus: one long side at most {LONGEST:.3g} times the other two, "
        f"or two long sides at most {FLATTEST:.3g} times the third; got cells of {sides} m"
    )
    yield Fault(("lattice", key), f"{wanted}; {_instead(lattice, counts, key)}")


def _instead(lattice: Any, counts: list[int], key: str) -> str:
    """Nearly cubic cells, in words of the key that the scene has."""
    found = nearest_solid(lattice.size, counts)
    if found is None:
        return f"the box is too flat or too long for nearly cubic ones, of which a side has at most {MOST}"
    sides = [side / count for side, count in zip(lattice.size, found, strict=True)]
    value = {"cells": max(found), "spacing": f"{max(lattice.size) / max(found):.4g}", "points": toml_text([n + 1 for n in found])}[key]
    return f"{key} = {value} gives {' x '.join(f'{side:.4g}' for side in sides)}"
