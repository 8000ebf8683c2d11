"""Results of computations, as named tuples and small classes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode._format import one_line, short
from polhode.principal import (
    TOP_RTOL,
    ContinuousAxes,
    PrincipalAxes,
    PrincipalDerivative,
    PrincipalLinear,
    PrincipalSigma,
)
from polhode.tops import FreePrecession, NutationDamping

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = [
    "TOP_RTOL",
    "AngularMomentum",
    "BoxFit",
    "ContinuousAxes",
    "ErrorBound",
    "FreePrecession",
    "Invariants",
    "KineticEnergy",
    "Linear",
    "MotionSensitivity",
    "NearestValid",
    "NutationDamping",
    "Particles",
    "PrincipalAxes",
    "PrincipalDerivative",
    "PrincipalLinear",
    "PrincipalSigma",
    "Provenance",
    "Sigma",
    "State",
]


class KineticEnergy(NamedTuple):
    """Kinetic energy in its three parts, T = ½ m v² + m v·(ω×c_P) + ½ ω·I_P·ω.

    P is the reference point `about`, v its velocity, c_P the vector from P to the centre of mass, I_P the
    tensor about P.

    Attributes
    ----------
    translational, mixed, rotational : numpy.ndarray, shape (...)
        The three parts, in the order of the formula.
    """

    translational: Floats
    mixed: Floats
    rotational: Floats

    def __repr__(self) -> str:
        return short(self)

    @property
    def total(self) -> Floats:
        """The sum of the three parts."""
        return self.translational + self.mixed + self.rotational


class AngularMomentum(NamedTuple):
    """Angular momentum in its three parts, L = m R×v + m [R×(ω×c_P) + c_P×v] + I_P ω.

    P is the reference point `about`, R its position and v its velocity, c_P the vector from P to the centre
    of mass, I_P the tensor about P.

    Attributes
    ----------
    orbital, mixed, spin : numpy.ndarray, shape (..., 3)
        The three parts, in the order of the formula.
    """

    orbital: Floats
    mixed: Floats
    spin: Floats

    def __repr__(self) -> str:
        return short(self)

    @property
    def total(self) -> Floats:
        """The sum of the three parts."""
        return self.orbital + self.mixed + self.spin


class NearestValid(NamedTuple):
    """The nearest possible tensor, shape (..., 3, 3), and its distance from the given one, shape (...)."""

    inertia: Floats
    distance: Any

    def __repr__(self) -> str:
        return short(self)


class BoxFit(NamedTuple):
    """Whether a body of the size of a box could have given mass properties.

    Attributes
    ----------
    possible : bool or numpy.ndarray, shape (...)
        Whether every condition holds.
    margin : float or numpy.ndarray, shape (...)
        Margin of the tightest condition, divided by the product of the lengths of the box along the two axes
        of the condition; negative if the condition is violated.
    axes : tuple of str or numpy.ndarray of str, shape (..., 2)
        The two axes of this condition; the same axis twice for a condition on the spread along one axis.
    """

    possible: Any
    margin: Any
    axes: Any

    def __repr__(self) -> str:
        return short(self)


class Linear(NamedTuple):
    """Flags for each result: True if its standard deviation to first order is accurate to about a percent.

    Attributes
    ----------
    mass, center_of_mass, inertia, principal_moments, axes, radii_of_gyration : bool or numpy.ndarray of bool
        True or False for each number of :class:`Sigma`. False where terms of higher order add more than 1.5
        percent to the variance, or where two moments may change places. There
        :func:`polhode.uncertainty.propagate` with ``method="monte-carlo"`` gives the right standard
        deviation.
    """

    mass: Any
    center_of_mass: Any
    inertia: Any
    principal_moments: Any
    axes: Any
    radii_of_gyration: Any

    def __repr__(self) -> str:
        return short(self)


class Sigma(NamedTuple):
    """Standard deviations of the mass properties of a body, to first order.

    Attributes
    ----------
    mass : float or numpy.ndarray, shape (...)
    center_of_mass : numpy.ndarray, shape (..., 3)
    inertia : numpy.ndarray, shape (..., 3, 3)
        Standard deviations of the elements of the tensor about C.
    principal_moments : numpy.ndarray, shape (..., 3)
    axes : numpy.ndarray, shape (..., 3)
        Standard deviations, in radians, of a small rotation of the principal axes about each axis. NaN where
        the two other moments are equal, or nearly so: the axes are not determined there.
    radii_of_gyration : numpy.ndarray, shape (..., 3)
        Standard deviations of the radii of gyration about the principal axes. NaN where a moment is zero but
        uncertain.
    linear : Linear
        Whether the first order is enough for each of them.
    """

    mass: Any
    center_of_mass: Any
    inertia: Any
    principal_moments: Any
    axes: Any
    radii_of_gyration: Any
    linear: Linear

    def __repr__(self) -> str:
        return short(self)


class ErrorBound(NamedTuple):
    """Bounds on the rounding errors of the numbers of a body, each in the unit of its number.

    An error is the difference from the result of exact arithmetic with the same input.

    Attributes
    ----------
    mass : float or numpy.ndarray, shape (...)
        Bound of the error of the mass.
    center_of_mass : float or numpy.ndarray, shape (...)
        Bound of the error of each component of the centre of mass.
    inertia : float or numpy.ndarray, shape (...)
        Bound of the error of each element of the tensor about the centre of mass.
    """

    mass: Any
    center_of_mass: Any
    inertia: Any

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True, eq=False, repr=False)
class Provenance:
    """Origin of the numbers of a body. For a stack each field is an array of the shape of the stack.

    Attributes
    ----------
    source : str
        What the body was made of: ``"tensor"``, ``"principal moments"``, ``"particles"``, ``"mesh"``,
        ``"surface"``, ``"curve"``, ``"tetrahedra"``, ``"voxels"``, ``"balls"``, ``"density"``, ``"solid"``,
        ``"lamina"``, ``"rod"``, ``"bodies"``, ``"second moment"``; of a molecule ``"atoms, most common
        isotopes"``,
        ``"atoms, average masses"`` or ``"atoms, masses of their own"`` (set in ASE).
    elements : int
        Number of particles, triangles, segments, cells or bodies; 1 for one tensor or solid.
    checked : str
        Checks that the input has passed, separated by commas. ``"unchecked"`` among them says that some
        checks were skipped on request; ``"repaired"`` says that a mesh was mended on request before the
        checks.
    welded : int
        Number of corners that were joined to others within a given length. Equal corners are always joined
        and not counted.
    closure : str
        How an open mesh was closed on request: ``"caps"``, ``"hull"`` or ``""``.
    volume_change : float
        Change of volume by this closure. The volume before is the sum of the tetrahedra of each face with the
        middle of the mesh.
    moments : str
        What the principal moments were computed from: ``"given"``, ``"tensor"``, ``"second moment"`` (before
        it was rounded to a tensor) or ``"second moment in own axes"`` (summed a second time in the principal
        axes, for thin bodies).
    rounded_to_zero : int
        Number of principal moments that differed from zero only by rounding, or within the tolerance of a
        table, and are stored as zero.
    rounding : float
        Largest rounding of a coordinate of the particles, in the unit of length, if the digits of the file
        tell it; else 0. The class of the top (`PrincipalAxes.top`) takes it into account.
    """

    source: Any
    elements: Any
    checked: Any
    welded: Any
    closure: Any
    volume_change: Any
    moments: Any
    rounded_to_zero: Any
    rounding: Any

    def __repr__(self) -> str:
        if shape := np.shape(self.source):
            return f"<Provenance stack of shape {shape}>"
        told = {name: value for name, value in vars(self).items() if name != "rounding" or value}
        return one_line(self, told)

    def __str__(self) -> str:
        """Describe the provenance of one body in one line."""
        made = self.source if self.elements == 1 else f"{self.source} of {self.elements} elements"
        if self.source.startswith("atoms, "):
            made = f"{self.elements} {self.source}" if self.elements > 1 else f"1 atom{self.source[5:]}"
        parts = [made, f"checked: {self.checked}"]
        if self.welded:
            parts.append(f"{self.welded} corners welded")
        if self.closure:
            parts.append(f"closed by {self.closure}, which changed the volume by {self.volume_change:.6g}")
        parts.append(
            f"moments {self.moments}" if self.moments == "given" else f"moments from the {self.moments}"
        )
        if self.rounded_to_zero:
            parts.append(f"{self.rounded_to_zero} rounded to zero")
        if self.rounding:
            parts.append(f"coordinates to {self.rounding:.3g} by their digits")
        return "; ".join(parts)


class Particles(NamedTuple):
    """Point masses: ``masses``, shape (..., n), and ``positions``, shape (..., n, 3), in the body frame."""

    masses: Floats
    positions: Floats

    def __repr__(self) -> str:
        return short(self)


class State(NamedTuple):
    """A state of motion.

    Its fields are arguments of `polhode.RigidBody.simulate`: ``body.simulate(t, **state._asdict())``.

    Attributes
    ----------
    omega : numpy.ndarray, shape (..., 3)
    attitude : numpy.ndarray, shape (..., 4)
    position, velocity : numpy.ndarray, shape (..., 3)
    states : dict of str and numpy.ndarray, shape (..., k), or None
        States of the load, by name; None if it has none.
    """

    omega: Floats
    attitude: Floats
    position: Floats
    velocity: Floats
    states: dict[str, Floats] | None = None

    def __repr__(self) -> str:
        return one_line(self, {name: value for name, value in self._asdict().items() if value is not None})


class Invariants(NamedTuple):
    """Conserved quantities of a motion, and how far the numbers have drifted from them.

    Attributes
    ----------
    energy : numpy.ndarray, shape (..., T), or None
        Sum of kinetic and potential energy, less the work that a plane has done by friction or as a
        turntable; None if the load has no potential.
    angular_momentum : numpy.ndarray, shape (..., T, 3) or (..., T), or None
        Angular momentum about the point `about`, components in space, if no torque acts. In a uniform field
        only its component along the field. None if neither is conserved.
    energy_drift, angular_momentum_drift : float or numpy.ndarray, shape (...), or None
        Largest change since the start: of the energy, relative to the largest sum of the absolute values of
        kinetic and potential energy; of the angular momentum, relative to the largest angular momentum.
    jellett : numpy.ndarray, shape (..., T), or None
        Of a body that rolls: Jellett's integral ``-(I ω)·r`` with r from C to the contact, for a sphere whose
        matter is one of revolution, on a level plane at rest. None in all other cases, so for all below.
    routh : numpy.ndarray, shape (..., T), or None
        Routh's integral ``ω_s √(I_t I_s + m r·I r)`` of the same.
    chaplygin : numpy.ndarray, shape (..., T, 3), or None
        Chaplygin's vector ``R (I ω + m r×(ω×r))`` in space, for a sphere about C with any tensor.
    jellett_drift, routh_drift, chaplygin_drift : float or numpy.ndarray, shape (...), or None
        Largest change of each since the start, relative to its largest size.
    """

    energy: Floats | None
    angular_momentum: Floats | None
    energy_drift: Any
    angular_momentum_drift: Any
    jellett: Floats | None = None
    routh: Floats | None = None
    chaplygin: Floats | None = None
    jellett_drift: Any = None
    routh_drift: Any = None
    chaplygin_drift: Any = None

    def __repr__(self) -> str:
        return short(self)


class MotionSensitivity(NamedTuple):
    """Derivatives of a simulated motion with respect to its start, the body and the load.

    The state at each time is six numbers, (δ, ω). Here δ describes the attitude: it is a small rotation from
    the attitude R of this motion, ``R → R exp(δ×)``, components in the body frame, in radians; ω is the
    angular velocity. If the load has states of its own, k numbers in all, they follow after ω, in the order
    of ``states`` of the trajectory. Each 6 in the shapes below is then 6 + k.

    Attributes
    ----------
    state : numpy.ndarray, shape (..., T, 6, 6)
        Derivatives with respect to the state at the first time: the state-transition matrix. The momentum of
        a wheel whose speed is given follows from this speed; the derivatives with respect to this momentum
        are zero.
    moments : numpy.ndarray, shape (..., T, 6, 3)
        Derivatives with respect to the principal moments, in ascending order. They are the moments about the
        point `about` of the motion. Principal axes, mass and centre of mass stay fixed. NaN for a body with a
        zero moment.
    products : numpy.ndarray, shape (..., T, 6, 3)
        Derivatives with respect to the elements 23, 31 and 12 of the tensor about the same point, with
        components along the principal axes. NaN for a body with a zero moment.
    center_of_mass : numpy.ndarray, shape (..., T, 6, 3)
        Derivatives with respect to the centre of mass, components in the body frame. The mass and the tensor
        about the same point stay fixed.
    mass : numpy.ndarray, shape (..., T, 6)
        Derivatives with respect to the mass. Centre of mass and tensor about the same point stay fixed.
    load : tuple of dict
        One dict for each term of the load. Its keys are the names of the arguments of the function of
        :mod:`polhode.loads` that made the term. The values are the derivatives with respect to these
        arguments, of shape (..., T, 6) followed by the shape of the argument.

        - The target of a feedback is varied by a small rotation δ, as the attitude is: shape (..., T, 6, 3).
        - The term ``2 * constant_torque(v)`` counts as ``constant_torque(2 * v)``. Its derivatives are with
          respect to ``2 * v``.
        - If the motor of a wheel follows a feedback, the dict has the arguments of the wheel and also those
          of the feedback.
        - Not varied are `frame`, the `times` of samples, the windows of :func:`polhode.loads.schedule`, and
          epochs.
    begins : numpy.ndarray, shape (..., k, 3)
        Derivatives of the states of the load at the first time with respect to ω at the first time. A wheel
        that starts with a given rate Ω has the angular momentum ``h = J (Ω + a·ω)``, where J is its moment of
        inertia and a the unit vector along its axis. Its row is therefore ``J a``. The rows of states that
        were given to `simulate` are zero.
        This field is needed because `state` holds h fixed while ω changes. The derivatives with respect to ω
        with Ω fixed instead are ``state[..., 3:6] + state[..., 6:] @ begins[..., None, :, :]``.
    """

    state: Floats
    moments: Floats
    products: Floats
    center_of_mass: Floats
    mass: Floats
    load: tuple[dict[str, Floats], ...]
    begins: Floats

    def __repr__(self) -> str:
        # Of the load the names of what varies.
        return one_line(self, self._asdict() | {"load": [list(term) for term in self.load]})
