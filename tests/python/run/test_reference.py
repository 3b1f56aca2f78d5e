"""Reference inputs and results in an FMU are those of a run of it, and their error is told."""

import csv
import io
import re
from xml.etree import ElementTree as Xml
from zipfile import ZipFile

import numpy as np
import pytest

from softffd import load_scene, package_fmu, simulate
from softffd.cli.command import main
from softffd.run.reference import ABOUT, FOLDER, LAYERED, reference_files

ROLE = re.compile(r"document|testcase|experiment(/smoke-test)?|result|report|other")
"""Of the schema, those that such files can have"""


@pytest.fixture(scope="module")
def scene():
    return load_scene("press").replace({"experiment.stop_time": 0.3})


def table(text: bytes) -> dict[str, list[str]]:
    rows = list(csv.reader(io.StringIO(text.decode())))
    return dict(zip(rows[0], map(list, zip(*rows[1:], strict=True)), strict=True))


def test_a_run_with_these_inputs_gives_these_results(scene, tmp_path):
    files = reference_files(scene)
    file = package_fmu(scene, tmp_path / "press.fmu", extra=files)
    with ZipFile(file) as archive:
        inputs, results = (table(archive.read(f"{FOLDER}/{name}.csv")) for name in ("inputs", "results"))
    given = np.array(list(zip(*([float(each) for each in column] for column in inputs.values()), strict=True)), dtype=float)
    rows = np.array([tuple(row) for row in given], dtype=[(name, float) for name in inputs])
    run = simulate(file, inputs=rows, stop_time=0.3)
    for name in ("plane.press.reaction.z", "energy.elastic", "plane.press.contacts"):
        assert [float(each) for each in results[name]] == run.outputs[name].tolist()
    assert [float(each) for each in results["position[3,3,3].z"]] == run.positions[:, 3, 3, 3, 2].tolist()
    errors = table(files[f"{FOLDER}/errors.csv"])
    assert errors["name"] == [name for name in results if name != "time"]
    assert 0 < float(errors["largest_difference"][errors["name"].index("position[3,3,3].z")]) < 1e-2


def test_the_manifest_has_what_the_layered_standard_wants(scene):
    files = reference_files(scene)
    root = Xml.fromstring(files[f"{FOLDER}/fmi-ls-manifest.xml"])
    assert root.tag == "fmiReferences" and root.attrib == {f"{{{LAYERED}}}{key}": text for key, text in ABOUT.items()}
    assert {each.get("source") for each in root} == {"inputs.csv", "results.csv", "errors.csv"}
    assert all(ROLE.fullmatch(each.get("role")) and f"{FOLDER}/{each.get('source')}" in files for each in root)
    assert b"From 0 to 0.3 s in communication steps of 0.01 s" in files["documentation/fmi-ls-ref.txt"]


def test_a_scene_without_inputs_has_no_file_of_them():
    assert f"{FOLDER}/inputs.csv" not in reference_files("free_vibration")


def test_the_command_puts_them_in_where_it_is_asked_to(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for more, wanted in (([], False), (["--reference"], True)):
        assert main(["build", "free_vibration", "-o", f"{wanted}.fmu", *more]) == 0
        with ZipFile(f"{wanted}.fmu") as archive:
            assert (f"{FOLDER}/fmi-ls-manifest.xml" in archive.namelist()) == wanted
