"""What acts on a body while it is simulated. Loads add: ``a + b`` acts as both."""

from polhode._core import Load, constant_torque, torque_callback

__all__ = ["Load", "constant_torque", "torque_callback"]
