"""The moving page of motions that nobody draws: it draws them, or says why not and what to do."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from browser import Browser, needs_browser
from moving_pictures import TOLD
from page_data import data
from polhode import RigidBody, animation, euler_angles, loads, solids
from polhode.animation import animate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
OMEGA = (0.3, 0.2, 1.1)
SPIN = (1.0, 0.2, 1.1)
CONE = solids.cone(radius=0.03, height=0.06, mass=0.1).translated((0.0, 0.0, 0.015))
DOWN, UPSIDE_DOWN = (0.0, 0.0, -9.81), euler_angles.to_quaternion((0.0, np.pi, 0.0))
TEN = np.linspace(0.0, 5.0, 100)
UNEVEN = np.concatenate([[0.0], np.geomspace(1e-12, 5.0, 60)])
WHEEL = loads.wheel((1, 0, 0), 0.1, 3.0)

EVERYWHERE = """(() => {
  const found = [], slider = document.getElementById("slider"), speed = document.getElementById("speed");
  const views = [...document.querySelectorAll("#tabs button:not([hidden])")];
  for (const t of [0, 0.31, 0.77, 1]) {
    slider.value = t; slider.dispatchEvent(new Event("input"));
    for (const view of views) {
      view.click();
      for (const one of Object.values(polhode.views)) for (const { at, name } of one.written ?? []) {
        if (!at.every(Number.isFinite)) found.push(["place of", name, at]);
      }
    }
    const { q, omega, momentum } = polhode.stateAt(polhode.now);
    if (![...q, ...omega, ...momentum].every(Number.isFinite)) found.push(["state", t]);
  }
  for (const one of speed.options) {
    speed.value = one.value; speed.dispatchEvent(new Event("change")); polhode.draw();
  }
  if (/NaN|Infinity|undefined/.test(document.body.textContent.replace(/<script.*/s, ""))) {
    for (const id of ["readouts", "clock", "speed", "sliders"]) {
      const text = document.getElementById(id).textContent;
      if (/NaN|Infinity|undefined/.test(text)) found.push([id, text]);
    }
  }
  return found;
})()"""


def run(
    t: Any, omega: Any = SPIN, body: RigidBody = BODY, load: loads.Load | None = None, **options: Any
) -> Callable[[], Any]:
    return lambda: body.simulate(t, omega, load=load, **options)


def top(omega: Any, attitude: Any = None, gravity: Any = DOWN) -> Callable[[], Any]:
    return lambda: CONE.heavy_top(omega, attitude, gravity).at(np.linspace(0.0, 2.0, 50))


def of(*moments: float, mass: float = 1.0) -> RigidBody:
    return RigidBody.from_principal(mass, moments)


DRAWN: dict[str, Callable[[], Any]] = {
    "one state": run([0.0]),
    "one state of a load": run([0.0], load=loads.damping(np.eye(3)) + WHEEL),
    "two states": run([0.0, 1.0]),
    "two states of a load": run([0.0, 0.1], load=loads.damping(np.eye(3)) + WHEEL),
    "a picosecond": run(np.linspace(0.0, 1e-12, 50), np.multiply(OMEGA, 1e12)),
    "a picosecond of a load": run(
        np.linspace(0.0, 1e-12, 50),
        np.multiply(OMEGA, 1e12),
        load=loads.constant_torque((1e20, 0, 0)) + WHEEL,
    ),
    "a picosecond at rest": run(np.linspace(0.0, 1e-12, 50)),
    "1e12 s": run(np.linspace(0.0, 1e12, 50), np.multiply(OMEGA, 1e-12)),
    "from 1e12 s on": run(np.linspace(1e12, 1e12 + 10.0, 50)),
    "rest": run(TEN, (0, 0, 0)),
    "rest under a load": run(TEN, (0, 0, 0), load=WHEEL),
    "1e-47 kg": run(TEN, body=of(1.0, 2.0, 2.5, mass=1e-47)),
    "a molecule": run(
        np.linspace(0.0, 1e-11, 200), np.multiply(OMEGA, 1e12), of(1e-47, 2e-47, 2.5e-47, mass=1e-26)
    ),
    "large": run(TEN, body=of(1e49, 2e49, 2.5e49, mass=1e-40)),
    "small": run(TEN, body=of(1e-50, 2e-50, 2.5e-50, mass=1e40)),
    "slow": run(np.array([0.0, 1e44]), np.multiply(OMEGA, 1e-44)),
    "fast": run(np.linspace(0.0, 1e-44, 9), np.multiply(OMEGA, 1e44), load=loads.rotor((0, 0, 1e-44))),
    "a rod": run(TEN, (0.0, 0.2, 1.1), of(0.0, 2.0, 2.0)),
    "a rod under a load": run(TEN, (0.0, 0.2, 1.1), of(0.0, 2.0, 2.0), loads.uniform_gravity(DOWN)),
    "a sphere": run(TEN, body=solids.sphere(1.0, mass=1.0)),
    "two equal moments": run(TEN, body=of(1.0, 1.0, 1.5)),
    "nearly equal moments": run(TEN, body=of(1.0, 1.0 + 1e-15, 1.0 + 3e-15)),
    "a plate": run(TEN, body=of(1.0, 2.0, 3.0)),
    "a top upside down": top((0.0, 0.0, 100.0), UPSIDE_DOWN),
    "a sleeping top": top((0.0, 0.0, 100.0)),
    "a top that stands": top((0.0, 0.0, 0.0)),
    "a pendulum": top((3.0, 0.0, 0.0), UPSIDE_DOWN),
    "gravity to the side": top((0.0, 0.0, 100.0), gravity=(9.81, 0.0, 0.0)),
    "a body about a corner": run(
        np.linspace(0.0, 2.0, 300),
        (1, 0, 0),
        solids.box((3, 2, 1), mass=1.0).translated((1, 2, 3)),
        loads.uniform_gravity(DOWN),
        about="origin",
    ),
    "backward": run(-TEN),
    "backward to zero": run(TEN - 5.0, load=WHEEL),
    "uneven": run(UNEVEN),
    "many states": run(np.linspace(0.0, 5.0, 50_000), load=WHEEL),
}


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("extremes")) as one:
        one.screen(900, 640)
        yield one


def seen(browser: Browser, page: Path) -> float:
    """Which part of the left view has colour."""
    browser.open(page, "#t=0&view=space")
    assert browser.run(EVERYWHERE) == []
    return float((np.ptp(browser.picture()[60:440, 20:430], axis=-1) > 25).mean())


@needs_browser
@pytest.mark.parametrize("name", DRAWN)
def test_it_is_drawn(browser: Browser, tmp_path: Path, name: str) -> None:
    """A body is seen, all numbers are numbers, and no script fails."""
    assert seen(browser, DRAWN[name]().animate(tmp_path / "a.html")) > (0.01 if "rod" in name else 0.02)


@needs_browser
def test_motions_in_closed_form(browser: Browser, tmp_path: Path) -> None:
    quick = polhode.wheel(axis=(1, 0, 0), inertia=1e-30, rate=1e20, mode="held")
    many = [polhode.wheel(axis=(k, 3, k - 4), inertia=1e-3, rate=9.0 * k, mode="held") for k in range(10)]
    for gyrostat, end in (
        (BODY.gyrostat(wheels=[quick]), -3.0),
        (BODY.gyrostat(wheels=many), 3.0),
        (BODY.gyrostat((0, 0, 1e30)), 1e-29),
    ):
        motion = gyrostat.free_motion((0.0, 1.0, 0.0))
        assert seen(browser, animate(motion, tmp_path / "a.html", end=end)) > 0.05
    assert seen(browser, animate(BODY.free_motion((0, 0, 0)), tmp_path / "a.html", end=3.0)) > 0.05
    with pytest.warns(UserWarning, match=r"shown is the beginning, to \S+ of 1e\+12 s"):
        page = animate(BODY.free_motion(OMEGA), tmp_path / "a.html", end=1e12)
    assert seen(browser, page) > 0.05


@needs_browser
def test_a_mesh_of_1e5_triangles(browser: Browser, tmp_path: Path) -> None:
    n = 224
    polar, around = np.linspace(0.0, np.pi, n), np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    circle = np.stack([np.cos(around), np.sin(around), np.zeros(n)], axis=-1)
    vertices = np.sin(polar)[:, None, None] * circle + np.cos(polar)[:, None, None] * np.array(
        [0.0, 0.0, 1.0]
    )
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(n - 1), np.arange(n), indexing="ij"))
    a, b, c, d = i * n + j, i * n + (j + 1) % n, (i + 1) * n + j, (i + 1) * n + (j + 1) % n
    faces = np.concatenate([np.stack([a, c, d], axis=1), np.stack([a, d, b], axis=1)])
    assert len(faces) > 99_000
    with pytest.warns(
        UserWarning, match=r"of 99904 triangles 1\d{4} are drawn, .* less than 0.0\d+ of its size"
    ):
        page = run(TEN)().animate(tmp_path / "a.html", shape=(vertices.reshape(-1, 3), faces))
    radii = np.linalg.norm(data(page)["vertices"], axis=-1)
    assert 0.97 < radii.min() < radii.max() < 1.0 + 1e-6
    assert seen(browser, page) > 0.1


@needs_browser
def test_words_of_times_and_speeds(browser: Browser, tmp_path: Path) -> None:
    """To a thousandth of the length; real time where it is near, and what no eye follows is named so."""
    clock, speeds = (
        "document.getElementById('clock').textContent",
        "document.getElementById('speed').textContent",
    )
    for name, words in (
        ("a picosecond", "t = 0.500e-12 s"),
        ("1e12 s", "t = 0.500e12 s"),
        ("from 1e12 s on", "t = 1000000000005.00 s"),
        ("backward", "t = -2.500 s"),
    ):
        motion = DRAWN[name]()
        browser.open(motion.animate(tmp_path / "a.html"), f"#t={float(motion.t[0] + motion.t[-1]) / 2!r}")
        assert browser.run(clock) == words
        assert ("real time" in browser.run(speeds).replace("× real time", "")) == (name[0] in "fb")
    browser.open(DRAWN["a sleeping top"]().animate(tmp_path / "a.html"))
    assert "real time, too fast to follow" in browser.run(speeds)
    browser.open(DRAWN["two equal moments"]().animate(tmp_path / "a.html"))
    assert "next flip" not in browser.run(TOLD)  # there is no intermediate axis


@needs_browser
@pytest.mark.parametrize("gap", [0.5e-12, 2e-12])
@pytest.mark.parametrize("low", [True, False], ids=["prolate", "oblate"])
def test_moments_that_differ_by_rounding_have_no_intermediate_axis(
    browser: Browser, tmp_path: Path, low: bool, gap: float
) -> None:
    """On both sides of 1e-12 of the largest: neither a next flip nor a separatrix is told of."""
    moments = (1.0, 2.0 - 2.0 * gap, 2.0) if low else (1.5, 1.5 + 2.0 * gap, 2.0)
    motion = of(*moments).free_motion((0.3, 1.0, 0.2)).at([0.0, 5.0])
    browser.open(motion.animate(tmp_path / "near.html"), "#t=1")
    caption = browser.run("document.getElementById('second-caption').textContent")
    are_three = gap > 1e-12
    assert ("next flip" in browser.run(TOLD)) is are_three
    assert ("separatrix" in caption) is are_three


@pytest.mark.parametrize(
    ("motion", "shape", "told"),
    [
        (
            run(TEN, body=of(1e300, 2e300, 2.5e300)),
            None,
            "moments of inertia: .* another unit of mass and length",
        ),
        (
            run(TEN, body=of(1e-51, 1e-51, 0.9e-51)),
            None,
            "moments of inertia: .* another unit of mass and length",
        ),
        (run([0.0, 1e-52], (1e51, 0, 0)), None, "angular velocity: .* another unit of time"),
        (
            run(TEN),
            (np.zeros((0, 3)), np.zeros((0, 3), int)),
            "shape: 0 triangles, none with an area; leave it",
        ),
        (run(TEN), (np.zeros((3, 3)), [[0, 1, 2]]), "shape: 1 triangles, none with an area; leave it out"),
        (run(TEN), (1e51 * np.eye(3), [[0, 1, 2]]), "shape: .* another unit of length"),
        (run(TEN, np.ones((2, 3))), None, r"motion of one body, got a stack of shape \(2,\); .* bodies\[0\]"),
        (lambda: BODY.free_motion(OMEGA).at([]), None, r"needs a series of times.* ask for times"),
        (run([0.0, 1.0, 5.0], load=WHEEL), None, "turn backward; ask for .* times or more, evenly spaced"),
    ],
)
def test_it_is_refused(motion: Callable[[], Any], shape: Any, told: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=told):
        motion().animate(tmp_path / "a.html", shape=shape)


def test_states_that_are_not_numbers(tmp_path: Path) -> None:
    motion = run(TEN)()
    motion.omega[40:] = np.nan
    with pytest.raises(ValueError, match=rf"from t = {TEN[40]:.6g} s on .* simulate to an earlier time"):
        motion.animate(tmp_path / "a.html")
    with pytest.raises(ValueError, match=r"got a stack of shape \(2,\); .* bodies\[0\].free_motion"):
        animation.animate(BODY.free_motion(np.ones((2, 3))), tmp_path / "a.html", end=1.0)


def test_notes(tmp_path: Path) -> None:
    corners = np.eye(3) + np.array([1e3, 0.0, 0.0])
    with pytest.warns(UserWarning, match="shape: drawn as a dot, for it is 1e.03 times its own size away"):
        run(TEN)().animate(tmp_path / "a.html", shape=(corners, [[0, 1, 2]]))
    run(TEN)().animate(tmp_path / "a.html", shape=(corners - np.array([950.0, 0.0, 0.0]), [[0, 1, 2]]))
    uneven = np.concatenate([[0.0], np.geomspace(1e-3, 5.0, 60)])
    with pytest.warns(UserWarning, match=r"ask for \d+ times or more, evenly spaced"):
        run(uneven, load=WHEEL)().animate(tmp_path / "a.html")
    with pytest.warns(UserWarning, match="give frames="):
        run(TEN, load=WHEEL)().animate(tmp_path / "a.html", frames=10)
