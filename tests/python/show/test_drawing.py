"""A process beside draws what this one would, whatever happens to it."""

import tempfile

import numpy as np
import pytest

from softffd.show import drawing as beside
from softffd.show.drawing import drawing
from softffd.show.figure import figure_of, png_of
from softffd.show.sheet import Curves, Image, Scale, Sheet, Words

IMAGE = Image(np.random.default_rng(1).integers(0, 255, (40, 60, 3), np.uint8), 20, 2)
TIME = np.linspace(0.0, 2.0, 50)
SHEET = Sheet(
    3.0, 2.0, 100,
    images=lambda: (IMAGE,),
    words=(Words("a", (0.5, 0.9), 9, quantities=((" in ", 1.5e-3, "s"), (", by ", 2e-6, "m"))),),
    curves=(Curves((0.2, 0.4, 0.7, 0.2), "force", "N", TIME, {"one": TIME**2, "two": np.sin(TIME)}, True, (0.5,)),),
    scale=Scale((0.4, 0.7, 0.4, 0.03), "viridis", (0.0, 2.0), "Pa", "stress"),
)  # fmt: skip


@pytest.fixture
def started(monkeypatch):
    """The processes that are started, as where no library is loaded."""
    processes, start = [], beside.Popen
    monkeypatch.setattr(beside, "LIBRARY", "not.loaded")
    monkeypatch.setattr(beside.os, "cpu_count", lambda: 2)
    monkeypatch.setattr(beside, "Popen", lambda *given, **more: processes.append(start(*given, **more)) or processes[-1])
    return processes


def test_sheets_are_drawn_beside_as_here(started, tmp_path):
    with drawing() as draw:
        draw(SHEET, tmp_path / "one.png")
        draw(Sheet(1.0, 1.0, 50), tmp_path / "two.png")
        assert not list(tmp_path.iterdir())  # it has only been told
    assert (tmp_path / "one.png").read_bytes() == png_of(figure_of(SHEET))
    assert (tmp_path / "two.png").read_bytes() == png_of(figure_of(Sheet(1.0, 1.0, 50)))
    assert len(started) == 1 and started[0].returncode is not None


@pytest.mark.parametrize("when", ["before", "between"])
def test_what_a_process_that_ends_leaves_undone_is_drawn_here(started, tmp_path, when):
    with drawing() as draw:
        if when == "between":
            draw(SHEET, tmp_path / "one.png")
        started[0].kill()
        started[0].wait()
        draw(SHEET, tmp_path / "two.png")
    assert all(file.read_bytes() == png_of(figure_of(SHEET)) for file in tmp_path.iterdir())
    assert len(list(tmp_path.iterdir())) == (2 if when == "between" else 1)


def test_an_interrupt_ends_the_process_and_leaves_no_file(started, monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(KeyboardInterrupt), drawing() as draw:
        draw(SHEET, tmp_path / "one.png")
        assert len(list(tmp_path.iterdir())) == 1  # the folder through which sheets and pictures go
        raise KeyboardInterrupt
    assert started[0].returncode is not None and not list(tmp_path.iterdir())


def test_where_the_library_is_loaded_no_process_is_started(started, monkeypatch, tmp_path):
    monkeypatch.setattr(beside, "LIBRARY", "softffd.show.figure")
    with drawing() as draw:
        draw(SHEET, tmp_path / "one.png")
        assert (tmp_path / "one.png").is_file()
    assert started == []
