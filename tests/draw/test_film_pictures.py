"""The pictures of a film: what is written stands apart and inside at every size; how long each is shown."""

from __future__ import annotations

import itertools
import re
import subprocess
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from PIL import Image
from polhode import euler_angles, solids
from polhode.draw.scene import Scene

if TYPE_CHECKING:
    from pathlib import Path

    from polhode import Trajectory

pytest.importorskip("matplotlib")

SIZES = [(64, 64), (200, 200), (320, 240), (640, 360), (480, 800), (1920, 1080)]
BRICK = solids.box((3.0, 2.0, 1.0), mass=2.0)
TITLE = "A brick with a rather long title, as people write them"


def motions() -> dict[str, Any]:
    """A free body, a top, and a gyrostat with wheels of every kind."""
    cone = solids.cone(radius=0.03, height=0.06, mass=0.1).rotated((1.0, 0.0, 0.0, 0.0))
    attitude = euler_angles.to_quaternion((0.0, 0.9, 0.0))
    wheels = [
        polhode.wheel(axis=(0, 1, 1), inertia=0.3, rate=3.0),
        polhode.wheel(axis=(1, 1, 0), inertia=0.1, rate=-200.0),
        polhode.wheel(axis=(1, 0, 0), inertia=0.1, rate=5.0, mode="held"),
    ]
    return {
        "free": BRICK.free_motion((0.05, 2.0, 0.02)),
        "top": cone.translated((0.0, 0.0, 0.045)).heavy_top((0.3, 0.0, 16.0), attitude, (0.0, 0.0, -9.81)),
        "gyrostat": BRICK.gyrostat((0.1, 0.0, 0.0), wheels=wheels).free_motion((0.3, 0.2, 1.1)),
    }


def scene_of(motion: Any, title: str = TITLE) -> Scene:
    return Scene.of_motion(motion, 1.5, shape=None, title=title, is_film=True)


def texts_of(picture: Any) -> dict[str, Any]:
    """Where each text is in a picture, in pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    renderer = FigureCanvasAgg(picture.figure).get_renderer()  # type: ignore[no-untyped-call]
    shown = [text for text in picture.figure.texts if text.get_text()]
    for text in shown:
        text.set_path_effects([])
    return {text.get_text(): text.get_window_extent(renderer) for text in shown}


class TestWords:
    @pytest.mark.parametrize("name", ["free", "top", "gyrostat"])
    def test_none_is_cut_or_written_over_another(self, name: str) -> None:
        from polhode.draw.animation.film import Picture

        scene = scene_of(motions()[name])
        for size in SIZES:
            picture = Picture(scene, size, has_labels=True)
            for frame in range(0, len(scene.t), len(scene.t) // 4):
                picture.show(frame)
                boxes = texts_of(picture)
                assert "ω" in boxes
                assert any(text.startswith("t = ") for text in boxes)
                for text, box in boxes.items():
                    assert min(box.x0, box.y0) >= -1.0, (size, frame, text)
                    assert (box.x1, box.y1) <= (size[0] + 1.0, size[1] + 1.0), (size, frame, text)
                for (first, a), (second, b) in itertools.combinations(boxes.items(), 2):
                    across = min(a.x1, b.x1) - max(a.x0, b.x0)
                    along = min(a.y1, b.y1) - max(a.y0, b.y0)
                    assert min(across, along) <= 1.0, (size, frame, first, second)

    def test_a_long_title_has_several_lines(self) -> None:
        from polhode.draw.animation.film import Picture

        scene = scene_of(motions()["free"])
        for size, count in (((1920, 1080), 1), ((200, 200), 2)):
            lines = [text for text in texts_of(Picture(scene, size, has_labels=True)) if text in TITLE]
            assert (len(lines), " ".join(lines)) == (count, TITLE)
        (line,) = texts_of(Picture(scene, (64, 64), has_labels=True))
        assert line.endswith("…")
        dollars = scene_of(motions()["free"], title="$5 and $6")
        assert "$5 and $6" in texts_of(Picture(dollars, (200, 200), has_labels=True))

    def test_each_wheel_has_its_line_and_its_name(self) -> None:
        from polhode.draw.animation.film import Picture

        scene = scene_of(motions()["gyrostat"])
        picture = Picture(scene, (640, 360), has_labels=True)
        picture.show(0)
        found = " ".join(texts_of(picture))
        assert re.search(r"wheel 2: -200 rad/s, drawn \S+× slower", found)
        assert "wheel 3" in texts_of(picture)

    def test_without_labels_nothing_is_written(self) -> None:
        from polhode.draw.animation.film import Picture

        picture = Picture(scene_of(motions()["gyrostat"]), (200, 200), has_labels=False)
        picture.show(0)
        assert not picture.figure.texts
        assert not picture.figure.axes[0].texts

    @pytest.mark.parametrize("size", [(64, 64), (203, 149), (637, 359), (1921, 1079), (4096, 64)])
    def test_pixels_are_those_that_were_asked_for(self, size: tuple[int, int]) -> None:
        from polhode.draw.animation.film import Picture

        scene = scene_of(motions()["free"])
        assert Picture(scene, size, has_labels=True).pixels().shape == (size[1], size[0], 4)

    def test_the_clock_tells_pictures_apart(self) -> None:
        from polhode.draw.animation.film import Picture

        run = BRICK.simulate(1e6 + np.linspace(0.0, 10.0, 301), (0.05, 2.0, 0.02))
        scene = Scene.of(run, frames=301, duration=None, shape=None, title="", time_unit="s", is_film=True)
        picture = Picture(scene, (64, 64), has_labels=True)
        assert len({picture._time(frame) for frame in range(301)}) == 301


def slow(samples: int) -> Trajectory:
    return BRICK.simulate(np.linspace(0.0, 0.75, samples), omega=(0.05, 2.0, 0.02))


class TestDelays:
    @pytest.mark.parametrize(
        ("count", "duration"), [(300, 10.0), (1, 0.5), (7, 3.0), (50, 1.0), (13, 0.26), (1800, 60.0)]
    )
    def test_each_change_is_at_its_time(self, count: int, duration: float) -> None:
        from polhode.draw.animation.film import _delays

        delays = np.array(_delays(count, duration))
        changes = np.cumsum(delays)
        assert not (delays % 10).any()
        assert delays.min() >= 20
        assert changes[-1] == 1000.0 * duration
        np.testing.assert_allclose(changes, 1000.0 * duration * np.arange(1, count + 1) / count, atol=5.0)

    @pytest.mark.parametrize(("fps", "duration"), [(30, 0.4), (45, 0.4), (24, 0.25)])
    def test_a_gif_takes_its_time(self, fps: int, duration: float, tmp_path: Path) -> None:
        path = BRICK.free_motion((0.05, 2.0, 0.02)).at([0.0, 0.75])
        file = path.animate(tmp_path / "a.gif", size=64, fps=fps, duration=duration)
        delays = []
        with warnings.catch_warnings(), Image.open(file) as film:
            for number in range(getattr(film, "n_frames", 1)):
                film.seek(number)
                delays.append(film.info["duration"])
        assert (sum(delays), len(delays)) == (1000.0 * duration, fps * duration)

    def test_more_pictures_than_a_gif_shows(self, tmp_path: Path) -> None:
        run = slow(6)
        run.animate(tmp_path / "a.gif", frames=6, duration=0.12, size=64)
        with pytest.raises(
            ValueError, match=r"duration: 6 pictures in 0.119 s .* give duration=0.12 or more"
        ):
            run.animate(tmp_path / "a.gif", frames=6, duration=0.119, size=64)

    def test_samples_are_thinned_to_those_that_are_seen(self) -> None:
        options: dict[str, Any] = {"shape": None, "title": "", "time_unit": "s", "is_film": True}
        run = BRICK.simulate(
            np.linspace(0.0, 12.0, 481), (0.05, 2.0, 0.02), load=polhode.loads.rotor((0, 0, 1e-9))
        )
        for duration, count in ((4.0, 200), (9.6, 480), (9.62, 481), (20.0, 481)):
            scene = Scene.of(run, frames=None, duration=duration, **options)
            assert (len(scene.t), scene.duration) == (count, duration)
        (note,) = Scene.of(run, frames=None, duration=0.7, **options).notes
        assert note.endswith("give a longer duration")

    def test_a_slow_mp4_takes_its_time(self, tmp_path: Path) -> None:
        carrier = pytest.importorskip("imageio_ffmpeg")
        file = slow(4).animate(tmp_path / "a.mp4", frames=4, duration=20.0, size=64)
        command = [carrier.get_ffmpeg_exe(), "-i", file, "-f", "null", "-"]
        done = subprocess.run(command, capture_output=True, timeout=60, check=True)
        assert b"Duration: 00:00:20.00" in done.stderr
