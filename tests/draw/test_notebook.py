"""What notebooks show of bodies: a table and a drawing without any drawing library."""

from __future__ import annotations

import html
import re
import sys
import webbrowser
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from polhode import RigidBody, loads, solids
from polhode.draw.html import ellipsoid_svg

NAMESPACE = "{http://www.w3.org/2000/svg}"


def test_one_body_has_its_numbers_and_a_drawing() -> None:
    text = solids.box((3.0, 2.0, 1.0), mass=1.25)._repr_html_()
    assert ElementTree.fromstring(text).tag == "div"
    assert "1.25" in text
    assert "asymmetric" in text
    assert "<svg" in text


def test_the_outline_is_that_of_the_ellipsoid() -> None:
    """That of a ball is a circle, seen from anywhere; no point of a ring lies beyond the outline."""
    outline = _drawing(solids.sphere(1.0, mass=1.0)).find(f"{NAMESPACE}ellipse")
    assert outline is not None
    assert outline.get("rx") == outline.get("ry") == "72.00"
    drawing = _drawing(solids.box((3.0, 2.0, 1.0), mass=1.0))
    outline = drawing.find(f"{NAMESPACE}ellipse")
    assert outline is not None
    radii = float(outline.get("rx", "")), float(outline.get("ry", ""))
    angle = np.deg2rad(float(outline.get("transform", "")[len("rotate(") : -1]))
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    reached = []
    for ring in drawing.iter(f"{NAMESPACE}polyline"):
        points = np.array([pair.split(",") for pair in ring.get("points", "").split()], dtype=float)
        reached.append(np.linalg.norm(points @ turn.T / radii, axis=1).max())
    assert len(reached) == 6
    assert max(reached) < 1.001
    assert max(reached) > 0.99


def test_rods_points_and_stacks() -> None:
    assert "<svg" in RigidBody.from_principal(1.0, (0.0, 1.0, 1.0))._repr_html_()
    assert "<svg" not in RigidBody.from_principal(1.0, (0.0, 0.0, 0.0))._repr_html_()
    stack = solids.cube(np.ones(3), mass=1.0)._repr_html_()
    assert stack.startswith("<pre>&lt;RigidBody stack of shape (3,)")


BRICK = RigidBody.from_principal(1.0, (1.0, 3.0, 3.2))
MOTION = BRICK.free_motion((0.01, 6.0, 0.0))


def framed(text: str) -> str:
    """The page in the frame that a notebook displays."""
    found = re.search(r'srcdoc="([^"]*)"', text)
    assert found
    return html.unescape(found[1])


def test_a_motion_shows_itself() -> None:
    """ω over time as a drawing, and the same page as a file's, in a frame; below 300 kB together."""
    shown = MOTION.at(np.linspace(0.0, 20.0, 401))
    text = shown._repr_html_()
    assert len(text.encode()) < 300_000
    page = framed(text)
    assert page.startswith("<!DOCTYPE html>")
    assert page.endswith("</html>\n")
    drawing = ElementTree.fromstring(text[text.index("<svg") : text.index("</svg>") + 6])
    curves = [line.get("points", "") for line in drawing.iter(f"{NAMESPACE}polyline")]
    assert len(curves) == 3
    heights = np.array([[float(pair.split(",")[1]) for pair in curve.split()] for curve in curves])
    assert len(heights[0]) == 400
    chosen = np.unique(np.linspace(0, 400, 400).round().astype(int))
    drawn = (75.0 - heights.T) / 63.0 * np.abs(shown.omega).max()
    np.testing.assert_allclose(drawn, shown.omega[chosen], atol=0.006)


def test_two_states_of_a_free_motion_are_drawn_as_the_curve_between_them() -> None:
    top = (
        solids.cone(radius=0.03, height=0.06, mass=0.1)
        .rotated((1.0, 0.0, 0.0, 0.0))
        .translated((0, 0, 0.045))
    )
    nodding = top.heavy_top((0.0, 0.0, 260.0), (0.0, 0.28, 0.0, 0.96), (0.0, 0.0, -9.81))
    for motion, end in ((MOTION, 20.0), (nodding, 0.5)):
        text = motion.at([0.0, end])._repr_html_()
        drawing = ElementTree.fromstring(text[text.index("<svg") : text.index("</svg>") + 6])
        curves = [line.get("points", "") for line in drawing.iter(f"{NAMESPACE}polyline")]
        heights = np.array([[float(pair.split(",")[1]) for pair in curve.split()] for curve in curves])
        omega = motion.at(np.linspace(0.0, end, 400)).omega
        np.testing.assert_allclose(
            (75.0 - heights.T) / 63.0 * np.abs(omega).max(), omega, atol=0.001 * np.abs(omega).max()
        )


def test_names_in_the_drawing_of_a_body_are_whole_and_apart() -> None:
    for body in (
        solids.box((3.0, 2.0, 1.0), mass=1.0),
        solids.box((1.0, 2.0, 3.0), mass=1.0),
        solids.cylinder(radius=0.1, height=3.0, mass=1.0),
        solids.box((0.1, 0.016, 0.016), mass=1.0)
        + solids.box((0.016, 0.016, 0.05), mass=0.5).translated((0, 0, -0.03)),
    ):
        places = np.array(
            [(float(t.get("x", "")), float(t.get("y", ""))) for t in _drawing(body).iter(f"{NAMESPACE}text")]
        )
        assert len(places) == 6
        assert np.abs(places).max() < 96.0
        gaps = np.abs(places[:, np.newaxis] - places).max(axis=-1) + 100.0 * np.eye(6)
        assert gaps.min() > 9.0


def test_motions_without_a_page() -> None:
    many = solids.cube(np.ones(3), mass=1.0).simulate([0.0, 1.0], (1.0, 0.0, 0.0))
    assert many._repr_html_().startswith("<pre>Trajectory(3 bodies")
    assert (
        "iframe"
        not in MOTION.at([])._repr_html_() + MOTION.at([1.0])._repr_html_() + MOTION.at(1.0)._repr_html_()
    )
    pull = loads.constant_torque((0.0, 0.0, 0.1))
    few = BRICK.simulate(np.linspace(0.0, 40.0, 51), (0.01, 6.0, 0.0), load=pull)._repr_html_()
    assert "<svg" in few
    assert "past the half turn" in few
    assert "iframe" not in few


def test_show_in_a_notebook_and_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    shown = MOTION.at([0.0, 5.0]).show(title="A racket", height=300)
    assert shown.path is not None
    assert opened == [shown.path.as_uri()]
    assert shown.path.read_text("utf-8") == shown.page == framed(shown._repr_html_())
    assert "<title>A racket</title>" in shown.page
    assert 'height="300"' in shown._repr_html_()
    assert str(shown.path) in repr(shown)
    shown.path.unlink()
    shown.path.parent.rmdir()
    monkeypatch.setitem(sys.modules, "ipykernel", sys)
    there = MOTION.at([0.0, 5.0]).show()
    assert (there.path, repr(there), len(opened)) == (None, "<page of a motion>", 1)


@pytest.mark.parametrize("height", [239, 460.0, True, "460"])
def test_heights_that_are_none(height: object) -> None:
    with pytest.raises(ValueError, match=r"height: .* is not a whole number of pixels from 240 on"):
        MOTION.at([0.0, 5.0]).show(height=height)  # type: ignore[arg-type]


def _drawing(body: RigidBody) -> ElementTree.Element:
    return ElementTree.fromstring(ellipsoid_svg(body))
