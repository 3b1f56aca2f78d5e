"""The estimated error of a run."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from measured_scenes import SMALL
from softffd import load_scene, package_fmu, simulate
from softffd.cli.command import main
from softffd.cli.told import told_after
from softffd.run.findings import findings


def test_error_of_a_built_fmu_needs_the_variable(folder, capsys):
    package_fmu(load_scene("small.toml"), "small.fmu")
    assert main(["run", "small.fmu", "--error", "-o", "out"]) == 1
    assert "error_estimate = true" in capsys.readouterr().err and not Path("out").exists()


def test_an_estimated_error_is_in_the_summary_in_words_and_on_the_picture(tmp_path):
    plain = simulate(load_scene("free_vibration"), stop_time=0.2)
    estimated = replace(plain, outputs=plain.outputs | {"solver.error_estimate": np.array([0.0, 1e-5, 3.21e-5])})
    results = {"plain": plain, "estimated": replace(estimated, summary=estimated.summary | findings(estimated))}
    assert results["estimated"].summary["estimated_error_m"] == 3.21e-5
    assert "with an estimated error of 3.2e-05 m" in told_after(results["estimated"].summary)
    rows = []
    for name, result in results.items():
        result.plot(tmp_path / f"{name}.png")
        with Image.open(tmp_path / f"{name}.png") as image:
            rows.append(np.asarray(image.convert("L"))[: image.height // 15, image.width // 2 :])
    assert rows[0].min() == 255 and rows[1].min() < 150  # words in the upper right corner, beside the title


def test_run_with_error_estimates_the_error_of_a_scene(folder, capsys):
    Path("small.toml").write_text(SMALL + '[solver]\nmethod = "leapfrog"\nstep = 1e-4\n')
    assert main(["run", "small.toml", "--error", "-o", "out"]) == 0
    assert "estimated error" in capsys.readouterr().out
    estimate = json.loads(Path("out/summary.json").read_text())["estimated_error_m"]
    exact = simulate(load_scene("small.toml"), start_values={"solver.method": "dop853", "solver.step": 0, "solver.tolerance": 1e-12})
    error = np.linalg.norm(np.load("out/result.npz")["positions"][-1] - exact.positions[-1], axis=-1).max()
    assert error / 3 < estimate < 3 * error
