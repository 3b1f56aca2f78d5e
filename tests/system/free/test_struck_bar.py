"""A free box on a guide strikes a clamped bar: its speed and force over time, and when it parts, by the waves in the bar."""

import numpy as np
import pytest

from readings import vector
from scenes import meshed
from softffd import simulate
from struck_bar import struck
from validation import shapes

LENGTH, MODULUS, DENSITY, SPEED = 0.2, 1e6, 1000.0, 0.2
"""m, Pa, kg/m3, m/s"""
WAVE = np.sqrt(MODULUS / DENSITY)
PASSAGE = LENGTH / WAVE


def test_the_exact_mass_parts_when_the_textbooks_say():
    """Timoshenko & Goodier, Theory of Elasticity, section on longitudinal impact: 3.068, 4.708, 5.900 L / c."""
    for ratio, parting in ((1.0, 3.068), (2.0, 4.708), (4.0, 5.900)):
        assert struck(ratio, 6.1).partings[0] == pytest.approx(parting, abs=2e-3)
    assert struck(2.0, 2.0).pressure[-3] == pytest.approx(np.exp(-1.0), rel=1e-3)  # before the wave is back
    assert struck(4.0, 8.0).partings == pytest.approx((5.900, 6.657), abs=2e-3)  # the wave that comes back then meets it again


def blow(folder, points, ratio, until):
    """Times [L / c], speed [V] and mean force [rho c V A] at them, and the result."""
    side = 3 * LENGTH / (points - 1)
    vertices, faces = shapes.cube(4, 0.0)
    mass = ratio * DENSITY * LENGTH * side**2
    hammer = {"name": "hammer", "size": [side, 2 * side, 2 * side], "point": [-side / 2, side / 2, side / 2], "velocity": [SPEED, 0.0, 0.0]}
    hammer |= {"motion": "free", "mass": mass, "guide": [1.0, 0.0, 0.0], "friction": 0.0}
    material = {"model": "solid", "youngs_modulus": MODULUS, "poissons_ratio": 0.0, "density": DENSITY}
    scene = meshed(
        folder, (vertices * [LENGTH, side, side], faces), lattice={"points": [points, 4, 4], "size": [LENGTH, side, side]},
        material=material, pin=[{"name": "end", "points": "x+"}], box=[hammer], energy=True, reactions=True,
        stop_time=until * PASSAGE, communication_step=PASSAGE / 50,
    )  # fmt: skip
    result = simulate(scene)
    force = vector(result, "box.hammer.reaction")[:, 0]
    speed = vector(result, "box.hammer.velocity")[:, 0]
    given = np.diff(speed) * mass / (PASSAGE / 50)
    assert force[1:] == pytest.approx(given, abs=1e-9 * np.abs(force).max())
    energy = result.outputs["energy.kinetic"] + result.outputs["energy.elastic"]
    assert energy.max() <= energy[0] * (1 + 1e-9)
    return result.time / PASSAGE, speed / SPEED, -force / (DENSITY * WAVE * SPEED * side**2)


MESHES = {13: (0.090, 0.067, 0.04), 22: (0.062, 0.022, 0.025), 31: (0.046, 0.012, 0.016)}
"""Points along the bar, and by how much the speed is off at most and at the end, by that of the blow, and the parting, by the exact one.
The nodes of the struck face stop at once and lose their energy, as they do on a wall: that is of the mesh, less the heavier the mass is."""

PARTS = {0.5: 2.5046, 1.0: 3.0677, 2.0: 4.7086, 4.0: 6.6573}
"""By mass over that of the bar, in L / c; a touch of 1 % of the impulse, with the mass of 1 from 4.2 to 4.3 L / c, is not counted"""


@pytest.mark.short("4.0")
@pytest.mark.parametrize("ratio", PARTS)
def test_the_mass_moves_and_parts_as_the_waves_say(ratio, tmp_path):
    exact, off = struck(ratio, 7.2), []
    for points, (most, last, parts) in MESHES.items():
        time, speed, force = blow(tmp_path, points, ratio, 7.2)
        errors = np.abs(speed - np.interp(time, exact.time, exact.speed))
        assert errors.max() < most and errors[-1] < last
        pressed = time[(force > 1e-3) & (time < 1.2 * PARTS[ratio])]
        assert pressed[-1] == pytest.approx(PARTS[ratio], rel=parts)
        off.append(errors.mean())
    assert off[0] > 1.4 * off[1] and off[1] > off[2]
