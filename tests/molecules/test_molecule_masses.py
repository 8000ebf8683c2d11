"""Whose masses a molecule's atoms have."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from command_line import run
from polhode import RigidBody
from polhode.errors import PolhodeError
from polhode.molecules import isotopes, rotational_constants

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


class TestMasses:
    """Chlorine: the average is that of 3/4 35Cl and 1/4 37Cl, which no molecule Cl2 has."""

    CL2 = "2\n\nCl 0.000 0.000 0.000\nCl 0.000 0.000 1.988\n"

    def test_whose_they_are(self, tmp_path: Path) -> None:
        path = tmp_path / "cl2.xyz"
        path.write_text(self.CL2)
        common, average = RigidBody.from_file(path), RigidBody.from_file(path, masses="average")
        assert str(common.provenance).startswith("2 atoms, most common isotopes; ")
        assert str(average.provenance).startswith("2 atoms, average masses; ")
        assert "coordinates to 0.0005 by their digits" in str(common.provenance)
        low, high = (rotational_constants(body.principal_moments)[1] for body in (average, common))
        # 34.968852694 u (Atomic Mass Evaluation 2020) and 35.45 u (IUPAC's standard atomic weight).
        assert low / high == pytest.approx(34.968852694 / 35.45, rel=1e-4)
        assert 1.0 - low / high == pytest.approx(0.0136, abs=1e-4)

    def test_on_the_command_line(self, tmp_path: Path) -> None:
        path = tmp_path / "cl2.xyz"
        path.write_text(self.CL2)
        report = json.loads(run("molecule", path, "--masses", "average", "--format", "json")[1])
        assert report["isotopes"] == "2 Cl"
        assert report["mass"] == pytest.approx(70.9, abs=0.02)
        assert any("averages over the isotopes" in note for note in report["notes"])
        report = json.loads(run("molecule", path, "--format", "json")[1])
        assert report["isotopes"] == "2 35Cl"
        assert any("not averages" in note for note in report["notes"])
        assert "2 atoms, most common isotopes" in run("report", path)[1]

    def test_labels_of_isotopes_stand(self) -> None:
        names = [isotope.name for isotope in isotopes(["O", "18O", "D", "8"], "average")]
        assert names == ["O", "18O", "2H", "O"]
        with pytest.raises(ValueError, match="masses: expected 'most_common' or 'average', got 'mean'"):
            isotopes(["O"], "mean")  # type: ignore[arg-type]

    def test_a_mesh_has_none(self, tmp_path: Path) -> None:
        path = tmp_path / "a.obj"
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        with pytest.raises(PolhodeError, match=r"masses: .* is a mesh"):
            RigidBody.from_file(path, density=1.0, masses="average")
