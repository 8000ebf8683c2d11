"""Moving pictures of bodies with momentum inside: their own motion, and L with that of the wheels."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING

import numpy as np
import polhode
import pytest
from moving_pictures import angles, check_chords, in_space
from oracles.bodies import matrix
from page_data import data
from PIL import Image
from polhode import RigidBody, Trajectory, loads
from polhode.draw.sampling import TURN, fastest, motion_times

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray
    from polhode import GyrostatMotion

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
STARTS = [
    ((0.0, 0.2, 0.0), (0.3, 0.2, 1.1)),
    ((0.0, 0.0, 30.0), (0.3, 0.2, 1.1)),
    ((0.1, 0.0, 0.3), (-0.4, 1.2, 0.1)),
    ((0.0, 0.5, 0.0), (1e-6, 0.3, 0.0)),
    ((0.0, 0.0, 0.0), (0.3, 0.2, 1.1)),
    ((0.0, 0.0, 1.0), (0.0, 0.0, -0.4)),
    ((0.1, 0.5, 2.0), (0.0, 0.0, 0.0)),
]


def arrows(page: Path) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """L and h as the page has them, both in space."""
    shown = data(page)
    quaternion, inside = np.array(shown["quaternion"]), np.array(shown["inside"])
    turned = np.stack([matrix(q) @ h for q, h in zip(quaternion, inside, strict=True)])
    return np.array(shown["momentum"]), turned


@pytest.mark.parametrize(("inside", "omega"), STARTS)
def test_frames_follow_a_gyrostat(
    inside: tuple[float, ...], omega: tuple[float, ...], tmp_path: Path
) -> None:
    motion = BODY.gyrostat(inside).free_motion(omega)
    rate = fastest(motion)
    dense = np.linalg.norm(motion.at(np.linspace(0.0, 300.0, 30_001)).omega, axis=-1).max()
    assert 0.999 * dense <= rate <= 1.001 * dense
    times = motion_times(motion, np.array([0.0, 20.0])).t
    assert angles(motion.at(times).quaternion).max() <= TURN * (1.0 + 1e-9)
    if rate > 0.0:
        check_chords(lambda t: in_space(motion.at(t)) / rate, times)
    few = motion.at(np.linspace(1.0, 11.0, 5))
    page = few.animate(tmp_path / "page.html")
    shown = data(page)
    exact = motion.at(shown["t"])
    np.testing.assert_allclose(shown["quaternion"], exact.quaternion, atol=1e-6)
    momentum, _ = arrows(page)
    np.testing.assert_allclose(momentum, momentum[:1] + np.zeros_like(momentum), atol=3e-6)


def test_free_wheels_too(tmp_path: Path) -> None:
    wheels = [
        polhode.wheel(axis=(0, 1, 1), inertia=0.3, rate=3.0),
        polhode.wheel(axis=(1, 1, 0), inertia=0.1, rate=-2.0),
        polhode.wheel(axis=(1, 0, 0), inertia=0.1, rate=5.0, mode="held"),
    ]
    motion = BODY.gyrostat((0.1, 0.0, 0.0), wheels=wheels).free_motion((0.3, 0.2, 1.1))
    page = motion.at([2.0, 12.0]).animate(tmp_path / "page.html")
    np.testing.assert_allclose(
        data(page)["quaternion"], motion.at(data(page)["t"]).quaternion, atol=1e-6, rtol=0
    )
    momentum, _ = arrows(page)
    np.testing.assert_allclose(momentum, momentum[:1] + np.zeros_like(momentum), atol=3e-6)


def test_on_the_separatrix() -> None:
    """From rest at an unstable spin and back: the greatest rate is that of the way between."""
    gyrostat = BODY.gyrostat((0.0, 0.2, 0.0))
    saddle = gyrostat.equilibria(2.0)
    spin = saddle.omega[list(saddle.kind).index("saddle")]
    motion: GyrostatMotion = gyrostat.free_motion(spin + np.array([1e-9, 0.0, 0.0]))
    dense = np.linalg.norm(motion.at(np.linspace(0.0, 400.0, 40_001)).omega, axis=-1).max()
    assert fastest(motion) == pytest.approx(dense, rel=2e-3)


def test_a_motion_that_only_knows_its_samples(tmp_path: Path) -> None:
    """What a file holds are samples; they are shown, not the motion without wheels."""
    motion = BODY.gyrostat((0.0, 0.2, 1.0)).free_motion((0.3, 0.2, 1.1))
    shown = copy.deepcopy(motion.at(np.linspace(0.0, 5.0, 101)))
    saved = tmp_path / "motion.npz"
    shown.save(saved)
    for one in (shown, Trajectory.from_file(saved)):
        found = data(one.animate(tmp_path / "page.html"))
        np.testing.assert_allclose(found["quaternion"], motion.at(found["t"]).quaternion, atol=1e-6)


def test_a_wheel_with_a_motor(tmp_path: Path) -> None:
    motor = loads.wheel((0, 0, 1), 0.05, 1.0, torque=[0.2, -0.2, 0.0], times=[0, 5, 10])
    run = BODY.simulate(np.linspace(0.0, 10.0, 201), omega=(0.3, 0.2, 1.1), load=motor)
    momentum, inside = arrows(run.animate(tmp_path / "page.html"))
    np.testing.assert_allclose(momentum, momentum[:1] + np.zeros_like(momentum), atol=3e-6)
    wheel = run.states["wheel"][:, 0] - 0.05 * run.omega[:, 2]
    np.testing.assert_allclose(np.linalg.norm(inside, axis=1), wheel, atol=3e-6)


def test_both_in_a_film(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    moving = BODY.gyrostat((0.0, 0.2, 1.0)).free_motion((0.3, 0.2, 1.1)).at(np.linspace(0.0, 1.0, 11))
    with_it = moving.animate(tmp_path / "a.gif", frames=4)
    with Image.open(with_it) as film:
        pixels = np.asarray(film.convert("RGB")).reshape(-1, 3).astype(int)
    assert (np.abs(pixels - (0x7A, 0x4A, 0x00)).max(axis=1) < 12).sum() > 20  # h, in its colour


def test_a_body_with_nothing_inside_has_no_h(tmp_path: Path) -> None:
    page = BODY.simulate([0.0, 1.0], (0.3, 0.2, 1.1)).animate(tmp_path / "page.html")
    assert data(page)["inside"] is None


def test_methods(tmp_path: Path) -> None:
    motion = BODY.gyrostat((0.1, 0.5, 0.3)).free_motion((0.3, 0.2, 1.1))
    assert motion.animate(tmp_path / "a.html", 5.0, title="A") == tmp_path / "a.html"
    assert data(tmp_path / "a.html")["t"][-1] == 5.0
    pytest.importorskip("matplotlib")
    assert motion.plot(5.0).lines[0].get_xdata()[-1] == 5.0
