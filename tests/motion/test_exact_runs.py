"""`simulate` in closed form: what "auto" takes for it, heavy tops to forty digits, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles import top_cases
from oracles.motion_cases import MotionCase, angle, load_table, relative_error
from polhode import Event, RigidBody, loads, solids
from polhode.errors import PolhodeError

BAR = 1e-14
G = (0.0, 0.0, -9.81)
GYROSCOPE = RigidBody.from_principal(0.5, (2e-4, 2e-4, 3e-4), center_of_mass=(0, 0, 0.04))
BRICK = solids.box((3.0, 2.0, 1.0), mass=1.0).translated((0.0, 0.0, 2.0))
LEANING = (np.sin(0.3), 0.0, 0.0, np.cos(0.3))
SPIN = (0.5, 0.7, 250.0)
WEIGHT = loads.uniform_gravity(G)


@pytest.mark.parametrize("case", load_table(top_cases.NAME), ids=lambda case: case.name)
def test_a_top_of_every_class_up_to_a_million_rotations(case: MotionCase) -> None:
    body, t = RigidBody.from_principal(**case.body), [0.0, *case.times]
    load = loads.uniform_gravity(case.gravity)
    run = body.simulate(t, case.omega, case.attitude, load=load, about="origin")
    assert run.steps == run.evaluations == 0
    rate = 2 * np.pi / case.times[0]
    for omega, quaternion, want in zip(run.omega[1:], run.quaternion[1:], case.expected, strict=True):
        assert angle(quaternion, want.quaternion) <= BAR
        assert relative_error(omega, want.omega, at_least=rate) <= BAR


class TestAuto:
    def simulate(self, body: RigidBody, **options: Any) -> Any:
        given: dict[str, Any] = {"load": WEIGHT, "about": "origin", **options}
        return body.simulate(np.linspace(0.0, 0.5, 5), SPIN, LEANING, **given)

    def test_takes_it_for_a_top_under_gravity_alone(self) -> None:
        run, named = self.simulate(GYROSCOPE), self.simulate(GYROSCOPE, method="exact")
        assert run.steps == 0
        assert np.array_equal(run.omega, named.omega)
        assert np.array_equal(run.quaternion, named.quaternion)
        exact = GYROSCOPE.heavy_top(SPIN, LEANING, G).at(run.t)
        assert np.array_equal(run.omega[1:], exact.omega[1:])
        assert np.array_equal(run.quaternion[1:], exact.quaternion[1:])

    @pytest.mark.parametrize(
        ("body", "load", "about"),
        [
            (BRICK, WEIGHT, "origin"),
            (GYROSCOPE.translated((1e-9, 0.0, 0.0)), WEIGHT, "origin"),
            (GYROSCOPE, WEIGHT, "center_of_mass"),
            (GYROSCOPE, WEIGHT + loads.damping(0.0), "origin"),
            (GYROSCOPE, loads.schedule(WEIGHT, [(0.0, 0.1)]), "origin"),
            (RigidBody.stack([GYROSCOPE, BRICK]), WEIGHT, "origin"),
            (RigidBody.from_principal(0.5, (2e-4, 2.0000001e-4, 3e-4)), WEIGHT, "origin"),
        ],
        ids=["brick", "off its axis", "free", "damped", "switched", "one of two", "nearly symmetric"],
    )
    def test_goes_on_to_taylor(self, body: RigidBody, load: Any, about: Any) -> None:
        run = self.simulate(body, load=load, about=about)
        named = self.simulate(body, load=load, about=about, method="taylor")
        assert np.all(run.steps > 0)
        assert np.array_equal(run.quaternion, named.quaternion)

    def test_taylor_agrees(self) -> None:
        for load in (WEIGHT, None, WEIGHT + loads.uniform_gravity((5.0, -3.0, 0.0)), -2 * WEIGHT):
            exact = self.simulate(GYROSCOPE, load=load)
            taylor = self.simulate(GYROSCOPE, load=load, method="taylor", rtol=2.3e-15)
            assert exact.steps == 0
            assert np.abs(exact.quaternion - taylor.quaternion).max() < 1e-12
            assert np.abs(exact.omega - taylor.omega).max() < 1e-12 * 250

    def test_stacks_of_tops_starts_and_gravities(self) -> None:
        tops = RigidBody.stack(
            [GYROSCOPE, GYROSCOPE.scaled(mass=2.0), GYROSCOPE.rotated([0.6, 0.0, 0.0, 0.8])]
        )
        gravity = loads.uniform_gravity(np.array([[[0.0, 0.0, -9.81]], [[0.0, 3.0, 1.6]]]))
        run = self.simulate(tops, load=gravity)
        assert run.omega.shape == (2, 3, 5, 3)
        assert not run.steps.any()
        for row, column in np.ndindex(2, 3):
            alone = self.simulate(tops[column], load=gravity[row, 0])
            assert np.array_equal(run.omega[row, column], alone.omega)
            assert np.array_equal(run.quaternion[row, column], alone.quaternion)

    def test_a_long_run_keeps_what_weight_keeps(self) -> None:
        t = np.linspace(0.0, 1e4 * 2 * np.pi / 250, 400)
        run = GYROSCOPE.simulate(t, SPIN, LEANING, load=WEIGHT, about="origin")
        kept = run.invariants()
        assert kept.energy_drift < 1e-14
        assert kept.angular_momentum_drift < 1e-14
        assert np.abs(np.linalg.norm(run.quaternion, axis=-1) - 1).max() < 4e-16


class TestRefused:
    @pytest.mark.parametrize(
        ("body", "message"),
        [
            (BRICK, r"no two of its principal moments are equal, by 2\.31e-1 .*: method=\"taylor\""),
            (GYROSCOPE.translated((1e-3, 0.0, 0.0)), r"the origin is off the symmetry axis, by 2\.24e-2"),
        ],
    )
    def test_a_body_that_is_no_top(self, body: RigidBody, message: str) -> None:
        with pytest.raises(PolhodeError, match=message):
            body.simulate([0, 1], SPIN, load=WEIGHT, about="origin", method="exact")

    def test_of_a_stack_by_its_row(self) -> None:
        pair = RigidBody.stack([GYROSCOPE, BRICK])
        options: dict[str, Any] = {"load": WEIGHT, "about": "origin", "method": "exact"}
        with pytest.raises(PolhodeError, match='row 1: the method "exact" needs a symmetric top'):
            pair.simulate([0, 1], SPIN, **options)
        run = pair.simulate([0, 1], SPIN, on_failure="keep", **options)
        assert run.status.tolist() == ["complete", "failed"]
        assert np.isfinite(run.omega[0]).all()

    @pytest.mark.parametrize("about", ["origin", "center_of_mass"])
    def test_another_load(self, about: Any) -> None:
        with pytest.raises(
            PolhodeError, match=r'uniform gravity alone on a symmetric top; .* can .*: method="taylor"'
        ):
            GYROSCOPE.simulate([0, 1], SPIN, load=loads.damping(1.0), about=about, method="exact")


def test_a_pendulum_let_go_is_seen_passing_below() -> None:
    """At rest at the start, it is looked at often enough for its speed further on."""
    bob = solids.sphere(radius=0.0, mass=1.0).translated((0, 0, -1))
    below = Event(lambda _t, _omega, q, *_: q[0])
    start = (np.sin(0.5), 0.0, 0.0, np.cos(0.5))
    run = bob.simulate([0, 100], (0, 0, 0), start, load=WEIGHT, about="origin", events=below)
    half = bob.heavy_top((0, 0, 0), start, G).nutation_period
    assert run.steps > 100
    assert np.abs(run.events.t - half * (np.arange(len(run.events.t)) + 0.5)).max() < 1e-12
    assert len(run.events.t) == int(100 / half + 0.5)
