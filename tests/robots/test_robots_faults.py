"""Robots with one bad item, and files that are not to be trusted."""

from __future__ import annotations

import contextlib
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polhode import robots
from polhode.errors import FileFormatError
from three_formats import FORMATS, PLAIN, there


class TestOneBadItem:
    """It ends the verdict of its own link alone, which says in which line it stands."""

    BAD = ("nan", "1e999", "-inf", "1e300", "", "0x1", "1_0", "heavy", "1 2 3 4 5 6 7 8", "9" * 100_000)

    @pytest.mark.parametrize("value", BAD, ids=lambda value: value[:9])
    @pytest.mark.parametrize("format_name", FORMATS)
    def test_of_numbers(self, format_name: str, value: str) -> None:
        right = FORMATS[format_name].format_map(PLAIN)
        places = {
            "URDF": ("0 0 0.1", "value='3'", 'iyz="0"', "0.4 0.5", 'size="0.2', 'radius="0.1"'),
            "SDF": ("0 0 0.1", "<mass>3", "<iyz>0", "0.4 0.5", "<size>0.2", "<radius>0.1"),
            "MJCF": ('pos="0 0 0.1', 'mass="3"', 'fullinertia="0.1', "0.4 0.5", '"0.1 0.15', 'size="0.1"'),
        }[format_name]
        other = {
            "URDF": ("</robot>", '<link name="two"/></robot>'),
            "SDF": ("</model>", '<link name="two"/></model>'),
            "MJCF": ("</worldbody>", '<body name="two"/></worldbody>'),
        }[format_name]
        for place in places:
            last = re.split(r"[^\d. ]", place.rstrip("\"'"))[-1]
            text = right.replace(place, place.replace(last, value, 1)).replace(*other)
            assert text != right
            robot = robots.parse_robot(text.encode(), name="r", folder=".")
            one, two = robots.check(robot)
            assert (two.name, two.verdict) == ("two", "placeholder" if format_name == "SDF" else "none")
            assert one.verdict == "unreadable"
            assert re.match(r"line \d+: .* (has|have) to stand$|line \d+: .*correct it$", one.reason)
            assert len(one.reason) < 300
            assert robots.fix(robot, [one, two]) == text.encode()

    @pytest.mark.parametrize(
        ("part", "says"),
        [
            ('<frame pos="nan 0 0"><body name="c"/></frame>', "line 2: pos is 'nan 0 0'"),
            ('<frame quat="0 0 0 0"><body name="c"/></frame>', "line 2: a direction of length zero"),
            ('<body name="c"><frame euler="1"><geom size="1"/></frame></body>', "line 2: euler is '1'"),
            ('<replicate count="2" offset="a"><body name="c"/></replicate>', "line 2: pos is 'a'"),
            (
                '<body name="c"><geom type="capsule" fromto="0 0 0 0 0 1"/></body>',
                "line 2: a geom of type capsule",
            ),
            (
                '<body name="c"><geom xyaxes="1 0 0 2 0 0" size="1"/></body>',
                "line 2: a direction of length zero",
            ),
        ],
    )
    def test_of_frames(self, part: str, says: str) -> None:
        text = f'<mujoco><worldbody><body name="a"/>\n{part}\n<body name="d"/></worldbody></mujoco>'
        verdicts = robots.check(robots.parse_robot(text.encode(), name="m", folder="."))
        found = {verdict.name: verdict for verdict in verdicts}
        assert [found[name].verdict for name in "acd"] == ["none", "unreadable", "none"]
        assert found["c"].reason.startswith(says)

    def test_of_angles_in_an_order_that_is_not_read(self) -> None:
        text = """<mujoco><compiler eulerseq="xYz"/><worldbody><body name="a"/>
            <body name="b"><geom size="1" euler="1 2 3"/></body></worldbody></mujoco>"""
        verdicts = robots.check(robots.parse_robot(text.encode(), name="m", folder="."))
        assert [verdict.verdict for verdict in verdicts] == ["none", "unreadable"]
        assert verdicts[1].reason.startswith("line 2: euler by eulerseq 'xYz', which is not read")

    def test_a_pose_of_no_numbers_is_not_one_in_another_frame(self) -> None:
        text = """<sdf><model><link name="a"><collision><pose>0 0 0 nan 0 0</pose><geometry><box>
            <size>1 1 1</size></box></geometry></collision></link></model></sdf>"""
        (verdict,) = robots.check(robots.parse_robot(text.encode(), name="s", folder="."))
        assert verdict.reason.startswith("line 1: pose is '0 0 0 nan 0 0'")

    def test_a_quaternion_of_any_length_is_a_rotation(self) -> None:
        text = """<sdf><model><link name="a"><inertial>
            <pose rotation_format="quat_xyzw">0 0 0 {} 0 0 {}</pose>
            <inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial></link></model></sdf>"""
        for size in (1e-45, 1e-3, 1.0, 1e45):
            source = text.format(size, size).encode()
            (link,) = robots.parse_robot(source, name="s", folder=".").links
            np.testing.assert_allclose(
                there(link.inertial).inertia, np.diag([1.0, 2.5, 2.0]), rtol=0, atol=1e-15
            )

    @pytest.mark.parametrize("mass", ["1e-320", "1e-50", "1e50"])
    @pytest.mark.parametrize("size", ["1e-50", "1e-20", "1e50"])
    def test_of_sizes_that_numbers_hardly_hold(self, mass: str, size: str) -> None:
        text = f"""<robot><link name="a"><inertial><mass value="{mass}"/><inertia ixx="1e-50" iyy="1e-50"
            izz="1e-50" ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry><box size="{size} {size} 1"/>
            </geometry></visual></link><link name="b"/></robot>"""
        robot = robots.parse_robot(text.encode(), name="r", folder=".")
        one, two = robots.check(robot)
        assert (one.mass, two.verdict) == (float(mass), "none")
        assert len(one.reason) < 300
        robots.check(robots.parse_robot(robots.fix(robot, [one, two]), name="r", folder="."))


class TestSafety:
    BOMB = b"""<?xml version="1.0"?><!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;">
        <!ENTITY c "&b;&b;&b;&b;">]><robot name="&c;"><link name="a"/></robot>"""

    @pytest.mark.parametrize(
        "text",
        [
            BOMB,
            b'<!DOCTYPE robot SYSTEM "http://localhost/robot.dtd"><robot name="r"><link name="a"/></robot>',
            b'<!DOCTYPE r [<!ENTITY f SYSTEM "file:///etc/hostname">]><robot><link name="&f;"/></robot>',
        ],
    )
    def test_entities_are_refused(self, text: bytes) -> None:
        with pytest.raises(FileFormatError, match="remove the declaration"):
            robots.parse_robot(text, name="r", folder=".")

    def test_depth_is_bounded(self) -> None:
        text = b"<robot>" + b"<link>" * 100_000
        with pytest.raises(FileFormatError, match="nested"):
            robots.parse_robot(text, name="r", folder=".")

    @given(st.binary(max_size=300))
    def test_any_bytes_are_read_or_refused(self, data: bytes) -> None:
        for source in (data, b"<robot><link>" + data + b"</link></robot>"):
            with contextlib.suppress(FileFormatError):
                robots.check(robots.parse_robot(source, name="r", folder="."))

    @given(st.data())
    def test_a_damaged_robot_is_read_or_refused(self, data: st.DataObject) -> None:
        """Any byte of a right file may be any other."""
        source = bytearray(data.draw(st.sampled_from(sorted(FORMATS.values()))).format_map(PLAIN).encode())
        for _ in range(data.draw(st.integers(1, 4))):
            source[data.draw(st.integers(0, len(source) - 1))] = data.draw(st.integers(32, 126))
        with contextlib.suppress(FileFormatError):
            robot = robots.parse_robot(bytes(source), name="r", folder=".")
            robots.fix(robot, robots.check(robot))


def test_what_a_urdf_says_twice_or_amiss_is_told() -> None:
    numbers = '<mass value="1"/><inertia ixx="1" iyy="1.1" izz="1.2" ixy="0" ixz="0" iyz="0"'
    right = f'<robot name="r">\n<link name="a"><inertial>{numbers}/></inertial></link>\n</robot>'
    assert robots.parse_robot(right.encode(), name="r", folder=".").notes == ()
    told = {
        'iyz="0" iyx="3" Ixx="1"/>': "line 2: link 'a': <inertia> has Ixx, iyx, which no parser reads",
        'iyz="0"/></inertial>\n<inertial>': "line 3: <inertial> again in link 'a'; only the first is read",
        'iyz="0"/></inertial></link>\n<link name="a"><inertial>': "line 3: link 'a' again; parsers refuse",
    }
    for text, note in told.items():
        wrong = right.replace('iyz="0"/>', text)
        (said,) = robots.parse_robot(wrong.encode(), name="r", folder=".").notes
        assert said.startswith(note)
