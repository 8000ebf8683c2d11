"""What ensembles once got wrong in silence, each by itself."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import RigidBody, distributions, ensemble, flybys, loads, orbits, reductions
from polhode.errors import PolhodeError
from polhode.reductions import QuantileSketch, quantiles_of, sort_columns

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from polhode import Ensemble

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
SPIN = distributions.normal((0.0, 0.0, 1.0), sigma=0.1)
GAIN = 1.0


def wheel(**options: Any) -> loads.Load:
    """Give a wheel about the third axis."""
    return loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=1.0, **options)


def few(t: list[float], load: Any, **options: Any) -> Ensemble:
    """Give nine members under a load."""
    return ensemble(BODY, t, SPIN, load=load, n=9, seed=1, **options)


def sometimes(rng: np.random.Generator) -> RigidBody:
    """Give a body, or for one of a few members none: its third moment is too large."""
    return RigidBody.from_principal(1.0, (1.0, 2.0, 2.5 + 0.6 * rng.random() ** 8))


def scaled(rng: np.random.Generator) -> np.ndarray:
    """Give an angular velocity that a number of the module shifts."""
    return np.array([0.0, 0.0, GAIN + rng.random()])


def test_a_function_that_makes_no_body_refuses_its_member_alone() -> None:
    many = ensemble(sometimes, [0, 1], SPIN, n=400, seed=1, chunk=100)
    status = many.compute().status.to_numpy()
    assert 0 < (status == "refused").sum() < 200
    assert (status == "complete").sum() == (status != "refused").sum()
    with pytest.raises(PolhodeError, match="member"):
        ensemble(sometimes, [0, 1], SPIN, n=400, seed=1, on_failure="raise").compute()


def test_drawn_elements_that_make_no_orbit_refuse_their_members() -> None:
    def pull(eccentricity: np.ndarray) -> loads.Load:
        return loads.gravity_gradient(
            orbits.from_elements(1.0, eccentricity=eccentricity, periapsis=3.0, epoch=0.0)
        )

    drawn = distributions.apply(pull, distributions.uniform(-1.0, 1.0))
    states = ensemble(BODY, [0, 1], SPIN, load=drawn, n=50, seed=1).compute()
    assert 10 < (states.status == "refused").sum() < 40


def test_states_that_are_no_numbers_refuse_their_members() -> None:
    drawn = distributions.per_member(lambda rng: [np.nan if rng.random() < 0.1 else 1.0])
    states = ensemble(BODY, [0, 1], SPIN, load=wheel(), states={"wheel": drawn}, n=100, seed=3).compute()
    assert 1 < (states.status == "refused").sum() < 30


@pytest.mark.parametrize("name", ["status", "axis", "member", "load.friction", "a/b", ".."])
def test_a_state_needs_a_name_of_its_own(name: str) -> None:
    def made(friction: np.ndarray) -> loads.Load:
        return wheel(name=name, friction=friction)

    drawn = distributions.apply(made, friction=distributions.uniform(0.0, 0.1))
    with pytest.raises(ValueError, match=r"load: a state has the name .* by name="):
        ensemble(BODY, [0, 1], SPIN, load=drawn, n=2, seed=1)


@pytest.mark.parametrize("name", ["file", "allow_pickle", "args", "x y"])
def test_any_other_word_may_name_a_state(name: str, tmp_path: Path) -> None:
    many = ensemble(BODY, [0, 1], SPIN, load=wheel(name=name), n=3, seed=1)
    many.to_npz(tmp_path / "a")
    with np.load(tmp_path / "a" / "chunk-00000000.npz") as found:
        np.testing.assert_array_equal(found[name], many.compute()[name])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: few([0, 1], loads.damping(0.1), method="splitting"), "splitting"),
        (lambda: few([1, 0], wheel(dry_friction=0.02)), "ascending"),
        (lambda: few([0, 1], distributions.apply(wheel, **{"a.b": SPIN})), "no name"),
        (lambda: SPIN.draw(-1, seed=1), "n: expected"),
        (lambda: distributions.samples([1.0, 2.0]).draw(1, seed=1, first=-1), "first: expected"),
        (
            lambda: flybys.flyby(
                BODY, orbits.kepler(1.0, (9, 0, 0), (0, 1, 0)), 1.0, rotation_period=9.0,
                precession_period=7.0, mode="long-axis", reduce=reductions.mean("omega"),
            ),
            "reduce: flyby tells",
        ),
    ],
)  # fmt: skip
def test_a_call_that_is_wrong_for_all_is_told_at_once(make: Callable[[], object], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=re.escape(message)):
        make()


def test_arrays_that_are_given_may_change_afterwards() -> None:
    moments = np.array([1.0, 2.0, 2.5])
    drawn = distributions.apply(RigidBody.from_principal, distributions.uniform(1, 2), moments)
    many = ensemble(drawn, [0, 1], (0.1, 0.2, 1.0), n=3, seed=1)
    before = many.compute().omega.to_numpy()
    moments[2] = 2.9
    np.testing.assert_array_equal(many.compute().omega.to_numpy(), before)


def begun(**options: Any) -> Ensemble:
    """Give four members in chunks of two."""
    return ensemble(BODY, [0, 1], scaled, n=4, seed=1, **({"chunk": 2} | options))


def test_a_number_of_the_module_is_part_of_a_function(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun().to_npz(tmp_path / "a")
    (tmp_path / "a" / "chunk-00000001.npz").unlink()
    monkeypatch.setitem(globals(), "GAIN", 5.0)
    with pytest.raises(ValueError, match="another ensemble"):
        begun().resume(tmp_path / "a")


@pytest.mark.parametrize("kind", ["npz", "zarr"])
def test_a_damaged_chunk_is_made_again(kind: str, tmp_path: Path) -> None:
    if kind == "zarr":
        pytest.importorskip("zarr")
    path, whole = tmp_path / "some", tmp_path / "whole"
    for place in (path, whole):
        getattr(begun(), f"to_{kind}")(place)
    damaged = path / ("chunk-00000001.npz" if kind == "npz" else "omega/1.0.0")
    before = (whole / damaged.relative_to(path)).read_bytes()
    if kind == "npz":
        damaged.write_bytes(before[: len(before) // 2])
    else:
        damaged.unlink()
    begun().resume(path)
    if kind == "npz":
        with np.load(damaged) as found, np.load(whole / damaged.name) as expected:
            np.testing.assert_array_equal(found["omega"], expected["omega"])
    else:
        assert damaged.read_bytes() == before


def test_a_chunk_is_no_larger_than_the_ensemble(tmp_path: Path) -> None:
    pytest.importorskip("zarr")
    begun(chunk=2**61).to_zarr(tmp_path / "a")


def test_what_is_reduced_has_one_shape() -> None:
    def of(motion: Any) -> np.ndarray:
        last: np.ndarray = motion.omega[:, -1]
        return last if len(last) == 4096 else last[:, 0]

    many = ensemble(BODY, [0, 1], SPIN, n=5000, seed=1, reduce=reductions.mean(of))
    with pytest.raises(ValueError, match=r"of: gave shape \(3,\) for some members and \(\) for others"):
        many.compute()


def sketched(seed: int) -> float:
    """Sketch 64 blocks in a tree of equals; by how much ranks are off, in parts of the bound, on average."""
    rng = np.random.default_rng(seed)
    blocks = [sort_columns(rng.uniform(size=(64, 1))) for _ in range(64)]
    every = np.sort(np.concatenate([block.buffers[1] for block in blocks]), axis=0)[:, 0]
    while len(blocks) > 1:
        blocks = [one.merge(other, 64) for one, other in zip(blocks[::2], blocks[1::2], strict=True)]
    sketch: QuantileSketch = blocks[0]
    parts = np.linspace(0.05, 0.95, 91)
    off = np.searchsorted(every, quantiles_of(sketch, parts)[:, 0]) - parts * (len(every) - 1)
    assert np.abs(off).max() <= sketch.error
    return float(off.mean()) / sketch.error


def test_the_errors_of_a_sketch_do_not_add_up() -> None:
    # What is left out is above as often as below.
    found = np.array([sketched(seed) for seed in range(60)])
    assert 15 <= (found > 0.0).sum() <= 45
    assert abs(found.mean()) < 0.1
