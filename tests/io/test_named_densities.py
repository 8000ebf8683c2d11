"""Components with densities of their own, each with its sigma, against closed forms and draws."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boxes import at, written
from command_line import run
from polhode import RigidBody, Uncertain, solids
from polhode.errors import PolhodeError

SIDES = {"body": np.array([1.0, 1.0, 1.0]), "insert": np.array([1.0, 0.5, 0.7])}
PLACES = {"body": np.zeros(3), "insert": np.array([2.0, 0.1, 0.05])}
VALUES, SIGMAS = {"body": 2700.0, "insert": 7800.0}, {"body": 27.0, "insert": 50.0}
TYPED = "body=2700 ± 27 kg/m^3, insert=7.80(5) g/cm^3"
INDICES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return written(tmp_path / "two.obj", *(at(SIDES[name], PLACES[name]) for name in SIDES))


def ten(densities: dict[str, Any]) -> Any:
    """Mass, centre and tensor about it of two boxes; densities are numbers or arrays of them."""
    masses = {name: np.asarray(rho) * SIDES[name].prod() for name, rho in densities.items()}
    mass = sum(masses.values())
    center = sum(m[..., None] * PLACES[name] for name, m in masses.items()) / mass[..., None]
    tensor = np.zeros((*np.shape(mass), 3, 3))
    for name, m in masses.items():
        squares, d = SIDES[name] ** 2, PLACES[name] - center
        own = np.diag(squares.sum() - squares) / 12.0
        far = (d**2).sum(axis=-1)[..., None, None] * np.eye(3) - d[..., :, None] * d[..., None, :]
        tensor += m[..., None, None] * (own + far)
    elements = np.stack([tensor[..., i, j] for i, j in INDICES], axis=-1)
    return np.concatenate([mass[..., None], center, elements], axis=-1)


def uncertain() -> dict[str, Any]:
    return {name: Uncertain(VALUES[name], SIGMAS[name]) for name in VALUES}


def test_the_covariance_is_that_of_independent_densities(path: Path) -> None:
    """By central differences of the closed forms."""
    body: Any = RigidBody.from_file(path, density=uncertain(), length_unit="m")
    slopes = []
    for name, sigma in SIGMAS.items():
        h = 1e-3 * VALUES[name]
        ends = [ten({k: v + s * h * (k == name) for k, v in VALUES.items()}) for s in (1.0, -1.0)]
        slopes.append((ends[0] - ends[1]) / (2.0 * h) * sigma)
    expected = np.transpose(slopes) @ slopes
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert (np.abs(body.covariance - expected) / scale).max() < 1e-5
    np.testing.assert_allclose(ten(VALUES)[0], body.mass, rtol=1e-14)
    assert body.sigma.mass == pytest.approx(np.hypot(27.0, 0.35 * 50.0), rel=1e-12)


def test_draws_of_the_densities_spread_as_much(path: Path, rng: np.random.Generator) -> None:
    count = 100_000
    draws = ten({name: rng.normal(VALUES[name], SIGMAS[name], count) for name in VALUES})
    body: Any = RigidBody.from_file(path, density=uncertain(), length_unit="m")
    np.testing.assert_allclose(np.sqrt(np.diag(body.covariance)), draws.std(axis=0), rtol=0.015)


def test_the_report_and_a_motion_tell_it(path: Path) -> None:
    options = ("--length-unit", "m", "--density", TYPED, "--format", "json")
    code, out, err = run("report", path, *options)
    assert (code, err) == (0, "")
    found = json.loads(out)
    body: Any = RigidBody.from_file(path, density=uncertain(), length_unit="m")
    assert found["sigma"]["mass"] == pytest.approx(float(body.sigma.mass), rel=1e-12)
    np.testing.assert_allclose(found["sigma"]["principal_moments"], body.sigma.principal_moments, rtol=1e-9)
    assert found["sigma"]["density"] == pytest.approx(float(body.sigma.mass) / 1.35, rel=1e-12)
    assert [part["density"] for part in found["components"]] == [2700.0, 7800.0]
    assert [part["density_sigma"] for part in found["components"]] == pytest.approx([27.0, 50.0])
    code, out, _ = run("report", path, "--length-unit", "m", "--density", TYPED)
    assert code == 0
    assert "2700 ± 27" in out
    assert "7800 ± 50" in out
    code, out, _ = run("spin", path, *options, "--omega", "1 2 3")
    assert code == 0
    np.testing.assert_allclose(
        json.loads(out)["sigma"]["principal_moments"], body.sigma.principal_moments, rtol=1e-9
    )


def test_one_may_be_exact(path: Path) -> None:
    named: dict[str, Any] = {"body": 2700.0, "insert": Uncertain(7800.0, 50.0)}
    body: Any = RigidBody.from_file(path, density=named, length_unit="m")
    assert body.sigma.mass == pytest.approx(0.35 * 50.0, rel=1e-12)
    code, out, _ = run("report", path, "--density", "body=2700, insert=7800 ± 50", "--format", "json")
    assert code == 0
    assert [part["density_sigma"] for part in json.loads(out)["components"]] == pytest.approx([0.0, 50.0])


def test_numbers_of_uncertainties_and_plain_ones(path: Path) -> None:
    exact = RigidBody.from_file(path, density=VALUES, length_unit="m")
    insert = solids.box(SIDES["insert"], density=7800.0).translated(PLACES["insert"])
    want = solids.box(SIDES["body"], density=2700.0) + insert
    assert exact.covariance is None
    np.testing.assert_allclose(exact.inertia, want.inertia, rtol=1e-13, atol=1e-10)
    uncertainties = pytest.importorskip("uncertainties")
    named = {name: uncertainties.ufloat(VALUES[name], SIGMAS[name]) for name in VALUES}
    both: list[Any] = [
        RigidBody.from_file(path, density=density, length_unit="m").covariance
        for density in (named, uncertain())
    ]
    np.testing.assert_allclose(both[0], both[1], rtol=1e-12)


@pytest.mark.parametrize(
    ("density", "options", "says"),
    [
        ({"body": 1.0}, {}, "nothing is said of component 'insert'"),
        ({**VALUES, "lid": 1.0}, {}, "no component 'lid'; give one density for each of body, insert"),
        (VALUES, {"mass": 2.0}, "mass: components have densities of their own"),
        (VALUES, {"repair": True}, "repair: components have densities of their own"),
        (VALUES, {"union": True}, "union: components have densities of their own"),
        (VALUES, {"closure": "hull"}, "closure: components have densities of their own"),
        ({**VALUES, "body": -1.0}, {}, "density must be"),
    ],
)
def test_what_does_not_fit_is_refused(density: Any, options: Any, says: str, path: Path) -> None:
    with pytest.raises(PolhodeError, match=re.escape(says)):
        RigidBody.from_file(path, density=density, **options)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("body=2700 ± 27,insert=7.8 g/cm^3 ± 0.1", "the sigma has no unit, but its number has one"),
        ("body=0 ± 27,insert=1", "body=0 ± 27 is not above 0"),
        ("body=2700 ± x,insert=1", "is not a number with a sigma"),
    ],
)
def test_sigmas_that_are_typed_wrong(text: str, says: str, path: Path) -> None:
    code, _, err = run("report", path, "--length-unit", "m", "--density", text)
    assert code == 2
    assert says in err


def test_overlaps_are_warned_of(tmp_path: Path) -> None:
    path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
    with pytest.warns(UserWarning, match="overlap") as told:
        RigidBody.from_file(path, density=VALUES)
    assert "components body and insert overlap" in str(told[0].message)
    assert "components of several densities overlap" in str(told[1].message)
    assert {Path(each.filename) for each in told} == {Path(__file__)}
