"""Plates in light and air: closed forms, sums in NumPy, motions by SciPy, and what is refused."""

from __future__ import annotations

import itertools
import pickle
from types import SimpleNamespace
from typing import Any, TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles import meshes
from polhode import RigidBody, loads
from polhode.errors import MeshError, PolhodeError
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

Floats: TypeAlias = NDArray[np.float64]

REST: Any = (0.0, (0, 0, 0), (0, 0, 0, 1))
BODY = RigidBody.from_principal(3.0, (1.0, 2.0, 2.5), center_of_mass=(0.1, -0.2, 0.3))
PLAIN = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5))
SUN = np.array([0.36, 0.48, 0.8])
PLATE: Any = ([(0.7, 0.2, -0.4)], [1.5], [(0.2, 0.1, 1.0)])
SHARES = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.3, 0.5)]
SQUARE: Any = ([(0, 0, 0)], [2.0], [(0, 0, 1)])


def lit(surface: Any, shares: Any, sun: Any = SUN, pressure: Any = 1.0, **options: Any) -> Any:
    """Make plates in light."""
    return loads.panels(surface, coefficients=shares, direction=sun, pressure=pressure, **options)


def flown(surface: Any, drag: Any, velocity: Any, density: Any = 1.0, **options: Any) -> Any:
    """Make plates in air."""
    return loads.panels(surface, "drag", coefficients=drag, density=density, velocity=velocity, **options)


def exerted(load: Any, state: Any = REST, body: Any = PLAIN, **options: Any) -> Floats:
    """Return force in N and torque in B."""
    arguments = {"body": body} | options
    return np.concatenate([load.force(*state, **arguments), load.torque(*state, **arguments)], axis=-1)


def forces_of_light(areas: Any, normals: Any, shares: Any, s: Floats, pressure: float) -> Floats:
    """Return the force on each plate, from the formula, all in one frame."""
    areas, normals = np.asarray(areas), np.asarray(normals, dtype=float)
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    mirrored, scattered = np.broadcast_to(shares, (len(areas), 2)).T
    s = s / np.linalg.norm(s)
    cos = normals @ s
    seen = np.where(cos > 0, pressure * areas * cos, 0.0)
    out = 2 * (mirrored * cos + scattered / 3)
    forces: Floats = -seen[:, None] * ((1 - mirrored)[:, None] * s + out[:, None] * normals)
    return forces


def forces_of_air(areas: Any, normals: Any, drag: Any, velocity: Floats, density: float) -> Floats:
    areas, normals = np.asarray(areas), np.asarray(normals, dtype=float)
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    flow = -velocity / np.linalg.norm(velocity)
    cos = np.maximum(-(normals @ flow), 0.0)
    forces: Floats = (0.5 * density * velocity @ velocity * drag * areas * cos)[:, None] * flow
    return forces


def facets(vertices: Floats, faces: Any) -> tuple[Floats, Floats, Floats]:
    """Return centers, areas and normals of triangles."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    twice = np.cross(b - a, c - a)
    area = np.linalg.norm(twice, axis=1)
    return (a + b + c) / 3, area / 2, twice / area[:, None]


class TestClosedForms:
    @pytest.mark.parametrize(
        ("shares", "times"), [((0, 0), 1), ((1, 0), 2), ((0, 1), 5 / 3), ((0.5, 0.2), 49 / 30)]
    )
    def test_a_plate_at_right_angles(self, shares: Any, times: float) -> None:
        found = exerted(lit(SQUARE, shares, (0, 0, 3), 4.5))
        assert found == pytest.approx([0, 0, -4.5 * 2.0 * times, 0, 0, 0], abs=1e-14)

    def test_a_vane_with_a_black_and_a_bright_side(self) -> None:
        # Vanes on both sides of an axle along z, in light along y: the bright one is pushed twice as much.
        vanes: Any = ([(1.5, 0, 0), (-1.5, 0, 0)], [0.2, 0.2], [(0, 1, 0), (0, 1, 0)])
        found = exerted(lit(vanes, [(0, 0), (1, 0)], (0, 1, 0), 3.0))
        assert found == pytest.approx([0, -3 * 0.6, 0, 0, 0, 1.5 * 1.2 - 1.5 * 0.6], abs=1e-15)

    @pytest.mark.parametrize("shares", SHARES)
    @pytest.mark.parametrize("sun", [SUN, (-1, 2, -0.5), (0, 0, -1), (1, -1, 0)])
    def test_a_box(self, shares: Any, sun: Any) -> None:
        size = (1.0, 2.0, 0.5)
        s = np.array(sun) / np.linalg.norm(sun)
        areas = np.array([size[1] * size[2], size[2] * size[0], size[0] * size[1]])
        mirrored, scattered = shares
        want = -2.5 * (
            (1 - mirrored) * (areas @ np.abs(s)) * s + 2 * areas * (mirrored * np.abs(s) + scattered / 3) * s
        )
        at = np.array([0.3, -0.1, 0.7])
        vertices, faces = meshes.box(size)
        found = exerted(lit((vertices + at, faces), shares, sun, 2.5))
        # Opposite faces are alike, so the black part acts at the middle; the others along normals through it.
        assert found[:3] == pytest.approx(want, abs=1e-14)
        assert found[3:] == pytest.approx(np.cross(at, want), abs=2e-14)

    @pytest.mark.parametrize("shares", SHARES)
    def test_a_sphere_of_plates(self, shares: Any) -> None:
        """Gauss's points on both sides of the terminator integrate the sphere exactly."""
        radius, at = 1.3, np.array([0.2, 0.1, -0.4])
        x, w = np.polynomial.legendre.leggauss(8)
        heights, weights = np.concatenate([(x + 1) / 2, (x - 1) / 2]), np.concatenate([w, w]) / 2
        phi = 2 * np.pi * np.arange(9) / 9
        z, f = np.meshgrid(heights, phi, indexing="ij")
        rho = np.sqrt(1 - z**2)
        normals = np.stack([rho * np.cos(f), rho * np.sin(f), z], axis=-1).reshape(-1, 3)
        areas = (radius**2 * weights[:, None] * np.full(9, 2 * np.pi / 9)).ravel()
        turn = Rotation.align_vectors([SUN], [(0, 0, 1)])[0]
        normals = turn.apply(normals)
        found = exerted(lit((at + radius * normals, areas, normals), shares, SUN, 2.0))
        want = -2.0 * np.pi * radius**2 * (1 + 4 / 9 * shares[1]) * SUN
        assert found[:3] == pytest.approx(want, abs=1e-13)
        assert found[3:] == pytest.approx(np.cross(at, want), abs=1e-13)
        air = exerted(flown((at + radius * normals, areas, normals), 2.0, 3.0 * SUN, 0.5))
        assert air[:3] == pytest.approx(-0.5 * 9.0 * np.pi * radius**2 * SUN, abs=1e-13)

    @pytest.mark.parametrize("shares", SHARES)
    def test_the_mesh_of_a_sphere_comes_near_it(self, shares: Any) -> None:
        want = np.pi * (1 + 4 / 9 * shares[1])
        off = []
        for fine in (3, 4, 5):
            mesh = meshes.icosphere(fine)
            centers, areas, normals = facets(*mesh)
            each = forces_of_light(areas, normals, shares, SUN, 1.0)
            found = exerted(lit(mesh, shares))
            assert found[:3] == pytest.approx(each.sum(axis=0), abs=1e-13)
            assert found[3:] == pytest.approx(np.cross(centers, each).sum(axis=0), abs=1e-13)
            off.append(abs(-found[:3] @ SUN - want))
        assert off[2] < 3e-3
        assert 3.5 < off[0] / off[1] < 4.5
        assert 3.5 < off[1] / off[2] < 4.5

    @pytest.mark.parametrize("shares", SHARES)
    @pytest.mark.parametrize("tilt", [0.0, 0.3])
    def test_a_cone(self, shares: Any, tilt: float) -> None:
        """A cone lit all around: the angle of light to the axis is less than the half-angle."""
        half, length, count = 0.6, 2.0, 24
        sin, cos = np.sin(half), np.cos(half)
        phi = 2 * np.pi * (np.arange(count) + 0.5) / count
        round_, flat = np.stack([np.cos(phi), np.sin(phi)], axis=-1), np.ones((count, 1))
        along = np.hstack([sin * round_, -cos * flat])  # from the apex, which is the origin
        normals = np.hstack([cos * round_, sin * flat])
        areas = np.full(count, np.pi * length**2 * sin / count)
        s = np.array([np.sin(tilt), 0, np.cos(tilt)])
        # cos θ = a cos φ + b; sums over φ are integrals.
        a, b = cos * np.sin(tilt), sin * np.cos(tilt)
        mirrored, scattered = shares
        force = (1 - mirrored) * 2 * np.pi * b * s
        force += 2 * mirrored * np.pi * np.array([2 * a * b * cos, 0, (a**2 + 2 * b**2) * sin])
        force += 2 / 3 * scattered * np.pi * np.array([a * cos, 0, 2 * b * sin])
        torque = (1 - mirrored) * np.pi * np.cross([a * sin, 0, -2 * b * cos], s)
        torque -= np.pi * np.array([0, 2 * mirrored * 2 * a * b + 2 / 3 * scattered * a, 0])
        unit = length**2 / 2 * sin
        plates = (2 / 3 * length * along, areas, normals)
        found = exerted(lit(plates, shares, s, 1.5))
        assert found[:3] == pytest.approx(-1.5 * unit * force, abs=1e-13)
        assert found[3:] == pytest.approx(-1.5 * unit * 2 / 3 * length * torque, abs=1e-13)

    def test_the_mesh_of_a_cone_comes_near_it(self) -> None:
        half, length = 0.6, 2.0
        sin, cos = np.sin(half), np.cos(half)
        off = []
        for count in (32, 64, 128):
            phi = 2 * np.pi * np.arange(count) / count
            rim = length * np.stack([sin * np.cos(phi), sin * np.sin(phi), np.full(count, -cos)], axis=-1)
            around = np.arange(count)
            faces = np.stack([np.zeros_like(around), around + 1, (around + 1) % count + 1], axis=-1)
            mantle = (np.vstack([np.zeros(3), rim]), faces)  # open
            found = exerted(lit(mantle, (1, 0), (0, 0, 1)))
            off.append(abs(found[2] + 2 * sin**2 * np.pi * (length * sin) ** 2))
            # Newton's flow takes all momentum: density times the square of the speed times the cross-section.
            section = count / 2 * np.sin(2 * np.pi / count) * (length * sin) ** 2
            air = exerted(flown(mantle, 2.0, (0, 0, 3.0), 0.5))
            assert air == pytest.approx([0, 0, -0.5 * 9 * section, 0, 0, 0], abs=1e-13)
        assert 3.9 < off[0] / off[1] < 4.1
        assert 3.9 < off[1] / off[2] < 4.1
        assert off[2] < 0.01

    def test_drag_of_a_plate(self) -> None:
        found = exerted(flown(SQUARE, 2.2, (3.0, 0, 4.0), 0.1))
        assert found == pytest.approx([*(-0.05 * 25 * 2.2 * 2.0 * 0.8 * np.array([0.6, 0, 0.8])), 0, 0, 0])
        # By the direction of the flow and the speed.
        same = exerted(flown(SQUARE, 2.2, 5.0, 0.1, direction=(-6, 0, -8)))
        assert same == pytest.approx(found, abs=1e-15)
        assert np.array_equal(exerted(flown(SQUARE, 2.2, (0, 0, 0), 0.1)), np.zeros(6))

    @pytest.mark.parametrize("off", [1e-3, 1e-9, 1e-15])
    def test_light_that_grazes(self, off: float) -> None:
        for shares in SHARES:
            just = exerted(lit(SQUARE, shares, (1, 0, off)))
            slope = np.array([1 - shares[0], 0, 2 / 3 * shares[1] + (1 + shares[0]) * off])
            assert just[:3] == pytest.approx(-2.0 * off * slope, rel=1e-6, abs=2.1 * off**2)
            assert np.array_equal(exerted(lit(SQUARE, shares, (1, 0, -off))), np.zeros(6))
            assert np.array_equal(exerted(lit(SQUARE, shares, (1, 0, 0))), np.zeros(6))
        assert exerted(flown(SQUARE, 2.0, (1, 0, off)))[0] == pytest.approx(-2.0 * off, rel=1e-5)
        assert np.array_equal(exerted(flown(SQUARE, 2.0, (1, 0, -off))), np.zeros(6))


class TestSums:
    def test_random_plates_and_attitudes(self, rng: np.random.Generator) -> None:
        for count in (1, 2, 3, 4, 5, 8, 41):
            centers, normals = rng.normal(size=(2, count, 3))
            areas = rng.uniform(0.1, 2.0, count)
            shares = rng.dirichlet((1, 1, 1), count)[:, :2]
            q = Rotation.from_quat(rng.normal(size=(20, 4))).as_quat()
            suns = rng.normal(size=(20, 3)) * 10.0 ** rng.uniform(-3, 3, (20, 1))
            pressures = rng.uniform(0.1, 10.0, 20)
            drags = rng.uniform(0.0, 3.0, count)
            light = lit((centers, areas, normals), shares, suns, pressures)
            air = flown((centers, areas, normals), drags, suns, pressures)
            assert light.shape == air.shape == (20,)
            for about, point in (("center_of_mass", BODY.center_of_mass), ("origin", np.zeros(3))):
                state = (0.0, np.zeros(3), q)
                got = [exerted(load, state, BODY, about=about) for load in (light, air)]
                for k in range(20):
                    turn = Rotation.from_quat(q[k])
                    inside = turn.inv().apply(suns[k])
                    each = (
                        forces_of_light(areas, normals, shares, inside, pressures[k]),
                        forces_of_air(areas, normals, drags, inside, pressures[k]),
                    )
                    for found, forces in zip(got, each, strict=True):
                        scale = np.abs(forces).sum() * (1 + np.abs(centers).max()) + 1e-300
                        assert np.abs(found[k, :3] - turn.apply(forces.sum(axis=0))).max() < 1e-14 * scale
                        moment = np.cross(centers - point, forces).sum(axis=0)
                        assert np.abs(found[k, 3:] - moment).max() < 1e-14 * scale

    def test_tables(self, rng: np.random.Generator) -> None:
        times = np.array([0.0, 1.0, 1.5, 3.0, 4.0])
        suns = np.array([(1, 0, 0.5), (1, 0.3, 0.4), (1, 0.5, 0.6), (0.5, 1, 0.5), (0, 1, 0.3)]) * 7.0
        levels = np.array([1.0, 2.0, 0.5, 0.0, 3.0])
        light = lit(PLATE, (0.3, 0.2), suns, levels, times=times)
        steady = lit(PLATE, (0.3, 0.2), SUN, levels, times=times)
        even = lit(PLATE, (0.3, 0.2), suns, 2.0, times=times)
        air = flown(PLATE, 2.2, suns, levels, times=times)
        wind = flown(PLATE, 2.2, levels, 1.5, direction=-SUN, times=times)
        units = CubicSpline(times, suns / np.linalg.norm(suns, axis=1, keepdims=True))
        speeds, winds = CubicSpline(times, suns), CubicSpline(times, levels[:, None] * SUN)
        _, areas, normals = PLATE
        for t in [*times, *rng.uniform(0, 4, 30)]:
            level = np.interp(t, times, levels)
            state = (t, *REST[1:])
            for load, want in (
                (light, forces_of_light(areas, normals, (0.3, 0.2), units(t), level)),
                (steady, forces_of_light(areas, normals, (0.3, 0.2), SUN, level)),
                (even, forces_of_light(areas, normals, (0.3, 0.2), units(t), 2.0)),
                (air, forces_of_air(areas, normals, 2.2, speeds(t), level)),
            ):
                assert exerted(load, state)[:3] == pytest.approx(want[0], rel=1e-12, abs=1e-14)
            flow = winds(t)
            if flow @ flow > 1e-12:
                want = forces_of_air(areas, normals, 2.2, flow, 1.5)
                assert exerted(wind, state)[:3] == pytest.approx(want[0], rel=1e-11, abs=1e-13)

    def test_forms_of_a_surface(self) -> None:
        vertices, faces = meshes.box((1.0, 2.0, 0.5))
        centers, areas, normals = facets(vertices, faces)
        mesh = SimpleNamespace(vertices=vertices, faces=faces)
        scene = SimpleNamespace(to_mesh=lambda: mesh)
        want = exerted(lit((vertices, faces), (0.3, 0.2)))
        for form in (mesh, scene, [vertices, faces], (vertices.tolist(), faces.tolist())):
            assert np.array_equal(exerted(lit(form, (0.3, 0.2))), want)
        plates = (centers, areas, 3.0 * normals)
        assert exerted(lit(plates, np.tile((0.3, 0.2), (12, 1)))) == pytest.approx(want, abs=1e-15)

    def test_sides_and_faces_without_area(self) -> None:
        both: Any = ([(1, 0, 0)] * 2, [2.0] * 2, [(0, 0, 1), (0, 0, -1)])
        for s in ((0, 0, 1), (0, 0, -1)):
            assert exerted(lit(both, (0, 0), s))[2] == -2.0 * s[2]
        # A sheet of two triangles, and the same with both sides.
        corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        sheet = [(0, 1, 2), (0, 2, 3)]
        back = [(0, 2, 1), (0, 3, 2)]
        for faces, behind in ((sheet, 0.0), (sheet + back, 1.0)):
            assert exerted(lit((corners, faces), (0, 0), (0, 0, 1)))[2] == pytest.approx(-1.0)
            assert exerted(lit((corners, faces), (0, 0), (0, 0, -1)))[2] == pytest.approx(behind)
        # Areas of zero, of plates and of faces, exert nothing.
        none: Any = ([(1, 0, 0)], [0.0], [(0, 0, 1)])
        assert np.array_equal(exerted(lit(none, (0, 0))), np.zeros(6))
        thin = ([*corners, (0.5, 0, 0)], [*sheet, (0, 4, 1)])
        assert exerted(lit(thin, (0, 0), (0, 0, 1))) == pytest.approx(
            exerted(lit((corners, sheet), (0, 0), (0, 0, 1)))
        )


class TestMotions:
    def test_a_plate_that_spins_about_the_line_to_the_sun(self) -> None:
        load = lit(SQUARE, (0.4, 0.3), (0, 0, 1), 0.05)
        t = np.linspace(0, 10, 6)
        run = PLAIN.simulate(t, (0, 0, 0.7), load=load, velocity=(0.1, 0, 0), rtol=1e-12)
        force = -0.05 * 2.0 * (0.6 + 2 * 0.4 + 2 / 3 * 0.3)
        want = np.stack([0.1 * t, 0 * t, force * t**2 / (2 * PLAIN.mass)], axis=-1)
        assert np.abs(run.position - want).max() < 1e-13
        assert np.abs(run.omega - (0, 0, 0.7)).max() < 1e-14

    def test_a_body_at_rest_is_lit_at_last(self) -> None:
        # The normal is along y at the start: cos θ = −sin ωt, from half a turn on.
        plate: Any = ([(0, 0, 0)], [2.0], [(0, 1, 0)])
        t = np.linspace(0, 9, 91)
        load = lit(plate, (0, 0), (1, 0, 0), 0.05)
        run = PLAIN.simulate(t, (0, 0, 0.7), load=load, rtol=1e-12)
        push = 1.0 + np.cos(np.clip(0.7 * t, np.pi, 2 * np.pi))
        want = -0.05 * 2.0 / (0.7 * PLAIN.mass) * push
        assert np.abs(run.velocity[:, 0] - want).max() < 1e-11

    def test_a_torque_about_the_line_of_the_axle(self) -> None:
        # A black plate beside the axle z, on a body that turns a little: I₃ φ̈ = −p A r cos² φ.
        plate: Any = ([(1.0, 0, 0)], [2.0], [(0, 1, 0)])
        run = PLAIN.simulate(
            np.linspace(0, 3, 7), (0, 0, 0), load=lit(plate, (0, 0), (0, 1, 0), 0.2), rtol=1e-13
        )

        def rates(_: float, y: Floats) -> Floats:
            return np.array([y[1], -0.2 * 2.0 * np.cos(y[0]) ** 2 / 2.5])

        want = solve_ivp(rates, (0, 3), (0, 0), "DOP853", run.t, rtol=3e-14, atol=1e-15).y
        assert run.omega[:, 2] == pytest.approx(want[1], abs=1e-12)
        assert 2 * np.arctan2(run.quaternion[:, 2], run.quaternion[:, 3]) == pytest.approx(want[0], abs=1e-12)

    def test_angular_momentum(self) -> None:
        t = np.linspace(0, 20, 5)
        centred: Any = ([PLAIN.center_of_mass], [2.0], [(0.3, 0.2, 1)])
        run = PLAIN.simulate(t, (0.4, -0.2, 0.5), load=lit(centred, (0.3, 0.2)), rtol=1e-12)
        about = run.angular_momentum().spin
        assert np.abs(about - about[0]).max() < 1e-11
        # Where light is absorbed, and of drag, all forces are along the line to the Sun: no torque about it.
        for load in (lit(PLATE, (0, 0)), flown(PLATE, 2.0, 0.5 * SUN)):
            run = PLAIN.simulate(t, (0.4, -0.2, 0.5), load=load, rtol=1e-12)
            about = run.angular_momentum().spin
            assert np.abs((about - about[0]) @ SUN).max() < 1e-10
            assert np.abs(about - about[0]).max() > 1e-2
        run = PLAIN.simulate(t, (0.4, -0.2, 0.5), load=lit(PLATE, (0, 1)), rtol=1e-12)
        about = run.angular_momentum().spin
        assert np.abs((about - about[0]) @ SUN).max() > 1e-3

    @pytest.mark.parametrize("kind", ["light", "table", "drag"])
    def test_plates_on_a_tumbling_body_by_scipy(self, kind: str) -> None:
        """Each plate turns to the Sun and away from it: the kinks are crossed."""
        centers = np.array([(0.9, 0.1, -0.3), (-0.7, 0.4, 0.2), (0.1, -0.8, 0.5)])
        normals = np.array([(0.1, 0.2, 1.0), (-1.0, 0.3, 0.2), (0.2, -1.0, 0.4)])
        areas, shares = np.array([1.0, 0.6, 0.8]), np.array([(0.3, 0.2), (0.0, 0.8), (0.9, 0.0)])
        end, omega, pressure = 8.0, np.array([0.5, -0.8, 0.6]), 0.01
        times = np.array([0.0, 3.0, 5.0, 8.0])
        suns = np.array([(0.6, 0, 0.8), (0.6, 0.3, 0.8), (0.3, 0.5, 0.8), (0, 1, 1)])
        units = CubicSpline(times, suns / np.linalg.norm(suns, axis=1, keepdims=True))
        levels = 0.01 * np.array([1.0, 2.0, 0.0, 1.0])
        if kind == "light":
            load = lit((centers, areas, normals), shares, SUN, pressure)
        elif kind == "table":
            load = lit((centers, areas, normals), shares, suns, levels, times=times)
        else:
            load = flown((centers, areas, normals), (2.0, 2.2, 1.0), 0.15 * SUN)
        arms, I = centers - BODY.center_of_mass, BODY.inertia
        inverse = np.linalg.inv(I)

        def rates(t: float, y: Floats) -> Floats:
            q, w = y[:4] / np.sqrt(y[:4] @ y[:4]), y[4:7]
            turn = Rotation.from_quat(q).as_matrix()
            if kind == "drag":
                each = forces_of_air(areas, normals, np.array([2.0, 2.2, 1.0]), 0.15 * SUN @ turn, 1.0)
            elif kind == "light":
                each = forces_of_light(areas, normals, shares, SUN @ turn, pressure)
            else:
                level = np.interp(t, times, levels)
                each = forces_of_light(areas, normals, shares, units(t) @ turn, level)
            torques = np.cross(np.vstack([arms, -w]), np.vstack([each, I @ w]))
            spin = inverse @ torques.sum(axis=0)
            x, v = q[3] * w + np.cross(q[:3], w), -q[:3] @ w
            force = turn @ each.sum(axis=0) / BODY.mass
            return np.concatenate([x / 2, [v / 2], spin, y[10:], force])

        y = np.concatenate([(0, 0, 0, 1), omega, np.zeros(6)])
        for start, stop in itertools.pairwise(times):  # where the tables have kinks
            found = solve_ivp(rates, (start, stop), y, "DOP853", rtol=1e-12, atol=1e-14, max_step=0.02)
            y = found.y[:, -1]
        run = BODY.simulate([0, end], omega, load=load, rtol=1e-12, atol=1e-14)
        got = run.quaternion[-1]
        assert min(np.abs(got - y[:4]).max(), np.abs(got + y[:4]).max()) < 1e-10
        assert np.abs(run.omega[-1] - y[4:7]).max() < 1e-10
        assert np.abs(run.position[-1] - run.position[0] - y[7:10]).max() < 1e-10
        assert np.abs(run.velocity[-1] - y[10:]).max() < 1e-10

    def test_a_body_held_at_its_origin(self) -> None:
        load = lit(PLATE, (0.3, 0.2), SUN, 0.1)
        run = BODY.simulate([0, 1.0], (0.1, 0.2, 0.3), load=load, about="origin", rtol=1e-12)
        state = (1.0, run.omega[-1], run.quaternion[-1])
        assert run.torque()[-1] == pytest.approx(exerted(load, state, BODY, about="origin")[3:], abs=1e-15)

    def test_a_sharp_shadow(self) -> None:
        load = loads.schedule(lit(SQUARE, (0, 0), (0, 0, 1), 0.3), [(0, 1.0), (2.5, 4.0)])
        run = PLAIN.simulate([0, 4.0], (0, 0, 0), load=load)
        assert run.velocity[-1] == pytest.approx([0, 0, -0.3 * 2.0 * 2.5 / 2.0], abs=1e-14)

    def test_a_soft_shadow(self) -> None:
        load = lit(SQUARE, (0, 0), (0, 0, 1), [0.3, 0.3, 0.0, 0.0], times=[0, 1, 1.5, 4])
        run = PLAIN.simulate([0, 4.0], (0, 0, 0), load=load)
        assert run.velocity[-1] == pytest.approx([0, 0, -0.3 * 2.0 * 1.25 / 2.0], abs=1e-14)


SHIFTED = (meshes.box((1, 2, 3))[0] + (0.3, 0.2, -0.1), meshes.box((1, 2, 3))[1])
LOADS: Any = {
    "light": lit(PLATE, (0.3, 0.2)),
    "drag": flown(PLATE, 2.0, 2.0 * SUN),
    "table": lit(SHIFTED, (0.3, 0.2), [SUN, (0, 0, 1)], [1.0, 2.0], times=[0, 1]),
}


class TestAlgebra:
    @pytest.mark.parametrize("name", LOADS)
    def test_factors_sums_and_pickles(self, name: str) -> None:
        load = LOADS[name]
        state = (0.5, (0.1, 0.2, 0.3), (0.1, 0.1, -0.1, 0.97**0.5))
        want = exerted(load, state)
        assert np.abs(want).min() > 0
        for other, factor in (
            (2.5 * load, 2.5),
            (-load, -1.0),
            (load + load - 0.5 * load, 1.5),
            (0 * load, 0.0),
        ):
            assert exerted(other, state) == pytest.approx(factor * want, rel=1e-14)
        again = pickle.loads(pickle.dumps(2 * load + load))
        assert np.array_equal(exerted(again, state), exerted(2 * load + load, state))
        assert repr(load) == "<Load: panels>"

    def test_arrays_are_copied(self) -> None:
        centers, areas, normals = (np.array(part, dtype=float) for part in PLATE)
        load = lit((centers, areas, normals), (0.3, 0.2))
        want = exerted(load)
        areas *= 2
        assert np.array_equal(exerted(pickle.loads(pickle.dumps(load))), want)

    def test_stacks(self) -> None:
        shares = np.array([[(0.1, 0.2)], [(0.3, 0.4)], [(0.0, 1.0)]])  # of three surfaces with one plate
        suns = np.array([SUN, (0, 0, 1)])
        load = lit(PLATE, shares, suns[:, None], 2.0)
        assert load.shape == (2, 3)
        for i, k in np.ndindex(2, 3):
            alone = lit(PLATE, shares[k, 0], suns[i], 2.0)
            assert np.array_equal(exerted(load)[i, k], exerted(alone))
            assert np.array_equal(exerted(load[i, k]), exerted(alone))
        run = PLAIN.simulate([0, 1], (0.1, 0, 0), load=load)
        assert run.omega.shape == (2, 3, 2, 3)
        drags = flown(PLATE, [[1.0], [2.0]], 2.0 * SUN)
        assert exerted(drags)[1] == pytest.approx(2 * exerted(drags)[0])
        tables = lit(PLATE, (0, 0), [[SUN, SUN], [SUN, (0, 0, 1)]], [[1.0, 1.0], [2.0, 2.0]], times=[0, 1])
        assert tables.shape == (2,)
        with pytest.raises(ValueError, match="do not broadcast: coefficients"):
            lit(PLATE, shares, np.ones((2, 3)))

    def test_derivatives(self) -> None:
        """By the pressure and the shares, where the plate is lit all the time."""
        run = PLAIN.simulate([0, 2], (0.1, 0, 0.2), load=lit(PLATE, (0.3, 0.2), SUN, 0.1), rtol=1e-13)
        with pytest.raises(PolhodeError, match="differences"):
            run.sensitivity()
        (slopes,) = run.sensitivity("differences").load
        assert set(slopes) == {"coefficients", "direction", "pressure"}
        h = 1e-4
        ends = [
            PLAIN.simulate([0, 2], (0.1, 0, 0.2), load=lit(PLATE, (0.3, 0.2), SUN, p), rtol=1e-13).omega[-1]
            for p in (0.1 + h, 0.1 - h)
        ]
        assert slopes["pressure"][-1, 3:6] == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-6)

    def test_derivatives_where_nothing_is_absorbed(self) -> None:
        """The shares sum up to one, so that none can be more: differences go to the other side."""

        def end(specular: float, diffuse: float) -> Floats:
            load = lit(PLATE, (specular, diffuse), SUN, 0.1)
            omega: Floats = PLAIN.simulate([0, 2], (0.1, 0, 0.2), load=load, rtol=1e-13).omega[-1]
            return omega

        load = lit(PLATE, (0.75, 0.25), SUN, 0.1)
        run = PLAIN.simulate([0, 2], (0.1, 0, 0.2), load=load, rtol=1e-13)
        found = run.sensitivity("differences").load[0]["coefficients"][-1, 3:6]
        h = 1e-3
        for k, step in enumerate(np.eye(2) * h):
            here, near, far = (end(0.75 - n * step[0], 0.25 - n * step[1]) for n in range(3))
            assert found[:, k] == pytest.approx((3 * here - 4 * near + far) / (2 * h), rel=1e-5)

    def test_methods(self) -> None:
        load = lit(PLATE, (0.3, 0.2))
        run = PLAIN.simulate([0, 1], (0.1, 0, 0), load=load)
        other = PLAIN.simulate([0, 1], (0.1, 0, 0), load=load, method="radau", rtol=1e-10)
        assert np.abs(run.omega - other.omega).max() < 1e-7
        with pytest.raises(PolhodeError, match="dop853"):
            PLAIN.simulate([0, 1], (0.1, 0, 0), load=load, method="taylor")


class TestRefused:
    @pytest.mark.parametrize(
        ("shares", "words"),
        [
            ((0.7, 0.3 + 1e-12), "at most 1, got 1.00000000000"),
            ((-1e-12, 0.5), "from 0 to 1.*got -1e-12"),
            ((0.5, -1e-12), "from 0 to 1.*got -1e-12"),
            ((1.5, 0.0), "got 1.5"),
            ((np.nan, 0.0), "coefficients must be finite, got NaN"),
            (0.3, r"coefficients: expected the shape \(2,\) or \(1, 2\), the shares of light"),
            ((0.1, 0.2, 0.3), r"got \(3,\)"),
            (((0.1, 0.2), (0.1, 0.2)), r"got \(2, 2\)"),
        ],
    )
    def test_shares(self, shares: Any, words: str) -> None:
        with pytest.raises(ValueError, match=words):
            lit(PLATE, shares)

    def test_shares_that_are_rounded(self) -> None:
        for shares in ((0.7, 0.3), (0.9, 0.1), (1 / 3, 2 / 3), (0.7, 0.3 + 2e-16), (1, 0), (0, 1), (0, 0)):
            assert lit(PLATE, shares).shape == ()

    def test_the_plate_is_named(self) -> None:
        three: Any = ([(0, 0, 0)] * 3, [1.0, 1.0, 1.0], [(0, 0, 1)] * 3)
        with pytest.raises(PolhodeError, match=r"row 1: coefficients must be .*got 1\.2"):
            lit(three, [(0, 0), (0.6, 0.6), (0, 0)])
        with pytest.raises(PolhodeError, match=r"row 2: coefficients must be positive or zero, got -1"):
            flown(three, [1.0, 2.0, -1.0], (1, 0, 0))
        with pytest.raises(PolhodeError, match="row 1: normals must not be the zero vector"):
            lit((three[0], three[1], [(0, 0, 1), (0, 0, 0), (0, 0, 1)]), (0, 0))
        with pytest.raises(PolhodeError, match=r"row 2: areas must be positive or zero, got -0\.5"):
            lit((three[0], [1.0, 0.0, -0.5], three[2]), (0, 0))

    @pytest.mark.parametrize(
        ("plates", "words"),
        [
            (([(0, 0, np.inf)], [1.0], [(0, 0, 1)]), "centers must be finite"),
            (([(0, 0, 0)], [np.nan], [(0, 0, 1)]), "areas must be finite"),
            (([(0, 0, 0)], [1.0], [(0, np.nan, 1)]), "normals must be finite"),
            (([(0, 0, 0)], [1.0, 2.0], [(0, 0, 1)]), "areas: expected one for each of the 1 plates.*got 2"),
            (([(0, 0, 0)], [1.0], [(0, 0, 1)] * 3), "normals: expected one for each of the 1 plates.*got 3"),
            (([(0, 0)], [1.0], [(0, 0, 1)]), r"centers: expected shape \(n, 3\), got \(1, 2\)"),
            (([(0, 0, 0)], 1.0, [(0, 0, 1)]), r"areas: expected shape \(n\), got \(\)"),
            ((np.zeros((0, 3)), [], np.zeros((0, 3))), "centers: expected at least one plate, got none"),
        ],
    )
    def test_plates(self, plates: Any, words: str) -> None:
        with pytest.raises(ValueError, match=words):
            lit(plates, (0, 0))

    @pytest.mark.parametrize("surface", [None, 3.0, np.zeros((3, 3)), (), ([1.0],), ([1.0],) * 4, "mesh"])
    def test_no_surface(self, surface: Any) -> None:
        with pytest.raises(TypeError, match=r"surface: expected a mesh, a tuple \(vertices, faces\)"):
            lit(surface, (0, 0))

    def test_meshes(self) -> None:
        vertices, faces = meshes.box((1.0, 2.0, 3.0))
        with pytest.raises(MeshError, match="inverted: its signed volume is -6") as caught:
            lit((vertices, faces[:, ::-1]), (0, 0))
        assert "orient" not in str(caught.value)
        two = meshes.merge((vertices, faces), (vertices + 9.0, faces[:, ::-1]))
        with pytest.raises(MeshError, match="inside out") as caught:
            lit(two, (0, 0))
        assert "orient" not in str(caught.value)
        flipped = faces.copy()
        flipped[3] = flipped[3, ::-1]
        with pytest.raises(MeshError, match="not consistently wound"):
            lit((vertices, flipped), (0, 0))
        with pytest.raises(MeshError, match="same triangle"):
            lit((vertices, np.vstack([faces, faces[:1]])), (0, 0))
        with pytest.raises(MeshError, match="names vertex 8"):
            lit((vertices, faces + 1), (0, 0))
        with pytest.raises(MeshError, match="no faces"):
            lit((vertices, np.zeros((0, 3), dtype=int)), (0, 0))
        with pytest.raises(MeshError, match="not finite"):
            lit((vertices * np.nan, faces), (0, 0))
        with pytest.raises(MeshError, match="no area"):
            lit(([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), (0, 0))
        # Without its top it is a surface.
        assert exerted(lit((vertices, faces[:-2]), (0, 0))).shape == (6,)

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ({"law": "light"}, 'law: expected "solar" or "drag", got "light"'),
            ({"direction": None}, "direction: the law .solar. needs"),
            ({"pressure": None}, "pressure: the law .solar. needs"),
            ({"density": 1.0}, "density: belongs to law=.drag."),
            ({"velocity": (1, 0, 0)}, "velocity: belongs to law=.drag."),
            ({"direction": (0, 0, 0)}, "direction must not be the zero vector"),
            ({"direction": (0, np.nan, 0)}, "direction must be finite"),
            ({"direction": (1, 0)}, r"direction: expected shape \(\.\.\., 3\)"),
            ({"pressure": -1e-9}, "pressure must be positive or zero, got -1e-9"),
            ({"pressure": np.inf}, "pressure must be finite"),
            ({"times": [0, 1]}, "times: neither direction nor pressure is a table"),
            (
                {"times": [0, 1], "direction": np.ones((3, 3))},
                "direction: expected one for each of the 2 times",
            ),
            ({"times": [0, 1], "pressure": [1, 1, 1]}, "pressure: expected one for each of the 2 times"),
            ({"times": [0, 1], "pressure": [1, -1e-9]}, "pressure must be positive or zero, got -1e-9"),
            ({"times": [1, 0], "pressure": [1, 1]}, "times must be strictly ascending"),
            ({"times": [0], "direction": [(0, 0, 1)]}, "at least 2"),
            ({"times": [0, 1], "direction": [(1, 0, 0), (0, 1, 0)]}, "less than a quarter of a turn"),
        ],
    )
    def test_light(self, given: Any, words: str) -> None:
        arguments = {"coefficients": (0, 0), "direction": (0, 0, 1), "pressure": 1.0} | given
        with pytest.raises((TypeError, ValueError), match=words):
            loads.panels(PLATE, **arguments)

    @pytest.mark.parametrize(
        ("given", "words"),
        [
            ({"density": None}, "density: the law .drag. needs"),
            ({"velocity": None}, "velocity: the law .drag. needs"),
            ({"pressure": 1.0}, "pressure: belongs to law=.solar."),
            ({"density": -1e-9}, "density must be positive or zero, got -1e-9"),
            ({"velocity": 3.0}, r"velocity: expected shape \(\.\.\., 3\)"),
            ({"velocity": (1e200, 0, 0)}, "the square of velocity must be finite"),
            ({"velocity": -1.0, "direction": (1, 0, 0)}, "velocity must be a speed along direction"),
            ({"velocity": 1.0, "direction": (0, 0, 0)}, "direction must not be the zero vector"),
            ({"coefficients": -1e-9}, "coefficients must be positive or zero, got -1e-9"),
            (
                {"coefficients": (1.0, 2.0)},
                r"coefficients: expected the shape \(\) or \(1,\), a drag coefficient",
            ),
        ],
    )
    def test_air(self, given: Any, words: str) -> None:
        arguments = {"coefficients": 2.0, "density": 1.0, "velocity": (1, 0, 0)} | given
        with pytest.raises((TypeError, ValueError), match=words):
            loads.panels(PLATE, "drag", **arguments)

    def test_times_beyond_a_table(self) -> None:
        for load in (
            lit(PLATE, (0, 0), [SUN, SUN], times=[0, 1]),
            lit(PLATE, (0, 0), SUN, [1.0, 2.0], times=[0, 1]),
            flown(PLATE, 2.0, [SUN, SUN], times=[0, 1]),
        ):
            assert PLAIN.simulate([0, 1.0], (0, 0, 0), load=load).status == "complete"
            with pytest.raises(ValueError, match=r"known from t = 0.0 to t = 1.0, and needed at t = 1.1"):
                PLAIN.simulate([0, 1.1], (0, 0, 0), load=load)

    def test_a_body_is_needed(self) -> None:
        with pytest.raises(TypeError, match="body"):
            lit(PLATE, (0, 0)).torque(*REST)
