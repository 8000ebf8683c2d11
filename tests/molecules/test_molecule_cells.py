"""Cells of molecules: what crosses their sides, against every image of every atom, and where it is said."""

from __future__ import annotations

import json
import warnings
from itertools import combinations, product
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody
from polhode.errors import PolhodeError
from polhode.io import load
from polhode.molecules import CellBond, bonds, cell_crossings
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

RADII = {"H": 0.31, "C": 0.76, "O": 0.66, "Cs": 2.44}
MARGIN = 0.45
BOX = 10.0 * np.eye(3)


def random_case(rng: np.random.Generator) -> tuple[list[str], Floats, Floats]:
    """Chains of atoms, some moved by whole vectors of a cell: skewed, thin or of fewer vectors."""
    while True:
        vectors = np.diag(rng.uniform(2.0, 9.0, 3)) + rng.normal(size=(3, 3)) * rng.choice([0.0, 0.7])
        vectors = vectors[rng.permutation(3)[: int(rng.integers(1, 4))]]
        if (1.0 / np.linalg.norm(np.linalg.pinv(vectors), axis=0)).min() > 1.5:
            break
    labels = rng.choice(list(RADII), int(rng.integers(1, 9)), p=[0.4, 0.3, 0.2, 0.1]).tolist()
    steps = rng.normal(size=(len(labels), 3))
    steps *= rng.choice([0.8, 1.2, 6.0], len(labels))[:, None] / np.linalg.norm(steps, axis=-1)[:, None]
    places = rng.uniform(-5.0, 5.0, 3) + np.cumsum(steps, axis=0)
    places += rng.integers(-2, 3, (len(labels), len(vectors))) @ vectors * rng.choice([0, 1])
    return labels, places, vectors


def all_bonds(labels: list[str], places: Floats, vectors: Floats, most: int) -> set[CellBond]:
    """By every image within so many cells."""
    found = set()
    shifts = np.array(list(product(range(-most, most + 1), repeat=len(vectors))))
    for i, j in [*combinations(range(len(labels)), 2), *((k, k) for k in range(len(labels)))]:
        distances = np.linalg.norm(places[j] + shifts @ vectors - places[i], axis=-1)
        for shift in shifts[distances < RADII[labels[i]] + RADII[labels[j]] + MARGIN].tolist():
            if i != j or shift > [0] * len(shift):
                found.add(CellBond(i, j, tuple(shift)))
    return found


def parts(count: int, pairs: set[CellBond]) -> int:
    graph = coo_array(
        (np.ones(len(pairs)), ([p.first for p in pairs], [p.second for p in pairs])), shape=(count, count)
    )
    return int(connected_components(graph, directed=False)[0])


def reaches_itself(count: int, pairs: set[CellBond], dimensions: int, most: int = 4) -> bool:
    """Whether a walk along bonds leads from an atom to an image of its own."""
    steps = [(p.first, p.second, p.shift) for p in pairs]
    steps += [(p.second, p.first, tuple(-s for s in p.shift)) for p in pairs]
    for start in range(count):
        seen = {(start, (0,) * dimensions)}
        rest = list(seen)
        while rest:
            here, at = rest.pop()
            for one, other, step in steps:
                there = (other, tuple(a + b for a, b in zip(at, step, strict=True)))
                if one != here or there in seen or max(map(abs, there[1])) > most * count:
                    continue
                if other == start:
                    return True
                seen.add(there)
                rest.append(there)
    return False


class TestAgainstEveryImage:
    def test_bonds_and_fragments(self, rng: np.random.Generator) -> None:
        kinds = {"across": 0, "endless": 0, "cut": 0}
        for _ in range(60):
            labels, places, vectors = random_case(rng)
            turns = np.floor(places @ np.linalg.pinv(vectors))
            most = 3 + int(np.ptp(turns, axis=0).max())
            known = all_bonds(labels, places, vectors, min(most, 12))
            found = cell_crossings(labels, places, vectors)
            across = {pair for pair in known if any(pair.shift)}
            assert found.bonds == tuple(sorted(across))
            assert found.fragments == parts(len(labels), known - across)
            assert found.fragments_joined == parts(len(labels), known)
            assert bonds(labels, places) == sorted((p.first, p.second) for p in known - across)
            if len(known) < 12:
                assert found.is_endless == reaches_itself(len(labels), known, len(vectors))
            kinds["across"] += bool(across)
            kinds["endless"] += found.is_endless
            kinds["cut"] += found.fragments != found.fragments_joined
        assert min(kinds.values()) > 5, kinds

    def test_extents(self, rng: np.random.Generator) -> None:
        """The least over all choices of images: each atom may be the first."""
        for _ in range(50):
            labels, places, vectors = random_case(rng)
            found = cell_crossings(labels, places, vectors)
            fractions = places @ np.linalg.pinv(vectors)
            np.testing.assert_allclose(found.extents, np.ptp(fractions, axis=0), atol=1e-12)
            ways = [np.ptp(first + np.mod(fractions - first, 1.0), axis=0) for first in fractions]
            least = np.minimum(np.min(ways, axis=0), found.extents)
            np.testing.assert_allclose(found.least_extents, least, atol=1e-9)

    def test_bonds_of_many_atoms(self, rng: np.random.Generator) -> None:
        """In boxes, as pair by pair; atoms far away among them."""
        for count, size in ((1, 1.0), (40, 3.0), (300, 12.0), (300, 1e6)):
            labels = rng.choice(list(RADII), count).tolist()
            places = rng.uniform(-size, size, (count, 3))
            places[rng.random(count) < 0.05] *= 1e200
            radii = np.array([RADII[label] for label in labels])
            distances = np.sqrt(((places[:, None] / 1e200 - places / 1e200) ** 2).sum(-1)) * 1e200
            near = distances < radii[:, None] + radii + MARGIN
            with np.errstate(over="ignore"):
                exact = np.linalg.norm(places[:, None] - places, axis=-1) < radii[:, None] + radii + MARGIN
            assert (near >= exact).all()
            assert bonds(labels, places) == [tuple(p) for p in np.argwhere(np.triu(exact, 1)).tolist()]

    def test_moving_atoms_by_the_shifts_makes_the_molecule_whole(self, rng: np.random.Generator) -> None:
        """Water cut at sides and corners, in any cell: put together again, it has its own moments."""
        water = np.array([(0.0, 0.0, 0.119), (0.0, 0.763, -0.477), (0.0, -0.763, -0.477)])
        whole = RigidBody.from_particles([16.0, 1.0, 1.0], water).principal_moments
        for _ in range(30):
            vectors = np.diag(rng.uniform(6.0, 9.0, 3)) + rng.normal(size=(3, 3))
            fractions = (water + rng.uniform(-20.0, 20.0, 3)) @ np.linalg.inv(vectors)
            places = np.mod(fractions, 1.0) @ vectors
            found = cell_crossings(["O", "H", "H"], places, vectors)
            for first, second, shift in found.bonds:
                assert first == 0
                places[second] += np.array(shift) @ vectors
            assert cell_crossings(["O", "H", "H"], places, vectors).is_whole
            moments = RigidBody.from_particles([16.0, 1.0, 1.0], places).principal_moments
            np.testing.assert_allclose(moments, whole, rtol=1e-9)


class TestFragmentsApart:
    """Atoms without bonds between them: they cross where they stand together through a side alone."""

    @pytest.mark.parametrize(("gap", "crossed"), [(0.66, False), (0.68, True)])
    def test_both_sides_of_the_share(self, gap: float, crossed: bool) -> None:
        """With a gap g between two atoms their extents are g and 1 - g: half at g = 2/3."""
        found = cell_crossings(["He", "He"], [(1.0, 5, 5), (1.0 + 10 * gap, 5, 5)], BOX)
        assert found.crossed == (crossed, False, False)
        assert found.is_whole != crossed

    def test_rounding_is_no_extent(self) -> None:
        flat = [(1.0, 2.0, 0.0), (1.0 + 1e-15, 2.0, -1e-17), (1.0, 6.0, 1e-17)]
        assert cell_crossings(["He"] * 3, flat, BOX).crossed == (False, False, False)

    def test_a_molecule_that_sticks_out_is_whole(self) -> None:
        """Coordinates beyond a side are as good as any."""
        assert cell_crossings(["H", "H"], [(9.63, 5, 5), (10.37, 5, 5)], BOX).is_whole

    def test_only_along_the_vectors_there_are(self) -> None:
        h2 = [(9.63, 5, 5), (0.37, 5, 5)]
        assert cell_crossings(["H", "H"], h2, BOX[1:]).is_whole
        assert cell_crossings(["H", "H"], h2, BOX[:1]).bonds == (CellBond(0, 1, (1,)),)


class TestRefusals:
    @pytest.mark.parametrize(
        ("cell", "says"),
        [
            (np.zeros((3, 3)), "do not span a cell"),
            ([(10, 0, 0), (20, 0, 0)], "do not span a cell"),
            (np.diag([0.99, 9.0, 9.0]), "0.99 angstrom apart"),
            (np.full((3, 3), np.inf), "do not span a cell"),
        ],
    )
    def test_no_cell(self, cell: Any, says: str) -> None:
        with pytest.raises(PolhodeError, match=says):
            cell_crossings(["H"], [(0, 0, 0)], cell)

    @pytest.mark.parametrize("shape", [(3,), (4, 3), (0, 3), (3, 2)])
    def test_shapes(self, shape: tuple[int, ...]) -> None:
        with pytest.raises(ValueError, match=r"cell: expected one to three vectors, shape \(k, 3\)"):
            cell_crossings(["H"], [(0, 0, 0)], np.ones(shape))

    def test_the_least_cell(self) -> None:
        """Sides are one angstrom apart at least."""
        assert len(cell_crossings(["H"], [(0, 0, 0)], np.diag([1.01, 9.0, 9.0])).bonds) == 1

    def test_atoms_that_are_none(self, rng: np.random.Generator) -> None:
        """More than one in a cubic angstrom, as where nanometres are read as angstrom."""
        places = rng.uniform(0.0, 1.0, (500, 3))
        for density, is_matter in ((0.8, True), (1.25, False)):
            side = (500 / density) ** (1 / 3)
            if is_matter:
                assert len(cell_crossings(["H"] * 500, places * side, np.eye(3) * side).bonds) > 0
            else:
                with pytest.raises(PolhodeError, match="nearer to each other than atoms can be"):
                    cell_crossings(["H"] * 500, places * side, np.eye(3) * side)
        with pytest.raises(PolhodeError, match="1e9 cells away"):
            cell_crossings(["H"], [(1e12, 0.0, 0.0)], BOX)


def pdb_of_h2(path: Path, *, cell: float = 10.0, second: float = 0.37) -> Path:
    sides = f"{cell:9.3f}" * 3 + "  90.00" * 3
    atom = "HETATM    {0}  H{0}  HH  A   1    {1:8.3f}   5.000   5.000  1.00  0.00           H\n"
    path.write_text(f"CRYST1{sides} P 1           1\n{atom.format(1, 9.63)}{atom.format(2, second)}")
    return path


def xyz_of_h2(path: Path, pbc: str = "T T T", scale: float = 1.0) -> Path:
    lattice = " ".join(repr(x * scale) for x in BOX.ravel().tolist())
    rows = "".join(f"H {x * scale!r} {5.0 * scale!r} {5.0 * scale!r}\n" for x in (9.63, 0.37))
    path.write_text(f'2\nLattice="{lattice}" Properties=species:S:1:pos:R:3 pbc="{pbc}"\n{rows}')
    return path


class TestWhereItIsSaid:
    @pytest.mark.parametrize("write", [pdb_of_h2, xyz_of_h2])
    def test_in_the_report_and_in_python(self, write: Any, tmp_path: Path) -> None:
        path = write(tmp_path / f"h2.{'pdb' if write is pdb_of_h2 else 'xyz'}")
        for command in ("molecule", "report"):
            code, out, err = run(command, path, "--format", "json")
            assert (code, err) == (0, "")
            report = json.loads(out)
            assert report["cell"] == {"bonds_across": 1, "fragments": 2, "fragments_joined": 1}
            assert report["cell_bonds"] == [{"first": 1, "second": 2, "shift": [1, 0, 0]}]
            (note,) = [note for note in report["notes"] if "side of the cell" in note]
            assert "1 bond crosses a side of the cell, 1H(1)-1H(2)" in note
            assert "move atoms by whole vectors" in note
        table = run("molecule", path)[1]
        assert "bonds across sides" in table
        with pytest.warns(UserWarning, match=r"h2\.(pdb|xyz): 1 bond crosses a side of the cell"):
            body = RigidBody.from_file(path)
        assert body.principal_moments[2] == pytest.approx(1.00782503 / 2 * 9.26**2, rel=1e-6)
        molecule = load(path).molecule
        assert molecule.cell is not None
        assert cell_crossings(molecule.labels, molecule.positions, molecule.cell).bonds[0].shift == (1, 0, 0)

    def test_in_any_unit(self, tmp_path: Path) -> None:
        path = xyz_of_h2(tmp_path / "h2.xyz", scale=0.1)
        report = json.loads(run("molecule", path, "--length-unit", "nm", "--format", "json")[1])
        assert report["cell"]["bonds_across"] == 1
        with pytest.warns(UserWarning, match="1 bond crosses"):
            RigidBody.from_file(path, length_unit="nm")

    def test_nothing_is_said_of_a_whole_molecule(self, tmp_path: Path) -> None:
        whole = [pdb_of_h2(tmp_path / "a.pdb", second=8.89), xyz_of_h2(tmp_path / "a.xyz", "F T T")]
        whole.append(pdb_of_h2(tmp_path / "b.pdb", cell=1.0))  # no crystal by the format
        for path in whole:
            with warnings.catch_warnings(action="error"):
                RigidBody.from_file(path)
            notes = json.loads(run("molecule", path, "--format", "json")[1])["notes"]
            assert not any("side" in note for note in notes)

    def test_in_an_assembly(self, tmp_path: Path) -> None:
        pdb_of_h2(tmp_path / "h2.pdb")
        (tmp_path / "two.toml").write_text('[[part]]\nname = "h2"\nfile = "h2.pdb"\n')
        code, out, err = run("assemble", tmp_path / "two.toml", "--format", "json")
        assert (code, err) == (0, "")
        assert "1 bond crosses a side of the cell" in out

    def test_crystals_and_pieces(self, tmp_path: Path) -> None:
        for rows, cell, says in (
            ("C 0 0 0", 1.5, "3 bonds cross a side of the cell, .* without end, as a crystal"),
            (
                "He 1 5 5\nHe 9 5 5",
                10.0,
                "together only through a side of the cell, over 0.2 instead of 0.8",
            ),
            ("Bk 0 0 0\nBk 5 5 5", 10.0, "was not looked for: .*no covalent radius"),
            ("H 0 0 0", 0.5, "was not looked for: .*0.5 angstrom apart"),
        ):
            path = tmp_path / "a.xyz"
            lattice = " ".join(str(x) for x in (cell * np.eye(3)).ravel().tolist())
            rows = rows.replace("Bk", "249Bk")
            path.write_text(
                f'{len(rows.splitlines())}\nLattice="{lattice}" Properties=species:S:1:pos:R:3\n{rows}\n'
            )
            with pytest.warns(UserWarning, match=says):
                RigidBody.from_file(path)

    def test_atoms_of_ase(self) -> None:
        """As ASE has them, by a stand-in: its cell keeps a vector of zeros where nothing repeats."""
        for pbc, warned in (
            ((True, True, True), True),
            ((False, True, True), False),
            ((True, False, False), True),
        ):
            atoms = SimpleNamespace(
                get_chemical_symbols=lambda: ["H", "H"],
                get_masses=lambda: np.array([1.008, 1.008]),
                get_positions=lambda: np.array([(9.63, 5.0, 5.0), (0.37, 5.0, 5.0)]),
                get_cell=lambda pbc=pbc: BOX * np.array(pbc)[:, None],
                get_pbc=lambda pbc=pbc: np.array(pbc),
                has=lambda name: name == "positions",
            )
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                RigidBody.from_atoms(atoms)
                atoms.has = lambda _: True
                RigidBody.from_atoms(atoms)
            says = "atoms: 1 bond crosses a side of the cell"
            assert [str(w.message)[: len(says)] for w in caught] == [says] * (2 * warned)
            assert all(w.filename == __file__ for w in caught)


def test_a_cell_of_very_different_sides() -> None:
    """The heights of (4, 0, 1e16) and (0, 5, 0) are 1e16 and 5: atoms cross neither."""
    found = cell_crossings(
        ["O", "H", "H"], [(0, 0, 0), (0.75, 0, 0.5), (-0.75, 0, 0.5)], [(4, 0, 1e16), (0, 5, 0)]
    )
    assert (found.bonds, found.fragments, found.is_endless) == ((), 1, False)
