"""Moving pictures: the page as a browser shows it, GIF and film, and what is refused."""

from __future__ import annotations

import base64
import itertools
import json
import re
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.bodies import matrix
from PIL import Image
from polhode import RigidBody, Trajectory, solids


@pytest.fixture(scope="module")
def racket() -> Trajectory:
    box = solids.box((3.0, 2.0, 1.0), mass=2.0).translated((0.1, 0.0, 0.0))
    return box.simulate(np.linspace(0.0, 12.0, 481), omega=(0.05, 2.0, 0.02))


@pytest.fixture(scope="module")
def slow() -> Trajectory:
    """So short that the body may be seen to turn in four pictures."""
    box = solids.box((3.0, 2.0, 1.0), mass=2.0).translated((0.1, 0.0, 0.0))
    return box.simulate(np.linspace(0.0, 0.75, 31), omega=(0.05, 2.0, 0.02))


KINDS = {"t": ("<f8", -1), "quaternion": ("<f4", 4), "omega": ("<f4", 3), "inside": ("<f4", 3)}
KINDS |= {"vertices": ("<f4", 3), "faces": ("<u4", 3), "colors": ("u1", 3)}


def data(page: Path) -> dict[str, Any]:
    """What a page holds, its packed arrays unpacked; and L in space, as the page works it out."""
    found = re.search(r'<script type="application/json" id="motion">(.*?)</script>', page.read_text("utf-8"))
    assert found
    motion: dict[str, Any] = json.loads(found[1])
    for name, (kind, width) in KINDS.items():
        if motion[name] is not None:
            numbers = np.frombuffer(base64.b64decode(motion[name]), dtype=kind)
            motion[name] = numbers if width < 0 else numbers.reshape(-1, width)
    axes = np.array(motion["axes"])
    spin = motion["omega"] @ axes.T * motion["moments"] @ axes
    spin = spin if motion["inside"] is None else spin + motion["inside"]
    turned = [matrix(q) @ v for q, v in zip(motion["quaternion"].astype(float), spin, strict=True)]
    return motion | {"momentum": np.array(turned)}


class TestPage:
    def test_it_holds_the_motion_and_asks_nothing_of_the_network(
        self, racket: Trajectory, tmp_path: Path
    ) -> None:
        page = racket.animate(tmp_path / "racket.html", title='A <b>"racket"</b> & </script>')
        text = page.read_text("utf-8")
        assert not re.search(
            r"https?://|//cdn|<link|src=(?!.\$\{file\}#embed)|import\(|fetch\(|XMLHttpRequest", text
        )
        assert "<title>A &lt;b&gt;" in text
        motion = data(page)
        assert motion["title"] == 'A <b>"racket"</b> & </script>'
        assert (motion["t"][0], motion["t"][-1]) == (racket.t[0], racket.t[-1])
        exact = racket.body.free_motion(racket.omega[0]).at(motion["t"])
        np.testing.assert_allclose(motion["omega"], exact.omega, atol=1e-6)
        np.testing.assert_allclose(motion["quaternion"], exact.quaternion, atol=1e-6)
        momentum = motion["momentum"]  # of a free body: one vector
        np.testing.assert_allclose(momentum, np.broadcast_to(momentum[0], momentum.shape), atol=1e-5)

    def test_it_is_small(self, racket: Trajectory, tmp_path: Path) -> None:
        """Below 300 kB with as many frames as a page has."""
        long = racket.body.free_motion((0.05, 2.0, 0.02)).at([0.0, 1e5])
        with pytest.warns(UserWarning, match="shown is the beginning"):
            page = long.animate(tmp_path / "long.html")
        assert len(data(page)["t"]) == 3600
        assert page.stat().st_size < 300_000

    def test_its_modules_are_one_without_a_name_twice(self, racket: Trajectory, tmp_path: Path) -> None:
        text = racket.animate(tmp_path / "racket.html").read_text("utf-8")
        script = text.split('<script type="module">')[1]
        names = re.findall(r"(?m)^(?:const|let|class|function) (\w+)", script)
        assert len(names) == len(set(names)) > 50
        assert not re.search(r"(?m)^(import|export) ", script)

    def test_the_box_has_the_body_s_inertia(self, racket: Trajectory, tmp_path: Path) -> None:
        vertices = data(racket.animate(tmp_path / "racket.html"))["vertices"]
        sides = np.sort(np.ptp(vertices, axis=0))
        np.testing.assert_allclose(sides / sides[0], (1.0, 2.0, 3.0), rtol=1e-5)

    def test_a_rod_and_a_disk_have_a_page(self, tmp_path: Path) -> None:
        for moments in ((0.0, 1.0, 1.0), (1.0, 1.0, 2.0)):
            body = RigidBody.from_principal(1.0, moments)
            motion = body.simulate(np.linspace(0, 1, 11), omega=(0.0, 1.0, 0.5))
            page = motion.animate(tmp_path / "page.html")
            assert all(np.isfinite(data(page)[name]).all() for name in ("omega", "quaternion", "vertices"))
            assert (data(page)["free"] is None) == (moments[0] == 0.0)


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
