"""The driver FMUs."""

import os
from pathlib import Path

import pytest

from locks import one_at_a_time


@pytest.fixture(scope="session")
def drivers(tmp_path_factory) -> Path:
    """A folder with the driver FMUs, which all processes of a run share."""
    from softffd.drivers import build_drivers  # needs pythonfmu

    run = tmp_path_factory.getbasetemp()
    folder = (run.parent if "PYTEST_XDIST_WORKER" in os.environ else run) / "drivers"
    with one_at_a_time(folder):
        if not any(folder.iterdir()):
            build_drivers(folder)
    return folder
