"""Matter that slicers mark as none, the order of components, and parts of assemblies that overlap."""

from __future__ import annotations

import io
import zipfile
from math import pi
from pathlib import Path
from typing import Any

import pytest
from mesh_files import dae
from oracles.meshes import cube
from polhode import RigidBody, assembly
from polhode.errors import FileFormatError, PolhodeError
from polhode.io import load

MODEL = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
Box = tuple[float, float]
"""Its least and its greatest coordinate along each axis."""


def mesh(*boxes: Box) -> str:
    vertices, faces = cube(1.0)
    low = vertices.min()
    points, plates = "", ""
    for n, (start, end) in enumerate(boxes):
        for x, y, z in (start + (end - start) * (vertices - low)).tolist():
            points += f'<vertex x="{x}" y="{y}" z="{z}"/>'
        for a, b, c in (faces + 8 * n).tolist():
            plates += f'<triangle v1="{a}" v2="{b}" v3="{c}"/>'
    return f"<mesh><vertices>{points}</vertices><triangles>{plates}</triangles></mesh>"


def package(path: Path, objects: str, build: str, settings: str = "", name: str = "") -> Path:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        relation = f'<Relationship Type="{MODEL}" Target="/m.model"/>'
        archive.writestr("_rels/.rels", f"<Relationships>{relation}</Relationships>")
        archive.writestr(
            "m.model",
            f'<model unit="meter"><resources>{objects}</resources><build>{build}</build></model>',
        )
        if settings:
            archive.writestr(f"Metadata/{name}", f"<config>{settings}</config>")
    path.write_bytes(stream.getvalue())
    return path


def prusa(path: Path, kind: str, other: Box) -> Path:
    rows = "".join(
        f'<volume firstid="{12 * n}" lastid="{12 * n + 11}"><metadata type="volume" key="volume_type" '
        f'value="{word}"/></volume>'
        for n, word in enumerate(("ModelPart", kind))
    )
    objects = f'<object id="1">{mesh((0.0, 10.0), other)}</object>'
    settings = f'<object id="1">{rows}</object>'
    return package(path, objects, '<item objectid="1"/>', settings, "Slic3r_PE_model.config")


def bambu(path: Path, kind: str, other: Box) -> Path:
    objects = (
        f'<object id="1">{mesh((0.0, 10.0))}</object><object id="2">{mesh(other)}</object><object id="3">'
        '<components><component objectid="1"/><component objectid="2"/></components></object>'
    )
    settings = f'<object id="3"><part id="1" subtype="normal_part"/><part id="2" subtype="{kind}"/></object>'
    return package(path, objects, '<item objectid="3"/>', settings, "model_settings.config")


@pytest.mark.parametrize(
    ("write", "kinds"),
    [
        (prusa, ("SupportBlocker", "SupportEnforcer", "ParameterModifier", "NegativeVolume")),
        (bambu, ("support_blocker", "support_enforcer", "modifier_part", "negative_part")),
    ],
)
def test_volumes_of_slicers(write: Any, kinds: tuple[str, ...], tmp_path: Path) -> None:
    path = tmp_path / "a.3mf"
    for kind in kinds[:3]:
        assert RigidBody.from_file(write(path, kind, (2.0, 30.0)), density=1.0).mass == pytest.approx(1000.0)
        assert "no matter" in load(path).notes[0]
    negative = kinds[3]
    inside = RigidBody.from_file(write(path, negative, (2.0, 8.0)), density=1.0)
    assert inside.mass == pytest.approx(1000.0 - 216.0, rel=1e-14)
    assert RigidBody.from_file(write(path, negative, (20.0, 30.0)), density=1.0).mass == pytest.approx(1000.0)
    assert "removes nothing" in load(path).notes[0]
    with pytest.raises(FileFormatError, match="places no triangles"):
        load(write(path, negative, (-1.0, 11.0)))
    with pytest.raises(FileFormatError, match="'riddle', which is not known"):
        load(write(path, "riddle", (2.0, 8.0)))


@pytest.mark.parametrize("write", [prusa, bambu])
def test_a_negative_volume_that_cuts_the_surface(
    write: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("manifold3d")
    path = write(tmp_path / "a.3mf", "NegativeVolume" if write is prusa else "negative_part", (5.0, 15.0))
    assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(1000.0 - 125.0, rel=1e-9)
    monkeypatch.setattr("polhode.io.subtraction.has_union", lambda: False)
    with pytest.raises(FileFormatError, match=r"cuts through the surface.*pip install"):
        load(path)


def test_two_objects_of_one_id(tmp_path: Path) -> None:
    one = f'<object id="1">{mesh((0.0, 1.0))}</object>'
    with pytest.raises(FileFormatError, match=r"two objects of /m\.model have the id '1'"):
        load(package(tmp_path / "a.3mf", one + one, '<item objectid="1"/>'))


def test_components_are_in_the_order_of_the_file(tmp_path: Path) -> None:
    objects = "".join(
        f'<object id="{k}" name="n{k}">{mesh((3.0 * k, 3.0 * k + 1))}</object>' for k in range(3)
    )
    path = package(tmp_path / "a.3mf", objects, "".join(f'<item objectid="{k}"/>' for k in (1, 0, 2)))
    assert load(path).groups == (("n1", 12), ("n0", 12), ("n2", 12))
    text = dae(*cube()).decode()
    shown = '<instance_geometry url="#shape"/></node>'
    more = "".join(
        f'<node name="{n}"><translate>{9 * k} 0 0</translate>{shown}' for k, n in enumerate("xyz", 1)
    )
    (tmp_path / "a.dae").write_text(text.replace("\n</visual_scene>", more + "</visual_scene>"))
    assert [name for name, _ in load(tmp_path / "a.dae").groups][1:] == ["x", "y", "z"]


class TestAssemblies:
    def test_spheres_share_a_lens(self) -> None:
        for a, b, d in ((1.0, 1.0, 1.0), (2.0, 1.0, 2.5), (1.0, 3.0, 3.1)):
            ball = {"solid": "sphere", "mass": 1}
            parts = [
                ball | {"name": "a", "radius": a},
                ball | {"name": "b", "radius": b, "position": [0, d, 0]},
            ]
            (found,) = assembly.read({"part": parts}).overlaps
            lens = pi * (a + b - d) ** 2 * (d * d + 2 * d * (a + b) - 3 * (a - b) ** 2) / (12 * d)
            assert found.volume == pytest.approx(lens, rel=1e-13)

    def test_flat_solids_and_contact(self) -> None:
        pytest.importorskip("manifold3d")
        cubes = {"solid": "cube", "side": 1, "mass": 1}
        for step, volume in ((0.75, 0.25), (1.0, None), (1.5, None)):
            made = assembly.read(
                {"part": [cubes | {"name": "a"}, cubes | {"name": "b", "position": [step, 0, 0]}]}
            )
            assert [each.volume for each in made.overlaps] == (
                [] if volume is None else [pytest.approx(volume, rel=1e-12)]
            )

    def test_the_same_part_at_one_place(self) -> None:
        disk = {"solid": "disk", "radius": 1, "mass": 1}
        made = assembly.read({"part": [disk | {"name": "a"}, disk | {"name": "b"}]})
        assert [each[:3] for each in made.overlaps] == [("same", "a", "b")]
        assert "the mass counts 2 times" in made.notes[0]

    def test_a_part_with_the_name_of_the_file(self, tmp_path: Path) -> None:
        path = tmp_path / "wheel.toml"
        path.write_text('[[part]]\nname="wheel"\nsolid="disk"\nradius=1\nmass=2\n')
        made = assembly.read(path)
        assert (made.name, made["wheel"].mass, len(made)) == ("wheel", 2.0, 1)
        with pytest.raises(PolhodeError, match="the name is there twice"):
            assembly.read({"part": 2 * [{"name": "a", "solid": "disk", "radius": 1, "mass": 1}]})
