"""What tests of several rooms need: pages that a browser is asked for, and the measurement of error against run time."""

from pathlib import Path

import pytest

from measured_scenes import COURSE, DRIVEN, SMALL
from softffd.accuracy import command as command
from softffd.accuracy import measure as accuracy
from softffd.accuracy import reference as accuracy_reference
from softffd.accuracy.measure import measure


@pytest.fixture
def opened(monkeypatch) -> list[str]:
    """The pages that a browser was asked to open."""
    pages: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda page: pages.append(page) or True)
    return pages


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """The working folder, with small.toml, driven.toml and driven.csv."""
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(SMALL)
    Path("driven.toml").write_text(DRIVEN)
    Path("driven.csv").write_text(COURSE)
    return tmp_path


@pytest.fixture
def hasty(monkeypatch):
    """Sweeps and references end after a tenth of the time that even --quick gives them."""
    monkeypatch.setattr(accuracy, "QUICK_BUDGET", 0.02)
    monkeypatch.setattr(accuracy_reference, "QUICK_PATIENCE", 0.1)


@pytest.fixture
def few(monkeypatch):
    """Two methods and few runs, for tests of what the command does around them."""
    monkeypatch.setattr(
        command, "measure", lambda scene, **options: measure(scene, methods=["central_difference", "bm4"], **options | {"repeats": 1})
    )
