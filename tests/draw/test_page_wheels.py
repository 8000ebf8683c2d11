"""Wheels that turn in the moving page and in films, by the angle that they turn relative to the body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from browser import Browser, needs_browser
from page_data import data
from PIL import Image
from polhode import RigidBody, Trajectory, loads
from polhode.animation import animate
from polhode.draw.sampling import TURN
from polhode.draw.scene import Scene
from polhode.draw.wheels import slowdown

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray
    from polhode.draw.wheels import Disc

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
OMEGA = (0.3, 0.2, 1.1)
DISC, MARK = (0xF6, 0xEA, 0xD2), (0x7A, 0x4A, 0x00)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("wheels")) as one:
        one.screen(1200, 820)
        yield one


def scene(motion: Any, end: float | None = None, frames: int | None = None) -> Scene:
    options: dict[str, Any] = {
        "duration": None,
        "shape": None,
        "title": "",
        "time_unit": "s",
        "is_page": True,
    }
    if end is None:
        return Scene.of(motion, frames=frames, **options)
    return Scene.of_motion(motion, end, **options)


def angle(disc: Disc) -> NDArray[np.float64]:
    assert disc.angle is not None
    return disc.angle


def speed(disc: Disc) -> NDArray[np.float64]:
    assert disc.rate is not None
    return disc.rate


def spin_up(rate: float = 3.0, samples: int = 201) -> Trajectory:
    """About one axis a motor's torque on the wheel turns the body the other way, both evenly faster."""
    motor = loads.wheel((0, 0, 2), 0.05, rate, torque=0.2, name="roll_wheel")
    return BODY.simulate(np.linspace(0.0, 10.0, samples), (0.0, 0.0, 0.4), load=motor)


def turned(t: Any, rate: float = 3.0) -> Any:
    return rate * t + 0.5 * 0.2 * (1.0 / 0.05 + 1.0 / 2.45) * t**2


class TestAngles:
    def test_of_a_motor_with_a_constant_torque(self) -> None:
        (disc,) = scene(spin_up()).discs
        t = np.linspace(0.0, 10.0, 201)
        assert (disc.name, disc.axis.tolist()) == ("roll wheel", [0.0, 0.0, 1.0])
        np.testing.assert_allclose(angle(disc), turned(t), rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(speed(disc), 3.0 + 0.2 * (20.0 + 1.0 / 2.45) * t, rtol=1e-9)

    @pytest.mark.parametrize("t", [[0.0, 0.1, 0.5, 0.6, 2.0], [0.0, -0.3, -0.5, -2.0], [0.0, 1.5], [1.0]])
    def test_at_uneven_falling_and_few_times(self, t: list[float]) -> None:
        motor = loads.wheel((0, 0, 2), 0.05, 3.0, torque=0.2)
        run = BODY.simulate(t, (0.0, 0.0, 0.4), load=motor)
        (disc,) = scene(run).discs
        np.testing.assert_allclose(angle(disc), turned(np.array(t) - t[0]), rtol=1e-9, atol=1e-9)

    def test_free_wheels_of_a_gyrostat_are_those_of_the_integrated_one(self) -> None:
        """The closed form against a run whose state is the wheel's momentum."""
        axis = np.array([0.0, 0.6, 0.8])
        free = polhode.wheel(axis=axis, inertia=0.3, rate=3.0)
        held = polhode.wheel(axis=(2, 0, 0), inertia=0.01, rate=-7.0, mode="held")
        exact = scene(BODY.gyrostat(wheels=[free, held]).free_motion(OMEGA), 12.0)
        carried = loads.wheel(axis, 0.3, 3.0) + loads.wheel((2, 0, 0), 0.01, speed=-7.0)
        run = scene(BODY.simulate(np.linspace(0.0, 12.0, 4001), OMEGA, load=carried, rtol=1e-12))
        for one, other in zip(exact.discs, run.discs, strict=True):
            found = np.interp(exact.t, run.t, angle(other))
            np.testing.assert_allclose(angle(one), found, atol=1e-5)
        assert [disc.name for disc in exact.discs] == ["wheel 1", "wheel 2"]
        np.testing.assert_allclose(angle(exact.discs[1]), -7.0 * exact.t, rtol=1e-15)

    def test_no_angle_without_a_speed(self) -> None:
        """Of a rotor the momentum alone is known."""
        gyrostat = BODY.gyrostat((0.0, 0.2, 0.0))
        known = scene(BODY.simulate([0.0, 0.1], OMEGA, load=2.0 * loads.rotor((0, 0, 3))))
        states = scene(gyrostat.free_motion(OMEGA).at([0.0, 1.0]))
        for shown in (known, states, scene(gyrostat.free_motion(OMEGA), 1.0)):
            (disc,) = shown.discs
            assert (disc.angle, disc.rate) == (None, None)
        assert known.discs[0].axis.tolist() == [0.0, 0.0, 1.0]
        massless = polhode.wheel(axis=(0, 1, 0), inertia=0.0, momentum=-2.0)
        (disc,) = scene(BODY.gyrostat(wheels=[massless]).free_motion(OMEGA), 1.0).discs
        assert (disc.axis.tolist(), disc.rate) == ([0.0, -1.0, 0.0], None)

    def test_states_of_a_gyrostat_turn_its_wheels(self) -> None:
        """As its motion does, from the first of their times on."""
        free = polhode.wheel(axis=(0, 1, 1), inertia=0.1, rate=40.0)
        held = polhode.wheel(axis=(0, 0, 1), inertia=0.1, rate=-7.0, mode="held")
        motion = BODY.gyrostat(wheels=[free, held]).free_motion(OMEGA)
        t = np.linspace(0.0, 3.0, 31)
        whole, part = scene(motion.at(t), frames=31), scene(motion.at(t[10:]), frames=21)
        for one, later in zip(whole.discs, part.discs, strict=True):
            assert one.name == later.name
            np.testing.assert_allclose(speed(later), speed(one)[10:], rtol=1e-12)
            np.testing.assert_allclose(angle(later), angle(one)[10:] - angle(one)[10], atol=1e-11)

    def test_parts_of_a_sum_and_of_a_stack(self) -> None:
        stack = (
            loads.wheel((0, 1, 0), [0.1, 0.2], 4.0)
            + loads.slug(0.1, 0.1)
            + loads.wheel((1, 0, 0), 0.1, [5.0, 6.0])
        )
        shown = scene(BODY.simulate(np.linspace(0.0, 1.0, 11), (0, 0, 0), load=stack[1]))
        assert [disc.name for disc in shown.discs] == ["wheel", "wheel 2"]
        for disc, rate in zip(shown.discs, (4.0, 6.0), strict=True):
            np.testing.assert_allclose(speed(disc), rate, rtol=1e-12)
        address = loads.torque_callback(lambda _t, _omega, _quaternion: (0.0, 0.0, 0.0))
        shown = scene(BODY.simulate(np.linspace(0.0, 1.0, 11), (0, 0, 0), load=stack[0] + address))
        assert len(shown.discs) == 2
        assert scene(BODY.simulate([0.0, 0.1], OMEGA, load=loads.slug(0.1, 0.1))).discs == ()


def test_discs_stand_outside_of_the_body_and_apart() -> None:
    axes = [(1, 0, 0), (1, 0, 0), (0, -1, 0), (1, 1, 1)]
    wheels = [polhode.wheel(axis=axis, inertia=0.01, rate=1.0, mode="held") for axis in axes]
    moved = BODY.translated((3.0, 2.0, 1.0))
    for body in (BODY, moved):
        shown = scene(body.gyrostat(wheels=wheels).free_motion(OMEGA), 1.0)
        for disc in shown.discs:
            beyond = (shown.shape.vertices - disc.middle) @ disc.axis
            assert (beyond < -disc.half).all()
        first, second = (disc.middle[0] for disc in shown.discs[:2])
        assert second - first > 2.0 * shown.discs[0].half


class TestSlowMotion:
    def test_both_sides_of_what_an_eye_follows(self) -> None:
        assert slowdown(0.0) == slowdown(TURN) == 1.0
        assert slowdown(1.001 * TURN) == slowdown(2.0 * TURN) == 2.0
        assert slowdown(2.001 * TURN) == slowdown(5.0 * TURN) == 5.0
        assert slowdown(np.pi) == 10.0
        for turn in np.geomspace(1e-3, 1e9, 301):
            factor = slowdown(float(turn))
            assert turn / factor <= TURN * (1.0 + 1e-6)
            assert factor == 1.0 or turn / factor > TURN / 2.6  # no slower than needed

    def test_a_film_names_it(self, tmp_path: Path) -> None:
        (disc,) = scene(spin_up()).discs
        assert disc.factor(0.05) == slowdown(float(np.max(speed(disc))) * 0.05) == 10.0
        assert disc.words(0, disc.factor(0.05), "s") == "roll wheel: 3 rad/s, drawn 10× slower"
        assert disc.words(0, disc.factor(0.0005), "s") == "roll wheel: 3 rad/s"
        pytest.importorskip("matplotlib")
        film = spin_up(samples=21).animate(tmp_path / "a.gif", labels=False)
        with Image.open(film) as frames:
            pixels = np.asarray(frames.convert("RGB")).reshape(-1, 3).astype(int)
        for color in (DISC, MARK):
            assert (np.abs(pixels - color).max(axis=1) < 16).sum() > 40


@needs_browser
class TestInABrowser:
    def test_it_turns_by_the_integral_of_its_speed(
        self, browser: Browser, tmp_path: Path, rng: np.random.Generator
    ) -> None:
        """Between the frames too, and at frames that are few."""
        t = np.sort(rng.uniform(0.0, 10.0, 200))
        found = "polhode.motion.wheels[0].at({}).{}"
        for samples, off in ((201, 1e-5), (26, 1e-4)):
            browser.open(spin_up(samples=samples).animate(tmp_path / "a.html"), "#t=0")
            angles = browser.run(f"{t.tolist()}.map((t) => {found.format('t', 'angle')})")
            np.testing.assert_allclose(angles, turned(t), atol=off)
        held = polhode.wheel(axis=(0, 1, 0), inertia=0.1, rate=-314.0, mode="held")
        motion = BODY.gyrostat(wheels=[held]).free_motion(OMEGA)
        browser.open(animate(motion, tmp_path / "b.html", end=10.0), "#t=0")
        angles = browser.run(f"{t.tolist()}.map((t) => {found.format('t', 'angle')})")
        np.testing.assert_allclose(angles, -314.0 * t, rtol=1e-15)

    def test_its_mark_is_where_the_angle_says(self, browser: Browser, tmp_path: Path) -> None:
        """Counterclockwise about its axis: what is seen of a disc that faces the viewer."""
        toward = np.array([np.cos(0.35) * np.cos(0.9), np.cos(0.35) * np.sin(0.9), np.sin(0.35)])
        motor = loads.wheel(toward, 0.05, 1.0)
        run = BODY.simulate(np.linspace(0.0, 3.0, 31), (0.0, 0.0, 0.0), load=motor)
        page = run.animate(tmp_path / "a.html")
        browser.open(page, "#t=0")
        (wheel,) = data(page)["wheels"]
        left, top = browser.run(
            "(({left, top}) => [left, top])(document.getElementById('space').getBoundingClientRect())"
        )
        scale = browser.run("0.85 / polhode.motion.solid.reach")
        across, beside = (
            np.array(browser.run(f"polhode.motion.wheels[0].{name}")) for name in ("across", "beside")
        )
        np.testing.assert_allclose(np.cross(across, beside), toward, atol=1e-12)
        browser.run("document.getElementById('axes').click(); polhode.views.space.zoom = 4")
        for t in (0.0, 0.7, 1.9, 3.0):
            browser.run(f"polhode.show({t})")
            picture = browser.picture()
            for ahead, color in ((np.pi / 6, MARK), (np.pi / 2, DISC), (-np.pi / 6, DISC)):
                around = np.cos(t + ahead) * across + np.sin(t + ahead) * beside
                spot = scale * (np.array(wheel["middle"]) + 0.6 * wheel["radius"] * around)
                x, y = browser.run(f"polhode.views.space.place({spot.tolist()})")
                pixel = picture[round(top + y), round(left + x)]
                assert np.abs(pixel - color).max() < 24, (t, ahead, pixel)

    def test_slow_motion_is_that_of_the_films_and_is_told(self, browser: Browser, tmp_path: Path) -> None:
        browser.open(spin_up(314.0).animate(tmp_path / "a.html"), "#t=0")
        turns = np.geomspace(0.01, 1e6, 300)
        found = browser.run(f"{turns.tolist()}.map(polhode.slowed)")
        np.testing.assert_allclose(found, [slowdown(float(turn)) for turn in turns], rtol=1e-12)
        told = "[...document.querySelectorAll('#readouts div')].map((row) => row.textContent)"
        assert "roll wheel314.0 rad/s, drawn 50× slower" in browser.run(told)
        names = browser.run("polhode.views.space.written.map((one) => one.name)")
        assert "roll wheel, slowed 50×" in names
        assert "not to scale" in browser.run("document.getElementById('space-caption').textContent")
        choice = "const c = document.getElementById('speed')"
        browser.run(
            f"{{ {choice}; c.selectedIndex = 0; c.dispatchEvent(new Event('change')); polhode.draw(); }}"
        )
        assert "roll wheel314.0 rad/s, drawn 5× slower" in browser.run(told)

    def test_what_has_no_speed_says_so(self, browser: Browser, tmp_path: Path) -> None:
        run = BODY.simulate(np.linspace(0.0, 3.0, 31), OMEGA, load=loads.rotor((0, 0, 2)))
        browser.open(run.animate(tmp_path / "a.html"), "#t=1")
        told = "[...document.querySelectorAll('#readouts div')].map((row) => row.textContent)"
        assert "rotorspeed not known, its momentum alone" in browser.run(told)
