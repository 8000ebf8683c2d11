"""The run that goes on from the end of a motion, and the derivatives of a motion by its start."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from polhode import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from polhode.results import MotionSensitivity
    from polhode.trajectory import Trajectory

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
    """Go on from the last state under the same load.

    Parameters
    ----------
    t : array_like, shape (T,)
        Times as in `simulate`; the first must be the last of this motion.
    **options
        Further arguments of :meth:`polhode.RigidBody.simulate`, such as `method` and `rtol`; if another
        `load` is given, its states begin anew.

    Returns
    -------
    Trajectory

    Examples
    --------
    >>> from polhode import RigidBody
    >>> body = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
    >>> first = body.simulate([0, 1], omega=(0, 0, 1))
    >>> first.resume([1, 2]).quaternion[-1].round(6)
    array([0.      , 0.      , 0.841471, 0.540302])
    """
    start = _core.real_numbers(t, "t").reshape(-1)[:1]
    state, last = self.state(), self.t.reshape(-1)[-1:]
    if not np.array_equal(start, last):
        raise ValueError(f"t: the motion goes on from t = {float(last[0])!r}, got {start.tolist()}")
    if np.isnan(state.omega).any():
        raise ValueError("resume: the last state is not known, since the run did not come to the last time")
    given = state._asdict()
    if "load" in options:
        del given["states"]  # another load has others
    else:
        load = self._acting("resume", -1)
        if load is not None:
            options["load"] = load.anchored(float(self.t.flat[0]))
    options.setdefault("about", self._about_word())
    if self.pivoted:
        del given["velocity"]
    run = self.body.simulate(t, **given | options)
    if self.uncertain_start != (None, None) or self.body._doubts() is not None:
        run.__dict__["uncertain_start"] = None  # the last state is uncertain, together with the body
    return run
