"""The motion of a body, or of a stack of them: what `simulate` returns."""

from __future__ import annotations

import operator
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, Literal, cast

import numpy as np

from polhode import _core
from polhode._hints import ClassWithHints, no_attribute
from polhode.motion.contact import ContactHistory, Extreme
from polhode.motion.events import Events, after_event
from polhode.motion.gyrostat import Wheel, wheel
from polhode.motion.invariants import drift, lengths
from polhode.results import AngularMomentum, Invariants, KineticEnergy, State

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path as FilePath

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray
    from pandas import DataFrame
    from pyvista import Plotter
    from scipy.spatial.transform import Rotation
    from xarray import Dataset

    from polhode._typing import SupportsQuaternion
    from polhode.draw.html import HtmlPage
    from polhode.errors import IntegrationError, PolhodeError
    from polhode.orbits import Path, RelativeMotion
    from polhode.results import MotionSensitivity
    from polhode.uncertainty.motion import StateSigma

    Floats = NDArray[np.float64]

__all__ = ["Trajectory"]

_OF_THE_MOTION = ("omega", "attitude", "position", "velocity", "about")
"""Arguments of a start that a motion has already."""
_EQUAL_MOMENTA = 1e-12
"""An angular momentum that differs by less, relative to its parts, is the same."""
_NO_WHEEL = 1e-12
"""A moment that small, relative to the largest, is that of no wheel."""


@dataclass(frozen=True)
class Origin:
    """Where a trajectory comes from, as far as its states do not show it.

    Attributes
    ----------
    motion : GyrostatMotion or None
        The closed form that it shows, of a gyrostat.
    states : tuple of str
        The states of the load that were given at the start; the others follow from the numbers of the load.
    start : float or None
        The first time of the motion that it continues; None if it is the first part.
    loaded : bool
        Whether a load acted that is not known any more, since a file does not hold it.
    derived : bool
        Whether the angular velocity was computed from the attitudes of a record.
    plane : bool
        Whether a plane acts on it along a line of contact.
    """

    motion: _core.GyrostatMotion | None = None
    states: tuple[str, ...] = ()
    start: float | None = None
    loaded: bool = False
    derived: bool = False
    plane: bool = False


_CONTACT_PHASES: Final = np.array(["rolling", "sliding", "flying", ""])
"""By their numbers; the last for states that are not known."""


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(metaclass=ClassWithHints):
    """The motion of one body or of a stack at the times asked for.

    Attributes
    ----------
    body : RigidBody or VaryingBody
        The body, or the stack of them.
    t : numpy.ndarray, shape (T,)
        Times; the first is the start. For a motion in closed form these are any times, in an array of any
        shape, which then stands in place of (T,).
    omega : numpy.ndarray, shape (..., T, 3)
        Angular velocity of the body relative to space, components in the body frame.
    quaternion : numpy.ndarray, shape (..., T, 4)
        Attitude R_NB as (x, y, z, w), continuous in time.
    position, velocity : numpy.ndarray, shape (..., T, 3)
        Position and velocity of the point `about`, in space.
    about : numpy.ndarray, shape (..., 3)
        The point the motion refers to, in the body frame. Of a varying body that moves freely the centre of
        mass at each time, shape (T, 3).
    steps, evaluations : numpy.ndarray, shape (...)
        Accepted steps and evaluations of the equations of motion.
    load : Load or None
        What acted on the body.
    status : str or numpy.ndarray of str, shape (...)
        How the run of each body ended: ``"complete"``; ``"event"``, at a terminal event; ``"lift-off"``,
        where a body leaves its plane, ``"landing"``, where it touches again, ``"roll"``, where its slip
        ceases and the law of contact needs one, or ``"rest"``, where it ceases to turn and its resistance
        needs that; ``"failed"``; ``"stopped"``, by Ctrl-C; or ``"not run"``, since another body failed first.
        States after the end are NaN.
    events : Events
        The passages of the event functions through zero, as a table.
    failures : tuple of PolhodeError
        One error for each body that failed, with its ``row`` in the stack, and the ``time`` and ``state``
        that were reached.
    pivoted : bool
        Whether the point `about` is fixed in space.
    uncertain_start : tuple, FreeMotion, HeavyTop or None
        The sigmas of the start. In most cases this is a tuple: the angular velocity and the attitude at the
        first time, each as an `Uncertain`, or None if it was given without a sigma. For states of a motion in
        closed form, the sigmas are those at t = 0. If the first time is not 0, this attribute is therefore
        the motion itself. It is None for a trajectory that :meth:`resume` made from an uncertain one; its
        :attr:`covariance` cannot be computed.
    states : dict of str and numpy.ndarray, shape (..., T, k)
        The states of the load, by name. Of a wheel it is the angular momentum ``J (Ω + a·ω)`` about its axis
        a, with its moment of inertia J and its rate Ω relative to the body. Of a slug it is the angular
        velocity, components in the body frame.
    carried : tuple of numpy.ndarray, shapes (..., T, 3) and (..., T), or None
        What the wheels, rotors and slugs of the load, or of a gyrostat, add to the body: first the angular
        momentum in addition to ``I ω``, components in the body frame; then the energy in addition to
        ``½ ω·I ω``. A rotor adds angular momentum, but no energy: see :meth:`kinetic_energy`. None if there
        are none of these.
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
    load: _core.Load | None = field(default_factory=lambda: None)
    status: Any = "complete"
    events: Events = field(default_factory=Events.none)
    failures: tuple[IntegrationError | PolhodeError, ...] = ()
    pivoted: bool = False
    uncertain_start: (
        tuple[_core.Uncertain | None, _core.Uncertain | None] | _core.FreeMotion | _core.HeavyTop | None
    ) = (None, None)
    states: dict[str, Floats] = field(default_factory=dict)
    carried: tuple[Floats, Floats] | None = field(default_factory=lambda: None)
    _origin: Origin = field(default=Origin(), init=False)
    _ended_by: Any = field(default=None, init=False)
    _contact: _core.Contact | None = field(default=None, init=False)
    _contact_extremes: tuple[Floats, Floats] | None = field(default=None, init=False)
    _contact_states: tuple[Floats, Floats] | None = field(default=None, init=False)

    @classmethod
    def _of_run(cls, known: dict[str, Any]) -> Trajectory:
        """Make the motion of a run; what is not in `known` is read from its ``_outcome`` when needed."""
        motion = object.__new__(cls)
        object.__setattr__(motion, "__dict__", known)
        return motion

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Get the attributes that few ask for from the outcome of the run."""
            outcome = self.__dict__.get("_outcome")
            if name == "carried":
                value = self._carried_now()
            elif outcome is not None and name in type(self).__dataclass_fields__:
                value = getattr(outcome, name)
            else:
                raise no_attribute("Trajectory", name, dir(self))
            self.__dict__[name] = value
            return value

    def __getstate__(self) -> dict[str, Any]:
        """Return all attributes, for copy and pickle."""
        # What ended the motion is a function, which may not pickle.
        return {one.name: getattr(self, one.name) for one in fields(self)} | {"_ended_by": None}

    def __len__(self) -> int:
        """Count the times."""
        return len(self.t)

    def __repr__(self) -> str:
        shape = self.omega.shape[: -1 - self.t.ndim]
        bodies = f"{'x'.join(map(str, shape))} bodies, " if shape else ""
        count = self.t.size
        span = f" from {self.t.flat[0]:.6g} to {self.t.flat[-1]:.6g}" if count else ""
        ends = np.unique(self.status).tolist()
        ended = f", {' or '.join(ends)}" if ends != ["complete"] else ""
        return f"Trajectory({bodies}{count} times{span}{ended})"

    @cached_property
    def contact(self) -> ContactHistory | None:
        """Return the contact of a body on a plane: force, friction needed and more; None without one."""
        if self._contact is None or self._contact_extremes is None:
            return None
        load = None if self.load is None else self._over_time(self.load)
        phases, work = self._contact_states or (np.zeros(self.omega.shape[:-1]),) * 2
        states = (self.omega, self.quaternion, self.position, self.velocity)
        known = _core.contact_history(self._bodies(), self._contact, load, *states, phases)
        known_until_here = ~np.isnan(self.omega[..., 0])
        words = _CONTACT_PHASES[np.where(known_until_here, phases, -1.0).astype(int)]
        most, least = (Extreme(*np.moveaxis(one, -1, 0)) for one in self._contact_extremes)
        return ContactHistory(
            **known, work=work, phase=words, largest_friction_needed=most, smallest_normal_force=least
        )

    @cached_property
    def rotation(self) -> Rotation:
        """The attitude as :class:`scipy.spatial.transform.Rotation`, shape (..., T); needs SciPy."""
        from polhode._optional import require

        transform = require("scipy.spatial.transform", extra=None, purpose="Trajectory.rotation")
        rotation: Rotation = transform.Rotation.from_quat(self.quaternion)
        return rotation

    def kinetic_energy(self) -> KineticEnergy:
        """Compute the kinetic energy at every time, in parts that refer to the point `about`.

        Returns
        -------
        KineticEnergy
            Each part of shape (..., T). The rotational part includes the energy of wheels and slugs. It does
            not include the energy of a rotor, of which only the momentum is known. For a body with a rotor
            and no other load, ``½ ω·I ω`` stays constant. For a gyrostat in closed form the total is
            :meth:`polhode.GyrostatMotion.kinetic_energy`.
        """
        found = self._bodies().kinetic_energy(
            self.omega,
            velocity=_core.rotate(self.quaternion, self.velocity, inverse=True),
            about=self._reference(),
        )
        return (
            found if self.carried is None else found._replace(rotational=found.rotational + self.carried[1])
        )

    def angular_momentum(self, frame: Literal["space", "body"] = "space") -> AngularMomentum:
        """Compute the angular momentum about the origin of space at every time.

        Parameters
        ----------
        frame : {"space", "body"}
            The frame whose axes the components refer to.

        Returns
        -------
        AngularMomentum
            Each part of shape (..., T, 3). The part ``spin`` includes the angular momentum of wheels, rotors
            and slugs.
        """
        if frame not in ("space", "body"):
            raise ValueError(f"frame: {frame!r} is not 'space' or 'body'")
        in_body = self._bodies().angular_momentum(
            self.omega,
            velocity=_core.rotate(self.quaternion, self.velocity, inverse=True),
            position=_core.rotate(self.quaternion, self.position, inverse=True),
            about=self._reference(),
        )
        if self.carried is not None:
            in_body = in_body._replace(spin=in_body.spin + self.carried[0])
        if frame == "body":
            return in_body
        return AngularMomentum(*(_core.rotate(self.quaternion, part) for part in in_body))

    def point(self, point: Literal["center_of_mass", "com", "origin"] | ArrayLike) -> Floats:
        """Position in space of a point of the body at every time.

        Parameters
        ----------
        point : {"center_of_mass", "origin"} or array_like, shape (..., 3)
            The point in the body frame; ``"com"`` is the centre of mass too.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        varying = self._varying()
        center = self.body.center_of_mass if varying is None else varying.at(self.t).center_of_mass
        words = {"center_of_mass": center, "com": center, "origin": np.zeros(3)}
        if isinstance(point, str) and point not in words:
            raise ValueError(
                f"point: {point!r} is not 'center_of_mass', 'origin' or a point of shape (..., 3)"
            )
        place = words[point] if isinstance(point, str) else _core.real_numbers(point, "point")
        if place.shape[-1:] != (3,):
            raise ValueError(f"point: expected shape (..., 3), got {place.shape}")
        arm = place - self.about if varying is None else place - self._reference()
        return self.position + _core.rotate(self.quaternion, self._per_time(arm) if varying is None else arm)

    def invariants(self) -> Invariants:
        """Return the conserved quantities of the motion, and how far the numbers have drifted from them.

        Returns
        -------
        Invariants

        Examples
        --------
        >>> from polhode import RigidBody
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> kept = body.simulate([0, 50, 100], omega=(1.0, 0.1, 1.0), rtol=1e-13).invariants()
        >>> bool(kept.energy_drift < 1e-11), bool(kept.angular_momentum_drift < 1e-11)
        (True, True)
        """
        kinetic, potential = self.kinetic_energy().total, self._potential()
        work = 0.0 if self._contact_states is None else self._contact_states[1]
        if self._contact is not None and self._contact.turntable and self._contact_states is None:
            potential = None  # the plane does work, which a closed form does not have
        if self._varying() is not None:
            potential = None  # what moves inside the body does work
        spin = self.angular_momentum().spin
        energy = None if potential is None else kinetic + potential - work
        kept = self._kept_directions()
        along = None
        if kept is not None:
            along = spin if kept is True else np.einsum("...i,...i->...", spin, self._per_time(kept))

        def relative_drift(values: Floats, size: Floats) -> Any:
            stack = size.shape[: size.ndim - self.t.ndim]
            if not self.t.size:
                return np.zeros(stack)[()]
            flat = (*stack, self.t.size)  # whatever the shape of t
            return drift(values.reshape(*flat, *values.shape[size.ndim :]), size.reshape(flat))

        return Invariants(
            energy,
            along,
            None
            if energy is None or potential is None
            else relative_drift(energy, kinetic + np.abs(potential)),
            None if along is None else relative_drift(along, lengths(spin)),
            **self._kept_by_rolling(relative_drift),
        )

    def _kept_by_rolling(self, relative_drift: Any) -> dict[str, Any]:
        """Return what the contact keeps, and how far the numbers have drifted from it."""
        if self._contact is None:
            return {}
        load = None if self.load is None else self._over_time(self.load)
        kept = _core.contact_invariants(
            self._bodies(), self._contact, load, self.omega, self.quaternion, self.position, self.velocity
        )
        for name, values in list(kept.items()):
            if values is not None:
                size = lengths(values) if name == "chaplygin" else np.abs(values)
                kept[f"{name}_drift"] = relative_drift(values, size)
        return kept

    def state(self, index: int = -1) -> State:
        """Return the state at one of the times, for example to start another simulation with it.

        Parameters
        ----------
        index : int
            Which of the times; the last by default.

        Returns
        -------
        State
        """
        if self.t.ndim == 0:  # of an exact motion, at one time
            return State(self.omega, self.quaternion, self.position, self.velocity)
        self._check_series("state")
        if not -len(self.t) <= operator.index(index) < len(self.t):
            raise IndexError(f"index: {index} is none of {len(self.t)} times")
        at: list[Floats] = [
            x[..., index, :] for x in (self.omega, self.quaternion, self.position, self.velocity)
        ]
        states = {name: values[..., index, :] for name, values in self.states.items()}
        return State(at[0], at[1], at[2], at[3], states or None)

    @staticmethod
    def from_file(path: str | PathLike[str]) -> Trajectory:
        """Read a motion that `save` wrote as ``.json`` or ``.npz``.

        Parameters
        ----------
        path : str or os.PathLike

        Returns
        -------
        Trajectory
            With the same bits; without load and events, which the file does not hold.

        Raises
        ------
        FileFormatError
            For a file that is not such a motion.
        """
        from polhode.io.saved import read_motion

        known, origin = read_motion(path)
        motion = Trajectory(**known)
        motion.__dict__["_origin"] = Origin(**origin)
        return motion

    @staticmethod
    def from_samples(
        body: _core.RigidBody,
        t: ArrayLike,
        attitude: ArrayLike | SupportsQuaternion,
        omega: ArrayLike | None = None,
        position: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        load: _core.Load | None = None,
        about: Literal["center_of_mass", "origin"] = "center_of_mass",
        *,
        sequence: str | None = None,
    ) -> Trajectory:
        """Make a trajectory of a recorded motion: of another program, or of a measurement.

        Parameters
        ----------
        body : RigidBody
            One body.
        t : array_like, shape (T,)
            Times, ascending, in any steps.
        attitude : array_like or rotation, shape (T, 4), (T, 3, 3) or (T, 3)
            R_NB at each time: quaternions (x, y, z, w), rotation matrices, SciPy rotations, or Euler angles
            in radians with `sequence`. A row that is unknown is NaN.
        omega : array_like, shape (T, 3), optional
            Angular velocity of the body relative to space, components in the body frame. By default
            :func:`polhode.kinematics.angular_velocity` computes it from the attitudes.
        position, velocity : array_like, shape (T, 3), optional
            Position and velocity of the point `about`, in space. Without a velocity it is the derivative of
            the position; without both the point is at rest at the origin.
        load : Load, optional
            What acted on the body. States of a load, such as the momentum of wheels, are in no record: a load
            with states is refused.
        about : {"center_of_mass", "origin"}
            The point that `position` and `velocity` are of. If this is the origin of the body frame, and no
            position is given, it is a pivot: a point fixed in space.
        sequence : str, optional
            Sequence of Euler angles, as in :mod:`polhode.euler_angles`.

        Returns
        -------
        Trajectory

        Raises
        ------
        PolhodeError
            For rows that are no rotations, and times that do not ascend.

        Examples
        --------
        >>> import numpy as np
        >>> from polhode import Trajectory, solids
        >>> brick = solids.box((3.0, 2.0, 1.0), mass=12.0)
        >>> t = np.linspace(0.0, 4.0, 81)
        >>> turns = np.stack([0.0 * t, 0.0 * t, np.sin(t), np.cos(t)], axis=1)  # 2 rad/s about z
        >>> record = Trajectory.from_samples(brick, t, turns)
        >>> record.omega[-1].round(6) + 0.0
        array([0., 0., 2.])
        >>> record.invariants().energy_drift < 1e-9
        True
        """
        from polhode.motion.samples import read_samples

        known = read_samples(body, t, attitude, omega, position, velocity, load, about, sequence)
        record = Trajectory(**known)
        record.__dict__["_origin"] = Origin(derived=omega is None)
        return record

    def relative_to(self, orbit: Path) -> RelativeMotion:
        """Compute attitude and rates relative to the local frame of an orbit: roll, pitch and yaw.

        Parameters
        ----------
        orbit : Orbit or SampledOrbit
            Of :mod:`polhode.orbits`, with axes of a stack that broadcast with those of the motion. If it has
            no epoch, it has its given state at the first of the times, as in a load of the run.

        Returns
        -------
        RelativeMotion
            Attitude in the frame L whose z points to the attractor and whose y points against the normal of
            the orbit, and the angular velocity relative to it.

        Examples
        --------
        A satellite that always shows one face to its planet:

        >>> import numpy as np
        >>> from polhode import orbits, solids
        >>> orbit = orbits.kepler(1.0, (1, 0, 0), (0, 1, 0))
        >>> local = orbit.frame(0.0)
        >>> t = np.linspace(0.0, 6.0, 4)
        >>> motion = solids.sphere(0.1, mass=1.0).free_motion(local.omega, local.quaternion).at(t)
        >>> relative = motion.relative_to(orbit)
        >>> bool((np.abs(relative.pitch) < 1e-12).all()), bool((np.abs(relative.omega) < 1e-12).all())
        (True, True)
        """
        from polhode.orbits import Path, RelativeMotion

        if not isinstance(orbit, Path):
            raise TypeError(
                f"orbit: expected one of polhode.orbits, such as orbits.kepler(mu, position, velocity), "
                f"got {type(orbit).__name__}"
            )
        start = self.t.flat[0] if getattr(orbit, "epoch", 0.0) is None and self.t.size else 0.0
        frame = orbit.frame(self.t - start)
        stack, own = frame.omega.shape[: -1 - self.t.ndim], self.omega.shape[: -1 - self.t.ndim]
        try:
            np.broadcast_shapes(stack, own)
        except ValueError:
            raise ValueError(
                f"orbit: its stack of shape {stack} does not broadcast with that of the motion, {own}"
            ) from None
        quaternion = _turn_back(frame.quaternion, self.quaternion)
        omega = self.omega - _core.rotate(quaternion, frame.omega, inverse=True)
        return RelativeMotion(self.t, _continuous(quaternion) if self.t.ndim == 1 else quaternion, omega)

    def euler_angles(
        self,
        sequence: str = "ZXZ",
        singular: Literal["raise", "nan"] = "raise",
        *,
        unwrap: bool = False,
        degrees: bool = False,
    ) -> Floats:
        """Compute the Euler angles of the attitude at every time.

        Parameters
        ----------
        sequence : str
            As in :mod:`polhode.euler_angles`; the default is the (phi, theta, psi) of Goldstein and Landau.
        singular : {"raise", "nan"}
            What to do at an attitude at which two of the angles are not defined; ``np.isnan`` of the result
            is the mask of those.
        unwrap : bool
            Whether the first and the third angle are counted on over many turns. Each then changes by less
            than half a turn from one time to the next at which it is defined. By default each is within its
            range.
        degrees : bool
            Give degrees.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
            In radians unless `degrees`.
        """
        if unwrap:
            self._check_series("euler_angles, unwrap")
        angles = _core.euler_angles_from_quaternion(self.quaternion, sequence, singular)
        angles = _unwrap(angles) if unwrap else angles
        return np.rad2deg(angles) if degrees else angles

    def euler_rates(
        self,
        sequence: str = "ZXZ",
        singular: Literal["raise", "nan"] = "raise",
        *,
        degrees: bool = False,
    ) -> Floats:
        """Compute the rates of the Euler angles at every time.

        Parameters
        ----------
        sequence : str
            As in :mod:`polhode.euler_angles`; the default is the (phi, theta, psi) of Goldstein and Landau.
        singular : {"raise", "nan"}
            What to do at an attitude at which the angles or their rates are not defined.
        degrees : bool
            Give degrees per time.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
            In radians per time unless `degrees`.
        """
        angles = self.euler_angles(sequence, singular)
        rates = _core.euler_rates(angles, self.omega, sequence, "body", singular)
        return np.rad2deg(rates) if degrees else rates

    def torque(self) -> Floats:
        """Compute the torque of the load about the point `about` at every time, components in the body frame.

        The torque of wheels is ``I ω̇ + ω × I ω``, where I includes the wheels as if they were locked.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        if self.load is None and self._origin.motion is not None:
            return self._torque_of_rotor()
        if self._acting("torque") is None:
            return np.zeros_like(self.omega)
        assert self.load is not None
        return self._over_time(self.load).torque(
            *self._states(), **self._subject(), states=self._own_states()
        )

    def force(self) -> Floats:
        """Sum of the forces of the load at every time, components in space.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        if self.load is None:
            if self._is_loaded():
                self._acting("force")
            return np.zeros_like(self.omega)
        return self._over_time(self.load).force(*self._states(), **self._subject(), states=self._own_states())

    def angular_acceleration(self) -> Floats:
        """Compute the angular acceleration at every time by Euler's equations, components in the body frame.

        The torque is that of the load, and of the plane on which a body rolls.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        torque, contact = self.torque(), self.contact
        if contact is not None:
            arm = contact.point_in_body - self._reference()
            torque = torque + np.cross(arm, _core.rotate(self.quaternion, contact.force, inverse=True))
            torque += _core.rotate(self.quaternion, contact.couple, inverse=True)
        varying = self._varying()
        if varying is not None:
            torque = torque + varying.torque_of_change(self.t, self.omega, self._about_word())
        return self._bodies().angular_acceleration(self.omega, torque, about=self._reference())

    def potential_energy(self) -> Floats:
        """Compute the potential energy in the field of the load at every time.

        Returns
        -------
        numpy.ndarray, shape (..., T)
            For example ``-m g·r_C`` in uniform gravity; see :meth:`polhode.loads.Load.potential`; zero
            without a load.

        Raises
        ------
        ValueError
            For a load with a part that has no potential.
        """
        potential = self._potential()
        if potential is None:
            raise ValueError(
                "potential_energy: a part of the load has no potential; weight, forces constant in space and "
                "feedback without damping have one"
            )
        return potential

    def pivot_reaction(
        self, gravity: ArrayLike = (0.0, 0.0, 0.0), force: ArrayLike = (0.0, 0.0, 0.0)
    ) -> Floats:
        """Force with which the pivot holds a body simulated with ``about="origin"``, at every time.

        Parameters
        ----------
        gravity : array_like, shape (..., 3)
            Gravitational acceleration g, components in space. Give it only if the load of the simulation held
            the torque of the weight but not the weight itself.
        force : array_like, shape (..., 3)
            Sum of the forces that act besides those of the load, components in space.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
            Force on the body, components in space: m a_C minus the forces of the load, minus m g, minus
            `force`.

        Raises
        ------
        ValueError
            For a motion whose point `about` is not the origin of the body frame, or moves.
        """
        if not self.pivoted:
            raise ValueError('pivot_reaction: no pivot holds this body; simulate it with about="origin"')
        return self._bodies().pivot_reaction(
            self.omega,
            self.angular_acceleration(),
            self.quaternion,
            gravity=gravity,
            force=self.force() + _core.real_numbers(force, "force"),
        )

    def sensitivity(self, method: Literal["series", "differences"] = "series") -> MotionSensitivity:
        """Compute the derivatives of the motion by its start, the body and the numbers of the load.

        Parameters
        ----------
        method : {"series", "differences"}
            ``"series"`` integrates the linearised equations of motion. ``"differences"`` takes finite
            differences of order six between motions that are simulated anew; it gives about nine digits. It
            also serves the loads for which there are no series: see Raises.

        Returns
        -------
        MotionSensitivity
            Derivatives of the attitude, the angular velocity and the states of the load at every time. They
            are taken with respect to the same quantities at the first time, to the principal moments,
            products of inertia, centre of mass and mass of the body, and to the numbers of the load. Some
            arguments of loads are not varied, such as times: see :class:`polhode.MotionSensitivity`.

        Raises
        ------
        PolhodeError
            With ``"series"``, for a load without series: a callback, a compiled function, a gravity gradient
            along an oblate or sampled orbit, a magnetic field along an orbit or at given times, B-dot, a
            motor with a limit, dry friction, a feedback on a moving target. With ``"differences"``, if the
            differences of order four and of order six do not agree.
        IntegrationError
            If the integration of the motion or of the derivatives cannot go on.

        Notes
        -----
        The linearised equations are integrated together with the motion, by Taylor series in which every
        number carries its derivatives. They are accurate to the last digits, whatever method and tolerance
        this motion was computed with. A feedback reverses its torque at half a turn from its target; the
        derivatives jump there, and the jump is computed. For free bodies :meth:`FreeMotion.sensitivity` is
        exact at any time.

        If the initial states of a load were not given to `simulate`, they follow from other numbers. At the
        start a wheel has the momentum ``h = J (Ω + a·ω)``, where J is its moment of inertia, a its axis and Ω
        its rate relative to the body. The derivatives with respect to J, a and Ω include the change of h. The
        derivatives with respect to ω at the first time do not: h stays fixed there. The field ``begins`` of
        :class:`polhode.MotionSensitivity` says how to find those with Ω fixed.

        Differences remain right where the law of the load changes on the way, for example when a wheel stops
        in its bearing or a motor saturates: each of the neighbouring motions finds its own time of the
        change. All numbers of an orbit are varied: also J₂, radius and pole of an oblate attractor, and each
        position of a table. Each number takes six runs, and more if it is zero: they find a step that fits
        the motion. A number that is zero and must not be negative, such as a friction, is only increased, and
        one at an upper limit is only decreased. A derivative is NaN where the slopes on the two sides of a
        number differ: by a duty of zero, or by a torque that is just the limit of a motor.

        The following numbers cannot be varied, and have no derivatives by differences:

        - numbers inside a function,
        - the attitude of a target at rest,
        - the arguments of a stack of loads,
        - the arguments of a load that is multiplied by a factor, or is added to a compiled function.

        Examples
        --------
        How a top's spin after three seconds depends on where it pointed at the start, and on the weight:

        >>> import numpy as np
        >>> from polhode import RigidBody, loads
        >>> top = RigidBody.from_principal(1.0, (0.2, 0.2, 0.1), center_of_mass=(0, 0, 0.3))
        >>> weight = loads.uniform_gravity((0, 0, -9.81))
        >>> tilted = (np.sin(0.2), 0, 0, np.cos(0.2))
        >>> run = top.simulate([0, 3], (0, 0, 40), tilted, load=weight, about="origin")
        >>> slopes = run.sensitivity()
        >>> slopes.state.shape, slopes.load[0]["gravity"].shape
        ((2, 6, 6), (2, 6, 3))
        """
        if self._contact is not None:
            raise ValueError(
                "sensitivity: the derivatives of a body that rolls are not known; take differences of "
                "motions from starts a little apart, simulated tightly"
            )
        self._check_constant("sensitivity", "take differences of motions from starts a little apart")
        self._check_series("sensitivity", "; FreeMotion.sensitivity(t) has those of a free body at any times")
        if method == "differences":
            from polhode.motion.finite_differences import by_differences

            return by_differences(self)
        if method != "series":
            raise ValueError(f"method: expected 'series' or 'differences', got {method!r}")
        start, load = self.state(0), self._acting("sensitivity")
        return _core.motion_sensitivity(
            self.body,
            self.t,
            start.omega,
            start.attitude,
            load,
            self._about_word(),
            start.states if load is self.load else None,
            self._origin.states,
        )

    def resume(self, t: ArrayLike, *, from_event: bool = False, **options: Any) -> Trajectory:
        """Continue the simulation from the last state, under the same load or under another one.

        The clock of the motion goes on too: orbits without an epoch and controllers with a period count from
        the first time of the motion, in every load and however often it is resumed.

        Parameters
        ----------
        t : array_like, shape (T,)
            Times as in `simulate`; the first must be the last of this motion, or with `from_event` the time
            of its last event.
        from_event : bool
            Go on from the terminal event that ended the motion of one body. If the same event is passed again
            in `events`, this passage does not count again. The default is to go on from the last time.
        **options
            Further arguments of :meth:`polhode.RigidBody.simulate`, such as `method` and `rtol`. States of
            another `load` go on from those of the same name and number, so that wheels keep their momentum;
            the others begin anew. `states` sets some of them. The angular momentum of wheels, rotors and
            slugs must not jump.

        Returns
        -------
        Trajectory

        Raises
        ------
        ValueError
            If another load, or `states`, makes the total angular momentum jump: the wheels of the motion are
            missing in it, or it has others that turn. With `from_event`, if no event ended the motion.

        See Also
        --------
        RigidBody.stepper : many short steps, with the same bits in less time.

        Examples
        --------
        >>> from polhode import RigidBody, loads
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> first = body.simulate([0, 1], omega=(0, 0, 1))
        >>> first.resume([1, 2]).quaternion[-1].round(6)
        array([0.      , 0.      , 0.841471, 0.540302])

        A thruster fires for a second; the wheel goes on:

        >>> wheel = loads.wheel((0, 0, 1), inertia=0.5, torque=0.1)
        >>> first = body.simulate([0, 1], omega=(0, 0, 0), load=wheel)
        >>> fires = first.resume([1, 2], load=wheel + loads.constant_torque((0, 0, 0.3)))
        >>> fires.states["wheel"][-1].round(9), fires.angular_momentum().spin[-1].round(9)
        (array([0.2]), array([0. , 0. , 0.3]))

        An event ends a motion, which goes on from there:

        >>> import numpy as np
        >>> from polhode import Event
        >>> half = Event(lambda t, omega, quaternion, *_: quaternion[3], terminal=True)
        >>> first = body.simulate([0, 10], omega=(0, 0, 1), events=half)
        >>> second = first.resume([first.events.t[-1], 10], from_event=True, events=half)
        >>> (first.events.t / np.pi).round(9), (second.events.t / np.pi).round(9)
        (array([1.]), array([3.]))
        """
        start = _core.real_numbers(t, "t").reshape(-1)[:1]
        state, last = self._event_state() if from_event else (self.state(), self.t.reshape(-1)[-1:])
        if not np.array_equal(start, last):
            raise ValueError(f"t: the motion goes on from t = {float(last[0])!r}, got {start.tolist()}")
        if np.isnan(state.omega).any():
            instead = "; to go on from the event: from_event=True" if np.any(self.status == "event") else ""
            raise ValueError(
                "resume: the last state is not known, since the run did not come to the last time" + instead
            )
        about = self._about_word()
        for name in _OF_THE_MOTION:
            if name in options and not (name == "about" and options[name] == about):
                raise TypeError(
                    f"resume: {name}: the motion goes on from its own state; for another one begin anew: "
                    f"body.simulate(t, **motion.state()._asdict() | {{{name!r}: ...}})"
                )
        given = state._asdict() | {"about": about}
        if self.pivoted or (self._contact is not None and self._contact.law == "rolling"):
            del given["velocity"]
        if self._contact is not None:
            given["contact"] = self._contact
        first = float(self.t.flat[0]) if self._origin.start is None else self._origin.start
        is_another = "load" in options or "states" in options
        load = options.pop("load") if "load" in options else self._acting("resume", -1)
        if isinstance(load, _core.Load):
            load = load.with_epoch(first)
        known = load.states if isinstance(load, _core.Load) else {}
        states = {
            name: values
            for name, values in (state.states or {}).items()
            if known.get(name) == np.shape(values)[-1]
        }
        own = options.pop("states", None)
        given |= {"load": load, "states": (states | dict(own) if own is not None else states) or None}
        if is_another:
            self._check_momentum(start, state, given)
        if from_event and options.get("events") is not None:
            given["events"] = after_event(options.pop("events"), self._ended_by, int(self.events.event[-1]))
        run = self.body.simulate(t, **given | options)
        run.__dict__["_origin"] = replace(run._origin, start=first)
        if self.uncertain_start != (None, None) or self.body._doubts() is not None:
            run.__dict__["uncertain_start"] = None  # the last state is uncertain, together with the body
        return run

    def save(self, path: str | PathLike[str]) -> None:
        """Write the motion to a file, with every bit of it.

        Parameters
        ----------
        path : str or os.PathLike
            The ending of the name tells the format. The load and the events are not written.

            ``.csv`` has one line for each time. The columns are ``t``; ``omega_*``, components in the body
            frame; ``quaternion_*``; ``position_*`` and ``velocity_*``, components in space; the angles
            ``euler_phi``, ``euler_theta``, ``euler_psi`` (ZXZ, in radians, nan where they are not defined);
            ``torque_*`` of the load about the point `about`, components in the body frame; and the states of
            the load. The torque is left out if the load is not known or a state is nan. For a stack, each
            line begins with the indices of the body.

            ``.npz`` has the arrays under the names of the attributes, and ``mass``, ``inertia`` and
            ``center_of_mass`` of the body. ``.json`` is text after the schema
            :data:`polhode.io.TRAJECTORY_SCHEMA`.
        """
        from polhode.io.saved import save_trajectory

        save_trajectory(self, path)

    def to_xarray(self) -> Dataset:
        """Return the motion as an :class:`xarray.Dataset`; needs xarray.

        Returns
        -------
        xarray.Dataset
            Its dimensions are ``time``, for a stack after ``body`` (or ``body_0``, ``body_1``, …). Components
            are named ``x y z`` and ``x y z w``; an attribute of each variable names its frame.
        """
        from polhode._optional import require

        xarray = require("xarray", extra=None, purpose="Trajectory.to_xarray")
        self._check_series("to_xarray")
        shape = self.omega.shape[:-2]
        stack = ["body"] if len(shape) == 1 else [f"body_{axis}" for axis in range(len(shape))]
        vector, frames = (
            [*stack, "time", "component"],
            {"omega": "body", "position": "space", "velocity": "space"},
        )
        variables: dict[str, Any] = {
            name: (vector, getattr(self, name), {"frame": frame}) for name, frame in frames.items()
        }
        variables["quaternion"] = (
            [*stack, "time", "quaternion_component"],
            self.quaternion,
            {"long_name": "R_NB, scalar last"},
        )
        for name, values in self.states.items():
            variables[name] = ([*stack, "time", f"{name}_component"], values, {"long_name": "of the load"})
        coordinates = {"time": self.t, "component": list("xyz"), "quaternion_component": list("xyzw")}
        dataset: Dataset = xarray.Dataset(variables, coordinates, {"title": repr(self)})
        return dataset

    def to_pandas(self) -> DataFrame:
        """Return the motion as a :class:`pandas.DataFrame`; needs pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each time, indexed by ``t``, after ``body`` (or ``body_0``, ``body_1``, …) of a stack;
            its columns are those of the ``.csv`` that `save` writes.
        """
        from polhode._optional import require
        from polhode.io.saved import table_of

        pandas = require("pandas", extra=None, purpose="Trajectory.to_pandas")
        self._check_series("to_pandas")
        index, columns = table_of(self)
        rows = pandas.MultiIndex.from_arrays([values.ravel() for values in index.values()], names=list(index))
        if len(index) == 1:
            rows = pandas.Index(index["t"], name="t")
        table: DataFrame = pandas.DataFrame(
            {name: values.ravel() for name, values in columns.items()}, index=rows
        )
        return table

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

    def view(self, plotter: Plotter | None = None, **options: Any) -> Plotter:
        """Show the motion of one body in a window; needs pyvista.

        Parameters
        ----------
        plotter : pyvista.Plotter, optional
            Where to show it; a new one by default.
        **options
            `at`, `shape`, `duration`, `title` and `time_label`, see :func:`polhode.view.motion`.

        Returns
        -------
        pyvista.Plotter
            Its ``show()`` opens the window.
        """
        from polhode.view import motion

        return motion(self, plotter, **options)

    def animate(self, path: str | PathLike[str], **options: Any) -> FilePath:
        """Write the motion of one body as a moving picture.

        Parameters
        ----------
        path : str or os.PathLike
            ``.html``: an interactive page that needs nothing else; ``.gif``: needs matplotlib;
            ``.mp4``: needs also the program ffmpeg, which the extra ``film`` brings.
        **options
            `shape`, `frames`, `duration`, `title`, `time_label`, `size`, `fps`, `labels` and `progress`, see
            :func:`polhode.animation.animate`.

        Returns
        -------
        pathlib.Path
            Where it was written.

        Examples
        --------
        >>> import tempfile
        >>> from pathlib import Path
        >>> import numpy as np
        >>> from polhode import solids
        >>> motion = solids.box((3, 2, 1), mass=1.0).simulate(np.linspace(0, 10, 201), omega=(0.01, 1, 0))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     page = motion.animate(Path(folder) / "racket.html", title="The tennis racket")
        ...     page.read_text(encoding="utf-8")[:15]
        '<!DOCTYPE html>'
        """
        from polhode.animation import animate

        return animate(self, path, **options)

    @cached_property
    def covariance(self) -> Floats | None:
        """Return the covariance of (δ, ω) at every time, shape (..., T, 6, 6); None if nothing is uncertain.

        δ is a small rotation from the attitude, ``R → R exp(δ×)``, components in the body frame, in radians.
        It comes from the covariance of the body, and from `omega` and `attitude` at the start if they were
        given as `Uncertain`. It is computed to first order, by the derivatives of :meth:`sensitivity`, with
        all correlations.

        Examples
        --------
        >>> import numpy as np
        >>> from polhode import Uncertain, solids
        >>> brick = solids.box(Uncertain((1, 2, 3), sigma=0.001), mass=1.0)
        >>> run = brick.simulate([0, 10], omega=Uncertain((0.1, 0.2, 2.0), sigma=0.001))
        >>> run.covariance.shape, run.sigma.omega[0]
        ((2, 6, 6), array([0.001, 0.001, 0.001]))
        """
        from polhode.uncertainty.motion import state_covariance

        return state_covariance(self)

    @cached_property
    def sigma(self) -> StateSigma | None:
        """Return the sigmas of attitude and angular velocity, shape (..., T, 3) each, or None."""
        from polhode.uncertainty.motion import state_sigma

        return state_sigma(self)

    def _spin_covariance(self, frame: Literal["space", "body"]) -> Floats | None:
        """Compute the covariance of the angular momentum at every time."""
        from polhode.uncertainty.motion import spin_covariance

        return spin_covariance(self, frame)

    def show(self, *, height: int = 460, **options: Any) -> HtmlPage:
        """Show the motion of one body as an interactive page: below a notebook's cell, or in the browser.

        Parameters
        ----------
        height : int
            Of the frame in a notebook, in pixels.
        **options
            `shape`, `duration`, `title` and `time_label`, see :func:`polhode.animation.animate`.

        Returns
        -------
        HtmlPage
            Outside a notebook its ``path`` is the page, in the folder for temporary files.

        Examples
        --------
        >>> from polhode import solids
        >>> motion = solids.box((3, 2, 1), mass=1.0).simulate([0.0, 20.0], omega=(0.01, 3, 0))
        >>> motion.show(title="The tennis racket")  # doctest: +SKIP
        """
        from polhode.draw.html import show

        return show(self, height=height, **options)

    def _repr_html_(self) -> str:
        """Show the motion at the end of a notebook's cell: omega over time, and the page below it."""
        from polhode.draw.html import motion_html

        return motion_html(self)

    def _varying(self) -> _core.VaryingBody | None:
        """Return the body if it varies with time."""
        body: Any = self.body  # to type checkers one that does not, as of nearly all motions
        return body if isinstance(body, _core.VaryingBody) else None

    def _check_constant(self, what: str, instead: str) -> None:
        """Refuse a body that varies with time."""
        if self._varying() is not None:
            raise ValueError(f"{what}: the body of this motion varies with time; {instead}")

    def _bodies(self) -> _core.RigidBody:
        """Return the body or stack with axes for time, along which it broadcasts."""
        varying = self._varying()
        if varying is not None:
            return varying.at(self.t)
        return self.body[(..., *self._time_axes())]

    def _time_axes(self) -> tuple[None, ...]:
        """Index with new axes for the times: one for a series, several for an exact motion at more."""
        return (np.newaxis,) * self.t.ndim

    def _check_series(self, what: str, hint: str = "") -> None:
        """Refuse times that are no series; an exact motion may have times of any shape."""
        if self.t.ndim != 1 or not self.t.size:
            raise ValueError(
                f"{what}: needs a series of times, and t of this motion has the shape {self.t.shape}; "
                f"ask for times of shape (T,){hint}"
            )

    def _per_time(self, vectors: Floats) -> Floats:
        """Return vectors with the axes of time before their components."""
        return vectors[(..., *self._time_axes(), slice(None))]

    def _reference(self) -> Floats:
        if self._varying() is not None:  # the centre of mass at each time, or the origin
            return self.about
        return self._per_time(self.about)

    def _over_time(self, load: _core.Load) -> _core.Load:
        """Return a stack of loads with an axis for time, along which it broadcasts."""
        return load[(..., *self._time_axes())] if load.shape else load

    def _states(self) -> tuple[Floats, ...]:
        return self.t, self.omega, self.quaternion, self.position, self.velocity

    def _own_states(self) -> dict[str, Floats] | None:
        return self.states or None

    def _is_loaded(self) -> bool:
        """Return whether a load acted, which a motion from a file does not have."""
        return self.load is not None or self._origin.loaded or self._origin.plane

    def _is_driven(self) -> bool:
        """Return whether a load or a plane acted, which a file of the motion does not hold."""
        return self._is_loaded() or self._contact is not None

    def _about_word(self) -> Literal["origin", "center_of_mass"]:
        return "origin" if self.pivoted else "center_of_mass"

    def _subject(self) -> dict[str, Any]:
        return {
            "body": self._bodies(),
            "about": self._about_word(),
            "start": float(self.t.flat[0]) if self.t.size else 0.0,
        }

    def _potential(self) -> Floats | None:
        if self.load is None:
            return None if self._is_loaded() else np.zeros(self.omega.shape[:-1])
        return self._over_time(self.load).potential(
            self._bodies(), self.quaternion, self.position, self._about_word()
        )

    def _kept_directions(self) -> Any:
        """Return the directions along which L is conserved: True for all, unit vectors, or None."""
        varying = self._varying()
        if self._contact is not None or (varying is not None and varying.outlet is not None):
            return None
        if self.load is None:
            return None if self._is_loaded() else True
        return self.load.keeps_momentum(self._about_word())

    def _event_state(self) -> tuple[State, Floats]:
        """Return the state at the terminal event that ended the motion of one body, and its time."""
        if np.ndim(self.status):
            raise ValueError(
                "from_event: the bodies of a stack end at different times; go on with one of them: simulate "
                "it alone"
            )
        if self.status != "event":
            raise ValueError(
                f"from_event: no terminal event ended this motion, its status is {self.status!r}; go on from "
                "its last time without from_event"
            )
        found = self.events
        states = {name: values[-1] for name, values in found.states.items()}
        state = State(
            found.omega[-1], found.quaternion[-1], found.position[-1], found.velocity[-1], states or None
        )
        return state, found.t[-1:]

    def _check_momentum(self, start: Floats, state: State, given: dict[str, Any]) -> None:
        """Refuse a start under another load at which the total angular momentum would jump."""
        first = self.body.simulate(start, **given)
        nothing = np.zeros_like(first.omega[..., 0, :])
        was = nothing if self.carried is None else self.carried[0][..., -1, :]
        if self.load is not None and self.carried is not None and np.isnan(was).any():  # at an event
            was = self.load.carried(start[0], state.omega, state.states)[0]
        now = nothing if first.carried is None else first.carried[0][..., 0, :]
        body = lengths(first.angular_momentum("body").spin[..., 0, :] - now)
        off = now - was
        jumps = lengths(off) > _EQUAL_MOMENTA * (lengths(now) + lengths(was) + body)
        if np.any(jumps):
            into, of = (np.broadcast_to(one, off.shape)[jumps][0].tolist() for one in (now, was))
            raise momentum_jump(float(start[0]), of, into)

    def _rotor_inside(self) -> tuple[Floats, Floats]:
        """Return the momentum h inside a gyrostat, and Σ J a aᵀ of its free wheels."""
        motion = self._origin.motion
        assert motion is not None
        return motion.rotor, motion.gyrostat._rotor()[1]

    def _carried_now(self) -> tuple[Floats, Floats] | None:
        """Return momentum and energy of the wheels of the load, or of a gyrostat."""
        if self._origin.motion is not None:
            momentum, free = self._rotor_inside()
            of_free = np.einsum(
                "...ij,...j->...i", free[(..., *self._time_axes(), slice(None), slice(None))], self.omega
            )
            return self._per_time(momentum) - of_free, -0.5 * np.einsum("...i,...i->...", self.omega, of_free)
        if self.load is None or not self.load.carries:
            return None
        return self._over_time(self.load).carried(self.t, self.omega, self._own_states())

    def _acting(self, what: str, index: int = 0) -> _core.Load | None:
        """Return the load that gives this motion in a simulation; for a gyrostat from one of its times on."""
        if self._origin.plane:
            raise ValueError(
                f"{what}: a plane acts on this motion along a line of contact; force(t) and pressure_at(t) "
                "of its RollingMotion give the force"
            )
        if self.load is None and self._is_loaded() and self.carried is None:
            raise ValueError(
                f"{what}: a load acted on this motion, which its file does not hold; of a stepper it is not "
                "known either once it has changed"
            )
        if self.load is not None or self.carried is None:
            return self.load
        if self._origin.motion is None:
            raise ValueError(
                f"{what}: the load of this motion is unknown: its file holds only the angular momentum of "
                "wheels and dampers, as does a stepper whose load has changed; simulate the motion anew with "
                "its load"
            )
        momentum, free = self._rotor_inside()
        return self._wheels_inside(what, index) if np.any(free) else _core.rotor(momentum)

    def _wheels_inside(self, what: str, index: int) -> _core.Load:
        """Return the free wheels of a gyrostat along the axes of Σ J a aᵀ, and the rest as a rotor."""
        momentum, free = self._rotor_inside()
        inertias, axes = np.linalg.eigh(free)
        turning = inertias > _NO_WHEEL * inertias[..., -1:]
        rows = turning.reshape(-1, 3)
        if (rows != rows[0]).any():
            raise ValueError(
                f"{what}: the gyrostats have free wheels along one, two or three axes; ask one by one"
            )
        start = self.omega[..., index, :]
        load: _core.Load | None = None
        rest = momentum
        for k in np.flatnonzero(rows[0]):
            axis, inertia = axes[..., k], inertias[..., k]
            held = np.einsum("...i,...i->...", axis, momentum)
            rest = rest - held[..., None] * axis
            rate = held / inertia - np.einsum("...i,...i->...", axis, start)
            one = _core.wheel(axis, inertia, rate)
            load = one if load is None else load + one
        assert load is not None
        return load + _core.rotor(rest)

    def _exact(self) -> _core.FreeMotion | _core.GyrostatMotion | None:
        """Return the motion in closed form from the first state on, of one body; None where none is known."""
        if self._is_loaded() or self.pivoted or self._contact is not None or self._varying() is not None:
            return None
        motion = self._origin.motion
        if motion is None:
            return self.body.free_motion(self.omega[0], self.quaternion[0]) if self.carried is None else None
        _, (_, besides, wheels) = cast("tuple[Any, tuple[Any, Floats, Any]]", motion.gyrostat.__reduce__())
        now = [_at(one, motion.omega - self.omega[0]) for one in wheels]
        return self.body.gyrostat(besides, wheels=now).free_motion(self.omega[0], self.quaternion[0])

    def _torque_of_rotor(self) -> Floats:
        """Compute the torque of the momentum inside a gyrostat: ``(I − F) ω̇ + ω × ((I − F) ω + h) = 0``."""
        momentum, free = self._rotor_inside()
        tensor = self._bodies().inertia_about(self._reference())
        inertias = free[(..., *self._time_axes(), slice(None), slice(None))]
        total = np.einsum("...ij,...j->...i", tensor - inertias, self.omega) + self._per_time(momentum)
        rate = np.linalg.solve(tensor - inertias, -np.cross(self.omega, total)[..., np.newaxis])
        in_body = np.einsum("...ij,...j->...i", tensor, self.omega)
        torque: Floats = (tensor @ rate)[..., 0] + np.cross(self.omega, in_body)
        return torque


def _turn_back(frame: Floats, body: Floats) -> Floats:
    """Compute ``p⁻¹∘q`` for quaternions p and q: the attitude of a body in a frame."""
    u, p = frame[..., :3], frame[..., 3:]
    v, q = body[..., :3], body[..., 3:]
    vector = p * v - q * u - np.cross(u, v)
    return np.concatenate([vector, p * q + np.sum(u * v, axis=-1, keepdims=True)], axis=-1)


def _continuous(quaternion: Floats) -> Floats:
    """Choose the signs of quaternions (..., T, 4) so that each is near the one before it."""
    near = np.sum(quaternion[..., 1:, :] * quaternion[..., :-1, :], axis=-1)
    signs = np.cumprod(np.where(near < 0.0, -1.0, 1.0), axis=-1)[..., np.newaxis]
    return np.concatenate([quaternion[..., :1, :], quaternion[..., 1:, :] * signs], axis=-2)


def momentum_jump(t: float, of: list[float], into: list[float]) -> ValueError:
    """Return the error of a motion that goes on with another momentum of what the body carries along."""
    return ValueError(
        f"load: the total angular momentum would jump at t = {t!r}: what the body "
        f"carries along, wheels, rotors and slugs, has {of} now and {into} under this load. Wheels "
        "of the same name keep their state: add to the load of the motion, load=motion.load + other, "
        "name wheels as before, and give new ones no rate; or begin another motion with simulate"
    )


def _unwrap(angles: Floats) -> Floats:
    """Unwrap angles (..., T, 3) along the times, over gaps that are not numbers."""
    columns = np.moveaxis(angles, -2, -1)
    series = columns.reshape(-1, columns.shape[-1]).copy()
    for one in series:
        known = ~np.isnan(one)
        one[known] = np.unwrap(one[known])
    return np.moveaxis(series.reshape(columns.shape), -1, -2)


def _at(one: Wheel, slower: Floats) -> Wheel:
    """Return a wheel with its rate after ω has decreased by a vector: a free one keeps ``J (Ω + a·ω)``."""
    if one.mode == "held":
        return one
    along = (one.axis / np.linalg.norm(one.axis)) @ slower
    momentum = one.momentum + one.inertia * along
    return wheel(axis=one.axis, inertia=one.inertia, momentum=momentum, name=one.name)
