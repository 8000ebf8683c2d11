"""The energy in the readouts of the moving page: T, V and their sum, as the motion has them."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from browser import Browser, needs_browser
from moving_pictures import TOLD
from polhode import RigidBody, Trajectory, euler_angles, loads, solids
from polhode.draw.sampling import Footage
from polhode.draw.scene import energy_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = needs_browser

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
OMEGA = (0.3, 0.2, 1.1)
TIMES = np.linspace(0.0, 8.0, 201)
CONE = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0)).translated((0, 0, 0.045))
FLAT = solids.box((0.3, 0.2, 0.1), mass=2.0).translated((0.1, 0.2, 0.3))
SPRING = loads.feedback(np.eye(3), np.zeros((3, 3)))


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("energy")) as one:
        one.screen(1200, 820)
        yield one


def told(browser: Browser, run: Trajectory, file: Path, t: float) -> dict[str, str]:
    browser.open(run.animate(file), f"#t={t!r}")
    found: dict[str, str] = browser.run(TOLD)
    return found


@pytest.mark.parametrize(
    ("body", "load", "options"),
    [
        (BODY, loads.uniform_gravity((0, 0, -9.81)), {"velocity": (0.0, 1.0, 5.0)}),
        (FLAT, loads.uniform_gravity((0, 0, -9.81)), {"about": "origin"}),
        (BODY, SPRING, {}),
        (BODY, loads.magnetic((0, 0.2, 1), (1.0, 0.3, 0)), {}),
        (BODY, loads.constant_force((0, 0.2, 1), "space", (1.0, 0, 0)), {"velocity": (0.1, 0.2, 0.0)}),
        (BODY, SPRING + loads.rotor((0, 0, 2)), {}),
        (BODY, SPRING + loads.wheel((1, 0, 0), 0.1, 5.0), {}),
    ],
)
def test_a_load_with_a_potential(
    browser: Browser, tmp_path: Path, body: RigidBody, load: loads.Load, options: dict[str, Any]
) -> None:
    """A coarse run: the drift that is seen is its own."""
    run = body.simulate(TIMES, OMEGA, load=load, rtol=1e-6, method="dop853", **options)
    numbers = told(browser, run, tmp_path / "a.html", float(TIMES[-1]))
    kinetic, potential = run.kinetic_energy().total, run.potential_energy()
    assert float(numbers["T"]) == pytest.approx(kinetic[-1], rel=1e-5)
    assert float(numbers["V"]) == pytest.approx(potential[-1], rel=1e-5)
    total, drift = numbers["T + V"].split(", drift ")
    assert float(total) == pytest.approx(kinetic[-1] + potential[-1], rel=1e-5)
    change = (kinetic + potential)[-1] - (kinetic + potential)[0]
    assert float(drift) == pytest.approx(change / (kinetic + np.abs(potential)).max(), rel=0.06, abs=1e-15)
    assert abs(float(drift)) <= 1.06 * float(run.invariants().energy_drift)


def test_of_a_top(browser: Browser, tmp_path: Path) -> None:
    motion = CONE.heavy_top((0, 0, 260.0), euler_angles.to_quaternion((0, 0.5, 0)), (0, 0, -9.81))
    run = motion.at(np.linspace(0.0, 1.0, 11))
    numbers = told(browser, run, tmp_path / "a.html", 1.0)
    assert float(numbers["T"]) == pytest.approx(run.kinetic_energy().total[-1], rel=1e-5)
    assert float(numbers["V"]) == pytest.approx(run.potential_energy()[-1], rel=1e-5)
    assert "drift" not in numbers["T + V"]  # of a closed form


@pytest.mark.parametrize(
    ("load", "why"),
    [
        (loads.damping(np.eye(3)), "no potential: damping"),
        (SPRING + loads.gravity_gradient(1.0, (0, 0, 3.0), (0.5, 0, 0)), "no potential: gravity_gradient"),
        (SPRING + loads.wheel((1, 0, 0), 0.1, torque=0.1), "no potential: wheel with motor or friction"),
        (
            0.5 * loads.constant_torque((1, 0, 0)) + loads.slug(0.1, 0.1),
            "no potential: constant_torque, slug",
        ),
    ],
)
def test_a_load_without_one(browser: Browser, tmp_path: Path, load: loads.Load, why: str) -> None:
    run = BODY.simulate(TIMES, OMEGA, load=load)
    numbers = told(browser, run, tmp_path / "a.html", 8.0)
    assert float(numbers["T"]) == pytest.approx(run.kinetic_energy().total[-1], rel=1e-5)
    assert numbers["V"] == why
    assert "T + V" not in numbers


def test_where_nothing_acts(browser: Browser, tmp_path: Path) -> None:
    """T alone, with that of the way of the centre of mass, which the picture leaves out."""
    run = BODY.simulate(TIMES, OMEGA, velocity=(3.0, 0.0, 4.0))
    numbers = told(browser, run, tmp_path / "a.html", 3.0)
    assert float(numbers["T"]) == pytest.approx(run.kinetic_energy().total[0], rel=1e-5)
    assert set(numbers) == {"T", "|L|", "|ω|", "next flip"}
    gyrostat = BODY.gyrostat((0.0, 0.2, 1.0)).free_motion(OMEGA).at(TIMES)
    numbers = told(browser, gyrostat, tmp_path / "b.html", 3.0)
    assert float(numbers["T"]) == pytest.approx(gyrostat.kinetic_energy().total[0], rel=1e-5)
    assert "V" not in numbers


def test_a_load_that_a_file_has_lost(browser: Browser, tmp_path: Path) -> None:
    BODY.simulate(TIMES, OMEGA, load=SPRING).save(tmp_path / "a.npz")
    numbers = told(browser, Trajectory.from_file(tmp_path / "a.npz"), tmp_path / "a.html", 3.0)
    assert numbers["V"] == "not known: a file does not hold the load"


def test_chosen_frames_are_samples() -> None:
    run = copy.copy(BODY.simulate(TIMES, OMEGA, load=SPRING))
    energy = energy_of(Footage(run, np.array([0, 7, 200]), 1.0), is_exact=False)
    np.testing.assert_array_equal(energy.kinetic, run.kinetic_energy().total[[0, 7, 200]])
