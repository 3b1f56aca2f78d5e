"""The one way a file is written: it appears whole, or what stood there before stays."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


@contextmanager
def replacing(path: str | Path) -> Iterator[BinaryIO]:
    """A binary stream into a file beside `path`, which takes its place when the block ends and goes when it fails.

    The name beside is this process's own, so that two that write the same file do not meet. A link stays one: its target is replaced.
    Raises OSError where the folder is missing or may not be written to.
    """
    target = Path(os.path.realpath(path))
    partial = target.with_name(f".{target.name}.{os.getpid()}.partial")
    try:
        with partial.open("wb") as stream:
            yield stream
        os.replace(partial, target)
    finally:
        partial.unlink(missing_ok=True)


def write_bytes(path: str | Path, content: bytes) -> None:
    """Writes a whole file."""
    with replacing(path) as stream:
        stream.write(content)


def write_text(path: str | Path, text: str) -> None:
    """Writes a whole file in UTF-8; line ends stay as they are."""
    write_bytes(path, text.encode())
