"""``polhode roll``: what it prints beside the same motion in Python, what it saves, and how it ends."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run, write_obj
from oracles.meshes import icosphere
from page_data import data
from polhode import RigidBody, Trajectory, loads, rolling, solids

COIN = ("--surface", "disk", "--radius", "0.05", "--mass", "0.2", "--omega", 0, 2, 14, "--tilt", "57deg")
G = loads.uniform_gravity((0, 0, -9.81))


def told(*arguments: Any) -> tuple[int, dict[str, Any]]:
    code, out, err = run("roll", *arguments, "--format", "json")
    assert err == ""
    return code, json.loads(out)


def coin(t: Any, omega: Any = (0, 2, 14)) -> Trajectory:
    angle = np.deg2rad(57.0) / 2
    return solids.cylinder(0.05, 0.0, mass=0.2).simulate(
        t,
        omega,
        (np.sin(angle), 0, 0, np.cos(angle)),
        load=G,
        contact=rolling.plane(rolling.disk(0.05)),
        rtol=1e-14,
    )


def test_a_coin() -> None:
    code, found = told(*COIN, "--end", 2)
    motion: Any = coin([0.0, 2.0])
    assert code == 0
    assert found["status"] == "complete"
    np.testing.assert_allclose(found["omega_end"], motion.omega[-1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["point_end"], motion.contact.point[-1], rtol=0, atol=1e-10)
    most, least = motion.contact.largest_friction_needed, motion.contact.smallest_normal_force
    assert found["largest_friction_needed"] == pytest.approx(most.value, rel=1e-9)
    # A motion that repeats reaches it again and again.
    there: Any = coin([0.0, found["largest_friction_needed_time"]]).contact
    assert there.friction_needed[-1] == pytest.approx(most.value, rel=1e-9)
    assert found["smallest_normal_force"] == pytest.approx(least.value, rel=1e-9)
    assert found["energy_drift"] < 1e-11
    assert found["tilt_start"] == pytest.approx(57.0, rel=1e-14)
    axis = motion.rotation[-1].as_matrix()[2, 2]
    assert found["tilt_end"] == pytest.approx(np.rad2deg(np.arccos(axis)), rel=1e-9)
    assert found["energy"] == pytest.approx(motion.invariants().energy[0], rel=1e-14)


def test_a_ball_with_its_constants(tmp_path: Path) -> None:
    """A loaded ball keeps the constants of Jellett and Routh; by moments and by a saved body alike."""
    moments, center = (8e-7, 8e-7, 9e-7), (0.0, 0.0, -0.003)
    start = ("--surface", "sphere", "--radius", "2 cm", "--omega", 1, 0, 80, "--tilt", 0.3, "--end", 1)
    body = RigidBody.from_principal(0.006, moments, center_of_mass=center)
    by_moments = ("--moments", "8e-7 8e-7 9e-7", "--mass", "6 g", "--center-of-mass", "0 0 -3 mm")
    body.save(tmp_path / "top.json")
    for where in (by_moments, (tmp_path / "top.json",)):
        code, found = told(*where, *start)
        assert code == 0
        assert max(found["jellett_drift"], found["routh_drift"], found["energy_drift"]) < 1e-10
        attitude = (np.sin(0.15), 0, 0, np.cos(0.15))
        contact = rolling.plane(rolling.sphere(0.02))
        motion: Any = body.simulate([0, 1], (1, 0, 80), attitude, load=G, contact=contact, rtol=1e-14)
        assert found["jellett"] == pytest.approx(motion.invariants().jellett[0], rel=1e-13)
        np.testing.assert_allclose(found["omega_end"], motion.omega[-1], rtol=0, atol=1e-8)


def test_a_ball_on_a_slope_and_on_a_turntable() -> None:
    ball = ("--surface", "sphere", "--radius", "0.1", "--mass", 2, "--end", 2)
    _, found = told(*ball, "--omega", 0, 0, 0, "--slope", "10deg", "--gravity", 10)
    way = 5 / 7 * 10 * np.sin(np.deg2rad(10)) / 2 * 2**2
    np.testing.assert_allclose(found["point_end"], (way, 0, 0), rtol=0, atol=1e-12)
    code, found = told(*ball, "--omega", 0, 3, 0, "--turntable", "30 rpm")
    assert code == 0
    assert found["energy_drift"] < 1e-12
    np.testing.assert_allclose(found["point_end"][2], 0.0, atol=1e-15)


def test_a_ball_that_is_thrown_slips_and_then_rolls() -> None:
    ball = ("--surface", "sphere", "--radius", "0.11", "--mass", 7, "--omega", 0, 0, 0, "--end", 8)
    code, found = told(*ball, "--velocity", "8 0 0", "--friction", 0.04)
    assert code == 1  # it slips
    ((event),) = found["events"]
    assert event["kind"] == "roll"
    assert event["t"] == pytest.approx(2 * 8 / (7 * 0.04 * 9.81), abs=1e-12)
    assert found["energy_drift"] < 1e-13
    assert told(*ball, "--friction", 0.04)[0] == 0  # it stands
    done = run("roll", *ball, "--velocity", "8 0 0")
    assert done[0] == 2
    assert "--friction" in done[2]


def test_a_body_that_flies_lands() -> None:
    loaded = ("--surface", "sphere", "--radius", 1, "--mass", 1, "--moments", "0.09 0.09 0.09")
    top = (*loaded, "--center-of-mass", "0 0 0.9", "--omega", 0.5, 0, 0, "--end", 3, "--lift", "fly")
    code, found = told(*top)
    assert (code, found["status"]) == (1, "landing")
    assert [event["kind"] for event in found["events"]] == ["lift-off", "landing"]


def test_surfaces_and_their_axes() -> None:
    """An ellipsoid of equal semi-axes and a sphere; a disk about y and one about z."""
    same = ("--mass", 1, "--omega", 0.3, 1, 2, "--end", 1)
    one = told("--surface", "sphere", "--radius", 0.2, *same)[1]
    other = told("--surface", "ellipsoid", "--semi-axes", "0.2 0.2 0.2", *same)[1]
    np.testing.assert_allclose(one["point_end"], other["point_end"], atol=1e-12)
    plain = ("--mass", 1, "--omega", 0, 0, 6, "--end", 1, "--surface", "disk", "--radius", 0.2)
    about_z = told(*plain, "--moments", "0.01 0.01 0.02", "--attitude", "0 90 0 deg")[1]
    turned = ("--omega", 0, -6, 0, "--moments", "0.01 0.02 0.01", "--axis", "0 1 0", "--attitude", "0 0 0")
    about_y = told(*(x for x in (*plain[:2], *turned, *plain[6:])))[1]
    np.testing.assert_allclose(about_z["point_end"], about_y["point_end"], atol=1e-12)
    code, _ = told("--surface", "torus", "--major-radius", 0.2, "--minor-radius", 0.05, *same, "--tilt", 1)
    assert code == 0
    boat = ("--surface", "paraboloid", "--radii", "0.5 0.3", "--apex", 0.1, "--moments", "0.01 0.02 0.02")
    assert told(*boat, "--mass", 1, "--center-of-mass", "0 0 -0.05", "--omega", 0.2, 0, 0, "--end", 1)[0] == 0


def test_a_lost_contact_ends_with_1(tmp_path: Path) -> None:
    """A ball loaded at its rim is thrown off; a disk falls flat; the plane may hold the first."""
    loaded = ("--surface", "sphere", "--radius", 1, "--mass", 1, "--moments", "0.09 0.09 0.09")
    top = (*loaded, "--center-of-mass", "0 0 0.9", "--omega", 0.5, 0, 0, "--end", 3)
    code, found = told(*top, "--save", tmp_path / "up.csv", "--save", tmp_path / "up.html")
    assert (code, found["status"]) == (1, "lift-off")
    ((event),) = found["events"]
    assert event["kind"] == "lift-off"
    assert found["time"] == event["t"] < 3
    assert data(tmp_path / "up.html")["t"][-1] == pytest.approx(event["t"], rel=1e-8)
    code, found = told(*top, "--lift", "hold")
    assert (code, found["status"]) == (0, "complete")
    assert found["events"][0]["t"] == pytest.approx(event["t"], rel=1e-12)
    code, found = told(*COIN[:6], "--omega", 0, 0, 0, "--tilt", "5deg", "--end", 3)
    assert code == 1
    assert any("lies flat" in note for note in found["notes"])
    assert found["time"] < 0.04


def test_a_mesh_that_rolls(tmp_path: Path) -> None:
    """The inertia of a file; its surface is told, and may stand elsewhere."""
    path = write_obj(tmp_path / "ball.obj", *(np.array(x) for x in icosphere(3)))
    where = ("--length-unit", "cm", "--mass", 0.1, "--surface", "sphere", "--radius", "1 cm")
    code, found = told(path, *where, "--omega", 0, 3, 0, "--end", 1)
    assert code == 0
    assert found["point_end"][0] == pytest.approx(0.03, rel=1e-3)


def test_what_is_saved(tmp_path: Path) -> None:
    names = ("coin.html", "coin.png", "coin.csv", "coin.npz")
    saves = [part for name in names for part in ("--save", tmp_path / name)]
    code, found = told(*COIN, "--end", 0.3, "--times", 7, *saves)
    assert code == 0
    assert all((tmp_path / name).stat().st_size > 500 for name in names)
    assert len(Trajectory.from_file(tmp_path / "coin.npz")) == 7
    assert [note for note in found["notes"] if note.startswith("saved ")] == [
        f"saved {tmp_path / name}" for name in names
    ]
    page = data(tmp_path / "coin.html")
    assert page["ground"]["normal"] == [0, 0, 1]
    assert np.diff(page["t"]).max() * np.linalg.norm(page["omega"], axis=1).max() < np.deg2rad(30)


def test_the_table_is_for_people() -> None:
    code, out, err = run("roll", *COIN, "--end", 1)
    assert (code, err) == (0, "")
    for words in ("friction needed", "none up to 1 s", "thin disk", "largest drift"):
        assert words in out
    assert max(map(len, out.splitlines())) <= 120
