"""Clones of a tumbling asteroid past a planet: their starts, what the flyby makes of them, the command."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import one_line, run
from polhode import RigidBody, Uncertain, flybys, loads, orbits, plot
from polhode.errors import PolhodeError
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.stats import kstest

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

HOUR, DAY = 3600.0, 86400.0
EARTH = 398600.4418
PASSAGE: dict[str, Any] = {"eccentricity": 4.253901873, "periapsis": 38011.486}
ORBIT = orbits.from_elements(EARTH, **PASSAGE, since_periapsis=-3 * DAY)
APOPHIS = RigidBody.from_principal(1.0, (0.64, 0.97, 1.0))
PERIODS: dict[str, Any] = {
    "rotation_period": 264.178 * HOUR,
    "precession_period": 27.38547 * HOUR,
    "mode": "short-axis",
}


def passed(n: int = 300, **options: Any) -> flybys.Flyby:
    """Run clones of Apophis past the Earth."""
    return flybys.flyby(APOPHIS, ORBIT, 6 * DAY, n=n, **PERIODS | options)


FOUND = passed(2000)


def test_before_it_all_clones_have_the_given_periods() -> None:
    assert set(FOUND.before.mode) == {"short-axis"}
    np.testing.assert_allclose(FOUND.before.rotation_period, PERIODS["rotation_period"], rtol=1e-11)
    np.testing.assert_allclose(FOUND.before.precession_period, PERIODS["precession_period"], rtol=1e-11)
    assert np.ptp(FOUND.before.spin_rate) < 1e-13 * FOUND.before.spin_rate[0]


def test_their_directions_and_phases_are_all_as_likely() -> None:
    direction = FOUND.before.momentum / np.linalg.norm(FOUND.before.momentum, axis=-1, keepdims=True)
    for component in direction.T:
        assert kstest(component, "uniform", (-1, 2)).pvalue > 1e-3
    states = flybys.clones(APOPHIS, ORBIT, 6 * DAY, n=2000, **PERIODS).compute()
    third = states.omega.to_numpy()[:, 0, 2]
    motion = APOPHIS.free_motion_from_periods(**PERIODS)
    along = motion.at(np.linspace(0.0, PERIODS["rotation_period"], 20001)).omega[:, 2]
    assert kstest(third, along).pvalue > 1e-3
    # About L: the azimuth of the long axis.
    turned = Rotation.from_quat(states.quaternion.to_numpy()[:, 0]).apply([1.0, 0.0, 0.0])
    side = np.cross(direction, [0.3, 0.5, 0.8])
    azimuth = np.arctan2(np.sum(np.cross(direction, side) * turned, -1), np.sum(side * turned, -1))
    assert kstest(azimuth, "uniform", (-np.pi, 2 * np.pi)).pvalue > 1e-3


@pytest.mark.parametrize(
    "pole",
    [
        (0, 0, 1),
        (0, 0, -1),
        (0.1, -0.2, -1.0),
        (1, 0, 0),
        (1e-9, 0, -1),
        (0, 0, 1e-200),
        (1e200, 0, 0),
        (3.0, 4.0, 0.0),
    ],
)
def test_a_pole_is_where_the_momentum_points(pole: tuple[float, float, float]) -> None:
    found = passed(50, pole=pole)
    direction = found.before.momentum / np.linalg.norm(found.before.momentum, axis=-1, keepdims=True)
    toward = np.array(pole) / np.abs(pole).max()
    toward = toward / np.linalg.norm(toward)
    np.testing.assert_allclose(direction, np.broadcast_to(toward, direction.shape), atol=1e-14)
    assert np.ptp(found.spin_ratio) > 0.01  # their phases differ


def test_its_sigma_is_that_across_it() -> None:
    toward = np.array([0.6, 0.0, -0.8])
    found = passed(4000, pole=toward, pole_sigma=0.05)
    direction = found.before.momentum / np.linalg.norm(found.before.momentum, axis=-1, keepdims=True)
    one, two = np.array([0.0, 1.0, 0.0]), np.array([0.8, 0.0, 0.6])
    angle = np.arccos(np.clip(direction @ toward, -1, 1))
    for axis in (one, two):
        share = direction @ axis / np.sin(angle) * angle
        assert kstest(share / 0.05, "norm").pvalue > 1e-3


def test_a_clone_is_a_motion_under_the_gradient() -> None:
    states = flybys.clones(APOPHIS, ORBIT, 6 * DAY, n=20, rtol=1e-12, **PERIODS).compute()
    omega, quaternion = states.omega.to_numpy(), states.quaternion.to_numpy()
    inertia = np.diag(APOPHIS.inertia)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        q, w = y[:4], y[4:]
        r = Rotation.from_quat(q).inv().apply(ORBIT.at(t).position)
        torque = 3 * EARTH / np.linalg.norm(r) ** 5 * np.cross(r, inertia * r)
        x, s = q[:3], q[3]
        turn = 0.5 * np.concatenate([s * w + np.cross(x, w), [-x @ w]])
        return np.concatenate([turn, (torque - np.cross(w, inertia * w)) / inertia])

    for k in range(3):
        start = np.concatenate([quaternion[k, 0], omega[k, 0]])
        run_ = solve_ivp(rates, (0.0, 6 * DAY), start, "DOP853", rtol=1e-11, atol=1e-16)
        np.testing.assert_allclose(omega[k, 1], run_.y[4:, -1], atol=1e-7 * np.abs(omega[k, 1]).max())
    load = loads.gravity_gradient(ORBIT)
    one = APOPHIS.simulate([0, 6 * DAY], omega[7, 0], quaternion[7, 0], load=load, rtol=1e-12)
    np.testing.assert_array_equal(one.omega, omega[7])


@pytest.mark.parametrize("n", [250, pytest.param(1000, marks=pytest.mark.long)])
def test_clones_beside_twice_the_precision(n: int) -> None:
    states = flybys.clones(APOPHIS, ORBIT, 6 * DAY, n=n, rtol=1e-12, **PERIODS).compute()
    omega, quaternion = states.omega.to_numpy(), states.quaternion.to_numpy()
    load = loads.gravity_gradient(ORBIT)
    exact = APOPHIS.simulate([0, 6 * DAY], omega[:, 0], quaternion[:, 0], load=load, rtol=1e-20)
    off = Rotation.from_quat(exact.quaternion[:, 1]).inv() * Rotation.from_quat(quaternion[:, 1])
    assert off.magnitude().max() <= 1e-10
    assert (
        np.abs(omega[:, 1] - exact.omega[:, 1]).max()
        <= 1e-11 * np.linalg.norm(exact.omega[:, 1], axis=-1).min()
    )


def test_spin_ratio_and_pole_shift_are_what_they_say() -> None:
    states = flybys.clones(APOPHIS, ORBIT, 6 * DAY, n=2000, **PERIODS).compute()
    omega, turned = states.omega.to_numpy(), states.quaternion.to_numpy()
    spin = omega * np.diag(APOPHIS.inertia)
    rate = np.sum(omega * spin, axis=-1) / np.linalg.norm(spin, axis=-1)
    np.testing.assert_allclose(FOUND.spin_ratio, rate[:, 1] / rate[:, 0], rtol=1e-12)
    ends = [Rotation.from_quat(turned[:, k]).apply(spin[:, k]) for k in (0, 1)]
    cosine = (
        np.sum(ends[0] * ends[1], -1) / np.linalg.norm(ends[0], axis=-1) / np.linalg.norm(ends[1], axis=-1)
    )
    np.testing.assert_allclose(np.cos(FOUND.pole_shift), cosine, atol=1e-12)
    assert sum(FOUND.modes().values()) == pytest.approx(1.0)


def test_a_table_of_positions_serves_from_its_first_time_on() -> None:
    t = np.linspace(1e3, 1e3 + 6 * DAY, 20001)
    table = orbits.sampled(EARTH, t, ORBIT.at(t - 1e3).position)
    found = flybys.flyby(APOPHIS, table, 6 * DAY, n=20, **PERIODS)
    np.testing.assert_allclose(found.spin_ratio, FOUND.spin_ratio[:20], rtol=1e-6)


def test_numpy_alone_is_enough() -> None:
    """In a process in which no other library can be imported."""
    code = f"""
import sys
for name in ("xarray", "dask", "distributed", "scipy", "pandas"):
    sys.modules[name] = None
from polhode import RigidBody, flybys, orbits
orbit = orbits.from_elements({EARTH}, **{PASSAGE}, since_periapsis={-3 * DAY})
body = RigidBody.from_principal(1.0, (0.64, 0.97, 1.0))
found = flybys.flyby(body, orbit, {6 * DAY}, n=300, **{PERIODS})
print(found.spin_ratio.tolist())
"""
    told = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=60
    )
    assert json.loads(told.stdout) == passed().spin_ratio.tolist()


def test_far_from_a_planet_nothing_changes() -> None:
    far = orbits.from_elements(EARTH, eccentricity=4.25, periapsis=1e9, since_periapsis=-3 * DAY)
    found = flybys.flyby(APOPHIS, far, 6 * DAY, n=50, **PERIODS)
    np.testing.assert_allclose(found.spin_ratio, 1.0, atol=1e-9)
    assert found.pole_shift.max() < 1e-9
    assert found.modes() == {"short-axis": 1.0}


def test_the_seed_makes_the_clones() -> None:
    again, other = passed(300, seed=0), passed(300, seed=1)
    np.testing.assert_array_equal(again.spin_ratio, FOUND.spin_ratio[:300])
    assert np.abs(other.spin_ratio - again.spin_ratio).min() > 0.0
    assert repr(again) == "Flyby(300 clones, 0 failed)"


@pytest.mark.parametrize("of", ["spin_ratio", "pole_shift", "rotation_period", "precession_period"])
def test_all_clones_are_in_the_picture(of: Any) -> None:
    ax = plot.flyby(FOUND, of, time_label="h", time_scale=HOUR)
    heights = [patch.get_height() for bars in ax.containers for patch in bars]
    assert sum(heights) == len(FOUND.failed)
    legend = ax.get_legend()
    assert legend is not None
    assert {"short-axis after", "long-axis after"} <= {text.get_text() for text in legend.get_texts()}


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: passed(span=0.0), TypeError, "span"),
        (lambda: flybys.flyby(APOPHIS, ORBIT, 0.0, **PERIODS), ValueError, "span: must be positive, got 0.0"),
        (lambda: passed(pole=(0, 0, 0)), ValueError, "pole: expected three numbers that are not all zero"),
        (lambda: passed(pole=(0, 1)), ValueError, "pole: expected three numbers"),
        (lambda: passed(pole_sigma=-1.0), ValueError, "pole_sigma: must not be negative"),
        (lambda: passed(pole_sigma=0.1), TypeError, "pole_sigma: it is that of a direction; give pole= too"),
        (
            lambda: passed(pole=(0, 0, 1), pole_sigma=[0.1, 0.2]),
            ValueError,
            "pole_sigma: expected one finite number",
        ),
        (
            lambda: flybys.flyby(APOPHIS, ORBIT, [1, 2], **PERIODS),  # type: ignore[arg-type]
            ValueError,
            "span: expected one finite number",
        ),
        (
            lambda: flybys.flyby(APOPHIS, orbits.sampled(EARTH, [1e3, 1e5], np.eye(3)[:2]), 1e6, **PERIODS),
            PolhodeError,
            "needed at t = 1001000",
        ),
        (lambda: passed(rotation_period=HOUR), PolhodeError, "period"),
        (lambda: passed(n=0), ValueError, "n: expected a positive integer"),
        (lambda: passed(radius=38011.5), PolhodeError, "is 38011.5, within its radius of 38011.5"),
        (
            lambda: flybys.clones(APOPHIS, orbits.kepler(EARTH, (9e3, 0, 0), (0, 7, 0)), DAY, **PERIODS),
            PolhodeError,
            "orbit: its eccentricity is 0.106",
        ),
        (
            lambda: flybys.flyby(
                APOPHIS,
                orbits.from_elements(
                    EARTH, eccentricity=2.0, periapsis=6378.0, since_periapsis=-DAY, j2=1e-3, radius=6378.137
                ),
                2 * DAY,
                **PERIODS,
            ),
            PolhodeError,
            "within its radius of 6378.14",
        ),
        (
            lambda: flybys.clones(
                APOPHIS,
                orbits.sampled(EARTH, [0.0, 1e3, 2e3, 3e3], 4e3 * np.eye(4, 3) + 1.0),
                1e3,
                radius=6378.0,
                **PERIODS,
            ),
            PolhodeError,
            "within its radius",
        ),
        (
            lambda: passed(rotation_period=[1e6, 2e6]),
            ValueError,
            "body and periods: expected one of each, got a stack of shape (2,)",
        ),
        (lambda: plot.flyby(FOUND, "speed"), ValueError, "of: expected"),  # type: ignore[arg-type]
    ],
)
def test_what_is_refused(make: Callable[[], object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=re.escape(message)):
        make()


WORDS = (
    "--moments", "0.64", "0.97", "1", "--periods", "264.178 h, 27.38547 h", "--mode", "short-axis",
    "--eccentricity", "4.253901873", "--periapsis", "38011.486 km", "--n", "200",
)  # fmt: skip


@pytest.mark.parametrize("call", [flybys.flyby, flybys.clones])
def test_the_mode_has_no_default(call: Any) -> None:
    """Most pairs of periods are those of two motions: who leaves the mode out is told which there are."""
    without = {name: value for name, value in PERIODS.items() if name != "mode"}
    with pytest.raises(TypeError, match=r'mode: state which.*mode="long-axis".*mode="short-axis"'):
        call(APOPHIS, ORBIT, 6 * DAY, n=5, **without)
    with pytest.raises(TypeError, match=r'mode: state which.*mode="long-axis".*mode="short-axis"'):
        APOPHIS.free_motion_from_periods(**without)
    assert inspect.signature(call).parameters["mode"].default is inspect.Parameter.empty
    assert inspect.signature(RigidBody.free_motion_from_periods).parameters["mode"].default is (
        inspect.Parameter.empty
    )


def test_an_orbit_just_beyond_the_planet_and_a_parabola_are_flybys() -> None:
    assert not passed(3, radius=38011.48).failed.any()
    parabola = orbits.from_elements(EARTH, eccentricity=1.0, periapsis=4e4, since_periapsis=-DAY)
    assert not flybys.flyby(APOPHIS, parabola, 2 * DAY, n=3, **PERIODS).failed.any()
    code, _, err = run("flyby", *WORDS[:-6], "--eccentricity", "1", "--periapsis", "6371.1 km", "--n", "3")
    assert code == 0, err


class TestCommand:
    def test_it_tells_what_the_module_tells(self, tmp_path: Path) -> None:
        picture = tmp_path / "flyby.png"
        code, out, err = run("flyby", *WORDS, "--format", "json", "--save", picture)
        assert code == 0, err
        values = json.loads(out)
        metres = orbits.from_elements(
            EARTH * 1e9, eccentricity=4.253901873, periapsis=38011486.0, since_periapsis=-3 * DAY
        )
        found = flybys.flyby(APOPHIS, metres, 6 * DAY, n=200, **PERIODS)
        rows = {row["name"]: row for row in values["after"]}
        assert rows["spin rate, ratio"]["median"] == pytest.approx(np.median(found.spin_ratio), rel=1e-6)
        high = np.degrees(np.quantile(found.pole_shift, 0.95))
        assert rows["pole shift"]["high"] == pytest.approx(high, rel=1e-6)
        assert values["before"]["rotation_period"] == pytest.approx(264.178)
        assert {row["mode"] for row in values["modes"]} == set(found.modes())
        assert picture.stat().st_size > 10_000

    def test_a_known_attitude_has_the_forecast_of_the_module(self) -> None:
        known = ("--pole", "0.2", "0.1", "-1", "--azimuth", "40 deg")
        code, out, err = run("flyby", *WORDS, *known, "--phase", "0.3 ± 0.0005", "--format", "json")
        assert code == 0, err
        metres = orbits.from_elements(
            EARTH * 1e9, eccentricity=4.253901873, periapsis=38011486.0, since_periapsis=-3 * DAY
        )
        attitude: Any = {"pole": (0.2, 0.1, -1.0), "azimuth": np.radians(40)}
        start = PERIODS | attitude | {"phase": Uncertain(0.3, 0.0005)}
        forecast = flybys.flyby(APOPHIS, metres, 6 * DAY, n=200, **start).forecast
        assert forecast is not None
        assert forecast.linear
        factors = {"P_psi": 1 / 3600, "P_phi": 1 / 3600, "spin rate, ratio": 1, "pole shift": np.degrees(1)}
        rows = {row["name"]: row for row in json.loads(out)["forecast"]}
        for (name, factor), one in zip(factors.items(), forecast, strict=False):
            assert rows[name]["value"] == pytest.approx(one.value * factor, rel=1e-6)
            assert rows[name]["sigma"] == pytest.approx(one.sigma * factor, rel=1e-6)
        # Of a phase that is hardly known the first order is not enough; without a sigma there is no forecast.
        _, out, _ = run("flyby", *WORDS, *known, "--phase", "0.3 ± 0.1", "--format", "json")
        rough = json.loads(out)
        assert rough["forecast"][0]["sigma"] is None
        assert any("first order" in note for note in rough["notes"])
        _, out, _ = run("flyby", *WORDS, *known, "--phase", "0.3", "--format", "json")
        assert "forecast" not in json.loads(out)

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            ((), "give a file, or principal moments with --moments"),
            (("--moments", "1 2 2.5"), "--periods: state the two periods"),
            ((*WORDS[:-1], "0"), "--n: expected a positive number, got 0"),
            ((*WORDS, "--span", "-1 d"), "--span: expected a positive time"),
            ((*WORDS[:8], "--eccentricity", "-1"), "--eccentricity: expected 1 or more, got -1"),
            ((*WORDS[:8], "--eccentricity", "0.5"), "--eccentricity: 0.5 is that of an ellipse"),
            ((*WORDS[:10], "--periapsis", "6371 km"), "6371 km from the centre is within the planet"),
            ((*WORDS, "--radius", "40000 km"), "38011.5 km from the centre is within the planet"),
            (WORDS[:6], "--mode: state which of the two motions has these periods: --mode long-axis"),
            (
                (*WORDS, "--save", "x.txt"),
                "--save: 'x.txt' has a suffix that is not written; use one of .png, .pdf, .svg",
            ),
            ((*WORDS, "--pole", "0 0 0"), "pole: expected three numbers"),
            (("--moments", "1 2 2.5", "--periods", "1 h, 90 h", "--mode", "short-axis"), "period"),
        ],
    )
    def test_what_it_refuses(self, words: tuple[str, ...], message: str) -> None:
        code, _, err = run("flyby", *words)
        assert code == 2
        assert one_line(err)
        assert message in err
