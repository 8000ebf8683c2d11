"""Rolling: a body with a convex surface on a plane, which it touches in one point.

A surface is fixed in the body, and its places are from the origin of the body frame. :func:`plane` makes the
contact that :meth:`polhode.RigidBody.simulate` takes as ``contact=``. The body rolls without slipping,
whatever force that takes, or slips, or does one after the other with dry friction. ``motion.contact`` is a
:class:`ContactHistory` and has the force of the plane, the friction needed, the slip and more.

:func:`cylinder` and :func:`cone` lie on a plane along a line. Of these, and of a homogeneous ball,
:meth:`polhode.RigidBody.rolling_motion` computes the motion in closed form.

:func:`steady`, :func:`critical_rate`, :func:`preferred_sense` and :func:`tippe_top` answer without a
simulation which motions are steady on a level plane, and which of them are stable.

The body touches one plane, at rest or turning. Impacts, two contacts at once and soft ground are
left to engines of many bodies such as MuJoCo, Drake or Chrono.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from polhode._core import (
    Contact,
    RuledSurface,
    Surface,
    rolling_critical_rate,
    rolling_modes,
    rolling_steady,
    rolling_tippe_top,
)
from polhode._core import rolling_plane as plane
from polhode._core import ruled_cone as cone
from polhode._core import ruled_cylinder as cylinder
from polhode._core import surface_disk as disk
from polhode._core import surface_ellipsoid as ellipsoid
from polhode._core import surface_paraboloid as paraboloid
from polhode._core import surface_sphere as sphere
from polhode._core import surface_torus as torus
from polhode._format import short
from polhode.motion.contact import ContactHistory, Extreme

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode._core import RigidBody

    Floats = NDArray[np.float64]

__all__ = [
    "Contact",
    "ContactHistory",
    "Extreme",
    "Rattleback",
    "Resistance",
    "RuledSurface",
    "Steady",
    "Surface",
    "TippeTop",
    "cone",
    "critical_rate",
    "cylinder",
    "disk",
    "ellipsoid",
    "paraboloid",
    "plane",
    "preferred_sense",
    "resistance",
    "sphere",
    "steady",
    "tippe_top",
    "torus",
]

_DOWN = (0.0, 0.0, -9.81)


class Resistance(NamedTuple):
    """The resistance of a plane to rolling and pivoting, made by :func:`resistance`.

    Attributes
    ----------
    viscous : float
    pivoting : float
    arm : float
    """

    viscous: float = 0.0
    pivoting: float = 0.0
    arm: float = 0.0


def resistance(viscous: float = 0.0, pivoting: float = 0.0, arm: float = 0.0) -> Resistance:
    """Make a resistance to rolling and pivoting, for ``resistance=`` of :func:`plane`.

    The couple on the body is ``-viscous ω_t - pivoting (ω·n) n - arm N ω_t/|ω_t|`` with the normal n of the
    plane, the part ω_t of the angular velocity across it, and the normal force N.

    Parameters
    ----------
    viscous, pivoting : float, optional
        In units of torque times time; zero by default.
    arm : float, optional
        A length: how far ahead of the contact the normal force acts; zero by default. With an arm the body
        must turn, and the run ends with the status "rest" where it ceases to.

    Returns
    -------
    Resistance

    Raises
    ------
    PolhodeError
        From :func:`plane`, if a number is negative or not finite.

    Examples
    --------
    A ball on grass comes to rest after ``7 a v/(5 arm g)``, since the couple slows it with ``5 arm g/(7 a)``:

    >>> from polhode import loads, rolling, solids
    >>> grass = rolling.plane(rolling.sphere(0.05), resistance=rolling.resistance(arm=0.005))
    >>> gravity = loads.uniform_gravity((0, 0, -9.81))
    >>> motion = solids.sphere(0.05, mass=0.9).simulate([0, 9], omega=(0, 40, 0), load=gravity, contact=grass)
    >>> motion.status, motion.events.t.round(6)
    ('rest', array([2.85...]))
    """
    return Resistance(float(viscous), float(pivoting), float(arm))


class Steady(NamedTuple):
    """A steady motion of a body of revolution that rolls on a level plane: its contact goes round a circle.

    Attributes
    ----------
    omega : numpy.ndarray, shape (3,)
        Angular velocity, components in the body frame, at the attitude `quaternion`.
    quaternion : numpy.ndarray, shape (4,)
        An attitude R_NB at which the motion is steady; the plane is normal to z.
    turn : float
        Rate about the normal of the plane.
    spin : float
        Rate about the axis of the body. The angular velocity is the sum of turn and spin.
    radius : float
        Radius of the circle of the contact.
    friction_needed : float
        The coefficient of friction must be larger.
    eigenvalues : numpy.ndarray of complex, shape (2,)
        Rates of small changes ``exp(rate·t)``. Four more are zero.
    stable : bool
        Whether small changes stay small.
    """

    omega: Floats
    quaternion: Floats
    turn: float
    spin: float
    radius: float
    friction_needed: float
    eigenvalues: NDArray[np.complex128]
    stable: bool

    def __repr__(self) -> str:
        return (
            f"<Steady: turn={self.turn:.6g}, spin={self.spin:.6g}, radius={self.radius:.6g}, "
            f"friction_needed={self.friction_needed:.6g}, {'stable' if self.stable else 'unstable'}>"
        )


class Rattleback(NamedTuple):
    """The two modes of a body that spins upright on a level plane.

    Attributes
    ----------
    growth_rates : numpy.ndarray, shape (2,)
        Of the faster mode first; where one is positive the mode grows.
    frequencies : numpy.ndarray, shape (2,)
        In radians per unit of time.
    sense : float
        1.0 if the body prefers to turn with a positive rate, -1.0 with a negative one: the sense in which the
        mode that changes faster decays. 0.0 if it prefers none.
    """

    growth_rates: Floats
    frequencies: Floats
    sense: float

    def __repr__(self) -> str:
        return short(self)


class TippeTop(NamedTuple):
    """What becomes of a tippe top that spins upright on a plane with friction.

    A tippe top is a ball with its centre of mass below its centre.

    Attributes
    ----------
    verdict : str
        "inverts", "tumbles" if it ends at an inclination in between, or "stays upright".
    cos_theta : float
        Cosine of the final inclination of the axis.
    jellett : float
        Jellett's constant of the upright spin, which friction does not change.
    upright_unstable_beyond : float
        The spin beyond which the upright top is unstable; inf if it never is.
    inverted_stable_beyond : float
        The spin of the inverted top beyond which it is stable; inf if it never is.
    """

    verdict: Literal["inverts", "tumbles", "stays upright"]
    cos_theta: float
    jellett: float
    upright_unstable_beyond: float
    inverted_stable_beyond: float

    def __repr__(self) -> str:
        return short(self)


def steady(
    body: RigidBody,
    surface: Surface,
    *,
    inclination: float,
    gravity: ArrayLike = _DOWN,
    turn: float | None = None,
    spin: float | None = None,
    degrees: bool = False,
) -> tuple[Steady, ...]:
    """Compute the steady circles of a body of revolution on a level plane.

    Parameters
    ----------
    body : RigidBody
        With equal moments across the axis of the surface, and C on that axis.
    surface : Surface
        A surface of revolution.
    inclination : float
        Angle from the axis of the body to the normal of the plane, between 0 and pi; in radians, or in
        degrees if `degrees` is True.
    gravity : array_like, shape (3,)
        The plane is normal to it.
    turn, spin : float
        Rate about the normal, or rate about the axis of the body; exactly one of them.
    degrees : bool
        Whether `inclination` is in degrees.

    Returns
    -------
    tuple of Steady
        One with a given turn. With a given spin two, the faster turn first, or one.

    Raises
    ------
    PolhodeError
        If the body or its surface is not one of revolution, or no steady motion has this rate.

    Notes
    -----
    Source: Routh, Advanced Rigid Dynamics (1884), sections 244 to 248.

    Examples
    --------
    >>> from polhode import rolling, solids
    >>> coin = solids.cylinder(0.012, 0.0, mass=0.006)
    >>> rolling.steady(coin, rolling.disk(0.012), inclination=1.2, turn=8.0)
    (<Steady: turn=8, spin=...stable>,)
    """
    if degrees:
        inclination = np.deg2rad(inclination)
    found = []
    for omega, quaternion, *numbers, squared in rolling_steady(
        body, surface, inclination, gravity, turn, spin
    ):
        root = np.sqrt(complex(squared))
        turning, spinning, radius, friction = numbers
        pair = np.array([root, -root])
        found.append(Steady(omega, quaternion, turning, spinning, radius, friction, pair, squared < 0.0))
    return tuple(found)


def critical_rate(
    body: RigidBody,
    surface: Surface,
    gravity: ArrayLike = _DOWN,
    motion: Literal["rolling", "spinning"] = "rolling",
) -> float:
    """Compute the rate from which a body of revolution is stable with its axis level.

    Parameters
    ----------
    body : RigidBody
    surface : Surface
    gravity : array_like, shape (3,)
        The plane is normal to it.
    motion : {"rolling", "spinning"}
        In a straight line, or upright on the spot about the normal.

    Returns
    -------
    float

    Raises
    ------
    PolhodeError
        If the body is not one of revolution, is not balanced there, or has no critical rate.

    Notes
    -----
    For a disk with the moments I_s along its axis and I_t across it these are
    ``√(g I_t m a/(I_s (I_s + m a²)))`` and ``√(m g a/(I_t + m a²))``.

    Examples
    --------
    >>> from polhode import rolling, solids
    >>> round(rolling.critical_rate(solids.cylinder(0.5, 0.0, mass=1.0), rolling.disk(0.5)), 6)
    2.557342
    >>> round((9.81 / (3 * 0.5)) ** 0.5, 6)
    2.557342
    """
    return rolling_critical_rate(body, surface, gravity, motion)


def preferred_sense(
    body: RigidBody, surface: Surface, gravity: ArrayLike = _DOWN, *, rate: float
) -> Rattleback:
    """Compute the modes of a body that spins upright, as a rattleback does.

    Parameters
    ----------
    body : RigidBody
    surface : Surface
        Its third axis is along the normal of the plane, so that an ellipsoid touches with the end of its
        third semi-axis, and a paraboloid with its apex.
    gravity : array_like, shape (3,)
        The plane is normal to it.
    rate : float
        Rate about the normal.

    Returns
    -------
    Rattleback

    Raises
    ------
    PolhodeError
        If the spin is not steady: C must be above the contact, and the normal a principal axis.

    Examples
    --------
    >>> from polhode import RigidBody, rolling
    >>> tensor = [[2e-4, 2e-5, 0], [2e-5, 1.6e-3, 0], [0, 0, 1.7e-3]]
    >>> celt = RigidBody(1.0, inertia=tensor, center_of_mass=(0, 0, -0.01))
    >>> there = rolling.preferred_sense(celt, rolling.ellipsoid((0.2, 0.03, 0.02)), rate=5.0)
    >>> back = rolling.preferred_sense(celt, rolling.ellipsoid((0.2, 0.03, 0.02)), rate=-5.0)
    >>> there.sense == back.sense, bool(there.growth_rates[0] * back.growth_rates[0] < 0)
    (True, True)
    """
    growth, frequencies = (np.array(one) for one in rolling_modes(body, surface, gravity, rate))
    largest = growth[np.argmax(np.abs(growth))]
    is_none = abs(largest) <= _NO_GROWTH * np.max(frequencies, initial=abs(rate))
    return Rattleback(growth, frequencies, 0.0 if is_none else float(-np.sign(rate) * np.sign(largest)))


_NO_GROWTH = 1e-9
"""A growth rate that small, relative to the frequencies, is rounding."""


def tippe_top(body: RigidBody, surface: Surface, spin: float, gravity: ArrayLike = _DOWN) -> TippeTop:
    """Compute what becomes of a tippe top that spins upright on a plane with friction.

    Parameters
    ----------
    body : RigidBody
        Its centre of mass is off the centre of the sphere, on the axis of its moments.
    surface : Surface
        A sphere.
    spin : float
        Rate about the normal at the start.
    gravity : array_like, shape (3,)
        The plane is normal to it.

    Returns
    -------
    TippeTop

    Raises
    ------
    PolhodeError
        If the body is no such ball.

    Notes
    -----
    Friction of any law keeps Jellett's constant λ and takes energy until the slip has ceased. The energy is
    then ``λ²/(2 d·I d) + m g h`` with the vector d from the contact to C, whose height is h. From upright the
    top comes to the first minimum. Source: Ebenfeld and Scheck, Annals of Physics 243 (1995) 195.

    Examples
    --------
    >>> from polhode import RigidBody, rolling
    >>> top = RigidBody.from_principal(0.006, (8e-7, 8e-7, 8e-7), center_of_mass=(0, 0, -0.003))
    >>> rolling.tippe_top(top, rolling.sphere(0.02), spin=200.0).verdict
    'inverts'
    >>> rolling.tippe_top(top, rolling.sphere(0.02), spin=1.0).verdict
    'stays upright'
    """
    cos_theta, *others = rolling_tippe_top(body, surface, spin, gravity)
    verdict: Literal["inverts", "tumbles", "stays upright"] = (
        "stays upright" if cos_theta == 1.0 else "inverts" if cos_theta == -1.0 else "tumbles"
    )
    return TippeTop(verdict, cos_theta, *others)


if not TYPE_CHECKING:
    from polhode._hints import explain_calls, no_name

    explain_calls(globals(), __all__)

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        raise no_name(__name__, name, __all__)
