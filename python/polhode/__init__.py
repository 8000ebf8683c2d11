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
from polhode._core import RigidBody, __version__, principal_axes
from polhode.results import (
    AngularMomentum,
    FreePrecession,
    KineticEnergy,
    Particles,
    PrincipalAxes,
    Trajectory,
)

__all__ = [
    "AngularMomentum",
    "FreePrecession",
    "KineticEnergy",
    "Particles",
    "PrincipalAxes",
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
    "solids",
    "tops",
]
