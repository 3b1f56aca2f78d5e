"""What a reader of the page asks of it, in headless Chromium: pictures, films, keys, and the marks on the time line."""

import base64
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from browser import showing
from made_up_run import made_up_run
from softffd.show.view import write_view

CATCH = """window.kept = [];
download = async (name, blob) => { const reader = new FileReader();
  reader.onload = () => kept.push([name, blob.type, reader.result.split(',')[1]]);
  reader.readAsDataURL(blob); }"""
WORDS = "[...element('keys').rows].map(row => [row.cells[0].textContent, row.cells[1].textContent])"


@pytest.fixture
def opened(tmp_path):
    """Opens a page of a made-up run, with a script before its own."""

    def open_page(script: str = ""):
        page = write_view(made_up_run(title="Ärger: 60 % <b>"), tmp_path / "view.html")
        page.write_text(page.read_text("utf-8").replace("<title>", f"<script>{script}</script><title>"), "utf-8")
        return showing(page, width=1000, height=600, hash="#t=1.2")

    return open_page


@pytest.mark.full
def test_picture_and_film_are_files_with_the_background_named_after_title_and_time(opened):
    with opened() as browser:
        browser.ask(CATCH)
        browser.ask("element('picture').click()")
        name, kind, data = browser.wait_for("kept[0]")
        assert (name, kind) == ("Ärger_60_b_1.200s.png", "image/png")
        image = np.asarray(Image.open(BytesIO(base64.b64decode(data))))
        assert image.shape[:2] == tuple(browser.ask("[canvas.height, element('readout').offsetLeft]")) and (image[..., 3] == 255).all()
        assert (image[..., 2].astype(int) - image[..., 0] > 60).mean() > 0.05 and (image[5, 5, :3] > 200).all()
        browser.key("v")
        assert browser.ask("[element('film').getAttribute('aria-pressed'), element('film').textContent.trim()]") == ["true", "Stop"]
        first = browser.ask("film.target.toDataURL()")
        browser.key(" ")
        browser.wait_for("state.time > 1.3 || state.time < 1")
        assert browser.ask("film.target.toDataURL()") != first
        browser.ask("element('film').click(), element('film').click()")  # once more while it ends
        name, kind, data = browser.wait_for("kept[1]")
        assert (name, kind) == ("Ärger_60_b_from_1.200s.webm", "video/webm") and b"webm" in base64.b64decode(data)[:64]
        assert browser.ask("[film, element('film').getAttribute('aria-pressed')]") == [None, "false"]


@pytest.mark.full
def test_a_browser_that_makes_no_films_offers_none(opened):
    with opened("delete globalThis.MediaRecorder") as browser:
        browser.key("?")
        assert browser.ask("element('film').hidden") and "V" not in dict(browser.ask(WORDS))


def test_the_keys_told_are_those_that_are_heard(opened):
    with opened() as browser:
        browser.key("?")
        told = dict(browser.ask(WORDS))
        assert told["L"] == "control points and lattice" and told[".→↑"] == "one frame on" and "Space" in told and "HomeEnd" in told
        shown = browser.ask("state.lattice")
        browser.key("l")
        assert browser.ask("[element('help').open, state.lattice]") == [True, shown]  # asleep while it is open
        browser.key("?")
        browser.key("l")
        assert browser.ask("[element('help').open, state.lattice]") == [False, not shown]
        turned = browser.ask("canvas.focus(), camera.yaw")
        browser.key("ArrowLeft")
        assert browser.ask("camera.yaw") != turned and browser.ask("state.time") == pytest.approx(1.2)
        browser.ask("canvas.blur()")
        browser.key("ArrowLeft")
        assert browser.ask("state.time") == pytest.approx(1.15)


def test_the_time_line_has_first_contact_and_the_largest_reactions(opened):
    result = made_up_run()
    with opened() as browser:
        marks = browser.ask("[...element('marks').children].map(mark => [mark.title, mark.className])")
        assert [kind for _, kind in marks] == ["contact", "peak"]  # both obstacles have their largest reaction in one frame
        forces = {name: np.abs(result.outputs[f"plane.{name}.reaction.z"]) for name in ("ground", "press")}
        first = min(int((force > 0).argmax()) for force in forces.values())
        assert marks[0][0].startswith("first contact: ") and marks[0][0].endswith(f", at {result.time[first]:.3f} s")
        assert all(f"{name}: largest reaction, " in marks[1][0] for name in forces)
        browser.ask("go_to(0)")
        times = []
        for _ in range(3):
            browser.key("m")
            times.append(browser.ask("state.time"))
        peak = result.time[forces["press"].argmax()]
        assert times == pytest.approx([result.time[first], peak, result.time[first]])
        browser.ask("element('marks').lastChild.click()")
        assert browser.ask("state.time") == pytest.approx(peak)
