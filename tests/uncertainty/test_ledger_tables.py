"""Tables of parts: what they may look like, and every bad row named with its line, the law and the number."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, laminae, samples, solids
from polhode.errors import InvalidInertiaError
from polhode.uncertainty import ledger
from random_ledgers import (
    NUMBERS,
    covariances,
    random_tree,
    ten,
    values,
)

CRAFT = samples.path("craft.csv")
HEAD = "id,parent,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,Ixy,Ixz,Iyz,POIconv,sigma_mass"
GOOD = "a,,,,,,,,,,,,,\nb,a,1,0,0,0,1,1,1,0,0,0,-,0.1\n"
BAD_ROWS = {
    "c,a,-1,0,0,0,1,1,1,0,0,0,-,": (InvalidInertiaError, "line 4 ('c'): mass must be positive, got -1.0"),
    "c,a,1,0,0,0,1,1,3,0,0,0,-,": (
        InvalidInertiaError,
        "line 4 ('c'): principal moments 1.0, 1.0, 3.0 break the triangle",
    ),
    "c,a,1,0,0,0,1,1,1,0,0,0,-,-0.1": (ValueError, "line 4 ('c'): sigma_mass must not be negative, got -0.1"),
    "c,a,1,x,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4: Cx is not a number: 'x'"),
    "c,a,1,nan,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4: Cx is not a number: 'nan'"),
    "c,a,1,inf,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4: Cx must be finite, got inf"),
    "c,a,1,,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('c'): has no children, and no Cx"),
    "c,a,1,0,0,0,,1,1,0,0,0,-,": (ValueError, "no Ixx; state it; Ipoint TRUE takes the part as a point"),
    "c,a,1,0,0,0,1,1,1,0.1,0,0,,": (ValueError, "line 4 ('c'): nothing says which sign Ixy = 0.1 has"),
    "c,a,1,0,0,0,1,1,1,0.1,0,0,?,": (ValueError, "line 4 ('c'): POIconv is '?'; write + or -"),
    "c,z,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('c'): an orphan: its parent 'z' has no row"),
    "c,,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('c'): a second root: 'a' and 'c' have no parent"),
    "b,a,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('b'): id 'b' is there twice, first at"),
    ",a,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 (''): id is empty"),
    "c,b,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 3 ('b'): has children, and mass = 1 of its own"),
    "c,a,,,,,,,,,,,,": (ValueError, "line 4 ('c'): has no children, and no mass"),
    "c,a,1,0,0": (ValueError, "line 4: 5 cells, but 14 columns"),
    "c,d,,,,,,,,,,,,\nd,e,,,,,,,,,,,,\ne,c,,,,,,,,,,,,": (
        ValueError,
        "line 4 ('c'): a cycle: 'c' in 'd' in 'e' in 'c'",
    ),
    "c,c,,,,,,,,,,,,": (ValueError, "line 4 ('c'): a cycle: 'c' in 'c'"),
}
BAD_TABLES: dict[str, tuple[dict[str, Any], str]] = {
    "unknown column": (
        {"sigma_mas": [0.1]},
        "table: nobody knows the column 'sigma_mas'; meant 'sigma_mass'",
    ),
    "far from any": ({"vendor": ["x"]}, "words for the reader may stand in 'name' and 'comment'"),
    "lengths": ({"name": ["x", "y"]}, "has 1 rows, but 'name' has 2"),
    "axes": ({"name": np.zeros((1, 2))}, "column 'name' has shape (1, 2)"),
    "truth": ({"Ipoint": ["maybe"]}, "row 0: Ipoint is 'maybe'; write TRUE or FALSE"),
    "about": ({"about": ["C"]}, "row 0 ('p'): about is 'C'; write center_of_mass or origin"),
    "growth": ({"growth": [15.0]}, "row 0 ('p'): growth must be a fraction of the basic mass from 0 to 1"),
    "growth below": ({"growth": [-0.1]}, "got -0.1"),
    "density": ({"density": [2.0]}, "row 0 ('p'): density and arguments are of a file or a solid"),
    "solid and tensor": ({"solid": ["cube"], "arguments": ["side=1"]}, "a tensor is stated beside the solid"),
}
SHAPES: dict[str, tuple[dict[str, Any], str]] = {
    "no such": (
        {"solid": "blob", "mass": 1},
        "row 0 ('p'): solid: there is no 'blob'; there are annulus, arc",
    ),
    "missing": (
        {"solid": "cube", "mass": 1},
        "arguments: cube: missing a required argument: 'side'; it takes side",
    ),
    "other": ({"solid": "cube", "arguments": "edge=1", "mass": 1}, "it takes side"),
    "word": ({"solid": "cube", "arguments": "side=long", "mass": 1}, "row 0 ('p'): "),
    "form": ({"solid": "cube", "arguments": "side", "mass": 1}, "arguments: 'side' is not name=value"),
    "twice": ({"solid": "cube", "arguments": "side=1 side=2", "mass": 1}, "arguments: 'side' is there twice"),
    "neither": ({"solid": "cube", "arguments": "side=1"}, "its mass or its density: one of each"),
    "both": ({"solid": "cube", "arguments": "side=1", "mass": 1, "density": 1}, "one of each"),
    "two": ({"solid": "cube", "file": "x.stl", "mass": 1}, "give a file or a solid"),
    "sigma of mass": (
        {"solid": "cube", "arguments": "side=1", "density": 1, "sigma_mass": 1},
        "state sigma_density",
    ),
    "sigma of density": (
        {"solid": "cube", "arguments": "side=1", "mass": 1, "sigma_density": 1},
        "state sigma_mass",
    ),
    "absent": ({"file": "nowhere.stl", "mass": 1}, "row 0 ('p'): [Errno 2]"),
    "negative": ({"solid": "cube", "arguments": "side=-1", "mass": 1}, "row 0 ('p'): side"),
}


class TestBadTables:
    @pytest.mark.parametrize("row", BAD_ROWS)
    def test_rows(self, row: str, tmp_path: Path) -> None:
        kind, words = BAD_ROWS[row]
        (tmp_path / "parts.csv").write_text(f"{HEAD}\n{GOOD}{row}\n", "utf-8")
        with pytest.raises(kind) as told:
            ledger(tmp_path / "parts.csv")
        assert f"{tmp_path / 'parts.csv'}: line " in str(told.value)
        assert words in str(told.value)

    @pytest.mark.parametrize("name", BAD_TABLES)
    def test_columns(self, name: str) -> None:
        columns, words = BAD_TABLES[name]
        good: dict[str, Any] = {"id": ["p"], "parent": [""], "POIconv": "-"}
        good |= {number: [1.0 if k < 7 else 0.0] for k, number in enumerate(NUMBERS)}
        ledger(good)
        with pytest.raises(ValueError, match=r"^(table|row 0)") as told:
            ledger(good | columns)
        assert words in str(told.value)

    @pytest.mark.parametrize("name", SHAPES)
    def test_shapes(self, name: str) -> None:
        row, words = SHAPES[name]
        with pytest.raises(ValueError, match="p") as told:
            ledger([{"id": "p", "parent": ""} | row])
        assert words in str(told.value)

    def test_the_first_of_many_bad_bodies_is_named(self) -> None:
        table, below = random_tree(20_000, 1)
        for row in below["n0"][7000::1000]:
            table["Izz"][row] = 1e4
        with pytest.raises(
            InvalidInertiaError, match=rf"^row {below['n0'][7000]} \('n{below['n0'][7000]}'\): principal"
        ):
            ledger(table)

    def test_numbers_beyond_the_range_of_floats(self) -> None:
        rows: list[dict[str, Any]] = [{"id": "all"}, {"id": "p", "parent": "all", "sigma_mass": 0.1}]
        rows[1] |= {"mass": 1.0, "Cx": 1.0, "Cy": 0.0, "Cz": 0.0, "Ipoint": True}
        assert ledger([*rows[:1], rows[1] | {"sigma_mass": 1e150}])["all"].with_sigma("mass")[1] == 1e150
        with pytest.raises(ValueError, match="the sigmas of 'all' are beyond the range of numbers"):
            ledger([*rows[:1], rows[1] | {"sigma_mass": 1e160}])
        with pytest.raises(ValueError, match="the numbers of 'all' are beyond the range of numbers"):
            ledger([*rows, rows[1] | {"id": "q", "Cx": 1e160}])

    def test_spoilt_cells(self, tmp_path: Path) -> None:
        """Cells of a table replaced by others, or by words: a ledger, or an error that says where."""
        words = [
            "",
            "NA",
            "nan",
            "inf",
            "1e308",
            "1e-320",
            "-1",
            "0",
            "x",
            "%",
            "=",
            "craft",
            "wheels",
            "origin",
            "+",
        ]
        rows = [line.split(",") for line in CRAFT.read_text("utf-8").splitlines()]
        cells = [*words, *(cell for row in rows for cell in row if cell)]
        rng = np.random.default_rng(5)
        good, told = 0, []
        for _ in range(600):
            spoilt = [list(row) for row in rows]
            for _ in range(int(rng.integers(1, 4))):
                row = spoilt[int(rng.integers(len(rows)))]
                row[int(rng.integers(len(row)))] = cells[int(rng.integers(len(cells)))]
            file = tmp_path / "parts.csv"
            file.write_text("".join(f"{','.join(row)}\n" for row in spoilt), "utf-8")
            try:
                made = ledger(file)
            except ValueError as error:
                told.append(str(error))
                continue
            good += 1
            assert np.all(np.isfinite(covariances(made)))
            assert np.all(np.linalg.eigvalsh(made.inertia) > -1e-9 * np.abs(made.inertia).max())
        assert 60 < good < 300
        places = re.compile(rf"{re.escape(str(tmp_path / 'parts.csv'))}: |the (numbers|sigmas) of ")
        assert [words for words in told if not places.match(words)] == []

    def test_texts_that_are_no_table(self, tmp_path: Path) -> None:
        file = tmp_path / "parts.csv"
        for text, words in (
            ("", "the file is empty"),
            ("id,parent\n", "there are no rows"),
            ("id,id\na,b\n", "line 1: column 'id' is there twice"),
            ("name\na\n", "there is no column 'id'"),
            ("id\na\n", "there is no column 'parent'"),
            ('id,parent\n"a,b\n', "line 2: not a table"),
        ):
            file.write_text(text, "utf-8")
            with pytest.raises(ValueError, match=words):
                ledger(file)
        file.write_bytes(b"id,parent\n\xff,\n")
        with pytest.raises(ValueError, match="not a text file, so not a table: byte 10 is not UTF-8"):
            ledger(file)
        with pytest.raises(TypeError, match="table: expected a path, columns by name or rows, got int"):
            ledger(3)
        with pytest.raises(TypeError, match="row 0: expected a mapping of columns to cells, got str"):
            ledger(["a"])

    def test_trees(self) -> None:
        point = {"mass": 1, "Cx": 0, "Cy": 0, "Cz": 0, "Ipoint": True}
        rows: list[dict[str, Any]] = [{"id": "a"}, {"id": "b"} | point, {"id": "c"} | point]
        good = [{"child": "b", "parent": "a"}, {"child": "c", "parent": "a"}]
        assert ledger(rows, good)["a"].mass == 2.0
        for edges, words in (
            ([*good, {"child": "d", "parent": "a"}], "row 2: the table has no row of 'd'"),
            ([*good, {"child": "c", "parent": "b"}], "row 2: 'c' has two parents, 'a' and 'b'"),
            ([{"child": "c", "above": "b"}], "tree: nobody knows the column 'above'"),
            ([{"parent": "b"}], "tree: a tree has the columns 'child' and 'parent'"),
        ):
            with pytest.raises(ValueError, match=words):
                ledger(rows, edges)
        with pytest.raises(ValueError, match=r"row 2 \('c'\): its parent is 'b' here, but 'a' in the tree"):
            ledger([*rows[:2], rows[2] | {"parent": "b"}], good)

    def test_columns_that_are_left_out(self) -> None:
        row = {"id": "p", "parent": "", "mass": 1, "Cx": 0, "Cy": 0, "Cz": 0, "Ipoint": True, "vendor": "x"}
        with pytest.raises(ValueError, match="pass ignore with its name"):
            ledger([row])
        assert ledger([row], ignore=("vendor",))["p"].mass == 1.0

    def test_a_tensor_of_few_digits(self) -> None:
        row = {
            "id": "p",
            "mass": 1,
            "Cx": 0,
            "Cy": 0,
            "Cz": 0,
            "Ixx": 1,
            "Iyy": 1,
            "Izz": 2.001,
            "Ixy": 0,
            "Ixz": 0,
            "Iyz": 0,
        }
        with pytest.raises(InvalidInertiaError, match="pass rtol="):
            ledger([row | {"parent": ""}])
        assert ledger([row | {"parent": ""}], rtol=1e-3).bodies.mass == 1.0


class TestTables:
    def test_separators_quotes_blank_lines_and_marks(self, tmp_path: Path) -> None:
        file = tmp_path / "parts.csv"
        text = (
            'id,parent,name,mass,Cx,Cy,Cz,Ipoint,growth\n\n"a, b",,"two\nlines",NA,NA,,,,\n'
            'c,"a, b",x, 2 ,1,0,0,yes,15%\n'
        )
        for mark in ("", "\ufeff"):
            file.write_text(mark + text, "utf-8")
            made = ledger(file)
            assert made.ids == ("a, b", "c")
            assert made["c"].predicted_mass == pytest.approx(2.3)
        file.write_text(text.replace(" 2 ", "two"), "utf-8")
        with pytest.raises(ValueError, match="line 5: mass is not a number: 'two'"):
            ledger(file)
        file.write_text("id;parent;mass;Cx;Cy;Cz;Ipoint\na;;2;1;0;0;T\n", "utf-8")
        assert ledger(file)["a"].mass == 2.0

    def test_columns_rows_and_frames_alike(self) -> None:
        table, _ = random_tree(30, 4)
        rows = [{name: column[k] for name, column in table.items()} for k in range(30)]

        class Frame:
            def keys(self) -> list[str]:
                return list(table)

            def __getitem__(self, name: str) -> Any:
                return np.array(table[name], dtype=object if name == "parent" else None)

        one = ledger(table)
        for other in (ledger(rows), ledger(Frame()), ledger(iter(rows))):
            assert other.ids == one.ids
            assert np.array_equal(values(other), values(one))
            assert np.array_equal(covariances(other), covariances(one))

    def test_ids_that_are_numbers(self) -> None:
        rows = {"id": [1, 2, 3], "parent": [np.nan, 1.0, 1.0], "mass": [np.nan, 2.0, 3.0], "Ipoint": True}
        assert ledger(rows | {"Cx": 0.0, "Cy": 0.0, "Cz": 0.0}, overwrite=True)["1"].mass == 5.0

    def test_nothing_of_the_caller_s_is_changed(self) -> None:
        table, _ = random_tree(30, 4)
        table["POIconv"] = ["+"] * 30
        table |= {name: -table[name] for name in ("Ixy", "Ixz", "Iyz")}
        table["Ipoint"] = np.arange(30) % 2 == 0
        before = {name: np.array(column) for name, column in table.items()}
        made = ledger(table)
        assert all(
            np.array_equal(table[name], before[name], equal_nan=name not in ("id", "parent", "POIconv"))
            for name in table
        )
        for array in (made.mass, made.center_of_mass, made.inertia, made.covariance, made.depth):
            assert array is not None
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1.0
        with pytest.raises(AttributeError):
            made.mass = made.mass  # type: ignore[misc]


class TestSigns:
    """Rows of one source with products of both signs share the error of the element of the tensor."""

    ROWS: ClassVar[list[dict[str, Any]]] = [
        {"id": "whole", "parent": ""},
        *(
            {"id": name, "parent": "whole", "mass": 2.0, "Cx": x, "Cy": 0.5, "Cz": 0.0, "Ixx": 3.0}
            | {"Iyy": 3.0, "Izz": 3.0, "Ixy": 0.2, "Ixz": 0.0, "Iyz": -0.1, "POIconv": "-", "source": source}
            | {"sigma_Ixy": 0.03, "sigma_Iyz": sigma}
            for name, x, source, sigma in (
                ("a", 0.0, "rig", 0.02), ("b", 1.0, "rig", 0.0), ("c", 2.0, "rig", 0.01), ("d", 3.0, "", 0.02)
            )
        ),
    ]  # fmt: skip

    def with_signs(self, signs: str) -> list[dict[str, Any]]:
        rows = [dict(row) for row in self.ROWS]
        for row, sign in zip(rows[1:], signs, strict=True):
            if sign == "+":
                row |= {"POIconv": "+"} | {name: -row[name] for name in ("Ixy", "Ixz", "Iyz")}
        return rows

    @pytest.mark.parametrize("signs", ["----", "++++", "+---", "-+--", "--+-", "---+", "+-+-"])
    def test_the_words_of_a_table_change_no_covariance(self, signs: str) -> None:
        made, plain = (ledger(self.with_signs(each)) for each in (signs, "----"))
        assert made.covariance is not None
        assert plain.covariance is not None
        np.testing.assert_array_equal(made.covariance, plain.covariance)
        stated = {
            name: {signs[k] for k in range(3) if self.ROWS[k + 1][f"sigma_{name}"]} for name in ("Ixy", "Iyz")
        }
        both = tuple(name for name, found in stated.items() if len(found) == 2)
        assert made.opposite_signs == ({"rig": both} if both else {})

    def test_they_are_told(self, tmp_path: Path) -> None:
        for signs, is_told in (("+---", True), ("++++", False)):
            path = tmp_path / f"{is_told}.csv"
            rows = self.with_signs(signs)
            names = list(rows[1])
            lines = [",".join(str(row.get(name, "")) for name in names) for row in rows]
            path.write_text("\n".join([",".join(names), *lines]), "utf-8")
            code, out, _ = run("ledger", path)
            assert code == 0
            told = "source rig: its parts state Ixy, Iyz with both signs of POIconv; what they share is"
            assert (told in out) == is_told


class TestShapes:
    def test_solids_and_files(self, tmp_path: Path) -> None:
        (tmp_path / "box.obj").write_text(
            "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "utf-8"
        )
        (tmp_path / "parts.csv").write_text(
            "id,parent,solid,file,arguments,mass,density,sigma_mass,sigma_density,Cx,Cy,Cz,sigma_Cx\n"
            "all,,,,,,,,,,,,\n"
            "tank,all,cylinder,,radius=0.5 height=2,,3,,0.1,1,2,3,0.01\n"
            'slab,all,box,,"size=1,2,3",5,,0.2,,,,,\n'
            'plate,all,rectangle,,"size=1,2",5,,,,,,,\n'
            "rock,all,,box.obj,length_unit=m,,2.5,,0.05,,,,\n",
            "utf-8",
        )
        rolled = ledger(tmp_path / "parts.csv")
        rock = RigidBody.from_file(tmp_path / "box.obj", density=2.5, length_unit="m")
        bodies = {
            "tank": solids.cylinder(radius=0.5, height=2.0, density=3.0).translated((1.0, 2.0, 3.0)),
            "slab": solids.box((1.0, 2.0, 3.0), mass=5.0),
            "plate": laminae.rectangle((1.0, 2.0), mass=5.0),
            "rock": rock,
        }
        for name, body in bodies.items():
            assert bool(rolled[name].body.isclose(body, rtol=1e-14))
        assert bool(rolled["all"].body.isclose(sum(list(bodies.values())[1:], bodies["tank"]), rtol=1e-14))
        for name, share in (("tank", 0.1 / 3.0), ("slab", 0.2 / 5.0), ("rock", 0.05 / 2.5)):
            body, covariance = bodies[name], rolled[name].covariance
            assert covariance is not None
            draw = share * ten(body.mass, np.zeros(3), body.inertia)
            theirs = np.outer(draw, draw)
            theirs[1, 1] += 0.01**2 * (name == "tank")
            assert np.allclose(covariance, theirs, rtol=1e-13, atol=1e-16)
        assert rolled.unstated == 1

    def test_a_part_used_twice(self) -> None:
        rows = [
            {"id": "all"},
            *(
                {"id": f"w{x}", "parent": "all", "solid": "sphere", "arguments": "radius=0.5", "density": 2.0}
                | {"sigma_density": 0.1, "Cx": float(x), "source": "cast"}
                for x in (-3, 5)
            ),
        ]
        whole = ledger(rows)["all"]
        body = whole.body
        draw = 0.05 * ten(body.mass, np.zeros(3), body.inertia)
        assert whole.covariance is not None
        assert np.allclose(whole.covariance, np.outer(draw, draw), rtol=1e-13, atol=1e-15)
