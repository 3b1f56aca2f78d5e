"""The scene: a TOML file, validated."""

from typing import Any


def __getattr__(name: str) -> Any:
    from softffd.moved import attribute

    return attribute(__name__, name)
