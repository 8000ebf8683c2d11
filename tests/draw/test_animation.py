"""Moving pictures: the page as a browser shows it, GIF and film, and what is refused."""

from __future__ import annotations

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
from page_data import data
from PIL import Image
from polhode import RigidBody, Trajectory, animation, euler_angles, solids
from polhode.animation import animate
from polhode.draw import sampling, shape, wheels


@pytest.fixture(scope="module")
def racket() -> Trajectory:
    box = solids.box((3.0, 2.0, 1.0), mass=2.0).translated((0.1, 0.0, 0.0))
    return box.simulate(np.linspace(0.0, 12.0, 481), omega=(0.05, 2.0, 0.02))


@pytest.fixture(scope="module")
def slow() -> Trajectory:
    """So short that the body may be seen to turn in four pictures."""
    box = solids.box((3.0, 2.0, 1.0), mass=2.0).translated((0.1, 0.0, 0.0))
    return box.simulate(np.linspace(0.0, 0.75, 31), omega=(0.05, 2.0, 0.02))


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


BAR = solids.box((0.080, 0.012, 0.012), density=7850.0)
STEM = solids.box((0.012, 0.012, 0.048), density=7850.0).translated((0.0, 0.0, -0.030))


class TestShapes:
    def test_parts_are_drawn_where_they_are(self, tmp_path: Path) -> None:
        """The T-handle of two boxes: its surface has the volume and the centre of mass of the body."""
        handle = BAR + STEM
        motion = handle.simulate([0.0, 1.0], (0.01, 0.0, 6.28))
        shown, by_hand = (
            data(motion.animate(tmp_path / "a.html")),
            data(motion.animate(tmp_path / "b.html", shape=[BAR, STEM])),
        )
        assert np.array_equal(shown["vertices"], by_hand["vertices"])
        vertices = shown["vertices"].astype(float) + handle.center_of_mass
        drawn = RigidBody.from_mesh(vertices, shown["faces"].astype(int), density=7850.0, check=False)
        np.testing.assert_allclose(drawn.inertia, handle.inertia, rtol=1e-5, atol=1e-12)
        assert len(np.unique(shown["colors"], axis=0)) == 2

    def test_a_mesh_among_parts(self, tmp_path: Path) -> None:
        mesh = (np.eye(3), [(0, 1, 2)])
        page = BAR.simulate([0.0, 1.0], (1.0, 0.0, 0.0)).animate(tmp_path / "a.html", shape=[BAR, mesh])
        assert len(data(page)["faces"]) == 13

    def test_no_parts_and_stacks(self, tmp_path: Path) -> None:
        motion = BAR.simulate([0.0, 1.0], (1.0, 0.0, 0.0))
        with pytest.raises(ValueError, match="shape: the list has no parts"):
            motion.animate(tmp_path / "a.html", shape=[])
        with pytest.raises(ValueError, match=r"shape: expected one body, got a stack of shape \(2,\)"):
            motion.animate(tmp_path / "a.html", shape=[RigidBody.stack([BAR, STEM])])


class TestClosedForms:
    """Motions that have no times of their own are shown to an end."""

    BRICK = RigidBody.from_principal(1.0, (1.0, 3.0, 3.2))

    def test_they_need_an_end(self, tmp_path: Path) -> None:
        motion = self.BRICK.free_motion((0.01, 6.0, 0.0))
        shown = data(animate(motion, tmp_path / "a.html", end=-5.0))
        assert (shown["t"][0], shown["t"][-1]) == (0.0, -5.0)
        assert shown["free"]["omega"] == pytest.approx([0.01, 6.0, 0.0])
        assert len(data(animate(motion, tmp_path / "a.html", end=5.0, frames=201))["t"]) == 201
        with pytest.raises(ValueError, match="end: a motion in closed form has no end of its own"):
            animate(motion, tmp_path / "a.html")
        with pytest.raises(ValueError, match="end: a trajectory has its own times"):
            animate(motion.at([0.0, 1.0]), tmp_path / "a.html", end=5.0)
        with pytest.raises(ValueError, match="end: inf is not a finite time"):
            animate(motion, tmp_path / "a.html", end=np.inf)

    def test_a_top_and_its_trajectory(self, tmp_path: Path) -> None:
        """From two samples of it the same page as from the top itself: pivot, axis, limits, kind of path."""
        cone = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0))
        body = cone.translated((0.0, 0.0, 0.045))
        attitude = euler_angles.to_quaternion((0.0, 0.5, 0.0))
        top = body.heavy_top((0.3, 0.0, 160.0), attitude, (0.0, 0.0, -9.81))
        first = data(animate(top, tmp_path / "a.html", end=1.0))
        second = data(top.at([0.0, 1.0]).animate(tmp_path / "b.html"))
        assert first["top"]["path"] == second["top"]["path"] == str(top.mode)
        assert first["top"]["limits"] == pytest.approx(list(top.nutation_limits), abs=1e-9)
        assert first["top"]["axis"] == pytest.approx([0.0, 0.0, 1.0])
        np.testing.assert_allclose(first["t"], second["t"])
        np.testing.assert_allclose(first["quaternion"], second["quaternion"], atol=1e-6)

    def test_a_pivot_without_gravity(self, tmp_path: Path) -> None:
        box = solids.box((3.0, 2.0, 1.0), mass=1.0).translated((0.0, 0.0, 1.0))
        run = box.simulate(np.linspace(0.0, 1.0, 101), (0.3, 0.2, 3.0), about="origin")
        shown = data(run.animate(tmp_path / "a.html"))
        assert (shown["top"]["limits"], shown["free"]) == ([], None)

    def test_methods(self, tmp_path: Path) -> None:
        free = self.BRICK.free_motion((0.01, 6.0, 0.0))
        assert free.animate(tmp_path / "a.html", 5.0, title="A") == tmp_path / "a.html"
        assert data(tmp_path / "a.html")["t"][-1] == 5.0
        pytest.importorskip("matplotlib")
        assert free.plot(5.0).lines[0].get_xdata()[-1] == 5.0


class TestTime:
    """Speed 1 is real time; where that cannot be watched, a round part or multiple of it."""

    @pytest.mark.parametrize(
        ("rate", "end", "unit", "factor"),
        [
            (6.0, 20.0, "s", 1.0),
            (10.4, 20.0, "s", 1.0),
            (10.6, 20.0, "s", 0.5),
            (600.0, 3.0, "s", 0.01),
            (6.0, 0.5, "s", 0.05),
            (0.001, 3600.0, "s", 200.0),
            (0.5, 30.0, "h", 10000.0),
            (6.0, 20.0, "turns", None),
        ],
    )
    def test_paces(self, rate: float, end: float, unit: str, factor: float | None, tmp_path: Path) -> None:
        motion = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0)).free_motion((0.0, 0.0, rate))
        seconds = data(animate(motion, tmp_path / "a.html", end=end, time_label=unit))["duration"]
        unit_seconds = {"s": 1.0, "h": 3600.0, "turns": 1.0}[unit]
        if factor is None:
            assert seconds == pytest.approx(max(10.0, end * rate / 30.0 / np.deg2rad(20.0)))
        else:
            assert end * unit_seconds / seconds == pytest.approx(factor)
            assert rate * end / seconds / 30.0 <= np.deg2rad(20.0) * (1.0 + 1e-9)

    def test_the_page_knows_the_same_units(self, racket: Trajectory, tmp_path: Path) -> None:
        """And the other numbers of both: the package writes them into the page."""
        text = racket.animate(tmp_path / "racket.html").read_text("utf-8")
        names = ("SECONDS", "PICTURES", "TURN", "SPOKES", "SPOKE", "RINGS", "TINTS")
        found = {name: json.loads(text.split(f"\nconst {name} = ")[1].split(";\n")[0]) for name in names}
        assert found["SECONDS"] == sampling.SECONDS
        assert (found["TURN"], found["PICTURES"]) == (sampling.TURN, sampling.RATE)
        assert (found["SPOKES"], found["SPOKE"], found["RINGS"]) == (
            wheels.SPOKES,
            wheels.SPOKE,
            [*wheels.RINGS],
        )
        assert found["TINTS"] == shape.BOX_TINTS.tolist()
        for name in names:
            for module in (Path(animation.__file__).parent / "page").glob("*.js"):
                assert f"const {name} " not in module.read_text("utf-8")


class TestFilm:
    @pytest.mark.parametrize(("size", "pixels"), [(200, (200, 200)), ((320, 180), (320, 180))])
    def test_sizes_and_speeds(
        self, slow: Trajectory, tmp_path: Path, size: Any, pixels: tuple[int, int]
    ) -> None:
        pytest.importorskip("matplotlib")
        path = slow.animate(tmp_path / "a.gif", frames=6, size=size, fps=20, labels=False)
        with Image.open(path) as film:
            assert film.size == pixels
            assert film.info["duration"] == 50
            bare = np.asarray(film.convert("RGB")).astype(int)
        with Image.open(slow.animate(tmp_path / "b.gif", frames=6, size=size, fps=20)) as film:
            named = np.asarray(film.convert("RGB")).astype(int)
        assert (np.abs(named - bare).max(axis=-1) > 60).sum() > 60  # title, time and the names of the axes

    def test_pictures_a_second(self, slow: Trajectory, tmp_path: Path) -> None:
        pytest.importorskip("matplotlib")
        path = slow.animate(tmp_path / "a.gif", size=64, fps=10, duration=1.5)
        with Image.open(path) as film:
            assert (getattr(film, "n_frames", 1), film.info["duration"]) == (15, 100)

    def test_a_top_s_axis_leaves_its_path(self, tmp_path: Path) -> None:
        pytest.importorskip("matplotlib")
        cone = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0))
        top = cone.translated((0.0, 0.0, 0.045)).heavy_top(
            (0.3, 0.0, 30.0), euler_angles.to_quaternion((0.0, 0.9, 0.0)), (0.0, 0.0, -9.81)
        )
        motion = top.at(np.linspace(0.0, 0.3, 41))
        path = motion.animate(tmp_path / "a.gif", frames=41, fps=20, size=200, labels=False)
        seen = []
        with warnings.catch_warnings(), Image.open(path) as film:
            for number in (0, 40):
                film.seek(number)
                pixels = np.asarray(film.convert("RGB")).astype(int)
                seen.append((np.abs(pixels - 0x55).max(axis=-1) < 8).sum())
        assert seen[1] > seen[0] + 20

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"size": 63}, "size: 63 is not a number of pixels from 64 to 4096"),
            ({"size": 4097}, "size: 4097 is not"),
            ({"size": (200.0, 200)}, "size: "),
            ({"size": (200, 200, 200)}, "size: "),
            ({"fps": 0.5}, "fps: 0.5 is not from 1"),
            ({"fps": 51}, "fps: 51 is not from 1 to 240 pictures a second, or 50 of a GIF"),
            ({"fps": float("nan")}, "fps: nan is not"),
            ({"fps": 20, "duration": 1.0, "frames": 6}, "fps: of samples each is one picture"),
        ],
    )
    def test_what_is_no_film(
        self, slow: Trajectory, tmp_path: Path, options: dict[str, Any], message: str
    ) -> None:
        pytest.importorskip("matplotlib")
        with pytest.raises(ValueError, match=message):
            slow.animate(tmp_path / "a.gif", **options)

    def test_an_mp4_has_even_sizes(self, slow: Trajectory, tmp_path: Path) -> None:
        pytest.importorskip("imageio_ffmpeg")
        with pytest.raises(ValueError, match=r"size: \(201, 200\): an MP4 has even .* such as \(202, 200\)"):
            slow.animate(tmp_path / "a.mp4", frames=4, size=(201, 200))

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
