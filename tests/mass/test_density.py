"""Bodies of given density: adaptive cubature whose reported error holds, on a listed suite.

Polynomials, Gaussians and shells over boxes, balls, ellipsoids, cylinders and meshes, against closed forms
and one-dimensional integrals in forty digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from mpmath import mp, mpf
from oracles import worst_error
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import icosphere, tetrahedron
from polhode import RigidBody, regions, solids
from polhode.errors import InvalidInertiaError, MeshError, PolhodeError, QuadratureError

mp.dps = 40

Field = Callable[[np.ndarray], np.ndarray]


class Case(NamedTuple):
    """A density over a region, with the exact mass, centre and diagonal second moments about the centre."""

    density: Field
    bounds: Any
    mass: float
    center: tuple[float, float, float]
    second: tuple[float, float, float]


def product(low: Any, high: Any, factors: list[Callable[[Any], Any]], density: Field) -> Case:
    """A density that is a product of functions of x, of y and of z, over a box."""
    moments = []
    for a, b, f in zip(low, high, factors, strict=True):
        cuts = [a + (b - a) * mpf(k) / 16 for k in range(17)]
        m, s, q = (mp.quad(lambda x, n=n, f=f: x**n * f(x), cuts) for n in range(3))
        moments.append((m, s / m, q / m - (s / m) ** 2))
    mass = moments[0][0] * moments[1][0] * moments[2][0]
    x, y, z = (float(c) for _, c, _ in moments)
    xx, yy, zz = (float(mass * v) for _, _, v in moments)
    return Case(density, (low, high), float(mass), (x, y, z), (xx, yy, zz))


def radial(
    f: Callable[[Any], Any], inner: float, outer: float, density: Field, center: Any = (0, 0, 0)
) -> Case:
    """A density of the radius alone over a ball or a hollow ball."""
    cuts = [mpf(inner) + (mpf(outer) - mpf(inner)) * k / 32 for k in range(33)]
    mass = 4 * mp.pi * mp.quad(lambda r: f(r) * r**2, cuts)
    second = float(4 * mp.pi / 3 * mp.quad(lambda r: f(r) * r**4, cuts))
    ball = regions.ball(outer, center, inner_radius=inner)
    return Case(density, ball, float(mass), center, (second,) * 3)


def gaussian_box(width: float, at: tuple[float, float, float]) -> Case:
    def factor(c: float) -> Callable[[Any], Any]:
        return lambda x: mp.exp(-(((x - mpf(c)) / mpf(width)) ** 2) / 2)

    return product(
        (-1.0, -1.0, -1.0),
        (1.0, 1.0, 1.0),
        [factor(c) for c in at],
        lambda r: np.exp(-(((r - at) / width) ** 2).sum(axis=1) / 2),
    )


def norm(r: np.ndarray) -> Any:
    return np.sqrt((r**2).sum(axis=1))


def shell(radius: float, width: float, inner: float, outer: float, center: Any = (0.0, 0.0, 0.0)) -> Case:
    return radial(
        lambda r: mp.exp(-(((r - mpf(radius)) / mpf(width)) ** 2)),
        inner,
        outer,
        lambda r: np.exp(-(((norm(r - center) - radius) / width) ** 2)),
        center,
    )


ELLIPSOID = math.pi * 4 / 3 * 1 * 2 * 3
CYLINDER = math.pi * 4 * 3
SUITE: dict[str, Callable[[], Case]] = {
    "constant in a box": lambda: product((0, 0, 0), (1, 2, 3), [lambda _: 1] * 3, lambda r: np.ones(len(r))),
    "x² y z³ in a box": lambda: product(
        (0, 0, 0),
        (1, 2, 3),
        [lambda x: x**2, lambda y: y, lambda z: z**3],
        lambda r: r[:, 0] ** 2 * r[:, 1] * r[:, 2] ** 3,
    ),
    "x^20 in a box": lambda: product(
        (-1, -1, -1), (1, 1, 1), [lambda x: x**20, lambda _: 1, lambda _: 1], lambda r: r[:, 0] ** 20
    ),
    "exp x in a box far away": lambda: product(
        (1e6, -1, 0),
        (1e6 + 2, 1, 1),
        [lambda x: mp.exp(x - 1000001), lambda _: 1, lambda _: 1],
        lambda r: np.exp(r[:, 0] - 1000001),
    ),
    "Gaussian 0.5": lambda: gaussian_box(0.5, (0, 0, 0)),
    "Gaussian 0.1 off centre": lambda: gaussian_box(0.1, (0.3, -0.2, 0.55)),
    "Gaussian 0.02 off centre": lambda: gaussian_box(0.02, (0.31, -0.22, 0.57)),
    "Gaussian cut by a face": lambda: gaussian_box(0.1, (0.0, 0.0, 0.98)),
    "sine squared": lambda: product(
        (0, 0, 0),
        (1, 1, 1),
        [lambda x: mp.sin(20 * x) ** 2, lambda _: 1, lambda _: 1],
        lambda r: np.sin(20 * r[:, 0]) ** 2,
    ),
    "square root at a face": lambda: product(
        (0, 0, 0), (1, 1, 1), [mp.sqrt, lambda _: 1, lambda _: 1], lambda r: np.sqrt(r[:, 0])
    ),
    "1 − r² in a ball": lambda: radial(lambda r: 1 - r**2, 0, 1, lambda r: 1 - norm(r) ** 2),
    "Gaussian in a ball": lambda: radial(
        lambda r: mp.exp(-(r**2) * 50), 0, 1, lambda r: np.exp(-50 * norm(r) ** 2)
    ),
    "1/r in a ball": lambda: radial(lambda r: 1 / r, 0, 2, lambda r: 1 / norm(r)),
    "cusp in a ball": lambda: radial(lambda r: mp.exp(-5 * r), 0, 3, lambda r: np.exp(-5 * norm(r))),
    "shell 0.05": lambda: shell(0.7, 0.05, 0, 1),
    "shell 0.005": lambda: shell(0.7, 0.005, 0, 1),
    "shell far away": lambda: shell(0.7, 0.02, 0.5, 1, (1e3, -2e3, 5.0)),
    "hollow ball": lambda: radial(lambda r: r**3, 0.9, 1, lambda r: norm(r) ** 3),
    "x² in an ellipsoid": lambda: Case(
        lambda r: r[:, 0] ** 2,
        regions.ellipsoid((1.0, 2.0, 3.0)),
        ELLIPSOID / 5,
        (0, 0, 0),
        (ELLIPSOID * 3 / 35, ELLIPSOID * 4 / 35, ELLIPSOID * 9 / 35),
    ),
    "x² + z² in a cylinder": lambda: Case(  # R = 2, h = 3
        lambda r: r[:, 0] ** 2 + r[:, 2] ** 2,
        regions.cylinder(2.0, 3.0),
        CYLINDER * (1 + 0.75),
        (0, 0, 0),
        (CYLINDER * (2 + 0.75), CYLINDER * (2 / 3 + 0.75), CYLINDER * (0.75 + 81 / 80)),
    ),
}


def check(case: Case, body: RigidBody, rtol: float) -> None:
    """The true error is within the tolerance asked for, and within the bound that the body reports."""
    second = np.array(case.second)
    width = math.sqrt(second.sum() / case.mass)
    inertia = second.sum() * np.eye(3) - np.diag(second)
    errors = (
        abs(body.mass - case.mass),
        np.abs(body.center_of_mass - case.center).max(),
        np.abs(body.inertia - inertia).max(),
    )
    floor = 4e-16 * max(1.0, np.abs(case.center).max() / width)  # what the oracle's own rounding is worth
    allowed = (rtol * case.mass, rtol * width, 2 * rtol * second.sum())
    for error, limit, size in zip(errors, allowed, (case.mass, width, second.sum()), strict=True):
        assert error <= limit + floor * size
    reported = body.error_bound
    bounds = (reported.mass, reported.center_of_mass, reported.inertia)
    for error, limit, size in zip(errors, bounds, (case.mass, width, second.sum()), strict=True):
        assert error <= limit + floor * size


class TestSuite:
    @pytest.mark.parametrize(
        ("name", "rtol"),
        [
            pytest.param(name, rtol, marks=[pytest.mark.long] * ((at + turn) % 3 > 0))
            for at, name in enumerate(SUITE)
            for turn, rtol in enumerate([1e-4, 1e-9, 1e-12])
        ],
    )
    def test_the_error_is_within_what_is_reported(self, name: str, rtol: float) -> None:
        case = SUITE[name]()
        check(case, RigidBody.from_density(case.density, case.bounds, rtol=rtol), rtol)

    def test_over_the_corner_tetrahedron(self) -> None:
        """ρ = x + 2: ∫x^a y^b z^c = a! b! c!/(a + b + c + 3)!."""
        inside = regions.mesh(*tetrahedron())
        body = RigidBody.from_density(lambda r: r[:, 0] + 2, inside)
        assert body.mass == pytest.approx(1 / 24 + 2 / 6, rel=1e-14)
        linear = RigidBody.from_tetrahedra(tetrahedron()[0], [(0, 1, 2, 3)], density=[2, 3, 2, 2])
        assert body.isclose(linear, rtol=1e-13)

    def test_over_a_mesh_a_constant_is_the_solid(self) -> None:
        vertices, faces = icosphere(2, 1.0)
        exact = polyhedron(vertices + 5, faces)
        body = RigidBody.from_density(lambda r: np.full(len(r), 3.0), regions.mesh(vertices + 5, faces))
        assert worst_error(body.mass / 3, exact.volume) <= 1e-14
        assert worst_error(body.center_of_mass, exact.centroid) <= 1e-14
        assert worst_error(body.inertia / 3, exact.inertia) <= 1e-13

    @pytest.mark.parametrize("distance", [10.0, 1e6, 1e12])
    def test_over_a_mesh_of_two_parts(self, distance: float) -> None:
        """However far apart they are, each part keeps its digits: nothing of one cancels in the other."""
        one, faces = icosphere(1, 1.0)
        other = 0.25 * one + [distance, 0, 0]
        vertices, both = np.vstack([one, other]), np.vstack([faces, faces + len(one)])
        body = RigidBody.from_density(lambda r: np.full(len(r), 2.0), regions.mesh(vertices, both))
        exact = polyhedron(vertices, both)
        assert worst_error(body.mass / 2, exact.volume) <= 1e-13
        assert worst_error(body.inertia[0, 0] / 2, exact.inertia[0][0]) <= 1e-12
        assert worst_error(body.inertia[1, 1] / 2, exact.inertia[1][1]) <= 1e-13
        assert body.error_bound.inertia <= 1e-10 * body.principal_moments[2]

    def test_surfaces_that_cross_are_no_matter(self) -> None:
        """A ball less a needle that reaches out of it, dense out there: no masses have such moments."""
        one, faces = icosphere(1, 1.0)
        needle = one * [1.5, 0.2, 0.2]
        crossing = regions.mesh(np.vstack([one, needle]), np.vstack([faces, faces[:, ::-1] + len(one)]))
        few = RigidBody.from_density(lambda r: 1 + 0.05 * r[:, 0] ** 16, crossing, rtol=1e-6)
        assert (few.principal_moments > 0).all()
        with pytest.raises(InvalidInertiaError, match="triangle inequality"):
            RigidBody.from_density(lambda r: 1 + 2.0 * r[:, 0] ** 16, crossing, rtol=1e-6)

    def test_over_a_mesh_that_is_not_convex(self) -> None:
        """An L-shaped bar: two boxes, one of them shortened."""
        outline = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
        vertices = np.array([(*p, z) for z in (0.0, 1.0) for p in outline])
        caps = [(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 5, 4)]
        faces = caps + [(c + 6, b + 6, a + 6) for a, b, c in caps]
        for i in range(6):
            j = (i + 1) % 6
            faces += [(i, j, j + 6), (i, j + 6, i + 6)]

        def density(r: np.ndarray) -> Any:
            return np.exp(-r[:, 0]) * (1 + r[:, 1])

        body = RigidBody.from_density(density, regions.mesh(vertices, faces))
        foot = RigidBody.from_density(density, [(0, 0, 0), (3, 1, 1)])
        leg = RigidBody.from_density(density, [(0, 1, 0), (1, 3, 1)])
        assert body.isclose(foot + leg, rtol=3e-9)


class TestRadial:
    def test_polytrope_of_index_one(self) -> None:
        """ρ = sin(πr)/(πr): I/(m R²) = ⅔ (1 − 6/π²), as of the textbooks on stars."""
        star = RigidBody.from_radial_density(lambda r: np.sinc(r), 1.0)
        assert star.mass == pytest.approx(4 / np.pi, rel=1e-13)
        assert star.principal_moments / star.mass == pytest.approx(
            [2 / 3 * (1 - 6 / np.pi**2)] * 3, rel=1e-13
        )

    def test_layers_are_concentric_shells(self) -> None:
        earth = [(0.0, 1221.5, 13.0), (1221.5, 3480.0, 11.0), (3480.0, 5701.0, 5.0), (5701.0, 6371.0, 3.4)]
        edges = [0.0, *(outer for _, outer, _ in earth)]
        densities = np.array([rho for _, _, rho in earth])
        planet = RigidBody.from_radial_density(lambda r: densities[np.searchsorted(edges[1:-1], r)], edges)
        shells = sum(solids.hollow_sphere(a, b, density=rho) for a, b, rho in earth)
        assert isinstance(shells, RigidBody)
        assert planet.isclose(shells, rtol=1e-14)

    def test_a_cavity(self) -> None:
        body = RigidBody.from_radial_density(np.ones_like, [1.0, 2.0])
        assert body.isclose(solids.hollow_sphere(1.0, 2.0, density=1.0), rtol=1e-14)

    @pytest.mark.parametrize("name", ["shell 0.05", "shell 0.005", "1/r in a ball", "cusp in a ball"])
    def test_it_is_the_density_over_the_ball(self, name: str) -> None:
        case = SUITE[name]()
        outer = {"1/r in a ball": 2.0, "cusp in a ball": 3.0}.get(name, 1.0)

        def of_radius(r: np.ndarray) -> np.ndarray:
            return case.density(np.stack([r, 0 * r, 0 * r], axis=-1))

        check(case, RigidBody.from_radial_density(of_radius, outer, rtol=1e-11), 1e-11)

    @pytest.mark.parametrize(
        "radii", [[0.0, 2.0, 1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, np.nan], 0.0, [1.0], [[1.0, 2.0]]]
    )
    def test_radii_ascend(self, radii: Any) -> None:
        with pytest.raises(ValueError, match="radi"):
            RigidBody.from_radial_density(np.ones_like, radii)


class TestFailure:
    def test_a_jump_inside_is_told_with_the_estimate(self) -> None:
        """A ball in a box: the boundary that should have been given is missing."""
        with pytest.raises(QuadratureError, match=r"jump.*boundary.*max_evaluations") as caught:
            RigidBody.from_density(
                lambda r: (norm(r) < 0.8).astype(float),
                [(-1, -1, -1), (1, 1, 1)],
                rtol=1e-9,
                max_evaluations=1_000_000,
            )
        fault = caught.value
        assert fault.evaluations <= 1_000_000
        true = 4 / 3 * math.pi * 0.8**3
        assert abs(fault.estimate.mass - true) <= fault.error * true
        assert fault.error > 1e-9

    def test_as_a_boundary_it_is_none(self) -> None:
        body = RigidBody.from_density(lambda r: np.ones(len(r)), regions.ball(0.8))
        assert body.isclose(solids.sphere(0.8, density=1.0), rtol=1e-13)

    @pytest.mark.parametrize(("value", "told"), [(-1.0, r"-1\.0"), (np.nan, "NaN"), (np.inf, "inf")])
    def test_a_density_that_is_none_is_told_where(self, value: float, told: str) -> None:
        with pytest.raises(PolhodeError, match=rf"density must be zero or more.*at \(.*\) it is {told}"):
            RigidBody.from_density(lambda r: np.where(r[:, 0] > 0.5, value, 1.0), [(0, 0, 0), (1, 1, 1)])

    def test_a_density_of_nothing(self) -> None:
        with pytest.raises(PolhodeError, match=r"density gives no mass.*bounds"):
            RigidBody.from_density(lambda r: np.zeros(len(r)), [(0, 0, 0), (1, 1, 1)])

    def test_the_functions_own_exception_comes_back(self) -> None:
        class OwnError(Exception):
            pass

        def density(_: np.ndarray) -> np.ndarray:
            raise OwnError("mine")

        with pytest.raises(OwnError, match="mine"):
            RigidBody.from_density(density, regions.ball(1.0))

    @pytest.mark.parametrize("answer", [1.0, np.ones(3), np.ones((2, 2))])
    def test_one_number_for_each_point(self, answer: Any) -> None:
        with pytest.raises(ValueError, match=r"density: expected it to return shape \(\d+,\)"):
            RigidBody.from_density(lambda _: answer, regions.ball(1.0))

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"rtol": 0.0}, "rtol"),
            ({"rtol": 1.0}, "rtol"),
            ({"rtol": np.nan}, "rtol"),
            ({"max_evaluations": 10}, r"max_evaluations must be at least 27000.*got 10"),
            ({"bounds": [(0, 0, 0), (1, 1, 0)]}, r"low must be below high"),
            ({"bounds": [(0, 0, 0)]}, r"bounds: expected a region or two corners"),
            ({"bounds": [(0, 0), (1, 1)]}, r"bounds"),
        ],
    )
    def test_wrong_options_are_named(self, options: dict[str, Any], message: str) -> None:
        arguments: dict[str, Any] = {"bounds": [(0, 0, 0), (1, 1, 1)]} | options
        with pytest.raises(ValueError, match=message):
            RigidBody.from_density(lambda r: np.ones(len(r)), **arguments)

    def test_a_number_is_no_function(self) -> None:
        number: Any = 1.0
        with pytest.raises(TypeError, match=r"density: expected a function.*float"):
            RigidBody.from_density(number, regions.ball(1.0))


class TestRegions:
    @pytest.mark.parametrize(
        ("make", "message"),
        [
            (lambda: regions.ball(0.0), "inner_radius must be below radius"),
            (lambda: regions.ball(-1.0), "radius"),
            (lambda: regions.ball(1.0, inner_radius=2.0), "inner_radius = 2"),
            (lambda: regions.ball(1.0, (0, 0, np.nan)), "center"),
            (lambda: regions.ball(1.0, [(0, 0, 0)]), r"center: expected shape \(3,\), got \(1, 3\)"),
            (lambda: regions.ellipsoid((1, 0, 1)), "semi_axes must be positive"),
            (lambda: regions.cylinder(1.0, 0.0), "height must be positive"),
            (lambda: regions.cylinder(np.inf, 1.0), "radius"),
            (lambda: regions.box((0, 0, 0), (1, np.nan, 1)), "high"),
        ],
    )
    def test_what_bounds_no_volume_is_told(self, make: Callable[[], object], message: str) -> None:
        with pytest.raises(ValueError, match=message):
            make()

    def test_an_open_mesh_is_told(self) -> None:
        vertices, faces = tetrahedron()
        with pytest.raises(MeshError, match="not closed"):
            regions.mesh(vertices, faces[:3])

    @pytest.mark.parametrize(
        ("bounds", "solid"),
        [
            (regions.box((-0.5, -1, -1.5), (0.5, 1, 1.5)), solids.box((1, 2, 3), density=1.0)),
            (regions.ball(2.0), solids.sphere(2.0, density=1.0)),
            (regions.ball(2.0, inner_radius=1.9), solids.hollow_sphere(1.9, 2.0, density=1.0)),
            (regions.ellipsoid((1, 2, 3)), solids.ellipsoid((1, 2, 3), density=1.0)),
            (regions.cylinder(2.0, 3.0), solids.cylinder(2.0, 3.0, density=1.0)),
            (regions.cylinder(2.0, 3.0, inner_radius=1.0), solids.tube(1.0, 2.0, 3.0, density=1.0)),
        ],
    )
    def test_a_constant_over_a_region_is_the_solid(self, bounds: Any, solid: RigidBody) -> None:
        assert RigidBody.from_density(lambda r: np.ones(len(r)), bounds).isclose(solid, rtol=1e-13)


# Bodies of two materials: a jump anywhere in the region is noticed, and the reported bound holds.

Inside = Callable[[np.ndarray], Any]


class Part(NamedTuple):
    """A uniform part of density one: where it is, its volume, centre and second moment about its centre."""

    inside: Inside
    volume: float
    center: np.ndarray
    second: np.ndarray


def brick(low: np.ndarray, high: np.ndarray) -> Part:
    def inside(r: np.ndarray) -> Any:
        return ((r >= low) & (r < high)).all(axis=1)

    size = high - low
    volume = float(size.prod())
    return Part(inside, volume, (low + high) / 2, volume * np.diag(size**2) / 12)


def ball(center: np.ndarray, radius: float) -> Part:
    volume = 4 / 3 * math.pi * radius**3
    return Part(
        lambda r: ((r - center) ** 2).sum(axis=1) < radius**2,
        volume,
        center,
        volume * radius**2 / 5 * np.eye(3),
    )


def drum(center: np.ndarray, radius: float, height: float) -> Part:
    """A cylinder along z."""
    volume = math.pi * radius**2 * height
    second = volume * np.diag([radius**2 / 4, radius**2 / 4, height**2 / 12])

    def inside(r: np.ndarray) -> Any:
        d = r - center
        return (d[:, 0] ** 2 + d[:, 1] ** 2 < radius**2) & (np.abs(d[:, 2]) < height / 2)

    return Part(inside, volume, center, second)


class Body(NamedTuple):
    """Parts that lie in each other or beside each other, with densities that add up."""

    region: Any
    parts: list[tuple[float, Part]]

    def density(self, r: np.ndarray) -> np.ndarray:
        return sum((rho * part.inside(r) for rho, part in self.parts), np.zeros(len(r)))

    def exact(self) -> tuple[float, Any, Any]:
        mass = math.fsum(rho * part.volume for rho, part in self.parts)
        center = sum(rho * part.volume * part.center for rho, part in self.parts) / mass
        second = np.zeros((3, 3))
        for rho, part in self.parts:
            d = part.center - center
            second = second + rho * (part.second + part.volume * np.outer(d, d))
        return mass, center, second.trace() * np.eye(3) - second


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """A place in an interval: anywhere, or close to an end, the middle or a quarter of it."""
    near = (0.0, 1.0, 0.5, 0.25, 0.75)
    place = rng.uniform()
    if rng.integers(2):
        place = near[rng.integers(5)] + rng.choice([-1, 1]) * 10 ** rng.uniform(-6, -1)
    return low + (high - low) * min(max(place, 1e-6), 1 - 1e-6)


def body(number: int) -> Body:
    """The two-material body of this number."""
    rng = np.random.default_rng([20261122, number])
    base, extra = rng.uniform(0, 2), rng.uniform(0.2, 5)
    low = rng.uniform(-2, 0, 3)
    high = low + rng.uniform(0.5, 2, 3)
    whole = brick(low, high)
    box = regions.box(low, high)
    match rng.integers(6):
        case 0:  # a plane across the box
            end, axis = high.copy(), rng.integers(3)
            end[axis] = between(rng, low[axis], high[axis])
            part = brick(low, end)
        case 1:  # a box in the box
            ends = np.array(
                [np.sort([between(rng, a, b) for _ in "ab"]) for a, b in zip(low, high, strict=True)]
            )
            ends[:, 1] = np.maximum(ends[:, 1], ends[:, 0] + 0.15 * (high - low))
            ends[:, 0] -= np.maximum(ends[:, 1] - high, 0)
            part = brick(ends[:, 0], np.minimum(ends[:, 1], high))
        case 2:  # a ball in the box
            radius = rng.uniform(0.3, 0.9) * (high - low).min() / 2
            part = ball(rng.uniform(low + radius, high - radius), radius)
        case 3:  # a layer of a ball, about its centre
            center, radius = rng.normal(size=3), rng.uniform(0.5, 2)
            whole, box = ball(center, radius), regions.ball(radius, center)
            part = ball(center, between(rng, 0.05 * radius, radius))
        case 4:  # a ball in a ball
            radius = rng.uniform(0.5, 2)
            whole, box = ball(np.zeros(3), radius), regions.ball(radius)
            inner = radius * rng.uniform(0.3, 0.7)
            direction = rng.normal(size=3)
            part = ball(direction / np.linalg.norm(direction) * rng.uniform() * (radius - inner), inner)
        case _:  # a core or a floor of a cylinder
            radius, height = rng.uniform(0.5, 2, 2)
            whole, box = drum(np.zeros(3), radius, height), regions.cylinder(radius, height)
            if rng.integers(2):
                part = drum(np.zeros(3), between(rng, 0.05 * radius, radius), height)
            else:
                depth = between(rng, 0.0, height)
                part = drum(np.array([0, 0, (depth - height) / 2]), radius, depth)
    return Body(box, [(base, whole._replace(inside=lambda r: np.ones(len(r), bool))), (extra, part)])


def faults(number: int) -> list[str]:
    """What is farther from the truth than its bound; of what did not converge, of the estimate."""
    case = body(number)
    rtol = [1e-3, 1e-5, 1e-7, 1e-9][number % 4]
    try:
        found = RigidBody.from_density(case.density, case.region, rtol=rtol, max_evaluations=200_000)
    except QuadratureError as fault:
        if fault.error <= rtol:
            return [f"{number}: refused at {fault.error}"]
        found = fault.estimate
    mass, center, inertia = case.exact()
    width = math.sqrt(inertia.trace() / 2 / mass)
    reported = found.error_bound
    pairs = [
        ("mass", abs(found.mass - mass), reported.mass, mass),
        ("center", np.abs(found.center_of_mass - center).max(), reported.center_of_mass, width),
        ("inertia", np.abs(found.inertia - inertia).max(), reported.inertia, inertia.trace()),
    ]
    return [
        f"{number}: {name} off by {error / size:.2e}, bound {limit / size:.2e}, rtol {rtol:g}"
        for name, error, limit, size in pairs
        if error > limit + 4e-15 * size
    ]


@pytest.mark.parametrize("start", range(0, 120, 30))
def test_the_bound_holds(start: int) -> None:
    assert [fault for number in range(start, start + 30) for fault in faults(number)] == []


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_the_bound_holds_of_many() -> None:
    assert [fault for number in range(120, 5000) for fault in faults(number)] == []


@pytest.mark.parametrize("place", [0.5, 0.500_01, 0.499, 0.123_456, 0.9999, 1e-5])
def test_a_plane_across_a_box_converges(place: float) -> None:
    cut = brick(np.zeros(3), np.array([place, 1.0, 1.0]))
    whole = brick(np.zeros(3), np.ones(3))
    case = Body(regions.box((0, 0, 0), (1, 1, 1)), [(1.0, whole), (7.0, cut)])
    found = RigidBody.from_density(case.density, case.region, rtol=1e-9)
    mass, center, inertia = case.exact()
    assert found.mass == pytest.approx(mass, rel=1e-9)
    assert found.center_of_mass == pytest.approx(center, abs=1e-9)
    assert np.abs(found.inertia - inertia).max() <= 2e-9 * inertia.trace()
