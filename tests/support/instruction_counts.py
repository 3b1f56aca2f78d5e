"""Counts of executed instructions, by which a slow-down is seen without timing.

    python tests/support/instruction_counts.py compare     counts beside those of tests/data/instruction_counts.json; status 1 above 1.05
    python tests/support/instruction_counts.py record      writes this compiler's counts anew, for every instruction set of this processor
    ... --build FOLDER                                     where C++ is built, build/native by default

The program tests/core/instruction_counts.cpp counts its own instructions one by one, on Linux on x86-64: an internal step, what a
communication step costs besides, a step in contact of points and of the surface, a damped one, an implicit step, a vertex of `deform`. The
counts are the same on every machine, but for each compiler others: they are kept by its name and major version. Those of the C library are
not among them.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import cpp_tests
from softffd.files import write_text

FILE = cpp_tests.ROOT / "tests" / "data" / "instruction_counts.json"
BUILD = cpp_tests.ROOT / "build" / "native"
SETS = ("baseline", "avx2", "avx512")
MOST = 1.05
"""More of what is kept is a slow-down."""

Counts = dict[str, int]


class NotCounted(Exception):
    """Why there is no count here."""


def built(folder: Path = BUILD) -> Path:
    """The program, built if need be."""
    cpp_tests.build(folder, "-DCMAKE_BUILD_TYPE=Release", target="instruction_counts")
    return folder / "tests" / "core" / "instruction_counts"


def counted(program: Path, instructions: str) -> tuple[str, Counts]:
    """The compiler, as "g++ 12", and the counts by name. NotCounted on other systems and for sets that the processor lacks."""
    done = subprocess.run([program], env=os.environ | {"SOFTFFD_INSTRUCTIONS": instructions}, capture_output=True, text=True, check=True)
    lines = [line.split("\t") for line in done.stdout.splitlines()]
    if not lines:
        raise NotCounted("instructions are counted on Linux on x86-64")
    (compiler, taken), *counts = lines
    if taken != instructions:
        raise NotCounted(f"this processor has no {instructions}")
    return compiler, {name: int(count) for name, count in counts}


def kept() -> dict[str, dict[str, Counts]]:
    """The file's counts by compiler and instruction set."""
    return json.loads(FILE.read_text()) if FILE.is_file() else {}


def kept_of(compiler: str, instructions: str) -> Counts:
    """NotCounted where the file has none for this compiler."""
    if (found := kept().get(compiler, {}).get(instructions)) is None:
        raise NotCounted(f"no counts are kept for {compiler}; `python tests/support/instruction_counts.py record` adds them")
    return found


def slower(counts: Counts, wanted: Counts) -> list[str]:
    """What takes more instructions than it may, in words, and what is not counted any more or not kept."""
    found = [f"{name}: in one of the two alone" for name in counts.keys() ^ wanted.keys()]
    both = [(name, counts[name], wanted[name]) for name in counts if name in wanted]
    return found + [f"{name}: {n} instructions, {n / of:.3f} of {of}" for name, n, of in both if n > MOST * of]


def compare(program: Path) -> int:
    """Prints all counts; returns how many are too large."""
    many = 0
    for instructions in SETS:
        try:
            compiler, counts = counted(program, instructions)
            wanted = kept_of(compiler, instructions)
        except NotCounted as reason:
            print(f"{instructions}: {reason}")
            continue
        print(f"{compiler}, {instructions}")
        for name, count in counts.items():
            print(f"  {name:40} {count:8}  {count / wanted.get(name, count):.3f} of {wanted.get(name, 'none')}")
        many += len(slower(counts, wanted))
    return many


def record(program: Path) -> None:
    """Writes this compiler's counts anew."""
    there = kept()
    for instructions in SETS:
        try:
            compiler, counts = counted(program, instructions)
        except NotCounted as reason:
            print(f"{instructions}: {reason}; what is kept of it stays")
        else:
            there.setdefault(compiler, {})[instructions] = counts
            print(f"{FILE}: {compiler}, {instructions}")
    write_text(FILE, json.dumps(there, indent=1, sort_keys=True) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("--build", type=Path, default=BUILD, metavar="FOLDER")
    options = parser.parse_args()
    program = built(options.build)
    if options.what == "compare":
        return 1 if compare(program) else 0
    record(program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
