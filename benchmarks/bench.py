"""Times of the program as ratios to what one would use otherwise, each measured in turn with it: one table.

    python3 python/run.py bench [--quick] [--only TEXT ...] [--library FILE] [-o FILE.json] [--picture FILE.png] [--page FILE.md]

The table has a column for every instruction set of the processor, each measured in a separate process on one core. --quick measures the
widest set alone; --library adds a column for another library, such as that of the release. A ratio is the median over several repetitions
of the program's processor time divided by that of the baseline measured right after. Half the range of the quartiles follows the ratio.
All results are written to softffd-bench/bench.json, completely or not at all.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from typing import Any

import column
import rows  # noqa: F401
import table
from measured import ROWS, Row
from picture import GROUP, draw

from softffd.accuracy.kept import conditions
from softffd.errors import SoftffdError
from softffd.files import require_writable, write_text
from softffd.run.progress import ProgressLine

FILE = Path("softffd-bench") / "bench.json"


def main() -> int:
    """Measures the rows, prints the table and writes the results."""
    options = parsed()
    if options.column:
        return column.serve(options.column, options.library, quick=options.quick)
    chosen = [row for row in ROWS.values() if not options.only or any(text in f"{row.group}: {row.name}" for text in options.only)]
    if not chosen:
        print(f"--only: wanted part of a row's name, got {' '.join(options.only)}; rows: {', '.join(ROWS)}", file=sys.stderr)
        return 1
    if options.picture and GROUP not in {row.group for row in chosen}:
        print(f"--picture: wanted rows of {GROUP!r}, which --only leaves out", file=sys.stderr)
        return 1
    if options.library and not options.library.is_file():
        print(f"--library: wanted a built library, found no file {options.library}", file=sys.stderr)
        return 1
    for file in filter(None, (options.output, options.picture)):
        require_writable(file.parent)
    about = conditions(["python3 python/run.py bench", *sys.argv[1:]], "numba", "scipy", "mujoco") | column.build()
    about["load"] = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    sets = column.instruction_sets()[: 1 if options.quick else None]
    if options.library:
        sets.append(column.OTHER)
        about["other"] = f"{options.library}; {column.compiler(options.library) or 'compiler not known'}"
    measured = measure(chosen, sets, options.library, quick=options.quick)
    document = {"about": about, "quick": options.quick, "sets": sets, "rows": measured}
    options.output.parent.mkdir(parents=True, exist_ok=True)
    write_text(options.output, json.dumps(document, indent=1) + "\n")
    print("\n" + "\n".join(table.foot(document)))
    print(f"kept in {options.output}")
    if options.picture:
        draw(document, options.picture)
    if options.page:
        write_text(options.page, table.in_page(options.page.read_text(), document))
    return 0


def parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="run.py bench", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="one repetition, with the widest instructions: whether it runs, not how fast")
    parser.add_argument("--only", nargs="+", metavar="TEXT", help="rows with this in their names")
    parser.add_argument("--library", type=Path, metavar="FILE", help="a column for this library too, with the widest instructions")
    parser.add_argument("-o", dest="output", type=Path, default=FILE, metavar="FILE.json", help=f"{FILE} by default")
    parser.add_argument("--picture", type=Path, metavar="FILE.png", help="draw what the parts of a scene cost")
    parser.add_argument("--page", type=Path, metavar="FILE.md", help="put the table in the place of the one there")
    parser.add_argument("--column", help=argparse.SUPPRESS)  # for the processes that measure on behalf of this program
    return parser.parse_args()


def measure(chosen: list[Row], sets: list[str], library: Path | None, *, quick: bool) -> list[dict[str, Any]]:
    """Measures each row in every column, or in the first column alone if the row does not depend on the instruction set."""
    found: list[dict[str, Any]] = []
    with column.Columns(sets, library, quick=quick) as columns, ProgressLine("measuring") as line:
        line.say("\n".join(table.head(sets)))
        for number, row in enumerate(chosen):
            if number == 0 or row.group != chosen[number - 1].group:
                line.say(table.heading(row.group))
            results = {}
            for name in sets if row.every_set else sets[:1]:
                line.note(f"{number + 1} of {len(chosen)}: {row.name}, {name}", at_once=True)
                results[name] = columns.measure(name, row.name)
            goals = {"goal": row.goal, "goal_seconds": row.seconds}
            found.append({"group": row.group, "name": row.name, "against": row.against, **goals, "results": results})
            line.say(table.line(found[-1], sets))
    return found


if __name__ == "__main__":
    try:
        sys.exit(main())
    except SoftffdError as error:
        print(f"bench: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print("\nbench: interrupted; nothing is kept", file=sys.stderr)
        sys.exit(130)
