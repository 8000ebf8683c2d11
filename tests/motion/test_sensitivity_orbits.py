"""Derivatives by the numbers of orbits and fields without series: an own model, exact laws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from polhode import MotionSensitivity, RigidBody, Trajectory, loads, orbits
from scipy.integrate import solve_ivp

if TYPE_CHECKING:
    from collections.abc import Callable

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
SECOND = 0.5 * np.trace(BODY.inertia) * np.eye(3) - BODY.inertia
OMEGA = (0.2, -0.1, 0.3)
T = np.array([0.0, 2.0, 5.0])
ORBIT: dict[str, Any] = {
    "mu": 1.0,
    "position": np.array([1.1, 0.2, -0.1]),
    "velocity": np.array([0.1, 0.8, 0.5]),
    "j2": 0.02,
    "radius": 0.8,
    "pole": np.array([0.3, -0.2, 0.9]),
}
SIX = np.array([45.0, -9.0, 1.0, -45.0, 9.0, -1.0]) / 60.0
STEPS = np.array([1.0, 2.0, 3.0, -1.0, -2.0, -3.0])


def spin(w: np.ndarray, q: np.ndarray, tidal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rates of ω and of (x, y, z, w) where the force on the mass at r is `tidal` r, of many motions."""
    x, y, z, s = q.T
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * s), 2 * (x * z + y * s)],
            [2 * (x * y + z * s), 1 - 2 * (x * x + z * z), 2 * (y * z - x * s)],
            [2 * (x * z - y * s), 2 * (y * z + x * s), 1 - 2 * (x * x + y * y)],
        ]
    )
    moved = SECOND @ np.einsum("jin,njk,kln->nil", turn, tidal, turn)
    torque = np.stack([moved[:, a, b] - moved[:, b, a] for a, b in ((1, 2), (2, 0), (0, 1))], axis=1)
    about = np.cross(w, w @ BODY.inertia)
    with_zero = np.concatenate([w, np.zeros((len(w), 1))], axis=1)
    (a, b, c, d), (i, j, k, l) = q.T, with_zero.T
    product = [d * i + a * l + b * k - c * j, d * j + b * l + c * i - a * k, d * k + c * l + a * j - b * i,
               d * l - a * i - b * j - c * k]  # fmt: skip
    return np.linalg.solve(BODY.inertia, (torque - about).T).T, 0.5 * np.array(product).T


def pulls(
    place: np.ndarray, mu: Any, j2: Any, radius: Any, pole: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Gradient and second derivatives of μ/r − μ J₂ R² (3 z²/r⁵ − 1/r³)/2, z along the pole."""
    n = pole / np.linalg.norm(pole, axis=1, keepdims=True)
    r, z = np.linalg.norm(place, axis=1), np.einsum("ni,ni->n", n, place)
    rr, rn, nn = (np.einsum("ni,nj->nij", a, b) for a, b in ((place, place), (place, n), (n, n)))
    one = np.eye(3)[None]
    k = (0.5 * mu * j2 * radius**2)[:, None]
    r, z, mu = r[:, None], z[:, None], mu[:, None]
    grad = -mu * place / r**3 - k * (6 * z * n / r**5 - 15 * z**2 * place / r**7 + 3 * place / r**5)
    r, z, mu, k = r[..., None], z[..., None], mu[..., None], k[..., None]
    second = -mu * (one / r**3 - 3 * rr / r**5) - k * (
        6 * nn / r**5 - 30 * z * (rn + rn.swapaxes(1, 2)) / r**7
        - 15 * z**2 * one / r**7 + 105 * z**2 * rr / r**9 + 3 * one / r**5 - 15 * rr / r**7
    )  # fmt: skip
    return grad, second


def oblate(numbers: dict[str, np.ndarray]) -> np.ndarray:
    """Give ω at the times, of many motions: those of the orbits with these numbers."""
    count = len(numbers["mu"])
    rest = [numbers[name] for name in ("mu", "j2", "radius", "pole")]

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        place, velocity, w, q = np.split(state.reshape(count, 13), [3, 6, 9], axis=1)
        grad, second = pulls(place, *rest)
        return np.concatenate([velocity, grad, *spin(w, q, second)], axis=1).ravel()

    own = np.tile([*OMEGA, 0.0, 0.0, 0.0, 1.0], (count, 1))
    start = np.concatenate([numbers["position"], numbers["velocity"], own], axis=1)
    run = solve_ivp(rates, (0.0, T[-1]), start.ravel(), "DOP853", t_eval=T, rtol=1e-13, atol=1e-14)
    return np.moveaxis(run.y.reshape(count, 13, len(T))[:, 6:9], 2, 1)


def along(
    model: Callable[[dict[str, np.ndarray]], np.ndarray], numbers: dict[str, Any], direction: dict[str, Any]
) -> np.ndarray:
    """Give the derivative of the ω of a model where its numbers move in a direction."""
    step = 2e-3
    moved = {
        name: np.array([np.asarray(value) + k * step * np.asarray(direction[name]) for k in STEPS])
        for name, value in numbers.items()
    }
    return np.tensordot(SIX, model(moved), 1) / step


def told(found: MotionSensitivity, direction: dict[str, Any]) -> np.ndarray:
    """Give the same by the derivatives by each number."""
    part = found.load[0]
    assert set(part) == set(direction)
    total = np.zeros((len(T), 3))
    for name, by in part.items():
        way = np.asarray(direction[name], dtype=float)
        parts: np.ndarray = by[:, 3:6].reshape(len(T), 3, -1)
        total += parts @ way.ravel()
    return total


def run_of(load: loads.Load) -> Trajectory:
    return BODY.simulate(T, OMEGA, load=load, rtol=1e-13)


def test_an_oblate_attractor() -> None:
    orbit = orbits.kepler(ORBIT["mu"], ORBIT["position"], ORBIT["velocity"], j2=ORBIT["j2"],
                          radius=ORBIT["radius"], pole=ORBIT["pole"])  # fmt: skip
    found = run_of(loads.gravity_gradient(orbit)).sensitivity("differences")
    rng = np.random.default_rng(1)
    ways: list[dict[str, Any]] = [
        {name: rng.normal(size=np.shape(value)) for name, value in ORBIT.items()} for _ in range(2)
    ]
    ways.append({name: np.full(np.shape(value), float(name == "j2")) for name, value in ORBIT.items()})
    for way in ways:
        exact = along(oblate, ORBIT, way)
        assert np.abs(exact).max() > 1e-2
        np.testing.assert_allclose(told(found, way), exact, atol=1e-8 * np.abs(exact).max())
    # The bulge is J₂ R²; of the pole the direction alone counts.
    part = found.load[0]
    size = np.abs(part["j2"]).max() * 1e-8
    np.testing.assert_allclose(0.8 * part["radius"], 2 * 0.02 * part["j2"], atol=size)
    np.testing.assert_allclose(part["pole"] @ ORBIT["pole"], 0.0, atol=size)


def test_without_a_bulge_they_are_those_of_the_series() -> None:
    plain = ORBIT["mu"], ORBIT["position"], ORBIT["velocity"]
    exact = run_of(loads.gravity_gradient(orbits.kepler(*plain))).sensitivity().load[0]
    round_one = orbits.kepler(*plain, j2=0.0, radius=1.0)
    found = run_of(loads.gravity_gradient(round_one)).sensitivity("differences").load[0]
    for name, by in exact.items():
        np.testing.assert_allclose(found[name], by, atol=1e-8 * np.abs(by).max())
    np.testing.assert_allclose(found["radius"], 0.0, atol=1e-12)


def test_a_table_of_positions() -> None:
    """A path that is straight: by its beginning and its velocity through all of the table."""
    times = np.linspace(0.0, 5.0, 6)
    straight: dict[str, Any] = {
        "mu": 1.0,
        "beginning": np.array([1.5, 0.3, -0.2]),
        "velocity": np.array([-0.2, 0.3, 0.1]),
    }

    def model(numbers: dict[str, np.ndarray]) -> np.ndarray:
        count = len(numbers["mu"])
        zero, pole = np.zeros(count), np.tile([0.0, 0.0, 1.0], (count, 1))

        def rates(t: float, state: np.ndarray) -> np.ndarray:
            w, q = np.split(state.reshape(count, 7), [3], axis=1)
            place = numbers["beginning"] + t * numbers["velocity"]
            _, second = pulls(place, numbers["mu"], zero, zero, pole)
            return np.concatenate(spin(w, q, second), axis=1).ravel()

        start = np.tile([*OMEGA, 0.0, 0.0, 0.0, 1.0], count)
        run = solve_ivp(rates, (0.0, T[-1]), start, "DOP853", t_eval=T, rtol=1e-13, atol=1e-14)
        return np.moveaxis(run.y.reshape(count, 7, len(T))[:, :3], 2, 1)

    table = straight["beginning"] + times[:, None] * straight["velocity"]
    run = run_of(loads.gravity_gradient(orbits.sampled(1.0, times, table)))
    found = run.sensitivity("differences")
    assert found.load[0]["position"].shape == (3, 6, 6, 3)
    rng = np.random.default_rng(2)
    way = {name: rng.normal(size=np.shape(value)) for name, value in straight.items()}
    exact = along(model, straight, way)
    in_table = {"mu": way["mu"], "position": way["beginning"] + times[:, None] * way["velocity"]}
    np.testing.assert_allclose(told(found, in_table), exact, atol=1e-8 * np.abs(exact).max())


def test_a_field_along_an_orbit() -> None:
    """The torque m × B is linear in the magnet and in the strength of the field."""
    magnet, strength = np.array([0.3, -0.1, 0.2]), np.array([0.1, 0.3, -0.9])
    orbit = orbits.kepler(ORBIT["mu"], ORBIT["position"], ORBIT["velocity"])
    run = run_of(loads.magnetic(magnet, orbit.dipole_field(strength)))
    part = run.sensitivity("differences").load[0]
    assert set(part) == {"dipole", "mu", "position", "velocity", "strength"}
    by_magnet = part["dipole"] @ magnet
    np.testing.assert_allclose(part["strength"] @ strength, by_magnet, atol=1e-8 * np.abs(by_magnet).max())
    # Kepler's third law: lengths times λ, μ times λ³ are the same orbit, its field weaker by λ³.
    grown = 3 * part["mu"] + part["position"] @ orbit.position + part["velocity"] @ orbit.velocity
    np.testing.assert_allclose(grown, -3 * by_magnet, atol=1e-8 * np.abs(by_magnet).max())


def test_a_target_that_follows_an_orbit() -> None:
    """Lengths times λ and μ times λ³ leave the frame of the orbit as it is."""
    target = orbits.kepler(ORBIT["mu"], ORBIT["position"], ORBIT["velocity"])
    run = run_of(loads.feedback(0.3, 0.2, target=target))
    part = run.sensitivity("differences").load[0]
    assert set(part) == {"K", "D", "mu", "position", "velocity"}
    grown = 3 * part["mu"] + part["position"] @ target.position + part["velocity"] @ target.velocity
    assert np.abs(grown).max() < 1e-8 * np.abs(part["mu"]).max()
    assert np.abs(part["position"]).max() > 0.01
