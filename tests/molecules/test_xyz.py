"""Molecules from XYZ files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from polhode import RigidBody
from polhode.errors import FileFormatError, PolhodeError
from polhode.io import read_mesh, read_xyz

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def write(tmp_path: Path) -> Any:
    def writer(name: str, data: bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(data)
        return path

    return writer


WATER = b"3\nwater\nO 0 0 0.1\nH 0.76 0 -0.5 extra 1\nH -0.76 0 -0.5\n\n"


def test_xyz(write: Any) -> None:
    molecule = read_xyz(write("water.xyz", WATER))
    assert molecule.labels == ("O", "H", "H")
    assert molecule.comment == "water"
    np.testing.assert_array_equal(molecule.positions, [[0, 0, 0.1], [0.76, 0, -0.5], [-0.76, 0, -0.5]])


def test_xyz_body_in_atomic_and_in_si_units(write: Any) -> None:
    path = write("water.xyz", WATER)
    atomic = RigidBody.from_file(path)
    si = RigidBody.from_file(path, length_unit="angstrom")
    assert atomic.mass == pytest.approx(15.9949146193 + 2 * 1.0078250319, abs=1e-8)
    assert si.mass == pytest.approx(atomic.mass * 1.66053906892e-27, rel=1e-14)
    np.testing.assert_allclose(si.principal_moments, atomic.principal_moments * 1.66053906892e-47, rtol=1e-13)


@pytest.mark.parametrize("given", ["density", "mass"])
def test_xyz_takes_no_mass(given: str, write: Any) -> None:
    keywords: Any = {given: 1.0}
    with pytest.raises(PolhodeError, match=rf"{given}: .*water\.xyz is a molecule"):
        RigidBody.from_file(write("water.xyz", WATER), **keywords)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "empty"),
        (b"water\n\nO 0 0 0\n", "line 1 .* number of atoms, not 'water'"),
        (b"0\nnothing\n", "number of atoms"),
        (b"3\nwater\nO 0 0 0\n", "promises 3 atoms, but the file holds 1"),
        (b"1\na\nO 0 0 0\n1\nb\nO 0 0 0\n", "one frame"),
        (b"1\na\nO 0 0\n", "line 3: expected 'symbol x y z', got 'O 0 0'"),
        (b"1\na\nO 0 zero 0\n", "line 3"),
        (b"1\na\nO 0 nan 0\n", "line 3"),
        (b"2\na\nO 0 0 0\n\n", "line 4"),
        (b"1\nProperties=pos:R:3:forces:R:3\n0 0 0 0 0 0\n", "line 2 declares no columns"),
        (b"1\n\xff\xfe\nO 0 0 0\n", "not a text file"),
        (b"9" * 30 + b"\nmany\nO 0 0 0\n", "promises 9999"),
        (bytes(80) + bytes(4), "content is binary STL"),
    ],
)
def test_damaged_xyz(data: bytes, message: str, write: Any) -> None:
    path = write("bad.xyz", data)
    with pytest.raises(FileFormatError, match=message) as caught:
        read_xyz(path)
    assert str(path) in str(caught.value)


def test_unknown_element_names_the_file(write: Any) -> None:
    with pytest.raises(FileFormatError, match=r"bad\.xyz: 'Xx' is not an element"):
        RigidBody.from_file(write("bad.xyz", b"1\na\nXx 0 0 0\n"))


def test_extended_xyz_with_the_usual_columns(write: Any) -> None:
    data = b'1\nProperties=species:S:1:pos:R:3:q:R:1 pbc="F F F"\nO 0 0 1 0.3\n'
    assert read_xyz(write("a.xyz", data)).labels == ("O",)


def test_a_molecule_is_no_mesh(write: Any) -> None:
    with pytest.raises(FileFormatError, match="atoms, not a mesh"):
        read_mesh(write("water.xyz", WATER))
