"""The parallel-axis theorem (Steiner, Huygens) for bare tensors: ``I_P = I_C + m (d² 1 − d dᵀ)``.

For a body, which has its centre of mass, `polhode.RigidBody.inertia_about` needs only the point.
"""

from polhode._core import inertia_from_center_of_mass as from_center_of_mass
from polhode._core import inertia_to_center_of_mass as to_center_of_mass

__all__ = ["from_center_of_mass", "to_center_of_mass"]
