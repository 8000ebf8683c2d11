"""The list of public robot files, and the judge that polhode's verdicts are held against."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import ROOT

BENCHMARKS = ROOT / "benchmarks"
WORDS = {"suspect", "disputed", "missing", "placeholder", "impossible", "unreadable"}


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    yield import_module
    for name in ("robots", "robots_files", "robots_law", "robots_engines"):
        sys.modules.pop(name, None)


def test_each_row_names_one_file_of_one_commit(bench: Any) -> None:
    files = bench("robots").listed()
    assert len(files) >= 300
    assert len({(f.repository, f.path) for f in files}) == len(files)
    for file in files:
        assert re.fullmatch(r"[\w.-]+/[\w.-]+", file.repository)
        assert re.fullmatch(r"[0-9a-f]{40}", file.commit)
        assert re.fullmatch(r"[A-Z][\w.+-]*", file.licence), file.repository
        assert Path(file.path).suffix in {".urdf", ".sdf", ".world", ".xml"}
        assert not Path(file.path).is_absolute()
        assert file.links > 0
        assert file.by
        assert set(file.words) <= WORDS


def test_no_link_has_two_expectations_and_writing_the_list_again_changes_nothing(bench: Any) -> None:
    robots = bench("robots")
    for file in robots.listed():
        named = [name for said in file.words.values() for names in said.values() for name in names]
        assert len(set(named)) == len(named) <= file.links, file.path
    assert robots.written(robots.listed()) == robots.LIST.read_text(encoding="utf-8")


def inertial(mass: float, x: float, y: float, z: float, at: str = "0 0 0") -> str:
    tensor = f'<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/>'
    return f'<inertial><origin xyz="{at}"/><mass value="{mass}"/>{tensor}</inertial>'


BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'  # 1/6 kg m^2 of a kilogram
LINKS = {
    "base": (BOX, "good"),  # tied to the world
    "true": (inertial(1, 1 / 6, 1 / 6, 1 / 6) + BOX, "good"),
    "small": (inertial(1, 0.01, 0.01, 0.012) + BOX, "suspect"),
    "large": (inertial(1, 0.45, 0.45, 0.451) + BOX, "good"),  # 2.7 times, nearly all in the corners
    "beyond": (inertial(1, 0.6, 0.6, 0.61) + BOX, "disputed"),  # 3.6 times: as near to 3 as digits may decide
    "far beyond": (inertial(1, 6, 6, 6.1) + BOX, "suspect"),
    "beyond reason": (inertial(1, 600, 600, 601) + BOX, "impossible"),
    "beside a wall": (inertial(1, 0.3, 0.3, 0.31, at="0.45 0 0") + BOX, "impossible"),
    "away": (inertial(1, 0.1, 0.1, 0.11, at="0.7 0 0") + BOX, "impossible"),
    "narrow": (inertial(1, 0.503, 0.503, 0.504) + BOX, "disputed"),
    "triangle": (inertial(1, 1, 1, 3), "impossible"),
    "negative": (inertial(-1, 1, 1, 1.5), "impossible"),
    "unit": (inertial(5, 1, 1, 1), "placeholder"),
    "nought": (inertial(5, 0, 0, 0), "placeholder"),
    "copied": (inertial(2, 0.3, 0.3, 0.3), "placeholder"),
    "copied too": (inertial(3, 0.3, 0.3, 0.3), "placeholder"),
    "nothing": (BOX, "missing"),
    "empty": (inertial(0, 0, 0, 0) + BOX, "missing"),
    "words": (inertial(1, 1, 1, 1).replace('value="1"', 'value="one"'), "unreadable"),
}


def urdf(links: dict[str, str], kinds: dict[str, str] | None = None) -> str:
    joints = "".join(
        f'<joint name="to {name}" type="{(kinds or {}).get(name, "revolute")}">'
        f'<parent link="base"/><child link="{name}"/><axis xyz="0 0 1"/></joint>'
        for name in links
        if name != "base"
    )
    return (
        '<robot name="r">'
        + "".join(f'<link name="{n}">{x}</link>' for n, x in links.items())
        + f"{joints}</robot>"
    )


def said(bench: Any, folder: Path, name: str, text: str) -> dict[str, str]:
    path = folder / name
    path.write_text(text)
    files, law = bench("robots_files"), bench("robots_law")
    robot = files.read(path, files.Meshes(folder))
    return {link.name: word for link, (word, _) in zip(robot.links, law.judged(robot), strict=True)}


def test_the_judge_knows_each_rule(bench: Any, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    found = said(bench, tmp_path, "r.urdf", urdf({name: text for name, (text, _) in LINKS.items()}))
    assert found == {name: word for name, (_, word) in LINKS.items()}


def test_the_judge_lets_mass_be_fixed_to_a_link(bench: Any, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    links = {"base": inertial(1, 1, 2, 2), "camera": BOX}
    assert said(bench, tmp_path, "r.urdf", urdf(links))["camera"] == "missing"
    assert said(bench, tmp_path, "r.urdf", urdf(links, {"camera": "fixed"}))["camera"] == "good"


def test_the_judge_reads_sdf(bench: Any, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    shape = "<collision name='c'><geometry><box><size>0.1 0.1 0.1</size></box></geometry></collision>"
    model = f"<link name='a'>{shape}</link><gz:odd/><model name='in'><link name='b'>{shape}</link></model>"
    text = f"<sdf version='1.9'><model name='m'>{{}}{model}</model></sdf>"
    assert said(bench, tmp_path, "m.sdf", text.format("")) == {
        "m::a": "placeholder",
        "m::in::b": "placeholder",
    }
    still = said(bench, tmp_path, "m.sdf", text.format("<static>true</static>"))
    assert still == {"m::a": "good", "m::in::b": "good"}


def test_the_room_of_a_box_is_sharp(bench: Any) -> None:
    """Half the matter at either end of an interval is the most that it has room for."""
    pytest.importorskip("trimesh")
    law = bench("robots_law")
    low, high = np.array([-1.0, -1.0, -1.0]), np.array([2.0, 1.0, 1.0])
    center = np.array([0.5, 0.0, 0.0])
    corners = np.array([[x, y, z] for x in (-1, 2) for y in (-1, 1) for z in (-1, 1)], float) - center
    second = corners.T @ corners / 8
    assert law.fits(second, center, low, high)
    assert not law.fits(second * (1 + 1e-9), center, low, high)
    two = np.array([[-1.0, -1.0, 0.0], [2.0, 1.0, 0.0]]) - center  # on a diagonal: the largest product
    assert law.fits(two.T @ two / 2, center, low, high)
    assert not law.fits(two.T @ two / 2 + [[0, 1e-9, 0], [1e-9, 0, 0], [0, 0, 0]], center, low, high)
