"""The checks of the material. Springs: stiffness or modulus, the keys that regions may override, and the cells that a modulus needs. A
solid: its lattice and its methods. Both: keys that only the other model has."""

from collections.abc import Iterator, Sequence
from typing import Any

from softffd.lattice import cells_within
from softffd.scene.cells import (
    FLATTEST,
    LONGEST,
    MOST,
    PATCH,
    SLENDER,
    SLENDER_PATCH,
    WIDEST,
    Fits,
    across_longest,
    fit_solid,
    fit_springs,
    nearest_fit,
)
from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, KeyPath, either, refused, toml_text
from softffd.scene.sections import Stiffness
from softffd.scene.selection import Ranges, Selection, flat_indices

OF_CELLS = ("youngs_modulus", "internal_damping", "density")
"""Keys of a region that apply to its cells; `internal_damping` does so only if the material has a modulus."""
OF_SPRINGS = {
    ("material", "stiffness"): "youngs_modulus and poissons_ratio say how stiff it is",
    ("material", "volume_stiffness"): "poissons_ratio says how it resists a change of its volume",
    ("lattice", "springs"): "it has no springs",
    ("mass", "uniform_share"): "none of its nodes is nearly massless",
    ("mass", "inertia"): "its masses match the inertia of the object where that is possible",
}  # keys that a solid does not have, and what a solid has instead
OF_REGIONS_OF_SPRINGS = {
    "stiffness": "all of it has material.youngs_modulus",
    "youngs_modulus": "all of it has material.youngs_modulus",
    "internal_damping": "all of it has material.internal_damping",
    "density": "give mass, of each of the points",
}  # keys that a region of a solid does not have, and what replaces them
OF_SOLIDS = {
    ("material", "poissons_ratio"): "that of springs is 1/4",
    ("material", "density"): "give mass.density",
}  # keys that springs do not have, and what replaces them
OF_PROBES_OF_SOLIDS = dict.fromkeys(("stress", "von_mises", "stretch"), "Result.stress and Result.strain have those of the cells")
"""Keys that a probe does not have with springs, and what replaces them."""
METHODS, IMPLICIT = ("auto", "leapfrog", "bm4", "rkn12", "dop853"), ("ros34pw2", "backward_euler", "sdirk2")
SPREADS = ("box", "vertices", "surface", "volume")
SOLID, SPRINGS = (f"material.model = {toml_text(model)}" for model in ("solid", "springs"))


def material_check(draft: Draft) -> Iterator[Fault]:
    """Yields the problems of a material of springs, of the region keys that override it, and of the lattice that it needs."""
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
    """Returns the stiffness as one would write it in the file."""
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
            wanted, beside = 'no density without mass.distribution = "box"', f' with "{distribution}"'
            yield refused(("region", number, "density"), wanted, region.density, beside)
        held = [key for key in OF_CELLS if key in given and key != wrong and (of_modulus or key == "density")]
        if held and draft.counts and not _holds_a_cell(region.points, draft.counts):
            points = region.points.model_dump(exclude_none=True) if isinstance(region.points, Ranges) else region.points
            wanted = f"all eight corners of one cell at least, in which {' and '.join(held)} would hold"
            yield refused(("region", number, "points"), wanted, points)


def _holds_a_cell(points: Selection, counts: tuple[int, int, int]) -> bool:
    """True if the selection holds all corners of a cell, or leaves the lattice, which another check reports."""
    try:
        return bool(cells_within(flat_indices(points, counts), counts).any())
    except ValueError:
        return True


def cells_check(draft: Draft, fits: Fits, wanted: str) -> Iterator[Fault]:
    """Yields a problem if the cells of the lattice, where it is known, do not satisfy `fits`; the message names cells that do."""
    if not draft.box or not draft.counts:
        return
    lattice, size, counts = draft.keys.lattice, draft.box[1], [count - 1 for count in draft.counts]
    if fits(size, counts):
        return
    key = next((each for each in ("cells", "spacing") if getattr(lattice, each) is not None), "points")
    wanted = f"wanted {wanted}; got cells of {_sides(size, counts)} m"
    most = MOST // draft.multiple * draft.multiple
    instead = f"the box is too flat or too long for nearly cubic ones, of which a side has at most {most}"
    if found := nearest_fit(size, counts, fits, draft.multiple):
        value = {"cells": max(found), "spacing": f"{max(size) / max(found):.4g}", "points": [n + 1 for n in found]}[key]
        instead = f"{key} = {value} gives {_sides(size, found)}"
    yield Fault(("lattice", key), f"{wanted}; {instead}")


def _sides(size: Sequence[float], counts: Sequence[int]) -> str:
    return " x ".join(f"{side / count:.4g}" for side, count in zip(size, counts, strict=True))


# ---- solid ----


def solid_check(draft: Draft) -> Iterator[Fault]:
    """Yields the problems of a solid, and for springs those of keys that only a solid has."""
    if not draft.sound("material", "model"):
        return
    if draft.keys.material.model == "springs":
        yield from _foreign(draft, OF_SOLIDS, SPRINGS)
        yield from _foreign_in(draft, "probe", OF_PROBES_OF_SOLIDS, SPRINGS)
        if draft.keys.lattice.basis == "patches":
            yield Fault(("lattice", "basis"), f'wanted "bezier" or "bspline" beside {SPRINGS}, got "patches"; a solid has them')
        return
    yield from _foreign(draft, OF_SPRINGS, SOLID)
    yield from _foreign_in(draft, "region", OF_REGIONS_OF_SPRINGS, SOLID)
    yield from _words(draft)
    yield from _density(draft)
    yield from _lattice(draft)
    if draft.keys.material.youngs_modulus is None:
        yield Fault(("material", "youngs_modulus"), f"wanted one in Pa beside {SOLID}, got none")


def _foreign(draft: Draft, table: dict[tuple[str, str], str], model: str) -> Iterator[Fault]:
    for (section, key), instead in table.items():
        if (value := _given(draft, section, key)) is not None:
            yield Fault((section, key), _none_beside(model, value, instead))


def _foreign_in(draft: Draft, section: str, table: dict[str, str], model: str) -> Iterator[Fault]:
    for number, entry in enumerate(getattr(draft.keys, section)):
        for key, instead in table.items():
            if (value := getattr(entry, key)) is not None and value is not False:
                yield Fault((section, number, key), _none_beside(model, value, instead))


def _given(draft: Draft, section: str, key: str) -> Any:
    table = getattr(draft.keys, section)
    return getattr(table, key) if key in table.model_fields_set else None


def _none_beside(model: str, value: Any, instead: str) -> str:
    got = stiffness_text(value) if isinstance(value, Stiffness) else toml_text(value)
    return f"wanted none beside {model}, got {got}; {instead}"


def _words(draft: Draft) -> Iterator[Fault]:
    keys = draft.keys
    one = draft.counts and max(draft.counts) <= PATCH + 1  # a single patch is a Bezier volume
    bases = ("bezier", "patches") if one else ("patches",)
    narrow = draft.counts and across_longest(draft.counts) <= WIDEST
    choices: dict[KeyPath, tuple[str, tuple[str, ...]]] = {
        ("lattice", "basis"): (keys.lattice.basis, bases),
        ("mass", "distribution"): (keys.mass.distribution, SPREADS),
        ("solver", "method"): (keys.solver.method, METHODS + IMPLICIT if narrow else METHODS),
    }
    for path, (got, wanted) in choices.items():
        if got not in wanted:
            wide = f"; at most {WIDEST} points across the longest axis, as 19 x 19, have it too" if got in IMPLICIT else ""
            yield refused(path, f"{either(wanted)} beside {SOLID}", got, wide)


def _density(draft: Draft) -> Iterator[Fault]:
    for key in ("total", "density"):
        if (given := _given(draft, "mass", key)) is not None and (density := draft.keys.material.density) is not None:
            yield refused(("material", "density"), f"none beside mass.{key} = {given:g}", density)


def _lattice(draft: Draft) -> Iterator[Fault]:
    counts = draft.counts
    if counts and any((count - 1) % PATCH for count in counts):
        nearest = [PATCH * min(max(1, round((count - 1) / PATCH)), MOST // PATCH) + 1 for count in counts]
        wanted = f"4, 7, 10, .. or {MOST // PATCH * PATCH + 1} along each axis beside {SOLID}"
        yield refused(("lattice", "points"), wanted, counts, f"; {nearest} is nearest")
        return
    limits = f"at most {SLENDER:g} times as long in one direction as in another ({SLENDER_PATCH:g} times with a single patch)"
    yield from cells_check(draft, fit_solid, f"cells of a solid {limits}")
