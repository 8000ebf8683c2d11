"""The run that goes on from the end of a motion, and the derivatives of a motion by its start."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from polhode import _core
from polhode._lengths import lengths

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from polhode.results import MotionSensitivity
    from polhode.trajectory import Trajectory

    Floats = NDArray[np.float64]

_OF_THE_MOTION = ("omega", "attitude", "position", "velocity", "about")
"""Arguments of a start that a motion has already."""

_ROUNDING = 1e-12
"""An angular momentum that differs by less, relative to its parts, is the same."""

__all__ = ["resume", "sensitivity"]


def sensitivity(self: Trajectory, method: Literal["series", "differences"] = "series") -> MotionSensitivity:
    """Tell how the motion depends on its start, on the body and on the numbers of the load.

    Parameters
    ----------
    method : {"series", "differences"}
        ``"series"`` integrates the linearised equations of motion. ``"differences"`` takes finite differences
        of order six between motions that are simulated anew; it gives about nine digits. It also serves
        the loads for which there are no series: see Raises.

    Returns
    -------
    MotionSensitivity
        Derivatives of the attitude, the angular velocity and the states of the load at every time. They are
        taken with respect to the same quantities at the first time, to the principal moments, products of
        inertia, centre of mass and mass of the body, and to the numbers of the load. Some arguments of loads
        are not varied, such as times: see :class:`polhode.MotionSensitivity`.

    Raises
    ------
    PolhodeError
        With ``"series"``, for a load without series: a callback, a compiled function, a gravity gradient
        along an oblate or sampled orbit, a magnetic field along an orbit or at given times, B-dot, a motor
        with a limit, dry friction, a feedback on a moving target. With ``"differences"``, if the differences
        of order four and of order six do not agree.
    IntegrationError
        If the integration of the motion or of the derivatives cannot go on.

    Notes
    -----
    The linearised equations are integrated together with the motion, by Taylor series in which every number
    carries its derivatives. They are accurate to the last digits, whatever method and tolerance this motion
    was computed with. A feedback reverses its torque at half a turn from its target; the derivatives jump
    there, and the jump is computed. For free bodies :meth:`FreeMotion.sensitivity` is exact at any time.

    If the initial states of a load were not given to `simulate`, they follow from other numbers. At the start
    a wheel has the momentum ``h = J (Ω + a·ω)``, where J is its moment of inertia, a its axis and Ω its rate
    relative to the body. The derivatives with respect to J, a and Ω include the change of h. The derivatives
    with respect to ω at the first time do not: h stays fixed there. The field ``begins`` of
    :class:`polhode.MotionSensitivity` says how to find those with Ω fixed.

    Differences remain right where the law of the load changes on the way, for example when a wheel stops in
    its bearing or a motor saturates: each of the neighbouring motions finds its own time of the change. All
    numbers of an orbit are varied: also J₂, radius and pole of an oblate attractor, and each position of a
    table. Each number takes six runs, and more if it is zero: they find a step that fits the motion. A number
    that is zero and must not be negative, such as a friction, is only increased.

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
    self._check_series("sensitivity", "; FreeMotion.sensitivity(t) has those of a free body at any times")
    if method == "differences":
        from polhode._differences import by_differences

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
        self.__dict__.get("_given", ()),
    )


def resume(self: Trajectory, t: ArrayLike, **options: Any) -> Trajectory:
    """Go on from the last state under the same load, or under another one.

    The clock of the motion goes on too: orbits without an epoch and controllers with a period count from the
    first time of the motion, in every load and however often it is resumed.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times as in `simulate`; the first must be the last of this motion.
    **options
        Further arguments of :meth:`polhode.RigidBody.simulate`, such as `method` and `rtol`. States of
        another `load` go on from those of the same name and number, so that wheels keep their momentum; the
        others begin anew. `states` sets some of them. The angular momentum of wheels, rotors and slugs must
        not jump.

    Returns
    -------
    Trajectory

    Raises
    ------
    ValueError
        If another load, or `states`, makes the total angular momentum jump: the wheels of the motion are
        missing in it, or it has others that turn.

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
    """
    start = _core.real_numbers(t, "t").reshape(-1)[:1]
    state, last = self.state(), self.t.reshape(-1)[-1:]
    if not np.array_equal(start, last):
        raise ValueError(f"t: the motion goes on from t = {float(last[0])!r}, got {start.tolist()}")
    if np.isnan(state.omega).any():
        raise ValueError("resume: the last state is not known, since the run did not come to the last time")
    about = self._about_word()
    for name in _OF_THE_MOTION:
        if name in options and not (name == "about" and options[name] == about):
            raise TypeError(
                f"resume: {name}: the motion goes on from its own state; for another one begin anew: "
                f"body.simulate(t, **motion.state()._asdict() | {{{name!r}: ...}})"
            )
    given = state._asdict() | {"about": about}
    if self.pivoted:
        del given["velocity"]
    began = self.__dict__.get("_began", float(self.t.flat[0]))
    is_another = "load" in options or "states" in options
    load = options.pop("load") if "load" in options else self._acting("resume", -1)
    if isinstance(load, _core.Load):
        load = load.with_epoch(began)
    known = load.states if isinstance(load, _core.Load) else {}
    states = {
        name: values
        for name, values in (state.states or {}).items()
        if known.get(name) == np.shape(values)[-1]
    }
    own = options.pop("states", None)
    given |= {"load": load, "states": (states | dict(own) if own is not None else states) or None}
    if is_another:
        _check_momentum(self, start, given)
    run = self.body.simulate(t, **given | options)
    run.__dict__["_began"] = began
    if self.uncertain_start != (None, None) or self.body._doubts() is not None:
        run.__dict__["uncertain_start"] = None  # the last state is uncertain, together with the body
    return run


def _check_momentum(self: Trajectory, start: Floats, given: dict[str, Any]) -> None:
    """Refuse a start under another load at which the total angular momentum would jump."""
    first = self.body.simulate(start, **given)
    nothing = np.zeros_like(first.omega[..., 0, :])
    was = nothing if self.carried is None else self.carried[0][..., -1, :]
    now = nothing if first.carried is None else first.carried[0][..., 0, :]
    body = lengths(first.angular_momentum("body").spin[..., 0, :] - now)
    off = now - was
    jumps = lengths(off) > _ROUNDING * (lengths(now) + lengths(was) + body)
    if np.any(jumps):
        into, of = (np.broadcast_to(one, off.shape)[jumps][0].tolist() for one in (now, was))
        raise ValueError(
            f"load: the total angular momentum would jump at t = {float(start[0])!r}: what the body "
            f"carries along, wheels, rotors and slugs, has {of} now and {into} under this load. Wheels of "
            "the same name keep their state: add to the load of the motion, load=motion.load + other, name "
            "wheels as before, and give new ones no rate; or begin another motion with simulate"
        )
