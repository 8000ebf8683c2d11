"""What a newcomer guesses before reading the interface: it works, or the message holds the right call."""

from __future__ import annotations

import builtins
import shlex
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import polhode
import pytest
from command_line import one_line, run
from oracles.meshes import cube
from polhode import RigidBody, loads, solids

GUESSES: list[dict[str, str]] = tomllib.loads(
    Path(__file__).with_name("first_guesses.toml").read_text(encoding="utf-8")
)["guess"]
ENOUGH = 0.9
ROBOT = """<robot name="arm"><link name="hand"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
MODEL = """<mujoco><worldbody><body><freejoint/>
<geom type="box" size=".1 .2 .3" density="1000"/></body></worldbody></mujoco>"""


class Names(dict[str, Any]):
    """The names of a session, beside which the package is asked for any other name."""

    def __missing__(self, name: str) -> Any:
        if hasattr(builtins, name):
            raise KeyError(name)
        return getattr(polhode, name)


@pytest.fixture
def names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Names:
    """Return what the guesses name, and stand in a folder with the files that they name."""
    pytest.importorskip("trimesh").creation.box((20, 30, 40)).export(tmp_path / "part.stl")
    (tmp_path / "robot.urdf").write_text(ROBOT)
    (tmp_path / "model.xml").write_text(MODEL)
    monkeypatch.chdir(tmp_path)
    body = solids.box((1, 2, 3), mass=2.0)
    vertices, faces = cube(2.0)
    return Names(
        np=np,
        Rotation=pytest.importorskip("scipy.spatial.transform").Rotation,
        loads=loads,
        solids=solids,
        RigidBody=RigidBody,
        body=body,
        other=solids.sphere(1.0, mass=1.0),
        run=body.simulate(np.linspace(0, 10, 101), (0.01, 5, 0)),
        path="part.stl",
        points=np.eye(3),
        masses=np.ones(3),
        mesh=SimpleNamespace(vertices=vertices, faces=faces),
        I=np.diag([1.0, 2.0, 2.5]),
    )


def _message(guess: dict[str, str], names: Names) -> str | None:
    """Try a guess, and return the message of its error; None if it works."""
    if guess["kind"] == "command":
        code, _, error = run(*shlex.split(guess["guess"])[1:])
        assert code < 2 or one_line(error), error
        return error if code > 1 else None
    try:
        eval(guess["guess"], {}, names)
    except Exception as error:
        return str(error)
    return None


def test_first_guesses_work_or_lead_to_the_right_call(names: Names) -> None:
    messages = [_message(guess, names) for guess in GUESSES]
    missed = [
        f"{guess['guess']}: {message}"
        for guess, message in zip(GUESSES, messages, strict=True)
        if message is not None and (not guess["answer"] or guess["answer"] not in message)
    ]
    assert len(missed) <= (1.0 - ENOUGH) * len(GUESSES), "\n".join(missed)


@pytest.mark.parametrize(
    "call",
    [one["answer"] for one in GUESSES if one["answer"].startswith("polhode ") and one["kind"] == "command"],
)
def test_commands_that_are_answers_run(call: str, names: Names) -> None:
    words = {"UNIT": "mm", "MASS": "2", "TIME": "1", "REPORT.json": "report.json"}
    if "REPORT.json" in call:
        assert run("report", names["path"], "--output", words["REPORT.json"])[0] == 0
    code, _, error = run(*[words.get(word, word) for word in shlex.split(call)[1:]])
    assert code == 0, error
