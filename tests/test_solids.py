"""Homogeneous solids, against integrals over their slices, and their degenerate limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import box as box_mesh
from polhode import RigidBody, solids

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

    def test_textbook_numbers(self) -> None:
        assert np.diag(solids.cube(6.0, mass=1.0).inertia).tolist() == [6.0, 6.0, 6.0]
        assert np.diag(solids.box((1.0, 2.0, 3.0), mass=12.0).inertia).tolist() == [13.0, 10.0, 5.0]
        cylinder = solids.cylinder(1.0, 12.0, mass=1000.0)  # the uniform cylinder of NASA's check cases
        assert cylinder.principal_moments == pytest.approx([500, 12250, 12250], rel=1e-15)


class TestDegenerateLimits:
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
