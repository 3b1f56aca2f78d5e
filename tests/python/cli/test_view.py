"""`softffd view`: the page of a run that was kept."""

import os
from pathlib import Path

import pytest

from scenes import box
from softffd import simulate
from softffd.cli.command import main


@pytest.fixture
def opened(tmp_path, monkeypatch) -> list[str]:
    monkeypatch.chdir(tmp_path)
    pages: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda page: pages.append(page) or True)
    simulate(box(points=[2, 2, 2], title="Two", stop_time=0.02)).save("kept")
    return pages


def test_a_page_is_made_where_there_is_none_and_kept_where_there_is(opened, capsys):
    page = Path("kept/view.html")
    assert main(["view", "kept"]) == 0 and "<title>Two</title>" in page.read_text()
    assert capsys.readouterr().out == f"{page}\n" and opened == [page.resolve().as_uri()]
    page.write_text("mine")
    assert main(["view", "kept"]) == 0 and page.read_text() == "mine" and len(opened) == 2
    os.utime(page, (0, 0))  # older than the result
    assert main(["view", "kept"]) == 0 and "<title>Two</title>" in page.read_text()


def test_one_file_of_a_result_has_its_page_beside_it(opened):
    assert main(["view", "kept/result.npz"]) == 0
    assert opened == [Path("kept/result.html").resolve().as_uri()]


@pytest.mark.parametrize("what", ["nowhere", ".", "nowhere.npz"])
def test_what_holds_no_result_is_refused(opened, capsys, what):
    assert main(["view", what]) == 1
    assert f"softffd: {what}: wanted a folder that softffd run wrote" in capsys.readouterr().err and not opened
