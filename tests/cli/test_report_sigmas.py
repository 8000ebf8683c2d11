"""What reports compute of uncertain bodies, against NumPy: tensors about points, moments, flags."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
from polhode import Uncertain
from polhode.cli.layout import Field, Report
from polhode.cli.tables import about_point, angle_field, moments_slopes, note_linear, sigmas_of_square
from polhode.draw.html import body_html

if TYPE_CHECKING:
    import pytest

RigidBody: Any = polhode.RigidBody
PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
DRAWS = 40_000


def body_of(rng: np.random.Generator, size: float) -> Any:
    """A random body, uncertain by `size` of what it has, all ten numbers correlated."""
    moments = np.array([0.6, 0.8, 1.0]) + rng.uniform(-0.05, 0.05, 3)  # apart by 0.1 at least
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    tensor = turn * moments @ turn.T
    mixing = rng.normal(size=(10, 10)) / np.sqrt(10)
    covariance = size**2 * mixing @ mixing.T
    return RigidBody(rng.uniform(0.5, 2.0), (tensor + tensor.T) / 2, rng.normal(size=3)).with_covariance(
        covariance
    )


def ten(body: Any) -> Any:
    return np.concatenate([[body.mass], body.center_of_mass, [body.inertia[place] for place in PLACES]])


def about(numbers: Any, point: Any) -> Any:
    """Tensors about a point, shape (n, 3, 3), of ten numbers each."""
    tensors = np.empty((len(numbers), 3, 3))
    for k, (i, j) in enumerate(PLACES):
        tensors[:, i, j] = tensors[:, j, i] = numbers[:, 4 + k]
    d = numbers[:, 1:4] - point
    spread = (d**2).sum(axis=1)[:, None, None] * np.eye(3) - d[:, :, None] * d[:, None, :]
    return tensors + numbers[:, 0, None, None] * spread


def test_tensors_about_points_against_draws() -> None:
    """Within 1.5 %, three times what so many draws leave open, or flagged; flags are right by the draws."""
    rng = np.random.default_rng(7)
    flagged = off = total = 0
    for size in (0.003, 0.01, 0.3):
        for _ in range(10):
            body = body_of(rng, size)
            point = rng.choice([0.0, 1.0]) * rng.normal(size=3)
            told: Any = about_point(body, point)
            draws = about(rng.multivariate_normal(ten(body), body.covariance, DRAWS), point)
            ratio = told["sigma"] / draws.std(axis=0)
            assert np.abs(ratio[told["linear"]] - 1.0).max(initial=0.0) < 0.015
            if size < 0.1:
                assert told["linear"].all()
            flagged += int((~told["linear"]).sum())
            off += int((np.abs(ratio[~told["linear"]] - 1.0) > 0.0075).sum())
            total += 9
    assert 0 < flagged < 0.5 * total
    assert off > 0.8 * flagged


def test_tensors_about_points_against_differences(rng: np.random.Generator) -> None:
    for _ in range(30):
        body, point = body_of(rng, 0.01), rng.normal(size=3)
        at, h = ten(body), 1e-4
        steps = h * np.eye(10)
        slopes = (about(at + steps, point) - about(at - steps, point)).reshape(10, 9) / (2 * h)
        expected = np.sqrt(np.einsum("ia,ij,ja->a", slopes, body.covariance, slopes)).reshape(3, 3)
        told: Any = about_point(body, point)
        np.testing.assert_allclose(told["sigma"], expected, rtol=1e-7)


def test_a_first_order_that_vanishes_is_flagged() -> None:
    """About C itself d is 0: the sigma of C moves the tensor to second order alone."""
    body = RigidBody(2.0, np.diag([1.0, 1.1, 1.2])).with_sigma(center_of_mass=(0.1, 0.1, 0.1))
    told: Any = about_point(body, np.zeros(3))
    assert not told["sigma"].any()
    assert not told["linear"].any()
    away: Any = about_point(body, np.array([3.0, 2.0, 1.0]))
    assert away["linear"].all()


def test_slopes_of_moments_against_differences(rng: np.random.Generator) -> None:
    for _ in range(30):
        body = body_of(rng, 0.001)
        slopes: Any = moments_slopes(body)
        at, h = ten(body), 1e-5
        steps = h * np.eye(10)
        values = [np.linalg.eigvalsh(about(at + s * steps, at[1:4])) for s in (1, -1)]
        for k in (0, 1, 2, 3):  # mass and centre do not move the tensor about C
            values[0][k] = values[1][k] = 0.0
        by_numbers = (values[0] - values[1]) / (2 * h)
        expected = by_numbers.T @ body.covariance @ by_numbers
        np.testing.assert_allclose(slopes.T @ slopes, expected, rtol=1e-7, atol=1e-7 * expected.max())
        np.testing.assert_allclose(np.sqrt((slopes**2).sum(axis=0)), body.sigma.principal_moments, rtol=1e-10)


def test_squares() -> None:
    told: Any = sigmas_of_square(
        np.array([2.0, 1.0]), {"sigma": np.array([0.1, 0.3]), "linear": np.array([True, True])}
    )
    assert told["sigma"].tolist() == [0.4, 0.6]
    assert told["linear"].tolist() == [True, False]
    assert sigmas_of_square(np.ones(3), {}) == {}


def test_axes_that_are_not_determined() -> None:
    ball: Any = polhode.solids.sphere(Uncertain(1.0, 0.01), mass=1.0)
    (field,) = angle_field(ball)
    report = Report()
    report.section("", field)
    assert field.cells == ["not determined"] * 3
    assert report.as_dict()["sigma"]["axes"] == [None] * 3
    assert "axes" not in {key for key in report.as_dict() if key not in ("sigma", "linear", "units")}
    note_linear(report)
    assert not any("*" in note for note in report.notes)  # nothing is marked
    assert angle_field(polhode.solids.sphere(1.0, mass=1.0)) == []


def test_marks_and_widths(capsys: pytest.CaptureFixture[str]) -> None:
    from rich.console import Console

    report = Report()
    sigma, linear = np.array([0.5, 0.0, np.nan]), np.array([False, True, True])
    report.section("", Field("x", "x", np.array([12.0, 3.0, np.inf]), "m", sigma=sigma, linear=linear))
    note_linear(report)
    report.print(Console(highlight=False))
    out = capsys.readouterr().out
    assert "12.00 ± 0.50*" in out
    assert "infinite" in out
    assert 'method="monte-carlo"' in out
    assert report.as_dict()["sigma"]["x"] == [0.5, 0.0, None]
    assert report.as_dict()["linear"]["x"] == [False, True, True]


def test_a_notebook_shows_them() -> None:
    text = body_html(polhode.solids.box((1.0, 2.0, 3.0), mass=Uncertain(12.0, 0.6)))
    assert "12.00 ± 0.60" in text
    assert "13.00 ± 0.65" in text
    assert "±" not in body_html(polhode.solids.box((1.0, 2.0, 3.0), mass=12.0))
