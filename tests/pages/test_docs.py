"""The pages: code prints what they show, theorems have their places, figures are what their scripts draw."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import runpy
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import polhode
import pytest
from markdown_code import MADE, blocks, pages_of, run_page
from PIL import Image, ImageSequence
from places import ROOT
from polhode import FreeMotion, RigidBody, Trajectory

DOCS = ROOT / "docs"
CORE = ROOT / "rust" / "core" / "src"
PAGES = pages_of(DOCS)
FILM = DOCS / "figures" / "flip.py"  # of the readme: it moves, and takes a minute to draw
SCRIPTS = sorted(set(DOCS.glob("figures/[!_]*.py")) - {FILM})
EXERCISES = (67, 173, 69, 73, 68, 252, 253, 254, 255, 71, 143, 174, 175)  # in the course's order
LABELS = {"mln24", "mln25", "mln27", "mln80", "msl25", "msl26"} | {f"mex{number}" for number in EXERCISES}


def name(path: Path) -> str:
    return path.relative_to(DOCS).with_suffix("").as_posix()


def theorems() -> list[str]:
    """The files of the core that hold formulas of mechanics, and folders of them, as in ``mass/body``."""
    return sorted(
        f"{part}/{entry.stem}"
        for part in ("mass", "principal", "uncertainty", "motion")
        for entry in (CORE / part).iterdir()
        if entry.stem != "mod"
    )


class TestCode:
    @pytest.mark.parametrize(
        "page",
        [
            pytest.param(p, marks=pytest.mark.timeout(400) if p.stem == "low_orbit" else ())
            for p in PAGES
            if any(kind == "python" for kind, _ in blocks(p))
        ],  # a day in orbit takes ten seconds of an idle processor
        ids=name,
    )
    def test_blocks_print_what_is_shown(
        self, page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.chdir(tmp_path)
        with mpl.rc_context():
            run_page(page)
        for picture in drawn_by(page):
            compare(tmp_path / picture, DOCS / "figures" / picture)

    @pytest.mark.parametrize("number", EXERCISES)
    def test_every_exercise_states_solves_and_shows(self, number: int) -> None:
        page = DOCS / "exercises" / f"mex{number}.md"
        text = page.read_text("utf-8")
        assert text.startswith(f"(mex{number})=\n# ")
        assert "**Problem.**" in text
        assert text.index("## By hand") < text.index("## With polhode")
        assert "$" in text[text.index("## By hand") : text.index("## With polhode")]
        assert {"python", "text"} <= {kind for kind, _ in blocks(page)}

    def test_exercises_stand_in_the_courses_order_with_name_and_label(self) -> None:
        folder = DOCS / "exercises"
        index = (folder / "index.md").read_text("utf-8")
        heading = re.compile(r"^# (.*) \((mex\d+)\)$", re.MULTILINE)
        named = [heading.findall((folder / f"mex{n}.md").read_text("utf-8")) for n in EXERCISES]
        rows = re.findall(r"\| \[([^]]*)\]\((mex\d+)\.md\) \| (mex\d+) \| \[", index, re.MULTILINE)
        assert rows == [(name, label, label) for ((name, label),) in named]
        assert re.findall(r"^(mex\d+)$", index, re.MULTILINE) == [f"mex{n}" for n in EXERCISES]
        assert {label for label in LABELS if label not in index} == set()


class TestTheory:
    text = "".join("\n" + page.read_text("utf-8") for page in sorted(DOCS.glob("theory/*.md")))

    @pytest.mark.parametrize("stem", theorems())
    def test_every_theorem_has_its_section_and_leads_to_its_code(self, stem: str) -> None:
        start = self.text.find(f"\n({stem})=\n")
        assert start >= 0, f"no section ({stem})= in docs/theory"
        end = self.text.find("\n(", start + 1)
        assert f"rust/core/src/{stem}" in self.text[start : end if end >= 0 else None]
        assert f"(#{stem})" in (DOCS / "theory" / "index.md").read_text("utf-8")

    def test_every_section_is_about_a_file_that_exists(self) -> None:
        sections = re.findall(r"^\((.*)\)=$", self.text, re.MULTILINE)
        assert len(sections) == len(set(sections))
        package = ROOT / "python" / "polhode"  # of the theory that NumPy computes
        files = {
            s: (CORE / f"{s}.rs", CORE / s / "mod.rs", package / f"{s}.py", package / s / "__init__.py")
            for s in sections
        }
        gone = [s for s, places in files.items() if not any(place.exists() for place in places)]
        assert gone == []

    def test_every_label_of_the_course_has_its_place(self) -> None:
        assert {label for label in LABELS if label not in self.text} == set()

    @pytest.mark.parametrize("page", PAGES, ids=name)
    def test_links_to_files_lead_somewhere(self, page: Path) -> None:
        links = re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text("utf-8"))
        dead = [link for link in links if "://" not in link and not (page.parent / link).exists()]
        made = {target for link in dead if (target := (page.parent / link).resolve()).parent.parent == DOCS}
        assert {target.parent.name for target in made} <= set(MADE)  # `test_site.py` follows these
        assert len(made) == len(set(dead))


def test_the_places_that_contributing_names_are_there() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    named = re.findall(r"`((?:rust|python|tests|docs|packaging|benchmarks|\.github)(?:/[\w.]+)+)`", text)
    assert len(named) > 20
    assert [place for place in named if not (ROOT / place).exists()] == []


class TestInterface:
    @pytest.fixture
    def pages(self, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
        monkeypatch.syspath_prepend(DOCS / "site")
        interface = importlib.import_module("interface")
        return dict(interface.pages(tomllib.loads((DOCS / "interface.toml").read_text("utf-8"))))

    def test_every_public_name_is_on_one_page(self, pages: dict[str, str]) -> None:
        text = "\n".join(pages.values())
        found = {
            export: len(re.findall(rf"auto\w+:: polhode\.{export}$", text, re.MULTILINE))
            for export in polhode.__all__
            if export != "__version__"
        }
        assert {export: count for export, count in found.items() if count != 1} == {}

    def test_every_member_of_a_class_is_on_its_page(self, pages: dict[str, str]) -> None:
        text = "\n".join(pages.values())
        missing = {}
        for export in polhode.__all__:
            value = getattr(polhode, export)
            if not isinstance(value, type) or value is RigidBody:  # which has pages of its own
                continue
            listed = re.search(rf"autoclass:: polhode\.{export}\n(?:   :members: (.*))?", text)
            assert listed
            # The class describes its fields.
            fields = {*inspect.get_annotations(value), *getattr(value, "_fields", ())}
            fields |= {name for name, member in vars(value).items() if inspect.ismemberdescriptor(member)}
            members = {name for name in vars(value) if not name.startswith("_")} - fields
            # Long classes have further pages of their own.
            parts = re.findall(rf"automethod:: polhode\.{export}\.(\w+)$", text, re.MULTILINE)
            missing[export] = members - set((listed[1] or "").split(", ")) - set(parts)
        assert {export: names for export, names in missing.items() if names} == {}
        assert "top" in vars(polhode.PrincipalAxes)  # a cached property is among them
        assert re.search(r"orbits\.Orbit\n   :members: .*dipole_field", text)  # which its base holds

    def test_every_member_of_a_body_is_on_one_page(self, pages: dict[str, str]) -> None:
        rest, *parts = (text for name, text in pages.items() if name.startswith("RigidBody."))
        first = pages["RigidBody.md"]
        shown = re.findall(
            r"auto(?:method|attribute):: polhode\.RigidBody\.(\w+)$", "\n".join([rest, *parts]), re.MULTILINE
        )
        listed = re.search(r":members: (.*)", first)
        assert listed
        shown += listed[1].split(", ")
        assert sorted(shown) == sorted(n for n in vars(polhode.RigidBody) if not n.startswith("_"))


class TestCheatSheet:
    def test_what_it_names_exists(self) -> None:
        sheet = (DOCS / "cheat_sheet.md").read_text("utf-8")
        homes = {"b": RigidBody, "run": Trajectory, "m": FreeMotion, "RigidBody": RigidBody}
        homes |= {name: getattr(polhode, name) for name in ("solids", "laminae", "rods", "loads", "orbits")}
        names = re.findall(r"\b(b|run|m|RigidBody|solids|laminae|rods|loads|orbits)\.(\w+)", sheet)
        fields = set(Trajectory.__dataclass_fields__)
        gone = [f"{home}.{n}" for home, n in names if not hasattr(homes[home], n) and n not in fields]
        assert gone == []
        assert len(names) > 50


class TestFigures:
    """Numbers are compared, not bytes: another matplotlib may write the same drawing differently."""

    @pytest.mark.parametrize(
        "script",
        # Twenty thousand flybys take some seconds.
        [pytest.param(s, marks=pytest.mark.long if s.stem == "flyby" else ()) for s in SCRIPTS],
        ids=name,
    )
    def test_the_script_draws_what_is_committed(
        self, script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.syspath_prepend(script.parent)
        monkeypatch.setattr(sys, "argv", [str(script), str(tmp_path)])
        monkeypatch.setattr(sys, "dont_write_bytecode", True)
        with mpl.rc_context():
            runpy.run_path(str(script), run_name="__main__")
        compare(tmp_path / f"{script.stem}.svg", script.with_suffix(".svg"))

    def test_every_picture_has_its_script_and_its_page(self) -> None:
        shown = set()
        for page in PAGES:
            for description, target in re.findall(r"!\[([^]]*)\]\(([^)]+)\)", page.read_text("utf-8")):
                assert description, f"{name(page)}: {target} has no description for those who cannot see it"
                shown.add((page.parent / target).resolve())
        figures = {script.with_suffix(".svg") for script in SCRIPTS}
        figures |= {DOCS / "figures" / picture for page in PAGES for picture in drawn_by(page)}
        assert set(DOCS.glob("figures/*.svg")) == figures
        assert figures <= shown

    @pytest.mark.parametrize("script", SCRIPTS, ids=name)
    def test_a_script_has_one_function_that_draws(self, script: Path) -> None:
        functions = [
            node.name
            for node in ast.parse(script.read_text("utf-8")).body
            if isinstance(node, ast.FunctionDef)
        ]
        assert "draw" in functions

    def test_the_film_of_the_readme_comes_back_to_its_start(self) -> None:
        """After two flips body and ω are where they were; the handle was upside down in between."""
        made = runpy.run_path(str(FILM))
        body = made["handle"]()
        motion, period = made["closed"](body)
        states = motion.at(np.array([0.0, period / 2.0, period]))
        start, half, end = states.quaternion
        assert abs(start @ end) == pytest.approx(1.0, abs=1e-12)
        assert abs(start @ half) < 0.1
        np.testing.assert_allclose(states.omega[2], states.omega[0], atol=1e-9)
        np.testing.assert_allclose(states.omega[1], states.omega[0] * (1, 1, -1), atol=1e-9)
        picture = DOCS / "images" / "flip.gif"
        assert picture.stat().st_size <= 1_000_000
        with Image.open(picture) as film:
            assert (sum(1 for _ in ImageSequence.Iterator(film)), film.info["loop"]) == (made["PICTURES"], 0)
            assert film.info["duration"] == round(1000.0 * made["DURATION"] / made["PICTURES"])
        assert f"]({picture.relative_to(ROOT).as_posix()})" in (ROOT / "README.md").read_text("utf-8")[:600]
        assert 'src="gallery/t_handle.live.html"' in (DOCS / "index.md").read_text("utf-8")[:600]


def drawn_by(page: Path) -> list[str]:
    """The pictures that a page shows and that its own code draws."""
    code = "".join(code for language, code in blocks(page) if language == "python")
    saved = re.findall(r"""savefig\("(\w+\.svg)"\)""", code)
    return [picture for picture in saved if f"figures/{picture})" in page.read_text("utf-8")]


def compare(drawn: Path, committed: Path) -> None:
    """Compare the texts of two figures, and the numbers if the same version of matplotlib wrote them."""
    one, other = (path.read_text("utf-8") for path in (drawn, committed))
    assert labels(one) == labels(other)
    if writer(one) == writer(other):
        assert np.allclose(coordinates(one), coordinates(other), atol=0.01)


def labels(svg: str) -> list[str]:
    """The texts of a figure, which the writer leaves beside their outlines as comments."""
    return re.findall(r"<!-- (.*?) -->", svg)


def writer(svg: str) -> str | None:
    """What wrote the figure, with its version."""
    found = re.search(r"<dc:title>(Matplotlib[^<]*)<", svg)
    return found and found[1]


def coordinates(svg: str) -> list[float]:
    """All numbers of all paths, in order."""
    paths = [
        element.get("d", "")
        for element in ElementTree.fromstring(svg).iter()
        if element.tag.endswith("}path")
    ]
    return [float(number) for path in paths for number in re.findall(r"-?\d+(?:\.\d+)?", path)]
