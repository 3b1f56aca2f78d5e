"""Builds and runs the C++ tests of tests/core and tests/fmi."""

from pathlib import Path

import pytest

import cpp


@pytest.fixture(scope="session")
def built() -> Path:
    """The folder of the built test programs: run.py builds the library there too, so that objects are compiled once."""
    folder = cpp.ROOT / "build" / "native"
    cpp.build(folder, "-DCMAKE_BUILD_TYPE=Release")
    return folder


@pytest.mark.parametrize("source", cpp.SOURCES, ids=cpp.source_id)
def test_cpp(built: Path, source: Path) -> None:
    cpp.check(built, source)
