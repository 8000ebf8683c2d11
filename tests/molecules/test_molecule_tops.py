"""Class of a molecule's top by the digits of its file, and whose masses its atoms have."""

from __future__ import annotations

import json
import pickle
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run
from hypothesis import given
from hypothesis import strategies as st
from oracles.bodies import matrix
from polhode import RigidBody
from polhode.errors import FileFormatError, PolhodeError
from polhode.io import read_xyz
from polhode.molecules import inertial_defect, isotopes, planar_moments, rotational_constants

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])


def around(count: int, radius: float, height: float = 0.0, phase: float = 0.0) -> Floats:
    """A regular polygon across z."""
    angle = phase + 2.0 * np.pi * np.arange(count) / count
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, height)], axis=-1)


def tetrahedron(radius: float) -> Floats:
    corners: Floats = np.array([(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)])
    corners *= radius / 3.0**0.5
    return corners


def along(*heights: float) -> Floats:
    return np.outer(heights, UP)


# Bond lengths in angstrom and angles of known molecules, as textbooks of spectroscopy give them.
MOLECULES: dict[str, tuple[str, list[Floats], str]] = {
    "CH4": ("C H H H H", [along(0), tetrahedron(1.087)], "spherical"),
    "CCl4": ("C Cl Cl Cl Cl", [along(0), tetrahedron(1.767)], "spherical"),
    "SF6": ("S F F F F F F", [along(0), 1.561 * np.eye(3), -1.561 * np.eye(3)], "spherical"),
    "C6H6": ("C C C C C C H H H H H H", [around(6, 1.3915), around(6, 2.4715)], "oblate"),
    "BF3": ("B F F F", [along(0), around(3, 1.307)], "oblate"),
    "NH3": ("N H H H", [along(0.3816), around(3, 0.9377)], "oblate"),
    "PH3": ("P H H H", [along(0.7712), around(3, 1.1932)], "oblate"),
    "CHCl3": ("C H Cl Cl Cl", [along(0.0, 1.1), around(3, 1.6756, -0.552)], "oblate"),
    "CH3F": ("C F H H H", [along(0.0, 1.383), around(3, 1.0297, -0.3475)], "prolate"),
    "C2H6": (
        "C C H H H H H H",
        [along(0.7668, -0.7668), around(3, 1.0195, 1.161), around(3, 1.0195, -1.161, np.pi)],
        "prolate",
    ),
    "CH3CCH": ("C C C H H H H", [along(-1.458, 0.0, 1.206, 2.262), around(3, 1.0385, -1.836)], "prolate"),
    "CO2": ("O C O", [along(-1.16, 0.0, 1.16)], "linear"),
    "C2H2": ("H C C H", [along(-1.664, -0.6015, 0.6015, 1.664)], "linear"),
    "HC5N": ("H C C C C C N", [along(-1.06, 0.0, 1.21, 2.58, 3.79, 5.17, 6.33)], "linear"),
}

# Asymmetric, most of them very nearly prolate.
ASYMMETRIC: dict[str, tuple[str, list[Floats]]] = {
    "H2O": ("O H H", [np.array([(0, 0, 0.06556), (0.75721, 0, -0.52032), (-0.75721, 0, -0.52032)])]),
    "HNCO": ("H N C O", [np.array([(0.944, -1.7, 0), (0, -1.215, 0), (0, 0, 0), (0.16, 1.152, 0)])]),
    "HNCS": ("H N C S", [np.array([(0.87, -1.64, 0), (0, -1.216, 0), (0, 0, 0), (0.05, 1.561, 0)])]),
    "H2CCO": (
        "C C O H H",
        [along(-1.3165, 0.0, 1.1612), np.array([(0.9446, 0, -1.8401), (-0.9446, 0, -1.8401)])],
    ),
    "CH2DF": ("C F H H D", [along(0.0, 1.383), around(3, 1.0297, -0.3475)]),
}


def printed(path: Path, labels: str, points: list[Floats], decimals: int, rng: np.random.Generator) -> Path:
    """Write a molecule in some attitude, its coordinates rounded."""
    q = rng.normal(size=4)
    placed = np.concatenate(points) @ matrix(q / np.linalg.norm(q)).T + rng.uniform(-1.0, 1.0, 3)
    rows = [
        f"{label} " + " ".join(f"{x:.{decimals}f}" for x in row)
        for label, row in zip(labels.split(), placed, strict=True)
    ]
    path.write_text(f"{len(rows)}\n\n" + "\n".join(rows) + "\n")
    return path


class TestKnownMolecules:
    @pytest.mark.parametrize("decimals", [2, 3, 4, 5, 9])
    @pytest.mark.parametrize("name", MOLECULES)
    def test_symmetric_ones_stay_so(
        self, name: str, decimals: int, rng: np.random.Generator, tmp_path: Path
    ) -> None:
        labels, points, top = MOLECULES[name]
        for _ in range(5):
            path = printed(tmp_path / "molecule.xyz", labels, points, decimals, rng)
            assert RigidBody.from_file(path).principal.top == top
            assert RigidBody.from_file(path, length_unit="angstrom").principal.top == top

    @pytest.mark.parametrize("decimals", [3, 4, 9])
    @pytest.mark.parametrize("name", ASYMMETRIC)
    def test_asymmetric_ones_stay_so(
        self, name: str, decimals: int, rng: np.random.Generator, tmp_path: Path
    ) -> None:
        labels, points = ASYMMETRIC[name]
        masses = np.array([isotope.mass for isotope in isotopes(labels.split())])
        exact = np.concatenate(points) - masses @ np.concatenate(points) / masses.sum()
        spread = np.linalg.eigvalsh(exact.T @ (exact * masses[:, np.newaxis]))
        gap = np.diff(spread).min() / (spread[1] + spread[2])
        assert gap > 0.003
        for _ in range(20):
            path = printed(tmp_path / "molecule.xyz", labels, points, decimals, rng)
            principal = RigidBody.from_file(path).principal
            assert principal.top == "asymmetric"
            assert principal.gaps.min() == pytest.approx(gap, rel=0.1)

    def test_water_of_two_decimals_is_asymmetric_too(self, rng: np.random.Generator, tmp_path: Path) -> None:
        for _ in range(20):
            path = printed(tmp_path / "h2o.xyz", *ASYMMETRIC["H2O"], 2, rng)
            assert RigidBody.from_file(path).principal.top == "asymmetric"


class TestTheBound:
    """What rounding by h can make of equal moments, against displacements sought to be the worst."""

    @given(seed=st.integers(0, 10**9))
    def test_no_displacement_makes_more(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        kind = int(rng.integers(4))
        masses, points = symmetric_particles(kind, rng)
        h = 10.0 ** rng.uniform(-6.0, -0.7)
        q = rng.normal(size=4)
        points = points @ matrix(q / np.linalg.norm(q)).T
        for moved in worst_displacements(masses, points, h, kind, rng):
            body = RigidBody.from_particles(masses, moved)._of_atoms("own", h)
            expected = ("linear", "prolate", "oblate", "spherical")[kind]
            principal = body.principal
            zero, lower, upper = principal.top_rtol
            below = principal.moments[0] / principal.moments[2]
            if kind == 0:
                assert below <= zero
            if kind in (0, 1, 3):
                assert principal.gaps[1] <= upper
            if kind in (2, 3):
                assert principal.gaps[0] <= lower
            # The class is the one of the symmetric body, or a more symmetric one where h is as large as that.
            if max(lower, upper) < 0.02 and h < 1e-3:
                assert principal.top == expected

    @given(seed=st.integers(0, 10**9))
    def test_it_is_the_documented_one(self, seed: int) -> None:
        """δ = √3 h; o_k = δ √(M I_k) + M δ²/2; 2 o + √(x² + o'²) − x of each pair, and M δ² for zero."""
        rng = np.random.default_rng(seed)
        masses, points = rng.uniform(1.0, 20.0, 5), rng.normal(size=(5, 3)) * rng.uniform(0.3, 3.0, 3)
        h = 10.0 ** rng.uniform(-5.0, -1.0)
        body = RigidBody.from_particles(masses, points)._of_atoms("most_common", h)
        (i1, i2, i3), square = body.principal_moments, 3.0 * h * h * masses.sum()
        o1, o3 = (np.sqrt(square * moment) + square / 2 for moment in (i1, i3))
        x, y = (i3 - i2) / 2 - o1, (i2 - i1) / 2 - o3
        known = np.array([square, 2 * o3 + np.hypot(x, o1) - x, 2 * o1 + np.hypot(y, o3) - y]) / i3
        np.testing.assert_allclose(body.principal.top_rtol, np.maximum(known, 1e-6), rtol=1e-9)

    @pytest.mark.parametrize(("factor", "top"), [(0.99, "oblate"), (1.01, "asymmetric")])
    def test_both_sides_of_it(self, factor: float, top: str) -> None:
        """Six particles on the axes; the rounding at which a gap is just as large as it can make."""
        points = np.concatenate([np.diag([1.0, 1.01, 0.5]), -np.diag([1.0, 1.01, 0.5])])
        body = RigidBody.from_particles(np.ones(6), points)
        low, high = 1e-6, 1e-1
        for _ in range(60):
            h = np.sqrt(low * high)
            too_small = body._of_atoms("own", h).principal.top_rtol[1] < body.principal.gaps[0]
            low, high = (h, high) if too_small else (low, h)
        assert body._of_atoms("own", high / factor).principal.top == top
        assert body.principal.top == "asymmetric"

    def test_it_goes_with_the_body(self, rng: np.random.Generator) -> None:
        labels, points, _ = MOLECULES["CH4"]
        masses = [isotope.mass for isotope in isotopes(labels.split())]
        body = RigidBody.from_particles(masses, np.round(np.concatenate(points) @ turn(rng).T, 3))
        body = body._of_atoms("most_common", 5e-4)
        assert body.provenance.rounding == 5e-4
        for other in (
            pickle.loads(pickle.dumps(body)),
            body.translated((1.0, 2.0, 3.0)),
            body.rotated(turn(rng)),
            body.scaled(length=1e-10, mass=1.66e-27),
        ):
            assert other.principal.top == "spherical"
            np.testing.assert_allclose(other.principal.top_rtol, body.principal.top_rtol, rtol=1e-6)
        assert body.scaled(length=2.0).provenance.rounding == 1e-3
        far = body.translated((50.0, 0.0, 0.0))
        assert far.principal_about("origin").top == "prolate"
        stack = RigidBody.stack([body, RigidBody.from_particles(masses, np.concatenate(points))])
        assert stack.principal.top.tolist() == ["spherical", "spherical"]
        assert stack.principal.top_rtol.shape == (2, 3)
        assert (stack.principal.top_rtol[1] == 1e-6).all()
        assert stack.principal.classify(1e-9).tolist()[0] == "asymmetric"

    def test_bodies_saved_before_it_was_kept_are_read(self) -> None:
        body = RigidBody.from_particles([1.0, 2.0, 3.0], np.eye(3))
        numbers = np.asarray(body.__reduce__()[1][0])
        assert RigidBody._from_numbers(numbers[:33]) == body
        assert RigidBody._from_numbers(np.stack([numbers, numbers])[:, :33]).shape == (2,)
        with pytest.raises(ValueError, match=r"expected shape \(\.\.\., 34\), got \(32,\)"):
            RigidBody._from_numbers(numbers[:32])

    def test_a_tolerance_may_be_one_or_three(self) -> None:
        principal = RigidBody.from_principal(1.0, (0.01, 1.0, 1.005)).principal
        assert principal.top_rtol == 1e-6
        assert principal.classify((0.02, 0.0, 0.01)) == "linear"
        assert principal.classify((0.0, 0.0, 0.01)) == "prolate"
        assert principal.classify(0.006) == "prolate"
        assert principal.classify(0.01) == "linear"
        with pytest.raises(ValueError, match="rtol: expected zero or more, got -1"):
            principal.classify((0.0, -1.0, 0.0))
        with pytest.raises(ValueError, match=r"rtol: expected shape \(\.\.\., 3\)"):
            principal.classify((0.0, 1.0))


def turn(rng: np.random.Generator) -> Floats:
    q = rng.normal(size=4)
    return matrix(q / np.linalg.norm(q))


def symmetric_particles(kind: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """A straight line, a long or a flat top about z, or a ball-like arrangement."""
    if kind == 0:
        count = int(rng.integers(2, 7))
        return rng.uniform(1.0, 30.0, count), along(*rng.normal(size=count) * 2.0)
    if kind == 3:
        outer = rng.uniform(0.5, 3.0)
        mass = rng.uniform(1.0, 30.0, 2)
        return np.repeat(mass, [1, 4]), np.concatenate([along(0.0), tetrahedron(outer)])
    count, heavy, light = int(rng.integers(3, 7)), rng.uniform(10.0, 30.0), rng.uniform(1.0, 3.0)
    if kind == 1:
        ring, height, masses = (
            around(count, rng.uniform(0.5, 1.0)),
            rng.uniform(2.0, 4.0),
            (light, heavy, heavy),
        )
    else:
        ring, height, masses = (
            around(count, rng.uniform(1.0, 3.0)),
            rng.uniform(0.0, 0.3),
            (heavy, light, light),
        )
    return np.repeat(masses, [count, 1, 1]), np.concatenate([ring, along(height, -height)])


def worst_displacements(
    masses: Floats, points: Floats, h: float, kind: int, rng: np.random.Generator
) -> list[Floats]:
    """Displaced points, each coordinate by h at most: at random, and so that a gap is the widest."""

    def spread(moved: Floats) -> Floats:
        center = masses @ moved / masses.sum()
        values = np.linalg.eigvalsh((moved - center).T @ ((moved - center) * masses[:, np.newaxis]))
        gaps: Floats = np.array([values[0] + values[1], values[2] - values[1], values[1] - values[0]])
        return gaps

    found = [points + rng.uniform(-h, h, points.shape)]
    # Second moments ascend where moments of inertia descend: the upper pair of one is the lower of the other.
    for aim in ({0}, {2}, {1}, {1, 2})[kind]:
        signs = rng.choice([-1.0, 1.0], points.shape)
        best = spread(points + h * signs)[aim]
        for index in np.ndindex(*points.shape):
            signs[index] *= -1.0
            widened = spread(points + h * signs)[aim]
            if widened > best:
                best = widened
            else:
                signs[index] *= -1.0
        found.append(points + h * signs)
    return found


class TestTheDigits:
    @pytest.mark.parametrize(
        ("words", "rounding"),
        [
            ("0.000 1.160 -1.160", 5e-4),
            ("0 0.1 -0.76", 5e-3),  # zeros cut off at the end
            ("1 2 -3", 0.0),
            ("12.3457 0.626998 -1.2", 5e-5),  # six digits, zeros cut off
            ("1.234e+00 5.678e-03 0.000e+00", 5e-4),
            ("12.345 0.123 1.200", 5e-4),
            ("0.30000000000000004 1.2000000000000002 6.1e-17", 5e-21),
            ("0.5 0.5 1E2", 5e-2),
        ],
    )
    def test_half_a_unit_of_the_last(self, words: str, rounding: float, tmp_path: Path) -> None:
        path = tmp_path / "a.xyz"
        path.write_text(f"1\n\nO {words}\n")
        molecule = read_xyz(path)
        assert molecule.rounding == pytest.approx(rounding, rel=1e-12)
        np.testing.assert_array_equal(molecule.positions, [[float(word) for word in words.split()]])

    @pytest.mark.parametrize(
        "word", ["snan", "nan", "-inf", "1e999", "1e-99999999999999999999", "1,0", "0x1"]
    )
    def test_what_is_no_coordinate(self, word: str, tmp_path: Path) -> None:
        path = tmp_path / "a.xyz"
        path.write_text(f"1\n\nO 0.0 {word} 0.0\n")
        with pytest.raises(FileFormatError, match=r"a\.xyz: line 3: expected 'symbol x y z'"):
            read_xyz(path)

    @pytest.mark.parametrize("word", ["1e-300", "5e-324", "1e-400000", "0e-999999", "1e308"])
    def test_numbers_at_the_ends_of_the_range(self, word: str, tmp_path: Path) -> None:
        path = tmp_path / "a.xyz"
        path.write_text(f"1\n\nO 1.25 {word} 0.50\n")
        molecule = read_xyz(path)
        assert molecule.positions[0, 1] == float(word)
        assert np.isfinite(molecule.rounding)

    def test_any_form_of_a_file_s_numbers(self, rng: np.random.Generator, tmp_path: Path) -> None:
        """Its digits tell at least the rounding there was, and at most ten times as much."""
        for _ in range(50):
            count, decimals = int(rng.integers(2, 12)), int(rng.integers(2, 9))
            values = rng.normal(size=(count, 3)) * 3.0
            for form, unit in ((f".{decimals}f", -decimals), (f".{decimals}e", None)):
                rows = [[format(x, form) for x in row] for row in values]
                path = tmp_path / "a.xyz"
                path.write_text(f"{count}\n\n" + "\n".join("O " + " ".join(row) for row in rows) + "\n")
                places = np.floor(np.log10(np.abs(values))).max() - decimals if unit is None else unit
                assert read_xyz(path).rounding == pytest.approx(0.5 * 10.0**places, rel=1e-9)


class TestTheCommand:
    def report(self, *arguments: Any) -> dict[str, Any]:
        code, out, err = run("molecule", *arguments, "--format", "json")
        assert (code, err) == (0, "")
        found: dict[str, Any] = json.loads(out)
        return found

    def test_it_tells_the_tolerance_and_why(self, rng: np.random.Generator, tmp_path: Path) -> None:
        path = printed(tmp_path / "ch4.xyz", *MOLECULES["CH4"][:2], 3, rng)
        report = self.report(path)
        assert report["top"] == "spherical"
        assert report["top_rtol"] == RigidBody.from_file(path).principal.top_rtol.tolist()
        assert "rounding of the coordinates by 0.0005 angstrom" in report["top_rtol_from"]
        assert "ray_kappa" not in report
        strict = self.report(path, "--rtol", "1e-6")
        assert (strict["top"], strict["top_rtol"]) == ("asymmetric", [1e-6, 1e-6, 1e-6])
        assert strict["top_rtol_from"] == "as --rtol says"
        exact = self.report(printed(tmp_path / "fine.xyz", *MOLECULES["CH4"][:2], 9, rng))
        assert exact["top_rtol"] == [1e-6, 1e-6, 1e-6]
        assert "the file has enough digits" in exact["top_rtol_from"]
        (tmp_path / "whole.xyz").write_text("2\n\nO 0 0 0\nO 0 0 1\n")
        assert (
            "the coordinates in the file have no decimals"
            in self.report(tmp_path / "whole.xyz")["top_rtol_from"]
        )
        for command in ("report", "spin"):
            words = ("--omega", 0, 0, 1) if command == "spin" else ()
            told = json.loads(run(command, path, *words, "--format", "json")[1])
            assert (told["top"], told["top_rtol"]) == (report["top"], report["top_rtol"])
        assert run("molecule", path, "--rtol", "-1")[0] == 2

    @pytest.mark.parametrize("decimals", [2, 3, 4])
    @pytest.mark.parametrize("name", ["CO2", "C2H2", "HC5N"])
    def test_a_linear_molecule_has_no_inertial_defect(
        self, name: str, decimals: int, rng: np.random.Generator, tmp_path: Path
    ) -> None:
        """By its last digits it is bent. Yet Ia = 0, and Ib = Ic is the sum over its atoms along the axis."""
        labels, points, _ = MOLECULES[name]
        masses = np.array([isotope.mass for isotope in isotopes(labels.split())])
        heights = np.concatenate(points)[:, 2]
        exact = masses @ (heights - masses @ heights / masses.sum()) ** 2
        for _ in range(8):
            path = printed(tmp_path / "linear.xyz", labels, points, decimals, rng)
            report = self.report(path)
            a, b, c = report["principal_moments"]
            assert (a, b) == (0.0, c)
            assert b == pytest.approx(exact, rel=10.0**-decimals)
            assert report["inertial_defect"] == 0.0
            assert report["planar_moments"] == [b, 0.0, 0.0]
            assert report["rotational_constants_MHz"][0] == "Infinity"
            bent = RigidBody.from_file(path).principal_moments
            assert bent[0] > 0.0
            assert any("not quite straight" in note for note in report["notes"])
            assert b == pytest.approx(planar_moments(bent)[0], rel=1e-14)

    def test_the_defect_is_never_positive(self, rng: np.random.Generator, tmp_path: Path) -> None:
        for labels, points in [(one[0], one[1]) for one in MOLECULES.values()] + list(ASYMMETRIC.values()):
            for decimals in (3, 6):
                path = printed(tmp_path / "any.xyz", labels, points, decimals, rng)
                moments = RigidBody.from_file(path).principal_moments
                assert inertial_defect(moments) <= 4.0 * np.finfo(float).eps * moments[2]
                assert (planar_moments(moments) >= -4.0 * np.finfo(float).eps * moments[2]).all()


# Whose masses a molecule's atoms have.


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
