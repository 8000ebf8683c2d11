"""``polhode check --format sarif`` and ``lines``: places of the offending numbers, laws, fixes as edits."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, get_args

import jsonschema
import pytest
from command_line import run
from polhode import robots
from polhode.robots.findings import LAWS
from polhode.robots.verdict import Law
from robot_texts import BALL, CUBE, HINGE, ROUND, bare, joint, link, mjcf, sdf, slink, urdf, weighed
from sarif_log import SCHEMA, apply_fixes

VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
JOINED = joint("base", "a")
#: A text, the law that its one finding breaks, and the words at its place.
ROWS = {
    "triangle inequality": (urdf(link("a", 5.0, (1.0, 1.5, 9.0))), "triangle-inequality", "9.0"),
    "negative moment": (urdf(link("a", 5.0, (-0.25, 1.5, 1.5))), "moments", "-0.25"),
    "mass": (urdf(link("a", -5.0, 1.5)), "mass", "-5.0"),
    "placeholder": (urdf(link("a", 5.0, 1.0, BALL)), "placeholder", "1.0"),
    "missing": (urdf(bare("base"), bare("a", BALL), JOINED), "missing-mass", "a"),
    "missing zeros": (urdf(bare("base"), link("a", 0.0, 0.0, BALL), JOINED), "missing-mass", "0.0"),
    "not a number": (urdf(link("a", 5.0, 2.0).replace('"5.0"', '"five"')), "unreadable", "five"),
    "not a shape": (urdf(link("a", 5.0, 2.0, '<sphere radius="r"/>')), "unreadable", "r"),
    "no number": (urdf(link("a", 5.0, 2.0).replace(' ixx="2.0"', "")), "unreadable", "inertia"),
    "center": (urdf(link("a", 5.0, (0.02, 0.021, 0.022), BALL, at="2 0 0")), "center-of-mass", "2 0 0"),
    "room": (urdf(link("a", 5.0, (900.0, 901.0, 902.0), BALL)), "room", "902.0"),
    "sdf": (sdf(slink("a", weighed(5, 1), ROUND)), "placeholder", "1"),
    "sdf negative": (
        sdf(slink("a", weighed(5, 2).replace("<iyy>2", "<iyy> -3 "), ROUND)),
        "moments",
        "-3",
    ),
    "sdf defaults": (sdf(slink("a", "<inertial/>", ROUND)), "placeholder", "inertial"),
    "sdf word": (sdf(slink("a", weighed(5, 2).replace("<mass>5", "<mass>x"), ROUND)), "unreadable", "x"),
    "mjcf": (
        mjcf(f'<body name="a">{HINGE}<inertial pos="0 0 0" mass="5" diaginertia="1 2  9"/></body>'),
        "triangle-inequality",
        "9",
    ),
    "mjcf full": (
        mjcf(f'<body name="a">{HINGE}<inertial pos="0 0 0" mass="5" fullinertia="1 9 2 0 0 0"/></body>'),
        "triangle-inequality",
        "9",
    ),
    "mjcf mass": (
        mjcf(f'<body name="a">{HINGE}<inertial pos="0 0 0" mass="-1" diaginertia="1 1 1"/></body>'),
        "mass",
        "-1",
    ),
}  # fmt: skip


def sarif(*arguments: object) -> tuple[int, dict[str, Any]]:
    """Exit code, and the run of a log that is valid."""
    code, out, _ = run("check", *arguments, "--format", "sarif")
    found = json.loads(out)
    VALIDATOR.validate(found)
    (one,) = found["runs"]
    for result in one["results"]:
        assert one["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == result["ruleId"]
    return code, one


def words_at(source: str, region: dict[str, int]) -> str:
    line = source.split("\n")[region["startLine"] - 1]
    assert region["endLine"] == region["startLine"]
    found = line[region["startColumn"] - 1 : region["endColumn"] - 1]
    end = region["byteOffset"] + region["byteLength"]
    assert source.encode()[region["byteOffset"] : end].decode() == found
    return found


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_the_place_is_that_of_the_offending_number(row: tuple[str, str, str], tmp_path: Path) -> None:
    text, law, words = row
    spread = text.replace("><", ">\n  <")
    path = tmp_path / "r.xml"
    path.write_text(spread)
    code, found = sarif(path)
    (result,) = found["results"]
    assert (code, result["ruleId"], result["level"]) == (1, law, "error")
    place = result["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == path.as_uri()
    assert words_at(spread, place["region"]) == words
    assert result["message"]["text"].startswith("a: ")


@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
@pytest.mark.parametrize("dress", ["plain", "dressed"])
def test_the_fixes_are_what_fix_writes(row: tuple[str, str, str], dress: str, tmp_path: Path) -> None:
    text = row[0].replace("><", ">\n<")
    source = text.encode()
    if dress == "dressed":  # a mark, lines of Windows; two units of UTF-16, four bytes, before the numbers
        for tag in ("<inertial", "<mass", "<diaginertia"):
            text = text.replace(tag, f"<!-- \U0001f9be \u00fc -->{tag}")
        source = b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode()
    path = tmp_path / "r.xml"
    path.write_bytes(source)
    filling = ["--density", "1000"]
    _, found = sarif(path, *filling)
    run("check", path, *filling, "--fix", tmp_path / "fixed.xml")
    fixed = (tmp_path / "fixed.xml").read_bytes()
    assert apply_fixes(source, found) == fixed
    # Edits of lines at whose numbers nothing is wrong would be no edits of that finding.
    before, after = source.split(b"\n"), fixed.split(b"\n")
    touched = {
        number
        for result in found["results"]
        for fix in result.get("fixes", [])
        for one in fix["artifactChanges"][0]["replacements"]
        for number in range(one["deletedRegion"]["startLine"], one["deletedRegion"]["endLine"] + 1)
    }
    if len(before) == len(after):
        assert {i + 1 for i, (x, y) in enumerate(zip(before, after, strict=True)) if x != y} <= touched


def test_tensors_on_the_edge_are_notes_with_a_fix(tmp_path: Path) -> None:
    path = tmp_path / "plate.urdf"
    path.write_text(urdf(link("a", 5.0, (0.1, 0.2, 0.3))))
    code, found = sarif(path)
    (result,) = found["results"]
    assert (code, result["ruleId"], result["level"]) == (0, "edge", "note")
    run("check", path, "--fix", tmp_path / "out.urdf")
    assert apply_fixes(path.read_bytes(), found) == (tmp_path / "out.urdf").read_bytes() != path.read_bytes()


def test_what_is_suspect_warns_and_is_fixed_only_when_it_fails(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(urdf(link("a", 5.0, 0.001, BALL)))
    for strict, level in (((), "warning"), (("--strict",), "error")):
        code, found = sarif(path, *strict)
        (result,) = found["results"]
        assert (result["ruleId"], result["level"], code) == ("shape", level, int(bool(strict)))
        assert ("fixes" in result) == bool(strict)


def test_included_files_are_named_and_not_fixed(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(mjcf('<include file="parts/hand.xml"/>'))
    (tmp_path / "parts").mkdir()
    body = f'<body name="a">{HINGE}\n<inertial pos="0 0 0" mass="5" diaginertia="1 2 9"/></body>'
    (tmp_path / "parts" / "hand.xml").write_text(f"<mujocoinclude>{body}</mujocoinclude>")
    code, found = sarif(tmp_path / "arm.xml")
    (result,) = found["results"]
    place = result["locations"][0]["physicalLocation"]
    assert code == 1
    assert place["artifactLocation"]["uri"].endswith("/parts/hand.xml")
    assert place["region"]["startLine"] == 2
    assert "fixes" not in result


def test_a_body_with_an_included_inertial_is_not_rewritten(tmp_path: Path) -> None:
    """Its numbers stand in another file, at other bytes."""
    inertial = '<inertial pos="0 0 0" mass="5" diaginertia="1 2 9"/>'
    (tmp_path / "own.xml").write_text(f"<mujocoinclude>{inertial}</mujocoinclude>")
    path = tmp_path / "arm.xml"
    path.write_text(mjcf(f'<body name="a"><include file="own.xml"/>{HINGE}</body>'))
    robot = robots.read_robot(path)
    assert robots.fix(robot, robots.check(robot)) == robot.source
    _, found = sarif(path)
    assert (
        words_at(path.read_text(), found["results"][0]["locations"][0]["physicalLocation"]["region"]) == "a"
    )


def test_paths_are_relative_to_where_the_command_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my robots").mkdir()
    path = Path("my robots", "[r].urdf")
    path.write_text(urdf(link("[a](b)", 5.0, 1.0, BALL)))
    _, found = sarif(path)
    (result,) = found["results"]
    place = result["locations"][0]["physicalLocation"]["artifactLocation"]
    assert place == {"uri": "my%20robots/%5Br%5D.urdf", "uriBaseId": "%SRCROOT%"}
    assert found["originalUriBaseIds"]["%SRCROOT%"]["uri"] == f"{tmp_path.as_uri()}/"
    assert result["message"]["text"].startswith(r"\[a\](b): 1 1 1 is the unit tensor")
    code, out, _ = run("check", path, "--format", "lines")
    first, last = out.splitlines()
    assert first.startswith("my robots/[r].urdf:1:")
    assert first.endswith("[placeholder]")
    assert (code, last) == (1, f"{path}: bad: 1 of 1 links fail (1 placeholder)")


def test_the_name_of_the_output_tells_the_form(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(urdf(link("a", 5.0, 1.0, BALL)))
    assert run("check", path, "--output", tmp_path / "out.sarif")[:2] == (1, "")
    VALIDATOR.validate(json.loads((tmp_path / "out.sarif").read_text()))


def test_every_law_is_a_rule_with_help() -> None:
    assert set(LAWS) - {"edge"} == set(get_args(Law)) - {""}
    assert {law for _, law, _ in ROWS.values()} == set(LAWS) - {"edge", "shape", "density"}
    assert all(rule.says.endswith(".") and rule.way_out.endswith(".") for rule in LAWS.values())


class TestSeveral:
    def test_verdicts_come_one_after_the_other(self, tmp_path: Path) -> None:
        good, bad = tmp_path / "good.urdf", tmp_path / "bad.urdf"
        good.write_text(urdf(link("a", 5.0, 0.02, BALL)))
        bad.write_text(urdf(link("a", 5.0, 1.0, BALL)))
        code, out, _ = run("check", good, bad)
        assert code == 1
        assert out.splitlines()[-1].strip() == f"bad: 1 of 2 robots failed: {bad}"
        code, out, _ = run("check", good, bad, "--format", "json")
        found = json.loads(out)
        assert [each["verdict"] for each in found["robots"]] == ["good", "bad"]
        assert (code, found["verdict"]) == (1, "bad")
        assert run("check", good, good)[0] == 0
        code, log = sarif(good, bad)
        assert (code, len(log["artifacts"]), len(log["results"])) == (1, 2, 1)

    def test_only_robots_passes_over_others(self, tmp_path: Path) -> None:
        package, robot = tmp_path / "package.xml", tmp_path / "r.xml"
        package.write_text("<package/>")
        robot.write_text(urdf(link("a", 5.0, 1.0, BALL)))
        code, _, err = run("check", package, robot)
        assert code == 2
        assert "its root is <package>" in err
        assert run("check", package, robot, "--only-robots")[0] == 1
        assert run("check", package, "--only-robots", "--format", "lines")[:2] == (
            0,
            "good: 0 of 0 robots failed; files that are no robots: 1\n",
        )
        package.write_text('<!DOCTYPE html [<!ENTITY a "b">]><html/>')
        assert run("check", package, "--only-robots")[0] == 0
        robot.write_text("<robot><link")
        assert run("check", package, robot, "--only-robots")[0] == 2

    def test_a_copy_is_of_one(self, tmp_path: Path) -> None:
        path = tmp_path / "r.urdf"
        path.write_text(urdf(link("a", 5.0, 1.0, BALL)))
        code, _, err = run("check", path, path, "--fix", tmp_path / "out.urdf")
        assert code == 2
        assert "--fix: it writes a copy of one robot, and 2 were named" in err


class TestBaseline:
    @pytest.fixture
    def robot(self, tmp_path: Path) -> Path:
        path = tmp_path / "robots" / "r.urdf"
        path.parent.mkdir()
        path.write_text(urdf(bare("base", CUBE), link("a", 5.0, 1.0, BALL), JOINED))
        assert run("check", path, "--baseline", tmp_path / "known.json", "--accept")[0] == 0
        return path

    @pytest.mark.usefixtures("robot")
    def test_holds_file_link_and_law(self, tmp_path: Path) -> None:
        found = json.loads((tmp_path / "known.json").read_text())
        assert found["accepted"] == [{"file": "robots/r.urdf", "link": "a", "law": "placeholder"}]

    def test_lines_and_numbers_may_change(self, robot: Path, tmp_path: Path) -> None:
        robot.write_text(
            "<!-- moved -->\n\n" + robot.read_text().replace('mass value="5.0"', 'mass value="6"')
        )
        code, out, _ = run("check", robot, "--baseline", tmp_path / "known.json", "--format", "lines")
        assert (code, out) == (0, f"{robot}: good: 0 of 2 links fail; the baseline accepts 1 more\n")
        _, log = sarif(robot, "--baseline", tmp_path / "known.json")
        (result,) = log["results"]
        assert result["baselineState"] == "unchanged"
        assert result["suppressions"][0]["status"] == "accepted"

    def test_another_law_of_the_link_is_new(self, robot: Path, tmp_path: Path) -> None:
        robot.write_text(robot.read_text().replace('izz="1.0"', 'izz="9.0"'))
        code, log = sarif(robot, "--baseline", tmp_path / "known.json")
        (result,) = log["results"]
        assert (code, result["ruleId"], result["baselineState"]) == (1, "triangle-inequality", "new")

    def test_another_link_is_new(self, robot: Path, tmp_path: Path) -> None:
        text = robot.read_text().replace("</robot>", link("b", 5.0, 1.0, BALL) + joint("a", "b") + "</robot>")
        robot.write_text(text)
        code, out, _ = run("check", robot, "--baseline", tmp_path / "known.json", "--format", "json")
        found = json.loads(out)
        assert (code, found["count"]["failing"], found["count"]["accepted"]) == (1, 1, 1)

    def test_an_included_robot_is_accepted_once_for_all_that_include_it(self, tmp_path: Path) -> None:
        hand = tmp_path / "hand.sdf"
        hand.write_text(sdf(slink("palm", weighed(5, 1), ROUND)))
        known = tmp_path / "known.json"
        assert run("check", hand, "--baseline", known, "--accept")[0] == 0
        two = "".join(
            f"<include><uri>hand.sdf</uri><name>{side}</name></include>" for side in ("left", "right")
        )
        arm = tmp_path / "arm.sdf"
        arm.write_text(sdf(two))
        assert run("check", arm)[0] == 1
        assert run("check", arm, "--baseline", known)[0] == 0
        hand.write_text(sdf(slink("palm", weighed(5, 1), ROUND), slink("tip", weighed(5, 1), ROUND)))
        assert run("check", arm, "--baseline", known)[0] == 1

    def test_of_bodies_without_a_name_it_knows_no_lines(self, tmp_path: Path) -> None:
        path, known = tmp_path / "m.xml", tmp_path / "known.json"
        bad = f'<body>{HINGE}<inertial pos="0 0 0" mass="5" diaginertia="1 2 9"/></body>'
        path.write_text(mjcf(bad))
        assert run("check", path, "--baseline", known, "--accept")[0] == 0
        path.write_text("<!-- moved -->\n" + mjcf(bad))
        assert run("check", path, "--baseline", known)[0] == 0
        path.write_text(mjcf(bad, bad))
        assert run("check", path, "--baseline", known)[0] == 1

    def test_accept_renews_what_was_checked_and_keeps_the_rest(self, robot: Path, tmp_path: Path) -> None:
        known = tmp_path / "known.json"
        other = tmp_path / "s.urdf"
        other.write_text(urdf(link("c", 5.0, 1.0, BALL)))
        assert run("check", other, "--baseline", known, "--accept")[0] == 0
        robot.write_text(urdf(link("a", 5.0, 0.02, BALL)))
        code, out, _ = run("check", robot, "--baseline", known, "--accept")
        assert code == 0
        assert f"wrote {known}, which accepts 1 finding" in " ".join(out.split())
        assert [each["link"] for each in json.loads(known.read_text())["accepted"]] == ["c"]

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("{", "is not JSON"),
            ("[]", "is no baseline"),
            ('{"format": "polhode baseline", "version": 2}', "has version 2, not 1"),
            ('{"format": "polhode baseline", "version": 1}', "entry 0 of accepted"),
            (
                '{"format": "polhode baseline", "version": 1, "accepted": [{"file": 1}]}',
                "entry 0 of accepted",
            ),
        ],
    )
    def test_others_are_refused(self, robot: Path, tmp_path: Path, text: str, says: str) -> None:
        (tmp_path / "known.json").write_text(text)
        code, _, err = run("check", robot, "--baseline", tmp_path / "known.json")
        assert code == 2
        assert says in err

    def test_the_file_is_named(self, robot: Path) -> None:
        code, _, err = run("check", robot, "--accept")
        assert code == 2
        assert "name its file with --baseline FILE" in err


PARTS = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="ball" params="name mass">
    <link name="${name}">
      <inertial><mass value="${mass}"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><geometry><sphere radius="0.1"/></geometry></collision>
    </link>
    <joint name="j_${name}" type="fixed"><parent link="base"/><child link="${name}"/></joint>
  </xacro:macro>
  <xacro:macro name="side" params="side">
    <xacro:ball name="${side}_ball" mass="$(arg mass)"/>
  </xacro:macro>
</robot>
"""
ARM = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm">
  <xacro:arg name="mass" default="5"/>
  <xacro:include filename="$(find arm_parts)/parts.xacro"/>
  <link name="base"/>
  <xacro:side side="left"/>
  <xacro:side side="right"/>
</robot>
"""


class TestMacros:
    @pytest.fixture
    def arm(self, tmp_path: Path) -> Path:
        pytest.importorskip("xacro")
        (tmp_path / "arm_parts").mkdir()
        (tmp_path / "arm_parts" / "package.xml").write_text("<package><name>arm_parts</name></package>")
        (tmp_path / "arm_parts" / "parts.xacro").write_text(PARTS)
        path = tmp_path / "arm.xacro"
        path.write_text(ARM)
        return path

    def test_findings_name_file_and_macro_calls(self, arm: Path) -> None:
        code, found = sarif(arm)
        assert code == 1
        assert len(found["results"]) == 2
        for result, side, line in zip(found["results"], ("left", "right"), (5, 6), strict=True):
            place = result["locations"][0]["physicalLocation"]
            assert place["artifactLocation"]["uri"].endswith("/arm_parts/parts.xacro")
            assert words_at(PARTS, place["region"]) == "1"
            assert place["region"]["startLine"] == 5
            calls = (
                f"<xacro:side> in line {line} of arm.xacro, <xacro:ball> in line 11 of arm_parts/parts.xacro"
            )
            assert result["message"]["text"].startswith(f"{side}_ball: 1 1 1 is the unit tensor")
            assert result["message"]["text"].endswith(f"it comes from {calls}")
            assert "fixes" not in result

    def test_verdicts_are_those_of_the_expanded_file(self, arm: Path, tmp_path: Path) -> None:
        import xacro

        robot = robots.read_robot(arm, arguments={"mass": "7"})
        assert [link.inertial.mass for link in robot.links[1:] if link.inertial] == [7.0, 7.0]
        arm.write_text(ARM.replace("$(find arm_parts)", str(tmp_path / "arm_parts")))
        expanded = tmp_path / "out.urdf"
        expanded.write_text(xacro.process_file(str(arm), mappings={"mass": "7"}).toprettyxml(indent="  "))
        plain = robots.check(robots.read_robot(expanded))
        assert [(v.name, v.verdict, v.reason) for v in robots.check(robot)] == [
            (v.name, v.verdict, v.reason) for v in plain
        ]

    def test_arguments_come_from_the_command(self, arm: Path) -> None:
        _, out, _ = run("check", arm, "--arguments", "mass:=8", "--format", "json")
        assert [row["mass"] for row in json.loads(out)["links"]] == [None, 8.0, 8.0]
        code, _, err = run("check", arm, "--arguments", "mass=8")
        assert code == 2
        assert "write it as name:=value" in err

    def test_a_copy_is_refused(self, arm: Path, tmp_path: Path) -> None:
        code, _, err = run("check", arm, "--fix", tmp_path / "out.urdf")
        assert code == 2
        assert f"xacro {arm} > out.urdf" in err

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ("$(arg mass)", "${mess}", "xacro refuses it: name 'mess' is not defined"),
            ("arm_parts)", "nowhere)", "xacro refuses it"),
            ("</robot>", "<link></robot>", "mismatched tag"),
            ("<robot ", '<!DOCTYPE r [<!ENTITY a "b">]><robot ', "declares a document type"),
        ],
    )
    def test_what_xacro_refuses_is_an_error(self, arm: Path, old: str, new: str, says: str) -> None:
        for path in (arm, arm.parent / "arm_parts" / "parts.xacro"):
            path.write_text(path.read_text().replace(old, new))
        code, _, err = run("check", arm)
        assert code == 2
        assert says in err
        assert err.count("\n") == 1

    def test_without_xacro_the_message_says_why(self, arm: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        import sys

        monkeypatch.setitem(sys.modules, "xacro", None)
        code, _, err = run("check", arm)
        assert code == 2
        assert 'needs xacro: pip install "polhode[xacro]"' in err
        assert f"expand it first: xacro {arm} > out.urdf" in err


def test_verdicts_and_fixes_of_a_public_robot(shared_data: Path, tmp_path: Path) -> None:
    path = shared_data / "urdf" / "07-physics.urdf"
    _, out, _ = run("check", path, "--format", "json")
    code, found = sarif(path)
    rows = [(row["link"], row["verdict"]) for row in json.loads(out)["links"] if row["law"]]
    names = [each["locations"][0]["logicalLocations"][0]["fullyQualifiedName"] for each in found["results"]]
    assert (code, [*zip(names, (r["properties"]["verdict"] for r in found["results"]), strict=True)]) == (
        1,
        rows,
    )
    run("check", path, "--fix", tmp_path / "out.urdf")
    assert apply_fixes(path.read_bytes(), found) == (tmp_path / "out.urdf").read_bytes()
