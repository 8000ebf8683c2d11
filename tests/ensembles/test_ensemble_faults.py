"""Ensembles of which members fail: what is kept of them, what functions see, when they are given up."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from ensemble_cases import BODY, SPIN, all_bytes, twisted
from polhode import RigidBody, distributions, ensemble, errors, loads, reductions
from polhode.ensembles import cluster as cluster_of_ensembles
from polhode.errors import FileFormatError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from polhode import Trajectory

pytest.importorskip("xarray")
BLOCK = 4096


def drifting(**options: Any) -> Any:
    """Of which a few turn ten thousand times as fast as the others, and take as many more steps."""
    fast = distributions.samples(np.array([[0.1, 0.2, 1.0]] * 9 + [[100.0, 2e4, 300.0]]))
    return ensemble(BODY, [0.0, 10.0], fast, n=10, seed=1, method="dop853", **options)


class TestRefusedMembers:
    def test_they_keep_what_they_drew(self) -> None:
        found = twisted(300).compute()
        lost = found.status.to_numpy() == "refused"
        assert 0 < lost.sum() < 300
        same_draws = ensemble(
            BODY, [0.0, 1.0], SPIN, distributions.uniform_rotation(), n=300, seed=5
        ).compute()
        for name in ("omega", "quaternion"):
            assert np.abs(found[name][lost, 0] - same_draws[name][lost, 0]).max() <= 1e-15
            assert np.isnan(found[name][lost, 1:]).all()

    def test_those_drawn_one_by_one_too(self) -> None:
        def body(rng: np.random.Generator) -> RigidBody:
            return RigidBody.from_principal(1.0, (1.0, 2.0, rng.uniform(2.0, 4.0)))

        def spin(rng: np.random.Generator) -> Any:
            return rng.normal(size=3)

        found = ensemble(body, [0.0, 1.0], spin, n=40, seed=3).compute()
        lost = found.status.to_numpy() == "refused"
        want = ensemble(BODY, [0.0, 1.0], spin, n=40, seed=3).compute()
        assert 0 < lost.sum() < 40
        assert np.array_equal(found.omega[lost, 0], want.omega[lost, 0])
        # The attitude was not drawn, and nothing is known of it.
        assert np.isnan(found.quaternion[lost]).all()

    def test_files_have_them_too(self, tmp_path: Path) -> None:
        twisted(60, chunk=30).to_npz(tmp_path / "out")
        found = twisted(60).compute()
        parts = [np.load(tmp_path / "out" / f"chunk-{k:08}.npz")["omega"] for k in range(2)]
        assert np.concatenate(parts).tobytes() == found.omega.to_numpy().tobytes()


class TestWhatFunctionsSee:
    def test_no_member_that_failed(self) -> None:
        seen: list[int] = []

        def of(motion: Trajectory) -> Any:
            assert np.isfinite(motion.omega).all()
            assert set(np.unique(motion.status)) == {"complete"}
            assert motion.failures == ()
            count = len(motion.omega)
            assert motion.kinetic_energy().total.shape == (count, 2)
            assert motion.angular_momentum().total.shape == (count, 2, 3)
            assert motion.torque().shape == (count, 2, 3)
            assert len(motion.body) == count
            seen.append(count)
            return motion.omega[:, -1] / np.abs(motion.omega[:, -1]).max()

        found = twisted(300, t=(0.0, 1.0), reduce=reductions.mean(of)).compute()
        states = twisted(300, t=(0.0, 1.0)).compute()
        good = states.omega.to_numpy()[states.status.to_numpy() == "complete", -1]
        assert seen == [len(good)]
        assert found.left_out == 300 - len(good) > 0
        assert found.mean == pytest.approx((good / np.abs(good).max()).mean(axis=0), rel=1e-12)

    def test_nor_one_that_failed_on_the_way(self) -> None:
        found = drifting(max_steps=5000, reduce=reductions.mean(lambda motion: motion.omega[:, -1])).compute()
        assert (found.members, found.left_out) == (9, 1)
        assert np.isfinite(found.mean).all()

    def test_motions_that_carry_wheels_keep_their_momentum(self) -> None:
        wheel = loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=2.0)
        kept = {
            "states": reductions.mean(lambda m: m.states["wheel"]),
            "L": reductions.mean(lambda m: m.angular_momentum().total),
        }
        found = ensemble(BODY, [0.0, 1.0], SPIN, load=wheel, n=50, seed=1, reduce=kept).compute()
        run = ensemble(BODY, [0.0, 1.0], SPIN, load=wheel, n=50, seed=1)
        momenta = [run.member(k).angular_momentum().total for k in range(50)]
        assert found["L"].mean == pytest.approx(np.mean(momenta, axis=0), rel=1e-12)

    @pytest.mark.parametrize("n", [300, BLOCK + 300])
    def test_nobody_changes_the_states_of_the_others(self, n: int) -> None:
        def spoil(motion: Trajectory) -> Any:
            motion.omega[:] -= 1.0
            return motion.omega

        def spoil_a_part(motion: Trajectory) -> Any:
            last = motion.quaternion[:, -1]
            last *= 2.0
            return last

        for bad in (spoil, spoil_a_part):
            with pytest.raises(ValueError, match=r"read-only[^:]*of=\nall .* change a copy"):
                twisted(n, reduce={"a": reductions.mean(bad), "b": reductions.mean("omega")}).compute()

        def shifted(motion: Trajectory) -> Any:
            own = motion.omega.copy()
            own -= 1.0
            return own

        both = twisted(n, reduce={"a": reductions.mean(shifted), "b": reductions.mean("omega")}).compute()
        assert all_bytes(both["b"]) == all_bytes(twisted(n, reduce=reductions.mean("omega")).compute())

    def test_a_covariance_of_nothing(self) -> None:
        nothing = reductions.covariance(lambda motion: motion.omega[:, :, :0])
        with pytest.raises(
            ValueError, match=r"of: a covariance of nothing: got an array of shape \(\d+, 3, 0\)"
        ):
            twisted(50, reduce=nothing).compute()


class TestStepsAtMost:
    def test_a_member_that_would_take_more_fails(self) -> None:
        free = drifting().compute()
        found = drifting(max_steps=5000).compute()
        assert found.status.to_numpy().tolist() == ["complete"] * 9 + ["failed"]
        assert np.array_equal(found.omega[:9], free.omega[:9])
        assert np.isnan(found.omega[9, 1]).all()
        with pytest.raises(errors.IntegrationError, match=r"member 9: .*a run takes 5e3 at most"):
            drifting(max_steps=5000, on_failure="raise").compute()

    @pytest.mark.parametrize("method", ["taylor", "dop853", "radau", "splitting"])
    def test_every_method_counts(self, method: str) -> None:
        load = loads.constant_torque((0.0, 0.0, 1e-3), frame="space")
        options: Any = {"load": load, "method": method, "rtol": 1e-9 if method != "radau" else 1e-6}
        run = BODY.simulate([0.0, 300.0], (0.1, 0.2, 1.0), **options)
        steps = int(run.steps)
        assert (
            BODY.simulate([0.0, 300.0], (0.1, 0.2, 1.0), **options, max_steps=2 * steps + 2).status
            == "complete"
        )
        with pytest.raises(errors.IntegrationError, match=r"and would take .* in all") as caught:
            BODY.simulate([0.0, 300.0], (0.1, 0.2, 1.0), **options, max_steps=steps // 2)
        assert 0.0 < caught.value.time < 300.0

    @pytest.mark.parametrize("method", ["taylor", "dop853"])
    @pytest.mark.parametrize("most", [1, 3, 7, 12, 18])
    def test_neighbours_do_not_matter(self, method: str, most: int) -> None:
        omega = np.random.default_rng(most).normal(size=(40, 3)) * 10.0
        options: Any = {"load": loads.constant_torque((1.0, 0.0, 0.0)), "method": method}
        options |= {"max_steps": most, "on_failure": "keep"}
        alone = [str(BODY.simulate([0.0, 2.0], one, **options).status) for one in omega]
        assert BODY.simulate([0.0, 2.0], omega, **options).status.tolist() == alone
        pairs = [BODY.simulate([0.0, 2.0], omega[k : k + 2], **options).status for k in range(0, 40, 2)]
        assert np.concatenate(pairs).tolist() == alone

    @pytest.mark.parametrize("most", [3, 12])
    def test_chunks_do_not_matter(self, most: int) -> None:
        def status(chunk: int) -> Any:
            omega = distributions.normal((0.0, 0.0, 3.0), sigma=(10.0, 10.0, 10.0))
            load = loads.constant_torque((1.0, 0.0, 0.0))
            found = ensemble(BODY, [0.0, 2.0], omega, load=load, n=60, seed=1, chunk=chunk, max_steps=most)
            return found.compute().status.to_numpy().tolist()

        first = status(1)
        assert all(status(chunk) == first for chunk in (2, 3, 5, 60))

    def test_closed_forms_take_none(self) -> None:
        assert BODY.simulate([0.0, 1e6], (0.1, 0.2, 1.0), max_steps=1).status == "complete"

    @pytest.mark.parametrize("count", [0, -3])
    def test_a_limit_is_positive(self, count: int) -> None:
        with pytest.raises(ValueError, match=f"max_steps: expected a positive integer, got {count}"):
            drifting(max_steps=count)


class TestWhatCannotBeSent:
    def held(self) -> Any:
        lock = threading.Lock()

        def spin(rng: np.random.Generator) -> Any:
            with lock:
                return rng.normal(size=3)

        return ensemble(BODY, [0.0, 1.0], spin, n=20, seed=1)

    def test_a_lock_in_a_function(self, tmp_path: Path) -> None:
        pytest.importorskip("cloudpickle")
        with pytest.raises(
            TypeError, match=r"client: a function .* cannot be sent to workers: .*lock.*; make locks"
        ):
            cluster_of_ensembles._serialize(self.held().plan)
        with pytest.raises(
            TypeError, match=r"cannot be told from another one in files: .*lock.*; make locks"
        ):
            self.held().to_npz(tmp_path / "out")
        assert len(self.held().compute().member) == 20


def once(**options: Any) -> Any:
    given: dict[str, Any] = {"body": BODY, "t": [0, 1], "omega": SPIN, "n": 10, "seed": 1}
    return ensemble(**(given | options))


def inverse(numbers: Any) -> Any:
    raise ZeroDivisionError(f"of {len(numbers)}")


@pytest.mark.parametrize(
    ("make", "notes"),
    [
        (
            lambda: once(omega=lambda rng: {}[rng.integers(1)]),
            ["raised by ", "for member 0", "in the argument 'omega' of the ensemble"],
        ),
        (
            lambda: once(body=distributions.apply(inverse, distributions.normal(1.0, sigma=0.1))),
            ["in the argument 'body' of the ensemble"],
        ),
        (
            lambda: once(reduce=reductions.mean(lambda motion: 1 / 0 * motion.t)).compute(),
            ["raised by the function of a reduction, of="],
        ),
    ],
)
def test_errors_of_functions_say_where_they_stand(make: Callable[[], object], notes: list[str]) -> None:
    with pytest.raises((KeyError, ZeroDivisionError)) as raised:
        make()
    told = " ".join(raised.value.__notes__)
    assert all(note in told for note in notes)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: once(omega=lambda rng: (1, 2)[: rng.integers(1, 3)]),
            ValueError,
            "omega: expected 3 numbers",
        ),
        (lambda: once(omega=lambda rng: rng and None), ValueError, "the function gave None for one"),
        (lambda: once(n=2**62), ValueError, "n: expected an integer below 2\\*\\*62, got 4611"),
        (
            lambda: once(n=2**61).to_npz("never"),
            ValueError,
            "chunk: 2305843009213693952 members in chunks of 4096 are 562949953421312 chunks, more than "
            "16777216; give chunk=137438953472 or more",
        ),
        (
            lambda: once(n=2**50, chunk=2**50).to_npz("never"),
            MemoryError,
            "chunk: 1125899906842624 members together take .* GB and this machine has .* give a smaller",
        ),
        (lambda: once(reduce={}), TypeError, "reduce: expected a reduction or a dict of them, got an empty"),
        (lambda: once(states=5), TypeError, "states: expected a dict of names to numbers, got int"),
        (lambda: once(max_steps=1.5), TypeError, "max_steps: expected a positive integer, got 1.5"),
        (lambda: once(rtol=-1), ValueError, "^rtol must be between"),
        (lambda: once(atol=-1), ValueError, "^atol must be zero or more, got -1"),
        (lambda: once().member(1.5), TypeError, "k: expected the number of a member, an integer, got 1.5"),
        (
            lambda: once(reduce=reductions.mean("omega")).compute(checkpoint="no/such/file"),
            FileNotFoundError,
            "checkpoint: no.such.file: there is no directory no.such; check the path or create it first",
        ),
        (
            lambda: once(reduce=reductions.mean("omega")).compute(checkpoint="."),
            IsADirectoryError,
            "checkpoint: . is a directory; give the name of a file in it",
        ),
        (
            lambda: once(reduce=reductions.mean("omega"), n=10_000, chunk=5000),
            ValueError,
            "multiple of 4096.*; got 5000, and the next one is 8192$",
        ),
        (lambda: once().to_npz(f"{__file__}/all"), NotADirectoryError, "all: .* is a file, not a directory"),
        (
            lambda: once(t=[0, 1], omega=(0, 0, 1e300)),
            ValueError,
            "none of the first 10 members can begin; member 0: t = ",
        ),
    ],
)
def test_what_can_never_run_is_refused_before_anything_is(
    make: Callable[[], object],
    error: type[Exception],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=message):
        make()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("header", [b"{", b"[]", b"\xff\xfe"])
def test_a_damaged_header_is_told(tmp_path: Path, header: bytes) -> None:
    once().to_npz(tmp_path / "out")
    (tmp_path / "out" / "ensemble.json").write_bytes(header)
    with pytest.raises(
        FileFormatError, match=r"ensemble\.json does not say what ensemble this is; begin anew"
    ):
        once().resume(tmp_path / "out")
