"""Groups of long tests, each short enough for one run on two cores, and the choice of one by a commit's hash."""

import hashlib

GROUP_SECONDS = 700.0
"""s of tests in a group, as recorded one core each: half of what two cores have in twelve minutes. The rest is for slower machines."""
UNKNOWN_SECONDS = 3.0
"""s for a test whose time was never recorded."""


def groups(tests: list[str], seconds: dict[str, float]) -> list[list[str]]:
    """The tests in as few groups as there must be, evenly filled; the same lists give the same groups."""
    took = {test: seconds.get(test, UNKNOWN_SECONDS) for test in tests}
    count = max(1, -(-int(sum(took.values())) // int(GROUP_SECONDS)))
    parts: list[list[str]] = [[] for _ in range(count)]
    filled = [0.0] * count
    for test in sorted(tests, key=lambda test: (-took[test], test)):
        least = filled.index(min(filled))
        parts[least].append(test)
        filled[least] += took[test]
    return parts


def chosen_group(tests: list[str], seconds: dict[str, float], key: str) -> tuple[set[str], str]:
    """The group for this key, and a line that says which it is."""
    parts = groups(tests, seconds)
    number = int.from_bytes(hashlib.sha256(key.encode()).digest()[:8]) % len(parts)
    line = f"group {number + 1} of {len(parts)} of the long tests: {len(parts[number])} of {len(tests)}, chosen by {key}"
    return set(parts[number]), line
