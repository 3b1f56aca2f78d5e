"""Outside anchors: the same equations with SciPy's solvers."""

import sys
from pathlib import Path

import numpy as np
import pytest

from measured_scenes import table_rows
from scenes import box
from softffd import load_scene
from softffd.accuracy.rig import Rig, Setting
from softffd.cli.command import exit_status
from validation.scipy import Equations, integrate, nodal_forces, solver
from validation.tools import run_tool

pytestmark = pytest.mark.usefixtures("hasty")
pytest.importorskip("scipy", reason="the outside anchors need SciPy: pip install softffd[comparisons]")


def test_the_equations_are_the_springs_damping_weight_and_force_point_by_point(folder):
    scene = load_scene("driven.toml")
    rng = np.random.default_rng(1)
    x, v, force = scene.rest_positions() + rng.normal(0, 0.05, (12, 3)), rng.normal(0, 1, (12, 3)), rng.normal(0, 1, (12, 3))
    rate = Equations(scene).rate(np.concatenate([x.ravel(), v.ravel()]), force).reshape(2, 12, 3)
    np.testing.assert_array_equal(rate[0], v)
    np.testing.assert_allclose(rate[1], accelerations(scene, x, v, force), rtol=1e-12, atol=1e-10)


def accelerations(scene, x, v, force):
    """Eq. (3) and (6) for every pair of neighbours, from the text of DRIVEN."""
    rest, size = scene.rest_positions(), np.array([0.5, 0.5, 0.7])
    place = np.rint(rest / size).astype(int)
    left = place[:, 0] == 0
    mass, damping = np.where(left, 0.3, 1 / 12), np.where(left, 0.2, 0.05)
    total = force + mass[:, None] * [0.5, 0.0, -9.81] - damping[:, None] * v
    for a in range(12):
        for b in range(12):
            kind = int(np.abs(place[a] - place[b]).sum())
            if a == b or np.abs(place[a] - place[b]).max() > 1:
                continue
            k = 4e3 if left[a] and left[b] else {1: 1e3, 2: 500.0, 3: 200.0}[kind]
            doubled = kind == 1  # with 3 x 2 x 2 points every edge spring lies on an edge of the box, but those across its middle
            if kind == 1 and place[a, 0] == 1 == place[b, 0]:
                doubled = False
            way, length = x[b] - x[a], np.linalg.norm(rest[b] - rest[a])
            total[a] += (2 if doubled else 1) * k * (1 - length / np.linalg.norm(way)) * way
    return total / mass[:, None]


def solved_twice(scene) -> tuple[np.ndarray, np.ndarray]:
    """Positions by the FMU and by SciPy."""
    with Rig(scene) as rig:
        ours = rig.run(Setting("dop853", tolerance=1e-11)).positions
        theirs, _ = integrate(solver(), Equations(rig.scene), nodal_forces(rig), rig, Setting("DOP853", tolerance=1e-11))
    return ours, theirs


def test_scipy_and_the_fmu_solve_the_same_equations_with_the_same_inputs(folder):
    ours, theirs = solved_twice(load_scene("driven.toml"))
    assert np.abs(ours - theirs).max() < 1e-9


DAMPED = {
    "modulus": {
        "material": {"youngs_modulus": 2e4, "internal_damping": 2e-3},
        "region": [{"points": {"k": [0, 1]}, "internal_damping": 5e-3}],
    },
    "stiffness": {"material": {"stiffness": 2e2, "internal_damping": 2e-3}, "region": [{"points": "x-", "internal_damping": 0.0}]},
}


@pytest.mark.parametrize("material", DAMPED)
def test_scipy_and_the_fmu_agree_on_springs_of_a_modulus_and_on_dashpots(material):
    lattice = {"points": [4, 3, 5], "size": [0.3, 0.22, 0.36]}
    started = {"stretch": [1.1, 0.95, 1.02], "angular_velocity": [3.0, 2.0, 1.0]}
    scene = box(lattice=lattice, initial=started, stop_time=0.2, **DAMPED[material])
    ours, theirs = solved_twice(scene)
    assert np.abs(ours - theirs).max() < 1e-11 and np.abs(ours[-1] - ours[0]).max() > 0.1


def test_the_command_measures_scipy_beside(folder, few):
    assert exit_status(lambda: run_tool(["scipy", "small.toml", "--quick", "-o", "out"])) == 0
    rows = [row for row in table_rows() if row["origin"] == "scipy"]
    assert {row["method"] for row in rows} == {"DOP853", "RK45", "Radau", "LSODA"}
    assert min(float(row["error"]) for row in rows if row["method"] == "DOP853") < 1e-6


def test_without_scipy_the_option_says_what_to_install(folder, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "scipy.integrate", None)
    assert exit_status(lambda: run_tool(["scipy", "small.toml", "--quick", "-o", "out"])) == 1
    assert "softffd[comparisons]" in capsys.readouterr().err and not Path("out").exists()
