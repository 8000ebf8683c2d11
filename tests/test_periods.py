"""Each period that is printed is one of the motion: against an integration of the equations by SciPy.

The periods come from the report of ``polhode spin``, so that its words are tried too. Nothing of the package
computes the motion that they are compared with.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run
from numpy.typing import NDArray
from polhode import RigidBody
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Callable

Floats = NDArray[np.float64]

KINDS = (
    "tumbling", "near the separatrix", "small wobble", "steady 1", "steady 2", "steady 3", "oblate",
    "prolate", "along an axis", "across an axis", "sphere", "gyrostat",
    "steady gyrostat", "top", "sleeping top",
)  # fmt: skip


def integrate(moments: Floats, omega: Floats, end: float, h: Any = (0.0, 0.0, 0.0)) -> Any:
    """Integrate ω in principal axes and the attitude (x, y, z, w), with a constant momentum h inside."""
    (a, b, c), (u, v, w) = moments.tolist(), tuple(h)

    def rates(_t: float, s: Floats) -> list[float]:
        x, y, z, p, q, r, e = s.tolist()
        k, m, n = a * x + u, b * y + v, c * z + w
        return [
            (m * z - n * y) / a, (n * x - k * z) / b, (k * y - m * x) / c,
            0.5 * (e * x + q * z - r * y), 0.5 * (e * y + r * x - p * z), 0.5 * (e * z + p * y - q * x),
            -0.5 * (p * x + q * y + r * z),
        ]  # fmt: skip

    start = [*omega, 0.0, 0.0, 0.0, 1.0]
    return solve_ivp(rates, (0.0, end), start, "DOP853", rtol=1e-11, atol=1e-13, dense_output=True).sol


def off(omega: Floats, other: Floats) -> float:
    """How far two angular velocities are from each other, in units of the first."""
    return float(np.linalg.norm(omega - other) / np.linalg.norm(omega))


def around(moments: Floats, omega: Floats, sol: Any, axis: int, end: float, momentum: Any = None) -> float:
    """Angle by which an axis goes round L, followed along the way."""
    t = np.linspace(0.0, end, 64 + int(40 * end * np.linalg.norm(omega)))
    states = sol(t).T
    L = moments * omega if momentum is None else momentum
    L = L / np.linalg.norm(L)
    side = np.cross(L, np.eye(3)[int(np.argmin(np.abs(L)))])
    side /= np.linalg.norm(side)
    path = Rotation.from_quat(states[:, 3:]).apply(np.eye(3)[axis])
    angle = np.unwrap(np.arctan2(path @ np.cross(L, side), path @ side))
    return float(angle[-1] - angle[0])


def report(moments: Floats, omega: Floats, *words: object) -> tuple[dict[str, Any], str]:
    """What the command prints of a motion: its numbers, and its words."""
    given = [" ".join(map(repr, numbers.tolist())) for numbers in (moments, omega)]
    asked = ("spin", "--moments", given[0], "--omega", given[1], *words)
    code, out, err = run(*asked, "--format", "json")
    assert code == 0, err
    return json.loads(out), run(*asked)[1]


def periods_of(told: dict[str, Any]) -> dict[str, float]:
    return {
        key.removesuffix("_period"): np.inf if value == "Infinity" else value
        for key, value in told.items()
        if key.endswith("_period") and value is not None
    }


def box(rng: np.random.Generator) -> Floats:
    """Moments of a box whose sides differ."""
    while True:
        squares = np.sort(rng.uniform(0.3, 2.0, 3)) ** 2
        moments = np.sort(squares.sum() - squares)
        if np.diff(moments).min() > 0.05 * moments[2]:
            return moments


def tumbling(rng: np.random.Generator, kind: str) -> tuple[Floats, Floats]:
    moments = box(rng)
    omega = rng.normal(size=3)
    if kind == "small wobble":
        omega = omega * 0.03 + rng.choice([-1.0, 1.0]) * np.eye(3)[rng.choice([0, 2])]
    elif kind == "near the separatrix":
        omega = omega * 0.02 + np.array([0.0, 1.0, 0.0])
    elif kind.startswith("steady"):
        omega = rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 2.0) * np.eye(3)[int(kind[-1]) - 1]
    elif kind in ("oblate", "prolate", "along an axis", "across an axis"):
        x = rng.uniform(0.2, 0.9) if kind != "oblate" else rng.uniform(1.1, 2.0)
        moments = np.sort([1.0, 1.0, x])
        own = 2 if x > 1.0 else 0
        if kind == "along an axis":
            omega = omega[0] * np.eye(3)[own]
        elif kind == "across an axis":
            omega[own] = 0.0
    elif kind == "sphere":
        moments = np.full(3, moments[0])
    return moments, omega


def check_free(moments: Floats, omega: Floats, told: dict[str, Any], words: str) -> None:
    """Every printed period of a free motion."""
    found, speed = periods_of(told), float(np.linalg.norm(omega))
    L = np.linalg.norm(moments * omega)
    end = max((x for x in found.values() if np.isfinite(x)), default=0.0)
    sol = integrate(moments, omega, max(end, 10.0 / speed))
    lean = np.abs(moments[1] * sol(np.linspace(0.0, end, 4001))[1]) / L
    assert ("flip" in found) == ("flips" in words)
    if found.get("turn") is not None:
        assert set(found) <= {"turn", "wobble"}
        full, half = (Rotation.from_quat(sol(part * found["turn"])[3:]).magnitude() for part in (1.0, 0.5))
        assert full < 1e-8
        assert half == pytest.approx(np.pi, abs=1e-8)
        assert off(omega, sol(0.3 * found["turn"])[:3]) < 1e-9
        check_wobble(moments, omega, found.get("wobble"))
    elif "spin" in found:
        assert set(found) == {"spin", "precession"}
        own = 2 if moments[0] == moments[1] else 0
        across = [k for k in range(3) if k != own]
        phase = np.unwrap(
            np.arctan2(*sol(np.linspace(0.0, found["spin"], 400))[across][::-1])
        )  # of ω about the axis, in the body
        assert abs(phase[-1] - phase[0]) == pytest.approx(2 * np.pi, rel=1e-8)
        assert around(moments, omega, sol, own, found["precession"]) == pytest.approx(2 * np.pi, rel=1e-8)
    else:
        assert set(found) - {"flip"} == {"rotation", "precession"}
        assert off(omega, sol(found["rotation"])[:3]) < 1e-6
        assert off(omega, sol(0.5 * found["rotation"])[:3]) > 1e-3  # it is the first time
        turned = around(moments, omega, sol, 0, found["rotation"])
        assert turned == pytest.approx(2 * np.pi * found["rotation"] / found["precession"], rel=1e-6)
        assert ("flip" in found) == (lean.max() > np.sqrt(0.5))
        if "flip" in found:
            later = sol(np.linspace(0.0, found["rotation"] - found["flip"], 50))
            over = sol(np.linspace(found["flip"], found["rotation"], 50))
            np.testing.assert_allclose(over[1], -later[1], atol=1e-5 * speed)
    short = told.get("short_axis")
    assert (short is not None) == ("rotation" in found)
    if short is not None:
        turned = around(moments, omega, sol, 2, found["rotation"])
        assert turned == pytest.approx(2 * np.pi * found["rotation"] / short["precession_period"], rel=1e-6)
    check_light_curve(found, told["light_curve"])


def check_wobble(moments: Floats, omega: Floats, wobble: float | None, h: Any = (0.0, 0.0, 0.0)) -> None:
    """A small push comes back after that period; it grows, or stays, where none is told."""
    push = 1e-6 * np.linalg.norm(omega) * np.array([0.36, 0.48, 0.8])
    push -= (push @ omega) / (omega @ omega) * omega
    speed = float(np.linalg.norm(omega))
    span = 20.0 / speed if wobble is None else wobble
    sol = integrate(moments, omega + push, span, h)
    moved = sol(np.linspace(0.0, span, 201))[:3].T - sol(0.0)[:3]
    size = np.linalg.norm(moved, axis=-1) / np.linalg.norm(push)
    if wobble is not None:
        assert size[-1] < 1e-3
        assert size[1:-1].min() > 2.0 * size[-1]  # it is the first time
        assert size.max() > 1e-2
    else:
        # No oscillation, which would come back to the start, as long as the way is small enough to be linear.
        near = size[: 1 + int(np.argmax(size > 1e3))] if size.max() > 1e3 else size
        assert (near >= 0.2 * np.maximum.accumulate(near) - 1e-4).all()


def check_light_curve(found: dict[str, float], rows: list[dict[str, Any]]) -> None:
    """Frequencies are those of the periods that stand above them."""
    assert rows
    first = found.get("turn", found.get("precession"))
    second = found.get("spin", found.get("rotation", np.inf))
    assert first is not None
    for row in rows:
        exact = abs(row["j"] / first + row["m"] / second)
        assert row["frequency"] / 86400.0 == pytest.approx(exact, rel=1e-9)
        assert row["period"] * 3600.0 == pytest.approx(1.0 / exact, rel=1e-9)
        assert "turn" not in found or row["m"] == 0


def check_gyrostat(rng: np.random.Generator, *, is_steady: bool) -> None:
    moments, h = box(rng), rng.normal(size=3)
    omega = rng.normal(size=3)
    if is_steady:
        # L = I ω + h along ω, without rounding: all numbers have few digits.
        moments, omega = np.round(64.0 * moments) / 64.0, np.round(16.0 * omega) / 16.0 + 1.0 / 32.0
        h = (np.round(16.0 * rng.normal()) / 8.0 - moments) * omega
        if rng.integers(2):
            h[:2] = omega[:2] = 0.0
    wheels = [("--wheel", f"{axis}, {x!r} kg m^2/s") for axis, x in zip("xyz", h.tolist(), strict=True)]
    told, words = report(moments, omega, *(word for wheel in wheels for word in wheel))
    assert (told["mode"] == "steady") == is_steady
    assert "flips" not in words
    found, speed = periods_of(told), float(np.linalg.norm(omega))
    sol = integrate(moments, omega, max([*(x for x in found.values() if np.isfinite(x)), 1.0 / speed]), h)
    if is_steady:
        assert "turn" in found
        assert off(omega, sol(0.3 * found["turn"])[:3]) < 1e-8
        assert Rotation.from_quat(sol(found["turn"])[3:]).magnitude() < 1e-7
        check_wobble(moments, omega, found.get("wobble"), h)
        return
    assert not set(found) & {"turn", "wobble", "flip"}
    period = told["period"]
    sol = integrate(moments, omega, period, h)
    assert off(omega, sol(period)[:3]) < 1e-6
    moved = np.linalg.norm(sol(np.linspace(0.0, period, 401)[20:-20])[:3].T - omega, axis=-1)
    assert moved.min() > 0.0


def check_top(rng: np.random.Generator, *, sleeps: bool) -> None:
    across, arm = rng.uniform(0.6, 1.0), rng.uniform(0.3, 1.0)
    own = across * rng.uniform(1.1, 1.6) if sleeps else rng.uniform(0.2, 1.1)
    tilt = 0.0 if sleeps else rng.uniform(0.2, 2.5)
    omega = np.array([0.0, 0.0, rng.uniform(2.0, 12.0)])
    if not sleeps:
        omega[:2] = rng.normal(size=2)
    mass, g = 1.0, 9.81
    # Moments about C; the command takes them ascending, along the axes e1, e2, e3 of the file.
    moments = np.sort([across, across, own])
    axis = 2 if own > across else 0
    center = arm * np.eye(3)[axis]
    turn = Rotation.from_euler("y", -90.0, degrees=True) if axis == 0 else Rotation.identity()  # e1 up
    start = Rotation.from_euler("x", tilt) * turn
    given = turn.inv().apply(omega)
    phi, theta, psi = start.as_euler("ZXZ") if tilt else (0.0, 0.0, 0.0)
    words = (
        "--mass", "1", "--center-of-mass", " ".join(map(repr, center.tolist())), "--gravity", "9.81",
        "--attitude", " ".join(map(repr, (float(phi), float(theta), float(psi)))),
    )  # fmt: skip
    told, text = report(moments, given, *words)
    assert "flips" not in text
    found = periods_of(told)
    about = moments + mass * arm**2 * (1.0 - np.eye(3)[axis])

    def rates(_t: float, s: Floats) -> Floats:
        q, w = s[3:], s[:3]
        down = Rotation.from_quat(q).inv().apply([0.0, 0.0, -mass * g])
        turned = np.concatenate([q[3] * w + np.cross(q[:3], w), [-q[:3] @ w]])
        return np.concatenate([(np.cross(center, down) - np.cross(w, about * w)) / about, 0.5 * turned])

    if sleeps:
        assert set(found) == {"turn"}
        assert found["turn"] == pytest.approx(2 * np.pi / np.linalg.norm(omega), rel=1e-12)
        return
    assert set(found) == {"nutation"}
    period = found["nutation"]
    sol = solve_ivp(
        rates, (0.0, period), [*given, *start.as_quat()], "DOP853", rtol=1e-9, atol=1e-11, dense_output=True
    ).sol
    height = Rotation.from_quat(sol(np.linspace(0.0, period, 401))[3:].T).apply(center)[:, 2]
    assert height[-1] == pytest.approx(height[0], abs=1e-5)
    assert np.ptp(height) > 1e-9


def check(kind: str, seed: int) -> None:
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    if "gyrostat" in kind:
        check_gyrostat(rng, is_steady=kind.startswith("steady"))
    elif "top" in kind:
        check_top(rng, sleeps=kind.startswith("sleeping"))
    else:
        moments, omega = tumbling(rng, kind)
        check_free(moments, omega, *report(moments, omega))


@pytest.mark.parametrize("kind", KINDS)
def test_printed_periods_are_those_of_the_motion(kind: str) -> None:
    for seed in range(2):
        check(kind, seed)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_printed_periods_are_those_of_a_thousand_motions(kind: str) -> None:
    for seed in range(2, 70):
        check(kind, seed)


BRICK = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
NAMES = ("turn", "wobble", "spin", "rotation", "precession", "flip")


@pytest.mark.parametrize(
    ("moments", "omega", "known"),
    [
        ((1.0, 2.0, 2.5), (0.0, 0.0, 10.0), {"turn", "wobble"}),
        ((1.0, 2.0, 2.5), (10.0, 0.0, 0.0), {"turn", "wobble"}),
        ((1.0, 2.0, 2.5), (0.0, 10.0, 0.0), {"turn"}),
        ((1.0, 2.0, 2.5), (0.0, 0.0, 0.0), {"turn"}),
        ((1.0, 1.0, 2.0), (0.0, 0.0, 10.0), {"turn", "wobble"}),
        ((1.0, 1.0, 2.0), (0.0, 10.0, 0.0), {"turn"}),
        ((1.0, 1.0, 2.0), (1.0, 0.0, 10.0), {"spin", "precession"}),
        ((0.5, 2.0, 2.0), (1.0, 0.0, 10.0), {"spin", "precession"}),
        ((2.0, 2.0, 2.0), (1.0, 0.0, 10.0), {"turn"}),
        ((1.0, 2.0, 2.5), (0.3, 0.2, 1.1), {"rotation", "precession"}),
        ((1.0, 2.0, 2.5), (0.001, 6.0, 0.0), {"rotation", "precession", "flip"}),
        ((2.0, 4.0, 4.5), (0.75, 0.3, 1.0), {"rotation", "precession", "flip"}),
    ],
)
def test_a_motion_has_the_periods_of_its_mode_alone(moments: Any, omega: Any, known: set[str]) -> None:
    """The others are NaN in Python, and not in the report; so is it in a stack."""
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega)
    assert {name for name in NAMES if not np.isnan(getattr(motion.periods, name))} == known
    told, words = report(np.array(moments), np.array(omega))
    assert set(periods_of(told)) == known
    assert ("flips" in words) == ("flip" in known)
    both = RigidBody.from_principal(1.0, [moments, (1.0, 2.0, 2.5)]).free_motion([omega, (0.001, 6.0, 0.0)])
    for name in NAMES:
        np.testing.assert_equal(getattr(both.periods, name)[0], getattr(motion.periods, name))


def test_a_steady_spin_turns_once_in_its_turn() -> None:
    """10 rad/s about the third axis of moments 1, 3 and 3.2: a turn takes 0.628 s, and nothing flips."""
    told, words = report(np.array([1.0, 3.0, 3.2]), np.array([0.0, 0.0, 10.0]))
    assert told["turn_period"] == pytest.approx(2 * np.pi / 10.0, rel=1e-15)
    rate = 10.0 * np.sqrt(2.2 * 0.2 / 3.0)
    assert told["wobble_period"] == pytest.approx(2 * np.pi / rate, rel=1e-14)
    assert "flips" not in words
    assert "P_psi" not in words
    assert "about e3" in words
    assert "the spin is unstable" in report(np.array([1.0, 3.0, 3.2]), np.array([0.0, 10.0, 0.0]))[1]


@pytest.mark.parametrize("circled", [0, 2])
@pytest.mark.parametrize(("share", "flips"), [(1.0 - 1e-7, False), (1.0 + 1e-7, True)])
def test_the_intermediate_axis_turns_over_where_it_is_the_nearest_to_the_momentum(
    circled: int, share: float, flips: bool
) -> None:
    """L is in the plane of axis 2 and the axis that is circled, half a right angle from both."""
    momentum = np.array([0.0, share, 0.0]) + np.eye(3)[circled]
    motion = BRICK.free_motion(momentum / BRICK.principal_moments)
    assert motion.mode == ("long-axis" if circled == 0 else "short-axis")
    assert np.isnan(motion.periods.flip) != flips


def test_fast_spins_have_light_curves_in_seconds_and_slow_ones_in_hours() -> None:
    fast = report(np.array([1.0, 3.0, 3.2]), np.array([0.0, 0.1, 1.0]))
    slow = report(np.array([1.0, 3.0, 3.2]), np.array([0.0, 1e-6, 1e-5]))
    assert "frequency, 1/s" in fast[1]
    assert "frequency, 1/d" in slow[1]
    for told, _ in (fast, slow):
        assert told["units"]["light_curve"] == {"frequency": "1/d", "period": "h"}
    rows: Callable[[Any], Any] = lambda told: [(row["j"], row["m"]) for row in told["light_curve"]]  # noqa: E731
    assert rows(fast[0]) == rows(slow[0])


def test_what_never_repeats_has_no_light_curve() -> None:
    told, words = report(np.array([2.0, 4.0, 4.5]), np.array([0.75, 0.3, 1.0]))
    assert told["rotation_period"] == told["flip_period"] == "Infinity"
    assert "light_curve" not in told
    assert "no frequencies of a light curve: the motion never repeats" in words
