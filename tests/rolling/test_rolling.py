"""Rolling by closed forms, laws and limits: lift-off, long times, invariants, and what is refused."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from polhode import Event, RigidBody, loads, rolling, solids
from polhode.errors import ContactError, PolhodeError

G = loads.uniform_gravity((0, 0, -9.81))


def about_x(angle: float) -> tuple[float, float, float, float]:
    return float(np.sin(angle / 2)), 0.0, 0.0, float(np.cos(angle / 2))


# Planar motions


def eccentric_disk(lift: Any = "stop", start: float = 0.5) -> Any:
    """A disk with C at 0.9 of its radius, which starts with C on top; it rolls about y, its axis."""
    body = RigidBody.from_principal(1.0, (0.045, 0.045, 0.09), center_of_mass=(0, 0.9, 0))
    surface = rolling.disk(1.0)
    # The axis z of the body along y of space, its y upward.
    attitude = (0.0, np.sqrt(0.5), np.sqrt(0.5), 0.0)
    return body.simulate(
        np.linspace(0, 3, 31),
        (0, 0, start),
        attitude,
        load=G,
        contact=rolling.plane(surface, lift=lift),
        rtol=2.3e-15,
    )


def test_an_eccentric_disk_lifts_off_where_energy_says() -> None:
    """½ [I + m (a² + e² + 2 a e cos φ)] φ̇² + m g e cos φ is kept, and N = m (g + z̈) with z = a + e cos φ."""
    a, e, moment, g, start = 1.0, 0.9, 0.09, 9.81, 0.5

    def moment_about_contact(angle: float) -> float:
        return float(moment + a * a + e * e + 2 * a * e * np.cos(angle))

    energy = 0.5 * moment_about_contact(0.0) * start**2 + g * e

    def rate(angle: float) -> float:
        return float(np.sqrt(2 * (energy - g * e * np.cos(angle)) / moment_about_contact(angle)))

    def normal(angle: float) -> float:
        w = rate(angle)
        turn = (g * e * np.sin(angle) + a * e * np.sin(angle) * w * w) / moment_about_contact(angle)
        return float(g - e * np.cos(angle) * w * w - e * np.sin(angle) * turn)

    low, high = 1.0, 2.0
    assert normal(low) > 0 > normal(high)
    while high - low > 1e-16 * high and 0.5 * (low + high) not in (low, high):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if normal(middle) > 0 else (low, middle)
    # By Gauss's rule: the integrand is analytic beside the interval.
    places, weights = np.polynomial.legendre.leggauss(200)
    time = float(np.sum(weights * [0.5 * low / rate(0.5 * low * (x + 1)) for x in places]))
    assert low == pytest.approx(1.809661, abs=5e-7)
    assert time == pytest.approx(1.482721, abs=5e-7)

    found = eccentric_disk()
    assert found.status == "lift-off"
    assert found.events.event.tolist() == [-1]
    assert found.events.t[0] == pytest.approx(time, abs=1e-13)
    height = found.events.position[0][2]
    assert np.arccos(height - a) / e == pytest.approx(np.arccos(e * np.cos(low)) / e, rel=1e-12)
    # States after the end are not known.
    assert np.isnan(found.omega[found.t > time]).all()
    assert not np.isnan(found.omega[found.t < time]).any()
    assert abs(found.contact.smallest_normal_force.value) < 1e-12
    assert found.contact.smallest_normal_force.t == pytest.approx(time, abs=1e-13)


def test_a_contact_that_holds_goes_on() -> None:
    found = eccentric_disk("hold")
    assert found.status == "complete"
    assert found.contact.normal_force.min() < 0
    least = found.contact.smallest_normal_force
    assert least.value <= found.contact.normal_force.min()
    assert np.isinf(found.contact.largest_friction_needed.value)
    assert (found.events.event == -1).any()


def test_extremes_are_located_and_not_sampled() -> None:
    """The same at two outputs as at many, and where a fine sampling has them."""
    body = solids.cylinder(0.5, 0.0, mass=1.0)
    start: dict[str, Any] = {"omega": (0.3, 0.1, 6.0), "attitude": about_x(1.2), "load": G, "rtol": 1e-13}
    contact = rolling.plane(rolling.disk(0.5))
    few: Any = body.simulate([0, 4], contact=contact, **start).contact
    many: Any = body.simulate(np.linspace(0, 4, 20001), contact=contact, **start).contact
    most = many.friction_needed.max()
    assert few.largest_friction_needed.value == pytest.approx(many.largest_friction_needed.value, rel=1e-13)
    assert most <= few.largest_friction_needed.value <= most * (1 + 1e-6)
    least = many.normal_force.min()
    assert least * (1 - 1e-6) <= few.smallest_normal_force.value <= least


# Closed forms


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_a_ball_on_a_turntable_goes_in_circles(tilt: float) -> None:
    """v̇_C = 2/7 Ω n×v_C + 5/7 g_t for a homogeneous ball: circles, and a drift across the slope."""
    ball, rate, g = solids.sphere(0.2, mass=3.0), 2.0, 9.81
    normal = np.array([np.sin(tilt), 0, np.cos(tilt)])
    contact = rolling.plane(rolling.sphere(0.2), normal=normal, turntable=rate)
    t = np.linspace(0, 20, 41)
    found: Any = ball.simulate(t, (1.0, -2.0, 0.5), load=G, contact=contact, rtol=1e-14)
    one = np.cross([0, 1.0, 0], normal)
    two = np.cross(normal, one)
    pull = 5 / 7 * np.array([0, 0, -g]) @ np.array([one, two]).T
    slow = 2 / 7 * rate
    start = found.velocity[0] @ one + 1j * (found.velocity[0] @ two)
    drift = 1j * (pull[0] + 1j * pull[1]) / slow
    exact = drift + (start - drift) * np.exp(1j * slow * t)
    velocity = found.velocity @ one + 1j * (found.velocity @ two)
    assert np.max(np.abs(velocity - exact)) < 1e-11 * max(1, np.max(np.abs(exact)))
    # The force is m (v̇ − g); a turntable works.
    force = found.contact.force @ np.array([one, two]).T
    acceleration = 1j * slow * (start - drift) * np.exp(1j * slow * t)
    weight = 3.0 * np.array([0, 0, -g]) @ np.array([one, two]).T
    assert np.allclose(force[:, 0] + 1j * force[:, 1], 3.0 * acceleration - complex(*weight), atol=1e-10)
    assert found.invariants().energy_drift < 1e-13  # less the work of the turntable


def test_a_rolling_coin_precesses_steadily() -> None:
    """A disk that circles at an inclination: Routh's condition for ψ̇ and the spin."""
    m, a, g, theta, turn = 2.0, 0.5, 9.81, 0.4, 1.3
    across, along = m * a * a / 4, m * a * a / 2
    # With β = π/2 − θ from the normal to the axis and ω = (0, Ω sin β, n) in the body, dL/dt = Ω×L = r×F is
    # Ω sin β (I_t Ω cos β − I_s n) = m a (a n Ω sin β + g cos β).
    spin = (across * turn**2 * np.cos(theta) - g * m * a) * np.sin(theta)
    spin /= (along + m * a * a) * turn * np.cos(theta)
    body, angle = solids.cylinder(a, 0.0, mass=m), np.pi / 2 - theta
    found: Any = body.simulate(
        np.linspace(0, 2, 21),
        (0.0, turn * np.sin(angle), spin),
        about_x(angle),
        load=G,
        contact=rolling.plane(rolling.disk(a)),
        rtol=1e-14,
    )
    assert np.max(np.abs(found.position[:, 2] - a * np.cos(theta))) < 1e-9
    assert found.contact.normal_force == pytest.approx(m * g, rel=1e-8)


# Long times


def slope_in_errors(values: Any) -> float:
    """Return the mean slope of a constant over its standard error: rounding adds up as a random walk."""
    steps = np.diff(values, axis=0)
    return float(np.max(np.abs(steps.mean(axis=0)) / (steps.std(axis=0, ddof=1) / np.sqrt(len(steps)))))


@pytest.mark.parametrize("turns", [300, pytest.param(10_000, marks=pytest.mark.long)])
def test_ten_thousand_rotations_of_chaplygins_ball(turns: int) -> None:
    ball = RigidBody.from_principal(1.0, (0.08, 0.1, 0.13))
    t = np.linspace(0, turns * 2 * np.pi / 3.74, 1001)
    contact = rolling.plane(rolling.sphere(0.5))
    found: Any = ball.simulate(t, (1.0, 2.0, 3.0), load=G, contact=contact, rtol=2.3e-15)
    kept = found.invariants()
    assert kept.chaplygin_drift <= 1e-12
    assert kept.energy_drift <= 1e-12
    assert kept.jellett is None
    assert np.max(np.abs(found.contact.residual)) <= 1e-14
    assert slope_in_errors(kept.energy) < 3
    assert slope_in_errors(kept.chaplygin) < 3


@pytest.mark.parametrize("turns", [300, pytest.param(10_000, marks=pytest.mark.long)])
def test_ten_thousand_rotations_of_a_disk(turns: int) -> None:
    body = solids.cylinder(0.5, 0.0, mass=1.0)
    t = np.linspace(0, turns * 2 * np.pi / 8, 1001)
    found: Any = body.simulate(
        t, (0.3, 1.0, 8.0), about_x(1.2), load=G, contact=rolling.plane(rolling.disk(0.5)), rtol=2.3e-15
    )
    assert found.status == "complete"
    assert found.invariants().energy_drift <= 1e-12
    assert slope_in_errors(found.invariants().energy) < 3


def test_jellett_and_routh_of_a_loaded_ball() -> None:
    ball = RigidBody.from_principal(1.0, (0.08, 0.08, 0.13), center_of_mass=(0, 0, -0.05))
    contact = rolling.plane(rolling.sphere(0.5))
    found: Any = ball.simulate(
        np.linspace(0, 100, 101), (1.0, 2.0, 6.0), about_x(0.5), load=G, contact=contact, rtol=2.3e-15
    )
    kept = found.invariants()
    assert kept.jellett is not None
    assert kept.routh is not None
    assert max(kept.jellett_drift, kept.routh_drift, kept.energy_drift) <= 1e-13
    assert kept.chaplygin is None
    # With another tensor neither is kept.
    other = RigidBody.from_principal(1.0, (0.08, 0.1, 0.13), center_of_mass=(0, 0, -0.05))
    kept = other.simulate([0, 1], (1.0, 2.0, 6.0), load=G, contact=contact).invariants()
    assert kept.jellett is None
    assert kept.routh is None


def test_the_rattleback_reverses() -> None:
    """Spun against its preferred sense it turns round; energy is kept."""
    turned = 0.035
    cos, sin = np.cos(turned), np.sin(turned)
    axes = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    body = RigidBody.from_principal(1.0, (2e-4, 1.6e-3, 1.7e-3), center_of_mass=(0, 0, 0))
    contact = rolling.plane(rolling.ellipsoid((0.2, 0.03, 0.02), axes=axes))
    t = np.linspace(0, 60, 601)
    ends = []
    for sense in (5.0, -5.0):
        found = body.simulate(t, (0.05, 0.0, sense), load=G, contact=contact, rtol=1e-13)
        assert found.status == "complete"
        assert found.invariants().energy_drift < 1e-11
        ends.append(found.omega[:, 2] * np.sign(sense))
    assert min(ends[0].min(), ends[1].min()) < -0.5 < 0.5 < max(ends[0].min(), ends[1].min()) + 5.0


# What a run can do


def test_a_motion_goes_on_back_and_in_stacks() -> None:
    ball = RigidBody.from_principal(1.0, (0.08, 0.1, 0.13))
    contact = rolling.plane(rolling.sphere(0.5), normal=(0.1, 0.2, 1.0), point=(1, 2, 3), turntable=0.5)
    given: dict[str, Any] = {"load": G, "contact": contact, "rtol": 1e-14}
    omega = np.array([[1.0, 2.0, 3.0], [0.5, -1.0, 2.0]])
    both: Any = ball.simulate([0, 1, 2], omega, **given)
    assert both.omega.shape == (2, 3, 3)
    assert both.contact.force.shape == (2, 3, 3)
    assert both.contact.largest_friction_needed.value.shape == (2,)
    for row in range(2):
        one = ball.simulate([0, 1, 2], omega[row], **given)
        assert np.array_equal(one.omega, both.omega[row])
        assert np.array_equal(one.position, both.position[row])
        again = ball.simulate([0, 1], omega[row], **given).resume([1, 2], rtol=1e-14)
        assert np.allclose(again.position[-1], one.position[-1], rtol=0, atol=1e-13)
        assert again.contact is not None
    last = one.state()
    back = ball.simulate([2, 0], last.omega, last.attitude, position=last.position, **given)
    assert np.allclose(back.omega[-1], omega[1], rtol=0, atol=1e-12)
    assert np.allclose(back.position[-1], one.position[0], rtol=0, atol=1e-12)


def test_events_of_functions_are_found() -> None:
    ball = solids.sphere(0.5, mass=1.0)

    def at_one(_: float, *state: Any) -> float:
        return float(state[2][0] - 1.0)

    found: Any = ball.simulate(
        [0, 10],
        (0, 2.0, 0),
        load=G,
        contact=rolling.plane(rolling.sphere(0.5)),
        events=Event(at_one, terminal=True),
    )
    assert found.status == "event"
    assert found.events.event.tolist() == [0]
    assert found.events.t[0] == pytest.approx(1.0, rel=1e-13)


def test_surfaces_and_contacts_are_pickled_and_printed() -> None:
    axes = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    for surface in (
        rolling.sphere(0.5, (0, 0, 0.1)),
        rolling.ellipsoid((1, 2, 3), axes=axes),
        rolling.disk(0.5, (0, 1, 0)),
        rolling.torus(0.5, 0.1),
        rolling.paraboloid((1, 2), 0.5, axes),
    ):
        contact = rolling.plane(surface, normal=(1, 2, 2), point=(1, 0, 0), turntable=0.5, lift="hold")
        again = pickle.loads(pickle.dumps(contact))
        assert repr(again) == repr(contact)
        assert repr(again.surface) == repr(surface)
        assert np.array_equal(again.surface.contact((0.1, 0.2, 1)), surface.contact((0.1, 0.2, 1)))
    assert contact.turntable == 0.5
    assert contact.lift == "hold"
    assert contact.normal.tolist() == pytest.approx([1 / 3, 2 / 3, 2 / 3])
    assert contact.point.tolist() == [1.0, 0.0, 0.0]


def test_a_motion_without_a_contact_has_none() -> None:
    assert solids.sphere(0.5, mass=1.0).simulate([0, 1], (0, 0, 1)).contact is None


def test_a_saved_motion_knows_that_something_acted(tmp_path: Path) -> None:
    ball = solids.sphere(0.5, mass=1.0)
    run = ball.simulate([0, 1], (0, 2.0, 0), contact=rolling.plane(rolling.sphere(0.5)))
    run.save(tmp_path / "run.npz")
    again = type(run).from_file(tmp_path / "run.npz")
    assert again.contact is None
    with pytest.raises(ValueError, match="a load acted on this motion, which its file does not hold"):
        again.resume([1, 2])


# What is refused


def simulate(**changed: Any) -> Any:
    given: dict[str, Any] = {
        "t": [0, 1],
        "omega": (0, 0, 1),
        "load": G,
        "contact": rolling.plane(rolling.sphere(0.5)),
    }
    return solids.sphere(0.5, mass=1.0).simulate(**(given | changed))


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"position": (0, 0, 0.6)}, "hovers over the plane by 0.09999999999999998"),
        ({"position": (0, 0, 0.4)}, "sinks into the plane by 0.09999999999999998"),
        ({"position": (0, 0, 0.5 + 1e-8)}, "hovers"),
        ({"contact": rolling.plane(rolling.disk(0.5))}, "lies flat"),
        ({"contact": rolling.plane(rolling.torus(0.5, 0.1))}, "lies flat"),
        (
            {"contact": rolling.plane(rolling.paraboloid((1, 1), 0.1)), "attitude": about_x(0.7)},
            "the paraboloid touches on its rim",
        ),
        ({"load": G + loads.constant_torque((0, 0, 1))}, "uniform gravity alone"),
        ({"load": loads.damping(np.eye(3))}, "uniform gravity alone"),
        ({"method": "dop853"}, 'the method "taylor"'),
        ({"rtol": 1e-20}, "2.3e-15 or more"),
        ({"about": "origin"}, "a body on a plane has no fixed point"),
    ],
)
def test_a_contact_that_cannot_be_is_refused(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(ContactError, match=words.replace("(", r"\(")):
        simulate(**changed)


def test_other_arguments_that_are_refused() -> None:
    with pytest.raises(ValueError, match="velocity: a body that rolls has the velocity"):
        simulate(velocity=(0, 0, 0))
    with pytest.raises(ValueError, match="contact: expected a contact"):
        simulate(contact=rolling.sphere(0.5))
    plane: Any = rolling.plane
    with pytest.raises(ValueError, match="surface: expected a surface"):
        plane(0.5)
    with pytest.raises(ValueError, match='lift: expected "stop", "fly" or "hold"'):
        plane(rolling.sphere(1), lift="jump")
    with pytest.raises(PolhodeError, match="radius must be a positive length"):
        rolling.sphere(0.0)
    with pytest.raises(ValueError, match="normal: expected vectors that have a direction"):
        rolling.sphere(1.0).contact((0, 0, 0))
    with pytest.raises(ValueError, match="sensitivity: the derivatives of a body that rolls"):
        simulate().sensitivity()


def test_a_boat_that_rolls_over_its_rim_says_so() -> None:
    boat = RigidBody.from_principal(1.0, (0.01, 0.02, 0.025), center_of_mass=(0, 0, 0.2))
    with pytest.raises(
        ContactError, match=r"the contact is lost at t = 0\.\d+: the paraboloid touches on its rim"
    ):
        boat.simulate(
            [0, 5], (0, 0.5, 0), load=G, contact=rolling.plane(rolling.paraboloid((0.2, 0.3), 0.05))
        )


def test_a_disk_that_falls_flat_says_so() -> None:
    disk = solids.cylinder(0.5, 0.0, mass=1.0)
    with pytest.raises(ContactError, match=r"the contact is lost at t = 0\.\d+: .*lies flat"):
        disk.simulate(
            [0, 5], (0, 0, 0), about_x(1.4), load=G, contact=rolling.plane(rolling.disk(0.5), lift="hold")
        )


def test_a_start_at_which_the_plane_would_pull_lifts_off_at_once() -> None:
    body = RigidBody.from_principal(1.0, (0.05, 0.05, 0.05), center_of_mass=(0, 0, 0.4))
    found: Any = body.simulate([0, 1], (20.0, 0, 0), load=G, contact=rolling.plane(rolling.sphere(0.5)))
    assert found.status == "lift-off"
    assert found.events.t.tolist() == [0.0]
    assert not np.isnan(found.omega[0]).any()
