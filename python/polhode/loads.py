"""What acts on a body while it is simulated.

Loads add and scale: ``a + b``, ``a - b``, ``2 * a``, ``sum(loads)``. Torques are about the reference point
of the motion: the centre of mass of a free body, or the origin that is fixed in space.
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
    sampled,
    schedule,
    torque_callback,
    uniform_gravity,
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
    "sampled",
    "schedule",
    "torque_callback",
    "uniform_gravity",
]
