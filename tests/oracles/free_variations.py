"""Derivatives of free motions in arbitrary precision, by differences of Taylor series in principal axes.

With 42 digits a difference quotient loses none that matter: changes of 1e-20 leave twenty. A small
rotation δ of the attitude is ``R → R exp(δ×)``, components in the body.

The derivatives of all cases take minutes: they are in ``free_variations.json``, which ``python -m
oracles.free_variations``, run in the folder of the tests, writes anew.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from mpmath import mp, mpf

__all__ = ["CASES", "jacobian", "table"]

TABLE = Path(__file__).with_suffix(".json")
# Moments, ω at zero, time.
CASES: dict[str, tuple[tuple[float, ...], tuple[float, ...], float]] = {
    "short-axis": ((1.0, 2.0, 2.5), (0.3, 0.2, 1.1), 9.0),
    "long-axis": ((1.0, 2.0, 2.5), (1.3, 0.2, -0.1), 9.0),
    "near the separatrix": ((1.0, 2.0, 2.5), (1e-3, 1.0, 1.1e-3), 14.0),
    "nearer": ((1.0, 2.0, 2.5), (1e-7, -1.0, -1.3e-7), 14.0),
    "onto it": ((1.0, 2.0, 2.5), (1e-3, 1.0, -0.89e-3), 14.0),
    "many flips": ((1.0, 2.0, 2.5), (1e-2, 1.0, 1.1e-2), 150.0),
    "the separatrix": ((2.0, 4.0, 4.5), (0.75, 0.3, 1.0), 9.0),
    "middle spin": ((1.0, 2.0, 2.5), (0.0, 1.0, 0.0), 14.0),
    "short spin": ((1.0, 2.0, 2.5), (0.0, 0.0, 1.0), 9.0),
    "nearly steady": ((1.0, 2.0, 2.5), (1.0, 1e-9, -1e-9), 9.0),
    "oblate": ((2.0, 2.0, 2.5), (0.3, 0.4, 1.0), 9.0),
    "across an oblate axis": ((2.0, 2.0, 2.5), (0.3, 0.4, 0.0), 9.0),
    "prolate": ((1.0, 2.0, 2.0), (0.6, 0.4, 0.5), 9.0),
    "spherical": ((2.0, 2.0, 2.0), (0.3, 0.4, 0.5), 9.0),
    "nearly spherical": ((2.0, 2.0 + 1e-9, 2.0 + 2e-9), (0.3, 0.4, 0.5), 9.0),
    "needle": ((1e-3, 2.0, 2.0005), (0.3, 0.4, 0.5), 9.0),
    "lamina": ((1.0, 2.0, 3.0), (0.3, 0.2, 1.1), -7.0),
}

ORDER = 30
STEP = mpf("1e-20")
State = tuple[list[mpf], list[mpf]]


def table() -> dict[str, np.ndarray]:
    """The derivatives of every case, (6, 9)."""
    return {name: np.array(rows) for name, rows in json.loads(TABLE.read_text("utf-8")).items()}


def jacobian(moments: Sequence[float], omega: Sequence[float], t: float) -> np.ndarray:
    """(6, 9): of (δ, ω) at `t` by (δ, ω) at zero and the moments; the attitude starts as the identity."""
    with mp.workdps(42):
        start = [*(mpf(x) for x in omega), *(mpf(x) for x in moments)]
        rates, attitude = _flow(start, mpf(t))
        conjugate = [-attitude[0], -attitude[1], -attitude[2], attitude[3]]
        columns = []
        for k in range(3):
            tilt = [mpf(0)] * 4
            tilt[k] = mpf(1)
            turned = _product(_product(conjugate, tilt), attitude)
            columns.append([*turned[:3], mpf(0), mpf(0), mpf(0)])
        for k in range(6):
            changed = list(start)
            changed[k] += STEP
            other_rates, other = _flow(changed, mpf(t))
            tilt = _product(conjugate, other)
            slopes = [2 * x / STEP for x in tilt[:3]]
            columns.append([*slopes, *((a - b) / STEP for a, b in zip(other_rates, rates, strict=True))])
        return np.array([[float(x) for x in column] for column in columns]).T


def _flow(start: Sequence[mpf], t: mpf) -> State:
    """ω and attitude at `t`, the attitude starting as the identity; `start` is ω and the moments."""
    w, (i, j, k) = list(start[:3]), start[3:]
    q = [mpf(0), mpf(0), mpf(0), mpf(1)]
    factors = [(j - k) / i, (k - i) / j, (i - j) / k]
    # Coefficients fall at least as (|ω| t)ⁿ.
    count = int(mpmath.ceil(abs(t) * mpmath.norm(w) / mpf("0.22"))) or 1
    for _ in range(count):
        w, q = _step(w, q, factors, t / count)
    return w, q


def _step(w: list[mpf], q: list[mpf], factors: list[mpf], h: mpf) -> State:
    W, Q = [[x] for x in w], [[x] for x in q]
    for n in range(ORDER):

        def term(a: list[mpf], b: list[mpf], n: int = n) -> mpf:
            return mpmath.fdot(a[: n + 1], b[n::-1])

        products = [term(W[1], W[2]), term(W[2], W[0]), term(W[0], W[1])]
        x, y, z, u = Q
        turns = [
            term(u, W[0]) + term(y, W[2]) - term(z, W[1]),
            term(u, W[1]) + term(z, W[0]) - term(x, W[2]),
            term(u, W[2]) + term(x, W[1]) - term(y, W[0]),
            -term(x, W[0]) - term(y, W[1]) - term(z, W[2]),
        ]
        for row, factor, product in zip(W, factors, products, strict=True):
            row.append(factor * product / (n + 1))
        for row, turn in zip(Q, turns, strict=True):
            row.append(turn / (2 * (n + 1)))
    powers = [h**n for n in range(ORDER + 1)]
    return [mpmath.fdot(row, powers) for row in W], [mpmath.fdot(row, powers) for row in Q]


def _product(p: Any, q: Any) -> list[mpf]:
    a, b, c, d = p
    x, y, z, w = q
    return [
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    ]


if __name__ == "__main__":
    found = {name: jacobian(*case).tolist() for name, case in CASES.items()}
    rows = (f"{json.dumps(name)}: {json.dumps(slopes)}" for name, slopes in found.items())
    TABLE.write_text("{\n" + ",\n".join(rows) + "\n}\n", "utf-8")
