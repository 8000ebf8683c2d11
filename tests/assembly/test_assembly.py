"""Assemblies: parts that are placed, turned, repeated and nested, against exact rational sums."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import trimesh
from command_line import one_line, run
from mesh_files import dae, glb, obj
from polhode import RigidBody, Uncertain, assembly, solids
from polhode.assembly.picture import _surface
from polhode.errors import PolhodeError
from random_assemblies import Random, ours, ten, toml

if TYPE_CHECKING:
    from numpy.typing import NDArray


@pytest.mark.parametrize("seed", range(60))
def test_random_trees_against_exact_sums(seed: int, tmp_path: Path) -> None:
    path, exact = Random(seed, tmp_path).tree(3)
    made = assembly.read(path)
    expected = ten(exact)
    length = np.sqrt(expected[4:7].max() / expected[0]) + np.abs(expected[1:4]).max()
    scale = expected[0] * np.array([1.0, *[length / expected[0]] * 3, *[length**2] * 6])
    for found in (ours(made.body), ours(made.ledger[made.ledger.root].body)):
        assert np.abs((found - expected) / scale).max() < 2e-14


class TestPlaces:
    def placed(self, **keys: Any) -> RigidBody:
        part = {"name": "a", "solid": "box", "size": [1, 2, 3], "mass": 1} | keys
        return assembly.read({"part": [part]}).body

    BOX = solids.box((1, 2, 3), mass=1.0)

    @pytest.mark.parametrize(
        "rotation",
        [
            {"axis": [0, 0, 2], "degrees": 30},
            {"axis": [0, 0, 1], "radians": np.pi / 6},
            {"sequence": "ZYX", "degrees": [30, 0, 0]},
            {"sequence": "xyz", "degrees": [0, 0, 30]},
            {"quaternion_xyzw": [0, 0, np.sin(np.pi / 12), np.cos(np.pi / 12)]},
            {"matrix": [[np.sqrt(0.75), -0.5, 0], [0.5, np.sqrt(0.75), 0], [0, 0, 1]]},
        ],
    )
    def test_ways_to_turn(self, rotation: dict[str, Any]) -> None:
        # Along x' = (cos 30°, sin 30°, 0): I' = R I Rᵀ by hand, I = (13, 10, 5)/12.
        c, s = np.sqrt(0.75), 0.5
        a, b = 13 / 12, 10 / 12
        found = self.placed(rotation=rotation, position=[1, 0, 0])
        expected = [[a * c * c + b * s * s, (a - b) * s * c, 0], [(a - b) * s * c, a * s * s + b * c * c, 0]]
        assert np.allclose(found.inertia[:2], expected, rtol=0, atol=4e-16)
        assert np.array_equal(found.center_of_mass, (1, 0, 0))

    @pytest.mark.parametrize("sequence", ["XYZ", "zyx", "ZXZ", "xzy", "YXY"])
    def test_sequences_are_those_of_euler_angles(self, sequence: str) -> None:
        from polhode import euler_angles

        q = euler_angles.to_quaternion(np.deg2rad([10.0, 20.0, 30.0]), sequence)
        found = self.placed(rotation={"sequence": sequence, "degrees": [10, 20, 30]})
        assert np.allclose(found.inertia, self.BOX.rotated(q).inertia, rtol=0, atol=1e-15)

    @pytest.mark.parametrize("turns", range(-4, 9))
    def test_quarter_turns_in_degrees_are_exact(self, turns: int) -> None:
        found = self.placed(rotation={"axis": [1, 0, 0], "degrees": 90 * turns}, position=[0, 1, 0])
        moments = np.diag(self.BOX.inertia)[[0, 2, 1] if turns % 2 else [0, 1, 2]]
        assert np.allclose(found.inertia, np.diag(moments), rtol=0, atol=2e-16)

    def test_the_innermost_unit_counts(self, tmp_path: Path) -> None:
        part = {"name": "a", "solid": "cube", "side": 10, "mass": 1, "position": [100, 0, "1 m"]}
        made = assembly.read({"length_unit": "mm", "part": [part, part | {"name": "b", "length_unit": "cm"}]})
        centers = [one.body.center_of_mass.tolist() for one in made.parts]
        assert centers == [[0.1, 0.0, 1.0], [1.0, 0.0, 1.0]]
        assert [one.body.inertia[0, 0] for one in made.parts] == pytest.approx(
            [1e-4 / 6, 1e-2 / 6], rel=1e-15
        )
        inner = tmp_path / "inner.toml"
        inner.write_text(toml({"part": [part | {"position": [1, 0, 0], "side": 1}]}))  # in metres of its own
        outer = {
            "length_unit": "mm",
            "part": [{"name": "x", "assembly": "inner.toml", "position": [500, 0, 0]}],
        }
        assert assembly.read(outer, folder=tmp_path).body.center_of_mass.tolist() == [1.5, 0.0, 0.0]

    def test_copies_go_round(self) -> None:
        keys = {
            "position": [2, 0, 0],
            "count": 4,
            "turn": {"axis": [0, 0, 1], "degrees": 90},
            "step": [0, 0, 1],
        }
        part = {"name": "leg", "solid": "box", "size": [1, 2, 3], "mass": 1} | keys
        made = assembly.read({"name": "table", "part": [part]})
        assert [one.id for one in made.parts] == ["leg/1", "leg/2", "leg/3", "leg/4"]
        centers = np.array([one.body.center_of_mass for one in made.parts])
        assert np.allclose(centers, [[2, 0, 0], [0, 2, 1], [-2, 0, 2], [0, -2, 3]], atol=1e-15)
        assert made["leg"].mass == 4.0
        assert [child.id for child in made["leg"].children] == [one.id for one in made.parts]

    def test_copies_at_one_place_are_told(self) -> None:
        made = assembly.read({"part": [{"name": "screw", "solid": "cube", "side": 1, "mass": 1, "count": 3}]})
        assert made.body.mass == 3.0
        assert len(made.notes) == 1
        assert "at the same place: the mass counts 3 times" in made.notes[0]


class TestSigmas:
    def test_copies_share_their_errors_and_others_do_not(self) -> None:
        part = {"name": "a", "solid": "cube", "side": 1, "density": "2.0 ± 0.1", "count": 4}
        moved = part | {"step": [3, 0, 0], "turn": {"axis": [0, 0, 1], "degrees": 90}}
        made = assembly.read(
            {"part": [moved, {"name": "b", "solid": "sphere", "radius": 1, "mass": "1.0(1)"}]}
        )
        assert made.body.sigma is not None
        assert made.body.sigma.mass == pytest.approx(np.hypot(4 * 0.1, 0.1), rel=1e-14)
        root = made.ledger[made.ledger.root]
        assert root.covariance is not None
        assert made.body.covariance is not None
        assert np.allclose(root.covariance, made.body.covariance, rtol=1e-12, atol=1e-14)
        group = RigidBody.stack([one.body for one in made.parts[:4]]).combined()
        assert made["a"].covariance is not None
        assert group.covariance is not None
        assert np.allclose(made["a"].covariance, group.covariance, rtol=1e-12, atol=1e-14)
        shares = made.ledger.variance_shares("Izz")
        assert list(shares.names) == ["a/1 and 3 like it", "b"]

    def test_of_a_saved_body(self, tmp_path: Path) -> None:
        body = solids.box((1, 2, 3), mass=Uncertain(2.0, sigma=0.1))
        body = body.with_sigma(center_of_mass=(0.1, 0.2, 0.3), inertia=np.full((3, 3), 0.01))
        body.save(tmp_path / "b.json")
        part = {
            "name": "b",
            "file": "b.json",
            "position": [1, 2, 3],
            "rotation": {"axis": [1, 1, 0], "degrees": 50},
        }
        parts = [part, part | {"name": "c", "position": [0, 0, 1]}]
        made = assembly.read({"part": parts}, folder=tmp_path)
        root = made.ledger[made.ledger.root]
        assert root.covariance is not None
        assert made.body.covariance is not None
        assert np.allclose(root.covariance, made.body.covariance, rtol=1e-11, atol=1e-12)


CUBE = {"name": "a", "solid": "cube", "side": 1, "mass": 1}
REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"part": [CUBE], "lenght_unit": "mm"}, "'lenght_unit' is not a known key; is 'length_unit' meant"),
    (
        {"part": [CUBE | {"positon": [0, 0, 1]}]},
        "part 'a' (cube): 'positon' is not a known key; is 'position' meant",
    ),
    ({"part": [CUBE | {"radius": 1}]}, "'radius' is not a known key"),
    ({"part": [{"name": "a", "sollid": "cube"}]}, "'sollid' is not a known key; is 'solid' meant"),
    ({"part": [{"name": "a", "mass": 1}]}, "expected one of solid, file, assembly, inertia, got none"),
    ({"part": [CUBE | {"file": "x.stl"}]}, "got solid and file"),
    ({"part": [{"solid": "cube"}]}, "part 1: it has no name"),
    ({"part": [CUBE, CUBE]}, "the name is there twice"),
    ({"part": [CUBE | {"name": "a/b"}]}, "has a / or a blank at its end"),
    ({"part": []}, "it has no parts"),
    ({}, "it has no parts"),
    ({"part": [CUBE | {"density": 1}]}, "needs its mass or its density; state one of the two"),
    ({"part": [{"name": "a", "solid": "cube", "side": 1}]}, "needs its mass or its density"),
    ({"part": [{"name": "a", "solid": "cube", "mass": 1}]}, "a cube takes side; state side"),
    ({"part": [{"name": "a", "solid": "cub", "mass": 1}]}, "there is no 'cub'; write one of"),
    ({"part": [CUBE | {"side": -1}]}, "side"),
    ({"part": [CUBE | {"side": True}]}, "side: True is not a number"),
    ({"part": [CUBE | {"side": "1 kg"}]}, "cannot be converted to m"),
    ({"part": [CUBE | {"side": float("inf")}]}, "is not finite"),
    ({"part": [CUBE | {"position": [1, 2]}]}, "position: expected 3 numbers, got 2"),
    ({"part": [CUBE | {"length_unit": "mmm"}]}, "'mmm' is not a known unit"),
    ({"part": [CUBE | {"length_unit": 3}]}, "is not the name of a unit"),
    ({"part": [CUBE | {"rotation": [0, 0, 90]}]}, "is not a table that says what it means"),
    ({"part": [CUBE | {"rotation": {"axis": [0, 0, 1]}}]}, "as degrees or as radians"),
    ({"part": [CUBE | {"rotation": {"axis": [0, 0, 0], "degrees": 3}}]}, "has no direction"),
    ({"part": [CUBE | {"rotation": {"angle": 3}}]}, "'angle' is not a known key"),
    ({"part": [CUBE | {"rotation": {"degrees": 3}}]}, "give one of axis, sequence, quaternion_xyzw, matrix"),
    ({"part": [CUBE | {"rotation": {"sequence": "xYz", "degrees": [1, 2, 3]}}]}, "expected three letters"),
    (
        {"part": [CUBE | {"rotation": {"quaternion_xyzw": [0, 0, 1, 1]}}]},
        "its length is 1.41421356, expected 1",
    ),
    ({"part": [CUBE | {"rotation": {"matrix": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}}]}, "it mirrors"),
    ({"part": [CUBE | {"rotation": {"matrix": [[1, 1, 0], [0, 1, 0], [0, 0, 1]]}}]}, "off from unit vectors"),
    ({"part": [CUBE | {"count": 0}]}, "is not a whole number from 1"),
    ({"part": [CUBE | {"count": 100_001}]}, "is not a whole number from 1"),
    ({"part": [CUBE | {"count": 100_000}]}, "more than 100000 parts"),
    ({"part": [CUBE | {"step": [1, 0, 0]}]}, "state count, 2 or more"),
    ({"part": [{"name": "a", "file": "part.obj", "mass": 1}]}, "does not say its unit of length"),
    ({"part": [{"name": "a", "file": "none.obj", "mass": 1, "length_unit": "m"}]}, "No such file"),
    ({"part": [{"name": "a", "file": "b.toml"}]}, "write assembly ="),
    ({"part": [{"name": "a", "assembly": "b.toml"}]}, "b.toml: No such file"),
    ({"part": [{"name": "a", "assembly": "b.toml", "mass": 3}]}, "an assembly has that of its parts"),
    ({"part": [{"name": "a", "inertia": 3}]}, "write a table"),
    ({"part": [{"name": "a", "inertia": {"mass": 1}}]}, "it has no tensor; state it"),
    (
        {"part": [{"name": "a", "inertia": {"mass": 1, "tensor": [1, 1, 1, 0.1, 0, 0]}}]},
        "which sign Ixy = 0.1 has",
    ),
    (
        {"part": [{"name": "a", "inertia": {"mass": 1, "tensor": [1, 1]}}]},
        "expected 3, 6 or 9 numbers, got 2",
    ),
    ({"part": [{"name": "a", "inertia": {"mass": 1, "tensor": [1, 1, 3]}}]}, "part 'a': inertia: "),
    (
        {"part": [{"name": "a", "inertia": {"mass": 1, "tensor": [1, 1, 1], "about": "C"}}]},
        "about: expected center_of_mass or",
    ),
]


class TestUnitsOfFiles:
    @pytest.fixture
    def box(self, tmp_path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """A box of 20 by 30 by 40, as a DAE in centimetres, a GLB, which is in metres, and an OBJ."""
        solid = trimesh.creation.box((20, 30, 40))
        mesh = np.asarray(solid.vertices), np.asarray(solid.faces)
        (tmp_path / "part.dae").write_bytes(dae(*mesh, unit='<unit meter="0.01"/>'))
        (tmp_path / "part.glb").write_bytes(glb(*mesh))
        (tmp_path / "part.obj").write_bytes(obj(*mesh))
        return mesh

    @pytest.mark.usefixtures("box")
    @pytest.mark.parametrize(("name", "own"), [("part.dae", 0.01), ("part.glb", 1.0), ("part.obj", 0.001)])
    def test_a_file_keeps_its_own(self, name: str, own: float, tmp_path: Path) -> None:
        table = {"length_unit": "mm", "part": [{"name": "a", "file": name, "density": 1000.0}]}
        whole = assembly.read(table, folder=tmp_path)
        assert whole.body.mass == pytest.approx(24e6 * own**3, rel=1e-6)
        points, _ = _surface(whole.parts[0], 100)
        np.testing.assert_allclose(np.ptp(points, axis=0), np.array([20, 30, 40]) * own, rtol=1e-6)

    @pytest.mark.usefixtures("box")
    def test_another_is_refused_or_taken(self, tmp_path: Path) -> None:
        part = {"name": "a", "file": "part.dae", "density": 1000.0, "length_unit": "mm"}
        with pytest.raises(PolhodeError, match="says itself that its unit is 'cm'"):
            assembly.read({"part": [part]}, folder=tmp_path)
        whole = assembly.read({"part": [part | {"file": "part.glb"}]}, folder=tmp_path)
        assert whole.body.mass == pytest.approx(0.024e-3 * 1000, rel=1e-6)

    def test_molecules_are_in_angstrom(self, tmp_path: Path) -> None:
        (tmp_path / "pair.xyz").write_text("2\npair\nH 0 0 0\nH 2 0 0\n")
        part = {"name": "a", "file": "pair.xyz"}
        for unit, metres in (({}, 1e-10), ({"length_unit": "nm"}, 1e-9)):
            whole = assembly.read({"length_unit": "in", "part": [part | unit]}, folder=tmp_path)
            np.testing.assert_allclose(whole.body.center_of_mass, [metres, 0, 0], rtol=1e-12)


class TestMeshes:
    CORNER = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"

    def part(self, tmp_path: Path, faces: str, **keys: Any) -> dict[str, Any]:
        (tmp_path / "part.obj").write_text(self.CORNER + faces)
        return {"part": [{"name": "a", "file": "part.obj", "length_unit": "m", "density": 6.0} | keys]}

    def test_one_is_repaired_where_its_part_says_so(self, tmp_path: Path) -> None:
        table = self.part(tmp_path, "f 1 3 2\nf 1 2 4\nf 2 3 4\n")
        with pytest.raises(PolhodeError, match="repair = true mends it") as caught:
            assembly.read(table, folder=tmp_path)
        assert 'closure = "caps" or "hull"' in str(caught.value)
        (tmp_path / "whole.toml").write_text(toml(table))
        _, _, err = run("assemble", tmp_path / "whole.toml")
        assert "repair = true mends it" in err
        assert "--" not in err
        table["part"][0]["repair"] = True
        whole = assembly.read(table, folder=tmp_path)
        assert whole.body.mass == pytest.approx(1.0, rel=1e-14)
        assert "part 'a': its mesh was repaired" in whole.notes[0]
        table["part"][0]["repair"] = "no"
        with pytest.raises(PolhodeError, match="repair: 'no' is neither true nor false"):
            assembly.read(table, folder=tmp_path)

    def test_what_overlaps_is_joined_where_its_part_says_so(self, tmp_path: Path) -> None:
        pytest.importorskip("manifold3d", reason="joining needs polhode[union]")
        boxes = [trimesh.creation.box((2, 2, 2)) for _ in range(2)]
        boxes[1].apply_translation((1, 0, 0))
        both: Any = trimesh.util.concatenate(boxes)
        (tmp_path / "part.obj").write_bytes(obj(np.asarray(both.vertices), np.asarray(both.faces)))
        part = {"name": "a", "file": "part.obj", "length_unit": "m", "density": 1.0, "union": True}
        assert assembly.read({"part": [part]}, folder=tmp_path).body.mass == pytest.approx(12.0, rel=1e-12)

    def test_faces_that_count_from_0_in_a_packed_file(self, tmp_path: Path) -> None:
        text = self.CORNER + "f 0 2 1\nf 0 1 3\nf 1 2 3\nf 0 3 2\n"
        (tmp_path / "part.tab.gz").write_bytes(gzip.compress(text.encode()))
        part = {"name": "a", "file": "part.tab.gz", "length_unit": "m", "density": 6.0, "index_base": 0}
        assert assembly.read({"part": [part]}, folder=tmp_path).body.mass == pytest.approx(1.0, rel=1e-14)


class TestRefused:
    @pytest.mark.parametrize(("table", "says"), REFUSED, ids=[says[:40] for _, says in REFUSED])
    def test_it_says_where_and_why(self, table: dict[str, Any], says: str, tmp_path: Path) -> None:
        (tmp_path / "part.obj").write_text(
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
        )
        with pytest.raises(PolhodeError) as caught:
            assembly.read(table, folder=tmp_path)
        assert says in str(caught.value)
        if table.get("part"):
            path = tmp_path / "whole.toml"
            path.write_text(toml(table).replace("Infinity", "inf"))
            code, out, err = run("assemble", path)
            assert (code, out) == (2, "")
            assert one_line(err)
            assert says in err
            assert "whole.toml" in err

    def test_circles(self, tmp_path: Path) -> None:
        for one, other in (("a", "b"), ("b", "c"), ("c", "b")):
            part = {"name": "x", "assembly": f"{other}.toml"}
            (tmp_path / f"{one}.toml").write_text(toml({"part": [part]}))
        with pytest.raises(PolhodeError, match=r"part of itself: b\.toml holds c\.toml holds b\.toml"):
            assembly.read(tmp_path / "a.toml")

    def test_too_many_by_nesting(self, tmp_path: Path) -> None:
        (tmp_path / "a0.toml").write_text(toml({"part": [CUBE]}))
        for k in range(1, 5):
            part = {"name": "x", "assembly": f"a{k - 1}.toml", "count": 1000, "step": [1, 0, 0]}
            (tmp_path / f"a{k}.toml").write_text(toml({"part": [part]}))
        with pytest.raises(PolhodeError, match="more than 100000 parts"):
            assembly.read(tmp_path / "a4.toml")

    def test_not_toml(self, tmp_path: Path) -> None:
        path = tmp_path / "a.toml"
        path.write_text("[[part]\n")
        with pytest.raises(PolhodeError, match="not TOML"):
            assembly.read(path)
