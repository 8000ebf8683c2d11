"""What is drawn beside a motion is true of it: its path has the energy and the |L| of the surface that is named."""

from __future__ import annotations

import base64
import json
import re
from itertools import combinations
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
import pytest
from browser import Browser, needs_browser
from polhode import FreeMotion, GyrostatMotion, RigidBody, loads, plot
from polhode.animation import page_of
from random_motions import KINDS, Motion, motion

mpl.use("Agg")
from matplotlib import pyplot as plt

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

ROUNDING = 3e-7
"""Of vectors that a page holds in four bytes, beside the largest of them."""
RESOLVED = 1e-6
"""Curvatures of the energy below this, beside the largest there can be, are those of equal moments or a fold."""
COLOR_WORDS = r"\b(dark|light|black|white|gr[ae]y|blue|green|red|pink|purple|orange|brown|yellow|vermilion)\b"
SIZES = ((390, 844), (800, 700), (1440, 900))

DRAWN = """(items) => items.map(({ surface, moments, along, fastest }) => {
  const ellipsoid = new polhode.Ellipsoid(moments, along, fastest);
  const shows = { omega: fastest > 0 }, plain = (html) => html.replace(/<[^>]*>/g, "");
  const drawn = polhode.drawnWith(surface, ellipsoid), angles = [0, 1, 2.5, 4], parts = [-1, -0.9, -0.3, 0, 0.5, 1];
  return {
    drawn, ends: ellipsoid.ends, isCut: ellipsoid.isCut,
    points: drawn === "ellipsoid" ? parts.flatMap((part) => angles.map((angle) => ellipsoid.point(part, angle))) : [],
    separatrix: drawn === "ellipsoid" ? ellipsoid.separatrix() : [],
    captions: [false, true].map((isRolling) => plain(polhode.captionOf({ surface, ellipsoid, shows }, isRolling))),
  };
})"""


class Shown:
    """What a page holds of a motion, and the path from it: ω and L in the body at its frames."""

    def __init__(self, text: str) -> None:
        found = re.search(r'<script type="application/json" id="motion">(.*?)</script>', text)
        assert found
        self.data: dict[str, Any] = json.loads(found[1])
        self.surface: dict[str, Any] = self.data["surface"]
        self.moments, self.axes = np.array(self.data["moments"]), np.array(self.data["axes"])
        self.omega = self._vectors(self.data["omega"], self.data["omega_unit"])
        self.along = self.omega @ self.axes.T
        self.spin = self.along * self.moments @ self.axes
        self.fastest = float(np.linalg.norm(self.omega, axis=1).max())
        self.greatest = self.fastest * float(self.moments[2])
        self.momentum = self.spin
        if self.data["inside"] is not None:
            inside = self._vectors(self.data["inside"], self.data["inside_unit"])
            self.momentum = self.spin + inside
            self.greatest += float(np.abs(inside).max())

    def _vectors(self, text: str, unit: float) -> np.ndarray:
        return numbers(text) * unit

    def of_page(self) -> dict[str, Any]:
        """What the page's own functions are asked with."""
        start = self.data["free"]
        along = start["omega"] if start else self.along[0].tolist()
        surface = self.surface | {
            "marks": [mark | {"curve": bool(mark["curve"])} for mark in self.surface["marks"]]
        }
        return {
            "surface": surface,
            "moments": self.data["moments"],
            "along": along,
            "fastest": self.fastest,
        }


def numbers(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), dtype="<f4").reshape(-1, 3).astype(float)


def constant(values: np.ndarray, size: float) -> bool:
    """Whether values, or vectors, are so but for the rounding of numbers of a size."""
    return bool(np.ptp(values, axis=0).max() <= ROUNDING * size)


def shown(one: Motion) -> Shown:
    return Shown(page_of(one.motion, one.end)[0])


def check_data(one: Motion, page: Shown) -> None:
    """The kind that the page has of a motion is the one that its numbers obey, and it is the one that was made."""
    surface = page.surface
    assert surface["kind"] == one.kind
    np.testing.assert_allclose(
        (page.axes.T * page.moments) @ page.axes, tensor_at_reference(one), atol=1e-9 * page.moments[2]
    )
    size = np.linalg.norm(page.momentum, axis=1)
    if surface["kind"] == "free":
        assert constant((page.omega * page.spin).sum(axis=1), page.fastest * page.greatest)
        assert constant(size, page.greatest)
    if surface["momentum"] is not None:
        off = size - np.linalg.norm(surface["momentum"])
        assert np.abs(off).max() <= ROUNDING * page.greatest
    if surface["kind"] == "gyrostat":
        check_gyrostat(one, page)
    else:
        assert (surface["marks"], surface["level"]) == ([], None)
    if surface["kind"] == "loaded":
        assert surface["momentum"] is None


def tensor_at_reference(one: Motion) -> np.ndarray:
    body = one.motion.body
    about = getattr(one.motion, "about", None)
    if about is None:
        about = np.zeros(3) if one.kind == "loaded" else body.center_of_mass
    tensor: np.ndarray = body.inertia_about(about)
    return tensor


def check_gyrostat(one: Motion, page: Shown) -> None:
    """Energies of the path, of the marks and of the separatrices, in the body's own numbers; and what is stable."""
    surface, inverse, h = page.surface, np.linalg.inv(one.tensor), one.rotor
    assert h is not None
    size = float(np.linalg.norm(surface["momentum"]))
    units = size**2 / np.abs(one.tensor).max()

    def level(n: np.ndarray) -> Any:
        off = n * size - h
        return 0.5 * np.einsum("...i,ij,...j", off, inverse, off) / units

    marks = surface["marks"]
    scale = max([surface["level"], *(mark["level"] for mark in marks)])
    of_path = 0.5 * np.einsum("...i,ij,...j", page.omega, one.tensor, page.omega) / units
    np.testing.assert_allclose(
        of_path, surface["level"], rtol=0, atol=ROUNDING * page.fastest * page.greatest / units
    )
    np.testing.assert_allclose(
        page.momentum - page.omega @ one.tensor,
        np.tile(h, (len(of_path), 1)),
        rtol=0,
        atol=ROUNDING * page.greatest,
    )
    index = 0
    for mark in marks:
        n = np.array(mark["direction"])
        assert np.linalg.norm(n) == pytest.approx(1.0, abs=1e-12)
        assert mark["level"] == pytest.approx(level(n), abs=1e-9 * scale)
        rate = inverse @ (n * size - h)
        stiff = np.linalg.eigvalsh(inverse) * size
        assert np.linalg.norm(np.cross(rate, n)) < 1e-6 * max(np.linalg.norm(rate), stiff.max())
        across = np.linalg.svd(n[np.newaxis])[2][1:]
        curvature = np.linalg.eigvalsh(across @ (inverse * size - (rate @ n) * np.eye(3)) @ across.T)
        if mark["circle"] is None and np.abs(curvature).min() > RESOLVED * stiff.max():
            wanted = {2: "minimum", 1: "saddle", 0: "maximum"}[int((curvature > 0.0).sum())]
            assert mark["kind"] == wanted
            assert (mark["curve"] is not None) == (wanted == "saddle")
        if mark["curve"] is not None:
            curve = numbers(mark["curve"])
            np.testing.assert_allclose(np.linalg.norm(curve, axis=1), 1.0, atol=1e-6)
            sensitive = np.abs(rate).max() * size / units + ROUNDING
            np.testing.assert_allclose(level(curve), mark["level"], atol=1e-5 * (scale + sensitive))
            assert np.linalg.norm(curve - n, axis=1).min() < 0.05
        index += {"minimum": 1, "maximum": 1, "saddle": -1}.get(mark["kind"], 0)
    if all(mark["circle"] is None and mark["kind"] != "degenerate" for mark in marks):
        assert index == 2  # as many extrema more than saddles as on every sphere


def check_words(page: Shown, drawn: dict[str, Any]) -> None:
    """The words of the page's own functions, and the surface and the separatrix that they give."""
    surface, moments = page.surface, page.moments
    caption, rolling = drawn["captions"]
    assert not re.search(COLOR_WORDS, caption + rolling)
    size = np.linalg.norm(page.momentum, axis=1)
    doubled = (page.along**2 * moments).sum(axis=1)
    if "ellipsoid of inertia" in caption:
        assert constant(doubled, page.fastest * page.greatest)
        assert constant(size, page.greatest)
        assert (np.abs(page.along[:, 0]) <= drawn["ends"][0] * (1.0 + 1e-6)).all()  # no path beyond the cut
        points = np.array(drawn["points"])
        np.testing.assert_allclose((points**2 * moments).sum(axis=1), doubled[0], rtol=1e-6)
        for curve in np.array(drawn["separatrix"]).reshape(-1, 145, 3):
            np.testing.assert_allclose((curve**2 * moments).sum(axis=1), doubled[0], rtol=1e-6)
            np.testing.assert_allclose(
                (curve**2 * moments**2).sum(axis=1), doubled[0] * moments[1], rtol=1e-6
            )
        assert ("cut off" in caption) == drawn["isCut"]
        assert ("rod" in caption) == (moments[0] == 0.0)
    assert ("polhode" in caption) == ("ellipsoid of inertia" in caption)
    assert ("polhode is a point" not in caption) or constant(page.omega, page.fastest)
    if "sphere of constant |L|" in caption:
        assert constant(size, page.greatest)
    assert ("curve of constant ½ ω·Iω" in caption) == (surface["level"] is not None)
    curves = drawn["separatrix"] or [mark for mark in surface["marks"] if mark["curve"]]
    assert ("separatri" in caption) == bool(curves)
    if "unstable" in caption:
        assert any(mark["kind"] == "saddle" for mark in surface["marks"])
    if surface["kind"] == "loaded":
        assert not re.search("polhode|sphere|separatri|ellipsoid of", caption)


def check_many(browser: Browser, pages: list[Shown]) -> None:
    for first in range(0, len(pages), 200):
        part = pages[first : first + 200]
        found = browser.run(f"({DRAWN})({json.dumps([page.of_page() for page in part])})")
        for page, drawn in zip(part, found, strict=True):
            check_words(page, drawn)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    folder = tmp_path_factory.mktemp("surfaces")
    with Browser(folder) as one:
        blank = RigidBody(1.0, np.diag([1.0, 2.0, 2.5])).free_motion((1.0, 0.1, 0.1)).at([0.0, 1.0])
        one.open(blank.animate(folder / "a.html"), "#t=0")
        yield one


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_forty_random_motions(browser: Browser, kind: str) -> None:
    many = [motion(kind, k) for k in range(40)]
    pages = [shown(one) for one in many]
    for one, page in zip(many, pages, strict=True):
        check_data(one, page)
    check_many(browser, pages)


@needs_browser
@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("kind", KINDS)
def test_a_thousand_random_motions(browser: Browser, kind: str) -> None:
    pages = []
    for k in range(40, 1040):
        one = motion(kind, k)
        pages.append(shown(one))
        check_data(one, pages[-1])
    check_many(browser, pages)
