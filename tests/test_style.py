"""Layout is what the formatters make it, and types are what the checkers find sound."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.lint

ROOT = Path(__file__).resolve().parents[1]
PROGRAMS = Path(sys.executable).parent
CHECKS = [("ruff", "check", "."), ("ruff", "format", "--check", "."), ("mypy",)]


def complaints(program: str, *arguments: str) -> str:
    done = subprocess.run([PROGRAMS / program, *arguments], cwd=ROOT, capture_output=True, text=True)
    return done.stdout + done.stderr if done.returncode else ""


@pytest.mark.parametrize("check", CHECKS, ids=" ".join)
def test_python_passes(check):
    found = complaints(*check)
    assert not found, found


def test_cpp_has_the_layout_of_clang_format():
    sources = [str(path) for folder in ("fmu_src", "tests") for path in sorted((ROOT / folder).rglob("*.[ch]pp"))]
    assert len(sources) > 100
    found = complaints("clang-format", "--dry-run", "-Werror", *sources)
    assert not found, found
