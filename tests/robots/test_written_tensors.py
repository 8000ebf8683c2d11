"""What is written for engines lies inside I1 + I2 = I3 after rounding: exactly, by MuJoCo and by Pinocchio.

Oracles: Fractions of the printed numbers, for which ``tr(I)/2 1 - I`` is positive semidefinite; and the two
engines, which load robots of many links.
"""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from command_line import run
from polhode import RigidBody, interop, laminae, robots, rods, solids, validity
from polhode.errors import PolhodeError
from polhode.interop.programs import PROGRAMS, inside_edge
from robot_texts import bare, joint, urdf

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

Floats = np.ndarray[Any, np.dtype[np.float64]]

LEAST = 1e-13
"""In kg m^2, of tensors that engines have to take: MuJoCo refuses less than 1e-14 in a URDF."""


def rotations(rng: np.random.Generator) -> Floats:
    """Random; or of angles as people write them."""
    if rng.random() < 0.2:
        c, s = np.cos(angle := rng.choice([1.57, 1.5708, 3.14, 3.14159, -0.785])), np.sin(angle)
        turn = np.roll(np.array([[1, 0, 0], [0, c, -s], [0, s, c]]), rng.integers(3), (0, 1))
        return np.asarray(turn)
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    turn = q * np.sign(np.diag(r))
    return np.asarray(turn * np.linalg.det(turn))


def tensors(rng: np.random.Generator, count: int) -> Iterator[Floats]:
    """Laminae, rods with next to no moment, nearest tensors, and others, at scales of 1e-9 to 1e9."""
    number = 0
    while number < count:
        kind = ("lamina", "rod", "nearest", "any")[number % 4]
        scale = 10.0 ** rng.uniform(-9, 9)
        a, b = np.sort(rng.uniform(0.01, 1.0, 2))
        if kind == "rod":
            a, b = 10.0 ** rng.uniform(-12, -3), 1.0
        share = rng.random() if kind == "any" else 1.0
        moments = np.array([a, b, b + share * a]) * scale
        if moments[0] < LEAST:
            continue
        turn = rotations(rng) if rng.random() < 0.9 else np.eye(3)
        if kind == "nearest":
            moments[2] *= rng.uniform(1.0, 1.3)
        tensor = turn @ np.diag(moments) @ turn.T
        tensor = (tensor + tensor.T) / 2.0
        if kind == "nearest":
            tensor = validity.nearest_valid(tensor).inertia
        number += 1
        yield tensor


def is_possible(tensor: Sequence[Sequence[float]]) -> bool:
    """Whether a body has exactly this tensor: all principal minors of its second moment are 0 or more."""
    exact = [[Fraction(float(x)) for x in row] for row in tensor]
    half = (exact[0][0] + exact[1][1] + exact[2][2]) / 2
    second = [[half * (i == j) - exact[i][j] for j in range(3)] for i in range(3)]

    def minor(axes: tuple[int, ...]) -> Fraction:
        if len(axes) == 1:
            return Fraction(second[axes[0]][axes[0]])
        if len(axes) == 2:
            i, j = axes
            return Fraction(second[i][i] * second[j][j] - second[i][j] * second[j][i])
        (a, b, c), (d, e, f), (g, h, k) = second
        return Fraction(a * (e * k - f * h) - b * (d * k - f * g) + c * (d * h - e * g))

    return all(minor(axes) >= 0 for n in (1, 2, 3) for axes in combinations(range(3), n))


def symmetric(six: Sequence[float]) -> Floats:
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def numbers(text: str) -> list[float]:
    return [float(x) for x in re.findall(r"-?\d+\.?\d*(?:e[+-]?\d+)?", text)]


def printed(body: RigidBody, program: str) -> list[Floats]:
    """The tensors about C that a text of a program has; principal ones on their diagonal."""
    text = interop.to_text(body, program)
    if program in ("urdf", "sdf"):
        element = ET.fromstring(text)
        inertia = element.find("inertia")
        assert inertia is not None
        values = inertia.attrib if program == "urdf" else {each.tag: each.text or "" for each in inertia}
        return [symmetric([float(values[n]) for n in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")])]
    if program in ("mjcf", "mujoco"):
        text = text.replace(" = [", '="').replace("]", '"').replace("body.inertia", "diaginertia")
        name, values = next(iter(re.findall(r'(diaginertia|fullinertia)="(.*?)"', text)))
        found = numbers(values)
        return [np.diag(found) if name == "diaginertia" else symmetric(found)]
    if program == "pybullet":
        return [np.diag(numbers(text.partition("Diagonal=")[2]))]
    if program == "onshape":
        return [np.reshape(json.loads(text)["inertia"], (3, 3))]
    if program == "pinocchio":
        return [np.reshape(numbers(text.partition("[[")[2]), (3, 3))]
    if program == "simulink":
        yz, xz, xy = numbers(text.partition("Products of Inertia: ")[2].partition(" kg")[0])
        xx, yy, zz = numbers(text.partition("Moments of Inertia: ")[2].partition(" kg")[0])
        return [symmetric([xx, yy, zz, xy, xz, yz])]
    if program == "drake":
        return [symmetric([float(x) for x in re.findall(r"I[xyz]{2}=([^,)]+)", text)])]
    if program == "adams":
        xx, yy, zz, xy, xz, yz = numbers(text.partition("IP=")[2].partition("\n")[0])
        return [symmetric([xx, yy, zz, -xy, -xz, -yz])]
    if program == "solidworks":
        found = [float(x) for x in re.findall(r"L[xyz]{2} = (\S+)", text)]
        own = np.reshape(found, (3, 3))
        return [2.0 * np.diag(np.diag(own)) - own]
    assert program == "matlab"  # about the origin: here C
    xx, yy, zz, yz, xz, xy = numbers(text.splitlines()[3])
    return [symmetric([xx, yy, zz, xy, xz, yz])]


def refused_by_mujoco(text: str) -> str:
    mujoco = pytest.importorskip("mujoco")
    try:
        mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        return str(error)
    return ""


def loaded_by_pinocchio(text: str, count: int) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromXML(text)
    assert model.njoints == count + 1
    matrix = pinocchio.crba(model, model.createData(), pinocchio.neutral(model))
    assert (np.diag(matrix) > 0.0).all()


def urdf_of(elements: Sequence[str], place: str = "") -> str:
    """A root and links that turn on it, each by a joint of its own."""
    names = [f"l{i}" for i in range(len(elements))]
    links = [f'<link name="{n}">{each}</link>' for n, each in zip(names, elements, strict=True)]
    hinge = [joint("root", n).replace('xyz="0 0 0"', f'xyz="0 0 0" {place}') for n in names]
    return urdf(bare("root"), *links, *hinge)


def mjcf_of(elements: Sequence[str]) -> str:
    bodies = [f'<body name="l{i}"><joint/>{each}</body>' for i, each in enumerate(elements)]
    return f"<mujoco><worldbody>{''.join(bodies)}</worldbody></mujoco>"


def sdf_of(elements: Sequence[str]) -> str:
    links = [f'<link name="l{i}">{each}</link>' for i, each in enumerate(elements)]
    return f'<sdf version="1.9"><model name="m">{"".join(links)}</model></sdf>'


def parsed(text: str | bytes) -> robots.Robot:
    return robots.parse_robot(text if isinstance(text, bytes) else text.encode(), name="r", folder=".")


def check_writers(bodies: Sequence[RigidBody]) -> None:
    for body in bodies:
        written = {tensor.tobytes(): (tensor, p) for p in PROGRAMS for tensor in printed(body, p)}
        for tensor, program in written.values():
            assert is_possible(tensor.tolist()), (program, body.inertia.tolist())
    text = urdf_of([interop.to_text(body, "urdf") for body in bodies])
    assert refused_by_mujoco(text) == ""
    loaded_by_pinocchio(text, len(bodies))
    assert refused_by_mujoco(mjcf_of([interop.to_text(body, "mjcf") for body in bodies])) == ""
    mujoco = pytest.importorskip("mujoco")
    spec = mujoco.MjSpec()
    for body in bodies:
        scope = {"body": spec.worldbody.add_body()}
        scope["body"].add_joint()
        exec(interop.to_text(body, "mujoco"), scope)
    model = spec.compile()
    for body, moments in zip(bodies, model.body_inertia[1:], strict=True):
        largest = float(body.principal_moments[2])
        np.testing.assert_allclose(np.sort(moments), body.principal_moments, rtol=0, atol=4e-12 * largest)


def check_fixes(given: Sequence[Floats], rng: np.random.Generator) -> None:
    """Tensors beyond the edge by up to 5 %, in turned frames: put right in all three formats."""
    beyond = []
    for tensor in given:
        moments, axes = np.linalg.eigh(tensor)
        moments[2] *= rng.choice([1.0, 1.0 + 1e-12, 1.001, 1.05])
        beyond.append(axes @ np.diag(moments) @ axes.T)
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    sixes = [t[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)].tolist() for t in beyond]
    turns = [" ".join(map(repr, rng.uniform(-3, 3, 3).tolist())) for _ in beyond]
    in_urdf = [
        f'<inertial><origin xyz="0 0 0" rpy="{turn}"/><mass value="1"/><inertia '
        + " ".join(f'{n}="{x!r}"' for n, x in zip(names, six, strict=True))
        + "/></inertial>"
        for six, turn in zip(sixes, turns, strict=True)
    ]
    in_sdf = [
        f"<inertial><pose>0 0 0 {turn}</pose><mass>1</mass><inertia>"
        + "".join(f"<{n}>{x!r}</{n}>" for n, x in zip(names, six, strict=True))
        + "</inertia></inertial>"
        for six, turn in zip(sixes, turns, strict=True)
    ]
    in_mjcf = [
        f'<inertial pos="0 0 0" quat="1 {turn}" mass="1" diaginertia="{" ".join(map(repr, six[:3]))}"/>'
        for six, turn in zip(sixes, turns, strict=True)
    ]
    for text in (urdf_of(in_urdf, 'rpy="0.1 1.2 -2"'), sdf_of(in_sdf), mjcf_of(in_mjcf)):
        robot = parsed(text)
        verdicts = robots.check(robot)
        fixed = robots.fix(robot, verdicts)
        again = parsed(fixed)
        for link, verdict in zip(again.links, robots.check(again), strict=True):
            if link.inertial is None:
                continue
            assert verdict.inside is None
            assert verdict.verdict not in robots.FAILURES, verdict.reason
            if robot.format != "MJCF":  # there it may be turned after it was read
                assert is_possible(link.inertial.inertia.tolist())
        if robot.format != "SDF":
            assert refused_by_mujoco(fixed.decode()) == ""
        if robot.format == "URDF":
            loaded_by_pinocchio(fixed.decode(), len(given))


def check_many(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    given = list(tensors(rng, count))
    check_writers([RigidBody(1.0, tensor) for tensor in given])
    check_fixes(given, rng)


def test_engines_take_what_is_written() -> None:
    check_many(1, 100)


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("seed", range(2, 52))
def test_engines_take_what_is_written_of_many(seed: int) -> None:
    check_many(seed, 200)


class TestTheEdge:
    def test_a_tensor_clear_of_it_is_the_same_object(self) -> None:
        for margin, is_same in ((4.0, False), (6.0, True)):
            tensor = np.diag([1.0, 1.0, 2.0 - 4.0 * margin * 2.0**-52])
            assert (inside_edge(tensor) is tensor) == is_same

    @pytest.mark.parametrize("scale", [1e-300, 1e-30, 1.0, 1e30, 1e300])
    def test_it_moves_by_rounding_alone_at_any_scale(self, scale: float) -> None:
        rng = np.random.default_rng(5)
        for _ in range(20):
            a, b = rng.uniform(0.0, 1.0, 2)
            turn = rotations(rng)
            tensor = turn @ np.diag([a, b, a + b]) @ turn.T * scale
            tensor = (tensor + tensor.T) / 2.0
            inside = inside_edge(tensor)
            assert np.abs(inside - tensor).max() <= 6e-15 * np.trace(tensor)
            assert is_possible(inside.tolist())
            assert inside_edge(inside) is inside

    def test_nothing_and_a_point_stay(self) -> None:
        zero = np.zeros((3, 3))
        assert inside_edge(zero) is zero

    @pytest.mark.parametrize("program", PROGRAMS)
    def test_a_body_with_a_thickness_keeps_its_bits(self, program: str) -> None:
        brick = solids.box((1.0, 2.0, 0.001), mass=3.0)
        (tensor,) = printed(brick, program)
        assert np.array_equal(np.sort(np.diag(tensor)), np.sort(np.diag(brick.inertia)))

    def test_a_lamina_is_written_inside(self) -> None:
        rng = np.random.default_rng(3)
        disk = laminae.disk(1.0, mass=1.0)
        turned = [RigidBody(1.0, r @ disk.inertia @ r.T) for r in (rotations(rng) for _ in range(8))]
        assert not all(is_possible(body.inertia.tolist()) for body in turned)
        for body in turned:
            for program in PROGRAMS:
                (tensor,) = printed(body, program)
                assert is_possible(tensor.tolist()), program
                np.testing.assert_allclose(np.linalg.eigvalsh(tensor), [0.25, 0.25, 0.5], rtol=0, atol=1e-14)

    @pytest.mark.parametrize("program", ["mjcf", "mujoco"])
    def test_less_than_mujoco_takes_is_refused(self, program: str) -> None:
        for moment, is_taken in ((0.999e-15, False), (1.001e-15, True)):
            turned = RigidBody.from_principal(1.0, (moment, 1e-9, 1e-9)).rotated([0.6, 0.0, 0.0, 0.8])
            for body in (RigidBody.from_principal(1.0, (moment, 1e-9, 1e-9)), turned):
                if is_taken:
                    text = interop.to_text(body, program)
                    if program == "mjcf":
                        assert refused_by_mujoco(mjcf_of([text])) == ""
                    continue
                with pytest.raises(PolhodeError, match=r"smallest moment is 9.99e-16, and MuJoCo refuses"):
                    interop.to_text(body, program)
        with pytest.raises(PolhodeError, match=r"its mass is 1e-15, and MuJoCo refuses"):
            interop.to_text(RigidBody(1e-15, np.eye(3)), program)
        with pytest.raises(PolhodeError, match=r"moment is 0, and MuJoCo refuses .* up to 1e-15 kg m\^2"):
            interop.to_text(rods.rod(1.0, mass=1.0), program)
        assert refused_by_mujoco(mjcf_of(['<inertial pos="0 0 0" mass="1" diaginertia="9.99e-16 1 1"/>']))

    def test_a_rod_is_written_as_it_is(self) -> None:
        rod = rods.rod(2.0, mass=3.0)
        assert 'izz="0.0"' in interop.to_text(rod, "urdf")


class TestFix:
    PLATE = """<robot name="r"><link name="w"><inertial><mass value="1"/><inertia ixx="1" iyy="1.1" izz="1.2"
        ixy="0" ixz="0" iyz="0"/></inertial></link>
        <link name="p"><inertial><origin xyz="0 0 0" rpy="1.57 0 3.14"/><mass value="0.001"/>
        <inertia ixx="1e-6" iyy="1e-6" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="j" type="floating"><parent link="w"/><child link="p"/></joint></robot>"""

    def test_a_tensor_on_the_edge_is_told_and_moved_inside(self, tmp_path: Path) -> None:
        (tmp_path / "r.urdf").write_text(self.PLATE.format("2e-6"))
        assert refused_by_mujoco(self.PLATE.format("2e-6"))
        code, out, _ = run("check", tmp_path / "r.urdf", "--fix", tmp_path / "b.urdf", "--format", "json")
        report = json.loads(out)
        assert (code, report["count"]["good"]) == (0, 2)
        assert any("p is on the edge I1 + I2 = I3" in note for note in report["notes"])
        assert [row["from"] for row in report["changed"]] == ["its own tensor, moved inside the edge"]
        text = (tmp_path / "b.urdf").read_text()
        assert refused_by_mujoco(text) == ""
        np.testing.assert_allclose(
            report["changed"][0]["inertia"], report["changed"][0]["inertia_before"], atol=1e-20
        )
        assert "on the edge" not in run("check", tmp_path / "b.urdf")[1]

    @pytest.mark.parametrize("program", ["urdf", "mjcf", "sdf"])
    def test_a_rod_is_not_given_a_thickness(self, program: str) -> None:
        text = '<inertial pos="0 0 0" mass="3" diaginertia="1 1 0"/>'
        if program != "mjcf":
            text = interop.to_text(rods.rod(2.0, mass=3.0), program)
        around = {"urdf": urdf_of([text]), "mjcf": mjcf_of([text]), "sdf": sdf_of([text])}
        robot = parsed(around[program])
        verdicts = robots.check(robot)
        assert verdicts[-1].inside is None
        assert robots.fix(robot, verdicts) == robot.source
        says = "no extent" if program == "sdf" else "MuJoCo refuses what has no more than 1e-1"
        assert any(says in note for note in verdicts[-1].notes)

    def test_one_clear_of_it_is_left(self) -> None:
        robot = parsed(self.PLATE.format("1.9999999e-6"))
        verdicts = robots.check(robot)
        assert [verdict.inside for verdict in verdicts] == [None, None]
        assert robots.fix(robot, verdicts) == robot.source

    @pytest.mark.parametrize(("share", "is_written"), [(0.99, False), (1.01, True)])
    def test_moments_that_mujoco_refuses_are_not_written(self, share: float, is_written: bool) -> None:
        """Of a ball of 1e-9 kg, 2/5 m r² = 1e-14 at r = 5 mm; of a bar of 1e-10 kg, m l²/6 = 1e-15."""
        radius = 0.005 * share**0.5
        ball = f'<visual><geometry><sphere radius="{radius!r}"/></geometry></visual>'
        text = f"""<robot name="r"><link name="a"><inertial><mass value="1e-9"/>
            <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>{ball}</link></robot>"""
        robot = parsed(text)
        (verdict,) = robots.check(robot)
        assert verdict.verdict == "placeholder"
        assert (verdict.better is not None) == is_written
        assert (robots.fix(robot, [verdict]) != robot.source) == is_written
        assert any("MuJoCo refuses what has no more than 1e-14" in n for n in verdict.notes) != is_written
        half = 0.5 * (6e-15 / 1e-10 * share) ** 0.5
        text = mjcf_of(
            [
                '<inertial pos="0 0 0" mass="1e-10" diaginertia="1 1 1"/><geom type="box" '
                f'quat="1 2 3 4" size="{half!r} {half!r} {2.0 * half!r}"/>'
            ]
        )
        robot = parsed(text)
        (verdict,) = robots.check(robot)
        assert any("MuJoCo refuses what has no more than 1e-15" in n for n in verdict.notes) != is_written
        fixed = robots.fix(robot, [verdict])
        assert (fixed != robot.source) == is_written
        assert refused_by_mujoco(fixed.decode()) == ""

    def test_a_mass_denser_than_any_matter_is_refused(self) -> None:
        robot = parsed(urdf(bare("base"), bare("a", '<box size="0.01 0.01 0.01"/>'), joint("base", "a")))
        assert robots.check(robot, mass=0.0249)[1].better is not None
        with pytest.raises(PolhodeError, match=r"mass: 0.0251 kg .* would be 2.51e\+04 kg/m\^3"):
            robots.check(robot, mass=0.0251)
        assert robots.check(robot, density=25_000.0)[1].better is not None
        with pytest.raises(PolhodeError, match=r"density: 25001 kg/m\^3, and no matter has more than 25000"):
            robots.check(robot, density=25_001.0)

    def test_a_marker_is_never_written(self, tmp_path: Path) -> None:
        text = """<robot name="r"><link name="a"><inertial><mass value="5"/><inertia ixx="1" iyy="1" izz="1"
            ixy="0" ixz="0" iyz="0"/></inertial><visual><geometry><sphere radius="0.001"/></geometry></visual>
            </link></robot>"""
        (tmp_path / "r.urdf").write_text(text)
        code, out, _ = run("check", tmp_path / "r.urdf", "--fix", tmp_path / "b.urdf")
        assert code == 1
        assert (tmp_path / "b.urdf").read_text() == text
        assert "5 kg in its visual shapes would be 1.19e+09 kg/m^3" in out
        assert "left as they are, since no better values are known" in out
