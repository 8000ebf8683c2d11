"""Meshes with a unit of their own, files of other programs, packed files: what they hold, how large."""

from __future__ import annotations

import gzip
import json
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from damage import KINDS, every_damage, whole_file
from foreign_files import LIB3MF_INCH, MESHIO_VTU, PYCOLLADA, VTK_ASCII
from mesh_files import ascii_stl, binary_stl, dae, glb, gltf, numbered_plates, three_mf
from oracles.meshes import cube
from polhode import RigidBody, _core, robots
from polhode.errors import FileFormatError, PolhodeError
from polhode.io import load, mesh_solid, read_mesh, solid_from_file, unpacked
from polhode.io.budget import LIMITS, Limit
from polhode.io.content import EXPECTED_CONTENT

CUBE = cube(2.0)
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048, "um": 1e-6}


def written(path: Path, content: bytes | str) -> Path:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def told(path: Path, *options: str) -> dict[str, Any]:
    code, out, err = run("report", str(path), "--density", "1000", "--format", "json", *options)
    assert (code, err) == (0, "")
    fields: dict[str, Any] = json.loads(out)
    return fields


def refused(path: Path, *says: str) -> None:
    with pytest.raises(FileFormatError) as caught:
        RigidBody.from_file(path, density=1.0)
    assert [text for text in (path.name, *says) if text not in str(caught.value)] == []


class TestUnitOfCollada:
    @pytest.mark.parametrize(
        ("meter", "name"),
        [
            ("1", "m"),
            ("0.01", "cm"),
            ("0.001", "mm"),
            ("0.0254", "in"),
            (" 2.54e-2 ", "in"),
            ("0.30480", "ft"),
            ("1e-6", "um"),
        ],
    )
    def test_is_applied(self, meter: str, name: str, tmp_path: Path) -> None:
        path = written(tmp_path / "part.dae", dae(*CUBE, unit=f'<unit meter="{meter}" name="whatever"/>'))
        mass = 8.0 * METRES[name] ** 3
        assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(mass, rel=1e-14)
        assert solid_from_file(path, density=1.0).body.mass == pytest.approx(mass, rel=1e-14)
        fields = told(path)
        assert fields["length_unit"] == name
        assert fields["mass"] == pytest.approx(1000 * mass, rel=1e-14)
        assert told(path, "--length-unit", name)["mass"] == pytest.approx(1000 * mass, rel=1e-14)
        other = "mm" if name != "mm" else "m"
        code, _, err = run("report", str(path), "--density", "1", "--length-unit", other)
        assert code == 2
        assert one_line(err)
        assert f"says itself that its unit is '{name}', not '{other}'; leave --length-unit out" in err

    def test_one_without_a_name(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.dae", dae(*CUBE, unit='<unit meter="0.3"/>'))
        fields = told(path)
        assert fields["length_unit"] == "m"
        assert fields["mass"] == pytest.approx(8000 * 0.027, rel=1e-14)
        assert any("unit is 0.3 m" in note for note in fields["notes"])

    @pytest.mark.parametrize("unit", ["", '<unit name="centimeter"/>'])
    def test_none_means_metres(self, unit: str, tmp_path: Path) -> None:
        """The standard's default; nobody states it, so that another one is taken, and told."""
        path = written(tmp_path / "part.dae", dae(*CUBE, unit=unit))
        assert told(path)["mass"] == pytest.approx(8000.0)
        fields = told(path, "--length-unit", "mm")
        assert fields["mass"] == pytest.approx(8e-6)
        assert any(
            "COLLADA is in m by its standard; --length-unit mm was taken" in n for n in fields["notes"]
        )

    @pytest.mark.parametrize("meter", ["0", "-1", "nan", "inf", "mm", "1e99", ""])
    def test_nonsense(self, meter: str, tmp_path: Path) -> None:
        refused(
            written(tmp_path / "part.dae", dae(*CUBE, unit=f'<unit meter="{meter}"/>')),
            "line 3",
            "is no length",
        )

    @pytest.mark.parametrize("name", ["mm", "cm", "in", "m"])
    def test_in_robots(self, name: str, tmp_path: Path) -> None:
        """A robot is in metres: a DAE in millimetres is a thousandth of its numbers."""
        written(tmp_path / "part.dae", dae(*CUBE, unit=f'<unit meter="{METRES[name]}"/>'))
        side = 2.0 * METRES[name]
        mass = 1000.0 * side**3
        inertia = mass * side**2 / 6.0
        link = f"""<robot name="r"><link name="a"><inertial><mass value="{mass}"/>
        <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><geometry><mesh filename="part.dae"/></geometry></collision></link></robot>"""
        robot = robots.read_robot(written(tmp_path / "arm.urdf", link))
        (verdict,) = robots.check(robot)
        assert verdict.verdict == "good"


class TestCollada:
    def test_of_another_program(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.dae", PYCOLLADA)
        body = RigidBody.from_file(path, density=2.0)
        assert body.mass == pytest.approx(12.0, rel=1e-15)
        assert np.diag(body.inertia) == pytest.approx([13.0, 10.0, 5.0], rel=1e-14)
        assert any("up is Y" in note for note in load(path).notes)

    def test_places_of_nodes(self, tmp_path: Path) -> None:
        placed = (
            "<translate>10 0 0</translate><rotate>0 0 1 90</rotate><scale>1 2 -3</scale>"
            "<matrix>1 0 0 1  0 1 0 0  0 0 1 0  0 0 0 1</matrix>"
        )
        body = RigidBody.from_file(written(tmp_path / "part.dae", dae(*CUBE, placed=placed)), density=1.0)
        assert body.mass == pytest.approx(8.0 * 6.0)
        # The cube of side 2 about (1, 0, 0): scaled, turned, moved. A reflection keeps it outward.
        x, y, z = RigidBody.from_mesh(*CUBE, density=1.0).center_of_mass + np.array([1.0, 0.0, 0.0])
        np.testing.assert_allclose(body.center_of_mass, [10.0 - 2.0 * y, x, -3.0 * z], atol=1e-12)

    def test_a_library_of_nodes_and_polygons(self, tmp_path: Path) -> None:
        text = dae(*CUBE).decode()
        corners = " ".join(str(k) for k in CUBE[1].ravel().tolist())
        sizes = " ".join("3" for _ in CUBE[1])
        polylist = f'<polylist count="{len(CUBE[1])}"><input semantic="VERTEX" source="#corners" offset="0"/>'
        start, end = text.index("<triangles"), text.index("</triangles>") + len("</triangles>")
        text = f"{text[:start]}{polylist}<vcount>{sizes}</vcount><p>{corners}</p></polylist>{text[end:]}"
        text = text.replace(
            "<library_visual_scenes>",
            '<library_nodes><node id="twice"><instance_geometry url="#shape"/><node>'
            "<translate>5 0 0</translate>"
            '<instance_geometry url="#shape"/></node></node></library_nodes><library_visual_scenes>',
        ).replace(
            '<node><instance_geometry url="#shape"/></node>\n</visual',
            '<node><instance_node url="#twice"/></node>\n</visual',
        )
        assert RigidBody.from_file(written(tmp_path / "part.dae", text), density=1.0).mass == pytest.approx(
            16.0
        )

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("<scene>", "<extra>", "not well-formed"),
            ('url="#view"', 'url="#nothing"', "names nothing in the file"),
            ('url="#shape"', 'url="other.dae#shape"', "names another file; write all into one"),
            ("<instance_geometry url=", "<instance_controller url=", "bent by bones"),
            ('name="Y"', 'name="T"', "expected coordinates X, Y, Z"),
            ("<node>", "<node><lookat>0 0 0 1 1 1 0 0 1</lookat>", "<lookat> is not read; export it"),
            ("<node>", "<node><matrix>1 2 3</matrix>", "<matrix> needs 16 finite numbers"),
            ("<p>0", "<p>99", "names a vertex that the file does not hold"),
            ("<triangles", "<tristrips", "not well-formed"),
            ("<COLLADA", "<!DOCTYPE a><COLLADA", "declares a document type"),
        ],
    )  # fmt: skip
    def test_refusals(self, old: str, new: str, says: str, tmp_path: Path) -> None:
        text = dae(*CUBE).decode()
        assert old in text
        refused(written(tmp_path / "part.dae", text.replace(old, new)), says)


class TestThreeMf:
    def test_of_the_consortiums_library(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.3mf", LIB3MF_INCH)
        assert load(path).unit == "in"
        assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(6.0 * 0.0254**3, rel=1e-14)

    @pytest.mark.parametrize(
        ("word", "name"),
        [
            ("micron", "um"),
            ("millimeter", "mm"),
            ("centimeter", "cm"),
            ("inch", "in"),
            ("foot", "ft"),
            ("meter", "m"),
        ],
    )
    def test_units(self, word: str, name: str, tmp_path: Path) -> None:
        path = written(tmp_path / "part.3mf", three_mf(*CUBE, unit=f'unit="{word}"'))
        fields = told(path)
        assert fields["length_unit"] == name
        assert fields["mass"] == pytest.approx(8000 * METRES[name] ** 3, rel=1e-14)

    def test_none_means_millimetres(self, tmp_path: Path) -> None:
        path = written(tmp_path / "part.3mf", three_mf(*CUBE, unit=""))
        assert told(path)["mass"] == pytest.approx(8e-6)
        assert told(path, "--length-unit", "cm")["mass"] == pytest.approx(8e-3)

    def test_components_and_items(self, tmp_path: Path) -> None:
        pair = (
            '<object id="2" type="model"><components><component objectid="1"/>'
            '<component objectid="1" transform="1 0 0 0 1 0 0 0 -2 9 0 0"/></components></object>'
            '<object id="3" type="support"><components><component objectid="1"/></components></object>'
        )
        build = '<item objectid="2"/><item objectid="3" transform="1 0 0 0 1 0 0 0 1 99 0 0"/>'
        path = written(tmp_path / "part.3mf", three_mf(*CUBE, build=build, more=pair))
        assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(8.0 + 16.0)

    @pytest.mark.parametrize(
        ("changes", "says"),
        [
            ({"unit": 'unit="parsec"'}, "its unit is 'parsec', none of micron"),
            ({"build": ""}, "places no triangles"),
            ({"build": '<item objectid="7"/>'}, "places an object '7' that it does not hold"),
            ({"build": '<item objectid="1" transform="1 2 3"/>'}, "3 numbers, not 12"),
            ({"more": '<object id="2"><components><component objectid="2"/></components></object>',
              "build": '<item objectid="2"/>'}, "without end"),
            ({"unit": 'requiredextensions="v"'}, "extensions ['v'], which are not read"),
        ],
    )  # fmt: skip
    def test_refusals(self, changes: Any, says: str, tmp_path: Path) -> None:
        refused(written(tmp_path / "part.3mf", three_mf(*CUBE, **changes)), says)

    def test_a_zip_of_something_else(self, tmp_path: Path) -> None:
        refused(written(tmp_path / "part.3mf", b"PK\x03\x04" + bytes(100)), "export it again")


class TestGltf:
    def test_is_in_metres(self, tmp_path: Path) -> None:
        pytest.importorskip("trimesh")
        for path in (written(tmp_path / "a.gltf", gltf(*CUBE)), written(tmp_path / "a.glb", glb(*CUBE))):
            fields = told(path)
            assert (fields["length_unit"], fields["mass"]) == ("m", pytest.approx(8000.0))
            fields = told(path, "--length-unit", "mm")
            assert fields["mass"] == pytest.approx(8e-6)
            assert any(
                "is in m by its standard; --length-unit mm was taken instead" in n for n in fields["notes"]
            )

    def test_numbers_beside_it(self, tmp_path: Path) -> None:
        """As trimesh exports it: two binary files."""
        trimesh = pytest.importorskip("trimesh")
        for name, content in trimesh.Trimesh(*CUBE, process=False).export(file_type="gltf").items():
            written(tmp_path / name, content)
        path = tmp_path / "model.gltf"
        assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(8.0)
        scene = json.loads(path.read_text())
        for address in ("../secret.bin", "/etc/passwd", "http://host/a.bin", "C:\\a.bin"):
            scene["buffers"][0]["uri"] = address
            refused(written(path, json.dumps(scene)), "put it beside it")
        (tmp_path / "far.bin").symlink_to("/etc/hostname")
        scene["buffers"][0]["uri"] = "far.bin"
        refused(written(path, json.dumps(scene)), "a link out of its own folder")
        scene["buffers"][0]["uri"] = "gltf_buffer_1.bin"
        scene["buffers"][0]["byteLength"] = 10**6
        refused(written(path, json.dumps(scene)), "not 1000000")


class TestVtk:
    """Of cells in space the surface counts; of a surface its triangles."""

    def test_files_of_meshio(self, tmp_path: Path) -> None:
        pytest.importorskip("pyvista")
        for name, text in (("a.vtu", MESHIO_VTU), ("a.vtk", VTK_ASCII)):
            path = written(tmp_path / name, text)
            body = RigidBody.from_file(path, density=6.0)
            assert body.mass == pytest.approx(1.0, rel=1e-14)
            assert body.center_of_mass == pytest.approx([0.25, 0.25, 0.25])
        refused(written(tmp_path / "b.vtu", MESHIO_VTU[:400]), "b.vtu")
        refused(written(tmp_path / "b.vtk", VTK_ASCII[:80]), "b.vtk")

    def test_without_the_extra(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setitem(sys.modules, "pyvista", None)
        code, _, err = run("report", str(written(tmp_path / "a.vtu", MESHIO_VTU)), "--density", "1")
        assert code == 2
        assert 'pip install "polhode[view]"' in err


class TestWithoutCad:
    @pytest.mark.parametrize("name", ["part.step", "part.STP", "part.igs", "part.iges", "part.step.gz"])
    @pytest.mark.parametrize("exists", [True, False])
    def test_the_line_that_installs_it(
        self, name: str, exists: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        for module in [module for module in sys.modules if module.partition(".")[0] == "OCP"]:
            monkeypatch.delitem(sys.modules, module)
        monkeypatch.setitem(sys.modules, "OCP", None)
        path = tmp_path / name
        if exists:
            path.write_bytes(b"ISO-10303-21;\n")
        code, out, err = run("report", str(path), "--density", "1")
        assert (code, out) == (2, "")
        assert one_line(err)
        assert 'pip install "polhode[cad]"' in err


class TestPacked:
    @pytest.mark.parametrize("writer", [binary_stl, ascii_stl])
    def test_a_mesh(self, writer: Any, tmp_path: Path) -> None:
        path = written(tmp_path / "part.stl.gz", gzip.compress(writer(*CUBE)))
        assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(8.0)
        assert read_mesh(path).faces.shape == (12, 3)
        assert any("unpacked with gunzip" in note for note in told(path)["notes"])

    def test_a_molecule(self, tmp_path: Path) -> None:
        path = written(tmp_path / "neon.xyz.gz", gzip.compress(b"1\n\nNe 0 0 0\n"))
        assert RigidBody.from_file(path).mass == pytest.approx(19.99244)
        assert run("molecule", str(path))[0] == 0

    def test_a_limit(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        data = ascii_stl(*CUBE)
        path = written(tmp_path / "part.stl.gz", gzip.compress(data))
        monkeypatch.setitem(LIMITS, "unpacked bytes", Limit(len(data), 0.0, "unpack it"))
        with unpacked.unpack(path) as inside:
            assert inside.read_bytes() == data
        monkeypatch.setitem(LIMITS, "unpacked bytes", Limit(len(data) - 1, 0.0, "unpack it"))
        with (
            pytest.raises(
                FileFormatError, match=f"there are more than {len(data) - 1} unpacked bytes; unpack it"
            ),
            unpacked.unpack(path),
        ):
            pass
        assert not inside.exists()

    @pytest.mark.parametrize(
        "name", [name for name, kind in KINDS.items() if kind.suffix in EXPECTED_CONTENT]
    )
    def test_what_is_wrong_inside_is_said_of_the_packed_file(
        self, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        kind, copies = KINDS[name], tmp_path / "copies"
        copies.mkdir()
        monkeypatch.setattr(tempfile, "tempdir", str(copies))
        data, _ = whole_file(kind, tmp_path)
        path = tmp_path / f"part{kind.suffix}.gz"
        messages = []
        for _, bad in [*every_damage(data, 1, 6, 12), ("other words", b"dear reader")]:
            written(path, gzip.compress(bad))
            try:
                kind.read(path)
            except PolhodeError as error:
                messages.append(str(error))
        assert messages != []
        assert [words for words in messages if str(path) not in words or str(copies) in words] == []

    def test_refusals(self, tmp_path: Path) -> None:
        refused(written(tmp_path / "a.stl.gz", gzip.compress(ascii_stl(*CUBE))[:-9]), "not a whole gzip file")
        refused(written(tmp_path / "b.stl.gz", b"solid"), "not a whole gzip file")
        refused(written(tmp_path / "c.stl.gz", gzip.compress(b"")), "is empty")
        refused(written(tmp_path / "d.stl.gz", gzip.compress(b"dear reader")), "d.stl.gz")
        refused(written(tmp_path / "e.tar.gz", gzip.compress(b"x")), "use one of")
        refused(written(tmp_path / "f.stl", gzip.compress(ascii_stl(*CUBE))), "packed with gzip; rename it")


class TestOneSolve:
    """A mesh is summed once, whatever is asked of it: with `mass` its volume is not that of a second body."""

    @pytest.mark.parametrize("amount", [{"mass": 3.0}, {"density": 4.0}])
    @pytest.mark.parametrize("option", [{}, {"orient": True}, {"closure": "caps"}, {"repair": True}])
    def test_with_mass_as_with_density(
        self, amount: Any, option: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        vertices, faces = CUBE
        path = written(tmp_path / "cube.tab", numbered_plates(vertices / 3.0, faces))
        solves: list[str] = []

        def counting(name: str) -> Any:
            def counted(*arguments: Any, **options: Any) -> Any:
                solves.append(name)
                return getattr(RigidBody, name)(*arguments, **options)

            return counted

        names = ("from_mesh", "_from_mesh")
        body = SimpleNamespace(**{name: counting(name) for name in names})
        monkeypatch.setattr(mesh_solid, "_core", SimpleNamespace(**{**vars(_core), "RigidBody": body}))
        solid = solid_from_file(path, **amount, **option)
        assert solves == ["_from_mesh"]
        monkeypatch.undo()
        mesh = read_mesh(path)
        assert solid.volume == RigidBody.from_mesh(mesh.vertices, mesh.faces, density=1.0).mass
        assert solid.body == RigidBody.from_mesh(mesh.vertices, mesh.faces, **amount)

    @pytest.mark.parametrize(("side", "volume"), [(1e102, pytest.approx(1e306)), (1e103, np.inf)])
    def test_a_volume_beyond_floats(self, side: float, volume: Any, tmp_path: Path) -> None:
        """The mass that was given and its moments are numbers all the same."""
        vertices, faces = CUBE
        path = written(tmp_path / "cube.tab", numbered_plates(vertices / 2.0 * side, faces))
        solid = solid_from_file(path, mass=1.0)
        assert solid.volume == volume
        assert solid.body.inertia[0, 0] == pytest.approx(side**2 / 6.0)


class TestNumberedPlates:
    @pytest.mark.parametrize("name", ["ver64q.tab", "ver64q.txt"])
    def test_a_model(self, name: str, tmp_path: Path) -> None:
        path = written(tmp_path / name, numbered_plates(*CUBE))
        assert load(path).format == "numbered plates"
        assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(8.0)
        mesh = read_mesh(path)
        np.testing.assert_array_equal(mesh.vertices, CUBE[0])
        np.testing.assert_array_equal(mesh.faces, CUBE[1])

    def test_refusals(self, tmp_path: Path) -> None:
        whole = numbered_plates(*CUBE).decode()
        lines = whole.splitlines()
        path = tmp_path / "a.tab"
        refused(written(path, "\n".join(lines[:5])), "promises 8 vertices", "cut short")
        refused(written(path, "\n".join(lines[:-1])), "promises 12 plates, and holds 11")
        refused(written(path, whole.replace("\n5 ", "\n7 ", 1)), "vertex 5 has the number 7")
        with pytest.raises(PolhodeError, match="names vertex 98"):
            RigidBody.from_file(written(path, "\n".join([*lines[:-1], "12 1 2 99"])), density=1.0)
