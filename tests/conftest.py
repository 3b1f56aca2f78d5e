"""Which tests run, and the stored data that they are compared with.

    pytest                  the short run: every feature, representative cells of the large matrices
    pytest --full           everything
    pytest -m lint          layout and types, which the short run leaves out
    pytest --rotate KEY     of what the short run leaves out, the group that KEY (a commit's hash) chooses

A test marked `full` is left to the long runs; a parametrised one marked `short("a-*", "b")` but for the cells of these ids.
A test that is named on the command line (file::test) always runs.
"""

import gzip
import json
import os
import signal
import zipfile
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np
import pytest

from rotation import chosen_group, renewed

DATA = Path(__file__).resolve().parent / "data"
SECONDS = DATA / "seconds.json"


def pytest_addoption(parser):
    group = parser.getgroup("softffd")
    group.addoption("--full", action="store_true", help="run the long tests too")
    group.addoption("--rotate", metavar="KEY", help="run one group of the long tests, which KEY (a commit's hash) chooses")
    group.addoption("--keep-seconds", action="store_true", help=f"with --full: write what each long test took to {SECONDS.name}")


def pytest_configure(config):
    config.addinivalue_line("markers", "full: left to the long runs")
    config.addinivalue_line("markers", "lint: layout and types, a step of its own")
    config.addinivalue_line("markers", "bundle(name): --rotate keeps tests of this name in one group, as they share a long preparation")
    config.addinivalue_line("markers", "short(*ids): of this matrix the short run takes the cells of these ids (with * and ?)")


def pytest_ignore_collect(collection_path, config):
    """Where only tests with certain marks run, files without these marks are not read: that takes as long as many tests."""
    wanted = ("mark.lint",) if config.option.markexpr == "lint" else ("mark.full", "mark.short") if config.option.rotate else ()
    if wanted and collection_path.suffix == ".py" and not any(mark in collection_path.read_text() for mark in wanted):
        return True


def pytest_collection_modifyitems(config, items):
    refuse_idle_patterns(config, items)
    if config.option.rotate:
        long_ones = sorted(item.nodeid for item in items if is_long(item))
        seconds = json.loads(SECONDS.read_text()) if SECONDS.is_file() else {}
        bundle = {item.nodeid: mark.args[0] for item in items if (mark := item.get_closest_marker("bundle"))}
        wanted, config.rotation = chosen_group(long_ones, seconds, config.option.rotate, bundle)
        keep(config, items, lambda item: item.nodeid in wanted)
        longest: dict[Path, float] = {}
        for item in items:
            longest[item.path] = max(longest.get(item.path, 0.0), seconds.get(item.nodeid, 0.0))
        items.sort(key=lambda item: -longest[item.path])  # so that all processes end at about the same time
    elif not config.option.full and not any("::" in argument for argument in config.args):
        lint = config.option.markexpr == "lint"
        keep(config, items, lambda item: not is_long(item) and (item.get_closest_marker("lint") is not None) == lint)


def is_long(item) -> bool:
    cells = item.get_closest_marker("short")
    if cells and not any(fnmatchcase(item.callspec.id, pattern) for pattern in cells.args):
        return True
    return item.get_closest_marker("full") is not None


def keep(config, items, wanted) -> None:
    config.hook.pytest_deselected(items=[item for item in items if not wanted(item)])
    items[:] = [item for item in items if wanted(item)]


def refuse_idle_patterns(config, items) -> None:
    """A pattern of `short` that fits no cell says something that is not so."""
    cells: dict[tuple[str, str], list[str]] = {}
    for item in items:
        for pattern in getattr(item.get_closest_marker("short"), "args", ()):
            cells.setdefault((item.nodeid.partition("[")[0], pattern), []).append(item.callspec.id)
    if any("::" in argument for argument in config.args):
        return
    for (test, pattern), ids in cells.items():
        if not any(fnmatchcase(found, pattern) for found in ids):
            raise pytest.UsageError(f"{test}: short({pattern!r}) fits none of its cells, {', '.join(ids[:5])}, ...")


def pytest_sessionfinish(session):
    if hasattr(session.config, "workeroutput"):  # a process of pytest-xdist
        session.config.workeroutput["rotation"] = getattr(session.config, "rotation", None)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    node.config.rotation = getattr(node, "workeroutput", {}).get("rotation")


def pytest_terminal_summary(terminalreporter, config):
    if rotation := getattr(config, "rotation", None):
        terminalreporter.write_line(rotation)
    if config.option.keep_seconds:
        took: dict[str, float] = {}
        for reports in terminalreporter.stats.values():
            for report in reports:
                if getattr(report, "of_long_test", False):
                    took[report.nodeid] = took.get(report.nodeid, 0.0) + report.spent
        kept = json.loads(SECONDS.read_text()) if SECONDS.is_file() else {}
        SECONDS.write_text(json.dumps(renewed(kept, took, config.rootpath), indent=0) + "\n")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item):
    """With what the processor spent since the report before, on a busy machine too."""
    report = yield
    spent = sum(os.times()[:4])
    report.of_long_test, report.spent = is_long(item), spent - getattr(item.config, "spent", spent)
    item.config.spent = spent
    return report


def plain_files(patch: pytest.MonkeyPatch) -> None:
    """Files that are written in a third of the time: pages without the still picture, which is the one that a run draws for itself too, and
    FMUs that are packed but not compressed."""
    patch.setattr("softffd.show.view._still", lambda _result: "")
    patch.setattr("softffd.fmu.archive.ZIP_DEFLATED", zipfile.ZIP_STORED)


@pytest.fixture(scope="session", autouse=True)
def files():
    with pytest.MonkeyPatch.context() as patch:
        plain_files(patch)
        yield patch


@pytest.fixture
def as_shipped(files):
    """Files are written as users have them."""
    files.undo()
    yield
    plain_files(files)


@pytest.fixture(scope="session")
def golden():
    """golden(name) is the archive of a reference solution in tests/data."""
    return lambda name: np.load(DATA / f"{name}.npz")


@pytest.fixture(scope="session")
def real_meshes(tmp_path_factory) -> Path:
    """A folder with beetle.obj (open) and spot.obj (closed, with texture coordinates); y is up."""
    folder = tmp_path_factory.mktemp("real_meshes")
    for packed in DATA.glob("*.obj.gz"):
        (folder / packed.stem).write_bytes(gzip.decompress(packed.read_bytes()))
    return folder


@pytest.fixture
def ctrl_c_is_heard():
    """Also where the suite runs in the background of a shell, which then ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
