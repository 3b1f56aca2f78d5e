"""Several runs in one page, in headless Chromium: side by side, or together as components of a coupled run; and a page without WebGL."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from browser import showing
from made_up_run import made_up_run
from softffd.show.view import write_view, write_views

LABELS = "[...element('names').children].filter(each => !each.hidden).map(each => each.textContent)"


def short(result, rows):
    """Its first rows alone."""
    cut = {
        name: {key: value[:rows] if np.ndim(value) else value for key, value in getattr(result, name).items()}
        for name in ("outputs", "inputs")
    }
    return replace(result, time=result.time[:rows], positions=result.positions[:rows], **cut)


def blue(picture, columns):
    red, _, blue = np.moveaxis(np.asarray(Image.open(picture).convert("RGB"))[90:480, columns] / 255.0, 2, 0)
    return (blue - red > 0.2).mean()


def test_two_runs_have_one_clock_one_camera_and_a_picture_each(tmp_path):
    runs = {"whole": made_up_run(), "short": short(made_up_run(), 21)}
    page = write_views(runs, tmp_path / "both.html")
    with showing(page, width=1200, height=600, hash="#t=1.4&colour=paint") as opened:
        opened.shot(tmp_path / "both.png")
        assert all(blue(tmp_path / "both.png", columns) > 0.03 for columns in (slice(0, 460), slice(480, 930)))
        assert opened.ask("bodies.map(body => [body.name, body.pane, frame_shown(body)])") == [["whole", 0, 28], ["short", 1, 20]]
        assert opened.ask("[times[LAST], LAST]") == [2, 40]
        assert {"whole", "short"} <= set(opened.ask(LABELS))
        assert opened.ask("run.rows.map(row => row.parts.value.parentNode.textContent)")[0].startswith("whole: ground")
        before = opened.ask("PANES.map(pane => camera_frame(pane).eye)")
        opened.drag((700, 300), (760, 300))
        after = opened.ask("PANES.map(pane => camera_frame(pane).eye)")
        assert after[0] == after[1] != before[0]


@pytest.mark.full
def test_components_are_in_one_picture_where_they_are_in_the_world(tmp_path):
    other = made_up_run()
    other = replace(other, positions=other.positions + np.array([0, 0, 3.0]), inputs={}, parameters={}, outputs={})
    page = write_views({"lower": made_up_run(), "upper": other}, tmp_path / "both.html", together=True)
    with showing(page, width=900, height=600, hash="#t=1.2") as opened:
        assert opened.ask("PANES.length") == 1
        lower, upper = opened.ask("bodies.map(body => [0, 1, 2].map(a => body.texels[a]))")
        assert np.allclose(np.subtract(upper, lower), [0, 0, 3], atol=1e-5)
        opened.ask("camera.yaw = -1, camera.pitch = 0.3, show()")
        assert "lower: press, from its solid side" in opened.wait_for(f"{LABELS}.length && {LABELS}")


@pytest.mark.full
def test_an_obstacle_is_hatched_and_named_from_its_solid_side(tmp_path):
    page = write_view(made_up_run(), tmp_path / "view.html")
    with showing(page, hash="#t=0") as opened:
        dark = []
        for pitch, name in ((0.4, "press"), (-0.4, "ground")):
            opened.ask(f"camera.pitch = {pitch}, set_playing(false)")
            opened.wait_for(f"String({LABELS}) === '{name}, from its solid side'")
            opened.shot(tmp_path / f"{name}.png")
            dark.append(np.asarray(Image.open(tmp_path / f"{name}.png").convert("L"))[440:520, 30:600])
        assert np.abs(np.diff(dark[1].astype(int), axis=1)).mean() > 0.5  # lines across the ground
        opened.ask("toggle('obstacles')")
        opened.wait_for(f"!{LABELS}.length")


@pytest.mark.full
def test_without_webgl_there_is_the_still_picture_of_each_run(as_shipped, tmp_path):
    page = write_views({"a": made_up_run(), "b": made_up_run()}, tmp_path / "both.html")
    still = "document.body?.classList.contains('still')"
    with showing(page, "--disable-3d-apis", ready=still, width=700, height=900) as opened:
        shown = opened.ask("[...document.images].map(each => [each.clientWidth, each.naturalWidth])")
        assert len(shown) == 2 and all(0 < width <= 700 and natural > 1000 for width, natural in shown)
        assert "so that it shows a still picture" in opened.ask("element('message').textContent")
