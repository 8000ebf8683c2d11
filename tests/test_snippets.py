"""What is written for other programs: read by our readers and by the programs, and against a printout."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from polhode import RigidBody, interop, solids
from polhode.errors import PolhodeError
from polhode.interop.programs import PROGRAMS
from polhode.robots import parse_robot

AROUND = {
    "urdf": '<robot name="r"><link name="a">{}</link></robot>',
    "sdf": '<sdf version="1.9"><model name="m"><link name="a">{}</link></model></sdf>',
    "mjcf": '<mujoco><worldbody><body name="a"><freejoint/>{}</body></worldbody></mujoco>',
}


def bodies() -> list[RigidBody]:
    rng = np.random.default_rng(2026)
    found = []
    for _ in range(12):
        q = rng.normal(size=4)
        scale = 10.0 ** rng.uniform(-6, 6)
        brick = solids.box(rng.uniform(0.3, 1.0, 3) * scale, mass=rng.uniform(0.1, 1.0) * scale**2)
        found.append(brick.rotated(q / np.linalg.norm(q)).translated(rng.normal(size=3) * scale))
    return found


def numbers(text: str) -> list[float]:
    return [float(x) for x in re.findall(r"-?\d+\.?\d*(?:e[+-]?\d+)?", text)]


def tensor(six: Any) -> np.ndarray[Any, Any]:
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@pytest.mark.parametrize("program", AROUND)
def test_our_reader_gives_the_same_bits(program: str) -> None:
    for body in bodies():
        if program == "mjcf" and body.principal_moments[0] <= 1e-15:
            continue  # refused, see TestTheEdge
        text = AROUND[program].format(interop.to_text(body, program)).encode()
        robot = parse_robot(text, name="a", folder=Path())
        inertial = robot.links[0].inertial
        assert inertial is not None
        assert inertial.mass == body.mass
        assert np.array_equal(inertial.center_of_mass, body.center_of_mass)
        if program == "mjcf" and body.principal_moments[0] < 1e-6:  # in principal axes
            np.testing.assert_allclose(
                inertial.inertia, body.inertia, rtol=0, atol=1e-15 * body.principal_moments[2]
            )
            continue
        assert np.array_equal(inertial.inertia, body.inertia)


def test_products_of_two_particles() -> None:
    # Two particles of mass 1 at ±(1, 1, 0): the product of inertia is +2, the element of the tensor -2.
    pair = RigidBody(2.0, [(2.0, -2.0, 0.0), (-2.0, 2.0, 0.0), (0.0, 0.0, 4.0)])
    assert np.allclose(pair.inertia, RigidBody.from_particles([1, 1], [(1, 1, 0), (-1, -1, 0)]).inertia)
    signs = {"adams": "2.0", "solidworks": "2.0"}
    places = {
        "adams": r"IP=2.0, 2.0, 4.0, (\S+), 0.0, 0.0",
        "solidworks": r"Lxy = (\S+)",
        "drake": r"Ixy=(\S+),",
        "simulink": r"Products of Inertia: \[0.0, 0.0, (\S+)\]",
        "pinocchio": r"\[\[2.0, (\S+), 0.0\]",
        "onshape": r'"inertia": \[\s+2.0, (\S+), 0.0,',
        "matlab": r"Inertia = \[2.0, 2.0, 4.0, 0.0, 0.0, (\S+)\];",
    }
    for program, place in places.items():
        found = re.search(place, interop.to_text(pair, program))
        assert found is not None
        assert found[1] == signs.get(program, "-2.0")


def test_lines_of_each_program_hold_the_body() -> None:
    for body in bodies():
        m, c = float(body.mass), body.center_of_mass
        simulink = [
            numbers(line.partition(":")[2].replace("m^2", ""))
            for line in interop.to_text(body, "simulink").split("\n")[1:]
        ]
        assert simulink[0] == [m]
        assert np.array_equal(simulink[1], c)
        yz, zx, xy = simulink[3]
        assert np.array_equal(tensor([*simulink[2], xy, zx, yz]), body.inertia)
        part, marker = interop.to_text(body, "adams").split("\n")
        xx, yy, zz, xy, xz, yz = numbers(part.partition("IP=")[2])
        assert np.array_equal(tensor((xx, yy, zz, -xy, -xz, -yz)), body.inertia)
        assert np.array_equal(numbers(marker.partition("QP=")[2]), c)
        onshape = json.loads(interop.to_text(body, "onshape"))
        assert [*onshape["mass"], *onshape["centroid"]] == [m, *c]
        assert np.array_equal(np.reshape(onshape["inertia"], (3, 3)), body.inertia)
        made, *matlab = interop.to_text(body, "matlab").split("\n")
        assert made == 'body = rigidBody("body");'
        assert [numbers(line) for line in matlab[:2]] == [[m], c.tolist()]
        xx, yy, zz, yz, xz, xy = numbers(matlab[2])  # about the origin of its frame
        assert np.array_equal(tensor((xx, yy, zz, xy, xz, yz)), body.inertia_about("origin"))
        text = interop.to_text(body, "pybullet")
        x, y, z, w = numbers(text.partition("Orientation=")[2].partition("]")[0])
        R = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        moments = numbers(text.partition("Diagonal=")[2])
        assert np.allclose(R @ np.diag(moments) @ R.T, body.inertia, rtol=0, atol=3e-15 * max(moments))


# A printout of SolidWorks, of a part named "shellwing": mass in pounds, lengths in feet.
MASS, CENTER = 1.51653435, (-0.45582142, 0.92780847, 0.0)
AXES = [[-0.17069455, 0.98532399, 0.0], [-0.98532399, -0.17069455, 0.0], [0.0, 0.0, 1.0]]
MOMENTS = (0.16112601, 0.51386477, 0.66303218)
OWN = (0.50358715, 0.17140362, 0.66303218, -0.05932693, 0.0, 0.0)
AT_ORIGIN = (1.80906323, 0.48649877, 2.28360341, -0.70069202, 0.0, 0.0)


class TestSolidWorks:
    @pytest.mark.parametrize(("six", "about"), [(OWN, "center_of_mass"), (AT_ORIGIN, "origin")])
    def test_a_printout_in_positive_notation(self, six: Any, about: str) -> None:
        body = interop.from_printout(MASS, CENTER, six, products="positive", about=about)
        assert np.allclose(body.principal_moments, MOMENTS, rtol=0, atol=4e-8)
        # The axes are rows; with the other sign they would be turned the other way.
        across = body.inertia @ np.array(AXES).T - np.array(AXES).T * MOMENTS
        assert np.abs(across).max() < 4e-8
        wrong = interop.from_printout(MASS, CENTER, OWN, products="negative")
        assert np.abs(wrong.inertia @ np.array(AXES).T - np.array(AXES).T * MOMENTS).max() > 0.1
        xx, yy, zz, xy, xz, yz = AT_ORIGIN
        assert np.allclose(body.inertia_about("origin"), tensor((xx, yy, zz, -xy, -xz, -yz)), atol=4e-8)

    def test_ours_is_such_a_printout(self) -> None:
        body = interop.from_printout(MASS, CENTER, OWN, products="positive")
        text = interop.to_text(body, "solidworks")
        rows = {letter: re.findall(rf"{letter}[xyz]{{2}} = (\S+)", text) for letter in "LI"}
        for letter, six in (("L", OWN), ("I", AT_ORIGIN)):
            found = np.array(rows[letter], float).reshape(3, 3)
            assert np.allclose(found, tensor(six), rtol=0, atol=4e-8)
        axes = np.array([numbers(line) for line in re.findall(r"I[xyz] = \((.*?)\)", text)])
        assert np.allclose(np.abs(np.sum(axes * AXES, axis=1)), 1.0, atol=1e-7)
        assert np.linalg.det(axes) == pytest.approx(1.0)
        assert np.allclose([float(x) for x in re.findall(r"P[xyz] = (\S+)", text)], MOMENTS, atol=4e-8)


def test_onshape_and_the_shape_it_was_asked_about() -> None:
    # Rhoban/onshape-to-robot-examples at a0f8b921, 2wheels_urdf: what Onshape's interface said of the part
    # "body", mass and tensor, in the part's axes; and assets/body.stl of that mass, by trimesh, in the same.
    told = (2.06023e-3, 1.50691e-3, 2.54354e-3, 4.48497e-10, 6.47006e-11, -2.87610e-4)
    shape = (2.059526353e-3, 1.506772201e-3, 2.542976451e-3, 0.0, 0.0, -2.873031616e-4)
    body = interop.from_printout(2.23874, (0.0375, 0.0253843, 0.0225241), told, products="negative")
    assert np.allclose(body.inertia, tensor(shape), rtol=2e-3, atol=1e-9)
    found = json.loads(interop.to_text(body, "onshape"))["inertia"]
    assert np.allclose(np.reshape(found, (3, 3)), tensor(told), rtol=1e-15)
    other = interop.from_printout(2.23874, (0.0375, 0.0253843, 0.0225241), told, products="positive")
    assert np.abs(other.inertia - tensor(shape)).max() > 5e-4


@pytest.mark.long
class TestThePrograms:
    """Needs mujoco and pin; without them these are skipped."""

    def test_mujoco_reads_the_element(self) -> None:
        mujoco = pytest.importorskip("mujoco")
        for body in bodies():
            scale = body.mass**-0.5  # what is small counts as nothing in MuJoCo
            body = body.scaled(
                length=scale / body.radii_of_gyration.max() * body.mass**0.5, mass=1 / body.mass
            )
            model = mujoco.MjModel.from_xml_string(AROUND["mjcf"].format(interop.to_text(body, "mjcf")))
            self.check_mujoco(model, body)
            spec = mujoco.MjSpec()
            scope = {"body": spec.worldbody.add_body()}
            scope["body"].add_freejoint()
            exec(interop.to_text(body, "mujoco"), scope)
            self.check_mujoco(spec.compile(), body)

    def check_mujoco(self, model: Any, body: RigidBody) -> None:
        w, x, y, z = model.body_iquat[1]
        turned = RigidBody(1.0, np.diag(model.body_inertia[1])).rotated([x, y, z, w])
        assert model.body_mass[1] == pytest.approx(body.mass, rel=1e-15)
        assert np.allclose(model.body_ipos[1], body.center_of_mass, rtol=1e-15)
        assert np.allclose(turned.inertia, body.inertia, rtol=0, atol=1e-10 * body.principal_moments[2])

    def test_pinocchio(self) -> None:
        pinocchio = pytest.importorskip("pinocchio")
        for body in bodies():
            text = AROUND["urdf"].format(interop.to_text(body, "urdf"))
            read = pinocchio.buildModelFromXML(text, pinocchio.JointModelFreeFlyer()).inertias[1]
            scope: dict[str, Any] = {}
            exec(interop.to_text(body, "pinocchio"), scope)
            for inertia in (read, scope["inertia"]):
                assert inertia.mass == body.mass
                assert np.allclose(inertia.lever, body.center_of_mass, rtol=1e-15)
                assert np.allclose(
                    inertia.inertia, body.inertia, rtol=0, atol=1e-15 * body.principal_moments[2]
                )


class TestCommand:
    WORDS = ("--mass", "2", "--com", "0 0 0.1", "--inertia", "3 4 5 0.5 0 0", "--products", "positive")

    @pytest.mark.parametrize("program", PROGRAMS)
    def test_it_prints_the_lines_alone(self, program: str, tmp_path: Path) -> None:
        body = RigidBody(2.0, [(3.0, -0.5, 0), (-0.5, 4.0, 0), (0, 0, 5.0)], (0, 0, 0.1))
        code, out, err = run("report", *self.WORDS, "--as", program)
        assert (code, out) == (0, interop.to_text(body, program) + "\n")
        assert err.splitlines() == [
            f"polhode: note: {option} has no unit: {unit} was taken"
            for option, unit in (("--mass", "kg"), ("--center-of-mass", "m"), ("--inertia", "kg m^2"))
        ]
        path = tmp_path / "x.json"
        assert run("report", *self.WORDS, "--as", program, "--output", path)[:2] == (0, "")
        assert path.read_text() == interop.to_text(body, program) + "\n"

    def test_refused(self, tmp_path: Path) -> None:
        rows: list[tuple[tuple[str, ...], str]] = [
            (("--format", "json"), "--format: --as prints"),
            (("--about", "0 0 1"), "--about: --as prints"),
            (("--mass-unit", "lb"), "--mass-unit: --as prints"),
            (("--expect", "x.json"), "--expect: --as prints"),
        ]
        for words, says in rows:
            code, out, err = run("report", *self.WORDS, "--as", "urdf", *words)
            assert (code, out) == (2, "")
            assert one_line(err)
            assert says in err
        solids.box((1, 2, 3), mass=1.0).save(tmp_path / "b.json")
        code, _, err = run("report", tmp_path / "b.json", "--as", "urdf")
        assert code == 2
        assert "state --length-unit" in err

    def test_python_refuses(self) -> None:
        with pytest.raises(PolhodeError, match="there is no form for 'catia'; give one of urdf"):
            interop.to_text(bodies()[0], "catia")
        with pytest.raises(PolhodeError, match="expected one body, got a stack of shape"):
            interop.to_text(RigidBody.stack(bodies()), "urdf")
        flat = solids.box((1, 0, 0), mass=1.0)
        for program in ("mjcf", "mujoco"):
            with pytest.raises(PolhodeError, match="give it a thickness"):
                interop.to_text(flat, program)
        assert "<inertial>" in interop.to_text(flat, "urdf")
