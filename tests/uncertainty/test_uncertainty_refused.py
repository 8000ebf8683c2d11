"""Sigmas and covariances that are refused, and numbers with a sigma where plain ones are expected."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import polhode
import pytest
from polhode import MassAccumulator, Uncertain
from scipy.spatial.transform import Rotation
from uncertain_bodies import RigidBody, laminae, rods, solids

QUARTER = Rotation.from_rotvec([0.3, -1.1, 0.6])
PLAIN = RigidBody(2.0, np.diag([3.0, 4.0, 5.0]))
DISK = laminae.disk(1.0, mass=4.0)
ROD = rods.rod(1.0, mass=12.0)
POINT = RigidBody.from_particles([1.0], [(0.0, 0.0, 0.0)])


def ten_by_ten(**elements: float) -> Any:
    P = np.eye(10) * 1e-4
    for place, value in elements.items():
        P[int(place[1]), int(place[2])] = value
    return P


REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "negative sigma": (lambda: Uncertain(1.0, -0.1), "sigma"),
    "one negative sigma": (lambda: Uncertain([1.0, 2.0], [0.1, -0.1]), "sigma"),
    "sigma NaN": (lambda: Uncertain(1.0, np.nan), "sigma|finite|NaN"),
    "sigma infinite": (lambda: Uncertain(1.0, np.inf), "sigma|finite|inf"),
    "sigma of another shape": (lambda: Uncertain([1.0, 2.0], [0.1, 0.2, 0.3]), "sigma"),
    "sigma longer than the number": (lambda: Uncertain(1.0, [0.1, 0.2]), "sigma"),
    "neither": (lambda: Uncertain(1.0), "sigma"),
    "both": (lambda: Uncertain(1.0, 0.1, covariance=[[0.01]]), "sigma"),
    "covariance of another shape": (lambda: Uncertain([1.0, 2.0], covariance=[[1.0]]), "covariance"),
    "covariance not symmetric": (
        lambda: Uncertain([1.0, 2.0], covariance=[[1.0, 0.1], [0.2, 1.0]]),
        "covariance",
    ),
    "covariance not positive": (
        lambda: Uncertain([1.0, 2.0], covariance=[[1.0, 1.1], [1.1, 1.0]]),
        "covariance",
    ),
    "variance negative": (
        lambda: Uncertain([1.0, 2.0], covariance=[[1.0, 0.0], [0.0, -1e-9]]),
        "covariance",
    ),
    "correlated with what has no variance": (
        lambda: Uncertain([1.0, 2.0], covariance=[[1.0, 0.1], [0.1, 0.0]]),
        "covariance",
    ),
    "covariance NaN": (
        lambda: Uncertain([1.0, 2.0], covariance=[[1.0, np.nan], [np.nan, 1.0]]),
        "covariance",
    ),
    "mass with negative sigma": (lambda: PLAIN.with_sigma(mass=-0.1), "mass|sigma"),
    "centre with sigma NaN": (lambda: PLAIN.with_sigma(center_of_mass=(0.1, np.nan, 0.1)), "center_of_mass"),
    "centre with two sigmas": (lambda: PLAIN.with_sigma(center_of_mass=(0.1, 0.1)), "center_of_mass|shape"),
    "tensor with six sigmas": (lambda: PLAIN.with_sigma(inertia=(0.1,) * 6), "inertia|shape"),
    "tensor's sigmas not symmetric": (
        lambda: PLAIN.with_sigma(inertia=[[0.1, 0.2, 0.1], [0.1, 0.1, 0.1], [0.1, 0.1, 0.1]]),
        "symmetric",
    ),
    "number with sigmas not symmetric": (
        lambda: RigidBody(2.0, Uncertain(np.diag([3.0, 4.0, 5.0]), [[0.1, 0.2, 0.1], [0.1] * 3, [0.1] * 3])),
        "symmetric",
    ),
    "tensor whose mirrored elements move apart": (
        lambda: RigidBody(2.0, Uncertain(np.diag([3.0, 4.0, 5.0]), covariance=0.01 * np.eye(9))),
        "symmetric",
    ),
    "body's covariance of nine": (lambda: PLAIN.with_covariance(np.eye(9)), r"10, 10"),
    "body's covariance not symmetric": (lambda: PLAIN.with_covariance(ten_by_ten(_01=1e-5)), "symmetric"),
    "body's covariance not positive": (
        lambda: PLAIN.with_covariance(ten_by_ten(_46=2e-4, _64=2e-4)),
        "covariance",
    ),
    "lamina with an uncertain thickness": (
        lambda: DISK.with_sigma(inertia=np.diag([0.0, 0.0, 0.01])),
        "no body|thickness|second moment",
    ),
    "lamina turned, with an uncertain thickness": (
        lambda: DISK.rotated(QUARTER).with_sigma(inertia=np.full((3, 3), 0.01)),
        "no body|thickness|second moment",
    ),
    "rod with an uncertain width": (
        lambda: ROD.with_sigma(inertia=np.diag([0.0, 0.0, 0.01])),
        "no body|thickness|second moment",
    ),
    "point with an uncertain size": (
        lambda: POINT.with_sigma(inertia=np.diag([0.01, 0.01, 0.01])),
        "no body|thickness|second moment",
    ),
    "lamina's covariance with its thickness": (
        lambda: DISK.with_covariance(np.diag([0.0] * 6 + [1e-4] + [0.0] * 3)),
        "no body|thickness|second moment",
    ),
}

NUMBER, VECTOR = Uncertain(1.0, 0.1), Uncertain((1.0, 2.0, 3.0), 0.1)
PLAIN_ONLY: dict[str, Callable[[], Any]] = {
    "float": lambda: float(NUMBER),
    "array": lambda: np.asarray(VECTOR, dtype=float),
    "list of numbers": lambda: np.array([NUMBER, NUMBER], dtype=float),
    "inertia_about": lambda: PLAIN.inertia_about(VECTOR),
    "moment_about": lambda: PLAIN.moment_about(VECTOR),
    "principal_about": lambda: PLAIN.principal_about(VECTOR),
    "isclose": lambda: PLAIN.isclose(PLAIN, rtol=NUMBER),
    "voxels": lambda: RigidBody.from_voxels(np.ones((2, 2, 2)), NUMBER),
    "nodes": lambda: RigidBody.from_tetrahedra(Uncertain(np.eye(4, 3), 0.1), [(0, 1, 2, 3)], density=1.0),
    "principal_axes": lambda: polhode.principal_axes(Uncertain(np.eye(3), 0.1)),
    "parallel_axis": lambda: polhode.parallel_axis.from_center_of_mass(np.eye(3), NUMBER, (1, 2, 3)),
    "kinetic_energy": lambda: PLAIN.kinetic_energy(VECTOR),
    "torque": lambda: PLAIN.torque(VECTOR),
    "stick": lambda: polhode.equimomental.stick(NUMBER, 1.0, (0, 0, 0), (1, 0, 0)),
    "accumulator": lambda: MassAccumulator().add(NUMBER, [(0.0, 0.0, 0.0)]),
    "constant_torque": lambda: polhode.loads.constant_torque(VECTOR),
    "euler_angles": lambda: polhode.euler_angles.to_quaternion(VECTOR),
    "transport": lambda: polhode.kinematics.transport(VECTOR, (1, 2, 3), (1, 2, 3)),
    "sides of a prism": lambda: solids.prism(Uncertain(6.0, 0.1), 1.0, 1.0, mass=1.0),
    "a rotation for a shift": lambda: PLAIN.translated(Uncertain(QUARTER, 0.1)),
    "a shift for a rotation": lambda: PLAIN.rotated(VECTOR),
}


class TestRefused:
    @pytest.mark.parametrize(("call", "words"), REFUSED.values(), ids=REFUSED)
    def test_with_the_reason(self, call: Callable[[], Any], words: str) -> None:
        with pytest.raises((ValueError, TypeError), match=words):
            call()

    @pytest.mark.parametrize("call", PLAIN_ONLY.values(), ids=PLAIN_ONLY)
    def test_never_taken_for_its_value(self, call: Callable[[], Any]) -> None:
        with pytest.raises((ValueError, TypeError)):
            call()

    def test_beside_what_is_refused(self) -> None:
        """The other side of each threshold."""
        assert Uncertain(1.0, 0.0).sigma == 0.0
        correlated = Uncertain([1.0, 2.0], covariance=[[1.0, 1.0], [1.0, 1.0]])
        assert correlated.sigma.tolist() == [1.0, 1.0]
        assert np.array_equal(correlated.covariance, np.ones((2, 2)))
        Uncertain([1.0, 2.0], covariance=[[1.0, 0.0], [0.0, 0.0]])
        flat = np.zeros((10, 10))
        flat[np.ix_([4, 5, 6], [4, 5, 6])] = 1e-4 * np.outer((1, 1, 2), (1, 1, 2))
        assert DISK.with_covariance(flat).sigma.inertia[2, 2] == pytest.approx(0.02, rel=1e-12)
        assert DISK.rotated(Uncertain(QUARTER, 0.1)).covariance is not None
        long = np.zeros((10, 10))
        long[np.ix_([4, 5], [4, 5])] = 1e-4
        assert ROD.with_covariance(long).sigma.principal_moments == pytest.approx(
            [0.0, 0.01, 0.01], rel=1e-10
        )
        assert POINT.with_sigma(mass=0.1, center_of_mass=(0.1,) * 3).sigma.mass == pytest.approx(0.1)

    def test_sources_make_no_impossible_bodies(self) -> None:
        """Laminae, rods and points with uncertain sizes, turned and moved, are laminae, rods and points."""
        radius, shift = Uncertain(1.0, 0.05), Uncertain((1.0, 2.0, 3.0), 0.1)
        turn = Uncertain(QUARTER, 0.02)
        for body in (laminae.disk(radius, density=2.0), rods.rod(radius, density=2.0), POINT):
            placed = body.rotated(turn).translated(shift)
            bare = RigidBody(placed.mass, placed.inertia, placed.center_of_mass)
            again = bare.with_covariance(placed.covariance)
            sigma = np.sqrt(np.diag(placed.covariance))
            scale = np.outer(sigma, sigma) + 1e-12 * sigma.max() ** 2
            assert (np.abs(again.covariance - placed.covariance) <= 1e-10 * scale).all()
