"""Every rule of the verdicts by a robot of its own, and what simulators say to the same robots."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from polhode import robots
from polhode.robots.verdict import Word
from robot_rules import ROWS
from three_formats import there


def test_there_is_a_robot_for_each_rule() -> None:
    assert len(ROWS) >= 60
    words = {word for row in ROWS.values() for word in row.words.values()}
    assert words == set(get_args(Word))


@pytest.mark.parametrize("name", ROWS)
def test_its_verdict_is_the_one_that_is_due(name: str) -> None:
    row = ROWS[name]
    verdicts = robots.check(robots.parse_robot(row.text.encode(), name="r", folder="."))
    assert {verdict.name: verdict.verdict for verdict in verdicts} == row.words
    assert row.says in " | ".join(verdict.reason for verdict in verdicts)


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name, row in ROWS.items() if row.singular is not None])
def test_pinocchio_finds_the_same_mass_matrices_singular(name: str) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    row = ROWS[name]
    model = pinocchio.buildModelFromXML(row.text.replace('<mesh filename="nowhere.stl"/>', ""))
    matrix = pinocchio.crba(model, model.createData(), pinocchio.neutral(model))
    full = np.triu(matrix) + np.triu(matrix, 1).T
    assert (np.linalg.matrix_rank(full) < len(full)) == row.singular


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name, row in ROWS.items() if row.refused is not None])
def test_mujoco_refuses_the_same_bodies(name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    row = ROWS[name]
    if row.refused:
        with pytest.raises(ValueError, match="mass and inertia of moving bodies"):
            mujoco.MjModel.from_xml_string(row.text)
        return
    model = mujoco.MjModel.from_xml_string(row.text)
    for verdict in robots.check(robots.parse_robot(row.text.encode(), name="r", folder=".")):
        if verdict.verdict == "inferred":
            body = model.body(verdict.name)
            np.testing.assert_allclose(there(verdict.mass), body.mass[0], rtol=1e-12)
            np.testing.assert_allclose(there(verdict.moments), np.sort(body.inertia), rtol=1e-12)
