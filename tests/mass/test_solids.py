"""Homogeneous solids, against integrals over their slices, and their degenerate limits."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles import worst_error
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import box as box_mesh
from polhode import RigidBody, laminae, rods, solids
from scipy.spatial import ConvexHull

lengths = st.floats(1e-3, 1e3)


def slices(
    semi_axes: Callable[[np.ndarray], tuple[Any, Any]], low: float, high: float
) -> tuple[float, np.ndarray, float]:
    """Volume, inertia diagonal about C and height of C of a solid cut in ellipses x²/a² + y²/b² ≤ 1.

    The cuts' areas and second moments are polynomials in z for every solid here, for which this
    Gauss rule is exact.
    """
    nodes, weights = np.polynomial.legendre.leggauss(12)
    z = (high + low) / 2 + (high - low) / 2 * nodes
    a, b = semi_axes(z)
    w = (high - low) / 2 * weights * np.pi * a * b
    volume = float(w.sum())
    height = float(w @ z / volume)
    xx, yy, zz = w @ (a**2 * np.ones_like(z)) / 4, w @ (b**2 * np.ones_like(z)) / 4, w @ (z - height) ** 2
    return volume, np.array([yy + zz, zz + xx, xx + yy]), height


def assert_diagonal(body: RigidBody, mass: float, diagonal: Any, rel: float = 1e-14) -> None:
    assert body.mass == pytest.approx(mass, rel=rel)
    assert not body.center_of_mass.any()
    assert np.diag(body.inertia) == pytest.approx(np.asarray(diagonal), rel=rel)
    assert not (body.inertia - np.diag(np.diag(body.inertia))).any()


def assert_mesh(body: RigidBody, corners: np.ndarray, rounded: bool = False) -> None:
    """The body is the convex hull of these corners, exactly or but for their own rounding."""
    hull = ConvexHull(corners)
    faces = [
        face if np.linalg.det(corners[face] - corners.mean(axis=0)) > 0 else face[::-1]
        for face in hull.simplices
    ]
    exact = polyhedron(corners, faces)
    size = np.abs(corners).max()
    rel = 2e-14 if rounded else 4e-15
    assert worst_error(body.mass, exact.volume) <= rel
    assert worst_error(body.center_of_mass, exact.centroid, scale=size) <= rel
    assert worst_error(body.inertia, exact.inertia) <= rel


class TestClosedForms:
    @given(x=lengths, y=lengths, z=lengths)
    def test_box_is_its_mesh(self, x: float, y: float, z: float) -> None:
        exact = polyhedron(*box_mesh((x, y, z)))
        diagonal = [float(exact.inertia[i][i]) for i in range(3)]
        assert_diagonal(solids.box((x, y, z), density=1.0), float(exact.volume), diagonal)

    @given(side=lengths)
    def test_cube_is_a_box(self, side: float) -> None:
        assert solids.cube(side, mass=2.0) == solids.box((side, side, side), mass=2.0)

    @given(a=lengths, b=lengths, c=lengths)
    def test_ellipsoid(self, a: float, b: float, c: float) -> None:
        def cut(z: np.ndarray) -> tuple[Any, Any]:
            width = np.sqrt(1 - (z / c) ** 2)
            return a * width, b * width

        volume, diagonal, _ = slices(cut, -c, c)
        assert_diagonal(solids.ellipsoid((a, b, c), density=3.0), 3 * volume, 3 * diagonal)

    @given(radius=lengths)
    def test_sphere_is_an_ellipsoid(self, radius: float) -> None:
        sphere, ellipsoid = solids.sphere(radius, mass=5.0), solids.ellipsoid((radius,) * 3, mass=5.0)
        assert_diagonal(sphere, 5.0, np.full(3, 2.0 * radius**2))
        assert bool(sphere.isclose(ellipsoid, rtol=1e-15))

    @given(radius=lengths, height=lengths)
    def test_cylinder(self, radius: float, height: float) -> None:
        volume, diagonal, _ = slices(lambda z: (radius + 0 * z, radius + 0 * z), -height / 2, height / 2)
        assert_diagonal(solids.cylinder(radius, height, density=0.5), volume / 2, diagonal / 2)

    @given(radius=lengths, height=lengths)
    def test_cone(self, radius: float, height: float) -> None:
        """Apex at +3h/4, base at −h/4 from the centre of mass."""

        def cut(z: np.ndarray) -> tuple[Any, Any]:
            r = radius * (0.75 - z / height)
            return r, r

        volume, diagonal, center = slices(cut, -height / 4, 3 * height / 4)
        assert abs(center) < 1e-14 * height
        assert_diagonal(solids.cone(radius, height, density=2.0), 2 * volume, 2 * diagonal)

    @given(inner=st.floats(0, 1), radius=lengths)
    def test_hollow_sphere(self, inner: float, radius: float) -> None:
        """⅖ m (R⁵ − r⁵)/(R³ − r³) in fifty digits, also where the shell is thin."""
        r, R = Fraction(inner * radius), Fraction(radius)
        moment = Fraction(2, 3) * R**2 if r == R else Fraction(2, 5) * (R**5 - r**5) / (R**3 - r**3)
        assert_diagonal(
            solids.hollow_sphere(float(r), radius, mass=3.0), 3.0, [float(3 * moment)] * 3, rel=1e-15
        )
        if r < R:
            mass = float(R**3 - r**3) * 4 / 3 * np.pi
            assert solids.hollow_sphere(float(r), radius, density=1.0).mass == pytest.approx(mass, rel=1e-15)

    @given(inner=st.floats(1e-3, 0.999), radius=lengths, height=lengths)
    def test_tube_is_a_cylinder_without_a_cylinder(self, inner: float, radius: float, height: float) -> None:
        tube = solids.tube(inner * radius, radius, height, density=0.5)

        def disks(r: float) -> Any:
            return slices(lambda z: (r + 0 * z, r + 0 * z), -height / 2, height / 2)

        outer, hole = disks(radius), disks(inner * radius)
        scale = 1 / (1 - inner**2)  # what the difference of the slices loses
        assert_diagonal(tube, (outer[0] - hole[0]) / 2, (outer[1] - hole[1]) / 2, rel=1e-14 * scale)

    @given(bottom=lengths, top=lengths, height=lengths)
    def test_frustum(self, bottom: float, top: float, height: float) -> None:
        def cut(z: np.ndarray) -> tuple[Any, Any]:
            r = bottom + (top - bottom) * z / height
            return r, r

        volume, diagonal, center = slices(cut, 0, height)
        frustum = solids.frustum(bottom, top, height, density=2.0)
        assert_diagonal(frustum, 2 * volume, 2 * diagonal)
        q = bottom**2 + bottom * top + top**2
        assert center == pytest.approx(height * (bottom**2 + 2 * bottom * top + 3 * top**2) / (4 * q))

    @given(radius=lengths, length=lengths)
    def test_capsule(self, radius: float, length: float) -> None:
        def rounded(z: np.ndarray) -> tuple[Any, Any]:
            r = np.sqrt(radius**2 - z**2)
            return r, r

        volume, diagonal, center = slices(rounded, 0, radius)
        middle = slices(lambda z: (radius + 0 * z, radius + 0 * z), -length / 2, length / 2)
        lever = volume * (center + length / 2) ** 2 * np.array([1, 1, 0])
        capsule = solids.capsule(radius, length, density=2.0)
        assert_diagonal(
            capsule, 2 * (2 * volume + middle[0]), 2 * (2 * (diagonal + lever) + middle[1]), rel=2e-14
        )

    @given(major=lengths, share=st.floats(0, 1))
    def test_torus(self, major: float, share: float) -> None:
        """The volume element is r (R + r cos t) in toroidal coordinates: Gauss over r, a sum over t."""
        minor = share * major
        if minor < 1e-6:
            return
        nodes, weights = np.polynomial.legendre.leggauss(8)
        r, w = minor * (nodes + 1) / 2, minor * weights / 2
        t = np.arange(16) * np.pi / 8
        distance = major + r[:, None] * np.cos(t)
        dV = w[:, None] * r[:, None] * distance * (2 * np.pi) ** 2 / 16
        volume, across = dV.sum(), (dV * distance**2).sum() / 2
        along = (dV * (r[:, None] * np.sin(t)) ** 2).sum()
        diagonal = 3 * np.array([across + along, across + along, 2 * across])
        assert_diagonal(solids.torus(major, minor, density=3.0), 3 * volume, diagonal)

    @given(radius=lengths)
    def test_hemisphere(self, radius: float) -> None:
        def cut(z: np.ndarray) -> tuple[Any, Any]:
            r = np.sqrt(radius**2 - (z + 3 * radius / 8) ** 2)
            return r, r

        volume, diagonal, center = slices(cut, -3 * radius / 8, 5 * radius / 8)
        assert abs(center) < 1e-14 * radius
        assert_diagonal(solids.hemisphere(radius, density=2.0), 2 * volume, 2 * diagonal)

    @given(x=lengths, y=lengths, z=lengths)
    def test_wedge_and_pyramid_are_their_meshes(self, x: float, y: float, z: float) -> None:
        size = np.array([x, y, z])
        third = np.array([[-1, -1.5, -1], [2, -1.5, -1], [-1, -1.5, 2]]) / 3
        assert_mesh(solids.wedge(size, density=1.0), np.vstack([third, third * [1, -1, 1]]) * size)
        base = [(a, b, -0.25) for a in (-0.5, 0.5) for b in (-0.5, 0.5)]
        assert_mesh(solids.pyramid(size, density=1.0), np.array([*base, (0, 0, 0.75)]) * size)

    @given(side=lengths)
    def test_tetrahedron(self, side: float) -> None:
        corners = [(0.0, 0.0, 6**0.5 / 4), (3**-0.5, 0.0, -(24**-0.5))]
        corners += [(-(12**-0.5), y, -(24**-0.5)) for y in (-0.5, 0.5)]
        assert_mesh(solids.tetrahedron(side, density=1.0), side * np.array(corners), rounded=True)

    @given(sides=st.integers(3, 12), radius=lengths, height=lengths)
    def test_prism(self, sides: int, radius: float, height: float) -> None:
        angle = np.arange(sides) * 2 * np.pi / sides
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1) * radius
        corners = [(*p, z) for p in ring for z in (-height / 2, height / 2)]
        assert_mesh(solids.prism(sides, radius, height, density=1.0), np.array(corners), rounded=True)

    def test_textbook_numbers(self) -> None:
        assert np.diag(solids.cube(6.0, mass=1.0).inertia).tolist() == [6.0, 6.0, 6.0]
        assert np.diag(solids.box((1.0, 2.0, 3.0), mass=12.0).inertia).tolist() == [13.0, 10.0, 5.0]
        cylinder = solids.cylinder(1.0, 12.0, mass=1000.0)  # the uniform cylinder of NASA's check cases
        assert cylinder.principal_moments == pytest.approx([500, 12250, 12250], rel=1e-15)


class TestDegenerateLimits:
    def test_hollow_without_thickness_is_a_shell(self) -> None:
        shell = solids.hollow_sphere(3.0, 3.0, mass=2.0)
        assert shell.principal_moments.tolist() == [12.0, 12.0, 12.0]
        thin = solids.hollow_sphere(3.0, np.nextafter(3.0, 4.0), mass=2.0)
        assert thin.principal_moments == pytest.approx([12.0] * 3, rel=1e-15)
        assert np.diag(solids.tube(2.0, 2.0, 6.0, mass=1.0).inertia).tolist() == [5.0, 5.0, 4.0]

    def test_hollow_without_cavity_is_solid(self) -> None:
        assert solids.hollow_sphere(0.0, 2.0, density=3.0) == solids.sphere(2.0, density=3.0)
        assert solids.tube(0.0, 2.0, 3.0, density=3.0).isclose(
            solids.cylinder(2.0, 3.0, density=3.0), rtol=1e-15
        )

    def test_capsule_is_a_ball_or_a_rod_at_its_ends(self) -> None:
        assert solids.capsule(2.0, 0.0, mass=5.0) == solids.sphere(2.0, mass=5.0)
        assert solids.capsule(0.0, 2.0, mass=3.0) == rods.rod(2.0, mass=3.0)
        assert not solids.capsule(0.0, 0.0, mass=3.0).inertia.any()

    def test_thin_torus_is_a_ring(self) -> None:
        assert solids.torus(2.0, 0.0, mass=3.0) == rods.ring(2.0, mass=3.0)

    def test_flat_prism_is_a_lamina(self) -> None:
        square = laminae.rectangle((1.0, 1.0), mass=2.0)
        assert solids.prism(4, 0.5**0.5, 0.0, mass=2.0).isclose(square, rtol=1e-15)

    def test_a_frustum_without_width_is_undecided(self) -> None:
        with pytest.raises(ValueError, match=r"bottom_radius or top_radius"):
            solids.frustum(0.0, 0.0, 1.0, mass=1.0)

    def test_a_thin_cylinder_is_a_rod(self) -> None:
        assert solids.cylinder(1e-9, 2.0, mass=3.0).principal_moments == pytest.approx(
            [1.5e-18, 1, 1], rel=1e-15
        )
        rod = solids.cylinder(0.0, 2.0, mass=3.0)
        assert rod.principal_moments.tolist() == [0.0, 1.0, 1.0]
        assert rod.principal.top == "linear"

    def test_a_flat_cylinder_is_a_disk(self) -> None:
        disk = solids.cylinder(2.0, 0.0, mass=1.0)
        assert np.diag(disk.inertia).tolist() == [1.0, 1.0, 2.0]

    def test_a_flat_box_is_a_rectangle_and_a_flat_rectangle_a_rod(self) -> None:
        assert np.diag(solids.box((2.0, 4.0, 0.0), mass=3.0).inertia).tolist() == [4.0, 1.0, 5.0]
        assert np.diag(solids.box((2.0, 0.0, 0.0), mass=3.0).inertia).tolist() == [0.0, 1.0, 1.0]

    def test_a_sphere_of_no_radius_is_a_point(self) -> None:
        assert not solids.sphere(0.0, mass=1.0).inertia.any()

    def test_without_volume_a_density_gives_no_mass(self) -> None:
        flat: list[Callable[[], RigidBody]] = [
            lambda: solids.box((1.0, 1.0, 0.0), density=1.0),
            lambda: solids.sphere(0.0, density=1.0),
            lambda: solids.cylinder(1.0, 0.0, density=1.0),
        ]
        for solid in flat:
            with pytest.raises(ValueError, match=r"(?i)mass|volume|positive"):
                solid()

    @pytest.mark.parametrize("scale", [1e-100, 1e-15, 1e15, 1e100])
    def test_no_scale_is_special(self, scale: float) -> None:
        body = solids.box((scale, 2 * scale, 3 * scale), mass=12.0)
        assert np.diag(body.inertia) / scale / scale == pytest.approx([13.0, 10.0, 5.0], rel=1e-15)


SOLIDS: dict[str, Callable[..., RigidBody]] = {
    "box": lambda **k: solids.box((1.0, 2.0, 3.0), **k),
    "cube": lambda **k: solids.cube(1.0, **k),
    "sphere": lambda **k: solids.sphere(1.0, **k),
    "ellipsoid": lambda **k: solids.ellipsoid((1.0, 2.0, 3.0), **k),
    "cylinder": lambda **k: solids.cylinder(1.0, 2.0, **k),
    "cone": lambda **k: solids.cone(1.0, 2.0, **k),
    "hollow_sphere": lambda **k: solids.hollow_sphere(1.0, 2.0, **k),
    "tube": lambda **k: solids.tube(1.0, 2.0, 3.0, **k),
    "frustum": lambda **k: solids.frustum(2.0, 1.0, 3.0, **k),
    "capsule": lambda **k: solids.capsule(1.0, 2.0, **k),
    "torus": lambda **k: solids.torus(2.0, 1.0, **k),
    "hemisphere": lambda **k: solids.hemisphere(1.0, **k),
    "tetrahedron": lambda **k: solids.tetrahedron(1.0, **k),
    "prism": lambda **k: solids.prism(6, 1.0, 2.0, **k),
    "pyramid": lambda **k: solids.pyramid((1.0, 2.0, 3.0), **k),
    "wedge": lambda **k: solids.wedge((1.0, 2.0, 3.0), **k),
}


class TestArguments:
    @pytest.mark.parametrize("name", SOLIDS)
    def test_exactly_one_of_mass_and_density(self, name: str) -> None:
        for given_both in ({}, {"mass": 1.0, "density": 1.0}):
            with pytest.raises((TypeError, ValueError), match=r"mass.*density|density.*mass"):
                SOLIDS[name](**given_both)

    @pytest.mark.parametrize("name", SOLIDS)
    @pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
    def test_mass_and_density_are_positive_numbers(self, name: str, value: float) -> None:
        for what in ("mass", "density"):
            with pytest.raises(ValueError, match=what):
                SOLIDS[name](**{what: value})

    @pytest.mark.parametrize("name", SOLIDS)
    def test_mass_and_density_agree(self, name: str) -> None:
        by_density = SOLIDS[name](density=2.5)
        assert bool(SOLIDS[name](mass=by_density.mass).isclose(by_density, rtol=1e-15))

    @pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
    def test_lengths_are_named(self, value: float) -> None:
        mistakes: list[tuple[Callable[[], RigidBody], str]] = [
            (lambda: solids.box((1.0, value, 1.0), mass=1.0), "size"),
            (lambda: solids.cube(value, mass=1.0), "side"),
            (lambda: solids.sphere(value, mass=1.0), "radius"),
            (lambda: solids.ellipsoid((1.0, 1.0, value), mass=1.0), "semi_axes|semi-axes"),
            (lambda: solids.cylinder(value, 1.0, mass=1.0), "radius"),
            (lambda: solids.cylinder(1.0, value, mass=1.0), "height"),
            (lambda: solids.cone(1.0, value, mass=1.0), "height"),
            (lambda: solids.hollow_sphere(value, 1.0, mass=1.0), "inner_radius"),
            (lambda: solids.hollow_sphere(1.0, value, mass=1.0), "outer_radius"),
            (lambda: solids.tube(0.0, 1.0, value, mass=1.0), "height"),
            (lambda: solids.frustum(value, 1.0, 1.0, mass=1.0), "bottom_radius"),
            (lambda: solids.frustum(1.0, value, 1.0, mass=1.0), "top_radius"),
            (lambda: solids.capsule(1.0, value, mass=1.0), "length"),
            (lambda: solids.torus(value, 0.0, mass=1.0), "major_radius"),
            (lambda: solids.hemisphere(value, mass=1.0), "radius"),
            (lambda: solids.tetrahedron(value, mass=1.0), "side"),
            (lambda: solids.prism(value, 1.0, 1.0, mass=1.0), "sides"),
            (lambda: solids.prism(2, 1.0, 1.0, mass=1.0), r"sides.*3 or more.*2"),
            (lambda: solids.prism(3.5, 1.0, 1.0, mass=1.0), r"sides.*whole.*3\.5"),
            (lambda: solids.pyramid((1.0, 1.0, value), mass=1.0), "size"),
            (lambda: solids.wedge((1.0, 1.0, value), mass=1.0), "size"),
            (lambda: solids.hollow_sphere(2.0, 1.0, mass=1.0), r"inner_radius = 2\.0.*outer_radius = 1\.0"),
            (lambda: solids.torus(1.0, 2.0, mass=1.0), r"minor_radius.*exceed.*major_radius"),
        ]
        for make, name in mistakes:
            with pytest.raises(ValueError, match=name):
                make()

    def test_arrays_make_stacks(self) -> None:
        radii = np.array([1.0, 2.0, 3.0])
        stack = solids.sphere(radii, mass=1.0)
        assert stack.shape == (3,)
        assert stack[1] == solids.sphere(2.0, mass=1.0)
        assert solids.cylinder(radii[:, None], np.ones(4), density=1.0).shape == (3, 4)
        assert solids.box(np.ones((5, 3)), mass=np.ones((2, 1))).shape == (2, 5)
        assert solids.sphere(1.0, mass=np.ones(0)).shape == (0,)

    def test_lengths_go_by_keyword_and_mass_only_so(self) -> None:
        assert solids.cylinder(radius=1.0, height=2.0, mass=1.0) == solids.cylinder(1.0, 2.0, mass=1.0)
        assert solids.box(size=(1, 2, 3), mass=1) == solids.box((1.0, 2.0, 3.0), mass=1.0)
        with pytest.raises(TypeError):
            solids.sphere(1.0, 1.0)  # type: ignore[call-arg]
        with pytest.raises(ValueError, match=r"size.*shape \(\.\.\., 3\), got \(2,\)"):
            solids.box((1.0, 2.0), mass=1.0)

    def test_the_row_of_a_stack_is_named(self) -> None:
        with pytest.raises(ValueError, match=r"(?=.*radius)(?=.*\b2\b).*-5"):
            solids.sphere([1.0, 2.0, -5.0, 1.0], mass=1.0)
