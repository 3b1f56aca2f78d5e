"""SIGTERM, which `timeout`, `docker stop` and batch systems send, is an interrupt: what there is is kept, and no temporary file stays."""

import json
import os
import signal
import subprocess
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path

import pytest

from softffd import Result, Sweep
from validation.guard import GRACE, Lost, guarded

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads what a process computed where Linux tells it")

SCENE = """
title = "A long fall"
[environment]
gravity = [0.0, 0.0, -9.81]
[outputs]
positions = "none"
energy = true
[experiment]
stop_time = 5000.0
"""


def terminated(tmp_path: Path, *arguments: str, when) -> str:
    """What a command says on stderr whose whole process group gets SIGTERM as soon as `when()`; it must end as after Ctrl-C."""
    (tmp_path / "tmp").mkdir()
    (tmp_path / "fall.toml").write_text(SCENE)
    process = subprocess.Popen(
        [sys.executable, "-m", "softffd", *arguments], cwd=tmp_path, env=os.environ | {"TMPDIR": str(tmp_path / "tmp")},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        when(process)
        os.killpg(process.pid, signal.SIGTERM)
        _, said = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 130 and said.startswith("softffd: interrupted; ") and said.count("\n") == 1, said
    assert not list((tmp_path / "tmp").iterdir())
    return said


def begun(process) -> None:
    """It has said what it runs, and computed for a while since, on a busy machine too."""
    assert process.stdout.readline() == "A long fall\n"
    said = computed(process)
    wait_until(process, lambda: computed(process) - said >= 0.3)


def wait_until(process, so) -> None:
    while not so():
        assert process.poll() is None, f"ended with {process.returncode} before: {process.stderr.read()}"
        time.sleep(0.05)


def computed(process) -> float:
    """What a process has computed so far [s]."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) / os.sysconf("SC_CLK_TCK")


def test_a_run_keeps_what_was_simulated(tmp_path):
    said = terminated(tmp_path, "run", "fall.toml", "-o", "kept", when=begun)
    assert "what was simulated until then is kept in kept" in said
    result = Result.load(tmp_path / "kept")
    assert 0 < result.time[-1] < 5000 and result.summary["interrupted_before_s"] == 5000


@pytest.mark.full
def test_a_sweep_counts_no_run_as_failed(tmp_path):
    def some_are_kept(process):
        file = tmp_path / "kept" / "sweep.npz"
        wait_until(process, lambda: file.is_file() and list((tmp_path / "tmp").glob("softffd-*")))
        time.sleep(2.0)

    command = ("sweep", "fall.toml", "--vary", "mass=1:2:4", "-j", "2", "-o", "kept", "--stop-time", "3000")
    said = terminated(tmp_path, *command, when=some_are_kept)
    assert "of 4 runs are kept in" in said and Sweep.load(tmp_path / "kept" / "sweep.npz").failures == []


@pytest.mark.full
def test_a_measurement_names_what_is_missing(tmp_path):
    (tmp_path / "short.toml").write_text("[environment]\ngravity = [0.0, 0.0, -9.81]\n[experiment]\nstop_time = 0.02\n")

    def one_is_kept(process):
        wait_until(process, (tmp_path / "kept" / "accuracy.json").is_file)
        time.sleep(1.0)

    terminated(tmp_path, "accuracy", "short.toml", "fall.toml", "--quick", "-o", "kept", when=one_is_kept)
    assert json.loads((tmp_path / "kept" / "accuracy.json").read_text())["scenes_not_measured"] == {"fall": "interrupted"}


def ends_within_a_message(jobs):
    """Of the first result some bytes go through."""
    if jobs[0] == 0:
        Connection._send = lambda pipe, message, **_rest: (os.write(pipe.fileno(), message[:10]), os._exit(7))
    yield from (b"x" * 1000 for _job in jobs)


def terminates_itself(jobs):
    os.kill(os.getpid(), signal.SIGTERM)
    yield from jobs


def test_a_process_that_ends_within_a_message_is_a_lost_job_and_the_next_ones_go_on(monkeypatch):
    monkeypatch.setattr("validation.guard._way", lambda _work: "fork")
    results = dict(guarded(ends_within_a_message, [0, 1, 2], lambda _job: 20.0))
    assert results == {0: Lost("crash", "the process ended with status 7"), 1: b"x" * 1000, 2: b"x" * 1000}


def test_where_all_processes_are_terminated_no_job_is_lost(monkeypatch):
    monkeypatch.setattr("validation.guard._way", lambda _work: "fork")
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, GRACE / 2)
        with pytest.raises(KeyboardInterrupt):
            list(guarded(terminates_itself, [1], lambda _job: 20.0))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
