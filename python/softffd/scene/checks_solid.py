"""The checks of a solid: its lattice and its methods, and keys that only springs have; and beside springs, keys that only a solid has."""

import math
from collections.abc import Iterator
from typing import Any

from softffd.scene.cells import MOST, PATCH, SLENDER, SLENDER_PATCH, fit_solid
from softffd.scene.checks_material import cells_check, stiffness_text
from softffd.scene.draft import Draft
from softffd.scene.faults import Fault, KeyPath, either, toml_text
from softffd.scene.sections import Stiffness

OF_SPRINGS = {
    ("material", "stiffness"): "youngs_modulus and poissons_ratio say how stiff it is",
    ("material", "volume_stiffness"): "poissons_ratio says how it resists a change of its volume",
    ("lattice", "springs"): "it has no springs",
    ("mass", "uniform_share"): "none of its nodes is nearly massless",
    ("mass", "inertia"): "its masses match the inertia of the object where that is possible",
}
"""Keys that a solid has not, and what it has in their place"""
OF_REGIONS_OF_SPRINGS = {
    "stiffness": "all of it has material.youngs_modulus",
    "youngs_modulus": "all of it has material.youngs_modulus",
    "internal_damping": "all of it has material.internal_damping",
    "density": "give mass, of each of the points",
}
"""The same of a region"""
OF_SOLIDS = {
    ("material", "poissons_ratio"): "that of springs is 1/4",
    ("material", "density"): "give mass.density",
}
"""Keys that springs have not, and what they have in their place"""
OF_PROBES_OF_SOLIDS = dict.fromkeys(("stress", "von_mises", "stretch"), "Result.stress and Result.strain have those of the cells")
"""The same of a probe"""
METHODS, IMPLICIT = ("auto", "leapfrog", "bm4", "rkn12", "dop853"), ("ros34pw2", "backward_euler", "sdirk2")
WIDEST = 320
"""Of a solid for which there are matrices, the nodes of a layer: three planes across the axis with the most points
(fmu_src/core/matrix/lattice_matrix.hpp)"""
SPREADS = ("box", "vertices", "surface", "volume")
SOLID, SPRINGS = (f"material.model = {toml_text(model)}" for model in ("solid", "springs"))


def solid_check(draft: Draft) -> Iterator[Fault]:
    """The problems of a draft's solid, or of what only a solid has."""
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
    """The same of the entries of a list."""
    for number, entry in enumerate(getattr(draft.keys, section)):
        for key, instead in table.items():
            if (value := getattr(entry, key)) is not None and value is not False:
                yield Fault((section, number, key), _none_beside(model, value, instead))


def _given(draft: Draft, section: str, key: str) -> Any:
    """What a scene says; None where it does not."""
    table = getattr(draft.keys, section)
    return getattr(table, key) if key in table.model_fields_set else None


def _none_beside(model: str, value: Any, instead: str) -> str:
    got = stiffness_text(value) if isinstance(value, Stiffness) else toml_text(value)
    return f"wanted none beside {model}, got {got}; {instead}"


def _words(draft: Draft) -> Iterator[Fault]:
    """Of those that a key may have, a solid has some."""
    keys = draft.keys
    one = draft.counts and max(draft.counts) <= PATCH + 1  # patch, which is a Bezier volume
    bases = ("bezier", "patches") if one else ("patches",)
    narrow = draft.counts and PATCH * math.prod(draft.counts) // max(draft.counts) <= WIDEST
    choices: dict[KeyPath, tuple[str, tuple[str, ...]]] = {
        ("lattice", "basis"): (keys.lattice.basis, bases),
        ("mass", "distribution"): (keys.mass.distribution, SPREADS),
        ("solver", "method"): (keys.solver.method, METHODS + IMPLICIT if narrow else METHODS),
    }
    for path, (got, wanted) in choices.items():
        if got not in wanted:
            wide = f"; at most {WIDEST // PATCH} points across the longest axis, as 10 x 10, have it too" if got in IMPLICIT else ""
            yield Fault(path, f"wanted {either(wanted)} beside {SOLID}, got {toml_text(got)}{wide}")


def _density(draft: Draft) -> Iterator[Fault]:
    for key in ("total", "density"):
        if (given := _given(draft, "mass", key)) is not None and (density := draft.keys.material.density) is not None:
            yield Fault(("material", "density"), f"wanted none beside mass.{key} = {given:g}, got {density:g}")


def _lattice(draft: Draft) -> Iterator[Fault]:
    """Whole patches, none too slender."""
    counts = draft.counts
    if counts and any((count - 1) % PATCH for count in counts):
        nearest = [PATCH * min(max(1, round((count - 1) / PATCH)), MOST // PATCH) + 1 for count in counts]
        wanted = f"wanted 4, 7, 10, .. or {MOST // PATCH * PATCH + 1} along each axis beside {SOLID}"
        yield Fault(("lattice", "points"), f"{wanted}, got {toml_text(counts)}; {nearest} is nearest")
        return
    limits = f"at most {SLENDER:g} times as long in one direction as in another ({SLENDER_PATCH:g} times with a single patch)"
    yield from cells_check(draft, fit_solid, f"cells of a solid {limits}")
