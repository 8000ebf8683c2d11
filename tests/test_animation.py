"""Moving pictures: the page as a browser shows it, GIF and film, and what is refused."""

from __future__ import annotations

import io
import itertools
import json
import re
import shutil
import subprocess
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image
from polhode import RigidBody, Trajectory, solids

if TYPE_CHECKING:
    from numpy.typing import NDArray

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


@pytest.fixture(scope="module")
def racket() -> Trajectory:
    box = solids.box((3.0, 2.0, 1.0), mass=2.0).translated((0.1, 0.0, 0.0))
    return box.simulate(np.linspace(0.0, 12.0, 481), omega=(0.05, 2.0, 0.02))


@pytest.fixture(scope="module")
def slow() -> Trajectory:
    """So short that the body may be seen to turn in four pictures."""
    box = solids.box((3.0, 2.0, 1.0), mass=2.0).translated((0.1, 0.0, 0.0))
    return box.simulate(np.linspace(0.0, 0.75, 31), omega=(0.05, 2.0, 0.02))


def data(page: Path) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="motion">(.*?)</script>', page.read_text("utf-8"))
    assert found
    motion: dict[str, Any] = json.loads(found[1])
    return motion


class TestPage:
    def test_it_holds_the_motion_and_asks_nothing_of_the_network(
        self, racket: Trajectory, tmp_path: Path
    ) -> None:
        page = racket.animate(tmp_path / "racket.html", title='A <b>"racket"</b> & </script>')
        text = page.read_text("utf-8")
        assert not re.search(r"https?://|//cdn|<link|src=|import\(|fetch\(|XMLHttpRequest", text)
        assert "<title>A &lt;b&gt;" in text
        motion = data(page)
        assert motion["title"] == 'A <b>"racket"</b> & </script>'
        fastest = np.linalg.norm(racket.omega, axis=1).max()
        np.testing.assert_allclose(np.array(motion["omega"]) * fastest, racket.omega, atol=1e-6)
        np.testing.assert_allclose(motion["quaternion"], racket.quaternion, atol=1e-7)
        np.testing.assert_array_equal(motion["t"], racket.t)
        momentum = np.array(motion["momentum"])  # of a free body: one direction
        np.testing.assert_allclose(momentum, np.broadcast_to(momentum[0], momentum.shape), atol=1e-6)

    def test_omega_lies_on_the_ellipsoid_that_is_drawn(self, racket: Trajectory, tmp_path: Path) -> None:
        motion = data(racket.animate(tmp_path / "racket.html", frames=60))
        along = np.array(motion["omega"]) @ np.array(motion["axes"]).T
        np.testing.assert_allclose(((along / np.array(motion["ellipsoid"])) ** 2).sum(axis=1), 1.0, atol=1e-5)

    def test_the_box_has_the_body_s_inertia(self, racket: Trajectory, tmp_path: Path) -> None:
        shape = data(racket.animate(tmp_path / "racket.html"))["shape"]
        assert isinstance(shape, dict)
        sides = np.sort(np.ptp(np.array(shape["vertices"]), axis=0))
        np.testing.assert_allclose(sides / sides[0], (1.0, 2.0, 3.0), rtol=1e-5)

    def test_a_rod_and_a_disk_have_a_page(self, tmp_path: Path) -> None:
        for moments in ((0.0, 1.0, 1.0), (1.0, 1.0, 2.0)):
            body = RigidBody.from_principal(1.0, moments)
            motion = body.simulate(np.linspace(0, 1, 11), omega=(0.0, 1.0, 0.5))
            page = motion.animate(tmp_path / "page.html")
            assert np.isfinite(np.array(data(page)["ellipsoid"], dtype=float)).all()


@pytest.mark.skipif(BROWSER is None, reason="no Chromium: apt install chromium")
@pytest.mark.timeout(300)
class TestInTheBrowser:
    def test_it_moves_between_two_moments(self, racket: Trajectory, tmp_path: Path) -> None:
        """At rest at t = 3 and at t = 7 the pictures differ; the same moment is the same."""
        page = racket.animate(tmp_path / "racket.html")
        early, again, late = (screenshot(page, tmp_path, at) for at in (3.0, 3.0, 7.0))
        assert np.ptp(early) > 100  # something is drawn
        assert np.array_equal(early, again)
        left, right = np.array_split(np.abs(late - early).max(axis=-1) > 40, 2, axis=1)
        assert left.mean() > 0.01  # the body in space
        assert right.mean() > 0.0005  # ω on the ellipsoid

    def test_the_clock_runs_by_itself(self, racket: Trajectory, tmp_path: Path) -> None:
        page = racket.animate(tmp_path / "racket.html")
        # On a busy machine the browser may draw no frame within its time.
        assert any(0.0 < clock(page, tmp_path) <= 12.0 for _ in range(4))
        assert clock(page, tmp_path, at=7.0) == 7.0


def browse(page: Path, folder: Path, *action: str, at: float | None = None) -> str:
    assert BROWSER is not None
    url = page.as_uri() + ("" if at is None else f"#t={at}")
    arguments = ["--headless=new", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}"]
    arguments += ["--virtual-time-budget=3000", "--window-size=1100,760", *action, url]
    done = subprocess.run([BROWSER, *arguments], capture_output=True, text=True, timeout=120, check=True)
    return done.stdout


def screenshot(page: Path, folder: Path, at: float) -> NDArray[np.int64]:
    picture = folder / "screen.png"
    picture.unlink(missing_ok=True)
    browse(page, folder, f"--screenshot={picture}", at=at)
    return np.asarray(Image.open(io.BytesIO(picture.read_bytes())).convert("RGB")).astype(np.int64)


def clock(page: Path, folder: Path, at: float | None = None) -> float:
    dom = browse(page, folder, "--dump-dom", at=at)
    found = re.search(r'<output id="clock">t = ([0-9.]+) s</output>', dom)
    assert found
    return float(found[1])


class TestFilm:
    def test_a_gif_has_its_frames_and_they_differ(self, slow: Trajectory, tmp_path: Path) -> None:
        pytest.importorskip("matplotlib")
        told: list[float] = []
        path = slow.animate(tmp_path / "racket.GIF", frames=4, duration=2.0, progress=told.append)
        assert told == [0.25, 0.5, 0.75, 1.0]
        with warnings.catch_warnings(), Image.open(path) as film:
            assert getattr(film, "n_frames", 1) == 4
            assert film.info["duration"] == 500
            frames = []
            for number in range(4):
                film.seek(number)
                frames.append(np.asarray(film.convert("L")).astype(int))
        assert all((np.abs(a - b) > 30).mean() > 0.002 for a, b in itertools.pairwise(frames))

    def test_a_film_shows_the_body_move(
        self, slow: Trajectory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """By the program that the extra brings: the system's is out of reach."""
        carrier = pytest.importorskip("imageio_ffmpeg")
        monkeypatch.setenv("PATH", "")
        path = slow.animate(tmp_path / "racket.mp4", frames=6, duration=2.0)
        command = [carrier.get_ffmpeg_exe(), "-i", path, "-f", "rawvideo", "-pix_fmt", "gray", "-"]
        done = subprocess.run(command, capture_output=True, timeout=60, check=True)
        assert re.search(rb"Video: h264.* 480x480.* 3 fps", done.stderr)
        frames = np.frombuffer(done.stdout, dtype=np.uint8).reshape(6, 480, 480).astype(int)
        assert all(np.ptp(frame) > 100 for frame in frames)
        assert all((np.abs(a - b) > 30).mean() > 0.002 for a, b in itertools.pairwise(frames))

    def test_without_ffmpeg_it_says_what_does_without(
        self, slow: Trajectory, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setenv("PATH", "")
        monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
        with pytest.raises(
            FileNotFoundError, match=r'racket\.mp4 needs .*"polhode\[film\]".*\.gif or \.html'
        ):
            slow.animate(tmp_path / "racket.mp4", frames=4)


class TestRefusals:
    def test_other_names(self, racket: Trajectory, tmp_path: Path) -> None:
        with pytest.raises(ValueError, match=r"does not end in \.html, \.gif or \.mp4"):
            racket.animate(tmp_path / "racket.avi")

    def test_stacks(self, tmp_path: Path) -> None:
        many = solids.cube(np.ones(3), mass=1.0).simulate([0.0, 1.0], (1.0, 0.0, 0.0))
        with pytest.raises(ValueError, match=r"one body, got a stack of shape \(3,\)"):
            many.animate(tmp_path / "many.html")

    @pytest.mark.parametrize("frames", [0, 482])
    def test_more_frames_than_samples(self, racket: Trajectory, tmp_path: Path, frames: int) -> None:
        with pytest.raises(ValueError, match=f"frames: {frames} is not between 1 and the 481 samples"):
            racket.animate(tmp_path / "racket.html", frames=frames)

    @pytest.mark.parametrize("duration", [0.0, -1.0, np.inf, np.nan])
    def test_durations(self, racket: Trajectory, tmp_path: Path, duration: float) -> None:
        with pytest.raises(ValueError, match="duration"):
            racket.animate(tmp_path / "racket.html", duration=duration)

    def test_a_mesh_with_a_face_too_many(self, racket: Trajectory, tmp_path: Path) -> None:
        with pytest.raises(ValueError, match="a face names vertex 3, but they run from 0 to 2"):
            racket.animate(tmp_path / "racket.html", shape=(np.eye(3), [(0, 1, 3)]))
