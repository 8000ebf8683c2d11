"""What a result of an identification does: its file, and its picture."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, Uncertain, identify
from polhode.errors import FileFormatError
from polhode.identify import Identified

T = np.linspace(0.0, 4.0, 200)


def tumble(seed: int = 1, **given: Any) -> Identified:
    body = RigidBody.from_principal(1.0, (0.2, 0.35, 0.45))
    exact = body.free_motion((1.0, 3.0, 0.5)).at(T).omega
    noisy = exact + np.random.default_rng(seed).normal(0.0, 0.01, (200, 3))
    return identify.from_tumble(T, noisy, **given)


def pendulums() -> Identified:
    body = RigidBody.from_principal(2.0, (0.02, 0.03, 0.04))
    rows = []
    for axis in np.eye(3):
        swing = identify.bifilar(axis, 1.0, 1.0, 0.2)
        period = swing.exact_period(body, gravity=9.81)
        rows.append(identify.bifilar(axis, Uncertain(period, sigma=0.001), 1.0, 0.2))
    for axis in np.array([(1, 1, 0), (1, 0, 1), (0, 1, 1)], dtype=float):
        swing = identify.bifilar(axis, 1.0, 1.0, 0.2)
        period = swing.exact_period(body, gravity=9.81)
        rows.append(identify.bifilar(axis, Uncertain(period, sigma=0.001), 1.0, 0.2))
    return identify.from_pendulum(rows, gravity=9.81, mass=2.0)


def gyrostat() -> Identified:
    found = tumble()
    assert found.start is not None
    plain = RigidBody(mass=1.0, inertia=found.body.inertia)
    return replace(found, motion=plain.gyrostat((0.1, 0.0, 0.2)).free_motion(found.start.omega))


def same(one: Any, other: Any) -> bool:
    """Whether two results have the same bits, but for the sources of bias and noise."""
    for field in fields(Identified):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            alike = np.array_equal(a, b, equal_nan=True)
        elif isinstance(a, Uncertain):
            alike = np.array_equal(a.value, b.value) and np.allclose(a.covariance, b.covariance, rtol=1e-12)
        elif field.name == "observability":
            alike = all(
                x.words == y.words
                and x.remedy == y.remedy
                and np.array_equal([x.sigma, x.relative, *x.parameters], [y.sigma, y.relative, *y.parameters])
                for x, y in zip(a, b, strict=True)
            )
        elif field.name == "alternatives":
            alike = all(same(x, y) for x, y in zip(a, b, strict=True))
        elif field.name == "start":
            alike = a is b is None or all(np.array_equal(x, y) for x, y in zip(a[:2], b[:2], strict=True))
        elif field.name == "motion":
            alike = a is b is None or np.array_equal(a.at(T).omega, b.at(T).omega)
        else:
            alike = a == b or (isinstance(a, float) and np.isnan(a) and np.isnan(b))
        if not alike:
            print(field.name, a, b)
            return False
    return True


@pytest.mark.parametrize(
    "found",
    [tumble(), tumble(sigma=0.01, bias=True), gyrostat(), pendulums()],
    ids=["tumble", "bias", "rotor", "pendulums"],
)
def test_a_file_keeps_every_bit(tmp_path: Path, found: Identified) -> None:
    found.save(tmp_path / "found.json")
    again = Identified.from_file(tmp_path / "found.json")
    assert same(found, again)
    assert again.body.covariance is not None
    assert found.body.covariance is not None
    assert np.array_equal(again.body.covariance, found.body.covariance)


def test_alternatives_go_along(tmp_path: Path) -> None:
    found = replace(tumble(), alternatives=(tumble(seed=2), tumble(seed=3)))
    found.save(tmp_path / "found.json")
    assert same(found, Identified.from_file(tmp_path / "found.json"))


def test_damaged_files(tmp_path: Path) -> None:
    path = tmp_path / "found.json"
    tumble(bias=True).save(path)
    whole = json.loads(path.read_text())
    wrong = [None, "x", [1.0], {"a": 1}, True, -1.5, [[None]]]
    for name in whole:
        for value in (*wrong, ...):
            damaged = {k: v for k, v in whole.items() if k != name}
            if value is not ...:
                damaged[name] = value
            path.write_text(json.dumps(damaged))
            try:
                Identified.from_file(path)
            except FileFormatError as error:
                assert "found.json" in str(error)  # noqa: PT017
    path.write_text(json.dumps(whole | {"new": 1}))
    with pytest.raises(FileFormatError, match="'new' is no field"):
        Identified.from_file(path)
    with pytest.raises(ValueError, match=r"does not end in \.json"):
        Identified.from_file(tmp_path / "found.npz")
    with pytest.raises(ValueError, match=r"does not end in \.json"):
        tumble().save(tmp_path / "found.npz")


def test_a_picture_shows_every_residual() -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    found = tumble()
    figure, ax = pyplot.subplots()
    assert found.plot(ax, t=T) is ax
    lines = [line for line in ax.get_lines() if len(np.asarray(line.get_xdata())) == len(T)]
    assert np.array_equal(np.array([line.get_ydata() for line in lines]).T, found.residuals)
    assert all(np.array_equal(line.get_xdata(), T) for line in lines)
    assert f"/ {found.degrees_of_freedom}" in ax.get_title()
    pyplot.close(figure)
    other = pendulums().plot()
    assert other.get_xlabel() == "row"
    pyplot.close(other.figure)
    with pytest.raises(ValueError, match="t: expected shape"):
        found.plot(t=T[1:])
