"""The bound that a body reports is never short, and nothing is refused that float64 can hold.

Random matter of every kind, each source against exact rational arithmetic on the very floats it was given.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
import pytest
import random_matter
from oracles import exact_simplices, rational
from oracles.exact_bodies import Body
from oracles.exact_cells import cells_matter
from oracles.exact_particles import Particles
from oracles.exact_polyhedron import polyhedron
from oracles.exact_shapes import tensor, tetrahedra
from oracles.meshes import box, icosphere, tetrahedron
from polhode import RigidBody, laminae, solids
from polhode.errors import InvalidInertiaError, MeshError, PolhodeError
from scipy.spatial.transform import Rotation

LEAST = Fraction(2) ** -1022
MOST = Fraction(np.finfo(float).max)


def short(body: RigidBody, mass: Any, center: Any, inertia: Any) -> list[str]:
    """What is farther from the truth than the bound says."""
    bound = body.error_bound
    told = [
        ("mass", [body.mass], [mass], bound.mass),
        ("center_of_mass", body.center_of_mass.tolist(), center, bound.center_of_mass),
        ("inertia", body.inertia.ravel().tolist(), [x for row in inertia for x in row], bound.inertia),
    ]
    # A shell of triangles much thinner than a rounding of their corners has no bound: it is infinite.
    return [
        f"{name}: off by {float(worst / max(Fraction(limit), LEAST**2))} of its bound {limit:g}"
        for name, computed, exact, limit in told
        if limit < np.inf
        and (worst := max(abs(Fraction(x) - y) for x, y in zip(computed, exact, strict=True)))
        > Fraction(limit)
    ]


def rightly_refused(error: PolhodeError, mass: Fraction, inertia: Any) -> bool:
    """Whether the mass or the largest moment is outside of what float64 holds with all its digits."""
    largest = max(inertia[k][k] for k in range(3))
    trace = sum(inertia[k][k] for k in range(3)) / 2
    law = "float64 holds 2.2e-308 to 1.8e+308" in str(error)
    return law and (mass < LEAST or mass > MOST or 0 < largest < LEAST or trace > MOST / 2)


def is_of_matter(inertia: Any) -> bool:
    """Whether these exact numbers are the tensor of masses: one whose second moment has no negative value."""
    trace = sum(inertia[k][k] for k in range(3)) / 2
    with mp.workdps(80):
        second = mp.matrix(3, 3)
        for i, j in np.ndindex(3, 3):
            element = ((trace if i == j else 0) - inertia[i][j]) / trace
            second[i, j] = mp.mpf(element.numerator) / element.denominator
        return bool(min(mp.eigsy(second, eigvals_only=True)) >= 0)


def cell_faults(number: int) -> list[str]:
    """What is wrong with the tetrahedral body of this number."""
    nodes, cells, density, at, corners = random_matter.cells(number)
    exact = cells_matter(nodes, cells, corners)
    try:
        body = RigidBody.from_tetrahedra(nodes, cells, density=density, at=at)
    except PolhodeError as error:
        if exact is None:
            return [] if "no mass" in str(error) else [f"{number}: {error}"]
        is_right = rightly_refused(error, exact.mass, exact.inertia)
        return [] if is_right else [f"{number}: refused, {error}"]
    if exact is None:
        return [f"{number}: a body without mass"]
    faults = short(body, exact.mass, exact.center, exact.inertia)
    # A bound that says nothing would never be short.
    size = float(np.abs(nodes).max())
    far = body.error_bound.center_of_mass > 1e-12 * size or body.error_bound.mass > 1e-13 * body.mass
    return [f"{number}: {fault}" for fault in faults + (["idle bound"] if far else [])]


def test_the_fast_oracle_is_the_slow_one() -> None:
    for number in range(20):
        nodes, cells, _, _, corners = random_matter.cells(number)
        exact = cells_matter(nodes, cells, corners)
        if exact is not None:
            assert exact == tetrahedra(nodes, cells, corners)
            assert exact.inertia == tensor(exact.second)


def cloud_faults(number: int) -> list[str]:
    """What is wrong with the particles of this number."""
    masses, positions = random_matter.cloud(number)
    exact = Particles(masses, positions)
    try:
        body = RigidBody.from_particles(masses, positions)
    except PolhodeError as error:
        is_right = rightly_refused(error, exact.mass, exact.inertia)
        return [] if is_right else [f"{number}: refused, {error}"]
    return [f"{number}: {fault}" for fault in short(body, exact.mass, exact.center_of_mass, exact.inertia)]


def grid_faults(number: int) -> list[str]:
    """What is wrong with the voxels of this number."""
    density, spacing, origin = random_matter.grid(number)
    h, at = rational(spacing), rational(origin)
    volume = h[0] * h[1] * h[2]
    filled = np.argwhere(density).tolist()
    places = [[o + e * i for o, e, i in zip(at, h, cell, strict=True)] for cell in filled]
    points = Particles([Fraction(float(density[tuple(c)])) * volume for c in filled], places)
    own = [e * e / 12 for e in h]
    inertia = [
        [x + (points.mass * (sum(own) - own[i]) if i == j else 0) for j, x in enumerate(row)]
        for i, row in enumerate(points.inertia)
    ]
    try:
        body = RigidBody.from_voxels(density, spacing, origin)
    except PolhodeError as error:
        is_right = rightly_refused(error, points.mass, inertia)
        return [] if is_right else [f"{number}: refused, {error}"]
    return [f"{number}: {fault}" for fault in short(body, points.mass, points.center_of_mass, inertia)]


MESHES = [tetrahedron(), box((1.0, 2.0, 3.0)), icosphere(0)]


def mesh_faults(number: int) -> list[str]:
    """What is wrong with the solid of this number; no volume beyond rounding may be refused."""
    rng = random_matter.generator("mesh", number)
    vertices, faces = MESHES[rng.integers(3)]
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    stretch = 10.0 ** (rng.uniform(-8, 0, 3) * rng.integers(0, 2))
    vertices = random_matter.placed(rng, (vertices * stretch) @ (turn * np.linalg.det(turn)), -100, 100)
    rho = float(random_matter.amounts(rng, 1)[0])
    try:
        exact = polyhedron(vertices, faces)
    except ZeroDivisionError:
        with pytest.raises(MeshError):
            RigidBody.from_mesh(vertices, faces, density=rho)
        return []
    try:
        body = RigidBody.from_mesh(vertices, faces, density=rho)
    except PolhodeError as error:
        if "volume" in str(error) or "inside out" in str(error) or "inward" in str(error):
            # Flat but for rounding: less than a few units of it times the area times the distance.
            size, far = np.ptp(vertices, axis=0).max(), np.abs(vertices).max()
            is_flat = float(exact.volume / Fraction(size) ** 2 / Fraction(far + size)) < 1e-13
            return [] if is_flat else [f"{number}: refused, {error}"]
        if "triangle inequality" in str(error):
            # Thin ones far from the origin cross themselves where their corners are rounded.
            return [f"{number}: refused, {error}"] if is_of_matter(exact.inertia) else []
        inertia = [[x * Fraction(rho) for x in row] for row in exact.inertia]
        is_right = rightly_refused(error, exact.volume * Fraction(rho), inertia)
        return [] if is_right else [f"{number}: refused, {error}"]
    inertia = [[x * Fraction(rho) for x in row] for row in exact.inertia]
    return [
        f"{number}: {fault}" for fault in short(body, exact.volume * Fraction(rho), exact.centroid, inertia)
    ]


def fractions(values: Any) -> Any:
    """Numbers of many digits as fractions."""
    if isinstance(values, list):
        return [fractions(x) for x in values]
    sign, mantissa, power, _ = values._mpf_
    return (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** power


def thin_faults(
    number: int, source: str, exact_of: Callable[..., Any], make: Callable[..., RigidBody]
) -> list[str]:
    """What is wrong with the shell or wire of this number."""
    rng = random_matter.generator(source, number)
    points = random_matter.placed(rng, random_matter.shape(rng, int(rng.integers(3, 9))), -100, 100)
    count = len(points)
    faces = np.array([rng.permutation(count)[:3] for _ in range(rng.integers(1, 5))])
    shape = (points, faces) if source == "surface" else (points,)
    rho = float(random_matter.amounts(rng, 1)[0])
    with mp.workdps(400):
        try:
            exact = exact_of(*shape, digits=400)
        except ZeroDivisionError:  # without area or length
            with pytest.raises(PolhodeError, match=r"area|length"):
                make(*shape, rho)
            return []
        mass = Fraction(rho) * fractions(exact.content)
        inertia = [[Fraction(rho) * fractions(x) for x in row] for row in exact.inertia]
        center = fractions(exact.center)
    try:
        body = make(*shape, rho)
    except PolhodeError as error:
        is_right = rightly_refused(error, mass, inertia)
        return [] if is_right else [f"{number}: refused, {error}"]
    return [f"{number}: {fault}" for fault in short(body, mass, center, inertia)]


def surface_faults(number: int) -> list[str]:
    """What is wrong with the shell of this number."""
    return thin_faults(
        number,
        "surface",
        exact_simplices.shell,
        lambda v, f, rho: RigidBody.from_surface(v, f, areal_density=rho),
    )


def curve_faults(number: int) -> list[str]:
    """What is wrong with the wire of this number."""
    return thin_faults(
        number,
        "curve",
        exact_simplices.wire,
        lambda p, rho: RigidBody.from_curve(p, linear_density=rho),
    )


class Pair(NamedTuple):
    """A body and what it is in exact arithmetic on the numbers that it was made of."""

    body: RigidBody
    exact: Body


def any_pairs(rng: np.random.Generator) -> Iterator[Pair]:
    """A tight cluster far away or not, whole, a part of it, and tensors that are as large and as far away."""
    far = 10.0 ** rng.uniform(-3, 9)
    size = far * 2.0**-52 * 10.0 ** rng.uniform(0, 6) if rng.integers(2) else 10.0 ** rng.uniform(-9, 1)
    count = int(rng.integers(1, 6))
    masses = 10.0 ** (rng.uniform(-9, 0) + rng.uniform(-10 * float(rng.integers(2)), 0, count))
    places = far * rng.normal(size=3) * rng.integers(0, 2, 3) + size * rng.normal(size=(count, 3))
    for part in (slice(None), slice(int(rng.integers(1, count + 1))), slice(int(rng.integers(count)), None)):
        exact = Body.from_particles(masses[part], places[part])
        mass = masses[part].sum()
        center = np.array(exact.center, dtype=float)
        match rng.integers(4):
            case 0 | 1:
                yield Pair(RigidBody.from_particles(masses[part], places[part]), exact)
            case 2:
                inertia = np.array(exact.inertia, dtype=float)
                body = RigidBody(mass, inertia, center)
                yield Pair(body, Body.from_tensor(mass, inertia, center))
            case _:
                trace = sum(exact.second[k][k] for k in range(3))
                about = np.array(
                    [[(trace if i == j else 0) - exact.second[i][j] for j in range(3)] for i in range(3)],
                    dtype=float,
                )
                try:
                    body = RigidBody(mass, inertia_about_origin=about, center_of_mass=center)
                except InvalidInertiaError:  # rounded about the origin it is none
                    continue
                yield Pair(body, Body.from_tensor_about_origin(mass, about, center))


def operation_faults(number: int) -> list[str]:
    """What is wrong with the bodies that a few operations make, one after the other."""
    rng = random_matter.generator("operations", number)
    pairs = list(any_pairs(rng))
    faults: list[str] = []
    if not pairs:
        return faults
    a = pairs[0]
    for b in [*pairs[1:], *pairs][: int(rng.integers(1, 4))]:
        d = 10.0 ** rng.uniform(-9, 9) * rng.normal(size=3)
        turn, s, k = Rotation.random(None, rng).as_matrix(), *np.exp(rng.normal(size=2))
        try:
            match rng.integers(8):
                case 0:
                    a = Pair(a.body + b.body, a.exact.plus(b.exact))
                case 1 | 2:
                    a = Pair(a.body - b.body, a.exact.plus(b.exact, -1))
                case 3:
                    whole = Pair(a.body + b.body, a.exact.plus(b.exact))
                    a = Pair(whole.body - b.body, whole.exact.plus(b.exact, -1))
                case 4:
                    a = Pair(a.body.translated(d), a.exact.translated(d))
                case 5:
                    a = Pair(a.body.rotated(turn), a.exact.rotated(turn))
                case 6:
                    a = Pair(a.body.scaled(s, k), a.exact.scaled(s, k))
                case _:
                    bodies, exact = [pair.body for pair in pairs], pairs[0].exact
                    for pair in pairs[1:]:
                        exact = exact.plus(pair.exact)
                    a = Pair(RigidBody.stack(bodies).combined(), exact)
        except InvalidInertiaError:  # nothing is left, to rounding
            break
        if a.exact.mass <= 0:  # what mass is left is rounding, and where it is not known
            if Fraction(a.body.mass) - a.exact.mass > a.body.error_bound.mass:
                faults.append("mass of rounding")
            break
        faults += short(a.body, a.exact.mass, a.exact.center, a.exact.inertia)
    return [f"{number}: {fault}" for fault in faults]


def test_what_a_rounded_center_adds_to_a_difference() -> None:
    """A speck far away: its place is lost in the sum's centre, and so all that is left is in the bound."""
    both = RigidBody.from_particles([1.0, 1e-9], [(1e8, 0.0, 0.0), (1e8 + 1.0, 0.0, 0.0)])
    rest = both - RigidBody(1.0, np.zeros((3, 3)), (1e8, 0.0, 0.0))
    # What is left is a point at 1e8 + 1.
    assert rest.error_bound.inertia >= np.abs(rest.inertia).max() > 0.0
    assert rest.error_bound.center_of_mass >= abs(rest.center_of_mass[0] - 1e8 - 1.0) > 0.0
    # Masses that cancel but for rounding say nothing of where the rest is.
    third = RigidBody.from_principal(0.1, (1.0, 1.0, 1.0)).scaled(mass=1.0 / 3.0)
    least = (third + third.translated((1.0, 0.0, 0.0))) - third.scaled(mass=2.0 - 2.0**-52)
    assert least.error_bound.center_of_mass == np.inf


SOURCES = {
    "operations": (operation_faults, 500, 100_000),
    "tetrahedra": (cell_faults, 800, 100_000),
    "particles": (cloud_faults, 500, 50_000),
    "voxels": (grid_faults, 200, 20_000),
    "mesh": (mesh_faults, 200, 20_000),
    "surface": (surface_faults, 50, 5_000),
    "curve": (curve_faults, 50, 5_000),
}


@pytest.mark.parametrize("source", SOURCES)
def test_no_bound_is_short(source: str) -> None:
    faults, count, _ = SOURCES[source]
    assert [fault for number in range(count) for fault in faults(number)] == []


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("source", SOURCES)
def test_no_bound_is_short_of_many(source: str) -> None:
    faults, few, count = SOURCES[source]
    assert [fault for number in range(few, count) for fault in faults(number)] == []


def plain_bodies(mass: float, length: float) -> Iterator[RigidBody]:
    """Bodies of every kind of sum, in any units."""
    ball = solids.sphere(length, mass=mass)
    box = solids.box((length, 2.0 * length, 3.0 * length), mass=mass).translated((length, 0.0, 0.0))
    corners = np.array([(0, 0), (3, 0), (2, 2), (0, 1)]) * length
    places = np.array([(0, 0, 1), (1, 0, 0), (0, 2, 0)]) * length
    ends = np.array([(-1, 0, 0), (1, 2, 2)]) * length
    yield ball + box
    yield RigidBody.stack([ball, box]).combined()
    yield laminae.polygon(corners, density=mass / length**2)
    yield RigidBody.from_particles(np.array([1.0, 2.0, 3.0]) * mass, places)
    yield RigidBody.from_density(lambda r: np.full(len(r), mass / length**3), ends, rtol=1e-12)


def test_bounds_are_rounding_in_every_unit() -> None:
    """A bound is a small part of what it bounds, the same in any unit that is a power of two."""

    def parts(mass: float, length: float) -> np.ndarray:
        rows = []
        for body in plain_bodies(mass, length):
            bound, spread = body.error_bound, np.trace(body.inertia)
            size = np.sqrt(spread / body.mass)
            rows.append((bound.mass / body.mass, bound.center_of_mass / size, bound.inertia / spread))
        return np.array(rows)

    plain = parts(1.0, 1.0)
    assert plain.max() < 1e-12
    for units in ((2.0**60, 1.0), (2.0**-60, 1.0), (1.0, 2.0**40), (2.0**60, 2.0**-40)):
        assert parts(*units) == pytest.approx(plain, rel=1e-6)
