"""A file is opened, recognised and read once, whoever asks; errors are known by data, not by their text."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mesh_files import WRITERS, binary_stl, obj
from oracles.meshes import cube
from polhode import RigidBody, _core
from polhode.cli import main
from polhode.errors import FileFormatError, MeshError
from polhode.io import load, read_mesh, read_xyz, solid_from_file

READERS = ("read_stl", "read_plates", "stream_solid")
NEON = "1\n\nNe 0 0 0\n"
_OPENED: list[str] | None = None


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if _OPENED is not None and event == "open" and isinstance(arguments[0], str):
        _OPENED.append(arguments[0])


sys.addaudithook(_note)


class Seen:
    """How often a file was opened by Python and read by the compiled readers."""

    def __init__(self, path: Path, opened: list[str], read: list[str]) -> None:
        self._path, self._opened, self._read = str(path), opened, read

    @property
    def opened(self) -> int:
        """Times that Python opened it."""
        return Counter(self._opened)[self._path]

    @property
    def read(self) -> int:
        """Times that a compiled reader went through it."""
        return len(self._read)


@pytest.fixture
def seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    global _OPENED
    opened: list[str] = []
    read: list[str] = []

    def watched(reader: Any) -> Any:
        def call(path: str, *rest: Any, **options: Any) -> Any:
            read.append(path)
            return reader(path, *rest, **options)

        return call

    for name in READERS:
        monkeypatch.setattr(_core, name, watched(getattr(_core, name)))

    def write(name: str, content: bytes) -> tuple[Path, Seen]:
        path = tmp_path / name
        path.write_bytes(content)
        opened.clear()
        read.clear()
        return path, Seen(path, opened, read)

    _OPENED = opened
    yield write
    _OPENED = None


def is_for_the_core(kind: str) -> bool:
    return kind.startswith(("binary STL", "binary PLY")) or WRITERS[kind][2] == "v/f text"


class TestOnce:
    @pytest.mark.parametrize("kind", WRITERS)
    def test_a_body_from_a_mesh(self, kind: str, seen: Any) -> None:
        suffix, writer, name = WRITERS[kind]
        path, counts = seen(f"part{suffix}", writer(*cube(2.0)))
        body = RigidBody.from_file(path, density=1.0)
        assert body.mass == pytest.approx(8.0)
        found = counts.opened, counts.read
        # Streams keep no triangles: those of a small file are read once more, for the body to hold.
        again = {".stl": (0, 1), ".ply": (1, 0)}[suffix] if load(path).is_stream else (0, 0)
        assert found == (1 + again[0], int(is_for_the_core(kind)) + again[1])
        assert load(path).format == name

    @pytest.mark.parametrize("kind", WRITERS)
    def test_a_report(self, kind: str, seen: Any, capsys: pytest.CaptureFixture[str]) -> None:
        suffix, writer, _ = WRITERS[kind]
        path, counts = seen(f"part{suffix}", writer(*cube(2.0)))
        assert main(["report", str(path)]) == 0
        assert str(path) in capsys.readouterr().out
        found = counts.opened, counts.read
        # Streams keep no triangles: their components are told from the file once more.
        again = {".stl": (0, 1), ".ply": (1, 0)}[suffix] if load(path).is_stream else (0, 0)
        assert found == (1 + again[0], int(is_for_the_core(kind)) + again[1])

    @pytest.mark.parametrize("command", ["report", "molecule"])
    def test_a_molecule(self, command: str, seen: Any, capsys: pytest.CaptureFixture[str]) -> None:
        path, counts = seen("neon.xyz", NEON.encode())
        assert main([command, str(path)]) == 0
        assert "Ne" in capsys.readouterr().out
        assert (counts.opened, counts.read) == (1, 0)

    def test_what_is_loaded_is_kept(self, seen: Any) -> None:
        path, counts = seen("part.obj", obj(*cube(2.0)))
        loaded = load(path)
        assert (counts.opened, counts.read) == (1, 0)
        assert loaded.mesh is loaded.mesh
        assert (counts.opened, counts.read) == (1, 1)

    def test_a_shape_that_is_drawn_is_not_recognised_again(self, seen: Any, tmp_path: Path) -> None:
        """The stream of a binary STL keeps no triangles: those that are drawn are read from it once more."""
        words = ["--omega", "0", "0", "1", "--end", "1", "--save", str(tmp_path / "m.html")]
        for name, content, readings in (
            ("part.stl", binary_stl(*cube(2.0)), 2),
            ("part.obj", obj(*cube(2.0)), 1),
        ):
            path, counts = seen(name, content)
            assert main(["spin", str(path), *words]) == 0
            assert (counts.opened, counts.read) == (1, readings)


class TestKinds:
    def test_a_mesh_is_no_molecule_and_the_other_way_round(self, seen: Any) -> None:
        mesh, _ = seen("part.obj", obj(*cube(2.0)))
        atoms, _ = seen("neon.xyz", NEON.encode())
        with pytest.raises(FileFormatError, match=r"part\.obj: v/f text holds a mesh, not atoms"):
            _ = load(mesh).molecule
        with pytest.raises(FileFormatError, match=r"neon\.xyz: XYZ holds atoms, not a mesh"):
            _ = load(atoms).mesh
        assert load(atoms).molecule.labels == read_xyz(atoms).labels
        assert np.array_equal(load(mesh).mesh.vertices, read_mesh(mesh).vertices)
        assert repr(load(mesh)) == f"<FileContent v/f text from {mesh}>"


class TestErrors:
    """An open mesh is known by what its error says beside the text."""

    def test_the_law_and_the_way_out_are_data(self) -> None:
        vertices, faces = cube(2.0)
        with pytest.raises(MeshError) as caught:
            RigidBody.from_mesh(vertices, faces[1:], density=1.0)
        assert (caught.value.law, caught.value.kind) == ("closed", "open")
        assert caught.value.way_out.startswith("close the mesh")
        assert str(caught.value).endswith(f"; {caught.value.way_out}")
        turned = faces.copy()
        turned[0] = turned[0][::-1]
        with pytest.raises(MeshError) as caught:
            RigidBody.from_mesh(vertices, turned, density=1.0)
        assert (caught.value.law, caught.value.kind, caught.value.way_out) == ("", "", "")

    @pytest.mark.parametrize(("suffix", "writer"), [(".stl", binary_stl), (".obj", obj)])
    def test_another_way_out_goes_before_it(self, suffix: str, writer: Any, seen: Any) -> None:
        vertices, faces = cube(3.0)  # its corners at 1.5, where 32-bit floats are 1.2e-7 apart
        strayed = np.concatenate([vertices, vertices[faces[0, :1]] * (1.0 + 8e-8)])
        cut = faces.copy()
        cut[0, 0] = len(vertices)
        path, counts = seen(f"frayed{suffix}", writer(strayed, cut))
        with pytest.raises(MeshError) as caught:
            solid_from_file(path, density=1.0)
        text = str(caught.value)
        assert text.startswith(f"{path}: the mesh is not closed")
        assert text.count(str(path)) == 1
        assert text.endswith(f"joins it; or {caught.value.way_out}")
        assert counts.opened == 1

    def test_an_offer_to_an_error_without_a_way_out(self) -> None:
        error = MeshError("inverted")
        error.offer("turn it")
        assert str(error) == "inverted (turn it)"
