"""Robots of several files: what is included, attached and replicated, and what is refused of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from mesh_files import obj
from oracles.meshes import cube
from polhode import robots
from polhode.errors import FileFormatError

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.robots import Verdict

# 2/5 m r² = 0.02.
BALL = '<inertial mass="5" pos="0 0 0" diaginertia="0.02 0.02 0.02"/><geom type="sphere" size="0.1"/>'
WORLD = "<mujoco>{}<worldbody>{}</worldbody></mujoco>"


def write(folder: Path, **files: str) -> Path:
    """Files by their names, ``__`` for a slash and ``_`` before the suffix; gives the first."""
    paths = []
    for name, text in files.items():
        stem, _, suffix = name.replace("__", "/").rpartition("_")
        path = folder / f"{stem}.{suffix}"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        paths.append(path)
    return paths[0]


def judged(path: Path, *packages: Path) -> dict[str, Verdict]:
    robot = robots.read_robot(path, packages)
    return {verdict.name: verdict for verdict in robots.check(robot, packages)}


def moments(verdict: Verdict) -> np.ndarray:
    """Those of its shape, which is there."""
    assert verdict.shape_moments is not None
    return verdict.shape_moments


class TestMuJoCoInclude:
    def test_elements_stand_where_the_include_stands(self, tmp_path: Path) -> None:
        main = write(
            tmp_path,
            main_xml=WORLD.format(
                '<include file="parts/defaults.xml"/>',
                f'<body name="a">{BALL}<include file="parts/leg.xml"/></body>',
            ),
            parts__defaults_xml='<mujoco><default><geom type="box" size="0.1 0.2 0.3"/></default></mujoco>',
            parts__leg_xml='<mujocoinclude>\n<body name="leg"><inertial mass="3" pos="0 0 0" '
            'diaginertia="0.13 0.1 0.05"/><geom/></body><include file="parts/foot.xml"/></mujocoinclude>',
            parts__foot_xml=f'<x><body name="foot">{BALL}</body></x>',
        )
        found = judged(main)
        assert list(found) == ["a", "leg", "foot"]
        # A box of half sides 0.1, 0.2, 0.3 by the included default: m (b² + c²)/3 and so on, as declared.
        assert found["leg"].verdict == "good"
        np.testing.assert_allclose(moments(found["leg"]), (0.05, 0.1, 0.13), rtol=1e-14)
        assert (found["leg"].file, found["leg"].line) == ("parts/leg.xml", 2)
        assert found["a"].file == ""
        notes = robots.read_robot(main).notes
        assert notes == ("read too: parts/defaults.xml, parts/leg.xml, parts/foot.xml",)

    @pytest.mark.parametrize(
        ("include", "says"),
        [
            ('<include file="no.xml"/>', "line 1: there is no file no.xml; put it at"),
            ("<include/>", "line 1: <include> without file"),
            ('<include file="."/>', "line 1: there is no file ."),
            ('<include file="main.xml"/>', "line 1 of main.xml: main.xml is included twice"),
            ('<include file="b.xml"/><include file="b.xml"/>', "b.xml is included twice"),
            ('<include file="loop.xml"/>', "line 1 of loop.xml: loop.xml is included twice"),
            ('<include file="cut.xml"/>', "cut.xml: line 1: not well-formed XML"),
            ('<include file="bomb.xml"/>', "bomb.xml: line 1: declares a document type or entities"),
            ('<include file="http://127.0.0.1:9/a.xml"/>', "there is no file http://127.0.0.1:9/a.xml"),
        ],
    )
    def test_what_is_refused(self, tmp_path: Path, include: str, says: str) -> None:
        main = write(
            tmp_path,
            main_xml=WORLD.format("", f'{include}<body name="a">{BALL}</body>'),
            b_xml="<x><body/></x>",
            loop_xml='<x><include file="loop.xml"/></x>',
            cut_xml="<x><body>",
            bomb_xml='<!DOCTYPE x [<!ENTITY a "b">]><x><body name="&a;"/></x>',
        )
        with pytest.raises(FileFormatError, match=says) as told:
            judged(main)
        assert str(told.value).startswith(f"{main}: ")

    def test_links_to_one_file_are_files_of_their_own(self, tmp_path: Path) -> None:
        """So MuJoCo takes them, which knows a file by its name; one that leads to itself has an end."""
        main = write(
            tmp_path,
            main_xml=WORLD.format("", "".join(f'<include file="{name}.xml"/>' for name in "bcd")),
            b_xml="<x><body><geom size='1'/></body></x>",
        )
        for name in "cd":
            (tmp_path / f"{name}.xml").symlink_to("b.xml")
        assert [verdict.verdict for verdict in judged(main).values()] == ["inferred"] * 3
        (tmp_path / "b.xml").write_text('<x><include file="c.xml"/></x>')
        with pytest.raises(FileFormatError, match=r"line 1 of c\.xml: c\.xml is included twice"):
            judged(main)

    def test_a_bad_number_ends_the_verdict_of_its_own_body_alone(self, tmp_path: Path) -> None:
        main = write(
            tmp_path,
            main_xml=WORLD.format("", f'<include file="bad.xml"/><body name="a">{BALL}</body>'),
            bad_xml='<x>\n<body name="b"><geom size="1"/></body>\n'
            '<body name="c"><geom mass="heavy" size="1"/></body></x>',
        )
        found = judged(main)
        assert {name: verdict.verdict for name, verdict in found.items()} == {
            "b": "inferred",
            "c": "unreadable",
            "a": "good",
        }
        assert found["c"].reason == "line 3 of bad.xml: mass is 'heavy' where a finite number has to stand"


class TestMuJoCoParts:
    def test_copies_of_a_geom_weigh_together(self, tmp_path: Path) -> None:
        """Four bricks, each a quarter turn and 0.1 beyond the last: MuJoCo 4.0.0 finds the same moments."""
        spread = '<replicate count="4" offset="0 0 0.1" euler="0 0 90">{}</replicate>'
        brick = '<geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/>'
        inertial = '<inertial mass="4" pos="0 0 0.15" diaginertia="2.2 2.2 4.1"/>'
        main = write(
            tmp_path, main_xml=WORLD.format("", f'<body name="w">{inertial}{spread.format(brick)}</body>')
        )
        # About C of all four: C of brick k is at (cos kπ/2, sin kπ/2, k/10), its x and y sides swap places.
        places = np.array([[1, 0, 0], [0, 1, 0.1], [-1, 0, 0.2], [0, -1, 0.3]])
        sides = np.array([[0.1, 0.2, 0.3], [0.2, 0.1, 0.3]] * 2)
        about_o = [np.diag(s**2) / 3 + np.outer(p, p) for s, p in zip(sides, places, strict=True)]
        second = np.mean(about_o, axis=0)
        second -= np.outer(places.mean(axis=0), places.mean(axis=0))
        tensor = 4 * (np.trace(second) * np.eye(3) - second)
        expected = np.linalg.eigvalsh(tensor)
        np.testing.assert_allclose(expected, (2.16134566, 2.20333333, 4.10865434), rtol=1e-8)  # MuJoCo's
        np.testing.assert_allclose(moments(judged(main)["w"]), expected, rtol=1e-13)

    def test_copies_of_a_body_are_judged_once_and_that_is_said(self, tmp_path: Path) -> None:
        row = f'<replicate count="3" offset="1 0 0"><body name="b">{BALL}</body></replicate>'
        robot = robots.read_robot(write(tmp_path, main_xml=WORLD.format("", row)))
        assert [link.name for link in robot.links] == ["b"]
        assert robot.notes == ("bodies within <replicate> are judged once, their copies not",)

    def test_an_attached_model_keeps_its_own_settings(self, tmp_path: Path) -> None:
        main = write(
            tmp_path,
            main_xml=WORLD.format(
                '<compiler angle="radian" meshdir="no"/>'
                '<asset><model name="arm" file="arm/arm.xml"/></asset>',
                f'<body name="torso">{BALL}<attach model="arm" body="upper" prefix="left_"/>'
                '<frame pos="0 1 0"><attach model="arm" body="upper" prefix="right_"/></frame></body>'
                '<attach model="arm" prefix="whole_"/>',
            ),
            arm__arm_xml='<mujoco><compiler meshdir="m"/><asset><mesh name="c" file="cube.obj"/></asset>'
            '<default><default class="d"><geom mesh="c" type="mesh" euler="0 0 90"/></default></default>'
            '<worldbody><body name="base" childclass="d"><body name="upper">'
            '<inertial mass="6" pos="0 0 0" diaginertia="13 10 5"/><geom/></body></body></worldbody>'
            "</mujoco>",
        )
        (tmp_path / "arm" / "m").mkdir()
        vertices, faces = cube(2.0)
        (tmp_path / "arm" / "m" / "cube.obj").write_bytes(obj(vertices * (1.0, 0.5, 1.5), faces))
        found = judged(main)
        assert list(found) == ["torso", "left_upper", "right_upper", "whole_base", "whole_upper"]
        for name in ("left_upper", "right_upper", "whole_upper"):
            # Sides 2, 1, 3 turned by 90 degrees: m/12 (b² + c²) with m = 6.
            np.testing.assert_allclose(moments(found[name]), (2.5, 5.0, 6.5), rtol=1e-12)
            assert found[name].file == "arm/arm.xml"

    def test_links_of_other_files_are_not_fixed_here(self, tmp_path: Path) -> None:
        main = write(
            tmp_path,
            main_xml=WORLD.format(
                "", f'<include file="b.xml"/><body name="a">{BALL.replace("0.02 0.02 0.02", "1 1 1")}</body>'
            ),
            b_xml=f'<x><body name="b">{BALL.replace("0.02 0.02 0.02", "1 1 3")}</body></x>',
        )
        robot = robots.read_robot(main)
        verdicts = robots.check(robot)
        assert [verdict.verdict for verdict in verdicts] == ["impossible", "placeholder"]
        after = robots.fix(robot, verdicts).decode()
        assert '<include file="b.xml"/>' in after
        assert after.count('diaginertia="0.02 0.02 0.02"') == 1

    @pytest.mark.parametrize(
        ("parts", "says"),
        [
            (
                '<attach model="leg" prefix="l"/>',
                "line 1: <attach> of model 'leg', which no <model> .* names",
            ),
            ('<attach model="arm" body="foot" prefix="l"/>', "arm.xml has no body 'foot'"),
            ('<attach model="gone" prefix="l"/>', "there is no file gone.xml; put it at"),
            ('<attach model="self" prefix="l"/>', "self.xml: self.xml is read within itself"),
            ('<replicate count="0.5"><geom/></replicate>', "line 1: count is '0.5' where a whole number"),
            ("<replicate><geom/></replicate>", "count is missing, where a finite number"),
            ('<replicate count="1000000000"><geom size="1"/></replicate>', "more than 10000 copies"),
            (
                '<replicate count="9999"><replicate count="9999"><geom size="1"/></replicate></replicate>',
                "more than 10000 copies",
            ),
            ('<attach model="many" prefix="l"/>', "there are more than 1000 files"),
        ],
    )
    def test_what_is_refused(self, tmp_path: Path, parts: str, says: str) -> None:
        assets = "".join(f'<model name="{x}" file="{x}.xml"/>' for x in ("arm", "gone", "self", "many"))
        own = '<asset><model name="{0}" file="{0}.xml"/></asset>'
        main = write(
            tmp_path,
            main_xml=WORLD.format(f"<asset>{assets}</asset>", f'<body name="a">{parts}{BALL}</body>'),
            arm_xml=WORLD.format("", '<body name="upper"/>'),
            self_xml=WORLD.format(own.format("self"), '<attach model="self" prefix="s"/>'),
            many_xml=WORLD.format(own.format("more"), 40 * '<attach model="more" prefix="m"/>'),
            more_xml=WORLD.format(own.format("arm"), 40 * '<attach model="arm" prefix="m"/>'),
        )
        with pytest.raises(FileFormatError, match=says):
            judged(main)


LINK = """<link name="{}"><inertial><mass>5</mass>
<inertia><ixx>{}</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial>
<collision name="c"><geometry>{}</geometry></collision></link>"""
SPHERE = "<sphere><radius>0.1</radius></sphere>"


def sdf(*parts: str) -> str:
    return f'<sdf version="1.9"><model name="m">{"".join(parts)}</model></sdf>'


class TestSdfInclude:
    def test_models_are_found_as_gazebo_finds_them(self, tmp_path: Path) -> None:
        mesh = "<mesh><uri>cube.obj</uri></mesh>"
        main = write(
            tmp_path,
            world__main_sdf=sdf(
                LINK.format("own", 0.02, SPHERE),
                "<include><uri>model://arm</uri><name>left</name></include>",
                "<include><uri>model://arm/old.sdf</uri></include>",
                '<include merge="true"><uri>../world/part.sdf</uri></include>',
                "<include><uri>robot.urdf</uri><name>u</name></include>",
            ),
            models__arm__model_config='<model><name>a</name><sdf version="1.4">old.sdf</sdf>'
            '<sdf version="1.10">new.sdf</sdf></model>',
            models__arm__new_sdf=sdf(LINK.format("new", 0.02, mesh)),
            models__arm__old_sdf=sdf(LINK.format("old", 9, SPHERE)),
            world__part_sdf=sdf(LINK.format("part", 0.02, SPHERE)),
            world__robot_urdf='<robot name="r"><link name="base"/></robot>',
        )
        vertices, faces = cube(0.12**0.5)  # m s²/6 = 0.1
        (tmp_path / "models" / "arm" / "cube.obj").write_bytes(obj(vertices, faces))
        found = judged(main, tmp_path / "models")
        assert list(found) == ["own", "left::new", "m::old", "part", "u::base"]
        words = [verdict.verdict for verdict in found.values()]
        assert words == ["good", "good", "impossible", "good", "none"]
        np.testing.assert_allclose(moments(found["left::new"]), 0.1, rtol=1e-12)
        assert found["m::old"].file == "model://arm/old.sdf"

    def test_what_is_not_there_is_a_link_that_cannot_be_read(self, tmp_path: Path) -> None:
        away = "<include><uri>https://example.org/sun</uri></include>"
        gone = "<include><uri>model://gone</uri></include>"
        main = write(tmp_path, main_sdf=sdf(LINK.format("own", 0.02, SPHERE), away, gone))
        robot = robots.read_robot(main)
        own, lost = robots.check(robot)
        assert own.verdict == "good"
        assert lost.verdict == "unreadable"
        assert (
            lost.reason == "line 3: model://gone was not found; name the folder that holds it with --packages"
        )
        assert robot.notes == ("https://example.org/sun is not judged: nothing is fetched from a network",)

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("<sdf><model>", "part.xml: line 1: not well-formed XML"),
            ("<html/>", "line 3: the root of part.xml is <html>, not <sdf> or <robot>"),
            ('<!DOCTYPE x [<!ENTITY a "b">]><sdf/>', "part.xml: line 1: declares a document type"),
        ],
    )
    def test_what_cannot_be_read_is_one_too(self, tmp_path: Path, text: str, says: str) -> None:
        include = "<include><uri>part.xml</uri></include>"
        main = write(tmp_path, main_sdf=sdf(LINK.format("own", 0.02, SPHERE), include), part_xml=text)
        own, lost = judged(main).values()
        assert (own.verdict, lost.verdict) == ("good", "unreadable")
        assert lost.reason.startswith("line 3: ")
        assert says in lost.reason

    def test_what_is_mjcf_is_told(self, tmp_path: Path) -> None:
        include = "<include><uri>part.xml</uri></include>"
        text = WORLD.format("", "<body/>")
        robot = robots.read_robot(write(tmp_path, main_sdf=sdf('<link name="own"/>', include), part_xml=text))
        assert [link.name for link in robot.links] == ["own"]
        assert robot.notes[1] == "part.xml is not judged: it is MJCF, to be checked for itself"

    def test_a_model_within_itself_is_refused(self, tmp_path: Path) -> None:
        main = write(tmp_path, main_sdf=sdf("<include><uri>main.sdf</uri></include>"))
        with pytest.raises(FileFormatError, match=r"line 1 of main\.sdf: main\.sdf is read within itself"):
            judged(main)


class TestSdf12:
    """SDF 1.2 has the root <gazebo>, and <filename> where later versions have <uri>."""

    def test_it_is_read_as_later_ones(self, tmp_path: Path) -> None:
        later = sdf(LINK.format("own", 0.02, SPHERE))
        old = later.replace('<sdf version="1.9">', '<gazebo version="1.2">').replace("</sdf>", "</gazebo>")
        assert old != later
        (verdict,) = judged(write(tmp_path, old_world=old)).values()
        (same,) = judged(write(tmp_path, later_sdf=later)).values()
        assert (verdict.verdict, verdict.mass) == (same.verdict, same.mass) == ("good", same.mass)

    def test_meshes_by_filename(self, tmp_path: Path) -> None:
        (tmp_path / "cube.obj").write_bytes(obj(*cube()))
        shape = "<mesh><{0}>cube.obj</{0}><scale>0.1 0.1 0.1</scale></mesh>"
        volumes = []
        for tag in ("uri", "filename"):
            text = sdf(LINK.format("own", 0.02, shape.format(tag)))
            (verdict,) = judged(write(tmp_path, main_sdf=text)).values()
            volumes.append(moments(verdict))
        np.testing.assert_array_equal(volumes[0], volumes[1])

    @pytest.mark.parametrize("version", ["", ' version="1.0"'])
    def test_older_ones_are_refused(self, tmp_path: Path, version: str) -> None:
        old = f"<gazebo{version}><model name='m'><link name='a'/></model></gazebo>"
        path = write(tmp_path, old_sdf=old)
        with pytest.raises(FileFormatError, match=r"is SDF before 1\.2, .*; export it as SDF 1\.2 or later"):
            robots.read_robot(path)
        include = "<include><uri>old.sdf</uri></include>"
        main = write(tmp_path, main_sdf=sdf(LINK.format("own", 0.02, SPHERE), include))
        _, lost = judged(main).values()
        assert "old.sdf: is SDF before 1.2" in lost.reason
