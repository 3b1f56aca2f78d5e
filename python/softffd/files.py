"""The one way a file is written: it appears whole, or what stood there before stays."""

import csv
import io
import json
import math
import os
import secrets
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from softffd.errors import SoftffdError


@contextmanager
def replacing(path: str | Path) -> Iterator[BinaryIO]:
    """A binary stream into a file beside `path`, which takes its place when the block ends and goes when it fails.

    The name beside cannot be guessed and must be new: writers of the same file do not meet, in threads neither, and no link that somebody
    has put there is followed. A link at `path` stays one: its target is replaced. Raises OSError where the folder is missing or may not
    be written to.
    """
    target = Path(os.path.realpath(path))
    partial = target.with_name(f".softffd-{secrets.token_hex(8)}.partial")
    try:
        with partial.open("xb") as stream:
            yield stream
        os.replace(partial, target)
    finally:
        partial.unlink(missing_ok=True)


@contextmanager
def appearing_in(folder: Path) -> Iterator[Path]:
    """A new folder inside `folder`, for a block that writes files into it: what is there when the block ends moves up into `folder`, files
    and folders each in place of the one of its name; nothing does if the block fails. Raises OSError as `replacing` does."""
    place = folder / f".softffd-{secrets.token_hex(8)}.partial"
    place.mkdir()
    try:
        yield place
        for made in sorted(place.iterdir(), key=lambda each: each.is_file()):  # folders first: what lists their files comes after them
            if made.is_dir() and (folder / made.name).is_dir():
                shutil.rmtree(folder / made.name)
            os.replace(made, folder / made.name)
    finally:
        shutil.rmtree(place, ignore_errors=True)


def write_bytes(path: str | Path, content: bytes) -> None:
    """Writes a whole file."""
    with replacing(path) as stream:
        stream.write(content)


def write_text(path: str | Path, text: str) -> None:
    """Writes a whole file in UTF-8; line ends stay as they are."""
    write_bytes(path, text.encode())


def table_text(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A table as CSV, lines ended by a line feed; cells with commas stand between quotation marks."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([head, *rows])
    return text.getvalue()


def json_text(document: Mapping[str, Any]) -> str:
    """JSON; numbers that it does not have are null."""
    return json.dumps(finite(document), indent=1, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """The same with None for numbers that are not finite, also inside."""
    if isinstance(value, Mapping):
        return {name: finite(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def seen_from(folder: str | Path, file: Path) -> str:
    """The path of a file as one names it in a folder."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:  # another drive
        return file.absolute().as_posix()


def size_of(path: Path) -> int:
    """Bytes of a file, or of all files in a folder."""
    return sum(each.stat().st_size for each in path.rglob("*")) if path.is_dir() else path.stat().st_size


def require_new(paths: Iterable[Path], another: str, *, overwrite: bool) -> None:
    """SoftffdError where one of these files is there and not to be written over: to be asked before it is made. another: how to say where
    else it could go."""
    if not overwrite and (there := [str(path) for path in paths if path.is_file()]):
        raise SoftffdError(f"{', '.join(there)}: there already; to write over what is there: --overwrite, to keep it: {another}")


def require_writable(folder: Path) -> None:
    """SoftffdError where files could not be written to a folder, which need not exist yet: to be asked before a long run."""
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise SoftffdError(f"{folder}: wanted a folder to write to, but {there} is a file")
    if not os.access(there, os.W_OK | os.X_OK):
        raise SoftffdError(f"{folder}: wanted a folder to write to, but {there} may not be written to")
