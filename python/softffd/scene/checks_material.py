"""The checks of springs: stiffness or modulus, what of it regions may override, and the cells that a modulus needs."""

from collections.abc import Iterator, Sequence

from softffd.lattice import cells_within
from softffd.scene.cells import FLATTEST, LONGEST, MOST, Fits, fit_springs, nearest_fit
from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, toml_text
from softffd.scene.sections import Stiffness
from softffd.scene.selection import Ranges, Selection, flat_indices

OF_CELLS = ("youngs_modulus", "internal_damping", "density")
"""Keys of a region that hold in its cells; `internal_damping` where the material has a modulus."""


def material_check(draft: Draft) -> Iterator[Fault]:
    """The problems of a draft's material, of what regions say of it, and of the lattice it needs."""
    material = draft.keys.material
    if material.model == "solid" or not all(draft.sound("material", key) for key in ("model", "stiffness", "youngs_modulus")):
        return
    of_modulus = material.youngs_modulus is not None
    if of_modulus and material.stiffness is not None:
        got = f"stiffness = {stiffness_text(material.stiffness)} and youngs_modulus = {material.youngs_modulus:g}"
        yield Fault(("material",), f"wanted stiffness or youngs_modulus, got {got}")
        return
    if of_modulus and draft.keys.lattice.springs == "paper":
        yield Fault(("lattice", "springs"), 'wanted "distinct", as springs of a youngs_modulus are, got "paper"')
    yield from _regions(draft, of_modulus)
    if of_modulus:
        limits = f"one long side at most {LONGEST:.3g} times the other two, or two long sides at most {FLATTEST:.3g} times the third"
        yield from cells_check(draft, fit_springs, f"nearly cubic cells, for springs of a given modulus: {limits}")


def stiffness_text(stiffness: Stiffness) -> str:
    """As one would write it in the file."""
    kinds = stiffness.model_dump()
    return f"{stiffness.edge:g}" if len(set(kinds.values())) == 1 else toml_text(kinds)


def _regions(draft: Draft, of_modulus: bool) -> Iterator[Fault]:
    distribution = draft.keys.mass.distribution
    for number, region in enumerate(draft.keys.region):
        given = {key: value for key in region.model_fields_set if (value := getattr(region, key)) is not None}
        wrong, other = ("stiffness", "youngs_modulus") if of_modulus else ("youngs_modulus", "stiffness")
        if wrong in given:
            yield Fault(("region", number, wrong), f"wanted {other}, because the material has one, got {wrong} = {given[wrong]:g}")
        if "density" in given and distribution != "box" and draft.sound("mass", "distribution"):
            wanted = 'wanted no density without mass.distribution = "box"'
            yield Fault(("region", number, "density"), f'{wanted}, got {region.density:g} with "{distribution}"')
        held = [key for key in OF_CELLS if key in given and key != wrong and (of_modulus or key == "density")]
        if held and draft.counts and not _holds_a_cell(region.points, draft.counts):
            points = toml_text(region.points.model_dump(exclude_none=True) if isinstance(region.points, Ranges) else region.points)
            text = f"wanted all eight corners of one cell at least, in which {' and '.join(held)} would hold, got {points}"
            yield Fault(("region", number, "points"), text)


def _holds_a_cell(points: Selection, counts: tuple[int, int, int]) -> bool:
    """Whether it does; of a selection that leaves the lattice something else is said."""
    try:
        return bool(cells_within(flat_indices(points, counts), counts).any())
    except ValueError:
        return True


def cells_check(draft: Draft, fits: Fits, wanted: str) -> Iterator[Fault]:
    """The problem of a lattice, where it is known, whose cells do not fit, and which would."""
    if not draft.box or not draft.counts:
        return
    lattice, size, counts = draft.keys.lattice, draft.box[1], [count - 1 for count in draft.counts]
    if fits(size, counts):
        return
    key = next((each for each in ("cells", "spacing") if getattr(lattice, each) is not None), "points")
    wanted = f"wanted {wanted}; got cells of {_sides(size, counts)} m"
    instead = (
        f"the box is too flat or too long for nearly cubic ones, of which a side has at most {MOST // draft.multiple * draft.multiple}"
    )
    if found := nearest_fit(size, counts, fits, draft.multiple):
        value = {"cells": max(found), "spacing": f"{max(size) / max(found):.4g}", "points": [n + 1 for n in found]}[key]
        instead = f"{key} = {value} gives {_sides(size, found)}"
    yield Fault(("lattice", key), f"{wanted}; {instead}")


def _sides(size: Sequence[float], counts: Sequence[int]) -> str:
    return " x ".join(f"{side / count:.4g}" for side, count in zip(size, counts, strict=True))
