"""Random legal sequences of calls, of several instances with states saved and restored: all stay on the straight run."""

import random
from ctypes import byref, c_void_p

import pytest

from c_host import DISCARD, OK, STEP, STEPS, TIMES, Fmu
from straight_run import apply, straight


class Walker:
    """An instance that takes detours; `at` is its place on the straight run."""

    def __init__(self, fmu: Fmu, generator: random.Random):
        self.fmu, self.random = fmu, generator
        self.states: list[tuple[c_void_p, int]] = []  # with their places
        self.renew()

    def renew(self) -> None:
        self.host, self.at = self.fmu.host(logging=self.random.random() < 0.5), 0
        self.host.begin()

    def advance(self) -> None:
        if self.at < STEPS:
            if "load.push.x" in self.fmu.names:
                self.host.set({"load.push.y": 99.0, "plane.ground.point.z": -7.0})  # taken back before the step
            apply(self.host, self.at, self.random)
            self.host.must("DoStep", TIMES[self.at], STEP, self.random.randrange(2))
            self.at += 1

    def restart(self) -> None:
        if self.random.random() < 0.5:
            self.host.must("Terminate")
        self.host.must("Reset")
        self.host.begin()
        self.at = 0

    def replace(self) -> None:
        """Another instance; what states it still held go with the old one."""
        self.host.free()
        self.states.clear()
        self.renew()

    def save(self) -> None:
        self.states.append((self.host.save(), self.at))

    def drop(self) -> None:
        if self.states:
            self.host.forget(self.states.pop(self.random.randrange(len(self.states)))[0])

    def overwrite(self) -> None:
        """Saves into a state that is there already."""
        if self.states:
            place = self.random.randrange(len(self.states))
            state = self.states[place][0]
            self.host.must("GetFMUstate", byref(state))
            self.states[place] = state, self.at

    def take(self, other: "Walker") -> None:
        """Another instance's state, as bytes."""
        if other.states and other.fmu is self.fmu:
            state, at = self.random.choice(other.states)
            self.states.append((self.host.received(other.host.serialized(state)), at))

    def look(self) -> None:
        self.host.outputs()
        self.host.settings()

    def discard(self) -> None:
        """A step that is too long for its stiffness, then back."""
        state, slopes = self.host.save(), self.host.slopes()
        assert self.host.set({"stiffness.edge": 1e19}) == OK
        assert self.host("DoStep", TIMES[self.at], 1.0, 1) == DISCARD
        assert self.host.slopes() == slopes
        assert self.host.reached() == pytest.approx(TIMES[self.at], abs=1e-12)
        self.host.must("SetFMUstate", state)
        self.host.forget(state)

    def restore(self) -> None:
        if self.states:
            state, self.at = self.random.choice(self.states)
            self.host.must("SetFMUstate", state)


MOVES = {
    "advance": 60, "save": 12, "restore": 10, "look": 6, "discard": 3, "restart": 1, "replace": 1, "drop": 6, "take": 6, "overwrite": 3,
}  # fmt: skip


def wander(fmus: list[Fmu], seed: int, moves: int) -> int:
    """Random moves of four instances of two scenes; returns how often the straight run was met."""
    generator = random.Random(seed)
    expected = {id(fmu): straight(fmu) for fmu in fmus}
    slopes = {id(fmu): straight(fmu, look=lambda host: host.slopes()) for fmu in fmus}
    walkers = [Walker(fmus[i % 2], generator) for i in range(4)]
    met = 0
    for _ in range(moves):
        walker = generator.choice(walkers)
        move = generator.choices(list(MOVES), MOVES.values())[0]
        getattr(walker, move)(*[generator.choice(walkers)] * (move == "take"))
        assert walker.host.outputs() == expected[id(walker.fmu)][walker.at], (seed, move, walker.at)
        assert walker.host.slopes() == slopes[id(walker.fmu)][walker.at], (seed, move, walker.at)
        met += move in ("advance", "restore")
    for walker in walkers:
        for state, _ in walker.states:
            walker.host.forget(state)
        walker.host.free()
    return met


@pytest.mark.short("fmi[23]-0")
@pytest.mark.parametrize("seed", range(4))
def test_thousands_of_random_legal_calls_stay_on_the_straight_run(of_each, seed):
    assert wander(of_each, seed, 1200) > 500


def test_the_straight_run_depends_on_what_the_schedule_sets(of_each):
    for fmu in of_each:
        host = fmu.host()
        host.begin()
        for n in range(STEPS):
            assert host.step(n) == OK
        assert host.outputs() != straight(fmu)[-1]
        host.free()
