"""One body in: an inertia you can trust, and exactly how it will spin."""

from polhode import errors, euler_angles, loads, solids
from polhode._core import MassAccumulator, RigidBody, __version__, principal_axes
from polhode.results import AngularMomentum, KineticEnergy, PrincipalAxes, Trajectory

__all__ = [
    "AngularMomentum",
    "KineticEnergy",
    "MassAccumulator",
    "PrincipalAxes",
    "RigidBody",
    "Trajectory",
    "__version__",
    "errors",
    "euler_angles",
    "loads",
    "principal_axes",
    "solids",
]
