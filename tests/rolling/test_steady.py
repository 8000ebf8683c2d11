"""Steady motions of rolling bodies: closed forms of textbooks, and simulations from a little beside."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from polhode import RigidBody, loads, rods, rolling, solids
from polhode.errors import PolhodeError

GRAVITY = (0.0, 0.0, -9.81)
RADIUS = 0.4
FLAT = rolling.disk(RADIUS)
DISK, HOOP = solids.cylinder(RADIUS, 0.0, mass=2.0), rods.ring(RADIUS, mass=2.0)
CRITICAL = [
    (DISK, "rolling", 1 / 3),
    (DISK, "spinning", 4 / 5),
    (HOOP, "rolling", 1 / 4),
    (HOOP, "spinning", 2 / 3),
]


@pytest.mark.parametrize(("body", "motion", "factor"), CRITICAL)
def test_critical_rates_of_disk_and_hoop(body: RigidBody, motion: Any, factor: float) -> None:
    found = rolling.critical_rate(body, FLAT, GRAVITY, motion)
    assert found == pytest.approx(np.sqrt(factor * 9.81 / RADIUS), rel=1e-13)


@pytest.mark.parametrize(("body", "motion", "factor"), CRITICAL)
def test_simulations_beside_the_critical_rates(body: RigidBody, motion: str, factor: float) -> None:
    """A change of 1e-6 stays small at 1.1 of the rate, and grows at 0.9."""
    critical = np.sqrt(factor * 9.81 / RADIUS)
    load, contact = loads.uniform_gravity(GRAVITY), rolling.plane(FLAT, lift="hold")
    upright = np.array([np.sin(np.pi / 4), 0, 0, np.cos(np.pi / 4)])  # z of the body along −y of space
    grown = []
    for part in (1.1, 0.9):
        rate = part * critical
        omega = np.array((1e-6, 0, rate) if motion == "rolling" else (1e-6, rate, 0))
        run = body.simulate(np.linspace(0, 6, 61), omega, upright, load=load, contact=contact, rtol=1e-13)
        axis = run.rotation.apply((0, 0, 1))
        grown.append(np.max(np.abs(axis[:, 2])))
    assert grown[0] < 1e-5
    assert grown[1] > 20 * grown[0]


def test_a_circle_is_the_one_that_a_simulation_goes_round() -> None:
    body, surface = solids.cylinder(0.4, 0.2, mass=2.0), rolling.torus(0.4, 0.1)
    (one,) = rolling.steady(body, surface, inclination=1.2, gravity=GRAVITY, turn=2.5)
    run = body.simulate(
        np.linspace(0, 10, 101),
        one.omega,
        one.quaternion,
        load=loads.uniform_gravity(GRAVITY),
        contact=rolling.plane(surface),
        rtol=1e-14,
    )
    assert run.contact is not None
    assert np.ptp(run.position[:, 2]) < 1e-11
    assert run.contact.friction_needed == pytest.approx(one.friction_needed, rel=1e-9)
    center = run.contact.point.mean(axis=0)
    t = 2.5 * np.linspace(0, 10, 101)
    around = (run.contact.point[:, 0] + 1j * run.contact.point[:, 1]) * 1.0
    design = np.stack([np.ones(101), np.exp(1j * t)], axis=1)
    (_, circle), *_ = np.linalg.lstsq(design, around, rcond=None)
    assert abs(circle) == pytest.approx(one.radius, rel=1e-9), center
    both = rolling.steady(body, surface, inclination=1.2, gravity=GRAVITY, spin=one.spin)
    assert len(both) == 2
    assert min(abs(found.turn - 2.5) for found in both) < 1e-11


def test_small_changes_of_a_circle_have_its_eigenvalues() -> None:
    (one,) = rolling.steady(DISK, FLAT, inclination=1.3, gravity=GRAVITY, turn=4.0)
    assert one.stable
    assert one.eigenvalues.real == pytest.approx([0.0, 0.0])
    frequency = abs(one.eigenvalues[0].imag)
    period = 2 * np.pi / frequency
    t = np.linspace(0, 4 * period, 401)
    across = np.cross(one.omega, (0, 0, 1))
    across /= np.linalg.norm(across)
    run = DISK.simulate(
        t,
        one.omega + 1e-6 * across,
        one.quaternion,
        load=loads.uniform_gravity(GRAVITY),
        contact=rolling.plane(FLAT),
        rtol=1e-14,
    )
    height = run.position[:, 2] - run.position[0, 2]
    design = np.stack([np.ones(401), np.cos(frequency * t), np.sin(frequency * t)], axis=1)
    found, *_ = np.linalg.lstsq(design, height, rcond=None)
    assert np.max(np.abs(design @ found - height)) < 1e-4 * np.max(np.abs(height))


def test_the_rattleback_of_kane_and_levinson() -> None:
    """Of the body of Kane and Levinson (1982): at the other sense the signs of the growth rates change."""
    tensor = [[2e-4, 2e-5, 0], [2e-5, 1.6e-3, 0], [0, 0, 1.7e-3]]
    celt = RigidBody(1.0, inertia=tensor, center_of_mass=(0, 0, -0.01))
    surface = rolling.ellipsoid((0.2, 0.03, 0.02))
    there = rolling.preferred_sense(celt, surface, GRAVITY, rate=5.0)
    back = rolling.preferred_sense(celt, surface, GRAVITY, rate=-5.0)
    assert np.allclose(there.growth_rates, -back.growth_rates, rtol=1e-9)
    assert np.allclose(there.frequencies, back.frequencies, rtol=1e-12)
    assert there.sense == back.sense != 0
    # A ball prefers no sense.
    other = rolling.preferred_sense(
        RigidBody(1.0, inertia=np.diag([2e-4, 1.6e-3, 1.7e-3]), center_of_mass=(0, 0, -0.01)),
        surface,
        rate=5.0,
    )
    assert other.sense == 0.0


def test_modes_are_those_of_a_simulation() -> None:
    """The growth of a tapped rattleback over two seconds, against the growth rate."""
    tensor = [[2e-4, 2e-5, 0], [2e-5, 1.6e-3, 0], [0, 0, 1.7e-3]]
    celt = RigidBody(1.0, inertia=tensor, center_of_mass=(0, 0, -0.01))
    surface = rolling.ellipsoid((0.2, 0.03, 0.02))
    modes = rolling.preferred_sense(celt, surface, GRAVITY, rate=5.0)
    load, contact = loads.uniform_gravity(GRAVITY), rolling.plane(surface)
    t = np.linspace(0, 2, 2001)
    run = celt.simulate(t, (1e-6, 1e-6, 5.0), load=load, contact=contact, rtol=1e-13)
    basis = []
    for growth, frequency in zip(modes.growth_rates, modes.frequencies, strict=True):
        rate = growth + 1j * frequency
        basis += [np.exp(rate * t).real, np.exp(rate * t).imag]
    design = np.stack(basis, axis=1)
    for component in (0, 1):
        fit, *_ = np.linalg.lstsq(design, run.omega[:, component], rcond=None)
        off = np.max(np.abs(design @ fit - run.omega[:, component]))
        assert off < 1e-3 * np.max(np.abs(run.omega[:, component]))


def energy(u: Any, jellett: float, top: RigidBody, radius: float, below: float) -> Any:
    across, _, along = top.inertia.diagonal()
    stiffness = across * radius**2 * (1 - u * u) + along * (radius * u - below) ** 2
    return jellett**2 / (2 * stiffness) + top.mass * 9.81 * (radius - below * u)


@pytest.mark.parametrize("ratio", [0.8, 0.95, 1.05, 1.2])
@pytest.mark.parametrize("below", [0.002, 0.004, 0.006])
@pytest.mark.parametrize("spin", [2.0, 20.0, 60.0, 250.0])
def test_tippe_tops_end_at_a_minimum_of_the_energy(ratio: float, below: float, spin: float) -> None:
    """48 tops: the verdict against the energy on a fine grid, downhill from upright."""
    radius = 0.02
    top = RigidBody.from_principal(0.006, (8e-7, 8e-7, 8e-7 * ratio), center_of_mass=(0, 0, -below))
    found = rolling.tippe_top(top, rolling.sphere(radius), spin, GRAVITY)
    u = np.cos(np.linspace(0, np.pi, 20001))
    levels = energy(u, found.jellett, top, radius, below)
    stops = np.flatnonzero(np.diff(levels) > 1e-15 * np.abs(levels[:-1]))
    end = u[stops[0]] if stops.size else -1.0
    assert found.cos_theta == pytest.approx(end, abs=2e-3)
    verdicts = {True: "tumbles", False: "inverts" if end < 0 else "stays upright"}
    assert found.verdict == verdicts[bool(-1 < found.cos_theta < 1)]
    if found.verdict == "stays upright":
        assert spin <= found.upright_unstable_beyond * (1 + 1e-9)
    else:
        assert spin > found.upright_unstable_beyond * (1 - 1e-9)


def growth_of_vertical_spin(side: int, spin: float, top: RigidBody, radius: float, below: float) -> float:
    """Return the largest growth rate of a spin upright (1) or inverted (−1), with a friction −κ (slip).

    To first order in the horizontal part ε = k_x + i k_y of the axis, with the horizontal velocity V of C,
    the spin s ω about the vertical, r from C to the contact and N = m g:

        s i I_t ε̈ + I_s ω ε̇ = −i N b ε + i r_z F,   m V̇ = F,   F = −κ [V − i r_z (s i ε̇ + ω ε) + i s ω b ε].
    """
    across, _, along = top.inertia.diagonal()
    mass, weight, viscous, s = top.mass, top.mass * 9.81, 0.3 * top.mass, side
    arm, rate = below * s - radius, s * spin
    # F of (ε, ε̇, V), then ε̈ and V̇.
    force = -viscous * np.array([-1j * arm * rate + 1j * s * rate * below, arm * s, 1.0])
    turn = np.array([-1j * weight * below, -along * rate, 0]) + 1j * arm * force
    matrix = np.array([[0, 1, 0], turn / (1j * s * across), force / mass])
    return float(np.max(np.linalg.eigvals(matrix).real))


@pytest.mark.parametrize("ratio", [0.8, 0.95, 1.05, 1.2])
@pytest.mark.parametrize("below", [0.002, 0.004, 0.006])
@pytest.mark.parametrize("spin", [2.0, 20.0, 60.0, 250.0])
def test_eigenvalues_of_both_vertical_spins_agree_with_the_verdict(
    ratio: float, below: float, spin: float
) -> None:
    radius = 0.02
    top = RigidBody.from_principal(0.006, (8e-7, 8e-7, 8e-7 * ratio), center_of_mass=(0, 0, -below))
    found = rolling.tippe_top(top, rolling.sphere(radius), spin, GRAVITY)
    inverted_spin = spin * (radius - below) / (radius + below)
    upright = growth_of_vertical_spin(1, spin, top, radius, below)
    inverted = growth_of_vertical_spin(-1, inverted_spin, top, radius, below)
    grows = {"inverts": (True, False), "tumbles": (True, True), "stays upright": (False, None)}
    is_upright_unstable, is_inverted_unstable = grows[found.verdict]
    assert (upright > 0) == is_upright_unstable
    assert is_inverted_unstable in (None, inverted > 0)
    # Both sides of the critical spins.
    for side, critical in ((1, found.upright_unstable_beyond), (-1, found.inverted_stable_beyond)):
        for factor in (0.999, 1.001):
            if 0 < critical < np.inf:
                grown = growth_of_vertical_spin(side, factor * critical, top, radius, below) > 0
                assert grown == ((factor > 1) == (side == 1))
            else:
                assert (growth_of_vertical_spin(side, 1e4, top, radius, below) > 0) == (
                    side == -1 or critical == 0
                )


def simulated_end(ratio: float, below: float, spin: float, end: float) -> tuple[float, float]:
    """Return the cosine of the inclination at which a tippe top with friction ends, and of its verdict."""
    top = RigidBody.from_principal(0.006, (8e-7, 8e-7, 8e-7 * ratio), center_of_mass=(0, 0, -below))
    surface = rolling.sphere(0.02)
    # Much friction on a fast slip has no unique force. Tops that nearly roll turn over slowly.
    viscous = 1.0 if spin < 100.0 else 0.05
    contact = rolling.plane(surface, law="sliding", viscous=("normal", viscous), lift="hold")
    load, tilted = loads.uniform_gravity(GRAVITY), (np.sin(0.01), 0, 0, np.cos(0.01))
    found = top.simulate([0, end], (0, 0, spin), tilted, load=load, contact=contact, rtol=1e-10)
    x, y = found.quaternion[-1][:2]
    return float(1 - 2 * (x * x + y * y)), rolling.tippe_top(top, surface, spin, GRAVITY).cos_theta


@pytest.mark.parametrize(
    ("ratio", "below", "spin"),
    [(1.05, 0.004, 60.0), (0.95, 0.004, 2.0), (1.2, 0.006, 60.0), (0.95, 0.002, 60.0)],
)
def test_tippe_tops_with_friction_end_as_their_verdict_says(ratio: float, below: float, spin: float) -> None:
    found, verdict = simulated_end(ratio, below, spin, 40.0)
    assert found == pytest.approx(verdict, abs=0.01)


@pytest.mark.long
@pytest.mark.parametrize("ratio", [0.8, 0.95, 1.05, 1.2])
@pytest.mark.parametrize("below", [0.002, 0.004, 0.006])
@pytest.mark.parametrize("spin", [2.0, 20.0, 60.0, 250.0])
def test_48_tippe_tops_end_as_their_verdict_says(ratio: float, below: float, spin: float) -> None:
    found, verdict = simulated_end(ratio, below, spin, 1e5 / spin)
    assert found == pytest.approx(verdict, abs=0.01)


def test_what_is_refused() -> None:
    brick = solids.box((1, 2, 3), mass=1.0)
    with pytest.raises(PolhodeError, match="surface of revolution"):
        rolling.steady(brick, rolling.ellipsoid((1, 2, 3)), inclination=1.0, turn=1.0)
    with pytest.raises(PolhodeError, match="two moments across the axis"):
        rolling.steady(brick, FLAT, inclination=1.0, turn=1.0)
    with pytest.raises(TypeError, match="exactly one of turn= and spin="):
        rolling.steady(DISK, FLAT, inclination=1.0)
    with pytest.raises(PolhodeError, match="inclination must be between 0 and pi"):
        rolling.steady(DISK, FLAT, inclination=0.0, turn=1.0)
    with pytest.raises(PolhodeError, match="the surface of a sphere"):
        rolling.tippe_top(DISK, FLAT, 1.0)
    with pytest.raises(PolhodeError, match="off its centre"):
        rolling.tippe_top(solids.sphere(0.5, mass=1.0), rolling.sphere(0.5), 1.0)
    with pytest.raises(PolhodeError, match="must be steady"):
        rolling.preferred_sense(solids.sphere(0.5, mass=1.0), rolling.sphere(0.5, (0.1, 0, 0)), rate=1.0)
    flying: Any = "flying"
    with pytest.raises(ValueError, match="motion: expected"):
        rolling.critical_rate(DISK, FLAT, motion=flying)
    with pytest.raises(ValueError, match="expected one body"):
        rolling.critical_rate(RigidBody.stack([DISK, HOOP]), FLAT)
