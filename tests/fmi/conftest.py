"""The two scenes of the tests on the C functions, packaged and unpacked once per file."""

import pytest

from c_host import Fmu
from straight_run import BARE, RICH


@pytest.fixture(scope="module")
def fmus(tmp_path_factory) -> list[Fmu]:
    folder = tmp_path_factory.mktemp("sequences")
    rich = Fmu(RICH, folder / "rich")
    return [rich, Fmu(BARE, folder / "bare", rich.library)]


@pytest.fixture(scope="module")
def rich(fmus) -> Fmu:
    return fmus[0]
