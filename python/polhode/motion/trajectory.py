"""The motion of a body, or of a stack of them: what `simulate` returns."""

from __future__ import annotations

import operator
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from polhode import _acting, _angles, _carried, _core, _going_on, _outlets
from polhode._hints import Hinting, no_attribute
from polhode.draw import html
from polhode.motion.events import Events
from polhode.motion.invariants import drift, lengths
from polhode.results import AngularMomentum, Invariants, KineticEnergy, State
from polhode.uncertainty import motion

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import ArrayLike, NDArray
    from scipy.spatial.transform import Rotation

    from polhode.errors import IntegrationError, PolhodeError

    Floats = NDArray[np.float64]

__all__ = ["Trajectory"]


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(metaclass=Hinting):
    """The motion of one body or of a stack at the times asked for.

    Attributes
    ----------
    body : RigidBody
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
        The point the motion refers to, in the body frame.
    steps, evaluations : numpy.ndarray, shape (...)
        Accepted steps and evaluations of the equations of motion.
    load : Load or None
        What acted on the body.
    status : str or numpy.ndarray of str, shape (...)
        How the run of each body ended: ``"complete"``; ``"event"``, at a terminal event; ``"failed"``;
        ``"stopped"``, by Ctrl-C; or ``"not run"``, since another body failed first. States after the end are
        NaN.
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

    # Methods that stand in files of their own.
    euler_angles = _angles.euler_angles
    euler_rates = _angles.euler_rates
    torque = _acting.torque
    force = _acting.force
    angular_acceleration = _acting.angular_acceleration
    potential_energy = _acting.potential_energy
    pivot_reaction = _acting.pivot_reaction
    sensitivity = _going_on.sensitivity
    covariance = cached_property(motion.covariance)
    sigma = cached_property(motion.sigma)
    _spin_covariance = motion.spin_covariance
    resume = _going_on.resume
    save = _outlets.save
    to_pandas = _outlets.to_pandas
    to_xarray = _outlets.to_xarray
    plot = _outlets.plot
    view = _outlets.view
    animate = _outlets.animate
    show = html.show
    _repr_html_ = html.repr_html
    _carried_now = _carried.now
    _acting = _carried.acting
    _exact = _carried.exact

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
        """Give all attributes, for copy and pickle."""
        held = {
            name: self.__dict__[name]
            for name in ("_within", "_was_loaded", "_given", "_began")
            if name in self.__dict__
        }
        return held | {one.name: getattr(self, one.name) for one in fields(self)}

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
    def rotation(self) -> Rotation:
        """The attitude as :class:`scipy.spatial.transform.Rotation`, shape (..., T); needs SciPy."""
        from polhode._optional import require

        transform = require("scipy.spatial.transform", extra=None, purpose="Trajectory.rotation")
        rotation: Rotation = transform.Rotation.from_quat(self.quaternion)
        return rotation

    def kinetic_energy(self) -> KineticEnergy:
        """Kinetic energy at every time, in parts that refer to the point `about`.

        Returns
        -------
        KineticEnergy
            Each part of shape (..., T). The rotational part includes the energy of wheels and slugs. It does
            not include the energy of a rotor, of which only the momentum is known. For a body with a rotor
            and no other load, ``½ ω·I ω`` stays constant. For a gyrostat in closed form the total is
            :attr:`polhode.GyrostatMotion.kinetic_energy`.
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
        """Angular momentum about the origin of space at every time.

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

    def point(self, r: Literal["center_of_mass", "com", "origin"] | ArrayLike) -> Floats:
        """Position in space of a point of the body at every time.

        Parameters
        ----------
        r : {"center_of_mass", "origin"} or array_like, shape (..., 3)
            The point in the body frame; ``"com"`` is the centre of mass too.

        Returns
        -------
        numpy.ndarray, shape (..., T, 3)
        """
        center = self.body.center_of_mass
        words = {"center_of_mass": center, "com": center, "origin": np.zeros(3)}
        if isinstance(r, str) and r not in words:
            raise ValueError(f"r: {r!r} is not 'center_of_mass', 'origin' or a point of shape (..., 3)")
        place = words[r] if isinstance(r, str) else _core.real_numbers(r, "r")
        if place.shape[-1:] != (3,):
            raise ValueError(f"r: expected shape (..., 3), got {place.shape}")
        arm = place - self.about
        return self.position + _core.rotate(self.quaternion, self._per_time(arm))

    def invariants(self) -> Invariants:
        """Give the conserved quantities of the motion, and how far the numbers have drifted from them.

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
        spin = self.angular_momentum().spin
        energy = None if potential is None else kinetic + potential
        kept = self._kept_directions()
        along = None
        if kept is not None:
            along = spin if kept is True else np.einsum("...i,...i->...", spin, self._per_time(kept))

        def drifted(values: Floats, size: Floats) -> Any:
            stack = size.shape[: size.ndim - self.t.ndim]
            if not self.t.size:
                return np.zeros(stack)[()]
            flat = (*stack, self.t.size)  # whatever the shape of t
            return drift(values.reshape(*flat, *values.shape[size.ndim :]), size.reshape(flat))

        return Invariants(
            energy,
            along,
            None if potential is None else drifted(kinetic + potential, kinetic + np.abs(potential)),
            None if along is None else drifted(along, lengths(spin)),
        )

    def state(self, index: int = -1) -> State:
        """Give the state at one of the times, to go on from or to begin anew with.

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

        known, besides = read_motion(path)
        motion = Trajectory(**known)
        motion.__dict__.update(besides)
        return motion

    def _bodies(self) -> _core.RigidBody:
        """Give the body or stack with axes for time, along which it broadcasts."""
        return self.body[(..., *self._time_axes())]

    def _time_axes(self) -> tuple[None, ...]:
        """One new axis for a series of times; for an exact motion as many as its times have."""
        return (np.newaxis,) * self.t.ndim

    def _check_series(self, what: str, hint: str = "") -> None:
        """Refuse times other than a series: an exact motion is known at times of any shape."""
        if self.t.ndim != 1 or not self.t.size:
            raise ValueError(
                f"{what}: needs a series of times, and t of this motion has the shape {self.t.shape}; "
                f"ask for times of shape (T,){hint}"
            )

    def _per_time(self, vectors: Floats) -> Floats:
        """Give vectors the axes of time before their components."""
        return vectors[(..., *self._time_axes(), slice(None))]

    def _reference(self) -> Floats:
        return self._per_time(self.about)

    def _over_time(self, load: _core.Load) -> _core.Load:
        """Give a stack of loads an axis for time, along which it broadcasts."""
        return load[(..., *self._time_axes())] if load.shape else load

    def _states(self) -> tuple[Floats, ...]:
        return self.t, self.omega, self.quaternion, self.position, self.velocity

    def _own_states(self) -> dict[str, Floats] | None:
        return self.states or None

    def _is_loaded(self) -> bool:
        """Tell whether a load acted, which a motion from a file does not have."""
        return self.load is not None or "_was_loaded" in self.__dict__

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
        """Give the directions along which L is conserved: True for all, unit vectors, or None."""
        if self.load is None:
            return None if self._is_loaded() else True
        return self.load.keeps_momentum(self._about_word())
