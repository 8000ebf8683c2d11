"""Runs and exact motions of dask arrays: nothing is computed before it is asked for; bits are the same."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import RigidBody, Uncertain, errors, loads
from polhode import wheel as wheel_of

if TYPE_CHECKING:
    from collections.abc import Iterator

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")
xarray = pytest.importorskip("xarray")

pytestmark = [
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore:.*:pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning:distributed"),
]

RNG = np.random.default_rng(4)
BODY: Any = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
STACK: Any = RigidBody.from_principal(np.ones(10), [1.0, 2.0, 2.5] * RNG.uniform(0.97, 1.03, (10, 1)))
OMEGA = RNG.normal(size=(10, 3))
TURNS = RNG.normal(size=(10, 4))
TURNS /= np.linalg.norm(TURNS, axis=1, keepdims=True)
PLACES = RNG.normal(size=(10, 3)) + np.array([9.0, 0.0, 0.0])
T = np.linspace(0.0, 3.0, 5)
GRADIENT = loads.gravity_gradient(30.0, (9.0, 0.0, 0.0), (0.0, 2.0, 0.5))
ARRAYS = ("omega", "quaternion", "position", "velocity")


@pytest.fixture(autouse=True)
def here() -> Iterator[None]:
    with dask.config.set(scheduler="synchronous"):
        yield


def lazily(array: Any, *chunks: Any) -> Any:
    return da.from_array(array, chunks=(*chunks, -1))


def same(found: Any, run: Any) -> None:
    """The bits of `to_xarray`, and its axes."""
    whole = run.to_xarray()
    assert set(found) == {*whole, "status"}
    for name, array in whole.items():
        assert found[name].dims == array.dims
        assert found[name].attrs == array.attrs
        assert found[name].to_numpy().tobytes() == array.to_numpy().tobytes()
    for name, coordinate in whole.coords.items():
        assert found[name].equals(coordinate)
    assert found.status.to_numpy().tolist() == np.asarray(run.status).tolist()


CASES: dict[str, Any] = {
    "free": (BODY, {}),
    "stack": (STACK, {}),
    "attitude": (BODY, {"attitude": TURNS}),
    "load": (BODY, {"load": GRADIENT}),
    "moving": (STACK, {"attitude": TURNS[0], "position": PLACES, "velocity": PLACES[::-1]}),
    "dop853": (STACK, {"load": loads.constant_torque((0.1, 0.0, 0.0)), "method": "dop853"}),
    "loads": (BODY, {"load": loads.constant_torque(0.1 * PLACES)}),
    "wheel": (BODY, {"load": loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=2.0, torque=0.01)}),
    "pivot": (
        RigidBody.from_principal(1.0, (1.0, 1.0, 0.5)).translated((0, 0, 1)),
        {"load": loads.uniform_gravity((0, 0, -9.8)), "about": "origin"},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_bits_are_those_of_a_run_at_once(case: str) -> None:
    body, options = CASES[case]
    for chunks in (3, 10):
        same(body.simulate(T, lazily(OMEGA, chunks), **options), body.simulate(T, OMEGA, **options))


@pytest.mark.parametrize("name", ["attitude", "position", "velocity"])
def test_any_of_the_arguments_may_be_lazy(name: str) -> None:
    value = TURNS if name == "attitude" else PLACES
    same(STACK.simulate(T, OMEGA, **{name: lazily(value, 4)}), STACK.simulate(T, OMEGA, **{name: value}))


def test_unlike_chunks_are_cut_alike() -> None:
    found = STACK.simulate(T, lazily(OMEGA, 4), lazily(TURNS, 5))
    assert found.omega.chunks == ((4, 1, 3, 2), (5,), (3,))
    same(found, STACK.simulate(T, OMEGA, TURNS))


def test_axes_go_together_as_in_numpy() -> None:
    grid = RNG.normal(size=(4, 10, 3))
    same(STACK.simulate(T, lazily(grid, 2, 5)), STACK.simulate(T, grid))
    columns = RNG.normal(size=(4, 1, 3))
    same(STACK.simulate(T, lazily(columns, 2, 1), TURNS), STACK.simulate(T, columns, TURNS))
    same(BODY.simulate(T, lazily(OMEGA[0])), BODY.simulate(T, OMEGA[0]))


@pytest.mark.parametrize("shape", [(1, 3), (3, 1, 3), (1, 4, 3), (2, 3, 1, 3), (1, 1, 1, 3)])
def test_axes_of_one_row_stay(shape: tuple[int, ...]) -> None:
    omega = RNG.normal(size=shape)
    chunks = (1,) * (len(shape) - 1)
    same(BODY.simulate(T, lazily(omega, *chunks)), BODY.simulate(T, omega))
    same(STACK[:1].simulate(T, lazily(omega, *chunks)), STACK[:1].simulate(T, omega))
    same(BODY.simulate(T, lazily(OMEGA[0]), TURNS[:1]), BODY.simulate(T, OMEGA[0], TURNS[:1]))


def test_methods_are_those_of_the_whole_stack() -> None:
    """By itself, the first chunk would be tops, with another method."""
    moments = np.concatenate([np.tile([0.9, 0.9, 0.5], (5, 1)), np.tile([0.9, 1.3, 1.0], (5, 1))])
    bodies: Any = RigidBody.from_principal(np.ones(10), moments).translated((0, 0, 1))
    options: Any = {"load": loads.uniform_gravity((0, 0, -9.8)), "about": "origin"}
    whole = bodies.simulate(T, OMEGA, **options)
    assert not np.array_equal(bodies[:5].simulate(T, OMEGA[:5], **options).omega, whole.omega[:5])
    same(bodies.simulate(T, lazily(OMEGA, 5), **options), whole)


def test_names_and_coordinates_go_along() -> None:
    named = xarray.DataArray(
        lazily(OMEGA, 4),
        dims=("clone", "xyz"),
        coords={"clone": np.arange(10) * 2, "xyz": list("xyz"), "kind": ("clone", list("aabbccddee"))},
    )
    found = STACK.simulate(T, named)
    assert found.omega.dims == ("clone", "time", "component")
    assert found.clone.to_numpy().tolist() == list(range(0, 20, 2))
    assert found.kind.dims == ("clone",)
    assert np.array_equal(found.sel(clone=6).omega, STACK.simulate(T, OMEGA).omega[3])
    turned = xarray.DataArray(TURNS[:4], dims=("way", "xyzw"))
    both = BODY.simulate(T, named, turned)
    assert both.quaternion.dims == ("clone", "way", "time", "quaternion_component")
    assert np.array_equal(both.omega, BODY.simulate(T, OMEGA[:, None], TURNS[:4]).omega)


def test_coordinates_are_the_same_for_all_arguments() -> None:
    numbers = np.arange(10)
    starts = xarray.DataArray(lazily(OMEGA, 4), dims=("clone", "xyz"), coords={"clone": numbers})
    turns = xarray.DataArray(TURNS, dims=("clone", "xyzw"), coords={"clone": numbers[::-1]})
    with pytest.raises(
        ValueError,
        match=r"omega and attitude: their coordinates of the axis 'clone' are not the same; .*"
        r"attitude\.drop_vars\('clone'\)",
    ):
        BODY.simulate(T, starts, turns)
    whole = BODY.simulate(T, OMEGA, TURNS)
    for other in (turns.assign_coords(clone=numbers), turns.drop_vars("clone")):
        found = BODY.simulate(T, starts, other)
        assert found.clone.to_numpy().tolist() == numbers.tolist()
        assert np.array_equal(found.quaternion, whole.quaternion)
    reordered = BODY.simulate(T, *xarray.align(starts, turns.sortby("clone"), join="exact"))
    assert np.array_equal(reordered.quaternion, BODY.simulate(T, OMEGA, TURNS[::-1]).quaternion)


def test_nothing_is_computed_before() -> None:
    def never(_: Any) -> Any:
        raise AssertionError

    lazy = lazily(OMEGA, 3).map_blocks(never, dtype=float, meta=np.empty((0, 0)))
    found = STACK.simulate(T, lazy)
    with pytest.raises(AssertionError):
        found.omega.compute()


def test_each_chunk_is_run_once() -> None:
    runs: list[int] = []

    def counted(omega: Any) -> Any:
        runs.append(len(omega))
        return omega

    lazy = lazily(OMEGA, 5).map_blocks(counted, dtype=float, meta=np.empty((0, 0)))
    BODY.simulate(T, lazy).compute()
    assert runs == [5, 5]


@pytest.mark.usefixtures("two_workers")
def test_two_workers_have_the_bits_of_this_process() -> None:
    same(
        STACK.simulate(T, lazily(OMEGA, 3), load=GRADIENT).compute(),
        STACK.simulate(T, OMEGA, load=GRADIENT),
    )
    times = da.from_array(T, chunks=2)
    found = STACK.free_motion(OMEGA).at(times).compute()
    assert np.array_equal(found.omega, STACK.free_motion(OMEGA).at(T).omega)


def test_an_error_tells_its_chunk() -> None:
    omega = OMEGA.copy()
    omega[7] = np.nan
    with pytest.raises(errors.PolhodeError, match=r"^in the chunk that begins with row 5: .*omega"):
        BODY.simulate(T, lazily(omega, 5)).compute()


class TestExactMotions:
    MOTIONS: Any = {  # noqa: RUF012
        "free": BODY.free_motion(OMEGA[0]),
        "stack": STACK.free_motion(OMEGA),
        "top": RigidBody.from_principal(1.0, (1.0, 1.0, 0.5))
        .translated((0, 0, 1))
        .heavy_top((0.1, 0.2, 9.0), (0.1, 0.0, 0.0, 0.99498743710662), gravity=(0, 0, -9.8)),
        "gyrostat": BODY.gyrostat(wheels=[wheel_of(axis=(0, 0, 1), inertia=0.1, rate=5.0)]).free_motion(
            OMEGA[0]
        ),
    }

    @pytest.mark.parametrize("kind", MOTIONS)
    def test_times_in_chunks(self, kind: str) -> None:
        motion = self.MOTIONS[kind]
        times = np.linspace(-3.0, 50.0, 100)
        found, whole = motion.at(da.from_array(times, chunks=30)), motion.at(times)
        assert found.omega.chunks is not None
        for name in ARRAYS:
            assert found[name].to_numpy().tobytes() == getattr(whole, name).tobytes()
        assert np.array_equal(found.t, times)
        assert found.omega.dims == (*(["body"] * len(motion.shape)), "time", "component")

    def test_times_of_many_axes_and_with_names(self) -> None:
        motion, times = self.MOTIONS["stack"], np.linspace(0.0, 9.0, 12).reshape(3, 4)
        found = motion.at(da.from_array(times, chunks=2))
        assert found.omega.dims == ("body", "time_0", "time_1", "component")
        assert np.array_equal(found.omega, motion.at(times).omega)
        named = xarray.DataArray(times, dims=("orbit", "t"), coords={"orbit": [7, 8, 9]}).chunk(orbit=1)
        found = motion.at(named)
        assert found.omega.dims == ("body", "orbit", "t", "component")
        assert np.array_equal(found.sel(orbit=8).omega, motion.at(times[1]).omega)

    def test_what_is_refused(self) -> None:
        motion, times = self.MOTIONS["free"], da.from_array(T, chunks=2)
        for bad, words in (
            (times + 1j, "t: expected real numbers, got dtype complex128"),
            (times[times > 1.0], r"t: the sizes of its chunks are not known"),
        ):
            with pytest.raises((TypeError, ValueError), match=words):
                motion.at(bad)
        sure = BODY.with_sigma(mass=0.1)
        with pytest.raises(ValueError, match="t: the motion is uncertain"):
            sure.free_motion(OMEGA[0]).at(times)
        with pytest.raises(ValueError, match="t: the motion is uncertain"):
            BODY.free_motion(Uncertain(OMEGA[0], 0.1)).at(times)
        with pytest.raises(ValueError, match="body: carries a covariance"):
            sure.simulate(T, lazily(OMEGA, 5))
        with pytest.raises(ValueError, match=r"omega and body: their axis 'body' has 7 and 10 rows"):
            STACK.simulate(T, lazily(OMEGA[:7], 5))

    def test_names_that_are_taken(self) -> None:
        named = xarray.DataArray(T, dims="component").chunk(component=2)
        with pytest.raises(ValueError, match="t: its axis 'component' has the name of one of the result"):
            self.MOTIONS["free"].at(named)


def test_what_is_in_memory_gives_a_trajectory_as_before() -> None:
    named = xarray.DataArray(OMEGA, dims=("clone", "xyz"))
    assert np.array_equal(BODY.simulate(T, named).omega, BODY.simulate(T, OMEGA).omega)
    assert BODY.free_motion(OMEGA).at(xarray.DataArray(T, dims="time")).omega.shape == (10, 5, 3)


LAZY = lazily(OMEGA, 5)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            {"omega": da.from_array(OMEGA, chunks=(5, 2))},
            r"omega: its 3 components lie in 2 chunks.*rechunk\(\{-1: -1\}\)",
        ),
        (
            {"omega": xarray.DataArray(OMEGA, dims=("n", "xyz")).chunk(n=5, xyz=1)},
            r"omega: its 3 components lie in 3 chunks; put them in one: omega\.chunk\(\{'xyz': -1\}\)",
        ),
        ({"omega": lazily(OMEGA.T, 3)}, r"omega: expected shape \(\.\.\., 3\), got \(3, 10\)"),
        (
            {"omega": xarray.DataArray(OMEGA.T, dims=("xyz", "n")).chunk(n=5)},
            r"omega: expected shape .* the components are to be the last",
        ),
        ({"omega": LAZY[LAZY[:, 0] > 0]}, r"omega: the sizes of its chunks are not known"),
        ({"attitude": lazily(OMEGA, 5)}, r"attitude: expected shape \(\.\.\., 4\)"),
        ({"events": lambda *_: 1.0}, r"events: a run of dask arrays"),
        ({"progress": print}, r"progress: a run of dask arrays.*ProgressBar"),
        ({"states": {"wheel": [0.0]}}, r"states: a run of dask arrays"),
        ({"t": [1.0, 1.0]}, r"t must be strictly monotone"),
        ({"rtol": 1.0}, r"rtol"),
        ({"method": "euler"}, r"method: expected one of"),
        ({"about": "origin", "velocity": (0, 0, 1)}, r"velocity: with about"),
        ({"position": Uncertain((0.0, 0.0, 0.0), 1.0)}, r"position: a run of dask arrays has no covariance"),
        (
            {"omega": xarray.DataArray(OMEGA, dims=("time", "xyz")).chunk(time=5)},
            r"an axis of the stack is named 'time'",
        ),
        (
            {"omega": xarray.DataArray(OMEGA, dims=("n", "xyz")).chunk(n=5), "attitude": np.ones((2, 10, 4))},
            r"a stack of 2 axes beside axes named n",
        ),
        ({"attitude": TURNS[:7]}, r"omega and attitude: their axis 'body' has 10 and 7 rows"),
        ({"omega": LAZY + 1j}, r"omega: expected real numbers, got dtype complex128"),
        ({"omega": da.from_array(np.full((2, 3), "a"))}, r"omega: expected real numbers, got dtype <U1"),
        ({"omega": da.ma.masked_greater(LAZY, 0.0)}, r"omega: its elements may be masked"),
        ({"on_failure": "never"}, r"on_failure: expected"),
        ({"load": 3.0}, r"load"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_computed(arguments: Any, words: str) -> None:
    given = {"t": T, "omega": LAZY} | arguments
    with pytest.raises((ValueError, TypeError), match=words):
        BODY.simulate(**given)


@pytest.mark.parametrize("name", ["time", "omega", "status", "component", "wheel"])
def test_names_of_the_result_are_refused(name: str) -> None:
    load = loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=2.0)
    at_one_time = xarray.DataArray(lazily(OMEGA, 4), dims=("clone", "xyz"), coords={name: 5.0})
    with pytest.raises(ValueError, match=rf"named '{name}', .* leave it out with \.drop_vars\('{name}'\)"):
        BODY.simulate(T, at_one_time, load=load)
    assert BODY.simulate(T, at_one_time.drop_vars(name), load=load).omega.shape == (10, 5, 3)
    with pytest.raises(ValueError, match=f"an axis of the stack is named '{name}'"):
        BODY.simulate(T, xarray.DataArray(lazily(OMEGA, 4), dims=(name, "xyz")), load=load)


@pytest.mark.parametrize("name", ["omega", "position", "component"])
def test_names_of_exact_motions_are_refused(name: str) -> None:
    times = xarray.DataArray(da.from_array(T, chunks=2), dims="orbit", coords={name: 5.0})
    with pytest.raises(ValueError, match=rf"named '{name}', .* leave it out with \.drop_vars\('{name}'\)"):
        BODY.free_motion(OMEGA[0]).at(times)
    with pytest.raises(ValueError, match=f"t: its axis '{name}' has the name of one of the result"):
        BODY.free_motion(OMEGA[0]).at(xarray.DataArray(times.data, dims=name))
