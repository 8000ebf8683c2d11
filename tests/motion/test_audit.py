"""Audits of records with known mistakes, and of records without any."""

from __future__ import annotations

import pickle
from collections import Counter
from typing import Any

import numpy as np
import polhode
import pytest
from oracles.faulty_records import Record, integrated, noisy, random_body, records
from polhode import Audit, RigidBody, Trajectory, loads
from polhode.errors import PolhodeError
from polhode.motion.auditing import KINDS
from scipy.spatial.transform import Rotation

OF_OMEGA = {"space axes", "degrees", "explicit", "semi-implicit", "substeps", "kept momentum"}
"""Mistakes that attitudes alone do not show, or not at every noise."""
BODY = RigidBody.from_principal(1.0, (1.0, 1.5, 2.0))
T = np.linspace(0.0, 20.0, 800)


def audited(body: RigidBody, record: Record, **given: Any) -> Audit:
    return polhode.audit(Trajectory.from_samples(body, *record), **given)


def kinds(found: Audit) -> list[str]:
    return [finding.kind for finding in found.findings]


Made = tuple[RigidBody, dict[str, tuple[str, Record]]]


@pytest.fixture(scope="module")
def one_body() -> Made:
    rng = np.random.default_rng(0)
    body = random_body(rng)
    return body, records(body, rng, rows=400)


def verdicts(
    made: Made, rng: np.random.Generator, every: Counter[float], right: Counter[float]
) -> list[tuple[str, float, list[str], bool]]:
    """Audit every mistake at three sizes of noise, and count; what is not right is returned."""
    wrong = []
    body, of_body = made
    for name, (kind, record) in of_body.items():
        for noise in (0.0, 1e-6, 1e-3):
            found = audited(body, noisy(record, noise, rng))
            is_right = kinds(found) == ([kind] if kind else []) and found.agrees == (not kind)
            every[noise] += 1
            right[noise] += is_right
            if not is_right:
                wrong.append((name, noise, kinds(found), found.agrees))
    return wrong


def test_every_mistake_of_one_body(one_body: Made) -> None:
    assert verdicts(one_body, np.random.default_rng(1), Counter(), Counter()) == []


@pytest.mark.long
def test_every_mistake_of_twenty_bodies() -> None:
    """99 % right without noise, 95 % at 1e-3; nothing is found in records without a mistake."""
    rng = np.random.default_rng(1)
    every: Counter[float] = Counter()
    right: Counter[float] = Counter()
    wrong = []
    for _ in range(20):
        body = random_body(rng)
        wrong += verdicts((body, records(body, rng)), rng, every, right)
    assert right[0.0] >= 0.99 * every[0.0], wrong
    assert right[1e-6] >= 0.99 * every[1e-6], wrong
    assert right[1e-3] >= 0.95 * every[1e-3], wrong
    assert not [one for one in wrong if one[0].startswith("right")], wrong


def test_of_attitudes_alone(one_body: Made) -> None:
    body, of_body = one_body
    for name, (kind, record) in of_body.items():
        if name not in OF_OMEGA:
            found = polhode.audit(Trajectory.from_samples(body, record.t, record.quaternion))
            assert kinds(found) == ([kind] if kind else []), name


@pytest.mark.parametrize(
    "moments", [(1, 1, 1), (1, 1, 1.5), (1, 2, 2), (1, 1.0001, 1.5), (0, 1, 1), (1, 2, 3)]
)
@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_nothing_is_found_where_nothing_is_wrong(moments: Any, noise: float) -> None:
    rng = np.random.default_rng(7)
    body = RigidBody.from_principal(1.0, moments).rotated(Rotation.random(rng=rng).as_quat())
    axes = body.principal.axes
    for omega in (rng.normal(size=3), 2.0 * axes[:, 2], axes @ (0.001, 0.0, 1.0), 1e-3 * rng.normal(size=3)):
        t = np.cumsum(rng.uniform(0.5, 1.5, 500)) * 10.0 ** rng.uniform(-2.0, -0.7)
        exact = body.free_motion(omega, Rotation.random(rng=rng).as_quat()).at(t)
        found = audited(body, noisy(Record(t, exact.quaternion, exact.omega), noise, rng))
        assert kinds(found) == []
        assert found.agrees


def test_rounded_records() -> None:
    exact = BODY.free_motion((0.3, 1.0, 0.2)).at(T)
    single = Record(T, *(x.astype(np.float32).astype(float) for x in (exact.quaternion, exact.omega)))
    digits = Record(T, exact.quaternion.round(5), exact.omega.round(5))
    for record in (single, digits):
        found = audited(BODY, record)
        assert found.agrees
        assert kinds(found) == []


def test_declared_loads() -> None:
    weight = loads.uniform_gravity((0.0, 0.0, -9.81))
    top = RigidBody.from_principal(1.0, (0.2, 0.2, 0.1), center_of_mass=(0.0, 0.0, 0.3))
    turn = (0.2, 0.0, 0.0, 0.96**0.5)
    run = top.simulate(np.linspace(0.0, 2.0, 800), (0, 0, 40), turn, load=weight, about="origin")
    record = Trajectory.from_samples(top, run.t, run.quaternion, run.omega, load=weight, about="origin")
    found = polhode.audit(record)
    assert found.agrees
    assert max(np.abs(found.energy_drift).max(), found.angle_from_exact.max()) < 1e-8
    bare = polhode.audit(Trajectory.from_samples(top, run.t, run.quaternion, run.omega, about="origin"))
    assert not bare.agrees
    for load in (
        loads.constant_torque((0.1, 0.0, 0.02)) + loads.damping(np.eye(3) * 0.05),
        loads.rotor((0.5, 0.0, 0.3)),
    ):
        run = BODY.simulate(T, (1.0, 0.5, 0.2), load=load)
        found = polhode.audit(Trajectory.from_samples(BODY, T, run.quaternion, run.omega, load=load))
        assert found.agrees
        assert not polhode.audit(Trajectory.from_samples(BODY, T, run.quaternion, run.omega)).agrees


def test_the_numbers_of_a_finding() -> None:
    push = np.array([0.02, -0.01, 0.03])
    run = BODY.simulate(T, (1.0, 0.5, 0.2), load=loads.constant_torque(push))
    record = Record(T, run.quaternion, run.omega)
    found = audited(BODY, record)
    (finding,) = found.findings
    np.testing.assert_allclose(finding.evidence["torque"], push, rtol=1e-5)
    assert finding.evidence["frame"] == "body"
    assert finding.evidence["before"] > 1e3 * finding.evidence["after"]
    assert finding.evidence["log_likelihood"] > 1e3
    np.testing.assert_allclose(found.residual_torque, np.tile(push, (800, 1)), atol=1e-6)
    run = BODY.simulate(T, (1.0, 0.5, 0.2), load=loads.damping(0.03 * np.eye(3)))
    (finding,) = audited(BODY, Record(T, run.quaternion, run.omega)).findings
    assert finding.evidence["coefficient"] == pytest.approx(0.03, rel=1e-5)
    energy = 0.5 * (run.omega * (run.omega @ BODY.inertia)).sum(1)
    drift = audited(BODY, Record(T, run.quaternion, run.omega)).energy_drift
    np.testing.assert_allclose(drift, energy / energy[0] - 1.0, atol=1e-12)
    assert set(KINDS) >= {finding.kind}
    assert "loads.damping" in finding.words
    assert pickle.loads(pickle.dumps(finding)) == finding


def test_a_mistake_below_the_noise_is_not_found() -> None:
    run = BODY.simulate(T, (1.0, 0.5, 0.2), load=loads.constant_torque((2e-6, 0.0, 0.0)))
    rng = np.random.default_rng(3)
    found = audited(BODY, noisy(Record(T, run.quaternion, run.omega), 1e-3, rng))
    assert found.agrees
    assert found.noise["attitude"] == pytest.approx(1e-3, rel=0.15)
    assert kinds(audited(BODY, Record(T, run.quaternion, run.omega), rtol=1e-9)) == ["undeclared torque"]


def test_two_mistakes_of_the_writer() -> None:
    exact = BODY.free_motion((0.3, 1.0, 0.2), (0.1, 0.7, 0.1, 0.7)).at(T)
    record = Record(T, exact.quaternion[:, [3, 0, 1, 2]], np.rad2deg(exact.omega))
    assert kinds(audited(BODY, record)) == ["scalar-first", "degrees"]


def test_a_clock_that_is_slow_and_one_that_jumps() -> None:
    exact = BODY.free_motion((0.3, 1.0, 0.2)).at(T)
    (finding,) = audited(BODY, Record(1.02 * T, exact.quaternion, exact.omega)).findings
    assert (finding.kind, round(finding.evidence["factor"], 6)) == ("clock", round(1 / 1.02, 6))
    jumped = T + 0.2 * (np.arange(800) >= 300)
    (finding,) = audited(BODY, Record(jumped, exact.quaternion, exact.omega)).findings
    assert finding.evidence["rows"] == [300]
    assert finding.evidence["jumps"] == pytest.approx([0.2], rel=1e-2)


def test_rows_that_are_not_there() -> None:
    exact = BODY.free_motion((0.3, 1.0, 0.2)).at(T)
    attitude = exact.quaternion.copy()
    attitude[[0, 5, 6, 400]] = np.nan
    found = audited(BODY, Record(T, attitude, exact.omega))
    assert found.agrees
    assert np.flatnonzero(np.isnan(found.angle_from_exact)).tolist() == [0, 5, 6, 400]


@pytest.mark.parametrize(("power", "order"), [(1, 1.0), (2, 2.0)])
def test_the_order_of_two_records(power: int, order: float) -> None:
    def run(step: float) -> Trajectory:
        """Take steps of Euler's method or of the midpoint rule."""
        tensor, omega, turn = np.diag(BODY.inertia), np.array([0.3, 1.0, 0.2]), Rotation.identity()
        rows = []
        for _ in range(round(8.0 / step) + 1):
            rows.append((turn.as_quat(), omega))
            rate = -np.cross(omega, tensor * omega) / tensor
            middle = omega + 0.5 * step * rate
            if power == 2:
                rate = -np.cross(middle, tensor * middle) / tensor
            turn = turn * Rotation.from_rotvec(step * (omega if power == 1 else middle))
            omega = omega + step * rate
        t = step * np.arange(len(rows))
        return Trajectory.from_samples(
            BODY, t, np.array([q for q, _ in rows]), np.array([w for _, w in rows])
        )

    found = polhode.audit(run(0.02), finer=run(0.01))
    assert found.order == pytest.approx(order, abs=0.1)
    again = polhode.audit(run(0.02), finer=run(0.01), ratio=2.0)
    assert again.order == pytest.approx(found.order, abs=1e-9)
    with pytest.raises(ValueError, match="finer: its rows are 1 times as far apart"):
        polhode.audit(run(0.02), finer=run(0.02))


def test_a_record_of_another_body() -> None:
    """No mistake explains it: there is no finding, and it does not agree."""
    rng = np.random.default_rng(4)
    tensor = np.array(random_body(rng).inertia)
    inverse = np.linalg.inv(tensor)

    def rate(w: Any, _: Any) -> Any:
        return -inverse @ np.cross(w, tensor @ w)

    found = audited(BODY, integrated(T, np.array([0.3, 1.0, 0.2]), rate, np.array([0.0, 0.0, 0.0, 1.0])))
    assert kinds(found) == []
    assert not found.agrees


@pytest.mark.parametrize("time", [1e-120, 1e-6, 1e9, 1e120])
@pytest.mark.parametrize("inertia", [1e-47, 1e37])
def test_units_of_any_size(time: float, inertia: float) -> None:
    """Findings and their numbers are the same in the units of molecules and of planets."""
    run = BODY.simulate(T, (1.0, 0.5, 0.2), load=loads.constant_torque((0.02, 0.0, 0.0)))
    scaled = RigidBody.from_principal(inertia, inertia * BODY.principal_moments)
    found = audited(scaled, Record(time * T, run.quaternion, run.omega / time))
    (finding,) = found.findings
    assert finding.kind == "undeclared torque"
    unit = inertia / time**2
    np.testing.assert_allclose(np.array(finding.evidence["torque"]) / unit, [0.02, 0, 0], atol=1e-7)
    np.testing.assert_allclose(found.residual_torque[:, 0] / unit, 0.02, atol=1e-6)


def test_records_that_tell_nothing() -> None:
    """Attitudes at random, none that turn, no angular velocity: none agrees, and nothing is found."""
    rng = np.random.default_rng(6)
    exact = BODY.free_motion((0.3, 1.0, 0.2)).at(T)
    anywhere = Rotation.random(800, rng=rng).as_quat()
    still = np.tile([0.0, 0.0, 0.0, 1.0], (800, 1))
    for quaternion, omega in (
        (anywhere, exact.omega),
        (still, exact.omega),
        (exact.quaternion, 0.0 * exact.omega),
    ):
        found = audited(BODY, Record(T, quaternion, omega))
        assert kinds(found) == []
        assert not found.agrees
    assert audited(BODY, Record(T, still, 0.0 * exact.omega)).agrees


def test_pictures_and_repr() -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    exact = BODY.free_motion((0.3, 1.0, 0.2)).at(T)
    found = audited(BODY, Record(T, exact.quaternion, exact.omega))
    assert repr(found) == "Audit(rows=800, agrees=True, findings=[])"
    axes = found.plot()
    assert len(axes.lines) == 3
    pyplot.close(axes.figure)


def test_what_is_refused() -> None:
    exact = BODY.free_motion((0.3, 1.0, 0.2)).at(T)
    with pytest.raises(PolhodeError, match="trajectory: needs at least 16 rows"):
        audited(BODY, Record(T[:15], exact.quaternion[:15], exact.omega[:15]))
    stack = RigidBody.stack([BODY, BODY]).free_motion((0.3, 1.0, 0.2)).at(T)
    with pytest.raises(
        ValueError, match=r"trajectory: expected that of one body, got a stack of shape \(2,\)"
    ):
        polhode.audit(stack)
    with pytest.raises(PolhodeError, match="trajectory: an angular velocity of"):
        audited(BODY, Record(T, exact.quaternion, 1e9 * exact.omega))
    with pytest.raises(PolhodeError, match=r"trajectory: steps of .* are beyond what is computed"):
        audited(BODY, Record(1e150 * T, exact.quaternion, 1e-150 * exact.omega))
    nothing: Any = None
    with pytest.raises(TypeError, match=r"trajectory: expected Trajectory, got NoneType"):
        polhode.audit(nothing)
    with pytest.raises(ValueError, match="rtol: expected a number between 0 and 1"):
        polhode.audit(exact, rtol=2.0)
