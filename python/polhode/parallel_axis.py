"""The parallel-axis theorem (Steiner, Huygens) for bare tensors: ``I_P = I_C + m (d² 1 − d dᵀ)``.

For a body, which has its centre of mass, `polhode.RigidBody.inertia_about` needs only the point.
"""

from typing import TYPE_CHECKING

from polhode._core import inertia_from_center_of_mass as from_center_of_mass
from polhode._core import inertia_to_center_of_mass as to_center_of_mass

__all__ = ["from_center_of_mass", "to_center_of_mass"]

if not TYPE_CHECKING:
    from polhode._hints import explain_module_call

    explain_module_call(
        __name__, "parallel_axis.from_center_of_mass(inertia, mass, displacement) is the tensor about a point"
    )
