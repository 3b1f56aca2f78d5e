"""What the header of a result's file says, each part of the kind that it should be."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ValidationError

from softffd.fmu.component import Message
from softffd.lattice import LatticeBox
from softffd.obstacles import Obstacles


class KeptScene(BaseModel):
    """A run's scene."""

    path: Any
    keys: dict[str, Any]
    mesh: str | None
    """Fingerprint of the mesh that was read"""


class Header(BaseModel):
    """All but the arrays, as the Result has it."""

    version: int
    outputs: list[str]
    inputs: list[str]
    parameters: dict[str, bool | int | float | str]
    summary: dict[str, Any]
    lattice: LatticeBox | None
    flat_names: bool
    obstacles: Obstacles | None = None
    log: tuple[Message, ...]
    scene: KeptScene | None


def read_header(said: dict[str, Any]) -> Header:
    """The header from its JSON; ValueError that tells what of it is not as it should be."""
    try:
        return Header.model_validate(said)
    except ValidationError as error:
        fault = error.errors()[0]
        place = ".".join(map(str, fault["loc"]))
        raise ValueError(f"header, {place}: {fault['msg']}") from None
