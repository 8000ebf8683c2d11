"""The theorems in letters: derived from first principles, and equal to the numbers of the core."""

from __future__ import annotations

from typing import Any

import numpy as np
import polhode
import pytest
from polhode import RigidBody, euler_angles, parallel_axis, solids

sympy = pytest.importorskip("sympy", reason="pip install sympy")
from polhode import symbolic  # noqa: E402 (needs SymPy)

S = symbolic.symbols
TENSOR = [S.tensor[pair] for pair in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
SEQUENCES = [
    turn(letters)
    for letters in ["ZXZ", "XYX", "YZY", "ZYZ", "XZX", "YXY", "XYZ", "YZX", "ZXY", "XZY", "ZYX", "YXZ"]
    for turn in (str.upper, str.lower)
]


def bodies(rng: np.random.Generator, count: int = 50) -> tuple[RigidBody, list[np.ndarray], np.ndarray]:
    """A stack of bodies, the six elements of their tensors about C, and where C is."""
    turn = euler_angles.to_quaternion(rng.uniform(0.1, 3.0, (count, 3)))
    sizes, masses = rng.uniform(0.5, 2.0, (count, 3)), rng.uniform(0.5, 3.0, count)
    stack = solids.box(sizes, mass=masses).rotated(turn).translated(rng.normal(size=(count, 3)))
    return stack, six(stack.inertia), stack.center_of_mass


def six(tensor: np.ndarray) -> list[np.ndarray]:
    return [tensor[..., i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def near(got: np.ndarray, want: np.ndarray) -> bool:
    """To 1e-14 of the largest number: in a smaller one terms may have cancelled."""
    return bool(np.all(np.abs(got - want) <= 1e-14 * np.max(np.abs(want))))


class TestNumbers:
    def test_parallel_axis(self, rng: np.random.Generator) -> None:
        stack, tensor, _ = bodies(rng)
        d = rng.normal(size=(50, 3))
        f = symbolic.function(symbolic.parallel_axis(), [*TENSOR, S.mass, *S.displacement])
        want = parallel_axis.from_center_of_mass(stack.inertia, stack.mass, d)
        assert near(f(*tensor, stack.mass, *d.T), want)

    def test_energy_and_momentum_about_any_point(self, rng: np.random.Generator) -> None:
        stack, _, center = bodies(rng)
        w, v, x = rng.normal(size=(3, 50, 3))
        given = [*six(stack.inertia_about("origin")), stack.mass, *w.T, *v.T, *center.T]
        letters = [*TENSOR, S.mass, *S.omega, *S.velocity, *S.center]
        energy = symbolic.function(symbolic.kinetic_energy(), letters)(*given)
        assert near(energy, stack.kinetic_energy(w, v, about="origin").total)
        momentum = symbolic.function(symbolic.angular_momentum(), [*letters, *S.position])(*given, *x.T)
        assert near(momentum, stack.angular_momentum(w, v, x, about="origin").total)

    def test_euler_s_equations(self, rng: np.random.Generator) -> None:
        stack, tensor, _ = bodies(rng)
        w, n = rng.normal(size=(2, 50, 3))
        whole = symbolic.angular_acceleration(S.tensor)
        rate = symbolic.function(whole, [*TENSOR, *S.omega, *S.torque])(*tensor, *w.T, *n.T)
        want = stack.angular_acceleration(w, n)
        assert np.abs(rate - want).max() <= 1e-12 * np.abs(want).max()  # the inverse of any tensor, by minors
        back = symbolic.torque(S.tensor)
        torque = symbolic.function(back, [*TENSOR, *S.omega, *S.angular_acceleration])(*tensor, *w.T, *n.T)
        assert near(torque, stack.torque(w, n))

    def test_euler_s_equations_in_principal_axes(self, rng: np.random.Generator) -> None:
        moments = np.sort(rng.uniform(1.0, 2.0, (50, 3)))
        stack = RigidBody.from_principal(1.0, moments)
        w, n = rng.normal(size=(2, 50, 3))
        letters = [*S.moments, *S.omega]
        rate = symbolic.function(symbolic.angular_acceleration(), [*letters, *S.torque])(
            *moments.T, *w.T, *n.T
        )
        assert near(rate, stack.angular_acceleration(w, n))

    def test_effective_potential(self, rng: np.random.Generator) -> None:
        letters = [S.mass, S.gravity, S.arm, S.axial, S.transverse]
        letters += [S.vertical_momentum, S.axial_momentum, S.angles[1]]
        f = symbolic.function(symbolic.effective_potential(), letters)
        for _ in range(20):
            mass, g, arm = rng.uniform(0.5, 2.0, 3)
            across, along = rng.uniform(1.0, 1.5), rng.uniform(0.5, 1.5)
            body = RigidBody.from_principal(mass, (across, across, along), center_of_mass=(0, 0, arm))
            omega, attitude = (
                rng.normal(size=3),
                euler_angles.to_quaternion((0.3, rng.uniform(0.3, 2.8), 0.1)),
            )
            top = body.heavy_top(omega, attitude, (0, 0, -g))
            pivoted = body.inertia_about("origin")
            spin = top.at(0.0).angular_momentum().spin
            theta = rng.uniform(0.5, 2.5, 5)
            got = f(mass, g, arm, pivoted[2, 2], pivoted[0, 0], spin[2], pivoted[2, 2] * omega[2], theta)
            want = top.effective_potential(theta)
            terms = (abs(spin[2]) + abs(pivoted[2, 2] * omega[2])) ** 2 / pivoted[0, 0] / np.sin(0.5) ** 2
            assert np.abs(got - want).max() <= 1e-14 * (terms + mass * g * arm)

    @pytest.mark.parametrize("sequence", SEQUENCES)
    def test_euler_angles(self, sequence: str, rng: np.random.Generator) -> None:
        angles, rates, w = rng.uniform(0.4, 1.1, (3, 40, 3))
        turned = symbolic.function(symbolic.rotation(sequence), S.angles)(*angles.T)
        q = euler_angles.to_quaternion(angles, sequence)
        for axis in np.eye(3):
            assert np.abs(turned @ axis - polhode._core.rotate(q, axis)).max() < 1e-14
        for frame in ("body", "space"):
            forward = symbolic.function(symbolic.angular_velocity(sequence, frame), [*S.angles, *S.rates])
            want = euler_angles.angular_velocity(angles, rates, sequence, frame)
            assert near(forward(*angles.T, *rates.T), want)
            back = symbolic.function(symbolic.euler_rates(sequence, frame), [*S.angles, *S.omega])
            want = euler_angles.rates(angles, w, sequence, frame)
            assert near(back(*angles.T, *w.T), want)

    def test_particles(self, rng: np.random.Generator) -> None:
        m = sympy.symbols("m_1:4", positive=True)
        x = sympy.symbols("x_1:10", real=True)
        mass, center, inertia = symbolic.particles(m, [x[:3], x[3:6], x[6:]])
        masses, places = rng.uniform(0.5, 2.0, (20, 3)), rng.normal(size=(20, 3, 3))
        body = RigidBody.from_particles(masses, places)
        given = [*masses.T, *places.reshape(20, 9).T]
        assert near(symbolic.function(mass, [*m, *x])(*given), body.mass)
        assert near(symbolic.function(center, [*m, *x])(*given), body.center_of_mass)
        assert np.allclose(symbolic.function(inertia, [*m, *x])(*given), body.inertia, rtol=0, atol=1e-13)


class TestDerivations:
    @pytest.mark.parametrize("sequence", ["ZXZ", "zyx", "YXZ"])
    def test_angular_velocity_is_the_derivative_of_the_rotation(self, sequence: str) -> None:
        """ω× = Rᵀ Ṙ in the body, Ṙ Rᵀ in space."""
        time = sympy.Symbol("t")
        moving = [sympy.Function(name)(time) for name in ("f", "g", "k")]
        turned = symbolic.rotation(sequence, moving)
        for frame, product in (
            ("body", turned.T * turned.diff(time)),
            ("space", turned.diff(time) * turned.T),
        ):
            want = sympy.Matrix([product[2, 1], product[0, 2], product[1, 0]])
            found = symbolic.angular_velocity(sequence, frame, moving, [one.diff(time) for one in moving])
            numbers = [(one.diff(time), 3 - k) for k, one in enumerate(moving)]
            numbers += [(one, sympy.Rational(7 * k + 3, 11)) for k, one in enumerate(moving)]
            assert (found - want).subs(numbers).evalf(40).norm() < 1e-35

    def test_lagrange_s_function_gives_the_effective_potential(self) -> None:
        """T + V of the top with its momenta L_z = ∂T/∂φ̇ and L_s = ∂T/∂ψ̇, less that of nod and spin."""
        w = symbolic.angular_velocity()
        across, along = S.transverse, S.axial
        T = (across * (w[0] ** 2 + w[1] ** 2) + along * w[2] ** 2) / 2
        phi, theta, psi = S.rates
        values = {
            S.vertical_momentum: sympy.diff(T, phi),
            S.axial_momentum: sympy.diff(T, psi),
        }
        weight = S.mass * S.gravity * S.arm * sympy.cos(S.angles[1])
        rest = T + weight - across * theta**2 / 2 - along * w[2] ** 2 / 2
        assert sympy.simplify(symbolic.effective_potential().subs(values) - rest) == 0

    def test_energy_is_the_sum_over_particles(self) -> None:
        m, n = sympy.symbols("m n", positive=True)
        one, two = sympy.symbols("x_1:4", real=True), sympy.symbols("y_1:4", real=True)
        mass, center, inertia = symbolic.particles([m, n], [one, two])
        about_origin = symbolic.parallel_axis(inertia, mass, center)
        told = symbolic.kinetic_energy(about_origin, mass, center=center)
        by_hand: Any = 0
        momentum = sympy.zeros(3, 1)
        for weight, place in ((m, one), (n, two)):
            r = sympy.Matrix(place)
            speed = S.velocity + S.omega.cross(r)
            by_hand += weight * speed.dot(speed) / 2
            momentum += weight * (S.position + r).cross(speed)
        assert sympy.simplify(told - by_hand) == 0
        found = symbolic.angular_momentum(about_origin, mass, center=center)
        assert (found - momentum).applyfunc(sympy.simplify) == sympy.zeros(3, 1)

    def test_euler_s_equations_are_each_other_s_inverse(self) -> None:
        back = symbolic.angular_acceleration(torque=symbolic.torque())
        assert (back - S.angular_acceleration).applyfunc(sympy.simplify) == sympy.zeros(3, 1)
        classic = [(S.moments[1] - S.moments[2]) * S.omega[1] * S.omega[2] / S.moments[0]]
        assert sympy.simplify(symbolic.angular_acceleration(torque=(0, 0, 0))[0] - classic[0]) == 0


def test_what_is_refused() -> None:
    for sequence in ("ZZX", "ZXQ", "Zxz", "ZX"):
        with pytest.raises(ValueError, match="is not three axes, neighbours different"):
            symbolic.rotation(sequence)
    assert symbolic.rotation("goldstein") == symbolic.rotation("ZXZ")
    with pytest.raises(ValueError, match="frame: expected 'body' or 'space', got 'lab'"):
        symbolic.angular_velocity(frame="lab")
    with pytest.raises(ValueError, match="omega: expected three components, got 2"):
        symbolic.torque(omega=(1, 2))
    with pytest.raises(ValueError, match="masses and positions: expected as many, got 1 and 0"):
        symbolic.particles([1], [])
