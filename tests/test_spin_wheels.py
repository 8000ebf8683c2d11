"""``polhode spin --wheel``: the gyrostat's motion against equations of motion that SciPy integrates."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run, write_obj
from oracles.bodies import matrix
from oracles.gyrostat_equilibria import equilibria
from oracles.meshes import box
from polhode import Trajectory
from scipy.integrate import solve_ivp
from test_animation import data

MOMENTS = np.array([1.0, 2.0, 2.5])
INSIDE = np.array([-0.1, 0.2, 0.4])
OMEGA = np.array([0.3, 0.2, 1.1])
BODY = ("spin", "--moments", "1 2 2.5", "--omega", "0.3 0.2 1.1")
WHEELS = ("--wheel", "y, 0.2 N m s", "--wheel", "-0.6, 0, 0.8, 0.5", "--wheel", "1 0 0, 0.2 kg m^2/s")


def told(*arguments: Any) -> Any:
    code, out, err = run(*arguments, "--format", "json")
    assert (code, err) == (0, "")
    return json.loads(out)


def integrated(inertia: Any, inside: Any, omega: Any, times: Any) -> Any:
    """ω and R after some times, R being the attitude; from R = 1."""

    def rates(_: float, y: Any) -> Any:
        w, r = y[:3], y[3:].reshape(3, 3)
        across = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
        return np.concatenate(
            [np.linalg.solve(inertia, -np.cross(w, inertia @ w + inside)), (r @ across).ravel()]
        )

    start = np.concatenate([omega, np.eye(3).ravel()])
    found = solve_ivp(rates, (0.0, times[-1]), start, "DOP853", times, rtol=1e-13, atol=1e-14)
    return found.y[:3].T, found.y[3:].T.reshape(-1, 3, 3)


def test_the_motion_is_that_of_a_body_with_the_momentum_inside(tmp_path: Path) -> None:
    saved = tmp_path / "motion.npz"
    report = told(*BODY, *WHEELS, "--end", "30", "--times", "7", "--save", saved)
    omega, attitude = integrated(np.diag(MOMENTS), INSIDE, OMEGA, np.linspace(0.0, 30.0, 7))
    motion = Trajectory.from_file(saved)
    np.testing.assert_allclose(motion.omega, omega, atol=1e-10)
    np.testing.assert_allclose([matrix(q) for q in motion.quaternion], attitude, atol=1e-10)
    np.testing.assert_allclose(report["omega_end"], omega[-1], atol=1e-10)
    momentum = MOMENTS * OMEGA + INSIDE
    np.testing.assert_allclose(report["momentum_inside"], INSIDE, atol=1e-16)
    np.testing.assert_allclose(report["angular_momentum_vector"], momentum, rtol=1e-15)
    assert report["angular_momentum"] == pytest.approx(np.linalg.norm(momentum), rel=1e-15)
    assert report["kinetic_energy"] == pytest.approx(0.5 * OMEGA @ (MOMENTS * OMEGA), rel=1e-15)
    np.testing.assert_allclose(motion.angular_momentum().total - momentum, 0.0, atol=1e-14)
    assert report["kinetic_energy_drift"] < 1e-14
    assert report["angular_momentum_drift"] < 1e-14


def test_period_and_mean_precession() -> None:
    report = told(*BODY, *WHEELS)
    period = report["period"]
    omega, (attitude,) = integrated(np.diag(MOMENTS), INSIDE, OMEGA, [period])
    np.testing.assert_allclose(omega[0], OMEGA, atol=1e-10)
    half, _ = integrated(np.diag(MOMENTS), INSIDE, OMEGA, [0.5 * period])
    assert np.linalg.norm(half[0] - OMEGA) > 0.1
    # After a period the body has turned about L alone, by the mean precession but for whole turns.
    unit = np.array(report["angular_momentum_vector"]) / report["angular_momentum"]
    across = np.cross(unit, [1.0, 0.0, 0.0])
    turned = attitude @ across
    angle = np.arctan2(turned @ np.cross(unit, across), turned @ across)
    turns = (report["mean_precession"] * period - angle) / (2.0 * np.pi)
    assert turns == pytest.approx(round(turns), abs=1e-9)


def test_steady_rotations() -> None:
    report = told(*BODY, *WHEELS)
    size = report["angular_momentum"]
    rows = report["equilibria"]
    for row in rows:
        n, omega = np.array(row["direction"]), np.array(row["omega"])
        np.testing.assert_allclose(MOMENTS * omega + INSIDE, size * n, atol=1e-13)
        np.testing.assert_allclose(np.cross(omega, n), 0.0, atol=1e-13)
    known = equilibria(MOMENTS.tolist(), INSIDE.tolist(), size)
    assert sorted(row["squared_rate"] for row in rows) == pytest.approx(
        sorted(float(squared) for *_, squared in known), rel=1e-9
    )
    assert [row["squared_rate"] > 0.0 for row in rows] == [row["kind"] != "saddle" for row in rows]
    assert rows[0]["kind"] == "minimum"
    out = run(*BODY, *WHEELS)[1]
    stable = out.count("stable, of least energy") + out.count("stable, of most energy")
    assert (stable, out.count("  unstable")) == (len(rows) // 2 + 1, len(rows) // 2 - 1)


def test_what_it_prints() -> None:
    out = run("spin", "--moments", "1 2 2.5", "--omega", 0, 1, 0, "--wheel", "y, 0.6", "--end", 10)[1]
    lines = [" ".join(line.split()) for line in out.splitlines()]
    for line in (
        "mode steady L rests in the body",
        "one turn 6.283185 s about an axis at rest in the body",
        "wobble 24.83647 s of small oscillations of omega in the body",
        "mean precession 1 rad/s of the body about L, but for whole turns in a period",
        "kinetic energy 1 kg m^2/s^2 half of omega.I omega: without the wheels' own",
        "|L| 2.6 kg m^2/s with the wheels",
        "L, in space 0 2.6 0 kg m^2/s",
        "h, in the body 0 0.6 0 kg m^2/s of the wheels",
        "L / |L| omega, rad/s steady rotation",
        "0.00000 1.00000 0.00000 0 1 0 stable, of least energy",
        "0.00000 -1.00000 0.00000 0 -1.6 0 unstable",
        "omega, end 0 1 0 rad/s",
    ):
        assert line in lines
    assert sum("stable, of most energy" in line for line in lines) == 2


def test_a_circle_and_no_momentum_at_all() -> None:
    out = run("spin", "--moments", "1 1 2", "--omega", 1, 0, 0, "--wheel", "z, -0.5")[1]
    assert "one of a circle about (0 0 1)" in out
    assert "circular  L goes round" in out
    still = run("spin", "--moments", "1 1 2", "--omega", 0, 0, 0.25, "--wheel", "z, -0.5", "--end", 5)[1]
    assert "none with an axis of its own: L is zero" in still


def test_axes_and_units(tmp_path: Path) -> None:
    """A part whose principal axes are not the file's: names mean the axes that are said."""
    path = write_obj(tmp_path / "box.obj", *box((3.0, 1.0, 2.0)))
    asked = ("--length-unit", "m", "--mass", "12", "--wheel")
    by_file = told("spin", path, *asked, "x, 7", "--omega", 1, 2, 3)
    np.testing.assert_allclose(by_file["momentum_inside"], [7.0, 0.0, 0.0], atol=1e-14)
    principal = ("--axes", "principal")
    by_name = told("spin", path, *asked, "x, 7", "--omega", 1, 2, 3, *principal)
    np.testing.assert_allclose(by_name["momentum_inside"], [7.0, 0.0, 0.0], atol=1e-14)
    for number, third in (("e1", 0), ("e2", 1), ("e3", 2)):
        found = told("spin", path, *asked, f"{number}, 7", "--omega", 1, 2, 3, *principal)
        np.testing.assert_allclose(found["momentum_inside"], 7.0 * np.eye(3)[third], atol=1e-14)
    by_degrees = told("spin", path, *asked, "x, 7", "--omega", 1, 2, 3, "--degrees")
    np.testing.assert_allclose(
        by_degrees["equilibria"][0]["omega"],
        np.degrees(np.linalg.solve(np.diag([5.0, 13.0, 10.0]), _off(by_degrees, [7.0, 0.0, 0.0]))),
        atol=1e-11,
    )
    in_own_unit = told("spin", path, "--mass", "12", "--wheel", "x, 7", "--omega", 1, 2, 3)
    assert in_own_unit["units"]["momentum_inside"] == "mass unit^2/s"
    np.testing.assert_allclose(in_own_unit["momentum_inside"], [7.0, 0.0, 0.0], atol=1e-14)


def _off(report: Any, inside: Any) -> Any:
    return report["angular_momentum"] * np.array(report["equilibria"][0]["direction"]) - inside


def test_a_wheel_with_no_momentum_changes_nothing() -> None:
    without = told(*BODY, "--end", "100")
    with_it = told(*BODY, "--wheel", "z, 0", "--end", "100")
    for name in ("omega_end", "euler_angles_end", "angular_momentum_vector", "kinetic_energy"):
        assert with_it[name] == without[name]


def test_pictures_and_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("polhode.draw.sampling._SECONDS", 0.5)  # few pictures
    names = [tmp_path / name for name in ("a.png", "a.svg", "a.csv", "a.npz", "a.json", "a.html", "a.gif")]
    saves = [word for name in names for word in ("--save", name)]
    code, out, err = run(*BODY, "--wheel", "y, 0.7", "--end", 1, "--times", 11, *saves)
    assert (code, err) == (0, "")
    for name, start in zip(
        names, (b"\x89PNG", b"<?xml", b"t,omega_x", b"PK", b"{", b"<!", b"GIF89a"), strict=True
    ):
        assert name.read_bytes().startswith(start)
        assert re.search(rf"saved .*{re.escape(name.name)}", out)
    momentum = np.array(data(names[5])["momentum"])
    np.testing.assert_allclose(momentum, momentum[:1] + np.zeros_like(momentum), atol=3e-7)
    again = Trajectory.from_file(names[4])
    np.testing.assert_allclose(
        again.angular_momentum().total, (MOMENTS * OMEGA + [0.0, 0.7, 0.0]) + np.zeros((11, 3)), atol=1e-14
    )
