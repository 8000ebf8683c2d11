"""Particles that are not in memory: the same bits however they are cut, and never the whole at once."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from oracles import worst_error
from oracles.exact_particles import Particles
from polhode import MassAccumulator, RigidBody, errors

if TYPE_CHECKING:
    from collections.abc import Iterator

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")
MADE: Any = RigidBody
COUNT = 30_000

pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore:.*:pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning:distributed"),
]


@pytest.fixture(autouse=True)
def here() -> Iterator[None]:
    with dask.config.set(scheduler="synchronous"):
        yield


@pytest.fixture(scope="module")
def cloud() -> tuple[Any, Any]:
    rng = np.random.default_rng(9)
    return rng.uniform(0, 2, COUNT), rng.normal((1e3, 0, -1e3), size=(COUNT, 3))


@pytest.fixture(scope="module")
def whole(cloud: Any) -> RigidBody:
    total = MassAccumulator()
    total.add(*cloud)
    return total.finish()


@pytest.mark.parametrize(
    ("of_masses", "of_positions"),
    [
        (4096, (4096, 3)),
        (8192, (8192, 3)),
        (3000, (3000, 3)),
        (COUNT, (COUNT, 3)),
        (1000, (7777, 3)),
        (4096, (4096, 1)),
        (4096, None),
        (None, (5000, 3)),
    ],
)
def test_bits_do_not_depend_on_chunks(
    cloud: Any, whole: RigidBody, of_masses: Any, of_positions: Any
) -> None:
    arrays = [
        array if chunks is None else da.from_array(array, chunks=chunks)
        for array, chunks in zip(cloud, (of_masses, of_positions), strict=True)
    ]
    assert MADE.from_particles(*arrays) == whole


def test_they_are_those_of_exact_arithmetic() -> None:
    rng = np.random.default_rng(3)
    masses, positions = rng.uniform(0.1, 1, 5000), rng.normal(size=(5000, 3)) + 10.0
    body = MADE.from_particles(da.from_array(masses, chunks=1200), da.from_array(positions, chunks=(1200, 3)))
    exact = Particles(masses, positions)
    assert worst_error(body.inertia, exact.inertia) <= 1e-15


@pytest.mark.parametrize("scheduler", ["synchronous", "threads"])
def test_generated_chunks_are_made_once_each_and_never_all_at_once(scheduler: str) -> None:
    made: list[int] = []

    def rows(block_id: Any) -> Any:
        made.append(block_id[0])
        return np.random.default_rng(block_id[0]).random((4096, 4))

    cuts = (4096,) * 20
    lazy = da.map_blocks(rows, chunks=(cuts, (4,)), dtype=float)
    made.clear()
    with dask.config.set(scheduler=scheduler):
        body = MADE.from_particles(lazy[:, 0], lazy[:, 1:])
    assert sorted(made) == list(range(20))
    all_rows = np.concatenate([rows((k,)) for k in range(20)])
    total = MassAccumulator()
    total.add(all_rows[:, 0], all_rows[:, 1:])
    assert body == total.finish()


@pytest.mark.usefixtures("two_workers")
def test_two_workers_have_the_bits_of_this_process(cloud: Any, whole: RigidBody) -> None:
    arrays = [da.from_array(array, chunks=5000) for array in cloud]
    assert MADE.from_particles(*arrays) == whole
    spoilt = arrays[0].map_blocks(lambda m: m - 1.9)
    with pytest.raises(
        errors.InvalidInertiaError, match=r"^particles \d+ to \d+: masses must not be negative"
    ):
        MADE.from_particles(spoilt, arrays[1])


def test_an_accumulator_takes_them_between_others(cloud: Any, whole: RigidBody) -> None:
    masses, positions = cloud
    total = MassAccumulator()
    total.add(masses[:100], positions[:100])
    total.add(
        da.from_array(masses[100:20_000], chunks=3000), da.from_array(positions[100:20_000], chunks=(3000, 3))
    )
    total.add(masses[20_000:], positions[20_000:])
    assert total.count == COUNT
    assert total.finish() == whole
    late = MassAccumulator()
    late.add(
        da.from_array(masses[9000:], chunks=4000),
        da.from_array(positions[9000:], chunks=(4000, 3)),
        start=9000,
    )
    late.add(masses[:9000], positions[:9000], start=0)
    assert late.finish() == whole


@pytest.mark.parametrize("kind", ["mapped", "dask"])
def test_chunks_without_places_are_appended_to_others(
    cloud: Any, whole: RigidBody, kind: str, tmp_path: Path
) -> None:
    masses, positions = cloud
    if kind == "mapped":
        np.save(tmp_path / "masses.npy", masses)
        masses = np.load(tmp_path / "masses.npy", mmap_mode="r")
    else:
        masses = da.from_array(masses, chunks=3000)
    left, right = MassAccumulator(), MassAccumulator()
    for first in (0, 4096):
        left.add(masses[first : first + 4096], positions[first : first + 4096])
    for first, last in ((8192, 12_288), (12_288, COUNT)):
        right.add(masses[first:last], positions[first:last])
    left.merge(right)
    assert left.finish() == whole


def test_an_error_leaves_an_accumulator_as_it_was(cloud: Any, tmp_path: Path) -> None:
    masses, positions = cloud
    total = MassAccumulator()
    total.add(masses[:100], positions[:100])
    before = total.finish()
    bad = masses.copy()
    bad[-1] = -1.0
    np.save(tmp_path / "bad.npy", bad)
    for array in (da.from_array(bad, chunks=4096), np.load(tmp_path / "bad.npy", mmap_mode="r")):
        with pytest.raises(errors.InvalidInertiaError, match=r"masses\[\d+\]"):
            total.add(array, positions)
        assert (total.count, total.finish()) == (100, before)


def test_files_are_read_in_pieces(cloud: Any, whole: RigidBody, tmp_path: Path, monkeypatch: Any) -> None:
    from polhode.ensembles import lazy_arrays

    monkeypatch.setattr(lazy_arrays, "_PIECE", 8192)
    masses, positions = cloud
    rows = np.column_stack([masses, positions])
    np.save(tmp_path / "rows.npy", rows)
    mapped = np.load(tmp_path / "rows.npy", mmap_mode="r")
    assert MADE.from_particles(mapped[:, 0], mapped[:, 1:]) == whole
    assert MADE.from_particles(masses, mapped[:, 1:]) == whole
    single = np.load(tmp_path / "rows.npy", mmap_mode="r").astype("f4")
    np.save(tmp_path / "single.npy", single)
    mapped = np.load(tmp_path / "single.npy", mmap_mode="r")
    total = MassAccumulator()
    total.add(single[:, 0].astype(float), single[:, 1:].astype(float))
    assert MADE.from_particles(mapped[:, 0], mapped[:, 1:]) == total.finish()


def test_zarr_arrays(cloud: Any, whole: RigidBody, tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr")
    masses, positions = cloud
    group = zarr.open_group(tmp_path / "cloud.zarr", mode="w")
    for name, array in (("masses", masses), ("positions", positions)):
        group.create_array(name, shape=array.shape, chunks=(5000, *array.shape[1:]), dtype="f8")[:] = array
    assert MADE.from_particles(group["masses"], group["positions"]) == whole
    lazy = [da.from_zarr(group[name]) for name in ("masses", "positions")]
    assert MADE.from_particles(*lazy) == whole


def test_hdf5_datasets(cloud: Any, whole: RigidBody, tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    masses, positions = cloud
    with h5py.File(tmp_path / "cloud.h5", "w") as file:
        file["masses"], file["positions"] = masses, positions
        assert MADE.from_particles(file["masses"], file["positions"]) == whole
        assert MADE.from_particles(masses, file["positions"]) == whole


def test_labelled_arrays(cloud: Any, whole: RigidBody, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("zarr")
    masses, positions = cloud
    held = xarray.Dataset({"mass": ("particle", masses), "place": (("particle", "axis"), positions)})
    body = MADE.from_particles(held.mass, held.place)
    assert body == MADE.from_particles(masses, positions)  # in memory: as ever
    lazy = held.chunk(particle=7000)
    assert MADE.from_particles(lazy.mass, lazy.place) == whole
    held.to_zarr(tmp_path / "held.zarr", zarr_format=2)
    with xarray.open_zarr(tmp_path / "held.zarr", chunks=None) as stored:
        assert MADE.from_particles(stored.mass, stored.place) == whole


def test_the_whole_is_never_in_memory(tmp_path: Path) -> None:
    """A file of single numbers is converted one piece after the other."""
    count = 1 << 23
    rows = np.memmap(tmp_path / "rows", dtype="f4", mode="w+", shape=(count, 4))
    rows[:: count // 8] = [[1, k, 0, 0] for k in range(8)]
    tracemalloc.start()
    body = MADE.from_particles(rows[:, 0], rows[:, 1:])
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert body.mass == 8.0
    assert body.center_of_mass.tolist() == [3.5, 0.0, 0.0]
    assert most < 10e6 < rows.nbytes / 10


def test_masks_and_units_within_chunks_are_refused(cloud: Any) -> None:
    masses, positions = cloud
    masked = da.ma.masked_greater(da.from_array(masses, chunks=5000), 1.9)
    with pytest.raises(ValueError, match=r"particles \d+ to \d+: masses: the element at .* is masked"):
        MADE.from_particles(masked, positions)


@pytest.mark.parametrize("start", [0, 100])
def test_errors_name_the_rows_of_the_whole(start: int, tmp_path: Path, monkeypatch: Any) -> None:
    from polhode.ensembles import lazy_arrays

    monkeypatch.setattr(lazy_arrays, "_PIECE", 4096)
    row, places = 4096 + 17, np.ones((10_000, 3))
    masses, masked = np.ones(10_000), np.ma.ones(10_000)
    masses[row], masked[row] = -1.0, np.ma.masked
    np.save(tmp_path / "masses.npy", masses)
    stored = np.load(tmp_path / "masses.npy", mmap_mode="r")
    for given in (masses, stored, *(da.from_array(masses, chunks=size) for size in (4096, 3000))):
        with pytest.raises(errors.InvalidInertiaError, match=rf"masses\[{row}\] is -1\.0"):
            MassAccumulator().add(given, places, start=start)
    for given in (masked, da.from_array(masked, chunks=3000)):
        with pytest.raises(ValueError, match=rf"masses: the element at \({row},\) is masked"):
            MassAccumulator().add(given, places, start=start)
    with pytest.raises(errors.InvalidInertiaError, match=rf"^particles {start + 3000} to {start + 5999}: "):
        MassAccumulator().add(da.from_array(masses, chunks=3000), places, start=start)


@pytest.mark.parametrize(
    ("masses", "positions", "words"),
    [
        (da.ones(5), np.zeros((5, 2)), r"positions: expected shape \(n, 3\), got \(5, 2\)"),
        (da.ones(5), np.zeros((4, 3)), r"n = 5 and n = 4"),
        (np.ones(4), da.zeros((5, 3)), r"n = 4 and n = 5"),
        (da.ones(5)[da.ones(5) > 0], np.zeros((5, 3)), r"masses\.compute_chunk_sizes\(\)"),
        (np.ones(5), da.zeros((5, 3))[da.ones(5) > 0], r"positions\.compute_chunk_sizes\(\)"),
        (da.zeros(5), da.zeros((5, 3)), r"total mass|mass"),
        (da.ones(0), da.zeros((0, 3)), r"0 particles"),
    ],
)
def test_what_makes_no_body_is_refused(masses: Any, positions: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        MADE.from_particles(masses, positions)


def test_stacks_are_read_as_before() -> None:
    masses, frames = np.ones(4), np.random.default_rng(1).normal(size=(5, 4, 3))
    assert MADE.from_particles(masses, da.from_array(frames, chunks=2)) == MADE.from_particles(masses, frames)


def test_no_library_is_imported_for_others() -> None:
    code = (
        "import sys, numpy as np\n"
        "from polhode import RigidBody\n"
        "RigidBody.from_particles(np.ones(3), np.eye(3)).simulate([0, 1], (0, 0, 1))\n"
        "assert not {'dask', 'xarray', 'zarr', 'h5py', 'polhode.ensembles.lazy_arrays'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_workers_with_another_polhode_are_refused(cloud: Any) -> None:
    from polhode.ensembles import lazy_arrays

    with pytest.raises(
        RuntimeError, match=r"this worker has polhode .* and the client polhode 0\.0\.9 \(core 0000"
    ):
        lazy_arrays._sum_chunk(cloud[0], cloud[1], (slice(0, 1),), first=0, wanted=("0.0.9", "0" * 32))
