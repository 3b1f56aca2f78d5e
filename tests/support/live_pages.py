"""Live pages: what they hold, and their worker without a browser."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

HOST = Path(__file__).parent / "hosts" / "live_in_node.mjs"


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
