"""Solids cut by a plane, against exact clipping of tetrahedra in rationals and closed forms."""

from __future__ import annotations

import itertools
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from boxes import at, written
from command_line import run, write_obj
from oracles.meshes import box, icosphere
from polhode import RigidBody, Uncertain, assembly, solids
from polhode.errors import PolhodeError
from polhode.io import cut_mesh


def volume_beyond(vertices: np.ndarray, faces: np.ndarray, n: list[Fraction], p: list[Fraction]) -> Any:
    """Volume and first moment beyond a plane, in rationals: each face with a point of the plane, clipped."""
    v = [[Fraction(float(x)) - q for x, q in zip(row, p, strict=True)] for row in vertices]
    height = [sum(a * b for a, b in zip(n, row, strict=True)) for row in v]
    six, first = Fraction(0), [Fraction(0)] * 3
    for face in faces.tolist():
        polygon = []
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            if height[a] >= 0:
                polygon.append(v[a])
            if height[a] * height[b] < 0:
                t = height[a] / (height[a] - height[b])
                polygon.append([x + t * (y - x) for x, y in zip(v[a], v[b], strict=True)])
        for i in range(1, len(polygon) - 1):
            a, b, c = polygon[0], polygon[i], polygon[i + 1]
            d = (
                a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
            )
            six += d
            first = [f + d * (x + y + z) for f, x, y, z in zip(first, a, b, c, strict=True)]
    return six / 6, [f / 24 + q * six / 6 for f, q in zip(first, p, strict=True)]


def torus(n: int = 24, m: int = 10) -> tuple[np.ndarray, np.ndarray]:
    a, b = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    u, v = 2 * np.pi * a / n, 2 * np.pi * b / m
    r = 3.0 + np.cos(v)
    vertices = np.stack([r * np.cos(u), r * np.sin(u), np.sin(v)], axis=-1).reshape(-1, 3)

    def at(i: int, j: int) -> int:
        return (i % n) * m + j % m

    faces = [
        t for i in range(n) for j in range(m)
        for t in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))
    ]  # fmt: skip
    return vertices, np.array(faces)


def hollow() -> tuple[np.ndarray, np.ndarray]:
    """A cube with a cubic cavity."""
    outer, faces = box((4.0, 4.0, 4.0))
    return np.concatenate([outer, outer / 2]), np.concatenate([faces, faces[:, ::-1] + len(outer)])


SHAPES = {"box": box((3.0, 2.0, 1.0)), "torus": torus(14, 7), "hollow": hollow()}


@pytest.mark.parametrize("name", SHAPES)
def test_against_rationals(name: str, rng: np.random.Generator) -> None:
    vertices, faces = SHAPES[name]
    vertices = vertices + np.array([1.0, 2.0, 3.0])
    body = RigidBody.from_mesh(vertices, faces, density=2.0)
    for _ in range(15):
        normal = rng.integers(-9, 10, 3)
        point = (vertices[rng.integers(len(vertices))] + rng.choice([0.0, 0.3]) * rng.normal(size=3)).round(3)
        n, p = [Fraction(int(x)) for x in normal], [Fraction(float(x)) for x in point]
        volume, first = volume_beyond(vertices, faces, n, p)
        if not normal.any() or volume < Fraction(1, 10**6):
            continue
        part = body.cut(normal, point)
        assert part.mass == pytest.approx(2.0 * float(volume), rel=0, abs=1e-13 * float(body.mass))
        for c, f in zip(part.center_of_mass, first, strict=True):
            assert c * part.mass == pytest.approx(2.0 * float(f), rel=0, abs=1e-12 * float(body.mass))
        whole = part
        if body.mass - part.mass > 1e-6:
            whole = part + body.cut(-normal, point)
        else:
            assert part.mass == pytest.approx(float(body.mass), rel=1e-6)
        assert whole.isclose(body, rtol=1e-6 if whole is part else 1e-12)
        assert "closed" in part.provenance.checked


def test_planes_through_corners_edges_and_faces() -> None:
    vertices, faces = box((2.0, 2.0, 2.0))
    body = RigidBody.from_mesh(vertices, faces, density=1.0)
    for normal in itertools.product((-1, 0, 1), repeat=3):
        if any(normal):
            assert body.cut(normal).mass == pytest.approx(4.0, rel=1e-14)
    assert body.cut((0, 0, 1), point=(0, 0, -1)).isclose(body, rtol=1e-15)
    assert body.cut((0, 0, 1), point=(0, 0, -7)).isclose(body, rtol=1e-15)
    for point in ((0, 0, 1), (0, 0, 7)):
        with pytest.raises(PolhodeError, match="nothing lies beyond the plane"):
            body.cut((0, 0, 1), point=point)


def test_a_cap_of_a_fine_sphere_is_a_cap() -> None:
    n = 60
    theta, phi = np.meshgrid(
        np.linspace(0, np.pi, n + 1), 2 * np.pi * np.arange(2 * n) / (2 * n), indexing="ij"
    )
    vertices = np.stack(
        [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
    ).round(15)
    at = np.arange((n + 1) * 2 * n).reshape(n + 1, 2 * n)
    a, b, c, d = at[:-1], np.roll(at, -1, 1)[:-1], at[1:], np.roll(at, -1, 1)[1:]
    faces = np.concatenate([np.stack([a, c, d], -1).reshape(-1, 3), np.stack([a, d, b], -1).reshape(-1, 3)])
    ball = RigidBody.from_mesh(vertices.reshape(-1, 3), faces, density=1.0)
    height = 0.4
    assert ball.cut((0, 0, 1), point=(0, 0, 1 - height)).mass == pytest.approx(
        np.pi * height**2 * (3 - height) / 3, rel=3e-3
    )


def test_what_was_moved_is_cut_where_it_is() -> None:
    body = RigidBody.from_mesh(*box((2.0, 2.0, 2.0)), density=3.0)
    moved = (
        body.translated((10, 0, 0)).rotated((0, 0, 0.6, 0.8)).scaled(length=2.0, mass=5.0).mirrored((1, 2, 3))
    )
    half = moved.cut((3, 2, 1), point=moved.center_of_mass)
    assert half.mass == pytest.approx(0.5 * float(moved.mass), rel=1e-13)
    doubtful = body.with_sigma(mass=0.1)
    assert doubtful.cut((0, 0, 1)).covariance is None


def test_a_mesh_of_stl_whose_corners_stand_anew() -> None:
    vertices, faces = SHAPES["torus"]
    anew = vertices[faces].reshape(-1, 3)
    part = cut_mesh(anew, np.arange(len(anew)).reshape(-1, 3), (1, 2, 3), (0.1, 0.2, 0.3))
    same = cut_mesh(vertices, faces, (1, 2, 3), (0.1, 0.2, 0.3))
    one, other = (RigidBody.from_mesh(each.vertices, each.faces, density=1.0) for each in (part, same))
    assert one.isclose(other, rtol=1e-14)


@pytest.mark.parametrize("orient", [False, True])
@pytest.mark.parametrize("count", [4, 5])  # 5,120 faces, which a body holds, and 20,480, which it does not
def test_a_file_of_stl_is_cut_as_its_mesh(tmp_path: Path, orient: bool, count: int) -> None:
    vertices, faces = icosphere(count, 1.0)
    corners = vertices.astype(np.float32)[faces if not orient else faces[:, ::-1]]
    rows = np.zeros(len(faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    rows["corners"] = corners
    path = tmp_path / "ball.stl"
    path.write_bytes(b"\0" * 80 + np.uint32(len(faces)).tobytes() + rows.tobytes())
    body = RigidBody.from_file(path, density=Uncertain(2.0, 0.1), orient=orient)
    if count == 5:
        with pytest.raises(PolhodeError, match="at most 20,000 faces, and this one holds no shape"):
            body.cut((1, 2, 3))
        return
    assert body.sigma is not None
    assert float(body.sigma.mass) == pytest.approx(0.05 * float(body.mass))
    part = cut_mesh(vertices.astype(np.float32).astype(float), faces, (1, 2, 3), (0.1, 0.2, 0.3))
    whole = RigidBody.from_mesh(part.vertices, part.faces, density=2.0)
    assert body.cut((1, 2, 3), (0.1, 0.2, 0.3)).isclose(whole, rtol=1e-13)


PONTOON = {"name": "hull", "file": "hull.obj", "length_unit": "mm", "density": "1.025 g/cm^3"}
BELOW = solids.box((4.0, 2.0, 0.3), density=1025.0).translated((0.0, 0.0, -0.35))


@pytest.fixture
def hull(tmp_path: Path) -> Path:
    """A box of 4 by 2 by 1 m, in millimetres."""
    return write_obj(tmp_path / "hull.obj", *box((4000.0, 2000.0, 1000.0)))


def test_the_same_in_an_assembly_and_on_the_command_line(hull: Path) -> None:
    body = RigidBody.from_file(hull, density=1025.0, length_unit="mm").cut((0, 0, -1), (0, 0, -0.2))
    assert body.isclose(BELOW, rtol=1e-13)
    for cut in (
        {"normal": [0, 0, -2], "point": [0, 0, -200]},
        {"normal": "0 0 -1", "point": "0 0 -20 cm"},
        {"normal": [0, 0, -1], "point": [1, "2 m", "-0.2 m"]},
    ):
        made = assembly.read({"name": "a", "part": [PONTOON | {"cut": cut}]}, folder=hull.parent)
        assert made.body.isclose(BELOW, rtol=1e-13)
    moved = PONTOON | {"cut": {"normal": [0, 0, -1]}, "position": ["1 m", 0, 0], "mirror": [0, 0, 1]}
    made = assembly.read({"name": "a", "part": [moved]}, folder=hull.parent)
    upper = solids.box((4.0, 2.0, 0.5), density=1025.0).translated((1.0, 0.0, 0.25))
    assert made.body.isclose(upper, rtol=1e-13)  # cut in its own axes, then mirrored
    for words in (("0 0 -1", "--cut-point", "0 0 -200"), ("0", "0", "-1", "--cut-point", "0, 0, -0.2 m")):
        arguments = ("--length-unit", "mm", "--density", "1.025 g/cm^3", "--cut", *words, "--format", "json")
        code, out, err = run("report", hull, *arguments)
        assert code == 0, err
        told = json.loads(out)
        assert told["mass"] == pytest.approx(float(BELOW.mass), rel=1e-12)
        assert told["volume"] == pytest.approx(2.4, rel=1e-12)
        assert told["area"] == pytest.approx(2 * (4 * 2 + 4 * 0.3 + 2 * 0.3), rel=1e-12)
        assert any("is cut by a plane" in note for note in told["notes"])
    code, out, err = run("report", hull, "--mass", "5 ± 0.1", "--cut", "0 0 -1", "--format", "json")
    assert code == 0, err
    told = json.loads(out)  # a mass is that of the whole
    assert told["mass"] == pytest.approx(2.5, rel=1e-12)
    assert told["sigma"]["mass"] == pytest.approx(0.05, rel=1e-12)


def test_a_section_with_a_hole_and_one_that_is_not_convex(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "hollow.obj", *hollow())
    code, out, err = run("report", path, "--density", "1", "--cut", "0", "0", "1", "--format", "json")
    assert code == 0, err
    told = json.loads(out)
    assert told["volume"] == pytest.approx(32.0 - 4.0, rel=1e-13)
    assert told["area"] == pytest.approx(48.0 + 12.0 + 12.0, rel=1e-13)  # outside, cavity, section


def test_what_is_mended_or_large_is_cut(tmp_path: Path) -> None:
    vertices, faces = box((2.0, 2.0, 2.0))
    path = write_obj(tmp_path / "open.obj", vertices, faces[:-1])
    part = {"name": "a", "file": "open.obj", "density": 3, "length_unit": "m", "cut": {"normal": [1, 0, 0]}}
    half = solids.box((1.0, 2.0, 2.0), density=3.0).translated((0.5, 0, 0))
    made = assembly.read({"name": "a", "part": [part | {"repair": True}]}, folder=path.parent)
    assert made.body.isclose(half, rtol=1e-13)
    for key, value in (("closure", "caps"), ("orient", True), ("union", True)):
        own = part | {"file": "open.obj" if key == "closure" else "whole.obj"}
        write_obj(tmp_path / "whole.obj", vertices, faces)
        with pytest.raises(
            PolhodeError, match=rf"{key}: a mesh is cut as its file .* repair = true mends it"
        ):
            assembly.read({"name": "a", "part": [own | {key: value}]}, folder=path.parent)
    write_obj(tmp_path / "turned.obj", vertices, faces[:, ::-1])
    made = assembly.read(
        {"name": "a", "part": [part | {"file": "turned.obj", "repair": True}]}, folder=path.parent
    )
    assert made.body.isclose(half, rtol=1e-13)
    write_obj(tmp_path / "ball.obj", *icosphere(5))  # more faces than a body holds
    whole = RigidBody.from_file(tmp_path / "ball.obj", density=3.0)
    made = assembly.read({"name": "a", "part": [part | {"file": "ball.obj"}]}, folder=path.parent)
    assert made.body.mass == pytest.approx(float(whole.mass) / 2.0, rel=1e-9)
    doubtful = assembly.read(
        {"name": "a", "part": [part | {"repair": True, "density": "3 ± 1"}]}, folder=path.parent
    )
    sigma = doubtful.body.sigma
    assert sigma is not None
    assert sigma.mass == pytest.approx(4.0, rel=1e-13)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"cut": [0, 0, 1]}, r"part 'hull': cut: write a table with the normal of a plane"),
        ({"cut": {"point": [0, 0, 1]}}, r"part 'hull': cut: write a table with the normal of a plane"),
        ({"cut": {"normal": [0, 0, 1], "pont": 1}}, r"cut: 'pont' is not a known key; is 'point' meant"),
        ({"cut": {"normal": [0, 1]}}, r"cut: normal: expected 3 numbers, got 2"),
        ({"cut": {"normal": [0, 0, 0]}}, r"part 'hull': .*normal must not be the zero vector"),
        ({"cut": {"normal": [0, 0, 1], "point": [0, 0, 7000]}}, r"part 'hull': .*nothing lies beyond"),
        ({"cut": {"normal": [0, 0, 1]}, "thickness": 1}, r"cut: thickness makes a sheet"),
        ({"cut": {"normal": [0, 0, 1]}, "density": {"*": 1}}, r"cut: a solid of one density is cut"),
    ],
)
def test_what_an_assembly_refuses_to_cut(hull: Path, more: Any, says: str) -> None:
    with pytest.raises(PolhodeError, match=says):
        assembly.read({"name": "a", "part": [PONTOON | more]}, folder=hull.parent)


def test_refused() -> None:
    vertices, faces = box((2.0, 2.0, 2.0))
    body = RigidBody.from_mesh(vertices, faces, density=1.0)
    with pytest.raises(PolhodeError, match="holds the shape 'cuboid'"):
        solids.box((1, 1, 1), mass=1.0).cut((0, 0, 1))
    with pytest.raises(PolhodeError, match="holds no shape"):
        RigidBody(1.0, np.eye(3)).cut((0, 0, 1))
    with pytest.raises(PolhodeError, match="holds 2 shapes"):
        (body + body.translated((5, 0, 0))).cut((0, 0, 1))
    with pytest.raises(PolhodeError, match="got a stack"):
        RigidBody.stack([body, body]).cut((0, 0, 1))
    with pytest.raises(PolhodeError, match="zero vector"):
        body.cut((0, 0, 0))
    with pytest.raises(PolhodeError, match="point must be finite"):
        body.cut((0, 0, 1), point=(0, 0, np.nan))
    with pytest.raises(ValueError, match=r"normal: expected shape \(3,\)"):
        body.cut((0, 1))
    with pytest.raises(PolhodeError, match="expected numbers of vertices from 0 to 7"):
        cut_mesh(vertices, faces + 1, (0, 0, 1))


def test_components_that_overlap_are_told_of_a_cut_too(tmp_path: Path) -> None:
    path = written(tmp_path / "two.obj", at((1, 1, 1), (0, 0, 0)), at((1, 0.5, 0.7), (0.6, 0.1, 0.05)))
    options = ("--length-unit", "m", "--density", "2", "--cut", "0 0 1")
    for command in (("report",), ("spin", "--omega", "0 0 1")):
        code, out, _ = run(command[0], path, *options, *command[1:])
        assert code == 0
        assert "counts twice" in " ".join(out.split())
        assert "--union" not in out
    part = '[[part]]\nname = "a"\nfile = "two.obj"\nlength_unit = "m"\ndensity = 2\n'
    (tmp_path / "whole.toml").write_text(part + "cut = { normal = [0, 0, 1] }\n")
    code, out, _ = run("assemble", tmp_path / "whole.toml")
    assert code == 0
    assert "counts twice" in " ".join(out.split())
