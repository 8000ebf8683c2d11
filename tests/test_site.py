"""The site as `make docs` has built it: no dead link, nothing from the network, and what a browser shows.

Without a site that is as new as its pages these tests are skipped; `.ci/run` builds it before.
"""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urldefrag

import pytest
from site_browser import CHROMIUM, Task, answers

ROOT = Path(__file__).resolve().parents[1]
SITE = ROOT / "docs" / "_build" / "html"
SOURCES = [
    path
    for folder in ("docs", "examples")
    for path in (ROOT / folder).rglob("*")
    if path.suffix in {".md", ".py", ".toml", ".css", ".js"}
    and "_build" not in path.parts
    and path.parent not in {ROOT / "docs" / name for name in ("interface", "gallery", "measured")}
]
BUILT = SITE / "built"
pytestmark = pytest.mark.skipif(
    not BUILT.exists() or BUILT.stat().st_mtime < max(path.stat().st_mtime for path in SOURCES),
    reason="the site is not built, or older than its pages: make docs",
)
in_a_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium")

PHONE, DESK = (390, 844), (1280, 800)
TALLEST = 15_000
"""Pixels of the longest page of the interface at the width of a desk."""


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
    assert pages()["theory/motion.html"].formulas > 300
    assert pages()["cheat_sheet.html"].formulas == 6


MEASURE = """
await wait(30);
const width = page.documentElement.clientWidth;
const scrolls = (e) => { for (let p = e; p && p.tagName !== "MAIN"; p = p.parentElement)
  if (["auto", "scroll", "hidden"].includes(view.getComputedStyle(p).overflowX)) return true; return false; };
const wide = [...page.querySelectorAll("main *")].filter((e) => {
  const box = e.getBoundingClientRect();
  return box.width > 1 && box.right > width + 1 && !scrolls(e);
});
const shown = [...page.querySelectorAll("math")].filter((e) => e.getClientRects().length);
const empty = shown.filter((e) => e.getBoundingClientRect().width < 2);
return {
  wide: wide.slice(0, 3).map((e) => e.outerHTML.slice(0, 200)),
  beyond: page.documentElement.scrollWidth - width,
  empty: empty.length,
  height: page.documentElement.scrollHeight,
};
"""


@in_a_browser
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_nothing_overflows_and_formulas_are_drawn(size: tuple[int, int]) -> None:
    every = list(pages())
    names = every if size == PHONE else [n for n in every if n.startswith("interface/") or "/" not in n]
    tasks: list[Task] = [(f"/{name}", *size, MEASURE) for name in names]
    bad = []
    for name, found in zip(names, answers(SITE, tasks), strict=True):
        is_tall = size == DESK and name.startswith("interface/") and found.get("height", 0) > TALLEST
        if "error" in found or found["wide"] or found["beyond"] > 0 or found["empty"] or is_tall:
            bad.append((name, found))
    assert bad == []


@in_a_browser
def test_the_search_finds_the_gallery_first() -> None:
    code = """
    for (let k = 0; k < 200; k++) { await wait(50); if (page.querySelector("#search-results li a")) break; }
    await wait(300);
    return [...page.querySelectorAll("#search-results li a")].slice(0, 3).map((e) => e.getAttribute("href"));
    """
    (found,) = answers(SITE, [("/search.html?q=tennis+racket", *DESK, code)])
    assert found[0].startswith("gallery/tennis_racket.html")


@in_a_browser
def test_a_button_copies_commands_without_their_dollar() -> None:
    code = """
    await wait(300);
    let kept = null;
    Object.defineProperty(view.navigator.clipboard, "writeText", {value: async (text) => { kept = text; }});
    const block = [...page.querySelectorAll(".highlight-console div.highlight")][0];
    block.querySelector("button.copy").click();
    await wait(50);
    return kept;
    """
    (found,) = answers(SITE, [("/command_line.html", *DESK, code)])
    assert found.startswith("polhode samples .\npolhode report t-handle.stl")
    assert "$" not in found


@in_a_browser
def test_the_cheat_sheet_is_two_pages_on_paper(tmp_path: Path) -> None:
    assert CHROMIUM
    file = tmp_path / "sheet.pdf"
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"]
    options += [f"--user-data-dir={tmp_path / 'profile'}", f"--print-to-pdf={file}"]
    page = (SITE / "cheat_sheet.html").as_uri()
    subprocess.run([CHROMIUM, *options, page], check=True, capture_output=True, timeout=60)
    assert len(re.findall(rb"/Type\s*/Page[^s]", file.read_bytes())) <= 2


def axe() -> Path | None:
    found = importlib.util.find_spec("axe_playwright_python")
    return Path(found.origin).parent / "axe.min.js" if found and found.origin else None


@in_a_browser
@pytest.mark.skipif(axe() is None, reason="no axe-core: pip install --no-deps axe-playwright-python")
@pytest.mark.parametrize("size", [PHONE, DESK], ids=["phone", "desk"])
def test_axe_finds_nothing_serious(size: tuple[int, int]) -> None:
    names = [
        "index", "tutorial", "gallery/index", "gallery/tennis_racket", "interface/index",
        "interface/RigidBody", "interface/RigidBody.motion", "theory/principal", "exercises/mex143",
        "why_others_disagree", "cheat_sheet", "command_line", "how_to/roboticist", "measured/elsewhere",
        "search",
    ]  # fmt: skip
    names = names if size == DESK else names[::2]
    code = """
    await wait(100);
    const found = await (await axe(view)).run(page, {resultTypes: ["violations"], iframes: false});
    return found.violations.filter((v) => ["serious", "critical"].includes(v.impact))
      .map((v) => [v.id, v.nodes.length, v.nodes[0].html.slice(0, 200)]);
    """
    tasks: list[Task] = [(f"/{name}.html", *size, code) for name in names]
    found: list[Any] = answers(SITE, tasks, axe())
    assert {name: each for name, each in zip(names, found, strict=True) if each} == {}
