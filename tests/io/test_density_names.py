"""Densities by name, number or "*" in files of every format that has names, against a sum by hand."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from boxes import at
from cad_files import moved, primitive, write_assembly, write_iges
from command_line import run
from mesh_files import ascii_stl, three_mf
from polhode import RigidBody, assembly, solids
from polhode.errors import PolhodeError
from polhode.io.components import assign

SIDES = [(1.0, 1.0, 1.0), (1.0, 0.5, 0.75), (0.25, 0.5, 1.0)]
PLACES = [(0.0, 0.0, 0.0), (3.0, 0.5, 0.25), (0.0, 5.0, 0.0)]
NAMES = ["plate", "bolt", "bolt"]
MESHES = [at(sides, place) for sides, place in zip(SIDES, PLACES, strict=True)]


def by_hand(densities: list[float]) -> RigidBody:
    parts = [
        solids.box(sides, density=rho).translated(place)
        for sides, place, rho in zip(SIDES, PLACES, densities, strict=True)
    ]
    return sum(parts[1:], start=parts[0])


def obj_by(word: str) -> Callable[[Path], Path]:
    def write(path: Path) -> Path:
        lines, count = [], 1
        for name, (vertices, faces) in zip(NAMES, MESHES, strict=True):
            lines.append(f"{word} {name}")
            lines += ["v {!r} {!r} {!r}".format(*row) for row in vertices.tolist()]
            lines += ["f {} {} {}".format(*face) for face in (faces + count).tolist()]
            count += len(vertices)
        (path / "a.obj").write_text("\n".join(lines))
        return path / "a.obj"

    return write


def stl(path: Path) -> Path:
    texts = [ascii_stl(*mesh, name=name) for name, mesh in zip(NAMES, MESHES, strict=True)]
    (path / "a.stl").write_bytes(b"\n".join(texts))
    return path / "a.stl"


def three(path: Path) -> Path:
    more = ""
    for number, (vertices, faces) in enumerate(MESHES[1:], start=2):
        points = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in vertices.tolist())
        plates = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*face) for face in faces)
        more += f'<object id="{number}" type="model" name="bolt"><mesh><vertices>{points}</vertices>'
        more += f"<triangles>{plates}</triangles></mesh></object>"
    items = "".join(f'<item objectid="{k}"/>' for k in (1, 2, 3))
    data = three_mf(*MESHES[0], build=items, more=more)
    import io
    import zipfile

    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(path / "a.3mf", "w") as new:
        for member in old.namelist():
            new.writestr(
                member, old.read(member).replace(b'id="1" type="model"', b'id="1" type="model" name="plate"')
            )
    return path / "a.3mf"


def gltf(path: Path) -> Path:
    blob, views, accessors, meshes, nodes = b"", [], [], [], []
    for name, (vertices, faces) in zip(NAMES, MESHES, strict=True):
        own = vertices.astype("<f4")
        for data, kind, count in (
            (own.tobytes(), 5126, len(own)),
            (faces.astype("<u4").tobytes(), 5125, faces.size),
        ):
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
            form = {"bufferView": len(views) - 1, "componentType": kind, "count": count}
            bounds = {"min": own.min(axis=0).tolist(), "max": own.max(axis=0).tolist()}
            accessors.append(form | ({"type": "VEC3"} | bounds if kind == 5126 else {"type": "SCALAR"}))
            blob += data
        meshes.append(
            {"primitives": [{"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1}]}
        )
        nodes.append({"mesh": len(meshes) - 1, "name": name})
    uri = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": nodes,
        "meshes": meshes,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob), "uri": uri}],
    }
    (path / "a.gltf").write_text(json.dumps(scene))
    return path / "a.gltf"


FORMATS = {
    "o": obj_by("o"),
    "g": obj_by("g"),
    "usemtl": obj_by("usemtl"),
    "stl": stl,
    "3mf": three,
    "gltf": gltf,
}


@pytest.mark.parametrize("form", FORMATS)
def test_every_format_with_names(form: str, tmp_path: Path) -> None:
    path = FORMATS[form](tmp_path)
    unit = None if form in ("3mf", "gltf") else "m"
    for given, densities in (
        ({"plate": 2700.0, "bolt": 7800.0}, [2700.0, 7800.0, 7800.0]),
        ({"plate": 2700.0, "*": 1000.0}, [2700.0, 1000.0, 1000.0]),
        ({1: 1.0, 2: 2.0, 3: 3.0}, [1.0, 2.0, 3.0]),
        ({"bolt": 7800.0, "3": 5.0, "*": 1.0}, [1.0, 7800.0, 5.0]),
    ):
        body = RigidBody.from_file(path, density=given, length_unit=unit)
        assert body.isclose(by_hand(densities), rtol=1e-7 if form == "gltf" else 1e-13)
    with pytest.raises(
        PolhodeError, match=r"no component 'nut'; give one density for each of .*plate"
    ) as told:
        RigidBody.from_file(path, density={"nut": 1.0}, length_unit=unit)
    assert "bolt" in str(told.value)
    with pytest.raises(
        PolhodeError, match=r'nothing is said of component .*; add it, or "\*" for all others'
    ):
        RigidBody.from_file(path, density={"plate": 1.0}, length_unit=unit)


def base_materials(path: Path, by_triangle: bool) -> Path:
    """A 3MF file whose objects, or triangles, have base materials; the last has another property."""
    bases = "".join(f'<base name="{name}" displaycolor="#808080FF"/>' for name in ("steel", " PLA  blue"))
    more = f'<basematerials id="7">{bases}</basematerials>'
    choices = {"steel": ("7", "0"), "PLA blue": ("7", "1"), "": ("9", "0")}
    for number, (vertices, faces), name in zip((2, 3, 4), MESHES, ("PLA blue", "steel", ""), strict=True):
        group, place = choices[name]
        own = f'pid="{group}" pindex="{place}"' if not by_triangle else 'pid="7" pindex="0"'
        word = f'pid="{group}" p1="{place}"' if by_triangle else ""
        points = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in vertices.tolist())
        plates = "".join('<triangle v1="{}" v2="{}" v3="{}" {}/>'.format(*face, word) for face in faces)
        more += (
            f'<object id="{number}" type="model" name="o{number}" {own}><mesh><vertices>{points}</vertices>'
        )
        more += f"<triangles>{plates}</triangles></mesh></object>"
    data = three_mf(*MESHES[0], build="".join(f'<item objectid="{k}"/>' for k in (2, 3, 4)), more=more)
    (path / "m.3mf").write_bytes(data)
    return path / "m.3mf"


@pytest.mark.parametrize("by_triangle", [False, True])
def test_base_materials_of_3mf(tmp_path: Path, by_triangle: bool) -> None:
    path = base_materials(tmp_path, by_triangle)
    for given, densities in (
        ({"steel": 7.8, "PLA blue": 1.2, "*": 1.0}, [1.2, 7.8, 1.0]),
        ({"steel": 7.8, "o2": 5.0, "*": 1.0}, [5.0, 7.8, 1.0]),
        ({"PLA blue": 1.2, "o3": 3.0, "o4": 4.0}, [1.2, 3.0, 4.0]),
    ):
        assert RigidBody.from_file(path, density=given).isclose(by_hand(densities), rtol=1e-13)
    code, out, err = run("report", path, "--density", "steel=7.8, PLA blue=1.2, *=1", "--format", "json")
    assert code == 0, err
    assert json.loads(out)["mass"] == pytest.approx(float(by_hand([1.2, 7.8, 1.0]).mass), rel=1e-12)
    with pytest.raises(
        PolhodeError, match=r"no component 'brass'; give one density for each of .*PLA blue.*steel"
    ):
        RigidBody.from_file(path, density={"brass": 1.0})


def test_the_command_line_and_assemblies(tmp_path: Path) -> None:
    path = FORMATS["o"](tmp_path)
    expected = by_hand([2700.0, 7800.0, 7800.0])
    code, out, err = run(
        "report", path, "--length-unit", "m", "--density", "plate=2.7 g/cm^3, *=7800", "--format", "json"
    )
    assert code == 0, err
    assert json.loads(out)["mass"] == pytest.approx(float(expected.mass), rel=1e-12)
    part = {
        "name": "a",
        "file": "a.obj",
        "length_unit": "m",
        "density": {"plate": 2700, "bolt": "7.8 g/cm^3"},
    }
    made = assembly.read({"name": "whole", "part": [part]}, folder=tmp_path)
    assert made.body.isclose(expected, rtol=1e-13)
    with pytest.raises(PolhodeError, match=r"part 'a': .*no component 'nut'"):
        assembly.read({"name": "whole", "part": [part | {"density": {"nut": 1}}]}, folder=tmp_path)


def test_two_hundred_random_assemblies(rng: np.random.Generator, tmp_path: Path) -> None:
    FORMATS["g"](tmp_path)
    for _ in range(200):
        rho = rng.uniform(1.0, 9.0, 3).round(2).tolist()
        forms = [
            ({"plate": rho[0], "2": rho[1], "*": rho[2]}, rho),
            ({"bolt": rho[1], "plate": rho[0]}, [rho[0], rho[1], rho[1]]),
            ({"3": rho[2], "*": rho[0]}, [rho[0], rho[0], rho[2]]),
        ]
        given, densities = forms[rng.integers(3)]
        position = rng.normal(size=3)
        part = {
            "name": "a",
            "file": "a.obj",
            "length_unit": "m",
            "density": given,
            "position": position.tolist(),
        }
        made = assembly.read({"name": "whole", "part": [part]}, folder=tmp_path)
        assert made.body.isclose(by_hand(densities).translated(position), rtol=1e-12)


@pytest.mark.usefixtures("occt_here")
def test_solids_of_cad(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    path = tmp_path / "a.step"
    write_assembly(path, {"block": 2.0})
    whole = RigidBody.from_file(path, density=1.0)
    block = RigidBody.from_file(path, density={"block": 1.0, "*": 1e-12})
    balls = RigidBody.from_file(path, density={"ball": 3.0, "block": 1e-12})
    assert float(block.mass) + float(balls.mass) / 3.0 == pytest.approx(float(whole.mass), rel=1e-9)
    first = RigidBody.from_file(path, density={"ball#1": 3.0, "*": 1e-12})
    assert float(first.mass) == pytest.approx(0.5 * float(balls.mass), rel=1e-9)
    # What nothing is said of has the density of its material.
    known = RigidBody.from_file(path, density={"ball": 3.0})
    assert float(known.mass) == pytest.approx(2000.0 * float(block.mass) + float(balls.mass), rel=1e-9)
    code, _, err = run("report", path, "--density", "ball=3, block=2")
    assert code == 0, err
    with pytest.raises(PolhodeError, match="no component 'lid'"):
        RigidBody.from_file(path, density={"lid": 3.0})


@pytest.mark.usefixtures("occt_here")
def test_solids_of_iges(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    box = primitive("Box", 10.0, 20.0, 30.0)
    cans = [moved(primitive("Cylinder", 5.0, 8.0), x, 0.0, 0.0) for x in (50.0, 90.0)]
    path = write_iges(tmp_path / "a.igs", [("block", box()), *(("can", can()) for can in cans)])
    volumes = [6e-6] + [np.pi * 25.0 * 8.0 * 1e-9] * 2
    for given, densities in (
        ({"block": 2.0, "can": 3.0}, [2.0, 3.0, 3.0]),
        ({"can": 3.0, "*": 1.0}, [1.0, 3.0, 3.0]),
        ({"can#2": 4.0, "1": 2.0, "*": 1.0}, [2.0, 1.0, 4.0]),
    ):
        mass = sum(rho * volume for rho, volume in zip(densities, volumes, strict=True))
        assert float(RigidBody.from_file(path, density=given).mass) == pytest.approx(mass, rel=1e-8)
    with pytest.raises(
        PolhodeError, match=r"no component 'lid'; give one density for each of block, .*can#2"
    ):
        RigidBody.from_file(path, density={"lid": 3.0})


def test_the_more_specific_name_goes_first() -> None:
    names = [
        ("a/bolt#1", "a/bolt", "bolt", "steel"),
        ("a/bolt#2", "a/bolt", "bolt", "steel"),
        ("nut", "nut", "nut", "brass"),
    ]
    assert assign({"steel": 1, "a/bolt#2": 2, "*": 3}, names) == [1, 2, 3]
    assert assign({"bolt": 1, "steel": 2, 1: 5}, names) == [5, 1, None]
    assert assign({"*": 4}, names) == [4, 4, 4]
    for wrong in ("", "0", "4", "screw"):
        with pytest.raises(PolhodeError, match=r"there is no component .* by number from 1 to 3"):
            assign({wrong: 1}, names)
