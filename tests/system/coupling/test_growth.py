"""What a coupling does to the energy of a contact: growth per radian of the swings of a mass on a body, against closed forms.

Two bodies: a spring without mass, of which the right answer is 0, and a silicone pad with internal damping tau, of which it is
-tau omega / 2. omega is that of the mass on the body's stiffness; omega h says how coarse the communication step is.
"""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from coupled_parts import body_fmu
from scenes import box
from softffd import Scene, Simulation
from softffd.fmu.component import Component
from softffd.scene.scene import scene_from

GRAVITY, STEP = 9.81, 1e-3
HOSTS = ("all step, then exchange", "body first", "plate first")
Press = Callable[[float, float, float], float]
"""Mean force of a body on a plate over a step [N], from the plate's place [m] and mean velocity [m/s] and the step [s]"""


def spring(stiffness: float) -> Press:
    return lambda place, velocity, step: -stiffness * (place + 0.5 * step * velocity)


def swing(plate: Component, press: Press, mass: float, step: float, steps: int, host: str, *, start: float = 0.0) -> np.ndarray:
    """(steps, 2): place [m] and momentum / mass [m/s] of plate.fmu after the steps whose impulse it has."""
    plate.set_up()
    late = host == HOSTS[0]
    plate.initialize({"mass": mass, "delay": int(late), "initial.point.z": start})
    plate.exit_initialization()
    motion, reaction, momentum = (plate.block(names) for names in (["point.z", "velocity.z"], ["reaction.z"], ["momentum.z"]))
    force, rows = 0.0, []
    for n in range(steps):
        if late:
            reaction.set([force])
            force = press(*motion.get(), step)
            plate.do_step(n * step, step)
        elif host == "body first":
            reaction.set([press(*motion.get(), step)])
            plate.do_step(n * step, step)
        else:
            reaction.set([force])
            plate.do_step(n * step, step)
            force = press(*motion.get(), step)
        rows.append((motion.get()[0], momentum.get()[0] / mass))
    table = np.array(rows)
    return np.stack([table[:-1, 0], table[1:, 1]], axis=1) if late else table  # there the momentum is that of one step before


def iterated(press: Press, save, restore, mass: float, step: float, steps: int) -> np.ndarray:
    """The loop of docs/partners.md: each step is tried until force and motion fit."""
    z = v = force = give = 0.0
    rows = []
    for _ in range(steps):
        before = save()
        mean = v + step / 2 * (force / mass - GRAVITY)
        force = press(z, mean, step)
        for _ in range(8):
            off = v + step / 2 * (force / mass - GRAVITY) - mean
            if abs(off) < 1e-9:
                break
            tried, held = mean, force
            mean += off / (1 + step / 2 * give / mass)
            restore(before)
            force = press(z, mean, step)
            give = max(0.0, (held - force) / (mean - tried))
        z, v = z + step * mean, v + step * (force / mass - GRAVITY)
        rows.append((z, v))
    return np.array(rows)


def growth(rows: np.ndarray, omega: float, step: float) -> float:
    """Of the amplitude, per radian, after the first period; the place of rest is where the weight is carried."""
    amplitude = np.hypot(rows[:, 0] + GRAVITY / omega**2, rows[:, 1] / omega)
    period = max(2, round(2 * np.pi / omega / step))
    first, last = amplitude[period : 2 * period].mean(), amplitude[-period:].mean()
    return float(np.log(last / first) / ((len(rows) - 2 * period) * step * omega))


MASS = Path(__file__).resolve().parents[3] / "examples" / "partner" / "mass.py"
IN_A_PROCESS = """
import os, sys
import test_growth
print(test_growth.growth_with_the_template(sys.argv[1], float(sys.argv[2])), flush=True)
os._exit(0)
"""
"""What pythonfmu leaves behind may abort a process at its end."""


def growth_with_the_template(fmu: str, coarse: float) -> float:
    mass, omega = 5.0, coarse / STEP
    press, force, rows = spring(mass * omega**2), 0.0, []
    with Component(Path(fmu)) as partner:
        partner.initialize({})
        partner.exit_initialization()
        motion, reaction = partner.block(["point", "velocity"]), partner.block(["reaction"])
        for n in range(round(60 / coarse)):
            reaction.set([force])
            force = press(*motion.get(), STEP)
            partner.do_step(n * STEP, STEP)
            rows.append(motion.get()[0])
    place = np.array(rows)
    return growth(np.stack([place[1:-1], (place[2:] - place[:-2]) / (2 * STEP)], axis=1), omega, STEP)


def test_the_partner_to_copy_neither_feeds_nor_damps(drivers, tmp_path):
    subprocess.run([sys.executable, "-m", "pythonfmu", "build", "-f", MASS, "-d", tmp_path], check=True, capture_output=True)
    command = [sys.executable, "-c", IN_A_PROCESS, tmp_path / "Mass.fmu", "0.3"]
    done = subprocess.run(
        command, env=os.environ | {"PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert abs(float(done.stdout)) < 2e-4


COARSE = {0.1: 0.0001, 0.3: 0.0035, 0.56: 0.025, 1.0: 0.13}
"""omega h, and the growth per radian where the velocity is predicted by half the last force"""


@pytest.mark.parametrize("coarse", COARSE)
def test_on_a_spring_the_couplings_neither_feed_nor_damp(drivers, coarse):
    mass, omega = 2.0, coarse / STEP
    body, steps = spring(mass * omega**2), round(60 / coarse)
    with Component(drivers / "plate.fmu") as plate:
        for host in HOSTS:
            plate.reset()
            assert abs(growth(swing(plate, body, mass, STEP, steps, host), omega, STEP)) < 2e-5, host
    assert abs(growth(iterated(body, lambda: None, lambda _: None, mass, STEP, steps), omega, STEP)) < 2e-5


@pytest.mark.parametrize("coarse, fed", COARSE.items())
def test_a_force_held_over_the_step_feeds_the_contact(coarse, fed):
    """What the couplings above are measured against."""
    omega, body = coarse / STEP, spring((coarse / STEP) ** 2)
    z = v = force = 0.0
    rows = []
    for _ in range(round(60 / coarse)):
        mean = v + STEP / 2 * (force - GRAVITY)
        force = body(z, mean, STEP)
        z, v = z + STEP * mean, v + STEP * (force - GRAVITY)
        rows.append((z, v))
    assert growth(np.array(rows), omega, STEP) == pytest.approx(fed, rel=0.1, abs=5e-5)


LATE: dict[str, tuple[Callable[[float, float, list[float]], float], Callable[[float], float]]] = {
    "a reaction": (lambda z, ahead, means: means[-1], lambda coarse: coarse / 2),
    "twice a reaction less the last": (lambda z, ahead, means: 2 * means[-1] - means[-2], lambda coarse: coarse**3 / 2),
    "of the place": (lambda z, ahead, means: z, lambda coarse: coarse / 4),
    "half a step ahead": (lambda z, ahead, means: ahead, lambda coarse: 0.0),
}
"""The table of docs/inside.md: the place whose force a host sends, from place, place half a step ahead and mean places of the steps [m],
and the growth per radian if all of the stiffness comes from there"""


@pytest.mark.parametrize("late", LATE)
def test_a_late_force_on_a_mass_inside_feeds_it_as_documented(late):
    place, fed = LATE[late]
    mass, step, stiffness = 2.0, 5e-3, 2700.0
    part = {"name": "m", "points": "z+", "motion": "free", "mass": mass, "guide": [0, 0, 1]}
    scene = box(
        points=[2, 2, 2],
        stiffness=300.0,
        damping=0.0,
        mass={"total": 0.05},
        method="leapfrog",
        pin=[{"name": "base", "points": "z-"}, part],
    )
    with Simulation(scene) as sim:
        start, means, rows = sim["pin.m.position"][2], [0.0, 0.0], [(0.0, 0.0)]
        for n in range(250):
            z, v = rows[-1]
            sim["pin.m.force"] = (0.0, 0.0, -stiffness * place(z, z + step / 2 * v, means) + 50 * (n < 4))
            sim.step(step)
            rows.append((sim["pin.m.position"][2] - start, sim["pin.m.velocity"][2]))
            means.append((z + rows[-1][0]) / 2)
    swings = np.array(rows[5:])
    omega = np.sqrt(np.mean(swings[:, 1] ** 2) / np.mean(swings[:, 0] ** 2))
    swings[:, 0] -= GRAVITY / omega**2
    share = stiffness / mass / omega**2
    assert growth(swings, omega, step) == pytest.approx(share * fed(omega * step), rel=0.3, abs=2e-4)


PAD_STIFFNESS, TAU, AREA, HEIGHT = 32374.0, 1e-5, 0.03 * 0.02, 0.01


def pad(density: float, **solver) -> Scene:
    """A silicone pad of 30 x 20 x 10 mm, held at its back; a plane lies on it. By leapfrog, whose steps damp nothing."""
    return scene_from({
        "title": "pad",
        "lattice": {"points": [7, 5, 3], "origin": [-0.015, -0.01, -HEIGHT], "size": [0.03, 0.02, HEIGHT]},
        "mass": {"density": density},
        "material": {"youngs_modulus": 0.5e6, "internal_damping": TAU, "damping": 0.0},
        "environment": {"gravity": [0.0, 0.0, -GRAVITY]},
        "pin": [{"name": "finger", "points": "z-"}],
        "plane": [{"name": "lid", "normal": [0.0, 0.0, -1.0], "motion": "input"}],
        "outputs": {"positions": "none"},
        "solver": solver or {"method": "leapfrog"},
    })  # fmt: skip


def pressed(sim: Simulation, plane: str = "plane.lid") -> Press:
    moved, reaction = sim.block([f"{plane}.point.z", f"{plane}.velocity.z"]), sim.block([f"{plane}.reaction.z"])

    def press(place: float, velocity: float, step: float) -> float:
        moved.set((place, velocity))
        sim.step(step)
        return reaction.get()[0]

    return press


@pytest.mark.short("0.343-0.001-all step, then exchange")
@pytest.mark.parametrize("host", [*HOSTS, "iterated"])
@pytest.mark.parametrize("step", [1e-3, 2.5e-4, 1e-4])
@pytest.mark.parametrize("mass", [0.343, 0.1])
def test_a_mass_on_a_pad_swings_out_as_the_damped_oscillator(drivers, mass, step, host):
    """But for the pad's own mass, which takes a jump of velocity at every step: up to omega h / 2 times its share of the plate's mass."""
    density = 1100.0
    omega = np.sqrt(PAD_STIFFNESS / mass)
    steps = round(40 / (omega * step))
    with Simulation(pad(density)) as sim, Component(drivers / "plate.fmu") as plate:
        if host == "iterated":
            rows = iterated(pressed(sim), sim.save, sim.restore, mass, step, steps)
        else:
            rows = swing(plate, pressed(sim), mass, step, steps, host)
    share, exact = density * AREA * HEIGHT / mass, -TAU * omega / 2
    found = growth(rows, omega, step)
    assert exact - max(0.5 * share * omega * step, 6e-4) < found < exact + 2e-4, f"{found:+.5f} where {exact:+.5f} is right"


@pytest.mark.full
@pytest.mark.parametrize("mass", [0.343, 0.1])
def test_implicit_steps_damp_a_mass_on_a_pad_within_the_error_of_their_force(drivers, mass):
    """Forces within 1 % of the largest (docs/methods.md) are off by half of that a radian at most where all of it lags; within a tenth
    of the default tolerance they are those of leapfrog."""
    step, omega = 1e-4, np.sqrt(PAD_STIFFNESS / mass)
    found = {}
    for tolerance in (1e-4, 1e-5):
        with Simulation(pad(1100.0, tolerance=tolerance)) as sim, Component(drivers / "plate.fmu") as plate:
            found[tolerance] = growth(swing(plate, pressed(sim), mass, step, round(40 / (omega * step)), HOSTS[0]), omega, step)
    exact = -TAU * omega / 2
    assert exact - 0.005 < found[1e-4] < exact + 2e-4
    assert exact - 1e-3 < found[1e-5] < exact + 2e-4


def test_a_velocity_that_moves_inside_the_step_spares_the_bodys_own_mass():
    """The loop tries for the rate of the velocity in place of its mean; the touched points then take no jumps."""
    mass, omega = 0.1, np.sqrt(PAD_STIFFNESS / 0.1)
    z = v = force = give = 0.0
    rows = []
    with Simulation(pad(1100.0)) as sim:

        def answer(rate: float) -> float:
            sim.restore(before)
            sim["plane.lid.point.z"], sim["plane.lid.velocity.z"] = z, v
            sim.set_rates({"plane.lid.velocity.z": rate})
            sim.step(STEP)
            return sim.plane["lid"].reaction[2]

        for _ in range(round(40 / omega / STEP)):
            before, rate = sim.save(), force / mass - GRAVITY
            force = answer(rate)
            for _ in range(8):
                off = force / mass - GRAVITY - rate
                if abs(off) < 1e-6:
                    break
                last, rate = (rate, force), rate + off / (1 + give / mass)
                force = answer(rate)
                give = max(0.0, (last[1] - force) / (rate - last[0]))
            z, v = z + STEP * v + STEP**2 / 2 * rate, v + STEP * (force / mass - GRAVITY)
            rows.append((z, v))
    assert growth(np.array(rows), omega, STEP) == pytest.approx(-TAU * omega / 2, abs=5e-4)


@pytest.mark.parametrize("host", HOSTS)
def test_a_contact_that_opens_and_closes_is_not_fed(drivers, host):
    """Bounces on a spring that only pushes, from a millimetre above it: the force that ends a flight cannot be expected."""
    mass, coarse = 2.0, 0.3
    stiffness = mass * (coarse / STEP) ** 2

    def press(place: float, velocity: float, step: float) -> float:
        times = np.linspace(0, step, 201)
        return float(stiffness * np.maximum(0.0, -(place + velocity * times)).mean())

    with Component(drivers / "plate.fmu") as plate:
        rows = swing(plate, press, mass, STEP, 500, host, start=1e-3)
    energy = 0.5 * rows[:, 1] ** 2 + GRAVITY * rows[:, 0] + 0.5 * stiffness / mass * np.minimum(rows[:, 0], 0) ** 2
    assert energy[-20:].max() < 1.05 * GRAVITY * 1e-3


@pytest.mark.parametrize("host, times", [(HOSTS[0], 5), ("body first", 3)])
def test_a_plate_as_light_as_the_documents_allow_comes_to_rest(drivers, host, times):
    """On a box of 1 kg, of which a plate touches 16 of 64 control points."""
    with Simulation(body_fmu(drivers, ("damping = 0.0", "damping = 2.0"))) as sim, Component(drivers / "plate.fmu") as plate:
        rows = swing(plate, pressed(sim, "plane.plate"), times * 0.25, STEP, 600, host)
    assert abs(rows[-50:, 1]).max() < 0.1 * abs(rows[:50, 1]).max()
