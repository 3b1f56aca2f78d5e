"""The one way in which files are written: a file appears whole, or the file that was there before stays."""

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
from softffd.spelling import did_you_mean


@contextmanager
def replacing(path: str | Path) -> Iterator[BinaryIO]:
    """Opens a binary stream to a temporary file beside `path`, which replaces `path` when the block ends and is deleted when it fails.

    The name of the temporary file cannot be guessed and must be new. Writers of the same file, threads included, therefore do not meet,
    and no link that somebody has put there is followed. If `path` is a link, it stays one, and its target is replaced. A missing folder
    is made. Raises SoftffdError if the folder may not be written to or is a file, or if `path` is a folder, and OSError, which names
    `path`, if writing fails.
    """
    target = Path(os.path.realpath(path))
    _require_no_folder(target, path)
    _make_folder(target.parent if Path(path).is_symlink() else Path(path).parent)
    partial = target.with_name(f".softffd-{secrets.token_hex(8)}.partial")
    try:
        with _naming(path, partial):
            with partial.open("xb") as stream:
                yield stream
            os.replace(partial, target)
    finally:
        partial.unlink(missing_ok=True)


def path_with(ending: str, path: str | Path) -> Path:
    """Returns the path. Raises SoftffdError if no file of this ending can be written there: it has another ending, or is a folder."""
    name = f"{path}" or '""'
    if Path(path).is_dir() and str(path):
        raise SoftffdError(f"{name}: wanted a file name ending in {ending}, got a folder{did_you_mean(str(Path(path) / f'NAME{ending}'))}")
    if Path(path).suffix.lower() != ending:
        raise SoftffdError(f"{name}: wanted a file name ending in {ending}{did_you_mean(f'{path}{ending}' if str(path) else None)}")
    return Path(path)


@contextmanager
def _naming(path: str | Path, partial: Path) -> Iterator[None]:
    """Lets an OSError of the block name `path` in place of the temporary `partial`, also as the folder of a file."""
    try:
        yield
    except OSError as error:
        if str(partial) not in str(error.filename):
            raise
        raise OSError(error.errno, error.strerror, str(error.filename).replace(str(partial), str(path))) from None


def _require_no_folder(target: Path, path: str | Path) -> None:
    if target.is_dir():
        raise SoftffdError(f"{path}: wanted the name of a file, got a folder")


@contextmanager
def appearing_in(folder: Path) -> Iterator[Path]:
    """Makes a new folder inside `folder`, for a block that writes files into it. When the block ends, the content of the new folder
    moves up into `folder`, and each file and folder replaces one of the same name; if the block fails, nothing moves. A missing `folder`
    is made. Raises OSError and SoftffdError as `replacing` does."""
    _make_folder(folder)
    place = folder / f".softffd-{secrets.token_hex(8)}.partial"
    try:
        with _naming(folder, place):
            place.mkdir()
            yield place
            for made in place.iterdir():
                if made.is_file():
                    _require_no_folder(folder / made.name, folder / made.name)
            for made in sorted(place.iterdir(), key=lambda each: each.is_file()):  # a file that lists files of folders comes after them
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
    """Returns a table as CSV. A line feed ends each line, and cells with commas stand between quotation marks."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([head, *rows])
    return text.getvalue()


def json_text(document: Mapping[str, Any]) -> str:
    """Returns a document as JSON text; numbers that JSON does not have become null."""
    return json.dumps(finite(document), indent=1, allow_nan=False) + "\n"


def finite(value: Any) -> Any:
    """Returns the value with None for every number that is not finite, also inside mappings, lists and tuples."""
    if isinstance(value, Mapping):
        return {name: finite(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def seen_from(folder: str | Path, file: Path) -> str:
    """Returns the path of a file relative to a folder; its absolute path if the two are on different drives."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:  # another drive
        return file.absolute().as_posix()


def size_of(path: Path) -> int:
    """Returns the size of a file, or of all files in a folder together [bytes]."""
    return sum(each.stat().st_size for each in path.rglob("*")) if path.is_dir() else path.stat().st_size


def require_new(paths: Iterable[Path], another: str, *, overwrite: bool) -> None:
    """Raises SoftffdError if one of these files exists and must not be overwritten; to be called before the files are made. another:
    words that say how to choose another place."""
    if not overwrite and (there := [str(path) for path in paths if path.is_file()]):
        raise SoftffdError(f"{', '.join(there)}: there already; to write over what is there: --overwrite, to keep it: {another}")


def require_writable(folder: Path) -> None:
    """Raises SoftffdError if files could not be written to a folder, which need not exist yet; to be called before a long run."""
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise SoftffdError(f"{folder}: wanted a folder to write to, but {there} is a file")
    if not os.access(there, os.W_OK | os.X_OK):
        raise SoftffdError(f"{folder}: wanted a folder to write to, but {there} may not be written to")


def _make_folder(folder: Path) -> None:
    """Makes a folder if it is missing. Raises SoftffdError if files cannot be written there."""
    require_writable(folder)
    folder.mkdir(parents=True, exist_ok=True)
