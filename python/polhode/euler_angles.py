"""Euler angles: all twelve sequences, intrinsic (``"ZXZ"``) and extrinsic (``"zxz"``).

The default ``"ZXZ"`` is the (φ, θ, ψ) of Goldstein and Landau: R_NB = Rz(φ) Rx(θ) Rz(ψ). The names
``"goldstein"``, ``"landau"`` (both ZXZ) and ``"aerospace"`` (ZYX: yaw, pitch, roll) are understood.
"""

from typing import TYPE_CHECKING

from polhode._core import angular_velocity_from_euler_rates as angular_velocity
from polhode._core import euler_angles_from_quaternion as from_quaternion
from polhode._core import euler_rates as rates
from polhode._core import quaternion_from_euler_angles as to_quaternion

__all__ = ["angular_velocity", "from_quaternion", "rates", "to_quaternion"]

if not TYPE_CHECKING:

    def __getattr__(name):
        """Refuse a name of others with the one here."""
        from polhode._hints import no_name

        raise no_name(__name__, name, __all__)
