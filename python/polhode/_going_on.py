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
        By the linearised equations, or by differences of order six of motions that are simulated anew, for
        loads without series, such as functions, a motor with a limit and dry friction: nine digits or so.

    Returns
    -------
    MotionSensitivity
        Derivatives of attitude and angular velocity at every time, and of the states that the load has of its
        own: by all of these at the first, by moments, products, centre of mass and mass, and by every
        argument of the load.

    Raises
    ------
    PolhodeError
        Of series, for a load that has none: callbacks and compiled functions, a magnetic field along an
        orbit, B-dot, a motor with a limit, dry friction, a feedback on a target that moves. Of differences,
        where those of order four and six differ.
    IntegrationError
        Where motion or derivatives cannot go on.

    Notes
    -----
    The linearised equations are integrated beside the motion, by Taylor series in which every number
    carries its derivatives, to the last digits whatever method and tolerance found this motion. Where a
    feedback turns its torque round, half a turn from its target, they jump as they must. For free bodies
    :meth:`FreeMotion.sensitivity` is exact at any time.

    The states of a load that were not given to `simulate` follow from its numbers: a wheel begins with
    ``h = J (Ω + a·ω)``. The derivatives by its inertia, its axis and its rate include that; those by ω at the
    first time hold the states, and `begins` has what they add where the rate is held in place of them.

    Differences follow the motion through every change of the law, since each neighbour finds its own: a wheel
    that stops in its bearing, a motor that saturates. Of orbits all numbers are varied: J₂, radius and
    pole of an oblate attractor too, and each position of a table, with six runs for a number. The numbers of
    functions are not known to them, and a target at rest is not varied; those of stacks of loads, of
    scaled ones and beside compiled functions are not either.

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
        Further arguments of :meth:`polhode.RigidBody.simulate`, such as `method` and `rtol`; with another
        `load` its own states begin anew.

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
