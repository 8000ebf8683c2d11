"""Molecules of other programs: PDB, MOL and SDF, extended XYZ; with what they lack."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import one_line, run
from polhode import RigidBody
from polhode.errors import FileFormatError
from polhode.files import load

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
        ):
            with pytest.raises(FileFormatError, match=says):
                load(written(tmp_path / "a.mol", text))


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

    @pytest.mark.parametrize(
        "columns", ["pos:R:3", "species:S:1:pos:R:2", "species:I:1:pos:R:3", "species:S:x"]
    )
    def test_refusals(self, columns: str, tmp_path: Path) -> None:
        path = written(tmp_path / "a.xyz", f"1\nProperties={columns}\nNe 0 0 1.5\n")
        with pytest.raises(FileFormatError, match="declares no columns species:S:1 and pos:R:3"):
            load(path)
