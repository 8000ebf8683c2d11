"""Images as files: NIfTI, NRRD and NumPy, read by their own libraries, against voxels in memory."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, assembly
from polhode.errors import FileFormatError, PolhodeError
from polhode.images import Image, body_of_image, grey_value_density, read_image

AFFINE = np.array([(-0.7, 0.1, 0, 30), (0, 0.7, 0.05, -12), (0.02, 0, 1.5, 7), (0, 0, 0, 1.0)])


@pytest.fixture
def labels(rng: np.random.Generator) -> np.ndarray:
    return rng.integers(0, 4, (6, 7, 8)).astype(np.int16)


def in_metres(affine: np.ndarray, unit: float) -> np.ndarray:
    own = affine.copy()
    own[:3] *= unit
    return own


def write_nifti(path: Path, values: np.ndarray, unit: str = "mm") -> None:
    nibabel = pytest.importorskip("nibabel")
    image = nibabel.Nifti1Image(values, AFFINE)
    image.header.set_xyzt_units(unit)
    image.set_sform(AFFINE)
    nibabel.save(image, path)


def write_nrrd(path: Path, values: np.ndarray) -> None:
    nrrd = pytest.importorskip("nrrd")
    header = {
        "space": "left-posterior-superior",
        "space directions": AFFINE[:3, :3].T,
        "space origin": AFFINE[:3, 3],
        "space units": ["mm", "mm", "mm"],
    }
    nrrd.write(str(path), values, header)


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz", "a.nrrd"])
def test_files_have_their_affine_and_unit(tmp_path: Path, labels: np.ndarray, name: str) -> None:
    path = tmp_path / name
    (write_nrrd if name.endswith("nrrd") else write_nifti)(path, labels)
    image = read_image(path)
    assert image.unit == "mm"
    assert np.array_equal(image.values, labels)
    assert np.allclose(image.affine, AFFINE, rtol=1e-6)  # float32 in NIfTI
    own = in_metres(image.affine, 1e-3)
    body = RigidBody.from_file(path, density={1: 1000.0, "2": 1900.0})
    density = np.where(labels == 1, 1000.0, np.where(labels == 2, 1900.0, 0.0))
    assert body.isclose(RigidBody.from_voxels(density, affine=own), rtol=1e-13)
    found, bodies = RigidBody.from_labelled_voxels(path, {3: 7.0, "*": 5.0})
    _, expected = RigidBody.from_labelled_voxels(labels, {3: 7.0, "*": 5.0}, affine=own)
    assert found.tolist() == [1, 2, 3]
    assert bodies.isclose(expected, rtol=1e-13).all()
    with pytest.raises(PolhodeError, match=r"affine: .* says itself where its voxels are; leave it out"):
        RigidBody.from_labelled_voxels(path, 1.0, affine=own)
    with pytest.raises(PolhodeError, match="length_unit: is for files"):
        RigidBody.from_labelled_voxels(labels, 1.0, spacing=1.0, length_unit="mm")
    with pytest.raises(PolhodeError, match="says itself that its unit is 'mm', not 'm'"):
        RigidBody.from_file(path, density=1.0, length_unit="m")


def test_arrays_of_numpy(tmp_path: Path, labels: np.ndarray) -> None:
    np.save(tmp_path / "a.npy", labels > 1)
    body = RigidBody.from_file(tmp_path / "a.npy", density=1000.0, length_unit="mm")
    assert body.isclose(RigidBody.from_voxels((labels > 1) * 1000.0, 1e-3), rtol=1e-14)
    plain = RigidBody.from_file(tmp_path / "a.npy", mass=2.0)
    assert plain.mass == pytest.approx(2.0, rel=1e-15)
    np.save(tmp_path / "four.npy", np.ones((2, 2, 2, 3)))
    with pytest.raises(
        FileFormatError, match=r"three dimensions is needed, and this one has the shape \(2, 2, 2, 3\)"
    ):
        read_image(tmp_path / "four.npy")
    np.save(tmp_path / "one.npy", np.ones((2, 2, 2, 1)))
    assert read_image(tmp_path / "one.npy").values.shape == (2, 2, 2)
    (tmp_path / "no.npy").write_bytes(b"nothing of the kind")
    with pytest.raises(FileFormatError, match="not an array of NumPy"):
        read_image(tmp_path / "no.npy")


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz", "a.nrrd"])
def test_damage_is_told(tmp_path: Path, labels: np.ndarray, name: str) -> None:
    path = tmp_path / name
    (write_nrrd if name.endswith("nrrd") else write_nifti)(path, labels)
    whole = path.read_bytes()
    for damaged in (whole[: len(whole) // 2], b"\0" * len(whole), whole[:40]):
        path.write_bytes(damaged)
        with pytest.raises(FileFormatError, match="not a whole"):
            RigidBody.from_file(path, density=1.0)
    with pytest.raises(FileNotFoundError):
        read_image(tmp_path / f"none{name}")


def test_grey_values(labels: np.ndarray) -> None:
    table = [(-1000, 0.0), (0, 1000.0), (2000, 2200.0)]
    density = grey_value_density(table)
    scan = np.where(labels == 1, 1200, np.where(labels == 2, -2048, 40)).astype(np.int16)
    body = body_of_image(Image(scan, AFFINE, "mm"), density, scale=1e-3)
    by_hand = np.where(labels == 1, 1000 + 0.6 * 1200, np.where(labels == 2, 0.0, 1000 + 0.6 * 40))
    assert body.isclose(RigidBody.from_voxels(by_hand, affine=in_metres(AFFINE, 1e-3)), rtol=1e-14)
    with pytest.raises(PolhodeError, match="ends at 2000, and the image has the value 3071"):
        density([0, 3071])
    for rows, words in (
        ([(0, 1), (0, 2)], "row 1 must be above the value before it"),
        ([(0, 1), (1, -2)], "row 1 must be of a density of 0 or more"),
        ([(0, 1), (1, np.inf)], "row 1 must be finite"),
    ):
        with pytest.raises(PolhodeError, match=words):
            grey_value_density(rows)
    with pytest.raises(ValueError, match=r"shape \(n, 2\)"):
        grey_value_density([(0, 1)])


def test_command_line_and_assembly(tmp_path: Path, labels: np.ndarray) -> None:
    path = tmp_path / "a.npy"
    np.save(path, labels)
    done = run("report", path, "--length-unit", "mm", "--density", "1=1 g/cm^3, *=2000", "--format", "json")
    assert done[0] == 0, done
    density = np.where(labels == 1, 1000.0, np.where(labels > 1, 2000.0, 0.0))
    expected = RigidBody.from_voxels(density, 1e-3)
    told = json.loads(done[1])
    assert told["mass"] == pytest.approx(float(expected.mass), rel=1e-12)
    found, bodies = RigidBody.from_labelled_voxels(labels, {1: 1000.0, "*": 2000.0}, spacing=1e-3)
    assert [row["value"] for row in told["regions"]] == found.tolist() == [1, 2, 3]
    assert np.allclose([row["mass"] for row in told["regions"]], bodies.mass, rtol=1e-12)
    done = run("report", path)
    assert done[0] == 2
    assert "--density" in done[2]
    part = {"name": "bone", "file": "a.npy", "length_unit": "mm", "density": {"1": 1000, "*": "2 g/cm^3"}}
    made = assembly.read({"name": "whole", "part": [part]}, folder=tmp_path).body
    assert made.isclose(expected, rtol=1e-13)
    with pytest.raises(PolhodeError, match=r"closure: .* is an image of voxels, not a mesh; leave it out"):
        assembly.read({"name": "whole", "part": [part | {"closure": "caps"}]}, folder=tmp_path)


def test_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.ones((2, 2, 2)))
    with pytest.raises(PolhodeError, match="no voxel has the value 'bone'; the values are 1"):
        RigidBody.from_file(tmp_path / "a.npy", density={"bone": 1.0})
    with pytest.raises(PolhodeError, match=r"thickness: .* is an image of voxels, not a mesh"):
        RigidBody.from_file(tmp_path / "a.npy", density=1.0, thickness=0.1)
    with pytest.raises(TypeError, match="exactly one of mass= and density="):
        RigidBody.from_file(tmp_path / "a.npy")
    for name in ("slice.dcm", "IM0001"):
        (tmp_path / name).write_bytes(b"\0" * 128 + b"DICM" + b"\0" * 400)
        with pytest.raises(FileFormatError, match="dcm2niix -z y -f scan FOLDER"):
            RigidBody.from_file(tmp_path / name, density=1.0)


@pytest.mark.parametrize("name", ["a.nii", "a.nrrd"])
def test_a_scan_without_a_unit(tmp_path: Path, labels: np.ndarray, name: str) -> None:
    """Python asks for the unit, since scans are in millimetres; a report says that it is not known."""
    path = tmp_path / name
    if name.endswith("nrrd"):
        pytest.importorskip("nrrd").write(str(path), labels)
    else:
        write_nifti(path, labels, "unknown")
    for read in (RigidBody.from_file, RigidBody.from_labelled_voxels):
        with pytest.raises(PolhodeError, match='states no unit of length; give length_unit="mm"'):
            read(path, density={1: 1000.0})
        read(path, density={1: 1000.0}, length_unit="mm")
    code, out, _ = run("report", path, "--density", "1=1000")
    assert code == 0
    assert "unit unknown" in out


def test_a_function_of_values_gets_floats(tmp_path: Path) -> None:
    """Of 16-bit numbers the product would wrap around."""
    np.save(tmp_path / "a.npy", np.full((2, 2, 2), 700, dtype=np.int16))
    body = RigidBody.from_file(tmp_path / "a.npy", density=lambda hu: 400 * hu / 700)
    assert body.mass == 8 * 400.0


def test_labels_are_no_factors(tmp_path: Path) -> None:
    values = np.zeros((3, 3, 3), dtype=np.int16)
    values[1, 1] = 1
    path = tmp_path / "a.npy"
    np.save(path, values)
    one = RigidBody.from_file(path, density=1000.0)
    for kind in (np.int16, np.float64):
        values[0, 1] = 2
        np.save(path, values.astype(kind))
        with pytest.raises(PolhodeError, match=r"density: a number multiplies the values, .* up to 2"):
            RigidBody.from_file(path, density=1000.0)
    assert RigidBody.from_file(path, density=1.0).mass == 9.0  # they are densities
    np.save(path, values / 4)
    assert RigidBody.from_file(path, density=4000.0).mass == pytest.approx(3.0 * float(one.mass))
