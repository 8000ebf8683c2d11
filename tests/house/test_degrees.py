"""``degrees=True``: every function that takes or gives angles has it, and it is the same as converting."""

from __future__ import annotations

import inspect
import math
from typing import Any

import numpy as np
import pytest
from polhode import euler_angles, orbits, rods, rolling, solids, tops
from polhode.results import NutationDamping
from public_objects import OBJECTS

HAVE = {
    "polhode.HeavyTop.effective_potential",
    "polhode.Trajectory.euler_angles",
    "polhode.Trajectory.euler_rates",
    "polhode.euler_angles.angular_velocity",
    "polhode.euler_angles.from_quaternion",
    "polhode.euler_angles.rates",
    "polhode.euler_angles.to_quaternion",
    "polhode.orbits.RelativeMotion.angles",
    "polhode.orbits.from_elements",
    "polhode.results.NutationDamping.angle",
    "polhode.results.NutationDamping.time",
    "polhode.rods.arc",
    "polhode.rolling.steady",
    "polhode.tops.least_spin",
    "polhode.tops.steady_precession",
}
NAMES = {"angle", "angles", "inclination", "node", "anomaly"}
TOP: Any = solids.cone(0.02, 0.05, mass=0.1).rotated((1, 0, 0, 0)).translated((0, 0, 0.0375))
ANGLES = np.array([[40.0, 70.0, -110.0], [-3.0, 20.0, 5.0]])
G = (0.0, 0.0, -9.81)


def parameters(name: str) -> set[str]:
    value = OBJECTS[name]
    value = value.__func__ if isinstance(value, staticmethod | classmethod) else value
    is_function = inspect.isroutine(value) and callable(value)  # a cached property is not callable
    return set(inspect.signature(value).parameters) if is_function else set()


def test_every_function_of_angles_has_the_option() -> None:
    assert {name for name in OBJECTS if "degrees" in parameters(name)} == HAVE
    # What polhode.symbolic takes are expressions, which have no unit.
    asks = {name for name in OBJECTS if parameters(name) & NAMES and "symbolic" not in name}
    assert asks <= HAVE
    for name in HAVE:
        option = inspect.signature(OBJECTS[name]).parameters["degrees"]
        assert (option.kind, option.default) == (option.KEYWORD_ONLY, False)


def same(got: object, want: object) -> None:
    np.testing.assert_allclose(np.asarray(got, float), np.asarray(want, float), rtol=4e-16, atol=0)


class TestEulerAngles:
    @pytest.mark.parametrize("sequence", ["ZXZ", "ZYX", "xyz"])
    def test_there_and_back(self, sequence: str) -> None:
        q = euler_angles.to_quaternion(ANGLES, sequence, degrees=True)
        assert np.array_equal(q, euler_angles.to_quaternion(np.deg2rad(ANGLES), sequence))
        plain = euler_angles.from_quaternion(q, sequence)
        same(euler_angles.from_quaternion(q, sequence, degrees=True), np.rad2deg(plain))

    def test_rates(self) -> None:
        rates = np.array([3.0, -20.0, 100.0])
        omega = euler_angles.angular_velocity(ANGLES, rates, degrees=True)
        assert np.array_equal(omega, euler_angles.angular_velocity(np.deg2rad(ANGLES), np.deg2rad(rates)))
        back = euler_angles.rates(ANGLES, omega, degrees=True)
        np.testing.assert_allclose(back, np.tile(rates, (2, 1)), rtol=1e-13)

    def test_singular_attitudes(self) -> None:
        upright = (0, 0, 0, 1)
        found = euler_angles.from_quaternion(upright, singular="nan", degrees=True)
        assert np.isnan(found[[0, 2]]).all()
        assert found[1] == 0.0

    def test_along_a_motion(self) -> None:
        motion = solids.box((3, 2, 1), mass=1.0).simulate(
            np.linspace(0, 20, 41), (1.0, 0.3, 2.0), (0.6, 0, 0, 0.8)
        )
        same(motion.euler_angles(degrees=True), np.rad2deg(motion.euler_angles()))
        same(motion.euler_angles(unwrap=True, degrees=True), np.rad2deg(motion.euler_angles(unwrap=True)))
        same(motion.euler_rates(degrees=True), np.rad2deg(motion.euler_rates()))


def test_tops() -> None:
    spun = np.deg2rad(30.0)
    assert tops.least_spin(TOP, G, 30.0, degrees=True) == tops.least_spin(TOP, G, spun)
    found = tops.steady_precession(TOP, 900.0, 30.0, G, degrees=True)
    assert np.array_equal(found, tops.steady_precession(TOP, 900.0, spun, G))
    top = TOP.heavy_top((1, 0, 400.0), gravity=G)
    leans = [10.0, 20.0]
    assert np.array_equal(
        top.effective_potential(leans, degrees=True), top.effective_potential(np.deg2rad(leans))
    )


def test_damping() -> None:
    fate = NutationDamping(-0.01)
    same(fate.angle(40.0, 30.0, degrees=True), np.rad2deg(fate.angle(np.deg2rad(40.0), 30.0)))
    same(fate.time(40.0, 10.0, degrees=True), fate.time(np.deg2rad(40.0), np.deg2rad(10.0)))


def test_arcs() -> None:
    assert np.array_equal(
        rods.arc(2.0, 90.0, mass=1.0, degrees=True).inertia, rods.arc(2.0, math.pi / 2, mass=1.0).inertia
    )
    assert rods.arc(1.0, 360.0, density=1.0, degrees=True).mass == 2 * math.pi
    with pytest.raises(ValueError, match="from 0 to 2π"):
        rods.arc(1.0, 360.1, mass=1.0, degrees=True)


def test_steady_rolling() -> None:
    coin, edge = solids.cylinder(0.012, 0.0, mass=0.006), rolling.disk(0.012)
    (found,) = rolling.steady(coin, edge, inclination=70.0, turn=8.0, degrees=True)
    (want,) = rolling.steady(coin, edge, inclination=np.deg2rad(70.0), turn=8.0)
    assert found.spin == want.spin
    same(found.omega, want.omega)


def test_orbits() -> None:
    turned = {"inclination": 51.6, "node": 30.0, "argument": 15.0, "anomaly": -100.0}
    orbit = orbits.from_elements(1.0, eccentricity=0.1, periapsis=1.0, degrees=True, **turned)
    plain = {name: np.deg2rad(value) for name, value in turned.items()}
    want = orbits.from_elements(1.0, eccentricity=0.1, periapsis=1.0, **plain)
    assert np.array_equal(orbit.position, want.position)
    told = orbit.elements.in_degrees()
    for name, value in turned.items():
        assert getattr(told, name) == pytest.approx(value, rel=1e-13)
    assert (told.periapsis, told.eccentricity) == (orbit.elements.periapsis, orbit.elements.eccentricity)
