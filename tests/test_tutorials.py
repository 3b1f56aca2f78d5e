"""Every tutorial from its first line to its last, in one empty folder, as a new user would: what it says comes out comes out.

A block `text` after a command or a script is what that prints; `...` stands for what differs from machine to machine or is left out. A
script `python picture` runs where OpenGL draws.
"""

import contextlib
import doctest
import io
import json
import re
import shlex
from pathlib import Path

import pytest

from softffd.cli.command import main

ROOT = Path(__file__).resolve().parents[1]
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
NOTEBOOKS = sorted((ROOT / "examples").glob("*.ipynb"))
NEEDS = {"robot": "mujoco"}
"""Tutorials that need the package of an extra"""
LONG = ("fit", "robot")
FOLLOWED = [pytest.param(file, id=file.stem, marks=[pytest.mark.full] * (file.stem in LONG)) for file in TUTORIALS]
BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def follow(document: Path, folder: Path) -> list[tuple[str, str]]:
    """Types in the blocks of a tutorial one after the other, in `folder`; what it says and what came out where it says something."""
    session: dict[str, object] = {"__name__": "__main__"}
    pairs, before = [], ""
    printed: str | None = ""
    text = document.read_text()
    for block in BLOCK.finditer(text):
        kind, _, more = block[1].partition(" ")
        if kind == "text" and printed is not None:
            pairs.append((block[2], printed))
        elif kind == "toml":
            (folder / (more or re.findall(r"`([\w-]+\.toml)`", before + text[: block.start()])[-1])).write_text(block[2])
        elif kind == "python":
            printed = output_of(exec, block[2], session) if more != "picture" or draws() else None
        elif kind != "text":
            printed = "".join(said(line, 1 if more == "refused" else 0) for line in block[2].replace("\\\n", " ").splitlines())
        before = block[2]
    return pairs


def said(line: str, status: int) -> str:
    """What a command prints; it must end with this status."""
    program, *words = shlex.split(line)
    assert program == "softffd"
    ended = []
    printed = output_of(lambda: ended.append(main(words)))
    assert ended == [status], line
    return printed


def output_of(call, *arguments) -> str:
    stream = io.StringIO()
    with contextlib.redirect_stdout(stream), contextlib.redirect_stderr(stream):
        call(*arguments)
    return stream.getvalue()


def draws() -> bool:
    """Does OpenGL draw for MuJoCo here? By MUJOCO_GL=egl it may do so without a screen."""
    import mujoco

    try:
        mujoco.Renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 8, 8).close()
    except Exception:  # of many kinds, by platform and library
        return False
    return True


@pytest.mark.parametrize("document", FOLLOWED)
def test_a_tutorial_does_what_it_says(document, tmp_path, monkeypatch):
    if package := NEEDS.get(document.stem):
        pytest.importorskip(package, reason=f"{package} is not installed: pip install 'softffd[{package}]'")
    monkeypatch.chdir(tmp_path)
    checker, pairs = doctest.OutputChecker(), follow(document, tmp_path)
    assert len(pairs) >= 5
    for wanted, printed in pairs:
        assert checker.check_output(wanted, printed, doctest.ELLIPSIS), f"{document.name} says\n{wanted}\nbut what comes out is\n{printed}"


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda notebook: notebook.stem)
def test_a_notebook_runs(notebook, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cells = [cell for cell in json.loads(notebook.read_text())["cells"] if cell["cell_type"] == "code"]
    assert cells and all(not cell["outputs"] for cell in cells)  # they are made, not kept
    exec("".join("".join([*cell["source"], "\n"]) for cell in cells), {})


def test_there_are_a_tutorial_each_for_coupling_fits_meshes_a_robot_scripting_and_sensors_and_a_notebook():
    assert [file.stem for file in TUTORIALS] == ["coupling", "fit", "mesh", "robot", "scripting", "sensors"] and NOTEBOOKS
