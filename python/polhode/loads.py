"""What acts on a body while it is simulated.

Loads add and scale: ``a + b``, ``a - b``, ``2 * a``, ``sum(loads)``. Torques are about the reference point
of the motion: the centre of mass of a free body, or the origin that is fixed in space.

What the body carries along, a :func:`rotor`, a :func:`wheel` or a :func:`slug`, is a load too, since it acts
on the body; momentum and energy of the trajectory include it. Its states are in `states` of the trajectory.
"""

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
    rotor,
    sampled,
    schedule,
    slug,
    torque_callback,
    uniform_gravity,
    wheel,
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
    "rotor",
    "sampled",
    "schedule",
    "slug",
    "torque_callback",
    "uniform_gravity",
    "wheel",
    "with_states",
]
