"""What a moving picture shows is what happens: turns from frame to frame, chords of paths, its seconds."""

from __future__ import annotations

import re
import warnings
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pytest
from command_line import run
from moving_pictures import BRICK, CONE, angles, check_chords, check_frames, top
from oracles.bodies import matrix
from page_data import data
from polhode import RigidBody, euler_angles, loads
from polhode.draw.sampling import COARSE, TURN, axis_times, fastest, follow, motion_times

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray
    from polhode import FreeMotion, HeavyTop

    Floats = NDArray[np.float64]

PULL = loads.constant_torque((0.0, 0.0, 0.1))


def random_bodies(rng: np.random.Generator, count: int) -> list[FreeMotion]:
    """Bodies of every shape, thin and symmetric ones too, some near the separatrix, some steady."""
    found = []
    for number in range(count):
        second = rng.uniform(0.0, 1.0, 3) ** 3
        if number % 5 == 0:
            second[1] = second[0]
        if number % 7 == 0:
            second[2] = 0.0
        moments = np.sort(second.sum() - second)
        omega = rng.normal(size=3)
        if number % 3 == 0:
            omega = np.array([1e-9, 1.0, 1e-9 * (number % 2)])
        if number % 11 == 0:
            omega = np.array([0.0, 0.0, 1.0])
        body = RigidBody.from_principal(1.0, moments, matrix(np.array([0.5, -0.5, 0.1, 0.7]) / 1.0))
        found.append(body.free_motion(body.principal.axes @ (omega * 10.0 ** rng.uniform(-3.0, 3.0))))
    return found


class TestTimes:
    """`polhode.draw.sampling`: one place that chooses times, for pages, films, windows and pictures."""

    def test_free_bodies_of_every_shape(self, rng: np.random.Generator) -> None:
        for motion in random_bodies(rng, 66):
            rate = fastest(motion)
            end = rng.uniform(0.1, 300.0) / rate * rng.choice([-1.0, 1.0])
            span = motion_times(motion, np.array([0.0, end]))
            assert span.is_whole
            assert (span.t[0], span.t[-1]) == (0.0, end)
            check_frames(motion, span.t, rate)

    def test_tops(self) -> None:
        for motion in (top(260.0), top(30.0), top(0.0, 2.0), top(60.0, 0.02, 0.3), top(5.0, 3.0, 2.0)):
            rate = fastest(motion)
            dense = np.linalg.norm(motion.at(np.linspace(0.0, 5.0, 20_001)).omega, axis=-1).max()
            assert 0.999 * dense <= rate
            if np.isfinite(motion.nutation_period) and motion.nutation_period < 5.0:
                assert rate <= 1.001 * dense
            span = motion_times(motion, np.array([0.0, 1.0]))
            assert span.is_whole
            check_frames(motion, span.t, rate)
            path = axis_times(motion, np.array([0.0, 1.0])).t
            check_chords(partial(axis, motion), path)

    def test_all_given_times_are_kept(self, rng: np.random.Generator) -> None:
        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        for sign in (1.0, -1.0):
            given = sign * np.cumsum(rng.uniform(0.0, 3.0, 30))
            chosen = motion_times(motion, given)
            assert chosen.is_whole
            assert np.isin(given, chosen.t).all()
            assert (sign * np.diff(chosen.t) > 0.0).all()

    @pytest.mark.parametrize("end", [0.0, 5e-324, 1e-300, -1e-300])
    def test_spans_of_nearly_nothing(self, end: float) -> None:
        chosen = motion_times(BRICK.free_motion((0.01, 6.0, 0.0)), np.array([0.0, end]))
        assert chosen.t.tolist() == [0.0, end]

    @pytest.mark.parametrize("end", [1e6, -1e6, 1e18, 1e300])
    def test_more_than_can_be_shown(self, end: float) -> None:
        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        chosen = motion_times(motion, np.array([0.0, end]), most=500)
        assert not chosen.is_whole
        assert len(chosen.t) == 500
        check_frames(motion, chosen.t, fastest(motion))

    def test_a_body_at_rest(self) -> None:
        assert motion_times(BRICK.free_motion((0.0, 0.0, 0.0)), np.array([0.0, 1e9])).t.tolist() == [0.0, 1e9]

    def test_a_curve_with_a_corner_ends(self) -> None:
        """Between neighbouring floats there is nothing more to ask."""
        chosen = follow(
            lambda t: np.sign(t - 0.3)[:, np.newaxis, np.newaxis] * np.ones(3), np.array([0.0, 1.0]), step=0.1
        )
        assert len(chosen.t) < 150
        assert np.diff(chosen.t).min() < 1e-15


def check_page(motion: FreeMotion | HeavyTop, t: Floats) -> None:
    """Between the frames of a page it interpolates: 40 degrees, 2 %."""
    check_frames(motion, t, fastest(motion), turn=2.0 * TURN, chord=0.02)


def axis(motion: HeavyTop, t: Floats) -> Floats:
    return motion.at(t).point("center_of_mass") / np.linalg.norm(CONE.center_of_mass)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """200 s at one turn a second, from the command: 300 frames of it would turn backward."""
    path = tmp_path_factory.mktemp("page") / "racket.html"
    words = ("--moments", "1 3 3.2", "--omega", 0.01, 6, 0, "--end", 200, "--save", path)
    code, out, err = run("spin", *words)
    assert (code, err) == (0, "")
    assert "beginning" not in out
    return path


class TestPages:
    def test_it_follows_a_long_run(self, page: Path) -> None:
        shown = data(page)
        t = np.array(shown["t"])
        assert (t[0], t[-1]) == (0.0, 200.0)
        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        check_page(motion, t)
        exact = motion.at(t)
        np.testing.assert_allclose(shown["quaternion"], exact.quaternion, atol=1e-6)
        # At thirty pictures a second no picture turns the body by more than 20 degrees.
        pictures = motion.at(np.arange(0.0, 200.0, 200.0 / shown["duration"] / 30.0))
        assert angles(pictures.quaternion).max() <= TURN * (1.0 + 1e-9)
        assert shown["duration"] == 200.0  # real time

    def test_backward_in_time(self, tmp_path: Path) -> None:
        words = ("--moments", "1 3 3.2", "--omega", 0.01, 6, 0, "--end", " -30")
        code, _, err = run("spin", *words, "--save", tmp_path / "back.html")
        assert (code, err) == (0, "")
        t = np.array(data(tmp_path / "back.html")["t"])
        assert (t[0], t[-1]) == (0.0, -30.0)
        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        check_page(motion, t)

    def test_a_top(self, tmp_path: Path) -> None:
        words = (
            "--moments",
            "2 2 1",
            "--mass",
            1,
            "--center-of-mass",
            "0 0 1",
            "--gravity",
            9.81,
            "--omega",
            0,
            0,
            40,
        )
        code, _, err = run(
            "spin", *words, "--attitude", "0 30 0 deg", "--end", 10, "--save", tmp_path / "top.html"
        )
        assert (code, err) == (0, "")
        shown = data(tmp_path / "top.html")
        body = RigidBody.from_principal(1.0, (2.0, 2.0, 1.0), center_of_mass=(0.0, 0.0, 1.0))
        attitude = euler_angles.to_quaternion((0.0, np.pi / 6, 0.0))
        motion = body.heavy_top((0.0, 0.0, 40.0), attitude, (0.0, 0.0, -9.81))
        check_page(motion, shown["t"])
        # With its pivot, and what its axis draws.
        assert shown["top"]["path"] == str(motion.mode)
        assert shown["top"]["limits"] == pytest.approx(list(motion.nutation_limits))
        assert shown["top"]["down"] == [0.0, 0.0, -1.0]

    def test_frames_beyond_the_most_are_told(self, tmp_path: Path) -> None:
        words = ("spin", "--moments", "1 3 3.2", "--omega", 0.01, 6, 0, "--end", 1e6)
        saves = [word for name in ("a.html", "a.png") for word in ("--save", tmp_path / name)]
        code, out, err = run(*words, *saves)
        assert (code, err) == (0, "")
        told = re.search(r"note: a.html: shown is the beginning, to (\S+) of 1e\+06 s: (\d+) frames", out)
        assert told
        shown = data(tmp_path / "a.html")
        assert len(shown["t"]) == int(told[2]) == 3600
        assert shown["t"][-1] == pytest.approx(float(told[1]), rel=1e-5)
        assert "note: a.png: shown is the beginning, to" in out
        with pytest.warns(UserWarning, match=r"shown is the beginning, to \S+ of 1e\+06 s"):
            BRICK.free_motion((0.01, 6.0, 0.0)).at([0.0, 1e6]).animate(tmp_path / "b.html")


class TestTrajectories:
    """Where nothing acts on the body its own samples need not be enough; else they have to be."""

    def test_two_samples_of_a_free_body(self, tmp_path: Path) -> None:
        motion = BRICK.free_motion((0.01, 6.0, 0.0))
        shown = data(motion.at([1.0, 21.0]).animate(tmp_path / "page.html"))
        t = np.array(shown["t"])
        assert (t[0], t[-1]) == (1.0, 21.0)
        check_page(motion, t)
        np.testing.assert_allclose(shown["quaternion"], motion.at(t).quaternion, atol=1e-6)

    @pytest.mark.parametrize("suffix", [".html", ".gif"])
    def test_too_few_samples_under_a_load_are_refused(self, suffix: str, tmp_path: Path) -> None:
        few = BRICK.simulate(np.linspace(0.0, 40.0, 51), (0.01, 6.0, 0.0), load=PULL)
        message = (
            r"from one frame to the next, at t = \S+ s, the body turns by up to \S+ deg, past the half turn"
        )
        with pytest.raises(ValueError, match=message + r".*ask for (\d+) times or more") as caught:
            few.animate(tmp_path / f"a{suffix}")
        assert not (tmp_path / f"a{suffix}").exists()
        needed = int(str(caught.value).split("ask for ")[1].split()[0])
        enough = BRICK.simulate(np.linspace(0.0, 40.0, needed), (0.01, 6.0, 0.0), load=PULL)
        enough.animate(tmp_path / "enough.html")
        coarse = BRICK.simulate(np.linspace(0.0, 40.0, needed // 2), (0.01, 6.0, 0.0), load=PULL)
        with pytest.warns(
            UserWarning, match=r"turns by up to \S+ deg, more than the 30 .* ask for \d+ times"
        ):
            coarse.animate(tmp_path / "coarse.html")

    @pytest.mark.parametrize(("factor", "outcome"), [(0.99, "shown"), (1.01, "warned")])
    def test_both_sides_of_the_limit(self, factor: float, outcome: str, tmp_path: Path) -> None:
        even = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
        many = even.simulate(np.arange(20) * COARSE * factor, (0.0, 0.0, 1.0), load=PULL * 1e-9)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            many.animate(tmp_path / "a.html")
        assert [str(one.message)[:8] for one in told] == ([] if outcome == "shown" else ["animate:"])

    @pytest.mark.parametrize(("factor", "outcome"), [(0.99, "warned"), (1.01, "refused")])
    def test_both_sides_of_half_a_turn(self, factor: float, outcome: str, tmp_path: Path) -> None:
        even = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
        many = even.simulate(np.arange(20) * np.pi * factor, (0.0, 0.0, 1.0), load=PULL * 1e-9)
        if outcome == "refused":
            with pytest.raises(ValueError, match="past the half turn"):
                many.animate(tmp_path / "a.html")
        else:
            with pytest.warns(UserWarning, match="more than the 30"):
                many.animate(tmp_path / "a.html")

    def test_frames_that_are_asked_for(self, tmp_path: Path) -> None:
        motion = BRICK.free_motion((0.01, 6.0, 0.0)).at(np.linspace(0.0, 10.0, 1001))
        with pytest.raises(ValueError, match=r"past the half turn.*give frames=(\d+) or more") as caught:
            motion.animate(tmp_path / "a.html", frames=20)
        needed = int(str(caught.value).split("frames=")[1].split()[0])
        assert len(data(motion.animate(tmp_path / "a.html", frames=needed))["t"]) == needed

    def test_seconds_that_are_asked_for(self, tmp_path: Path) -> None:
        motion = BRICK.free_motion((0.01, 6.0, 0.0)).at(np.linspace(0.0, 200.0, 20_001))
        with pytest.raises(ValueError, match=r"duration: .*past the half turn.*duration=(\d+)") as caught:
            motion.animate(tmp_path / "a.html", duration=5.0)
        needed = float(str(caught.value).split("duration=")[1].split()[0])
        assert data(motion.animate(tmp_path / "a.html", duration=needed))["duration"] == needed
        with pytest.warns(UserWarning, match="duration: .*more than the 30"):
            motion.animate(tmp_path / "a.html", duration=needed / 2)

    def test_no_times(self, tmp_path: Path) -> None:
        with pytest.raises(ValueError, match="animate: needs a series of times"):
            BRICK.free_motion((0.0, 0.0, 1.0)).at([]).animate(tmp_path / "a.html")
        one = BRICK.free_motion((0.0, 0.0, 1.0)).at([2.0]).animate(tmp_path / "one.html")
        assert data(one)["t"].tolist() == [2.0]
