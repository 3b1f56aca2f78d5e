"""A plate and a soft body, coupled both ways: explicitly, and implicitly by steps that are tried again from saved states."""

from pathlib import Path

import numpy as np
import pytest

from coupled_parts import BODY_MASS, GRAVITY, MECHANICAL, PLANE, REST_ENERGY, body_fmu, run_explicitly
from readings import orders
from scenes import meshed
from softffd import package_fmu
from softffd.fmu.component import Component
from softffd.fmu.package import scene_masses
from stepping import Stepper
from validation import shapes as bodies

MOTION_START = [f"initial.{family}.{axis}" for family in ("point", "velocity") for axis in "xyz"]


def test_momentum_of_plate_and_body_balances_to_rounding(drivers):
    """With friction, a sliding plate, a fall and impacts; the ground's impulse and the weights are part of the balance."""
    nodes = [f"[{i},{j},{k}]" for k in range(4) for j in range(4) for i in range(4)]
    read = [f"plane.ground.reaction.{axis}" for axis in "xyz"] + [f"velocity{node}.{axis}" for node in nodes for axis in "xyz"]
    down = "normal = [0.0, 0.0, -1.0]"
    fmu = body_fmu(drivers, ("energy = true", 'velocities = "all"'), (down, f"{down}\nfriction = 0.5"))
    step, mass = 2e-3, 3.0
    start = {"mass": mass, "initial.point.z": 0.02, "initial.velocity.x": 0.4, "initial.velocity.z": -0.5}
    run = run_explicitly(drivers, fmu, step, 200, body_start={PLANE + "point.z": 0.02}, plate_start=start, read=read)
    rows = np.array(run.rows)
    plate, reaction, ground = rows[:, :3], rows[:, 3:6], rows[:, 6:9]
    body = BODY_MASS / 64 * rows[:, 9:].reshape(len(rows), 64, 3).sum(axis=1)
    steps = np.arange(1, len(rows) + 1)
    weight = np.outer(step * (BODY_MASS * steps + mass * (steps - 1)), [0, 0, -GRAVITY])
    first = mass * np.array([0.4, 0.0, -0.5])
    left = plate + body + step * reaction + step * np.cumsum(ground, axis=0) - weight - first
    assert abs(reaction[:, 0]).max() > 1 and reaction[:, 2].max() > 50  # there was friction and a hard landing
    assert abs(left).max() < 1e-12 * abs(weight).max(), "momenta of some 20 N s, summed over 200 steps"


SOLIDS = {
    "sphere": {"radius": 0.3},
    "cylinder": {"radius": 0.3, "length": 2.0, "normal": [0.0, 1.0, 0.0]},
    "box": {"size": [0.6, 0.6, 0.6], "rotation": {"axis": [1, 2, 0], "degrees": 20.0}},
}


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_solid_that_falls_on_a_body_gives_it_its_momentum(drivers, tmp_path, solid):
    """What moves with the plate is a solid; without gravity on the body all momentum is that of plate, body and the step under way."""
    keys = {"name": "plate", "point": [0.5, 0.5, 1.1], "velocity": [0.0, 0.0, -2.0], "motion": "input", "friction": 0.3}
    scene = meshed(tmp_path, bodies.sphere(3), velocities="all", reactions=True, damping=0.0, **{solid: [keys | SOLIDS[solid]]})
    velocities = [f"velocity[{i},{j},{k}].{axis}" for k in range(4) for j in range(4) for i in range(4) for axis in "xyz"]
    plate = {"mass": 3.0, "gravity.z": 0.0} | dict(zip(MOTION_START, (*keys["point"], *keys["velocity"]), strict=True))
    step = 2e-3
    run = run_explicitly(
        drivers, package_fmu(scene, tmp_path / "body.fmu"), step, 100, plate_start=plate, read=velocities, plate_name=f"{solid}.plate."
    )
    rows = np.array(run.rows)
    body = np.einsum("p,tpa->ta", scene_masses(scene).mass, rows[:, 6:].reshape(len(rows), 64, 3))
    left = rows[:, :3] + body + step * rows[:, 3:6] - [0.0, 0.0, -6.0]
    assert rows[:, 5].max() > 20
    assert abs(left).max() < 1e-12 * 6.0


def energy_error(drivers, fmu, step: float, *, delay: int = 1) -> float:
    """Largest error of energy + losses over 0.5 s, the plate lying on the body from the start [J]."""
    mass, steps = 5.0, round(0.5 / step)
    run = run_explicitly(drivers, fmu, step, steps, plate_start={"delay": delay}, read=[*MECHANICAL, "energy.dissipated"])
    rows = np.array(run.rows)
    arrived = rows[:, 2] / mass
    if delay == 1:  # the momentum put out is that before the step; the step's own impulse is the reaction put out
        before, after = arrived, arrived + step * (rows[:, 5] / mass - GRAVITY)
    else:
        before, after = np.append(0.0, arrived[:-1]), arrived
    height = np.cumsum(0.5 * step * (before + after))
    return abs(0.5 * mass * after**2 + mass * GRAVITY * height + rows[:, 6:].sum(axis=1) - REST_ENERGY).max()


def test_the_energy_error_falls_at_least_with_the_square_of_the_communication_step(drivers):
    fmu = body_fmu(drivers, step=2e-5)
    errors = [energy_error(drivers, fmu, step) for step in (2e-3, 1e-3, 5e-4, 2.5e-4)]
    assert orders(errors).min() > 1.85
    assert errors[1] < 0.002


def test_a_late_reaction_taken_for_that_of_the_step_is_of_first_order_only(drivers):
    fmu = body_fmu(drivers, step=2e-5)
    late = [energy_error(drivers, fmu, step, delay=0) for step in (1e-3, 5e-4, 2.5e-4)]
    assert all(1.0 < order < 1.5 for order in orders(late))
    assert late[0] > 10 * energy_error(drivers, fmu, 1e-3)


def loop_energy_error(fmu: Path, step: float, *, ahead: float) -> float:
    """Largest error of energy + losses over 0.5 s [J] of a loop that sends the velocity `ahead` (share of a step) of the plate's own."""
    mass, z, v, force, errors = 5.0, 0.0, 0.0, 0.0, []
    with Component(fmu) as body:
        moved, reaction = body.block([PLANE + "point.z", PLANE + "velocity.z"]), body.block([PLANE + "reaction.z"])
        energy = body.block([*MECHANICAL, "energy.dissipated"])
        body.initialize({})
        body.exit_initialization()
        for n in range(round(0.5 / step)):
            sent = v + ahead * step * (force / mass - GRAVITY)
            moved.set([z, sent])
            body.do_step(n * step, step)
            (force,) = reaction.get()
            z, v = z + step * sent, v + step * (force / mass - GRAVITY)
            errors.append(0.5 * mass * v**2 + mass * GRAVITY * z + energy.get().sum() - REST_ENERGY)
    return max(map(abs, errors))


def test_a_loop_of_a_few_lines_is_of_second_order_with_the_mean_velocity_by_the_last_force(drivers):
    fmu = body_fmu(drivers, step=2e-5)
    errors = {ahead: [loop_energy_error(fmu, step, ahead=ahead) for step in (1e-3, 5e-4, 2.5e-4)] for ahead in (0.5, 0.0)}
    assert orders(errors[0.5]) == pytest.approx([2, 2], abs=0.15)
    assert all(1.0 < order < 1.3 for order in orders(errors[0.0]))
    assert errors[0.5][0] < errors[0.0][0] / 100


def implicit_step(body: Stepper, plate: Stepper, length: float) -> int:
    """Finds the reaction that plate and body agree on, between none and the one that an unmoved plate would get; the number of tries."""
    parts = (plate, body)
    saved, (place,) = [part.save() for part in parts], plate.read("point.z")

    def excess(reaction: float) -> float:
        for part, state in zip(parts, saved, strict=True):
            part.restore(state)
        plate.set({"reaction.z": reaction})
        plate.step(length)
        body.set({PLANE + "point.z": place, PLANE + "velocity.z": (plate.read("point.z")[0] - place) / length})
        body.step(length)
        return body.read(PLANE + "reaction.z")[0] - reaction

    return false_position(excess)


def false_position(excess) -> int:
    """Illinois: the body's reaction falls as the plate's grows. Returns the number of tries."""
    low, below = 0.0, excess(0.0)
    if below == 0:
        return 1
    high, above = below, excess(below)
    for tries in range(3, 100):
        middle = (low * above - high * below) / (above - below)
        rest = excess(middle)
        if abs(rest) < 1e-8:
            return tries
        if rest > 0:
            low, below, above = middle, rest, 0.5 * above
        else:
            high, above, below = middle, rest, 0.5 * below
    raise AssertionError(f"no common reaction between {low} and {high}")


LOAD = {"force.z": -20.0}
"""N; the 16 control points on the plate weigh 0.25 kg"""


def test_a_light_plate_under_load_diverges_explicitly(drivers):
    speeds = []
    with Stepper(body_fmu(drivers)) as body, Stepper(drivers / "plate.fmu", start_values={"mass": 0.05}) as plate:
        plate.set(LOAD)
        for _ in range(100):
            plate.set({"reaction.z": body.read(PLANE + "reaction.z")[0]})
            body.set({PLANE + name: plate.read(name)[0] for name in ("point.z", "velocity.z")})
            for part in (plate, body):
                part.step(1e-3)
            speeds.append(abs(plate.read("velocity.z")[0]))
    assert max(speeds) > 20, "m/s, where the load can give it 0.2"


@pytest.mark.short("0.001")
@pytest.mark.parametrize("mass", [0.05, 0.001])
def test_a_light_plate_under_load_is_solved_implicitly(drivers, mass):
    errors, heights, speeds = [], [], []
    with Stepper(body_fmu(drivers)) as body, Stepper(drivers / "plate.fmu", start_values={"mass": mass, "delay": 0}) as plate:
        plate.set(LOAD)
        for _ in range(100):
            assert implicit_step(body, plate, 1e-3) < 60
            height, momentum = plate.read("point.z", "momentum.z")
            energy = 0.5 * momentum**2 / mass + (mass * GRAVITY - LOAD["force.z"]) * height
            errors.append(energy + sum(body.read(*MECHANICAL, "energy.dissipated")) - REST_ENERGY)
            heights.append(height)
            speeds.append(abs(momentum / mass))
    assert max(map(abs, errors)) < 2e-5, "J; work and kinetic energy balance exactly, the rest is the body's internal step"
    assert max(speeds) < 0.3
    assert -0.003 < min(heights) < -0.001
