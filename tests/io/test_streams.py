"""Binary STL and PLY larger than a block: same body, same faults, little memory, progress and Ctrl-C."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run, write_obj
from mesh_files import binary_ply
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import box, icosphere, merge
from polhode import RigidBody
from polhode.errors import FileFormatError, MeshError
from polhode.io import read_mesh, solid_from_file

if TYPE_CHECKING:
    from pathlib import Path

STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl(vertices: Any, faces: Any, repeats: int = 1) -> bytes:
    """A binary STL; repeated, each time a little farther to the side."""
    records = np.zeros(len(faces) * repeats, dtype=STL_RECORD)
    corners = vertices[faces].astype(np.float32)
    for k in range(repeats):
        rows = slice(k * len(faces), (k + 1) * len(faces))
        records["corners"][rows] = corners + np.float32(4 * k) * np.array([1, 0, 0], dtype=np.float32)
    return b"part".ljust(80) + len(records).to_bytes(4, "little") + records.tobytes()


@pytest.fixture(scope="module")
def ball() -> Any:
    """5120 triangles with coordinates that 32 bits hold."""
    vertices, faces = icosphere(4)
    return vertices.astype(np.float32).astype(np.float64), faces


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A million triangles in 195 balls, 51 MB."""
    path: Path = tmp_path_factory.mktemp("large") / "balls.stl"
    path.write_bytes(stl(*icosphere(4), repeats=195))
    return path


class TestBodies:
    @pytest.mark.parametrize("kind", ["stl", "ply"])
    def test_against_exact_arithmetic(self, kind: str, ball: Any, tmp_path: Path) -> None:
        path = tmp_path / f"ball.{kind}"
        path.write_bytes(stl(*ball) if kind == "stl" else binary_ply(*ball))
        exact = polyhedron(*ball)
        found = solid_from_file(path, density=1.0)
        body = found.body
        assert body.mass == pytest.approx(float(exact.volume), rel=4e-15)
        inertia = np.array(exact.inertia, dtype=float)
        np.testing.assert_allclose(body.inertia, inertia, rtol=0, atol=8e-15 * inertia.max())
        assert (found.faces, found.volume) == (5120, body.mass)
        assert found.area == pytest.approx(12.55, abs=0.02)
        assert abs(body.mass - float(exact.volume)) <= body.error_bound.mass

    def test_a_needle_is_gone_through_again(self, tmp_path: Path) -> None:
        turn = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
        vertices, faces = box((1e-3, 2e-3, 1.0))
        vertices = (vertices @ turn).astype(np.float32).astype(np.float64)
        path = tmp_path / "needle.stl"
        path.write_bytes(stl(vertices, faces))
        body = RigidBody.from_file(path, mass=1.0)
        want = RigidBody.from_mesh(vertices, faces, mass=1.0, orient=True)
        assert body.provenance.moments == "second moment in own axes"
        assert body.principal_moments == pytest.approx(want.principal_moments, rel=1e-14)

    def test_units_and_mass(self, ball: Any, tmp_path: Path) -> None:
        path = tmp_path / "ball.stl"
        path.write_bytes(stl(*ball))
        small = RigidBody.from_file(path, mass=2.0, length_unit="mm")
        large = RigidBody.from_file(path, mass=2.0)
        assert small.inertia == pytest.approx(large.inertia * 1e-6, rel=1e-13, abs=1e-20)
        found = solid_from_file(path, mass=2.0, scale=1e-3)
        assert found.volume == pytest.approx(solid_from_file(path, density=1.0).volume * 1e-9, rel=1e-14)


class TestFaults:
    def test_they_name_the_triangle_and_the_place(self, ball: Any, tmp_path: Path) -> None:
        vertices, faces = ball
        for missing in (0, 4095, 4096, 5119):
            path = tmp_path / "open.stl"
            path.write_bytes(stl(vertices, np.delete(faces, missing, axis=0)))
            with pytest.raises(
                MeshError, match=r"open\.stl: the mesh is not closed.*\(3 such edges"
            ) as caught:
                RigidBody.from_file(path, density=1.0)
            corner = vertices[faces[missing][0]].tolist()
            assert any(str(tuple(vertices[k].tolist())) in str(caught.value) for k in faces[missing]), corner

    def test_turned_and_doubled_faces_and_numbers_that_are_none(self, ball: Any, tmp_path: Path) -> None:
        vertices, faces = ball
        turned = faces.copy()
        turned[5000] = turned[5000][::-1]
        bad = vertices.copy()
        bad[100, 1] = np.nan
        for mesh, message in (
            ((vertices, turned), r"not consistently wound: faces\[\d+\] and faces\[\d+\] both run from \("),
            ((vertices, [*faces.tolist(), faces[7].tolist()]), r"faces\[7\] and faces\[5120\] are the same"),
            ((bad, faces), r"faces\[\d+\] has a corner that is not finite: \(.*NaN"),
            ((vertices, faces[:, ::-1]), "inverted"),
        ):
            path = tmp_path / "bad.stl"
            path.write_bytes(stl(mesh[0], np.asarray(mesh[1])))
            with pytest.raises(MeshError, match=message):
                RigidBody.from_file(path, density=1.0)

    def test_binary_ply_is_read_whole_or_not(self, ball: Any, tmp_path: Path) -> None:
        data = binary_ply(*ball)
        path = tmp_path / "ball.ply"
        for damaged, message in (
            (data[:-1], "promises 5120 face elements, but the file ends in number 5119"),
            (data[:5000], "promises 2562 vertex elements"),
            (data + b"\0", "bytes after its last element"),
            (data.replace(b"property double z", b"property double w"), "no x, y and z"),
            (data.replace(b"double z", b"doubel z"), "header line"),
        ):
            path.write_bytes(damaged)
            with pytest.raises(FileFormatError, match=message):
                RigidBody.from_file(path, density=1.0)
        path.write_bytes(data[:-4] + (9999).to_bytes(4, "little"))
        with pytest.raises(MeshError, match=r"faces\[5119\] names vertex 9999, but there are 2562"):
            RigidBody.from_file(path, density=1.0)

    def test_polygons_are_fans_in_both_byte_orders(self, tmp_path: Path) -> None:
        pytest.importorskip("trimesh")
        vertices, _ = box((1.0, 2.0, 3.0))
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        for order, mark in (("little", "<"), ("big", ">")):
            header = (
                f"ply\nformat binary_{order}_endian 1.0\nelement vertex 8\nproperty float x\n"
                "property float y\nproperty float z\nproperty uchar red\nelement face 6\n"
                "property list uchar uint vertex_index\n"
                "end_header\n"
            )
            rows = np.zeros(8, dtype=[("r", f"{mark}f4", 3), ("red", "u1")])
            rows["r"] = vertices
            faces = np.zeros(6, dtype=[("n", "u1"), ("k", f"{mark}u4", 4)])
            faces["n"], faces["k"] = 4, quads
            path = tmp_path / "box.ply"
            path.write_bytes(header.encode() + rows.tobytes() + faces.tobytes())
            body = RigidBody.from_file(path, density=1.0)
            assert body.mass == pytest.approx(6.0, rel=1e-15)
            assert body.provenance.elements == 12
            assert len(read_mesh(path).faces) == 12


class TestCavities:
    def test_a_part_that_is_inside_out_is_told_and_turned(self, tmp_path: Path) -> None:
        (ball, faces), (vertices, sides) = icosphere(2), box((1.0, 1.0, 1.0))
        for center, volume in ((3.0, 4.05 + 0.125), (0.0, 4.05 - 0.125)):
            mesh = merge((ball, faces), (vertices / 2 + center, sides[:, ::-1]))
            path = tmp_path / "two.stl"
            path.write_bytes(stl(*mesh))
            if center:
                with pytest.raises(MeshError, match=r"two\.stl: .*12 connected faces with faces\[320\]"):
                    RigidBody.from_file(path, density=1.0)
            found = solid_from_file(path, density=1.0, orient=True)
            assert found.volume == pytest.approx(volume, rel=1e-2)
            assert found.body.mass == found.volume
            assert "cavities" in found.body.provenance.checked


class TestLargeFiles:
    def test_little_memory_is_needed(self, many: Path) -> None:
        program = f"""
import resource
from polhode import RigidBody
used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
body = RigidBody.from_file({str(many)!r}, density=1.0)
assert body.provenance.elements == 195 * 5120
assert body.provenance.checked.endswith("duplicates")  # that parts lie in parts is checked of fewer
grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - used
assert grown < 30_000, grown  # kilobytes: eight bytes a triangle, a block and some sums
"""
        subprocess.run([sys.executable, "-c", program], check=True, timeout=60)

    def test_progress_rises_to_one(self, many: Path) -> None:
        seen: list[float] = []
        RigidBody.from_file(many, density=1.0, progress=seen.append)
        assert seen == sorted(seen)
        assert seen[-1] == 1.0
        assert 0.0 < seen[0] < 1.0

    def test_what_progress_raises_ends_the_reading(self, many: Path) -> None:
        def enough(fraction: float) -> None:
            raise KeyError(f"enough at {fraction:.0%}")

        with pytest.raises(KeyError, match="enough at"):
            RigidBody.from_file(many, density=1.0, progress=enough)

    def test_an_interrupt_ends_it(self, many: Path) -> None:
        seen: list[float] = []

        def interrupt(fraction: float) -> None:
            seen.append(fraction)
            if len(seen) == 1:
                signal.raise_signal(signal.SIGINT)

        assert threading.current_thread() is threading.main_thread()
        with pytest.raises(KeyboardInterrupt):
            RigidBody.from_file(many, density=1.0, progress=interrupt)
        assert len(seen) <= 2


def test_a_file_called_as_standard_input(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As everywhere, "./-" names the file and "-" the stream."""
    monkeypatch.chdir(tmp_path)
    write_obj(tmp_path / "slab.obj", *box((1.0, 2.0, 3.0)))
    assert run("report", "slab.obj", "--mass", "2", "--output", "./-.json")[0] == 0
    (tmp_path / "-.json").rename(tmp_path / "-")
    code, _, err = run("report", "./-")
    assert code == 2  # read, but without a suffix that names its format
    assert str(tmp_path / "-") in err
