"""Labels of light-curve frequencies: published tumblers, frequencies of simulated light, bodies."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from polhode import RigidBody, _core, identify
from polhode.errors import IdentificationError

Floats = NDArray[np.float64]


def row_of(found: identify.Labellings, labels: list[tuple[int, int]], mode: str) -> int:
    """Return the row with these labels, in the long-axis convention."""
    is_row = (np.stack([found.j, found.m], axis=-1) == labels).all(axis=(1, 2)) & (found.mode == mode)
    assert is_row.sum() == 1
    return int(np.flatnonzero(is_row)[0])


class TestPublished:
    """Periods of the literature, from light curves: each is found again, by its labels."""

    def test_apophis(self) -> None:
        """Pravec et al., Icarus 233 (2014) 48: P_φ = 27.38 ± 0.07 h, P_ψ = 263 ± 6 h, short-axis mode; the
        strongest period 30.56 ± 0.01 h is that of f_φ − f_ψ, and its second harmonic is the largest."""
        frequencies, sigma = np.array([2 / 30.56, 1 / 27.38]), np.array([0.02 / 30.56**2, 0.07 / 27.38**2])
        found = identify.labellings(frequencies, sigma, moments=(0.61, 0.965, 1.0))
        k = row_of(found, [(2, -2), (1, 0)], "short-axis")
        assert found.admissible[k]
        assert 1 / found.f_phi[k] == pytest.approx(27.38)
        assert 1 / found.f_psi[k] == pytest.approx(263.0, abs=6.0)
        low, high = found.ratio_range[k].T
        assert (low <= (0.61, 0.965)).all()
        assert (high >= (0.61, 0.965)).all()

    def test_toutatis(self) -> None:
        """Hudson and Ostro, Science 270 (1995) 84: 5.41 d about the long axis, which precesses in 7.35 d.
        Samarasinha and Mueller (2015): in the short-axis convention the latter is 3.12 d."""
        f_phi, f_psi = 1 / 7.35, 1 / 5.41
        found = identify.labellings((2 * f_phi, f_phi + f_psi, 2 * f_psi), 1e-4, moments=(1.0, 3.09, 3.22))
        k = row_of(found, [(2, 0), (1, 1), (0, 2)], "long-axis")
        assert found.admissible[k]
        assert (found.f_phi[k], found.f_psi[k]) == pytest.approx((f_phi, f_psi))
        assert 1 / found.f_phi_short[k] == pytest.approx(3.12, abs=0.005)
        assert found.m_short[k].tolist() == [-2, 0, 2]
        assert not found.admissible[row_of(found, [(2, 0), (1, 1), (0, 2)], "short-axis")]

    def test_halley(self) -> None:
        """Samarasinha and A'Hearn, Icarus 93 (1991) 194: 3.69 d of the long axis about L, 7.1 d about it, in
        long-axis mode. A ratio of 1.92 is one of short-axis mode as well, for other bodies."""
        frequencies = (1 / 3.69, 1 / 7.1, 1 / 3.69 + 1 / 7.1)
        found = identify.labellings(frequencies, 1e-4)
        for mode in ("long-axis", "short-axis"):
            k = row_of(found, [(1, 0), (0, 1), (1, 1)], mode)
            assert found.admissible[k]
            assert found.chi2[k] == pytest.approx(0.0, abs=1e-12)


def brightness(motion: Any, t: Floats) -> Floats:
    """The light of a lopsided ellipsoid: the area that is seen, and a dark end."""
    seen = _core.rotate(motion.at(t).quaternion, np.array([0.6, 0.0, 0.8]), inverse=True)
    x, y, z = np.asarray(seen).T
    return np.asarray(np.sqrt(x * x / 9 + y * y / 4 + z * z) + 0.1 * x + 0.05 * y * z)


def lines(t: Floats, light: Floats, n: int) -> list[float]:
    """Return the frequencies of the n strongest lines: maxima of the tapered Fourier integral, by SciPy."""
    optimize = pytest.importorskip("scipy.optimize")
    taper = (1.0 - np.cos(2.0 * np.pi * (np.arange(len(t)) + 0.5) / len(t))) ** 2
    left, found = light - light.mean(), []
    step = 0.25 / (t[-1] - t[0])
    grid = step * np.arange(1, 4000)
    for _ in range(n):
        spectrum = np.abs(np.fft.rfft(left * taper, 4 * len(t)))[1:4000]
        start = grid[np.argmax(spectrum)]

        def power(f: float, left: Floats = left) -> float:
            return -float(abs(np.sum(left * taper * np.exp(-2j * np.pi * f * t))))

        best = optimize.minimize_scalar(
            power, bounds=(start - 3 * step, start + 3 * step), method="bounded", options={"xatol": 1e-12}
        ).x
        found.append(float(best))
        waves = np.exp(2j * np.pi * np.outer(t, found))
        terms = np.hstack([np.ones((len(t), 1)), waves.real, waves.imag])
        left = light - terms @ np.linalg.lstsq(terms, light, rcond=None)[0]
    return found


@pytest.mark.parametrize(("mode", "ratio"), [("long-axis", 1.37), ("short-axis", 2.83)])
def test_frequencies_of_light_have_their_labels(mode: Any, ratio: float) -> None:
    body = RigidBody.from_principal(1.0, (1.0, 2.2, 2.6))
    motion = body.free_motion_from_periods(ratio, 1.0, mode=mode)
    t = np.linspace(0.0, 300.0, 20_001)
    measured = np.array(lines(t, brightness(motion, t), 4))
    curve = motion.periods.light_curve(order=4)
    nearest = [int(np.nanargmin(np.abs(curve.frequency - f))) for f in measured]
    assert np.abs(curve.frequency[nearest] - measured).max() < 1e-5
    signs = [1 if curve.j[k] + curve.m[k] / ratio > 0 else -1 for k in nearest]
    labels = [
        (int(sign * curve.j[k]), int(sign * curve.m[k])) for k, sign in zip(nearest, signs, strict=True)
    ]
    found = identify.labellings(measured, 1e-5, order=4, moments=body.principal_moments)
    k = row_of(found, labels, mode)
    assert found.admissible[k]
    assert found.f_phi[k] == pytest.approx(1.0, abs=1e-5)
    assert found.f_psi[k] == pytest.approx(1.0 / ratio, abs=1e-5)


@pytest.mark.parametrize("order", [1, 2])
def test_every_labelling_is_found(order: int) -> None:
    """Against all labels one by one, with a fit of SciPy for each."""
    optimize, stats = pytest.importorskip("scipy.optimize"), pytest.importorskip("scipy.stats")
    measured, sigma = np.array([0.272, 0.321, 0.3697]), np.array([0.002, 0.003, 0.002])
    pairs = [p for p in itertools.product(range(-order, order + 1), repeat=2) if p != (0, 0)]
    want = {}
    for labels in itertools.product(pairs, repeat=3):
        matrix = np.array(labels)
        if np.linalg.matrix_rank(matrix) < 2:
            continue
        rates, norm = optimize.nnls(matrix / sigma[:, None], measured / sigma)
        if (rates > 0.0).all() and stats.chi2.sf(norm**2, 1) >= 1e-3:
            want[labels] = (*rates, norm**2)
    found = identify.labellings(measured, sigma, order=order)
    got: dict[Any, list[Any]] = {}
    for k in range(len(found)):
        labels = tuple(zip(found.j[k].tolist(), found.m[k].tolist(), strict=True))
        got.setdefault(labels, []).append((found.f_phi[k], found.f_psi[k], found.chi2[k]))
    assert set(got) == set(want)
    for labels, rows in got.items():
        assert len(rows) == 2  # one for each mode
        for row in rows:
            assert row == pytest.approx(want[labels], rel=1e-9, abs=1e-9)


class TestBodies:
    """Which bodies have a motion with two periods: `free_motion_from_periods` says, body by body."""

    @staticmethod
    def exists(x: float, y: float, ratio: float, mode: Any) -> bool:
        try:
            RigidBody.from_principal(1.0, (x, y, 1.0)).free_motion_from_periods(ratio, 1.0, mode=mode)
        except ValueError:
            return False
        return True

    @pytest.mark.parametrize("mode", ["long-axis", "short-axis"])
    @pytest.mark.parametrize("ratio", [0.3, 0.97, 1.03, 1.92, 3.1])
    @pytest.mark.parametrize("count", [15, pytest.param(40, marks=pytest.mark.long)])
    def test_of_given_moments(self, mode: str, ratio: float, count: int) -> None:
        rng = np.random.default_rng(5)
        for _ in range(count):
            y = rng.uniform(0.5, 1.0)
            x = rng.uniform(1.0 - y, y)
            found = identify.labellings((ratio, 1.0), 1e-6, moments=(x, y, 1.0))
            k = row_of(found, [(1, 0), (0, 1)], mode)
            assert found.admissible[k] == self.exists(x, y, ratio, mode)

    @pytest.mark.parametrize("mode", ["long-axis", "short-axis"])
    @pytest.mark.parametrize("ratio", [0.3, 0.97, 1.03, 1.92, 3.1])
    def test_the_range_of_ratios(self, mode: str, ratio: float) -> None:
        found = identify.labellings((ratio, 1.0), 1e-6)
        k = row_of(found, [(1, 0), (0, 1)], mode)
        y, share = np.meshgrid(np.linspace(0.501, 0.999, 40), [1e-4, *np.linspace(0.02, 0.98, 40), 0.999])
        x = 1.0 - y + (2.0 * y - 1.0) * share
        able = np.vectorize(self.exists)(x, y, ratio, mode)
        if not able.any():
            assert not found.admissible[k]
            assert np.isnan(found.ratio_range[k]).all()
            return
        seen = np.array([[one[able].min(), one[able].max()] for one in (x, y)])
        assert found.admissible[k]
        assert (seen[:, 0] >= found.ratio_range[k, :, 0]).all()
        assert (seen[:, 1] <= found.ratio_range[k, :, 1]).all()
        assert np.abs(seen - found.ratio_range[k]).max() < 0.03  # of the grid


def test_a_threshold_of_short_axis_mode() -> None:
    for ratio, able in ((1.0 + 1e-6, True), (1.0 - 1e-6, False)):
        found = identify.labellings((ratio, 1.0), 1e-9)
        assert found.admissible[row_of(found, [(1, 0), (0, 1)], "short-axis")] == able


def test_the_likely_ones_first() -> None:
    found = identify.labellings((2 / 7.35, 1 / 7.35 + 1 / 5.41, 2 / 5.41), 1e-4)
    assert (np.diff(found.admissible.astype(int)) <= 0).all()
    sizes = np.abs(np.stack([found.j, found.m])).sum(axis=(0, 2))
    able = found.admissible
    assert (np.diff(sizes[able]) >= 0).all()
    assert repr(found).startswith("Labellings(n=")


def test_noise_decides() -> None:
    """A third frequency 5 sigma away from a multiple is not labelled by it, 2 sigma away it is."""
    for off, explained in ((2.0, True), (5.0, False)):
        found = identify.labellings((1.0, 0.31, 1.31 + off * 1e-4), (1e-6, 1e-6, 1e-4), order=4)
        labels = np.stack([found.j, found.m], axis=-1)
        assert (labels == [(1, 0), (0, 1), (1, 1)]).all(axis=(1, 2)).any() == explained


def test_nothing_fits_and_anything_fits() -> None:
    with pytest.raises(IdentificationError, match="no j f_phi") as caught:
        identify.labellings((1.0, 0.3137, 0.0217, 1.777), 1e-6)
    assert caught.value.kind == "no fit"
    with pytest.raises(IdentificationError, match="so large") as caught:
        identify.labellings(np.linspace(0.1, 0.2, 12), 0.05, order=6)
    assert caught.value.kind == "undetermined"


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"frequencies": (1.0,)}, "frequencies: expected shape"),
        ({"frequencies": (1.0, -2.0)}, "frequencies: expected positive"),
        ({"frequencies": (1.0, np.nan)}, "frequencies: expected positive"),
        ({"sigma": 0.0}, "sigma: expected numbers from 1e-13"),
        ({"sigma": (0.1, 0.1, 0.1)}, "sigma: expected a number or shape"),
        ({"order": 0}, "order: 0 is not a whole number from 1 to 6"),
        ({"order": 7}, "order: 7 is not"),
        ({"order": True}, "order: True is not"),
        ({"moments": (1.0, 1.0)}, "moments: expected three positive numbers"),
        ({"moments": (1.0, 1.0, 2.1)}, "moments: 2.1 exceeds the sum"),
    ],
)
def test_bad_input(changed: dict[str, Any], words: str) -> None:
    given: dict[str, Any] = {"frequencies": (1.0, 0.3), "sigma": 1e-3}
    with pytest.raises(ValueError, match=words):
        identify.labellings(**given | changed)
