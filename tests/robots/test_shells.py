"""Hollow geoms of MJCF (``shellinertia``) and links that are no mirror images, against MuJoCo and by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from polhode import robots
from scipy.spatial.transform import Rotation


def parse(source: bytes) -> robots.Robot:
    return robots.parse_robot(source, name="r", folder=Path())


SHELLS = {
    "sphere": 'size="0.3"',
    "box": 'type="box" size="0.3 0.2 0.1"',
    "cylinder": 'type="cylinder" size="0.2 0.5"',
    "capsule": 'type="capsule" size="0.2 0.5"',
    "ellipsoid": 'type="ellipsoid" size="0.1 0.2 0.3"',
    "round ellipsoid": 'type="ellipsoid" size="0.3 0.3 0.3"',
    "flat ellipsoid": 'type="ellipsoid" size="1 2 0.05" pos="1 2 3" euler="10 20 30"',
    "placed": 'type="capsule" size="0.1" fromto="0.1 0.2 0.3 0.5 -0.1 0.2"',
}


@pytest.mark.parametrize("name", SHELLS)
@pytest.mark.parametrize("weight", ["", 'mass="2"', 'density="12"'])
def test_a_shell_is_that_of_mujoco(name: str, weight: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    text = (
        '<mujoco><worldbody><body name="b"><joint type="hinge"/>'
        f'<geom {SHELLS[name]} {weight} shellinertia="true"/></body></worldbody></mujoco>'
    )
    (verdict,) = robots.check(parse(text.encode()))
    model = mujoco.MjModel.from_xml_string(text)
    assert verdict.verdict == "inferred"
    assert verdict.mass == pytest.approx(model.body_mass[1], rel=1e-12)
    assert verdict.moments is not None
    assert np.allclose(verdict.moments, np.sort(model.body_inertia[1]), rtol=1e-9)


def test_what_a_hollow_ellipsoid_is() -> None:
    text = '<geom type="ellipsoid" size="{}" shellinertia="true"/>'
    text = f'<mujoco><worldbody><body name="b"><joint type="hinge"/>{text}</body></worldbody></mujoco>'
    (verdict,) = robots.check(parse(text.format("0.3 0.3 0.3").encode()))
    assert verdict.moments is not None
    assert verdict.mass is not None
    assert verdict.mass == pytest.approx(1000.0 * 4.0 * np.pi * 0.09, rel=1e-12)
    assert np.allclose(verdict.moments, 2.0 / 3.0 * verdict.mass * 0.09, rtol=1e-5)
    assert any("hollow ellipsoid is counted as MuJoCo does" in note for note in verdict.notes)
    (verdict,) = robots.check(parse(text.format("0.1 0.2 0.3").encode()))
    assert verdict.mass == pytest.approx(488.82146302582, rel=0.0106)  # exact, by elliptic integrals


TENSOR = 'ixx="4" ixy="-0.5" ixz="0.25" iyy="5" iyz="0.75" izz="6"'
MIRRORED = 'ixx="4" ixy="0.5" ixz="0.25" iyy="5" iyz="-0.75" izz="6"'


def two_arms(left: str, right: str, names: tuple[str, str] = ("left_arm", "right_arm")) -> bytes:
    links = "".join(
        f'<link name="{name}"><inertial>{body}</inertial></link>'
        for name, body in zip(names, (left, right), strict=True)
    )
    return f'<robot name="r">{links}</robot>'.encode()


def inertial(tensor: str, place: str = "0.1 0.2 0.3", mass: str = "2") -> str:
    return f'<origin xyz="{place}"/><mass value="{mass}"/><inertia {tensor}/>'


@pytest.mark.parametrize(
    ("right", "says"),
    [
        (inertial(MIRRORED, "0.1 -0.2 0.3"), ""),
        (inertial(MIRRORED, "0.1 -0.2 0.3", "2.5"), "its mass is 2.5 kg, that of the other 2 kg"),
        (inertial(TENSOR), "it has the same numbers, which are not those of its mirror image"),
        (
            inertial(MIRRORED, "0.1 0.2 0.3"),
            "its products of inertia and its centre of mass have signs of different sides",
        ),
        (
            inertial(TENSOR, "0.1 -0.2 0.3"),
            "its products of inertia and its centre of mass have signs of different sides",
        ),
        (
            inertial(MIRRORED, "0.3 -0.2 0.1"),
            "its products of inertia and its centre of mass have signs of different sides",
        ),
        (inertial(MIRRORED, "0.1 -0.4 0.3"), "its centre of mass is 0.5099 m from its origin"),
        (inertial(MIRRORED.replace('"6"', '"7"'), "0.1 -0.2 0.3"), "its principal moments are"),
    ],
)
@pytest.mark.parametrize(
    "names", [("left_arm", "right_arm"), ("LeftArm", "RightArm"), ("l_arm", "r_arm"), ("FL_hip", "FR_hip")]
)
def test_twins(right: str, says: str, names: tuple[str, str]) -> None:
    robot = parse(two_arms(inertial(TENSOR), right, names))
    notes = [note for verdict in robots.check(robot) for note in verdict.notes if "mirror image" in note]
    assert len(notes) == bool(says)
    if says:
        assert f"{names[1]} is no mirror image of {names[0]}: {says}" in notes[0]


def test_links_that_are_no_twins() -> None:
    for names in (("arm", "leg"), ("left_arm", "right_leg"), ("frame", "flame"), ("ball", "barr")):
        robot = parse(two_arms(inertial(TENSOR), inertial(TENSOR), names))
        assert not any("mirror" in note for verdict in robots.check(robot) for note in verdict.notes)


def test_frames_of_twins_may_be_any(rng: np.random.Generator) -> None:
    """A mirror image stays one in axes that are turned; a copied centre or tensor does not become one."""
    tensor = np.array([(4, -0.5, 0.25), (-0.5, 5, 0.75), (0.25, 0.75, 6.0)])
    center, signs = np.array([0.1, 0.2, 0.3]), np.array([1.0, -1.0, 1.0])
    mirrored = np.outer(signs, signs) * tensor
    for turn in Rotation.random(20, rng=rng).as_matrix():
        for own, place, is_twin in (
            (mirrored, signs * center, True),
            (mirrored, center, False),
            (tensor, signs * center, False),
        ):
            turned = turn @ own @ turn.T
            names = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
            text = " ".join(f'{name}="{turned[i, j]:.6g}"' for name, i, j in names)
            right = inertial(text, " ".join(f"{x:.6g}" for x in turn @ place))
            robot = parse(two_arms(inertial(TENSOR), right))
            notes = [note for verdict in robots.check(robot) for note in verdict.notes if "mirror" in note]
            assert bool(notes) != is_twin
