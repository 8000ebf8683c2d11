"""Numbers with a sigma on the command line: every way to write one, and what reports make of them."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run, write_obj
from oracles.meshes import box
from polhode import Uncertain
from polhode.errors import PolhodeError
from polhode.units import amount, has_unit, quantity

if TYPE_CHECKING:
    from pathlib import Path

LB = Fraction("0.45359237")
WAYS: dict[str, tuple[Fraction | int, Fraction | int]] = {
    "5.0 ± 0.1 kg": (5, Fraction(1, 10)),
    "5.0±0.1kg": (5, Fraction(1, 10)),
    "5.0 +- 0.1 kg": (5, Fraction(1, 10)),
    "5.0 +/- 0.1 kg": (5, Fraction(1, 10)),
    "(5.0 ± 0.1) kg": (5, Fraction(1, 10)),
    "5.0(1) kg": (5, Fraction(1, 10)),
    "5.0 kg ± 2 %": (5, Fraction(1, 10)),
    "5.0 ± 2% kg": (5, Fraction(1, 10)),
    "5.0 ± 2 %": (5, Fraction(1, 10)),
    "5.0 ± 0.1": (5, Fraction(1, 10)),
    "5(1)": (5, 1),
    "5.00(12) kg": (5, Fraction(12, 100)),
    "1.250(3)e2 g": (Fraction(1, 8), Fraction(3, 10_000)),
    "5e-3 ± 1E-4 kg": (Fraction(5, 1000), Fraction(1, 10_000)),
    "5 kg ± 100 g": (5, Fraction(1, 10)),
    "5 ± .5 lb": (5 * LB, LB / 2),
    "(5.0 ± 2 %) lb": (5 * LB, LB / 10),
    "-5 lb ± 10 %": (-5 * LB, LB / 2),
    "5 ± 0 kg": (5, 0),
}


@pytest.mark.parametrize("text", WAYS)
def test_ways_to_write_one(text: str) -> None:
    value, sigma = WAYS[text]
    found = amount(text, "kg", "--mass")
    assert isinstance(found, Uncertain)
    assert float(found.value) == float(value)
    assert found.sigma == pytest.approx(float(sigma), rel=1e-15)
    assert has_unit(text) == any(letter.isalpha() and letter not in "eE" for letter in text)


@pytest.mark.parametrize("text", ["5", " 5 ", "2.7 g", "-.5e-3", "1e22", "0.1 lb", "3 oz"])
def test_plain_numbers_stay_plain(text: str) -> None:
    found = amount(text, "kg", "--mass")
    assert isinstance(found, float)
    assert found == quantity(text, "kg", "--mass")


def test_last_places_are_digits(rng: np.random.Generator) -> None:
    """Random numbers of any number of decimals, against exact fractions."""
    for _ in range(300):
        whole, places, last = int(rng.integers(10**6)), int(rng.integers(8)), int(rng.integers(1, 999))
        digits = f"{whole:09d}"
        number = digits if places == 0 else f"{digits[:-places]}.{digits[-places:]}"
        power = int(rng.integers(-20, 20))
        found: Any = amount(f"{number}({last})e{power:+d}", "kg", "--mass")
        scale = Fraction(10) ** (power - places)
        assert float(found.value) == float(whole * scale)
        assert found.sigma == float(last * scale)


# Reports --------------------------------------------------------------------------------------------------


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    """A 1 x 2 x 3 box that stands with one corner at the origin."""
    vertices, faces = box((1.0, 2.0, 3.0))
    return write_obj(tmp_path / "slab.obj", vertices + np.array([0.5, 1.0, 1.5]), faces)


def read(*arguments: object) -> dict[str, Any]:
    code, out, err = run(*arguments, "--format", "json")
    assert (code, err) == (0, "")
    report: dict[str, Any] = json.loads(out)
    return report


@pytest.mark.parametrize("given", [("--density", "2.0 ± 0.1"), ("--mass", "12.0(6)"), ("--mass", "12 ± 5 %")])
def test_all_moments_are_as_uncertain_as_the_mass(slab: Path, given: tuple[str, str]) -> None:
    report = read("report", slab, *given, "--about", "0", "0", "10")
    sigma, linear = report["sigma"], report["linear"]
    for key in ("density", "mass", "inertia_about_center_of_mass", "inertia_about_origin"):
        np.testing.assert_allclose(sigma[key], 0.05 * np.abs(report[key]), rtol=1e-12, atol=1e-12)
    for key in ("principal_moments", "inertia_about_point"):
        np.testing.assert_allclose(sigma[key], 0.05 * np.abs(report[key]), rtol=1e-12, atol=1e-12)
    for key in ("center_of_mass", "axes", "moments_per_mass", "radii_of_gyration"):
        np.testing.assert_allclose(sigma[key], np.zeros(3), atol=1e-14)
    assert report["units"]["sigma"]["axes"] == "deg"
    assert set(linear) == set(sigma)
    assert all(np.all(flag) for flag in linear.values())


def test_units_of_the_file_and_of_the_option(slab: Path) -> None:
    words = ("--length-unit", "mm", "--density", "2.0 ± 0.1 g/cm^3", "--mass-unit", "lb")
    report = read("report", slab, *words)
    assert report["sigma"]["density"] == pytest.approx(100.0)
    assert report["sigma"]["mass"] == pytest.approx(6e-9 * 100.0)
    assert report["sigma"]["in_file_unit"]["mass"] == pytest.approx(6e-9 * 100.0 / float(LB))
    assert report["sigma"]["in_file_unit"]["principal_moments"][0] == pytest.approx(
        0.05 * report["in_file_unit"]["principal_moments"][0]
    )


def test_the_table_rounds_to_two_digits_of_sigma(slab: Path) -> None:
    code, out, err = run("report", slab, "--mass", "12.0(6)")
    assert (code, err) == (0, "")
    assert "12.00 ± 0.60" in out
    assert "13.00 ± 0.65" in out  # 12 (2² + 3²)/12
    assert "turned by" in out
    assert "± is one standard deviation, to first order" in out
    assert "*" not in out


def test_without_a_sigma_nothing_is_said_of_it(slab: Path) -> None:
    report = read("report", slab, "--mass", "12")
    assert not {"sigma", "linear"} & set(report)
    assert "sigma" not in report["units"]
    for given in (("report", slab, "--mass", "12"), ("spin", slab, "--mass", "12", "--omega", "0 0 1")):
        assert not any(word in run(*given)[1] for word in ("±", "turned by"))


def test_a_spin_tells_of_mass_and_moments(slab: Path) -> None:
    report = read("spin", slab, "--mass", "12.0(6)", "--omega", "0 0 1")
    np.testing.assert_allclose(report["sigma"]["principal_moments"], 0.05 * np.array([5.0, 10.0, 13.0]))
    alone = read("spin", "--moments", "1 2 2.5", "--mass", "5 ± 0.1 kg", "--omega", "0 0 1")
    assert alone["sigma"]["mass"] == 0.1
    assert alone["sigma"]["principal_moments"] == [0.0, 0.0, 0.0]


def test_what_is_expected_may_have_a_sigma_too(slab: Path, tmp_path: Path) -> None:
    saved = tmp_path / "saved.json"
    for before, after, joint in (
        ("12 ± 0.3", "12.5 ± 0.4", 0.5),
        ("12", "12.5 ± 0.4", 0.4),
        ("12 ± 0.3", "12.5", 0.3),
    ):
        assert run("report", slab, "--mass", before, "--output", saved)[0] == 0
        code, out, _ = run("report", slab, "--mass", after, "--expect", saved, "--format", "json")
        assert code == 1
        rows = {row["field"]: row for row in json.loads(out)["differences"]}
        assert rows["mass"]["in_sigmas"] == {"difference": 0.5, "sigma": pytest.approx(joint)}
        # 12 and 12.5 times (2² + 3²)/12, the largest moment; all have the same number of sigmas.
        found = rows["principal_moments"]["in_sigmas"]
        assert found["difference"] / found["sigma"] == pytest.approx(0.5 / joint)
    table = run("report", slab, "--mass", "12.5 ± 0.4", "--expect", saved)[1]
    assert "0.50 ± 0.50" in table
    assert "as independent" in table
    assert run("report", slab, "--mass", "12 ± 0.1", "--expect", saved)[0] == 0  # sigmas are not compared


# Exact by definition: pound 0.45359237 kg, inch 0.0254 m, g 9.80665 m/s^2; slug = lbf s^2/ft.
POUND, INCH, G = LB, Fraction("0.0254"), Fraction("9.80665")


@pytest.mark.parametrize(
    ("text", "unit", "exact"),
    [
        ("1 lbm", "kg", POUND),
        ("1 lb", "kg", POUND),
        ("1 oz", "kg", POUND / 16),
        ("1 ozm", "kg", POUND / 16),
        ("1 slug", "kg", POUND * G / (12 * INCH)),
        ("1 slinch", "kg", POUND * G / INCH),
        ("1 lbf", "N", POUND * G),
        ("1 lbm in^2", "kg m^2", POUND * INCH**2),
        ("1 lbm-in^2", "kg m^2", POUND * INCH**2),
        ("1 lbm·ft²", "kg m^2", POUND * (12 * INCH) ** 2),
        ("1 slug ft^2", "kg m^2", POUND * G * 12 * INCH),
        ("1 lbf in s^2", "kg m^2", POUND * G * INCH),
        ("1 lbf-in-s^2", "kg m^2", POUND * G * INCH),
        ("1 lbf ft s^2", "kg m^2", POUND * G * 12 * INCH),
        ("1 ozf in s^2", "kg m^2", POUND * G * INCH / 16),
        ("1 lbm/in^3", "kg/m^3", POUND / INCH**3),
        ("1 pcf", "kg/m^3", POUND / (12 * INCH) ** 3),
        ("1 ft", "m", 12 * INCH),
        ("1 in", "m", INCH),
        ("1 t mm^2", "kg m^2", Fraction(1, 1000)),
    ],
)
def test_units_of_the_desk(text: str, unit: str, exact: Fraction) -> None:
    assert quantity(text, unit, "x") == pytest.approx(float(exact), rel=4e-16)


@pytest.mark.parametrize("text", ["1 lb in s^2", "1 oz in s^2"])
def test_a_pound_is_a_mass(text: str) -> None:
    with pytest.raises(PolhodeError, match="lb and oz are masses here; write lbf or ozf"):
        quantity(text, "kg m^2", "x")


# Whatever has the dimension of a rate or an angle without counting an angle.
NO_ANGLE = (
    "Hz",
    "mHz",
    "cps",
    "Bq",
    "1/min",
    "min^-1",
    "d-1",
    "s**-1",
    "counts/s",
    "percent/s",
    "sr/s",
    "deg^-1/s",
    "m/m/s",
)


@pytest.mark.parametrize("unit", NO_ANGLE)
def test_a_rate_counts_an_angle(unit: str) -> None:
    """Turns a minute are written min^-1 as well; read as radians they would be wrong by 2π."""
    with pytest.raises(PolhodeError, match="does not say what is counted; write turn/s, rad/s, deg/s or rpm"):
        quantity(f"1 {unit}", "rad/s", "--omega")


@pytest.mark.parametrize("unit", ["sr", "counts", "percent", "m/m"])
def test_an_angle_is_one(unit: str) -> None:
    with pytest.raises(PolhodeError, match="does not say what is counted; write turn, rad or deg"):
        quantity(f"1 {unit}", "rad", "--node")


@pytest.mark.parametrize(
    ("unit", "per_radian"),
    {
        "rpm": np.pi / 30,
        "turn min^-1": np.pi / 30,
        "rev/d": np.pi / 43200,
        "cycle/s": 2 * np.pi,
        "deg h-1": np.pi / 648000,
        "arcsec/s": np.pi / 648000,
        "grad/s": np.pi / 200,
        "mrad/s": 1e-3,
    }.items(),
)
def test_rates(unit: str, per_radian: float) -> None:
    assert quantity(f"1 {unit}", "rad/s", "--omega") == pytest.approx(per_radian, rel=4e-16)


@pytest.mark.parametrize(
    "text", ["1e-400", "1e400", "1e-322 g", "1e-400 ± 1", "1 ± 1e-400", "1(5)e-400", "-1e-400"]
)
def test_beyond_the_range_at_both_ends(text: str) -> None:
    """A number that would become zero is told as one that would become infinite is."""
    zero: Any = amount("0e-400 ± 0.0e-400 g", "kg", "x")
    assert (zero.value, zero.sigma) == (0.0, 0.0)
    assert quantity("5e-324", "kg", "x") == 5e-324
    with pytest.raises(PolhodeError, match=r"is beyond the range of numbers; check the exponent"):
        amount(text, "kg", "x")


@pytest.mark.parametrize("unit", ["kg^0", "kg0", "a0", "kg m0"])
def test_a_unit_has_a_power(unit: str) -> None:
    with pytest.raises(PolhodeError, match="is not a unit"):
        quantity(f"1 {unit}", "kg", "x")
