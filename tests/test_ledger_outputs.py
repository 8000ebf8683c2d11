"""What a ledger tells: shares of the variance, files, pictures, the command line."""

from __future__ import annotations

import io
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from matplotlib.figure import Figure
from polhode._format import with_sigma
from polhode.uncertainty import ledger
from random_ledgers import (
    NUMBERS,
    SIGMAS,
    covariances,
    random_tree,
    values,
)


class TestShares:
    @pytest.mark.parametrize("number", NUMBERS)
    def test_a_share_is_what_the_variance_loses_without_it(self, number: str) -> None:
        table, below = random_tree(25, 9)
        table["source"] = ["rig" if k % 4 == 0 else "" for k in range(25)]
        table["about"] = ["origin" if k == below["n1"][0] else "" for k in range(25)]
        for k in (below["n1"][0],):  # a tensor about the origin has to be that of a body
            for name in NUMBERS[4:7]:
                table[name][k] += 1e3
        rolled = ledger(table)
        for at in ("n0", "n1"):
            shares = rolled.variance_shares(number, at)
            total = rolled[at].with_sigma(number)[1]
            assert total is not None
            assert shares.sigma == pytest.approx(total, rel=1e-12)
            assert shares.fraction.sum() == pytest.approx(1.0, rel=1e-12)
            assert np.allclose(shares.by_number.sum(axis=1), shares.fraction, rtol=1e-12)
            assert np.all(np.diff(shares.fraction) <= 0.0)
            assert len(shares) == len({table["source"][k] or k for k in below[at]})
            for k in range(3):
                name = shares.names[k]
                calm = {column: cells.copy() for column, cells in table.items()}
                rows = (
                    [row for row in below["n0"] if table["source"][row] == name]
                    if shares.is_source[k]
                    else [int(name[1:])]
                )
                for column in SIGMAS:
                    calm[column][rows] = 0.0
                left = ledger(calm)[at].with_sigma(number)[1]
                assert left is not None
                assert 1.0 - (left / total) ** 2 == pytest.approx(shares.fraction[k], abs=1e-9)

    def test_which_scale_has_to_become_better(self) -> None:
        shares = ledger(
            [
                {"id": "craft"},
                {
                    "id": "bus",
                    "parent": "craft",
                    "mass": 50,
                    "Cx": 0,
                    "Cy": 0,
                    "Cz": 0,
                    "Ipoint": "TRUE",
                    "sigma_mass": 0.3,
                },
                {
                    "id": "fin",
                    "parent": "craft",
                    "mass": 1,
                    "Cx": 0,
                    "Cy": 0,
                    "Cz": 0,
                    "Ipoint": "TRUE",
                    "sigma_mass": 0.4,
                },
            ]
        ).variance_shares("mass")
        assert shares.names == ("fin", "bus")
        assert shares.fraction == pytest.approx([0.64, 0.36])
        assert shares.largest(0) == "mass"
        assert (
            repr(shares) == "<Shares of the variance of mass of 'craft': fin 64.0% (mass), bus 36.0% (mass)>"
        )

    def test_what_has_no_variance_is_told(self) -> None:
        point = {"parent": "", "mass": 1, "Cx": 0, "Cy": 0, "Cz": 0, "Ipoint": True}
        with pytest.raises(ValueError, match="no part states a standard deviation"):
            ledger([{"id": "a"} | point]).variance_shares()
        uncertain = ledger([{"id": "a", "sigma_Cx": 0.1} | point])
        with pytest.raises(ValueError, match="mass of 'a' has no variance"):
            uncertain.variance_shares()
        with pytest.raises(ValueError, match="of: 'weight' is none of mass, Cx"):
            uncertain.variance_shares("weight")
        with pytest.raises(KeyError, match="no part has the id 'b'"):
            uncertain.variance_shares("Cx", "b")


class TestOutputs:
    def test_a_table_that_is_read_back(self, tmp_path: Path) -> None:
        table, _ = random_tree(30, 4)
        table["name"] = [f"part, {k}" for k in range(30)]
        table["growth"] = np.where(np.isnan(table["mass"]), np.nan, 0.125)
        made = ledger(table)
        made.to_csv(tmp_path / "out.csv")
        again = ledger(tmp_path / "out.csv", overwrite=True)
        assert again.ids == made.ids
        assert again.parents == made.parents
        assert np.array_equal(values(again), values(made))
        assert np.array_equal(covariances(again), covariances(made))
        assert np.allclose(again.predicted_mass, made.predicted_mass, rtol=1e-15)
        again.to_csv(tmp_path / "again.csv")
        assert (tmp_path / "again.csv").read_text("utf-8") == (tmp_path / "out.csv").read_text("utf-8")

    def test_json(self, tmp_path: Path) -> None:
        table, _ = random_tree(12, 4)
        made = ledger(table)
        made.to_json(tmp_path / "out.json")
        told = json.loads((tmp_path / "out.json").read_text("utf-8"))
        assert told["format"] == "polhode.Ledger/1"
        assert told["id"] == list(made.ids)
        assert told["covariance_of"] == list(NUMBERS)
        assert np.array_equal(told["covariance"], covariances(made))
        assert np.array_equal(told["sigma"]["inertia"], made.sigma.inertia if made.sigma else 0.0)
        made.to_json(tmp_path / "short.json", covariance=False)
        assert "covariance" not in json.loads((tmp_path / "short.json").read_text("utf-8"))
        table = {name: column for name, column in table.items() if not name.startswith("sigma")}
        ledger(table).to_json(tmp_path / "exact.json")
        assert json.loads((tmp_path / "exact.json").read_text("utf-8"))["covariance"] is None

    def test_what_is_printed(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        leaves = int(made.is_part.sum())
        assert repr(made).startswith(f"<Ledger of 'n0': {leaves} parts, {made.depth.max() + 1} levels, mass ")
        assert str(made).count("\n") == 21
        assert str(made).endswith("  and 20 more")
        assert repr(made["n0"]).startswith("<Assembly 'n0': mass ")
        assert repr(made["n39"]).startswith("<Part 'n39': mass ")
        assert " ± " in repr(made["n39"])
        assert "without sigmas" in repr(
            ledger(
                table | {name: table[name] * np.where(np.arange(40) == 39, np.nan, 1.0) for name in SIGMAS}
            )
        )

    def test_nodes(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        for node in made:
            assert all(child.parent is not None and child.parent.id == node.id for child in node.children)
            assert node.mass == pytest.approx(
                sum(child.mass for child in node.children) or node.mass, rel=1e-14
            )
            assert made[node.id].row == node.row
            assert node.id in made
        assert made["n0"].parent is None
        assert next(made.walk()).id == "n0"
        assert sorted(node.id for node in made.walk()) == sorted(made.ids)
        assert {node.depth for node in made.walk(1)} == {0, 1}
        assert "nobody" not in made
        again = pickle.loads(pickle.dumps(made))
        assert np.array_equal(covariances(again), covariances(made))

    @pytest.mark.parametrize(
        ("value", "sigma", "text"),
        [
            (57.834, 1.2416, "57.8 ± 1.2"),
            (57.834, 0.12, "57.83 ± 0.12"),
            (57.834, 0.0996, "57.83 ± 0.10"),
            (57.834, 0.0994, "57.834 ± 0.099"),
            (42673.7, 2789.3, "42700 ± 2800"),
            (0.0004, 12.5, "0 ± 12"),
            (-0.182859, 0.19998, "-0.18 ± 0.20"),
            (-3.2e-9, 4.56e-11, "(-3.200 ± 0.046)e-09"),
            (3.2e12, 4.56e10, "(3.200 ± 0.046)e+12"),
            (0.1, 2.7e-19, "0.1"),
            (57.834, 0.0, "57.834"),
            (-0.0, None, "0"),
            (1.0, float("nan"), "1"),
            (1e301, 1e299, "1e+301 ± 1.0e+299"),
        ],
    )
    def test_two_digits_of_sigma(self, value: float, sigma: float | None, text: str) -> None:
        assert with_sigma(value, sigma) == text


class TestPictures:
    def test_a_sunburst_of_masses(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        ax = made.plot(Figure().subplots(), of="mass")
        rings: dict[float, float] = {}
        wedges: list[Any] = list(ax.patches)
        for wedge in wedges:
            rings[wedge.r] = rings.get(wedge.r, 0.0) + wedge.theta2 - wedge.theta1
        assert rings[2.0] == pytest.approx(360.0)
        assert len(rings) == 3
        assert all(turn <= 360.0 + 1e-9 for turn in rings.values())
        first = {child.id: child.mass / made["n0"].mass for child in made["n0"].children}
        widths = sorted((wedge.theta2 - wedge.theta1) / 360.0 for wedge in wedges if wedge.r == 2.0)
        assert widths == pytest.approx(sorted(first.values()))

    def test_bars_of_variance(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        shares = made.variance_shares("Iyy")
        ax = made.plot(Figure().subplots(), of="variance", number="Iyy")
        names = [label.get_text() for label in ax.get_yticklabels()]
        assert names == [*shares.names[:12], f"{len(shares) - 12} others"]
        widths = np.zeros(len(names))
        drawn: list[Any] = list(ax.patches)
        for bar in drawn:
            widths[round(bar.get_y() + bar.get_height() / 2)] += bar.get_width()
        assert widths.sum() == pytest.approx(100.0)
        assert widths[:12] == pytest.approx(100.0 * shares.fraction[:12])
        with pytest.raises(ValueError, match='of: expected "mass" or "variance"'):
            made.plot(of="weight")

    def test_many_small_parts_are_drawn_together(self) -> None:
        point = {"parent": "all", "mass": 1.0, "Cx": 0.0, "Cy": 0.0, "Cz": 0.0, "Ipoint": True}
        rows = [
            {"id": "all"},
            {"id": "big"} | point | {"mass": 1000.0},
            *({"id": f"p{k}"} | point for k in range(500)),
        ]
        ax = ledger(rows).plot(Figure().subplots())
        assert len(ax.patches) == 2
        assert [text.get_text() for text in ax.texts][:2] == ["big\n66.7 %", "others\n33.3 %"]


CRAFT = """id,parent,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,Ixy,Ixz,Iyz,POIconv,sigma_mass,sigma_Cx,growth
craft,,,,,,,,,,,,,,,
bus,craft,22,0,0,0.1,3.1,3,2.2,0,0.02,0,-,0.1,0.002,5%
"wheel, x",craft,1.6,0.3,0,0,0.006,0.0032,0.0032,0,0,0,-,0.01,0.001,
"""


class TestCommand:
    @pytest.fixture
    def craft(self, tmp_path: Path) -> Path:
        (tmp_path / "craft.csv").write_text(CRAFT, "utf-8")
        return tmp_path / "craft.csv"

    def test_table(self, craft: Path) -> None:
        code, out, err = run("ledger", craft, "--of", "Cx")
        assert (code, err) == (0, "")
        for words in (
            "craft       23.60 ± 0.10",
            "4.66 %",
            "24.7",
            "    wheel, x",
            "variance of Cx of craft",
            "mostly by its",
        ):
            assert words in out
        assert "bus" not in run("ledger", craft, "--depth", "0")[1].partition("who contributes")[0]
        assert "  wheel, x" in run("ledger", craft, "--at", "wheel, x")[1]

    def test_json(self, craft: Path) -> None:
        code, out, _ = run("ledger", craft, "--format", "json")
        told = json.loads(out)
        made = ledger(craft)
        assert code == 0
        assert [node["id"] for node in told["nodes"]] == ["craft", "bus", "wheel, x"]
        assert told["nodes"][0]["mass"] == {
            "value": made.mass[0],
            "sigma": made.sigma.mass[0] if made.sigma else None,
        }
        assert np.array_equal(told["nodes"][0]["covariance"], covariances(made)[0])
        assert told["variance_shares"][0]["name"] == "bus"

    def test_files(self, craft: Path) -> None:
        folder = craft.parent
        assert run("ledger", craft, "--save", folder / "all.csv")[0] == 0
        assert np.array_equal(ledger(folder / "all.csv", overwrite=True).mass, ledger(craft).mass)
        assert run("ledger", craft, "--output", folder / "all.json", "--save", folder / "all.png")[0] == 0
        assert json.loads((folder / "all.json").read_text("utf-8"))["parts"] == 2
        assert (folder / "all.png").read_bytes().startswith(b"\x89PNG")
        code, _, err = run("ledger", craft, "--save", craft)
        assert code == 2
        assert "write to another one" in err
        assert craft.read_text("utf-8") == CRAFT

    def test_standard_input(self, craft: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(CRAFT.encode())))
        assert run("ledger", "-")[1].replace("standard input", str(craft)) == run("ledger", craft)[1]

    def test_exact_tables_say_so(self, craft: Path) -> None:
        craft.write_text(CRAFT.replace(",0.1,0.002,", ",,,").replace(",0.01,0.001,", ",,,"), "utf-8")
        code, out, _ = run("ledger", craft, "--save", craft.parent / "all.svg")
        assert code == 0
        assert "no part states a standard deviation" in out
        craft.write_text(CRAFT.replace(",0.1,0.002,", ",,,"), "utf-8")
        assert "1 of the parts state no standard deviation" in run("ledger", craft)[1]
        assert "Ixy of craft is exact" in run("ledger", craft, "--of", "Ixy")[1]

    @pytest.mark.parametrize(
        ("words", "told"),
        [
            (("--of", "weight"), "--of: 'weight' is none of the numbers; give one of mass"),
            (("--at", "x"), "--at: no part has the id 'x'"),
            (("--depth", "-1"), "--depth: expected a number of levels, 0 or more"),
            (("--tree", "none.csv"), "none.csv"),
            (("--save", "no/where.csv"), "create it first"),
            (("--save", "rows.xlsx"), "use one of .png, .pdf, .svg, .csv"),
            (("--output", "rows.csv"), "--save rows.csv writes the rows"),
        ],
    )
    def test_bad_words(self, craft: Path, words: tuple[str, ...], told: str) -> None:
        code, out, err = run("ledger", craft, *words)
        assert (code, out) == (2, "")
        assert one_line(err)
        assert told in err

    def test_ways_out_are_options(self, craft: Path) -> None:
        craft.write_text(CRAFT.replace("craft,,,", "craft,,5,"), "utf-8")
        err = run("ledger", craft)[2]
        assert "line 2 ('craft'): has children, and mass = 5 of its own" in err
        assert "pass --overwrite" in err
        assert run("ledger", craft, "--overwrite")[0] == 0
        craft.write_text(CRAFT.replace("growth", "cost"), "utf-8")
        assert "pass --ignore with its name" in run("ledger", craft)[2]
        assert run("ledger", craft, "--ignore", "cost")[0] == 0
