"""The work that a free mass on a pad takes, beside that of a plate that an input presses as far."""

import pytest

from scenes import meshed
from softffd import simulate
from validation import shapes

SIDE, FORCE, RISE = 0.1, 50.0, 0.1
"""m, N, s"""
PADS = {
    "solid": {"model": "solid", "youngs_modulus": 1e6, "poissons_ratio": 0.3, "density": 1000.0, "internal_damping": 2e-3},
    "springs": {"stiffness": 1e5, "internal_damping": 1e-3},
}
SUNK = {"solid": 4.69e-4, "springs": 3.8e-5}
"""m, under the force"""


def steps(folder, pad, keys, inputs) -> float:
    """Steps of a second, rejected ones among them, in which the lid is pressed as `inputs` say."""
    vertices, faces = shapes.cube(4, 0.0)
    lid = {"name": "lid", "size": [2 * SIDE, 2 * SIDE, SIDE], "point": [0.0, 0.0, 1.5 * SIDE], **keys}
    scene = meshed(
        folder, (vertices * SIDE - [SIDE / 2, SIDE / 2, 0.0], faces), points=[4, 4, 4], material=PADS[pad], box=[lid],
        lattice={"origin": [-SIDE / 2, -SIDE / 2, 0.0], "size": [SIDE] * 3}, pin=[{"name": "base", "points": "z-"}],
        outputs={"solver": True},
    )  # fmt: skip
    result = simulate(scene, inputs=inputs, interpolation="linear", stop_time=1.0, step=0.01)
    assert not result.summary["warnings"]
    return result.outputs["solver.steps"][-1] + result.outputs["solver.rejected"][-1]


def of_mass(folder, pad, mass, *, guided: bool) -> float:
    free = {"motion": "free", "mass": mass, **({"guide": [0.0, 0.0, 1.0]} if guided else {})}
    return steps(folder, pad, free, lambda t: {"box.lid.force.z": -FORCE * min(1.0, t / RISE)})


CASES = [(pad, mass) for pad in PADS for mass in (1e-3, 1e-1, 1e1, 1e4)]


@pytest.mark.short("springs-0.001-loose", "solid-10000.0-guided")
@pytest.mark.parametrize("guided", [True, False], ids=["guided", "loose"])
@pytest.mark.parametrize(("pad", "mass"), CASES)
def test_a_mass_needs_no_more_than_twice_the_steps_of_a_plate(pad, mass, guided, tmp_path):
    led = {"motion": "input", "inputs": ["point.z", "velocity.z"]}
    plate = steps(tmp_path, pad, led, lambda t: {
        "box.lid.point.z": 1.5 * SIDE - SUNK[pad] * min(1.0, t / RISE), "box.lid.velocity.z": -SUNK[pad] / RISE * (t < RISE - 1e-6),
    })  # fmt: skip
    assert of_mass(tmp_path, pad, mass, guided=guided) <= 2 * plate


@pytest.mark.short("solid-0.001", "springs-0.1")
@pytest.mark.parametrize("mass", [1e-3, 1e-1])
@pytest.mark.parametrize("pad", PADS)
def test_a_light_mass_that_may_turn_needs_the_steps_of_one_that_may_not(pad, mass, tmp_path):
    """A force of a thousand times its weight turns with it, and each iteration of an implicit step answers for that: it would fly off."""
    assert of_mass(tmp_path, pad, mass, guided=False) <= 1.2 * of_mass(tmp_path, pad, mass, guided=True)
