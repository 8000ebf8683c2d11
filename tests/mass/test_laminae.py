"""Homogeneous laminae: closed forms, exact polygons, slivers, and what does not bound an area."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import ulp_errors, worst_error
from oracles.exact_shapes import polygon
from polhode import RigidBody, laminae, rods, solids

lengths = st.floats(1e-3, 1e3)


class TestKnownByLengths:
    """A lamina is the limit of a flat solid, and those are tested against integrals over their slices."""

    @given(radius=lengths)
    def test_disk_is_a_flat_cylinder(self, radius: float) -> None:
        assert laminae.disk(radius, mass=2.0).isclose(solids.cylinder(radius, 0.0, mass=2.0), rtol=1e-15)
        assert laminae.disk(radius, density=2.0).mass == pytest.approx(2 * np.pi * radius**2, rel=1e-15)

    @given(radius=lengths, share=st.floats(0, 1))
    def test_annulus_is_a_flat_tube(self, radius: float, share: float) -> None:
        inner = share * radius
        annulus = laminae.annulus(inner, radius, mass=2.0)
        assert annulus.isclose(solids.tube(inner, radius, 0.0, mass=2.0), rtol=1e-15)

    def test_annulus_is_a_disk_without_a_disk(self) -> None:
        rest = laminae.disk(3.0, density=0.5) - laminae.disk(1.0, density=0.5)
        assert laminae.annulus(1.0, 3.0, density=0.5).isclose(rest, rtol=1e-14)

    def test_annulus_without_width_is_a_ring(self) -> None:
        assert laminae.annulus(2.0, 2.0, mass=3.0) == rods.ring(2.0, mass=3.0)
        almost = laminae.annulus(2.0, np.nextafter(2.0, 3.0), density=1.0)
        assert almost.mass == pytest.approx(4 * np.pi * (np.nextafter(2.0, 3.0) - 2.0), rel=1e-15)

    def test_ellipse(self) -> None:
        a, b = 3.0, 0.5
        ellipse = laminae.ellipse((a, b), density=4.0)
        assert ellipse.mass == pytest.approx(4 * np.pi * a * b, rel=1e-15)
        quarter = ellipse.mass / 4
        assert np.diag(ellipse.inertia) == pytest.approx(quarter * np.array([b * b, a * a, a * a + b * b]))

    def test_rectangle_is_a_flat_box(self) -> None:
        assert laminae.rectangle((2.0, 4.0), mass=3.0) == solids.box((2.0, 4.0, 0.0), mass=3.0)

    def test_perpendicular_axes(self) -> None:
        """The polar moment of a lamina is the sum of the other two."""
        for lamina in LAMINAE.values():
            i1, i2, i3 = lamina(mass=1.7).principal_moments
            assert i3 == pytest.approx(i1 + i2, rel=4e-16)


POLYGONS: dict[str, Any] = {
    "L": [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)],
    "clockwise": [(0, 0), (0, 2), (5, 2), (4, 0)],
    "star": [
        (np.cos(k * np.pi / 5) * (1 + k % 2), np.sin(k * np.pi / 5) * (1 + k % 2)) for k in range(10)
    ],
    "spiral": [(0, 0), (9, 0), (9, 9), (1, 9), (1, 2), (7, 2), (7, 7), (3, 7), (3, 4), (5, 4), (5, 5), (4, 5),
               (4, 6), (6, 6), (6, 3), (2, 3), (2, 8), (8, 8), (8, 1), (0, 1)],
}  # fmt: skip


def fan(rng: np.random.Generator, signs: list[int]) -> np.ndarray:
    """Triangles about the origin, one after the other, each gone round as its sign says."""
    count = len(signs)
    corners = []
    for k, sign in enumerate(signs):
        angles = (k + rng.uniform(0.1, 0.4) + np.array([0.0, rng.uniform(0.1, 0.5)])) * 2 * np.pi / count
        ends = rng.uniform(0.5, 2.0, (2, 1)) * np.column_stack([np.cos(angles), np.sin(angles)])
        corners += [np.zeros(2), *ends[::sign]]
    return np.array(corners)


class TestTouching:
    """Boundaries that touch themselves: refused where they pass through themselves."""

    @pytest.mark.parametrize("seed", range(20))
    def test_triangles_that_share_a_corner(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        signs = [1] * int(rng.integers(2, 6))
        corners = np.roll(fan(rng, signs), int(rng.integers(0, 9)), axis=0) + 1e3 * rng.normal(size=2)
        same = laminae.polygon(corners, density=1.0)
        exact = polygon(corners)
        assert worst_error(same.mass, abs(exact.mass)) <= 1e-12
        signs[int(rng.integers(0, len(signs)))] = -1
        with pytest.raises(ValueError, match=r"passes through itself|no area"):
            laminae.polygon(fan(rng, signs), density=1.0)

    def test_gone_round_twice(self) -> None:
        square = [(0, 0), (2, 0), (2, 1), (0, 1)]
        assert laminae.polygon([*square, square[0]], density=1.0).mass == 2.0
        with pytest.raises(ValueError, match="negative or twice"):
            laminae.polygon(square * 2, density=1.0)

    def test_a_hole_joined_by_a_cut(self) -> None:
        outside, inside = [(0, 0), (5, 0), (5, 5), (0, 5), (0, 0)], [(1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]
        assert laminae.polygon(outside + inside, density=1.0).mass == pytest.approx(21.0, rel=1e-15)
        with pytest.raises(ValueError, match="negative or twice"):
            laminae.polygon(outside + inside[::-1], density=1.0)


class TestPolygons:
    @pytest.mark.parametrize("name", POLYGONS)
    @pytest.mark.parametrize("distance", [0.0, 1e3, 1e8])
    def test_polygon_is_exact_wherever_it_is(self, name: str, distance: float) -> None:
        corners = np.array(POLYGONS[name], dtype=float) + distance * np.array([0.6, -0.8])
        exact = polygon(corners)
        body = laminae.polygon(corners, density=1.0)
        assert worst_error(body.mass, exact.mass) <= 1e-15
        if distance:
            assert max(ulp_errors(body.center_of_mass[:2], exact.center[:2])) <= 1
        assert worst_error(body.center_of_mass, exact.center, scale=2 + distance) <= 4e-16
        assert worst_error(body.inertia, exact.inertia) <= 4e-15

    @pytest.mark.parametrize("width", [1e-2, 1e-6, 1e-10, 1e-14])
    def test_slivers_keep_their_smallest_moment(self, width: float) -> None:
        """Of the corners as they are stored: turned, thin, and not quite rectangular."""
        turn = np.array([[0.6, -0.8], [0.8, 0.6]])
        corners = (np.array([(-1, -1), (1, -1.5), (1, 1), (-1, 2)]) * [1.0, width]) @ turn.T
        i1 = smallest_moment(polygon(corners).second)
        body = laminae.polygon(corners, mass=2.0)
        mass = float(polygon(corners).mass)
        assert body.principal_moments[0] == pytest.approx(2 * i1 / mass, rel=2e-14)
        three = corners[:3]
        want = 2 * smallest_moment(polygon(three).second) / float(polygon(three).mass)
        assert laminae.triangle(three, mass=2.0).principal_moments[0] == pytest.approx(want, rel=2e-15)

    @given(corners=st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), min_size=3, max_size=3))
    def test_triangle(self, corners: list[tuple[float, float]]) -> None:
        exact_area = abs(float(polygon_area(corners)))
        if exact_area < 1e-6:
            return
        exact = polygon(corners)
        body = laminae.triangle(corners, density=1.0)
        assert worst_error(body.mass, exact.mass) <= 1e-15
        assert worst_error(body.inertia, exact.inertia) <= 2e-15
        assert worst_error(body.center_of_mass, exact.center, scale=5) <= 1e-15
        assert body.isclose(laminae.polygon(corners, density=1.0), rtol=1e-14)

    def test_triangle_without_area_takes_a_mass(self) -> None:
        line = laminae.triangle([(0, 0), (3, 3), (6, 6)], mass=2.0)
        assert line.principal_moments[0] < 1e-30
        with pytest.raises(ValueError, match="area"):
            laminae.triangle([(0, 0), (3, 3), (6, 6)], density=2.0)

    def test_crossing_edges_are_named(self) -> None:
        bow = [(0, 0), (2, 2), (2, 0), (0, 2)]
        with pytest.raises(ValueError, match=r"simple.*vertex 0 crosses.*vertex 2"):
            laminae.polygon(bow, mass=1.0)

    def test_edges_that_touch_do_not_cross(self) -> None:
        """A slit to a hole: the two runs along it touch all the way."""
        keyhole = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]
        hole = laminae.rectangle((1, 1), density=1.0).translated((1.5, 1.5, 0))
        whole = laminae.rectangle((4, 4), density=1.0).translated((2, 2, 0))
        assert laminae.polygon(keyhole, density=1.0).isclose(whole - hole, rtol=1e-14)

    @pytest.mark.parametrize("corners", [[(0, 0), (1, 1)], [(0, 0), (1, 1), (2, 2)], [(1, 1)] * 5])
    def test_what_bounds_nothing_is_told(self, corners: Any) -> None:
        with pytest.raises(ValueError, match=r"vertices.*(three|area)"):
            laminae.polygon(corners, mass=1.0)

    def test_a_polygon_of_many_corners_is_a_disk(self) -> None:
        angle = np.linspace(0, 2 * np.pi, 20_000, endpoint=False)
        corners = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        body = laminae.polygon(corners, mass=4.0)
        assert body.principal_moments == pytest.approx([1, 1, 2], rel=1e-7)

    def test_stacks(self) -> None:
        corners = np.array([POLYGONS["L"], POLYGONS["L"]], dtype=float) * np.array([[[1.0]], [[2.0]]])
        stack = laminae.polygon(corners, mass=[[1.0], [2.0], [3.0]])
        assert stack.shape == (3, 2)
        assert stack[2, 1] == laminae.polygon(corners[1], mass=3.0)
        assert laminae.triangle(corners[:, :3], mass=1.0).shape == (2,)
        with pytest.raises(ValueError, match=r"vertices.*\(\.\.\., n, 2\), got \(4, 3\)"):
            laminae.polygon(np.ones((4, 3)), mass=1.0)


def polygon_area(corners: Any) -> float:
    (a, b), (c, d), (e, f) = corners
    return float(((c - a) * (f - b) - (e - a) * (d - b)) / 2)


def smallest_moment(second: Any) -> float:
    """The smaller eigenvalue of the exact 2×2 second moment, in fifty digits."""
    from mpmath import mp, mpf, sqrt

    with mp.workdps(60):
        x, y, z = (mpf(s.numerator) / s.denominator for s in (second[0][0], second[0][1], second[1][1]))
        return float((x + z) / 2 - sqrt(((x - z) / 2) ** 2 + y * y))


LAMINAE: dict[str, Callable[..., RigidBody]] = {
    "disk": lambda **k: laminae.disk(1.0, **k),
    "annulus": lambda **k: laminae.annulus(1.0, 2.0, **k),
    "ellipse": lambda **k: laminae.ellipse((1.0, 2.0), **k),
    "rectangle": lambda **k: laminae.rectangle((1.0, 2.0), **k),
    "triangle": lambda **k: laminae.triangle([(0, 0), (1, 0), (0.5, 2)], **k),
    "polygon": lambda **k: laminae.polygon(POLYGONS["L"], **k),
}


class TestArguments:
    @pytest.mark.parametrize("name", LAMINAE)
    def test_exactly_one_of_mass_and_density(self, name: str) -> None:
        for given_both in ({}, {"mass": 1.0, "density": 1.0}):
            with pytest.raises(TypeError, match=r"mass.*density"):
                LAMINAE[name](**given_both)
        by_density = LAMINAE[name](density=2.5)
        assert LAMINAE[name](mass=by_density.mass).isclose(by_density, rtol=1e-15)

    @pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
    def test_lengths_are_named(self, value: float) -> None:
        mistakes: list[tuple[Callable[[], RigidBody], str]] = [
            (lambda: laminae.disk(value, mass=1.0), "radius"),
            (lambda: laminae.annulus(value, 2.0, mass=1.0), "inner_radius"),
            (lambda: laminae.annulus(1.0, value, mass=1.0), "outer_radius"),
            (lambda: laminae.ellipse((1.0, value), mass=1.0), "semi_axes"),
            (lambda: laminae.rectangle((1.0, value), mass=1.0), "size"),
        ]
        for make, name in mistakes:
            with pytest.raises(ValueError, match=name):
                make()

    def test_radii_the_wrong_way_round_are_told(self) -> None:
        with pytest.raises(ValueError, match=r"inner_radius = 2\.0 and outer_radius = 1\.0"):
            laminae.annulus(2.0, 1.0, mass=1.0)

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    def test_corners_are_finite(self, value: float) -> None:
        with pytest.raises(ValueError, match="vertices"):
            laminae.polygon([(0, 0), (1, 0), (0, value)], mass=1.0)
        with pytest.raises(ValueError, match="vertices"):
            laminae.triangle([(0, 0), (1, 0), (0, value)], mass=1.0)
