"""What tests of several rooms need: pages that a browser is asked for, and the measurement of error against run time."""

from pathlib import Path

import pytest

from measured_scenes import COURSE, DRIVEN, SMALL
from softffd.accuracy import command as command
from softffd.accuracy import measure as accuracy
from softffd.accuracy import reference as accuracy_reference
from softffd.accuracy.measure import measure
from softffd.accuracy.rig import Rig


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


@pytest.fixture
def fail_runs(monkeypatch):
    """fail_runs(error, where): runs of a measurement raise an error where `where(scene's name, setting)` says so."""
    plain = Rig.run

    def fail(error, where=lambda _name, _setting: True) -> None:
        def run(rig, setting, **options):
            if where(rig.scene.name, setting):
                raise error
            return plain(rig, setting, **options)

        monkeypatch.setattr(Rig, "run", run)

    return fail
