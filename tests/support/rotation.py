"""Groups of long tests, each short enough for one run on two cores, and the choice of one by a commit's hash. What is longer than a group
by itself is in none: it is left to the runs of everything."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

GROUP_SECONDS = 420.0
"""Seconds of one core in a group: three and a half minutes of two cores, and on slower machines twice that."""
LONGEST = 250.0
"""Seconds of the longest test in a group, which is among the first."""
UNKNOWN_SECONDS = 3.0
"""s for a test whose time was never recorded."""
NONE: Mapping[str, str] = {}


def groups(tests: list[str], seconds: dict[str, float], bundle: Mapping[str, str] = NONE) -> list[list[str]]:
    """The tests in as few groups as there must be, evenly filled; the same lists give the same groups.

    Tests with the same entry in `bundle` come into the same group. Tests longer than LONGEST, and bundles longer than GROUP_SECONDS, are in
    none.
    """
    bundles: dict[str, list[str]] = {}
    for test in tests:
        bundles.setdefault(bundle.get(test, test), []).append(test)
    took = {name: sum(seconds.get(test, UNKNOWN_SECONDS) for test in bundled) for name, bundled in bundles.items()}
    longest = {name: max(seconds.get(test, UNKNOWN_SECONDS) for test in bundled) for name, bundled in bundles.items()}
    took = {name: total for name, total in took.items() if longest[name] <= LONGEST and total <= GROUP_SECONDS}
    count = max(1, -(-int(sum(took.values())) // int(GROUP_SECONDS)))
    parts: list[list[str]] = [[] for _ in range(count)]
    filled = [0.0] * count
    for name in sorted(took, key=lambda name: (-took[name], name)):
        least = filled.index(min(filled))
        parts[least] += bundles[name]
        filled[least] += took[name]
    return parts


def chosen_group(tests: list[str], seconds: dict[str, float], key: str, bundle: Mapping[str, str] = NONE) -> tuple[set[str], str]:
    """The group for this key, and a line that says which it is."""
    parts = groups(tests, seconds, bundle)
    number = int.from_bytes(hashlib.sha256(key.encode()).digest()[:8]) % len(parts)
    longer = len(tests) - sum(map(len, parts))
    line = f"group {number + 1} of {len(parts)} of the long tests: {len(parts[number])} of {len(tests)}, chosen by {key}"
    line += f" ({longer} are too long for groups)" * (longer > 0)
    return set(parts[number]), line


def renewed(seconds: dict[str, float], took: Mapping[str, float], root: Path) -> dict[str, float]:
    """The times [s] that are recorded after a run: its own, and of tests that did not run those that are still there, as far as their
    functions say; of a test that ran, cells that did not are gone."""
    ran = {test.partition("[")[0] for test in took}

    def stands(test: str) -> bool:
        path, _, name = test.partition("[")[0].rpartition("::")
        return (root / path).is_file() and f"def {name}(" in (root / path).read_text()

    kept = {test: spent for test, spent in seconds.items() if test.partition("[")[0] not in ran and stands(test)}
    return dict(sorted((kept | {test: round(spent, 1) for test, spent in took.items()}).items()))
