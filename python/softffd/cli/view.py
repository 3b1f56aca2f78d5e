"""`softffd view`: the page of a kept run, of several runs side by side, or of the components of a coupled run."""

from collections.abc import Sequence
from pathlib import Path

from softffd.errors import SoftffdError
from softffd.files import require_new
from softffd.run.progress import Note, silent
from softffd.run.replay import replay_system
from softffd.run.result import Result
from softffd.run.result_file import KEPT
from softffd.show.view import write_views


def page_to_view(
    what: Sequence[Path], output: Path | None, *, overwrite: bool, together: bool, mesh: Path | None = None, stage: Note = silent,
    say: Note = silent,
) -> Path:  # fmt: skip
    """Returns the page of kept runs, or of a system and the CSV file of its rows; writes it, for one run only where no newer page exists.

    mesh: as in `kept_result`. stage: receives what is being done. say: receives what the user should know.
    output: where the page of several runs goes; by default in this folder, under their names.
    together: the runs are components of one coupled run. Raises SoftffdError for unsuitable files, or a page that may not be overwritten.
    """
    is_system = what[0].suffix.lower() == ".ssp"
    if len(what) == 1 and not is_system:
        if together or output:
            raise SoftffdError(f"view: {'--ssp' if together else '--output'}: wanted with two runs or more; the page of one is beside it")
        stage("writing view.html")
        return page_of(what[0], mesh, say)
    if is_system and (len(what) != 2 or what[1].suffix.lower() != ".csv"):
        raise SoftffdError(f"{what[0]}: wanted with it the CSV file of what a host recorded of the system: softffd view {what[0]} rows.csv")
    page = output or Path(f"{what[0].stem if is_system else '-'.join(map(_short, what))}.html")
    require_new([page], "another name by -o X.html", overwrite=overwrite)
    if mesh:
        raise SoftffdError(f"--mesh: wanted with one kept run, got {len(what)} files; of several the meshes have to lie beside them")
    if is_system:
        runs = replay_system(what[0], what[1], stage)
        for name, run in runs.items():
            _tell_sceneless(name, run, say)
    elif len(set(what)) < len(what):
        raise SoftffdError(f"view: wanted each run once, got {', '.join(map(str, what))}")
    else:  # named after their folders or files; by whole paths where two names are the same
        short = [_short(each) for each in what]
        runs = {
            name if len(set(short)) == len(short) else str(each): kept_result(each, say=say) for name, each in zip(short, what, strict=True)
        }
    stage(f"writing {page.name}")
    return write_views(runs, page, together=together or is_system)


def _short(kept: Path) -> str:
    return (kept.resolve().name if kept.is_dir() else kept.stem).removeprefix("softffd-")


def page_of(kept: Path, mesh: Path | None = None, say: Note = silent) -> Path:
    """Returns the interactive page of a folder that a run is kept in, or of one file; writes it if `mesh` is given, and unless one newer
    than the result exists. mesh, say: as in `kept_result`."""
    results, page = _results_of(kept), kept / "view.html" if kept.is_dir() else kept.with_suffix(".html")
    if not mesh and page.is_file() and page.stat().st_mtime >= results.stat().st_mtime:
        return page
    return kept_result(kept, mesh, say).view(page, browser=False)


def kept_result(kept: Path, mesh: Path | None = None, say: Note = silent) -> Result:
    """Returns the result in a folder that a run is kept in, or in one file. mesh: the file of its scene's mesh, if that lies elsewhere
    now. say: receives why the result does not have its scene."""
    result = Result.load(_results_of(kept), mesh=mesh)
    _tell_sceneless(kept, result, say)
    return result


def _tell_sceneless(name: str | Path, result: Result, say: Note) -> None:
    if result.sceneless:
        say(f"  {name}: without its scene, so without a mesh of it: {result.sceneless}")


def _results_of(kept: Path) -> Path:
    results = kept / KEPT if kept.is_dir() else kept
    if not results.is_file():
        raise SoftffdError(f"{kept}: wanted a folder that softffd run wrote, or a file of Result.save, got no result there")
    return results
