"""Arrays by name in one file, an NPZ archive. numpy.load reads it too; its own savez would not write arrays of any name."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from softffd.errors import SoftffdError
from softffd.run.drive import memory
from softffd.scene.document import shown

UNREADABLE = (OSError, ValueError, EOFError, RuntimeError, zipfile.BadZipFile, zlib.error, MemoryError, OverflowError)
"""What archives raise that are none, or damaged."""


def write_arrays(stream: BinaryIO, arrays: Mapping[str, Any]) -> None:
    """Writes the whole archive, compressed and each entry with its checksum. Nothing is pickled: ValueError for arrays of objects."""
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, values in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                np.lib.format.write_array(entry, np.asanyarray(values), allow_pickle=False)


def read_arrays(path: Path, what: str) -> dict[str, np.ndarray]:
    """All arrays of a file that should be a `what`, "sweep"; SoftffdError where it is missing, damaged, or larger than the memory."""
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(entry.file_size for entry in archive.infolist())
            if size > memory():
                raise SoftffdError(
                    f"{shown(path)}: its arrays take {size / 1e9:.3g} GB; wanted at most {memory() / 1e9:.3g} GB, this machine's memory"
                )
            entries = {name.removesuffix(".npy"): archive.read(name) for name in archive.namelist()}
        return {name: np.lib.format.read_array(BytesIO(entry), allow_pickle=False) for name, entry in entries.items()}
    except FileNotFoundError:
        raise SoftffdError(f"{shown(path)}: there is no such file; wanted a {what} that softffd wrote") from None
    except UNREADABLE as fault:
        raise damaged(path, what, fault) from None


def damaged(path: Path, what: str, fault: object) -> SoftffdError:
    """Of a file that should be a `what`."""
    return SoftffdError(f"{shown(path)}: damaged, or no {what} that softffd wrote ({fault})")
