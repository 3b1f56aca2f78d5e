"""A block laid on a belt is dragged to its speed by mu m g; on belts that turn round it sticks and slides by turns."""

import numpy as np
import pytest

from rigid import STILL, Belt, G, slide
from softffd.names import OBSTACLES
from textbook import BRICK, CUBE, SMALL, Case, along, block, called

BODIES = {"cube": CUBE, "brick": BRICK, "small": SMALL}
COURSES = {
    "flips": lambda t: 0.5 if np.floor(t / 0.4 + 1e-9) % 2 == 0 else -0.5,
    "swings": lambda t: 0.4 * np.sin(2 * np.pi * t / 0.8),
    "gentle": lambda t: 0.15 * np.sin(2 * np.pi * t / 0.8),
}
"""m/s; a gentle one never takes more than the friction gives"""


def laid(body, on, stiffness, step, speed, *, friction=0.25, stop=1.0, **keys):
    name = f"{body}-{on}-k{stiffness:.0e}-H{step:g}-laid-v{speed:g}"
    below = {"friction": friction, "velocity": [speed, 0.0, 0.0]}
    scene = block(BODIES[body], stiffness=stiffness, step=step, on=on, below=below, stop_time=stop, **keys)
    belt = Belt(np.zeros(1), np.array([speed]))
    return Case(called(name, keys), scene, lambda t, b: along(slide(t, grip=friction * G, belt=belt), b))


def turning(body, on, stiffness, step, course, *, friction=0.25, stop=1.2, linear=True, **keys):
    """With the speed of the belt linear between communication points, or held."""
    held = "" if linear else "-held"
    name = f"{body}-{on}-k{stiffness:.0e}-H{step:g}-{course}{held}"
    below = {"friction": friction, "motion": "input", "inputs": ["velocity.x"]}
    scene = block(BODIES[body], stiffness=stiffness, step=step, on=on, below=below, stop_time=stop, **keys)
    speed, times = COURSES[course], np.arange(0.0, stop + step / 2, step)
    belt = Belt(times, np.array([speed(t) for t in times]), linear)
    moved = [f"{kind}.{each['name']}.velocity.x" for kind in OBSTACLES for each in scene.get(kind, ())]
    return Case(called(name, keys), scene, lambda t, b: along(slide(t, grip=friction * G, belt=belt), b),
        inputs=lambda t: dict.fromkeys(moved, speed(t)), interpolation="linear" if linear else "held",
    )  # fmt: skip


CASES = [
    laid("cube", "plane", 1e5, 0.05, 9.0),
    *(laid("cube", "plane", k, H, 9.0, stop=0.6) for k in (1e4, 1e6, 1e9) for H in (0.01, 0.1)),
    *(laid("brick", "plane", k, H, 1.0, kilograms=min(1.0, k / 1e6)) for k in (1e5, 1e7, 1e9) for H in (0.005, 0.05, 0.2)),
    *(laid("small", on, k, 0.05, 0.8, stop=0.5, kilograms=k / 1e7) for on in ("surface", "box", "disk", "rails") for k in (1e5, 1e7)),
    *(turning("brick", "plane", k, H, c) for c in ("swings", "gentle") for k in (1e7, 1e9) for H in (0.02, 0.1)),
    *(turning("brick", "plane", 1e4, H, c, kilograms=1e-3) for c in ("swings", "gentle") for H in (0.01, 0.05)),
    *(turning("brick", "plane", k, H, "flips", linear=False) for k in (1e6, 1e7, 1e9) for H in (0.02, 0.1, 0.2)),
    *(turning("small", on, 1e7, 0.05, c, stop=0.8) for on in ("surface", "disk") for c in ("swings", "gentle")),
    *(turning("small", on, 1e6, 0.1, "flips", stop=0.8, linear=False) for on in ("box", "rails")),
    *(laid("small", on, 1e5, 0.05, 0.8, stop=0.4, internal_damping=1e-3) for on in ("plane", "box")),
]


@pytest.mark.short("cube-plane-k1e+05-H0.05-laid*", "brick-plane-k1e+09-H0.1-flips*", "small-disk-k1e+07-H0.05-swings")
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_belt_drags_a_block_as_friction_has_it(case, holds):
    holds(case)


def test_what_sticks_and_slides_is_summed_rightly():
    """The closed forms' own: to rest, loose under a growing push, and along with a belt."""
    t = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(slide(t, speed=2.0, grip=3.0)[-1], 4 / 6, rtol=1e-9)
    np.testing.assert_allclose(slide(t, grip=4.0, push=lambda s: 12 * s)[-1], 2 * (1 - 1 / 3) ** 3, rtol=1e-7)
    np.testing.assert_allclose(slide(t, grip=4.0, belt=Belt(np.zeros(1), np.ones(1)))[-1], 1 - 1 / 8, rtol=1e-8)
    np.testing.assert_allclose(slide(t, speed=-1.0, grip=2.0, push=3.0)[-1], -0.1 + 0.8**2 / 2, rtol=1e-8)
    assert slide(t, grip=4.0, push=-3.9, belt=STILL)[-1] == 0
