"""What polhode's computations return: values that only hold results."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from polhode._principal import (
    TOP_RTOL,
    ContinuousAxes,
    PrincipalAxes,
    PrincipalDerivative,
    PrincipalLinear,
    PrincipalSigma,
)
from polhode._repr import one_line, short
from polhode._tops import FreePrecession, NutationDamping

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
    """Kinetic energy in its three parts, T = ½ m v² + m v·(ω×c_P) + ½ ω·I_P·ω."""

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
    """Angular momentum in its three parts, L = m R×v + m [R×(ω×c_P) + c_P×v] + I_P ω."""

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
    """The tensor of a body nearest to a given one, shape (..., 3, 3), and its distance, shape (...)."""

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
        The room that the tightest condition leaves, relative to the square of the box's size along its axes;
        negative where it is broken.
    axes : tuple of str or numpy.ndarray of str, shape (..., 2)
        The two axes that condition is about; the same twice for the spread along one.
    """

    possible: Any
    margin: Any
    axes: Any

    def __repr__(self) -> str:
        return short(self)


class Linear(NamedTuple):
    """Whether standard deviations to first order are enough: within about a percent.

    Attributes
    ----------
    mass, center_of_mass, inertia, principal_moments, axes, radii_of_gyration : bool or numpy.ndarray of bool
        For each number of :class:`Sigma`. False where terms of higher order add more than 1.5 percent to the
        variance, or moments may change places. There ``method="monte-carlo"`` of
        :func:`polhode.uncertainty.propagate` tells what is right.
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
    """Standard deviations of what a body has, to first order.

    Attributes
    ----------
    mass : float or numpy.ndarray, shape (...)
    center_of_mass : numpy.ndarray, shape (..., 3)
    inertia : numpy.ndarray, shape (..., 3, 3)
        Standard deviations of the elements of the tensor about C.
    principal_moments : numpy.ndarray, shape (..., 3)
    axes : numpy.ndarray, shape (..., 3)
        Standard deviations of the small rotation of the principal axes about each of them, in radians; NaN
        where the two other moments are equal, or nearly so: there the axes are not determined.
    radii_of_gyration : numpy.ndarray, shape (..., 3)
        Standard deviations of those about the principal axes. NaN where a moment is zero and may leave zero.
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
    """Bounds of the rounding errors of a body's numbers, each in the unit of its number.

    The errors are those against exact arithmetic on what was given.

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
    """Where a body's numbers come from; for a stack each field is an array of the stack's shape.

    Attributes
    ----------
    source : str
        What the body was made of: ``"tensor"``, ``"principal moments"``, ``"particles"``, ``"mesh"``,
        ``"surface"``, ``"curve"``, ``"tetrahedra"``, ``"voxels"``, ``"density"``, ``"solid"``, ``"lamina"``,
        ``"rod"``, ``"bodies"``, ``"second moment"``; of a molecule ``"atoms, most common isotopes"``,
        ``"atoms, average masses"`` or ``"atoms, masses of their own"`` (set in ASE).
    elements : int
        How many of them: particles, triangles, segments, cells, bodies; 1 for one tensor or solid.
    checked : str
        What the input has passed, separated by commas; ``"unchecked"`` among them says that checks were left
        out on request, ``"repaired"`` that a mesh was mended on request before it passed them.
    welded : int
        Corners joined to others within a length that was asked for. Equal corners are one, and not counted.
    closure : str
        How an open mesh was closed on request: ``"caps"``, ``"hull"`` or ``""``.
    volume_change : float
        Amount by which that changed the volume that the faces span with the middle of the mesh.
    moments : str
        What the principal moments were found from: ``"given"``, ``"tensor"``, ``"second moment"`` (before it
        is rounded to a tensor) or ``"second moment in own axes"`` (summed again, for thin bodies).
    rounded_to_zero : int
        Principal moments that rounding had left, or a table had admitted, and that are stored as zero.
    rounding : float
        Largest amount by which a coordinate of the particles was rounded, in the unit of length, where a
        file's digits tell it; else 0. The class of the top follows it.
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
        shape = np.shape(self.source)
        if shape:
            return f"<Provenance stack of shape {shape}>"
        told = {name: value for name, value in vars(self).items() if name != "rounding" or value}
        return one_line(self, told)

    def __str__(self) -> str:
        """Tell it in one line, for one body."""
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
    """Point masses: ``masses`` (..., n) and ``positions`` (..., n, 3) in the body frame."""

    masses: Floats
    positions: Floats

    def __repr__(self) -> str:
        return short(self)


class State(NamedTuple):
    """A state of motion, in the words of `simulate`: ``body.simulate(t, **state._asdict())``.

    Attributes
    ----------
    omega : numpy.ndarray, shape (..., 3)
    attitude : numpy.ndarray, shape (..., 4)
    position, velocity : numpy.ndarray, shape (..., 3)
    states : dict of str and numpy.ndarray, shape (..., k), or None
        States of the load, by name, where it has states of its own.
    """

    omega: Floats
    attitude: Floats
    position: Floats
    velocity: Floats
    states: dict[str, Floats] | None = None

    def __repr__(self) -> str:
        fields = self._asdict()
        if self.states is None:
            del fields["states"]
        return one_line(self, fields)


class Invariants(NamedTuple):
    """What a motion keeps, and how far the numbers have drifted from it.

    Attributes
    ----------
    energy : numpy.ndarray, shape (..., T), or None
        Kinetic and potential; None where the load has no potential.
    angular_momentum : numpy.ndarray, shape (..., T, 3) or (..., T), or None
        Angular momentum about the point `about`, in space, where no torque acts; its component along the
        field where the torque of a uniform field acts; None where neither is kept.
    energy_drift, angular_momentum_drift : float or numpy.ndarray, shape (...), or None
        The largest change since the start, relative to the largest sum of the sizes of both energies, and to
        the largest angular momentum.
    """

    energy: Floats | None
    angular_momentum: Floats | None
    energy_drift: Any
    angular_momentum_drift: Any

    def __repr__(self) -> str:
        return short(self)


class MotionSensitivity(NamedTuple):
    """How a motion depends on what it is computed from: the derivatives of (δ, ω) at every time.

    δ is a small rotation from the attitude, ``R → R exp(δ×)``, components in the body frame, in radians.
    Where the load has k states of its own, they come after ω, in the order of `states` of the trajectory:
    every 6 below is then 6 + k.

    Attributes
    ----------
    state : numpy.ndarray, shape (..., T, 6, 6)
        Derivatives by (δ, ω) and the load's states at the first time, each with the others held: the
        state-transition matrix. By the momentum of a wheel whose speed is given, which follows from ω, it is
        zero.
    moments : numpy.ndarray, shape (..., T, 6, 3)
        Derivatives by the principal moments about the point `about` of the motion, ascending, with principal
        axes, mass and centre of mass held; not a number, as are `products`, for a body with a zero moment.
    products : numpy.ndarray, shape (..., T, 6, 3)
        Derivatives by the elements 23, 31 and 12 of that tensor in its principal axes.
    center_of_mass : numpy.ndarray, shape (..., T, 6, 3)
        Derivatives by the centre of mass in the body frame, with that tensor held.
    mass : numpy.ndarray, shape (..., T, 6)
        Derivatives by the mass, with that tensor held.
    load : tuple of dict
        For each term of the load: by each argument of the function of :mod:`polhode.loads` that makes it,
        under its name, shape (..., T, 6) and then that of the argument, a matrix in full. The target
        of a feedback is varied by a small rotation. For a term that was multiplied by a factor, the
        derivatives are by the arguments after the multiplication. Frames, times of samples, windows and
        epochs are not varied. A wheel whose motor follows a feedback has the arguments of both.
    begins : numpy.ndarray, shape (..., k, 3)
        Derivatives of the load's initial states by ω at the first time; for a wheel this is ``J a``. With its
        rate held in place of its momentum, the motion depends on ω by
        ``state[..., 3:6] + state[..., 6:] @ begins[..., None, :, :]``. Zero for states that were given.
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
