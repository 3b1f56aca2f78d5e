"""What instances and states take of the memory; by the thousand, and with their steps, they leave it and descriptors where they were."""

import os
import sys
from concurrent.futures import ProcessPoolExecutor
from ctypes import byref, c_size_t
from multiprocessing import get_context
from pathlib import Path
from types import SimpleNamespace

import pytest

from c_host import Fmu, Host
from scenes import box

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


def own_memory() -> int:
    """Of this process without the pages of files, of which the system maps more or fewer at once [kB]."""
    return next(int(line.split()[1]) for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("RssAnon:"))


def taken(path: str, guid: bytes, uri: bytes) -> tuple[int, int, int]:
    """What this process, which has nothing else to do, takes for an instance up to its first step, and for ten saved states; the bytes of
    these when they are serialized. All in kB."""
    fmu = SimpleNamespace(standard=Fmu.standard, library=Fmu.opened(path), guid=guid, uri=uri)
    before = own_memory()
    host = Host(fmu)
    host.begin()
    ready = own_memory()
    states, size = [host.save() for _ in range(10)], c_size_t()
    host.must("SerializedFMUstateSize", states[0], byref(size))
    return ready - before, own_memory() - ready, 10 * size.value // 1024


@pytest.mark.short("4-400")
@pytest.mark.skipif(not LINUX, reason="reads /proc")
@pytest.mark.parametrize(("side", "most"), [(4, 400), (32, 40_000)])
def test_a_scene_takes_little_memory_before_it_is_used_and_a_state_its_fields(side, most, tmp_path):
    """Of scenes without a plane even less; [kB]."""
    plane = {"name": "ground", "point": [0.0, 0.0, -1.0]}
    fmu = Fmu(box(points=[side] * 3, outputs={"positions": "none"}, plane=[plane]), tmp_path / "fmu")
    with ProcessPoolExecutor(1, get_context("spawn")) as fresh:
        scene, states, fields = fresh.submit(taken, fmu.path, fmu.guid, fmu.uri).result()
    assert scene <= most
    assert states <= 1.2 * fields
