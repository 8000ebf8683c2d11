"""Every script in examples/ runs, draws its figure and prints what theory says; the gallery keeps it."""

from __future__ import annotations

import importlib
import re
import runpy
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from places import ROOT

pytest.importorskip("matplotlib")

EXAMPLES = ROOT / "examples"
PRINTED = {
    "apophis": [r"before: 0\.[67]\d to 1\.[34]\d", r"short-axis: 9\d % after"],
    "asteroid": [r"rotation 5\.4100 d, precession 7\.3500 d", r"relative change [0-9]e-1[5-7]|0e\+00"],
    "ball_on_turntable": [
        r"takes 10\.9956 s; .* off by \d\.\de-1\d",
        r"simulation differ by \de-1\d",
    ],  # 7π/Ω
    "chandler_wobble": [r"rigid Earth wobbles in 303\.6 days of 24 hours", r"A/\(C - A\) = 304\.5 turns"],
    "coin": [r"stably from 16\.51 rad/s on", r"circle of 35\.\d mm"],  # √(g/3a)
    "detumbling": [r"25\.1°/s at first, 0\.12\d°/s after"],  # twice the rate of the orbit: 720°/5851 s
    "dual_spin": [
        r"h = 0 N m s: off the axis by up to 17\d\.\d°",
        r"h = 1 N m s: off the axis by up to 2\.\d°",
    ],
    "edge_mill": [r"11688\.000 N, by hand 11688\.000 N"],
    "euler_disk": [
        r"circle of (\d+\.\d+) mm; a cos 20° is \1 mm",
        r"after 8 s at 0\.96°, by theory 1\.00°; flat by theory after 10\.29 s",
        r"kept to \de-1[23]",
    ],
    "flat_spin": [r"from L: 6\.9° to 8[89]\.\d°, \|L\| changed by \de-1\d"],
    "flip_time": [r"per factor e: 0\.18763\d s; theory 2/growth = 0\.187639 s"],
    "four_particles": [r"4 particles of 2 kg; tensors differ by (0e\+00|\de-1[5-7])"],
    "gravity_gradient": [r"theory: 4218\.4 s", r"from 2°: 42(19|20)\.\d s"],
    "gyroscope": [r"at 600 rad/s: 0\.837\d rad/s, m g l/\(I ω\) = 0\.8371 rad/s"],
    "planet_interior": [r"differs from the sum of two balls by at most (0e\+00|\de-1\d)"],
    "lagrange_top": [r"cusp: nutates between 30\.0000°"],
    "light_curve": [r"strongest period 3\.67 d; half of the precession, 3\.675 d"],
    # (5, 4.5, 3.5) k/(5 + k) with k = 1 - 5/(0.01134 * 16**3), the lead less the plastic in its place.
    "loaded_die": [r"one gram: centre of mass \[0\.757 0\.681 0\.53 \] mm, prolate top"],
    "molecule": [r"H2O: A 820\.71, B 437\.28, C 285\.28 GHz"],
    "parallel_axis": [r"0\.166667 kg m², by hand 0\.166667", r"at 0\.28[89] m; radius of gyration 0\.289 m"],
    "pointing_down": [r"yaw 0\.3: up to [4-9]° off", r"yaw 0\.9: up to 1[78]\d° off"],
    "polhodes": [r"brick: \[2\.5 5\.  6\.5\], kappa -0\.625"],
    "rattleback": [r"changes 1 times in 6 s", r"energy kept to \de-1[2-5]"],
    "sleeping_top": [r"0\.9 of it: up to 5\d\.\d°", r"1\.2 of it: up to 0\.\d°"],
    "slew": [r"turned by (-\d+\.\d+)°, by hand \1°"],
    "spacecraft": [r"empty: 497\.0 kg"],
    "symmetric_molecules": [r"ammonia: kappa \+1\.0000, oblate", r"water: kappa -0\.4\d+, asymmetric"],
    "t_handle": [r"a flip every 5\.1361 s"],
    "tennis_racket": [r"every 1\.737951 s", r"simulated: 1\.737951 s"],
    "thrown_book": [r"axis 1: .* stable", r"axis 2: .* flips", r"axis 3: .* stable"],
    "tippe_top": [
        r"from 14° to 16\d° in 5 s",
        r"40 rad/s: tumbles, at (\d+)°; least energy at \1°",
        r"120 rad/s: inverts, at 180°",
    ],
    "triangle_of_shapes": [r"sphere: 1\.000, 1\.000", r"disk: 0\.500, 0\.500", r"rod: 0\.000, 1\.000"],
    "uncertain_axes": [r"middle moment 1\.4: axes known to 1\.7\d°", r"moment 1\.15: axes known to 4\.\d\d°"],
    "uncertain_flip": [r"± 0\.3 rad/s: a flip every 0\.9\d s", r"± 0\.003 rad/s: .* every 1\.8\d s"],
    "wobbling_plate": [r"goes round 2\.00\d\d times while the plate turns once"],
}


@pytest.fixture
def gallery(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """What makes the gallery; what it keeps here, the next build of the site takes."""
    monkeypatch.syspath_prepend(ROOT / "docs" / "site")
    return importlib.import_module("gallery")


def test_every_script_has_its_row_and_stands_in_the_gallery() -> None:
    scripts = {path.stem for path in EXAMPLES.glob("*.py")}
    table = tomllib.loads((ROOT / "docs/gallery.toml").read_text("utf-8"))
    shown = [name for group in table["groups"].values() for name in group]
    assert scripts == set(PRINTED) == set(shown) == set(table["thumbnails"])
    assert len({words for _, words in table["thumbnails"].values()}) == len(shown)
    assert len(shown) == len(set(shown)) >= 24
    moving = [name for name in shown if "def animate(" in (EXAMPLES / f"{name}.py").read_text("utf-8")]
    assert len(moving) >= 24  # a page that moves wherever something does


@pytest.mark.parametrize("name", PRINTED)
def test_it_runs_and_draws(
    name: str, gallery: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    picture = pytest.importorskip("matplotlib.image")
    if not gallery.done(name, gallery.of_package()):  # else the site has just run it
        monkeypatch.setattr(gallery, "KEPT", tmp_path)
        monkeypatch.setattr(gallery.thumbnails, "save", lambda *_: None)  # drawn in the next test
        gallery.run(name, gallery.of_package())
    made = gallery.KEPT / name
    printed = (made / "printed.txt").read_text("utf-8")
    for pattern in PRINTED[name]:
        assert re.search(pattern, printed), printed
    pixels = np.asarray(picture.imread(made / f"{name}.png"))
    assert pixels.shape[1] >= 480
    assert (pixels[..., :3].min(axis=-1) < 0.9).mean() > 0.005
    has_page = "def animate(" in (EXAMPLES / f"{name}.py").read_text("utf-8")
    assert (made / "live.html").exists() == has_page


@pytest.mark.parametrize(
    "name",  # one with a view in space and one in the plane; with the mark `long` the others
    [
        pytest.param(name, marks=[] if name in {"asteroid", "light_curve"} else pytest.mark.long)
        for name in PRINTED
    ],
)
def test_its_small_pictures(name: str, gallery: ModuleType) -> None:
    picture = pytest.importorskip("matplotlib.image")
    if not gallery.done(name, gallery.of_package()):
        gallery.run(name, gallery.of_package())
    made = gallery.KEPT / name
    for mode, is_dark in (("light", False), ("dark", True)):
        small = np.asarray(picture.imread(made / f"{mode}.png"))[..., :3]
        assert small.shape == (400, 640, 3)
        assert bool(small[0, 0].max() < 0.2) is is_dark
        assert (np.abs(small - small[0, 0]).max(axis=-1) > 0.3).mean() > 0.01  # something is seen


def test_a_script_run_by_itself_writes_its_picture_and_its_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["slew.py"])
    runpy.run_path(str(EXAMPLES / "slew.py"), run_name="__main__")
    assert {file.name for file in tmp_path.iterdir()} == {"slew.png", "slew.html"}
