"""Events of a motion: functions of time and state, and the table of their passages through zero.

The search itself is in the compiled core: ``rust/core/src/motion/simulate/events.rs``.
"""

from __future__ import annotations

import operator
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Event", "Events"]


@dataclass(frozen=True, eq=False)
class Event:
    """An event: a passage through zero of a function of the motion, which `RigidBody.simulate` searches for.

    A plain function is an event too. This class adds the attributes ``direction`` and ``terminal``, as in
    ``solve_ivp`` of SciPy.

    Attributes
    ----------
    function : callable
        ``function(t, omega, quaternion, position, velocity)`` returns a number: zero at the event. If the
        load has states, they are the sixth argument, a dict by name.
    direction : float
        Positive: only passages that rise in time count; negative: only those that fall; zero: all.
    terminal : bool or int
        True ends the run at the first passage, a number n at the n-th.

    Examples
    --------
    The flips of a racket that spins about its intermediate axis:

    >>> from polhode import Event, RigidBody
    >>> racket = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    >>> flip = Event(lambda t, omega, *_: omega[1], terminal=3)
    >>> motion = racket.simulate([0, 200], omega=(1e-3, 1.0, 1e-3), events=flip)
    >>> motion.events.t.round(4), motion.status
    (array([ 22.8707,  62.156 , 101.4413]), 'event')
    """

    function: Callable[..., float]
    direction: float = 0.0
    terminal: bool | int = False
    _of_load: tuple[str, str] | None = field(default=None, init=False, repr=False)
    _thruster: int | None = field(default=None, init=False, repr=False)
    _is_at_start: bool = field(default=False, init=False, repr=False)

    @classmethod
    def stop(cls, wheel: str = "wheel", *, terminal: bool | int = False) -> Event:
        """Make the event that a wheel with dry friction comes to rest in its bearing.

        The integration itself needs these times, and finds them to the last digits. The state of the event
        has the wheel at rest. If the motor is stronger than the friction, the wheel goes on at once; there is
        then a :meth:`breakaway` at the same time.

        Parameters
        ----------
        wheel : str
            Name of the state of the wheel in ``states`` of the trajectory.
        terminal : bool or int
            As for the class.

        Examples
        --------
        >>> from polhode import Event, RigidBody, loads
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
        >>> wheel = loads.wheel((0, 0, 1), inertia=0.5, rate=10.0, dry_friction=0.25)
        >>> motion = body.simulate([0, 100], (0, 0, 0), load=wheel, events=Event.stop("wheel"))
        >>> motion.events.t.round(9), motion.events.states["wheel"][0].round(9)
        (array([16.66666667]), array([0.83333333]))
        """
        return cls._of_kind("stop", wheel, 0.0, terminal)

    @classmethod
    def breakaway(cls, wheel: str = "wheel", *, terminal: bool | int = False) -> Event:
        """Make the event that a wheel at rest in its bearing begins to turn; arguments as :meth:`stop`."""
        return cls._of_kind("breakaway", wheel, 0.0, terminal)

    @classmethod
    def limit(cls, wheel: str = "wheel", *, direction: float = 0.0, terminal: bool | int = False) -> Event:
        """Make the event that the torque demanded of a motor passes the motor's limit.

        Parameters
        ----------
        wheel : str
            Name of the state of the wheel in ``states`` of the trajectory.
        direction : float
            Positive: only when the motor begins to saturate; negative: only when it ceases to; zero: both.
        terminal : bool or int
            As for the class.
        """
        return cls._of_kind("limit", wheel, direction, terminal)

    @classmethod
    def rate_limit(
        cls, wheel: str = "wheel", *, direction: float = 0.0, terminal: bool | int = False
    ) -> Event:
        """Make the event that a wheel comes to its `max_rate`, or leaves it.

        The integration itself needs these times, and finds them to the last digits.

        Parameters
        ----------
        wheel : str
            Name of the state of the wheel in ``states`` of the trajectory.
        direction : float
            Positive: only when the wheel comes to its limit; negative: only when it leaves it; zero: both.
        terminal : bool or int
            As for the class.

        Examples
        --------
        >>> from polhode import Event, RigidBody, loads
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
        >>> wheel = loads.wheel((0, 0, 1), inertia=0.5, torque=0.1, max_rate=2.0)
        >>> motion = body.simulate([0, 20], (0, 0, 0), load=wheel, events=Event.rate_limit())
        >>> motion.events.t.round(9), motion.states["wheel"][-1].round(9)
        (array([8.33333333]), array([0.83333333]))
        """
        return cls._of_kind("rate limit", wheel, direction, terminal)

    @classmethod
    def momentum_limit(
        cls, wheel: str = "wheel", *, direction: float = 0.0, terminal: bool | int = False
    ) -> Event:
        """Make the event that a wheel comes to its `max_momentum`, or leaves it; see :meth:`rate_limit`."""
        return cls._of_kind("momentum limit", wheel, direction, terminal)

    @classmethod
    def dipole_limit(cls, *, direction: float = 0.0, terminal: bool | int = False) -> Event:
        """Make the event that the moment demanded of coils passes their limit, `max_dipole`.

        The coils saturate as long as one of them does, of any :func:`polhode.loads.magnetic` with a limit.

        Parameters
        ----------
        direction : float
            Positive: only when the coils begin to saturate; negative: only when they cease to; zero: both.
        terminal : bool or int
            As for the class.

        Examples
        --------
        A controller asks for a torque that rises with time, across a field of 2:

        >>> from polhode import Event, RigidBody, loads
        >>> body = RigidBody.from_principal(1.0, (1.0, 1.0, 1.0))
        >>> rising = loads.torque_callback(lambda t, *_: (0, 0, 0.1 * t))
        >>> coils = loads.magnetic(rising, (2, 0, 0), max_dipole=0.01)
        >>> body.simulate([0, 1], (0, 0, 0), load=coils, events=Event.dipole_limit()).events.t.round(6)
        array([0.2])
        """
        return cls._of_kind("dipole limit", "", direction, terminal)

    @classmethod
    def pulse(
        cls,
        thruster: int = 0,
        name: str = "thrusters",
        *,
        direction: float = 0.0,
        terminal: bool | int = False,
    ) -> Event:
        """Make the event that a thruster is switched on or off.

        These times are known at the start of each period, and are exact. A thruster that fires in two periods
        without a pause is not switched in between.

        Parameters
        ----------
        thruster : int
            Number of the thruster, from 0 on.
        name : str
            Name of the thrusters in ``states`` of the trajectory.
        direction : float
            Positive: only when it is switched on; negative: only when it is switched off; zero: both.
        terminal : bool or int
            As for the class.

        Examples
        --------
        >>> from polhode import Event, RigidBody, loads
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
        >>> jet = loads.thrusters([(1, 0, 0)], [(0, 1, 0)], 0.5, command=[0.25], period=1.0)
        >>> body.simulate([0, 2], (0, 0, 0), load=jet, events=Event.pulse()).events.t
        array([0.  , 0.25, 1.  , 1.25])
        """
        event = cls._of_kind("pulse", name, direction, terminal)
        object.__setattr__(event, "_thruster", operator.index(thruster))
        return event

    @classmethod
    def _of_kind(cls, kind: str, name: str, direction: float, terminal: bool | int) -> Event:
        event = cls(_never_called, direction, terminal)
        object.__setattr__(event, "_of_load", (kind, str(name)))
        return event

    def __call__(
        self,
        t: float,
        omega: Floats,
        quaternion: Floats,
        position: Floats,
        velocity: Floats,
        *states: dict[str, Floats],
    ) -> float:
        """Evaluate the function."""
        return self.function(t, omega, quaternion, position, velocity, *states)


def after_event(events: Any, last: Any, number: int) -> Any:
    """Return the events of a run that begins where `last`, or the one of this number, ended another.

    That event is at zero there, and does not count again.
    """
    last = last.function if getattr(last, "_is_at_start", False) else last

    def skip_start(index: int, event: Any) -> Any:
        if (index != number) if last is None else (event is not last):
            return event
        of_load, thruster = getattr(event, "_of_load", None), getattr(event, "_thruster", None)
        again = Event(event, getattr(event, "direction", 0.0), getattr(event, "terminal", False))
        object.__setattr__(again, "_of_load", of_load)
        object.__setattr__(again, "_thruster", thruster)
        object.__setattr__(again, "_is_at_start", True)
        return again

    if callable(events):
        return skip_start(0, events)
    return [skip_start(index, event) for index, event in enumerate(events)]


def _never_called(*_: Any) -> float:
    raise TypeError(
        "an event of a wheel, of coils or of a thruster is found by simulate, and has no function to call"
    )


_KINDS: Final = np.array(["function", "lift-off", "slip", "roll", "landing", "rest"])
"""By the number of an event with the other sign, from zero on."""


class _Events(NamedTuple):
    row: NDArray[np.int64]
    event: NDArray[np.int64]
    t: Floats
    omega: Floats
    quaternion: Floats
    position: Floats
    velocity: Floats


class Events(_Events):
    """Table of the events of all bodies of a stack; each field is a column.

    Attributes
    ----------
    row : numpy.ndarray of int, shape (n,)
        Index of the body in the flattened stack, see :func:`numpy.unravel_index`.
    event : numpy.ndarray of int, shape (n,)
        Index of the event function; negative for an event of a contact, see `kind`.
    kind : numpy.ndarray of str, shape (n,)
        "function", or what happens to a contact: "lift-off", "slip", "roll", "landing" or "rest".
    t : numpy.ndarray, shape (n,)
    omega : numpy.ndarray, shape (n, 3)
    quaternion : numpy.ndarray, shape (n, 4)
    position, velocity : numpy.ndarray, shape (n, 3)
        State at the event; position and velocity in space.
    states : dict of str and numpy.ndarray, shape (n, k)
        States of the load at the event, by name.
    """

    states: Mapping[str, Floats] = MappingProxyType({})

    @property
    def kind(self) -> NDArray[np.str_]:
        """Return what each event is, in a word."""
        return _KINDS[np.maximum(-self.event, 0)]

    def __repr__(self) -> str:
        count = len(self.t)
        if not count:
            return "<Events: none>"
        span = f" from {self.t.min():.6g} to {self.t.max():.6g}" if count > 1 else f" at {self.t[0]:.6g}"
        return f"<Events: {count}{span}>"

    @classmethod
    def with_states(cls, states: dict[str, Floats], *columns: Any) -> Events:
        """Make the table of a run whose load has states of its own."""
        table = cls(*columns)
        if states:
            table.states = states
        return table

    @classmethod
    def none(cls) -> Events:
        """Make the table of a run without events."""
        none, vectors = np.zeros(0, dtype=np.int64), np.zeros((0, 3))
        return cls(none, none, np.zeros(0), vectors, np.zeros((0, 4)), vectors, vectors)
