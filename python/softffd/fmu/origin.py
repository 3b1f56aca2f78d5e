"""Who made what FMUs are made of, and when."""

from __future__ import annotations

import os
from datetime import UTC, datetime
from typing import Final

from softffd.errors import SoftffdError
from softffd.installed import data_folder

AUTHOR: Final = "the softffd authors"
COPYRIGHT: Final = f"Copyright (c) 2026, {AUTHOR}"
"""As the licence says it"""
LAST: Final = 253402300799
"""The last second of the year 9999"""


def generation_time() -> str:
    """The time of the sources, as xs:dateTime: the same scene gives the same FMU whenever it is made.

    It is that of SOURCE_DATE_EPOCH where the environment has it, else of the newest file that the installation puts into FMUs.
    SoftffdError where SOURCE_DATE_EPOCH is no number of seconds.
    """
    given = os.environ.get("SOURCE_DATE_EPOCH")
    if given is None:
        seconds = int(max(file.stat().st_mtime for file in data_folder().rglob("*") if file.is_file()))
    elif given.isascii() and given.isdigit() and int(given) <= LAST:
        seconds = int(given)
    else:
        raise SoftffdError(f"SOURCE_DATE_EPOCH: wanted seconds since 1970, got {given!r}")
    return datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
