"""The component in WebAssembly, as web pages run it, in node: every bit of the outputs, and what it says of errors."""

import base64
import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from c_host import WARNING, Fmu, doubles, uints
from softffd import SoftffdError, installed, load_scene
from softffd.run.inputs import Inputs

ROOT = Path(__file__).resolve().parents[2]
ALL = {"positions": "all", "velocities": "all", "reactions": True, "energy": True, "solver": True}
EVERYTHING = {f"outputs.{key}": value for key, value in ALL.items()}
CASES = {
    **{name: {} for name in ("pad", "press", "car_drop", "hanging", "car_bump")},
    "pad by damped kicks": {"solver.method": "leapfrog", "experiment.stop_time": 0.2},  # exp and cos
    "standard with threads": {"solver.threads": 3},  # there are none in WebAssembly
}
"""Shipped scenes and what is changed in them"""

pytestmark = [pytest.mark.full, pytest.mark.bundle("wasm")]


@pytest.fixture
def in_node(tmp_path):
    """in_node(script, **run): what a script of tests/support/hosts prints of a run in WebAssembly."""
    try:
        library = installed.wasm_library()
    except SoftffdError as missing:
        pytest.skip(str(missing))
    if not (node := shutil.which("node")):
        pytest.skip("there is no node on this machine")

    def printed(script: str, **run):
        component, file = ROOT / "python" / "softffd" / "show" / "live_component.js", tmp_path / "run.json"
        file.write_text(json.dumps({"library": str(library), "component": str(component)} | run))
        done = subprocess.run([node, ROOT / "tests" / "support" / "hosts" / script, file], capture_output=True, text=True, timeout=900)
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
        return json.loads(done.stdout)

    return printed


def scene_text(fmu: Fmu) -> Path:
    return Path(fmu.path).parents[2] / "resources" / "scene.txt"


@pytest.mark.parametrize("name", CASES)
def test_every_output_has_the_bits_of_the_native_library(in_node, tmp_path, name):
    scene = load_scene(name.split()[0]).replace(EVERYTHING | CASES[name])
    fmu = Fmu(scene, tmp_path / "native")
    stop, step, course = scene.experiment.stop_time, scene.experiment.communication_step, Inputs(scene.default_inputs)
    course.derive_only(fmu.names)
    names, times = course.names + course.derived_names, step * np.arange(round(stop / step) + 1)
    rows = course.rows(times)

    host, expected = fmu.host(), []
    host.must("SetupExperiment", 0, 0.0, times[0], 1, times[-1])
    for n, row in enumerate(rows):
        host.set(dict(zip(names, row, strict=True)))
        if n == 0:
            host.must("EnterInitializationMode")
            host.must("ExitInitializationMode")
            expected.append(host.outputs())
        host.must("DoStep", times[n], times[n + 1] - times[n], 1)
        expected.append(host.outputs())

    run = {"scene": scene_text(fmu).read_text(), "guid": fmu.guid.decode(), "times": times.tolist(), "rows": rows.tolist()}
    references = {"inputs": [fmu.names[name] for name in names], "reals": fmu.reals, "integers": fmu.integers}
    found = in_node("wasm_run.mjs", **run, **references)
    assert len(fmu.reals) > 390 and len(fmu.integers) > 3 and not found["said"]
    for n, (one, other) in enumerate(zip(map(base64.b64decode, found["rows"]), expected, strict=True)):
        assert one == other, (n, [k for k, a, b in zip(fmu.reals, *map(doubles_in, (one, other)), strict=False) if a != b][:10])


def doubles_in(data: bytes) -> list[int]:
    """The bits of the doubles that a row begins with."""
    return np.frombuffer(data[: len(data) // 8 * 8], np.uint64).tolist()


def nothing(_host) -> None:
    """Not even set up."""


def spoilt(host) -> None:
    host.begin()
    host.set({INPUT: float("nan")})
    host.messages.clear()


def spoilt_and_reset(host) -> None:
    spoilt(host)
    host.must("Reset")
    host.begin()


INPUT = "plane.press.point.z"
STEP = ("DoStep", 0.0, 0.01, 1)
REFUSALS = {
    "a step too early": (nothing, lambda host: host(*STEP)),
    "an unknown variable": (lambda host: host.begin(), lambda host: host("GetReal", uints([12345]), 1, doubles([0.0]))),
    "not a number": (lambda host: host.begin(), lambda host: host.set({INPUT: float("nan")})),
    "a step backwards": (lambda host: host.begin(), lambda host: host("DoStep", 0.0, -0.01, 1)),
    "a failed instance": (spoilt, lambda host: host(*STEP)),
    "a failed instance after a reset": (spoilt_and_reset, lambda host: host(*STEP)),
}
"""What happens before, and the call"""


def test_it_refuses_what_the_native_library_refuses_in_the_same_words(in_node, tmp_path):
    fmu = Fmu(load_scene("press"), tmp_path / "native")
    text = scene_text(fmu).read_text()
    damaged = text.replace("counts 4 4 4", "counts 4 4 5")
    assert damaged != text
    expected = {}
    for name, (before, call) in REFUSALS.items():
        host = fmu.host()
        before(host)
        status = call(host)
        expected[name] = [status if status > WARNING else None, words_of(host)]
    expected["another guid"] = ["refused", words_of(fmu.host(guid=b"{another}"))]
    scene_text(fmu).write_text(damaged)
    expected["a damaged scene"] = ["refused", words_of(fmu.host())]

    found = in_node("wasm_refusals.mjs", scene=text, guid=fmu.guid.decode(), damaged=damaged, input=fmu.names[INPUT])
    said = json.dumps(found["said"]).replace("softffd_open", "fmi2Instantiate")
    assert json.loads(said) == expected
    assert found["restores"]


def words_of(host) -> list:
    return [[status, message.decode().replace("%%", "%").replace("##", "#")] for *_, status, _category, message in host.messages]
