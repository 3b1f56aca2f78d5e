"""Wording of messages: lists of words, and the nearest known name, with which every message about an unknown name ends. The numbers that
words and other values mean, with the message about a value that means none."""

import difflib
import operator
from collections.abc import Iterable, Sequence
from typing import Any

from softffd.errors import FmuError, SoftffdError


def nearest_of(given: str, choices: Iterable[str]) -> str | None:
    """Returns the choice spelt most like `given`, else one of the same letters ("-z": "z-"); None if none is near."""
    by_fold = {choice.casefold(): choice for choice in choices}
    near = difflib.get_close_matches(given.casefold(), by_fold, n=1)
    near += [fold for fold in by_fold if sorted(fold) == sorted(given.casefold())]
    return by_fold[near[0]] if near else None


def did_you_mean(nearest: str | None) -> str:
    """Returns `, did you mean "..."?`; empty without a nearest name."""
    return f', did you mean "{nearest}"?' if nearest else ""


def wanted_one_of(choices: Iterable[str], given: object) -> str:
    """Returns the words of a message about a word that is none of its choices."""
    words = list(choices)
    return f"wanted one of {', '.join(words)}, got {given!r:.70}{did_you_mean(nearest_of(str(given), words))}"


def few(names: Sequence[str]) -> str:
    """Returns the names in one line; of many names the first six and how many more there are."""
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def is_unicode(name: str) -> bool:
    """False for the name of a file whose bytes are no UTF-8, which Python stands in for with surrogates."""
    return not any(0xD800 <= ord(letter) < 0xE000 for letter in name)


def number_in(word: str) -> float:
    """Returns the number that a word in a file or a command means. Raises ValueError for any other word, and for spellings that only
    Python reads as a number: 1_0, digits of other scripts."""
    if "_" in word or not word.isascii():
        raise ValueError(word)
    return float(word)


def one_number(what: str, value: Any, refusal: type[SoftffdError] = FmuError) -> float:
    """Returns the value as a number. Raises the refusal for an array, text and anything else."""
    try:
        if not getattr(value, "ndim", 0) and not isinstance(value, str | bytes):
            return float(value)
    except (TypeError, ValueError):
        pass
    raise refusal(f"{what}: wanted one number, got {value!r:.70}")


def whole_number(what: str, value: Any, least: int) -> int:
    """Returns the value as an integer. Raises SoftffdError for anything that is none, and for one below `least`."""
    try:
        if (number := operator.index(value)) >= least:
            return number
    except TypeError:
        pass
    raise SoftffdError(f"{what}: wanted a whole number of at least {least}, got {value!r:.70}")
