"""Events of a motion: functions of time and state, and the table of their passages through zero."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

__all__ = ["Event", "Events"]


@dataclass(frozen=True, eq=False)
class Event:
    """A function of the motion whose passages through zero `simulate` looks for.

    Any function will do; this gives it the attributes that SciPy's ``solve_ivp`` reads too.

    Attributes
    ----------
    function : callable
        ``function(t, omega, quaternion, position, velocity)`` returns a number: zero at the event. With a
        load that has states of its own it gets a sixth argument, a dict of these states by name.
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
    _of_wheel: tuple[str, str] | None = field(default=None, init=False, repr=False)

    @classmethod
    def stop(cls, wheel: str = "wheel", *, terminal: bool | int = False) -> Event:
        """Tell when a wheel with dry friction comes to rest in its bearing.

        The run finds these times for its own sake, so that they are known to the last digits; the state of
        the event is that of the wheel at rest. A motor that is stronger than the friction may turn it on at
        once: then there is a :meth:`slip` at the same time.

        Parameters
        ----------
        wheel : str
            The name of its state in `states` of the trajectory.
        terminal : bool or int
            As in an event.

        Examples
        --------
        >>> from polhode import Event, RigidBody, loads
        >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
        >>> wheel = loads.wheel((0, 0, 1), inertia=0.5, rate=10.0, dry_friction=0.25)
        >>> motion = body.simulate([0, 100], (0, 0, 0), load=wheel, events=Event.stop("wheel"))
        >>> motion.events.t.round(9), motion.events.states["wheel"][0].round(9)
        (array([16.66666667]), array([0.83333333]))
        """
        return cls._told("stop", wheel, 0.0, terminal)

    @classmethod
    def slip(cls, wheel: str = "wheel", *, terminal: bool | int = False) -> Event:
        """Tell when a wheel at rest in its bearing begins to turn; arguments as of :meth:`stop`."""
        return cls._told("slip", wheel, 0.0, terminal)

    @classmethod
    def limit(cls, wheel: str = "wheel", *, direction: float = 0.0, terminal: bool | int = False) -> Event:
        """Tell when what a motor with a limit is asked for passes that limit.

        Parameters
        ----------
        wheel : str
            The name of its state in `states` of the trajectory.
        direction : float
            Positive: only where the motor saturates; negative: only where it no longer does; zero: both.
        terminal : bool or int
            As in an event.
        """
        return cls._told("limit", wheel, direction, terminal)

    @classmethod
    def _told(cls, kind: str, wheel: str, direction: float, terminal: bool | int) -> Event:
        event = cls(_never_called, direction, terminal)
        object.__setattr__(event, "_of_wheel", (kind, str(wheel)))
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


def _never_called(*_: Any) -> float:
    raise TypeError("an event of a wheel is found by simulate, and has no function to call")


class _Events(NamedTuple):
    row: NDArray[np.int64]
    event: NDArray[np.int64]
    t: Floats
    omega: Floats
    quaternion: Floats
    position: Floats
    velocity: Floats


class Events(_Events):
    """The events of all bodies of a stack, one after the other: a table of its columns.

    Attributes
    ----------
    row : numpy.ndarray of int, shape (n,)
        Which body: the index into the flattened stack, see :func:`numpy.unravel_index`.
    event : numpy.ndarray of int, shape (n,)
        Which of the functions.
    t : numpy.ndarray, shape (n,)
    omega : numpy.ndarray, shape (n, 3)
    quaternion : numpy.ndarray, shape (n, 4)
    position, velocity : numpy.ndarray, shape (n, 3)
        The state then.
    states : dict of str and numpy.ndarray, shape (n, k)
        The states of the load then, by name: beside the columns.
    """

    states: Mapping[str, Floats] = MappingProxyType({})

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
