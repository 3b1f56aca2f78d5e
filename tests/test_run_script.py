"""python/run.py: what a user sees while it builds."""

import importlib
import sys
from pathlib import Path

import pytest


@pytest.fixture
def script(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parents[1] / "python"))
    yield importlib.import_module("run")
    for name in ("run", "release"):
        sys.modules.pop(name, None)


def compiled(script, monkeypatch, text: str, status: int = 0) -> None:
    """pip_compile with a pip that says this."""
    monkeypatch.setattr(script, "pip_command", lambda *_words: [sys.executable, "-c", f"import sys; print({text!r}); sys.exit({status})"])
    script.pip_compile("install", ".")


def test_the_compiler_is_followed(script, monkeypatch, capsys):
    monkeypatch.setattr(script, "TELL_EVERY", 0)
    compiled(script, monkeypatch, "  [0/2] Re-run CMake\n  [7/95] Building a")
    assert capsys.readouterr().out == "run.py:    compiled 7/95\n"
    compiled(script, monkeypatch, "[ 12%] Building with make\n  array[3/4]")
    assert capsys.readouterr().out == "run.py:    compiled 12%\n"


def test_where_the_output_is_kept_a_line_every_few_seconds_is_enough(script, monkeypatch, capsys):
    compiled(script, monkeypatch, "\n".join(f"[{n}/95] Building" for n in range(1, 96)))
    assert capsys.readouterr().out == "run.py:    compiled 1/95\n"


def test_what_pip_said_is_shown_where_it_fails(script, monkeypatch):
    with pytest.raises(SystemExit, match=r"(?s)x.cpp:3: error: no.*pip failed \(see above\)"):
        compiled(script, monkeypatch, "[1/2] Building\nx.cpp:3: error: no", status=1)
