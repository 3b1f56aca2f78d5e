"""Damped bodies in contact, which `auto` takes implicitly: places and reactions against explicit runs of a far smaller tolerance, sliding
and rest against closed forms, momentum, energy, states. One pad of rubber's kind, 0.1 x 0.1 x 0.05 m, rests, slides, is pressed or led."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from readings import centre, imbalance, points, vector, velocities
from scenes import GRAVITY, box, meshed
from softffd import Scene, package_fmu, simulate
from softffd.fmu.package import scene_masses
from stepping import Stepper, require_same_continuation
from validation import shapes as bodies

G, MASS, FRICTION = 9.81, 0.5, 0.5
TOLERANCE = 1e-4 * 0.1
"""m; the default of solver.tolerance for these bodies"""
EXPLICIT = {"solver.method": "leapfrog", "solver.tolerance": 1e-6}
GROUND = {"name": "ground", "friction": FRICTION}
PAD = {"size": [0.1, 0.1, 0.05], "origin": [0.0, 0.0, 0.0], "mass": {"total": MASS}, "damping": 0.0, "plane": [GROUND]}
OBSERVED = {"velocities": "all", "reactions": True, "energy": True, "outputs": {"solver": True}}
TOP = {"name": "top", "points": "z+"}
LEADING = [f"pin.top.{what}.{axis}" for what in ("position", "velocity") for axis in "xyz"]

Path = Callable[[float], np.ndarray]


def pad(tau: float, stiffness: float = 1e6, **keys) -> Scene:
    """A pad on the ground; tau: of its dashpots [s]."""
    material = {"stiffness": stiffness, "internal_damping": tau}
    return box(**PAD | OBSERVED | {"gravity": GRAVITY, "communication_step": 0.01, "stop_time": 1.0, "material": material} | keys)


def led(tau: float) -> Scene:
    """Its upper face is an input, and it has no weight."""
    return pad(tau, gravity=[0.0, 0.0, 0.0], pin=[TOP | {"motion": "input"}])


def lead(body: Stepper, path: Path, until: float, H: float) -> tuple[np.ndarray, np.ndarray]:
    """Places (T, n, 3) [m] and reactions of the ground (T, 3) [N] of communication steps of H [s], the upper face along a path."""
    rows = []
    for _ in range(round((until - body.time) / H)):
        begin, end = path(body.time), path(body.time + H)
        body.set(dict(zip(LEADING, [*begin, *(end - begin) / H], strict=True)))
        body.step(H)
        rows.append((body.points(), body.vector("plane.ground.reaction")))
    return np.array([x for x, _ in rows]), np.array([f for _, f in rows])


# ---- rest, slide, press, led pad ----


def waving(grid: float, until: float = 0.05) -> Path:
    """Pressed down by 0.2 mm in the first 10 ms and led to and fro by 1 mm at 20 Hz, straight between the multiples of grid [s]."""
    times = np.arange(0.0, until + 1.5 * grid, grid)
    sideways, down = 0.001 * np.sin(2 * np.pi * 20 * (times if grid < 0.05 else 0.25 * times)), 0.0002 * np.minimum(times / 0.01, 1)
    return lambda time: np.array([0.05 + np.interp(time, times, sideways), 0.05, 0.05 - np.interp(time, times, down)])


CELLS = {
    "rest": lambda tau: pad(tau),
    "slide": lambda tau: pad(tau, velocity=[0.3, 0.0, 0.0]),
    "press": lambda tau: pad(tau, load=[{"name": "push", "points": "z+"}]),
    "pad": led,
}


def run_cell(kind: str, tau: float, grid: float, until: float, H: float, **start) -> tuple[np.ndarray, np.ndarray]:
    with Stepper(CELLS[kind](tau), start_values=start) as body:
        if kind == "pad":
            return lead(body, waving(grid), until, H)
        if kind == "press":
            body.set({"load.push.z": -500.0})
        rows = [(body.step(H), body.points(), body.vector("plane.ground.reaction")) for _ in range(round(until / H))]
        return np.array([x for _, x, _ in rows]), np.array([f for _, _, f in rows])


@cache
def explicit_cell(kind: str, tau: float, grid: float, until: float) -> tuple[np.ndarray, np.ndarray]:
    """At every ms."""
    return run_cell(kind, tau, grid, until, 1e-3, **EXPLICIT)


@pytest.mark.short("rest-0.0001-0.0[15]", "press-0.0001-*", "pad-0.001-0.01", "pad-0.0001-0.01")
@pytest.mark.parametrize("H", [0.001, 0.01, 0.05])
@pytest.mark.parametrize("tau", [1e-4, 1e-3])
@pytest.mark.parametrize("kind", CELLS)
def test_places_keep_the_tolerance_and_mean_reactions_a_hundredth(kind, tau, H):
    """The strongly damped ones over a short stretch: explicit steps are slow there."""
    until = 0.01 if tau == 1e-3 and H < 0.05 else 0.05
    grid = max(H, 0.01) if kind == "pad" else 0.01
    x, f = explicit_cell(kind, tau, grid, until)
    every = round(H / 1e-3)
    places, reactions = run_cell(kind, tau, grid, until, H)
    mean = f.reshape(-1, every, 3).mean(axis=1)
    assert np.abs(places - x[every - 1 :: every]).max() < TOLERANCE
    assert np.abs(reactions - mean).max() < 0.01 * np.abs(mean).max()


def test_mean_reactions_keep_a_hundredth_where_the_pad_slips_and_sticks_again_and_again():
    """Two swings: 1.6 % off in the second when two runs of a step that both step over the slip were taken at their word."""
    with Stepper(led(1e-4), start_values=EXPLICIT) as exact, Stepper(led(1e-4)) as body:
        (_, f), (_, reactions) = (lead(each, waving(5e-3, 0.1), 0.1, 5e-3) for each in (exact, body))
    assert np.abs(reactions - f).max() < 0.01 * np.abs(f).max()


# ---- stick and slip ----


def reversing(time: float) -> np.ndarray:
    """Pressed down by 0.2 mm in 5 ms, then led at 0.1 m/s, from 20 ms on back."""
    return np.array([0.05 + 0.1 * (np.clip(time - 0.005, 0.0, 0.015) - max(time - 0.02, 0.0)), 0.05, 0.05 - 0.0002 * min(time / 0.005, 1)])


def slipping(tau: float, **start) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Reactions while it slides to and fro, (T, 3) each [N], and the moments when its lowest points begin to slide back [s]."""
    with Stepper(led(tau), start_values=start) as body:
        lead(body, reversing, 0.016, 2e-3)
        _, to = lead(body, reversing, 0.02, 1e-3)
        x, _ = lead(body, reversing, 0.024, 1e-4)
        _, fro = lead(body, reversing, 0.04, 1e-3) if not start else (None, np.zeros((1, 3)))
    sunk = x[:, :16, 0].max(axis=0) - x[:, :16, 0]
    after = np.arange(len(x)) >= x[:, :16, 0].argmax(axis=0)[:, None]
    moments = [0.02 + 1e-4 * (1 + np.interp(2e-6, back[late], np.flatnonzero(late))) for back, late in zip(sunk.T, after, strict=True)]
    return to, fro[-8:], np.array(moments)


@pytest.mark.short("0.0001")
@pytest.mark.parametrize("tau", [1e-4, 1e-3])
def test_a_led_pad_slides_at_the_cone_and_begins_to_slide_back_when_it_should(tau):
    to, fro, moments = slipping(tau)
    for reaction, sign in ((to, 1), (fro, -1)):
        assert np.abs(sign * reaction[:, 0] / (-FRICTION * reaction[:, 2]) - 1).max() < 1e-6
    *_, exact = slipping(tau, **EXPLICIT)
    assert 0.02 < exact.min() < exact.max() < 0.0239
    assert np.abs(moments - exact).max() < 1e-4


DAMPED = pytest.mark.parametrize("tau", [1e-5, 1e-4, 1e-3, 1e-2])


@DAMPED
def test_a_sliding_pad_stops_where_friction_stops_it(tau):
    scene = pad(tau, velocity=[0.3, 0.0, 0.0], stop_time=0.5)
    result, start = simulate(scene), 0.5 * MASS * 0.3**2
    way = np.einsum("tpc,p->tc", points(result), scene_masses(scene).mass / MASS)
    assert way[-1, 0] - way[0, 0] == pytest.approx(0.3**2 / (2 * FRICTION * G), abs=TOLERANCE)
    assert vector(result, "plane.ground.reaction")[-1] == pytest.approx([0.0, 0.0, -MASS * G], abs=1e-6 * MASS * G)
    assert result.outputs["energy.dissipated"][-1] == pytest.approx(start, rel=1e-3)  # and what its weight squeezes in
    assert np.abs(way[-20:] - way[-1]).max() < 1e-12
    if tau == 1e-4:  # what its weight sets ringing is no error of its way
        assert result.outputs["solver.steps"][-1] + result.outputs["solver.rejected"][-1] < 130


@DAMPED
def test_below_the_cone_a_pushed_pad_does_not_creep(tau):
    with Stepper(pad(tau, load=[{"name": "push", "points": "all"}])) as body:
        body.step(0.1)
        body.set({"load.push.x": 0.9 * FRICTION * MASS * G})
        body.step(0.5)
        before = body.points()
        body.step(1.0, times=10)
        assert np.abs(body.points() - before).max() < 1e-8
        assert body.vector("plane.ground.reaction") == pytest.approx([0.9 * FRICTION * MASS * G, 0.0, -MASS * G], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("tau", [1e-4, 1e-3])
def test_a_belt_does_twice_the_work_that_the_pad_keeps(tau):
    result = simulate(pad(tau, plane=[GROUND | {"velocity": [0.3, 0.0, 0.0]}], stop_time=0.3))
    kept = 0.5 * MASS * 0.3**2
    assert centre(velocities(result))[-1] == pytest.approx([0.3, 0.0, 0.0], abs=1e-6)
    assert result.outputs["energy.work"][-1] == pytest.approx(2 * kept, rel=1e-3)
    assert np.abs(imbalance(result)).max() < 1e-6 * kept


# ---- drops, momentum, energy ----

FALLS = {
    "flat": {"offset": [0.0, 0.0, 0.005], "velocity": [0.3, 0.0, 0.0]},
    "tilted": {"offset": [0.0, 0.0, 0.03], "rotation": {"axis": [1.0, 0.4, 0.0], "degrees": 25.0}, "velocity": [0.3, 0.0, -1.0]},
}


@cache
def dropped(fall: str, tau: float, **start):
    stiffness = 1e5 if fall == "flat" else 3e4
    return simulate(pad(tau, stiffness, stop_time=0.06, **FALLS[fall]), start_values={f"solver.{key}": start[key] for key in start})


DROPS = [(fall, tau) for fall in FALLS for tau in (1e-3, 1e-4, 1e-5, 1e-6)]


@pytest.mark.short("flat-0.001-*", "flat-1e-05-*", "tilted-0.0001-*", "tilted-1e-06-*")
@pytest.mark.parametrize("method", ["auto", "sdirk2"])
@pytest.mark.parametrize(("fall", "tau"), DROPS)
def test_a_dropped_pad_rebounds_as_in_explicit_steps(fall, tau, method):
    exact, result = points(dropped(fall, tau, method="leapfrog", tolerance=1e-6)), points(dropped(fall, tau, method=method))
    assert np.abs(result - exact).max() < 10 * TOLERANCE


@pytest.mark.full
@pytest.mark.parametrize("velocity", [[0.3, 0.0, 0.0], [0.0, 0.0, -1.0]], ids=["by its weight", "thrown down"])
@pytest.mark.parametrize("stiffness", [1e4, 1e6])
@pytest.mark.parametrize("tau", [1e-3, 1e-4, 1e-5, 1e-6])
def test_auto_keeps_the_tolerance_in_drops_and_warns_of_nothing(tau, stiffness, velocity):
    scene = pad(tau, stiffness, stop_time=0.06, offset=[0.0, 0.0, 0.005], velocity=velocity)
    exact, result = simulate(scene, start_values={"solver.method": "leapfrog", "solver.tolerance": 1e-6}), simulate(scene)
    assert np.abs(points(result) - points(exact)).max() < TOLERANCE
    assert not [each for each in result.log if each.status]


@pytest.mark.short("flat-0.001", "flat-1e-05", "tilted-0.0001", "tilted-1e-06")
@pytest.mark.parametrize(("fall", "tau"), DROPS)
def test_its_energy_never_grows_and_is_accounted_for(fall, tau):
    result = dropped(fall, tau, method="auto")
    stored = sum(result.outputs[f"energy.{part}"] for part in ("kinetic", "elastic", "gravity"))
    assert (stored - stored[0]).max() < 1e-9 * stored[0]
    assert np.abs(imbalance(result)).max() < 1e-3 * stored[0]
    assert result.outputs["energy.dissipated"][-1] > 0


@pytest.mark.parametrize("fall", FALLS)
def test_what_the_ground_receives_is_what_a_dropped_pad_loses(fall):
    result = dropped(fall, 1e-4, method="auto")
    gained = np.diff(np.einsum("p,tpc->tc", scene_masses(result.scene).mass, velocities(result)), axis=0) - 0.01 * MASS * np.array(GRAVITY)
    assert np.abs(gained + 0.01 * vector(result, "plane.ground.reaction")[1:]).max() < 1e-10


def test_what_ground_and_pin_receive_is_what_a_led_pad_loses():
    with Stepper(led(1e-3)) as body:
        mass, before = scene_masses(led(1e-3)).mass, np.zeros(3)
        for end in np.arange(0.002, 0.041, 0.002):
            lead(body, reversing, end, 2e-3)
            received = body.vector("plane.ground.reaction") + body.vector("pin.top.reaction")
            now = mass @ body.point_velocities()
            assert np.abs(now - before + 0.002 * received).max() < 1e-10
            before = now


# ---- what bodies and scenes may have, and may change ----


def skinned(folder, **keys) -> Scene:
    """A cube whose surface touches, in [0, 1]^3 m."""
    material = {"youngs_modulus": 6e6, "internal_damping": 1e-3}
    start = {"gravity": GRAVITY, "velocity": [0.3, 0.0, 0.0], "offset": [0.0, 0.0, 0.001], "plane": [GROUND], "mass": {"density": 100.0}}
    return meshed(folder, bodies.cube(4, 0.0), material=material, **start, **OBSERVED, **keys)


THROWN = {"velocity": [0.3, 0.0, 0.0], "offset": [0.0, 0.0, 0.002]}
LID = {"name": "lid", "friction": 0.3, "point": [0.0, 0.0, 0.0499], "normal": [0.0, 0.0, -1.0]}
STIFF_SOLE = {"points": "z-", "stiffness": 1e6, "internal_damping": 1e-4}
PARTS = {
    "sliding": lambda _, **keys: pad(1e-3, 1e5, velocity=[0.3, 0.0, 0.0], **keys),
    "pinned on a belt": lambda _, **keys: pad(1e-3, 1e5, pin=[TOP], plane=[GROUND | {"velocity": [0.05, 0.0, 0.0]}], **keys),
    "regions": lambda _, **keys: pad(1e-3, 1e5, region=[STIFF_SOLE], **THROWN, **keys),
    "volume": lambda _, **keys: pad(1e-3, material={"stiffness": 1e5, "internal_damping": 1e-3, "volume_stiffness": 1e5}, **THROWN, **keys),
    "between planes": lambda _, **keys: pad(1e-3, 1e5, velocity=[0.3, 0.0, 0.0], plane=[GROUND, LID], **keys),
    "spline": lambda _, **keys: pad(1e-3, 1e5, basis="bspline", points=[5, 5, 4], velocity=[0.3, 0.0, 0.0], **keys),
    "surface": skinned,
}
PART = pytest.mark.parametrize("part", PARTS)


def changed_on_the_way(scene: Scene, change: dict[str, float], **start) -> tuple[np.ndarray, np.ndarray]:
    with Stepper(scene, start_values=start) as body:
        rows = []
        for values in ({}, change):
            body.set(values)
            for _ in range(4):
                body.step(0.005)
                rows.append((body.points(), body.vector("plane.ground.reaction")))
        return np.array([x for x, _ in rows]), np.array([f for _, f in rows])


@pytest.mark.short("pinned on a belt", "regions", "surface")
@PART
def test_tunable_parameters_may_change_in_contact(part, tmp_path):
    scene = PARTS[part](tmp_path)
    stiffer = {"youngs_modulus": 9e6} if part == "surface" else {"stiffness.edge": 2e5, "stiffness.body": 5e4}
    change = {"internal_damping": 3e-4, "plane.ground.friction": 0.2, **stiffer}
    (x, f), (places, reactions) = (changed_on_the_way(scene, change, **start) for start in (EXPLICIT, {}))
    tolerance = TOLERANCE * (10 if part == "surface" else 1)  # ten times the size
    assert np.abs(places - x).max() < tolerance
    assert np.abs(reactions - f).max() < 0.01 * np.abs(f).max()


@PART
def test_auto_takes_implicit_steps(part, tmp_path):
    with Stepper(PARTS[part](tmp_path)) as body:
        body.step(0.01, times=4)
        assert "sdirk2" in dict(body.methods())


@PART
def test_a_state_continues_with_the_same_bits(part, tmp_path):
    require_same_continuation(PARTS[part](tmp_path, communication_step=0.002))


@pytest.mark.parametrize("calls", [10, 20, 30, 40])
def test_a_state_goes_on_with_the_same_bits_where_explicit_steps_take_turns(calls, tmp_path):
    """By what they cost, which does not depend on what an instance has found before."""
    scene = PARTS["surface"](tmp_path, communication_step=0.002)
    with Stepper(scene) as first, Stepper(scene) as second:
        first.step(0.002, times=calls)
        second.restore(bytes(first.save()))
        for each in (first, second):
            each.step(0.002, times=30)
        assert bytes(first.save()) == bytes(second.save())


@pytest.mark.short("pinned on a belt", "surface")
@PART
def test_both_standards_run_it_with_the_same_bits(part, tmp_path):
    scene = PARTS[part](tmp_path, communication_step=0.005, stop_time=0.05)
    two, three = (simulate(package_fmu(scene, tmp_path / f"{fmi}.fmu", fmi=fmi)) for fmi in (2, 3))
    np.testing.assert_array_equal(three.positions, two.positions)
    np.testing.assert_array_equal(vector(three, "plane.ground.reaction"), vector(two, "plane.ground.reaction"))
