"""One body in: an inertia you can trust, and exactly how it will spin."""

from polhode import (
    equimomental,
    errors,
    euler_angles,
    kinematics,
    loads,
    parallel_axis,
    solids,
    tops,
)
from polhode._core import MassAccumulator, RigidBody, __version__, principal_axes, principal_moments
from polhode.results import (
    AngularMomentum,
    FreePrecession,
    KineticEnergy,
    Particles,
    PrincipalAxes,
    PrincipalDerivative,
    Trajectory,
)

__all__ = [
    "AngularMomentum",
    "FreePrecession",
    "KineticEnergy",
    "MassAccumulator",
    "Particles",
    "PrincipalAxes",
    "PrincipalDerivative",
    "RigidBody",
    "Trajectory",
    "__version__",
    "equimomental",
    "errors",
    "euler_angles",
    "kinematics",
    "loads",
    "parallel_axis",
    "principal_axes",
    "principal_moments",
    "solids",
    "tops",
]
