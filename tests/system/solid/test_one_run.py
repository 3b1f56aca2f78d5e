"""A solid's run has the same bits from saved states, in both standards and on every instruction set; what is set between steps acts."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest

from scenes import GRAVITY, OBSERVED
from softffd import FmuError, Simulation, package_fmu, simulate
from solids import braked, solid
from stepping import Stepper, require_same_continuation

WALL = {"name": "wall", "points": "x-"}
LIVELY = {
    "free": {"stretch": [1.1, 0.95, 1.0], "angular_velocity": [1.0, 2.0, 3.0]},
    "damped": {"stretch": [1.1, 0.95, 1.0], "angular_velocity": [1.0, 2.0, 3.0], "internal_damping": 1e-3},
    "falling": {"gravity": GRAVITY, "offset": [0.0, 0.0, 0.02], "velocity": [0.5, 0.0, 0.0], "plane": [{"name": "ground"}]},
    "falling damped": {
        "points": 4, "gravity": GRAVITY, "offset": [0.0, 0.0, 0.02], "plane": [{"name": "ground"}], "internal_damping": 1e-3,
    },
    "held": {"gravity": GRAVITY, "pin": [WALL], "load": [{"name": "end", "points": "x+"}], "forces": "all"},
}  # fmt: skip


def lively(name: str, **keys):
    keys = {"points": (7, 4, 4)} | LIVELY[name] | OBSERVED | keys
    return solid(modulus=1e4, ratio=0.4, density=10.0, size=[2.0, 1.0, 1.0], stop_time=0.3, **keys)


@pytest.mark.parametrize("name", LIVELY)
def test_a_run_goes_on_from_a_saved_state_with_the_same_bits(name):
    require_same_continuation(lively(name))


@pytest.mark.parametrize("method", ["leapfrog", "bm4", "rkn12", "dop853", "auto"])
def test_the_same_calls_give_the_same_bits(method):
    scene = lively("free", method=method, tolerance=1e-6)
    one, other = (simulate(scene) for _ in range(2))
    assert np.array_equal(one.positions, other.positions)
    assert all(np.array_equal(values, other.outputs[key]) for key, values in one.outputs.items())


def test_a_fixed_step_gives_the_same_bits_however_the_run_is_cut():
    scene = lively("held", method="leapfrog", step=2e-4)
    fine, coarse = (simulate(scene, step=length, start_values={"load.end.z": 3.0}) for length in (0.01, 0.05))
    assert np.array_equal(fine.positions[::5], coarse.positions)


@pytest.mark.parametrize("name", ["falling damped", "held"])
def test_fmi_3_gives_the_same_bits_as_fmi_2(name, tmp_path):
    scene = lively(name)
    packages = [package_fmu(scene, tmp_path / f"fmi{fmi}.fmu", fmi=fmi) for fmi in (2, 3)]
    two, three = (simulate(package) for package in packages)
    assert np.array_equal(two.positions, three.positions)
    assert np.array_equal(two.positions, simulate(scene).positions)


RUNS = """
import sys
from softffd import simulate
sys.path[:0] = sys.argv[1:]
from test_one_run import LIVELY, lively

for name in LIVELY:
    result = simulate(lively(name))
    print(name, result.positions.tobytes().hex(), result.outputs["energy.elastic"].tobytes().hex())
"""


@pytest.mark.full
def test_the_same_bits_with_every_instruction_set():
    paths = [path for path in sys.path if path.endswith(("support", "solid"))]

    def digest(instructions: str) -> str:
        environment = os.environ | {"SOFTFFD_INSTRUCTIONS": instructions}
        command = [sys.executable, "-c", RUNS, os.path.dirname(__file__), *paths]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        assert len(set(done.stdout.splitlines())) == len(LIVELY)
        return hashlib.sha256(done.stdout.encode()).hexdigest()

    assert digest("baseline") == digest("avx2") == digest("")


def stretched_force(sim: Simulation) -> float:
    """Of the solid at rest on the frame at its end [N]."""
    for _ in range(60):
        sim.step(0.5)
    return sim.number("pin.hand.reaction.x")


def held_long():
    """Pulled to 1.2 times its length between two frames."""
    hand = {"name": "hand", "points": "x+", "motion": "input", "inputs": ["position.x"]}
    return solid(4, ratio=0.3, pin=[WALL, hand], region=braked(4, 1.5), method="leapfrog", energy=True)


def test_modulus_and_ratio_that_are_set_between_steps_act():
    with Simulation(held_long(), start_values={"pin.hand.position.x": 1.2}) as sim:
        first = stretched_force(sim)
        sim["youngs_modulus"] = 3.0
        assert stretched_force(sim) == pytest.approx(3 * first, rel=1e-6)
        sim["poissons_ratio"] = 0.45
        stiffer = stretched_force(sim) / 3
        assert sim["poissons_ratio"] == 0.45
    with Simulation(held_long(), start_values={"pin.hand.position.x": 1.2, "poissons_ratio": 0.45}) as sim:
        assert stretched_force(sim) == pytest.approx(stiffer, rel=1e-6)
    assert abs(stiffer) > 1.02 * abs(first)


def test_a_change_of_the_material_is_work():
    with Stepper(held_long(), start_values={"pin.hand.position.x": 1.2}) as stepper:
        stepper.step(0.5, times=60)
        before = stepper.energy("kinetic", "elastic", "dissipated") - stepper.energy("work")
        stepper.set({"youngs_modulus": 3.0, "poissons_ratio": 0.45})
        stepper.step(0.5, times=60)
        after = stepper.energy("kinetic", "elastic", "dissipated") - stepper.energy("work")
        assert stepper.energy("work") > 0.05
        assert after == pytest.approx(before, abs=0.02 * stepper.energy("work"))


REFUSED = [("poissons_ratio", 0.6, "0.495"), ("poissons_ratio", -0.1, "0"), ("youngs_modulus", 0.0, "0")]


@pytest.mark.parametrize("running", [False, True], ids=["at the start", "between steps"])
@pytest.mark.parametrize(("name", "value", "wanted"), REFUSED)
def test_values_that_no_solid_has_are_refused_by_name(name, value, wanted, running):
    with Simulation(held_long()) as sim:
        if running:
            sim.step(0.5)
        with pytest.raises(FmuError, match=rf"{name}: wanted (<=|>=|>) {wanted}\b.*got {value:g}"):
            sim[name] = value


def test_the_published_method_has_no_solid():
    with pytest.raises(FmuError, match=r"solver.method: wanted one of .*\(the body is a solid\), got 2"):
        Simulation(held_long(), method="central_difference")
