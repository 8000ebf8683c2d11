"""Bodies and motions through io, and other libraries' objects taken as they are."""

from __future__ import annotations

import importlib
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, Trajectory, Uncertain, io, loads, solids
from polhode.errors import FileFormatError, PolhodeError
from polhode.molecules import isotopes
from rdkit import Chem
from rdkit.Chem import AllChem

TILT = np.array([0.3, -0.1, 0.4, 0.86]) / np.linalg.norm([0.3, -0.1, 0.4, 0.86])
BODIES = {
    "box": solids.box((3.0, 0.2, 1.1), mass=0.7).translated((0.1, 1e3, 0.3)).rotated(TILT),
    "molecule": RigidBody.from_principal(3e-26, (0.0, 1.9e-46, 1.9e-46)),
    "rod": RigidBody.from_particles([1.0, 2.0, 3.0], [(i, 1e-12 * i * i, 0.0) for i in range(3)]),
    "stack": solids.box(np.arange(1.0, 19.0).reshape(2, 3, 3), density=2.0),
}


class TestBodies:
    @pytest.mark.parametrize("suffix", [".json", ".npz", ".JSON", ".NPZ"])
    @pytest.mark.parametrize("name", BODIES)
    def test_every_bit_returns(self, name: str, suffix: str, tmp_path: Path) -> None:
        path = tmp_path / f"body{suffix}"
        body = BODIES[name]
        body.save(path)
        again = RigidBody.from_file(path)
        assert again == body
        assert again.shape == body.shape
        assert np.array_equal(again.principal.axes, body.principal.axes)
        assert np.array_equal(again.principal_moments, body.principal_moments)
        assert [p.name for p in tmp_path.iterdir()] == [path.name]

    def test_an_empty_stack(self, tmp_path: Path) -> None:
        empty = solids.box(np.ones((2, 0, 3)), mass=1.0)
        empty.save(tmp_path / "body.npz")
        assert RigidBody.from_file(tmp_path / "body.npz").shape == (2, 0)
        with pytest.raises(ValueError, match=r"shape of an empty stack; save it as \.npz"):
            empty.save(tmp_path / "body.json")

    def test_json_is_readable_and_after_its_schema(self, tmp_path: Path) -> None:
        BODIES["box"].save(tmp_path / "body.json")
        fields = json.loads((tmp_path / "body.json").read_text("utf-8"))
        assert fields["mass"] == 0.7
        assert fields["center_of_mass"] == BODIES["box"].center_of_mass.tolist()
        properties: Any = io.BODY_SCHEMA["properties"]
        of_uncertain_bodies = {"variable_counts", "variables", "tangents", "second_order"}
        assert set(fields) == set(properties) - of_uncertain_bodies
        assert fields["format"] == properties["format"]["const"]

    def test_an_uncertain_one_has_its_sources_too(self, tmp_path: Path) -> None:
        brick: Any = solids.box(
            Uncertain((1.0, 2.0, 3.0), sigma=0.01), mass=Uncertain(2.0, 0.1, source="scale")
        )
        for name in ("body.json", "body.npz"):
            brick.save(tmp_path / name)
            again: Any = RigidBody.from_file(tmp_path / name)
            assert again == brick
            assert np.array_equal(again.covariance_with(brick), brick.covariance)
        fields = json.loads((tmp_path / "body.json").read_text("utf-8"))
        properties: Any = io.BODY_SCHEMA["properties"]
        assert set(fields) == set(properties)
        del fields["numbers"]
        (tmp_path / "spoilt.json").write_text(json.dumps(fields), "utf-8")
        with pytest.raises(FileFormatError, match="uncertainty"):
            RigidBody.from_file(tmp_path / "spoilt.json")

    def test_one_written_by_hand(self, tmp_path: Path) -> None:
        fields = {"format": "polhode.RigidBody/1", "mass": 2, "center_of_mass": [0, 0, 1]}
        path = tmp_path / "body.json"
        path.write_text(json.dumps(fields | {"inertia": np.diag([1.0, 2.0, 2.5]).tolist()}), "utf-8")
        assert RigidBody.from_file(path) == RigidBody(2.0, np.diag([1.0, 2.0, 2.5]), (0, 0, 1))

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"mass": 1.0}, "mass is not that of the body in numbers"),
            ({"format": "polhode.Trajectory/1"}, "its format is 'polhode.Trajectory/1'"),
            ({"inertia": "big"}, "inertia is not an array of numbers"),
            ({"inertia": [[1, 2], [3]]}, "inertia is not an array of numbers"),
            ({"numbers": [1.0, 2.0]}, "not the fields of a body"),
            ({"numbers": [-1.0] * 33}, "body.json"),
        ],
    )
    def test_what_does_not_fit_is_told(self, change: dict[str, Any], message: str, tmp_path: Path) -> None:
        path = tmp_path / "body.json"
        BODIES["box"].save(path)
        path.write_text(json.dumps(json.loads(path.read_text("utf-8")) | change), "utf-8")
        with pytest.raises(FileFormatError, match=message):
            RigidBody.from_file(path)

    def test_impossible_bodies_and_broken_files(self, tmp_path: Path) -> None:
        path = tmp_path / "body.json"
        fields = {"format": "polhode.RigidBody/1", "mass": 2, "center_of_mass": [0, 0, 1]}
        path.write_text(json.dumps(fields | {"inertia": np.diag([1.0, 1.0, 3.0]).tolist()}), "utf-8")
        with pytest.raises(FileFormatError, match="triangle inequality"):
            RigidBody.from_file(path)
        path.write_text(json.dumps(fields), "utf-8")
        with pytest.raises(FileFormatError, match="inertia is missing"):
            RigidBody.from_file(path)
        for name, content in (
            ("a.json", b"{"),
            ("b.json", b"\xff"),
            ("c.npz", b"PK"),
            ("d.npz", b""),
            ("e.json", b"[]"),
        ):
            (tmp_path / name).write_bytes(content)
            with pytest.raises(FileFormatError, match=name):
                RigidBody.from_file(tmp_path / name)
        with pytest.raises(ValueError, match=r"does not end in \.json or \.npz"):
            BODIES["box"].save(tmp_path / "body.csv")
        (tmp_path / "body.csv").write_text("mass\n1\n", "utf-8")
        with pytest.raises(FileFormatError, match=r"files named \.csv are not read"):
            RigidBody.from_file(tmp_path / "body.csv")


@pytest.fixture(params=["one", "stack"])
def motion(request: pytest.FixtureRequest) -> Trajectory:
    body = BODIES["box" if request.param == "one" else "stack"]
    load = loads.uniform_gravity((0.0, 0.0, -9.81))
    return body.simulate(np.linspace(0, 1, 5), (0.1, 1.0, 0.2), load=load, velocity=(0.0, 1.0, 0.0))


class TestMotions:
    @pytest.mark.parametrize("suffix", [".json", ".npz"])
    def test_every_bit_returns(self, motion: Trajectory, suffix: str, tmp_path: Path) -> None:
        motion.save(tmp_path / f"motion{suffix}")
        again = Trajectory.from_file(tmp_path / f"motion{suffix}")
        assert again.body == motion.body
        for name in ("t", "omega", "quaternion", "position", "velocity", "about", "steps", "evaluations"):
            assert np.array_equal(getattr(again, name), getattr(motion, name)), name
        assert np.array_equal(again.status, motion.status)
        assert again.pivoted == motion.pivoted

    def test_states_after_a_failure_are_null(self, tmp_path: Path) -> None:
        motion = BODIES["box"].simulate([0.0, 1.0], (0.1, 1.0, 0.2))
        for states in (motion.omega, motion.quaternion, motion.position, motion.velocity):
            states.setflags(write=True)
            states[-1] = np.nan
        motion = replace(motion, status="failed")
        motion.save(tmp_path / "motion.json")
        assert json.loads((tmp_path / "motion.json").read_text("utf-8"))["omega"][-1] == [None] * 3
        again = Trajectory.from_file(tmp_path / "motion.json")
        assert np.array_equal(again.omega, motion.omega, equal_nan=True)

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"omega": [[1.0, 2.0, 3.0]]}, r"omega has shape \(1, 3\), expected \(2, 3\)"),
            ({"t": 3.0}, "expected"),
            ({"body": 3}, "body is not an object"),
            ({"about": [0.0]}, "about has shape"),
        ],
    )
    def test_what_does_not_fit_is_told(self, change: dict[str, Any], message: str, tmp_path: Path) -> None:
        path = tmp_path / "motion.json"
        BODIES["box"].simulate([0.0, 1.0], (0.1, 1.0, 0.2)).save(path)
        path.write_text(json.dumps(json.loads(path.read_text("utf-8")) | change), "utf-8")
        with pytest.raises(FileFormatError, match=message):
            Trajectory.from_file(path)

    def test_xarray_names_its_axes(self, motion: Trajectory) -> None:
        pytest.importorskip("xarray")
        dataset = motion.to_xarray()
        stack = ("body_0", "body_1") if motion.body.shape else ()
        assert dataset["omega"].dims == (*stack, "time", "component")
        assert dataset["quaternion"].dims == (*stack, "time", "quaternion_component")
        np.testing.assert_array_equal(dataset["omega"].sel(component="y"), motion.omega[..., 1])
        np.testing.assert_array_equal(dataset["time"], motion.t)
        assert dataset["velocity"].attrs["frame"] == "space"


class TestOtherLibraries:
    def test_trimesh(self) -> None:
        trimesh = pytest.importorskip("trimesh")
        mesh = trimesh.creation.box(extents=(1.0, 2.0, 3.0))
        mesh.apply_translation((0.5, 0.0, 0.0))
        body = RigidBody.from_mesh_object(mesh, density=2.0)
        assert body.isclose(solids.box((1.0, 2.0, 3.0), density=2.0).translated((0.5, 0.0, 0.0)))
        np.testing.assert_allclose(body.inertia, 2.0 * mesh.moment_inertia, atol=1e-12)
        scene = trimesh.Scene()
        scene.add_geometry(
            trimesh.creation.box(extents=(1.0, 2.0, 3.0)), transform=np.eye(4)[:, [1, 2, 0, 3]]
        )
        assert RigidBody.from_mesh_object(scene, mass=6.0).isclose(
            RigidBody.from_mesh_object(scene.to_mesh(), mass=6.0)
        )

    def test_triangles_with_corners_of_their_own(self) -> None:
        corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
        faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
        soup = SimpleNamespace(vertices=corners[faces].reshape(-1, 3), faces=np.arange(12).reshape(4, 3))
        body = RigidBody.from_mesh_object(soup, density=6.0)
        np.testing.assert_allclose(body.mass, 1.0, rtol=1e-15)
        with pytest.raises(TypeError, match="expected an object with vertices and faces"):
            RigidBody.from_mesh_object(3.0, density=1.0)

    def test_ase(self) -> None:
        """Water as ASE gives it: a stand-in with its methods where ASE is not installed."""
        positions = np.array([(0.0, 0.0, 0.119262), (0.0, 0.763239, -0.477047), (0.0, -0.763239, -0.477047)])
        try:
            ase: Any = importlib.import_module("ase")
            atoms = ase.Atoms("OH2", positions=positions)
            heavy = ase.Atoms("OH2", positions=positions, masses=[16.0, 2.0, 2.0])
        except ImportError:
            atoms = SimpleNamespace(
                get_chemical_symbols=lambda: ["O", "H", "H"],
                get_masses=lambda: np.array([15.999, 1.008, 1.008]),
                get_positions=lambda: positions,
                has=lambda name: name == "positions",
            )
            heavy = SimpleNamespace(
                **vars(atoms) | {"get_masses": lambda: np.array([16.0, 2.0, 2.0]), "has": lambda _: True}
            )
        body = RigidBody.from_atoms(atoms)
        assert body == RigidBody.from_particles(
            [isotope.mass for isotope in isotopes(["O", "H", "H"])], positions
        )
        assert str(body.provenance).startswith("3 atoms, most common isotopes; ")
        average = RigidBody.from_atoms(atoms, masses="average")
        np.testing.assert_allclose(average.mass, 15.999 + 2 * 1.008, atol=1e-3)
        assert average.provenance.source == "atoms, average masses"
        own = RigidBody.from_atoms(heavy)
        assert own == RigidBody.from_particles([16.0, 2.0, 2.0], positions)
        assert own.provenance.source == "atoms, masses of their own"
        nameless = SimpleNamespace(get_masses=lambda: [16.0, 2.0, 2.0], get_positions=lambda: positions)
        assert RigidBody.from_atoms(nameless) == own
        nameless.get_masses = lambda: np.ma.masked_array([16.0, 2.0, 2.0], mask=[False, True, False])
        with pytest.raises(ValueError, match="masked"):
            RigidBody.from_atoms(nameless)
        with pytest.raises(ValueError, match="conformer"):
            RigidBody.from_atoms(atoms, conformer=0)
        with pytest.raises(ValueError, match="masses: expected 'most_common' or 'average', got 'heavy'"):
            RigidBody.from_atoms(atoms, masses="heavy")  # type: ignore[arg-type]

    def test_rdkit(self) -> None:
        """Two conformers of a diatomic molecule, as a stand-in with RDKit's names."""
        conformers = {0: np.array([(0.0, 0, 0), (1.0, 0, 0)]), 3: np.array([(0.0, 0, 0), (2.0, 0, 0)])}
        atoms = [
            SimpleNamespace(GetSymbol=lambda: "C", GetIsotope=lambda: 13),
            SimpleNamespace(GetSymbol=lambda: "O", GetIsotope=lambda: 0),
        ]
        molecule = SimpleNamespace(
            GetAtoms=lambda: atoms,
            GetNumConformers=lambda: len(conformers),
            GetConformer=lambda number: SimpleNamespace(GetPositions=lambda: conformers[max(number, 0)]),
        )
        carbon, oxygen = (isotope.mass for isotope in isotopes(["13C", "16O"]))
        reduced = carbon * oxygen / (carbon + oxygen)
        for number, length in ((None, 1.0), (0, 1.0), (3, 2.0)):
            moments = RigidBody.from_atoms(molecule, conformer=number).principal_moments
            np.testing.assert_allclose(moments, (0.0, reduced * length**2, reduced * length**2), rtol=1e-14)
        conformers.clear()
        with pytest.raises(ValueError, match="no conformer"):
            RigidBody.from_atoms(molecule)
        with pytest.raises(TypeError, match="expected ASE's Atoms or RDKit's Mol, got str"):
            RigidBody.from_atoms("H2O")

    def test_rdkit_drawings_and_hydrogens_without_places(self) -> None:
        """RDKit itself: a conformer in the plane is refused, missing hydrogens are told."""
        ethanol: Any = Chem.AddHs(Chem.MolFromSmiles("CCO"))
        AllChem.EmbedMolecule(ethanol, randomSeed=1)
        assert RigidBody.from_atoms(ethanol).mass == pytest.approx(46.0418648, abs=1e-6)
        with pytest.warns(UserWarning, match="6 hydrogens have no positions"):
            assert RigidBody.from_atoms(Chem.RemoveHs(ethanol)).mass == pytest.approx(39.9949146, abs=1e-6)
        drawing: Any = Chem.MolFromSmiles("CCO")
        AllChem.Compute2DCoords(drawing)
        with pytest.raises(PolhodeError, match="a drawing in the plane, not a geometry; make one with"):
            RigidBody.from_atoms(drawing)
        drawing = Chem.AddHs(drawing, addCoords=True)
        drawing.GetConformer().Set3D(True)  # as its message says
        RigidBody.from_atoms(drawing)
        water: Any = Chem.MolFromXYZBlock("3\n\nO 0 0 0\nH 1 0 0\nH 0 1 0\n")
        for _ in range(2):
            assert RigidBody.from_atoms(water).mass == pytest.approx(18.0105647, abs=1e-6)
            water.UpdatePropertyCache(strict=False)  # valences without bonds, which nobody stated


class TestAnyBody:
    """``RigidBody.from_file`` reads every file that holds a body, and refuses what it cannot use."""

    def test_an_assembly_and_a_report(self, tmp_path: Path) -> None:
        rows = '[[part]]\nname = "a"\nsolid = "sphere"\nradius = 2\nmass = 3\n'
        (tmp_path / "a.toml").write_text(rows + rows.replace('"a"', '"b"'), "utf-8")
        with pytest.warns(UserWarning, match=r"a\.toml: part b is the same as a, at the same place"):
            whole = RigidBody.from_file(tmp_path / "a.toml")
        assert whole.mass == 6.0
        report = {
            "units": {"mass": "kg", "center_of_mass": "m"},
            "mass": 2.0,
            "center_of_mass": [0, 0, 1],
            "inertia_about_center_of_mass": [[1, 0, 0], [0, 2, 0], [0, 0, 2.5]],
        }
        (tmp_path / "r.json").write_text(json.dumps(report), "utf-8")
        expected = RigidBody(2.0, np.diag([1.0, 2.0, 2.5]), (0, 0, 1))
        assert RigidBody.from_file(tmp_path / "r.json") == expected
        with pytest.raises(ValueError, match=r"length_unit: .* is a report, in kg and m; leave it out"):
            RigidBody.from_file(tmp_path / "r.json", length_unit="mm")

    def test_a_saved_body_in_a_unit(self, tmp_path: Path) -> None:
        BODIES["box"].save(tmp_path / "b.json")
        found = RigidBody.from_file(tmp_path / "b.json", length_unit="mm")
        assert found == BODIES["box"].scaled(length=1e-3)

    @pytest.mark.parametrize(
        "name", ["density", "mass", "weld", "closure", "orient", "union", "repair", "index_base", "masses"]
    )
    def test_what_a_saved_body_cannot_use_is_refused_by_name(self, name: str, tmp_path: Path) -> None:
        given: dict[str, Any] = {"closure": "caps", "masses": "average", "weld": 1e-3, "index_base": 0}
        BODIES["box"].save(tmp_path / "b.npz")
        with pytest.raises(PolhodeError, match=f"^{name}: .* is a saved body, whole as it is; leave it out"):
            RigidBody.from_file(
                tmp_path / "b.npz", **{name: given.get(name, name not in ("density", "mass") or 1.0)}
            )
