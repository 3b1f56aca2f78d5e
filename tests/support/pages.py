"""Pages of runs and live pages: what they hold, and the worker of a live page without a browser."""

import base64
import gzip
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from made_up_run import at_rest_about
from mesh_files import two_colours
from softffd.lattice import to_flat
from softffd.mesh.files import load_mesh
from softffd.show.view import write_view

HOST = Path(__file__).parent / "hosts" / "live_in_node.mjs"


def whole_run_of(page):
    return json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', page.read_text("utf-8"))[1])


def run_of(page):
    """The run of a page of one body, what the body has beside the rest; of its surface the arrays."""
    run = whole_run_of(page)
    (body,) = run["bodies"]
    cells = [each | {"values": values} for each, values in zip(run["cells"], body.get("cells", []), strict=False)]
    return run | body | opened(body["surface"]) | {"cells": cells}


def opened(surface):
    """The arrays of a surface that is packed."""
    data, columns = gzip.decompress(base64.b64decode(surface["block"])), []
    for count, planes in surface["columns"]:
        number = sum(np.frombuffer(data[k * count : (k + 1) * count], "u1").astype(int) << 8 * k for k in range(planes))
        columns.append((number >> 1) ^ -(number & 1))
        data = data[planes * count :]
    assert not data
    *of_vertices, second, third = columns
    *of_vertices, first = [np.cumsum(each) for each in of_vertices]
    triangles = np.stack([first, first + second, first + third], axis=1)
    place, coordinates, uv = (
        np.stack(of_vertices[3:5], axis=1) / 2047,
        *(
            np.stack([low + step * of_vertices[begin + a] for a, (low, step) in enumerate(surface[scales])], axis=1)
            for begin, scales in ((0, "scales"), (8, "uv_scales"))
        ),
    )
    up = 1 - np.abs(place).sum(axis=1, keepdims=True)
    normals = np.hstack([np.where(up < 0, (1 - np.abs(place[:, ::-1])) * np.where(place < 0, -1, 1), place), up])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    tints = np.stack(of_vertices[5:8], axis=1)
    return {"coordinates": coordinates, "normals": normals, "uv": uv, "tints": tints, "triangles": triangles, "parts": surface["parts"]}


def decoded(text, kind, width):
    """An array of the page."""
    return np.frombuffer(base64.b64decode(text), kind).reshape(-1, width).astype(float)


def page_of_two_colours(folder, name):
    mesh = load_mesh(two_colours(folder, name))
    page = write_view(at_rest_about(mesh), folder / "view.html")
    return run_of(page), page


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


def assert_shown(result, points: list[float], centre: list[float]) -> None:
    """A live page showed the control points as they are at the end of a run, to the last bit."""
    native = (to_flat(result.positions[-1]) - centre).astype("f4")
    assert (np.array(points, "f4").reshape(-1, 3) == native).all()
