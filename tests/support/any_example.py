"""Examples that hypothesis draws: a check of very many in the long run, of a few in the short one."""

from collections.abc import Callable
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis.strategies import SearchStrategy

AT_MOST = 20_000
"""Of an example, on a busy machine [ms]"""


def require_of_all(strategy: SearchStrategy[Any], examples: int, check: Callable[[Any], None]) -> None:
    """The check holds for so many examples; those of the short run are the same ones each time."""
    own = settings(
        max_examples=examples, deadline=AT_MOST, database=None, derandomize=examples < 100, suppress_health_check=list(HealthCheck)
    )
    own(given(strategy)(check))()
