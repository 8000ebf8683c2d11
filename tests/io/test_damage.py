"""Damaged, foreign and endless files: one clear error that names the file, soon; never anything else."""

from __future__ import annotations

import bz2
import json
import os
import resource
import socket
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run
from damage import KINDS, every_damage, tally, whole_file
from mesh_files import ascii_ply, glb, obj
from oracles.meshes import cube
from polhode import RigidBody, Trajectory, robots, solids
from polhode.errors import FileFormatError, PolhodeError
from polhode.io import read_mesh, read_xyz

BOX = solids.box((3.0, 2.0, 1.0), mass=0.7)
READERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "body, JSON": (".json", RigidBody.from_file),
    "body, npz": (".npz", RigidBody.from_file),
    "motion, JSON": (".json", Trajectory.from_file),
    "motion, npz": (".npz", Trajectory.from_file),
    "STL": (".stl", lambda path: RigidBody.from_file(path, density=1.0)),
    "OBJ": (".obj", lambda path: RigidBody.from_file(path, density=1.0)),
    "PLY": (".ply", lambda path: RigidBody.from_file(path, density=1.0)),
    "OFF": (".off", read_mesh),
    "GLB": (".glb", read_mesh),
    "XYZ": (".xyz", read_xyz),
    "robot": (".urdf", robots.read_robot),
}


class TestDamage:
    @pytest.mark.parametrize("name", KINDS)
    def test_it_is_refused_or_a_valid_body(self, name: str, tmp_path: Path) -> None:
        kind = KINDS[name]
        data, whole = whole_file(kind, tmp_path)
        few = 15 if name == "expected report" else 55  # that one runs a command each time
        counts = tally(kind, tmp_path, every_damage(data, seed=20261122, cut=few, bad=few), whole)
        assert counts["refused"] > few, counts

    @pytest.mark.long
    @pytest.mark.timeout(600)
    @pytest.mark.parametrize("name", KINDS)
    def test_many_more(self, name: str, tmp_path: Path) -> None:
        """Cut after every byte of the small ones, after each of 2000 places of the others."""
        kind = KINDS[name]
        data, whole = whole_file(kind, tmp_path)
        counts = tally(kind, tmp_path, every_damage(data, seed=13, cut=2000, bad=2000), whole)
        print(f"{name}: {counts.total()} damaged files: {dict(counts)}")
        assert counts["refused"] > 1000, counts


class TestWhatIsNoFile:
    @pytest.mark.timeout(20)
    @pytest.mark.parametrize("name", READERS)
    def test_it_is_refused_at_once(self, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        suffix, read = READERS[name]
        folder, pipe, plug, link = (
            tmp_path / f"{word}{suffix}" for word in ("folder", "pipe", "plug", "link")
        )
        folder.mkdir()
        os.mkfifo(pipe)
        link.symlink_to("/dev/zero")
        monkeypatch.chdir(tmp_path)
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(plug.name)  # by a short name: the path of a socket may not be long
            for path, words in ((folder, "directory"), (pipe, "pipe"), (plug, "socket"), (link, "device")):
                with pytest.raises(FileFormatError, match=words) as caught:
                    read(path)
                assert str(caught.value).startswith(str(path))
        with pytest.raises(FileNotFoundError) as missing:
            read(tmp_path / f"absent{suffix}")
        assert Path(missing.value.filename).name == f"absent{suffix}"

    @pytest.mark.parametrize("suffix", [".json", ".xyz"])
    def test_a_text_beyond_the_limit(self, suffix: str, tmp_path: Path) -> None:
        path = tmp_path / f"long{suffix}"
        path.write_bytes(b"3\nwater\nO 0 0 0\n")
        os.truncate(path, 1 << 40)  # which takes no room on the disk
        read = next(read for ending, read in READERS.values() if ending == suffix)
        with pytest.raises(FileFormatError, match=r"\d{9,} bytes, the most"):
            read(path)


class TestWhatIsNotListed:
    @pytest.mark.parametrize(
        "suffix", [".zip", ".bz2", ".xaml", ".dxf", ".svg", ".stl_ascii", ".binvox", ".tar.gz"]
    )
    def test_it_does_not_reach_trimesh(
        self, suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """An archive would be unpacked without end: a gigabyte of zeros in a megabyte."""
        trimesh = pytest.importorskip("trimesh")
        monkeypatch.setattr(trimesh, "load_scene", pytest.fail)
        path = tmp_path / f"part{suffix}"
        path.write_bytes(bz2.compress(bytes(1 << 20)))
        way_out = r"use one of \.stl, \.obj, .*\.glb, |export it as \.step"
        with pytest.raises(FileFormatError, match=f"are not read; ({way_out})"):
            read_mesh(path)

    def test_what_is_listed_is_read(self) -> None:
        suffixes = {kind.suffix for kind in KINDS.values()}
        with pytest.raises(FileFormatError) as caught:
            read_mesh(Path(__file__))
        listed = str(caught.value).partition("use one of ")[2].split(", ")
        assert set(listed) <= suffixes


def npz(path: Path, **changes: Any) -> Path:
    """A body's npz file with some of its arrays changed."""
    BOX.save(path)
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive} | changes
    with path.open("wb") as stream:
        np.savez(stream, **{name: value for name, value in arrays.items() if value is not None})
    return path


class TestNpz:
    @pytest.mark.parametrize(
        ("changes", "message"),
        [
            ({"mass": np.complex128(0.7)}, "mass holds complex128, expected real numbers"),
            ({"mass": np.datetime64("2026-11-22")}, "mass holds datetime64"),
            ({"inertia": np.eye(3) > 0.5}, "inertia holds bool"),
            ({"center_of_mass": np.array(["1", "2", "3"])}, "center_of_mass holds <U1"),
            ({"center_of_mass": np.array([1, 2, 3], dtype=object)}, "Object arrays|expected plain numbers"),
            ({"mass": np.zeros((), dtype=[("a", "f8")])}, "expected plain numbers"),
            ({"numbers": np.float64(3.0)}, r"numbers: expected shape \(\.\.\., 34\)"),
            ({"numbers": None, "inertia": np.eye(2)}, r"inertia: expected shape \(\.\.\., 3, 3\)"),
            ({"numbers": None, "mass": np.float64(np.nan)}, "mass holds nan, expected finite"),
            ({"numbers": None, "mass": np.int64(2**60)}, r"beyond 2\^53"),
            ({"mass": np.longdouble(0.7)}, "mass holds (float128|longdouble)|mass is not that of the body"),
            ({"weight": np.float64(0.7)}, "'weight' is no field of this format"),
            ({"format": None}, "its format is None"),
        ],
    )
    def test_what_is_no_body(self, changes: dict[str, Any], message: str, tmp_path: Path) -> None:
        with pytest.raises(FileFormatError, match=message) as caught:
            RigidBody.from_file(npz(tmp_path / "body.npz", **changes))
        assert "body.npz" in str(caught.value)

    def test_compressed_and_of_other_numbers(self, tmp_path: Path) -> None:
        path = npz(
            tmp_path / "body.npz", numbers=None, mass=np.float32(0.5), center_of_mass=np.array([1, 2, 3])
        )
        with np.load(path) as archive:
            arrays = {name: archive[name] for name in archive}
        np.savez_compressed(path, **arrays)
        body = RigidBody.from_file(path)
        assert body == RigidBody(0.5, BOX.inertia, (1.0, 2.0, 3.0))

    @pytest.mark.timeout(20)
    def test_a_bomb(self, tmp_path: Path) -> None:
        """Much in little: refused by what the archive says, before it is unpacked."""
        path = tmp_path / "body.npz"
        with (
            zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
            archive.open("mass.npy", "w", force_zip64=True) as member,
        ):
            for _ in range(5):
                member.write(bytes(1 << 24))
        used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        with pytest.raises(
            FileFormatError,
            match=r"there are more than \d+ unpacked bytes, the most for \d+ bytes of file; unpack it",
        ):
            RigidBody.from_file(path)
        assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - used < 50_000

    def test_a_header_that_promises_too_much(self, tmp_path: Path) -> None:
        path = tmp_path / "body.npz"
        header = str({"descr": "<f8", "fortran_order": False, "shape": (1 << 50,)}).encode()
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("mass.npy", b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
        with pytest.raises(FileFormatError, match="but 0 bytes are there"):
            RigidBody.from_file(path)

    def test_times_of_any_shape(self, tmp_path: Path) -> None:
        """A closed form is asked at times of any shape, and comes back with it."""
        for name, t in (("one", 0.5), ("grid", np.arange(6.0).reshape(2, 3))):
            motion = BOX.free_motion((0.1, 1.0, 0.2)).at(t)
            for suffix in (".json", ".npz"):
                motion.save(tmp_path / f"{name}{suffix}")
                again = Trajectory.from_file(tmp_path / f"{name}{suffix}")
                assert np.array_equal(again.t, motion.t)
                assert np.array_equal(again.quaternion, motion.quaternion)
            with pytest.raises(ValueError, match=r"one row for each time.*\.npz"):
                motion.save(tmp_path / f"{name}.csv")


class TestJson:
    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("[" * 100_000, "nested beyond reason"),
            ('{"mass": NaN}', "NaN is no number of JSON"),
            ('{"mass": 1, "mass": 2}', "'mass' stands there twice"),
            ('{"mass": 1' + "0" * 5000 + "}", "not JSON"),
            ('{"format": "polhode.RigidBody/1", "mas": 1}', "'mas' is no field"),
            ("3", "not an object"),
        ],
    )
    def test_what_is_no_object_of_fields(self, text: str, message: str, tmp_path: Path) -> None:
        path = tmp_path / "body.json"
        path.write_text(text, "utf-8")
        with pytest.raises(FileFormatError, match=message) as caught:
            RigidBody.from_file(path)
        assert "body.json" in str(caught.value)

    @pytest.mark.parametrize(
        ("mass", "message"),
        [
            ('"2"', "it holds text"),
            ("true", "it holds true or false"),
            ("null", "it holds null"),
            ("[1, [2]]", "lists of different lengths"),
            ("{}", "it holds an object"),
            ("1" + "0" * 400, "beyond float64"),
            ("1e999", "mass holds inf, expected finite"),
        ],
    )
    def test_what_is_no_number(self, mass: str, message: str, tmp_path: Path) -> None:
        path = tmp_path / "body.json"
        path.write_text(
            f'{{"format": "polhode.RigidBody/1", "mass": {mass}, "center_of_mass": [0, 0, 0], '
            '"inertia": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}',
            "utf-8",
        )
        with pytest.raises(FileFormatError, match=message):
            RigidBody.from_file(path)

    @pytest.mark.parametrize(
        ("name", "value", "message"),
        [
            ("quaternion", [[0, 0, 0, 2], [0, 0, 0, 1]], "a quaternion has the norm 2"),
            ("pivoted", "false", "pivoted is 'false', expected true or false"),
            (
                "status",
                "finished",
                "status holds 'finished', expected one of complete, event, stopped, failed, not run",
            ),
            ("steps", -3, "steps holds numbers that are no counts"),
            ("steps", [1, 2], r"steps has shape \(2,\), expected \(\)"),
            ("t", [0.0, None], "t is not an array of numbers: it holds null"),
        ],
    )
    def test_what_is_no_motion(self, name: str, value: object, message: str, tmp_path: Path) -> None:
        path = tmp_path / "motion.json"
        BOX.free_motion((0.1, 1.0, 0.2)).at([0.0, 1.0]).save(path)
        path.write_text(json.dumps(json.loads(path.read_text("utf-8")) | {name: value}), "utf-8")
        with pytest.raises(FileFormatError, match=message):
            Trajectory.from_file(path)

    def test_a_comment_may_stand_in_it(self, tmp_path: Path) -> None:
        path = tmp_path / "body.json"
        BOX.save(path)
        path.write_text(path.read_text("utf-8").replace("{", '{"comment": "by hand",', 1), "utf-8")
        assert RigidBody.from_file(path) == BOX

    def test_what_it_cannot_hold_is_not_written(self, tmp_path: Path) -> None:
        motion = BOX.free_motion((0.1, 1.0, 0.2)).at([0.0, 1.0])
        motion.position.setflags(write=True)
        motion.position[1] = np.inf
        with pytest.raises(ValueError, match=r"position is infinite somewhere.*\.npz"):
            motion.save(tmp_path / "motion.json")
        empty = solids.box(np.ones((2, 0, 3)), mass=1.0).free_motion((0.1, 1.0, 0.2)).at([0.0, 1.0])
        with pytest.raises(ValueError, match=r"shape of an empty stack; save it as \.npz"):
            empty.save(tmp_path / "motion.json")
        assert list(tmp_path.iterdir()) == []


def changed_glb(path: Path, change: Callable[[dict[str, Any]], object]) -> Path:
    """A GLB file of a cube whose description is changed."""
    data = glb(*cube(2.0))
    length = int.from_bytes(data[12:16], "little")
    scene = json.loads(data[20 : 20 + length])
    change(scene)
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    sizes = (20 + len(text) + len(rest)).to_bytes(4, "little") + len(text).to_bytes(4, "little")
    path.write_bytes(data[:8] + sizes + data[16:20] + text + rest)
    return path


class TestGlb:
    def test_unchanged_it_is_read(self, tmp_path: Path) -> None:
        body = RigidBody.from_file(changed_glb(tmp_path / "part.glb", lambda _: None), density=1.0)
        assert body.mass == pytest.approx(8.0, rel=1e-14)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            (lambda s: s["accessors"][0].update(count=1 << 40), r"says that it holds \d+ items"),
            (lambda s: s["accessors"].append({"count": 1 << 40}), r"says that it holds \d+ items"),
            (
                lambda s: s["accessors"][s["meshes"][0]["primitives"][0]["indices"]].pop("bufferView"),
                "not in the file",
            ),
            (lambda s: s["accessors"][0].update(sparse={}) or s["accessors"][1].update(sparse={}), "sparse"),
            (lambda s: s["meshes"][0]["primitives"][0].update(mode=6), "fans"),
            (lambda s: s["meshes"][0]["primitives"][0].update(mode=1), "lines"),
            (
                lambda s: s.update(extensionsRequired=["KHR_draco_mesh_compression"]),
                "KHR_draco_mesh_compression",
            ),
            (lambda s: s["buffers"][0].update(uri="../secret.bin"), "another file"),
            (lambda s: s["nodes"].append({"children": [len(s["nodes"])]}), "below itself"),
            (lambda s: s["nodes"].extend([{"children": [0]}, {"children": [0]}]), "two parents"),
        ],
    )
    def test_what_trimesh_would_pass_over(self, change: Any, message: str, tmp_path: Path) -> None:
        with pytest.raises(FileFormatError, match=message):
            read_mesh(changed_glb(tmp_path / "part.glb", change))


def test_an_ascii_ply_with_a_word_that_is_no_number(tmp_path: Path) -> None:
    """trimesh reads a row up to it and says nothing."""
    path = tmp_path / "part.ply"
    path.write_bytes(ascii_ply(*cube()).replace(b"0.5 0.5 0.5", b"0.5 0.5 0.5x"))
    with pytest.raises(FileFormatError, match=r"part\.ply"):
        read_mesh(path)


def test_a_face_beyond_the_vertices_is_refused_by_the_reader(tmp_path: Path) -> None:
    path = tmp_path / "part.obj"
    path.write_bytes(obj(*cube()).replace(b"f 1 ", b"f 9 ", 1))
    for weld in (0.0, 1e-9):
        with pytest.raises(PolhodeError, match="names vertex 8, but there are 8 vertices"):
            read_mesh(path, weld=weld)


@pytest.mark.parametrize(
    "known",
    [
        '{"mass": [[1], [2, 3]]}',
        '{"mass": 1' + "0" * 400 + "}",
        '{"mass": NaN}',
        '{"mass": ["x"]}',
        '{"mass": null}',
        '{"principal_moments": true}',
    ],
)
def test_an_expected_report_with_other_things_than_numbers_differs(known: str, tmp_path: Path) -> None:
    (tmp_path / "part.obj").write_bytes(obj(*cube()))
    (tmp_path / "known.json").write_text(known, "utf-8")
    for form in ("table", "json"):
        code, out, err = run(
            "report", tmp_path / "part.obj", "--expect", tmp_path / "known.json", "--format", form
        )
        assert (code, err) == (1, "")
        assert "1 of 1 fields differ" in out
