"""Sweeps on a Dask cluster, two workers in processes of their own: the same tables as here, and words for what a cluster does wrong."""

import os

import numpy as np
import pytest

import softffd
from scenes import box
from softffd import SoftffdError, Sweep, sweep
from softffd.cli.command import main
from softffd.run.sweep import cluster

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


def test_a_cluster_makes_the_table_of_this_machine_with_the_words_of_what_failed(scheduler):
    here, there = sweep(SCENE, VARY, outputs=[WORK]), sweep(SCENE, VARY, outputs=[WORK], scheduler=scheduler)
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
            sweep("pinned.fmu", VARY, outputs=[WORK], file="kept.npz", progress=stop, scheduler=client)
        assert client.status == "running"
    told = []
    whole = sweep("pinned.fmu", VARY, outputs=[WORK], file="kept.npz", progress=lambda *counts: told.append(counts), jobs=1)
    assert told == [(n, 8) for n in range(3, 9)] and whole.failures == sweep("pinned.fmu", VARY, outputs=[WORK]).failures


def test_workers_of_another_version_are_refused(scheduler, monkeypatch):
    real = distributed.Client.get_versions

    def later(client, **options):
        told = real(client, **options)
        told["client"]["packages"]["softffd"] = "9.9"
        return told

    monkeypatch.setattr(softffd, "__version__", "9.9")  # a worker that comes later looks itself
    with pytest.raises(SoftffdError, match=rf"a worker has softffd {VERSION}, wanted 9.9"):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], scheduler=scheduler)
    monkeypatch.setattr(distributed.Client, "get_versions", later)
    with pytest.raises(SoftffdError, match=rf"the same versions .* worker tcp://\S+ has softffd {VERSION}, here is 9.9"):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], scheduler=scheduler)


def test_what_has_to_be_alike():
    here = {"softffd": "0.1.0", "distributed": "2026.8.0", "python": "3.11.2.final.0", "numpy": "2.1.0"}
    assert list(cluster.differences(here, here | {"python": "3.11.9.final.0", "numpy": "2.4.1"}, "worker a")) == []
    assert list(cluster.differences(here, here | {"softffd": None, "numpy": None}, "the scheduler")) == []
    found = list(cluster.differences(here, here | {"softffd": None, "python": "3.12.1.final.0", "numpy": "1.26.0"}, "worker a"))
    assert found == [
        "worker a has no softffd, here is 0.1.0",
        "worker a has python 3.12.1.final.0, here is 3.11.2.final.0",
        "worker a has numpy 1.26.0, here is 2.1.0",
    ]


def test_an_fmu_that_a_worker_cannot_open_is_refused(scheduler, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "_bytes_of", lambda plan: b"no FMU")
    with pytest.raises(SoftffdError, match=r"cannot open the FMU: .*swept\.fmu"):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], scheduler=scheduler)


@pytest.mark.parametrize(
    "address, words",
    [("tcp://127.0.0.1:9", "no Dask scheduler answered"), ("post://a", "got post://a"), (7, "address of a Dask scheduler")],
)
def test_an_address_where_no_scheduler_is_is_refused(address, words, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECTING", 0.3)
    with pytest.raises(SoftffdError, match=words):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], scheduler=address)


@pytest.mark.full  # distributed gives its loop 10 s to begin, which a busy machine may need
def test_a_cluster_without_workers_is_refused(monkeypatch):
    monkeypatch.setattr(cluster, "WORKERS", 0.1)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address="127.0.0.1:0") as made,
        pytest.raises(SoftffdError, match=r"wanted a cluster with workers, that at tcp://.* had none for 0.1 s"),
    ):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], scheduler=made.scheduler_address)


def test_jobs_are_the_clusters_own():
    with pytest.raises(SoftffdError, match="jobs: wanted without a scheduler"):
        sweep(SCENE, {"mass": [1]}, jobs=2, scheduler="tcp://127.0.0.1:9")


def test_without_dask_its_extra_is_told(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    with pytest.raises(SoftffdError, match=r"pip install 'softffd\[clusters\]'"):
        sweep(SCENE, {"mass": [1]}, outputs=[WORK], scheduler="tcp://127.0.0.1:9")


def test_the_command_takes_a_scheduler(scheduler, tmp_path, capsys):
    arguments = ["sweep", "hanging", "--vary", "mass=1,2,3", "--stop-time", "0.02", "--scheduler", scheduler, "-o", str(tmp_path / "kept")]
    assert main(arguments) == 0
    assert "3 runs, 0 failed" in capsys.readouterr().out
    assert Sweep.load(tmp_path / "kept" / "sweep.npz").done.all()
    assert main([*arguments, "-j", "2"]) == 1
    assert "jobs: wanted without a scheduler" in capsys.readouterr().err


def test_a_run_that_takes_its_worker_down_is_a_failed_run_and_the_rest_goes_on(scheduler, monkeypatch):
    def deadly(sent, runs, _version):
        return os._exit(1) if (1,) in runs else [np.array([float(run[0])]) for run in runs]

    deadly.__module__ = "__main__"  # goes to the workers as it is
    monkeypatch.setattr(cluster, "run_elsewhere", deadly)
    monkeypatch.setattr(cluster, "TOGETHER", 2)
    table = sweep(SCENE, {"mass": [1, 2, 3, 4]}, outputs=[WORK], scheduler=scheduler)
    assert table.failures == [({"mass": 2}, "the worker process ended, each time that it was tried")]
    assert table.outputs[WORK][[0, 2, 3]].tolist() == [0.0, 2.0, 3.0]
