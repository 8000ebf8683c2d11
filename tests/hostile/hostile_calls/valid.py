"""One valid call of every public callable, from the stubs.

Whoever adds one has to say here what it takes, unless its docstring does: numbers, vectors, matrices.
"""

from __future__ import annotations

import ast
import inspect
import operator
import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import documented
import numpy as np
import polhode
from polhode import (
    RigidBody,
    _core,
    equimomental,
    interop,
    kinematics,
    loads,
    molecules,
    orbits,
    rolling,
    solids,
    validity,
)

NO_TEST = {
    # Files and pictures have tests of their own; a compiled load is a machine address, to be trusted or not.
    *(f"RigidBody.{name}" for name in ("from_file", "load", "save", "plot", "view")),
    *(
        f"Trajectory.{name}"
        for name in ("from_file", "save", "plot", "view", "animate", "show", "to_pandas", "to_xarray")
    ),
    *(
        f"{name}.{what}"
        for name in ("FreeMotion", "GyrostatMotion", "HeavyTop")
        for what in ("animate", "plot")
    ),
    *("read_stl", "read_plates", "stream_solid", "compiled", "labelled_voxels"),
    "machine",  # takes nothing
    "Stepper.step",  # goes on from where the call before has left it; tests/motion/test_stepper.py
    # Objects of other libraries, which have to be there.
    *("RigidBody.from_mesh_object", "RigidBody.from_atoms"),
}
OPERATORS: dict[str, Callable[..., Any]] = {
    "__getitem__": operator.getitem, "__add__": operator.add, "__sub__": operator.sub,
    "__mul__": operator.mul, "__neg__": operator.neg,
    "__len__": len, "__hash__": hash,
}  # fmt: skip
"""Special methods that are public, as they are called."""

TUMBLER = RigidBody.from_principal(2.0, (1.0, 2.0, 2.5), center_of_mass=(0.25, 0.0, 0.5))
TOP = RigidBody.from_principal(2.0, (1.0, 1.0, 0.5), center_of_mass=(0.0, 0.0, 0.5))
STACK = RigidBody.from_principal((1.0, 2.0), [(1.0, 2.0, 2.5), (2.0, 2.0, 1.0)])
OMEGA = [0.25, 1.5, 0.5]
QUATERNION = [0.5, 0.5, 0.5, 0.5]
TURNS = [QUATERNION, [0.5, 0.5, -0.5, 0.5], [0.0, 0.0, 0.0, 1.0]]
RATES = [OMEGA, [0.5, 1.0, 0.25], [0.0, 1.0, 0.0]]
TETRAHEDRON = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
MESHED = RigidBody.from_mesh(TETRAHEDRON, FACES, density=2.0)
TENSOR = [[2.0, 0.25, 0.0], [0.25, 3.0, -0.5], [0.0, -0.5, 4.0]]


def brake(t: float, omega: Any, *_: Any) -> Any:  # noqa: ARG001
    return -0.125 * omega


def push(t: float, omega: Any, *_: Any) -> Any:  # noqa: ARG001
    return np.zeros(3), -0.125 * omega


def gas(points: Any) -> Any:
    x = points[..., 0] if points.ndim == 2 else points
    with np.errstate(over="ignore"):
        return 1.0 + 0.25 * x**2


def passage(t: float, omega: Any, *_: Any) -> float:  # noqa: ARG001
    return float(omega[0])


WATER = [[0.0, 0.0, 0.0], [0.75, 0.0, 0.5], [-0.75, 0.0, 0.5]]

VALUES: dict[str, Any] = {
    "mass": 2.0, "density": 1.5, "inertia": TENSOR, "inertia_about_origin": TENSOR,
    "center_of_mass": [0.25, 0.0, 0.5], "rtol": 1e-6, "atol": 1e-9, "moments": [1.0, 2.0, 2.5],
    "axes": QUATERNION, "products": [0.125, 0.0, -0.25], "nodes": TETRAHEDRON, "cells": [[0, 1, 2, 3]],
    "at": "cells", "bounds": [[0.0, 0.0, 0.0], [1.0, 2.0, 0.5]], "radii": [0.0, 0.5, 1.0],
    "max_evaluations": 20_000, "masses": [1.0, 2.0, 0.5, 1.0], "positions": TETRAHEDRON,
    "labels": [0, 1, -1, 1], "return_labels": False, "spacing": [0.5, 0.25, 1.0], "origin": [0.0, 1.0, 0.0],
    "vertices": TETRAHEDRON, "faces": FACES, "closure": None, "orient": False, "check": True,
    "areal_density": 0.5, "thickness": 0.0625, "points": TETRAHEDRON, "linear_density": 0.5,
    "bodies": [TUMBLER, TOP], "point": [1.0, 0.0, 0.5], "axis": [0.0, 1.0, 0.5],
    "displacement": [1.0, 0.0, 0.5], "rotation": QUATERNION, "length": 2.0, "other": TUMBLER,
    "omega": OMEGA, "velocity": [1.0, 0.0, 0.25], "about": "center_of_mass", "position": [2.0, 0.0, 0.5],
    "torque": [0.5, 0.0, 0.25], "angular_acceleration": [0.5, 0.0, 0.25],
    "acceleration": [0.5, 0.0, 0.0], "attitude": QUATERNION, "gravity": [0.0, 0.0, -8.0],
    "force": [0.5, 0.0, 0.0], "rate": 1.5, "rotation_period": 4.0, "precession_period": 2.5,
    "mode": "long-axis", "sense": 1.0, "phase": 0.25, "angular_momentum_direction": [0.0, 0.5, 1.0],
    "t": [0.0, 0.25, 0.5], "load": None, "given": [], "method": "auto", "events": None, "on_failure": "raise",
    "progress": None, "n": 9, "start": None, "inclination": 0.5, "canonical": False, "degrees": False,
    "tangent": TENSOR, "vector": [0.5, 0.0, 0.25], "frame": "body", "mu": 4.0, "epoch": None,
    "matrix": [[0.5, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.5]], "quadratic": None,
    "windows": [[0.0, 0.25], [0.5, 1.0]], "K": 1.0, "D": 0.5, "target": QUATERNION, "function": brake,
    "size": [1.0, 2.0, 0.5], "side": 1.5, "radius": 1.5, "semi_axes": [1.0, 2.0, 0.5], "height": 2.0,
    "inner_radius": 0.5, "outer_radius": 1.5, "bottom_radius": 1.5, "top_radius": 0.5,
    "major_radius": 2.0, "minor_radius": 0.5, "sides": 5, "angle": 1.5, "low": [-2.0, -2.0, -2.0],
    "high": [2.0, 2.0, 3.0], "center": [0.5, 0.0, 0.0], "body": TUMBLER, "order": "angular-linear",
    "parameters": [2.0, 0.5, 0.0, 1.0, 5.0, 0.0, 5.0, -0.25, 0.0, 4.0], "angles": [0.5, 1.0, 1.5],
    "sequence": "ZXZ", "quaternion": QUATERNION, "singular": "raise", "rates": [0.5, 1.0, -0.25],
    "rate_in_frame": [0.5, 0.0, 0.25], "frame_omega": [0.0, 0.0, 1.0], "a": 0.5, "b": 0.25, "spin": 8.0,
    "inverse": False, "name": "omega", "values": OMEGA, "direction": 0.0, "terminal": False, "index": -1,
    "constants": [3.0, 2.0, 1.0],
    "unwrap": False, "options": {}, "unit": "MHz", "factor": 2.0, "key": 0, "user_data": None,
    "labels_of_atoms": ["C", "O"], "states": None, "momentum": [0.0, 0.5, 2.0], "speed": None,
    "times": None, "friction": 0.25, "dry_friction": 0.125,
    "initial": [0.5, 0.0], "wrench": None, "update": None, "period": None,
    "scale": None, "wheels": None, "dipole": [0.5, 0.25, 0.0], "field": [0.0, 0.5, 0.25], "gain": 0.125,
    "elapsed": 0.5, "max_torque": 0.75, "max_momentum": 0.5, "max_rate": 2.5, "allocation": None,
    "from_event": False, "strength": [0.0, 0.5, 0.25],
    "law": "normal", "seed": 7, "stream": 9, "first": 3, "count": 5, "width": 4,
    "value": [1.0, 2.0], "sigma": [0.125, 0.25], "covariance": None, "source": None,
    "contact": None, "normal": [0.25, 0.0, 1.0], "apex": 0.5, "turntable": 0.25, "lift": "hold",
    "surface": rolling.sphere(0.5), "turn": None, "phases": 0.0,
}  # fmt: skip
"""What a parameter of this name takes; numbers that float32 has too."""

KNOWN = {
    "sigma": None, "bias": False, "momentum": [0.0, 0.0, 0.5], "torque": [0.0, 0.0, 0.0], "prior": None,
    "student": False, "starts": 1,
    "attitude": None, "specific_force": None, "scale": False,
}  # fmt: skip
"""What is known beside the log of a tumble."""

OVERRIDES: dict[str, dict[str, Any]] = {
    "fit_tumble": {
        "t": [0.25 * k for k in range(12)],
        "omega": [RATES[k % 3] for k in range(12)],
        "known": KNOWN,
    },
    "tumble_information": {
        "inertia": [1.0, 2.0, 2.5, 0.0, 0.25, 0.0],
        "place": [0.25, 0.0, -0.5],
        "known": KNOWN,
    },
    "RigidBody": {"inertia": TENSOR},
    "RigidBody.__sub__": {"self": [TUMBLER], "other": RigidBody.from_principal(0.5, (0.125, 0.25, 0.25))},
    "RigidBody.from_density": {"density": gas, "rtol": 1e-3, "max_evaluations": 30_000},
    "RigidBody.from_radial_density": {"density": gas, "rtol": 1e-4},
    "RigidBody.from_balls": {
        "centers": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        "radii": [1.0, 0.5],
        "mass": None,
        "density": 2.0,
    },
    "RigidBody.from_voxels": {"density": [[[1.0, 0.5], [2.0, 1.0]]], "spacing": 0.5, "affine": None},
    "RigidBody.from_labelled_voxels": {
        "labels": [[[1, 2], [0, 1]]],
        "density": 2.0,
        "spacing": 0.5,
        "origin": None,
        "affine": None,
        "length_unit": None,
    },
    "RigidBody.cut": {"self": [MESHED], "normal": [0.0, 0.0, 1.0], "point": [0.0, 0.0, 0.1]},
    "RigidBody.from_principal": {"axes": QUATERNION},
    "RigidBody.combined": {"axis": None},
    "RigidBody.heavy_top": {"self": [TOP]},
    "RigidBody.stack": {"bodies": [TUMBLER, TOP]},
    "RigidBody.varying": {
        "t": [0.0, 2.0],
        "bodies": RigidBody.stack([TUMBLER, TUMBLER]),
        "outlet": (0.0, 0.0, 0.5),
    },
    "RigidBody.__getitem__": {"self": [STACK], "key": 1},
    "RigidBody.__len__": {"self": [STACK]},
    "RigidBody.simulate": {"rtol": 1e-8, "max_steps": 100_000},
    "VaryingBody.simulate": {
        "t": [0.0, 2.0],
        "rtol": 1e-8,
        "max_steps": 100_000,
        "load": loads.constant_torque((0.5, 0.0, 0.25)),
    },
    "RigidBody.stepper": {"self": [TUMBLER, TOP], "start": 0.5, "rtol": 1e-8, "max_steps": 100_000},
    "RigidBody.pivot_reaction": {"about": "origin"},
    "RigidBody.free_motion_from_periods": {
        "self": [TUMBLER],
        "rotation_period": 4.0,
        "precession_period": 2.0,
    },
    "RigidBody.with_sigma": {
        "mass": 0.125,
        "center_of_mass": [0.25, 0.125, 0.5],
        "inertia": np.full((3, 3), 0.125).tolist(),
    },
    "RigidBody.with_covariance": {"self": [TUMBLER, TOP], "covariance": (np.eye(10) / 64).tolist()},
    "RigidBody._from_numbers": {},
    "Load.__getitem__": {"self": [loads.constant_torque([[0.5, 0.0, 0.25], [1.0, 0.0, 0.0]])]},
    "Load.__add__": {"other": loads.uniform_gravity((0.0, 0.0, -8.0))},
    "Load.__sub__": {"other": loads.uniform_gravity((0.0, 0.0, -8.0))},
    "Load.potential": {"self": [loads.uniform_gravity((0.0, 0.0, -8.0))]},
    "Load.with_epoch": {"t": 0.5},
    "Load.torque": {"t": 0.5},
    "Load.force": {"t": 0.5},
    "MassAccumulator.merge": {"other": polhode.MassAccumulator()},
    "canonical_axes": {"axes": np.eye(3).tolist()},
    "principal_derivative": {"axes": np.eye(3).tolist()},
    "covariance_factor": {"covariance": [[1.0, 0.5], [0.5, 2.0]]},
    "rectangle": {"size": [1.0, 2.0]},
    "ellipse": {"semi_axes": [1.0, 2.0]},
    "triangle": {"vertices": [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]},
    "polygon": {"vertices": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]},
    "sampled": {"t": [-1.0, 0.5, 2.0], "torque": [[0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]]},
    "wheel": {"axis": [0.0, 0.5, 1.0], "inertia": 0.25, "torque": 0.5, "name": "mine"},
    "wheels": {
        "axes": [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]],
        "inertias": 0.125,
        "torque": loads.feedback(1.0, 0.5),
        "allocation": "pseudo-inverse",
        "name": "mine",
    },
    "magnetic": {"dipole_times": None, "max_dipole": 0.25},
    "thrusters": {
        "positions": [[1.0, 0.0, 0.5], [-1.0, 0.0, 0.25]],
        "directions": [[0.0, 1.0, 0.0], [0.0, 0.5, 1.0]],
        "forces": [0.5, 0.25],
        "command": [0.5, 1.0],
        "period": 0.25,
        "min_on": 0.0625,
        "max_on": 0.125,
        "deadband": None,
        "name": "mine",
    },
    "panels": {
        "surface": ([[1.0, 0.0, 0.5], [0.0, 0.5, 0.0]], [0.5, 1.0], [[0.0, 0.25, 1.0], [1.0, 0.0, 0.0]]),
        "law": "solar",
        "coefficients": [0.25, 0.5],
        "direction": [0.5, 0.0, 1.0],
        "pressure": 0.25,
        "density": None,
        "velocity": None,
    },
    "slug": {"inertia": 0.25, "damping": 0.5, "name": "mine"},
    "nutation_damping": {"body": TOP, "momentum": 2.0, "inertia": 0.25, "damping": 0.5},
    "with_states": {"rates": None, "name": "mine"},
    "Load.carried": {"t": 0.5},
    "Gyrostat.equilibria": {"momentum": 2.0},
    "GyrostatMotion.equilibria": {"self": [TUMBLER.gyrostat((0.0, 0.5, 2.0)).free_motion(OMEGA)]},
    "kinematics.angular_velocity": {"attitude": TURNS, "order": None, "sequence": None, "sigma": 0.125},
    "kinematics.angular_acceleration": {"omega": RATES, "order": None, "sigma": 0.125},
    "kinematics.quaternion": {"omega": RATES, "order": 4},
    "rates": {"rows": TURNS, "order": None, "sigma": None},
    "white_noise": {"rows": TURNS},
    "attitudes": {"omega": RATES, "order": 4},
    "impulses": {"quaternion": TURNS, "torques": [RATES]},
    "audit": {"trajectory": TUMBLER.free_motion(OMEGA).at(np.arange(20.0)), "finer": None, "ratio": None},
    "Trajectory.from_samples": {
        "attitude": TURNS,
        **dict.fromkeys(("omega", "position", "velocity"), RATES),
        "sequence": None,
    },
    "Trajectory.sensitivity": {"method": "series"},
    "rolling_steady": {"body": TOP, "surface": rolling.sphere(0.5), "spin": None, "turn": 2.0},
    "rolling_critical_rate": {
        "body": RigidBody.from_principal(2.0, (1.0, 1.0, 1.5)),
        "surface": rolling.disk(0.5),
        "motion": "rolling",
    },
    "rolling_modes": {"body": TOP},
    "rolling_plane": {"law": "sliding", "friction": None, "viscous": 0.25, "resistance": None},
    "RigidBody.rolling_motion": {
        "self": [solids.sphere(0.5, mass=2.0)],
        "omega": [0.5, 1.0, -0.25],
    },
    "rolling_states": {"body": solids.sphere(0.5, mass=2.0)},
    "RollingMotion": {"body": solids.sphere(0.5, mass=2.0)},
    "rolling_tippe_top": {"body": TOP, "surface": rolling.sphere(1.5)},
    "surface_ellipsoid": {"axes": np.eye(3).tolist()},
    "surface_paraboloid": {"radii": [1.0, 0.5], "axes": np.eye(3).tolist()},
    **{
        name: {"contact": rolling.plane(rolling.sphere(0.5)), "load": loads.uniform_gravity((0.0, 0.0, -8.0))}
        for name in ("contact_history", "contact_invariants")
    },
    "schedule": {"load": loads.constant_torque((0.5, 0.0, 0.25))},
    "callback": {"function": push},
    "from_pseudo_inertia": {"pseudo_inertia": _core.to_pseudo_inertia(TUMBLER).tolist()},
    "from_spatial_inertia": {"spatial_inertia": _core.to_spatial_inertia(TUMBLER).tolist()},
    "from_parameters": {"parameters": _core.to_parameters(TUMBLER).tolist()},
    "from_log_cholesky": {"parameters": [0.0, 0.5, 0.25, 0.0, 0.5, 0.0, 0.125, 0.0, 0.25, 0.0]},
    "quaternion_from_matrix": {"matrix": [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]},
    "to_log_cholesky": {"body": solids.box((1.0, 2.0, 0.5), mass=2.0)},
    "free_precession": {"body": TOP},
    "least_spin": {"body": TOP},
    "steady_precession": {"body": TOP, "spin": 32.0},
    "stick": {"inertia": 0.25, "mass": 2.0},
    "RigidBody.from_surface": {"areal_density": None, "density": None, "thickness": None},
    "Trajectory.euler_angles": {"sequence": "ZYX"},
    "Trajectory.euler_rates": {"sequence": "ZYX"},
    "Trajectory.pivot_reaction": {"self": [TOP.simulate([0.0, 0.5], OMEGA, about="origin")]},
    "gravity_gradient": {"velocity": [0.0, 1.0, 0.25]},
    "kepler_period": {"velocity": [0.0, 1.0, 0.25]},
    "kepler_states": {"velocity": [0.0, 1.0, 0.25]},
    "feedback": {"rate": [0.25, 0.0, 0.5]},
    "oblate_states": {
        "velocity": [0.0, 1.0, 0.25],
        "j2": 0.01,
        "radius": 0.5,
        "pole": [0.0, 0.0, 1.0],
        "elapsed": [0.5, 1.0],
    },
    "local_frames": {"orbit": orbits.kepler(1.0, (1.0, 0.0, 0.0), (0.0, 1.0, 0.25))},
    "sampled_states": {
        "times": [0.0, 1.0, 2.0],
        "position": [[1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.0, 1.0, 0.5]],
        "t": [0.5, 1.5],
        "velocity": [[-0.5, 1.0, 0.0], [-0.5, 0.5, 0.25], [-0.5, 0.0, 0.5]],
    },
    "RigidBody.from_tetrahedra": {"density": 1.5, "at": None},
    "PrincipalAxes.classify": {"rtol": 1e-6},
    "PrincipalAxes.continuous": {"self": [STACK.principal], "axis": 0, "rtol": 1e-6},
    "RigidBody.inertia_about": {"about": [1.0, 0.0, 0.5]},
    "RigidBody.moment_about": {"about": [1.0, 0.0, 0.5]},
    "RigidBody.principal_about": {"about": [1.0, 0.0, 0.5]},
    "RigidBody.sigma_about": {"about": [1.0, 0.0, 0.5]},
    "equimomental.ellipsoid": {"volume": 0.5},
    "forms.to_text": {"program": "urdf"},
    "forms.from_printout": {
        "center_of_mass": [0.25, 0.0, 0.5],
        "inertia": [2.0, 3.0, 4.0, 0.25, 0.0, -0.5],
        "products": "positive",
        "name": "inertia",
    },
    "Trajectory.point": {"point": [1.0, 0.0, 0.5]},
    "Trajectory.relative_to": {"orbit": orbits.kepler(1.0, (1.0, 0.0, 0.0), (0.0, 1.0, 0.25))},
    "Trajectory.resume": {"t": [0.5, 0.75, 1.0]},
    "Trajectory.invariants": {},
    "molecules.isotopes": {"labels": ["C", "D", "O"], "masses": "most_common"},
    "molecules.ray_kappa": {"constants": [3.0, 2.0, 1.0]},
    "molecules.rotational_constants_sigma": {"sigma": [0.125, 0.25, 0.125]},
    "molecules.uncertain_masses": {"labels": ["C", "D", "O"], "masses": "most_common"},
    "molecules.bonds": {"labels": ["O", "H", "H"], "positions": WATER},
    "molecules.cell_crossings": {
        "labels": ["O", "H", "H"],
        "positions": WATER,
        "cell": [[4.0, 0.0, 0.0], [0.0, 5.0, 0.0]],
    },
    "molecules.uncertain_positions": {
        "labels": ["O", "H", "H"],
        "positions": WATER,
        "sigma": 0.125,
        "bonds": [[0, 1], [0, 2]],
    },
}
"""What some of them take instead, and on what: `self` lists the receivers."""

ONE_OF = (("mass", "density", "areal_density", "linear_density"), ("inertia", "inertia_about_origin"))
"""Parameters of which exactly one is given, but for those without which there is no body at all."""


@dataclass(frozen=True)
class Call:
    """A public callable and arguments that it takes."""

    name: str
    function: Callable[..., Any]
    arguments: dict[str, Any]
    optional: frozenset[str]
    receivers: tuple[Any, ...] = ()
    positional: frozenset[str] = field(default=frozenset())


def load_of_all() -> Any:
    return (
        loads.uniform_gravity((0.0, 0.0, -8.0))
        + loads.damping(np.eye(3) * 0.5)
        + loads.constant_torque((0.5, 0.0, 0.25), frame="space")
    )


def receivers() -> dict[str, tuple[Any, ...]]:
    accumulator = polhode.MassAccumulator()
    accumulator.add([1.0, 2.0, 0.5], TETRAHEDRON[1:])
    motion = TUMBLER.simulate([0.0, 0.25, 0.5], OMEGA, load=loads.uniform_gravity((0.0, 0.0, -8.0)))
    return {
        "RigidBody": (TUMBLER, TOP, STACK),
        "FreeMotion": (TUMBLER.free_motion(OMEGA), STACK.free_motion(OMEGA), TOP.free_motion(OMEGA)),
        "Gyrostat": (TUMBLER.gyrostat((0.0, 0.5, 2.0)),),
        "GyrostatMotion": (
            TUMBLER.gyrostat((0.0, 0.5, 2.0)).free_motion(OMEGA),
            STACK.gyrostat((0.0, 0.5, 2.0)).free_motion(OMEGA),
        ),
        "HeavyTop": (TOP.heavy_top(OMEGA, QUATERNION, (0.0, 0.0, -8.0)),),
        "Load": (loads.constant_torque((0.5, 0.0, 0.25)), load_of_all()),
        "MassAccumulator": (accumulator,),
        "PrincipalAxes": (TUMBLER.principal, STACK.principal),
        "RollingMotion": (
            solids.sphere(0.5, mass=2.0).rolling_motion(rolling.sphere(0.5), OMEGA, gravity=(1.0, 0.0, -8.0)),
        ),
        "RuledSurface": (rolling.cylinder(0.5, 2.0), rolling.cone(0.5, 2.0)),
        "Stepper": (TUMBLER.stepper(OMEGA),),
        "Surface": (rolling.sphere(0.5), rolling.paraboloid((1.0, 0.5), 0.5)),
        "VaryingBody": (RigidBody.varying([0.0, 2.0], RigidBody.stack([TUMBLER, TUMBLER])),),
        "Trajectory": (motion, TUMBLER.free_motion(OMEGA).at([0.0, 0.5])),
        "Wheel": (polhode.wheel(axis=[0.0, 0.5, 1.0], inertia=[0.25, 0.125], rate=2.0),),
    }


def _choice(parameters: set[str], name: str) -> set[str]:
    """Those that are left out, of parameters of which one is given."""
    out = set()
    for group in ONE_OF:
        given = [p for p in group if p in parameters]
        if name == "RigidBody" and group[0] == "mass":
            continue
        is_amount = group[0] == "mass" and not {"masses", "cells"} & parameters and len(given) > 1
        if is_amount or (group[0] == "inertia" and len(given) > 1):
            out |= set(given[1:])
    return out


def _of_signature(name: str, function: Any, arguments: ast.arguments, holder: str | None) -> Call:
    specific = OVERRIDES.get(name, {})
    is_method = bool(arguments.args or arguments.posonlyargs) and holder is not None
    plain = [*arguments.posonlyargs, *arguments.args]
    is_bound = is_method and plain[0].arg == "self"
    if is_bound:
        plain = plain[1:]
    names = {a.arg for a in [*plain, *arguments.kwonlyargs]}
    left_out = _choice(names, name) - set(specific)
    values = {}
    for parameter in sorted(names - left_out):
        if parameter in specific:
            values[parameter] = specific[parameter]
        else:
            known = VALUES if parameter in VALUES else documented.arrays(function)
            assert parameter in known, f"{name}: hostile_calls/valid.py has no value for {parameter}="
            values[parameter] = known[parameter]
    defaults = len(arguments.defaults)
    optional = {a.arg for a in plain[len(plain) - defaults :]} if defaults else set()
    optional |= {
        a.arg for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True) if d is not None
    }
    on = tuple(specific.get("self", receivers()[holder])) if is_bound and holder else ()
    posonly = frozenset(a.arg for a in arguments.posonlyargs)
    return Call(name, function, values, frozenset(optional | left_out), on, posonly)


def _from_stub() -> list[Call]:
    tree = ast.parse((Path(polhode.__path__[0]) / "_core.pyi").read_text(encoding="utf-8"))
    calls = []
    for node in tree.body:
        if isinstance(node, ast.FunctionDef) and node.name not in NO_TEST:
            calls.append(_of_signature(node.name, getattr(_core, node.name), node.args, None))
        elif isinstance(node, ast.ClassDef):
            for method in node.body:
                if not isinstance(method, ast.FunctionDef):
                    continue
                if any(isinstance(d, ast.Name) and d.id == "property" for d in method.decorator_list):
                    continue
                name = f"{node.name}.{method.name}"
                hidden = method.name.startswith("_") and method.name not in ("__new__", *OPERATORS)
                if hidden or name in NO_TEST:
                    continue
                holder = getattr(_core, node.name)
                if method.name == "__new__":
                    del method.args.args[0]
                    calls.append(_of_signature(node.name, holder, method.args, None))
                else:
                    function = OPERATORS.get(method.name) or getattr(holder, method.name)
                    calls.append(_of_signature(name, function, method.args, node.name))
    return calls


def _from_python() -> list[Call]:
    """The callables that are written in Python: of results, of validity, of molecules."""
    functions: list[tuple[str, Any, str | None]] = [
        (f"validity.{name}", getattr(validity, name), None) for name in ("nearest_valid", "fit_in_box")
    ]
    functions += [
        ("equimomental.ellipsoid", equimomental.ellipsoid, None),
        ("forms.to_text", interop.to_text, None),
        ("forms.from_printout", interop.from_printout, None),
    ]
    functions += [
        (f"molecules.{name}", getattr(molecules, name), None)
        for name in molecules.__all__
        if inspect.isfunction(getattr(molecules, name))
    ]
    functions += [
        (f"kinematics.{name}", getattr(kinematics, name), None)
        for name in ("angular_velocity", "angular_acceleration", "quaternion")
    ]
    functions.append(("audit", polhode.audit, None))
    for holder in (polhode.PrincipalAxes, polhode.Trajectory):
        for name, method in inspect.getmembers(holder, inspect.isfunction):
            if not name.startswith("_") and f"{holder.__name__}.{name}" not in NO_TEST:
                functions.append((f"{holder.__name__}.{name}", method, holder.__name__))
    calls = []
    for name, function, of in functions:
        tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
        node = next(n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef))
        calls.append(_of_signature(name, function, node.args, of))
    return calls


def all_calls() -> list[Call]:
    """Every public callable with arguments that it takes."""
    return sorted([*_from_stub(), *_from_python()], key=lambda call: call.name)
