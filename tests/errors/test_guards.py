"""Both sides of thresholds: what is still let through, and what a little more does."""

from __future__ import annotations

import struct
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, Trajectory, laminae, principal_axes, solids, tops
from polhode.errors import FileFormatError, InvalidInertiaError, MeshError, PolhodeError
from polhode.motion.invariants import drift

ULP = np.finfo(float).eps


class TestBounds:
    """They hold, and some case comes within a tenth of them: bounds ten times smaller would not hold."""

    def worst(self, kind: str) -> float:
        rng = np.random.default_rng(5)
        ratios = []
        for _ in range(1000):
            m, p = rng.random(3).tolist(), rng.random((3, 3)).tolist()
            exact = [Fraction(x) for x in m]
            points = [[Fraction(x) for x in point] for point in p]
            if kind == "box":
                body = solids.box(p[0], density=m[0])
                off = abs(Fraction(float(body.mass)) - exact[0] * points[0][0] * points[0][1] * points[0][2])
                ratios.append(off / Fraction(float(body.error_bound.mass)))
                continue
            body = RigidBody.from_particles(m, p)
            total = sum(exact, Fraction(0))
            weighted = [[x * q[k] for x, q in zip(exact, points, strict=True)] for k in range(3)]
            center = [sum(column, Fraction(0)) / total for column in weighted]
            if kind == "centre":
                offs = [abs(Fraction(float(body.center_of_mass[k])) - center[k]) for k in range(3)]
                ratios.append(max(offs) / Fraction(float(np.max(body.error_bound.center_of_mass))))
            else:
                parts = [
                    x * ((q[1] - center[1]) ** 2 + (q[2] - center[2]) ** 2)
                    for x, q in zip(exact, points, strict=True)
                ]
                moment = sum(parts, Fraction(0))
                off = abs(Fraction(float(body.inertia[0, 0])) - moment)
                ratios.append(off / Fraction(float(np.max(body.error_bound.inertia))))
        return float(max(ratios))

    @pytest.mark.parametrize("kind", ["box", "centre", "tensor"])
    def test_a_tenth_of_the_bound_would_not_hold(self, kind: str) -> None:
        assert 0.1 < self.worst(kind) <= 1.0


class TestTensors:
    @pytest.mark.parametrize(("times", "is_let"), [(0.9, True), (1.2, False), (3.9, False)])
    def test_asymmetry_of_rounding(self, times: float, is_let: bool) -> None:
        tensor = 2.0 * np.eye(3)
        tensor[0, 1] = times * 8 * ULP * 2.0
        if is_let:
            body = RigidBody(1.0, tensor)
            assert body.inertia[0, 1] == body.inertia[1, 0] == tensor[0, 1] / 2
        else:
            with pytest.raises(InvalidInertiaError, match="must be symmetric"):
                RigidBody(1.0, tensor)

    @pytest.mark.parametrize(
        ("gap", "lower", "upper"), [(0.9e-6, "oblate", "prolate"), (1.1e-6, *["asymmetric"] * 2)]
    )
    def test_equal_moments(self, gap: float, lower: str, upper: str) -> None:
        assert RigidBody.from_principal(1.0, (1.0, 1.0 + 2.0 * gap, 2.0)).principal.top == lower
        assert RigidBody.from_principal(1.0, (1.5, 2.0 - 2.0 * gap, 2.0)).principal.top == upper

    @pytest.mark.parametrize(("tilt", "decides"), [(0.9e-8, "x"), (1.1e-8, "z")])
    def test_the_direction_of_an_axis_across_its_own(self, tilt: float, decides: str) -> None:
        """A symmetry axis near the x-y plane, of an oblate body: to 1e-8 its largest component decides."""
        n = np.array([0.8, 0.6, -tilt])
        found = principal_axes(np.eye(3) + 0.5 * np.outer(n, n), canonical=True).axes
        toward = n if decides == "x" else -n
        between = np.array([toward[0], toward[1], 1.0 + toward[2]])
        first = np.eye(3)[0] - toward[0] / (1.0 + toward[2]) * between
        assert abs(found[:, 0] @ first) == pytest.approx(1.0, abs=1e-12)

    @pytest.mark.parametrize(("times", "is_let"), [(0.9, True), (1.2, False), (9.0, False)])
    def test_a_negative_moment_of_rounding(self, times: float, is_let: bool) -> None:
        """Of a tensor, 16 ε of the trace; of moments, 16 ε of the largest."""
        small = -times * 16 * ULP
        makers: list[Callable[[], RigidBody]] = [
            lambda: RigidBody(1.0, np.diag([2.0 * small, 1.0, 1.0])),
            lambda: RigidBody.from_principal(1.0, (small, 1.0, 1.0)),
        ]
        for make in makers:
            if is_let:
                assert make().principal_moments.tolist() == [0.0, 1.0, 1.0]
            else:
                with pytest.raises(InvalidInertiaError, match="no negative principal moment"):
                    make()

    def test_equal_moments_of_a_derivative_without_a_tolerance(self) -> None:
        tangent = np.eye(3)[[1, 0, 2]]
        equal, apart = (principal_axes(np.diag([1.0, 1.0 + gap, 2.0])) for gap in (0.0, ULP))
        assert equal.derivative(tangent, rtol=0.0).degenerate.tolist() == [True, False, False]
        assert np.isfinite(equal.derivative(tangent, rtol=0.0).axes).all()
        assert apart.derivative(tangent, rtol=0.0).degenerate.tolist() == [False, False, False]
        assert apart.derivative(tangent).degenerate.tolist() == [True, False, False]

    @pytest.mark.parametrize(("times", "is_let"), [(0.9, True), (1.2, False)])
    def test_rounding_of_a_torque_along_a_rod(self, times: float, is_let: bool) -> None:
        rod, torque = RigidBody.from_principal(1.0, (0.0, 1.0, 1.0)), (times * 16 * ULP, 0.0, 1.0)
        if is_let:
            assert rod.angular_acceleration((0.0, 0.0, 0.0), torque).tolist() == [0.0, 0.0, 1.0]
        else:
            with pytest.raises(InvalidInertiaError, match="moment of inertia is zero"):
                rod.angular_acceleration((0.0, 0.0, 0.0), torque)


class TestPolygons:
    @pytest.mark.parametrize("y", [1e-12, 0.0, 1e-300])
    def test_a_corner_that_touches_an_edge(self, y: float) -> None:
        found = laminae.polygon([(0, 0), (2, 0), (2, 2), (1, y), (0, 2)], density=1.0)
        assert found.mass == pytest.approx(2.0, rel=1e-11)

    def test_a_corner_beyond_an_edge(self) -> None:
        with pytest.raises(PolhodeError, match="the edge from vertex 0 crosses the edge from vertex"):
            laminae.polygon([(0, 0), (2, 0), (2, 2), (1, -1e-12), (0, 2)], mass=1.0)

    def test_a_corner_on_an_edge_whose_products_round(self) -> None:
        """On y = 3 x exactly, differences longer than a float: what their products leave is no side."""
        rng = np.random.default_rng(3)
        for _ in range(200):
            lengths = sorted(rng.integers(1, 2**51, 3).tolist(), key=int)
            scales = np.sort(rng.integers(-60, 0, 3)).tolist()
            (p, c, q) = (length * 2.0 ** (scale - 51) for length, scale in zip(lengths, scales, strict=True))
            corners = [(p, 3 * p), (q, 3 * q), (-2 * q, 4 * q), (c, 3 * c), (-2 * p, 4 * p)]
            exact = [(Fraction(x), Fraction(y)) for x, y in corners]
            assert p < c < q
            assert all(exact[k][1] == 3 * exact[k][0] for k in (0, 1, 3))
            pairs = zip(exact, [*exact[1:], exact[0]], strict=True)
            area = sum((a[0] * b[1] - a[1] * b[0] for a, b in pairs), Fraction(0)) / 2
            found = laminae.polygon(corners, density=1.0)
            assert abs(Fraction(float(found.mass)) - area) <= Fraction(1e-14) * area

    @pytest.mark.parametrize(("beyond", "is_let"), [(-(2.0**-98), True), (2.0**-98, False)])
    def test_a_corner_a_little_beyond_a_slanted_edge(self, beyond: float, is_let: bool) -> None:
        """Beyond by 2⁻⁹⁹ of the edge's length, or short of it by as much."""
        corners = [(0.0, beyond), (1.0, 3.0), (-2.0, 4.0), (0.5, 1.5), (-2.0, 1.0)]
        if is_let:
            assert laminae.polygon(corners, density=1.0).mass > 0
        else:
            with pytest.raises(PolhodeError, match="crosses the edge from vertex"):
                laminae.polygon(corners, density=1.0)


TETRAHEDRON = [[(0, 0, 0), (0, 1, 0), (1, 0, 0)], [(0, 0, 0), (1, 0, 0), (0, 0, 1)]]
TETRAHEDRON += [[(0, 0, 0), (0, 0, 1), (0, 1, 0)], [(1, 0, 0), (0, 1, 0), (0, 0, 1)]]


class TestFiles:
    @pytest.mark.parametrize("surplus", [-1, 0, 1, 50])
    def test_an_stl_is_as_long_as_its_header_says(self, tmp_path: Path, surplus: int) -> None:
        records = b"".join(struct.pack("<12fH", 0, 0, 0, *np.ravel(face), 0) for face in TETRAHEDRON)
        whole = bytes(80) + struct.pack("<I", 4) + records
        file = tmp_path / "t.stl"
        file.write_bytes(whole + bytes(surplus) if surplus >= 0 else whole[:surplus])
        if surplus == 0:
            assert RigidBody.from_file(file, density=6.0).mass == pytest.approx(1.0, rel=1e-15)
        else:
            with pytest.raises((FileFormatError, MeshError)):
                RigidBody.from_file(file, density=6.0)

    @pytest.mark.parametrize("comment", ["", " # a remark", " #1 2 3", "\t#"])
    def test_a_remark_behind_a_face(self, tmp_path: Path, comment: str) -> None:
        faces = [(1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4)]
        lines = [
            "v 0 0 0",
            "v 1 0 0",
            "v 0 1 0",
            "v 0 0 1",
            *(f"f {a} {b} {c}{comment}" for a, b, c in faces),
        ]
        file = tmp_path / "t.obj"
        file.write_text("\n".join(lines) + "\n")
        assert RigidBody.from_file(file, density=6.0).mass == pytest.approx(1.0, rel=1e-15)

    @pytest.mark.parametrize("kinds", ["ddd", "fdd", "dfd", "ddf", "fff"])
    def test_coordinates_of_mixed_kinds_keep_their_digits(self, tmp_path: Path, kinds: str) -> None:
        """A box with edges of 0.1: in 32 bits that is another number."""
        corners = [(x, y, z) for x in (0, 0.1) for y in (0, 0.1) for z in (0, 0.1)]
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        names = {"d": "double", "f": "float"}
        header = ["ply", "format binary_little_endian 1.0", "element vertex 8"]
        header += [f"property {names[kind]} {axis}" for kind, axis in zip(kinds, "xyz", strict=True)]
        header += ["element face 6", "property list uchar int vertex_indices", "end_header", ""]
        data = b"".join(struct.pack(f"<{kinds}", *corner) for corner in corners)
        data += b"".join(struct.pack("<B4i", 4, *quad) for quad in quads)
        file = tmp_path / "t.ply"
        file.write_bytes("\n".join(header).encode() + data)
        edges = [Fraction(0.1) if kind == "d" else Fraction(float(np.float32(0.1))) for kind in kinds]
        volume = float(edges[0] * edges[1] * edges[2])
        assert RigidBody.from_file(file, density=1.0).mass == pytest.approx(volume, rel=1e-15)


class TestSaved:
    """What a version has written is read by later ones: these are files of the first formats."""

    BODY = """{"format": "polhode.RigidBody/1", "mass": 2.0, "center_of_mass": [0.0, 0.5, 0.0],
      "inertia": [[1.0, 0.25, 0.0], [0.25, 1.5, 0.0], [0.0, 0.0, 2.0]], "comment": "by hand"}"""
    MOTION = """{"format": "polhode.Trajectory/1", "t": [0.0, 1.0],
      "omega": [[0.0, 0.0, 2.0], [0.0, 0.0, 2.0]],
      "quaternion": [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.8414709848078965, 0.5403023058681398]],
      "position": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]], "velocity": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
      "about": [0.0, 0.0, 0.0], "steps": 0, "evaluations": 0, "status": "complete", "pivoted": false,
      "loaded": false,
      "body": {"mass": 1.0, "center_of_mass": [0.0, 0.0, 0.0],
               "inertia": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]]}}"""

    def test_a_body_of_the_first_format(self, tmp_path: Path) -> None:
        (tmp_path / "b.json").write_text(self.BODY)
        body = RigidBody.from_file(tmp_path / "b.json")
        assert (body.mass, body.inertia[0, 1]) == (2.0, 0.25)

    def test_a_motion_of_the_first_format(self, tmp_path: Path) -> None:
        (tmp_path / "m.json").write_text(self.MOTION)
        motion = Trajectory.from_file(tmp_path / "m.json")
        assert motion.omega[1, 2] == 2.0
        assert motion.kinetic_energy().total.tolist() == [3.0, 3.0]

    @pytest.mark.parametrize(
        ("number", "told"), [("2", "a later version of polhode"), ("0", "expected"), ("x", "expected")]
    )
    def test_a_body_of_another_format(self, tmp_path: Path, number: str, told: str) -> None:
        (tmp_path / "b.json").write_text(self.BODY.replace("RigidBody/1", f"RigidBody/{number}"))
        with pytest.raises(FileFormatError, match=told):
            RigidBody.from_file(tmp_path / "b.json")


class TestRows:
    def test_the_first_row_that_fails_is_named(self) -> None:
        with pytest.raises(InvalidInertiaError, match=r"row 1: mass must be positive, got -1\.0"):
            RigidBody([1.0, -1.0, -2.0], np.eye(3))
        with pytest.raises(InvalidInertiaError, match=r"row \(1, 0\): mass must be positive, got -3.0"):
            RigidBody([[1.0, 2.0], [-3.0, -1.0]], np.eye(3))

    def test_the_first_row_is_named_whoever_comes_to_it_first(self) -> None:
        """The last rows of a block fail, and the first of those behind: other threads are there sooner."""
        for rows, first in ((1 << 16, 20 * 1024), (1 << 16, 40 * 1024)):
            masses = np.where(np.arange(rows) < first, 1.0, -1.0)
            for _ in range(20):
                with pytest.raises(InvalidInertiaError, match=f"row {first}: mass must be positive"):
                    RigidBody(masses, np.eye(3))

    @pytest.mark.parametrize(
        ("size", "is_let"), [("[1.0, 1, 1]", True), ("[true, 1, 1]", False), ("[1, 1, false]", False)]
    )
    def test_true_and_false_in_a_list_are_no_numbers(self, tmp_path: Path, size: str, is_let: bool) -> None:
        text = f'[[part]]\nname = "a"\nsolid = "box"\nlength_unit = "m"\nsize = {size}\ndensity = 1000\n'
        (tmp_path / "whole.toml").write_text(text)
        code, _, err = run("assemble", tmp_path / "whole.toml")
        assert (code, "size" in err) == ((0, False) if is_let else (2, True))

    @pytest.mark.parametrize("shape", [(1,), (2,), (1, 3), (3, 1)])
    def test_leading_axes_stay(self, shape: tuple[int, ...]) -> None:
        body = RigidBody(np.ones(shape), np.eye(3))
        assert body.shape == shape
        assert body.inertia.shape == (*shape, 3, 3)
        assert body.kinetic_energy((1.0, 0.0, 0.0)).total.shape == shape


class TestMotions:
    def test_a_drift_of_nothing_is_zero(self) -> None:
        assert drift(np.zeros(3), np.zeros(3)) == 0.0
        assert drift(np.full(3, 2.0), np.full(3, 2.0)) == 0.0
        assert drift(np.array([0.0, 1e-3, 0.0]), np.full(3, 2.0)) == 5e-4

    def test_a_body_of_three_equal_moments_is_neutral(self) -> None:
        for moments, word in (((1, 1, 1), "neutral"), ((1, 1, 1.5), "damps"), ((1, 1.5, 1.5), "flat spin")):
            body = RigidBody.from_principal(1.0, moments)
            assert tops.nutation_damping(body, 1.0, inertia=1e-3, damping=1e-3).verdict == word


class TestRobots:
    LINK = """<link name="l{0}"><inertial><mass value="{1}"/>
      <inertia ixx="0.5" iyy="0.5" izz="{2!r}" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><geometry><sphere radius="0.1"/></geometry></collision></link>"""

    @pytest.mark.parametrize(("apart", "is_told"), [(0.9e-9, True), (1.2e-9, False)])
    def test_the_same_multiple_of_the_unit_tensor(self, tmp_path: Path, apart: float, is_told: bool) -> None:
        links = [self.LINK.format(k, mass, 0.5 * (1 + apart)) for k, mass in enumerate((5, 7))]
        joint = '<joint name="j" type="continuous"><parent link="l0"/><child link="l1"/></joint>'
        (tmp_path / "r.urdf").write_text(f'<robot name="r">{"".join(links)}{joint}</robot>')
        out = run("check", tmp_path / "r.urdf", "--format", "json")[1]
        assert out.count('"verdict": "placeholder"') == (2 if is_told else 0)
