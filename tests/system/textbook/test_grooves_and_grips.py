"""A block in a groove, pressed on a wall by a push, and held between two plates: what presses it decides whether it slides."""

import numpy as np
import pytest

from rigid import G, slide
from textbook import SMALL, Case, Motion, along, block, called, require_right

CUBICLE = ((0.2, 0.2, 0.2), (3, 3, 3))


def grooved(of, stiffness, step, *, friction=0.3, speed=1.0, stop=0.5, **keys):
    """A block lies with two faces in a groove of 90 degrees along y and slides along it: each wall presses with its weight / sqrt(2)."""
    name = f"groove-{of}-k{stiffness:.0e}-H{step:g}-mu{friction:g}"
    side = np.sqrt(0.5)
    walls = [{"name": n, "normal": [s * side, 0.0, side], "friction": friction} for n, s in (("left", 1.0), ("right", -1.0))]
    scene = block(
        SMALL, stiffness=stiffness, step=step, on="surface" if of == "surface" else "plane", stop_time=stop, velocity=[0.0, speed, 0.0],
        rotation={"axis": [0.0, 1.0, 0.0], "degrees": 45.0}, **keys,
    )  # fmt: skip
    (a, _, c), _ = SMALL
    # its lowest edge, which the rotation about the centre takes from the lower corner at +x, to the origin
    corner = np.array([side * a / 2 - side * c / 2, 0.0, -side * a / 2 - side * c / 2])
    scene |= {"plane": walls, "offset": (-corner - np.array([0.0, 0.0, c / 2])).tolist()}
    return Case(
        called(name, keys), scene, lambda t, b: along(slide(t, speed=speed, grip=np.sqrt(2) * friction * G), b.at(-corner[0]), axis=1)
    )


def pressed(of, stiffness, step, *, rest=24.0, fade=0.0, friction=0.5, stop=0.6, **keys):
    """A block on a wall, which a push along x presses on it, N a kilogram: it stays, or slips down where the push fades."""
    name = f"wall-{of}-k{stiffness:.0e}-H{step:g}-push{rest:g}-{fade:g}"
    kilograms = keys.get("kilograms", 1.0)
    scene = block(
        SMALL, stiffness=stiffness, step=step, on=of, stop_time=stop, load=[{"name": "push", "points": "all"}],
        below={"friction": friction}, gravity=[G, 0.0, 0.0], **keys,
    )  # fmt: skip
    push = lambda t: rest - fade * t  # noqa: E731
    return Case(called(name, keys), scene, lambda t, b: along(slide(t, grip=lambda s: friction * push(s), push=G), b),
        inputs=lambda t: {"load.push.z": -kilograms * push(t)},
    )  # fmt: skip


def gripped(modulus, step, *, strain=1e-3, lift=0.0, gravity=G, friction=0.5, stop=0.4, density=1000.0, **keys):
    """A cube between two plates, squeezed by this strain and free to the sides from the start: each presses with E A strain. Where
    friction holds its weight it goes with the plates, at the speed `lift`, else it slips."""
    size, _ = CUBICLE
    side = size[0]
    mass, force = density * side**3, modulus * side**2 * strain
    name = f"grip-E{modulus:.0e}-H{step:g}-mu{friction:g}-lift{lift:g}"
    scene = block(CUBICLE, stiffness=0.0, step=step, stop_time=stop, gravity=[0.0, 0.0, -gravity])
    half = side / 2 * (1 - strain)
    del scene["stiffness"], scene["mass"], scene["damping"]
    plates = [
        {"name": n, "point": [s * half, 0.0, 0.0], "normal": [-s, 0.0, 0.0], "friction": friction, "velocity": [0.0, 0.0, lift]}
        for n, s in (("left", -1.0), ("right", 1.0))
    ]
    scene |= {
        "plane": plates, "material": {"youngs_modulus": modulus, **keys}, "mass": {"density": density, "distribution": "box"},
        "stretch": [1 - strain, 1 + strain / 4, 1 + strain / 4], "offset": [-side / 2 * strain, side / 8 * strain, 0.0],
        "velocity": [0.0, 0.0, lift],
    }  # fmt: skip
    scene["plane"], up = plates, side / 8 * strain

    def motion(t, b):
        way = slide(t, grip=2 * friction * force / mass, push=-gravity)
        centre = np.full((len(t), 3), np.nan)
        centre[:, 2] = b.centre[2] + up + lift * t + way
        return Motion(centre)

    return Case(called(name, keys), scene, motion)


CASES = [
    *(grooved("lattice", k, H) for k in (1e6, 1e8) for H in (0.01, 0.1)),
    *(grooved("surface", k, H) for k in (1e5, 1e7) for H in (0.02, 0.1)),
    grooved("lattice", 1e5, 0.05, internal_damping=1e-3),
    *(pressed("plane", k, H) for k in (1e7, 1e9) for H in (0.02, 0.1)),
    *(pressed(on, 1e6, 0.02, internal_damping=1e-4, stop=0.4) for on in ("surface", "box")),
    *(pressed("plane", k, H, fade=30.0) for k in (1e6, 1e7, 1e9) for H in (0.02, 0.1)),
    *(pressed(on, 1e6, 0.05, fade=30.0, stop=0.5, internal_damping=1e-4) for on in ("surface", "box", "disk")),
    pressed("plane", 1e4, 0.2, fade=30.0, kilograms=0.01),
    pressed("plane", 1e5, 0.05, fade=30.0, kilograms=0.1, internal_damping=1e-3),
    *(gripped(1e7, H, strain=1e-4, friction=f) for f in (0.02, 3.0) for H in (0.01, 0.1)),
    *(gripped(1e7, H, strain=1e-4, lift=0.3, friction=f) for f in (0.02, 3.0) for H in (0.02, 0.1)),
    gripped(1e7, 0.05, strain=1e-4, friction=3.0, lift=0.3, internal_damping=1e-4),
    gripped(1e6, 0.05, friction=0.02, internal_damping=1e-4),
]


@pytest.mark.short("groove-lattice-k1e+08-H0.1*", "wall-plane-k1e+09-H0.1*", "grip-E1e+07-H0.1-mu0.02*")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_block_slides_where_what_presses_it_is_too_weak(case, tmp_path):
    require_right(case, tmp_path)
