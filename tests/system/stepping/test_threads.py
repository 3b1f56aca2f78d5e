"""Several threads: the bits of one, no more threads than the scene asks for, none left behind."""

import os
import re
import sys
from pathlib import Path

import pytest

from scenes import box
from softffd import Simulation

TASKS = Path("/proc/self/task")
SIDES = [12, 12, 12]
LARGE = [16, 16, 17]
"""Layers that do not divide into equal parts."""
GROUND = {"gravity": [0.0, 0.0, -9.81], "offset": [0.0, 0.0, 0.001], "plane": [{"name": "ground", "friction": 0.4}]}


def large(threads, points=SIDES, **keys):
    """A lattice with work for three threads."""
    keys = {"outputs": {"positions": "none"}, "communication_step": 0.001, **keys}
    solver = {"threads": threads, "step": 2e-4, **keys.pop("solver", {})}
    return box(points=points, stiffness=1e4, damping=1e-4, stretch=[1.02, 1.0, 1.0], **keys, solver=solver)


def state(simulation):
    """All bytes behind the head, which ends with the scene's guid."""
    return re.split(rb"\{[0-9a-f-]{36}\}", bytes(simulation.save()), maxsplit=1)[1]


def states(scene):
    """The bytes after each of some communication steps, with a way back in between."""
    found = []
    with Simulation(scene) as simulation:
        for step in range(6):
            if step == 3:
                before = simulation.save()
                simulation.step(0.003)
                simulation.restore(before)
            simulation.step()
            found.append(state(simulation))
    return found


@pytest.mark.short("leapfrog-energy", "leapfrog-ground", "leapfrog-estimate", "dop853-bare")
@pytest.mark.parametrize("parts", [{}, {"energy": True}, GROUND, {"error_estimate": True}], ids=["bare", "energy", "ground", "estimate"])
@pytest.mark.parametrize("method", ["leapfrog", "bm4", "dop853"])
def test_threads_give_the_bits_of_one(method, parts):
    alone, shared = (states(large(threads, LARGE, solver={"method": method}, **parts)) for threads in (1, 3))
    assert alone == shared
    assert len({len(each) for each in alone}) == 1 and len(set(alone)) == len(alone)


def tasks():
    return {task.name for task in TASKS.iterdir()}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="counts the process's threads by Linux's table of them")
@pytest.mark.short("3-points2-*", "2-*")
@pytest.mark.parametrize(
    "threads, points, keys, more",
    [(1, SIDES, {}, 0), (3, SIDES, {}, 2), (3, SIDES, {"error_estimate": True}, 2), (64, SIDES, {}, 2), (2, [4, 4, 4], {}, 0)],
)
def test_there_are_the_threads_that_the_lattice_has_work_for_while_an_instance_lives(threads, points, keys, more):
    before = tasks()
    for _ in range(10):
        with Simulation(large(threads, points, **keys)) as one, Simulation(large(threads, points, **keys)):
            one.step()
            assert len(tasks() - before) == 2 * more  # threads of tests before this one may end meanwhile
    assert not tasks() - before


def test_a_lattice_with_too_little_work_says_so():
    def said(threads, points):
        with Simulation(large(threads, points)) as simulation:
            simulation.step()
            return [message.text for message in simulation.log if "solver.threads" in message.text]

    assert said(2, [4, 4, 4]) == ["solver.threads = 2: a lattice of 64 control points uses 1 thread"]
    assert said(10, SIDES) == ["solver.threads = 10: a lattice of 1728 control points uses 3 threads"]
    assert said(3, SIDES) == said(1, SIDES) == []


@pytest.mark.skipif(not hasattr(os, "fork"), reason="for systems that fork")
def test_the_child_of_a_fork_goes_on_alone():
    with Simulation(large(3)) as simulation:
        simulation.step()
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            simulation.step()
            os.write(writing, state(simulation))
            simulation.close()
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading, "rb") as answer:
            told = answer.read()
        assert os.waitpid(child, 0)[1] == 0
        simulation.step()
        assert told == state(simulation)
