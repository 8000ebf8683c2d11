"""``polhode spin`` with sigmas: of moments, angular velocity and mass, at the start and at the end."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from command_line import run
from polhode import Uncertain
from polhode.errors import PolhodeError
from polhode.units import amounts
from uncertain_bodies import RigidBody

BRICK = ("spin", "--moments", "1.000 ± 0.002, 2.0, 2.5", "--format", "json")


def told(*arguments: str) -> Any:
    status, out, err = run(*arguments)
    assert (status, err) == (0, "")
    return json.loads(out)


class TestReports:
    def test_is_what_python_says(self) -> None:
        found = told(*BRICK, "--omega", "0.3, 0.2, 1.100(2)", "--end", "10")
        body = RigidBody.from_principal(1.0, [Uncertain(1.0, 0.002), 2.0, 2.5])
        motion = body.free_motion(Uncertain((0.3, 0.2, 1.1), (0.0, 0.0, 0.002)))
        periods, run_ = motion.periods, motion.at([0.0, 10.0])
        for key, name in (
            ("rotation_period", "rotation"),
            ("precession_period", "precession"),
        ):
            assert found[key] == pytest.approx(getattr(periods, name), rel=1e-14)
            assert found["sigma"][key] == pytest.approx(getattr(periods.sigma, name), rel=1e-6)
            assert found["linear"][key] is True
        assert "flip_period" not in found
        assert found["sigma"]["mean_precession"] == pytest.approx(periods.sigma.rates.tolist(), rel=1e-6)
        assert found["sigma"]["principal_moments"] == pytest.approx([0.002, 0.0, 0.0], abs=1e-15)
        assert found["sigma"]["omega_start"] == pytest.approx([0.0, 0.0, 0.002], abs=1e-15)
        assert found["sigma"]["omega_end"] == pytest.approx(run_.sigma.omega[-1], rel=1e-9)
        assert found["sigma"]["attitude_end"] == pytest.approx(np.degrees(run_.sigma.attitude[-1]), rel=1e-9)
        assert found["linear"]["attitude_end"] == [True] * 3

    def test_degrees_and_other_axes(self) -> None:
        plain = told(*BRICK, "--omega", "0.3, 0.2 ± 0.1, 1.1")
        degrees = told(
            *BRICK, "--degrees", "--omega", f"{np.degrees(0.3)}, {np.degrees(0.2)} ± 50 %, {np.degrees(1.1)}"
        )
        assert degrees["sigma"]["omega_start"] == pytest.approx(
            np.degrees(plain["sigma"]["omega_start"]), rel=1e-12
        )
        assert degrees["sigma"]["rotation_period"] == pytest.approx(
            plain["sigma"]["rotation_period"], rel=1e-9
        )
        turns = told(*BRICK, "--omega", "10 ± 1 deg/s, 20 deg/s, 30 deg/s")
        assert turns["sigma"]["omega_start"] == pytest.approx([np.radians(1.0), 0.0, 0.0], abs=1e-15)

    def test_tops_too(self) -> None:
        top = (
            "spin",
            "--moments",
            "2e-4, 2e-4, 3e-4",
            "--center-of-mass",
            "0 0 0.04",
            "--gravity",
            "9.81",
            "--format",
            "json",
        )
        found = told(
            *top, "--mass", "0.5", "--omega", "0, 0, 150 ± 1", "--attitude", "0 30 0 deg", "--end", "1"
        )
        assert found["sigma"]["omega_end"][2] == pytest.approx(1.0, rel=1e-9)
        assert len(found["sigma"]["attitude_end"]) == 3

    def test_without_sigma_nothing_is_said(self) -> None:
        found = told(
            "spin", "--moments", "1", "2", "2.5", "--omega", "0.3", "0.2", "1.1", "--end", "10", *BRICK[3:]
        )
        assert "sigma" not in found
        assert "linear" not in found

    def test_the_table_marks_what_is_not_linear(self) -> None:
        status, out, _ = run(
            "spin", "--moments", "1 ± 0.01, 2, 2.5", "--omega", "0.001 ± 0.001, 1, 0.001 ± 0.001"
        )
        assert status == 0
        assert "*" in out
        assert "the first order is not enough" in out


class TestAmounts:
    def test_read(self) -> None:
        one, two, three = amounts(("1 ± 0.1,", "2(1),", "3"), 3, "kg", "--mass")
        assert isinstance(one, Uncertain)
        assert isinstance(two, Uncertain)
        assert (one.sigma, two.sigma, three) == (0.1, 1.0, 3.0)
        assert amounts(("1 2 3 kg",), 3, "kg", "--mass") == [1.0, 2.0, 3.0]

    @pytest.mark.parametrize("text", ["1 ± 0.1, 2", "1 ± 0.1 2 3", "1 ± 0.1 kg, 2, 3", "1, 2, 3, 4(1)"])
    def test_refused(self, text: str) -> None:
        with pytest.raises(PolhodeError, match=r"--mass: expected 3 numbers, with commas"):
            amounts((text,), 3, "kg", "--mass")
