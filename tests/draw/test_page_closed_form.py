"""The motion of a free body as the page computes it, beside the package: JavaScript in node or a browser."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from browser import BROWSER, Browser
from places import ROOT
from polhode import RigidBody

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from polhode import FreeMotion

    Floats = NDArray[np.float64]

MODULES = ROOT / "python/polhode/draw/animation/web"
NODE = shutil.which("node")
ASKED = """([moments, omega, attitude, times]) => {
  const body = new FreeBody(moments, omega, attitude);
  const row = (t) => { const s = body.at(t); return [...s.omega, ...s.attitude, body.nextFlip(t)]; };
  return [body.halfPeriod, times.map(row)];
}"""
STARTS = 1000

pytestmark = pytest.mark.skipif(NODE is None and BROWSER is None, reason="neither node nor Chromium")


def computed(cases: list[Any], folder: Path) -> list[Any]:
    """Half periods, and at each time ω, the attitude and the time to the next flip."""
    if NODE is not None:
        script = f"""import {{ FreeBody }} from {json.dumps((MODULES / "free.js").as_uri())};
import {{ readFileSync }} from "node:fs";
console.log(JSON.stringify(JSON.parse(readFileSync(0)).map({ASKED})));"""
        program = folder / "asked.mjs"
        program.write_text(script, encoding="utf-8")
        # What is not a number or not finite is null in JSON.
        done = subprocess.run(
            [NODE, program], input=json.dumps(cases), capture_output=True, text=True, check=True
        )
        answers: list[Any] = json.loads(done.stdout)
        return answers
    page = (
        RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        .simulate([0.0, 1.0], (0.1, 1.0, 0.1))
        .animate(folder / "a.html")
    )
    with Browser(folder) as browser:
        browser.open(page)
        script = f"(() => {{ const {{ FreeBody }} = polhode; return {json.dumps(cases)}.map({ASKED}); }})()"
        return list(browser.run(script))


def separation(moments: Floats, omega: Floats) -> float:
    """(L² − 2T I₂)/L²."""
    a, b, c = moments
    x, _, z = omega
    return float((c * (c - b) * z * z - a * (b - a) * x * x) / ((moments * omega) ** 2).sum())


def starts(rng: np.random.Generator, count: int) -> list[tuple[Floats, Floats]]:
    """Bodies of every shape; of each third start one at 1e-6 to 1e-2 from the separatrix, on either side."""
    found: list[tuple[Floats, Floats]] = []
    while len(found) < count:
        second = rng.uniform(0.02, 1.0, 3)
        moments, omega = np.sort(second.sum() - second), rng.normal(size=3)
        if len(found) % 3 == 0:
            a, b, c = moments
            omega[2] *= 10.0 ** rng.uniform(-3.0, 0.0)
            apart = 10.0 ** rng.uniform(-6.0, -2.0) * rng.choice([-1.0, 1.0])
            rest = (b * omega[1]) ** 2 + (c * omega[2]) ** 2
            square = (c * (c - b) * omega[2] ** 2 - apart * rest) / (a * (b - a) + apart * a * a)
            if square < 0.0:
                continue
            omega[0] = np.sqrt(square) * rng.choice([-1.0, 1.0])
        if abs(separation(moments, omega)) >= 1e-6:
            found.append((moments, omega * 10.0 ** rng.uniform(-2.0, 2.0)))
    return found


def test_random_starts(rng: np.random.Generator, tmp_path: Path) -> None:
    """Within ten periods, to both sides of the start, ω and the attitude to 1e-12."""
    cases: list[Any] = []
    motions: list[FreeMotion] = []
    for moments, omega in starts(rng, STARTS):
        attitude = rng.normal(size=4)
        motion = RigidBody.from_principal(1.0, moments).free_motion(
            omega, attitude / np.linalg.norm(attitude)
        )
        period = float(motion.periods.rotation)
        times = np.concatenate([rng.uniform(-10.0, 10.0, 6), [0.0, 0.25, 0.5, 1.0, 10.0]]) * period
        cases.append([moments.tolist(), omega.tolist(), motion.quaternion.tolist(), times.tolist()])
        motions.append(motion)
    assert min(abs(separation(np.array(m), np.array(w))) for m, w, *_ in cases) < 3e-6
    for (half, rows), motion, (*_, times) in zip(computed(cases, tmp_path), motions, cases, strict=True):
        states, exact = np.array(rows, dtype=float), motion.at(times)
        assert 2.0 * half == pytest.approx(float(motion.periods.rotation), rel=1e-14)
        size = np.linalg.norm(exact.omega, axis=-1).max()
        assert np.abs(states[:, :3] - exact.omega).max() <= 1e-12 * size
        off = np.minimum(
            np.abs(states[:, 3:7] - exact.quaternion).max(-1),
            np.abs(states[:, 3:7] + exact.quaternion).max(-1),
        )
        assert off.max() <= 1e-12
        # At the next flip the spin about the intermediate axis is zero.
        there = motion.at(np.array(times) + states[:, 7])
        assert (states[:, 7] >= 0.0).all()
        assert np.abs(there.omega[:, 1]).max() <= 1e-8 * size


@pytest.mark.parametrize(
    ("moments", "omega"),
    [
        ((1.0, 1.0, 1.0), (0.3, -0.2, 0.9)),
        ((1.0, 2.0, 2.5), (0.0, 0.0, -2.0)),
        ((1.0, 2.0, 2.5), (0.0, 2.0, 0.0)),
        ((1.0, 2.0, 2.5), (0.0, 0.0, 0.0)),
        ((1.0, 1.0, 1.7), (0.3, -0.2, 0.9)),
        ((1.0, 1.7, 1.7), (-0.3, 0.2, 0.9)),
        ((1.0, 1.7, 1.7), (0.0, 0.2, 0.9)),
        ((1.0, 1.0, 2.0), (0.3, -0.2, -0.9)),
        ((1.0, 3.0, 3.2), (1e-9, 6.0, 0.0)),
        ((1.0, 3.0, 3.2), (0.0, 6.0, 1e-9)),
    ],
)
def test_special_starts(moments: tuple[float, ...], omega: tuple[float, ...], tmp_path: Path) -> None:
    """Symmetric bodies, steady spins, and starts that the separatrix is nearest to."""
    motion = RigidBody.from_principal(1.0, moments).free_motion(omega)
    times = np.linspace(-8.0, 8.0, 33)
    ((_, rows),) = computed([[moments, omega, motion.quaternion.tolist(), times.tolist()]], tmp_path)
    states, exact = np.array(rows, dtype=float), motion.at(times)
    np.testing.assert_allclose(states[:, :3], exact.omega, atol=2e-8 * (1.0 + np.abs(omega).max()), rtol=0.0)
    sign = np.sign((states[:, 3:7] * exact.quaternion).sum(-1, keepdims=True))
    np.testing.assert_allclose(states[:, 3:7] * sign, exact.quaternion, atol=2e-8)


def test_on_the_separatrix_it_goes_to_the_intermediate_axis(tmp_path: Path) -> None:
    """ω₂ → ω tanh, from Euler's equations; moments whose separatrix floats lie on exactly."""
    moments, omega = (
        (1.0, 2.0, 3.0),
        (np.sqrt(3.0), 0.5, 1.0),
    )  # 3 (3 - 2) 1² = 1 (2 - 1) √3², but for a rounding
    ((_, rows),) = computed([[moments, omega, (0, 0, 0, 1), [0.0, 5.0, 9.0]]], tmp_path)
    states = np.array(rows, dtype=float)
    size = np.sqrt(np.dot(moments, np.square(omega)) / 2.0)  # 2T = I₂ ω²
    rate = np.sqrt((2.0 - 1.0) * (3.0 - 2.0) / (1.0 * 3.0)) * size
    begun = np.arctanh(0.5 / size)
    np.testing.assert_allclose(
        states[:, 1], size * np.tanh(begun + rate * np.array([0.0, 5.0, 9.0])), rtol=1e-6
    )
