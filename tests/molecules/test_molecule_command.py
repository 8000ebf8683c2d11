"""``polhode molecule``: constants, class, kappa, inertial defect, planar moments, isotopologues."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import run
from polhode.molecules import inertial_defect, planar_moments
from test_molecules import CONSTANTS

if TYPE_CHECKING:
    from pathlib import Path

# CODATA 2022 and Atomic Mass Evaluation 2020.
FACTOR = 6.62607015e-34 / (8 * np.pi**2 * 1.66053906892e-27 * 1e-20) / 1e6
LIGHT = 29979.2458
MASSES = {"1H": 1.007825031898, "2H": 2.014101777844, "16O": 15.99491461926, "18O": 17.99915961214}


@pytest.mark.parametrize("name", CONSTANTS)
def test_eight_molecules(name: str, eight_molecules: Path) -> None:
    constants, top, kappa = CONSTANTS[name]
    code, out, err = run("molecule", eight_molecules / f"{name}.xyz", "--format", "json")
    assert (code, err) == (0, "")
    report = json.loads(out)
    assert report["top"] == top
    for found, megahertz, known in zip(
        report["rotational_constants_cm^-1"], report["rotational_constants_MHz"], constants, strict=True
    ):
        if np.isinf(known):
            assert found == megahertz == "Infinity"
        else:
            assert abs(Fraction(round(found, 6)).limit_denominator(10**6) - Fraction(str(known))) <= Fraction(
                1, 10**6
            )
            assert megahertz == pytest.approx(found * LIGHT, rel=1e-12)
    assert report.get("ray_kappa") == (None if kappa is None else pytest.approx(kappa, abs=6e-6))
    a, b, c = report["principal_moments"]
    assert report["inertial_defect"] == pytest.approx(c - a - b, abs=1e-12 * c)
    np.testing.assert_allclose(
        report["planar_moments"], [(b + c - a) / 2, (a + c - b) / 2, (a + b - c) / 2], atol=1e-12 * c
    )
    if name in {"h2o", "h2co", "c6h6_re", "c6h6_r0", "co2"}:  # matter in a plane
        assert abs(report["inertial_defect"]) < 1e-8 * c


def test_isotopologues_of_water(eight_molecules: Path) -> None:
    path = eight_molecules / "h2o.xyz"
    words = ("--isotopes", "D", "--isotopes", "18O", "--isotopes", "2=D", "--isotopes", "18O,3=D")
    report = json.loads(run("molecule", path, *words, "--format", "json")[1])
    names = [row["isotopes"] for row in report["isotopologues"]]
    assert names == ["as above", "1 16O, 2 2H", "1 18O, 2 1H", "1 16O, 1 2H, 1 1H", "1 18O, 1 1H, 1 2H"]
    x, z = 0.757207835, 0.586529739  # a symmetric bent molecule, by hand
    for row, hydrogen, oxygen in (
        (report["isotopologues"][0], "1H", "16O"),
        (report["isotopologues"][1], "2H", "16O"),
        (report["isotopologues"][2], "1H", "18O"),
    ):
        m, M = MASSES[hydrogen], MASSES[oxygen]
        across, along = 2 * m * x**2, 2 * m * M / (2 * m + M) * z**2
        moments = np.sort([across, along, across + along])
        np.testing.assert_allclose(row["principal_moments"], moments, rtol=1e-8)
        np.testing.assert_allclose(row["rotational_constants_MHz"], FACTOR / moments, rtol=2e-8)
        assert row["mass"] == pytest.approx(2 * m + M, rel=1e-8)
        assert row["top"] == "asymmetric"


def test_defect_and_planar_moments_of_particles(rng: np.random.Generator) -> None:
    """Their definitions as sums over particles on the principal axes."""
    masses, points = rng.uniform(1, 2, 8), rng.normal(size=(8, 3)) * [3, 2, 1]
    points = np.concatenate([points, points * [-1, 1, 1]])
    points = np.concatenate([points, points * [1, -1, 1]])
    points = np.concatenate([points, points * [1, 1, -1]])
    spread = np.tile(masses, 8) @ points**2
    order = np.argsort(-spread)
    moments = (spread.sum() - spread)[order]
    np.testing.assert_allclose(planar_moments(moments), spread[order], rtol=1e-12)
    assert inertial_defect(moments) == pytest.approx(-2 * spread.min(), rel=1e-12)
    with pytest.raises(ValueError, match=r"expected shape \(\.\.\., 3\)"):
        planar_moments([1.0, 2.0])
