"""Advice that presumes a cause: given where following it works, and not given where it would not.

The way out is taken, on both sides of the condition under which it is offered.
"""

from __future__ import annotations

import errno
import os
import re
import shutil
import sys
from decimal import Decimal
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run
from mesh_files import ascii_stl, binary_stl, obj
from oracles.meshes import cube
from polhode import RigidBody, animation, plot, robots, solids, tops, validity
from polhode._format import at_least, at_most
from polhode.cli.terminal import in_options
from polhode.errors import FileFormatError, InvalidInertiaError, PolhodeError
from polhode.io import load
from polhode.io.budget import words_of
from polhode.io.content import EXPECTED_CONTENT

if TYPE_CHECKING:
    from collections.abc import Callable

BODY: Any = RigidBody
RTOL = re.compile(r"pass rtol=(\S+) if the table was printed to few digits")
EQUAL = re.compile(r"pass rtol=(\S+) to take them as equal")


def refused(call: Callable[[], object]) -> InvalidInertiaError | None:
    """The error of numbers that no body has."""
    try:
        call()
    except InvalidInertiaError as error:
        return error
    return None


def printed(rng: np.random.Generator) -> list[str]:
    """Three moments with so many decimals as one printer gives them, which need not be a body's."""
    digits = int(rng.integers(0, 6))
    size = 10.0 ** float(rng.integers(0, 3))
    a, b = size * rng.uniform(0.2, 1.0, 2)
    c = (a + b) * (1.0 + 10.0 ** rng.uniform(-5.0, 0.0))
    return [f"{number:.{digits}f}" for number in (a, b, c)]


def may_be_rounded(texts: list[str]) -> bool:
    """By exact decimals: half a unit of the last place of each makes up for what breaks the law."""
    numbers = sorted(Decimal(text).normalize() for text in texts)
    places = [int(number.as_tuple().exponent) for number in numbers if number]
    unit = Decimal(1).scaleb(min(places))
    return numbers[2] - numbers[1] - numbers[0] <= Decimal("1.5") * unit and numbers[2] >= 10 * unit


def test_a_tolerance_is_named_where_rounding_may_have_broken_the_law() -> None:
    rng = np.random.default_rng(0)
    counts = {True: 0, False: 0}
    for _ in range(2000):
        texts = printed(rng)
        moments = [float(text) for text in texts]
        error = refused(partial(RigidBody.from_principal, 1.0, moments))
        if error is None:
            continue
        found = RTOL.search(str(error))
        assert (found is not None) == may_be_rounded(texts), (texts, error)
        counts[found is not None] += 1
        if found is not None:
            RigidBody.from_principal(1.0, moments, rtol=float(found[1]))
            assert in_options(error).endswith("give more digits")
        else:
            assert error.way_out.startswith("check the numbers and their units")
        assert error.fault == str(error)[: -len(error.way_out)].rstrip("; ")
        nearest, _ = validity.nearest_valid(np.diag(moments))
        RigidBody(1.0, nearest)
    assert min(counts.values()) > 100


@pytest.mark.parametrize(
    "moments", [(1.0, 2.0, 4.0), (1.0, 1.0, 100.0), (0.0, 1.0, 199.0), (10.0, 20.0, 40.0)]
)
def test_no_tolerance_is_named_for_what_is_no_rounding(moments: tuple[float, ...]) -> None:
    with pytest.raises(InvalidInertiaError) as told:
        RigidBody.from_principal(1.0, moments)
    assert "rtol" not in str(told.value)
    text = " ".join(map(str, moments))
    code, _, err = run("spin", "--moments", text, "--omega", "1 0 0")
    assert (code, "digits" in err) == (2, False)


def test_a_link_of_a_robot_is_told_the_law_alone() -> None:
    source = b"""<robot name="one"><link name="arm"><inertial><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="199" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
    (verdict,) = robots.check(robots.parse_robot(source, name="one.urdf", folder="."))
    assert verdict.verdict == "impossible"
    assert "break the triangle inequality" in verdict.reason
    assert not re.search(r"rtol|digits|nearest_valid", verdict.reason)


@pytest.mark.parametrize("off", [1e-10, 1e-3, 0.3])
def test_a_tensor_that_is_not_symmetric(off: float) -> None:
    tensor = np.diag([2.0, 2.5, 3.0])
    tensor[0, 1], tensor[1, 0] = 0.1, 0.1 + off
    for make in (lambda t: RigidBody(1.0, t), validity.nearest_valid):
        with pytest.raises(InvalidInertiaError, match="put one number in both places, such as their mean"):
            make(tensor)
        make(0.5 * (tensor + tensor.T))


def test_a_tensor_about_the_origin_is_taken_for_one_about_the_centre_where_it_may_be() -> None:
    rng = np.random.default_rng(1)
    counts = {True: 0, False: 0}
    for _ in range(300):
        moments = rng.uniform(0.2, 1.0, 3) * (1.0, 1.0, 1.7)
        center = rng.normal(size=3)
        error = refused(partial(BODY, 2.0, inertia_about_origin=np.diag(moments), center_of_mass=center))
        if error is None or "no negative principal moment" not in str(error):
            continue
        is_possible = 2.0 * moments.max() <= moments.sum()
        counts[is_possible] += 1
        assert ("pass it as inertia=" in str(error)) == is_possible
        if is_possible:
            BODY(2.0, inertia=np.diag(moments), center_of_mass=center)
    assert min(counts.values()) > 20


@pytest.mark.parametrize("gap", [1e-5, 9e-3, 1.1e-2, 0.3])
def test_moments_are_taken_as_equal_where_they_nearly_are(gap: float) -> None:
    body = RigidBody.from_principal(1.0, (1.0, 1.5 * (1.0 - gap), 1.5), center_of_mass=(0.1, 0.0, 0.0))
    for call in (
        lambda **rtol: tops.free_precession(body, (1.0, 0.0, 0.1), **rtol),
        lambda **rtol: body.heavy_top((1.0, 0.0, 0.1), gravity=(0.0, 0.0, -9.81), **rtol),
    ):
        with pytest.raises(PolhodeError, match=r"integrate with simulate\(\)") as told:
            call()
        found = EQUAL.search(str(told.value))
        assert (found is not None) == (gap < 0.01)
        if found is not None:
            call(rtol=float(found[1]))


def test_matter_is_told_of_no_tolerance() -> None:
    """Only constructors from tables have one."""
    admitted = RigidBody.from_principal(1.0, (1.0, 1.0, 2.01), rtol=1e-2)
    with pytest.raises(InvalidInertiaError) as told:
        admitted.equimomental_particles()
    assert "rtol" not in str(told.value)


@pytest.mark.parametrize("seed", range(6))
def test_a_unit_that_was_stated_is_not_contradicted(seed: int, tmp_path: Path) -> None:
    """An asteroid in metres is one: a remark says how large it is, and tells nobody to change the unit."""
    rng = np.random.default_rng(seed)
    side = float(10.0 ** rng.uniform(-1.0, 4.0))
    unit = ("m", "mm", "in", "ft", "cm")[seed % 5]
    (tmp_path / "rock.obj").write_bytes(obj(*cube(side)))
    code, out, _ = run("report", tmp_path / "rock.obj", "--density", "2000", "--length-unit", unit)
    assert code == 0
    assert "state --length-unit" not in out
    if "is unusual for a part" in out:
        assert f"check that the file is in {unit}" in out or "check the unit of length" in out


@pytest.mark.parametrize(
    "number", [errno.ENOENT, errno.ENOTDIR, errno.ENOSPC, errno.EACCES, errno.EIO, errno.EISDIR]
)
def test_the_path_is_at_fault_only_where_it_is(number: int) -> None:
    words = words_of(OSError(number, os.strerror(number), "a.stl"))
    assert words.startswith(f"a.stl: {os.strerror(number)}")
    assert ("check the path" in words) == (number in (errno.ENOENT, errno.ENOTDIR))
    own = OSError(number, "is full of holes; name another file", "a.stl")
    assert words_of(own) == "a.stl: is full of holes; name another file"


@pytest.mark.parametrize("carrier", ["absent", "without the program"])
def test_a_film_without_ffmpeg(carrier: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> str:
        raise RuntimeError("no ffmpeg")

    monkeypatch.setattr(shutil, "which", lambda _: None)
    found = None if carrier == "absent" else SimpleNamespace(get_ffmpeg_exe=refuse)
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", found)
    (tmp_path / "box.obj").write_bytes(obj(*cube(1.0)))
    words = ("--mass", "1", "--omega", "0 0 1", "--end", "1")
    code, _, err = run("spin", tmp_path / "box.obj", *words, "--save", tmp_path / "a.mp4")
    assert code == 2
    assert "needs the program ffmpeg" in err
    assert "check the path" not in err
    assert ('pip install "polhode[film]"' in err) == (carrier == "absent")
    assert "write a .gif or .html" in err
    assert run("spin", tmp_path / "box.obj", *words, "--save", tmp_path / "a.html")[0] == 0


CONTENTS: dict[str, Callable[[], bytes]] = {
    "ASCII STL": lambda: ascii_stl(*cube(1.0)),
    "binary STL": lambda: binary_stl(*cube(1.0)),
    "v/f text": lambda: obj(*cube(1.0)),
    "XYZ": lambda: b"1\nhelium\nHe 0 0 0\n",
    "VTK": lambda: (
        b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0\n1 0 0\n0 1 0\n"
        b"0 0 1\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
    ),
}


@pytest.mark.parametrize("content", CONTENTS)
def test_a_file_is_read_under_the_name_that_is_advised(content: str, tmp_path: Path) -> None:
    data = CONTENTS[content]()
    tried = 0
    for suffix in (*EXPECTED_CONTENT, "", ".foo", ".step.foo"):
        path = tmp_path / f"part{suffix}"
        if content in EXPECTED_CONTENT.get(path.suffix, ()) or suffix in (".step", ".stp", ".igs", ".iges"):
            continue
        path.write_bytes(data)
        with pytest.raises(FileFormatError, match=f"its content is {content}; rename it to end in") as told:
            load(path)
        name = re.search(r"rename it to end in (\.\w+)", str(told.value))
        assert name is not None
        renamed = path.rename(tmp_path / f"good{name[1]}")
        if content == "VTK":
            pytest.importorskip("pyvista")
        load(renamed)
        tried += 1
    assert tried > 10


def test_a_robot_that_is_a_mesh_is_read_under_the_name_that_is_advised(tmp_path: Path) -> None:
    for name, advice in (
        ("arm.urdf", "rename it to end in .obj, and polhode report reads it"),
        ("arm.obj", ""),
    ):
        path = tmp_path / name
        path.write_bytes(obj(*cube(1.0)))
        with pytest.raises(FileFormatError) as told:
            robots.read_robot(path)
        assert str(told.value).endswith(advice or "not a robot; polhode report reads it")
    assert run("report", tmp_path / "arm.obj", "--density", "1")[0] == 0


@pytest.mark.parametrize("seed", range(3))
def test_limits_that_are_told_hold(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for number in 10.0 ** rng.uniform(-12.0, 12.0, 300):
        for digits in (2, 3, 6):
            up, down = float(at_least(float(number), digits)), float(at_most(float(number), digits))
            assert down <= number <= up
            assert up - down <= 2.1 * 10.0 ** (np.floor(np.log10(number)) - digits + 1)


def test_the_limits_of_pictures_hold(tmp_path: Path) -> None:
    uncertain: Any = solids.box((1.0, 2.0, 3.0), mass=2.0).with_sigma(inertia=np.full((3, 3), 0.0137))
    with pytest.raises(ValueError, match="give less than") as told:
        plot.ellipsoid(uncertain, enlarged=1e4)
    limit = float(re.findall(r"give less than (\S+)", str(told.value))[0])
    plot.ellipsoid(uncertain, enlarged=0.9999 * limit)
    motion = solids.box((3.0, 2.0, 1.0), mass=1.0).free_motion((0.01, 1.0, 0.0))
    with pytest.raises(ValueError, match="give duration=") as told:
        animation.animate(motion, tmp_path / "a.gif", end=3.0, frames=7, duration=0.0123)
    least = float(re.findall(r"give duration=(\S+) or more", str(told.value))[0])
    animation.animate(motion, tmp_path / "a.gif", end=3.0, frames=7, duration=least, size=64)
