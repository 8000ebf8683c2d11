"""What polhode's computations return: values that only hold results."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from os import PathLike

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray
    from scipy.spatial.transform import Rotation

    Floats = NDArray[np.float64]

__all__ = [
    "AngularMomentum",
    "BoxFit",
    "ErrorBound",
    "FreePrecession",
    "KineticEnergy",
    "NearestValid",
    "Particles",
    "PrincipalAxes",
    "PrincipalDerivative",
    "Provenance",
    "Trajectory",
]


@dataclass(frozen=True, eq=False)
class PrincipalAxes:
    """Principal moments and axes of one tensor or of a stack.

    Attributes
    ----------
    moments : numpy.ndarray, shape (..., 3)
        Ascending.
    axes : numpy.ndarray, shape (..., 3, 3)
        The axes are the **columns**, right-handed: ``inertia = axes @ diag(moments) @ axes.T`` and
        ``v_body = axes @ v_principal``.
    """

    moments: Floats
    axes: Floats

    @cached_property
    def quaternion(self) -> Floats:
        """The rotation `axes` as unit quaternions (x, y, z, w), shape (..., 4)."""
        return _core.quaternion_from_matrix(self.axes)

    @cached_property
    def gaps(self) -> Floats:
        """Relative gaps (I2 - I1)/I3 and (I3 - I2)/I3, shape (..., 2); zero for a point."""
        return _core.principal_gaps(self.moments)

    @cached_property
    def top(self) -> Any:
        """Class of the top, decided on `gaps` at a relative tolerance of 1e-6.

        ``"spherical"`` (I1 = I2 = I3), ``"oblate"`` (I1 = I2 < I3), ``"prolate"`` (I1 < I2 = I3),
        ``"asymmetric"``, ``"linear"`` (0 = I1 < I2 = I3), ``"point"`` (all zero), ``"none"`` where the
        moments belong to no body. One string, or an array of them for a stack. Another tolerance:
        :meth:`classify`.
        """
        return self.classify()

    def classify(self, rtol: float = 1e-6) -> Any:
        """Class of the top with moments closer than ``rtol`` times the largest taken as equal."""
        return _core.classify_tops(self.moments, rtol)

    @cached_property
    def kappa(self) -> Any:
        """Ray's asymmetry parameter κ = (2B − A − C)/(A − C) of the rotational constants A ≥ B ≥ C.

        −1 for a prolate top, +1 for an oblate one, NaN for a spherical one. A float, or an array for a stack.
        """
        return _core.ray_kappa(self.moments)

    def canonical(self, rtol: float = 1e-6) -> PrincipalAxes:
        """Turn the axes that are free because moments are equal to the body axes of largest projection.

        Parameters
        ----------
        rtol : float, optional
            Moments closer than this times the largest count as equal.

        Returns
        -------
        PrincipalAxes
            With the same moments; a spherical top gets the body axes themselves.

        Examples
        --------
        >>> from polhode import principal_axes
        >>> principal_axes([(2.0, 0, 0), (0, 1.0, 0), (0, 0, 2.0)]).canonical().axes
        array([[ 0.,  1.,  0.],
               [ 1.,  0.,  0.],
               [ 0.,  0., -1.]])
        """
        return PrincipalAxes(self.moments, _core.canonical_axes(self.moments, self.axes, rtol))

    def derivative(self, tangent: ArrayLike, rtol: float = 1e-12) -> PrincipalDerivative:
        """Change of moments and axes for a change of the tensor.

        Parameters
        ----------
        tangent : array_like, shape (..., 3, 3)
            dI, symmetric.
        rtol : float, optional
            Moments closer than this times the largest count as equal.

        Returns
        -------
        PrincipalDerivative

        Examples
        --------
        >>> from polhode import principal_axes
        >>> found = principal_axes([(1.0, 0, 0), (0, 2.0, 0), (0, 0, 4.0)])
        >>> change = found.derivative([(0.5, 1, 0), (1, 0, 0), (0, 0, 0)])
        >>> change.moments
        array([0.5, 0. , 0. ])
        >>> change.axes
        array([[ 0.,  1.,  0.],
               [-1.,  0.,  0.],
               [ 0.,  0.,  0.]])
        """
        found = _core.principal_derivative(self.moments, self.axes, tangent, rtol)
        return PrincipalDerivative(*found)


class PrincipalDerivative(NamedTuple):
    """Derivatives of principal moments and axes in the direction of a tangent dI.

    Attributes
    ----------
    moments : numpy.ndarray, shape (..., 3)
        dI_k = (Vᵀ dI V)_kk.
    axes : numpy.ndarray, shape (..., 3, 3)
        dV = V Ω, Ω_ij = (Vᵀ dI V)_ij / (I_j − I_i): the axes turn.
    degenerate : numpy.ndarray of bool, shape (..., 3)
        Which of the pairs (1, 2), (1, 3), (2, 3) have equal moments. Within such a pair neither the axes nor
        the single moments have a derivative: `axes` leaves out the rotation in the plane of the pair, and
        of the two `moments` only the sum has a meaning that does not depend on the choice of axes.
    """

    moments: Floats
    axes: Floats
    degenerate: NDArray[np.bool_]


class KineticEnergy(NamedTuple):
    """Kinetic energy in its three parts, T = ½ m v² + m v·(ω×c_P) + ½ ω·I_P·ω."""

    translational: Floats
    mixed: Floats
    rotational: Floats

    @property
    def total(self) -> Floats:
        """The sum of the three parts."""
        return self.translational + self.mixed + self.rotational


class AngularMomentum(NamedTuple):
    """Angular momentum in its three parts, L = m R×v + m [R×(ω×c_P) + c_P×v] + I_P ω."""

    orbital: Floats
    mixed: Floats
    spin: Floats

    @property
    def total(self) -> Floats:
        """The sum of the three parts."""
        return self.orbital + self.mixed + self.spin


class NearestValid(NamedTuple):
    """The tensor of a body nearest to a given one, shape (..., 3, 3), and its distance, shape (...)."""

    inertia: Floats
    distance: Any


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


class ErrorBound(NamedTuple):
    """What rounding can have done to a body's numbers, against exact arithmetic on what was given.

    Attributes
    ----------
    mass : float or numpy.ndarray, shape (...)
        Of the mass.
    center_of_mass : float or numpy.ndarray, shape (...)
        Of each component of the centre of mass.
    inertia : float or numpy.ndarray, shape (...)
        Of each element of the tensor about the centre of mass.
    """

    mass: Any
    center_of_mass: Any
    inertia: Any


@dataclass(frozen=True, eq=False)
class Provenance:
    """Where a body's numbers come from; for a stack each field is an array of the stack's shape.

    Attributes
    ----------
    source : str
        What the body was made of: ``"tensor"``, ``"principal moments"``, ``"particles"``, ``"mesh"``,
        ``"surface"``, ``"curve"``, ``"tetrahedra"``, ``"voxels"``, ``"density"``, ``"solid"``, ``"lamina"``,
        ``"rod"``, ``"bodies"``, ``"second moment"``.
    elements : int
        How many of them: particles, triangles, segments, cells, bodies; 1 for one tensor or solid.
    checked : str
        What the input has passed, separated by commas; ``"unchecked"`` among them says that checks were left
        out on request.
    welded : int
        Corners joined to others within a length that was asked for. Equal corners are one, and not counted.
    closure : str
        How an open mesh was closed on request: ``"caps"``, ``"hull"`` or ``""``.
    volume_change : float
        By how much that changed the volume that the faces span with the middle of the mesh.
    moments : str
        What the principal moments were found from: ``"given"``, ``"tensor"``, ``"second moment"`` (before it
        is rounded to a tensor) or ``"second moment in own axes"`` (summed again, for thin bodies).
    rounded_to_zero : int
        Principal moments that rounding had left, or a table had admitted, and that are stored as zero.
    """

    source: Any
    elements: Any
    checked: Any
    welded: Any
    closure: Any
    volume_change: Any
    moments: Any
    rounded_to_zero: Any

    def __str__(self) -> str:
        """Tell it in one line, for one body."""
        made = self.source if self.elements == 1 else f"{self.source} of {self.elements} elements"
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
        return "; ".join(parts)


class Particles(NamedTuple):
    """Point masses: ``masses`` (..., n) and ``positions`` (..., n, 3) in the body frame."""

    masses: Floats
    positions: Floats


class FreePrecession(NamedTuple):
    """How a torque-free symmetric top precesses: n its symmetry axis, ω and L in one plane about L.

    Attributes
    ----------
    axis : numpy.ndarray, shape (..., 3)
        n in the body frame, toward the side of ω.
    body_rate : float or numpy.ndarray, shape (...)
        ``(I_s − I_t) ω_s/I_t``: ω and L circle about n, seen from the body. Negative for a prolate top.
    space_rate : float or numpy.ndarray, shape (...)
        ``L/I_t``: n and ω circle about L, seen from space.
    body_cone, space_cone : float or numpy.ndarray, shape (...)
        Half the opening of the body cone (between n and ω) and of the space cone (between L and ω).
    nutation : float or numpy.ndarray, shape (...)
        Between n and L.
    """

    axis: Floats
    body_rate: Any
    space_rate: Any
    body_cone: Any
    space_cone: Any
    nutation: Any


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """The motion of one body or of a stack at the times asked for.

    Attributes
    ----------
    body : RigidBody
        The body, or the stack of them.
    t : numpy.ndarray, shape (T,)
        Times, the first being the start.
    omega : numpy.ndarray, shape (..., T, 3)
        Angular velocity of the body relative to space, components in the body frame.
    quaternion : numpy.ndarray, shape (..., T, 4)
        Attitude R_NB as (x, y, z, w), continuous in time.
    position, velocity : numpy.ndarray, shape (..., T, 3)
        Of the point `about`, in space.
    about : numpy.ndarray, shape (..., 3)
        The point the motion refers to, in the body frame.
    steps, evaluations : numpy.ndarray, shape (...)
        Accepted steps and evaluations of the equations of motion.
    load : Load or None
        What acted on the body.
    """

    body: _core.RigidBody
    t: Floats
    omega: Floats
    quaternion: Floats
    position: Floats
    velocity: Floats
    about: Floats
    steps: NDArray[np.int64]
    evaluations: NDArray[np.int64]
    load: _core.Load | None = None

    def __len__(self) -> int:
        """Count the times."""
        return len(self.t)

    def __repr__(self) -> str:
        shape = self.omega.shape[:-2]
        bodies = f"{'x'.join(map(str, shape))} bodies, " if shape else ""
        span = f" from {self.t[0]:.6g} to {self.t[-1]:.6g}" if len(self) else ""
        return f"Trajectory({bodies}{len(self)} times{span})"

    @cached_property
    def rotation(self) -> Rotation:
        """The attitude as :class:`scipy.spatial.transform.Rotation`, shape (..., T); needs SciPy."""
        from polhode._extras import require

        transform = require("scipy.spatial.transform", extra=None, purpose="Trajectory.rotation")
        rotation: Rotation = transform.Rotation.from_quat(self.quaternion)
        return rotation

    def kinetic_energy(self) -> KineticEnergy:
        """Kinetic energy at every time, in parts that refer to the point `about`.

        Returns
        -------
        KineticEnergy
            Each part of shape (..., T).
        """
        return self._bodies().kinetic_energy(
            self.omega,
            velocity=_core.rotate(self.quaternion, self.velocity, inverse=True),
            about=self.about[..., np.newaxis, :],
        )

    def angular_momentum(self, frame: Literal["space", "body"] = "space") -> AngularMomentum:
        """Angular momentum about the origin of space at every time.

        Parameters
        ----------
        frame : {"space", "body"}
            Whose axes the components refer to.

        Returns
        -------
        AngularMomentum
            Each part of shape (..., T, 3).
        """
        if frame not in ("space", "body"):
            raise ValueError(f"frame: {frame!r} is not 'space' or 'body'")
        in_body = self._bodies().angular_momentum(
            self.omega,
            velocity=_core.rotate(self.quaternion, self.velocity, inverse=True),
            position=_core.rotate(self.quaternion, self.position, inverse=True),
            about=self.about[..., np.newaxis, :],
        )
        if frame == "body":
            return in_body
        return AngularMomentum(*(_core.rotate(self.quaternion, part) for part in in_body))

    def euler_angles(self, sequence: str = "ZXZ", singular: Literal["raise", "nan"] = "raise") -> Floats:
        """Euler angles of the attitude at every time.

        Parameters
        ----------
        sequence : str
            As in :mod:`polhode.euler_angles`; the default is the (phi, theta, psi) of Goldstein and Landau.
        singular : {"raise", "nan"}
            What to do at an attitude at which two of the angles are not defined.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
            In radians, each within its range (no unwrapping).
        """
        return _core.euler_angles_from_quaternion(self.quaternion, sequence, singular)

    def euler_rates(self, sequence: str = "ZXZ", singular: Literal["raise", "nan"] = "raise") -> Floats:
        """Rates of the Euler angles at every time.

        Parameters
        ----------
        sequence : str
            As in :mod:`polhode.euler_angles`; the default is the (phi, theta, psi) of Goldstein and Landau.
        singular : {"raise", "nan"}
            What to do at an attitude at which the angles or their rates are not defined.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        angles = self.euler_angles(sequence, singular)
        return _core.euler_rates(angles, self.omega, sequence, "body", singular)

    def point(self, r: Literal["center_of_mass", "origin"] | ArrayLike) -> Floats:
        """Position in space of a point of the body at every time.

        Parameters
        ----------
        r : {"center_of_mass", "origin"} or array_like, shape (..., 3)
            The point in the body frame.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        words = {"center_of_mass": self.body.center_of_mass, "origin": np.zeros(3)}
        if isinstance(r, str) and r not in words:
            raise ValueError(f"r: {r!r} is not 'center_of_mass', 'origin' or a point of shape (..., 3)")
        place = words[r] if isinstance(r, str) else np.asarray(r, dtype=float)
        if place.shape[-1:] != (3,):
            raise ValueError(f"r: expected shape (..., 3), got {place.shape}")
        arm = place - self.about
        return self.position + _core.rotate(self.quaternion, arm[..., np.newaxis, :])

    def torque(self) -> Floats:
        """Torque of the load about the point `about` at every time, components in the body frame.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        if self.load is None:
            return np.zeros_like(self.omega)
        return self.load.torque(self.t, self.omega, self.quaternion)

    def angular_acceleration(self) -> Floats:
        """Angular acceleration at every time by Euler's equations, components in the body frame.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        return self._bodies().angular_acceleration(
            self.omega, self.torque(), about=self.about[..., np.newaxis, :]
        )

    def pivot_reaction(
        self, gravity: ArrayLike = (0.0, 0.0, 0.0), force: ArrayLike = (0.0, 0.0, 0.0)
    ) -> Floats:
        """Force with which the pivot holds a body simulated with ``about="origin"``, at every time.

        Parameters
        ----------
        gravity : array_like, shape (..., 3)
            g in space. The load of the simulation must have contained its torque about the pivot.
        force : array_like, shape (..., 3)
            The sum of all other forces in space.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
            Force on the body, components in space: m a_C − m g − force.

        Raises
        ------
        ValueError
            For a motion whose point `about` is not the origin of the body frame, or moves.
        """
        if np.any(self.about != 0.0) or np.any(self.velocity != 0.0):
            raise ValueError('pivot_reaction: no pivot holds this body; simulate it with about="origin"')
        return self._bodies().pivot_reaction(
            self.omega, self.angular_acceleration(), self.quaternion, gravity=gravity, force=force
        )

    def save(self, path: str | PathLike[str]) -> None:
        """Write the motion to a file, with every bit of it.

        Parameters
        ----------
        path : str or os.PathLike
            ``.csv``: one line per time, ``t, omega_*`` (body), ``quaternion_*``, ``position_*, velocity_*``
            (space); a stack's lines begin with the indices of the body. ``.npz``: the arrays under the names
            of the attributes, with the body's ``mass``, ``inertia`` and ``center_of_mass``.
        """
        from polhode._files.trajectory import save_trajectory

        save_trajectory(self, path)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the components of the angular velocity in the body over time; needs matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure by default.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from polhode.plot import angular_velocity

        return angular_velocity(self, ax)

    def _bodies(self) -> _core.RigidBody:
        """Give the body or stack an axis for time, along which it broadcasts."""
        return self.body[..., np.newaxis]
