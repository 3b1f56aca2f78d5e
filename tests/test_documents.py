"""Every command and script of the README, the documents and the examples runs, in a copy of a folder as its reader has it by then.

A block marked `sh full` takes minutes and runs with --full; a block marked `text` is not run: it is what another platform or a compiler
that is not everywhere would need. What takes no minutes runs in this process: tests/python/cli starts the command in one of its own.
"""

import contextlib
import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from mesh_files import ball
from softffd import save_mesh
from softffd.cli.command import exit_status, main
from validation.tools import TOOLS, run_tool

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "fmu_src").rglob("README.md"))]
TUTORIALS = sorted((ROOT / "docs" / "tutorials").glob("*.md"))
"""Run from start to end in test_tutorials.py"""
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
SUITE = "python3 python/run.py test"
"""This suite, which does not run itself."""
RESTS = "presses with"
"""Scripts that say so lay a plate of 5 kg on the box."""
MADE_BEFORE = ("build", "ssp", "drivers")
"""Commands whose files of the same name are in the reader's folder already."""
SAMPLED = ("free_vibration", "press")
"""Scenes that the command of the FMI Cross-Check takes here; tests/python/validation makes and compares the files of each."""
MINUTES = ("python3 python/run.py demo",)
"""Commands of blocks for everybody that take a minute or more; the demonstration runs in tests/python/cli with a shorter course too."""


def blocks(document: Path) -> list[tuple[str, str]]:
    """Kind and text of the document's blocks of code."""
    return re.findall(r"^```([\w ]*)\n(.*?)^```$", document.read_text(), re.MULTILINE | re.DOTALL)


def lines(text: str) -> list[str]:
    """The commands of a block, without their comments."""
    return [command for line in text.replace("\\\n", " ").splitlines() if (command := line.split("#")[0].strip())]


def commands() -> list:
    """Every line of every block `sh`, by the first document that has it. The short run takes those of the README, and the first of every
    other command."""
    found, seen, verbs = [], set(), set()
    for document in DOCUMENTS:
        for kind, text in blocks(document):
            for line in lines(text) if kind.split()[:1] == ["sh"] else []:
                if not line.startswith(SUITE) and line not in seen:
                    seen.add(line)
                    verb = " ".join(line.split()[: 3 if line.startswith("python3") else 2])
                    long = kind == "sh full" or line.startswith(MINUTES) or (verb in verbs and document != DOCUMENTS[0])
                    verbs.add(verb)
                    marks = [pytest.mark.full] if long else []
                    found.append(pytest.param(line, marks=marks, id=f"{document.name}: {line}"))
    return found


def scripts() -> list:
    """Every block `python` of the documents, and the examples. The short run takes the README's, and the first of other documents."""
    found = []
    for document in DOCUMENTS:
        texts = [text for kind, text in blocks(document) if kind == "python"]
        for n, text in enumerate(texts):
            marks = [pytest.mark.full] if n > 0 and document != DOCUMENTS[0] else []
            found.append(pytest.param(text, marks=marks, id=f"{document.name}: script {n + 1}"))
    return found + [pytest.param(file.read_text(), id=file.name) for file in EXAMPLES]


@pytest.fixture(scope="module")
def reader(tmp_path_factory) -> Path:
    """Where a reader would work: the examples, the README's scene under the name that it gives, its FMU, the drivers, their coupling, and a
    mesh, and runs that were kept."""
    folder = tmp_path_factory.mktemp("reader")
    shutil.copytree(ROOT / "examples", folder / "examples")
    for ending in ("toml", "csv"):
        (folder / f"box.{ending}").write_text(next(text for kind, text in blocks(DOCUMENTS[0]) if kind == ending))
    save_mesh(ball(), folder / "cow.obj")
    coupling = next(text for kind, text in blocks(DOCUMENTS[0]) if kind == "sh" and "softffd ssp" in text)
    with contextlib.chdir(folder):
        kept = "softffd run press --stop-time 0.1 --no-pictures -o softffd-press"
        for line in ["softffd build box.toml", "softffd run box.toml --stop-time 0.1 --no-pictures", kept, *lines(coupling)]:
            assert main(shlex.split(line)[1:]) == 0, line
    return folder


@pytest.fixture
def folder(reader, tmp_path, monkeypatch) -> Path:
    """The reader's folder, anew for every command, which runs in it."""
    shutil.copytree(reader, tmp_path / "here")
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def printed_by(call, *arguments) -> str:
    """What a call prints; it must not end with a status other than 0."""
    stream = io.StringIO()
    with contextlib.redirect_stdout(stream), contextlib.redirect_stderr(stream):
        status = call(*arguments)
    assert not status, stream.getvalue()
    return stream.getvalue()


def run_apart(command: list, folder: Path) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(command, cwd=folder, env=os.environ | {"PATH": path}, capture_output=True, text=True, timeout=3600)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_documents_have_their_examples():
    assert SUITE in DOCUMENTS[0].read_text()
    assert len(commands()) >= 12 and len(scripts()) >= 6 and EXAMPLES
    assert sum(RESTS in text for script in scripts() for text in script.values) == 4  # by an SSP, a loop, blocks in a loop, a bridge


@pytest.mark.parametrize("line", commands())
def test_command_runs(line, folder, monkeypatch):
    monkeypatch.setattr("validation.cross_check.shipped_scenes", lambda: SAMPLED)
    program, *words = shlex.split(line)
    if program == "softffd":
        again = ["--overwrite"] if words[0] in MADE_BEFORE else []
        printed_by(main, [*words, *again])
        return
    assert (program, words.pop(0)) == ("python3", "python/run.py")
    if words[0] == "bench":
        run_apart([sys.executable, ROOT / "benchmarks" / "bench.py", "--quick", *words[1:]], folder)
    elif words[0] in ("release", "wasm", "docs"):
        run_apart([sys.executable, ROOT / "python" / "run.py", words[0]], folder)
    elif words[0] in TOOLS:  # run.py hands over to the same program once it has set up
        printed_by(exit_status, lambda: run_tool(words))
    else:
        printed_by(main, words)


@pytest.mark.parametrize("code", scripts())
def test_script_runs(code, folder):
    printed = printed_by(exec, compile(code, "script", "exec"), {"__name__": "__main__"})
    assert printed
    if RESTS in code:
        assert float(re.search(rf"{RESTS} (\S+) N", printed)[1]) == pytest.approx(5 * 9.81, rel=1e-2)


@pytest.mark.parametrize("document", DOCUMENTS + TUTORIALS, ids=lambda document: document.name)
def test_every_place_that_a_document_names_exists(document):
    text = document.read_text()
    for name in re.findall(r"`((?:python|fmu_src|tests|modelDescription|docs|examples|benchmarks)/[\w/.]+)`", text):
        assert (ROOT / name).exists(), name
    for name in re.findall(r"\]\((?!https?:)([^)#]+)\)", text):
        assert (document.parent / name).exists(), name


def test_no_document_is_left_out():
    readme = DOCUMENTS[0].read_text()
    documents = [file.relative_to(ROOT).as_posix() for file in (ROOT / "docs").rglob("*.md")]
    assert [name for name in documents if name not in readme] == []
    in_site = (ROOT / "docs" / "site" / "mkdocs.yml").read_text()
    assert [name for name in documents if name not in in_site] == []


def checked_as() -> dict[str, str]:
    """The Python of documents, tutorials, examples and notebooks by module names; a tutorial and a notebook are a session each."""
    found = {}
    for document in DOCUMENTS + TUTORIALS:
        codes = [text for kind, text in blocks(document) if kind == "python"]
        texts = ["\n".join(codes)] if document in TUTORIALS else codes
        stem = "_".join(document.relative_to(ROOT).with_suffix("").parts)
        found |= {f"{stem}_{n + 1}": text for n, text in enumerate(texts)}
    for notebook in sorted((ROOT / "examples").glob("*.ipynb")):
        cells = [cell for cell in json.loads(notebook.read_text())["cells"] if cell["cell_type"] == "code"]
        found[notebook.stem] = "".join("".join([*cell["source"], "\n"]) for cell in cells)
    return found | {f"examples_{file.stem}": file.read_text() for file in EXAMPLES}


@pytest.mark.lint
def test_a_type_checker_finds_nothing_in_what_the_documents_show(tmp_path):
    texts = checked_as()
    for name, text in texts.items():
        (tmp_path / f"{name}.py").write_text(text)
    assert len(texts) >= 20
    options = ["--config-file", ROOT / "pyproject.toml", "--follow-imports=silent", "--allow-untyped-defs", "--allow-incomplete-defs"]
    options += ["--cache-dir", ROOT / ".mypy_cache" / "documents"]
    done = subprocess.run([sys.executable, "-m", "mypy", *options, tmp_path], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
