"""Readers of molecules beside RDKit and gemmi, on random files with every option of the formats.

Each file is read as what it holds, and as the peers read it, or is refused with the way out.
"""

from __future__ import annotations

import importlib
import re
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import gemmi
import numpy as np
import pytest
from polhode import RigidBody
from polhode.errors import PolhodeError
from polhode.io import load
from polhode.molecules import isotopes
from random_molecules import Atom, Case, cases, extended_xyz, mol, pdb, v3000, xyz
from rdkit import Chem, RDLogger

RDLogger.DisableLog("rdApp.*")

KINDS = {
    "pdb": (pdb, 120),
    "mol": (mol, 120),
    "v3000": (v3000, 50),
    "xyz": (xyz, 50),
    "extxyz": (extended_xyz, 60),
}


def read(path: Path) -> tuple[list[Atom], Any]:
    """The atoms as the package reads them, and the molecule."""
    molecule = load(path).molecule
    found = []
    for label, place in zip(molecule.labels, molecule.positions.tolist(), strict=True):
        (isotope,) = isotopes([label], "average")
        digits, symbol = re.fullmatch(r"(\d*)([A-Z][a-z]?)", isotope.name).groups()  # type: ignore[union-attr]
        number = Chem.GetPeriodicTable().GetAtomicNumber(symbol)
        found.append(Atom(number, int(digits or 0), tuple(place)))
    return found, molecule


def by_rdkit(case: Case) -> tuple[list[Atom], Any] | None:
    """As RDKit reads it, and its molecule; None where it does not, or an atom stands for others."""
    text = case.text
    molecule: Any
    try:
        if case.suffix == ".pdb":
            molecule = Chem.MolFromPDBBlock(text, sanitize=False, removeHs=False, proximityBonding=False)
        elif case.suffix == ".sdf":
            supplier = Chem.SDMolSupplier()
            supplier.SetData(text, sanitize=False, removeHs=False, strictParsing=True)
            molecule = supplier[0] if len(supplier) == 1 else None
        elif case.suffix == ".mol":
            molecule = Chem.MolFromMolBlock(text, sanitize=False, removeHs=False, strictParsing=True)
        else:
            molecule = Chem.MolFromXYZBlock(text)
    except (RuntimeError, ValueError):
        molecule = None
    if molecule is None or not molecule.GetNumConformers():
        return None
    if any(atom.GetAtomicNum() == 0 or atom.HasQuery() for atom in molecule.GetAtoms()):
        return None
    at = molecule.GetConformer().GetPositions().tolist()
    atoms = [
        Atom(atom.GetAtomicNum(), atom.GetIsotope(), tuple(place))
        for atom, place in zip(molecule.GetAtoms(), at, strict=True)
    ]
    return atoms, molecule


def by_gemmi(case: Case) -> tuple[list[Atom], Any]:
    """As gemmi reads it, of each residue and atom the place with the highest occupancy; and the structure."""
    structure = gemmi.read_pdb_string(case.text)
    rows = [
        ((chain.name, str(residue.seqid), residue.segment), residue.name, atom)
        for chain in structure[0]
        for residue in chain
        for atom in residue
    ]
    best: dict[Any, Any] = {}
    for site, name, atom in rows:
        if atom.has_altloc() and (site not in best or best[site][0] < atom.occ):
            best[site] = (atom.occ, name)
    groups: dict[Any, list[Any]] = {}
    for site, name, atom in rows:
        if not atom.has_altloc() or best[site][1] == name:
            groups.setdefault((site, name, atom.name), []).append(atom)
    found = []
    for group in groups.values():
        if any(atom.has_altloc() for atom in group):
            group = [max(group, key=lambda atom: atom.occ)]
        for atom in group:
            mass = 2 if atom.element.name == "D" else 0
            found.append(Atom(atom.element.atomic_number, mass, (atom.pos.x, atom.pos.y, atom.pos.z)))
    return found, structure


def by_ase(path: Path) -> tuple[list[Atom], Any] | None:
    """As ASE reads extended XYZ, where it is installed and labels are symbols, and the cell's vectors."""
    try:
        read: Any = importlib.import_module("ase.io").read
    except ImportError:
        return None
    try:
        atoms = read(path, format="extxyz")
    except KeyError:  # a label that is no symbol
        return None
    found = [
        Atom(int(number), 0, tuple(place))
        for number, place in zip(atoms.numbers, atoms.positions.tolist(), strict=True)
    ]
    return found, np.asarray(atoms.cell)[atoms.pbc]


def same(one: list[Atom], other: list[Atom]) -> bool:
    """The same atoms at the same places, in any order."""

    def key(atom: Atom) -> tuple[Any, ...]:
        return (*(round(x, 6) + 0.0 for x in atom.place), atom.number, atom.mass_number)

    return sorted(map(key, one)) == sorted(map(key, other))


def mass_by_rdkit(atoms: list[Atom]) -> float:
    table = Chem.GetPeriodicTable()
    total: float = sum(
        table.GetMassForIsotope(atom.number, atom.mass_number)
        if atom.mass_number
        else table.GetMostCommonIsotopeMass(atom.number)
        for atom in atoms
    )
    return total


@pytest.mark.parametrize("kind", KINDS)
def test_random_files(kind: str, tmp_path: Path) -> None:
    maker, count = KINDS[kind]
    counts: Counter[str] = Counter()
    for number, case in enumerate(cases(maker, 14, count)):
        check(case, tmp_path / f"{kind}{number}{case.suffix}", counts)
    assert counts["read"] > 0.6 * count
    assert counts["may"] <= 0.1 * count
    assert counts["peers"] >= {"extxyz": 0, "xyz": 0.3}.get(kind, 0.4) * count


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS)
def test_many_random_files(kind: str, tmp_path: Path) -> None:
    for case in cases(KINDS[kind][0], 15, 5000):
        check(case, tmp_path / f"{kind}{case.suffix}", Counter())


def check(case: Case, path: Path, counts: Counter[str]) -> None:
    """Hold a file against what it holds and against the peers."""
    path.write_bytes(case.text.encode())
    words = f"{case.options}\n{case.text}"
    refusal = ""
    try:
        atoms, molecule = read(path)
    except PolhodeError as error:
        refusal = str(error)
    if refusal:
        assert case.refused != "never", f"{refusal}\n{words}"
        assert refusal.startswith(str(path))
        assert "; " in refusal, refusal
        counts["may" if case.refused == "may" else "refused"] += 1
        return
    assert case.refused != "always", words
    assert same(atoms, case.atoms), words
    counts["read"] += 1
    rdkit = None
    if case.by_peers:
        rdkit = None if has_alternatives(case) else by_rdkit(case)  # it takes the places named A alone
        if rdkit is not None:
            assert same(atoms, rdkit[0]), words
        if case.suffix == ".pdb":
            found, structure = by_gemmi(case)
            assert same(atoms, found), words
            check_crystal(molecule.cell, structure.cell)
        counts["peers"] += case.suffix == ".pdb" or rdkit is not None
    if case.suffix in (".xyz", ".extxyz"):
        assert (molecule.cell is None) == (case.cell is None), words
        if case.cell is not None:
            assert molecule.cell.ravel().tolist() == case.cell
        is_of_ase = "properties=" not in case.text and "element:S" not in case.text and not by_labels(case)
        ase = by_ase(path) if is_of_ase else None
        if ase is not None:
            counts["ASE"] += 1
            assert same(atoms, ase[0]), words
            assert ase[1].ravel().tolist() == (case.cell or []), words
    if all(atom.number not in (43, 61) and atom.number < 84 for atom in atoms):  # else no most common isotope
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of what crosses a cell, and of open valences
            body = RigidBody.from_file(path)
            other = body if rdkit is None else RigidBody.from_atoms(rdkit[1])
        assert body.mass == pytest.approx(mass_by_rdkit(atoms), rel=2e-6), words
        assert other.mass == pytest.approx(float(body.mass), rel=1e-12)
        np.testing.assert_allclose(other.inertia, body.inertia, rtol=1e-9, atol=1e-9 * body.mass)


def by_labels(case: Case) -> bool:
    """Whether labels are more than symbols, or the file begins with a mark: ASE reads neither."""
    return not {"isotope", "D and T", "atomic number", "byte order mark"}.isdisjoint(case.options)


def has_alternatives(case: Case) -> bool:
    return any(option.startswith("alternate") for option in case.options)


def check_crystal(cell: Any, known: Any) -> None:
    if cell is None:
        assert not known.is_crystal()
    else:
        np.testing.assert_allclose(cell, np.array(known.orth.mat.tolist()).T, atol=1e-9)
