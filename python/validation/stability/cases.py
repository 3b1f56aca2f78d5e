"""The table of extreme cases."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validation.stability import cases_contact, cases_extreme, cases_impact, cases_standard, cases_surface
from validation.stability.verdict import Case, Outcome, run_case

PARTS = {
    "The standard scenes and exact limits": cases_standard,
    "Contact": cases_contact,
    "Contact of the surface": cases_surface,
    "Impacts, sliding and rest of stiff bodies": cases_impact,
    "Extremes": cases_extreme,
}

CASES: dict[str, Case] = {case.name: case for part in PARTS.values() for case in part.cases()}


def run_named(names: Sequence[str]) -> Iterator[Outcome]:
    """Runs cases by name, one after the other."""
    yield from (run_case(CASES[name]) for name in names)
