"""How messages speak of words: a wrong one's nearest right one, with which every message about a name that does not exist ends; lists."""

import difflib
from collections.abc import Iterable, Sequence


def nearest_of(given: str, choices: Iterable[str]) -> str | None:
    """The choice spelt most like `given`, else one of the same letters ("-z": "z-"); None where none is near."""
    by_fold = {choice.casefold(): choice for choice in choices}
    near = difflib.get_close_matches(given.casefold(), by_fold, n=1)
    near += [fold for fold in by_fold if sorted(fold) == sorted(given.casefold())]
    return by_fold[near[0]] if near else None


def did_you_mean(nearest: str | None) -> str:
    """`, did you mean "..."?`, or nothing."""
    return f', did you mean "{nearest}"?' if nearest else ""


def wanted_one_of(choices: Iterable[str], given: object) -> str:
    """What a message says of a word that is none of its choices."""
    words = list(choices)
    return f"wanted one of {', '.join(words)}, got {given!r:.70}{did_you_mean(nearest_of(str(given), words))}"


def few(names: Sequence[str]) -> str:
    """The names in a line, of many the first six and how many more there are."""
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def number_in(word: str) -> float:
    """The number that a word is in a file or a command; ValueError for what only Python reads as one: 1_0, digits of other scripts."""
    if "_" in word or not word.isascii():
        raise ValueError(word)
    return float(word)
