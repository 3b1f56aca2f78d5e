"""python/run.py: what a user sees while it builds."""

import importlib
import subprocess
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


@pytest.fixture
def half(script, monkeypatch, tmp_path):
    """The script with a .venv that is set up, in which `half.lost` says what is missing, and with a pip of no effect."""
    stamp = tmp_path / "stamp"
    monkeypatch.setattr(script, "PYTHON", Path(sys.executable))
    stamp.write_text(script.fingerprint())
    script.lost, script.installed = [], []
    monkeypatch.setattr(script, "STAMP", stamp)
    monkeypatch.setattr(script, "missing", lambda: script.lost)
    monkeypatch.setattr(script, "make_venv", lambda: None)
    monkeypatch.setattr(script, "forget_wasm", lambda: None)
    monkeypatch.setattr(script, "pip_command", lambda *_words: [sys.executable, "-c", "pass"])
    monkeypatch.setattr(script, "pip", lambda *words, **_: script.installed.append(words))
    monkeypatch.setattr(script, "pip_compile", lambda *words, **_: script.installed.append(words))
    return script


def test_what_is_set_up_is_left_alone(half):
    half.set_up()
    assert not half.installed


def test_a_set_up_that_was_interrupted_is_done_again(half, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(half, "fingerprint", lambda: "other sources")
        patch.setattr(half, "pip_compile", lambda *_words, **_: sys.exit(130))
        with pytest.raises(SystemExit):
            half.set_up()
    assert not half.STAMP.exists()
    half.installed.clear()
    half.set_up()
    assert half.installed and half.STAMP.exists()


def test_what_is_of_older_sources_goes(script, monkeypatch, tmp_path):
    old = tmp_path / "wasm32-wasi" / "softffd.wasm"
    old.parent.mkdir()
    old.write_bytes(b"old")
    monkeypatch.setattr(script, "installed_libraries", lambda _python: tmp_path)
    script.forget_wasm()
    assert not old.exists() and tmp_path.is_dir()


def test_what_pip_takes_for_installed_is_named(half):
    half.lost = ["pydantic"]
    with pytest.raises(SystemExit, match=r"\.venv holds parts only of pydantic; remove the folder .* and run this again"):
        half.set_up()
    assert half.installed and not half.STAMP.exists()


def test_the_modules_that_are_missing_are_found_without_importing_them(script, monkeypatch):
    monkeypatch.setattr(script, "PYTHON", sys.executable)
    assert script.missing() == []
    monkeypatch.setattr(script, "IMPORTED_AS", {"pillow": "PIL", "pydantic": "pydantic_of_nobody"})
    assert script.missing() == ["pydantic_of_nobody"]


def test_the_command_says_how_to_finish_a_set_up(tmp_path):
    (tmp_path / "sitecustomize.py").write_text("import sys\nsys.modules['pydantic'] = None\n")
    command = [sys.executable, "-m", "softffd", "run", "press"]
    ended = subprocess.run(command, env={"PYTHONPATH": str(tmp_path)}, cwd=tmp_path, capture_output=True, text=True)
    assert (ended.returncode, ended.stdout) == (1, "")
    assert ended.stderr.startswith("softffd: the package pydantic is not installed, as after a set-up that was interrupted; to ")


@pytest.mark.parametrize("words", [["--help"], ["release", "--help"], ["wasm", "-h"], ["docs", "--help"]], ids=" ".join)
def test_help_is_printed_and_nothing_is_done(script, monkeypatch, capsys, words):
    monkeypatch.setattr(sys, "argv", ["run.py", *words])
    monkeypatch.setattr(script, "set_up", lambda: pytest.fail("sets up"))
    assert script.main() == 0 and capsys.readouterr().out == f"{script.__doc__}\n"
