"""Names and titles are shown as they are typed, whatever they mean to a page or to Matplotlib."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any

import pytest
from browser import Browser, needs_browser
from command_line import run, write_obj
from matplotlib.figure import Figure
from matplotlib.text import Text
from oracles.meshes import box
from polhode import Trajectory, loads, solids
from polhode.draw.scene import Scene
from polhode.uncertainty.ledgers import ledger

if TYPE_CHECKING:
    from pathlib import Path

MATH = r"$\frac$ and $x$"  # the first is no formula, the second is one
MARKUP = "<!-- <script> </script> & \u2028 \"'"


def motion(name: str) -> Trajectory:
    wheel = loads.wheel((0, 0, 1), 0.05, rate=3.0, name=name)
    return solids.box((3.0, 2.0, 1.0), mass=2.0).simulate(
        [0.0, 0.1, 0.2], omega=(0.05, 2.0, 0.02), load=wheel
    )


def as_typed(figure: Any, word: str) -> int:
    """Count the texts of a figure that hold a word; each of them shows it as it is."""
    drawn: list[Any] = figure.findobj(Text)
    texts = [text for text in drawn if word in text.get_text()]
    assert not any(text.get_parse_math() for text in texts), [text.get_text() for text in texts]
    figure.canvas.draw()
    return len(texts)


def test_films() -> None:
    from polhode.draw.animation.film import Picture

    run = motion(MATH)
    scene = Scene.of(run, frames=None, duration=None, shape=None, title=MATH, time_unit="s", is_film=True)
    picture: Any = Picture(scene, (900, 600), has_labels=True)
    picture.show(0)
    assert as_typed(picture.figure, "frac") >= 2


def test_ledgers() -> None:
    part = {"mass": 1.0, "Cx": 0.0, "Cy": 0.0, "Cz": 0.0, "Ipoint": True, "sigma_mass": 0.1}
    made = ledger(
        [{"id": MATH}, {"id": MATH + "1", "parent": MATH} | part, {"id": MATH + "2", "parent": MATH} | part]
    )
    assert as_typed(made.plot(Figure().subplots(), of="mass").figure, "frac") >= 3
    assert as_typed(made.plot(Figure().subplots(), of="variance").figure, "frac") >= 3


@pytest.mark.parametrize("name", [MATH, os.fsdecode(b"\xff")])
def test_files_with_odd_names(tmp_path: Path, name: str) -> None:
    slab = write_obj(tmp_path / f"{name}.obj", *box((1.0, 2.0, 3.0)))
    words = ("--mass", "1", "--omega", "0 0 1", "--end", "1")
    code, _, err = run("spin", slab, *words, "--save", tmp_path / "a.svg", "--save", tmp_path / "a.html")
    assert (code, err) == (0, "")
    shown = name if name.isprintable() else r"\udcff"
    assert f"<title>{shown}.obj</title>" in (tmp_path / "a.html").read_text("utf-8")


def test_no_markup_in_the_data_of_a_page(tmp_path: Path) -> None:
    """After "<!--" and "<script" a browser takes the end of the data for a part of it."""
    page = motion(MARKUP).animate(tmp_path / "a.html", title=MARKUP).read_text("utf-8")
    data = re.search(r'<script type="application/json" id="motion">(.*)', page)
    assert data
    assert data[1].index("<") == data[1].index("</script>") > 1000


@needs_browser
def test_a_page_shows_markup(tmp_path: Path) -> None:
    page = motion(MARKUP).animate(tmp_path / "a.html", title=MARKUP)
    with Browser(tmp_path) as browser:
        browser.ask("Page.navigate", url=page.as_uri())
        browser.wait("document.readyState === 'complete'")
        assert browser.run("document.getElementById('title').textContent") == MARKUP
