"""The two scenes of the tests on the C functions, packaged and unpacked once per file."""

import pytest

from c_host import Fmu
from c_host3 import Fmu3
from straight_run import BARE, RICH


def unpacked(standard, folder) -> list:
    rich = standard(RICH, folder / "rich")
    return [rich, standard(BARE, folder / "bare", rich.library)]


@pytest.fixture(scope="module")
def fmus(tmp_path_factory) -> list[Fmu]:
    return unpacked(Fmu, tmp_path_factory.mktemp("fmi2"))


@pytest.fixture(scope="module")
def rich(fmus) -> Fmu:
    return fmus[0]


@pytest.fixture(scope="module")
def rich3(tmp_path_factory) -> Fmu3:
    return Fmu3(RICH, tmp_path_factory.mktemp("fmi3") / "rich")


@pytest.fixture(scope="module", params=[Fmu, Fmu3], ids=["fmi2", "fmi3"])
def of_each(request, tmp_path_factory) -> list[Fmu]:
    """The same of either standard."""
    return unpacked(request.param, tmp_path_factory.mktemp("each"))


@pytest.fixture(scope="module")
def rich_of_each(of_each) -> Fmu:
    return of_each[0]
