"""One body in: an inertia you can trust, and exactly how it will spin.

Start here. A body comes from a shape (:mod:`polhode.solids`, ``laminae``, ``rods``), from a file
(``RigidBody.from_file``), or from numbers (``RigidBody(mass, inertia)``):

>>> from polhode import solids
>>> brick = solids.box((3.0, 2.0, 1.0), mass=12.0)
>>> brick.principal_moments
array([ 5., 10., 13.])

Its methods compute energy, angular momentum and motion:

>>> brick.kinetic_energy((0.0, 0.0, 2.0)).total
26.0
>>> brick.free_motion((0.01, 1.0, 0.0)).mode
'long-axis'
>>> brick.simulate([0.0, 10.0], (0.01, 1.0, 0.0)).omega.shape
(2, 3)

Loads act on it while it is simulated (``help(polhode.loads)``), and every function has an example:
``help(polhode.RigidBody)``, ``help(polhode.RigidBody.simulate)``. On the command line, ``polhode --help``
lists the commands.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from polhode import animation as animation
    from polhode import (
        assembly,
        distributions,
        equimomental,
        errors,
        euler_angles,
        flybys,
        identify,
        kinematics,
        laminae,
        loads,
        orbits,
        parallel_axis,
        reductions,
        regions,
        rods,
        rolling,
        solids,
        tops,
        uncertainty,
        validity,
    )
    from polhode import images as images
    from polhode import io as io
    from polhode import molecules as molecules
    from polhode import plot as plot
    from polhode import robots as robots
    from polhode import samples as samples
    from polhode import symbolic as symbolic
    from polhode import units as units
    from polhode import view as view
    from polhode._core import (
        FreeMotion,
        Gyrostat,
        GyrostatMotion,
        HeavyTop,
        MassAccumulator,
        RigidBody,
        Stepper,
        Uncertain,
        VaryingBody,
        __version__,
        principal_axes,
        principal_moments,
    )
    from polhode.accumulator import LabelledMassAccumulator
    from polhode.ensembles.call import Ensemble, ensemble
    from polhode.motion.auditing import Audit, Finding, audit
    from polhode.motion.events import Event, Events
    from polhode.motion.free import Cones, ErrorBar, LightCurve, Periods, Poinsot, Sensitivity
    from polhode.motion.gyrostat import Bifurcations, Equilibria, Wheel, wheel
    from polhode.motion.rolling import RollingMotion
    from polhode.motion.trajectory import Trajectory
    from polhode.results import (
        AngularMomentum,
        ContinuousAxes,
        ErrorBound,
        FreePrecession,
        Invariants,
        KineticEnergy,
        Linear,
        MotionSensitivity,
        Particles,
        PrincipalAxes,
        PrincipalDerivative,
        PrincipalLinear,
        PrincipalSigma,
        Provenance,
        Sigma,
        State,
    )
else:

    def __getattr__(name):
        """Import a name when it is first used, so that the help of the command line needs no NumPy."""
        from importlib import import_module

        if name in _LATER:
            return import_module(f"polhode.{name}")
        if name not in __all__:
            raise import_module("polhode._hints").no_name(__name__, name, [*__all__, *_LATER])
        for home in _APART.get(name, _HOMES):
            value = getattr(import_module(home), name, None)
            if value is not None:
                break
        else:
            value = import_module(f"polhode.{name}")
        globals()[name] = value
        return value

    def __dir__():
        return __all__


_HOMES = (
    "polhode.motion.gyrostat",  # whose wheel is not that of loads
    "polhode._core",
    "polhode.results",
    "polhode.motion.trajectory",
    "polhode.motion.events",
    "polhode.motion.free",
)
"""Modules whose names are public here; the other names are modules."""

_APART = {
    **dict.fromkeys(("Ensemble", "ensemble"), ("polhode.ensembles.call",)),
    **dict.fromkeys(("Audit", "Finding", "audit"), ("polhode.motion.auditing",)),
    "LabelledMassAccumulator": ("polhode.accumulator",),
    "RollingMotion": ("polhode.motion.rolling",),
}
"""Names whose module is imported for them alone."""

_LATER = ("animation", "images", "io", "molecules", "plot", "robots", "samples", "symbolic", "units", "view")
"""Modules that a star import leaves out: some need libraries, and their names are those of many scripts."""

__all__ = [
    "AngularMomentum",
    "Audit",
    "Bifurcations",
    "Cones",
    "ContinuousAxes",
    "Ensemble",
    "Equilibria",
    "ErrorBar",
    "ErrorBound",
    "Event",
    "Events",
    "Finding",
    "FreeMotion",
    "FreePrecession",
    "Gyrostat",
    "GyrostatMotion",
    "HeavyTop",
    "Invariants",
    "KineticEnergy",
    "LabelledMassAccumulator",
    "LightCurve",
    "Linear",
    "MassAccumulator",
    "MotionSensitivity",
    "Particles",
    "Periods",
    "Poinsot",
    "PrincipalAxes",
    "PrincipalDerivative",
    "PrincipalLinear",
    "PrincipalSigma",
    "Provenance",
    "RigidBody",
    "RollingMotion",
    "Sensitivity",
    "Sigma",
    "State",
    "Stepper",
    "Trajectory",
    "Uncertain",
    "VaryingBody",
    "Wheel",
    "__version__",
    "assembly",
    "audit",
    "distributions",
    "ensemble",
    "equimomental",
    "errors",
    "euler_angles",
    "flybys",
    "identify",
    "interop",
    "kinematics",
    "laminae",
    "loads",
    "orbits",
    "parallel_axis",
    "principal_axes",
    "principal_moments",
    "reductions",
    "regions",
    "rods",
    "rolling",
    "solids",
    "tops",
    "uncertainty",
    "validity",
    "wheel",
]
