"""What ensembles keep in place of states: against NumPy, in trees of every shape, within stated errors."""

from __future__ import annotations

import operator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from ensemble_cases import BODY, SPIN, TIMES, all_bytes, all_reductions, last_spin, twisted
from polhode import RigidBody, distributions, ensemble, loads, reductions
from polhode.ensembles.merge_tree import Tree
from polhode.reductions import compact, moments, quantiles_of, sort_columns, sum_by_halves

N = 10_000


@pytest.fixture(scope="module")
def states() -> Any:
    """All states of an ensemble that is reduced too, without the members that failed."""
    found = twisted(N).compute()
    return found.omega.values[found.status.values == "complete"]


@pytest.fixture(scope="module")
def results() -> Any:
    return twisted(N, reduce=all_reductions()).compute()


class TestAgainstTheStates:
    def test_members(self, states: Any, results: Any) -> None:
        assert {(one.members, one.left_out) for one in results.values()} == {(len(states), N - len(states))}
        assert 0 < len(states) < N

    def test_mean(self, states: Any, results: Any) -> None:
        assert results["mean"].mean.shape == (3, 3)
        assert np.abs(results["mean"].mean - states.mean(axis=0)).max() < 1e-14

    def test_covariance(self, states: Any, results: Any) -> None:
        assert np.abs(results["covariance"].mean - states[:, -1].mean(axis=0)).max() < 1e-14
        assert np.abs(results["covariance"].covariance - np.cov(states[:, -1].T)).max() < 1e-14

    def test_histogram(self, states: Any, results: Any) -> None:
        found = results["histogram"]
        for axis in range(3):
            values = states[:, -1, axis]
            assert np.array_equal(found.counts[axis], np.histogram(values, found.edges)[0])
            assert found.below[axis] == np.count_nonzero(values < found.edges[0])
            assert found.above[axis] == np.count_nonzero(values > found.edges[-1])

    def test_quantiles(self, states: Any, results: Any) -> None:
        found = results["quantiles"]
        want = np.quantile(states[:, -1], found.q, axis=0)
        assert found.rank_error == 0.0
        assert np.abs(found.values - want).max() < 1e-15
        assert np.array_equal(found.values[[0, -1]], want[[0, -1]])

    def test_modes(self, results: Any) -> None:
        found = results["modes"]
        small = twisted(200, reduce=reductions.mode_changes()).compute()
        many, count = twisted(200), np.zeros_like(small.table)
        for k in np.flatnonzero(many.compute().status.values == "complete"):
            run = many.member(int(k))
            start, end = (run.body.free_motion(run.omega[i]).mode for i in (0, -1))
            count[small.modes.index(start), small.modes.index(end)] += 1
        assert np.array_equal(small.table, count)
        assert found.table.sum() == found.members
        assert np.count_nonzero(found.table) == 2


class TestBits:
    def test_chunks_change_none(self, results: Any) -> None:
        want = all_bytes(results)
        for chunk in (8192, 2**20):
            assert all_bytes(twisted(N, reduce=all_reductions(), chunk=chunk).compute()) == want

    @pytest.mark.parametrize("leaves", [1, 2, 3, 5, 8, 13, 64, 100])
    def test_a_tree_is_the_same_in_any_order(self, leaves: int, rng: np.random.Generator) -> None:
        def merged(one: str, other: str) -> str:
            return f"({one}{other})"

        found = set()
        for _ in range(20):
            tree: Tree[str] = Tree(leaves, merged)
            for index in rng.permutation(leaves).tolist():
                tree.add((0, index), f"{index} ")
            found.add(tree.root)
            assert len(tree.nodes) == 1
        # In pieces of some leaves each, as chunks are.
        for size in (1, 2, 3, 7, leaves):
            tree = Tree(leaves, merged)
            for start in reversed(range(0, leaves, size)):
                piece: Tree[str] = Tree(leaves, merged)
                for index in range(start, min(start + size, leaves)):
                    piece.add((0, index), f"{index} ")
                for place, state in piece.nodes.items():
                    tree.add(place, state)
            found.add(tree.root)
        (text,) = found
        assert [int(word) for word in text.replace("(", "").replace(")", "").split()] == list(range(leaves))


class TestSums:
    @pytest.mark.parametrize("count", [1, 2, 3, 7, 4095, 4096])
    def test_halves_hold_every_row_once(self, count: int, rng: np.random.Generator) -> None:
        rows = rng.normal(size=(count, 2))
        exact = [float(sum(map(Fraction, column.tolist()))) for column in rows.T]
        assert np.abs(sum_by_halves(rows) - exact).max() < 1e-15 * count**0.5 * 4

    def test_moments_of_parts_are_those_of_all(self, rng: np.random.Generator) -> None:
        rows = 1e8 + rng.normal(size=(1000, 3))
        parts = [moments(part, products=True) for part in np.split(rows, [1, 300, 777])]
        both = parts[0].merge(parts[1]).merge(parts[2].merge(parts[3]))
        assert both.members == 1000
        assert np.abs(both.mean - rows.mean(axis=0)).max() < 1e-7
        assert np.abs(np.asarray(both.products) / 999 - np.cov(rows.T)).max() < 1e-6

    @pytest.mark.parametrize("place", [0, 5, 8191])
    def test_infinite_values_have_an_infinite_mean(self, place: int, rng: np.random.Generator) -> None:
        rows = rng.normal(size=(8192, 5))
        rows[place, :4] = np.inf, -np.inf, np.nan, np.inf
        rows[100, 3] = -np.inf
        one, other = (moments(part, products=True) for part in np.split(rows, 2))
        for both in (one.merge(other), other.merge(one)):
            assert np.array_equal(both.mean[:4], [np.inf, -np.inf, np.nan, np.nan], equal_nan=True)
            products = np.asarray(both.products)
            assert np.isnan(products[:4]).all()
            assert np.isnan(products[:, :4]).all()
            assert both.mean[4] == pytest.approx(rows[:, 4].mean(), abs=1e-14)
            assert products[4, 4] / 8191 == pytest.approx(rows[:, 4].var(ddof=1), rel=1e-12)

    def test_an_ensemble_with_infinite_values_tells_so(self) -> None:
        def ratio(motion: Any) -> Any:
            with np.errstate(divide="ignore"):
                return 1.0 / np.maximum(motion.omega[:, 0, 0], 0.0)

        found = twisted(N, t=(0.0,), reduce=reductions.mean(ratio)).compute()
        assert found.mean == np.inf
        assert found.members > 4096


class TestSketch:
    @pytest.mark.parametrize("most", [64, 256])
    @pytest.mark.parametrize("kind", ["normal", "ascending", "few values"])
    def test_ranks_are_within_the_stated_error(self, most: int, kind: str, rng: np.random.Generator) -> None:
        values = rng.normal(size=(20_000, 2))
        if kind == "ascending":
            values = np.sort(values, axis=0)
        if kind == "few values":
            values = np.round(values * 2)
        tree: Tree[Any] = Tree(100, lambda one, other: one.merge(other, most))
        for index, part in enumerate(np.split(values, 100)):
            tree.add((0, index), compact(sort_columns(part), most))
        sketch = tree.root
        assert sum(weight * len(held) for weight, held in sketch.buffers.items()) == 20_000
        assert sum(map(len, sketch.buffers.values())) < 12 * most
        assert 0 < sketch.error < 20_000 * 12 / most
        q = np.linspace(0, 1, 101)
        found = quantiles_of(sketch, q)
        for column in range(2):
            below = (values[:, [column]] < found[:, column]).sum(axis=0)
            up_to = (values[:, [column]] <= found[:, column]).sum(axis=0)
            rank = q * 19_999
            assert (below - sketch.error <= rank + 1).all()
            assert (up_to + sketch.error >= rank).all()

    def test_more_than_a_million_members(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(reductions, "MOST_EXACT", 10_000)
        monkeypatch.setattr(reductions, "KEPT", 1000)
        many = ensemble(BODY, [0.0], SPIN, n=30_000, seed=1, reduce=reductions.quantiles((0.1, 0.5), "omega"))
        found = many.compute()
        assert found.values.shape == (2, 1, 3)
        assert 0.0 < found.rank_error < 0.01
        exact = np.sort(SPIN.draw(30_000, seed=1), axis=0)
        for q, values in zip((0.1, 0.5), found.values[:, 0], strict=True):
            for axis in range(3):
                rank = np.searchsorted(exact[:, axis], values[axis])
                assert abs(rank / 30_000 - q) <= found.rank_error + 1e-4


class TestWhatIsNoNumber:
    def test_it_is_told(self) -> None:
        def odd(motion: Any) -> Any:
            values = motion.omega[:, -1, 0].copy()
            values[:3] = np.nan
            return values

        kept = {
            "mean": reductions.mean(odd),
            "histogram": reductions.histogram((-1, 0, 1), odd),
            "quantiles": reductions.quantiles(0.5, odd),
        }
        found = ensemble(BODY, TIMES, SPIN, n=100, seed=1, reduce=kept).compute()
        assert np.isnan(found["mean"].mean)
        assert found["histogram"].not_a_number == 3
        assert np.isnan(found["quantiles"].values).all()

    def test_no_member_is_left(self) -> None:
        push = loads.torque_callback(lambda t, omega, q: 1e9 * omega**3)  # noqa: ARG005
        kept = all_reductions()
        found = ensemble(BODY, [0, 1], (1, 1, 1), load=push, n=4, seed=1, reduce=kept, rtol=1e-6).compute()
        assert {(one.members, one.left_out) for one in found.values()} == {(0, 4)}
        assert np.isnan(found["mean"].mean)


WHEEL = loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=1.0)
REFUSED: list[tuple[Any, type[Exception], str]] = [
    (lambda: reductions.mean("spin"), ValueError, "of: 'spin' is not one of 'omega'"),
    (lambda: reductions.mean(3), TypeError, "of: expected the name of a state or a function"),  # type: ignore[arg-type]
    (lambda: reductions.histogram([1.0], "omega"), ValueError, "bins: expected two or more increasing edges"),
    (lambda: reductions.histogram([1.0, 1.0], "omega"), ValueError, "bins: expected two or more"),
    (lambda: reductions.quantiles(1.5, "omega"), ValueError, "q: expected one or more numbers from 0 to 1"),
    (lambda: reductions.quantiles([], "omega"), ValueError, "q: expected one or more numbers from 0 to 1"),
    (lambda: run(reductions.mean(lambda _: 1.0)), ValueError, "of: expected a first axis of 10 members"),
    (lambda: run(reductions.mean(lambda motion: motion.omega.T)), ValueError, "of: expected a first axis"),
    (lambda: run(reductions.covariance("omega"), t=np.arange(400)), ValueError, "1000 numbers of a member"),
    (lambda: run(reductions.mode_changes(), load=WHEEL), ValueError, "carries wheels"),
]  # fmt: skip


def run(reduction: Any, t: Any = TIMES, load: Any = None) -> Any:
    return ensemble(BODY, t, SPIN, load=load, n=10, seed=1, reduce=reduction).compute()


@pytest.mark.parametrize(("call", "kind", "told"), REFUSED)
def test_refused(call: Any, kind: type[Exception], told: str) -> None:
    with pytest.raises(kind, match=told):
        call()


@pytest.mark.parametrize(
    ("reduction", "text"),
    [
        (reductions.mean("omega"), "Mean(of='omega')"),
        (reductions.covariance(last_spin), "Covariance(of='last_spin')"),
        (reductions.histogram((0, 1), "omega"), "Histogram(bins=[0.0, 1.0], of='omega')"),
        (
            reductions.quantiles(0.5, operator.attrgetter("omega")),
            "Quantiles(q=[0.5], of=operator.attrgetter",
        ),
        (reductions.mode_changes(), "ModeChanges()"),
    ],
)
def test_they_print_on_a_line(reduction: Any, text: str) -> None:
    assert repr(reduction).replace('"', "").startswith(text)


def test_results_print_on_a_line() -> None:
    found = run(reductions.histogram((0, 1, 2), lambda motion: motion.omega[:, 0, 2]))
    assert repr(found).startswith("HistogramCounts(counts=[")


@pytest.mark.long
def test_a_million_members_are_reduced_with_the_bits_of_other_chunks() -> None:
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    spin = distributions.normal((0.2, 0.1, 1.0), sigma=0.2)
    kept = {"c": reductions.covariance(last_spin), "q": reductions.quantiles((0.1, 0.9), last_spin)}
    both = [ensemble(body, [0, 10], spin, n=1_200_000, seed=1, reduce=kept, chunk=c) for c in (4096, 40_960)]
    one, other = (many.compute() for many in both)
    assert all_bytes(one) == all_bytes(other)
    assert 0.0 < one["q"].rank_error < 1e-3
