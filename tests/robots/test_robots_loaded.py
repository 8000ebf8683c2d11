"""A robot that an engine loads before ``--fix``, it loads after: a law over generated robots.

MuJoCo and Pinocchio are asked. The robots have the faults of links in public files: tensors that no body has,
placeholders, points, plates, tiny ones, mass left out; dots, markers and shapes as large as the link.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
from polhode import robots
from polhode.errors import PolhodeError
from robot_texts import joint, urdf

SUSPECTS = robots.FAILURES | {"suspect", "coarse"}


def row(values: Any) -> str:
    return " ".join(repr(float(x)) for x in values)


def drawn_moments(rng: np.random.Generator, scale: float) -> Any:
    """A tensor in its axes: of a body, or with one of the faults."""
    a, b = rng.uniform(0.1, 1.0, 2)
    kind = rng.integers(12)
    if kind < 4:
        return np.array([a, b, max(a, b)]) * scale
    if kind == 4:
        return np.array([a, b, a + b]) * scale  # a plate
    if kind == 5:
        return np.array([a, b, (a + b) * (1.0 + 10.0 ** rng.uniform(-16, -1))]) * scale
    if kind == 6:
        return np.array([a, b, 20.0 * (a + b)]) * scale
    if kind == 7:
        return np.ones(3) * rng.choice([1.0, 1e-3, 1e-6])
    if kind == 8:
        return np.zeros(3)
    if kind == 9:
        return np.array([a, b, max(a, b)]) * 10.0 ** rng.uniform(-17, -12)
    if kind == 10:
        return np.array([10.0 ** rng.uniform(-12, 0) * a, 1.0, 1.0]) * scale  # a rod
    return np.array([a, b, max(a, b)]) * scale * 10.0 ** rng.uniform(-4, 4)


def drawn_shape(rng: np.random.Generator, size: float, *, is_mjcf: bool) -> str:
    size *= rng.choice([1.0, 1.0, 1.0, 1e-3, 1e-5])
    x, y, z = rng.uniform(0.3, 1.0, 3) * size
    z *= rng.choice([1.0, 1.0, 1e-6])
    at = row(rng.normal(size=3) * size * 0.2)
    if is_mjcf:
        kind = rng.choice(["box", "sphere", "capsule"])
        return f'<geom type="{kind}" size="{row((x, y, z))}" pos="{at}"/>'
    form = rng.choice(
        [
            f'<box size="{row((x, y, z))}"/>',
            f'<sphere radius="{float(x)!r}"/>',
            f'<cylinder radius="{float(x)!r}" length="{float(z)!r}"/>',
        ]
    )
    role = rng.choice(["collision", "visual"])
    turn = row(rng.uniform(-3, 3, 3))
    return f'<{role}><origin xyz="{at}" rpy="{turn}"/><geometry>{form}</geometry></{role}>'


def drawn_robot(rng: np.random.Generator) -> str:
    """A tree of a few links, in URDF or MJCF, most of them without a fault."""
    is_mjcf = rng.random() < 0.4
    count = int(rng.integers(2, 7))
    parents = [int(rng.integers(0, i)) for i in range(1, count)]
    parts, hung = [], []
    for i in range(count):
        size, mass = 10.0 ** rng.uniform(-2.5, 0.0), 10.0 ** rng.uniform(-3, 1)
        moments = drawn_moments(rng, mass * size**2 / 6.0)
        if rng.random() < 0.5:
            moments = np.array([1.0, 1.1, 1.2]) * mass * size**2 / 6.0
        declared = rng.random() < 0.9
        at, turn = row(rng.normal(size=3) * size * 0.1), row(rng.uniform(-3, 3, 3))
        shapes = "".join(drawn_shape(rng, size, is_mjcf=is_mjcf) for _ in range(rng.integers(0, 3)))
        if is_mjcf:
            inertial = f'<inertial pos="{at}" euler="{turn}" mass="{mass!r}" diaginertia="{row(moments)}"/>'
            hung.append("" if rng.random() < 0.25 else "<joint/>")
            parts.append((inertial if declared else "") + shapes)
        else:
            xx, yy, zz = map(float, moments)
            inertial = (
                f'<inertial><origin xyz="{at}" rpy="{turn}"/><mass value="{mass!r}"/><inertia ixx="{xx!r}" '
                f'iyy="{yy!r}" izz="{zz!r}" ixy="0" ixz="0" iyz="0"/></inertial>'
            )
            parts.append(f'<link name="l{i}">{inertial if declared else ""}{shapes}</link>')
    if not is_mjcf:
        kinds = [str(rng.choice(["revolute", "revolute", "fixed", "floating", "prismatic"])) for _ in parents]
        joints = [
            joint(f"l{parent}", f"l{i}", kind, at=row(rng.normal(size=3))).replace(
                "<axis", f"<!-- {i} --><axis"
            )
            for i, (parent, kind) in enumerate(zip(parents, kinds, strict=True), 1)
        ]
        return urdf(*parts, *joints)

    def body(i: int) -> str:
        below = "".join(body(k) for k, parent in enumerate(parents, 1) if parent == i)
        return f'<body name="l{i}" pos="{row((0.1 * i, 0, 0.2))}">{hung[i]}{parts[i]}{below}</body>'

    return f"<mujoco><worldbody>{body(0)}</worldbody></mujoco>"


def is_loaded(engine: str, text: str) -> bool:
    """Whether an engine loads a robot; of Pinocchio also whether no motion is without inertia."""
    if engine == "mujoco":
        mujoco = pytest.importorskip("mujoco")
        try:
            mujoco.MjModel.from_xml_string(text)
        except ValueError:
            return False
        return True
    pinocchio = pytest.importorskip("pinocchio")
    model = pinocchio.buildModelFromXML(text)
    matrix = pinocchio.crba(model, model.createData(), pinocchio.neutral(model))
    return bool((np.diag(matrix) > 0.0).all())


def check_law(seed: int, count: int) -> Counter[str]:
    rng = np.random.default_rng(seed)
    counts: Counter[str] = Counter()
    for _ in range(count):
        text = drawn_robot(rng)
        robot = robots.parse_robot(text.encode(), name="r", folder=".")
        engines = ["mujoco"] if robot.format == "MJCF" else ["mujoco", "pinocchio"]
        before = {engine: is_loaded(engine, text) for engine in engines}
        for words, density in ((robots.FAILURES, None), (SUSPECTS, None), (robots.FAILURES, 1000.0)):
            try:
                verdicts = robots.check(robot, density=density)
            except PolhodeError as error:
                raise AssertionError(text) from error
            fixed = robots.fix(robot, verdicts, words).decode()
            for engine, was_loaded in before.items():
                is_now = is_loaded(engine, fixed)
                assert is_now or not was_loaded, f"{engine} no longer loads it:\n{text}\n{fixed}"
                if fixed != text:
                    counts[f"{engine}: {'loaded' if was_loaded else 'refused'}, then {is_now}"] += 1
    return counts


def test_what_was_loaded_is_loaded_after_the_fix() -> None:
    counts = check_law(1, 60)
    assert counts["mujoco: loaded, then True"] > 15
    assert counts["mujoco: refused, then True"] > 15
    assert counts["pinocchio: loaded, then True"] > 15


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("seed", range(2, 22))
def test_what_was_loaded_is_loaded_after_the_fix_of_many(seed: int) -> None:
    check_law(seed, 400)
