"""Robots read here and by MuJoCo."""

from __future__ import annotations

import importlib
import importlib.util
from pathlib import Path

import numpy as np
import pytest
from polhode import robots, solids
from three_formats import fixed_axes, there


class TestMuJoCo:
    def read(self, geom: str, compiler: str = "") -> robots.Verdict:
        text = f"""<mujoco><compiler {compiler}/><worldbody><body name="b">
            <inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>{geom}</body></worldbody></mujoco>"""
        (verdict,) = robots.check(robots.parse_robot(text.encode(), name="m", folder="."))
        return verdict

    def test_lengths_are_halves(self) -> None:
        np.testing.assert_allclose(
            there(self.read('<geom type="cylinder" size="0.5 1"/>').shape_moments),
            solids.cylinder(0.5, 2.0, mass=1.0).principal_moments,
            rtol=1e-14,
        )
        capsule = solids.capsule(0.5, 3.0, mass=1.0)
        for geom in (
            '<geom type="capsule" size="0.5 1.5"/>',
            '<geom type="capsule" size="0.5" fromto="0 1 0 0 4 0"/>',
            '<geom type="capsule" size="0.5" fromto="0 0 4 0 0 1"/>',
            '<geom type="capsule" size="0.5 1.5" zaxis="1 2 3"/>',
            '<geom type="capsule" size="0.5 1.5" axisangle="0 1 0 30"/>',
            '<geom type="capsule" size="0.5 1.5" xyaxes="0 1 0 1 1 0"/>',
            '<geom type="capsule" size="0.5 1.5" quat="2 1 0 0"/>',
        ):
            np.testing.assert_allclose(
                there(self.read(geom).shape_moments), capsule.principal_moments, rtol=1e-13
            )

    def test_masses_and_densities_weigh(self) -> None:
        two = '<geom size="0.1" mass="{}"/><geom size="0.2" pos="1 0 0" {}/>'
        light = 1000 * 4 / 3 * np.pi * 0.2**3
        for second, share in (('mass="3"', 3.0), ("", light), ('density="500"', light / 2)):
            verdict = self.read(two.format(1.0, second))
            total = 1.0 + share
            along = (0.4 * 0.01 * 1 + 0.4 * 0.04 * share) / total
            np.testing.assert_allclose(there(verdict.shape_moments)[0], along, rtol=1e-13)
            np.testing.assert_allclose(there(verdict.shape_moments)[2], along + share / total**2, rtol=1e-13)

    def test_default_angles_are_degrees_of_the_turning_frame(self) -> None:
        text = b"""<mujoco><worldbody><body name="b"><inertial mass="1" pos="0 0 0" euler="10 20 30"
            diaginertia="1 2 2.5"/></body></worldbody></mujoco>"""
        (link,) = robots.parse_robot(text, name="m", folder=".").links
        x, y, z = (fixed_axes(*row) for row in np.diag(np.deg2rad([10, 20, 30])))
        turn = x @ y @ z
        np.testing.assert_allclose(
            there(link.inertial).inertia, turn @ np.diag([1, 2, 2.5]) @ turn.T, rtol=0, atol=1e-14
        )

    def test_frames_and_classes(self) -> None:
        text = b"""<mujoco><default><default class="big"><geom size="0.5"/></default></default><worldbody>
            <frame><body name="b"><inertial mass="1" pos="0 0 0" diaginertia="1 2 2.5"/>
            <geom size="0.5"/><frame pos="0 0 1" euler="90 0 0" childclass="big"><geom pos="0 3 0"/></frame>
            </body></frame></worldbody></mujoco>"""
        robot = robots.parse_robot(text, name="m", folder=".")
        assert [shape.size for shape in robot.links[0].shapes] == [(0.5,), (0.5,)]
        np.testing.assert_allclose(robot.links[0].shapes[1].place.position, [0, 0, 4], atol=1e-15)
        (verdict,) = robots.check(robot)
        np.testing.assert_allclose(there(verdict.shape_moments), [0.1, 4.1, 4.1], rtol=1e-14)

    def test_nothing_declared_is_inferred(self) -> None:
        text = b'<mujoco><worldbody><body name="b"><geom size="1"/><body/></body></worldbody></mujoco>'
        verdicts = robots.check(robots.parse_robot(text, name="m", folder="."))
        assert [verdict.verdict for verdict in verdicts] == ["inferred", "none"]
        text = b"""<sdf><model><link name="a"><inertial auto="true"/>
            <collision><geometry><sphere><radius>1</radius></sphere></geometry></collision></link></model></sdf>"""
        (verdict,) = robots.check(robots.parse_robot(text, name="s", folder="."))
        assert verdict.verdict == "inferred"


def boxes(*centers: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Unit cubes as one mesh."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([t for a, b, c, d in sides for t in ([a, b, c], [a, c, d])])
    return (
        np.concatenate([corners + center for center in centers]),
        np.concatenate([faces + 8 * i for i in range(len(centers))]),
    )


def written_obj(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


class TestMeshesThatWeigh:
    """MuJoCo takes a mesh by its attribute inertia; the default counts what is not convex more than once."""

    DENSITY = 1000.0

    def inferred(
        self,
        folder: Path,
        attributes: str,
        centers: tuple[tuple[float, float, float], ...],
        defaults: str = "",
    ) -> robots.Verdict:
        written_obj(folder / "m.obj", *boxes(*centers))
        mesh = f'<mesh name="m" file="m.obj" {attributes}/>'
        text = f"""<mujoco><default>{defaults}</default><asset>{mesh}</asset><worldbody>
            <body name="b"><joint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""
        (folder / "m.xml").write_text(text, encoding="utf-8")
        (verdict,) = robots.check(robots.read_robot(folder / "m.xml"))
        self.beside_mujoco(folder / "m.xml", verdict)
        return verdict

    @staticmethod
    def beside_mujoco(path: Path, verdict: robots.Verdict) -> None:
        if importlib.util.find_spec("mujoco") is None:
            return
        body = importlib.import_module("mujoco").MjModel.from_xml_path(str(path)).body("b")
        np.testing.assert_allclose(there(verdict.mass), body.mass[0], rtol=1e-6)
        np.testing.assert_allclose(there(verdict.moments), np.sort(body.inertia), rtol=1e-6)

    @pytest.mark.parametrize("distance", [1.0, 2.0, 5.0])
    @pytest.mark.parametrize("attributes", ["", 'inertia="legacy"'])
    def test_two_cubes_by_the_default(self, tmp_path: Path, distance: float, attributes: str) -> None:
        # From the middle: pyramids on faces at x = d ± 1/2 and four at 1/2; all count as full. Of a pyramid
        # of height h over a base B, ∫ x² dV = h/5 ∫_B x² dA.
        d = distance
        verdict = self.inferred(tmp_path, attributes, ((-d, 0.0, 0.0), (d, 0.0, 0.0)))
        volume = 2.0 * ((d + 0.5) / 3.0 + (d - 0.5) / 3.0 + 4.0 * 0.5 / 3.0)
        xx = 2.0 / 5.0 * ((d + 0.5) ** 3 + (d - 0.5) ** 3 + 4.0 * 0.5 * (d**2 + 1.0 / 12.0))
        yy = 2.0 / 5.0 * ((d + 0.5) / 12.0 + (d - 0.5) / 12.0 + 2.0 * 0.5 / 4.0 + 2.0 * 0.5 / 12.0)
        assert there(verdict.mass) == pytest.approx(self.DENSITY * volume, rel=1e-13)
        moments = self.DENSITY * np.array([2.0 * yy, xx + yy, xx + yy])
        np.testing.assert_allclose(there(verdict.moments), moments, rtol=1e-13)
        (note,) = [note for note in verdict.notes if "legacy" in note]
        assert f'counts {volume / 2.0:.3g} times its volume; inertia="exact" there counts it once' in note

    def test_two_cubes_as_they_are(self, tmp_path: Path) -> None:
        verdict = self.inferred(tmp_path, 'inertia="exact"', ((-2.0, 0.0, 0.0), (2.0, 0.0, 0.0)))
        assert there(verdict.mass) == pytest.approx(2.0 * self.DENSITY, rel=1e-13)
        moments = 2.0 * self.DENSITY * np.array([1.0 / 6.0, 4.0 + 1.0 / 6.0, 4.0 + 1.0 / 6.0])
        np.testing.assert_allclose(there(verdict.moments), moments, rtol=1e-13)
        assert not verdict.notes

    @pytest.mark.parametrize("by_class", [False, True])
    def test_two_cubes_as_their_hull(self, tmp_path: Path, by_class: bool) -> None:
        word = 'inertia="convex"'
        verdict = self.inferred(
            tmp_path,
            "" if by_class else word,
            ((-2.0, 0.0, 0.0), (2.0, 0.0, 0.0)),
            f"<mesh {word}/>" if by_class else "",
        )
        assert there(verdict.mass) == pytest.approx(5.0 * self.DENSITY, rel=1e-13)
        np.testing.assert_allclose(
            there(verdict.moments), 5.0 * self.DENSITY / 12.0 * np.array([2.0, 26.0, 26.0]), rtol=1e-13
        )
        assert not verdict.notes

    def test_a_convex_mesh_counts_once(self, tmp_path: Path) -> None:
        verdict = self.inferred(tmp_path, "", ((3.0, 1.0, 0.0),))
        assert there(verdict.mass) == pytest.approx(self.DENSITY, rel=1e-13)
        np.testing.assert_allclose(there(verdict.moments), self.DENSITY / 6.0, rtol=1e-13)
        assert not verdict.notes

    def test_an_open_mesh_adds_its_tetrahedra(self, tmp_path: Path) -> None:
        vertices, faces = boxes((0.0, 0.0, 0.0))
        written_obj(tmp_path / "m.obj", vertices, faces[:-2])
        text = """<mujoco><asset><mesh name="m" file="m.obj"/></asset>
            <worldbody><body name="b"><joint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""
        (tmp_path / "m.xml").write_text(text, encoding="utf-8")
        (verdict,) = robots.check(robots.read_robot(tmp_path / "m.xml"))
        # The middle of the five sides left is 0.1 below: four pyramids of height 1/2 and one of 0.4; then the
        # same from their centre of mass.
        sides, bottom = 4.0 * 0.5 / 3.0, 0.4 / 3.0
        center = (sides * -0.1 / 4.0 + bottom * (-0.5 * 0.75 - 0.1 / 4.0)) / (sides + bottom)
        volume = sides + (0.5 + center) / 3.0
        assert there(verdict.mass) == pytest.approx(self.DENSITY * volume, rel=1e-12)
        assert any("does not bound a solid: MuJoCo's inertia" in note for note in verdict.notes)
        self.beside_mujoco(tmp_path / "m.xml", verdict)

    @pytest.mark.parametrize(
        ("attributes", "low", "high"),
        [
            ('refpos="1 2 3"', (-1.5, -2.5, -3.5), (-0.5, -1.5, -2.5)),
            ('refpos="1 2 3" scale="2 1 1"', (-3.0, -2.5, -3.5), (-1.0, -1.5, -2.5)),
            # Turned back by a quarter about z, so that x becomes -y.
            ('refpos="1 2 3" refquat="1 0 0 1"', (-2.5, 0.5, -3.5), (-1.5, 1.5, -2.5)),
            ('refpos="1 2 3" refquat="3 0 0 3" scale="2"', (-5.0, 1.0, -7.0), (-3.0, 3.0, -5.0)),
        ],
    )
    def test_where_refpos_and_refquat_put_a_mesh(
        self, tmp_path: Path, attributes: str, low: tuple[float, ...], high: tuple[float, ...]
    ) -> None:
        """Bodies of a tensor with room there, and not where the mesh would be without them."""
        written_obj(tmp_path / "m.obj", *boxes((0.0, 0.0, 0.0)))
        sides, center = np.subtract(high, low), np.add(low, high) / 2.0
        moments = 7.0 / 12.0 * (sides @ sides - sides**2)
        for place, word in ((center, "good"), (np.zeros(3), "impossible")):
            position, diagonal = (" ".join(map(repr, row.tolist())) for row in (place, moments))
            text = f"""<mujoco><asset><mesh name="m" file="m.obj" {attributes}/></asset>
                <worldbody><body name="b"><joint/>
                <inertial pos="{position}" mass="7" diaginertia="{diagonal}"/><geom type="mesh" mesh="m"/>
                </body></worldbody></mujoco>"""
            robot = robots.parse_robot(text.encode(), name="m", folder=tmp_path)
            (verdict,) = robots.check(robot)
            assert verdict.verdict == word
            assert verdict.factor == pytest.approx(1.0, rel=1e-12)

    def test_what_is_turned_and_scaled_unevenly_is_not_told(self, tmp_path: Path) -> None:
        written_obj(tmp_path / "m.obj", *boxes((0.0, 0.0, 0.0)))
        text = """<mujoco><asset><mesh name="m" file="m.obj" refquat="1 0 0 1" scale="1 2 1"/></asset>
            <worldbody><body name="b"><inertial pos="0 0 0" mass="6" diaginertia="1 1 1.1"/>
            <geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""
        (verdict,) = robots.check(robots.parse_robot(text.encode(), name="m", folder=tmp_path))
        assert verdict.verdict == "good"
        assert any("turned by refquat and scaled unevenly" in note for note in verdict.notes)
