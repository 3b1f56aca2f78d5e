"""Mesh files: read, checked, written."""

from typing import Any


def __getattr__(name: str) -> Any:
    from softffd.moved import attribute

    return attribute(__name__, name)
