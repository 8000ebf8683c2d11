"""What any version has saved is read by this one, to the last digit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polhode
import pytest
from polhode import RigidBody, Trajectory
from saved_files import FOLDER, MASSES, MOMENTS, RATE, SIGMA, TIMES, boxes

FOLDERS = sorted(path for path in FOLDER.iterdir() if path.is_dir())
EACH = pytest.mark.parametrize(
    "file",
    [
        pytest.param(folder / f"{{}}.{suffix}", id=f"{folder.name} {suffix}")
        for folder in FOLDERS
        for suffix in ("json", "npz")
    ],
)


def of(file: Path, name: str) -> Path:
    return file.with_name(file.name.format(name))


def test_there_are_files_of_this_minor_version_or_an_earlier_one() -> None:
    def numbers(version: str) -> list[int]:
        return [int(part) for part in version.split(".")]

    assert FOLDERS
    assert numbers(FOLDERS[0].name) <= numbers(polhode.__version__)


@EACH
def test_bodies(file: Path) -> None:
    body = RigidBody.from_file(of(file, "bodies"))
    np.testing.assert_array_equal(body.mass, MASSES)
    np.testing.assert_array_equal(body.center_of_mass, [[1.0, 0.0, 0.0]] * 2)
    np.testing.assert_allclose(body.principal_moments, MOMENTS * [[1.0], [2.0]], rtol=4e-16)
    np.testing.assert_allclose(body.inertia, boxes().inertia, rtol=4e-16)


@EACH
def test_a_body_with_a_sigma(file: Path) -> None:
    body = RigidBody.from_file(of(file, "uncertain"))
    assert body.mass == 12.0
    sigma = body.sigma
    assert sigma is not None
    np.testing.assert_allclose(sigma.mass, SIGMA, rtol=4e-16)
    moments = np.asarray(sigma.principal_moments, float)
    np.testing.assert_allclose(moments, MOMENTS * SIGMA / 12.0, rtol=1e-15)


@EACH
def test_a_motion(file: Path) -> None:
    motion = Trajectory.from_file(of(file, "motion"))
    np.testing.assert_array_equal(motion.t, TIMES)
    np.testing.assert_allclose(motion.omega, [[RATE, 0.0, 0.0]] * 3, atol=1e-15)
    half = RATE * TIMES / 2
    turned = np.stack([np.sin(half), 0 * half, 0 * half, np.cos(half)], axis=-1)
    np.testing.assert_allclose(motion.quaternion, turned, atol=1e-15)
    np.testing.assert_allclose(motion.body.principal_moments, MOMENTS, rtol=4e-16)
