"""Builds and runs the C++ tests of tests/core and tests/fmi/library."""

import os
import re
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


WITH_GRIDS = [source for source in cpp_tests.SOURCES if re.search(r"check::(some|thorough)", source.read_text())]


@pytest.mark.full
@pytest.mark.parametrize("source", WITH_GRIDS, ids=cpp_tests.source_id)
def test_cpp_on_whole_grids(built: Path, source: Path) -> None:
    cpp_tests.check(built, source, os.environ | {"SOFTFFD_THOROUGH": "1"})
