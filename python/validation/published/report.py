"""Runs the published cases and writes their table as a CSV file and as a page of the documents."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from softffd.accuracy.kept import conditions, csv_text, keep_files
from softffd.errors import SoftffdError
from softffd.run.progress import Note, silent
from softffd.spelling import wanted_one_of
from validation.published.cases import Case, Row
from validation.published.catalogue import CASES

COLUMNS = ("case", "body", "quantity", "reference", "found", "error_percent", "steps", "run_time_s", "source")
COMMAND = "python3 python/run.py benchmarks"
HEAD = f"""# Published cases

This page compares what comes out with numbers from textbooks and papers, for springs of a modulus and for solids, and names their sources.

- [The table](#the-table)
- [The cases](#the-cases)

## The table

An error is relative to the reference, a time that of the run without its set-up. The FMU gave every number here: this page and
`benchmarks.csv` are made by

```sh full
{COMMAND} -o docs
```

"""


def report_published(folder: Path, only: Sequence[str] = (), note: Note = silent) -> list[Row]:
    """Runs the cases whose titles contain one of the words of `only` (all by default). Writes benchmarks.md and benchmarks.csv to a folder.

    Returns all rows. Raises SoftffdError if a word fits no title.
    """
    chosen = [case for case in CASES if not only or any(word.lower() in case.title.lower() for word in only)]
    for word in only:
        if not any(word.lower() in case.title.lower() for case in CASES):
            raise SoftffdError(f"--only {word}: {wanted_one_of([case.title for case in CASES], word)}")
    found: list[tuple[Case, list[Row]]] = []
    for case in chosen:
        rows: list[Row] = []
        for body in case.bodies:
            note(f"{case.title}: {body}")
            rows += case.rows(body)
        found.append((case, rows))
    keep_files(folder, {"benchmarks.md": page(found), "benchmarks.csv": table(found)})
    return [row for _, rows in found for row in rows]


def table(found: Sequence[tuple[Case, Sequence[Row]]]) -> str:
    """Returns the text of the CSV file."""
    return csv_text(COLUMNS, (_cells(case, row) for case, rows in found for row in rows))


def _cells(case: Case, row: Row) -> dict[str, object]:
    return {
        "case": case.title, "body": str(row.body), "quantity": row.quantity, "reference": row.reference, "found": row.found,
        "error_percent": 100 * row.error, "steps": row.steps, "run_time_s": row.seconds, "source": case.source,
    }  # fmt: skip


def page(found: Sequence[tuple[Case, Sequence[Row]]]) -> str:
    """Returns the text of the page: one table, and a paragraph for each case."""
    lines = ["| case | body | quantity | reference | found | error | steps | time |", "|---|---|---|---|---|---|---|---|"]
    for case, rows in found:
        name = f"[{case.title}](#{_anchor(case.title)})"
        lines += [
            f"| {name} | {row.body} | {row.quantity} | {row.reference:.5g} | {row.found:.5g} | {_percent(row.error)} | {row.steps:,} | "
            f"{row.seconds:.2g} s |"
            for row in rows
        ]
    about = conditions([COMMAND])
    machine = f"Measured on {about['date'][:10]}: {about['machine']['processor']}, one core."
    cases = "\n\n".join(f"### {case.title}\n\n{_filled(paragraph(case))}" for case, _ in found)
    return HEAD + "\n".join(lines) + f"\n\n{machine}\n\n## The cases\n\n{cases}\n"


def _percent(error: float) -> str:
    error *= 100
    return f"{error:+.0f} %" if abs(error) >= 9.95 else f"{error:+.1f} %" if abs(error) >= 0.995 else f"{error:+.2f} %"


def paragraph(case: Case) -> str:
    """Returns a paragraph on the parameters of a case, the uncertainty of its reference, and its source."""
    return f"{case.parameters} {case.certainty} Source: {case.source}."


def _anchor(title: str) -> str:
    return "".join(c for c in title.lower().replace(" ", "-") if c.isalnum() or c == "-")


def _filled(text: str, width: int = 140) -> str:
    """Returns the text in lines shorter than `width`, broken at spaces only, so that a link stays in one piece."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] += word if not lines[-1] else f" {word}"
    return "\n".join(lines)
