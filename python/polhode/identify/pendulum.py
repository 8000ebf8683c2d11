"""From periods of pendulums to a body: compound, torsional, bifilar and trifilar."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NoReturn

import numpy as np

from polhode._core import RigidBody, Uncertain
from polhode._format import one_line
from polhode._hints import check_kind
from polhode.errors import IdentificationError
from polhode.identify.cone import along_the_edge, fit_possible, second_moment_maps
from polhode.identify.results import (
    ELEMENTS,
    NUMBERS,
    Identified,
    find_directions,
    p_value_of,
    spread_directions,
    tensor_of,
)
from polhode.uncertainty.uncertain import join
from polhode.uncertainty.variables import of_forms

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]
    Complexes = NDArray[np.complex128]

__all__ = ["Pendulum", "bifilar", "compound", "from_pendulum", "torsional", "trifilar"]

_STEP: Final = 1e-30
"""Imaginary step of derivatives, which are exact to rounding."""
_DOUBLINGS: Final = 14
"""Doublings of the number of points of a quadrature."""
_PASSES: Final = 60
_OPEN: Final = 1e-9
"""Share of the largest singular value of the equations below which a direction is not determined."""
_ROUNDING: Final = 2e-15
"""Of a tensor: what `RigidBody` takes for one, relative to the trace."""
_BASIS: Final = np.array(tensor_of(np.eye(6)))


@dataclass(frozen=True, eq=False, repr=False)
class Pendulum:
    """A measured period, and the device on which the body swung.

    :func:`compound`, :func:`torsional`, :func:`bifilar` and :func:`trifilar` make it.

    Attributes
    ----------
    device : str
        ``"compound"``, ``"torsional"`` or ``"bifilar"``; a trifilar pendulum is a bifilar one with the
        distance of two radii.
    numbers : dict of str
        What was measured, by the names of the arguments.
    """

    device: str
    numbers: dict[str, Any]

    def __repr__(self) -> str:
        return f"<{self.device} pendulum, {one_line('', self.numbers).removeprefix('str')}>"

    def exact_period(self, body: RigidBody, gravity: float) -> float:
        """Compute the exact period of a body on this device, at its amplitude and decrement.

        Parameters
        ----------
        body : RigidBody
            One body; its sigmas do not matter.
        gravity : float
            Magnitude of the acceleration of gravity.

        Returns
        -------
        float

        Raises
        ------
        ValueError
            For a torsional pendulum of unknown stiffness.

        Examples
        --------
        A rod on its end, let go at 40 degrees; the small-angle formula gives 1.6379:

        >>> import numpy as np
        >>> from polhode import identify, rods
        >>> swing = identify.compound((0, 1, 0), (0, 0, 0.5), period=1.7, amplitude=np.deg2rad(40))
        >>> round(swing.exact_period(rods.rod(1.0, mass=1.0), gravity=9.81), 4)
        1.6893
        """
        check_kind(body, "body", "RigidBody")
        if body.shape != ():
            raise ValueError(f"body: expected one body, got a stack of shape {body.shape}")
        gravity = _positive("gravity", gravity)
        given = {name: np.asarray(_value(one)) for name, one in self.numbers.items() if one is not None}
        if "stiffness" not in given and self.device == "torsional":
            raise ValueError("stiffness: the wire of this pendulum has none; give its stiffness for a period")
        stiffness = given.get("stiffness")
        square = _square(self.device, given, body.mass, body.center_of_mass, body.inertia, stiffness, gravity)
        return float(np.sqrt(square))


def compound(axis: Any, about: Any, period: Any, amplitude: Any = 0.0, *, decrement: Any = 0.0) -> Pendulum:
    """Return the period of a body that swings about a horizontal axis.

    Each number may be uncertain: an `Uncertain`, or a ``ufloat`` of the package *uncertainties*.

    Parameters
    ----------
    axis : array_like, shape (3,)
        Direction of the axis in the body frame; its length does not matter.
    about : array_like, shape (3,)
        A point of the axis, in the body frame.
    period : float
        Time of one swing to and fro.
    amplitude : float
        Largest angle from rest, in radians.
    decrement : float
        Logarithmic decrement: the logarithm of the ratio of two amplitudes that follow one another. A
        linearly damped swing takes longer by the factor ``√(1 + (decrement/2π)²)``.

    Returns
    -------
    Pendulum

    Raises
    ------
    ValueError
        For a period that is not positive, or an amplitude outside [0, π).

    Examples
    --------
    >>> from polhode import Uncertain, identify
    >>> swing = identify.compound((0, 1, 0), (0, 0, 0.5), Uncertain(1.64, 0.001), amplitude=0.1)
    >>> swing.device
    'compound'
    """
    given = {"axis": axis, "about": about, "period": period, "amplitude": amplitude, "decrement": decrement}
    return _checked("compound", given)


def torsional(
    axis: Any,
    period: Any,
    stiffness: Any = None,
    fixture: Any = 0.0,
    *,
    known: Any = None,
    decrement: Any = 0.0,
) -> Pendulum:
    """Return the period of a body on a wire that is twisted.

    Parameters
    ----------
    axis : array_like, shape (3,)
        Direction of the wire in the body frame; it passes through the centre of mass.
    period : float
    stiffness : float, optional
        Torque per radian. Without it the wire is one of unknown stiffness, the same in all rows that have
        none; rows with `known` measure it in the same fit.
    fixture : float
        Moment of inertia of what holds the body.
    known : float, optional
        Moment of a reference body that hangs on the wire in place of the body.
    decrement : float
        As of :func:`compound`.

    Returns
    -------
    Pendulum

    Raises
    ------
    ValueError
        For a number that is not positive.

    Examples
    --------
    >>> from polhode import Uncertain, identify
    >>> rod = identify.torsional((0, 0, 1), Uncertain(1.894, 1e-4), known=0.511)  # calibrates the wire
    >>> rod.numbers["known"]
    0.511
    """
    given = {"axis": axis, "period": period, "decrement": decrement, "fixture": fixture}
    given |= {"stiffness": stiffness, "known": known}
    return _checked("torsional", given)


def bifilar(
    axis: Any,
    period: Any,
    length: Any,
    distance: Any,
    amplitude: Any = 0.0,
    plate_mass: Any = 0.0,
    plate_moment: Any = 0.0,
    *,
    decrement: Any = 0.0,
) -> Pendulum:
    """Return the period of a body on two wires, which turns about the vertical between them.

    Parameters
    ----------
    axis : array_like, shape (3,)
        Direction of the vertical in the body frame. It passes through the centre of mass.
    period : float
    length : float
        Of each wire. The wires are parallel at rest.
    distance : float
        Between the wires.
    amplitude : float
        Largest angle from rest, in radians.
    plate_mass, plate_moment : float
        Of the plate on which the body lies: its mass, and its moment about the vertical.
    decrement : float
        As of :func:`compound`.

    Returns
    -------
    Pendulum

    Raises
    ------
    ValueError
        For a number that is not positive, or an amplitude at which the wires would have to lie level.

    Examples
    --------
    >>> from polhode import identify
    >>> swing = identify.bifilar((0, 0, 1), period=2.01, length=1.5, distance=0.4, amplitude=0.5)
    >>> swing.numbers["distance"]
    0.4
    """
    given = {"axis": axis, "period": period, "length": length, "distance": distance, "amplitude": amplitude}
    given |= {"plate_mass": plate_mass, "plate_moment": plate_moment, "decrement": decrement}
    return _checked("bifilar", given)


def trifilar(
    axis: Any,
    period: Any,
    length: Any,
    radius: Any,
    amplitude: Any = 0.0,
    plate_mass: Any = 0.0,
    plate_moment: Any = 0.0,
    *,
    decrement: Any = 0.0,
) -> Pendulum:
    """Return the period of a body on a plate that hangs on three wires.

    Parameters
    ----------
    axis : array_like, shape (3,)
        Direction of the vertical in the body frame. It passes through the centre of mass and the middle of
        the wires.
    period, length : float
        As of :func:`bifilar`.
    radius : float
        Distance of each wire from the vertical.
    amplitude, plate_mass, plate_moment, decrement : float
        As of :func:`bifilar`.

    Returns
    -------
    Pendulum

    Raises
    ------
    ValueError
        As of :func:`bifilar`.

    Examples
    --------
    >>> from polhode import identify
    >>> plate = {"plate_mass": 0.4, "plate_moment": 0.005}
    >>> swing = identify.trifilar((0, 0, 1), 1.31, length=0.8, radius=0.15, **plate)
    >>> swing.numbers["radius"]
    0.15
    """
    given = {"axis": axis, "period": period, "length": length, "radius": radius, "amplitude": amplitude}
    given |= {"plate_mass": plate_mass, "plate_moment": plate_moment, "decrement": decrement}
    return _checked("bifilar", given)


_VECTORS: Final = ("axis", "about")
_POSITIVE: Final = ("period", "length", "distance", "radius", "stiffness", "known")


def _value(one: Any) -> Any:
    """Return the numbers of an argument that may be uncertain."""
    joined = join(one)
    return one if joined is None else joined.value


def _checked(device: str, given: dict[str, Any]) -> Pendulum:
    """Check the numbers of a pendulum."""
    values = {}
    for name, one in given.items():
        if one is None:
            continue
        value = np.asarray(_value(one), dtype=float)
        shape = (3,) if name in _VECTORS else ()
        if value.shape != shape:
            raise ValueError(f"{name}: expected shape {shape}, got {value.shape}")
        if not np.isfinite(value).all():
            raise ValueError(f"{name}: expected finite numbers, got {value.tolist()}")
        if name == "axis":
            if not 1e-100 < float(np.abs(value).max()) < 1e100:
                raise ValueError(f"axis: expected a direction, got {value.tolist()}")
        elif not shape and (value < 0.0 or (name in _POSITIVE and not 1e-100 < value < 1e100)):
            least = "a positive number" if name in _POSITIVE else "a number that is not negative"
            raise ValueError(f"{name}: expected {least}, got {value}")
        values[name] = value
    amplitude = float(values.get("amplitude", 0.0))
    if amplitude >= math.pi:
        raise ValueError(
            f"amplitude: expected radians in [0, pi), got {amplitude}; of degrees take np.deg2rad"
        )
    if device == "bifilar":
        distance = float(values["distance"] if "distance" in values else 2.0 * values["radius"])
        shift = distance * math.sin(0.5 * amplitude)
        if shift >= values["length"]:
            raise ValueError(
                f"amplitude: at {amplitude} the wires end {shift} aside, and are only {values['length']} long"
            )
    return Pendulum(device, given)


def _positive(name: str, number: Any) -> float:
    value = np.asarray(number, dtype=float)
    if value.shape != () or not 1e-100 < value < 1e100:
        raise ValueError(f"{name}: expected a positive number, got {number!r}")
    return float(value)


def _mean_by_agm(amplitude: Any) -> Any:
    """Return the arithmetic-geometric mean of 1 and cos(A/2), which is π / 2K(sin(A/2))."""
    a, b = 1.0 + 0.0 * amplitude, np.cos(0.5 * amplitude)
    for _ in range(8):
        a, b = 0.5 * (a + b), np.sqrt(a * b)
    return a


def _mean_by_sums(gyration: Any, length: Any, share: Any, top: Any) -> Any:
    """Compute the mean over ψ of √((k² + h'²)(q + Q)/2) / cos(φ/2) along a swing on wires.

    With sin(φ/2) = sin(A/2) sin ψ the integrand is an analytic function of sin²ψ, so sums over equidistant
    points converge exponentially. k² is J/M, h' the rise per angle, and q and Q the height of a wire at φ and
    at the amplitude A, relative to its length; `share` is D/L, `top` is sin(A/2).
    """
    at_top = np.sqrt(1.0 - share**2 * top**2)
    found: Any = 0.0
    for doubling in range(_DOUBLINGS):
        last, points = found, 8 << doubling
        s = top * np.sin((np.arange(points) + 0.5) * (0.5 * np.pi / points))
        q, c2 = np.sqrt(1.0 - share**2 * s**2), 1.0 - s**2
        rise = length**2 * share**4 * s**2 * c2 / (4.0 * q**2)
        found = np.mean(np.sqrt((gyration + rise) * (q + at_top) * 0.5 / c2))
        if abs(found - last) <= 1e-15 * abs(found):
            break
    return found


def _square(
    device: str, x: dict[str, Any], mass: Any, center: Any, tensor: Any, stiffness: Any, g: Any
) -> Any:
    """Compute the square of the period, of real or complex numbers."""
    damped = 4.0 * np.pi**2 * (1.0 + (x["decrement"] / (2.0 * np.pi)) ** 2)
    n = x["axis"] / np.sqrt(np.sum(x["axis"] ** 2))
    moment = n @ tensor @ n
    if device == "compound":
        arm = center - x["about"]
        square = np.sum(arm**2) - np.sum(n * arm) ** 2
        moment = moment + mass * square
        return damped * moment / (mass * g * np.sqrt(square) * _mean_by_agm(x["amplitude"]) ** 2)
    if device == "torsional":
        moment = x.get("known", moment) + x["fixture"]
        return damped * moment / stiffness
    distance = x["distance"] if "distance" in x else 2.0 * x["radius"]
    length, whole = x["length"], mass + x["plate_mass"]
    gyration = (moment + x["plate_moment"]) / whole
    mean = _mean_by_sums(gyration, length, distance / length, np.sin(0.5 * x["amplitude"]))
    return damped * 4.0 * length * mean**2 / (g * distance**2)


def from_pendulum(
    measurements: Sequence[Pendulum],
    *,
    gravity: Any,
    mass: Any = None,
    center_of_mass: Any = (0.0, 0.0, 0.0),
    normal: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    prior: RigidBody | None = None,
) -> Identified:
    """Find the most likely body from periods of pendulums.

    Parameters
    ----------
    measurements : list of Pendulum
        Periods of :func:`compound`, :func:`torsional`, :func:`bifilar` and :func:`trifilar` pendulums. Every
        number in them may be uncertain. One `Uncertain` in several rows is one source: its error is shared.
    gravity : float
        Magnitude of the acceleration of gravity. May be uncertain, as `mass` and `center_of_mass` may.
    mass : float, optional
        Without it the mass is estimated too, which takes pendulums of both kinds: on wires, and on an axis.
    center_of_mass : array_like, shape (3,), optional
        In the body frame, by default its origin. None to estimate it, from compound pendulums about several
        axes.
    normal : array_like, shape (3,), optional
        Normal of a plane through the centre of mass that mirrors the body: it is a principal axis.
    axis : array_like, shape (3,), optional
        Axis of revolution through the centre of mass.
    prior : RigidBody, optional
        What is known of the body beforehand: one with a covariance.

    Returns
    -------
    Identified
        Its body depends on the same sources as the measurements: two parts that were measured with one wire
        are correlated. `residuals`, shape (k, 1), are the errors of the sources. Where no number has a sigma,
        every period is taken to have the same relative sigma, ``noise``, from the residuals. If there are no
        more rows than unknowns, the covariance is NaN then, and the body carries none.

    Raises
    ------
    IdentificationError
        ``"undetermined"`` where the rows do not determine the body; `observability` of the error has every
        direction that they leave open. ``"contradiction"`` where exact rows contradict one another.
    ValueError
        For arguments that are no numbers, or not positive.

    Examples
    --------
    A brick on a wire of unknown stiffness, which a rod of known moment measures:

    >>> from polhode import Uncertain, identify
    >>> rows = [identify.torsional((0, 0, 1), Uncertain(2.0, 0.001), known=0.05)]
    >>> for a, period in (((1, 0, 0), 2.3), ((0, 1, 0), 3.1), ((0, 0, 1), 3.5)):
    ...     rows.append(identify.torsional(a, Uncertain(period, 0.001)))
    >>> for a, period in (((1, 1, 0), 2.73), ((1, 0, 1), 2.96), ((0, 1, 1), 3.31)):
    ...     rows.append(identify.torsional(a, Uncertain(period, 0.001)))
    >>> found = identify.from_pendulum(rows, gravity=9.81, mass=Uncertain(2.0, 0.01))
    >>> found.body.principal_moments.round(4)
    array([0.0661, 0.1201, 0.1531])
    >>> found.body.sigma.inertia.diagonal().round(5)
    array([9.0e-05, 1.4e-04, 1.8e-04])
    """
    rows = list(measurements)
    for row in rows:
        check_kind(row, "measurements", "Pendulum")
    if not rows:
        raise ValueError("measurements: expected at least one pendulum, got none")
    if prior is not None:
        check_kind(prior, "prior", "RigidBody")
        if prior.shape != () or prior._doubts() is None:
            raise ValueError("prior: expected one body with a covariance; give it one by with_covariance")
    return _Task(rows, gravity, mass, center_of_mass, normal, axis, prior).solve()


class _Task:
    """The unknown numbers, the measured ones, and the equations between them.

    Each row is an equation: the square of its exact period over the square of the measured one is 1. The
    measured numbers x are their values plus a linear form of independent errors u. The most likely unknowns
    are those of the smallest |u|² with which all equations hold.
    """

    def __init__(
        self,
        rows: list[Pendulum],
        gravity: Any,
        mass: Any,
        center_of_mass: Any,
        normal: ArrayLike | None,
        axis: ArrayLike | None,
        prior: RigidBody | None,
    ) -> None:
        _positive("gravity", _value(gravity))
        if mass is not None:
            _positive("mass", _value(mass))
        elif all(row.device == "torsional" for row in rows):
            raise ValueError("mass: periods on wires that are twisted do not depend on it; give the mass")
        self.rows, self.basis = rows, _basis(normal, axis)
        self.places: list[dict[str, slice | int]] = []
        cells: list[Any] = []

        def put(one: Any) -> slice | int:
            at = len(cells)
            if np.ndim(_value(one)) == 0:
                cells.append(one)
                return at
            cells.extend(_split(one))
            return slice(at, at + 3)

        for row in rows:
            self.places.append({name: put(one) for name, one in row.numbers.items() if one is not None})
        self.at_gravity: Any = put(gravity)
        self.at_mass: Any = None if mass is None else put(mass)
        self.at_center: Any = None
        if center_of_mass is not None:
            if np.shape(_value(center_of_mass)) != (3,):
                shape = np.shape(_value(center_of_mass))
                raise ValueError(f"center_of_mass: expected shape (3,), got {shape}")
            self.at_center = put(center_of_mass)
        joined = join(cells)
        self.x = np.array(cells if joined is None else joined.value, dtype=float)
        if not np.isfinite(self.x).all():
            raise ValueError("center_of_mass: expected finite numbers")
        self.columns: dict[tuple[int, int], int] = {}
        self.forms = np.zeros((len(cells), 0))
        if joined is not None:
            self.forms = self._matrix(joined._forms())
        self.prior = prior
        self.exact = not self.columns and prior is None
        self.wire = any(row.device == "torsional" and row.numbers["stiffness"] is None for row in rows)
        self.unknown = [] if mass is not None else ["mass"]
        self.unknown += [] if center_of_mass is not None else list(NUMBERS[1:4])
        self.first = len(self.unknown)
        self.unknown += [f"tensor {k}" for k in range(len(self.basis))]
        self.unknown += ["stiffness of the wire"] if self.wire else []

    def _matrix(self, forms: Any) -> Floats:
        for form in forms:
            for variable, _ in form:
                self.columns.setdefault(tuple(variable), len(self.columns))
        found = np.zeros((len(forms), len(self.columns)))
        for k, form in enumerate(forms):
            for variable, step in form:
                found[k, self.columns[tuple(variable)]] += step
        return found

    def numbers_of(self, z: Any, x: Any) -> Any:
        """Return mass, centre of mass and tensor."""
        mass = z[0] if self.at_mass is None else x[self.at_mass]
        at = 1 if self.at_mass is None else 0
        center = z[at : at + 3] if self.at_center is None else x[self.at_center]
        tensor = np.tensordot(z[self.first : self.first + len(self.basis)], self.basis, 1)
        return mass, center, tensor

    def equation(self, k: int, z: Any, x: Any) -> Any:
        """Compute the square of an exact period over that of the measured one, minus 1."""
        mass, center, tensor = self.numbers_of(z, x)
        given = {name: x[at] for name, at in self.places[k].items()}
        stiffness = given.get("stiffness", z[-1] if self.wire else None)
        square = _square(self.rows[k].device, given, mass, center, tensor, stiffness, x[self.at_gravity])
        return square / given["period"] ** 2 - 1.0

    def equations(self, z: Floats, x: Floats) -> tuple[Floats, Floats, Floats]:
        """Compute the equations, and their derivatives by the unknowns and by the measured numbers."""
        found = np.array([self.equation(k, z, x) for k in range(len(self.rows))])
        by_z, by_x = np.zeros((len(found), len(z))), np.zeros((len(found), len(x)))
        moving = (self.forms != 0.0).any(axis=1)
        for k, places in enumerate(self.places):
            shared = [self.at_gravity, self.at_mass, self.at_center]
            own = np.concatenate(
                [np.arange(len(x))[at].ravel() for at in (*places.values(), *shared) if at is not None]
            )
            for point, which, columns in ((z, range(len(z)), by_z), (x, own[moving[own]], by_x)):
                for place in which:
                    step, moved = _STEP * max(abs(point[place]), 1e-3), point.astype(complex)
                    moved[place] += 1j * step
                    value = self.equation(k, *((moved, x) if point is z else (z, moved)))
                    columns[k, place] = np.imag(value) / step
        return found, by_z, by_x

    def start(self) -> tuple[Floats, Floats]:
        """Return unknowns to begin with, and their sizes."""
        mass = float(self.x[self.at_mass]) if self.at_mass is not None else 1.0
        wires = [
            4.0 * np.pi**2 * (self.x[at["known"]] + self.x[at["fixture"]]) / self.x[at["period"]] ** 2
            for row, at in zip(self.rows, self.places, strict=True)
            if "known" in at and "stiffness" not in at
        ]
        stiffness = float(np.mean(wires)) if wires else 1.0
        gravity = float(self.x[self.at_gravity])
        moments: list[float] = []
        for row, place in zip(self.rows, self.places, strict=True):
            given: dict[str, Any] = {name: self.x[one] for name, one in place.items()}
            if "known" in given:
                continue
            turn = (given["period"] / (2.0 * np.pi)) ** 2
            if row.device == "torsional":
                moments.append(given.get("stiffness", stiffness) * turn - given["fixture"])
            elif row.device == "bifilar":
                distance = given["distance"] if "distance" in given else 2.0 * given["radius"]
                whole = mass + given["plate_mass"]
                moments.append(whole * gravity * distance**2 * turn / (4.0 * given["length"]))
            else:
                center = np.zeros(3) if self.at_center is None else self.x[self.at_center]
                n = given["axis"] / np.linalg.norm(given["axis"])
                arm = float(np.linalg.norm(np.cross(center - given["about"], n)))
                if self.at_center is not None and arm <= 1e-12 * float(np.abs(given["about"]).max()):
                    raise ValueError(
                        f"about: the axis through {given['about'].tolist()} meets the centre of mass, "
                        "and the body does not swing; check about= and center_of_mass="
                    )
                moments.append(mass * max(float(gravity * arm * turn) - arm**2, 0.04 * arm**2))
        moment = float(np.mean([one for one in moments if one > 0.0] or [mass]))
        z = np.zeros(len(self.unknown))
        z[self.first : self.first + len(self.basis)] = np.linalg.lstsq(
            self.basis.reshape(len(self.basis), -1).T, (moment * np.eye(3)).ravel(), rcond=None
        )[0]
        sizes = np.full(len(z), moment)
        if self.at_mass is None:
            z[0] = sizes[0] = mass
        if self.at_center is None:
            first = 0 if self.at_mass is not None else 1
            sizes[first : first + 3] = math.sqrt(moment / mass)
        if self.wire:
            z[-1] = sizes[-1] = stiffness
        return z, sizes

    def prior_rows(self, z: Floats) -> tuple[Floats, Floats, Floats]:
        """Return residuals, slopes and forms of what the prior says of the unknowns."""
        assert self.prior is not None
        doubts = self.prior._doubts()
        assert doubts is not None
        variables = [tuple(pair) for pair in doubts["variables"].tolist()]
        for pair in variables:
            self.columns.setdefault(pair, len(self.columns))
        forms = np.zeros((10, len(self.columns)))
        forms[:, [self.columns[pair] for pair in variables]] = doubts["tangents"].T
        elements = np.array([self.prior.inertia[i, j] for i, j in ELEMENTS])
        numbers = np.concatenate([[self.prior.mass], self.prior.center_of_mass, elements])
        to_basis = np.linalg.pinv(np.array([[one[i, j] for i, j in ELEMENTS] for one in self.basis]).T)
        pick = np.zeros((len(self.unknown), 10))
        names = [name for name in self.unknown if name in NUMBERS]
        for k, name in enumerate(names):
            pick[k, NUMBERS.index(name)] = 1.0
        pick[self.first : self.first + len(self.basis), 4:] = to_basis
        used = np.arange(self.first + len(self.basis))
        slope = np.eye(len(self.unknown))[used]
        return z[used] - pick[used] @ numbers, slope, -pick[used] @ forms

    def solve(self) -> Identified:
        z, sizes = self.start()
        count, u = len(z), np.zeros(0)
        for _ in range(_PASSES):
            prior = None if self.prior is None else self.prior_rows(z)
            forms = np.pad(self.forms, ((0, 0), (0, len(self.columns) - self.forms.shape[1])))
            u = np.pad(u, (0, max(0, len(self.columns) - len(u)))) if not self.exact else u
            x = self.x + forms @ u if not self.exact else self.x
            g, by_z, by_x = self.equations(z, x)
            # Where nothing has a sigma every period has the same relative one.
            by_u = 2.0 * np.eye(len(g)) if self.exact else by_x @ forms
            if self.exact and not u.size:
                u = np.zeros(len(g))
            target = g - by_u @ u if not self.exact else g
            if prior is not None:
                off, slope, own = prior
                scale = sizes[: len(off)]
                target = np.concatenate([target, off / scale])
                by_z = np.vstack([by_z, slope / scale[:, None]])
                by_u = np.vstack([by_u, own / scale[:, None]])
            jacobian = by_z * sizes
            left, values, right = np.linalg.svd(jacobian, full_matrices=True)
            if len(values) < count or values[-1] <= _OPEN * values[0]:
                self._refuse(z, x, sizes, prior)
            inverse = (right.T / values) @ left[:, :count].T
            rest = left[:, count:].T
            # The least |u| with which the equations beyond the unknowns hold.
            free = rest @ by_u
            back = np.linalg.pinv(free, rcond=1e-12) if free.size else np.zeros((by_u.shape[1], len(rest)))
            new = -back @ (rest @ target)
            left_over = float(np.abs(rest @ target + free @ new).max(initial=0.0))
            change = -inverse @ (target + by_u @ new) * sizes
            limit = self._within(z, change, sizes)
            z, moved = z + limit * change, float(np.abs(change / sizes).max(initial=0.0))
            settled = float(np.abs(new - u).max(initial=0.0)) < 1e-9 * (
                1.0 + float(np.abs(new).max(initial=0.0))
            )
            u = new
            if moved < 1e-11 and settled:
                break
        else:
            raise IdentificationError(
                "measurements: no body fits these periods; the last step still changed it by ",
                f"{moved:.2g}",
                " of its size; check units, amplitudes and which row has which axis",
                kind="no fit",
            )
        # What the equations leave of the errors; the truth is the estimate plus `spread` times them.
        left_of = np.eye(by_u.shape[1]) - back @ free
        if left_over > 1e-9:
            raise IdentificationError(
                "measurements: rows without a sigma contradict one another by ",
                f"{left_over:.2g}",
                " of the square of a period; give their numbers sigmas: Uncertain(period, sigma)",
                kind="contradiction",
            )
        spread = -inverse @ by_u @ left_of * sizes[:, None]
        return self._result(
            z, u, spread, forms @ left_of if not self.exact else forms, forms, sizes, len(jacobian)
        )

    def _within(self, z: Floats, change: Floats, sizes: Floats) -> float:
        """Return the share of a step that keeps every moment and the stiffness positive."""
        share, old = 1.0, self.numbers_of(z, self.x)[0]
        for _ in range(40):
            mass, _, tensor = self.numbers_of(z + share * change, self.x)
            wire = z[-1] + share * change[-1] > 0.1 * z[-1] if self.wire else True
            if mass > 0.1 * old and wire and np.linalg.eigvalsh(tensor)[0] > -1e-3 * sizes[self.first]:
                break
            share *= 0.5
        return share

    def _refuse(self, z: Floats, x: Floats, sizes: Floats, prior: tuple[Floats, ...] | None) -> NoReturn:
        """Raise the error that names what the rows leave open, at unknowns that explain them."""
        for _ in range(_PASSES):
            g, by_z, _ = self.equations(z, x)
            change = -np.linalg.pinv(by_z * sizes, rcond=_OPEN) @ g * sizes
            z = z + self._within(z, change, sizes) * change
            if np.abs(change / sizes).max() < 1e-9:
                break
        by_z = self.equations(z, x)[1]
        if prior is not None:
            by_z = np.vstack([by_z, prior[1] / sizes[: len(prior[1]), None]])
        names, to_numbers, own = self._names(sizes)
        back = np.linalg.pinv(to_numbers)
        # Numbers that a symmetry excludes are not open.
        barred = (np.eye(len(own)) - to_numbers @ back) / own
        remedy = "let it swing about further axes, or give what is known by normal=, axis= or prior="
        found, _ = find_directions(np.vstack([by_z @ back, barred]), own, names, remedy, _OPEN)
        open_ones = tuple(one for one in found if not math.isfinite(one.relative))
        raise IdentificationError(
            f"measurements: {len(self.rows)} rows leave undetermined: ",
            "; ".join(one.words for one in open_ones) or "combinations of the unknowns",
            f"; {remedy}",
            kind="undetermined",
            observability=open_ones,
        )

    def _names(self, sizes: Floats) -> tuple[list[str], Floats, Floats]:
        """Return names of what is estimated, the matrix that makes it of the unknowns, and its sizes."""
        head = self.unknown[: self.first]
        tail = ["stiffness of the wire"] if self.wire else []
        names = [*head, *NUMBERS[4:], *tail]
        matrix = np.zeros((len(names), len(self.unknown)))
        matrix[: self.first, : self.first] = np.eye(self.first)
        six = np.array([[one[i, j] for i, j in ELEMENTS] for one in self.basis]).T
        matrix[self.first : self.first + 6, self.first : self.first + len(self.basis)] = six
        if self.wire:
            matrix[-1, -1] = 1.0
        moment = sizes[self.first]
        own = np.concatenate([sizes[: self.first], np.full(6, moment), sizes[-1:] if self.wire else []])
        return names, matrix, own

    def _result(
        self, z: Floats, u: Floats, spread: Floats, moved: Floats, forms: Floats, sizes: Floats, rows: int
    ) -> Identified:
        count = len(z)
        freedom, chi2 = rows - count, float(u @ u)
        noise, unknown_sigma = None, False
        if self.exact:
            unknown_sigma = freedom == 0
            level = math.sqrt(chi2 / freedom) if freedom else 0.0
            spread = spread * level
            if freedom:
                u = u / level if level > 0.0 else u
                chi2 = float(u @ u)
                noise = Uncertain(level, level / math.sqrt(2.0 * freedom))
        p_value = math.nan if self.exact else p_value_of(chi2, freedom)
        if p_value < 1e-6:
            raise IdentificationError(
                f"measurements: chi2 is {chi2:.6g} with {freedom} degrees of freedom; ",
                "errors of these sigmas do not explain the periods; ",
                "check which row has which axis and amplitude, or enlarge the sigmas",
                kind="no fit",
            )
        names, to_numbers, own = self._names(sizes)
        x = self.x if self.exact else self.x + forms @ u
        tensor_at = slice(self.first, self.first + len(self.basis))
        maps = second_moment_maps(self.basis)
        covariance = spread @ spread.T
        crlb, edge, gap = covariance, False, 0.0
        second = np.tensordot(z[tensor_at], maps, 1)
        if np.linalg.eigvalsh(second)[0] < -_ROUNDING * float(np.trace(second)):
            edge = True
            inner = covariance[tensor_at, tensor_at]
            size = float(np.trace(np.tensordot(z[tensor_at], self.basis, 1))) / 3.0
            inner = inner + 1e-24 * size**2 * np.eye(len(inner))
            factor: Floats = np.asarray(np.linalg.inv(np.linalg.cholesky(inner)), dtype=np.float64)
            ball = np.asarray(
                np.linalg.lstsq(
                    self.basis.reshape(len(self.basis), -1).T, (size * np.eye(3)).ravel(), rcond=None
                )[0],
                dtype=np.float64,
            )
            best, gap, _ = fit_possible(factor, factor @ z[tensor_at], maps, ball, chi2)
            chi2 += float(np.sum((factor @ (best - z[tensor_at])) ** 2))
            # The other unknowns go with the tensor.
            follow = covariance[:, tensor_at] @ np.linalg.solve(inner, best - z[tensor_at])
            kept = along_the_edge(inner, maps, best)
            z = z + follow
            z[tensor_at] = best
            gain = covariance[:, tensor_at] @ np.linalg.solve(inner, kept - np.eye(len(kept)))
            spread = spread + gain @ spread[tensor_at]
            covariance = spread @ spread.T
        mass, center, tensor = self.numbers_of(z, x)
        columns = np.zeros((10, spread.shape[1]))
        if self.at_mass is None:
            columns[0] = spread[0]
        elif not self.exact:
            columns[0] = moved[self.at_mass]
        if self.at_center is None:
            at = 1 if self.at_mass is None else 0
            columns[1:4] = spread[at : at + 3]
        elif not self.exact:
            columns[1:4] = moved[self.at_center]
        columns[4:] = to_numbers[self.first : self.first + 6] @ spread
        body = self._body(mass, center, tensor, columns)
        estimate = to_numbers @ z
        scale = np.concatenate([own[: self.first], np.full(6, np.trace(tensor) / 3.0), own[self.first + 6 :]])
        whole = to_numbers @ covariance @ to_numbers.T
        bound = to_numbers @ crlb @ to_numbers.T
        remedy = "measure the periods better, or about axes that tell more of it"
        observability = spread_directions(to_numbers @ spread, scale, names, remedy)
        if unknown_sigma:
            whole, bound, observability = np.full_like(whole, np.nan), np.full_like(bound, np.nan), ()
        return Identified(
            body=body, parameters=tuple(names), estimate=estimate, covariance=whole, crlb=bound,
            residuals=u[:, None], chi2=chi2, degrees_of_freedom=freedom,
            p_value=p_value,
            noise=noise, bias=None, at_edge=edge, linear=not edge, gap=gap,
            observability=observability, scale_known=True, dropped={},
        )  # fmt: skip

    def _body(self, mass: float, center: Floats, tensor: Floats, columns: Floats) -> RigidBody:
        """Return the body, whose numbers depend on the sources of the measurements."""
        if self.exact:
            body = RigidBody(mass=mass, inertia=tensor, center_of_mass=center)
            return body.with_covariance(columns @ columns.T) if columns.any() else body
        variables = list(self.columns)
        forms = [
            [(pair, float(step)) for pair, step in zip(variables, one, strict=True) if step]
            for one in columns
        ]
        places = {pair: k for k, pair in enumerate(ELEMENTS)}
        order = [4 + places[min(i, j), max(i, j)] for i in range(3) for j in range(3)]
        return RigidBody(
            mass=of_forms(np.asarray(mass), forms[:1]),
            inertia=of_forms(np.asarray(tensor), [forms[k] for k in order]),
            center_of_mass=of_forms(np.asarray(center), forms[1:4]),
        )


def _split(one: Any) -> list[Any]:
    """Return the three numbers of a vector, each with its own sources."""
    joined = join(one)
    if joined is None:
        return [float(part) for part in np.asarray(one, dtype=float)]
    forms = joined._forms()
    return [of_forms(np.asarray(value), [form]) for value, form in zip(joined.value, forms, strict=True)]


def _basis(normal: ArrayLike | None, axis: ArrayLike | None) -> Floats:
    """Return a basis of the tensors of a body with these symmetries, shape (p, 3, 3)."""
    laws: list[Floats] = []
    for name, given in (("normal", normal), ("axis", axis)):
        if given is None:
            continue
        vector = np.asarray(given, dtype=float)
        if vector.shape != (3,) or not np.isfinite(vector).all() or not vector.any():
            raise ValueError(f"{name}: expected a direction of shape (3,), got {given!r}")
        vector = vector / np.linalg.norm(vector)
        across = np.linalg.svd(vector[None])[2][1:]
        laws += [np.einsum("i,kij,j", one, _BASIS, vector) for one in across]
        if name == "axis":
            laws.append(np.einsum("i,kij,j", across[0], _BASIS, across[1]))
            laws.append(np.einsum("i,kij,j", across[0], _BASIS, across[0]))
            laws[-1] = laws[-1] - np.einsum("i,kij,j", across[1], _BASIS, across[1])
    if not laws:
        return _BASIS
    values, rows = np.linalg.svd(np.array(laws))[1:]
    rank = int((values > 1e-9).sum())
    return np.asarray(np.tensordot(rows[rank:], _BASIS, 1))
