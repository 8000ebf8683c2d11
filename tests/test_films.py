"""Films and still pictures of a motion, and where they end."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run
from polhode.draw.sampling import TURN, drawn_times, fastest
from test_animation_frames import BRICK, angles, check_chords, check_frames, in_space, top

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


class TestFilms:
    def test_its_pictures_are_even_and_follow(self) -> None:
        from polhode.draw.sampling import of_motion

        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        ends = motion.at([0.0, 30.0])
        for duration, count in ((None, None), (20.0, 600), (13.0, None)):
            film = of_motion(motion, ends, duration=duration, is_film=True, time_unit="s")
            t = film.trajectory.t[film.chosen]
            np.testing.assert_allclose(np.diff(t), t[1], rtol=1e-9)
            assert (t[0], t[-1], film.notes) == (0.0, 30.0, ())
            assert angles(motion.at(t).quaternion).max() <= TURN * (1.0 + 1e-9)
            assert len(t) / film.duration <= 50.0
            assert film.duration == (len(t) / 30.0 if duration is None else duration)
            assert count is None or len(t) == count
            check_chords(lambda times: in_space(motion.at(times)) / fastest(motion), film.trajectory.t)
        uneven = motion.at(10.0 * np.linspace(0.0, 1.0, 344) ** 2)  # as many samples as the film has pictures
        film = of_motion(motion, uneven, duration=None, is_film=True, time_unit="s")
        t = film.trajectory.t[film.chosen]
        np.testing.assert_allclose(t, np.linspace(0.0, 10.0, len(t)), atol=1e-12)
        np.testing.assert_allclose(film.trajectory.omega, motion.at(film.trajectory.t).omega, atol=1e-9)
        slow = of_motion(motion, motion.at([0.0, 0.1]), duration=None, is_film=True, time_unit="s")
        assert (len(slow.chosen), slow.duration) == (300, 10.0)

    def test_what_it_cannot_show(self) -> None:
        from polhode.draw.sampling import of_motion

        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        film = of_motion(motion, motion.at([0.0, 1e4]), duration=None, is_film=True, time_unit="s")
        (note,) = film.notes
        assert re.match(r"shown is the beginning, to \S+ of 10000 s: 1800 frames", note)
        t = film.trajectory.t[film.chosen]
        assert len(t) == 1800
        assert angles(motion.at(t).quaternion).max() <= TURN * (1.0 + 1e-9)
        with pytest.raises(ValueError, match=r"duration: .*half turn.*give a longer one"):
            of_motion(motion, motion.at([0.0, 1e4]), duration=10.0, is_film=True, time_unit="s")
        fast = of_motion(motion, motion.at([0.0, 60.0]), duration=10.0, is_film=True, time_unit="s")
        assert "more than the 30" in fast.notes[0]


class TestPictures:
    def test_their_curves_follow_the_motion(self) -> None:
        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        t = drawn_times(motion, [0.0, 100.0])
        assert (t[0], t[-1]) == (0.0, 100.0)
        check_frames(motion, t, fastest(motion))
        pytest.importorskip("matplotlib")
        from matplotlib.figure import Figure
        from polhode import plot

        for draw in (plot.poinsot, plot.cones):
            ax: Any = Figure().add_subplot(projection="3d", computed_zorder=False)
            draw(motion, [0.0, 100.0], ax)
            assert len(t) in [len(line.get_data_3d()[0]) for line in ax.lines]
            with pytest.raises(ValueError, match=r"t: a curve through 50000 points .* give a shorter span"):
                draw(motion, [0.0, 1e7])
            with pytest.raises(ValueError, match="t: expected one or more finite times"):
                draw(motion, [0.0, np.nan])
            with pytest.raises(ValueError, match="t: expected one or more finite times"):
                draw(motion, [])
        ax = Figure().add_subplot(projection="3d", computed_zorder=False)
        plot.nutation(top(260.0), [0.0, 20.0], ax)
        assert max(len(line.get_data_3d()[0]) for line in ax.lines) > 1000

    def test_numbers_whose_times_are_too_few_are_told(self, tmp_path: Path) -> None:
        words = ("spin", "--moments", "1 3 3.2", "--omega", 0.01, 6, 0, "--end", 2000, "--save")
        out = run(*words, tmp_path / "a.csv")[1]
        told = re.search(r"a.csv: .* the body turns by up to \S+ deg, .*; --times (\d+) follows it", out)
        assert told
        assert "turns by" not in run(*words, tmp_path / "a.csv", "--times", told[1])[1]


class TestTheEnd:
    @pytest.mark.parametrize("until", ["1e300", "1e16", " -1e300"])
    def test_beyond_what_digits_tell(self, until: str) -> None:
        code, _, err = run("spin", "--moments", "1 3 3.2", "--omega", 0.01, 6, 0, "--end", until)
        assert code == 2
        assert re.match(r"polhode: --end: after \S+ s at \S+ rad/s the last digit .* end before \S+ s", err)

    def test_both_sides_of_it(self) -> None:
        rate = fastest(BRICK.free_motion((0.01, 6.0, 0.0)))
        last = 1.0 / (rate * np.finfo(float).eps)
        for factor, expected in ((0.99, 0), (1.01, 2)):
            words = ("--moments", "1 3 3.2", "--omega", 0.01, 6, 0, "--end", repr(float(factor * last)))
            assert run("spin", *words)[0] == expected

    @pytest.mark.parametrize("until", ["nan", "inf", "1e999", "0", "soon"])
    def test_what_is_no_time(self, until: str) -> None:
        code, _, err = run("spin", "--moments", "1 3 3.2", "--omega", 0.01, 6, 0, "--end", until)
        assert code == 2
        assert err.startswith("polhode: --end: ")
