"""Ends of motions that an attractor's field turns, on orbits of every eccentricity, and their derivatives.

By Taylor series in 40 digits; the orbit is integrated with the body. ``python -m oracles.orbit_torques`` in
the folder ``tests`` writes ``oracles/tables/orbit_torques.json``.
"""

from __future__ import annotations

import json
import sys
from typing import Any, NamedTuple

import numpy as np
from mpmath import mpf

from oracles.load_variations import Setting, end, jacobian
from oracles.motion_cases import TABLES

__all__ = ["CASES", "Known", "Passage", "setting", "table"]

TABLE = TABLES / "orbit_torques.json"
DIGITS = 40
CHANGE = mpf("1e-18")
NEAR = (1e-12, 1e-9, 1e-6, 1e-3)
ECCENTRICITIES = (
    0.0, 1e-9, 0.3, 0.9, *(1 - gap for gap in NEAR), 1.0, *(1 + gap for gap in NEAR),
    1.1, 2.0, 4.253901873, 30.0, 1e3, 1e6,
)  # fmt: skip
BODY = {"moments": [0.64, 0.97, 1.0], "mass": 1.0}
OMEGA = [0.3, -0.4, 1.2]


class Passage(NamedTuple):
    """An eccentricity, and the share of the way to the farthest direction at which the motion starts."""

    eccentricity: float
    start: float


class Known(NamedTuple):
    """The end of a motion in many digits, and its derivatives."""

    omega: np.ndarray
    quaternion: np.ndarray
    slopes: np.ndarray


# From the periapsis and through it, on hyperbolas from far away too.
CASES = tuple(
    Passage(e, start) for e in ECCENTRICITIES for start in ((0.0, -0.7, -0.93) if e > 1.01 else (0.0, -0.7))
)


def setting(case: Passage) -> Setting:
    """The motion of a case: the distance of the periapsis and the speed there are one."""
    e = case.eccentricity
    mu = 1.0 / (1.0 + e)
    farthest = np.pi if e < 1 else np.arccos(-1.0 / e)
    nu = case.start * farthest
    distance = (1 + e) / (1 + e * np.cos(nu))
    plane = np.array([[1.0, 0.0], [0.0, 0.8], [0.0, 0.6]])
    position = plane @ (distance * np.array([np.cos(nu), np.sin(nu)]))
    velocity = plane @ (mu * np.array([-np.sin(nu), e + np.cos(nu)]))
    time = 3.0 + 2.0 * distance * abs(np.sin(nu)) / np.linalg.norm(velocity)
    load: list[dict[str, Any]] = [
        {"kind": "gravity_gradient", "mu": mu, "position": position.tolist(), "velocity": velocity.tolist()}
    ]
    return Setting(BODY, OMEGA, load, False, float(round(time, 3)))


def table() -> dict[Passage, Known]:
    """What is known of each of `CASES`."""
    rows = json.loads(TABLE.read_text("utf-8"))
    return {Passage(*key): Known(*map(np.array, values)) for key, *values in rows}


if __name__ == "__main__":
    which, of = (int(x) for x in sys.argv[1:3]) if len(sys.argv) > 1 else (0, 1)
    rows = []
    for case in CASES[which::of]:
        given = setting(case)
        rows.append([case, *end(given, DIGITS), jacobian(given, DIGITS, CHANGE).tolist()])
        print(case, given.time, flush=True)
        TABLE.with_suffix(f".{which}.json" if of > 1 else ".json").write_text(
            "[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n", "utf-8"
        )
