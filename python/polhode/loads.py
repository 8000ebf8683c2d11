"""Loads: the forces and torques on a body while it is simulated.

Loads can be added and multiplied by a factor: ``a + b``, ``a - b``, ``2 * a``, ``sum(loads)``. Torques are
about the reference point of the motion: the centre of mass of a free body, or the origin of the body frame if
that point is fixed in space.

A :func:`rotor`, a :func:`wheel` and a :func:`slug` are carried by the body. They are loads too, since they
act on the body. The angular momentum of the trajectory includes theirs. Its energy includes that of wheels
and slugs, but not that of a rotor, whose speed is not known. :attr:`Trajectory.states <polhode.Trajectory>`
has their states. A wheel that turns freely or at a constant rate, from :func:`polhode.wheel`, is a load as it
is.
"""

from typing import TYPE_CHECKING

from polhode._core import (
    Load,
    callback,
    compiled,
    constant_force,
    constant_torque,
    damping,
    feedback,
    gravity_gradient,
    magnetic,
    panels,
    rotor,
    sampled,
    schedule,
    slug,
    thrusters,
    torque_callback,
    uniform_gravity,
    wheel,
    wheels,
    with_states,
)

__all__ = [
    "Load",
    "callback",
    "compiled",
    "constant_force",
    "constant_torque",
    "damping",
    "feedback",
    "gravity_gradient",
    "magnetic",
    "panels",
    "rotor",
    "sampled",
    "schedule",
    "slug",
    "thrusters",
    "torque_callback",
    "uniform_gravity",
    "wheel",
    "wheels",
    "with_states",
]

if not TYPE_CHECKING:
    from polhode._hints import explain_calls, no_name

    explain_calls(globals(), __all__)

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        raise no_name(__name__, name, __all__)
