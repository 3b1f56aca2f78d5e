"""The text of the table."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from matplotlib.ticker import EngFormatter

from softffd.accuracy.kept import condition_words

LOADED = 0.7
"""Average number of running processes in the minute before the start, above which the machine counts as loaded by other programs"""

NAME, AGAINST, CELL = 41, 37, 21


def head(sets: Sequence[str]) -> list[str]:
    """Returns the lines above the rows."""
    columns = "".join(f"{name:{CELL}}" for name in sets)
    return [f"{'':{NAME + 2}}{'against':{AGAINST}}{'own time':>9}  {columns}goal"]


def heading(group: str) -> str:
    """Returns the heading above the rows of a group."""
    return f"\n{group}"


def in_page(page: str, document: Mapping[str, Any]) -> str:
    """Returns the page with its table replaced by this table, which is appended if the page has none."""
    rows, sets = document["rows"], document["sets"]
    lines = head(sets)
    for group in dict.fromkeys(row["group"] for row in rows):
        lines += [heading(group), *(line(row, sets) for row in rows if row["group"] == group)]
    block = "\n".join(["```text", *lines, "", *foot(document), "```\n"])
    found = re.search(r"^```text\n {20,}against.*?^```\n", page, re.MULTILINE | re.DOTALL)
    return page.replace(found[0], block) if found else page + block


def line(row: Mapping[str, Any], sets: Sequence[str]) -> str:
    """Returns the line of a row: own time in the first column, ratios in all columns, whether the ratios meet the goal."""
    results = row["results"]
    first = results[sets[0]]
    own = EngFormatter(unit="s", places=1, sep=" ")(first["own"]["median"]) if "own" in first else ""
    cells = "".join(f"{cell(row, results[name]) if name in results else '':{CELL}}" for name in sets)
    return f"  {row['name']:{NAME}}{row['against']:{AGAINST}}{own:>9}  {cells}{goal(row)}".rstrip()


def cell(row: Mapping[str, Any], result: Mapping[str, Any]) -> str:
    """Returns a ratio, its spread, and whether it meets the goal."""
    if "missing" in result:
        return str(result["missing"])
    ratio = result["ratio"]
    low, high = ratio["quartiles"]
    met = kept(row, result)
    return f"{ratio['median']:.3g} ±{float(f'{(high - low) / 2:.1g}'):g}" + ("" if met is None else " met" if met else " missed")


def kept(row: Mapping[str, Any], result: Mapping[str, Any]) -> bool | None:
    """Returns whether the goal is met, or None if there is no goal."""
    if row["goal"] is not None:
        return bool(result["ratio"]["median"] <= row["goal"])
    if row["goal_seconds"] is not None:
        return bool(result["own"]["median"] <= row["goal_seconds"])
    return None


def goal(row: Mapping[str, Any]) -> str:
    """Returns the goal of a row."""
    if row["goal"] is not None:
        return f"{row['goal']:g}"
    return "" if row["goal_seconds"] is None else f"{row['goal_seconds']:g} s"


def foot(document: Mapping[str, Any]) -> Iterator[str]:
    """Yields the lines below the rows: goals, machine, flags."""
    about = document["about"]
    goals = [kept(row, result) for row in document["rows"] for result in row["results"].values() if "ratio" in result]
    yield f"ratios of times, ± half the range of their quartiles; {goals.count(True)} meet their goals, {goals.count(False)} miss them"
    yield condition_words(about)
    yield f"library: {about['compiler'] or 'compiler not known'}; {about['flags'] or 'flags not known'}"
    if "other" in about:
        yield f"other library: {about['other']}"
    if document["quick"]:
        yield "quick: one repetition each, the first, which is slow"
    if (about["load"] or 0) > LOADED:
        yield f"the machine was not idle before: {about['load']:.1f} processes ran on average; ratios may be off"
