"""The files for the FMI Cross-Check are those that the program makes, and an importer that goes by them agrees."""

from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv, read_ref_opt_file, validate_result

from softffd import __version__
from softffd.scene.document import shipped_scenes
from validation.cross_check import MOST, write_cross_check

KEPT = Path(__file__).resolve().parents[3] / "cross-check" / "fmus" / "2.0" / "cs" / "linux64" / "softffd" / __version__
MEGABYTE = 1_000_000


@pytest.mark.short("press", "free_vibration")
@pytest.mark.parametrize("scene", shipped_scenes())
def test_the_files_are_made_again_and_an_importer_agrees(scene, tmp_path):
    made = {file.name: file for file in write_cross_check(tmp_path, [scene])}
    kept = {file.name: file for file in (KEPT / scene).iterdir() if file.suffix != ".fmu"}
    assert made.keys() - {f"{scene}.fmu"} == kept.keys()
    for name, file in kept.items():
        assert made[name].read_bytes() == file.read_bytes(), name
        assert file.stat().st_size < MEGABYTE
    options, reference = read_ref_opt_file(kept[f"{scene}_ref.opt"]), read_csv(kept[f"{scene}_ref.csv"])
    signals = read_csv(kept[f"{scene}_in.csv"]) if f"{scene}_in.csv" in kept else None
    names = list(reference.dtype.names[1:])
    assert 0 < len(names) <= MOST and not any("," in name for name in names)
    theirs = fmpy.simulate_fmu(
        str(made[f"{scene}.fmu"]), stop_time=options["StopTime"], step_size=options["StepSize"], output_interval=options["StepSize"],
        input=signals, output=names,
    )  # fmt: skip
    assert (reference["time"][0], reference["time"][-1]) == (options["StartTime"], options["StopTime"])
    assert validate_result(theirs, reference, options["StopTime"] - 1e-9) == 0  # the share of points outside the rules' band
    wrong = reference.copy()
    wrong[names[0]] += 0.5 * np.ptp(reference[names[0]])
    assert validate_result(theirs, wrong) > 0


def test_every_shipped_scene_has_its_files():
    assert sorted(folder.name for folder in KEPT.iterdir()) == sorted(shipped_scenes())
