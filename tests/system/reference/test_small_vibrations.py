"""Small vibrations follow the eigenmodes of the lattice."""

import numpy as np
import pytest

import reference
from scenes import box
from stepping import Stepper

FREE = {"stiffness": 1e3, "forces": "all", "method": "leapfrog", "step": 1e-4}
H = 1e-4
AMPLITUDE = 1e-6


def excited(stepper, frequency, shape, steps):
    """The displacements at the communication points after a constant force along a mode has acted for half of its period.

    A leapfrog oscillates with omega' = 2/h asin(omega h / 2), and under a constant force f about f / m omega^2 exactly so.
    """
    on = max(1, round(np.pi / frequency / H))
    mass, largest = 1 / 64, np.abs(shape).max()
    stepper.set_forces(shape.reshape(-1, 3) / largest * mass * frequency**2 * 0.5 * AMPLITUDE)
    stepper.step(on * H)
    stepper.set_forces(np.zeros((64, 3)))
    measured, expected = [], []
    discrete = 2 / H * np.arcsin(frequency * H / 2)
    for n in range(1, steps + 1):
        stepper.step(7 * H)
        t = (on + 7 * n) * H
        measured.append(stepper.points() - reference.rest_lattice())
        course = 0.5 * AMPLITUDE * (np.cos(discrete * (t - on * H)) - np.cos(discrete * t))
        expected.append(course * shape.reshape(-1, 3) / largest)
    return np.array(measured), np.array(expected)


@pytest.mark.parametrize(("topology", "count"), [("distinct", 468), ("paper", 504)])
def test_each_mode_vibrates_alone_with_its_own_frequency(golden, topology, count):
    modes = golden("modes")
    with Stepper(box(**FREE, damping=0.0, springs=topology)) as stepper:
        for number, shape in zip(modes["numbers"], modes[f"modes_{count}"].T, strict=True):
            frequency = modes[f"omega_{count}"][number]
            measured, expected = excited(stepper, frequency, shape, 100)
            # springs are linear but for terms of the order of the square of the amplitude over a spring's length
            assert np.abs(measured - expected).max() < 1e-4 * AMPLITUDE, f"mode {number}"
            stepper.restart({})


def test_the_topologies_differ_in_frequency_and_the_test_above_would_tell(golden):
    modes = golden("modes")
    with Stepper(box(**FREE, damping=0.0, springs="paper")) as stepper:
        measured, expected = excited(stepper, modes["omega_468"][6], modes["modes_468"][:, 0], 100)
    assert np.abs(measured - expected).max() > 0.1 * AMPLITUDE


def test_a_damped_mode_decays_with_half_the_damping_rate():
    frequencies, shapes = reference.cube().eigenmodes()
    with Stepper(box(**FREE, damping=0.2)) as stepper:
        measured, _ = excited(stepper, frequencies[6], shapes[:, 6], 200)
    course = np.einsum("tpc,pc->t", measured, shapes[:, 6].reshape(-1, 3))
    t, rate = 7 * H * np.arange(200), 0.2 * 64 / 2
    omega = np.sqrt(frequencies[6] ** 2 - rate**2)
    waves = np.exp(-rate * t)[:, None] * np.stack([np.cos(omega * t), np.sin(omega * t)], axis=1)
    fitted, *_ = np.linalg.lstsq(waves, course, rcond=None)
    # the leapfrog's phase error: omega t (omega h)^2 / 24, 27 rad * 1.5e-5
    assert np.abs(waves @ fitted - course).max() < 1e-3 * np.abs(course).max()
