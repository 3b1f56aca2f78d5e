"""Sweeps on a Dask cluster, two workers in processes of their own: the same tables as here, and words for what a cluster does wrong."""

import os
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import softffd
from scenes import box
from softffd import SoftffdError, Sweep, sweep
from softffd.cli import many as command
from softffd.cli.command import main
from softffd.run import sweep_runs as sweeping

distributed = pytest.importorskip("distributed")

SCENE = box(gravity=[0.0, 0.0, -9.81], energy=True, stop_time=0.02, communication_step=0.01, pin=[{"name": "base", "points": "z-"}])
VARY = {"damping": [0.0, 0.5], "stiffness.edge": [400.0, -5.0, 900.0, 1600.0]}
WORK = "energy.work"
VERSION = softffd.__version__


@pytest.fixture(scope="module")
def scheduler():
    import dask

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0") as made,
    ):
        yield made.scheduler_address


@pytest.fixture
def client(scheduler):
    with distributed.Client(scheduler, set_as_default=False) as client:
        yield client


def test_a_cluster_makes_the_table_of_this_machine_with_the_words_of_what_failed(client):
    here, there = sweep(SCENE, VARY, outputs=[WORK]), sweep(SCENE, VARY, outputs=[WORK], executor=client.get_executor())
    assert np.array_equal(there.outputs[WORK], here.outputs[WORK], equal_nan=True)
    assert there.done.all() and there.failures == here.failures
    assert [words for _, words in there.failures] == [here.failures[0][1]] * 2 and "got -5" in here.failures[0][1]


def test_an_interrupted_sweep_goes_on_there_or_here(scheduler, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    softffd.package_fmu(SCENE, "pinned.fmu")  # the workers get its bytes: the name means nothing where they are

    def stop(done, total):
        if done == 2:
            raise KeyboardInterrupt

    with distributed.Client(scheduler) as client:
        with pytest.raises(KeyboardInterrupt, match=r"2 of 8 runs are kept in kept\.npz"):
            sweep("pinned.fmu", VARY, outputs=[WORK], file="kept.npz", progress=stop, executor=client.get_executor())
        assert client.status == "running"
    told = []
    whole = sweep("pinned.fmu", VARY, outputs=[WORK], file="kept.npz", progress=lambda *counts: told.append(counts), jobs=1)
    assert told == [(n, 8) for n in range(3, 9)] and whole.failures == sweep("pinned.fmu", VARY, outputs=[WORK]).failures


def test_workers_of_another_version_are_refused(client, monkeypatch):
    monkeypatch.setattr(softffd, "__version__", "9.9")
    with pytest.raises(SoftffdError, match=rf"a worker has softffd {VERSION}, wanted 9.9"):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], executor=client.get_executor())


@pytest.mark.parametrize("made", [lambda: ThreadPoolExecutor(2), lambda: ProcessPoolExecutor(2, get_context("spawn"))])
def test_any_executor_makes_the_table_of_this_machine(made):
    with made() as executor:
        there = sweep(SCENE, VARY, outputs=[WORK], executor=executor)
    here = sweep(SCENE, VARY, outputs=[WORK])
    assert np.array_equal(there.outputs[WORK], here.outputs[WORK], equal_nan=True) and there.failures == here.failures


def test_an_fmu_that_a_worker_cannot_open_is_told(client, monkeypatch):
    monkeypatch.setattr(sweeping, "_bytes_of", lambda plan: b"no FMU")
    table = sweep(SCENE, {"mass": [1]}, outputs=[WORK], executor=client.get_executor())
    assert "swept.fmu" in table.failures[0][1]


def test_jobs_beside_an_executor_and_one_that_is_shut_down_are_refused():
    with ThreadPoolExecutor(1) as executor, pytest.raises(SoftffdError, match="jobs: wanted without an executor"):
        sweep(SCENE, {"mass": [1]}, jobs=2, executor=executor)
    with pytest.raises(SoftffdError, match="executor: takes no runs any more"):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], executor=executor)


COMMAND = ["sweep", "hanging", "--vary", "mass=1", "--scheduler"]


def test_an_address_where_no_scheduler_is_is_refused(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(command, "CONNECTING", 0.3)
    assert main([*COMMAND, "tcp://127.0.0.1:9", "-o", str(tmp_path / "kept")]) == 1
    assert "no Dask scheduler answered" in capsys.readouterr().err


@pytest.mark.parametrize("address", ["post://a", "foo", ""])
def test_what_is_no_address_is_refused_before_there_is_a_client(address, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(distributed, "Client", None)
    assert main([*COMMAND, address, "-o", str(tmp_path / "kept")]) == 1
    assert f"such as tcp://host:8786, got {address}: " in capsys.readouterr().err


@pytest.mark.full  # distributed gives its loop 10 s to begin, which a busy machine may need
def test_a_cluster_without_workers_is_refused(monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(command, "WORKERS", 0.1)
    with distributed.LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as made:
        assert main([*COMMAND, made.scheduler_address, "-o", str(tmp_path / "kept")]) == 1
    assert "had none for 0.1 s" in capsys.readouterr().err


def test_without_dask_its_extra_is_told(monkeypatch, capsys, tmp_path):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    assert main([*COMMAND, "tcp://127.0.0.1:9", "-o", str(tmp_path / "kept")]) == 1
    assert "pip install 'softffd[clusters]'" in capsys.readouterr().err


def test_the_command_takes_a_scheduler(scheduler, tmp_path, capsys):
    arguments = ["sweep", "hanging", "--vary", "mass=1,2,3", "--stop-time", "0.02", "--scheduler", scheduler, "-o", str(tmp_path / "kept")]
    assert main(arguments) == 0
    assert "3 runs, 0 failed" in capsys.readouterr().out
    assert Sweep.load(tmp_path / "kept" / "sweep.npz").done.all()


@pytest.mark.full
def test_a_run_that_takes_its_worker_down_is_a_failed_run_and_the_rest_goes_on(client, monkeypatch):
    def deadly(_plan, _fmu, given, _version):
        return os._exit(1) if (1,) in given else [np.array([float(run[0])]) for run in given]

    deadly.__module__ = "__main__"  # goes to the workers as it is
    monkeypatch.setattr(sweeping, "run_elsewhere", deadly)
    monkeypatch.setattr(sweeping, "CHUNKS", 2)
    table = sweep(SCENE, {"mass": [1, 2, 3, 4]}, outputs=[WORK], executor=client.get_executor(pure=False))
    assert table.failures == [({"mass": 2}, "the worker process ended, each time that it was tried")]
    assert table.outputs[WORK][[0, 2, 3]].tolist() == [0.0, 2.0, 3.0]
