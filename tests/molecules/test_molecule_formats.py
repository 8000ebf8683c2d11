"""Molecules of other programs: PDB, MOL and SDF, extended XYZ; with what they lack."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from polhode import RigidBody
from polhode.errors import FileFormatError
from polhode.io import load
from polhode.molecules.nuclides import SYMBOLS

# Columns as in the format's guide.
PDB = """HEADER    WATER AND A CHLORIDE
TITLE     TYPED AFTER THE WORLDWIDE PDB'S GUIDE, VERSION 3.3
ATOM      1  O   HOH A   1      -1.000   0.500   0.250  1.00 10.00           O
HETATM    2 CL    CL A   2       2.000   0.000   0.000  1.00 10.00          CL
TER       3       CL A   2
END
"""
# Methane, V2000 as RDKit and Open Babel write it.
METHANE = """methane
     RDKit          3D

  5  4  0  0  0  0  0  0  0  0999 V2000
    0.0000    0.0000    0.0000 C   0  0  0  0  0  0  0  0  0  0  0  0
    0.6276    0.6276    0.6276 H   0  0  0  0  0  0  0  0  0  0  0  0
   -0.6276   -0.6276    0.6276 H   0  0  0  0  0  0  0  0  0  0  0  0
   -0.6276    0.6276   -0.6276 H   0  0  0  0  0  0  0  0  0  0  0  0
    0.6276   -0.6276   -0.6276 H   0  0  0  0  0  0  0  0  0  0  0  0
  1  2  1  0
  1  3  1  0
  1  4  1  0
  1  5  1  0
M  END
"""
V3000 = """water
     test

  0  0  0     0  0            999 V3000
M  V30 BEGIN CTAB
M  V30 COUNTS 3 2 0 0 0
M  V30 BEGIN ATOM
M  V30 1 O 0 0 0.119 0
M  V30 2 H 0 0.763 -0.477 0 MASS=2
M  V30 3 H 0 -0.763 -0.477 0
M  V30 END ATOM
M  V30 BEGIN BOND
M  V30 1 1 1 2
M  V30 2 1 1 3
M  V30 END BOND
M  V30 END CTAB
M  END
"""
O16, CL35, C12, H1, H2 = 15.99491461957, 34.968852682, 12.0, 1.00782503223, 2.01410177812


def written(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


class TestPdb:
    def test_atoms(self, tmp_path: Path) -> None:
        path = written(tmp_path / "a.pdb", PDB)
        body = RigidBody.from_file(path)
        assert body.mass == pytest.approx(O16 + CL35, rel=1e-8)
        center = (O16 * np.array([-1.0, 0.5, 0.25]) + CL35 * np.array([2.0, 0.0, 0.0])) / (O16 + CL35)
        assert body.center_of_mass == pytest.approx(center, rel=1e-7)
        assert load(path).molecule.rounding == 0.0005

    @pytest.mark.parametrize("command", ["report", "molecule"])
    def test_missing_hydrogens_are_told(self, command: str, tmp_path: Path) -> None:
        path = written(tmp_path / "a.pdb", PDB)
        code, out, _ = run(command, str(path), "--format", "json")
        assert code == 0
        assert any("the file holds no hydrogens" in note for note in json.loads(out)["notes"])
        with_one = PDB.replace("           O\n", "           H\n")
        notes = json.loads(run(command, str(written(path, with_one)), "--format", "json")[1])["notes"]
        assert not any("hydrogens" in note for note in notes)

    @pytest.mark.parametrize(
        ("name", "element"),
        [
            (" CA ", "C"),
            ("CA  ", "Ca"),
            (" N  ", "N"),
            ("HG21", "H"),
            (" OXT", "O"),
            ("FE  ", "Fe"),
            ("1HB ", "H"),
        ],
    )
    def test_elements_of_names(self, name: str, element: str, tmp_path: Path) -> None:
        """Files without columns 77 and 78: the column of the name tells calcium from an alpha carbon."""
        line = f"ATOM      1 {name} ALA A   1       1.000   2.000   3.000  1.00 10.00\n"
        assert load(written(tmp_path / "a.pdb", line)).molecule.labels == (element,)

    def test_first_model_and_first_place(self, tmp_path: Path) -> None:
        line = "ATOM      1  O  {}HOH A   1       1.000   2.000   {}.000  1.00 10.00           O\n"
        first, second = line.format("A", 3) + line.format("B", 4), line.format(" ", 5)
        text = f"MODEL        1\n{first}ENDMDL\nMODEL        2\n{second}ENDMDL\n"
        molecule = load(written(tmp_path / "a.ent", text)).molecule
        assert molecule.positions.tolist() == [[1.0, 2.0, 3.0]]
        assert "the first of 2 models was taken" in molecule.notes
        assert any("1 atoms at alternate places" in note for note in molecule.notes)

    def test_refusals(self, tmp_path: Path) -> None:
        path = tmp_path / "a.pdb"
        for text, says in (
            ("HEADER    NOTHING\n", "no ATOM"),
            (PDB.replace("-1.000", "-1.0x0"), "line 3: expected three coordinates"),
            ("3\nwater\nO 0 0 0\n", "rename it"),
        ):
            with pytest.raises(FileFormatError, match=says):
                load(written(path, text))


class TestElementsOfPdbNames:
    """Files without columns 77 and 78: gemmi's rules, but for names that may be either element."""

    @pytest.mark.parametrize(
        ("name", "residue", "element"),
        [
            ("CO  ", "LIG", "Co"),
            ("CO2 ", "LIG", "Co"),
            (" CO ", "LIG", "C"),
            (" CO2", "LIG", "C"),
            ("HO  ", " HO", "Ho"),
            ("HG  ", " HG", "Hg"),
            ("NP1 ", "LIG", "Np"),
            ("HE21", "GLN", "H"),
            ("DG21", "VAL", "D"),
            (" D1 ", "LIG", "D"),
            ("2HG1", "VAL", "H"),
            ("C1  ", "LIG", "C"),
            ("O5* ", "  A", "O"),
            ("ZNA ", "LIG", "Zn"),  # Z alone is no element
            (" W  ", "LIG", "W"),
        ],
    )
    def test_by_column(self, name: str, residue: str, element: str, tmp_path: Path) -> None:
        assert load(written(tmp_path / "a.pdb", named(name, residue))).molecule.labels == (element,)

    @pytest.mark.parametrize(
        ("name", "residue", "says"),
        [
            (" CO ", " CO", "is C by its column and Co by its residue"),
            (" FE ", " FE", "is F by its column and Fe by its residue"),
            ("CA12", "LIG", "may be Ca or C"),
            ("CAA ", "LIG", "may be Ca or C"),
            ("HG  ", "SER", "may be Hg or H"),
            ("HO  ", " DA", "may be Ho or H"),
            ("UNK ", "UNK", "begins with no element of two letters"),
            ("CX1 ", "LIG", "begins with no element of two letters"),
            ("LP1 ", "LIG", "begins with no element of two letters"),
            (" Q1 ", "LIG", "names no element"),
            ("*   ", "LIG", "names no element"),
        ],
    )
    def test_refused(self, name: str, residue: str, says: str, tmp_path: Path) -> None:
        path = written(tmp_path / "a.pdb", named(name, residue))
        with pytest.raises(
            FileFormatError, match=f"line 1: .*{says}; write the element in columns 77 and 78"
        ):
            load(path)
        assert load(written(path, named(name, residue, "CO"))).molecule.labels == ("Co",)

    def test_columns_that_hold_no_element(self, tmp_path: Path) -> None:
        with pytest.raises(FileFormatError, match="line 1: columns 77 and 78 hold 'EP', which is no element"):
            load(written(tmp_path / "a.pdb", named(" N  ", "LIG", "EP")))

    def test_all_elements_are_known(self) -> None:
        elements = importlib.import_module("periodictable").elements
        assert list(SYMBOLS) == [elements[number].symbol for number in range(1, 119)]


def named(name: str, residue: str, element: str = "") -> str:
    line = f"HETATM    1 {name} {residue} A   1       1.000   2.000   3.000  1.00 10.00"
    return f"{line}          {element:>2s}\n"


class TestAlternatePlaces:
    SERINE = (
        ("N", " ", 1.0, 0.0),
        ("CB", "B", 0.6, 1.9),
        ("OG", "B", 0.6, 3.3),
        ("CB", "C", 0.4, 2.2),
        ("OG", "C", 0.4, 3.6),
    )

    def lines(self, rows: Any, residue: str = "SER", number: str = "   1 ") -> str:
        return "".join(
            f"ATOM      1  {name:3s}{letter}{residue} A{number}   {x:8.3f}   0.000   0.000{occupancy:6.2f}"
            f" 10.00           {name[0]}\n"
            for name, letter, occupancy, x in rows
        )

    def places(self, text: str, tmp_path: Path) -> list[float]:
        found: list[float] = load(written(tmp_path / "a.pdb", text)).molecule.positions[:, 0].tolist()
        return found

    def test_of_each_atom_the_likeliest(self, tmp_path: Path) -> None:
        assert self.places(self.lines(self.SERINE), tmp_path) == [0.0, 1.9, 3.3]
        reverse = [self.SERINE[0], *self.SERINE[3:], *self.SERINE[1:3]]
        assert self.places(self.lines(reverse), tmp_path) == [0.0, 1.9, 3.3]
        (note,) = (n for n in load(tmp_path / "a.pdb").molecule.notes if "alternate" in n)
        assert note.startswith(
            "2 atoms at alternate places were left out; of each atom the place with the highest"
        )

    @pytest.mark.parametrize(("second", "taken"), [(0.49, 1.0), (0.5, 1.0), (0.51, 2.0)])
    def test_the_first_of_equals(self, second: float, taken: float, tmp_path: Path) -> None:
        rows = [("C", "X", 0.5, 1.0), ("C", "A", second, 2.0)]
        assert self.places(self.lines(rows), tmp_path) == [taken]
        rows = [("C", " ", 0.5, 1.0), ("C", "B", second, 2.0)]  # as old files have it
        assert self.places(self.lines(rows), tmp_path) == [taken]

    def test_one_residue_of_several(self, tmp_path: Path) -> None:
        text = self.lines([("N", "A", 0.3, 1.0), ("OG", "A", 0.3, 2.0)])
        text += self.lines([("N", "B", 0.7, 3.0), ("SG", "B", 0.7, 4.0)], residue="CYS")
        assert self.places(text, tmp_path) == [3.0, 4.0]

    def test_what_is_no_alternative(self, tmp_path: Path) -> None:
        """Equal names without letters, residues with other insertion codes, models that follow."""
        text = self.lines([("H", " ", 0.5, 1.0), ("H", " ", 1.0, 2.0)])
        text += self.lines([("C", "A", 1.0, 3.0)], number="   2 ")
        text += self.lines([("C", "B", 0.5, 4.0)], number="   2A")
        assert self.places(text + "END\n" + text, tmp_path) == [1.0, 2.0, 3.0, 4.0]
        assert "the first frame was taken" in load(tmp_path / "a.pdb").molecule.notes[0]

    def test_an_occupancy_that_is_none(self, tmp_path: Path) -> None:
        text = self.lines(self.SERINE).replace("  0.60 10.00", "  0.x0 10.00")
        with pytest.raises(FileFormatError, match=r"line 2: expected an occupancy in columns 55 to 60"):
            self.places(text, tmp_path)
        assert self.places(
            self.lines([("C", " ", 1.0, 3.0)]).replace("  1.00 10", "  1.x0 10"), tmp_path
        ) == [3.0]


class TestMassDifferences:
    """Of V2000: from the element's own mass number, but where ``M  ISO`` stands."""

    def text(self, symbol: str, difference: str, properties: str = "") -> str:
        changed = METHANE.replace(
            "0.6276    0.6276    0.6276 H   0", f"0.6276    0.6276    0.6276 {symbol:3s}{difference}"
        )
        return changed.replace("M  END", f"{properties}M  END")

    def labels(self, tmp_path: Path, *words: str) -> tuple[str, ...]:
        return load(written(tmp_path / "a.mol", self.text(*words))).molecule.labels

    @pytest.mark.parametrize(
        ("symbol", "difference", "label"),
        [
            ("H", " 1", "2H"),
            ("H", " 2", "3H"),
            ("C", "-2", "10C"),
            ("Cl", " 2", "37Cl"),
            ("H", "  ", "H"),
            ("H", "+1", "2H"),
        ],
    )
    def test_alone(self, symbol: str, difference: str, label: str, tmp_path: Path) -> None:
        assert self.labels(tmp_path, symbol, difference)[1] == label

    @pytest.mark.parametrize(
        ("difference", "says"),
        [(" 5", "from -3 to 4"), ("-4", "from -3 to 4"), (" x", "from -3 to 4"), ("l ", "from -3")],
    )
    def test_beyond(self, difference: str, says: str, tmp_path: Path) -> None:
        with pytest.raises(FileFormatError, match=f"line 6: expected a mass difference {says}"):
            self.labels(tmp_path, "C", difference)

    def test_isotope_lines_come_first(self, tmp_path: Path) -> None:
        assert self.labels(tmp_path, "H", " 1", "M  ISO  1   2   3\n")[1] == "3H"
        assert self.labels(tmp_path, "H", " 1", "M  ISO  1   2   0\n")[1] == "H"
        with pytest.raises(
            FileFormatError, match="line 6: the mass difference 1 of H is not repeated in 'M  ISO'"
        ):
            self.labels(tmp_path, "H", " 1", "M  ISO  1   3   2\n")

    def test_what_may_be_two_isotopes(self, tmp_path: Path) -> None:
        with pytest.raises(FileFormatError, match="difference 1 of Br may count from 79 or from 80"):
            self.labels(tmp_path, "Br", " 1")
        with pytest.raises(FileFormatError, match="D has a mass difference too"):
            self.labels(tmp_path, "D", " 1")

    @pytest.mark.parametrize(
        ("line", "says"),
        [
            ("M  ISO  1   2", "a count and as many pairs"),
            ("M  ISO  2   2   2", "a count and as many pairs"),
            ("M  ISO  1   2   2   3   2", "a count and as many pairs"),
            ("M  ISO  1   6   2", "names no atom"),
            ("M  ISO  1   0   2", "names no atom"),
            ("M  ISO  1   2  -2", "a count and as many pairs"),
        ],
    )
    def test_lines_that_are_none(self, line: str, says: str, tmp_path: Path) -> None:
        with pytest.raises(FileFormatError, match=f"line 14: .*{says}"):
            self.labels(tmp_path, "H", " 0", f"{line}\n")

    def test_only_where_properties_stand(self, tmp_path: Path) -> None:
        """Not in the name, behind an alias, in lines to skip, or in data of SDF."""
        text = self.text(
            "H", " 0", "A    3\nM  ISO  1   3   2\nS  SKP  1\nM  ISO  1   4   2\nM  ISO  1   5   2\n"
        )
        text = text.replace("methane\n", "M  ISO  1   1  13\n") + ">  <A>\nM  ISO  1   2   2\n\n$$$$\n"
        molecule = load(written(tmp_path / "a.sdf", text)).molecule
        assert molecule.labels == ("C", "H", "H", "H", "2H")
        assert molecule.notes == ("atom 3 is shown as 'M  ISO  1   3   2': it counts as H",)


class TestMol:
    @pytest.mark.parametrize("name", ["methane.mol", "methane.sdf"])
    def test_v2000(self, name: str, tmp_path: Path) -> None:
        path = written(tmp_path / name, METHANE + ("$$$$\n" if name.endswith("sdf") else ""))
        body = RigidBody.from_file(path)
        moment = 4 * H1 * 2 * 0.6276**2  # each hydrogen is √2·0.6276 from each axis
        assert body.mass == pytest.approx(C12 + 4 * H1, rel=1e-9)
        assert body.principal_moments == pytest.approx([moment] * 3, rel=1e-9)
        assert str(body.principal.top) == "spherical"
        assert run("molecule", str(path))[0] == 0

    def test_isotopes(self, tmp_path: Path) -> None:
        path = written(tmp_path / "a.mol", METHANE.replace("M  END", "M  ISO  1   2   2\nM  END"))
        assert RigidBody.from_file(path).mass == pytest.approx(C12 + 3 * H1 + H2, rel=1e-9)
        path = written(tmp_path / "b.mol", V3000)
        assert RigidBody.from_file(path).mass == pytest.approx(O16 + H1 + H2, rel=1e-9)

    def test_a_molecule_or_a_robot(self, tmp_path: Path) -> None:
        """Both are named .sdf: the content decides."""
        path = written(tmp_path / "a.sdf", '<?xml version="1.0"?><sdf version="1.9"><model name="m"/></sdf>')
        code, _, err = run("report", str(path))
        assert code == 2
        assert one_line(err)
        assert "is a robot (SDF); polhode check judges its links" in err
        assert run("report", str(written(path, METHANE)))[0] == 0

    def test_what_is_missing_is_told(self, tmp_path: Path) -> None:
        bare = METHANE.replace(" H  ", " F  ")
        assert any("no hydrogens" in note for note in load(written(tmp_path / "a.mol", bare)).molecule.notes)
        lines = METHANE.splitlines()
        flat = "\n".join(
            line[:20] + "    0.0000" + line[30:] if 4 <= number < 9 else line
            for number, line in enumerate(lines)
        )
        notes = load(written(tmp_path / "b.mol", flat + "\n")).molecule.notes
        assert any("all z are zero" in note for note in notes)

    def test_drawings(self, tmp_path: Path) -> None:
        """The header says 2D: refused where all z are zero, else a geometry after all."""
        drawing = METHANE.replace("          3D", "          2D")
        assert "2D, but z differs from zero" in load(written(tmp_path / "a.mol", drawing)).molecule.notes[0]
        planar = V3000.replace("     test", "  random  01020304052D")
        for row in ("0 0 0.119", "0 0.763 -0.477", "0 -0.763 -0.477"):
            planar = planar.replace(f" {row} 0", f" {row.removeprefix('0 ')} 0 0")
        for text in (drawing.replace("-0.6276", " 0.0000").replace("0.6276", "0.0000"), planar):
            path = written(tmp_path / "b.mol", text)
            with pytest.raises(FileFormatError, match=r"line 2 says 2D: a drawing, .*; make a geometry"):
                load(path)

    @pytest.mark.parametrize(
        "symbol", ["A", "Q", "*", "L", "R", "R#", "X", "M", "LP", "AH", "Pol", "R12", ""]
    )
    def test_atoms_that_stand_for_others(self, symbol: str, tmp_path: Path) -> None:
        text = METHANE.replace("0.0000 C  ", f"0.0000 {symbol:3s}")
        with pytest.raises(
            FileFormatError, match=r"line 5: .*is no element: it may stand for a list, a group"
        ):
            load(written(tmp_path / "a.mol", text))
        if symbol:
            with pytest.raises(FileFormatError, match=r"line 8: .*is no element"):
                load(written(tmp_path / "b.mol", V3000.replace("1 O 0", f"1 {symbol} 0")))

    @pytest.mark.parametrize(
        ("label", "words", "found"),
        [
            ("H", "MASS=2", "2H"),
            ("D", "", "D"),
            ("D", "MASS=2", "D"),
            ('"H"', "CHG=1 mass=3.0", "3H"),
            ("H", "MASS=0", "H"),
            ("CL", 'FIELDNAME="MASS=2 x" MASS=35', "35Cl"),
            ("D", "MASS=3", None),
            ("H", "MASS=2.5", None),
            ("H", "MASS=", None),
            ("H", "RGROUPS=(1 2)", None),
            ("C", "CLASS=AA", None),
        ],
    )
    def test_words_of_v3000(self, label: str, words: str, found: str | None, tmp_path: Path) -> None:
        text = V3000.replace(
            "3 H 0 -0.763 -0.477 0", f"3 {label} 0 -0.763 -\nM  V30 -0.477 0 {words}".rstrip()
        )
        path = written(tmp_path / "a.mol", text)
        if found is None:
            with pytest.raises(FileFormatError, match=r"a\.mol: line 10: .*; "):
                load(path)
        else:
            assert load(path).molecule.labels[2] == found

    def test_refusals(self, tmp_path: Path) -> None:
        for text, says in (
            (METHANE + "$$$$\n" + METHANE, "more than one molecule"),
            (METHANE.replace("M  END\n", ""), "'M  END' is missing"),
            (METHANE.replace("  5  4", " 50  4"), "promises 50 atoms"),
            (
                METHANE.replace("0.6276    0.6276    0.6276", "0.6276    0.6x76    0.6276"),
                "line 6: expected three",
            ),
            (V3000.replace("COUNTS 3", "COUNTS 4"), "promises 4 atoms and holds 3"),
            (V3000.replace("M  END\n", ""), "'M  END' is missing"),
            (
                METHANE.replace("    0.0000    0.0000    0.0000 C", "\t0.0\t0.0\t0.0\tC"),
                "line 5: the line holds a tab",
            ),
            (
                METHANE.replace("  0999 V2000", "  0999 V2000").replace("  5  4  0", "  5  4  1"),
                "line 4: an atom stands",
            ),
            (
                METHANE.replace("M  END", "M  ALS   1  2 F C   N\nM  END"),
                "line 14: an atom stands for a list",
            ),
            (METHANE.replace("M  END", "M  RGP  1   1   1\nM  END"), "line 14: an atom stands for a list"),
        ):
            with pytest.raises(FileFormatError, match=says):
                load(written(tmp_path / "a.mol", text))


class TestTexts:
    """What is text around the numbers of any format."""

    @pytest.mark.parametrize(
        ("name", "text"),
        [("a.pdb", PDB), ("a.mol", METHANE), ("b.mol", V3000), ("a.xyz", "2\nname\nC 0 0 0\nO 0 0 1.1\n")],
    )
    def test_marks_and_ends_of_lines(self, name: str, text: str, tmp_path: Path) -> None:
        """Windows, old Macintosh, a byte order mark; a form feed or U+2028 ends no line."""
        plain = load(written(tmp_path / name, text)).molecule
        title = "WATER" if name == "a.pdb" else plain.comment
        for changed in (
            text.replace("\n", "\r\n"),
            text.replace("\n", "\r"),
            "\ufeff" + text,
            text.rstrip("\n"),
            text.replace(title, f"{title}\x0c\u2028\x85"),
        ):
            (tmp_path / name).write_bytes(changed.encode())
            molecule = load(tmp_path / name).molecule
            assert molecule.labels == plain.labels
            assert molecule.positions.tolist() == plain.positions.tolist()

    @pytest.mark.parametrize("number", ["1_0", "١", "0x10", "1,5", "--1", "1e", ".", "1d0", "½"])
    def test_numbers_that_are_none(self, number: str, tmp_path: Path) -> None:
        """Python reads some of these."""
        with pytest.raises(FileFormatError, match="line 3: expected 'symbol x y z'"):
            load(written(tmp_path / "a.xyz", f"1\n\nO 0 {number} 0\n"))
        with pytest.raises(FileFormatError, match="line 5: expected three coordinates"):
            load(
                written(
                    tmp_path / "a.mol",
                    METHANE.replace(
                        "    0.0000    0.0000    0.0000 C", f"    0.0000{number:>10s}    0.0000 C"
                    ),
                )
            )
        with pytest.raises(FileFormatError, match="number of atoms"):
            load(written(tmp_path / "b.xyz", f"{number}\n\nO 0 0 0\n"))

    def test_tabs_in_columns(self, tmp_path: Path) -> None:
        with pytest.raises(
            FileFormatError, match="line 3: the line holds a tab, but PDB counts columns; write"
        ):
            load(written(tmp_path / "a.pdb", PDB.replace("      1  O", "\t1  O")))
        long = PDB.replace("ATOM      1", "ATOM 100000").replace("HETATM", "hetatm")
        assert load(written(tmp_path / "a.pdb", long)).molecule.labels == ("O", "Cl")
        assert load(written(tmp_path / "a.xyz", "1\n\nO\t0\t1\t2\n")).molecule.positions.tolist() == [
            [0, 1, 2]
        ]

    @pytest.mark.parametrize("words", ["0.000", "  x   ", "-10.00"])
    def test_crystals_that_are_none(self, words: str, tmp_path: Path) -> None:
        line = f"CRYST1{words:>9s}   10.000   10.000  90.00  90.00  90.00 P 1           1\n"
        path = written(tmp_path / "a.pdb", line + PDB)
        if "x" in words:
            with pytest.raises(FileFormatError, match="line 1: expected three lengths and three angles"):
                load(path)
        else:
            assert load(path).molecule.cell is None


class TestExtendedXyz:
    def test_the_order_of_columns(self, tmp_path: Path) -> None:
        """As ASE writes it, with columns before the positions."""
        text = (
            '2\nLattice="5 0 0 0 5 0 0 0 5" Properties=tags:I:1:pos:R:3:species:S:1:forces:R:3 pbc="T T T"\n'
            "7 0.0 0.0 0.0 O 9 9 9\n8 0.0 0.0 1.1 C 9 9 9\n"
        )
        loaded = load(written(tmp_path / "a.extxyz", text))
        assert loaded.molecule.labels == ("O", "C")
        assert loaded.molecule.positions.tolist() == [[0, 0, 0], [0, 0, 1.1]]
        code, out, _ = run("molecule", str(tmp_path / "a.extxyz"), "--format", "json")
        assert code == 0
        assert any("the lattice of the file is not used" in note for note in json.loads(out)["notes"])

    def test_the_usual_order_has_no_note(self, tmp_path: Path) -> None:
        text = "1\nProperties=species:S:1:pos:R:3:charge:R:1 energy=-1.0\nNe 0 0 1.5 20.1\n"
        molecule = load(written(tmp_path / "a.xyz", text)).molecule
        assert (molecule.labels, molecule.notes) == (("Ne",), ())
        assert molecule.positions.tolist() == [[0, 0, 1.5]]

    def test_a_column_of_masses_is_told(self, tmp_path: Path) -> None:
        text = "1\nProperties=species:S:1:pos:R:3:masses:R:1\nO 0 0 1.5 18.0\n"
        (note,) = load(written(tmp_path / "a.xyz", text)).molecule.notes
        assert note.startswith("the column 'masses' of the file is not used")

    @pytest.mark.parametrize(
        ("words", "cell"),
        [
            ('Lattice="2 0 0 0 3 0 0 0 4"', [[2, 0, 0], [0, 3, 0], [0, 0, 4]]),
            ('Lattice="2 0 0 0 3 0 0 0 4" pbc="T F T"', [[2, 0, 0], [0, 0, 4]]),
            ('Lattice="[[2, 0, 0], [0, 3, 0], [0, 0, 4]]" pbc=[true, false, 0]', [[2, 0, 0]]),
            ("lattice='2 0 0 0 3 0 0 0 4' pbc=\"F F F\"", None),
            ('pbc="T T T"', None),
            ('note="Lattice=x Properties=pos:R:3" a=b', None),
        ],
    )
    def test_lattices(self, words: str, cell: list[list[float]] | None, tmp_path: Path) -> None:
        text = f"1\n{words} Properties=species:S:1:pos:R:3\nO 0 0 1\n"
        found = load(written(tmp_path / "a.xyz", text)).molecule.cell
        assert (found is None) == (cell is None)
        if found is not None:
            assert found.tolist() == cell

    @pytest.mark.parametrize(
        "words", ['Lattice="2 3 4"', "Lattice=fcc", 'Lattice="2 0 0 0 3 0 0 0 4" pbc="T T"']
    )
    def test_lattices_that_are_none(self, words: str, tmp_path: Path) -> None:
        with pytest.raises(
            FileFormatError, match="line 2: expected Lattice of nine numbers and pbc of three"
        ):
            load(written(tmp_path / "a.xyz", f"1\n{words} Properties=species:S:1:pos:R:3\nO 0 0 1\n"))
        assert load(written(tmp_path / "b.xyz", f"1\n{words}\nO 0 0 1\n")).molecule.cell is None  # plain XYZ

    def test_rows_that_are_short(self, tmp_path: Path) -> None:
        text = "1\nProperties=species:S:1:pos:R:3:forces:R:3\nO 0 0 1 9 9\n"
        with pytest.raises(
            FileFormatError, match="line 3: expected 7 words, as Properties of line 2 declares, got 6"
        ):
            load(written(tmp_path / "a.xyz", text))

    @pytest.mark.parametrize(
        "columns",
        ["species:S:2:pos:R:3", "pos:R:3", "species:S:1:pos:R:2", "species:I:1:pos:R:3", "species:S:x"],
    )
    def test_refusals(self, columns: str, tmp_path: Path) -> None:
        path = written(tmp_path / "a.xyz", f"1\nProperties={columns}\nNe 0 0 1.5\n")
        with pytest.raises(FileFormatError, match="declares no columns species:S:1 and pos:R:3"):
            load(path)
