"""``polhode validate``: cases of others on this machine; and what a report of a fault has to tell of it."""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from dataclasses import replace

import numpy as np
import polhode
import pytest
from command_line import run
from mpmath import ellipk, mp, mpf
from polhode import _core
from polhode.cli.validate import CASES, Case, validation


def test_every_case_agrees_here() -> None:
    code, out, err = run("validate")
    assert (code, err) == (0, "")
    assert out.count(" good ") == len(CASES)
    assert f"{len(CASES)} cases agree with the published values" in out
    kinds = {"NASA", "asteroid", "molecule", "CAD", "spacecraft", "orbit", "flyby", "closed form"}
    assert {case.kind for case in CASES} == kinds


def test_the_same_build_has_the_same_bits() -> None:
    told = [json.loads(run("validate", "--format", "json")[1]) for _ in range(2)]
    assert told[0]["notes"] == told[1]["notes"]
    for row in told[0]["cases"]:
        assert [float.fromhex(bits) for bits in row["bits"]] == row["found"]
        assert max(abs(np.subtract(row["found"], row["expected"]))) == row["difference"]
    assert re.search(r"all numbers: [0-9a-f]{16};", told[0]["notes"][1])


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.kind} {case.name}")
def test_a_case_that_is_off_is_bad(case: Case) -> None:
    one, ours = case, case.compute()
    size = max(map(abs, ours))
    near = replace(one, expected=tuple(x + 0.99 * one.allowed for x in ours[:1]) + ours[1:])
    far = replace(one, expected=tuple(x + 1.01 * one.allowed + 4e-16 * size for x in ours[:1]) + ours[1:])
    lost = replace(one, compute=lambda: (math.nan,) * len(ours))
    assert validation((far, one))[1] is False
    assert validation((lost,))[1] is False
    if one.allowed > 1e-14 * size:
        assert validation((near,))[1] is True


def test_a_bad_case_ends_with_1(monkeypatch: pytest.MonkeyPatch) -> None:
    from polhode.cli import validate

    bad = replace(CASES[0], allowed=0.0)
    monkeypatch.setattr(validate.validation, "__defaults__", ((bad, CASES[-1]),))
    code, out, err = run("validate")
    assert (code, err) == (1, "")
    assert " bad " in out
    assert "1 of 2 cases are bad" in out


def test_the_period_is_the_elliptic_integral() -> None:
    """What the table holds as closed form, in 30 digits by mpmath."""
    with mp.workdps(30):
        exact = float(4 * ellipk(mpf("0.04") / 3))
    assert CASES[-1].expected[0] == pytest.approx(exact, rel=4e-16)


def test_version_in_full() -> None:
    code, out, err = run("--version", "--verbose")
    assert (code, err) == (0, "")
    told = {line[:16].strip(): line[16:].strip() for line in out.splitlines()}
    level, threads = _core.machine()
    assert told["polhode"] == polhode.__version__
    assert told["instruction set"] == level
    assert told["threads"] == str(threads)
    assert f"numpy {np.__version__}" in told["libraries"]
    assert run("--verbose", "--version")[1] == out
    assert run("--version")[1] == f"polhode {polhode.__version__}\n"


@pytest.mark.parametrize("threads", [1, 3])
def test_the_machine_is_what_the_environment_says(threads: int) -> None:
    program = "from polhode import _core; print(*_core.machine())"
    environment = os.environ | {"POLHODE_NUM_THREADS": str(threads), "POLHODE_LEVEL": "baseline"}
    out = subprocess.run(
        [sys.executable, "-c", program], env=environment, check=True, capture_output=True, text=True
    )
    assert out.stdout == f"baseline {threads}\n"
