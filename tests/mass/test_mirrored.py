"""Mirror images of bodies, against particles, exact rationals and draws of their uncertain numbers."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, assembly, solids
from polhode.errors import PolhodeError


def mirror(normal: np.ndarray) -> np.ndarray:
    n = normal / np.linalg.norm(normal)
    return np.eye(3) - 2.0 * np.outer(n, n)


def test_of_particles_it_is_the_body_of_their_images(rng: np.random.Generator) -> None:
    for _ in range(50):
        masses, places = rng.uniform(0.1, 1.0, 7), rng.normal(size=(7, 3)) + 3.0
        normal, point = rng.normal(size=3) * 10.0 ** rng.integers(-200, 200), rng.normal(size=3)
        image = RigidBody.from_particles(masses, places).mirrored(normal, point)
        m = mirror(normal / np.abs(normal).max())
        exact = RigidBody.from_particles(masses, point + (places - point) @ m)
        assert image.mass == exact.mass
        size = float(exact.radii_of_gyration.max()) + 10.0
        assert np.abs(image.center_of_mass - exact.center_of_mass).max() <= 1e-14 * size
        assert np.abs(image.inertia - exact.inertia).max() <= 1e-14 * exact.mass * size**2


def test_through_a_plane_of_coordinates_it_is_exact() -> None:
    rows = [[Fraction(4), Fraction(-1, 2), Fraction(1, 4)], [Fraction(-1, 2), Fraction(5), Fraction(3, 4)]]
    rows.append([Fraction(1, 4), Fraction(3, 4), Fraction(6)])
    body = RigidBody(2.0, [[float(x) for x in row] for row in rows], (0.5, 0.25, 0.125))
    for axis in range(3):
        signs = [-1 if i == axis else 1 for i in range(3)]
        image = body.mirrored(3.0 * np.eye(3)[axis], (1, 1, 1))
        for i in range(3):
            assert image.center_of_mass[i] == (
                2 - body.center_of_mass[i] if i == axis else body.center_of_mass[i]
            )
            for j in range(3):
                assert Fraction(float(image.inertia[i, j])) == signs[i] * signs[j] * rows[i][j]
        assert np.array_equal(image.principal_moments, body.principal_moments)
        assert np.linalg.det(image.principal.axes) == pytest.approx(1.0)


def test_twice_is_the_body_itself(rng: np.random.Generator) -> None:
    body = solids.wedge((3, 2, 1), density=2.0).translated((1, 2, 3))
    for _ in range(20):
        normal, point = rng.normal(size=3), rng.normal(size=3)
        assert body.mirrored(normal, point).mirrored(normal, point).isclose(body, rtol=1e-14)
    stack = body.mirrored(np.eye(3))
    assert stack.shape == (3,)
    assert stack[1] == body.mirrored((0, 1, 0))


def test_what_is_uncertain_is_so_in_the_image(rng: np.random.Generator) -> None:
    factor = rng.normal(size=(10, 10)) * 1e-3
    body = solids.wedge((3, 2, 1), mass=2.0).translated((1, 2, 3)).with_covariance(factor @ factor.T)
    normal = rng.normal(size=3)
    image = body.mirrored(normal, (1, 1, 1))
    m = mirror(normal)
    at = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
    change = np.zeros((10, 10))  # of m, C, I_C: xx yy zz xy xz yz
    change[0, 0], change[1:4, 1:4] = 1.0, m
    for column, (i, j) in enumerate(at):
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        turned = m @ unit @ m
        change[4:, 4 + column] = [turned[k] for k in at]
    assert body.covariance is not None
    assert image.covariance is not None
    expected = change @ body.covariance @ change.T
    assert np.abs(image.covariance - expected).max() <= 1e-13 * np.abs(expected).max()
    # Both halves come from one source: what is odd in the mirrored axis is zero without doubt.
    whole = body + body.mirrored((0, 1, 0))
    assert whole.sigma is not None
    assert body.sigma is not None
    assert float(whole.sigma.center_of_mass[1]) <= 1e-15
    assert float(whole.sigma.mass) == pytest.approx(2.0 * float(body.sigma.mass))


def test_pictures_show_the_image() -> None:
    from polhode.draw.shape import body_shape

    body = solids.wedge((3, 2, 1), density=2.0).translated((1, 2, 3))
    drawn = [body_shape(each, np.zeros(3), is_cut=False)[0] for each in (body, body.mirrored((0, 1, 0)))]
    volumes = []
    for shape in drawn:
        a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
        volumes.append(float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0))
    assert volumes[0] == pytest.approx(3.0)
    assert volumes[1] == pytest.approx(volumes[0])
    low, high = drawn[1].vertices.min(axis=0), drawn[1].vertices.max(axis=0)
    assert low[1] == pytest.approx(-drawn[0].vertices[:, 1].max())
    assert high[1] == pytest.approx(-drawn[0].vertices[:, 1].min())


def test_refused() -> None:
    body = solids.cube(1.0, mass=1.0)
    with pytest.raises(PolhodeError, match="normal must not be the zero vector"):
        body.mirrored((0, 0, 0))
    with pytest.raises(PolhodeError, match="point must be finite"):
        body.mirrored((0, 0, 1), (0, np.inf, 0))


def part(**more: object) -> dict[str, object]:
    return {"name": "arm", "solid": "wedge", "size": [3, 2, 1], "density": 2.0, **more}


def test_random_parts_of_assemblies_against_a_sum_by_hand(rng: np.random.Generator) -> None:
    arm = solids.wedge((3, 2, 1), density=2.0)
    for _ in range(60):
        normal, position = rng.normal(size=3), rng.normal(size=3)
        axis, degrees = rng.normal(size=3), float(rng.uniform(-180, 180))
        inner = {"name": "inner", "part": [part(mirror=normal.tolist(), position=position.tolist())]}
        turned = part(rotation={"axis": axis.tolist(), "degrees": degrees}, mirror=normal.tolist())
        turn = np.deg2rad(degrees) * axis / np.linalg.norm(axis)
        quaternion = np.append(
            np.sin(np.linalg.norm(turn) / 2) * axis / np.linalg.norm(axis), np.cos(np.linalg.norm(turn) / 2)
        )
        if degrees < 0:
            quaternion[:3] *= -1.0
        found = assembly.read(inner).body
        assert found.isclose(arm.mirrored(normal).translated(position), rtol=1e-13)
        assert assembly.read({"name": "a", "part": [turned]}).body.isclose(
            arm.mirrored(normal).rotated(quaternion), rtol=1e-13
        )


def test_an_assembly_mirrored_whole(tmp_path: Any) -> None:
    (tmp_path / "arm.toml").write_text(
        'name = "arm"\n[[part]]\nname = "a"\nsolid = "wedge"\nsize = [3, 2, 1]\ndensity = 2\n'
        "position = [1, 2, 3]\n"
        '[[part]]\nname = "b"\nsolid = "wedge"\nsize = [1, 2, 3]\ndensity = 1\nmirror = [0, 0, 1]\n'
    )
    (tmp_path / "both.toml").write_text(
        'name = "both"\n[[part]]\nname = "right"\nassembly = "arm.toml"\n'
        '[[part]]\nname = "left"\nassembly = "arm.toml"\nmirror = [0, 1, 0]\n'
    )
    whole = assembly.read(tmp_path / "both.toml")
    one = assembly.read(tmp_path / "arm.toml").body
    assert whole.body.isclose(one + one.mirrored((0, 1, 0)), rtol=1e-13)
    hands = {part.id: np.linalg.det(part.rotation) for part in whole.parts}
    assert hands == pytest.approx({"right/a": 1.0, "right/b": -1.0, "left/a": -1.0, "left/b": 1.0})
    with pytest.raises(PolhodeError, match="mirror: a normal of length 0"):
        assembly.read({"name": "a", "part": [part(mirror=[0, 0, 0])]})
