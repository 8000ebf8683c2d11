"""The site as `make docs` has built it: no dead link, nothing from the network, and what a browser shows.

Without a site that is as new as its pages these tests are skipped; `make test` builds it before.
"""

from __future__ import annotations

import base64
import os
import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote, urldefrag

import pytest
from browser import Browser, needs_browser
from places import ROOT

if TYPE_CHECKING:
    from collections.abc import Iterator

SITE = ROOT / "docs" / "_build" / "html"
SOURCES = [
    path
    for folder in ("docs", "examples")
    for path in (ROOT / folder).rglob("*")
    if path.suffix in {".md", ".py", ".toml", ".css", ".js", ".ipynb"}
    and "_build" not in path.parts
    and path.parent not in {ROOT / "docs" / name for name in ("interface", "gallery", "measured")}
    and not path.match("docs/notebooks/*.md")
]
BUILT = SITE / "built"
pytestmark = pytest.mark.skipif(
    not BUILT.exists() or BUILT.stat().st_mtime < max(path.stat().st_mtime for path in SOURCES),
    reason="the site is not built, or older than its pages: make docs",
)

PHONE, DESK = (390, 844), (1280, 800)
TALLEST = 15_000
"""Pixels of the longest page at the width of a desk."""


class Page(HTMLParser):
    """What a page refers to, and what in it can be referred to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.anchors: set[str] = set()
        self.formulas = 0
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.anchors |= {value for name in ("id", "name") if (value := found.get(name))}
        self.formulas += tag == "math"
        if tag == "a" and (href := found.get("href")):
            self.links.append(href)
        if tag in {"script", "img", "iframe"} and (source := found.get("src")):
            self.loaded.append(source)
        if (
            tag == "link"
            and found.get("rel") in {"stylesheet", "preload", "icon"}
            and (href := found.get("href"))
        ):
            self.loaded.append(href)


@cache
def pages() -> dict[str, Page]:
    return {
        path.relative_to(SITE).as_posix(): Page(path.read_text("utf-8"))
        for path in sorted(SITE.rglob("*.html"))
        if "_static" not in path.parts and not path.name.endswith(".live.html")
    }


def is_ours(address: str) -> bool:
    return not address.startswith(("http://", "https://", "mailto:", "data:", "//", "javascript:"))


def test_no_link_is_dead() -> None:
    dead = []
    for name, page in pages().items():
        for link in filter(is_ours, page.links + page.loaded):
            file, anchor = urldefrag(link)
            target = os.path.normpath(
                (Path(name).parent / unquote(file.partition("?")[0])).as_posix() if file else name
            )
            if not (SITE / target).exists():
                dead.append(f"{name}: {link}")
            elif anchor and target in pages() and unquote(anchor) not in pages()[target].anchors:
                dead.append(f"{name}: {link}, no such anchor")
    assert dead == []


def test_nothing_is_loaded_from_the_network() -> None:
    assert [(name, each) for name, page in pages().items() for each in page.loaded if not is_ours(each)] == []


def test_formulas_are_in_the_pages() -> None:
    assert pages()["theory/free.html"].formulas > 50
    assert pages()["cheat_sheet.html"].formulas == 6


def test_old_links_to_the_theory_of_motion_lead_on() -> None:
    """Each section was once on one page; its anchor there names the page where it is now."""
    old = (SITE / "theory" / "motion.html").read_text("utf-8")
    on = dict(re.findall(r'<span id="([^"]+)" data-moved="([^"]+)">', old))
    sections = re.compile(r"^\((motion/[\w/]+)\)=$", re.MULTILINE)
    names = [
        name
        for page in (ROOT / "docs" / "theory").glob("*.md")
        for name in sections.findall(page.read_text("utf-8"))
    ]
    assert len(names) > 20
    assert {re.sub(r"[/_]", "-", name) for name in names} <= set(on)
    for anchor, target in on.items():
        file, same = urldefrag(target)
        assert same == anchor
        assert anchor in pages()[f"theory/{file}"].anchors


def test_no_page_shows_markup_or_what_python_says_of_its_own_types() -> None:
    texts = {path: path.read_text("utf-8") for path in (SITE / "interface").glob("*.html")}
    assert len(texts) > 60
    told = (
        ":meth:",
        ":func:",
        ":class:",
        ":mod:",
        "Built-in immutable sequence",
        "str(object=",
        "int([x])",
        "dict() -&gt;",
        "Convert a string or number",
    )
    assert [(path.name, words) for path, text in texts.items() for words in told if words in text] == []


@pytest.mark.parametrize(
    ("name", "printed", "frames"),
    [
        ("racket", "turns over every", 1),
        ("satellite", "ω strays from the axis", 2),
        ("asteroid", "long-axis", 1),
    ],
)
def test_notebooks_are_read_on_the_site(name: str, printed: str, frames: int) -> None:
    """Text, code, what the cells print, and the pages that they show."""
    text = (SITE / "notebooks" / f"{name}.html").read_text("utf-8")
    assert printed in text
    live = [each for each in pages()[f"notebooks/{name}.html"].loaded if each.endswith(".live.html")]
    assert len(live) == frames
    assert f"{name}.ipynb" in text


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("browser")) as one:
        yield one


@pytest.fixture
def desk(browser: Browser) -> Browser:
    browser.screen(*DESK)
    return browser


MEASURE = """(() => {
const width = document.documentElement.clientWidth;
const scrolls = (e) => { for (let p = e; p && p.tagName !== "MAIN"; p = p.parentElement)
  if (["auto", "scroll", "hidden"].includes(getComputedStyle(p).overflowX)) return true; return false; };
const wide = [...document.querySelectorAll("main *")].filter((e) => {
  const box = e.getBoundingClientRect();
  return box.width > 1 && box.right > width + 1 && !scrolls(e);
});
const shown = [...document.querySelectorAll("math")].filter((e) => e.getClientRects().length);
const empty = shown.filter((e) => e.getBoundingClientRect().width < 2);
// How far a formula reaches beyond its box on one side, when it is scrolled to that side.
const beyond = (e, side, sign) => {
  e.scrollLeft = sign * 1e5;
  const parts = [...e.querySelectorAll("math *")].map((part) => part.getBoundingClientRect()[side]);
  return Math.max(...parts.map((at) => sign * (at - e.getBoundingClientRect()[side])));
};
const cut = [...document.querySelectorAll(".math")].filter((e) => e.getClientRects().length)
  .filter((e) => beyond(e, "right", 1) > 2 || beyond(e, "left", -1) > 2);
return {
  wide: wide.slice(0, 3).map((e) => e.outerHTML.slice(0, 200)),
  beyond: document.documentElement.scrollWidth - width,
  empty: empty.length,
  cut: cut.slice(0, 3).map((e) => e.textContent),
  height: document.documentElement.scrollHeight,
};
})()"""


@needs_browser
@pytest.mark.timeout(300)
def test_nothing_overflows_and_formulas_are_drawn(browser: Browser) -> None:
    """On a phone and as wide as a desk; pages that are as wide as others there on a phone alone."""
    alike = ("gallery/", "exercises/", "decisions/")
    sizes = [PHONE, DESK]
    bad = []
    for name in sorted(pages(), key=lambda name: not name.startswith(alike)):
        for size in [PHONE] if name.startswith(alike) else sizes:
            browser.screen(*size, still=True)
            if size == sizes[0]:
                browser.open(SITE / name)
            browser.wait(f"innerWidth === {size[0]}")
            found = browser.run(MEASURE)
            is_tall = size == DESK and found["height"] > TALLEST
            if found["wide"] or found["beyond"] > 0 or found["empty"] or found["cut"] or is_tall:
                bad.append((name, size, found))
        if not name.startswith(alike):
            # The next page is opened at the size of this one: to lay out a page that is left takes time.
            sizes.reverse()
    assert bad == []


@needs_browser
@pytest.mark.parametrize("words", ["tennis racket", "Tennis+Racket", "racket"])
def test_the_search_finds_the_gallery_first(desk: Browser, words: str) -> None:
    desk.open(SITE / "search.html", f"?q={words.replace(' ', '+')}")
    first = "document.querySelector('#search-results li a')"
    desk.wait(f"{first} && !document.querySelector('#search-progress')?.textContent")
    assert desk.run(f"{first}.getAttribute('href')").startswith("gallery/tennis_racket.html")


@needs_browser
def test_formulas_have_the_font_of_the_site(desk: Browser) -> None:
    desk.open(SITE / "theory" / "free.html")
    desk.wait("document.fonts.status === 'loaded'")
    fonts = "[...document.fonts].filter((font) => font.family.includes('Latin Modern Math'))"
    assert desk.run(f"{fonts}.map((font) => font.status).join()") == "loaded"
    first = desk.run("getComputedStyle(document.querySelector('math')).fontFamily")
    assert str(first).startswith('"Latin Modern Math"')


@needs_browser
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_no_code_is_under_the_button_that_copies_it(browser: Browser, size: tuple[int, int]) -> None:
    browser.screen(*size)
    browser.open(SITE / "how_to" / "engineer.html")
    browser.wait("document.querySelectorAll('button.copy').length > 3")
    covered = """[...document.querySelectorAll('button.copy')].filter((button) => {
        const code = button.parentElement.querySelector('pre');
        const [a, b] = [button, code].map((one) => one.getBoundingClientRect());
        return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    }).length"""
    assert browser.run(covered) == 0


@needs_browser
class TestCopies:
    """A real press of the button, and what the clipboard then holds."""

    @pytest.fixture
    def clipboard(self, desk: Browser) -> Browser:
        desk.ask("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        return desk

    def copied(self, browser: Browser, page: str, block: str) -> str:
        browser.open(SITE / page)
        browser.run("navigator.clipboard.writeText('nothing yet')")
        browser.click(f"{block} button.copy")
        browser.wait(f"document.querySelector({block + ' button.copy'!r}).textContent === 'copied'")
        return str(browser.run("navigator.clipboard.readText()"))

    def test_commands_without_their_dollar_and_what_they_print(self, clipboard: Browser) -> None:
        found = self.copied(clipboard, "command_line.html", ".highlight-console div.highlight")
        assert found.startswith("polhode samples .\npolhode report t-handle.stl")
        assert "$" not in found
        assert all(line.startswith("polhode ") for line in found.splitlines())

    def test_code_as_it_stands(self, clipboard: Browser) -> None:
        found = self.copied(clipboard, "gallery/tennis_racket.html", ".highlight-python div.highlight")
        assert found.strip() == (ROOT / "examples" / "tennis_racket.py").read_text("utf-8").strip()

    def test_a_session_without_its_prompts(self, clipboard: Browser) -> None:
        found = self.copied(clipboard, "interface/RigidBody.html", ".doctest div.highlight")
        assert found.count("\n") > 1
        assert ">>>" not in found
        assert compile(found, "session", "exec")


@needs_browser
class TestMovingPage:
    """The moving page within a page of the gallery."""

    FRAME = "iframe.live"
    INSIDE = "document.querySelector('iframe.live').contentWindow"

    @pytest.fixture
    def racket(self, desk: Browser) -> Browser:
        desk.open(SITE / "gallery" / "tennis_racket.html")
        desk.run(
            "document.querySelector('iframe.live').scrollIntoView({ block: 'center', behavior: 'instant' })"
        )
        desk.wait(f"typeof {self.INSIDE}.polhode === 'object'")
        return desk

    def test_full_screen_and_back(self, racket: Browser) -> None:
        racket.click("#full", frame=self.FRAME)
        racket.wait("document.fullscreenElement?.matches('iframe.live') ?? false")
        racket.wait(f"{self.INSIDE}.innerWidth === {DESK[0]} && {self.INSIDE}.innerHeight === {DESK[1]}")
        racket.click("#full", frame=self.FRAME)
        racket.wait("document.fullscreenElement === null")

    def test_keys_bring_nearer_and_reset_turns_back(self, racket: Browser) -> None:
        zoom = f"{self.INSIDE}.polhode.views.space.zoom"
        racket.click("#space", frame=self.FRAME)
        start = racket.run(zoom)
        for name, nearer in (("+", True), ("-", False)):
            before = racket.run(zoom)
            racket.key(name, name)
            assert (racket.run(zoom) > before) is nearer
        racket.key("+", "+")
        racket.click("#reset", frame=self.FRAME)
        racket.wait(f"{zoom} === {start}")

    def test_two_fingers_bring_nearer_and_one_scrolls_the_page(self, racket: Browser) -> None:
        racket.screen(*PHONE, touch=True)
        racket.open(SITE / "gallery" / "tennis_racket.html")
        racket.run(
            "document.querySelector('iframe.live').scrollIntoView({ block: 'start', behavior: 'instant' })"
        )
        racket.wait(f"typeof {self.INSIDE}.polhode === 'object'")
        x, y = racket.middle("#space", frame=self.FRAME)
        zoom = f"{self.INSIDE}.polhode.views.space.zoom"
        before = racket.run(zoom)
        racket.touch("touchStart", (x - 20, y), (x + 20, y))
        for far in (25, 30, 35, 40):
            racket.touch("touchMove", (x - far, y), (x + far, y))
        racket.touch("touchEnd")
        assert racket.run(zoom) == pytest.approx(2.0 * before, rel=0.2)
        place = f"scrollY + {self.INSIDE}.scrollY"
        before = racket.run(place)
        racket.touch("touchStart", (x, y + 100))
        for k in range(1, 11):
            racket.touch("touchMove", (x, y + 100 - 20 * k))
        racket.touch("touchEnd")
        racket.wait(f"{place} > {before + 50}")


@needs_browser
def test_an_old_link_goes_to_the_new_page(desk: Browser) -> None:
    desk.open(SITE / "theory" / "motion.html", "#motion-heavy-top")
    desk.wait("location.pathname.endsWith('/theory/heavy_top.html') && location.hash === '#motion-heavy-top'")


@needs_browser
def test_the_cheat_sheet_is_two_pages_on_paper(browser: Browser) -> None:
    browser.open(SITE / "cheat_sheet.html")
    paper = base64.b64decode(browser.ask("Page.printToPDF")["data"])
    assert len(re.findall(rb"/Type\s*/Page[^s]", paper)) <= 2


@needs_browser
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_axe_finds_nothing_serious(browser: Browser, size: tuple[int, int], dark: bool) -> None:
    names = [
        "index", "tutorial", "gallery/index", "gallery/tennis_racket", "interface/index",
        "interface/RigidBody", "interface/RigidBody.motion", "theory/principal", "exercises/mex143",
        "why_others_disagree", "cheat_sheet", "command_line", "how_to/roboticist", "measured/elsewhere",
        "search", "notebooks/racket",
    ]  # fmt: skip
    browser.screen(*size, dark=dark, still=True)
    chosen = names[dark::2] if size == PHONE else names[1 - dark :: 2]  # each page on both screens
    assert faults_of(browser, [f"{name}.html" for name in chosen]) == {}


@needs_browser
@pytest.mark.long
@pytest.mark.parametrize("part", range(8))
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_axe_finds_nothing_serious_on_any_page(desk: Browser, dark: bool, part: int) -> None:
    """Of all pages, which takes minutes."""
    desk.screen(*DESK, dark=dark, still=True)
    assert faults_of(desk, list(pages())[part::8]) == {}


def faults_of(browser: Browser, names: list[str]) -> dict[str, list[Any]]:
    """What axe-core finds on pages, by their names."""
    faults: dict[str, list[Any]] = {}
    for name in names:
        browser.open(SITE / name)
        if found := browser.serious_faults():
            faults[name] = found
    return faults
