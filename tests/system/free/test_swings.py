"""A free mass on a pad, bonded or lying on it: it swings at the pad's stiffness, and gets of what shakes the pad what textbooks say."""

import numpy as np
import pytest
from scipy.optimize import curve_fit

from readings import points
from scenes import box, meshed
from softffd import simulate
from stepping import Stepper
from validation import shapes

SIDE, MASS, PAD, GRAVITY = 0.1, 1000.0, 1.0, 0.1
"""m; kg, of the mass and of the pad; m/s2"""
PUSH = 0.02 * MASS * GRAVITY
"""N; the pad sinks by 1 % under the mass"""


def pad(folder, kind, *, ratio, guide, damping):
    """The scene of a mass on a pad that is held below, and the mass's name."""
    material = {"model": "solid", "youngs_modulus": 1e6, "poissons_ratio": ratio, "density": PAD / SIDE**3, "internal_damping": damping}
    keys = {
        "points": [4, 4, 4], "lattice": {"origin": [-SIDE / 2, -SIDE / 2, 0.0], "size": [SIDE] * 3}, "gravity": [0.0, 0.0, -GRAVITY],
        "material": material, "tolerance": 1e-5, "stop_time": 30.0,
    }  # fmt: skip
    base = {"name": "base", "points": "z-"}
    mass = {"name": "load", "motion": "free", "mass": MASS, **({"guide": [0.0, 0.0, 1.0]} if guide else {})}
    if kind == "pin":
        turns = {} if guide else {"inertia": [MASS * SIDE**2 / 6] * 3}
        return box(pin=[base, {**mass, "points": "z+", **turns}], **keys), "pin.load"
    vertices, faces = shapes.cube(4, 0.0)
    mass |= {"size": [2 * SIDE, 2 * SIDE, SIDE], "point": [0.0, 0.0, 1.5 * SIDE], "friction": 0.5}
    return meshed(folder, (vertices * SIDE - [SIDE / 2, SIDE / 2, 0.0], faces), pin=[base], box=[mass], **keys), "box.load"


CASES = [
    *((kind, step, 0.3, True) for kind in ("pin", "box") for step in (0.001, 0.01, 0.1)),
    *((kind, 0.01, ratio, guide) for kind in ("pin", "box") for ratio, guide in ((0.0, True), (0.3, False))),
]


@pytest.mark.short("pin-0.01-*")
@pytest.mark.parametrize(("kind", "step", "ratio", "guide"), CASES)
def test_a_mass_on_a_pad_swings_at_the_root_of_stiffness_by_mass(kind, step, ratio, guide, tmp_path):
    """The stiffness is that of the pad at rest under a little more and a little less; a third of the pad swings along."""
    scene, name = pad(tmp_path, kind, ratio=ratio, guide=guide, damping=0.2)
    with Stepper(scene, stop_time=30.0) as stepper:
        places = []
        for force in (PUSH, -PUSH, 0.0):
            stepper.set({f"{name}.force.z": force})
            stepper.step(0.5, times=10)
            places.append(stepper.number(f"{name}.position.z"))
        stiffness = 2 * PUSH / (places[0] - places[1])
        stepper.set({"internal_damping": 0.0, f"{name}.force.z": PUSH})
        count = round(1.8 / step)
        times, heights = step * np.arange(count + 1), [places[-1]]
        for _ in range(count):
            stepper.step(step)
            heights.append(stepper.number(f"{name}.position.z"))
        assert not stepper.warnings
    wanted = np.sqrt(stiffness / (MASS + PAD / 3))
    moved = (np.array(heights) - places[-1]) * stiffness / PUSH

    def swing(phase, rate, start):
        return start + 1 - np.cos(rate * phase)

    (rate, start), _ = curve_fit(swing, wanted * times, moved, p0=(1.0, 0.0))
    assert rate == pytest.approx(1, abs=2e-4 if ratio else 2e-5)  # sideways more of the pad swings along
    assert np.abs(swing(wanted * times, rate, start) - moved).max() < 1e-3


RATES = [0.3, 0.7, 1.0, 1.41, 2.0, 3.0]


def isolator(*, damping, mass=10.0, **keys):
    """A mass bonded on a block of 1 g, whose base may move."""
    material = {"model": "solid", "youngs_modulus": 1e6, "poissons_ratio": 0.3, "density": 1.0, "internal_damping": damping}
    base = {"name": "base", "points": "z-", "motion": "input", "inputs": ["position.z"]}
    load = {"name": "load", "points": "z+", "motion": "free", "mass": mass, "guide": [0.0, 0.0, 1.0]}
    lattice = {"points": [4, 4, 4], "origin": [-SIDE / 2, -SIDE / 2, 0.0], "size": [SIDE] * 3}
    return box(lattice=lattice, material=material, pin=[base, load], tolerance=1e-6, **keys)


@pytest.fixture(scope="module")
def static_stiffness():
    """Of the block, N/m, by what a force of 1 N to either side moves the mass in the end."""
    rest = []
    for force in (-1.0, 1.0):
        result = simulate(isolator(damping=0.02), inputs={"pin.load.force.z": force}, stop_time=1.0, step=0.1)
        rest.append(result.outputs["pin.load.position.z"][-1])
    return 2.0 / (rest[1] - rest[0])


@pytest.mark.short("0.2-1.0")
@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("damped", [0.05, 0.2])
def test_an_isolator_transmits_what_the_textbook_says(static_stiffness, damped, rate):
    """x / y = k (1 + i w tau) / (k (1 + i w tau) - m w^2), of a base that moves as y; `rate` is w by the resonance, `damped` the damping
    ratio tau w0 / 2."""
    mass, height = 10.0, 1e-4
    resonance = np.sqrt(static_stiffness / mass)
    w, tau = rate * resonance, 2 * damped / resonance
    period = 2 * np.pi / w
    cycles = int(np.ceil(np.log(1e3) / (damped * resonance * period))) + 2
    result = simulate(
        isolator(damping=tau), inputs=lambda t: {"pin.base.position.z": height * np.sin(w * t)}, interpolation="linear",
        stop_time=cycles * period, step=period / 100,
    )  # fmt: skip
    last = result.time > (cycles - 2) * period
    phase = w * result.time[last]
    waves = np.stack([np.cos(phase), np.sin(phase), np.ones_like(phase)], axis=1)
    (cosine, sine, _), *_ = np.linalg.lstsq(waves, result.outputs["pin.load.position.z"][last] - SIDE, rcond=None)
    block = static_stiffness * (1 + 1j * w * tau)
    assert (sine + 1j * cosine) / height == pytest.approx(block / (block - mass * w**2), rel=5e-3)


def test_a_body_that_only_a_free_part_holds_is_free():
    """It falls and turns with its part; errors of its motion last. They were forgotten as those of a body that a pin brings back: by the
    implicit steps of `auto` it lost its spin, 9e-4 m in 0.2 s."""
    part = {"name": "part", "motion": "free", "mass": 6.8, "points": "x+", "origin": [1.0, 0.5, 0.5], "inertia": [0.64, 0.66, 1.1]}
    scene = box(
        points=[3, 2, 4], mass={"total": 1.8}, stiffness=3.3e5, damping=0.0, internal_damping=4.5e-3, pin=[part], gravity=[0.0, 0.0, -9.81],
        velocity=[-0.35, -0.66, -0.56], angular_velocity=[1.3, 1.4, 1.8], stop_time=0.2, communication_step=0.02, tolerance=4e-5,
    )  # fmt: skip
    result, exact = simulate(scene), simulate(scene, start_values={"solver.method": "leapfrog"})
    assert points(result) == pytest.approx(points(exact), abs=10 * 4e-5)
    assert not result.summary["warnings"]
