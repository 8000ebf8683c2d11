"""What members draw: bits that are published, laws, names that keep draws apart or together."""

from __future__ import annotations

import math
import operator
import pickle
from typing import Any

import mpmath
import numpy as np
import pytest
from polhode import RigidBody, _core, distributions, loads
from polhode.distributions import apply, normal, per_member, samples, uniform, uniform_rotation
from polhode.errors import PolhodeError
from scipy import stats

MANY = 100_000


def bits(seed: int, stream: int, first: int, count: int, width: int) -> Any:
    return _core.random_numbers("bits", seed, stream, first, count, width)


class TestBits:
    """Philox4x64-10: the words of a member are those of the counter (block, 0, member, 0)."""

    @pytest.mark.parametrize("member", [1, 2, 977, 2**40])
    def test_they_are_those_of_numpys_generator(self, member: int) -> None:
        key = np.array([123, 2**63 + 5], dtype=np.uint64)
        # NumPy counts up before the first block: it begins one below.
        counter = np.array([2**64 - 1, 2**64 - 1, member - 1, 0], dtype=np.uint64)
        want = np.random.Philox(counter=counter, key=key).random_raw(10)
        assert np.array_equal(bits(123, 2**63 + 5, member, 1, 10)[0], want)

    def test_they_are_those_that_are_published(self) -> None:
        """Random123's file of known answers: counter and key zero."""
        want = [0x16554D9ECA36314C, 0xDB20FE9D672D0FDC, 0xD7E772CEE186176B, 0x7E68B68AEC7BA23B]
        assert bits(0, 0, 0, 1, 4).tolist() == [want]

    def test_a_member_draws_the_same_wherever_the_rows_begin(self) -> None:
        all_rows = bits(7, 9, 0, 5000, 5)
        assert np.array_equal(bits(7, 9, 4321, 11, 5), all_rows[4321:4332])
        assert np.array_equal(bits(7, 9, 0, 5000, 3), all_rows[:, :3])
        assert bits(7, 9, 3, 0, 5).shape == (0, 5)

    @pytest.mark.parametrize(
        ("arguments", "told"),
        [
            (("words", 0, 0, 0, 1, 1), "law: expected"),
            (("rotation", 0, 0, 0, 1, 3), "width: a rotation has 4 numbers, got 3"),
            (("bits", 0, 0, 2**64 - 1, 2, 1), "first: there are members up to"),
        ],
    )
    def test_refused(self, arguments: tuple[Any, ...], told: str) -> None:
        with pytest.raises(ValueError, match=told):
            _core.random_numbers(*arguments)

    def test_more_than_there_is_memory_for_is_refused(self) -> None:
        with pytest.raises(MemoryError):
            bits(0, 0, 0, 2**40, 2**10)


class TestNumbers:
    def test_uniform_numbers_are_odd_multiples_of_a_unit(self) -> None:
        words, found = bits(3, 4, 0, 1000, 3), _core.random_numbers("uniform", 3, 4, 0, 1000, 3)
        assert np.array_equal(found, ((words >> np.uint64(11)) | np.uint64(1)) * 2.0**-53)

    def test_no_release_changes_what_is_made_of_them(self) -> None:
        seed = 20260413
        (rotation,) = uniform_rotation().draw(1, seed=seed).tolist()
        assert rotation[0].hex() == "-0x1.231db91980fa6p-1"
        assert rotation[3].hex() == "-0x1.090a88a10bcd8p-2"
        (pair,) = normal((0, 0), [[2, 0.5], [0.5, 1]]).draw(1, seed=seed).tolist()
        assert [x.hex() for x in pair] == ["-0x1.9d1d2bc3eb351p+0", "-0x1.bbd420fd0d3eep+0"]
        assert samples([1, 2, 3, 4, 5], "shuffled").draw(5, seed=seed).tolist() == [3, 5, 1, 4, 2]

    def test_normal_numbers_are_exact_to_a_few_units_in_the_last_place(self) -> None:
        words, found = bits(5, 6, 0, 300, 1)[:, 0], _core.random_numbers("normal", 5, 6, 0, 300, 1)[:, 0]
        with mpmath.workdps(40):
            for word, number in zip(words.tolist(), found.tolist(), strict=True):
                beyond = mpmath.mpf(2 * (word % 2**63) + 1) / 2**65
                exact = mpmath.sqrt(2) * mpmath.erfinv(1 - 2 * beyond)
                exact = -exact if word >> 63 else exact
                assert abs(number - exact) <= 6 * math.ulp(float(exact))

    @pytest.mark.parametrize(
        ("law", "shown"),
        [
            (normal(0.0, sigma=1.0), ["-0x1.bbd420fd0d3eep+0", "-0x1.d82ace80c5ecep-2"]),
            (uniform(0.0, 1.0), ["0x1.153d8b3fcf50fp-1", "0x1.a50cc84236525p-1"]),
        ],
    )
    def test_no_release_changes_them(self, law: Any, shown: list[str]) -> None:
        assert [x.hex() for x in law.draw(2, seed=20260413, argument="omega").tolist()] == shown


def p_value(numbers: Any, law: Any) -> float:
    return float(stats.kstest(np.ravel(numbers), law).pvalue)


class TestLaws:
    """Fixed seeds: what passes once passes for ever."""

    def test_normal(self) -> None:
        drawn = normal((1.0, -2.0, 0.0), sigma=(0.5, 2.0, 0.0)).draw(MANY, seed=1)
        assert drawn.shape == (MANY, 3)
        assert p_value((drawn[:, 0] - 1.0) / 0.5, "norm") > 0.01
        assert p_value((drawn[:, 1] + 2.0) / 2.0, "norm") > 0.01
        assert not drawn[:, 2].any()
        assert abs(np.corrcoef(drawn[:, :2].T)[0, 1]) < 4 / math.sqrt(MANY)

    def test_tails(self) -> None:
        drawn = normal(0.0, sigma=1.0).draw(1_000_000, seed=2)
        for bound in (2.0, 3.0, 4.0):
            expected = 2e6 * stats.norm.sf(bound)
            assert abs(np.count_nonzero(abs(drawn) > bound) - expected) < 4 * math.sqrt(expected)
        assert 4.5 < abs(drawn).max() < 6.0

    def test_covariance(self, rng: np.random.Generator) -> None:
        half = rng.normal(size=(4, 4)) * [1.0, 1e-3, 1e3, 1.0]
        want = half.T @ half
        drawn = normal(np.zeros(4), want).draw(MANY, seed=3)
        scale = np.sqrt(np.diag(want))
        assert np.abs((np.cov(drawn.T) - want) / scale / scale[:, None]).max() < 0.02
        combined = drawn @ np.linalg.inv(np.linalg.cholesky(want)).T
        assert all(p_value(column, "norm") > 0.01 for column in combined.T)

    def test_a_factor_gives_the_matrix_back(self, rng: np.random.Generator) -> None:
        for rank in (1, 3, 6):
            half = rng.normal(size=(6, rank))
            factor = _core.covariance_factor(half @ half.T)
            assert np.abs(factor @ factor.T - half @ half.T).max() < 1e-13 * (half @ half.T).max()
            assert not factor[:, rank:].any()

    def test_singular_covariances(self) -> None:
        drawn = normal((0.0, 1.0, 2.0), [[1, 1, 0], [1, 1, 0], [0, 0, 0]]).draw(1000, seed=4)
        assert np.array_equal(drawn[:, 0] + 1.0, drawn[:, 1])
        assert (drawn[:, 2] == 2.0).all()

    def test_a_diagonal_covariance_is_that_of_sigmas(self) -> None:
        one = normal((1.0, 2.0), [[0.25, 0.0], [0.0, 4.0]]).draw(100, seed=5)
        assert np.array_equal(one, normal((1.0, 2.0), sigma=(0.5, 2.0)).draw(100, seed=5))

    def test_uniform(self) -> None:
        drawn = uniform((0.0, -3.0), (1.0, 5.0)).draw(MANY, seed=6)
        assert p_value(drawn[:, 0], "uniform") > 0.01
        assert p_value((drawn[:, 1] + 3.0) / 8.0, "uniform") > 0.01
        assert drawn.min() >= -3.0
        assert (uniform(2.0, 2.0).draw(5, seed=1) == 2.0).all()

    def test_rotations(self) -> None:
        q = uniform_rotation().draw(MANY, seed=7)
        assert np.abs((q * q).sum(axis=1) - 1.0).max() < 1e-15
        assert np.abs(q.T @ q / MANY - np.eye(4) / 4).max() < 0.005
        heights = _core.rotate(q, [0.0, 0.0, 1.0])[:, 2]
        assert p_value(heights, stats.uniform(-1.0, 2.0).cdf) > 0.01
        angle = 2 * np.arccos(np.clip(np.abs(q[:, 3]), 0, 1))
        assert p_value(angle, lambda a: (a - np.sin(a)) / np.pi) > 0.01

    def test_samples(self) -> None:
        rows = np.arange(12.0).reshape(6, 2)
        assert np.array_equal(samples(rows).draw(3, seed=1, first=2), rows[2:5])
        shuffled = samples(rows, "shuffled")
        all_six = shuffled.draw(6, seed=1)
        assert not np.array_equal(all_six, rows)
        assert np.array_equal(np.sort(all_six, axis=0), rows)
        assert np.array_equal(shuffled.draw(2, seed=1, first=3), all_six[3:5])
        anew = samples(np.arange(6.0), "with replacement").draw(60_000, seed=2)
        counts = np.bincount(anew.astype(int), minlength=6)
        assert stats.chisquare(counts).pvalue > 0.01

    def test_a_function_of_a_generator(self) -> None:
        law = per_member(lambda rng: rng.normal(size=2))
        drawn = np.array(law.draw(500, seed=8))
        assert np.array_equal(np.array(law.draw(3, seed=8, first=100)), drawn[100:103])
        assert p_value(drawn, "norm") > 0.01
        assert len(np.unique(drawn)) == 1000


class TestNames:
    def test_arguments_seeds_and_members_draw_apart(self) -> None:
        law = normal(np.zeros(4), sigma=1.0)
        drawn = [
            law.draw(1000, seed=1, argument="omega"),
            law.draw(1000, seed=1, argument="position"),
            law.draw(1000, seed=2, argument="omega"),
            law.draw(1000, seed=1, argument="omega", first=1000),
        ]
        everything = np.concatenate(drawn, axis=1)
        assert np.abs(np.corrcoef(everything.T) - np.eye(16)).max() < 0.15
        assert len(np.unique(everything)) == everything.size

    def test_a_name_goes_before_the_argument(self) -> None:
        law = normal(0.0, sigma=1.0, name="gust")
        one, other = (law.draw(5, seed=1, argument=word) for word in ("omega", "load"))
        assert np.array_equal(one, other)
        wide = normal(10.0, sigma=2.0, name="gust").draw(5, seed=1)
        assert np.array_equal(wide, 10.0 + 2.0 * one)
        # The word "omega" as a name is not the place "omega".
        assert not np.array_equal(
            normal(0.0, sigma=1.0, name="omega").draw(5, seed=1), normal(0.0, sigma=1.0).draw(5, seed=1)
        )

    def test_pickle_keeps_the_numbers(self) -> None:
        for law in (normal((1, 2), [[1, 0.5], [0.5, 1]]), uniform(0, 1), uniform_rotation(), samples([1, 2])):
            again = pickle.loads(pickle.dumps(law))
            assert np.array_equal(again.draw(2, seed=3), law.draw(2, seed=3))
            assert repr(again) == repr(law)

    def test_arrays_are_read_only(self) -> None:
        mean = np.zeros(3)
        law = normal(mean, sigma=1.0)
        mean[:] = 5.0
        assert not law.mean.any()
        with pytest.raises(ValueError, match="read-only"):
            law.mean[0] = 1.0


PRINTED = [
    (lambda: normal((0, 1), sigma=0.5), "Normal(mean=[0.0, 1.0], sigma=[0.5, 0.5])"),
    (lambda: normal((0, 1), np.eye(2), name="a"), "Normal(mean=[0.0, 1.0], sigma=[1.0, 1.0], name='a')"),
    (lambda: uniform(0, 1), "Uniform(low=0.0, high=1.0)"),
    (uniform_rotation, "UniformRotation()"),
    (lambda: samples(np.zeros((9, 3))), "Samples(values=<shape (9, 3)>, order='as given')"),
    (lambda: per_member(id, name="b"), "PerMember(id, name='b')"),
    (lambda: apply(operator.add, 1, uniform(0, 1)), "FunctionOfDraws(add, 1, Uniform(low=0.0, high=1.0))"),
    (lambda: apply(loads.damping, matrix=2), "FunctionOfDraws(damping, matrix=2)"),
]


@pytest.mark.parametrize(("make", "text"), PRINTED)
def test_they_print_on_a_line(make: Any, text: str) -> None:
    assert repr(make()) == text


NOT_POSITIVE = [[1.0, 2.0], [2.0, 1.0]]
REFUSED: list[tuple[Any, type[Exception], str]] = [
    (lambda: normal((0, 0), NOT_POSITIVE), PolhodeError, "the least eigenvalue of the matrix is -1"),
    (lambda: normal((0, 0), [[1.0, 0.5], [0.4, 1.0]]), PolhodeError, "must be symmetric"),
    (lambda: normal((0, 0), [[-1.0, 0.0], [0.0, 1.0]]), PolhodeError, "no negative variance"),
    (lambda: normal((0, 0), np.eye(3)), ValueError, r"covariance: expected shape \(2, 2\)"),
    (lambda: normal((0, 0)), TypeError, "give either covariance or sigma"),
    (lambda: normal((0, 0), np.eye(2), sigma=1.0), TypeError, "give either covariance or sigma"),
    (lambda: normal(0, sigma=-1.0), ValueError, "sigma: expected numbers that are zero or more, got -1"),
    (lambda: normal((0, 0), sigma=(1, 1, 1)), ValueError, r"sigma: shape \(3,\) does not broadcast"),
    (lambda: normal(np.nan, sigma=1.0), ValueError, "mean must be finite, got nan"),
    (lambda: uniform(2.0, 1.0), ValueError, "low must not exceed high, got 2 and 1"),
    (lambda: uniform(-1e308, 1e308), ValueError, "leaves the range of float64"),
    (lambda: uniform((1, 2), (1, 2, 3)), ValueError, "do not broadcast"),
    (lambda: samples(3.0), ValueError, "with one row at least"),
    (lambda: samples([1.0], "random"), ValueError, "order: expected"),  # type: ignore[arg-type]
    (lambda: samples([1.0]).draw(2, seed=1), ValueError, "2 members want a row each"),
    (lambda: apply(3), TypeError, "function: expected a function"),  # type: ignore[arg-type]
    (lambda: per_member(3), TypeError, "function: expected a function"),  # type: ignore[arg-type]
    (lambda: uniform(0, 1, name=""), TypeError, "name: expected a word"),
    (lambda: uniform(0, 1).draw(1, seed=-1), ValueError, "seed: expected an integer from 0"),
    (lambda: uniform(0, 1).draw(1, seed=2**64), ValueError, "seed: expected an integer from 0"),
    (lambda: uniform(0, 1).draw(1, seed=1.5), TypeError, "seed: expected an integer"),  # type: ignore[arg-type]
    (lambda: _core.covariance_factor(np.zeros((2, 3))), ValueError, r"expected shape \(k, k\), got \(2, 3\)"),
]


@pytest.mark.parametrize(("call", "kind", "told"), REFUSED)
def test_refused(call: Any, kind: type[Exception], told: str) -> None:
    with pytest.raises(kind, match=told):
        call()


def test_made_bodies_have_the_numbers_that_are_drawn() -> None:
    recipe = apply(RigidBody.from_principal, 1.0, normal((1.0, 2.0, 2.5), sigma=0.01))
    assert list(recipe.parts()) == ["0", "1"]
    assert distributions.apply(dict, b=1, a=2).parts() == {"a": 2, "b": 1}
