"""Both ends of float64: what can be held is right, what cannot is refused with the law and the number."""

from __future__ import annotations

import functools
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from oracles.meshes import icosphere
from oracles.motion_cases import unit_floats
from polhode import (
    MassAccumulator,
    RigidBody,
    equimomental,
    laminae,
    loads,
    parallel_axis,
    regions,
    rods,
    solids,
    tops,
)
from polhode.errors import IntegrationError, InvalidInertiaError, PolhodeError

NODES = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
CELL = [(0, 1, 2, 3)]


def test_a_nearly_flat_cell_has_the_volume_that_its_corners_say() -> None:
    """One corner is 2⁻⁵³ beside the plane of the others: the volume is exactly 2⁻⁵⁴/6."""
    up = 2.0**-53
    nodes = [(0.25, 0.25, 0.0), (0.75, 0.75, 0.0), (0.25, 0.25, 1.0), (0.5, 0.5 + up, 0.5)]
    body = RigidBody.from_tetrahedra(nodes, CELL, density=1.0)
    assert body.mass == pytest.approx(2.0**-54 / 6, rel=1e-15)


@pytest.mark.parametrize(("size", "density"), [(1e-80, 1e240), (1e-90, 1e250), (1e90, 1e-280)])
def test_tiny_and_huge_cells_are_the_cell(size: float, density: float) -> None:
    one = RigidBody.from_tetrahedra(NODES, CELL, density=1.0)
    body = RigidBody.from_tetrahedra(size * NODES, CELL, density=density)
    assert body.center_of_mass / size == pytest.approx(one.center_of_mass, rel=1e-15)
    assert body.mass / (density * size * size * size) == pytest.approx(one.mass, rel=1e-14)
    assert body.principal_moments / body.mass / size / size == pytest.approx(
        one.principal_moments / one.mass, rel=1e-14
    )


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: RigidBody.from_tetrahedra(1e-90 * NODES, CELL, density=1.0), "e-452"),
        (lambda: RigidBody.from_tetrahedra(1e90 * NODES, CELL, density=1.0), "e448"),
        (lambda: RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (1e-160, 0, 0)]), r"5\.00e-321"),
        (lambda: RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (1e160, 0, 0)]), r"5\.00e319"),
        (lambda: RigidBody.from_voxels(np.ones((2, 2, 2)), 1e-80), r"5\.33e-400"),
        (lambda: solids.sphere(1e-156, mass=1.0), "e-313"),
        (lambda: RigidBody.from_density(lambda r: np.ones(len(r)), regions.ball(1e-70)), "e-350"),
        (lambda: RigidBody.from_density(lambda r: np.ones(len(r)), regions.ball(1e70)), "e350"),
    ],
)
def test_moments_beyond_the_range_are_refused_with_their_number(make: Any, told: str) -> None:
    with pytest.raises(InvalidInertiaError, match=rf"{told}.*float64 holds 2.2e-308 to 1.8e\+308"):
        make()


def test_particles_between_normal_and_denormal() -> None:
    """Moments of ½ d² for two unit masses: on this side of 2.2e-308 exact, on that side refused."""
    at = 2.0**-510
    pair = RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (at, 0, 0)])
    assert pair.principal_moments.tolist() == [0.0, 2.0**-1021, 2.0**-1021]
    with pytest.raises(InvalidInertiaError, match="largest principal moment"):
        RigidBody.from_particles([1.0, 1.0], [(0, 0, 0), (at / 2, 0, 0)])


def test_denormal_masses_are_exact() -> None:
    least = 5e-324
    pair = RigidBody.from_particles([least, 3 * least], [(0, 0, 0), (2.0**200, 0, 0)])
    assert pair.mass == 4 * least
    assert pair.center_of_mass[0] == 0.75 * 2.0**200
    assert pair.principal_moments[2] == least * (0.75 * 2.0**400)


def test_a_density_of_any_size_over_a_region_of_any_size() -> None:
    one = RigidBody.from_density(lambda r: 1 + r[:, 0] ** 2, regions.box((0, 0, 0), (1, 2, 3)))
    for size, rho in ((2.0**-250, 2.0**900), (2.0**250, 2.0**-1000)):
        box = regions.box((0, 0, 0), (size, 2 * size, 3 * size))

        def density(r: np.ndarray, size: float = size, rho: float = rho) -> Any:
            return rho * (1 + (r[:, 0] / size) ** 2)

        body = RigidBody.from_density(density, box)
        assert body.mass / size / size / size / rho == one.mass
        assert (body.center_of_mass / size).tolist() == one.center_of_mass.tolist()


@pytest.mark.parametrize(
    ("distance", "is_refused"), [(1e-120, False), (1e-121, True), (1e150, False), (1e151, True)]
)
def test_chunks_tell_where_their_sums_may_have_lost_digits(distance: float, is_refused: bool) -> None:
    sums = MassAccumulator()
    sums.add([1.0, 1.0], [(0, 0, 0), (distance, 0, 0)])
    if is_refused:
        with pytest.raises(PolhodeError, match=r"sum of the second moments must be from 1\.5e-241"):
            sums.finish()
    else:
        assert sums.finish().principal_moments[2] / distance / distance == pytest.approx(0.5, rel=1e-15)


@pytest.mark.parametrize("scale", [1e-300, 1e-160, 1e154, 1e200, 1e306])
@pytest.mark.parametrize("moments", [(1, 1, 1), (1, 1, 2), (1, 2, 2.5), (0, 1, 1)])
def test_the_drift_of_a_heavy_bodys_momentum_is_a_number(scale: float, moments: Any) -> None:
    body = RigidBody.from_principal(1.0, scale * np.array(moments, float))
    kept = body.simulate([0.0, 5.0, 10.0], (0.0, 0.2, 0.5)).invariants()
    one = RigidBody.from_principal(1.0, moments).simulate([0.0, 5.0, 10.0], (0.0, 0.2, 0.5)).invariants()
    for name in ("energy_drift", "angular_momentum_drift"):
        assert 0.0 <= getattr(kept, name) <= 1e-9
        assert getattr(one, name) <= 1e-9


def test_radii_of_what_is_very_light_or_heavy() -> None:
    for mass, moment in ((1e-200, 1e200), (1e200, 1e-200)):
        body = RigidBody.from_principal(mass, (moment,) * 3)
        assert body.radii_of_gyration == pytest.approx([moment / 1.0] * 3, rel=1e-14)


def _cart(s: float, m: float) -> RigidBody:
    """A body of mass m and lengths of order s, away from the origin."""
    moments = [x * m * s * s if abs(np.log2(m * s)) < 500 else x * (m * s) * s for x in (1.1, 2.2, 2.7)]
    return RigidBody.from_principal(m, moments, None, (0.3 * s, 0.2 * s, -0.1 * s))


CORNERS = np.array([(0.0, 0.0), (1.0, 0.1), (1.2, 1.0), (0.1, 2.0)])
IN_UNITS: dict[str, Any] = {
    "box": lambda s, m: solids.box((s, 2 * s, 3 * s), mass=m).inertia,
    "wedge": lambda s, m: solids.wedge((s, 2 * s, 3 * s), mass=m).inertia,
    "sphere": lambda s, m: solids.sphere(s, mass=m).inertia,
    "hollow sphere": lambda s, m: solids.hollow_sphere(0.3 * s, s, mass=m).inertia,
    "hemisphere": lambda s, m: solids.hemisphere(s, mass=m).inertia,
    "ellipsoid": lambda s, m: solids.ellipsoid((s, 2 * s, 3 * s), mass=m).inertia,
    "cylinder": lambda s, m: solids.cylinder(s, 2 * s, mass=m).inertia,
    "tube": lambda s, m: solids.tube(0.3 * s, s, 2 * s, mass=m).inertia,
    "cone": lambda s, m: solids.cone(s, 2 * s, mass=m).inertia,
    "frustum": lambda s, m: solids.frustum(s, 0.3 * s, 2 * s, mass=m).inertia,
    "capsule": lambda s, m: solids.capsule(s, 3 * s, mass=m).inertia,
    "torus": lambda s, m: solids.torus(2 * s, 0.3 * s, mass=m).inertia,
    "prism": lambda s, m: solids.prism(6, s, 2 * s, mass=m).inertia,
    "pyramid": lambda s, m: solids.pyramid((s, 2 * s, 3 * s), mass=m).inertia,
    "tetrahedron": lambda s, m: solids.tetrahedron(s, mass=m).inertia,
    "disk": lambda s, m: laminae.disk(s, mass=m).inertia,
    "annulus": lambda s, m: laminae.annulus(0.3 * s, s, mass=m).inertia,
    "rectangle": lambda s, m: laminae.rectangle((s, 2 * s), mass=m).inertia,
    "triangle": lambda s, m: laminae.triangle(s * CORNERS[:3], mass=m).inertia,
    "polygon": lambda s, m: laminae.polygon(s * CORNERS, mass=m).inertia,
    "rod": lambda s, m: rods.rod(s, mass=m).inertia,
    "ring": lambda s, m: rods.ring(s, mass=m).inertia,
    "arc": lambda s, m: rods.arc(s, 1.0, mass=m).inertia,
    "wire": lambda s, m: RigidBody.from_curve(s * np.eye(3), mass=m).inertia,
    "shell": lambda s, m: RigidBody.from_surface(s * np.eye(3), [(0, 1, 2)], mass=m).inertia,
    "particles": lambda s, m: RigidBody.from_particles(m * np.array([1.0, 2.0, 4.0]), s * np.eye(3)).inertia,
    "inertia_about": lambda s, m: _cart(s, m).inertia_about("origin"),
    "moment_about": lambda s, m: _cart(s, m).moment_about((1.0, 2.0, 2.0), (s, 0.0, 0.0)),
    "principal_about": lambda s, m: _cart(s, m).principal_about((s, s, 0.0)).moments,
    "sum": lambda s, m: (_cart(s, m) + _cart(s, m).translated((s, 0, 0))).inertia,
    "parallel_axis": lambda s, m: parallel_axis.from_center_of_mass(_cart(s, m).inertia, m, (s, 2 * s, 0.0)),
    "kinetic energy": lambda s, m: _cart(s, m).kinetic_energy((1, 2, 3), (s, 0.3 * s, 0)).total,
    "energy about O": lambda s, m: _cart(s, m).kinetic_energy((1, 2, 3), (s, 0.3 * s, 0), "origin").total,
    "angular momentum": lambda s, m: (
        _cart(s, m).angular_momentum((1, 2, 3), (0.7 * s, s, 0), (s, 0, 0.3 * s), "origin").total
    ),
}


@pytest.mark.parametrize(("length", "mass"), [(-531, 66), (531, -66), (-400, 700), (300, -600), (-531, 1000)])
@pytest.mark.parametrize("name", IN_UNITS)
def test_powers_of_two_as_units_change_no_digit(name: str, length: int, mass: int) -> None:
    """Whatever m s² is a number, squares and volumes that leave float64 on the way do no harm."""
    quantity = IN_UNITS[name]
    expected = np.ldexp(quantity(1.0, 1.0), mass + 2 * length)
    assert np.array_equal(quantity(2.0**length, 2.0**mass), expected)


@pytest.mark.parametrize(("length", "density"), [(-300, 900), (300, -900), (-500, 1000), (400, -1000)])
def test_densities_of_any_size_in_shapes_of_any_size(length: int, density: int) -> None:
    shapes: list[tuple[int, Any]] = [
        (3, lambda s, d: solids.torus(3.0 * s, s, density=d)),
        (2, lambda s, d: laminae.triangle(s * CORNERS[:3], density=d)),
        (2, lambda s, d: laminae.polygon(s * CORNERS, density=d)),
        (1, lambda s, d: rods.arc(s, 2.0, density=d)),
    ]
    for dimensions, shape in shapes:
        mass = density + dimensions * length
        if abs(mass + 2 * length) > 1010:
            with pytest.raises(InvalidInertiaError, match="float64 holds"):
                shape(2.0**length, 2.0**density)
            continue
        one, other = shape(1.0, 1.0), shape(2.0**length, 2.0**density)
        assert other.mass == np.ldexp(one.mass, mass)
        assert np.array_equal(other.inertia, np.ldexp(one.inertia, mass + 2 * length))
        assert np.array_equal(other.center_of_mass, np.ldexp(one.center_of_mass, length))


@pytest.mark.parametrize("by", ["exact", "taylor", "dop853", "radau", "splitting"])
def test_a_straight_path_out_of_float64_is_told(by: Any) -> None:
    """Without a force nothing integrates the place: it is where the velocity brings it."""
    body = RigidBody.from_principal(1.0, (1.0, 1.2, 1.5))
    free: dict[str, Any] = {} if by == "exact" else {"method": by}
    if by in ("dop853", "radau"):
        free["load"] = loads.torque_callback(lambda *_: (0, 0, 0))
    if by in ("taylor", "splitting"):
        free["load"] = loads.constant_torque((0, 0, 0.1))
    looking: list[dict[str, Any]] = [{}, {"events": lambda t, *_: t - 30.0}]
    for options in looking:
        with pytest.raises(IntegrationError, match="not finite at t") as caught:
            body.simulate([0.0, 1.0, 40.0], (0, 0, 1), velocity=(0, 0, 1.5e308), **free, **options)
        # The closed form is refused at once; the step of splitting that leaves float64 gives no samples.
        if by in ("taylor", "dop853", "radau"):
            assert caught.value.partial is not None
            assert np.isfinite(caught.value.partial.position[1]).all()


@pytest.mark.parametrize("method", ["exact", "taylor", "dop853", "radau", "splitting"])
def test_places_beyond_all_numbers_are_told(method: Any) -> None:
    """A body that flies out of float64 is not somewhere at infinity."""
    body = RigidBody.from_principal(1.0, (1.0, 1.2, 1.5))
    load = None if method == "exact" else loads.uniform_gravity((0.0, 0.0, -1e307))
    fast = (0.0, 0.0, 1.5e308 if method == "exact" else 0.0)
    with pytest.raises(IntegrationError, match=r"float64|finite|cannot go on"):
        body.simulate([0.0, 1.0, 40.0], (0, 0, 1), load=load, velocity=fast, method=method, rtol=1e-6)


@pytest.mark.parametrize("method", ["taylor", "dop853", "radau", "splitting"])
def test_a_point_keeps_its_rate(method: Any) -> None:
    """Nothing has a moment to turn it: as of a rod about itself."""
    body = RigidBody.from_particles([2.0], [(0.0, 0.0, 0.0)])
    load = loads.uniform_gravity((0.0, 0.0, -1.0))
    for end in (-0.1, 4.0):
        run = body.simulate([0.0, end], (0.0, 0.2, 0.4), load=load, method=method)
        assert run.omega[-1] == pytest.approx([0.0, 0.2, 0.4], abs=1e-15)
        half = 0.5 * end * np.hypot(0.2, 0.4)
        assert abs(run.quaternion[-1, 3]) == pytest.approx(abs(np.cos(half)), abs=1e-9)
        assert run.position[-1, 2] == pytest.approx(-0.5 * end**2, rel=1e-9)


def test_events_of_a_body_that_turns_too_fast_end_with_the_limit_of_steps() -> None:
    """A long step of Taylor series is looked through turn by turn: of 1e187 turns there is no end."""
    body = RigidBody.from_principal(1.7, (1.3, 1.3, 2.6))
    load = loads.uniform_gravity((3.0, 3.0, 3.0))
    with pytest.raises(IntegrationError, match="a run takes 1e9 at most"):
        body.simulate(
            [0.0, -1e12], (0.0, 0.0, -5e187), load=load, events=lambda t, *_: t + 2.0, method="taylor"
        )


def test_events_over_thousands_of_turns_are_all_found() -> None:
    """Spin about the axis of symmetry under gravity at C: two passages in each turn."""
    body = RigidBody.from_principal(1.7, (1.3, 1.3, 2.6))
    load = loads.uniform_gravity((0.0, 0.0, -3.0))
    spin, end = 2000.0, 10.0
    run = body.simulate(
        [0.0, end], (0, 0, spin), load=load, events=lambda _t, _w, q, *_: q[2], method="taylor", rtol=1e-12
    )
    assert run.events.t == pytest.approx(np.arange(1, int(spin * end / 2 / np.pi) + 1) * 2 * np.pi / spin)


def test_what_leaves_float64_on_the_way_is_refused() -> None:
    far = RigidBody.from_principal(1.0, (1, 1, 1), center_of_mass=(-1.7e308, -1.7e308, -1.7e308))
    with pytest.raises(PolhodeError, match="center_of_mass must be finite"):
        far.rotated(unit_floats(0.2, 0.5, -0.3, 0.8))
    with pytest.raises(PolhodeError, match="moment of inertia about the axis must be finite"):
        far.moment_about((0, 0, 1), (1e308, 0, 0))


def test_a_body_whose_mass_has_no_parts() -> None:
    least = RigidBody.from_principal(5e-324, (1.0, 1.0, 1.0))
    with pytest.raises(PolhodeError, match="mass of each particle"):
        least.equimomental_particles()
    with pytest.raises(PolhodeError, match="positions must be finite"):
        RigidBody.from_principal(
            1e-307, (0.0, 8e307, 8e307), center_of_mass=(1.79e308, 0, 0)
        ).equimomental_particles()


def test_a_stick_of_lengths_that_differ_by_much() -> None:
    for inertia, a, b, mass in ((1e200, 1e205, 1e-150, 1e160), (1e-200, 1e120, 1e-120, 1.0)):
        masses = equimomental.stick(mass, inertia, a, b).masses
        want = [Fraction(inertia) / Fraction(x) / (Fraction(a) + Fraction(b)) for x in (a, b)]
        assert masses[:2] == pytest.approx([float(x) for x in want], rel=1e-15)


def test_a_light_particle_far_away_keeps_its_share_of_a_chunk() -> None:
    """The sums of a chunk start from its heaviest particle, wherever the first one is."""
    masses = [5e-324, 0.0, 1e100]
    positions = [(-2.6784660491453424e160, 1.3e154, 1.3e154), (-4, 3, -4), (-4, -4, -3)]
    chunks = MassAccumulator()
    chunks.add(masses, positions)
    product = 5e-324 * 2.6784660491453424e160 * 1.3e154
    for body in (chunks.finish(), RigidBody.from_particles(masses, positions)):
        assert body.inertia[0, 1:] == pytest.approx([product, product], rel=1e-13)
        assert body.inertia[0, 0] == pytest.approx(2 * 5e-324 * 1.3e154 * 1.3e154, rel=1e-13)


@pytest.mark.parametrize("thickness", [1e-100, 1e-300, 1e-310, 5e-324])
def test_a_shell_as_thin_as_you_like_keeps_its_digits(thickness: float) -> None:
    vertices, faces = icosphere(1, 1.0)
    thin = RigidBody.from_surface(vertices, faces, density=1e300, thickness=1e-20)
    shell = RigidBody.from_surface(vertices, faces, mass=thin.mass, thickness=thickness)
    assert shell.isclose(thin, rtol=1e-14)
    dense = RigidBody.from_surface(vertices, faces, density=1e300, thickness=thickness)
    assert dense.mass == pytest.approx(
        thin.mass / 1e-20 * thickness, rel=1e-14 if thickness > 1e-308 else 1e-2
    )
    assert dense.isclose(shell.scaled(1.0, dense.mass / shell.mass), rtol=1e-13)


METHODS = ("auto", "taylor", "dop853", "radau", "splitting")


def pivoted_run(body: RigidBody, method: Any) -> Any:
    """A short motion about the origin, under gravity."""
    load = loads.uniform_gravity((0.0, 0.0, -9.0))
    return body.simulate([0.0, 0.1], (0.1, 0.2, 3.0), load=load, about="origin", method=method).omega


@pytest.mark.parametrize("moments", [(2.0, 2.0, 2.0), (1.0, 1.0, 2.0), (1.0, 2.0, 2.5)])
def test_points_too_far_for_a_moment_of_inertia_are_refused(moments: Any) -> None:
    # From d = 1.3e154 on m d² is beyond float64: tops had quaternions of length 0.95, and axes were NaN.
    calls: list[Callable[[RigidBody], Any]] = [
        lambda body: body.inertia_about("origin"),
        lambda body: body.moment_about((1.0, 0.0, 0.0), "origin"),
        lambda body: body.principal_about("origin"),
        lambda body: body.angular_acceleration((1.0, 2.0, 3.0), about="origin"),
        lambda body: body.torque((1.0, 2.0, 3.0), about="origin"),
        lambda body: body.stability(1.0, about="origin"),
    ]
    if moments[0] == moments[1]:
        calls += [
            lambda body: body.heavy_top((0.1, 0.2, 3.0), None, (0.0, 0.0, -9.0)).at([0.0, 0.1]).omega,
            lambda body: tops.free_precession(body, (0.1, 0.2, 3.0), about="origin").axis,
        ]
    calls += [functools.partial(pivoted_run, method=method) for method in METHODS]
    far = RigidBody.from_principal(1.0, moments, center_of_mass=(0.0, 0.0, 1.4e154))
    for call in calls:
        with pytest.raises(PolhodeError, match=r"moment of inertia about .* must be finite, got inf"):
            call(far)
    near = RigidBody.from_principal(1.0, moments, center_of_mass=(0.0, 0.0, 1.2e154))
    for call in calls[:6]:
        call(near)
