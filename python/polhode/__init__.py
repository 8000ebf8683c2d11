"""One body in: an inertia you can trust, and exactly how it will spin."""

from polhode import errors, euler_angles, loads, solids
from polhode._core import RigidBody, __version__, principal_axes, principal_moments
from polhode.results import AngularMomentum, KineticEnergy, PrincipalAxes, PrincipalDerivative, Trajectory

__all__ = [
    "AngularMomentum",
    "KineticEnergy",
    "PrincipalAxes",
    "PrincipalDerivative",
    "RigidBody",
    "Trajectory",
    "__version__",
    "errors",
    "euler_angles",
    "loads",
    "principal_axes",
    "principal_moments",
    "solids",
]
