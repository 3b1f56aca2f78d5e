"""Nothing takes 5 % more instructions than it did: tests/support/instruction_counts.py says what is counted, and how to record anew."""

import pytest

import instruction_counts
from instruction_counts import NotCounted, counted, kept, kept_of, slower


@pytest.fixture(scope="session")
def program():
    return instruction_counts.built()


def counts_of(program, instructions):
    """The compiler's and the processor's; skipped where there are none."""
    try:
        return counted(program, instructions)
    except NotCounted as reason:
        pytest.skip(str(reason))


@pytest.mark.parametrize("instructions", instruction_counts.SETS)
@pytest.mark.full
def test_nothing_takes_more_instructions_than_it_did(program, instructions):
    compiler, counts = counts_of(program, instructions)
    try:
        wanted = kept_of(compiler, instructions)
    except NotCounted as reason:
        pytest.skip(str(reason))
    assert slower(counts, wanted) == []


@pytest.mark.full
def test_counts_are_the_same_every_time(program):
    first, second = (counts_of(program, "avx2") for _ in range(2))
    assert first == second


def test_a_slow_down_has_its_name():
    wanted = next(iter(kept()["g++ 12"].values()))
    name = "a communication step of 16 steps"
    slow = wanted | {name: round(1.06 * wanted[name])}
    assert slower(wanted, wanted) == []
    assert [words.partition(":")[0] for words in slower(slow, wanted)] == [name]
    assert slower({}, wanted)
