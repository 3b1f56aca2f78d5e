"""The runs of a sweep on a Dask cluster: the FMU goes to the workers as bytes, with all that the runs need."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

import softffd
from softffd.errors import FmuError, SoftffdError
from softffd.fmu.component import Component
from softffd.fmu.package import package_fmu
from softffd.run.sweep.plan import Plan
from softffd.run.sweep.worker import run_all
from softffd.run.tables import package

if TYPE_CHECKING:
    from distributed import Client

CONNECTING, WORKERS = 10.0, 60.0
"""So long a scheduler may take to answer, and a cluster to have its first worker [s]."""
TOGETHER = 50
"""Runs that a worker makes at most before it tells them: an interrupt loses them"""
ALIKE = {"softffd": None, "distributed": None, "python": 2, "numpy": 1}
"""What has to have the same version everywhere, in so many of its numbers"""
LOST = "the worker process ended, each time that it was tried"

Index = tuple[int, ...]


def on_cluster(scheduler: str | Client, plan: Plan, indices: Sequence[Index]) -> Iterator[tuple[Index, np.ndarray | str]]:
    """Each run with its readings (r,), or the words of what failed, as they come from the workers.

    scheduler: its address, or a Client. SoftffdError where no scheduler answers, workers have other versions or cannot open the FMU, or
    the cluster goes away. Leaving the iteration early takes back what has not begun.
    """
    if not indices:
        return
    distributed = package("distributed", "sweep(scheduler=...)", "clusters")
    with _connected(scheduler) as client:
        fmu = _bytes_of(plan)
        _require_alike(client)
        _require_opens(client, fmu)
        sent = client.submit(_sent, replace(plan, source=Path(), folder=""), fmu, pure=False)  # where it is lost it is sent again
        together = min(TOGETHER, math.ceil(len(indices) / (4 * sum(client.nthreads().values()))))
        given: dict[Any, Sequence[Index]] = {}

        def give(runs: Sequence[Index]) -> Any:
            future = client.submit(run_elsewhere, sent, runs, softffd.__version__, pure=False)
            given[future] = runs
            return future

        try:
            begun = [give(indices[n : n + together]) for n in range(0, len(indices), together)]
            suspects: list[Index] = []
            for future in distributed.as_completed(begun, loop=client.loop):
                runs, results = given.pop(future), _results(future)
                if results is None:
                    suspects += runs
                else:
                    yield from zip(runs, results, strict=True)
            for run in suspects:  # alone in the cluster: what ends its worker now is this run and no other
                yield run, (_results(give([run])) or [LOST])[0]
        finally:
            client.cancel([*given])


def _results(future: Any) -> list[np.ndarray | str] | None:
    """Of some runs; none where their worker ended each time that they were tried."""
    from distributed import KilledWorker

    try:
        return future.result()
    except KilledWorker:
        return None
    except SoftffdError:
        raise
    except Exception as error:
        raise SoftffdError(f"scheduler: the cluster could not make the runs: {type(error).__name__}: {error}") from None


def _sent(plan: Plan, fmu: bytes) -> tuple[Plan, bytes]:
    """What all runs need, on its way to where they are made."""
    return plan, fmu


def run_elsewhere(sent: tuple[Plan, bytes], runs: Sequence[Index], version: str) -> list[np.ndarray | str]:
    """The results of some runs, on a worker: one component is opened, and reset between them."""
    if softffd.__version__ != version:
        raise SoftffdError(f"scheduler: a worker has softffd {softffd.__version__}, wanted {version}")
    plan, fmu = sent
    with _as_file(fmu) as file:
        return list(run_all(replace(plan, source=file), runs))


def why_not_opened(fmu: bytes) -> str:
    """Why this FMU cannot be opened here; empty where it can."""
    try:
        with _as_file(fmu) as file, Component(file):
            return ""
    except FmuError as error:
        return str(error)


@contextmanager
def _as_file(fmu: bytes) -> Iterator[Path]:
    with TemporaryDirectory(prefix="softffd-") as folder:
        file = Path(folder) / "swept.fmu"
        file.write_bytes(fmu)
        yield file


def _bytes_of(plan: Plan) -> bytes:
    if isinstance(plan.source, str | Path):
        return Path(plan.source).read_bytes()
    with TemporaryDirectory(prefix="softffd-") as folder:
        return package_fmu(plan.source, Path(folder) / "swept.fmu").read_bytes()


@contextmanager
def _connected(scheduler: str | Client) -> Iterator[Client]:
    """The client given, or one of its own for an address; it has a worker."""
    from distributed import Client

    if isinstance(scheduler, Client):
        client = scheduler
    elif isinstance(scheduler, str):
        client = _client(scheduler)
    else:
        raise SoftffdError(f"scheduler: wanted the address of a Dask scheduler or a distributed.Client, got {type(scheduler).__name__}")
    try:
        try:
            client.wait_for_workers(1, timeout=WORKERS)
        except TimeoutError:
            raise SoftffdError(f"scheduler: wanted a cluster with workers, that at {_address(client)} had none for {WORKERS:g} s") from None
        yield client
    finally:
        if client is not scheduler:
            client.close()


def _client(address: str) -> Client:
    from distributed import Client

    try:
        return Client(address, timeout=CONNECTING, set_as_default=False)
    except (OSError, ValueError) as error:  # nobody is there; no address
        why = f"no Dask scheduler answered within {CONNECTING:g} s" if isinstance(error, OSError) else str(error)
        raise SoftffdError(f"scheduler: wanted the address of one, such as tcp://host:8786, got {address}: {why}") from None


def _address(client: Client) -> str:
    return client.scheduler.address if client.scheduler else "?"


def _require_alike(client: Client) -> None:
    """SoftffdError that tells each package of another version and where."""
    told: Any = client.get_versions(packages=["softffd"])
    here = told["client"]["packages"]
    places = {"the scheduler": told["scheduler"], **{f"worker {name}": worker for name, worker in told["workers"].items()}}
    if others := [line for place, versions in places.items() for line in differences(here, versions["packages"], place)]:
        more = f"; and {len(others) - 5} more" if len(others) > 5 else ""
        raise SoftffdError(f"scheduler: wanted the same versions here and on the cluster: {'; '.join(others[:5])}{more}")


def differences(here: Mapping[str, str | None], there: Mapping[str, str | None], place: str) -> Iterator[str]:
    """What is not alike at this place. A scheduler does not need what only runs need."""
    for name, numbers in ALIKE.items():
        ours, theirs = here.get(name), there.get(name)
        if place == "the scheduler" and name in ("softffd", "numpy") and theirs is None:
            continue
        if theirs is None or _numbers(ours, numbers) != _numbers(theirs, numbers):
            yield f"{place} has {f'{name} {theirs}' if theirs else f'no {name}'}, here is {ours}"


def _numbers(version: str | None, count: int | None) -> list[str]:
    return (version or "").split(".")[:count]


def _require_opens(client: Client, fmu: bytes) -> None:
    for worker, why in client.run(why_not_opened, fmu).items():
        if why:
            raise SoftffdError(f"scheduler: worker {worker} cannot open the FMU: {why}")
