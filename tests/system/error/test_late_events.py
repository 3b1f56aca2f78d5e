"""What begins at a communication point, after a time in which any step was accurate: loads on a body at rest, and an impact. Two masses in
a row on springs along z have closed forms."""

import numpy as np
import pytest

from scenes import GRAVITY, box
from softffd import simulate
from textbook import stated

STIFFNESS, HELD, TOLERANCE = 1e3, 4e3, 1e-6
OMEGA, STEP = np.sqrt(8e3), 0.01
FINE = {"solver.method": "leapfrog", "solver.step": 4e-6}
IN_A_ROW = {"points": [2, 2, 2], "damping": 0.0, "tolerance": TOLERANCE}


def ramp(time, begin, end, force):
    """The motion that a force sets off which grows from 0 in this time [m]."""
    since = np.maximum(time[:, None] - [begin, end], 0.0)
    return force / HELD / (end - begin) * (since - np.sin(OMEGA * since) / OMEGA) @ [1, -1]


def step(time, begin, force):
    return force / HELD * (1 - np.cos(OMEGA * np.maximum(time - begin, 0.0)))


def sine(time):
    """The motion under 40 N sin(omega t), which is linear between communication points."""
    force = 40 * np.sin(OMEGA * time)
    return sum(ramp(time, begin, begin + STEP, more) for begin, more in zip(time[:-1], np.diff(force), strict=True))


@pytest.mark.parametrize(
    ("force", "exact", "interpolation"),
    [
        (lambda t: 100.0 * (t > 0.295), lambda time: step(time, 0.3, 100.0), "held"),
        (lambda t: 0.01 + 99.99 * (t > 0.295), lambda time: step(time, 0.0, 0.01) + step(time, 0.3, 99.99), "held"),
        (lambda t: 100 * np.clip(100 * (t - 0.3), 0, 1), lambda time: ramp(time, 0.3, 0.31, 100.0), "linear"),
        (lambda t: 100 * np.clip((t - 0.3) / 0.3, 0, 1), lambda time: ramp(time, 0.3, 0.6, 100.0), "linear"),
        (lambda t: 40 * np.sin(OMEGA * t), sine, "linear"),
    ],
    ids=["step", "larger step", "steep ramp", "ramp", "resonance"],
)
@pytest.mark.parametrize("factor", [1, 1000])
def test_a_load_that_comes_later(force, exact, interpolation, factor):
    stiffness = {"edge": STIFFNESS, "face": 0.0, "body": 0.0}
    held = {"pin": [{"name": "wall", "points": "z-"}], "load": [{"name": "pull", "points": "z+"}]}
    scene = box(**IN_A_ROW | {"tolerance": factor * TOLERANCE}, stiffness=stiffness, **held)
    result = simulate(scene, stop_time=1.0, step=STEP, inputs=lambda t: {"load.pull.z": float(force(t))}, interpolation=interpolation)
    assert np.abs(result.positions[:, 0, 0, 1, 2] - 1 - exact(result.time)).max() < 3 * factor * TOLERANCE


def test_a_pin_that_begins_to_move_and_stops():
    """At 1 m/s, from 0.3 s to 0.6 s."""
    wall = {"name": "wall", "points": "z-", "motion": "input", "inputs": ["position", "velocity"]}
    scene = box(**IN_A_ROW, stiffness={"edge": STIFFNESS, "face": 0.0, "body": 0.0}, pin=[wall])
    moves = {"pin.wall.velocity.z": lambda t: float(0.295 < t < 0.595), "pin.wall.position.z": lambda t: np.clip(t - 0.3, 0.0, 0.3)}
    result = simulate(scene, stop_time=1.0, step=STEP, inputs=lambda t: {name: at(t) for name, at in moves.items()})
    begun, stopped = (np.maximum(result.time - at, 0.0) for at in (0.3, 0.6))
    exact = begun - np.sin(OMEGA * begun) / OMEGA - (stopped - np.sin(OMEGA * stopped) / OMEGA)
    assert np.abs(result.positions[:, 0, 0, 1, 2] - 1 - exact).max() < 3 * TOLERANCE


@pytest.mark.parametrize(("stiffness", "length"), [(1e4, 0.01), (1e5, 0.05), (1e6, 0.1), (1e8, 0.1)])
def test_an_impact_at_a_communication_point(stiffness, length):
    """The two masses come at 1 m/s and leave the plane after half a period: with half a metre per second and half the energy."""
    stiff = {"edge": stiffness, "face": 0.0, "body": 0.0}
    scene = box(**IN_A_ROW, stiffness=stiff, plane=[{"name": "ground", "point": [0.0, 0.0, -0.1]}], velocity=[0.0, 0.0, -1.0])
    result = simulate(scene, stop_time=1.0, step=length)
    height = 0.4 + 0.5 * (0.9 - np.pi / np.sqrt(8 * stiffness))
    assert abs(result.positions[-1, 0, 0, :, 2].mean() - height) < 10 * TOLERANCE
    assert -length * result.outputs["plane.ground.reaction.z"].sum() == pytest.approx(1.5, abs=1e-5)


@pytest.mark.parametrize("height", [-0.2, -5.0])
def test_a_stiff_body_that_never_comes_to_its_plane_is_integrated_as_without(height):
    """It is pulled at both ends; half a force per mass and communication step squared is farther than any plane."""
    stiff, loads = {"edge": 1e8, "face": 0.0, "body": 0.0}, [{"name": "up", "points": "z+"}, {"name": "down", "points": "z-"}]
    ends = []
    for plane in ([], [{"name": "far", "point": [0.0, 0.0, height]}]):
        scene = box(**IN_A_ROW, stiffness=stiff, load=loads, plane=plane)
        ends.append(simulate(scene, stop_time=1.0, step=STEP, inputs={"load.up.z": 2e6, "load.down.z": -2e6}).positions[-1])
    assert np.abs(ends[0] - ends[1]).max() < TOLERANCE
    assert ends[1][0, 0, 1, 2] - 1 == pytest.approx(2e6 / 8e8 * (1 - np.cos(4e4)), abs=TOLERANCE)


@pytest.mark.parametrize("velocity", [0.0, -10.0])
def test_a_floor_that_is_taken_away_sets_vibrations_free(velocity):
    """An undamped cube is laid on the floor. While weight presses the cube on, steps damp what cannot move it. Then the cube falls with
    what it had: 42 tolerances apart, and that is stated."""
    floor = {"name": "floor", "friction": 0.4, "motion": "input", "inputs": ["point", "velocity"]}
    mass = {"total": 1.0}
    body = box(size=[0.2] * 3, mass=mass, stiffness=1e5, damping=0.0, gravity=GRAVITY, plane=[floor], outputs={"solver": True})

    def moves(time):
        since = time - 0.195
        return {
            "plane.floor.point.z": -10.0 * (max(since, 0.0) if velocity else since > 0),
            "plane.floor.velocity.z": velocity * (since > 0),
        }

    runs = [simulate(body, stop_time=0.5, step=STEP, inputs=moves, start_values=values) for values in ({}, FINE)]
    error = np.abs(runs[0].positions[-1] - runs[1].positions[-1]).max()
    assert error > 10 * 1e-4 * 0.2
    assert error / 3 < stated(runs[0])[-1] < 3 * error
