"""Solids in STEP and IGES files against closed forms: moments, bounds, units, assemblies, refusals."""

from __future__ import annotations

import gzip
import json
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cad_files import SOLIDS, occt, primitive, write_assembly, write_step
from command_line import one_line, run
from polhode import RigidBody, Uncertain, assembly, solids
from polhode.errors import FileFormatError, MeshError, PolhodeError
from polhode.io import cad_files, cad_process, load, read_mesh, solid_from_file
from polhode.io.cad_files import read_cad, solids_of
from polhode.io.cad_geometry import moments_of_faces

pytest.importorskip("OCP.BRep", reason="CAD files need polhode[cad]")
MM = 1e-3


@pytest.fixture(autouse=True)
def _in_this_process(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read in this process, which is sooner, but in the tests of the other one."""
    if request.cls is not TestApart:
        monkeypatch.setattr(cad_process, "read_cad_apart", lambda path, _packed: read_cad(path))


class TestClosedForms:
    @pytest.mark.parametrize("name", SOLIDS)
    def test_moments(self, name: str, tmp_path: Path) -> None:
        known = SOLIDS[name]
        path = write_step(known.make(), tmp_path / "part.step")
        body = RigidBody.from_file(path, density=1.0)
        mass, size = known.volume * MM**3, known.volume ** (1 / 3) * MM
        rtol = 1e-11 if known.exact else 1e-8
        assert body.mass == pytest.approx(mass, rel=rtol)
        np.testing.assert_allclose(
            body.center_of_mass, np.array(known.center) * MM, rtol=0, atol=rtol * 10 * size
        )
        inertia = np.diag(known.moments) * MM**5
        np.testing.assert_allclose(body.inertia, inertia, rtol=0, atol=rtol * 10 * inertia.max())
        bound = body.error_bound
        assert abs(body.mass - mass) <= bound.mass <= (1e-11 if known.exact else 1e-6) * mass
        assert np.abs(body.center_of_mass - np.array(known.center) * MM).max() <= bound.center_of_mass
        assert np.abs(body.inertia - inertia).max() <= bound.inertia
        assert bound.inertia <= (1e-8 if known.exact else 1e-3) * inertia.max()

    def test_there_are_enough_of_them(self) -> None:
        assert len(SOLIDS) >= 12
        assert sum("splines" in name for name in SOLIDS) >= 3

    def test_occt_alone_errs_on_splines(self) -> None:
        """Why the integrals are our own: OCCT's default is off by more than 1e-3, silently."""
        found = occt("GProp").GProp_GProps()
        known = SOLIDS["cylinder as splines"]
        occt("BRepGProp").BRepGProp.VolumeProperties_s(known.make(), found)
        assert abs(found.Mass() / known.volume - 1.0) > 1e-3

    def test_a_solid_far_away_and_a_thin_one(self, tmp_path: Path) -> None:
        from cad_files import moved

        far = write_step(moved(primitive("Box", 1.0, 2.0, 3.0), 1e5, -2e5, 3e5)(), tmp_path / "far.step")
        body = RigidBody.from_file(far, density=1.0)
        np.testing.assert_allclose(np.diag(body.inertia), np.array([6.5, 5.0, 2.5]) * MM**5, rtol=1e-9)
        assert (
            np.abs(np.diag(body.inertia) - np.array([6.5, 5.0, 2.5]) * MM**5).max()
            <= body.error_bound.inertia
        )
        thin = write_step(primitive("Box", 1000.0, 1000.0, 0.01)(), tmp_path / "thin.step")
        assert RigidBody.from_file(thin, density=1.0).mass == pytest.approx(1e4 * MM**3, rel=1e-9)


class TestUnits:
    @pytest.mark.parametrize(
        ("unit", "name"), [("MM", "mm"), ("INCH", "in"), ("M", "m"), ("CM", "cm"), ("FT", "ft")]
    )
    def test_of_the_file(self, unit: str, name: str, tmp_path: Path) -> None:
        path = write_step(primitive("Box", 10.0, 20.0, 30.0)(), tmp_path / "part.stp", unit)
        assert load(path).unit == name
        assert RigidBody.from_file(path, density=2.0).mass == pytest.approx(2 * 6e-6, rel=1e-11)
        code, out, _ = run("report", str(path), "--density", "2700", "--format", "json")
        told = json.loads(out)
        assert (code, told["length_unit"]) == (0, name)
        assert told["mass"] == pytest.approx(2700 * 6e-6, rel=1e-11)
        assert RigidBody.from_file(path, density=2.0, length_unit=name).mass == pytest.approx(12e-6)
        assert solid_from_file(path, density=2.0).body.mass == pytest.approx(12e-6)

    def test_one_without_a_name_here(self, tmp_path: Path) -> None:
        path = write_step(primitive("Box", 10.0, 20.0, 30.0)(), tmp_path / "part.stp", "MIL")
        loaded = load(path)
        assert loaded.unit == "m"
        (note,) = loaded.notes
        assert "lengths are in: mil; each was read in its own unit, and all are told in m" in note
        assert RigidBody.from_file(path, density=2.0).mass == pytest.approx(12e-6, rel=1e-9)

    def test_another_one_is_refused(self, tmp_path: Path) -> None:
        path = write_step(primitive("Sphere", 10.0)(), tmp_path / "part.step", "INCH")
        with pytest.raises(
            PolhodeError, match=r"says itself that its unit is 'in', not 'mm'; leave length_unit out"
        ):
            RigidBody.from_file(path, density=1.0, length_unit="mm")
        with pytest.raises(PolhodeError, match=r"scale: .* leave it out"):
            solid_from_file(path, density=1.0, scale=1.0)
        code, _, err = run("report", str(path), "--density", "1", "--length-unit", "mm")
        assert code == 2
        assert one_line(err)
        assert "leave --length-unit out" in err
        assert run("report", str(path), "--density", "1")[0] == 0


class TestAssemblies:
    def test_parts_at_their_places(self, tmp_path: Path) -> None:
        body = RigidBody.from_file(write_assembly(tmp_path / "thing.step", {}), density=1000.0)
        block = solids.box((0.01, 0.02, 0.03), density=1000.0)
        ball = solids.sphere(0.005, density=1000.0)
        turned = block.rotated([0.0, 0.0, np.sin(np.pi / 4), np.cos(np.pi / 4)])
        whole = (
            block.translated((0.005, 0.01, 0.015))
            + ball.translated((0.05, 0.0, 0.0))
            + ball.translated((0.0, 0.07, 0.0))
            + turned.translated((-0.01, 0.005, 0.105))
        )
        assert body.mass == pytest.approx(whole.mass, rel=1e-13)
        np.testing.assert_allclose(body.center_of_mass, whole.center_of_mass, rtol=1e-12)
        np.testing.assert_allclose(body.inertia, whole.inertia, atol=1e-12 * whole.inertia.max())

    def test_names_and_materials(self, tmp_path: Path) -> None:
        path = write_assembly(tmp_path / "thing.step", {"block": 7.85, "ball": 2.7})
        solid = solid_from_file(path)
        assert [part.name for part in solid.parts] == ["block", "ball", "ball", "block"]
        assert [part.material for part in solid.parts][:2] == ["stuff of block", "stuff of ball"]
        ball = 4 / 3 * np.pi * 0.005**3
        assert solid.body.mass == pytest.approx(2 * 7850 * 6e-6 + 2 * 2700 * ball, rel=1e-12)
        assert RigidBody.from_file(path, density=1.0).mass == pytest.approx(12e-6 + 2 * ball, rel=1e-12)
        code, out, _ = run("report", str(path))
        assert code == 0
        assert "stuff of block" in out
        assert "density 1 was used" not in out
        # A mass is shared out as the materials say.
        by_mass = solid_from_file(path, mass=3.0)
        shares = np.array([part.body.mass for part in by_mass.parts])
        np.testing.assert_allclose(
            shares / shares.sum(), [p.body.mass / solid.body.mass for p in solid.parts]
        )
        assert by_mass.body.mass == pytest.approx(3.0)

    def test_the_unit_of_a_density(self, tmp_path: Path) -> None:
        """OCCT passes over the prefix of kg, and writes g/cm^3 with the wrong powers; both are told apart."""
        path = write_assembly(tmp_path / "thing.step", {"block": 7.85, "ball": 2.7})
        text = path.read_text()
        right = text.replace("$,.GRAM.", ".KILO.,.GRAM.").replace(".CENTI.,.METRE.", "$,.METRE.")
        right = re.sub(r"(DERIVED_UNIT_ELEMENT\(#\d+),3\.\)", r"\1,1.)", right)
        right = re.sub(r"(DERIVED_UNIT_ELEMENT\(#\d+),2\.\)", r"\1,-3.)", right)
        right = right.replace("MEASURE(7.85)", "MEASURE(7850.)").replace("MEASURE(2.7)", "MEASURE(2700.)")
        assert right.count(",-3.)") >= 1
        path.write_text(right)
        cad = load(path).cad
        assert cad is not None
        assert {part.density for part in cad.parts} == {7850.0, 2700.0}
        path.write_text(right.replace(",-3.)", ",-2.)"))
        loaded = load(path)
        assert loaded.cad is not None
        assert {part.density for part in loaded.cad.parts} == {None}
        assert any("units that are not understood" in note for note in loaded.notes)

    def test_a_part_without_density_is_named(self, tmp_path: Path) -> None:
        path = write_assembly(tmp_path / "thing.step", {"block": 7.85})
        with pytest.raises(PolhodeError, match="'ball' has no density in the file; give one"):
            RigidBody.from_file(path)
        assert "density 1 was used" in run("report", str(path))[1]

    def test_sigmas_go_through(self, tmp_path: Path) -> None:
        path = write_step(primitive("Sphere", 10.0)(), tmp_path / "part.step")
        body = RigidBody.from_file(path, mass=Uncertain(2.0, 0.1))
        assert body.mass == pytest.approx(2.0)
        assert body.sigma is not None
        assert body.sigma.mass == pytest.approx(0.1)


class TestRefusals:
    def refused(self, path: Path, *says: str, error: type[PolhodeError] = FileFormatError) -> None:
        with pytest.raises(error) as caught:
            RigidBody.from_file(path, density=1.0)
        assert [text for text in says if text not in str(caught.value)] == []

    def test_surfaces_without_a_solid(self, tmp_path: Path) -> None:
        gp, api = occt("gp"), occt("BRepBuilderAPI")
        face = api.BRepBuilderAPI_MakeFace(gp.gp_Pln(), 0.0, 1.0, 0.0, 1.0).Face()
        path = write_step(face, tmp_path / "part.step")
        self.refused(path, "holds no solid (1 faces bound none)", "export solids")

    def test_cut_short_and_damaged(self, tmp_path: Path) -> None:
        path = write_step(primitive("Sphere", 10.0)(), tmp_path / "part.step")
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
        self.refused(path, "cut short")
        path.write_bytes(b"solid part\n")
        self.refused(path, "part.step")
        path.write_bytes(whole[:2000] + b"END-ISO-10303-21;\n")
        self.refused(path, "part.step")

    def test_an_open_solid(self, tmp_path: Path) -> None:
        builder, shapes = occt("BRep").BRep_Builder(), occt("TopoDS")
        box = primitive("Box", 1.0, 2.0, 3.0)()
        faces = occt("TopExp").TopExp_Explorer(box, occt("TopAbs").TopAbs_ShapeEnum.TopAbs_FACE)
        shell, solid = shapes.TopoDS_Shell(), shapes.TopoDS_Solid()
        builder.MakeShell(shell)
        builder.MakeSolid(solid)
        for _ in range(5):
            builder.Add(shell, faces.Current())
            faces.Next()
        builder.Add(solid, shell)
        path = write_step(solid, tmp_path / "part.step")
        with pytest.raises((MeshError, FileFormatError), match=r"is open: 4 edges|holds no solid"):
            RigidBody.from_file(path, density=1.0)

    @pytest.mark.parametrize(("error", "is_taken"), [(0.9e-3, True), (1.1e-3, False)])
    def test_a_volume_that_is_hardly_known(
        self, error: float, is_taken: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        path = write_step(primitive("Box", 1.0, 1.0, 1.0)(), tmp_path / "part.step")

        def worse(*given: Any) -> Any:
            return moments_of_faces(*given)._replace(error=error)

        monkeypatch.setattr(cad_files, "moments_of_faces", worse)
        if is_taken:
            assert RigidBody.from_file(path, density=1.0).error_bound.mass == pytest.approx(error * MM**3)
        else:
            self.refused(path, "is known to 0.11 % alone; heal it in CAD", error=MeshError)

    def test_what_only_a_mesh_has(self, tmp_path: Path) -> None:
        path = write_step(primitive("Sphere", 10.0)(), tmp_path / "part.step")
        with pytest.raises(PolhodeError, match=r"orient: .* holds solids, not a mesh; leave it out"):
            RigidBody.from_file(path, density=1.0, orient=True)
        code, _, err = run("report", str(path), "--density", "1", "--repair")
        assert code == 2
        assert err.startswith("polhode: --repair: ")
        with pytest.raises(FileFormatError, match="solids with curved faces, not triangles"):
            read_mesh(path)
        with pytest.raises(FileFormatError, match="holds solids, not atoms"):
            _ = load(path).molecule

    def test_a_packed_one(self, tmp_path: Path) -> None:
        path = write_step(primitive("Box", 10.0, 20.0, 30.0)(), tmp_path / "part.step")
        packed = tmp_path / "part.step.gz"
        packed.write_bytes(gzip.compress(path.read_bytes()))
        assert RigidBody.from_file(packed, density=1.0).mass == pytest.approx(6e-6)


class TestApart:
    """OCCT ends the process on some damaged files: it has one of its own."""

    def test_it_is_read_and_refused_alike(self, tmp_path: Path) -> None:
        path = write_assembly(tmp_path / "thing.step", {"block": 7.85, "ball": 2.7})
        whole = solid_from_file(path)
        assert whole.body == solids_of(read_cad(path))[0]
        assert [part.material for part in whole.parts][:2] == ["stuff of block", "stuff of ball"]
        path.write_bytes(path.read_bytes()[:2000])
        with pytest.raises(FileFormatError, match=r"thing\.step: .* cut short"):
            load(path)

    def test_in_an_assembly_of_parts(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        # One process for each file, which takes a second to start; who reads it again gets the same answer.
        monkeypatch.setattr("polhode.io.cad_process.read_cad_apart", cache(cad_process.read_cad_apart))
        path = write_assembly(tmp_path / "thing.step", {"block": 7.85, "ball": 2.7})
        whole = solid_from_file(path)
        table = {"length_unit": "in", "part": [{"name": "a", "file": path.name}]}
        made = assembly.read(table, folder=tmp_path)
        assert made.body.mass == pytest.approx(float(whole.body.mass), rel=1e-14)
        code, out, _ = run("report", str(path))
        assert code == 0
        assert "counts twice" not in out
        plain = write_step(primitive("Sphere", 10.0)(), tmp_path / "part.step")
        table = {"part": [{"name": "a", "file": plain.name}]}
        with pytest.raises(PolhodeError, match=r"part\.step needs its mass or its density"):
            assembly.read(table, folder=tmp_path)

    def test_a_break_down_is_an_error(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        path = write_step(primitive("Sphere", 10.0)(), tmp_path / "part.step")
        monkeypatch.setattr(cad_process, "_COMMAND", ["-c", "import os; os.kill(os.getpid(), 11)"])
        with pytest.raises(FileFormatError, match=r"part\.step: OCCT broke down on it \(exit code -11\)"):
            load(path)

    def test_within_another_program(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        path = write_step(primitive("Sphere", 10.0)(), tmp_path / "part.step")
        monkeypatch.setattr(cad_process, "_COMMAND", ["-c", "raise SystemExit(1)"])
        monkeypatch.setattr(sys, "executable", "")
        assert load(path).format == "STEP"


class TestIges:
    def write(self, shape: Any, path: Path, mode: int) -> Path:
        iges = occt("IGESControl")
        iges.IGESControl_Controller.Init_s()
        writer = iges.IGESControl_Writer("IN", mode)
        writer.AddShape(shape)
        writer.ComputeModel()
        assert writer.Write(str(path))
        return path

    def test_a_solid(self, tmp_path: Path) -> None:
        path = self.write(primitive("Cylinder", 10.0, 20.0)(), tmp_path / "part.igs", 1)
        loaded = load(path)
        assert (loaded.format, loaded.unit) == ("IGES", "in")
        body = RigidBody.from_file(path, density=1.0)
        assert body.mass == pytest.approx(np.pi * 100 * 20 * MM**3, rel=1e-8)
        assert abs(body.mass - np.pi * 2000 * MM**3) <= body.error_bound.mass

    def test_surfaces_are_refused(self, tmp_path: Path) -> None:
        path = self.write(primitive("Cylinder", 10.0, 20.0)(), tmp_path / "part.igs", 0)
        with pytest.raises(FileFormatError, match=r"holds no solid .*; export STEP"):
            RigidBody.from_file(path, density=1.0)
