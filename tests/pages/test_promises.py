"""Facts that the pages state and no other test has: versions, extras, counts, limits of what is read."""

from __future__ import annotations

import json
import re
import tomllib
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from places import ROOT
from polhode import Event, RigidBody, euler_angles, regions, robots
from polhode.errors import SingularAttitudeError
from polhode.io.budget import LIMITS, MOST_TEXT
from robot_texts import ONE_BALL
from scipy.spatial.transform import Rotation

README = (ROOT / "README.md").read_text("utf-8")
WORDS = {
    "six": 6,
    "seven": 7,
    "eight": 8,
    "nine": 9,
    "ten": 10,
    "eleven": 11,
    "twelve": 12,
    "thirty-five": 35,
}


def manifest(path: str) -> dict[str, object]:
    return tomllib.loads((ROOT / path).read_text("utf-8"))


def test_the_versions_are_those_that_the_build_asks_for() -> None:
    stated = re.search(r"Python ≥ (\S+), .* Rust ≥ ([\d.]+),", README)
    assert stated
    python, rust = (ROOT / name for name in ("pyproject.toml", "Cargo.toml"))
    assert f'requires-python = ">={stated[1]}"' in python.read_text("utf-8")
    assert f'rust-version = "{stated[2]}"' in rust.read_text("utf-8")


def test_the_extra_all_is_every_extra_but_view_cluster_and_cad_and_scipy() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]

    def names(extra: str) -> set[str]:
        """The extra and those within it, and distributions."""
        found = {extra}
        for need in extras[extra]:
            inner = re.fullmatch(r"polhode\[(.*)\]", need)
            within = [names(part) for part in inner[1].split(",")] if inner else [{re.split(r"\W", need)[0]}]
            found = found.union(*within)
        return found

    shown = set(re.findall(r"^\| `(\w+)` \|", README[README.index("| extra |") :], re.MULTILINE))
    assert shown == set(extras)
    assert names("all") & set(extras) == set(extras) - {"view", "cluster", "cad"}
    assert "scipy" in names("all")


def test_the_core_needs_no_python() -> None:
    needed = manifest("rust/core/Cargo.toml")["dependencies"]
    assert isinstance(needed, dict)
    assert not {"pyo3", "numpy", "polhode-python"} & set(needed)


@pytest.mark.parametrize("page", ["README.md", "CHANGELOG.md"])
def test_the_examples_are_as_many_as_is_said(page: str) -> None:
    said = re.search(r"([\w-]+) scripts with a figure each", (ROOT / page).read_text("utf-8"))
    assert said
    assert WORDS[said[1]] == len(list((ROOT / "examples").glob("*.py")))


def test_commands_print_json_and_end_with_0_1_or_2(tmp_path: Path) -> None:
    part, robot, water = tmp_path / "part.obj", tmp_path / "r.urdf", tmp_path / "water.xyz"
    part.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "utf-8")
    robot.write_text(ONE_BALL.format(0.02), "utf-8")
    water.write_text("3\n\nO 0 0 0\nH 0.757 0 0.587\nH -0.757 0 0.587\n", "utf-8")
    for command, file, *options in (
        ("report", part),
        ("check", robot),
        ("molecule", water),
        ("spin", part, "--omega", 0, 0, 1),
    ):
        code, out, err = run(command, file, *options)
        assert (code, err) == (0, "")
        assert out
        code, out, err = run(command, file, *options, "--format", "json")
        assert (code, err) == (0, "")
        assert isinstance(json.loads(out), dict)
        code, out, err = run(command, tmp_path / "absent", *options)
        assert (code, out) == (2, "")
        assert one_line(err)
    robot.write_text(ONE_BALL.format(1), "utf-8")
    assert run("check", robot)[0] == 1


@pytest.mark.parametrize("command", ["report", "check", "molecule", "spin", "assemble", "ledger", "demo"])
def test_the_help_of_each_command_lists_its_options(command: str) -> None:
    code, out, _ = run(command, "--help")
    assert code == 0
    assert "--" in out


@pytest.mark.parametrize(
    ("moment", "verdict"),
    [(0.02 / 10.1, "suspect"), (0.02 / 9.9, "good"), (0.02 * 2.99, "good"), (0.02 * 3.01, "suspect")],
)
def test_both_sides_of_what_is_suspect(moment: float, verdict: str) -> None:
    """A ball of 5 kg with the radius 0.1 m has 2/5 m r² = 0.02 kg m²."""
    robot = robots.parse_robot(ONE_BALL.format(moment).encode(), name="r", folder=".")
    assert robots.check(robot)[1].verdict == verdict


@pytest.mark.parametrize(("mass", "is_read"), [("9.9e49", True), ("1.1e50", False), ("-1.1e50", False)])
def test_both_sides_of_the_largest_number_of_a_robot(mass: str, is_read: bool) -> None:
    text = ONE_BALL.format(1).replace('value="5"', f'value="{mass}"')
    found = robots.check(robots.parse_robot(text.encode(), name="r", folder="."))[1].verdict
    assert (found != "unreadable") == is_read


def test_the_limits_of_files_are_those_that_the_page_states() -> None:
    """What happens at each of them: ``test_robot_limits.py``, ``test_damage.py``."""
    page = (ROOT / "docs" / "command_line.md").read_text("utf-8")
    assert "texts of more than a gigabyte" in page
    assert MOST_TEXT == 1 << 30
    limits = " ".join(page[page.index("nests more than") :].split())
    assert "more than a million elements" in limits
    assert LIMITS["elements"].least == 1_000_000
    for text, value in (
        ("1000 included files", LIMITS["files"].least),
        ("256 MiB", LIMITS["included bytes"].least >> 20),
        ("50,000 links", LIMITS["links"].least),
        ("10,000 copies", LIMITS["copies"].least),
        ("50,000 elements in them", LIMITS["elements in copies"].least),
    ):
        assert text in limits
        assert int(text.partition(" ")[0].replace(",", "")) == value


@pytest.mark.parametrize("sequence", ["ZXZ", "ZYX"])
def test_both_sides_of_the_singular_attitude(sequence: str) -> None:
    pole = 0.0 if sequence == "ZXZ" else np.pi / 2
    for offset, is_singular in ((3e-12, False), (3e-13, True)):
        h = (pole + (offset if pole == 0.0 else -offset)) / 2
        about = 0 if sequence == "ZXZ" else 1
        q = np.zeros(4)
        q[about], q[3] = np.sin(h), np.cos(h)
        if is_singular:
            with pytest.raises(SingularAttitudeError):
                euler_angles.from_quaternion(q, sequence)
        else:
            assert np.isfinite(euler_angles.from_quaternion(q, sequence)).all()


def test_shapes_that_overlap_count_twice() -> None:
    """A ball and a half of its size at one place, together of 5 kg: 8/9 and 1/9 of the mass."""
    shape = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    text = ONE_BALL.format(1).replace(shape, shape + shape.replace("0.1", "0.05"))
    found = robots.check(robots.parse_robot(text.encode(), name="r", folder="."))[1].shape_moments
    assert found is not None
    assert found == pytest.approx(0.4 * 5 / 9 * (8 * 0.1**2 + 0.05**2), rel=1e-12)


def test_the_bound_is_eight_times_what_is_asked() -> None:
    """Of a jump the error told is close below the tolerance, and the bound is eight times that."""

    def density(r: np.ndarray) -> np.ndarray:
        return np.where(r[:, 0] < 0.123_456, 1.0, 2.0)

    body = RigidBody.from_density(density, regions.box((0, 0, 0), (1, 1, 1)), rtol=1e-4)
    told = body.error_bound.mass / body.mass / 8
    assert 1e-5 < told <= 1e-4 * (1 + 1e-6)


def test_a_tiny_body_of_a_large_density() -> None:
    """Edges of 1e-90 with 1e200: 1e-270 of volume has a mass of 1e-70."""
    nodes = 1e-90 * np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    body = RigidBody.from_tetrahedra(nodes, [(0, 1, 2, 3)], density=1e200)
    assert body.mass == pytest.approx(1e-70 / 6, rel=1e-13)
    assert body.principal_moments[0] > 0.0


@pytest.mark.parametrize("method", ["taylor", "dop853", "radau", "splitting", "exact"])
@pytest.mark.parametrize("apart", [1e-1, 1e-3, 1e-5])
def test_two_events_close_together(method: Any, apart: float) -> None:
    """(t − 5)² = (apart/2)², within one step of a slow turn."""
    near = Event(lambda t, *_: (t - 5.0) ** 2 - 0.25 * apart**2)
    ball = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    run = ball.simulate([0.0, 11.0], (0.0, 0.01, 0.1), method=method, events=near)
    assert run.events.t == pytest.approx([5.0 - apart / 2, 5.0 + apart / 2], rel=1e-9)


def test_the_outermost_node_of_the_rule() -> None:
    """The Kronrod rule of 15 points (QUADPACK) in boxes of half the length: the first is 0.4 % inside."""
    asked: list[float] = []

    def density(r: np.ndarray) -> np.ndarray:
        asked.extend(r[:, 0])
        return np.ones(len(r))

    RigidBody.from_density(density, regions.box((0, 0, 0), (1, 1, 1)))
    outermost = 0.5 * (1.0 - 0.991_455_371_120_812_6)
    assert round(100 * outermost, 1) == 0.4
    assert np.abs(np.array(asked) - 0.5 * outermost).min() < 1e-15


def test_the_ratio_of_third_and_second_order_of_a_power() -> None:
    for n in (-2, -1, 2, 3, 5, 7):
        first, second, third = Fraction(n), Fraction(n * (n - 1), 2), Fraction(n * (n - 1) * (n - 2), 6)
        mean = {2: 1, 4: 3}  # of the powers of a standard normal variable
        ratio = 2 * first * third * mean[4] / (second**2 * mean[4])
        assert ratio == Fraction(4, 3) * Fraction(n - 2, n - 1)
        if n == -1:
            variance = second**2 * (mean[4] - mean[2] ** 2)
            others = variance + ratio * second**2 * mean[4]
            taken = variance + Fraction(4, 3) * second**2 * mean[4]
            assert others / taken == Fraction(4, 3)
            assert Fraction(15, 1000) * others / taken == Fraction(2, 100)


def test_the_angles_of_the_closed_form_are_those_of_zxz() -> None:
    for mu, theta, chi in np.random.default_rng(5).uniform(0.1, 3.0, (20, 3)):
        attitude = Rotation.from_euler("ZYZ", [mu, -theta, -chi])
        same = Rotation.from_euler("ZXZ", [mu - np.pi / 2, theta, np.pi / 2 - chi])
        assert (attitude * same.inv()).magnitude() < 1e-14
