"""Frequencies of the light curve of a tumbling body, and the short-axis convention of its periods."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from command_line import run
from polhode import FreeMotion, RigidBody, _core

BODY = RigidBody.from_principal(1.0, (1.0, 2.2, 2.6))
MOTIONS = {
    "long-axis": BODY.free_motion_from_periods(7.3, 5.0, mode="long-axis"),
    "short-axis": BODY.free_motion((0.25, 0.1, 1.0)),
}


def brightness(motion: FreeMotion, t: Any) -> Any:
    """The light of a lopsided body: a function of the fixed direction from which it is seen, in the body."""
    seen = _core.rotate(motion.at(t).quaternion, np.array([0.6, 0.0, 0.8]), inverse=True)
    x, y, z = seen.T
    return np.sqrt(x * x / 9 + y * y / 4 + z * z) + 0.1 * x + 0.05 * y * z + 0.08 * np.exp(-z)


@pytest.mark.parametrize("mode", MOTIONS)
@pytest.mark.parametrize(("off", "is_right"), [(0.0, True), (0.002, False)])
def test_brightness_is_a_series_in_these_frequencies(mode: str, off: float, is_right: bool) -> None:
    motion = MOTIONS[mode]
    assert motion.mode == mode
    t = np.linspace(0.0, 60.0 * motion.periods.precession, 4001)
    seen = brightness(motion, t)
    found = motion.periods.light_curve(order=8)
    phase = 2.0 * np.pi * np.outer(t, found.frequency * (1.0 + off))
    terms = np.hstack([np.ones((len(t), 1)), np.cos(phase), np.sin(phase)])
    fitted = terms @ np.linalg.lstsq(terms, seen, rcond=1e-10)[0]
    left = np.std(seen - fitted) / np.std(seen)  # what terms of higher orders carry
    assert left < 1e-3 if is_right else left > 1e-2


@pytest.mark.parametrize("mode", MOTIONS)
def test_the_short_axis_convention(mode: str) -> None:
    """P_φ from the path of axis 3 about L itself, over many turns."""
    motion = MOTIONS[mode]
    periods = motion.periods
    assert 1 / periods.precession_short_axis == pytest.approx(1 / periods.precession + 1 / periods.rotation)
    t = np.linspace(0.0, 400.0 * periods.precession, 400_001)
    axis = np.array(_core.rotate(motion.at(t).quaternion, BODY.principal.axes[:, 2]))
    L = motion.angular_momentum().spin / np.linalg.norm(motion.angular_momentum().spin)
    across = np.cross(L, (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    angle = np.unwrap(np.arctan2(axis @ np.cross(L, across), axis @ across))
    turns = (angle[-1] - angle[0]) / (2.0 * np.pi)
    assert t[-1] / turns == pytest.approx(periods.precession_short_axis, rel=3e-3)


def test_orders_and_pairs() -> None:
    periods = MOTIONS["long-axis"].periods
    found = periods.light_curve()
    pairs = set(zip(found.j.tolist(), found.m.tolist(), strict=True))
    assert len(pairs) == len(found.j) == 12
    assert not {(0, 0)} & pairs
    assert all((-j, -m) not in pairs for j, m in pairs)
    k = sorted(pairs).index((2, -1))
    order = np.lexsort((found.m, found.j))
    assert found.frequency[order[k]] == pytest.approx(abs(2 / 5.0 - 1 / 7.3), rel=1e-12)
    stack = RigidBody.stack([BODY, BODY]).free_motion([(0.25, 0.1, 1.0), (1.0, 0.1, 0.2)])
    assert stack.periods.light_curve(3).frequency.shape == (2, 24)
    for order_ in (0, 101, 2.0, True):
        with pytest.raises(ValueError, match="is not a whole number from 1 to 100"):
            periods.light_curve(order_)  # type: ignore[arg-type]


def test_the_report_tells_them() -> None:
    """Toutatis: 5.41 d and 7.35 d give 3.116 d in the short-axis convention."""
    words = ("spin", "--moments", "1 3.01307 3.18992", "--periods", "5.41 d, 7.35 d", "--mode", "long-axis")
    code, out, err = run(*words, "--format", "json")
    assert (code, err) == (0, "")
    told = json.loads(out)
    assert told["short_axis"]["precession_period"] / 86400 == pytest.approx(
        5.41 * 7.35 / (5.41 + 7.35), rel=1e-9
    )
    rows = {(row["j"], row["m"]): row for row in told["light_curve"]}
    assert len(rows) == 12
    assert rows[2, 0]["period"] == pytest.approx(7.35 * 24 / 2, rel=1e-9)
    assert rows[1, 1]["frequency"] == pytest.approx(1 / 5.41 + 1 / 7.35, rel=1e-9)
    assert "swinging, about e3" in run(*words)[1]
    code, out, _ = run("spin", "--moments", "1 3 3.2", "--omega", "0 0.1 1", "--format", "json")
    told = json.loads(out)  # however the motion was started
    assert len(told["light_curve"]) == 12
    periods = RigidBody.from_principal(1.0, (1.0, 3.0, 3.2)).free_motion((0.0, 0.1, 1.0)).periods
    assert told["short_axis"]["precession_period"] == pytest.approx(periods.precession_short_axis, rel=1e-12)
    code, out, _ = run(
        "spin", "--moments", "0.61 0.965 1", "--periods", "263 h, 27.38 h", "--mode", "short-axis"
    )
    assert "rotation, about e3" in out
