"""Sigmas of motions against draws of bodies and starts that NumPy moves by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.drawn_motion import attitude_changes, moved
from oracles.matter_models import Node, Quantity, ten_numbers
from oracles.textbook_shapes import FLOATS
from oracles.uncertain_cases import case
from oracles.uncertainty import Drawn, Sources, drawn, values
from polhode import Uncertain, loads
from scipy.spatial.transform import Rotation
from uncertain_bodies import Bodies, RigidBody, symmetric

START = Rotation.from_rotvec([0.4, -0.2, 0.9])


def by_draws(
    node: Node, omega: Quantity, turn: Quantity, time: float, torque: Any, drag: float, n: int
) -> Drawn:
    """Sigmas of (δ, ω) at a time."""
    sources = Sources(node, omega, turn)

    def states(z: Any) -> tuple[Any, Any]:
        of, count = sources.draws(z), z.shape[1]
        numbers = [np.broadcast_to(np.asarray(x, float), count) for x in ten_numbers(node.matter(of, FLOATS))]
        tensors = np.array([symmetric(six) for six in np.array(numbers[4:]).T])
        w = np.array([np.broadcast_to(x, count) for x in of(omega)])
        angles = np.array([np.broadcast_to(x, count) for x in of(turn)])
        q = (Rotation.from_rotvec(angles.T) * START).as_quat().T
        return moved(tensors, w, q, time, torque, drag, int(50 * time) + 1)

    _, nominal = states(np.zeros((sources.count, 1)))

    def outputs(z: Any) -> Any:
        w, q = states(z)
        return np.vstack([attitude_changes(nominal[:, 0], q), w]).T

    return drawn(outputs, sources.count, n, 3)


def spun(seed: int, share: float) -> tuple[Node, Quantity, Quantity]:
    """A body, rates about its principal axes that are far from the separatrix, and a start with sigmas."""
    node = case("given", seed)
    rng = np.random.default_rng(seed)
    rates = values(node)[1] @ (np.array([0.2, 0.3, 1.5]) * rng.uniform(0.8, 1.2, 3))
    omega = Quantity(rates, share * np.diag(rng.uniform(0.5, 1, 3)), (3,))
    return node, omega, Quantity(np.zeros(3), share * np.diag(rng.uniform(0.5, 1, 3)), (3,))


def started(omega: Quantity, turn: Quantity) -> dict[str, Any]:
    assert omega.factor is not None
    assert turn.factor is not None
    return {
        "omega": Uncertain(omega.value, np.diag(omega.factor)),
        "attitude": Uncertain(START, np.diag(turn.factor)),
    }


def compared(body: Any, drawn_: Drawn, run: Any) -> None:
    sigma = np.sqrt(np.diagonal(run.covariance[-1]))
    assert sigma == pytest.approx(np.concatenate([run.sigma.attitude[-1], run.sigma.omega[-1]]), rel=1e-12)
    linear = drawn_.departure < 0.01
    assert linear.sum() >= 4  # what is compared is nearly all
    assert (np.abs(sigma / drawn_.sigma - 1) <= 0.01 + 3 * drawn_.error / drawn_.sigma)[linear].all()
    assert sigma == pytest.approx(drawn_.first_order, rel=0.01), body


class TestRuns:
    @pytest.mark.parametrize("seed", [1, 2, 4])
    def test_free(self, seed: int) -> None:
        node, omega, turn = spun(seed, 0.002)
        body = Bodies().body(node)
        run = body.simulate([0.0, 6.0], **started(omega, turn))
        compared(body, by_draws(node, omega, turn, 6.0, np.zeros(3), 0.0, 1000), run)

    @pytest.mark.parametrize("seed", [1, 2, 4])
    def test_driven_and_damped(self, seed: int) -> None:
        node, omega, turn = spun(seed, 0.002)
        body = Bodies().body(node)
        size = float(np.trace(body.inertia))
        torque, drag = 0.05 * size * np.array([1.0, -0.5, 0.2]), 0.01 * size
        load = loads.constant_torque(torque) + loads.damping(drag * np.eye(3))
        run = body.simulate([0.0, 4.0], **started(omega, turn), load=load)
        compared(body, by_draws(node, omega, turn, 4.0, torque, drag, 1000), run)

    def test_the_start_alone(self) -> None:
        """Without a sigma of the body, and with one number for both."""
        body = RigidBody(2.0, np.diag([3.0, 4.0, 5.0]))
        assert body.simulate([0.0, 1.0], (0.1, 0.2, 1.0)).covariance is None
        run = body.simulate([0.0, 1.0], Uncertain((0.1, 0.2, 1.0), 0.01))
        assert run.sigma.omega[0] == pytest.approx([0.01] * 3, rel=1e-14)
        assert run.sigma.attitude[0] == pytest.approx([0.0] * 3, abs=1e-16)
        assert run.sigma.attitude[1].min() > 0.005

    def test_mass_turns_no_free_body(self) -> None:
        body = RigidBody(Uncertain(2.0, 0.1), np.diag([3.0, 4.0, 5.0]), Uncertain((1.0, 0.0, 0.0), 0.1))
        run = body.simulate([0.0, 3.0], (0.1, 0.2, 1.0))
        assert run.covariance is not None
        assert np.abs(run.covariance).max() < 1e-28


class TestLinear:
    """What is not flagged is right within a percent; of what is flagged at least half is not."""

    def test_against_draws(self) -> None:
        outputs = flagged = rightly = 0
        for seed in (1, 2, 4):
            for share, time in ((0.002, 6.0), (0.01, 6.0), (0.03, 4.0), (0.06, 4.0)):
                node, omega, turn = spun(seed, share)
                body = Bodies(label=f"linear {seed}").body(node)
                run = body.simulate([0.0, time], **started(omega, turn))
                by_draw = by_draws(node, omega, turn, time, np.zeros(3), 0.0, 1000)
                sigma = np.concatenate([run.sigma.attitude[-1], run.sigma.omega[-1]])
                linear = np.concatenate([run.sigma.linear.attitude[-1], run.sigma.linear.omega[-1]])
                off = np.abs(sigma / by_draw.sigma - 1)
                assert (off <= 0.01 + 3 * by_draw.error / by_draw.sigma)[linear].all(), (seed, share, off)
                outputs, flagged = outputs + 6, flagged + int((~linear).sum())
                rightly += int((off > 0.01)[~linear].sum())
        print(outputs, flagged, rightly)
        assert 0 < flagged < outputs
        assert 2 * rightly >= flagged

    def test_of_a_stack_with_a_load_of_each(self) -> None:
        stack = RigidBody.from_principal(1.0, [(1.0, 2.0, 2.5), (1.0, 1.9, 2.6)]).with_sigma(
            inertia=1e-4 * np.eye(3), source="scale"
        )
        push = loads.constant_torque([(0.0, 0.0, 1e-3), (0.0, 1e-3, 0.0)])
        times, omega = [0.0, 3.0, 1000.0], Uncertain((0.3, 0.2, 1.1), 1e-3, source="gyro")
        found = stack.simulate(times, omega, load=push).sigma.linear
        assert found.attitude.shape == found.omega.shape == (2, 3, 3)
        alone = stack[1].simulate(times, omega, load=loads.constant_torque((0.0, 1e-3, 0.0))).sigma.linear
        assert np.array_equal(found.attitude[1], alone.attitude)
        assert found.attitude[:, :2].all()
        assert not found.attitude[1, 2].any()

    def test_sigmas_by_themselves_do_not_know(self) -> None:
        run = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5)).simulate(
            [0.0, 1.0], Uncertain((0.1, 0.2, 1.0), 0.01)
        )
        alone = run.sigma._replace(omega=run.sigma.omega)
        with pytest.raises(ValueError, match="not of a motion"):
            _ = alone.linear
