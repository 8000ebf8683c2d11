"""Of a hundred intervals of 95 %, ninety-five hold the truth.

A body is drawn, and measured with the errors that its sigmas tell of; the package is given what was measured.
Each interval is the value ± 1.96 σ, both as the package says them, where it calls the sigma linear.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
from oracles.matter_models import Node, displaced
from oracles.uncertain_cases import KINDS, case
from oracles.uncertainty import Sources, values
from polhode.errors import InvalidInertiaError
from polhode.uncertainty import propagate
from scipy.special import ellipk
from uncertain_bodies import Bodies, symmetric

SIX = np.array([0, 4, 8, 1, 2, 5])
ROOMS = {"mass": 1, "center_of_mass": 3, "inertia": 6, "principal_moments": 3, "axes": 3}


def period(tensor: Any, omega: Any) -> float:
    """Of the rates in the body: Landau and Lifshitz, Mechanics §37."""
    a, b, c = np.linalg.eigvalsh(tensor)
    L = tensor @ omega
    m, e = L @ L, omega @ L
    if m < e * b:
        a, c = c, a
    parameter = (b - a) * (e * c - m) / ((c - b) * (m - e * a))
    return float(4 * ellipk(parameter) * np.sqrt(a * b * c / ((c - b) * (m - e * a))))


def angles(frame: Any, truth: Any) -> Any:
    """Small rotation from one frame of axes to another, about the first one's axes."""
    turn = frame.T @ truth
    turn = turn * np.sign(np.diag(turn))
    return np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2


def held(body: Any, truth: Any, axes: Any, tally: Counter[tuple[str, bool]]) -> None:
    """Counts which intervals hold the truth."""
    s = body.sigma
    tensor = symmetric(truth[4:])
    errors = {
        "mass": np.atleast_1d(body.mass - truth[0]),
        "center_of_mass": body.center_of_mass - truth[1:4],
        "inertia": (body.inertia - tensor).ravel()[SIX],
        "principal_moments": body.principal_moments - np.linalg.eigvalsh(tensor),
        "axes": angles(body.principal.axes, axes),
    }
    for word, count in ROOMS.items():
        sigma, linear = np.asarray(getattr(s, word)), np.asarray(getattr(s.linear, word))
        if word == "inertia":
            sigma, linear = sigma.ravel()[SIX], np.broadcast_to(linear, (3, 3)).ravel()[SIX]
        size = float(np.abs(body.inertia).max()) if word in ("inertia", "principal_moments") else 1.0
        known = (np.broadcast_to(sigma, count) > 1e-9 * size) & np.broadcast_to(linear, count)
        for error, one in zip(errors[word][known], np.broadcast_to(sigma, count)[known], strict=True):
            tally[word, bool(abs(error) <= 1.959964 * one)] += 1


def held_period(body: Any, truth: Any, omega: Any, tally: Counter[tuple[str, bool]]) -> None:
    found = propagate(lambda b: b.free_motion(omega).periods.rotation, body)
    error = float(found.value) - period(symmetric(truth[4:]), omega)
    if found.sigma < 1e-12 * found.value:  # of a body known but for its mass: there is no interval
        assert abs(error) < 1e-11 * found.value
    elif np.all(found.linear):
        tally["period", bool(abs(error) <= 1.959964 * float(found.sigma))] += 1


def bodies_of(rng: np.random.Generator, count: int, kinds: list[str]) -> Any:
    """Measured bodies, with the ten numbers and the axes of the true ones."""
    refused = 0
    for k in range(count):
        node: Node = case(kinds[k % len(kinds)], int(rng.integers(10**6)))
        sources = Sources(node)
        measured = displaced(node, sources.own(rng.standard_normal(sources.count)))
        truth, axes = values(node)
        moments = np.linalg.eigvalsh(symmetric(truth[4:]))
        try:
            body = Bodies().body(measured)
        except InvalidInertiaError:  # who measures that measures again
            refused += 1
            continue
        yield body, truth, axes, np.diff(moments) / moments[2]
    assert refused <= 1 + 1e-3 * count


def cover(count: int, motions: int, seed: int, within: float) -> None:
    """Each share is 95 %, within this and four standard errors of the count."""
    rng = np.random.default_rng(seed)
    tally: Counter[tuple[str, bool]] = Counter()
    for k, (body, truth, axes, gaps) in enumerate(bodies_of(rng, count, sorted(KINDS))):
        if body.covariance is None or gaps.min() < 1e-3:
            continue
        held(body, truth, axes, tally)
        if k < motions and gaps.min() > 0.1:
            omega = axes @ (rng.choice([[2.0, 0.4, 0.3], [0.3, 0.4, 2.0]]) * rng.uniform(0.5, 1.5, 3))
            held_period(body, truth, omega, tally)
    failed = []
    for word in [*ROOMS, "period"]:
        n = tally[word, True] + tally[word, False]
        share = tally[word, True] / n
        print(f"{word}: {share:.4f} of {n}")
        if abs(share - 0.95) > within + 4 * (0.0475 / n) ** 0.5:
            failed.append(f"{word}: {share:.4f} of {n}")
    assert not failed


class TestCoverage:
    def test_of_some(self) -> None:
        cover(750, 350, 1, 0.01)

    @pytest.mark.long
    def test_of_more(self) -> None:
        cover(1500, 700, 1, 0.01)

    @pytest.mark.long
    @pytest.mark.timeout(3000)
    def test_of_twenty_thousand(self) -> None:
        cover(40_000, 40_000, 2, 0.01)
