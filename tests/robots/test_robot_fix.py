"""What ``fix`` and ``check --fix`` write: what is missing, in the form of the file, with warnings."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import run
from polhode import robots
from robot_texts import BALL, CUBE, ROUND, UNREAD, bare, joint, link, mjcf, sdf, sjoint, slink, urdf, weighed
from three_formats import there

if TYPE_CHECKING:
    from pathlib import Path

BOX = '<box size="0.1 0.2 0.3"/>'
VOLUME = 0.006
# m/12 (b² + c²) and so on, for 1 kg.
MOMENTS = np.array([0.13, 0.10, 0.05]) / 12.0
ARM = urdf(bare("base"), bare("a", BOX), joint("base", "a"))
INDENTED = """<robot name="r">
\t<link name="base"/>
\t<link name="a">
\t\t<!-- from the drawing -->
\t\t<collision>
\t\t\t<origin xyz="0 0 1"/><geometry><box size="0.1 0.2 0.3"/></geometry>
\t\t</collision>
\t</link>
\t<joint name="j" type="revolute"><parent link="base"/><child link="a"/></joint>
</robot>
"""


def parsed(text: str | bytes) -> robots.Robot:
    return robots.parse_robot(text if isinstance(text, bytes) else text.encode(), name="r", folder=".")


def test_what_is_unreadable_is_left_and_told_so(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(urdf(link("a", 1.0, 0.1, BALL).replace('"1.0"', '"${mass}"')))
    code, out, _ = run("check", path, "--fix", tmp_path / "out.urdf")
    assert code == 1
    assert "expand the file with xacro first" in out
    assert "left as they are, to be corrected by hand: a" in out
    assert "tells nothing" not in out


class TestWhatIsMissing:
    def test_is_left_without_a_density(self) -> None:
        robot = parsed(ARM)
        verdicts = robots.check(robot)
        assert [v.verdict for v in verdicts] == ["none", "missing"]
        assert robots.fix(robot, verdicts) == robot.source

    @pytest.mark.parametrize(
        "text",
        [
            ARM,
            INDENTED,
            ARM.replace("<box", "<box ").replace(bare("base"), '<link name="base"></link>'),
            mjcf(
                '<body name="a"><joint/><geom type="box" size="0.05 0.1 0.15" mass="0" pos="0 0 1"/></body>',
            ),
            sdf(
                slink("a", weighed(0, 0), "<box><size>0.1 0.2 0.3</size></box>"),
                sjoint("world", "a"),
            ),
            sdf(slink("a", "", "<box><size>0.1 0.2 0.3</size></box>"), sjoint("world", "a")),
            sdf(slink("a", "<inertial/>", "<box><size>0.1 0.2 0.3</size></box>")),
            urdf(bare("base"), link("a", 0.0, 0.0, BOX), joint("base", "a")),
        ],
        ids=["urdf", "indented", "spaced", "mjcf", "sdf zeros", "sdf without", "sdf empty", "urdf zeros"],
    )
    def test_is_what_the_shape_says(self, text: str) -> None:
        robot = parsed(text)
        fixed = robots.fix(robot, robots.check(robot, density=1000.0))
        again = parsed(fixed)
        a = again.links[-1]
        inertial = there(a.inertial)
        assert inertial.mass == pytest.approx(1000.0 * VOLUME, rel=1e-9)
        np.testing.assert_allclose(inertial.inertia, 6.0 * np.diag(MOMENTS), rtol=1e-8, atol=1e-15)
        np.testing.assert_allclose(inertial.center_of_mass, a.shapes[0].place.position, atol=1e-15)
        assert robots.check(again)[-1].verdict == "good"

    def test_stands_in_the_form_of_the_file(self) -> None:
        robot = parsed(INDENTED)
        before = INDENTED.splitlines()
        after = robots.fix(robot, robots.check(robot, density=1000.0)).decode().splitlines()
        added = [
            "\t\t<inertial>",
            '\t\t\t<origin xyz="0.0 0.0 1.0" rpy="0 0 0"/>',
            '\t\t\t<mass value="6.0"/>',
            '\t\t\t<inertia ixx="0.065" iyy="0.05" izz="0.025" ixy="0.0" ixz="0.0" iyz="0.0"/>',
            "\t\t</inertial>",
        ]
        at = after.index(added[0])
        assert after[at : at + 5] == added
        assert after[:at] + after[at + 5 :] == before

    def test_a_mass_is_shared_by_the_volumes(self) -> None:
        two = '<box size="0.2 0.2 0.3"/>'
        robot = parsed(
            urdf(bare("base", BOX), bare("a", BOX), bare("b", two), joint("base", "a"), joint("a", "b"))
        )
        verdicts = robots.check(robot, mass=12.0)
        assert [v.better.mass if v.better else None for v in verdicts] == [None, 4.0, 8.0]

    @pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
    def test_amounts_that_are_none_are_refused(self, bad: float) -> None:
        with pytest.raises(ValueError, match="density: expected a finite number above 0"):
            robots.check(parsed(ARM), density=bad)
        with pytest.raises(ValueError, match="mass: expected a finite number above 0"):
            robots.check(parsed(ARM), mass=bad)
        with pytest.raises(ValueError, match="give one of them"):
            robots.check(parsed(ARM), density=1.0, mass=1.0)


class TestCommand:
    def test_density_writes_what_is_missing(self, tmp_path: Path) -> None:
        (tmp_path / "r.urdf").write_text(ARM)
        code, out, _ = run("check", tmp_path / "r.urdf")
        assert code == 1
        assert "--fix FILE with --density or --mass writes the mass that is missing" in out
        code, out, _ = run("check", tmp_path / "r.urdf", "--fix", tmp_path / "left.urdf")
        assert code == 1
        assert "left as they are: a; --fix FILE with --density or --mass" in out
        better = tmp_path / "better.urdf"
        density = ("--density", "1 g/cm^3")
        code, out, _ = run("check", tmp_path / "r.urdf", "--fix", better, *density, "--format", "json")
        assert code == 0
        (changed,) = json.loads(out)["changed"]
        assert (changed["link"], changed["mass"], changed["inertia_before"]) == ("a", 6.0, None)
        assert run("check", better)[0] == 0
        code, _, _ = run("check", tmp_path / "r.urdf", "--fix", better, "--mass", "3 kg")
        assert code == 0
        assert 'value="3.0"' in better.read_text()

    def test_a_mass_is_shared_by_links_of_known_volumes(self, tmp_path: Path) -> None:
        known, unread = bare("a", BALL), bare("b", UNREAD)
        text = urdf(bare("base"), known, unread, joint("base", "a"), joint("base", "b"))
        (tmp_path / "r.urdf").write_text(text)
        code, _, err = run("check", tmp_path / "r.urdf", "--mass", "3 kg")
        assert code == 2
        assert err.startswith("polhode: --mass: the shape of b, which has no mass, tells no volume")
        assert "pass --density" in err
        code, out, _ = run(
            "check", tmp_path / "r.urdf", "--fix", tmp_path / "f.urdf", "--density", "1 g/cm^3"
        )
        assert code == 1
        assert "left as they are: b" in out

    def test_a_frame_that_fails_is_served_by_the_mass_of_what_is_tied_to_it(self, tmp_path: Path) -> None:
        text = urdf(bare("base"), bare("a"), bare("b", CUBE), joint("base", "a"), joint("a", "b", "fixed"))
        (tmp_path / "r.urdf").write_text(text)
        assert run("check", tmp_path / "r.urdf")[0] == 1
        for amount in (("--density", "1000 kg/m^3"), ("--mass", "3 kg")):
            code, out, _ = run("check", tmp_path / "r.urdf", "--fix", tmp_path / "f.urdf", *amount)
            assert code == 0
            assert "1 link changed" in out
            assert "left as they are" not in out
            assert run("check", tmp_path / "f.urdf")[0] == 0
        code, out, _ = run("check", tmp_path / "r.urdf", "--fix", tmp_path / "f.urdf")
        assert code == 1
        assert "left as they are: a, b; --fix FILE with --density or --mass" in out

    def test_a_density_that_serves_nothing_is_told(self, tmp_path: Path) -> None:
        (tmp_path / "r.urdf").write_text(urdf(link("a", 5.0, 0.02, BALL)))
        _, out, _ = run("check", tmp_path / "r.urdf", "--density", "1000 kg/m^3")
        assert "--density has no effect: no failing link is without mass" in out
        (tmp_path / "r.urdf").write_text(ARM)
        assert "changes nothing" not in run("check", tmp_path / "r.urdf", "--density", "1000 kg/m^3")[1]

    def test_tensors_that_may_have_been_measured_are_named_before(self, tmp_path: Path) -> None:
        """A valid tensor without room in its shape; a placeholder and a broken law are no measurements."""
        (tmp_path / "r.urdf").write_text(
            urdf(
                link("arm", 5.0, (0.019, 0.02, 0.021), BALL, at="0.12 0 0"),
                link("far", 5.0, (0.3, 0.31, 0.32), BALL),
                link("one", 5.0, 1.0, BALL),
                link("law", 5.0, (0.1, 0.1, 0.3), BALL),
            )
        )
        for more in ((), ("--fix", tmp_path / "better.urdf")):
            code, out, _ = run("check", tmp_path / "r.urdf", *more)
            assert code == (0 if more else 1)
            (warning,) = [line for line in out.splitlines() if "warning: " in line]
            assert "they may be measured: arm; compare" in warning
            _, out, _ = run("check", tmp_path / "r.urdf", "--strict", *more)
            assert "they may be measured: arm, far; compare" in out

    def test_numbers_that_stay_keep_their_form(self, tmp_path: Path) -> None:
        text = (
            urdf(link("arm", 5.0, 1.0, BALL))
            .replace('value="5.0"', 'value="5.000"')
            .replace('"0 0 0"', "'0  0 0'")
        )
        (tmp_path / "r.urdf").write_text(text)
        assert run("check", tmp_path / "r.urdf", "--fix", tmp_path / "better.urdf")[0] == 0
        assert (tmp_path / "better.urdf").read_text() == text.replace('"1.0"', '"0.02"')

    def test_meshes_that_are_not_found_are_told_in_one_line(self, tmp_path: Path) -> None:
        meshes = [f'<mesh filename="package://hand/{name}.stl"/>' for name in "abcde"]
        (tmp_path / "r.urdf").write_text(
            urdf(*(link(f"l{i}", 1.0, 0.1 + i, m) for i, m in enumerate(meshes)))
        )
        _, out, _ = run("check", tmp_path / "r.urdf")
        (line,) = [line for line in out.splitlines() if "not found" in line]
        assert line.strip() == (
            "note: 5 meshes were not found: package://hand/a.stl, package://hand/b.stl, package://hand/c.stl "
            "and 2 more; name the folder that holds hand with --packages, or put them where the file says"
        )

    def test_a_bad_visual_shape_is_a_note(self, tmp_path: Path) -> None:
        (tmp_path / "r.urdf").write_text(urdf(link("a", 5.0, 0.02, BALL, seen='<box size="1 1 x"/>')))
        code, out, _ = run("check", tmp_path / "r.urdf")
        assert code == 0
        assert "note: line 1: box size is '1 1 x' where 3 finite numbers have to stand" in out

    def test_what_is_inferred_shows_its_numbers(self, tmp_path: Path) -> None:
        (tmp_path / "m.xml").write_text(mjcf('<body name="a"><freejoint/><geom size="0.1"/></body>'))
        report = json.loads(run("check", tmp_path / "m.xml", "--format", "json")[1])
        (a,) = report["links"]
        mass = 1000 * 4 / 3 * np.pi * 0.1**3
        np.testing.assert_allclose([a["mass"], *a["moments"]], [mass, *3 * [0.4 * mass * 0.01]], rtol=1e-14)

    def test_sdf_infers_with_its_densities(self) -> None:
        text = sdf(
            slink("a", '<inertial auto="true"><density>500</density></inertial>', ROUND),
            slink("b", '<inertial auto="true"/>', ROUND).replace(
                "<geometry>", "<density>20</density><geometry>"
            ),
            slink("c", '<inertial auto="true"/>', ROUND),
        )
        masses = [there(verdict.mass) for verdict in robots.check(parsed(text))]
        np.testing.assert_allclose(masses, np.array([500, 20, 1000]) * 4 / 3 * np.pi * 0.1**3, rtol=1e-14)
