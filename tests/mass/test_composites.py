"""Composites: sums and cavities, of solids, sheets and wires, near and far, thick and thin."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import Exact, dot, rational, worst_error
from oracles.bodies import Body, attitudes, bodies, matrix
from polhode import RigidBody, laminae, rods, solids
from polhode.errors import InvalidInertiaError


def assembled(parts: list[tuple[int, RigidBody]]) -> tuple[Fraction, Exact, Exact]:
    """Mass, centre and tensor of bodies with signs, exact from their numbers as they are stored."""
    signed = [
        (sign * Fraction(b.mass), rational(b.center_of_mass), sign, rational(b.inertia)) for sign, b in parts
    ]
    mass = sum((m for m, *_ in signed), Fraction(0))
    center = [sum((m * c[i] for m, c, *_ in signed), Fraction(0)) / mass for i in range(3)]
    tensor = [[Fraction(0)] * 3 for _ in range(3)]
    for m, c, sign, own in signed:
        d = [x - y for x, y in zip(c, center, strict=True)]
        for i in range(3):
            for j in range(3):
                tensor[i][j] += sign * own[i][j] + m * ((dot(d, d) if i == j else 0) - d[i] * d[j])
    return mass, center, tensor


class TestFarApart:
    """Sums of bodies a distance D apart, anywhere: 4e-15 and 4 ulp(D) of their size."""

    @given(data=st.lists(bodies(decades=0), min_size=2, max_size=5), power=st.integers(0, 12))
    def test_sums(self, data: list[Body], power: int) -> None:
        far = 10.0**power
        parts = [
            RigidBody.from_principal(*body).translated(far * np.array([0.3 * i, 1 - i, i * i]))
            for i, body in enumerate(data)
        ]
        mass, center, tensor = assembled([(1, part) for part in parts])
        for whole in (sum(parts), RigidBody.stack(parts).combined()):
            assert isinstance(whole, RigidBody)
            assert worst_error(whole.mass, mass) <= 1e-15
            assert worst_error(whole.center_of_mass, center, scale=16 * far + 100) <= 4e-16
            assert worst_error(whole.inertia, tensor) <= 4e-15

    @pytest.mark.parametrize("distance", [1e3, 1e8, 1e12])
    def test_together_far_from_the_origin(self, distance: float) -> None:
        """What is close together keeps its tensor; only the stored centres are rounded."""
        parts = [
            solids.cube(1.0, mass=m).translated(np.array([x, y, 0.0]) + distance * np.array([0.6, -0.8, 0.1]))
            for m, x, y in ((1.0, 0.0, 0.0), (2.0, 1.0, 0.25), (0.5, 0.0, 3.0))
        ]
        mass, center, tensor = assembled([(1, part) for part in parts])
        whole = RigidBody.stack(parts).combined()
        assert whole.mass == mass
        assert worst_error(whole.center_of_mass, center, scale=np.spacing(distance)) <= 1
        assert worst_error(whole.inertia, tensor) <= 1e-15

    def test_many_rounds_less_than_one_after_the_other(self, rng: np.random.Generator) -> None:
        stack = solids.sphere(rng.uniform(0.1, 1, 5000), density=1.0).translated(rng.normal(size=(5000, 3)))
        _, _, tensor = assembled([(1, body) for body in stack])
        assert worst_error(stack.combined().inertia, tensor) <= 4e-15
        by_parts = stack.combined().isclose(stack[:2500].combined() + stack[2500:].combined(), rtol=4e-15)
        assert by_parts


class TestThinSums:
    """Collinear and coplanar parts keep the smallest moment that they have, however they are turned."""

    @given(attitude=attitudes(), thin=st.sampled_from([0.0, 1e-14, 1e-10, 1e-6]))
    def test_collinear_cylinders(self, attitude: Any, thin: float) -> None:
        turn = matrix(attitude)
        rod = solids.cylinder(thin, 1.0, mass=1.0)
        parts = rod.translated([(0, 0, 0), (0, 0, 1), (0, 0, 2), (0, 0, 3.5)]).rotated(turn)
        for whole in (parts.combined(), sum(parts)):
            assert isinstance(whole, RigidBody)
            i1, i2, i3 = whole.principal_moments
            assert i2 == pytest.approx(4 / 12 + 6.6875 + thin**2, rel=4e-15)
            assert i3 == pytest.approx(i2, rel=4e-15)
            # Their centres are stored with a rounding of 1e-16, which is a width.
            assert abs(i1 - 2 * thin**2) <= 1e-14 * 2 * thin**2 + 1e-30

    def test_a_wire_of_parts_is_the_wire(self) -> None:
        turn = matrix(np.array([0.5, -0.1, 0.7, 0.5]) / np.linalg.norm([0.5, -0.1, 0.7, 0.5]))
        part = rods.rod(0.5, density=2.0).translated([(0, 0, 0.25 + 0.5 * k) for k in range(8)])
        whole = part.rotated(turn).combined()
        rod = rods.rod(4.0, density=2.0)
        assert whole.principal_moments == pytest.approx(rod.principal_moments, rel=2e-15, abs=1e-29)
        assert whole.principal.top == "linear"

    @given(attitude=attitudes())
    def test_coplanar_sheets_obey_perpendicular_axes(self, attitude: Any) -> None:
        sheets = laminae.rectangle([(2.0, 1e-7), (1.0, 3e-8)], mass=1.0).translated([(0, 0, 0), (3, 0, 0)])
        i1, i2, i3 = sheets.rotated(matrix(attitude)).combined().principal_moments
        assert i1 == pytest.approx((1e-14 + 9e-16) / 12, rel=1e-13)
        assert i3 == pytest.approx(i1 + i2, rel=1e-15)

    def test_points_on_a_line(self) -> None:
        """Bodies without extent, as in a dumbbell: nothing but the distance counts."""
        point = RigidBody(1.0, np.zeros((3, 3)))
        line = point.translated(np.outer([-3.0, 1.0, 2.0], [3.0, 4.0, 12.0])).combined()
        assert line.principal_moments[0] <= 1e-30 * line.principal_moments[2]
        assert line.principal_moments[2] == pytest.approx(14 * 169, rel=1e-15)


class TestMixed:
    def test_a_drum_is_two_disks_and_a_shell(self) -> None:
        radius, height, areal = 2.0, 3.0, 0.25
        ends = laminae.disk(radius, density=areal).translated([(0, 0, -height / 2), (0, 0, height / 2)])
        side = solids.tube(radius, radius, height, mass=areal * 2 * np.pi * radius * height)
        drum = ends.combined() + side
        a, b = np.pi * radius**2 * areal, side.mass
        across = a * radius**2 / 2 + 2 * a * height**2 / 4 + b * (6 * radius**2 + height**2) / 12
        assert np.diag(drum.inertia) == pytest.approx(
            [across, across, a * radius**2 + b * radius**2], rel=1e-15
        )

    def test_a_wheel_of_ring_spokes_and_hub(self) -> None:
        spoke = rods.rod(1.0, mass=0.1).rotated([(0, 0, 1), (1, 0, 0), (0, 1, 0)]).translated((0.5, 0, 0))
        turns = [matrix(np.array([0, 0, np.sin(a / 2), np.cos(a / 2)])) for a in np.arange(6) * np.pi / 3]
        wheel = (
            spoke.rotated(turns).combined() + rods.ring(1.0, mass=2.0) + solids.cylinder(0.1, 0.2, mass=1.0)
        )
        assert wheel.mass == pytest.approx(3.6, rel=1e-15)
        assert np.abs(wheel.center_of_mass).max() < 1e-16
        assert wheel.principal_moments[2] == pytest.approx(6 * 0.1 / 3 + 2.0 + 0.005, rel=1e-15)


class TestCavities:
    @given(data=bodies(decades=1), cut=bodies(decades=1))
    def test_taking_out_undoes_putting_in(self, data: Body, cut: Body) -> None:
        one, two = RigidBody.from_principal(*data), RigidBody.from_principal(*cut)
        both = one + two
        loss = 1 + both.mass / one.mass
        spread = np.trace(both.inertia)
        mass, center, tensor = assembled([(1, both), (-1, two)])
        if np.trace(one.inertia) < 1e-10 * spread or loss > 1e6:
            return  # what is left is not more than the rounding of what there was
        rest = both - two
        assert worst_error(rest.mass, mass) <= 1e-15
        size = float(np.sqrt(spread / one.mass) + np.abs(both.center_of_mass).max())
        assert worst_error(rest.center_of_mass, center, scale=size) <= 4e-15 * loss
        assert worst_error(rest.inertia, tensor, scale=spread) <= 4e-15 * loss

    def test_a_box_with_a_hole(self) -> None:
        block = solids.box((4.0, 2.0, 1.0), density=2.0)
        hole = solids.cylinder(0.5, 1.0, density=2.0).translated((1.0, 0.0, 0.0))
        rest = block - hole
        mass, center, tensor = assembled([(1, block), (-1, hole)])
        assert worst_error(rest.mass, mass) <= 1e-16
        assert worst_error(rest.center_of_mass, center) <= 4e-16
        assert worst_error(rest.inertia, tensor) <= 1e-15

    def test_thin_tube_keeps_its_smallest_moment(self) -> None:
        turn = matrix(np.full(4, 0.5))
        tube = solids.cylinder(2e-6, 1.0, density=1.0) - solids.cylinder(1e-6, 1.0, density=1.0)
        turned = solids.cylinder(2e-6, 1.0, density=1.0).rotated(turn) - solids.cylinder(
            1e-6, 1.0, density=1.0
        ).rotated(turn)
        want = solids.tube(1e-6, 2e-6, 1.0, density=1.0).principal_moments
        assert tube.principal_moments == pytest.approx(want, rel=4e-15)
        assert turned.principal_moments == pytest.approx(want, rel=4e-15)

    def test_more_mass_than_there_is(self) -> None:
        with pytest.raises(InvalidInertiaError, match=r"mass of what remains would be -1\.5"):
            solids.cube(1.0, mass=0.5) - solids.cube(1.0, mass=2.0)
        with pytest.raises(InvalidInertiaError, match=r"mass of what remains would be 0\.0"):
            solids.cube(1.0, mass=2.0) - solids.cube(1.0, mass=2.0)

    def test_a_part_that_is_not_there(self) -> None:
        far = solids.cube(1.0, mass=0.5).translated((0.0, 0.0, 5.0))
        with pytest.raises(
            InvalidInertiaError, match=r"second moment .* would be -\d.* along the axis \(.*1\.000\).*within"
        ):
            solids.cube(1.0, mass=2.0) - far
        with pytest.raises(InvalidInertiaError, match=r"row 1: .*second moment"):
            solids.cube([1.0, 1.0], mass=2.0) - solids.cube([0.5, 1.9], mass=1.0)

    def test_subtraction_broadcasts_and_takes_bodies_only(self) -> None:
        holes = solids.sphere([0.1, 0.2, 0.3], density=1.0)
        rest = solids.cube(1.0, density=1.0) - holes
        assert rest.shape == (3,)
        assert rest[1] == solids.cube(1.0, density=1.0) - holes[1]
        number: Any = 1
        with pytest.raises(TypeError):
            holes - number


class TestCombined:
    def test_axes(self, rng: np.random.Generator) -> None:
        stack = solids.sphere(rng.uniform(1, 2, (2, 3, 4)), density=1.0).translated(
            rng.normal(size=(2, 3, 4, 3))
        )
        assert stack.combined().shape == ()
        assert stack.combined(0).shape == (3, 4)
        assert stack.combined(-1).shape == (2, 3)
        assert stack.combined((0, 2)).shape == (3,)
        assert stack.combined(axis=(0, 2))[1] == stack[:, 1].combined()
        assert stack.combined(1)[1, 2] == stack[1, :, 2].combined()
        assert stack.combined(()) == stack
        assert stack.combined().isclose(stack.combined(2).combined(1).combined(0), rtol=4e-15)

    def test_one_is_itself(self) -> None:
        body = solids.box((1, 2, 3), mass=1.0)
        assert body.combined() == body
        assert body[None].combined(0) == body

    def test_none_is_an_error(self) -> None:
        nothing = solids.sphere(np.ones((0, 2)), mass=1.0)
        with pytest.raises(ValueError, match="empty"):
            nothing.combined()
        with pytest.raises(ValueError, match="empty"):
            nothing.combined(0)
        assert nothing.combined(1).shape == (0,)

    def test_a_wrong_axis_is_an_error(self) -> None:
        with pytest.raises(ValueError, match="axis 1"):
            solids.sphere([1.0, 2.0], mass=1.0).combined(1)
