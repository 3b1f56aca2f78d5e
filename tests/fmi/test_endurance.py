"""Instances, states and steps by the thousand leave memory and descriptors where they were."""

import os
import sys
from pathlib import Path

import pytest

from c_host import Host

LINUX = sys.platform == "linux"


def resident() -> tuple[int, int]:
    """Resident memory [kB] and open files."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE") // 1024, len(os.listdir("/proc/self/fd"))


@pytest.mark.full
@pytest.mark.skipif(not LINUX, reason="reads /proc")
def test_ten_thousand_instances_and_a_million_steps_leave_memory_and_files_as_they_were(fmus):
    bare = fmus[1]

    def live_and_die() -> None:
        host = Host(bare)
        host.begin()
        host.step(0)
        host.forget(host.save())
        host.free()

    for _ in range(500):
        live_and_die()
    before = resident()
    for _ in range(10_000):
        live_and_die()
    after = resident()
    assert after[0] - before[0] < 1000, "kB grown over 10,000 instances"
    assert after[1] == before[1]
    host, step = Host(bare), bare.library.fmi2DoStep
    host.begin()
    before = resident()
    for n in range(1_000_000):
        if step(host.component, n * 1e-4, 1e-4, 1):
            pytest.fail(f"step {n}")
    after = resident()
    assert after[0] - before[0] < 500, "kB grown over 1,000,000 steps"
    assert after[1] == before[1]
    host.free()


@pytest.mark.skipif(not LINUX, reason="reads /proc")
def test_states_that_a_host_never_freed_go_with_their_instance(rich):
    def cycle(times: int) -> None:
        for _ in range(times):
            host = Host(rich)
            host.begin()
            for _ in range(10):
                host.save()
            host.free()

    cycle(50)
    before = resident()[0]
    cycle(300)
    assert resident()[0] - before < 1000, "kB grown by 3,000 forgotten states of some 10 kB"
