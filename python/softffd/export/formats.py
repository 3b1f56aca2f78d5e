"""The table of the formats that a run can be exported to, and the export procedure that all formats share."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import numpy as np

from softffd.errors import SoftffdError
from softffd.export.take import Take
from softffd.files import appearing_in
from softffd.run.progress import Note, silent
from softffd.run.result import Result
from softffd.run.tables import package
from softffd.spelling import did_you_mean, nearest_of, one_number, wanted_one_of, whole_number

TOLERANCE = 1e-3
"""Error allowed where a format approximates, as a fraction of the largest side of the box"""


@dataclass(frozen=True)
class Format:
    """endings: of the file, the first by default. writer: module of this folder whose `write` makes the file. needs: a required package,
    and the extra of softffd that installs it. series: ending of the files that the file lists, in a folder beside it. beside: what
    replaces the ending in further files' names. approximates: the format holds a run within a tolerance. draws: it holds pictures."""

    endings: tuple[str, ...]
    writer: str
    needs: tuple[str, str] | None = None
    series: str = ""
    beside: tuple[str, ...] = ()
    approximates: bool = False
    draws: bool = False

    def ending_of(self, name: str) -> str:
        """Returns the one of the endings that a file's name has, as it is spelled there; "" if the name has none of them."""
        return next((name[-len(each) :] for each in self.endings if name.lower().endswith(each)), "")

    def files(self, path: Path) -> list[Path]:
        """Returns what is written for a path, with or without an ending: the file itself, then the files and the folder beside it."""
        ending = self.ending_of(path.name)
        stem = path.name.removesuffix(ending)
        own = self.endings[0] if self.series or not ending else ending.lower()
        return [path.with_name(stem + each) for each in (own, *self.beside, *([f"_{self.series[1:]}"] if self.series else []))]


FORMATS = {
    "vtkhdf": Format((".vtkhdf",), "vtkhdf", needs=("h5py", "vtkhdf")),
    "vtu": Format((".pvd", ".vtu"), "vtu", series=".vtu"),
    "glb": Format((".glb",), "glb", approximates=True),
    "usd": Format((".usdc", ".usd", ".usda"), "usd", needs=("pxr", "usd")),
    "pc2": Format((".pc2",), "points", beside=("_rest.obj", "_rest.mtl")),
    "ply": Format((".ply.series", ".ply"), "points", series=".ply"),
    "gif": Format((".gif",), "film", draws=True),
    "mp4": Format((".mp4",), "film", draws=True),
}


def format_of(path: Path | None, to: str | None) -> str:
    """Returns the format that `to` names or the file's ending means. Raises SoftffdError where neither names one, or where they differ."""
    if to is not None and to not in FORMATS:
        raise SoftffdError(f"--to: {wanted_one_of(FORMATS, to)}")
    if path is None or (to is not None and not path.suffix):
        if to is None:
            raise SoftffdError(f"export: wanted --to, one of {', '.join(FORMATS)}, or --output with one of their endings")
        return to
    found = next((name for name, each in FORMATS.items() if each.ending_of(path.name)), None)
    if found is None:
        endings = [ending for each in FORMATS.values() for ending in each.endings]
        raise SoftffdError(
            f"{path}: wanted a name that ends with one of {', '.join(endings)}{did_you_mean(nearest_of(path.suffix, endings))}"
        )
    if to not in (None, found):
        raise SoftffdError(f"{path}: has the ending of {found}, but {to} is asked for; wanted {' or '.join(FORMATS[str(to)].endings)}")
    return found


def export_result(
    result: Result, path: str | Path, *, to: str | None = None, tolerance: float | None = None, frames: int | None = None,
    lattice: bool | None = None, note: Note = silent, say: Note = silent,
) -> list[Path]:  # fmt: skip
    """Writes `result` to `path` as `Result.export` says; returns the files. note, say: as in a Take."""
    name = format_of(Path(path), to)
    kind = FORMATS[name]
    path, *others = kind.files(Path(path))
    if kind.needs:
        package(kind.needs[0], f"export to {name}", kind.needs[1])
    if tolerance is not None and not (kind.approximates and 0 < one_number("tolerance", tolerance) < np.inf):
        able = _that(lambda each: each.approximates)
        raise SoftffdError(f"tolerance: wanted a number > 0, a share of the largest side of the box, and with {able}, got {tolerance:g}")
    if lattice is not None and not kind.draws:
        raise SoftffdError(f"lattice: wanted with {_that(lambda each: each.draws)}, which are drawn, got {name}")
    take = Take(result, _rows(len(result.time), frames), TOLERANCE if tolerance is None else tolerance, lattice, note, say)
    _ = take.stage  # raises SoftffdError where positions were not recorded
    if not kind.draws:
        take.require_within(name, float(np.spacing(np.abs(take.stage.positions[take.rows]).max().astype(np.float32))) / 2)
    if kind.series:
        _require_own(others[-1], kind.series)
    write: Callable[[Take, Path], None] = import_module(f"softffd.export.{kind.writer}").write
    with appearing_in(path.parent) as place:
        write(take, place / path.name)
        made = sorted(each.name for each in place.iterdir())
    return [path.parent / each for each in made]


def _that(can: Callable[[Format], bool]) -> str:
    return ", ".join(name for name, each in FORMATS.items() if can(each))


def _rows(count: int, frames: int | None) -> np.ndarray:
    """Returns all rows, or evenly chosen ones with the first and the last. Raises SoftffdError for fewer than 2 frames."""
    wanted = count if frames is None else min(count, whole_number("frames", frames, 2))
    return np.unique(np.linspace(0, count - 1, wanted).round().astype(int))


def _require_own(folder: Path, ending: str) -> None:
    """Raises SoftffdError if the folder of a series exists and contains anything that is no file of a series."""
    strange = [each.name for each in folder.iterdir() if each.suffix != ending or not each.is_file()] if folder.is_dir() else []
    if strange:
        raise SoftffdError(f"{folder}: wanted a folder for the series alone, got one with {strange[0]} in it; take another name")
