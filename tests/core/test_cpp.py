"""Builds and runs the C++ tests of tests/core and tests/fmi/library."""

from pathlib import Path

import pytest

import cpp_tests


@pytest.fixture(scope="session")
def built() -> Path:
    """The folder of the built test programs: run.py builds the library there too, so that objects are compiled once."""
    folder = cpp_tests.ROOT / "build" / "native"
    cpp_tests.build(folder, "-DCMAKE_BUILD_TYPE=Release")
    return folder


@pytest.mark.parametrize("source", cpp_tests.SOURCES, ids=cpp_tests.source_id)
def test_cpp(built: Path, source: Path) -> None:
    cpp_tests.check(built, source)
