"""The live page: what it holds, and that a recording of what a hand did runs natively to the same bits."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from softffd.cli.keep import run_scene_or_fmu
from softffd.errors import SoftffdError
from softffd.installed import wasm_library
from softffd.run.findings import reactions
from softffd.show.live.page import write_live
from softffd.show.live.scene import is_recording

HOST = Path(__file__).parents[2] / "support" / "hosts" / "live_in_node.mjs"


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """Live pages by scene, each written once."""
    try:
        wasm_library()
    except SoftffdError:
        pytest.skip("no WebAssembly library in this installation")
    folder, written = tmp_path_factory.mktemp("pages"), {}

    def page(name: str) -> Path:
        if name not in written:
            written[name] = write_live(name, folder / f"{name}.html")
        return written[name]

    return page


def in_node(page: Path, messages: list[dict], folder: Path) -> list[dict]:
    if shutil.which("node") is None:
        pytest.skip("no node on this machine to run the worker with")
    (folder / "messages.json").write_text(json.dumps(messages))
    done = subprocess.run(["node", HOST, page, folder / "messages.json"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout)


def live_of(page: Path) -> dict:
    return json.loads(re.search(r'id="live">(.*?)</script>', page.read_text("utf-8"))[1])


def parts_by_name(live: dict) -> dict[str, int]:
    return {part["label"]: n for n, part in enumerate(live["open"]["parts"])}


def session(live: dict, part: str, target: list[float], slider: int, corner: int) -> list[dict]:
    """Moves a part, pulls at a control point, changes a parameter at the start and on the way, saves and restores; then the recording."""
    starts = [each["start"] for each in live["open"]["parameters"]]
    stiffer, softer = [*starts], [*starts]
    stiffer[slider] *= 2
    softer[slider] /= 2
    hand = {"part": parts_by_name(live)[part], "target": target}
    most, size = live["pull"]["most"] / 20, live["open"]["most_speed"] / 3
    pull = {"weights": [[corner, 0.75], [corner + 1, 0.25]], "stiffness": 10 * most / size, "damping": 0.0, "most": most}
    pull["target"] = [x + 0.3 * size for x in live["open"]["centre"]]
    long = {"budget": 1e9}
    return [
        {"set": stiffer}, {"run": 0.05, "hand": hand, **long}, {"set": softer}, {"run": 0.1, "hand": hand, **long}, {"save": True},
        {"run": 0.15, "hand": None, **long}, {"set": starts}, {"run": 0.2, "hand": pull, **long}, {"restore": True},
        {"run": 0.15, "hand": pull, **long}, {"run": 0.2, "hand": None, **long}, {"recording": True},
    ]  # fmt: skip


@pytest.mark.short("press")
@pytest.mark.parametrize("name", ["press", "car_ball", "hanging", "pad", "car_drop"])
def test_a_recording_runs_natively_to_the_same_bits(tmp_path, pages, name):
    page = pages(name)
    live = live_of(page)
    parts = live["open"]["parts"]
    part = {"press": "press", "car_ball": "ball"}.get(name, parts[-1]["label"])
    target = np.array(parts[parts_by_name(live)[part]]["point"]) - 0.05 * live["open"]["most_speed"] / 3
    answers = in_node(page, session(live, part, target.tolist(), 0, 21), tmp_path)
    recording = tmp_path / "recording.csv"
    recording.write_text(answers[-1]["recording"])
    last = answers[-2]
    result = run_scene_or_fmu(name, inputs=recording)
    assert is_recording(recording) and result.time[-1] == last["frame"]
    shown = (result.positions[-1].transpose(2, 1, 0, 3).reshape(-1, 3) - live["open"]["centre"]).astype("f4")
    assert (np.array(last["points"], "f4").reshape(-1, 3) == shown).all()
    for row in (row for row in rows_of(page) if row["kind"] == "reaction"):
        force = next(force for found, force in reactions(result).items() if found.name == row["label"])
        assert [last["outputs"][n] for n in row["at"]] == force[-1].tolist()
    assert np.abs(result.inputs["force[1,1,1].x"]).max() > 0


def rows_of(page: Path) -> list[dict]:
    return json.loads(re.search(r'id="run">(.*?)</script>', page.read_text("utf-8"))[1])["rows"]
