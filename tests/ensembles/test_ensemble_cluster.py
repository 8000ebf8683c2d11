"""Ensembles on a dask cluster of processes: bits, a worker that is killed, workers that are refused."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run
from ensemble_cases import BODY, all_bytes, all_reductions, slow, twisted
from polhode import distributions, ensemble, loads, reductions
from polhode.ensembles import cluster as cluster_of_ensembles

distributed = pytest.importorskip("distributed")
TESTS = Path(__file__).parent

pytestmark = [
    # What dask and its event loop leave behind when processes are killed is not this package's.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore:.*:pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning:distributed"),
]


@pytest.fixture(scope="module")
def workers() -> Iterator[Any]:
    """A cluster of one worker, which tests make larger."""
    cluster = distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=":0", host="127.0.0.1"
    )
    try:
        with distributed.Client(cluster) as client:
            # Workers import what tests hand over from beside the tests.
            client.register_plugin(Beside(str(TESTS)))
            yield client
    finally:
        try:
            cluster.close()
        except KeyError:
            # When all processes have ended it may yet ask for a worker that a test has killed.
            cluster.status = distributed.Status.closed


class Beside(distributed.WorkerPlugin):  # type: ignore[misc,name-defined]  # found by pytest alone
    """Puts a folder before others, also of workers that come later."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def setup(self, worker: Any) -> None:  # noqa: ARG002
        sys.path.insert(0, self.folder)


def scaled(client: Any, count: int) -> None:
    client.cluster.scale(count)
    client.wait_for_workers(count, timeout=60)


def test_bits_are_those_of_this_machine_for_any_number_of_workers(workers: Any) -> None:
    states = all_bytes(twisted(500, chunk=60).compute())
    reduced = all_bytes(twisted(13_000, reduce=all_reductions()).compute())
    for count in (1, 2):
        scaled(workers, count)
        assert all_bytes(twisted(500, chunk=60, client=workers).compute()) == states
        many = twisted(13_000, reduce=all_reductions(), client=workers, chunk=4096 * count)
        assert all_bytes(many.compute()) == reduced


@pytest.mark.long
@pytest.mark.parametrize("count", [3, 7])
def test_bits_of_more_workers(workers: Any, count: int) -> None:
    scaled(workers, count)
    assert all_bytes(twisted(5000, chunk=60, client=workers).compute()) == all_bytes(twisted(5000).compute())
    many = twisted(100_000, reduce=all_reductions(), client=workers)
    assert all_bytes(many.compute()) == all_bytes(twisted(100_000, reduce=all_reductions()).compute())


def test_the_command_prints_the_same_numbers_by_workers(workers: Any, tmp_path: Path) -> None:
    words = (
        "ensemble",
        "--moments",
        "1.00(1), 2.00(2), 2.5",
        "--omega",
        "0, 1.00 ± 0.05, 0.01",
        "--end",
        "9",
    )
    many = (*words, "--n", "9000")
    code, out, err = run(*many, "--client", workers.scheduler.address)
    assert (code, err) == (0, "")
    assert out == run(*many)[1]
    for place in ("here.npz", "there.npz"):
        to = ("--client", workers.scheduler.address) if place == "there.npz" else ()
        assert run(*words, "--chunk", "300", "--save", tmp_path / place, *to)[0] == 0
    assert (tmp_path / "there.npz").stat().st_size == (tmp_path / "here.npz").stat().st_size
    with np.load(tmp_path / "here.npz") as here, np.load(tmp_path / "there.npz") as there:
        assert all(
            here[name].tobytes() == there[name].tobytes() for name in ("omega", "quaternion", "status")
        )


def test_functions_of_ones_own_go_along(workers: Any) -> None:
    factor = 0.5

    def spin(rng: np.random.Generator) -> Any:
        return factor * rng.normal(size=3)

    both = [ensemble(BODY, [0, 1], spin, n=50, seed=1, chunk=20, client=client) for client in (None, workers)]
    assert all_bytes(both[0].compute()) == all_bytes(both[1].compute())
    kept = reductions.mean(lambda run: run.omega[:, -1] * factor)
    reduced = [
        ensemble(BODY, [0, 1], spin, n=5000, seed=1, reduce=kept, client=client) for client in (None, workers)
    ]
    assert all_bytes(reduced[0].compute()) == all_bytes(reduced[1].compute())


def test_a_worker_that_is_killed_half_way_costs_its_chunks_alone(workers: Any, tmp_path: Path) -> None:
    scaled(workers, 2)
    want = slow().compute()
    told: list[float] = []
    killed: list[int] = []

    def kill_one(fraction: float) -> None:
        told.append(fraction)
        if fraction >= 0.3 and not killed:
            killed.append(next(iter(workers.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    many = slow(client=workers, progress=kill_one)
    many.to_npz(tmp_path / "out")
    files = sorted((tmp_path / "out").glob("chunk-*.npz"))
    assert len(files) == 20
    for name in ("omega", "quaternion", "status"):
        found = np.concatenate([np.load(file)[name] for file in files])
        assert found.tobytes() == np.asarray(want[name]).tobytes()
    assert killed
    # Each chunk counts once, nothing twice: the fractions go up by one chunk.
    assert np.allclose(np.diff(told), 0.05)
    assert told[-1] == 1.0


def test_what_was_ended_goes_on_with_a_cluster(workers: Any, tmp_path: Path) -> None:
    class Enough(Exception):  # noqa: N818
        pass

    def end(fraction: float) -> None:
        if fraction > 0.4:
            raise Enough

    with pytest.raises(Enough):
        twisted(300, chunk=30, progress=end).to_npz(tmp_path / "out")
    done = len(list((tmp_path / "out").glob("chunk-*")))
    assert 0 < done < 10
    twisted(300, chunk=30, client=workers).resume(tmp_path / "out")
    twisted(300, chunk=30).to_npz(tmp_path / "whole")
    for file in (tmp_path / "whole").iterdir():
        assert (tmp_path / "out" / file.name).read_bytes() == file.read_bytes()


def test_an_error_of_a_member_comes_back_and_ends_the_rest(workers: Any) -> None:
    with pytest.raises(ValueError, match=r"member [0-9]+: "):
        twisted(500, chunk=20, client=workers, on_failure="raise").compute()

    late = ensemble(
        BODY,
        [0, 1],
        (0, 0, 1),
        load=loads.torque_callback(lambda t, omega, q: [0, 0, 1 / (t < 0.5)]),  # noqa: ARG005
        n=100,
        seed=1,
        chunk=10,
        client=workers,
    )
    with pytest.raises(ZeroDivisionError):
        late.compute()
    assert all_bytes(twisted(50, client=workers).compute()) == all_bytes(twisted(50).compute())


def test_workers_with_another_polhode_are_refused(workers: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_of_ensembles, "build", lambda: ("0.0.9", "0" * 32))
    with pytest.raises(
        RuntimeError, match=r"worker .* has polhode .* and this process polhode 0\.0\.9 \(core 0000"
    ):
        twisted(50, client=workers).compute()


def test_a_worker_that_comes_later_is_refused_too() -> None:
    with pytest.raises(RuntimeError, match=r"this worker has polhode .* and the client polhode 0\.0\.9"):
        cluster_of_ensembles._deserialize(b"", ("0.0.9", "0" * 32))


def test_ctrl_c_cancels(workers: Any) -> None:
    timer = threading.Timer(1.0, lambda: signal.raise_signal(signal.SIGINT))
    many = twisted(100_000, t=(0.0, 400.0), chunk=500, client=workers)
    start = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        many.compute()
    assert time.monotonic() - start < 10.0
    deadline = time.monotonic() + 30.0
    while any(workers.processing().values()) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not any(workers.processing().values())


def test_a_client_that_promises_is_refused(workers: Any) -> None:
    async def check() -> None:
        async with distributed.Client(workers.scheduler.address, asynchronous=True) as client:
            with pytest.raises(ValueError, match="client: it is asynchronous"):
                cluster_of_ensembles.check_client(client)

    asyncio.run(check())


def test_nothing_but_the_extra_is_needed_without_a_client() -> None:
    code = (
        "import sys, ensemble_cases as e\n"
        "e.twisted(9, reduce=e.all_reductions()).compute()\n"
        "assert not {'dask', 'distributed', 'zarr', 'xarray', 'cloudpickle'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=TESTS, timeout=60)


def test_the_extra_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(
        ModuleNotFoundError, match=r'client= needs distributed: pip install "polhode\[cluster\]"'
    ):
        twisted(9, client=object())


def test_samples_are_the_same_there(workers: Any) -> None:
    rows = distributions.samples(np.linspace(0, 1, 90).reshape(30, 3), "shuffled")
    both = [ensemble(BODY, [0, 1], rows, n=30, seed=1, chunk=7, client=client) for client in (None, workers)]
    assert all_bytes(both[0].compute()) == all_bytes(both[1].compute())
