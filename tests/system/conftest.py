"""Scenes from text, and the stored reference data."""

from pathlib import Path

import numpy as np
import pytest

from softffd import load_scene

GOLDEN = Path(__file__).resolve().parents[2].parent / "shared" / "golden"


@pytest.fixture
def scene(tmp_path):
    """scene(text) writes a TOML text to a file and loads it."""

    def load(text: str, name: str = "scene"):
        path = tmp_path / f"{name}.toml"
        path.write_text(text)
        return load_scene(path)

    return load


@pytest.fixture
def golden():
    """golden(name) is the archive of a reference trajectory; the test is skipped where the data are not at hand."""

    def load(name: str):
        path = GOLDEN / f"{name}.npz"
        if not path.is_file():
            pytest.skip(f"the reference data {name}.npz are not beside this checkout (folder shared/golden)")
        return np.load(path)

    return load


@pytest.fixture(scope="session")
def drivers(tmp_path_factory) -> Path:
    """A folder with the driver FMUs."""
    from softffd.drivers import build_drivers  # needs pythonfmu

    folder = tmp_path_factory.mktemp("drivers")
    build_drivers(folder)
    return folder
