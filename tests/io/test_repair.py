"""Meshes mended on request: each step told, right to rounding where the mesh was whole; off by default."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from mesh_files import binary_stl, obj
from oracles.meshes import cube, icosphere
from polhode import RigidBody
from polhode.errors import MeshError, PolhodeError
from polhode.io import solid_from_file

VERTICES, FACES = icosphere(2)
VERTICES = VERTICES * np.array([3.0, 2.0, 1.0]) + np.array([0.5, -1.0, 2.0])
WHOLE = RigidBody.from_mesh(VERTICES, FACES, density=1.0)
Mesh = tuple[Any, Any]


def doubled() -> Mesh:
    return VERTICES, np.concatenate([FACES, FACES[:2], FACES[7:9, [1, 2, 0]]])


def doubled_both_ways() -> Mesh:
    return VERTICES, np.concatenate([FACES, FACES[3:5, ::-1]])


def mixed() -> Mesh:
    faces = FACES.copy()
    faces[40:90] = faces[40:90, ::-1]
    return VERTICES, faces


def inside_out() -> Mesh:
    return VERTICES, FACES[:, ::-1]


def frayed() -> Mesh:
    corners = VERTICES[FACES].reshape(-1, 3)
    shaken = corners + np.random.default_rng(1).uniform(-1e-8, 1e-8, corners.shape)
    return shaken, np.arange(len(corners)).reshape(-1, 3)


def with_lines() -> Mesh:
    lines = np.array([[0, 1, 1], [5, 5, 5]])
    return VERTICES, np.concatenate([FACES, lines])


def all_at_once() -> Mesh:
    vertices, faces = mixed()
    return vertices, np.concatenate([faces, faces[:3], [[9, 9, 2]]])


def two_parts() -> Mesh:
    """One of them inside out, though it is no cavity."""
    return np.concatenate([VERTICES, VERTICES + 10.0]), np.concatenate(
        [FACES, FACES[:, ::-1] + len(VERTICES)]
    )


EXACT: dict[str, tuple[Callable[[], Mesh], list[str]]] = {
    "faces that stand twice": (doubled, ["drop"]),
    "faces that stand twice, seen from both sides": (doubled_both_ways, ["drop"]),
    "mixed winding": (mixed, ["orient"]),
    "all faces inward": (inside_out, ["orient"]),
    "corners that differ in their last digits": (frayed, ["weld"]),
    "faces without area": (with_lines, ["drop"]),
    "all at once": (all_at_once, ["drop", "orient"]),
}


def written(path: Path, mesh: Mesh) -> Path:
    path.write_bytes(obj(*mesh))
    return path


class TestExact:
    @pytest.mark.parametrize("name", EXACT)
    def test_the_body_is_that_of_the_whole_mesh(self, name: str, tmp_path: Path) -> None:
        make, steps = EXACT[name]
        path = written(tmp_path / "part.obj", make())
        solid = solid_from_file(path, density=1.0, repair=True)
        assert [step.name for step in solid.steps] == steps
        rtol = 1e-7 if name.startswith("corners") else 1e-13
        assert solid.body.mass == pytest.approx(float(WHOLE.mass), rel=rtol)
        np.testing.assert_allclose(solid.body.center_of_mass, WHOLE.center_of_mass, atol=rtol)
        np.testing.assert_allclose(solid.body.inertia, WHOLE.inertia, atol=10 * rtol * WHOLE.inertia.max())

    @pytest.mark.parametrize(
        "name", [name for name in EXACT if not name.startswith("faces that stand twice, ")]
    )
    def test_without_it_the_message_names_it_and_that_works(self, name: str, tmp_path: Path) -> None:
        path = written(tmp_path / "part.obj", EXACT[name][0]())
        code, out, err = run("report", str(path), "--density", "1")
        if name in ("all faces inward", "faces without area") and code == 0:
            return  # nothing is wrong with it
        assert (code, out) == (2, "")
        assert one_line(err)
        assert ("--weld " if name.startswith("corners") else "--repair mends it") in err
        code, out, _ = run("report", str(path), "--density", "1", "--repair")
        assert code == 0

    def test_parts_that_face_inward(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.obj", two_parts())
        solid = solid_from_file(path, density=1.0, repair=True)
        assert solid.body.mass == pytest.approx(2 * float(WHOLE.mass), rel=1e-13)
        assert [step.name for step in solid.steps] == ["orient"]
        assert solid.steps[0].change == pytest.approx(100.0, rel=1e-9)

    def test_a_cavity_stays_one(self, tmp_path: Path) -> None:
        outer, inner = cube(4.0), cube(2.0)
        shift = np.full(3, 0.0)
        vertices = np.concatenate(
            [outer[0] - outer[0].mean(axis=0), inner[0] - inner[0].mean(axis=0) + shift]
        )
        faces = np.concatenate([outer[1], inner[1][:, ::-1] + len(outer[0])])
        mixed_up = np.concatenate([faces, faces[:1]])
        solid = solid_from_file(
            written(tmp_path / "part.obj", (vertices, mixed_up)), density=1.0, repair=True
        )
        assert solid.body.mass == pytest.approx(64.0 - 8.0, rel=1e-14)


class TestFilled:
    def test_a_flat_hole_is_filled_exactly(self, tmp_path: Path) -> None:
        """What is open of a cube is flat: the fan is the wall that was taken away."""
        vertices, faces = cube(2.0)
        top = np.flatnonzero((vertices[faces][:, :, 2] == vertices[:, 2].max()).all(axis=1))
        path = written(tmp_path / "part.obj", (vertices, np.delete(faces, top, axis=0)))
        solid = solid_from_file(path, density=1.0, repair=True)
        assert solid.body.mass == pytest.approx(8.0, rel=1e-14)
        (step,) = solid.steps
        assert (step.name, step.what) == ("fill", "1 loop of 4 edges closed by fans of triangles")
        # The five walls span five sixths with the middle.
        assert step.change == pytest.approx(100.0 / 6.0, rel=1e-12)

    def test_it_is_what_closure_caps_does(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.obj", (VERTICES, np.delete(FACES, [0, 1, 2, 50, 51, 200], axis=0)))
        mended = solid_from_file(path, density=1.0, repair=True)
        capped = RigidBody.from_file(path, density=1.0, closure="caps")
        assert mended.body.mass == pytest.approx(capped.mass, rel=1e-14)
        np.testing.assert_allclose(mended.body.inertia, capped.inertia, rtol=1e-12)
        provenance = mended.body.provenance
        assert provenance.closure == "caps"
        assert provenance.volume_change == pytest.approx(capped.provenance.volume_change, rel=1e-9)


class TestTold:
    def test_report(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.obj", all_at_once())
        code, out, _ = run("report", str(path), "--density", "1", "--repair", "--format", "json")
        told = json.loads(out)
        assert code == 0
        assert [row["step"] for row in told["repaired"]] == ["drop", "orient"]
        total = sum(row["volume_change_percent"] for row in told["repaired"])
        (note,) = (note for note in told["notes"] if "was repaired (--repair)" in note)
        (share,) = re.findall(r"by (\S+) % in all", note)
        assert float(share) == pytest.approx(total, rel=1e-2)
        out = run("report", str(path), "--density", "1", "--repair")[1]
        assert "4 faces that stand twice or are lines dropped" in out
        assert "50 faces turned" in out

    def test_provenance(self, tmp_path: Path) -> None:
        body = solid_from_file(written(tmp_path / "part.obj", mixed()), density=1.0, repair=True).body
        assert body.provenance.checked.endswith(", repaired")
        assert RigidBody.from_file(tmp_path / "part.obj", density=1.0, repair=True) == body
        assert "repaired" not in WHOLE.provenance.checked

    def test_a_good_mesh_is_left_alone(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.obj", (VERTICES, FACES))
        solid = solid_from_file(path, density=1.0, repair=True)
        assert solid.steps == ()
        assert solid.body == RigidBody.from_file(path, density=1.0)
        assert "nothing had to be repaired" in run("report", str(path), "--density", "1", "--repair")[1]

    def test_a_binary_stl(self, tmp_path: Path) -> None:
        path = tmp_path / "part.stl"
        path.write_bytes(binary_stl(*mixed()))
        assert "--repair mends it (orient; volume changed by" in run("report", str(path), "--density", "1")[2]
        assert run("report", str(path), "--density", "1", "--repair")[0] == 0


class TestLimits:
    def test_what_closes_by_itself(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.obj", mixed())
        for option, words in (("closure", {"closure": "hull"}), ("orient", {"orient": True})):
            with pytest.raises(
                PolhodeError, match=f"{option}: repair closes and orients by itself; leave one"
            ):
                solid_from_file(path, density=1.0, repair=True, **words)
        code, _, err = run("report", str(path), "--density", "1", "--repair", "--orient")
        assert code == 2
        assert one_line(err)

    def test_where_only_the_hull_serves(self, tmp_path: Path) -> None:
        """A strip with a half turn has no inside that winding could tell; its hull has."""
        pytest.importorskip("scipy")
        t = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
        edge = np.stack([np.cos(t / 2) * np.cos(t), np.cos(t / 2) * np.sin(t), np.sin(t / 2)], axis=-1) * 0.4
        middle = np.stack([np.cos(t), np.sin(t), np.zeros(24)], axis=-1) * 2.0
        vertices = np.concatenate([middle + edge, middle - edge])
        faces = []
        for k in range(24):
            a, b = k, k + 24
            c, d = ((k + 1), (k + 25)) if k < 23 else (24, 0)
            faces += [[a, b, c], [c, b, d]]
        path = written(tmp_path / "strip.obj", (vertices, np.array(faces)))
        code, _, err = run("report", str(path), "--density", "1")
        assert code == 2
        assert "--closure hull" in err
        assert run("report", str(path), "--density", "1", "--closure", "hull")[0] == 0

    def test_a_surface_with_one_side(self, tmp_path: Path) -> None:
        """Klein's bottle is closed, but no winding of its triangles is consistent."""
        pytest.importorskip("scipy")
        n, m = 16, 12
        rows, columns = (grid.ravel() for grid in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
        u, v = 2 * np.pi * rows / n, 2 * np.pi * (columns + 0.5) / m  # no corner where it passes itself
        r = 3.0 + np.cos(u / 2) * np.sin(v) - np.sin(u / 2) * np.sin(2 * v)
        height = np.sin(u / 2) * np.sin(v) + np.cos(u / 2) * np.sin(2 * v)
        vertices = np.stack([r * np.cos(u), r * np.sin(u), height], axis=-1)

        def at(i: int, j: int) -> int:
            return (i * m + j % m) if i < n else (-j - 1) % m

        faces = [
            face
            for i in range(n)
            for j in range(m)
            for face in (
                [at(i, j), at(i + 1, j), at(i, j + 1)],
                [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)],
            )
        ]
        path = written(tmp_path / "bottle.obj", (vertices, np.array(faces)))
        code, _, err = run("report", str(path), "--density", "1")
        assert code == 2
        assert "--repair" not in err
        assert "not consistently wound" in err
        assert "--closure hull takes the convex hull instead" in err
        assert run("report", str(path), "--density", "1", "--closure", "hull")[0] == 0
        code, _, err = run("report", str(path), "--density", "1", "--repair")
        assert code == 2
        assert "--repair" not in err.partition("bottle.obj")[2]

    def test_corners_nearer_than_32_bits_tell(self, tmp_path: Path) -> None:
        """Far from the origin all corners of a small part are that near: they are not joined."""
        small = VERTICES * 1e-7 + np.array([1.0, 0.0, 0.0])
        solid = solid_from_file(written(tmp_path / "part.obj", (small, mixed()[1])), density=1.0, repair=True)
        assert [step.name for step in solid.steps] == ["orient"]
        assert solid.body.mass == pytest.approx(float(WHOLE.mass) * 1e-21, rel=1e-6)
        with pytest.raises(ValueError, match="give a smaller length"):
            solid_from_file(tmp_path / "part.obj", density=1.0, repair=True, weld=1e-7)

    def test_what_nothing_mends(self, tmp_path: Path) -> None:
        sheet = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]])
        path = written(tmp_path / "sheet.obj", sheet)
        with pytest.raises(MeshError):
            solid_from_file(path, density=1.0, repair=True)
        assert "--repair" not in run("report", str(path), "--density", "1")[2]

    def test_every_command_of_a_message_runs(self, tmp_path: Path) -> None:
        """Of corners that differ in their last digits the first: caps between them enclose nothing."""
        pytest.importorskip("scipy")
        torn = VERTICES, FACES[3:]
        for mesh, first in (
            (frayed(), ["--weld"]),
            (torn, ["--repair", "--closure", "--closure"]),
        ):
            path = written(tmp_path / "part.obj", mesh)
            err = run("report", str(path), "--density", "1")[2]
            ways = re.findall(r"--(?:weld [^ ,]+|repair|closure \w+)", err)
            assert [way.split()[0] for way in ways][: len(first)] == first
            for way in ways[: len(first)]:
                assert run("report", str(path), "--density", "1", *shlex.split(way))[0] == 0, way


class TestUnusualSizes:
    @pytest.mark.parametrize(
        ("side", "unit", "likely"),
        [
            (30.0, "m", "mm"),
            (21.0, "m", None),
            (22.0, "m", "mm"),
            (0.04, "mm", "m"),
            (5.0, "mm", None),
            (30.0, "km", None),
        ],
    )
    def test_are_remarked(self, side: float, unit: str, likely: str | None, tmp_path: Path) -> None:
        path = written(tmp_path / "part.obj", cube(side))
        code, out, _ = run("report", str(path), "--density", "1000", "--length-unit", unit)
        assert code == 0
        assert ("is unusual for a part" in out) == (likely is not None)
        if likely is not None:
            assert f"in {likely} it would be" in out
            assert f"check that the file is in {unit}, as --length-unit says" in out
            again = run("report", str(path), "--density", "1000", "--length-unit", likely)[1]
            assert "is unusual" not in again
