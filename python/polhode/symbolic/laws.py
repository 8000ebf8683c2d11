"""The theorems of the textbook as expressions. Without arguments they are in the letters of `symbols`."""

from __future__ import annotations

from typing import Any, Final

from polhode.symbolic.symbols import symbols, sympy

__all__ = [
    "angular_acceleration",
    "angular_momentum",
    "angular_velocity",
    "effective_potential",
    "euler_rates",
    "kinetic_energy",
    "parallel_axis",
    "particles",
    "rotation",
    "torque",
]

_NAMES: Final = {"goldstein": "ZXZ", "landau": "ZXZ", "aerospace": "ZYX"}


def parallel_axis(inertia: Any = None, mass: Any = None, displacement: Any = None) -> Any:
    """Compute the tensor about a point from the tensor about the centre of mass: ``I + M (d² 1 − d dᵀ)``.

    Parameters
    ----------
    inertia : Matrix, optional
        Tensor about the centre of mass.
    mass : Expr, optional
    displacement : sequence of three Expr, optional
        Vector from the centre of mass to the point.

    Returns
    -------
    Matrix

    Examples
    --------
    >>> from polhode import symbolic
    >>> symbolic.parallel_axis()[0, 1]
    I_xy - M*d_x*d_y
    """
    tensor = symbols.tensor if inertia is None else sympy.Matrix(inertia)
    m = symbols.mass if mass is None else sympy.sympify(mass)
    d = _vector(displacement, symbols.displacement, "displacement")
    return tensor + m * (d.dot(d) * sympy.eye(3) - d * d.T)


def particles(masses: Any, positions: Any) -> tuple[Any, Any, Any]:
    """Compute the mass, centre of mass and tensor about the centre of mass of particles.

    Parameters
    ----------
    masses : sequence of n Expr
    positions : sequence of n sequences of three Expr

    Returns
    -------
    mass : Expr
    center_of_mass : Matrix, shape (3, 1)
    inertia : Matrix, shape (3, 3)

    Examples
    --------
    >>> from polhode import symbolic
    >>> from sympy import symbols
    >>> m, a = symbols("m a")
    >>> symbolic.particles([m, m], [(a, 0, 0), (-a, 0, 0)])[2].diagonal()
    Matrix([[0, 2*a**2*m, 2*a**2*m]])
    """
    if isinstance(masses, str):
        raise TypeError(f"masses: expected several expressions, got {masses!r}; sympy.symbols makes them")
    weights = [sympy.sympify(mass) for mass in masses]
    places = [_vector(place, None, "positions") for place in positions]
    if not weights or len(weights) != len(places):
        raise ValueError(f"masses and positions: expected as many, got {len(weights)} and {len(places)}")
    mass = sympy.Add(*weights)
    center = sum((m * r for m, r in zip(weights, places, strict=True)), sympy.zeros(3, 1)) / mass
    tensor = sympy.zeros(3, 3)
    for m, r in zip(weights, places, strict=True):
        tensor += parallel_axis(sympy.zeros(3, 3), m, r - center)
    return mass, center.applyfunc(sympy.factor), tensor.applyfunc(sympy.factor)


def kinetic_energy(
    inertia: Any = None, mass: Any = None, omega: Any = None, velocity: Any = None, center: Any = None
) -> Any:
    """Compute the kinetic energy: ``½ M v² + M v·(ω×c) + ½ ω·I ω``.

    Parameters
    ----------
    inertia : Matrix, optional
        Tensor about the reference point.
    mass : Expr, optional
    omega, velocity : sequence of three Expr, optional
        Angular velocity, and velocity of the reference point, components in the body.
    center : sequence of three Expr, optional
        Vector from the reference point to the centre of mass. Give (0, 0, 0) if the reference point is the
        centre of mass; by default it is a vector of symbols.

    Returns
    -------
    Expr
    """
    tensor = symbols.tensor if inertia is None else sympy.Matrix(inertia)
    m = symbols.mass if mass is None else sympy.sympify(mass)
    w, v = _vector(omega, symbols.omega, "omega"), _vector(velocity, symbols.velocity, "velocity")
    c = _vector(center, symbols.center, "center")
    return m * v.dot(v) / 2 + m * v.dot(w.cross(c)) + w.dot(tensor * w) / 2


def angular_momentum(
    inertia: Any = None,
    mass: Any = None,
    omega: Any = None,
    velocity: Any = None,
    position: Any = None,
    center: Any = None,
) -> Any:
    """Compute the angular momentum about the origin of space: ``M X×v + M (X×(ω×c) + c×v) + I ω``.

    Parameters
    ----------
    inertia, mass, omega, velocity, center : optional
        As in `kinetic_energy`.
    position : sequence of three Expr, optional
        Position X of the reference point, components in the body.

    Returns
    -------
    Matrix, shape (3, 1)
    """
    tensor = symbols.tensor if inertia is None else sympy.Matrix(inertia)
    m = symbols.mass if mass is None else sympy.sympify(mass)
    w, v = _vector(omega, symbols.omega, "omega"), _vector(velocity, symbols.velocity, "velocity")
    x, c = _vector(position, symbols.position, "position"), _vector(center, symbols.center, "center")
    return m * x.cross(v) + m * (x.cross(w.cross(c)) + c.cross(v)) + tensor * w


def torque(inertia: Any = None, omega: Any = None, angular_acceleration: Any = None) -> Any:
    """Return Euler's equations for the torque: ``N = I ω̇ + ω × I ω``.

    Parameters
    ----------
    inertia : Matrix, optional
        Tensor about the centre of mass or a fixed point; diagonal with the principal moments by default.
    omega, angular_acceleration : sequence of three Expr, optional
        Components in the body.

    Returns
    -------
    Matrix, shape (3, 1)
    """
    tensor, w = _principal(inertia), _vector(omega, symbols.omega, "omega")
    rate = _vector(angular_acceleration, symbols.angular_acceleration, "angular_acceleration")
    return tensor * rate + w.cross(tensor * w)


def angular_acceleration(inertia: Any = None, omega: Any = None, torque: Any = None) -> Any:
    """Compute the angular acceleration by Euler's equations: ``ω̇ = I⁻¹ (N − ω × I ω)``.

    Parameters
    ----------
    inertia : Matrix, optional
        Tensor about the centre of mass or a fixed point; diagonal with the principal moments by default.
    omega, torque : sequence of three Expr, optional
        Components in the body.

    Returns
    -------
    Matrix, shape (3, 1)

    Examples
    --------
    >>> from polhode import symbolic
    >>> symbolic.angular_acceleration(torque=(0, 0, 0))[0].factor()
    omega_2*omega_3*(I_2 - I_3)/I_1
    """
    tensor, w = _principal(inertia), _vector(omega, symbols.omega, "omega")
    n = _vector(torque, symbols.torque, "torque")
    return tensor.inv() * (n - w.cross(tensor * w))


def effective_potential(inclination: Any = None) -> Any:
    """Compute the effective potential of a heavy top: ``(L_z − L_s cos θ)²/(2 I_t sin²θ) + M g l cos θ``.

    Parameters
    ----------
    inclination : Expr, optional
        Angle θ between the axis and the upward vertical.

    Returns
    -------
    Expr
        The potential. Its sum with ``I_t θ̇²/2`` is constant: the energy minus the energy of the spin about
        the axis.
    """
    theta = symbols.angles[1] if inclination is None else sympy.sympify(inclination)
    precession = symbols.vertical_momentum - symbols.axial_momentum * sympy.cos(theta)
    weight = symbols.mass * symbols.gravity * symbols.arm * sympy.cos(theta)
    return precession**2 / (2 * symbols.transverse * sympy.sin(theta) ** 2) + weight


def rotation(sequence: str = "ZXZ", angles: Any = None) -> Any:
    """Compute the matrix R_NB of Euler angles: ``v_N = R v_B``.

    Parameters
    ----------
    sequence : str, optional
        As in :mod:`polhode.euler_angles`.
    angles : sequence of three Expr, optional

    Returns
    -------
    Matrix
    """
    turned = sympy.eye(3)
    for axis, angle in _intrinsic(sequence, _angles_or_default(angles)):
        turned = turned * _about(axis, angle)
    return turned


def angular_velocity(
    sequence: str = "ZXZ", frame: str = "body", angles: Any = None, rates: Any = None
) -> Any:
    r"""Compute the angular velocity by Euler angles and their rates.

    Parameters
    ----------
    sequence : str, optional
        As in :mod:`polhode.euler_angles`.
    frame : {"body", "space"}, optional
        The frame whose axes the components refer to.
    angles, rates : sequence of three Expr, optional

    Returns
    -------
    Matrix, shape (3, 1)

    Examples
    --------
    >>> from polhode import symbolic
    >>> symbolic.angular_velocity()[2]
    \dot{\psi} + \dot{\varphi}*cos(theta)
    """
    given = sympy.Matrix(symbols.rates if rates is None else list(rates))
    return _columns(sequence, frame, angles) * given


def euler_rates(sequence: str = "ZXZ", frame: str = "body", angles: Any = None, omega: Any = None) -> Any:
    """Compute the rates of Euler angles by the angles and the angular velocity.

    Parameters
    ----------
    sequence, frame : str, optional
        As in `angular_velocity`.
    angles, omega : sequence of three Expr, optional

    Returns
    -------
    Matrix, shape (3, 1)
        The rates. They are not defined where the sine of the middle angle is zero; for sequences of three
        different axes, where its cosine is zero.
    """
    _check_frame(frame)
    (first, start), (second, middle), (third, end) = _intrinsic(sequence, _angles_or_default(angles))
    # Next to the middle axis stands a frame in which the three axes depend on the middle angle alone.
    middle_turn = _about(second, middle)
    if frame == "space":
        axes, into = [_axis(first), _axis(second), middle_turn * _axis(third)], _about(first, start).T
    else:
        axes, into = [middle_turn.T * _axis(first), _axis(second), _axis(third)], _about(third, end)
    matrix = sympy.Matrix.hstack(*axes)
    rates = (matrix.adjugate() / matrix.det()).applyfunc(sympy.trigsimp) * into
    if _is_extrinsic(sequence):
        rates = sympy.Matrix.vstack(*(rates[k, :] for k in (2, 1, 0)))
    return rates * _vector(omega, symbols.omega, "omega")


def _columns(sequence: str, frame: str, angles: Any) -> Any:
    """Return the matrix of ω = J (rates): the axes about which the angles turn."""
    _check_frame(frame)
    turns = _intrinsic(sequence, _angles_or_default(angles))
    columns = [_axis(axis) for axis, _ in turns]
    for k in range(3):
        # An axis is turned in space by the angles before it; the body has the later ones turned back.
        for axis, angle in turns[k + 1 :] if frame == "body" else turns[:k][::-1]:
            turn = _about(axis, angle)
            columns[k] = (turn.T if frame == "body" else turn) * columns[k]
    if _is_extrinsic(sequence):
        columns.reverse()
    return sympy.Matrix.hstack(*columns)


def _check_frame(frame: str) -> None:
    if frame not in ("body", "space"):
        raise ValueError(f"frame: expected 'body' or 'space', got {frame!r}")


def _angles_or_default(angles: Any) -> Any:
    return symbols.angles if angles is None else angles


def _is_extrinsic(sequence: str) -> bool:
    return sequence.islower() and sequence not in _NAMES


def _intrinsic(sequence: str, angles: Any) -> list[tuple[int, Any]]:
    """Return axes and angles in the order of the turning body's own axes."""
    letters = _NAMES.get(sequence, sequence)
    upper = letters.upper()
    mixed = letters not in (upper, letters.lower())
    if mixed or len(upper) != 3 or set(upper) - set("XYZ") or upper[0] == upper[1] or upper[1] == upper[2]:
        raise ValueError(
            f"sequence: {sequence!r} is not three axes, neighbours different, in one case, as 'ZXZ' or 'xyz'"
        )
    turns = list(zip(("XYZ".index(letter) for letter in upper), angles, strict=True))
    return turns if letters == upper else turns[::-1]


def _axis(axis: int) -> Any:
    """Return a coordinate axis."""
    return sympy.eye(3)[:, axis]


def _about(axis: int, angle: Any) -> Any:
    """Rotate about a coordinate axis."""
    c, s = sympy.cos(angle), sympy.sin(angle)
    turned = sympy.eye(3)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    turned[j, j], turned[j, k], turned[k, j], turned[k, k] = c, -s, s, c
    return turned


def _vector(given: Any, default: Any, name: str) -> Any:
    vector = default if given is None else sympy.Matrix(list(given))
    if vector.shape != (3, 1):
        raise ValueError(f"{name}: expected three components, got {vector.shape[0]}")
    return vector


def _principal(inertia: Any) -> Any:
    return sympy.diag(*symbols.moments) if inertia is None else sympy.Matrix(inertia)
