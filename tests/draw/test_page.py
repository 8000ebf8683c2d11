"""The page as people meet it: each control, each size of screen, in a real browser."""

from __future__ import annotations

from itertools import combinations, permutations
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from browser import Browser, needs_browser
from colors import SEEN, lab, linear, luminance
from moving_pictures import BRICK, CONE, DESK, START, TOLD, inside, middle
from page_data import data
from polhode import RigidBody, euler_angles, loads
from polhode.animation import animate_motion

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

pytestmark = needs_browser


BETWEEN = "{}.map((t) => {{ const s = polhode.frames.at(t); return [s.q, s.omega]; }})"
MOVE = """(() => {{
  const slider = document.getElementById("{}");
  slider.value = {};
  slider.dispatchEvent(new Event("input"));
}})()"""
FASTER = """(() => {
  const choice = document.getElementById("speed");
  choice.selectedIndex += 1;
  choice.dispatchEvent(new Event("change"));
})()"""
NAMES = "polhode.views.{}.written.map((n) => [n.name, n.at, n.width, [n.x, n.y], [n.ux, n.uy], n.size])"
CAMERA = "(({ azimuth, elevation, zoom }) => [azimuth, elevation, zoom])(polhode.views.space)"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("pages")


@pytest.fixture(scope="module")
def page(folder: Path) -> Path:
    return BRICK.free_motion(START).at([0.0, 20.0]).animate(folder / "brick.html", title="A brick")


@pytest.fixture(scope="module")
def top(folder: Path) -> Path:
    motion = CONE.heavy_top((0.0, 0.0, 260.0), euler_angles.to_quaternion((0.0, 0.5, 0.0)), (0.0, 0.0, -9.81))
    animate_motion(motion, 2.0, folder / "top.html", title="A top")
    return folder / "top.html"


@pytest.fixture(scope="module")
def running(folder: Path) -> Iterator[Browser]:
    with Browser(folder) as one:
        yield one


@pytest.fixture
def browser(running: Browser) -> Browser:
    running.screen(*DESK)
    return running


def near(picture: NDArray[np.int64], color: str, within: int = 24) -> NDArray[np.bool_]:
    """Pixels of about a colour."""
    wanted = [int(color[k : k + 2], 16) for k in (1, 3, 5)]
    return np.asarray(np.abs(picture - wanted).max(axis=-1) <= within)


class TestWhatIsDrawn:
    def test_its_states_are_those_of_the_motion(
        self, browser: Browser, page: Path, rng: np.random.Generator
    ) -> None:
        """Between the frames too: the attitude to a tenth of a degree, ω to a thousandth."""
        browser.open(page, "#t=0")
        times = np.sort(rng.uniform(0.0, 20.0, 400))
        assert len(data(page)["t"]) < 250  # far fewer than a film has pictures
        rows = browser.run(BETWEEN.format(times.tolist()))
        quaternion, omega = (np.array(part) for part in zip(*rows, strict=True))
        exact = BRICK.free_motion(START).at(times)
        products = np.abs((quaternion * exact.quaternion).sum(axis=-1))
        assert np.rad2deg(2.0 * np.arccos(np.minimum(1.0, products))).max() < 0.1
        assert np.linalg.norm(omega - exact.omega, axis=-1).max() < 0.001 * 6.0 * 2.0

    def test_its_states_of_a_top(self, browser: Browser, top: Path, rng: np.random.Generator) -> None:
        browser.open(top, "#t=0")
        times = np.sort(rng.uniform(0.0, 2.0, 400))
        rows = browser.run(BETWEEN.format(times.tolist()))
        quaternion, _ = (np.array(part) for part in zip(*rows, strict=True))
        motion = CONE.heavy_top(
            (0.0, 0.0, 260.0), euler_angles.to_quaternion((0.0, 0.5, 0.0)), (0.0, 0.0, -9.81)
        )
        exact = motion.at(times)
        products = np.abs((quaternion * exact.quaternion).sum(axis=-1))
        assert np.rad2deg(2.0 * np.arccos(np.minimum(1.0, products))).max() < 0.1
        assert data(top)["top"]["path"] == str(motion.mode)
        assert np.array(data(top)["top"]["limits"]) == pytest.approx(motion.nutation_limits)

    @pytest.mark.parametrize("dark", [False, True])
    def test_the_body_is_in_the_middle_and_moves(self, browser: Browser, page: Path, dark: bool) -> None:
        browser.screen(*DESK, dark=dark)
        browser.open(page, "#t=3")
        early, (x, y) = browser.picture(), map(int, middle(browser, "space"))
        assert (early[0, 0] > 200).all() != dark
        around = early[y - 40 : y + 40, x - 60 : x + 60]
        # Its tints are pale, and neither the ground's nor grey.
        assert (np.ptp(around, axis=-1) > 25).mean() > 0.8
        browser.run("polhode.show(3)")
        assert np.array_equal(browser.picture(), early)
        browser.run("polhode.show(4.7)")
        late = browser.picture()
        left, right = np.array_split(np.abs(late - early).max(axis=-1) > 40, 2, axis=1)
        assert left.mean() > 0.01
        assert right.mean() > 0.0005

    def test_poinsot_s_ellipsoid_touches_its_plane(self, browser: Browser, page: Path) -> None:
        """The tip of ω is at one height at all times, where the plane is; the separatrix is drawn."""
        browser.open(page, "#t=3&view=poinsot")
        states = [browser.run(f"polhode.stateAt({t}).along") for t in np.linspace(0.0, 20.0, 21)]
        momenta = [browser.run(f"polhode.stateAt({t}).momentum") for t in np.linspace(0.0, 20.0, 21)]
        doubled = np.square(states) @ BRICK.principal_moments
        heights = doubled / np.linalg.norm(momenta, axis=-1)
        assert np.ptp(heights) < 1e-12 * heights[0]
        picture = browser.picture()
        x, y = (int(part) for part in middle(browser, "second"))
        shown = picture[y - 250 : y + 250, x - 250 : x + 250]
        assert near(shown, browser.run("polhode.colors.omega")).sum() > 150
        assert near(shown, browser.run("polhode.colors.e2"), 60).sum() > 200

    def test_names_are_not_written_over_each_other(self, browser: Browser, page: Path, top: Path) -> None:
        for one, end in ((page, 20.0), (top, 2.0)):
            browser.open(one, "#t=0")
            for t in np.linspace(0.0, end, 60):
                browser.run(f"polhode.show({t})")
                for view in ("space", "second"):
                    names = browser.run(
                        f"polhode.views.{view}.written.map((n) => [n.name, ...n.at, n.width])"
                    )
                    assert len(names) >= 4
                    for (_, x, y, width), (_, p, q, other) in combinations(names, 2):
                        assert abs(x - p) >= (width + other) / 2 + 4 or abs(y - q) >= 16

    def test_no_name_stands_on_the_arrow_of_another(self, browser: Browser, page: Path) -> None:
        """Where ω, **L**, z and an axis of the body lie on one line, their names stand beside it."""
        browser.open(page, "#t=0")
        for view in ("space", "second"):
            names = browser.run(NAMES.format(view))
            for (name, at, width, *_), (other, _, _, tip, way, size) in permutations(names, 2):
                ends = np.array(tip) - np.outer(np.linspace(0.0, min(size, 50.0), 26), way)
                inside = np.abs(ends - at) < (width / 2.0, 8.0)
                assert not inside.all(axis=-1).any(), (view, name, other)

    def test_a_load_s_samples(self, browser: Browser, tmp_path: Path) -> None:
        run = BRICK.simulate(np.linspace(0.0, 5.0, 201), START, load=loads.constant_torque((0.0, 0.0, 0.1)))
        browser.open(run.animate(tmp_path / "run.html"), "#t=2.5")
        assert browser.run("document.getElementById('live').hidden") is True
        found = browser.run("polhode.stateAt(2.5).omega")
        assert found == pytest.approx(run.omega[100], rel=1e-5)

    def test_colours_that_all_can_tell_apart(self, browser: Browser, page: Path) -> None:
        """To eyes without one kind of cones (Viénot 1999, Brettel 1997) no two lines look alike."""
        for dark in (False, True):
            browser.screen(*DESK, dark=dark)
            browser.open(page, "#t=0")
            named = browser.run("polhode.colors")
            lines = [named[name] for name in ("e1", "e2", "e3", "omega", "momentum")]
            for seen in SEEN.values():
                colors = [lab(seen @ linear(color)) for color in lines]
                assert min(np.linalg.norm(a - b) for a, b in combinations(colors, 2)) > 15.0
            ground = luminance(named["ground"])
            for color in (*lines, named["quiet"], named["ink"]):
                high, low = sorted((luminance(color), ground), reverse=True)
                assert (high + 0.05) / (low + 0.05) > 4.5  # WCAG 2.1, contrast of text


class TestControls:
    def test_play_and_pause(self, browser: Browser, page: Path) -> None:
        browser.open(page)
        assert browser.run("document.getElementById('play').textContent") == "Pause"
        browser.wait("polhode.now > 0.05")
        browser.run("document.getElementById('play').click()")
        at = browser.run("polhode.now")
        assert browser.run("new Promise((r) => setTimeout(() => r(polhode.now), 200))") == at
        browser.key(" ", " ")
        browser.wait(f"polhode.playing && polhode.now > {at}")

    def test_real_time(self, browser: Browser, page: Path, top: Path) -> None:
        """Speed 1 is real time; slow motion is named, and so much slower."""
        browser.open(page)
        words = "document.getElementById('speed').selectedOptions[0].textContent"
        assert browser.run(words) == "real time"
        browser.wait("polhode.now > 0")
        script = "new Promise((r) => { const t = performance.now(), a = polhode.now;"
        script += "setTimeout(() => r((polhode.now - a) / (performance.now() - t) * 1000), 600) })"
        assert browser.run(script) == pytest.approx(1.0, abs=0.35)
        browser.open(top)
        assert browser.run(words) == "slow motion 1/50"
        browser.run(FASTER)
        assert browser.run(words) != "slow motion 1/50"

    def test_the_slider_of_time(self, browser: Browser, page: Path) -> None:
        browser.open(page)
        browser.run(MOVE.format("slider", 0.25))
        assert browser.run("[polhode.now, polhode.playing]") == [5.0, False]
        assert browser.run("document.getElementById('clock').textContent") == "t = 5.00 s"

    @pytest.mark.parametrize(
        ("asked", "now"),
        [("#t=7", 7.0), ("#t=1e9", 20.0), ("#t=-3", 0.0), ("#t=soon", None), ("#t=", None), ("#t=NaN", None)],
    )
    def test_a_time_in_the_address(self, browser: Browser, page: Path, asked: str, now: float | None) -> None:
        browser.open(page, asked)
        if now is None:
            assert browser.run("polhode.playing && polhode.now < 5")
        else:
            assert browser.run("[polhode.now, polhode.playing]") == [now, False]

    def test_views_turn_and_turn_back(self, browser: Browser, page: Path) -> None:
        browser.open(page, "#t=3")
        home = browser.run(CAMERA)
        x, y = middle(browser, "space")
        browser.drag((x, y), (x + 60, y + 20))
        browser.run("document.getElementById('space').focus()")
        browser.key("+", "+")
        turned = browser.run(CAMERA)
        assert turned == pytest.approx([home[0] - 0.6, home[1] + 0.2, 1.15])
        browser.key("ArrowLeft")
        assert browser.run("polhode.views.space.azimuth") == pytest.approx(turned[0] + 0.1)
        browser.run("document.getElementById('reset').click()")
        assert browser.run(CAMERA) == home

    @pytest.mark.parametrize("box", ["traces", "axes"])
    def test_boxes(self, browser: Browser, page: Path, box: str) -> None:
        browser.open(page, "#t=15")
        before = browser.picture()
        browser.run(f"document.getElementById({box!r}).click()")
        browser.run("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))")
        assert (np.abs(browser.picture() - before).max(axis=-1) > 30).sum() > 200

    def test_another_start(self, browser: Browser, page: Path) -> None:
        """A slider moves: the page computes the motion anew, as the package does; and goes back."""
        browser.open(page, "#t=4")
        given = browser.run("polhode.stateAt(4).omega")
        for name, value in (("size", 4.0), ("tilt", 20.0), ("toward", 30.0), ("second", 0.8), ("first", 0.6)):
            browser.run(
                f"(() => {{ const s = document.getElementById('start-{name}'); s.value = {value};"
                "s.dispatchEvent(new Event('input')) })()"
            )
        tilt, toward = np.deg2rad(20.0), np.deg2rad(30.0)
        omega = 4.0 * np.array([np.sin(tilt) * np.sin(toward), np.cos(tilt), np.sin(tilt) * np.cos(toward)])
        exact = (
            RigidBody.from_principal(1.0, 3.2 * np.array([0.6, 0.8, 1.0])).free_motion(omega).at([4.0, 11.0])
        )
        for t, wanted, attitude in zip((4.0, 11.0), exact.omega, exact.quaternion, strict=True):
            found = browser.run(f"(() => {{ const s = polhode.stateAt({t}); return [s.omega, s.q] }})()")
            assert found[0] == pytest.approx(wanted, abs=1e-9)
            assert abs(np.dot(found[1], attitude)) == pytest.approx(1.0, abs=1e-9)
        assert "circles e" in browser.run("document.getElementById('mode').textContent")
        browser.run("document.getElementById('given').click()")
        assert browser.run("polhode.stateAt(4).omega") == given

    def test_moments_that_no_body_has(self, browser: Browser, page: Path) -> None:
        browser.open(page, "#t=4")
        for name, value in (("second", 0.5), ("first", 0.001), ("first", 1.0), ("second", 0.5)):
            browser.run(
                f"(() => {{ const s = document.getElementById('start-{name}'); s.value = {value};"
                "s.dispatchEvent(new Event('input')) })()"
            )
            first, second, third = browser.run("polhode.motion.moments")
            assert 0.0 < first <= second <= third <= (first + second) * (1.0 + 1e-12)
            assert np.isfinite(browser.run("polhode.stateAt(3).omega")).all()

    def test_numbers(self, browser: Browser, page: Path, top: Path) -> None:
        def told() -> dict[str, str]:
            found: dict[str, str] = browser.run(TOLD)
            return found

        motion = BRICK.free_motion(START)
        browser.open(page, "#t=4")
        numbers = told()
        assert float(numbers["T"]) == pytest.approx(float(motion.kinetic_energy().total), rel=1e-5)
        assert float(numbers["|L|"]) == pytest.approx(
            np.linalg.norm(motion.angular_momentum().total), rel=1e-5
        )
        assert float(numbers["|ω|"].split()[0]) == pytest.approx(
            np.linalg.norm(motion.at(4.0).omega), rel=1e-4
        )
        flip = 4.0 + float(numbers["next flip"].split()[1])
        assert abs(motion.at(flip).omega[1]) < 0.02
        energies = []
        for t in (0.1, 1.1, 1.9):
            browser.open(top, f"#t={t}")
            energies.append(float(told()["T + V"]))
        assert energies == pytest.approx([energies[0]] * 3, rel=1e-5)

    def test_a_line_for_another_page(self, browser: Browser, page: Path, folder: Path) -> None:
        browser.open(page)
        line = browser.run("document.getElementById('frame').value")
        assert line.startswith('<iframe src="brick.html#embed"')
        assert " allowfullscreen " in line  # without it the page hides its button for the full screen
        outer = folder / "outer.html"
        outer.write_text(
            f"<!DOCTYPE html><p>Before</p>{line}<script>var polhode = {{}}</script>", encoding="utf-8"
        )
        browser.screen(800, 600, still=True)
        browser.open(outer)
        browser.run("new Promise((r) => setTimeout(r, 500))")
        picture = browser.picture()
        assert (np.ptp(picture[60:400, 20:640], axis=-1) > 25).sum() > 2000
        browser.screen(640, 420)
        browser.open(page, "#embed")
        assert browser.run("document.documentElement.scrollHeight <= innerHeight")
        assert all(inside(browser, name) for name in ("play", "slider", "speed", "full"))
