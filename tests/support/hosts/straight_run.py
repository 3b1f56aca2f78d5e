"""Two scenes, a schedule of what each step is taken with, and the undisturbed run that any detour has to come back to."""

import random
from collections.abc import Callable
from functools import cache

from c_host import OK, STEP, STEPS, TIMES, Fmu, Host
from scenes import GRAVITY, LED, MOVED, box

RICH = box(
    points=[3, 3, 3],
    stiffness=2e3,
    damping=0.05,
    gravity=GRAVITY,
    plane=[
        {"name": "ground", "normal": [0.0, 0.1, 1.0], "friction": 0.4, **MOVED},
        {"name": "wall", "point": [1.3, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]},
    ],
    pin=[{"name": "grip", "points": [[0, 0, 2]], **LED}],
    load=[{"name": "push", "points": "x+"}],
    forces=[[1, 1, 1]],
    offset=[0.0, 0.0, 0.1],
    velocity=[1.0, 0.0, 0.0],
    probe=[{"name": "tip", "at": [0.5, 0.5, 1.0]}],
    velocities="all",
    energy=True,
    outputs={"solver": True},
)
BARE = box(points=[2, 2, 2], damping=0.0, stretch=[1.1, 1.0, 0.9], method="central_difference")


@cache
def schedule(fmu: Fmu, n: int) -> list[dict[str, float]]:
    """What step n is taken with; each part is one call. Depends on n alone: any route to n is the same.
    Kept, because under another rounding mode the test's own arithmetic gives other numbers."""
    if "load.push.x" not in fmu.names:
        return [{"stiffness.edge": 1000.0 + n}] if n % 7 == 3 else []
    parts = [
        {"load.push.y": 3.0 * (n % 5), "load.push.z": -0.5 * n},
        {"pin.grip.velocity.x": 0.2 + 0.01 * n, "force[1,1,1].z": 0.1 * n},
        {"plane.ground.point.z": 0.001 * n, "plane.ground.velocity.z": 0.1},
    ]
    return parts + ([{"stiffness.face": 2000.0 + n, "gravity.z": -9.0 - 0.1 * n}, {"damping": 0.01 * n}] if n % 6 == 5 else [])


def apply(host: Host, n: int, generator: random.Random | None = None) -> None:
    parts = list(schedule(host.fmu, n))
    if generator:
        generator.shuffle(parts)
    for values in parts:
        assert host.set(values) == OK
    if "load.push.x" in host.fmu.names and host.fmu.interpolates and n % 3 == 1:
        host.set_rates({"load.push.x": 10.0 * n, "plane.ground.velocity.z": -0.5})


def straight(fmu: Fmu, steps: int = STEPS, look: Callable[[Host], bytes] = lambda host: host.outputs()) -> list[bytes]:
    """What a look shows, the outputs, at every communication point of an undisturbed run."""
    host = fmu.host()
    host.begin()
    points = [look(host)]
    for n in range(steps):
        apply(host, n)
        host.must("DoStep", TIMES[n], STEP, 1)
        points.append(look(host))
    host.free()
    return points


def check_straight(host: Host, expected: list[bytes], before_step: Callable[[], None] = lambda: None) -> None:
    """From its start on an instance has these outputs, whatever happens before each step."""
    assert host.outputs() == expected[0]
    for n in range(len(expected) - 1):
        apply(host, n)
        before_step()
        host.must("DoStep", TIMES[n], STEP, 1)
        assert host.outputs() == expected[n + 1]


def check_as_new(host: Host, expected: list[bytes]) -> None:
    host.must("Reset")
    host.begin()
    check_straight(host, expected[:4])
