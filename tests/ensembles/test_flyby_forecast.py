"""Sigmas of Apophis after 2029, where its attitude before the passage is known: against clones."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import RigidBody, Uncertain, flybys, loads, orbits
from polhode.errors import PolhodeError
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Callable

HOUR, DAY = 3600.0, 86400.0
PASSAGE: dict[str, Any] = {"eccentricity": 4.253901873, "periapsis": 38011.486}
ORBIT = orbits.from_elements(398600.4418, **PASSAGE, since_periapsis=-3 * DAY)
MOMENTS, P_PSI, P_PHI = (0.64, 0.97, 1.0), 264.178 * HOUR, 27.38547 * HOUR
KNOWN = RigidBody.from_principal(1.0, MOMENTS)
POLE = np.array([0.2, 0.1, -1.0])
START: dict[str, Any] = {"phase": 0.3, "azimuth": 0.7, "pole": POLE}
PERIODS: dict[str, Any] = {"rotation_period": P_PSI, "precession_period": P_PHI, "mode": "short-axis"}
FIGURES = ("rotation_period", "precession_period", "spin_ratio", "pole_shift")


def passed(body: RigidBody = KNOWN, n: int = 200, **options: Any) -> flybys.Flyby:
    """Run clones of Apophis, whose attitude is known, past the Earth."""
    return flybys.flyby(body, ORBIT, 6 * DAY, n=n, **PERIODS | START | options)


def small() -> tuple[RigidBody, dict[str, Any]]:
    """Return a body, periods and angles so well known that the first order is enough."""
    body: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, (2e-4, 2e-4, 1e-4)))
    return body, {
        "rotation_period": Uncertain(P_PSI, 100.0),
        "precession_period": Uncertain(P_PHI, 2.0),
        "phase": Uncertain(0.3, 5e-4),
        "azimuth": Uncertain(0.7, 5e-4),
        "pole_sigma": 1e-3,
    }


def wide() -> tuple[RigidBody, dict[str, Any]]:
    """Return what light curves tell: moments to a few percent."""
    body: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, (0.03, 0.02, 0.0)))
    angles = {"phase": Uncertain(0.3, 0.03), "azimuth": Uncertain(0.7, 0.05), "pole_sigma": 0.1}
    return body, angles | {"precession_period": Uncertain(P_PHI, 1.0)}


def drawn(n: int, seed: int) -> dict[str, np.ndarray]:
    """Return figures after the passage of clones that NumPy draws, as of :func:`small`."""
    rng = np.random.default_rng(seed)
    moments = MOMENTS + np.array([2e-4, 2e-4, 1e-4]) * rng.normal(size=(n, 3))
    bodies = RigidBody.from_principal(1.0, moments)
    rotation, precession = P_PSI + 100.0 * rng.normal(size=n), P_PHI + 2.0 * rng.normal(size=n)
    phase, azimuth = 0.3 + 5e-4 * rng.normal(size=n), 0.7 + 5e-4 * rng.normal(size=n)
    pole = POLE / np.linalg.norm(POLE)
    start: Any = bodies.free_motion_from_periods(
        rotation, precession, "short-axis", phase=phase, angular_momentum_direction=pole
    )
    across = rng.normal(size=(n, 3)) * 1e-3
    lean = Rotation.from_rotvec(across - (across @ pole)[:, None] * pole)
    turned = lean * Rotation.from_rotvec(azimuth[:, None] * pole) * Rotation.from_quat(start.quaternion)
    run = bodies.simulate(
        [0.0, 6 * DAY], start.omega, turned.as_quat(), load=loads.gravity_gradient(ORBIT), rtol=1e-8
    )
    ends = [bodies.free_motion(run.omega[:, k], run.quaternion[:, k]) for k in (0, 1)]
    momenta = [end.angular_momentum().spin for end in ends]
    rates = [
        2 * np.asarray(end.kinetic_energy().total) / np.linalg.norm(momentum, axis=-1)
        for end, momentum in zip(ends, momenta, strict=True)
    ]
    units = [momentum / np.linalg.norm(momentum, axis=-1, keepdims=True) for momentum in momenta]
    return {
        "rotation_period": np.asarray(ends[1].periods.rotation),
        "precession_period": np.asarray(ends[1].periods.precession),
        "spin_ratio": rates[1] / rates[0],
        "pole_shift": np.arccos(np.sum(units[0] * units[1], axis=-1)),
        "pole": units[1],
    }


@pytest.mark.parametrize("n", [10_000, pytest.param(100_000, marks=pytest.mark.long)])
def test_sigmas_are_those_of_clones_that_numpy_draws(n: int) -> None:
    body, given = small()
    found = passed(body, n=2000, **given).forecast
    assert found is not None
    assert found.linear
    clones = drawn(n, seed=7)
    bar = 0.02 + 3.0 / np.sqrt(2.0 * n) * (n < 50_000)
    for name in FIGURES:
        assert getattr(found, name).sigma == pytest.approx(np.std(clones[name]), rel=bar), name
    off = clones["pole"] - found.pole.value
    ellipse = np.sqrt(np.linalg.eigvalsh(np.cov(off.T))[:0:-1])
    np.testing.assert_allclose(found.pole.sigma, ellipse, rtol=bar)


def test_values_are_those_of_the_body_itself() -> None:
    found = passed(pole_sigma=1e-4).forecast
    assert found is not None
    one = passed(n=1)
    assert one.forecast is None  # nothing is uncertain
    for name in FIGURES[:2]:
        assert getattr(found, name).value == pytest.approx(getattr(one.after, name)[0], rel=1e-8)
    assert found.spin_ratio.value == pytest.approx(one.spin_ratio[0], rel=1e-8)
    assert found.pole_shift.value == pytest.approx(one.pole_shift[0], rel=1e-8)
    direction = one.after.momentum[0] / np.linalg.norm(one.after.momentum[0])
    np.testing.assert_allclose(found.pole.value, direction, atol=1e-9)


@pytest.mark.parametrize("pole", [(0.2, 0.1, 1.0), (0.2, 0.1, -1.0), (0, 0, -1), (1, 0, 0)])
def test_phase_and_azimuth_are_an_attitude(pole: Any) -> None:
    """That of the motion from periods, turned about its pole; also if one of the two alone is given."""
    start: Any = KNOWN.free_motion_from_periods(
        **PERIODS, phase=0.3, angular_momentum_direction=np.asarray(pole, float)
    )
    unit = np.asarray(pole) / np.linalg.norm(pole)
    attitude = Rotation.from_rotvec(0.7 * unit) * Rotation.from_quat(start.quaternion)
    states = flybys.clones(KNOWN, ORBIT, 6 * DAY, n=2, **PERIODS | START | {"pole": pole}).to_numpy()
    off = attitude.inv() * Rotation.from_quat(states["quaternion"][:, 0])
    assert off.magnitude().max() < 1e-12
    np.testing.assert_allclose(states["omega"][:, 0], np.broadcast_to(start.omega, (2, 3)), rtol=1e-12)


def test_one_of_the_angles_alone_is_no_known_start() -> None:
    for left in ("phase", "azimuth"):
        given: dict[str, Any] = {"pole_sigma": 0.01, left: None}
        found = passed(n=40, **given)
        assert found.forecast is None
        assert np.ptp(found.spin_ratio) > 0.01
    assert flybys.flyby(KNOWN, ORBIT, 6 * DAY, n=5, **PERIODS, phase=0.3).forecast is None


def test_wide_distributions_have_quantiles_and_say_so() -> None:
    body, given = wide()
    found = passed(body, n=500, **given)
    forecast = found.forecast
    assert forecast is not None
    assert not forecast.linear
    known = ~found.failed
    for name in FIGURES:
        spread = getattr(forecast, name)
        assert not spread.linear
        assert np.isnan(spread.sigma)
        values = getattr(found if hasattr(found, name) else found.after, name)[known]
        assert [spread.low, spread.median, spread.high] == np.quantile(values, (0.05, 0.5, 0.95)).tolist()
    assert np.isnan(forecast.pole.sigma).all()
    assert 0.0 < forecast.pole.low < forecast.pole.median < forecast.pole.high < np.pi
    assert "linear=False" in repr(forecast)


def test_between_the_two_it_is_linear_or_not() -> None:
    """One number ten times as uncertain, step by step: a sigma until the first order lacks two percent."""
    seen = []
    for factor in (1.0, 10.0, 100.0):
        found = passed(n=2000, phase=Uncertain(0.3, 5e-4 * factor)).forecast
        assert found is not None
        seen.append(found.rotation_period.linear)
        if seen[-1]:
            width = (found.rotation_period.high - found.rotation_period.low) / (2 * 1.6449)
            assert found.rotation_period.sigma == pytest.approx(width, rel=0.08)
    assert seen == sorted(seen, reverse=True)
    assert (seen[0], seen[-1]) == (True, False)


def test_far_from_the_planet_the_sigmas_stay() -> None:
    far = orbits.from_elements(398600.4418, eccentricity=4.25, periapsis=1e9, since_periapsis=-3 * DAY)
    given: dict[str, Any] = PERIODS | START | {
        "rotation_period": Uncertain(P_PSI, 108.0), "precession_period": Uncertain(P_PHI, 0.25),
        "pole_sigma": 1e-3,
    }  # fmt: skip
    found = flybys.flyby(KNOWN, far, 6 * DAY, n=500, **given).forecast
    assert found is not None
    assert found.rotation_period.sigma == pytest.approx(108.0, rel=1e-4)
    assert found.precession_period.sigma == pytest.approx(0.25, rel=1e-3)
    np.testing.assert_allclose(found.pole.sigma, 1e-3, rtol=1e-3)
    assert found.spin_ratio.sigma < 1e-9
    assert found.linear


def test_correlated_periods_are_respected() -> None:
    """Both periods from one clock, or from two."""

    def timed(**source: Any) -> flybys.Forecast | None:
        rotation, precession = (Uncertain(one, 1e-4 * one, **source) for one in (P_PSI, P_PHI))
        return passed(rotation_period=rotation, precession_period=precession, n=400).forecast

    one, two = timed(source="clock"), timed()
    assert one is not None
    assert two is not None
    assert one.linear
    assert one.rotation_period.sigma != pytest.approx(two.rotation_period.sigma, rel=0.05)


def test_numpy_alone_is_enough() -> None:
    code = f"""
import json, sys
for name in ("xarray", "dask", "distributed", "scipy", "pandas"):
    sys.modules[name] = None
from polhode import RigidBody, Uncertain, flybys, orbits
import numpy as np
orbit = orbits.from_elements(398600.4418, **{PASSAGE}, since_periapsis={-3 * DAY})
body = RigidBody.from_principal(1.0, {MOMENTS})
found = flybys.flyby(body, orbit, {6 * DAY}, n=300, rotation_period={P_PSI}, precession_period={P_PHI},
                     mode="short-axis", phase=Uncertain(0.3, 5e-4), azimuth=0.7, pole={POLE.tolist()})
assert type(found.spin_ratio) is np.ndarray
print(json.dumps([found.spin_ratio.tolist(), found.forecast.spin_ratio.sigma]))
"""
    run = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=120
    )
    ratios, sigma = json.loads(run.stdout)
    here = passed(n=300, phase=Uncertain(0.3, 5e-4))
    assert here.forecast is not None
    assert ratios == here.spin_ratio.tolist()
    assert sigma == here.forecast.spin_ratio.sigma


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda: flybys.flyby(KNOWN, ORBIT, DAY, **PERIODS, azimuth=0.1),
            TypeError,
            "azimuth: it is an angle about the pole; give pole= too",
        ),
        (lambda: passed(phase=[0.1, 0.2]), ValueError, "phase: expected one finite number"),
        (lambda: passed(phase=np.nan), ValueError, "phase: expected one finite number"),
        (lambda: passed(azimuth=Uncertain([0.1, 0.2], 0.1)), ValueError, "azimuth: expected one number"),
        (
            lambda: flybys.flyby(
                KNOWN,
                orbits.sampled(398600.4418, [-1.0, 1.0], [(5e3, -1, 0), (5e3, 1, 0)], j2=1e-3, radius=6378.0),
                1.0,
                **PERIODS,
            ),
            PolhodeError,
            "within its radius of 6378",
        ),
    ],
)
def test_what_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=re.escape(message)):
        make()


def test_what_benson_and_others_say_of_uncertain_moments() -> None:
    """arXiv:2210.13365: likely a short-axis mode afterwards, a rate that may halve, a shift of 10 degrees."""
    body: Any = RigidBody.from_principal(1.0, Uncertain(MOMENTS, (0.03, 0.01, 0.0)))
    periods = PERIODS | {"rotation_period": Uncertain(P_PSI, 0.03 * HOUR)}
    found = flybys.flyby(body, ORBIT, 6 * DAY, n=1500, **periods)
    known = ~found.failed
    assert 0.8 < found.modes()["short-axis"] < 1.0
    assert found.spin_ratio[known].min() < 0.55
    assert found.spin_ratio[known].max() > 1.5
    assert np.degrees(np.median(found.pole_shift[known])) == pytest.approx(10.0, abs=1.0)
