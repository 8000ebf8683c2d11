"""Ensembles on one machine: members and their bits, failures, what is refused."""

from __future__ import annotations

import operator
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import polhode
import pytest
from ensemble_cases import BODY, SPIN, TIMES, all_bytes, all_reductions, last_spin, python, twisted
from polhode import RigidBody, Uncertain, distributions, ensemble, loads, orbits, reductions
from polhode.ensembles.fingerprint import fingerprint
from polhode.errors import IntegrationError, InvalidInertiaError
from scipy.spatial.transform import Rotation


class TestMembers:
    def test_each_has_the_bits_of_its_own_run(self) -> None:
        many = twisted(60)
        found = many.compute()
        assert {"complete", "refused"} == set(found.status.values)
        for k in range(60):
            if found.status[k] == "refused":
                assert np.isnan(found.omega[k, 1:]).all()
                with pytest.raises(InvalidInertiaError, match="triangle"):
                    many.member(k)
                continue
            alone = many.member(k)
            assert np.array_equal(alone.omega, found.omega[k])
            assert np.array_equal(alone.quaternion, found.quaternion[k])

    def test_they_are_what_simulate_makes_of_what_is_drawn(self) -> None:
        many = ensemble(BODY, TIMES, SPIN, distributions.uniform_rotation(), n=20, seed=3)
        found = many.compute()
        omega = SPIN.draw(20, seed=3, argument="omega")
        attitude = distributions.uniform_rotation().draw(20, seed=3, argument="attitude")
        alone = BODY.simulate(TIMES, omega, attitude)
        assert np.array_equal(found.omega, alone.omega)
        assert np.array_equal(found.quaternion, alone.quaternion)
        assert np.array_equal(found.time, TIMES)
        assert found.omega.dims == ("member", "time", "axis")
        assert found.quaternion.dims == ("member", "time", "quaternion_component")
        assert (found.attrs["seed"], found.attrs["n"]) == (3, 20)

    def test_numpy_has_the_same_arrays(self) -> None:
        many = twisted(60)
        found, arrays = many.compute(), many.to_numpy()
        assert list(arrays) == list(found.data_vars)
        for name, array in arrays.items():
            same = np.array_equal(array, found[name], equal_nan=array.dtype.kind == "f")
            assert same, name
        with pytest.raises(ValueError, match="to_numpy: returns states, and with reduce= none are kept"):
            twisted(9, reduce=all_reductions()).to_numpy()

    def test_more_members_leave_the_first_as_they_are(self) -> None:
        few, many = twisted(50).compute(), twisted(80, chunk=7).compute()
        for name in few:
            same = np.array_equal(few[name], many[name][:50], equal_nan=few[name].dtype.kind == "f")
            assert same, name

    @pytest.mark.parametrize("method", ["auto", "taylor", "dop853", "splitting"])
    def test_chunks_change_no_bit(self, method: str) -> None:
        torque = distributions.normal((0, 0.1, 0), sigma=0.1)
        twist = distributions.apply(loads.constant_torque, torque, "space") if method == "taylor" else None
        found = {
            all_bytes(
                ensemble(BODY, TIMES, SPIN, load=twist, n=50, seed=2, chunk=chunk, method=method).compute()
            )
            for chunk in (2, 9, 50, 4096)
        }
        assert len(found) == 1

    def test_loads_of_one_chunk_do_not_choose_the_method(self) -> None:
        """Dry friction has no series: alone, a wheel without it would be run by another method."""

        def wheel(friction: Any) -> loads.Load:
            return loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=1.0, dry_friction=friction)

        friction = distributions.samples(np.where(np.arange(30) % 3 == 1, 0.02, 0.0))
        many = [
            ensemble(BODY, TIMES, SPIN, load=distributions.apply(wheel, friction), n=30, seed=1, chunk=chunk)
            for chunk in (1, 3, 30)
        ]
        assert len({all_bytes(one.compute()) for one in many}) == 1
        assert many[0].plan.options["method"] == "dop853"
        alone = BODY.simulate(TIMES, SPIN.draw(2, seed=1)[1], load=wheel(0.02))
        assert np.array_equal(many[0].compute().omega[1], alone.omega)
        # Who has dry friction later than in the first members is told.
        late = distributions.samples(np.where(np.arange(30) == 29, 0.02, 0.0))
        with pytest.raises(ValueError, match='the method "taylor" needs loads whose series'):
            ensemble(BODY, TIMES, SPIN, load=distributions.apply(wheel, late), n=30, seed=1).compute()

    def test_threads_and_lanes_change_no_bit(self) -> None:
        code = (
            "import hashlib, ensemble_cases as e\n"
            "from polhode.ensembles.running import arrays_of_chunk\n"
            "plan = e.twisted(400, chunk=90).plan\n"
            "chunks = [arrays_of_chunk(plan, k) for k in range(5)]\n"
            "rows = b''.join(one[name].tobytes() for one in chunks for name in sorted(one))\n"
            "print(hashlib.sha256(rows).hexdigest(),\n"
            "hashlib.sha256(e.all_bytes(e.twisted(400, reduce=e.all_reductions()).compute())).hexdigest())"
        )
        told = {python(code, POLHODE_NUM_THREADS=str(count), PYTHONHASHSEED=str(count)) for count in (1, 2)}
        assert len(told) == 1

    def test_all_that_a_run_has(self) -> None:
        wheel = loads.wheel(axis=(0, 0, 1), inertia=0.1, rate=5.0, torque=0.01)
        moving = ensemble(
            BODY, TIMES, (0, 0, 1), Rotation.identity(), wheel,
            n=4, seed=1, position=distributions.normal((0, 0, 0), sigma=1.0), velocity=(1.0, 0.0, 0.0),
            states={"wheel": distributions.uniform([0.4], [0.6])},
        )  # fmt: skip
        found = moving.compute()
        assert np.allclose(found.position[:, -1] - found.position[:, 0], [4.0, 0.0, 0.0])
        assert found.wheel.dims == ("member", "time", "wheel_component")
        assert ((found.wheel[:, 0] >= 0.4) & (found.wheel[:, 0] <= 0.6)).all()
        alone = moving.member(3)
        assert np.array_equal(alone.position, found.position[3])
        assert np.array_equal(alone.states["wheel"], found.wheel[3])
        few = ensemble(BODY, TIMES, SPIN, n=2, seed=1, outputs=["position"]).compute()
        assert set(few) == {"position", "omega", "status"}
        assert few.omega.dims == ("member", "omega_0"), "what was drawn, where the state is not kept"

    def test_orbits_are_drawn_too(self) -> None:
        pull = distributions.apply(
            loads.gravity_gradient,
            4.0,
            position=distributions.normal((3, 0, 0), sigma=0.01),
            velocity=(0, 1, 0),
        )
        many = ensemble(BODY, TIMES, (0, 0, 1), load=pull, n=5, seed=1)
        found = many.compute()
        orbit = orbits.kepler(4.0, found["load.position"][2].values, (0, 1, 0))
        assert np.array_equal(
            BODY.simulate(TIMES, (0, 0, 1), load=loads.gravity_gradient(orbit)).omega, found.omega[2]
        )

    def test_functions_of_a_generator(self) -> None:
        def body(rng: np.random.Generator) -> RigidBody:
            return RigidBody.from_principal(rng.uniform(1, 2), (1.0, 2.0, 2.5))

        def spin(rng: np.random.Generator) -> Any:
            return rng.normal(size=3)

        def load(rng: np.random.Generator) -> loads.Load:
            return loads.constant_torque(rng.normal(size=3) * 0.1)

        def attitude(rng: np.random.Generator) -> Rotation:
            return Rotation.from_rotvec(rng.normal(size=3))

        many = ensemble(body, TIMES, spin, attitude, load, n=9, seed=4)
        found = many.compute()
        for k in (0, 8):
            assert np.array_equal(many.member(k).omega, found.omega[k])
        cut = ensemble(body, TIMES, spin, attitude, load, n=9, seed=4, chunk=2).compute()
        assert all(np.array_equal(cut[name], found[name]) for name in found)


class TestSources:
    def test_two_places_draw_apart_and_one_object_the_same(self) -> None:
        law, twin = (distributions.normal((0, 0, 1), sigma=0.1) for _ in range(2))

        def drawn(first: Any, second: Any) -> Any:
            return ensemble(BODY, [0.0], first, n=3, seed=1, velocity=second).compute()

        apart, together = drawn(law, twin), drawn(law, law)
        assert not np.array_equal(apart.omega, apart.velocity)
        assert np.array_equal(together.omega, together.velocity)
        assert np.array_equal(apart.omega, together.omega)
        named = drawn(*(distributions.normal((0, 0, 1), sigma=0.1, name="x") for _ in range(2)))
        assert np.array_equal(named.omega, named.velocity)

    def test_rotations_are_made(self) -> None:
        turn = distributions.apply(Rotation.from_rotvec, distributions.normal((0, 0, 0), sigma=1.0))
        found = ensemble(BODY, [0.0], SPIN, turn, n=5, seed=1).compute()
        want = Rotation.from_rotvec(found["attitude.0"].values)
        assert (want.inv() * Rotation.from_quat(found.quaternion[:, 0].values)).magnitude().max() < 1e-15

    def test_order_of_keywords_does_not_matter(self) -> None:
        parts = {
            "position": distributions.normal((3, 0, 0), sigma=0.1),
            "velocity": distributions.normal((0, 1, 0), sigma=0.1),
        }
        both = [
            ensemble(BODY, TIMES, SPIN, n=3, seed=1,
                     load=distributions.apply(loads.gravity_gradient, 4.0, **dict(order)))
            for order in (parts.items(), reversed(parts.items()))
        ]  # fmt: skip
        assert all_bytes(both[0].compute()) == all_bytes(both[1].compute())
        assert fingerprint(both[0].plan) == fingerprint(both[1].plan)

    def test_sums_of_loads_are_made(self) -> None:
        part = distributions.apply(loads.constant_torque, distributions.normal((0, 0, 0), sigma=0.1))
        load = distributions.apply(operator.add, part, loads.damping(np.eye(3) * 0.1))
        found = ensemble(BODY, TIMES, SPIN, load=load, n=3, seed=1).compute()
        one = loads.constant_torque(found["load.0.0"][1].values) + loads.damping(np.eye(3) * 0.1)
        assert np.array_equal(BODY.simulate(TIMES, found.omega[1, 0].values, load=one).omega, found.omega[1])


class TestFailures:
    @staticmethod
    def failing(**options: Any) -> polhode.Ensemble:
        """Motors that spin up for ever: steps end where the rates do."""

        def push(t: float, omega: Any, quaternion: Any) -> Any:  # noqa: ARG001
            return 1e3 * omega**3 if omega[2] > 1.0 else -omega

        return ensemble(
            BODY, [0.0, 1.0], SPIN, load=loads.torque_callback(push), n=8, seed=2, rtol=1e-6, **options
        )

    def test_they_are_kept_with_a_status(self) -> None:
        found = self.failing().compute()
        failed = found.status.values == "failed"
        assert 0 < failed.sum() < 8
        assert np.isnan(found.omega[failed, -1]).all()
        assert not np.isnan(found.omega[:, 0]).any()
        assert not np.isnan(found.omega[~failed]).any()

    def test_they_end_the_ensemble_where_asked_to(self) -> None:
        first = int(np.flatnonzero(self.failing().compute().status.values == "failed")[0])
        with pytest.raises(IntegrationError, match=f"member {first}: ") as caught:
            self.failing(on_failure="raise").compute()
        assert 0.0 < caught.value.time < 1.0
        refused = int(np.flatnonzero(twisted().compute().status.values == "refused")[0])
        with pytest.raises(InvalidInertiaError, match=f"member {refused}: "):
            twisted(on_failure="raise").compute()

    def test_errors_of_ones_own_come_back_as_they_are(self) -> None:
        def omega(rng: np.random.Generator) -> Any:
            raise LookupError(str(rng.integers(3)))

        with pytest.raises(LookupError):
            ensemble(BODY, TIMES, omega, n=3, seed=1)

    def test_a_call_that_nobody_can_begin_is_wrong(self) -> None:
        flat = distributions.apply(RigidBody.from_principal, 1.0, distributions.normal((1, 1, 9), sigma=0.1))
        with pytest.raises(InvalidInertiaError, match="none of the first 16 members can begin; member 0"):
            ensemble(flat, TIMES, SPIN, n=100, seed=1)


MASS = distributions.uniform(1.0, 2.0)
REFUSED: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"n": 0}, ValueError, "n: expected a positive integer, got 0"),
    ({"n": 2.5}, TypeError, "n: expected a positive integer"),
    ({"chunk": -1}, ValueError, "chunk: expected a positive integer"),
    ({"seed": -1}, ValueError, "seed: expected an integer from 0"),
    ({"seed": None}, TypeError, "seed: expected an integer from 0"),
    ({"on_failure": "skip"}, ValueError, "on_failure: expected"),
    ({"omega": np.zeros((10, 3))}, ValueError, "a row for each goes in distributions.samples"),
    ({"omega": distributions.uniform((0, 0), (1, 1))}, ValueError, "omega: expected 3 numbers for each"),
    ({"omega": distributions.samples(np.zeros((9, 3)))}, ValueError, "omega: 10 members want a row each"),
    ({"body": 3.0}, TypeError, "body: expected a RigidBody, a distribution"),
    ({"body": RigidBody.stack([BODY, BODY])}, ValueError, "body: expected one for all members"),
    ({"body": BODY.with_sigma(mass=0.1)}, ValueError, "body: carries a covariance"),
    ({"omega": Uncertain((0, 0, 1), sigma=0.1)}, TypeError, "omega: an Uncertain is given"),
    ({"body": distributions.apply(abs, 2.0)}, TypeError, "body: expected a RigidBody for each member"),
    ({"load": 3.0}, TypeError, "load: expected a Load, a distribution"),
    ({"load": lambda _: 3.0}, TypeError, "load: expected a Load for each member, got float"),
    ({"method": "euler"}, ValueError, "method: expected one of"),
    ({"rtol": 2.0}, ValueError, "rtol"),
    ({"outputs": "omega"}, TypeError, "outputs: expected a sequence of names"),
    ({"outputs": ["spin"]}, ValueError, "outputs: 'spin' is not one of 'omega'"),
    ({"t": [1.0, 0.0, 2.0]}, ValueError, "t must be strictly"),
    ({"reduce": 3}, TypeError, "reduce: expected a reduction or a dict"),
    ({"reduce": {"a": 3}}, TypeError, "reduce: 'a' is no reduction but int"),
    ({"reduce": reductions.mean("omega"), "chunk": 5}, ValueError, "chunk: with reduce= it must be"),
    (
        {"reduce": reductions.mean("omega"), "load": lambda _: loads.damping(np.eye(3))},
        ValueError,
        "load: a function gives one load for each member",
    ),
    ({"client": 3}, TypeError, "client: expected a dask.distributed.Client, got int"),
    ({"progress": 3}, TypeError, "progress: expected True, False, None or a function"),
    (
        {"about": "origin", "body": distributions.apply(RigidBody.from_principal, MASS, (1.0, 1.0, 1.5))},
        ValueError,
        'method: "auto" would choose by the bodies of a chunk',
    ),
]  # fmt: skip


@pytest.mark.parametrize(("change", "kind", "told"), REFUSED)
def test_refused(change: dict[str, Any], kind: type[Exception], told: str) -> None:
    call: dict[str, Any] = {"body": BODY, "t": TIMES, "omega": SPIN, "n": 10, "seed": 1} | change
    with pytest.raises(kind, match=told):
        ensemble(**call).compute()


class TestTheObject:
    def test_it_prints_on_a_line(self) -> None:
        assert repr(twisted(10_000)) == (
            "Ensemble(10000 members, 3 times, seed=5, draws body.1, omega, attitude, load.0, "
            "3 chunks of 4096, 21.9 MB a chunk)"
        )
        assert "reduced, 3 chunks" in repr(twisted(10_000, reduce=reductions.mean("omega")))
        assert len(twisted(10_000)) == 10_000

    def test_it_goes_through_pickle(self) -> None:
        again = pickle.loads(pickle.dumps(twisted(20)))
        assert all_bytes(again.compute()) == all_bytes(twisted(20).compute())

    def test_more_states_than_memory_are_refused_before_the_first(self) -> None:
        with pytest.raises(MemoryError, match="write them with to_zarr or to_npz, ask for fewer times"):
            twisted(10**12).compute()

    @pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the system does not tell")
    @pytest.mark.parametrize(
        "options",
        [
            "n=10_000, t=[k / 50 for k in range(100)]",
            pytest.param("n=100_000, t=(0, 1)", marks=pytest.mark.long),
        ],
    )
    def test_a_chunk_takes_as_much_memory_as_is_told(self, options: str) -> None:
        code = (
            "import re, pathlib, ensemble_cases as e\n"
            "from polhode.ensembles.running import arrays_of_chunk\n"
            "status = pathlib.Path('/proc/self/status')\n"
            "peak = lambda: 1024 * int(re.search(r'VmHWM:\\s*(\\d+)', status.read_text())[1])\n"
            f"many = e.twisted({options}, chunk=2**20)\n"
            "start = peak(); arrays_of_chunk(many.plan, 0)\n"
            "print((peak() - start) / many.memory.worker)"
        )
        assert 0.3 < float(python(code)) < 1.1

    def test_a_member_that_is_none(self) -> None:
        with pytest.raises(IndexError, match="k: there are members 0 to 299, got 300"):
            twisted().member(300)

    def test_states_are_not_written_where_they_are_reduced(self, tmp_path: Path) -> None:
        many = twisted(10, reduce=reductions.mean("omega"))
        for write in (many.to_npz, many.to_zarr, many.resume):
            with pytest.raises(ValueError, match="writes states, and with reduce= none are kept"):
                write(tmp_path / "out")

    def test_progress_is_told_up_to_the_end(self) -> None:
        told: list[float] = []
        twisted(500, chunk=100, progress=told.append).compute()
        assert told == sorted(told)
        assert told[-1] == 1.0
        assert len(told) >= 5
        told.clear()
        twisted(
            9000, reduce={"s": reductions.mean(last_spin)} | all_reductions(), progress=told.append
        ).compute()
        assert told == sorted(told)
        assert told[-1] == 1.0
