"""Robots that would grow without end, or take a time out of proportion: stated limits, and linear reading."""

from __future__ import annotations

import io
import math
import time
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import one_line, run
from polhode import robots
from polhode.errors import FileFormatError
from polhode.io.budget import LIMITS
from polhode.io.xml_source import Edit, apply_edits, parse_xml
from polhode.robots.sources import read_source, read_stream

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

INERTIAL = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
WORLD = "<mujoco>{}<worldbody>{}</worldbody></mujoco>"


def limited(monkeypatch: pytest.MonkeyPatch, kind: str, most: int) -> None:
    """Set a limit of the budget, whatever the size of the file."""
    monkeypatch.setitem(LIMITS, kind, LIMITS[kind]._replace(least=most, per_byte=0.0))


def parsed(text: str) -> robots.Robot:
    return robots.parse_robot(text.encode(), name="r", folder=".")


def link(number: int) -> str:
    return f"""<link name="l{number}"><inertial><mass value="1"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def read_and_fixed(text: str) -> Callable[[], object]:
    def work() -> None:
        robot = parsed(text)
        better = robots.Inertial(2.0, np.zeros(3), np.diag([1.0, 2.0, 2.5]))
        found = robots.Verdict("", 1, "impossible", "", better=better)
        verdicts = [found for _ in robot.links]
        robots.fix(robot, verdicts)

    return work


GEOM = '<geom mesh="m"/>'
QUOTED = 'a{}=""'.format
TEXTS: dict[str, Callable[[int], str]] = {
    "newlines": lambda n: f"<robot><link>{chr(10) * n}</link></robot>",
    "character references": lambda n: f"<robot><link>{'&#10;' * (n // 5)}</link></robot>",
    "sections": lambda n: f"<robot><link>{'<![CDATA[x]]>' * (n // 13)}</link></robot>",
    "texts between children": lambda n: f"<robot><link>{'<a/>x' * (n // 5)}</link></robot>",
    "comments": lambda n: f"<robot><link>{'<!---->x' * (n // 8)}</link></robot>",
    "one comment": lambda n: f"<robot><link><!--{'x' * n}--></link></robot>",
    "one value": lambda n: f'<robot><link name="{"x" * n}"/></robot>',
    "attributes": lambda n: f"<robot><link {' '.join(map(QUOTED, range(n // 9)))}/></robot>",
    "blanks in a tag": lambda n: f"<robot><link{chr(10) * n}/></robot>",
    "lines": lambda n: "<robot>" + "<link/>\n" * (n // 8) + "</robot>",
    "links to be fixed": lambda n: "<robot>" + "".join(map(link, range(n // 160))) + "</robot>",
    "default classes": lambda n: WORLD.format(
        "<default><geom "
        + " ".join(map(QUOTED, range(n // 16)))
        + "/>"
        + "".join(f'<default class="{i}"/>' for i in range(n // 48))
        + "</default>",
        f"<body>{INERTIAL}</body>",
    ),
    "meshes in a long folder": lambda n: WORLD.format(
        f'<compiler meshdir="{"m" * (n // 2)}"/><asset><mesh name="m" file="m.stl"/></asset>',
        f"<body>{INERTIAL}{GEOM * (n // 36)}</body>",
    ),
    "numbers of a class": lambda n: WORLD.format(
        f'<default><geom size="{"1 " * (n // 4)}"/></default>',
        "<body><geom/></body>" * (n // 40),
    ),
}


@pytest.mark.parametrize("name", TEXTS)
def test_time_is_in_proportion_to_length(name: str) -> None:
    """Eight times the text takes eight times the time; a quadratic path would take 64 times."""
    length = 32_000
    works = [(read_and_fixed(TEXTS[name](length)), 3), (read_and_fixed(TEXTS[name](8 * length)), 1)]
    best = [math.inf, math.inf]
    # Processor time; what else the machine does may slow one of them: the best of up to ten turns counts.
    for _ in range(10):
        for k, (work, count) in enumerate(works):
            for _ in range(count):
                start = time.process_time()
                work()
                best[k] = min(best[k], time.process_time() - start)
        if best[1] < 30.0 * max(best[0], 2e-3):
            return
    pytest.fail(f"{best[1]} s for eight times the text of {best[0]} s")


class TestEdits:
    def test_they_are_those_of_one_after_the_other(self, rng: np.random.Generator) -> None:
        for _ in range(200):
            source = bytes(rng.integers(97, 123, 60, dtype=np.uint8))
            places = np.sort(rng.choice(61, 12, replace=False)).tolist()
            edits = [
                Edit(start, end if rng.random() < 0.7 else start, "X" * int(rng.integers(0, 4)))
                for start, end in zip(places[::2], places[1::2], strict=True)
            ]
            want = source
            for edit in reversed(edits):
                want = want[: edit.start] + edit.text.encode() + want[edit.end :]
            assert apply_edits(source, [edits[i] for i in rng.permutation(len(edits))]) == want

    def test_one_within_another_is_refused(self) -> None:
        with pytest.raises(ValueError, match="starts at byte 2, within another"):
            apply_edits(b"abcdef", [Edit(0, 3, ""), Edit(2, 4, "")])


class TestDepth:
    @pytest.mark.parametrize(
        ("opening", "closing", "text"),
        [
            ('<body name="b">', "</body>", WORLD.format("", "{}")),
            ("<frame>", "</frame>", WORLD.format("", '<body name="b">{}<geom size="1"/></body>')),
            ("<default class='c'>", "</default>", WORLD.format("{}", '<body name="b"/>')),
            ("<model>", "</model>", "<sdf>{}<model><static>1</static><link/></model></sdf>"),
            ("<model>", "</model>", "<robot><link/>{}</robot>"),
        ],
    )
    def test_up_to_the_limit_it_is_read(self, opening: str, closing: str, text: str, tmp_path: Path) -> None:
        path = tmp_path / "r.xml"
        for times, code in ((190, 0), (200, 2), (100_000, 2)):
            path.write_text(text.format(opening * times + closing * times))
            found, _, err = run("check", path)
            assert found == code
            assert code == 0 or f"{path}: line 1: elements are nested more than 200 deep" in err
            assert code == 0 or one_line(err)

    def test_copies_within_copies(self) -> None:
        opening = '<replicate count="1">' * 190
        text = WORLD.format("", f'<body>{INERTIAL}{opening}<geom size="1"/>{"</replicate>" * 190}</body>')
        assert len(parsed(text).links[0].shapes) == 1

    def test_files_within_files_count_together(self, tmp_path: Path) -> None:
        """Each of 60 models stands four elements deeper than the one that includes it."""
        for i in range(60):
            uri = f"<include><uri>m{i + 1}.sdf</uri></include>"
            (tmp_path / f"m{i}.sdf").write_text(
                f'<sdf><model name="m"><link/><model>{uri}</model></model></sdf>'
            )
        links = robots.check(robots.read_robot(tmp_path / "m0.sdf"))
        assert 45 < len(links) < 60
        assert {verdict.verdict for verdict in links[:-1]} == {"placeholder"}
        assert "elements are nested more than 200 deep" in links[-1].reason
        assert len(links[-1].reason) < 400
        for i in range(60):
            include = f'<a><a><a><include file="m{i + 1}.xml"/></a></a></a>'
            (tmp_path / f"m{i}.xml").write_text(
                WORLD.format("", include) if i == 0 else f"<x><body/>{include}</x>"
            )
        with pytest.raises(
            FileFormatError,
            match=r"line 1 of m\d+.xml: .*m\d+.xml: line 1: elements are nested more than 200",
        ):
            robots.read_robot(tmp_path / "m0.xml")


class TestCopies:
    def body(self, inner: str) -> str:
        return WORLD.format("", f'<body name="b">{INERTIAL}{inner}</body>')

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            (
                '<replicate count="9999">{2000}</replicate>',
                "line 2: there are more than 50000 elements in copies",
            ),
            (
                '<replicate count="9">\n<replicate count="9">{2000}</replicate></replicate>',
                "line 2: there are more than 50000 elements in copies",
            ),
            (
                25 * '<replicate count="2">' + "{1}" + 25 * "</replicate>",
                "line 2: there are more than 10000 copies",
            ),
            (
                12 * '<replicate count="2">' + "{100}" + 12 * "</replicate>",
                "more than 50000 elements in copies",
            ),
            ('<replicate count="1e40">{1}</replicate>', "line 2: there are more than 10000 copies"),
            (11 * '<replicate count="1000">{1}</replicate>', "line 2: there are more than 10000 copies"),
        ],
    )
    def test_they_end_before_they_are_made(self, text: str, says: str) -> None:
        number = text.partition("{")[2].partition("}")[0]
        start = time.process_time()
        with pytest.raises(FileFormatError, match="lower the count") as told:
            parsed(self.body("\n" + text.replace(f"{{{number}}}", '<geom size="1"/>' * int(number))))
        assert says in str(told.value)
        assert time.process_time() - start < 5.0

    def test_those_of_all_bodies_count_together(self, monkeypatch: pytest.MonkeyPatch) -> None:
        ten = '<replicate count="5"><replicate count="2"><geom size="1"/></replicate></replicate>'
        text = WORLD.format("", f"<body>{ten}</body>\n" * 6)
        limited(monkeypatch, "elements in copies", 60)
        assert len(parsed(text).links) == 6
        limited(monkeypatch, "elements in copies", 59)
        with pytest.raises(FileFormatError, match="line 6: there are more than 59 elements in copies"):
            parsed(text)

    def test_below_the_limits_all_are_made(self) -> None:
        four = '<replicate count="2"><replicate count="100">{}</replicate></replicate>'
        (one,) = parsed(self.body(four.format('<geom size="1"/>' * 3))).links
        assert len(one.shapes) == 600


class TestMany:
    @pytest.mark.parametrize("text", ["<robot>{}</robot>", "<sdf>{}</sdf>", WORLD.format("", "{}")])
    def test_elements_and_links(self, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
        one = "<body/>" if "mujoco" in text else "<link/>"
        source = text.format("\n" + 300 * one)
        assert len(parsed(source).links) == 300
        limited(monkeypatch, "links", 299)
        with pytest.raises(FileFormatError, match="r: line 2: there are more than 299 links; divide"):
            parsed(source)
        monkeypatch.undo()
        limited(monkeypatch, "elements", 300)
        with pytest.raises(FileFormatError, match="r: line 2: there are more than 300 elements"):
            parsed(source)

    def test_the_same_of_included_files(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """Ten in each of ten in each of ten: the numbers of files and of elements end it."""
        for i in range(4):
            inner = f"<include><uri>m{i + 1}.sdf</uri></include>" * 10
            (tmp_path / f"m{i}.sdf").write_text(f'<sdf><model name="m"><link/>{inner}</model></sdf>')
        (tmp_path / "m4.sdf").write_text('<sdf><model name="m"><link/></model></sdf>')
        links = robots.check(robots.read_robot(tmp_path / "m0.sdf"))
        lost = [verdict.reason for verdict in links if verdict.verdict == "unreadable"]
        assert "there are more than 1000 files; divide the model" in lost[0]
        limited(monkeypatch, "elements", 500)
        links = robots.check(robots.read_robot(tmp_path / "m0.sdf"))
        lost = [verdict.reason for verdict in links if verdict.verdict == "unreadable"]
        assert "there are more than 500 elements" in lost[0]
        limited(monkeypatch, "included bytes", 2000)
        links = robots.check(robots.read_robot(tmp_path / "m0.sdf"))
        assert any("more than" in verdict.reason and "bytes" in verdict.reason for verdict in links)

    def test_bytes(self, tmp_path: Path) -> None:
        (tmp_path / "r.urdf").write_text("<robot><link/></robot>")
        with pytest.raises(FileFormatError, match="has more than 10 bytes"):
            read_source(tmp_path / "r.urdf", 10)
        with pytest.raises(FileFormatError, match="standard input: has more than 10 bytes"):
            read_stream(io.BytesIO(b"n" * 11), "standard input", 10)
        assert read_stream(io.BytesIO(b"n" * 10), "standard input", 10) == b"n" * 10

    def test_names_do_not_multiply(self, tmp_path: Path) -> None:
        (tmp_path / "m.sdf").write_text(f"<sdf><model><static>1</static>{'<link/>' * 1000}</model></sdf>")
        include = f"<include><uri>m.sdf</uri><name>{'n' * 1_000_000}</name></include>"
        own = f'<link name="{"l" * 100_000}"/>'
        (tmp_path / "r.sdf").write_text(
            f'<sdf><model name="m"><static>true</static>{own}{include}</model></sdf>'
        )
        links = robots.read_robot(tmp_path / "r.sdf").links
        assert max(len(link.name) for link in links) < 1100
        assert links[0].name.endswith("l... (100000 characters)")
        code, out, _ = run("check", tmp_path / "r.sdf")
        assert code == 0
        assert len(out) < 4_000_000


class TestEncodings:
    @pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be", "utf-16", "utf-32"])
    def test_wide_characters_are_refused(self, encoding: str) -> None:
        source = '<?xml version="1.0"?><robot><link name="a"/></robot>'.encode(encoding)
        with pytest.raises(FileFormatError, match="r: is in UTF-16; save it as UTF-8"):
            robots.parse_robot(source, name="r", folder=".")

    @pytest.mark.parametrize("encoding", ["nothing", "hex", "big5", "utf-7", "cp037", "UTF-16"])
    def test_declared_ones_that_are_not_read(self, encoding: str) -> None:
        text = f'<?xml version="1.0" encoding="{encoding}"?><robot><link name="a"/></robot>'
        with pytest.raises(FileFormatError, match=r"^r: line 1: "):
            parsed(text)

    def test_latin_characters_stay(self) -> None:
        text = """<?xml version="1.0" encoding="ISO-8859-1"?><robot><link name="Gerät"><inertial><!-- für -->
            <mass value="5"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
            <visual><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></visual></link>
            </robot>"""
        robot = robots.parse_robot(text.encode("latin-1"), name="r", folder=".")
        (verdict,) = robots.check(robot)
        assert verdict.name == "Gerät"
        fixed = robots.fix(robot, [verdict])
        assert "<!-- für -->".encode("latin-1") in fixed
        (again,) = robots.check(robots.parse_robot(fixed, name="r", folder="."))
        assert again.verdict == "good"

    def test_places_are_those_behind_a_byte_order_mark(self) -> None:
        source = b'\xef\xbb\xbf<robot>\n<link name="a"/></robot>'
        (found,) = parse_xml(source, "r").children
        assert (source[found.start : found.end], found.line, found.depth) == (b'<link name="a"/>', 2, 2)
