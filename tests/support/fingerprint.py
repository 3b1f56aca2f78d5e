"""The fingerprint of results: a hash of the bits that come out, for every shipped scene with every method it takes and for the stability
cases that end within about two seconds.

    python tests/support/fingerprint.py compare [NAME ...] [-j N]   what differs from tests/data/fingerprint.json; status 1 if anything does
    python tests/support/fingerprint.py record [NAME ...] [-j N]    writes that file anew; with names (parts of them), those entries alone
    ... --library FILE                                              with this library instead of the installed one
    ... --part K/N                                                  of the entries every N-th, from the K-th

Hashed are the control points' positions and the reactions of planes and pins at all communication points, and whether the component
refused. Moving, renaming, splitting and merging code keeps every bit. Where bits change on purpose, a commit does only that, says by how
much, and brings the entries that `record NAME ...` has made anew for what `compare` names. How long a scene runs stands in the file, so
that a slower machine compares the same. With another numpy the last bits of the masses may differ, and then so does all that follows:
there, record on the code before and compare on the code after.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import re
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from softffd import FmuError, Result, Scene, installed, load_scene, simulate
from softffd.installed import table
from softffd.scene.document import shipped_scenes
from validation.guard import guarded
from validation.stability.cases import CASES
from validation.stability.drive import Drive
from validation.stability.verdict import run_case

FILE = Path(__file__).resolve().parents[1] / "data" / "fingerprint.json"

SCENE_TIME, CASE_TIME = 0.4, 2.0
"""CPU time [s] of an entry, about: a scene's run ends earlier where it takes longer, a case that takes longer is left out."""

PATIENCE = 600.0
"""Time [s] in which any case has used up its CPU time, also on a busy machine."""

Entry = dict[str, Any]


def names() -> list[str]:
    """Of all entries that the file can have: "scene NAME, METHOD" and "case NAME"."""
    scenes = [f"scene {name}, {method}" for name in shipped_scenes() for method in _methods()]
    return scenes + [f"case {name}" for name in CASES]


def kept() -> dict[str, Entry]:
    """The file's entries by name."""
    return json.loads(FILE.read_text())


def entry(name: str, like: Entry) -> Entry:
    """The entry of this name now; a scene runs as long as it did in `like`."""
    kind, _, what = name.partition(" ")
    if kind == "case":
        return {"hash": _case(what)}
    scene, method = what.split(", ")
    return {"until": like["until"], "hash": _scene(load_scene(scene), method, like["until"])}


def made(name: str) -> Entry | None:
    """A new entry; None for a case that takes too long."""
    kind, _, what = name.partition(" ")
    if kind == "case":
        _, found = next(guarded(_timed_cases, [what], lambda _: PATIENCE))
        return {"hash": found[0]} if isinstance(found, tuple) and found[1] <= CASE_TIME else None
    scene, method = what.split(", ")
    loaded = load_scene(scene)
    until = loaded.experiment.stop_time
    while until:
        try:
            return {"until": until, "hash": _scene(loaded, method, until, Clock(SCENE_TIME))}
        except Slow as slow:
            until = slow.reached
    return None


class Slow(Exception):
    """A run has taken its time."""

    def __init__(self, reached: float):
        super().__init__(f"{reached:g} s")
        self.reached = reached


class Clock:
    """Ends a run that takes longer [s]."""

    def __init__(self, most: float):
        self.most, self.began = most, None

    def __call__(self, share: float, reached: float) -> None:
        """Told of a run's progress: the simulated time [s] that it has reached."""
        self.began = self.began or time.process_time()
        if time.process_time() - self.began > self.most:
            raise Slow(reached if share < 1 else reached / 2)


def use_library(file: Path | None) -> None:
    """From here on this process runs scenes with this library."""
    if file:
        installed.host_library = lambda: file


def _methods() -> list[str]:
    return [method["key"] for method in table()["method"]]


def _scene(scene: Scene, method: str, until: float, clock: Clock | None = None) -> str:
    observed = scene.replace({"outputs.positions": "all", "outputs.reactions": True})
    settings, digest = {"solver.method": method}, hashlib.sha256()
    try:
        result = simulate(observed, stop_time=until, start_values=settings, inputs=scene.default_inputs, progress=clock)
    except FmuError:
        digest.update(b"refused")
    else:
        for numbers in (result.positions, *_reactions(result)):
            digest.update(np.ascontiguousarray(numbers).tobytes())
    return digest.hexdigest()[:16]


def _reactions(result: Result) -> Iterator[np.ndarray]:
    """In the order of the names that they would have if all obstacles were planes."""
    names = sorted(result.outputs, key=lambda name: re.sub("^(sphere|cylinder|box)", "plane", name))
    return (result.outputs[name] for name in names if ".reaction." in name)


def _case(name: str) -> str:
    digest, step = hashlib.sha256(), Drive.step

    def hashed(drive: Drive, length: float) -> None:
        step(drive, length)
        digest.update(drive.x.tobytes())
        for fixture in [f"plane.{plane.name}" for plane in drive.scene.plane] + [f"pin.{pin.name}" for pin in drive.scene.pin]:
            digest.update(drive.reaction(fixture).tobytes())

    with patch.object(Drive, "step", hashed):
        if run_case(CASES[name]).verdict == "refused":
            digest.update(b"refused")
    return digest.hexdigest()[:16]


def _timed_cases(cases: list[str]) -> Iterator[tuple[str, float]]:
    """Hashes and CPU times [s]; the system ends the process where one takes much too long."""
    import resource  # not on Windows

    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + CASE_TIME) + 1, resource.RLIM_INFINITY))
    for name in cases:
        began = time.process_time()
        yield _case(name), time.process_time() - began


def _compared(job: tuple[str, Entry]) -> tuple[str, bool]:
    name, like = job
    return name, entry(name, like) == like


def compare(chosen: Chosen, pool: ProcessPoolExecutor) -> int:
    """Prints what differs; returns how many entries do."""
    there = kept()
    jobs = [(name, there[name]) for name in chosen.of(list(there))]
    differing = [name for name, same in pool.map(_compared, jobs) if not same]
    for name in differing:
        print(f"differs: {name}")
    print(f"{len(jobs)} entries, {len(differing)} differ")
    return len(differing)


def record(chosen: Chosen, pool: ProcessPoolExecutor) -> None:
    """Writes the file anew, or the chosen entries."""
    there = kept() if chosen != Chosen() and FILE.is_file() else {}
    wanted = chosen.of(names())
    there |= dict(zip(wanted, pool.map(made, wanted), strict=True))
    lines = [f"{json.dumps(name)}: {json.dumps(there[name])}" for name in names() if there.get(name)]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    print(f"{FILE}: {len(lines)} entries")


@dataclass(frozen=True)
class Chosen:
    """Some of the entries: with one of these texts in their names, and of those every `parts`-th, from the `part`-th."""

    texts: tuple[str, ...] = ()
    part: int = 1
    parts: int = 1

    def of(self, entries: list[str]) -> list[str]:
        found = [name for name in entries if not self.texts or any(text in name for text in self.texts)]
        return found[self.part - 1 :: self.parts]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("-j", dest="processes", type=int, default=1, metavar="N")
    parser.add_argument("--library", type=Path, metavar="FILE")
    parser.add_argument("--part", default="1/1", metavar="K/N")
    options = parser.parse_intermixed_args()
    part, parts = map(int, options.part.split("/"))
    chosen = Chosen(tuple(options.names), part, parts)
    with ProcessPoolExecutor(options.processes, initializer=use_library, initargs=(options.library,)) as pool:
        if options.what == "compare":
            return 1 if compare(chosen, pool) else 0
        record(chosen, pool)
    return 0


if __name__ == "__main__":
    import fingerprint  # a guarded process takes what it runs from the module of that name

    sys.exit(fingerprint.main())
