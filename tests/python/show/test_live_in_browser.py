"""A hand on the live page, in headless Chromium: mouse, keys and fingers; and what it recorded, run natively."""

from pathlib import Path

import numpy as np
import pytest

from browser import LIVE, Browser, showing
from pages import assert_shown
from softffd import load_scene, simulate
from softffd.cli.keep import run_scene_or_fmu
from softffd.show.live.scene import live_scene
from softffd.show.tension import COLOURS

pytestmark = pytest.mark.full

ON_SCREEN = """(at => { const m = camera_matrix(camera_frame());
  const [x, y, , w] = [0, 1, 2, 3].map(r => m[r] * at[0] + m[4 + r] * at[1] + m[8 + r] * at[2] + m[12 + r]);
  return [canvas.offsetLeft + (x / w + 1) / 2 * canvas.clientWidth, canvas.offsetTop + (1 - y / w) / 2 * canvas.clientHeight]; })"""
PRESS = "bodies[0].planes.find(plane => plane.name === 'press').now"
EDGE = f"plus({PRESS}.centre, 0.95 * {PRESS}.extent[0] * {PRESS}.reach, {PRESS}.tangent)"
HEIGHT = "now.parts[live.open.parts.findIndex(part => part.label === 'press')][2]"


def on_screen(browser: Browser, place: str) -> list[float]:
    return browser.ask(f"{ON_SCREEN}({place})")


def kept_recording(browser: Browser, folder: Path) -> Path:
    """What the page recorded, as a file."""
    browser.ask("keep_recording = text => { window.kept = text; }, element('record').click()")
    (folder / "recording.csv").write_text(browser.wait_for("window.kept"))
    return folder / "recording.csv"


def paused(browser: Browser) -> None:
    browser.ask("set_playing(false)")
    browser.wait_for("asked === null")


def test_mouse_keys_and_sliders_do_what_a_recording_repeats(tmp_path, live_page):
    with showing(live_page("press"), ready=LIVE) as browser:
        edge, lower = on_screen(browser, EDGE), on_screen(browser, f"plus({EDGE}, 0.3, {PRESS}.normal)")
        browser.drag(edge, lower)
        assert browser.ask("hand.part") is not None
        browser.wait_for(f"{HEIGHT} < 0.85")
        browser.mouse("mouseReleased", *lower)
        assert browser.wait_for("Math.hypot(...run.rows[1].at.map(n => now.outputs[n])) > 100")  # the press is pressed on
        height = browser.wait_for(f"hand === null && {HEIGHT}")
        browser.ask("element('save').click()")
        browser.wait_for("!element('restore').disabled")
        saved = browser.ask("now.frame")
        before = browser.ask("camera.yaw")
        browser.drag((30, 510), (90, 510))  # beside everything: turns
        browser.mouse("mouseReleased", 90, 510)
        assert browser.ask("camera.yaw") < before
        middle = on_screen(browser, "middle_of_object()")
        browser.drag(middle, [middle[0] + 60, middle[1]])
        assert browser.wait_for("now.pull && Math.hypot(...now.pull) > 1")
        browser.mouse("mouseReleased", *middle)
        browser.ask("Object.assign(document.querySelector('#sliders input'), { value: 0.25 }).dispatchEvent(new Event('input'))")
        assert browser.ask("document.querySelector('#sliders output').textContent") == "316.0 N/m"
        browser.wait_for(f"now.frame > {saved} + 0.2")
        browser.ask("element('restore').click()")
        browser.wait_for(f"now.frame < {saved} + 0.2")
        assert browser.ask("document.querySelector('#sliders output').textContent") == "1.000 kN/m"
        browser.ask("element('panel').open = true")
        browser.ask("[...element('grips').children].find(each => each.textContent === 'press').focus()")
        for _ in range(4):
            browser.key("ArrowUp")
        browser.wait_for(f"{HEIGHT} > {height} + 0.05")
        browser.key("Escape")
        paused(browser)
        time = browser.ask("now.frame")
        browser.key(".")
        browser.wait_for(f"now.frame > {time}")
        shown = browser.ask(
            "({ frame: now.frame, points: [...now.points], outputs: [...now.outputs], rows: run.rows.map(row => row.at), centre })"
        )
        recording = kept_recording(browser, tmp_path)
        browser.key("?")
        told = {row[0]: row[1] for row in browser.ask("[...element('keys').rows].map(row => [...row.cells].map(cell => cell.textContent))")}
        assert told["W"] == "save what was done, for softffd run" and told[".→↑"] == "one communication step"
        browser.key("?")
        browser.ask("download = (name, blob) => { window.picture = [name, blob.size]; }, save_picture()")
        name, size = browser.wait_for("window.picture")
        assert name.endswith("s.png") and size > 10_000
    result = run_scene_or_fmu("press", inputs=recording)
    assert result.time[-1] == shown["frame"]
    assert_shown(result, shown["points"], shown["centre"])
    for name, places in zip(("table", "press"), shown["rows"], strict=False):
        assert [shown["outputs"][n] for n in places] == [result.outputs[f"plane.{name}.reaction.{c}"][-1] for c in "xyz"]


def test_one_finger_drags_or_turns_and_two_pinch(tmp_path, live_page):
    with showing(live_page("press"), ready=LIVE, width=390, height=844, mobile=True) as browser:
        assert not browser.ask("element('panel').open")
        edge = on_screen(browser, EDGE)
        lower = [edge[0], edge[1] + 60]
        browser.touch("touchStart", edge)
        browser.touch("touchMove", lower)
        browser.wait_for(f"hand && {HEIGHT} < 1.0")
        distance = browser.ask("camera.distance")
        browser.touch("touchStart", lower, [lower[0] - 80, lower[1]])
        browser.wait_for("hand === null")
        browser.touch("touchMove", [lower[0] + 40, lower[1]], [lower[0] - 120, lower[1]])
        browser.touch("touchEnd")
        assert browser.wait_for(f"camera.distance < {distance}")
        yaw = browser.ask("camera.yaw")
        browser.touch("touchStart", [30, 640])
        browser.touch("touchMove", [90, 640])
        browser.touch("touchEnd")
        assert browser.ask("camera.yaw") < yaw and browser.ask("hand") is None


def test_the_car_is_crushed_by_a_finger_and_its_force_is_read_and_repeated(tmp_path, live_page):
    with showing(live_page("car_drop"), ready=LIVE, width=390, height=844, mobile=True) as browser:
        bumper = "run.bodies[0].planes.find(plane => plane.name === 'bumper').now"
        rim = f"plus({bumper}.centre, 0.7 * {bumper}.extent[0] * {bumper}.reach, {bumper}.tangent)"
        edge = on_screen(browser, f"plus({rim}, 0.05, {bumper}.normal)")
        browser.touch("touchStart", edge)
        held = browser.wait_for("hand && live.open.parts[hand.part].label")
        assert held == "bumper"
        browser.touch("touchMove", [edge[0] + 90, edge[1]])
        read = "run.rows.find(row => row.label === 'bumper').parts.value.textContent"
        assert browser.wait_for(f"{read}.endsWith('kN') && parseFloat({read}) > 20 && {read}", 120).endswith("kN")
        browser.touch("touchEnd")
        paused(browser)
        rows = "rows: run.rows.map(row => row.at), labels: run.rows.map(row => row.label)"
        shown = browser.ask(f"({{ frame: now.frame, points: [...now.points], outputs: [...now.outputs], centre, {rows} }})")
        recording = kept_recording(browser, tmp_path)
    result = run_scene_or_fmu("car_drop", inputs=recording)
    assert result.time[-1] == shown["frame"]
    assert_shown(result, shown["points"], shown["centre"])
    at = shown["rows"][shown["labels"].index("bumper")]
    assert [shown["outputs"][n] for n in at] == [result.outputs[f"plane.bumper.reaction.{axis}"][-1] for axis in "xyz"]


def test_loads_are_pulled_and_obstacles_turned_by_pointer_and_keys(tmp_path, live_page):
    scene = load_scene("press").replace({"load": [{"name": "push", "points": "x+"}]})
    with showing(live_page(scene), ready=LIVE, width=1000, height=700) as browser:
        browser.ask("set_playing(false)")
        browser.wait_for("asked === null && shown !== null")
        start = on_screen(browser, "place_of_load(0)")
        tip = [start[0] + 80, start[1] - 40]
        browser.drag(start, tip)
        browser.mouse("mouseReleased", *tip)
        force = np.array(browser.ask("loads[0]"))
        assert 1 < np.linalg.norm(force) <= browser.ask("live.pull.most") and browser.ask("hand") is None
        assert np.allclose(on_screen(browser, "plus(place_of_load(0), 1, arrow_of_load(0))"), tip, atol=2)
        assert [float(each) for each in browser.ask("load_sliders[0].map(each => each.now)")] == force.tolist()
        browser.ask("set_playing(true)")
        browser.wait_for("now.frame > 0.1")
        browser.ask("element('panel').open = true, [...element('grips').children].find(each => each.textContent === 'push').focus()")
        browser.key("ArrowUp")
        assert browser.ask("loads[0][2]") > force[2]
        browser.ask(
            "[...document.querySelectorAll('#sliders label')].find(each => each.textContent.startsWith('push y')).lastChild.focus()"
        )
        browser.key("ArrowRight")
        assert browser.ask("loads[0][1]") != force[1]
        edge = on_screen(browser, EDGE)
        browser("Input.dispatchKeyEvent", type="keyDown", key="Control", modifiers=2)
        browser.mouse("mousePressed", *edge, modifiers=2)
        browser.mouse("mouseMoved", edge[0], edge[1] + 30, modifiers=2)
        turn = browser.wait_for("hand?.turn")
        assert turn[0] == pytest.approx(np.cos(0.12)) and browser.wait_for("now.turns[1][0] < 0.995")
        browser.mouse("mouseReleased", *edge)
        browser.ask("element('turning').click(), [...element('grips').children].find(each => each.textContent === 'press').focus()")
        before = browser.ask("now.turns[1]")
        browser.key("ArrowLeft", shift=True)
        assert browser.wait_for(f"now.turns[1].some((x, n) => Math.abs(x - {before}[n]) > 0.05)")
        assert browser.ask(f"{PRESS}.normal[2]") > -1
        browser.key("Escape")
        paused(browser)
        shown = browser.ask("({ frame: now.frame, points: [...now.points], centre })")
        recording = kept_recording(browser, tmp_path)
    result = simulate(live_scene(scene), inputs=recording, stop_time=shown["frame"], open_end=True)
    assert_shown(result, shown["points"], shown["centre"])


@pytest.mark.parametrize("name", ["press", "car_drop", "beam", "stiff_layer"])
def test_colours_of_cells_are_those_of_a_run(tmp_path, live_page, name):
    """Stress and stretch of a pulled body, to a step of the 255 of the scale."""
    with showing(live_page(name), ready=LIVE, width=300, height=300) as browser:
        browser.ask("set_playing(false)")
        browser.wait_for("asked === null && element('frame').textContent === 'paused'")
        browser.ask("hand = pull(weights_at([0.9, 0.9, 0.9]), [run.radius, 0, 0]), ask({ run: now.frame + 20 * h, budget: 1e9, hand })")
        browser.wait_for("asked === null && now.pull")
        shares = [browser.ask(f"[...source.cells({n})]") for n in range(2)]
        cells = browser.ask("run.cells")
        recording = kept_recording(browser, tmp_path)
    result = run_scene_or_fmu(name, inputs=recording)
    for each, found in zip(cells, shares, strict=True):
        low, high = each["ends"]
        values = COLOURS[each["name"]][2](result, -1).transpose(2, 1, 0).ravel()
        assert np.abs(np.array(found[::2]) - 255 * ((values - low) / (high - low)).clip(0, 1)).max() < 1.5
        assert values.max() > low + 0.01 * (high - low) and not any(found[1::2])
