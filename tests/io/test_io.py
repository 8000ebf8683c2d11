"""Reading bodies from files: every format the same body, every damage one clear error."""

from __future__ import annotations

import struct
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from mesh_files import WRITERS, Writer, ascii_ply, ascii_stl, binary_ply, binary_stl, glb, obj, off
from numpy.typing import NDArray
from oracles import worst_error
from oracles.exact_polyhedron import polyhedron
from oracles.meshes import cube, icosphere, tetrahedron
from polhode import RigidBody, samples
from polhode.errors import FileFormatError, MeshError, PolhodeError
from polhode.io import Mesh, read_mesh
from polhode.units import METRES, metres_per

if TYPE_CHECKING:
    from pathlib import Path

Floats = NDArray[np.float64]


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str, bytes], Path]:
    def writer(name: str, data: bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(data)
        return path

    return writer


# every format gives the same body -----------------------------------------------------


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("shape", [cube, tetrahedron])
def test_every_format_gives_the_same_body(kind: str, shape: Any, write: Any) -> None:
    suffix, writer, name = WRITERS[kind]
    vertices, faces = shape(2.0)
    vertices = vertices + np.array([3.0, -1.0, 0.5])  # exact in 32 bits too
    path = write(f"part{suffix}", writer(vertices, faces))
    mesh = read_mesh(path)
    assert isinstance(mesh, Mesh)
    assert mesh.format == name
    assert mesh.vertices.dtype == np.float64
    assert mesh.faces.dtype == np.int64
    assert mesh.vertices.shape == vertices.shape  # corners welded where the format stores them apart
    assert mesh.faces.shape == faces.shape
    exact = polyhedron(vertices, faces)
    body = RigidBody.from_file(path, density=1.0)
    assert body.mass == pytest.approx(float(exact.volume), rel=4e-15)
    np.testing.assert_allclose(body.center_of_mass, np.array(exact.centroid, dtype=float), rtol=4e-15)
    inertia = np.array(exact.inertia, dtype=float)
    np.testing.assert_allclose(body.inertia, inertia, rtol=0, atol=4e-15 * inertia.max())


def test_text_formats_keep_every_bit(write: Any) -> None:
    vertices, faces = icosphere(2, radius=1 / 3)
    writers: dict[str, Writer] = {"a.obj": obj, "a.stl": ascii_stl, "a.ply": ascii_ply, "b.ply": binary_ply}
    for name, writer in writers.items():
        mesh = read_mesh(write(name, writer(vertices, faces)))
        corners, expected = mesh.vertices[mesh.faces], vertices[faces]
        assert corners.tobytes() == expected.tobytes(), name


def test_ascii_stl_of_several_solids_with_odd_names(write: Any) -> None:
    vertices, faces = cube(1.0)
    apart = ascii_stl(vertices + 5.0, faces, "vertex 1 2 3 facet").replace(b"\n", b"\r\n").upper()
    data = ascii_stl(vertices, faces, "solid gr\xfc\xdf") + apart.replace(b"\xc3", b"\xe9")
    body = RigidBody.from_file(write("two.stl", data), mass=2.0)
    np.testing.assert_allclose(body.center_of_mass, [2.5, 2.5, 2.5], rtol=1e-15)


def test_large_ascii_stl_is_read_in_blocks(write: Any) -> None:
    vertices, faces = icosphere(4)  # 5120 triangles, more than one block
    mesh = read_mesh(write("ball.stl", ascii_stl(vertices, faces)))
    assert mesh.vertices.shape == (2562, 3)
    assert mesh.faces.shape == (5120, 3)


def test_faces_counted_from_zero(write: Any) -> None:
    vertices, faces = cube(2.0)
    path = write("plates.tab", obj(vertices, faces, base=0))
    with pytest.raises(FileFormatError, match=r"counts from 0 say so: index_base=0"):
        read_mesh(path)
    mesh = read_mesh(path, index_base=0)
    np.testing.assert_array_equal(mesh.faces, faces)


def test_index_base_is_checked(write: Any) -> None:
    path = write("part.stl", binary_stl(*cube()))
    with pytest.raises(ValueError, match="not v/f text"):
        read_mesh(path, index_base=0)
    with pytest.raises(ValueError, match="expected 0 or 1, got 2"):
        read_mesh(write("part.obj", obj(*cube())), index_base=2)


# scenes -----------------------------------------------------


def scene_file(tmp_path: Path, transforms: list[Floats]) -> Path:
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    part = trimesh.Trimesh(*tetrahedron(1.0), process=False)
    for number, transform in enumerate(transforms):
        scene.add_geometry(part, node_name=f"node {number}", geom_name="part", transform=transform)
    path = tmp_path / "scene.glb"
    path.write_bytes(scene.export(file_type="glb"))
    return path


def test_scene_places_its_nodes(tmp_path: Path) -> None:
    shift, mirror, turn = np.eye(4), np.eye(4), np.eye(4)
    shift[:3, 3] = [10, 0, 0]
    mirror[:3, :3] = np.diag([-2.0, 1, 1])
    turn[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    turn[:3, 3] = [0, -20, 0]
    body = RigidBody.from_file(scene_file(tmp_path, [shift, mirror, turn]), density=1.0)
    # Three corner tetrahedra: volume 1/6 each but for the stretched one, centroid at a quarter of the legs.
    volumes = np.array([1, 2, 1]) / 6
    centroids = np.array([[10.25, 0.25, 0.25], [-0.5, 0.25, 0.25], [-0.25, -19.75, 0.25]])
    assert body.mass == pytest.approx(volumes.sum(), rel=1e-15)
    np.testing.assert_allclose(body.center_of_mass, volumes @ centroids / volumes.sum(), rtol=1e-14)


# damage -----------------------------------------------------

STL = binary_stl(*cube())


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("empty.stl", b"", "empty"),
        ("empty.obj", b"", "empty"),
        ("empty.ply", b"", "empty"),
        ("cut.stl", STL[:-30], "truncated"),
        ("few.stl", b"ab\x00c", "few.stl"),
        ("huge.stl", STL[:80] + struct.pack("<I", 4_000_000_000) + STL[84:134], "4000000000"),
        ("text.stl", b"dear reader,\nthis is no mesh\n", "named .stl, but it is text"),
        ("noend.stl", ascii_stl(*cube()).rpartition(b"endsolid")[0], "endsolid"),
        ("half.stl", ascii_stl(*cube())[:700], "cut short"),
        ("two.stl", ascii_stl(*cube()) + ascii_stl(*cube())[:-20], "cut short"),
        ("word.stl", ascii_stl(*cube()).replace(b"vertex", b"vertx", 1), "expected 'vertex', got 'vertx'"),
        ("value.stl", ascii_stl(*cube()).replace(b"vertex -0.5", b"vertex -0,5", 1), "-0,5"),
        ("none.stl", b"solid facet\nendsolid facet\n", "no triangles"),
        ("cut.ply", ascii_ply(*cube())[: -len(b"3 0 0 0\n")], "promises 12 faces"),
        ("points.ply", ascii_ply(cube()[0], cube()[1][:0]), "points|triangles"),
        ("index.ply", ascii_ply(*cube()).replace(b"\n3 0", b"\n3 -1"), "names a vertex"),
        ("cut.off", off(*cube()).rpartition(b"3 ")[0], "promises 12 faces"),
        ("cut.glb", glb(*cube())[:-7], "not a readable GLB"),
        ("words.ply", b"dear reader\n", "not a readable PLY"),
        ("words.off", b"dear reader\n", "not a readable OFF"),
        ("words.obj", b"dear reader\n", "words.obj"),
        ("bytes.obj", b"v \x00\x01\x02", "not text"),
        ("part.foo", b"v 0 0 0\n", "named .foo, but its content is v/f text; rename it to end in .obj"),
        ("words.foo", b"dear reader\n", "named .foo are not read; use one of .stl"),
        ("part", b"v 0 0 0\n", "without a suffix"),
        ("ply.stl", ascii_ply(*cube()), "content is PLY"),
        ("obj.stl", obj(*cube()), "content is v/f text"),
        ("stl.obj", STL, "content is binary STL"),
        ("stl.ply", ascii_stl(*cube()), "content is ASCII STL"),
        ("off.ply", off(*cube()), "content is OFF"),
        ("zip.glb", b"PK\x03\x04....", "content is a ZIP archive"),
        ("water.txt", b"1\nneon\nNe 0 0 0\n", "content is XYZ"),
    ],
)
def test_damaged_or_misnamed_file_is_one_clear_error(
    name: str, data: bytes, message: str, write: Any
) -> None:
    path = write(name, data)
    with pytest.raises(FileFormatError, match=message) as caught:
        read_mesh(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_directory_and_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="is a directory"):
        read_mesh(tmp_path)
    with pytest.raises(FileNotFoundError, match=r"absent\.stl"):
        read_mesh(tmp_path / "absent.stl")


def test_header_that_promises_too_much_allocates_nothing(write: Any) -> None:
    path = write("huge.stl", STL[:80] + struct.pack("<I", 4_000_000_000) + STL[84:134])
    program = f"""
import resource
from polhode.errors import FileFormatError
from polhode.io import read_mesh
used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))  # a fiftieth of what the header promises
try:
    read_mesh({str(path)!r})
except FileFormatError:
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - used < 20_000, "allocated"
else:
    raise AssertionError("read it")
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_open_mesh_is_refused_and_not_closed(write: Any) -> None:
    vertices, faces = cube()
    with pytest.raises(MeshError, match=r"open\.obj: the mesh is not closed"):
        RigidBody.from_file(write("open.obj", obj(vertices, faces[1:])), density=1.0)


def test_corners_that_nearly_coincide_are_welded_on_request_only(write: Any) -> None:
    """As some exporters write them: zero in one triangle, 1e-17 in the next."""
    vertices, faces = cube(2.0)
    corners = vertices[faces].reshape(-1, 3) + 1.0
    corners[corners == 0.0] = np.resize([0.0, 1e-17, -3e-17], (corners == 0.0).sum())
    path = write("frayed.stl", binary_stl(corners, np.arange(len(corners)).reshape(-1, 3)))
    with pytest.raises(
        MeshError, match=r"not closed.* corners lie within 2e-07 of another, weld=2e-07 joins"
    ):
        RigidBody.from_file(path, density=1.0)
    mesh = read_mesh(path, weld=1e-12)
    assert mesh.vertices.shape == (8, 3)
    body = RigidBody.from_mesh(mesh.vertices, mesh.faces, density=1.0)
    assert body.mass == pytest.approx(8.0, rel=1e-15)


def test_welding_keeps_a_mesh_that_needs_none(write: Any) -> None:
    path = write("ball.obj", obj(*icosphere(3)))
    for a, b in zip(read_mesh(path), read_mesh(path, weld=1e-9), strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("length", [-1.0, np.nan, np.inf])
def test_weld_is_a_positive_length(length: float, write: Any) -> None:
    with pytest.raises(ValueError, match="not a positive length"):
        read_mesh(write("part.stl", STL), weld=length)


def test_weld_that_would_join_far_corners_by_a_chain_is_refused(write: Any) -> None:
    with pytest.raises(ValueError, match="would join corners up to"):
        read_mesh(write("ball.obj", obj(*icosphere(3))), weld=0.1)


def test_without_trimesh_the_remedy_is_named(write: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    path = write("part.ply", ascii_ply(*cube()))
    with pytest.raises(ModuleNotFoundError, match=r'pip install "polhode\[mesh\]"'):
        read_mesh(path)
    assert len(read_mesh(write("part.stl", STL)).faces) == 12  # needs no extra
    assert len(read_mesh(write("part2.stl", ascii_stl(*cube()))).faces) == 12


# units -----------------------------------------------------


def test_length_unit_converts_to_metres(write: Any) -> None:
    path = write("cube.obj", obj(*cube(2.0)))
    for unit, metres in METRES.items():
        body = RigidBody.from_file(path, density=3.0, length_unit=unit)
        assert body.mass == pytest.approx(3.0 * (2.0 * metres) ** 3, rel=4e-15)
        assert metres_per(unit) == metres
    assert RigidBody.from_file(path, density=3.0).mass == pytest.approx(24.0, rel=1e-15)
    with pytest.raises(PolhodeError, match=r"'inches' is not a known unit; use one of m, mm"):
        RigidBody.from_file(path, density=3.0, length_unit="inches")


def test_mass_and_density_exclude_each_other(write: Any) -> None:
    path = write("cube.obj", obj(*cube(2.0)))
    assert RigidBody.from_file(path, mass=5.0).mass == 5.0
    wrong: list[Any] = [{}, {"mass": 1.0, "density": 1.0}]
    for given in wrong:
        with pytest.raises((TypeError, ValueError), match="exactly one of mass= and density="):
            RigidBody.from_file(path, **given)


# real files -----------------------------------------------------


def test_an_asteroid() -> None:
    mesh = read_mesh(samples.path("asteroid.obj"))
    exact = polyhedron(mesh.vertices, mesh.faces)
    body = RigidBody.from_file(samples.path("asteroid.obj"), density=1.0)
    assert worst_error(body.mass, exact.volume) <= 4e-15
    assert worst_error(body.inertia, exact.inertia) <= 4e-15


def test_indices_from_zero_are_refused_until_their_base_is_given(write: Any) -> None:
    whole = read_mesh(samples.path("asteroid.obj"))
    path = write("rock.tab", obj(whole.vertices, whole.faces, 0))
    with pytest.raises(FileFormatError, match=r"index_base=0"):
        RigidBody.from_file(path, density=1.0)
    mesh = read_mesh(path, index_base=0)
    assert np.array_equal(mesh.faces, whole.faces)
    assert RigidBody.from_file(path, density=1.0, index_base=0) == RigidBody.from_mesh(
        whole.vertices, whole.faces, density=1.0
    )


def test_parts_once_their_corners_are_welded(write: Any) -> None:
    """Corners of 64-bit numbers that a program rounded to 32 bits, some of them down and some up."""
    whole = read_mesh(samples.path("torus.obj"))
    corners = whole.vertices[whole.faces].astype(np.float32).reshape(-1, 3)
    corners[::5] = np.nextafter(corners[::5], np.float32(0.0))
    path = write("ring.stl", binary_stl(corners.astype(float), np.arange(len(corners)).reshape(-1, 3)))
    with pytest.raises(MeshError, match=r"corners lie within \de-06 of another, weld="):
        RigidBody.from_file(path, density=1.0)
    body = RigidBody.from_file(path, density=1.0, weld=1e-5)
    assert bool(body.isclose(RigidBody.from_file(samples.path("torus.obj"), density=1.0), rtol=1e-6))


def _agrees(computed: float, printed: str) -> None:
    """To half a unit of the last digit printed."""
    decimals = len(printed.partition(".")[2])
    assert abs(Fraction(float(computed)) - Fraction(printed)) <= Fraction(1, 2 * 10**decimals), (
        computed,
        printed,
    )
