"""Fixtures and settings that the whole suite shares."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from cad_files import read_here
from hypothesis import HealthCheck, settings
from molecule_files import write_molecules
from places import ROOT

# Collecting makes objects that stay to the end: the garbage collector does not look through them.
gc.disable()

# What runs in the background of a shell ignores Ctrl-C, and so do its children: tests of it would not end.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile(
    "polhode",
    derandomize=True,  # the same examples on every machine and every day
    database=None,
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile(
    "thorough", parent=settings.get_profile("polhode"), derandomize=False, max_examples=5000
)
settings.load_profile(os.environ.get("POLHODE_HYPOTHESIS_PROFILE", "polhode"))


LONG = 3600
"""Seconds that a test marked `long` may take, unless it says otherwise."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Allow long tests their time."""
    for item in items:
        if item.get_closest_marker("long") and not item.get_closest_marker("timeout"):
            item.add_marker(pytest.mark.timeout(LONG))


def pytest_collection_finish() -> None:
    """Turn the garbage collector on, for what the tests make."""
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real files and known values, beside the repository unless the environment says where.

    Without it the test is skipped; where it has to be present (``POLHODE_REQUIRE_DATA=1``) that is a failure.
    """
    folder = Path(os.environ.get("POLHODE_SHARED_DATA") or ROOT.parent / "shared" / "data")
    if not folder.is_dir():
        message = f"no folder of shared data at {folder}; POLHODE_SHARED_DATA names another place"
        if os.environ.get("POLHODE_REQUIRE_DATA") == "1":
            pytest.fail(message)
        pytest.skip(message)
    return folder


@pytest.fixture(scope="session")
def eight_molecules(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the eight molecules of `molecule_files`."""
    return write_molecules(tmp_path_factory.mktemp("molecules"))


@pytest.fixture
def two_workers() -> Iterator[None]:
    """A dask cluster of two worker processes, which computes meanwhile."""
    dask, distributed = pytest.importorskip("dask"), pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", host="127.0.0.1"
        ) as cluster,
        distributed.Client(cluster),
        dask.config.set(scheduler=None),
    ):
        yield


@pytest.fixture(params=[True, False], ids=["with manifold3d", "without"])
def has_union(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether manifold3d is there: once with it, once as if it were not."""
    if request.param:
        pytest.importorskip("manifold3d")
    else:
        monkeypatch.setattr("polhode.io.components.has_union", lambda: False)
    return bool(request.param)


@pytest.fixture
def occt_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """OCCT reads files in this process."""
    monkeypatch.setattr("polhode.io.cad_process.read_cad_apart", read_here)


@pytest.fixture
def without_surfaces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ellipsoids under curves are not drawn: each takes half a second."""
    for module in ("ellipsoid", "portrait", "top"):
        monkeypatch.setattr(f"polhode.draw.plot.{module}.solid_ellipsoid", lambda *_: None)


@pytest.fixture
def rng() -> np.random.Generator:
    """A generator with a fixed seed, fresh for each test."""
    return np.random.default_rng(20261121)
