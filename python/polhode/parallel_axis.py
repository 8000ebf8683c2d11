"""The parallel-axis theorem (Steiner, Huygens) for bare tensors: ``I_P = I_C + m (d² 1 − d dᵀ)``.

Bodies know their centre of mass and ask for the point alone: `RigidBody.inertia_about`.
"""

from polhode._core import inertia_from_center_of_mass as from_center_of_mass
from polhode._core import inertia_to_center_of_mass as to_center_of_mass

__all__ = ["from_center_of_mass", "to_center_of_mass"]
