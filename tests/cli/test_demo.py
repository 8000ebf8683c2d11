"""The demo: the T-handle, its flips and its picture, and NASA's brick."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest
from markdown_code import blocks
from places import ROOT
from polhode import RigidBody
from polhode.cli import brick, main
from sample_files import t_handle

README = ROOT / "README.md"
Capture: TypeAlias = pytest.CaptureFixture[str]


def test_t_handle_is_a_t() -> None:
    vertices, faces = t_handle()
    body = RigidBody.from_mesh(vertices, faces, density=1.0)  # refuses what is open or inverted
    # A 100 x 16 x 16 bar and a 16 x 16 x 50 stem that hangs from its middle.
    volumes = np.array([100 * 16 * 16, 16 * 16 * 50])
    assert body.mass == pytest.approx(volumes.sum(), rel=1e-14)
    center = (volumes[0] * 8 - volumes[1] * 25) / volumes.sum()
    np.testing.assert_allclose(body.center_of_mass, [0, 0, center], atol=1e-13)
    steiner = volumes[0] * (8 - center) ** 2 + volumes[1] * (-25 - center) ** 2
    about_x = volumes[0] * (16**2 + 16**2) / 12 + volumes[1] * (16**2 + 50**2) / 12 + steiner
    about_y = volumes[0] * (100**2 + 16**2) / 12 + volumes[1] * (16**2 + 50**2) / 12 + steiner
    about_z = volumes[0] * (100**2 + 16**2) / 12 + volumes[1] * (16**2 + 16**2) / 12
    np.testing.assert_allclose(np.diag(body.inertia), [about_x, about_y, about_z], rtol=1e-14)
    assert about_x < about_z < about_y  # the stem is the axis of the intermediate moment


def test_demo(tmp_path: Path, capsys: Capture) -> None:
    folder = tmp_path / "out" / "demo"
    assert main(["demo", "--save", str(folder)]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert (folder / "t-handle.png").read_bytes().startswith(b"\x89PNG")
    assert (folder / "t-handle.stl").stat().st_size == 84 + 50 * 28
    assert "verdict: good" in out
    assert "polhode report" in out
    # What the README shows of it is what it prints.
    shown = [code for language, code in blocks(README) if language == "text" and "NASA" in code]
    assert len(shown) == 1
    assert [line for line in shown[0].splitlines() if line not in out.splitlines()] == []
    # The flips come at equal intervals: the zeros of an elliptic cosine.
    (line,) = (line for line in out.splitlines() if line.strip().startswith("flips"))
    times = [float(time) for time in re.findall(r"\d+\.\d+", line)]
    assert len(times) >= 3
    np.testing.assert_allclose(np.diff(times), np.diff(times)[0], atol=2e-3)
    # Its own last words work, with a file in place of the one they name.
    *_, last = (line for line in out.splitlines() if line.strip())
    name, *command = last.split()
    assert (name, command[:2]) == ("polhode", ["spin", "part.stl"])
    places = {"part.stl": str(folder / "t-handle.stl"), "part.html": str(tmp_path / "part.html")}
    assert main([places.get(word, word) for word in command]) == 0
    assert "<canvas" in (tmp_path / "part.html").read_text("utf-8")


def test_demo_without_matplotlib_says_so(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in [name for name in sys.modules if name.startswith("matplotlib.")]:
        monkeypatch.delitem(sys.modules, name)
    assert main(["demo", "--save", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert 'pip install "polhode[plot]"' in out
    assert "verdict: good" in out


def test_demo_ends_with_1_where_the_brick_comes_out_wrong(
    tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(brick, "MOMENTS", (0.0018942, 0.006211019, 0.007194665))  # two digits short
    assert main(["demo", "--save", str(tmp_path)]) == 1
    out = capsys.readouterr().out
    assert "verdict: BAD" in out
