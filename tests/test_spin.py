"""``polhode spin``: what it prints and what it saves."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from command_line import run, write_obj
from oracles.meshes import box, cube
from polhode.cli import brick


@pytest.fixture
def slab(tmp_path: Path) -> Path:
    """A 1 x 2 x 3 box about the origin."""
    return write_obj(tmp_path / "slab.obj", *box((1.0, 2.0, 3.0)))


def test_spin_of_a_brick(tmp_path: Path) -> None:
    """NASA's brick as a mesh: the box of its moments, spun from its published rates to its exact ones."""
    i1, i2, i3 = brick.MOMENTS
    sides = np.sqrt(6 * np.array([i2 + i3 - i1, i1 + i3 - i2, i1 + i2 - i3]) / brick.MASS)
    path = write_obj(tmp_path / "brick.obj", *box(tuple(sides)))
    rates = ("--omega", "10", "20", "30", "--degrees", "--until", "30", "--rtol", "1e-13")
    report = json.loads(run("spin", path, "--mass", brick.MASS, *rates, "--format", "json")[1])
    np.testing.assert_allclose(report["principal_moments"], brick.MOMENTS, rtol=1e-14)
    np.testing.assert_allclose(report["omega_start"], [10, 20, 30], rtol=1e-14)
    np.testing.assert_allclose(report["omega_end"], brick.EXACT_RATES, rtol=0, atol=1e-11)
    assert report["kinetic_energy_drift"] < 1e-12
    assert report["angular_momentum_drift"] < 1e-11
    assert all(math.isfinite(angle) for angle in report["euler_angles_end"])
    omega = np.deg2rad([10, 20, 30])
    assert report["kinetic_energy"] == pytest.approx(0.5 * omega @ (omega * brick.MOMENTS), rel=1e-13)
    assert report["angular_momentum"] == pytest.approx(np.linalg.norm(omega * brick.MOMENTS), rel=1e-13)


def test_spin_along_principal_axes(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "box.obj", *box((3.0, 1.0, 2.0)))
    report = json.loads(
        run("spin", path, "--axes", "principal", "--omega", 0, 0, 2, "--until", 1, "--format", "json")[1]
    )
    np.testing.assert_allclose(report["omega_end"], [0, 0, 2], atol=1e-12)
    assert report["angular_momentum"] == pytest.approx(2 * 6 * (9 + 4) / 12, rel=1e-13)


def test_undefined_euler_angles_are_said(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "cube.obj", *cube(2.0))
    arguments = ("spin", path, "--omega", 0, 0, 1, "--until", 1)
    code, out, _ = run(*arguments)
    assert code == 0
    assert "undefined" in out
    assert "not defined" in out
    report = json.loads(run(*arguments, "--format", "json")[1])
    assert None in report["euler_angles_end"]


def test_body_at_rest_stays(slab: Path) -> None:
    report = json.loads(run("spin", slab, "--omega", 0, 0, 0, "--until", 1, "--format", "json")[1])
    assert report["omega_end"] == [0, 0, 0]
    assert report["kinetic_energy_drift"] == 0


def test_spin_of_a_linear_molecule(tmp_path: Path) -> None:
    (tmp_path / "co.xyz").write_text("2\ncarbon monoxide\nC 0 0 0\nO 0 0 1.128\n")
    code, out, err = run("spin", tmp_path / "co.xyz", "--omega", 1, 0, 0.5, "--until", 3, "--format", "json")
    assert (code, err) == (0, "")
    assert json.loads(out)["omega_end"][2] == pytest.approx(0.5, rel=1e-12)


def test_spin_saves_by_suffix(slab: Path, tmp_path: Path) -> None:
    names = [tmp_path / name for name in ("a.png", "a.svg", "a.pdf", "a.csv", "a.npz")]
    saves = [argument for name in names for argument in ("--save", name)]
    code, out, err = run("spin", slab, "--omega", 0.1, 2, 0.1, "--until", 5, "--samples", 11, *saves)
    assert (code, err) == (0, "")
    for name, start in zip(names, (b"\x89PNG", b"<?xml", b"%PDF", b"t,omega_x", b"PK"), strict=True):
        assert name.read_bytes().startswith(start)
        assert f"saved {name}" in out
    with np.load(names[-1]) as file:
        assert file["t"].tolist() == np.linspace(0, 5, 11).tolist()
        assert file["omega"].shape == (11, 3)
