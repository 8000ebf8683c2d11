"""Every public callable that takes an array or a count, with absurd ones: ``python absurd.py``.

Run within an address space of 4 GB. Prints for each call its name, that of the exception and what it said.
"""

from __future__ import annotations

import json
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from documented import arrays, takes_arrays_alone
from polhode import RigidBody, _core, loads, orbits, regions, rolling

if TYPE_CHECKING:
    from collections.abc import Callable

#: Rows of a stack that exists; two of them broadcast to far more than there is.
SIDE = 1 << 17
#: Rows that exist nowhere.
ABSURD = 10**12

BODY = RigidBody.from_principal(1.0, (1.0, 1.2, 1.5), center_of_mass=(0.1, 0.0, 0.0))
TOP = RigidBody.from_principal(1.0, (0.2, 0.2, 0.1), center_of_mass=(0.0, 0.0, 0.3))
COLUMN = RigidBody.from_principal(np.ones((SIDE, 1)), (0.2, 0.2, 0.1), center_of_mass=(0.0, 0.0, 0.3))
V, Q, T = (0.1, 0.2, 1.0), (0.0, 0.0, 0.0, 1.0), np.diag([1.0, 1.2, 1.5])
WEIGHT = (0.0, 0.0, -9.81)
POINTS, FACES = np.eye(4)[:, :3], np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
MOTION, HEAVY = BODY.free_motion(V), TOP.heavy_top(V, (np.sin(0.2), 0.0, 0.0, np.cos(0.2)), WEIGHT)
MOTIONS, HEAVIES = COLUMN.free_motion(V), COLUMN.heavy_top(V, (np.sin(0.2), 0, 0, np.cos(0.2)), WEIGHT)
LOAD = _core.constant_torque(V)
GYROSTAT = BODY.gyrostat(V)
LOADS = _core.constant_torque(np.ones((SIDE, 1, 3)))
REGION = regions.ball(1.0)
BALL = RigidBody.from_principal(1.0, (0.1, 0.1, 0.1))
SPHERE = rolling.sphere(0.5)
CONTACT = rolling.plane(rolling.sphere(0.5))

#: Homogeneous shapes and their lengths.
SHAPES: dict[str, dict[str, Any]] = {
    "box": {"size": (1.0, 1.0, 1.0)},
    "cube": {"side": 1.0},
    "wedge": {"size": (1.0, 1.0, 1.0)},
    "pyramid": {"size": (1.0, 1.0, 1.0)},
    "tetrahedron": {"side": 1.0},
    "prism": {"sides": 6.0, "radius": 1.0, "height": 1.0},
    "sphere": {"radius": 1.0},
    "hollow_sphere": {"inner_radius": 0.5, "outer_radius": 1.0},
    "hemisphere": {"radius": 1.0},
    "ellipsoid": {"semi_axes": (1.0, 1.0, 1.0)},
    "cylinder": {"radius": 1.0, "height": 1.0},
    "tube": {"inner_radius": 0.5, "outer_radius": 1.0, "height": 1.0},
    "cone": {"radius": 1.0, "height": 1.0},
    "frustum": {"bottom_radius": 1.0, "top_radius": 0.5, "height": 1.0},
    "capsule": {"radius": 1.0, "length": 1.0},
    "torus": {"major_radius": 2.0, "minor_radius": 1.0},
    "disk": {"radius": 1.0},
    "annulus": {"inner_radius": 0.5, "outer_radius": 1.0},
    "rectangle": {"size": (1.0, 1.0)},
    "ellipse": {"semi_axes": (1.0, 1.0)},
    "triangle": {"vertices": np.eye(3)[:, :2]},
    "polygon": {"vertices": np.eye(3)[:, :2]},
    "rod": {"length": 1.0},
    "ring": {"radius": 1.0},
    "arc": {"radius": 1.0, "angle": 1.0},
}

#: For each callable its arguments by name: one row each.
ROWS: dict[str, tuple[Callable[..., object], dict[str, Any]]] = {
    "RigidBody": (RigidBody, {"mass": 1.0, "inertia": T, "center_of_mass": V}),
    "RigidBody.from_principal": (
        RigidBody.from_principal,
        {"mass": 1.0, "moments": (1.0, 1.2, 1.5), "axes": Q, "center_of_mass": V},
    ),
    "RigidBody.from_positive_products": (
        RigidBody.from_positive_products,
        {"mass": 1.0, "moments": (1.0, 1.2, 1.5), "products": (0.0, 0.0, 0.0), "center_of_mass": V},
    ),
    "RigidBody.inertia_about": (BODY.inertia_about, {"about": V}),
    "RigidBody.moment_about": (BODY.moment_about, {"axis": V, "about": V}),
    "RigidBody.principal_about": (BODY.principal_about, {"about": V}),
    "RigidBody.translated": (BODY.translated, {"displacement": V}),
    "RigidBody.rotated": (BODY.rotated, {"rotation": Q}),
    "RigidBody.mirrored": (BODY.mirrored, {"normal": V, "point": V}),
    "RigidBody.scaled": (BODY.scaled, {"length": 1.0, "mass": 1.0}),
    "RigidBody.with_sigma": (BODY.with_sigma, {"center_of_mass": V, "inertia": T}),
    "RigidBody.kinetic_energy": (BODY.kinetic_energy, {"omega": V, "velocity": V, "about": V}),
    "RigidBody.angular_momentum": (BODY.angular_momentum, {"omega": V, "velocity": V, "position": V}),
    "RigidBody.angular_acceleration": (BODY.angular_acceleration, {"omega": V, "torque": V}),
    "RigidBody.torque": (BODY.torque, {"omega": V, "angular_acceleration": V}),
    "RigidBody.point_velocity": (BODY.point_velocity, {"point": V, "omega": V, "velocity": V}),
    "RigidBody.point_acceleration": (BODY.point_acceleration, {"point": V, "omega": V, "acceleration": V}),
    "RigidBody.pivot_reaction": (BODY.pivot_reaction, {"omega": V, "attitude": Q, "gravity": V}),
    "RigidBody.stability": (BODY.stability, {"rate": 1.0, "about": V}),
    "RigidBody.free_motion": (BODY.free_motion, {"omega": V, "attitude": Q}),
    "RigidBody.free_motion_from_periods": (
        partial(BODY.free_motion_from_periods, mode="long-axis"),
        {"rotation_period": 10.0, "precession_period": 4.0, "phase": 0.0},
    ),
    "RigidBody.rolling_motion": (
        partial(BALL.rolling_motion, SPHERE),
        {"omega": V, "attitude": Q, "gravity": WEIGHT},
    ),
    "RigidBody.heavy_top": (TOP.heavy_top, {"omega": V, "attitude": Q, "gravity": WEIGHT}),
    "RigidBody.simulate": (
        lambda **rows: BODY.simulate([0.0, 1.0], **rows),
        {"omega": V, "attitude": Q, "position": V, "velocity": V},
    ),
    "RigidBody.from_voxels": (
        lambda density: RigidBody.from_voxels(density, 1.0),
        {"density": np.ones((2, 2, 2))},
    ),
    "RigidBody.from_particles": (
        RigidBody.from_particles,
        {"masses": np.ones(4), "positions": np.ones((4, 3))},
    ),
    "RigidBody.from_curve": (lambda points: RigidBody.from_curve(points, mass=1.0), {"points": POINTS}),
    "FreeMotion.herpolhode": (MOTION.herpolhode, {"t": 1.0}),
    "FreeMotion.poinsot": (MOTION.poinsot, {"t": 1.0}),
    "FreeMotion.sensitivity": (MOTION.sensitivity, {"t": 1.0}),
    "FreeMotion.error_bar": (MOTION.error_bar, {"t": 1.0}),
    "FreeMotion.at": (MOTION.at, {"t": 1.0}),
    "RigidBody.gyrostat": (BODY.gyrostat, {"momentum": V}),
    "Gyrostat.free_motion": (GYROSTAT.free_motion, {"omega": V, "attitude": Q}),
    "GyrostatMotion.at": (GYROSTAT.free_motion(V).at, {"t": 1.0}),
    "HeavyTop.at": (HEAVY.at, {"t": 1.0}),
    "HeavyTop.effective_potential": (HEAVY.effective_potential, {"inclination": 1.0}),
    "Load.torque": (lambda **rows: LOAD.torque(0.0, **rows), {"omega": V, "quaternion": Q}),
    "Load.force": (lambda **rows: LOAD.force(0.0, **rows), {"omega": V, "quaternion": Q}),
    "Load.potential": (
        lambda **rows: _core.uniform_gravity(V).potential(BODY, **rows),
        {"quaternion": Q, "position": V},
    ),
    "constant_torque": (_core.constant_torque, {"vector": V}),
    "constant_force": (_core.constant_force, {"vector": V, "point": V}),
    "uniform_gravity": (_core.uniform_gravity, {"gravity": V}),
    "gravity_gradient": (_core.gravity_gradient, {"mu": 1.0, "position": V, "velocity": V}),
    "kepler_states": (
        _core.kepler_states,
        {"mu": 1.0, "position": V, "velocity": (1.0, 0.2, 0.1), "elapsed": 1.0},
    ),
    "oblate_states": (
        lambda **rows: _core.oblate_states(elapsed=[1.0], **rows),
        {"mu": 1.0, "position": V, "velocity": (1.0, 0.2, 0.1), "j2": 0.01, "radius": 0.1, "pole": V},
    ),
    "kepler_period": (_core.kepler_period, {"mu": 1.0, "position": V, "velocity": (1.0, 0.2, 0.1)}),
    "dipole_field": (_core.dipole_field, {"strength": V, "position": V}),
    "magnetic": (_core.magnetic, {"dipole": V, "field": V, "gain": 1.0}),
    "panels": (
        lambda **rows: _core.panels(([V], [1.0], [V]), **rows),
        {"coefficients": np.full((1, 2), 0.25), "direction": V, "pressure": 1.0},
    ),
    "damping": (_core.damping, {"matrix": T, "quadratic": T}),
    "feedback": (_core.feedback, {"K": T, "D": T, "target": Q}),
    "nutation_damping": (
        lambda **rows: _core.nutation_damping(TOP, **rows),
        {"momentum": 1.0, "inertia": 1.0, "damping": 1.0},
    ),
    "rotor": (_core.rotor, {"momentum": V}),
    "wheel": (_core.wheel, {"axis": V, "inertia": 1.0, "rate": 1.0, "friction": 1.0, "dry_friction": 1.0}),
    "slug": (_core.slug, {"inertia": 1.0, "damping": 1.0}),
    "Load.carried": (_core.rotor(V).carried, {"t": 1.0, "omega": V}),
    "principal_axes": (_core.principal_axes, {"inertia": T}),
    "principal_moments": (_core.principal_moments, {"inertia": T}),
    "canonical_axes": (
        lambda **rows: _core.canonical_axes(rtol=1e-6, **rows),
        {"moments": V, "axes": np.eye(3)},
    ),
    "principal_derivative": (
        lambda **rows: _core.principal_derivative(rtol=1e-6, **rows),
        {"moments": V, "axes": np.eye(3), "tangent": T},
    ),
    "classify_tops": (lambda moments: _core.classify_tops(moments, 1e-6), {"moments": V}),
    "principal_gaps": (_core.principal_gaps, {"moments": V}),
    "ray_kappa": (_core.ray_kappa, {"moments": V}),
    "inertia_from_center_of_mass": (
        _core.inertia_from_center_of_mass,
        {"inertia": T, "mass": 1.0, "displacement": V},
    ),
    "inertia_to_center_of_mass": (
        _core.inertia_to_center_of_mass,
        {"inertia": T, "mass": 1.0, "displacement": (0.0, 0.0, 0.0)},
    ),
    "transport": (_core.transport, {"rate_in_frame": V, "vector": V, "frame_omega": V}),
    "rotate": (_core.rotate, {"quaternion": Q, "vector": V}),
    "quaternion_from_euler_angles": (_core.quaternion_from_euler_angles, {"angles": V}),
    "euler_angles_from_quaternion": (
        lambda quaternion: _core.euler_angles_from_quaternion(quaternion, "ZXZ", "nan"),
        {"quaternion": Q},
    ),
    "quaternion_from_matrix": (_core.quaternion_from_matrix, {"matrix": np.eye(3)}),
    "euler_rates": (_core.euler_rates, {"angles": V, "omega": V}),
    "angular_velocity_from_euler_rates": (
        _core.angular_velocity_from_euler_rates,
        {"angles": V, "rates": V},
    ),
    "from_pseudo_inertia": (_core.from_pseudo_inertia, {"pseudo_inertia": np.eye(4)}),
    "from_spatial_inertia": (_core.from_spatial_inertia, {"spatial_inertia": np.eye(6)}),
    "from_parameters": (_core.from_parameters, {"parameters": _core.to_parameters(BODY)}),
    "from_log_cholesky": (_core.from_log_cholesky, {"parameters": np.zeros(10)}),
    "nearest_valid": (_core.nearest_valid, {"inertia": T}),
    "within_box": (lambda **rows: _core.within_box(BODY, **rows), {"low": (-1.0,) * 3, "high": (1.0,) * 3}),
    "stick": (_core.stick, {"mass": 1.0, "inertia": 0.1, "a": 0.5, "b": 0.5}),
    "free_precession": (lambda **rows: _core.free_precession(TOP, **rows), {"omega": V, "about": V}),
    "least_spin": (
        lambda **rows: _core.least_spin(TOP, **rows),
        {"gravity": WEIGHT, "inclination": 0.1},
    ),
    "steady_precession": (
        lambda **rows: _core.steady_precession(TOP, **rows),
        {"spin": 100.0, "inclination": 0.1, "gravity": WEIGHT},
    ),
    "motion_sensitivity": (
        lambda **rows: _core.motion_sensitivity(BODY, [0.0, 1.0], load=None, about="center_of_mass", **rows),
        {"omega": V, "quaternion": Q},
    ),
    "real_numbers": (lambda numbers: _core.real_numbers(numbers, "numbers"), {"numbers": V}),
    **{name: (getattr(_core, name), {**sizes, "mass": 1.0}) for name, sizes in SHAPES.items()},
}

#: Calls whose absurdity is of another kind than that of many rows.
# Loads whose arguments are numbers, vectors, matrices: their docstrings tell what they take.
ROWS |= {
    name: (function, arrays(function))
    for name in loads.__all__
    if name not in ROWS and takes_arrays_alone(function := getattr(loads, name))
}

OTHERS: dict[str, Callable[[], object]] = {
    "FreeMotion.polhode": lambda: MOTION.polhode(10**12),
    "FreeMotion.polhode of 2**62": lambda: MOTION.polhode(2**62),
    "FreeMotion.polhode of 2**100": lambda: MOTION.polhode(2**100),
    "FreeMotion.polhode of a stack": lambda: MOTIONS.polhode(10**6),
    "FreeMotion.polhode of few": lambda: MOTION.polhode(-1),
    "FreeMotion.at of a stack": lambda: MOTIONS.at(np.linspace(0.0, 1.0, SIDE)),
    "FreeMotion.herpolhode of a stack": lambda: MOTIONS.herpolhode(np.linspace(0.0, 1.0, SIDE)),
    "FreeMotion.sensitivity of a stack": lambda: MOTIONS.sensitivity(np.linspace(0.0, 1.0, SIDE)),
    "HeavyTop.at of a stack": lambda: HEAVIES.at(np.linspace(0.0, 1.0, SIDE)),
    "HeavyTop.effective_potential of a stack": lambda: HEAVIES.effective_potential(np.linspace(0, 1, SIDE)),
    "RigidBody.simulate, many times": lambda: COLUMN.simulate(np.linspace(0.0, 1.0, SIDE), V),
    "RigidBody.simulate, absurd times": lambda: BODY.simulate(np.broadcast_to(0.0, ABSURD), V),
    "RigidBody.simulate, many loads": lambda: COLUMN.simulate([0.0, 1.0], many(V), load=LOADS),
    "motion_sensitivity, many times": lambda: _core.motion_sensitivity(
        COLUMN, np.linspace(0.0, 1.0, SIDE), V, Q, None, "center_of_mass"
    ),
    "rolling_states": lambda: _core.rolling_states(
        BALL, SPHERE, np.ones((SIDE, 3)), None, WEIGHT, 0.0, np.linspace(0.0, 1.0, SIDE)
    ),
    "RigidBody.__getitem__ of rows": lambda: COLUMN[np.broadcast_to(0, ABSURD)],
    "with_states": lambda: _core.with_states(None, np.broadcast_to(1.0, ABSURD)),
    "covariance_factor": lambda: _core.covariance_factor(np.broadcast_to(0.0, (10**6, 10**6))),
    "random_numbers": lambda: _core.random_numbers("normal", 0, 0, 0, ABSURD, 3),
    "oblate_states, absurd times": lambda: _core.oblate_states(
        1.0, V, (1.0, 0.2, 0.1), 0.01, 0.1, V, np.broadcast_to(1.0, ABSURD)
    ),
    "local_frames": lambda: _core.local_frames(
        orbits.kepler(1.0, (1, 0, 0), (0, 1, 0)), np.broadcast_to(1.0, ABSURD)
    ),
    "sampled_states": lambda: _core.sampled_states(
        np.broadcast_to(1.0, ABSURD), np.broadcast_to(1.0, (ABSURD, 3)), [1.0]
    ),
    "wheel, absurd times": lambda: _core.wheel(
        V, 1.0, torque=np.broadcast_to(1.0, ABSURD), times=np.broadcast_to(1.0, ABSURD)
    ),
    "thrusters, absurd forces": lambda: _core.thrusters(
        np.broadcast_to(V, (ABSURD, 3)),
        np.broadcast_to(V, (ABSURD, 3)),
        np.broadcast_to(1.0, ABSURD),
        command=[0.5],
        period=1.0,
    ),
    "panels, absurd plates": lambda: _core.panels(
        (np.broadcast_to(V, (ABSURD, 3)), np.broadcast_to(1.0, ABSURD), np.broadcast_to(V, (ABSURD, 3))),
        coefficients=(0.0, 0.0),
        direction=V,
        pressure=1.0,
    ),
    "wheels, absurd axes": lambda: _core.wheels(
        np.broadcast_to(V, (ABSURD, 3)), 1.0, torque=loads.feedback(K=1.0, D=1.0)
    ),
    "RigidBody.stepper, absurd omega": lambda: BODY.stepper(np.broadcast_to(V, (ABSURD, 3))),
    "fit_tumble, absurd times": lambda: _core.fit_tumble(
        np.broadcast_to(0.0, ABSURD), np.broadcast_to(V, (ABSURD, 3)), {}
    ),
    "tumble_information, absurd times": lambda: _core.tumble_information(
        np.broadcast_to(0.0, ABSURD), V, [1.0, 1.2, 1.5, 0.0, 0.0, 0.0], V, {}
    ),
    "Load.__getitem__": lambda: LOADS[np.broadcast_to(0, ABSURD)],
    "RigidBody.__add__": lambda: COLUMN + COLUMN[:, 0],
    "RigidBody.__sub__": lambda: COLUMN - COLUMN[:, 0],
    "RigidBody.sigma_about": lambda: BODY.with_sigma(mass=0.1).sigma_about(np.broadcast_to(1.0, (ABSURD, 3))),
    "RigidBody.covariance_with": lambda: COLUMN.covariance_with(COLUMN[:, 0]),
    "RigidBody.with_covariance": lambda: BODY.with_covariance(np.broadcast_to(1.0, (ABSURD, 10))),
    "Uncertain": lambda: _core.Uncertain(np.broadcast_to(1.0, ABSURD), 1.0),
    "Uncertain, sigma": lambda: _core.Uncertain(1.0, np.broadcast_to(1.0, ABSURD)),
    "RigidBody.isclose": lambda: COLUMN.isclose(COLUMN[:, 0]),
    "Load.__add__": lambda: LOADS + LOADS[:, 0],
    "RigidBody.from_density": lambda: RigidBody.from_density(
        lambda _: np.broadcast_to(1.0, ABSURD), REGION, max_evaluations=2**80
    ),
    "RigidBody.from_density of none": lambda: RigidBody.from_density(
        lambda r: r[:, 0] ** 2, REGION, max_evaluations=-1
    ),
    "RigidBody.from_radial_density": lambda: RigidBody.from_radial_density(
        lambda _: np.broadcast_to(1.0, ABSURD), 1.0
    ),
    "RigidBody.from_tetrahedra": lambda: RigidBody.from_tetrahedra(
        np.broadcast_to(1.0, (ABSURD, 3)), [(0, 1, 2, 3)], density=1.0
    ),
    "RigidBody.from_tetrahedra, cells": lambda: RigidBody.from_tetrahedra(
        POINTS, np.broadcast_to(np.arange(4), (ABSURD, 4)), density=1.0
    ),
    "RigidBody.from_mesh": lambda: RigidBody.from_mesh(np.broadcast_to(1.0, (ABSURD, 3)), FACES, density=1.0),
    "RigidBody.from_mesh, faces": lambda: RigidBody.from_mesh(
        POINTS, np.broadcast_to(np.arange(3), (ABSURD, 3)), density=1.0
    ),
    "RigidBody.from_surface": lambda: RigidBody.from_surface(
        POINTS, np.broadcast_to(np.arange(3), (ABSURD, 3)), mass=1.0
    ),
    "surface_area": lambda: _core.surface_area(POINTS, np.broadcast_to(np.arange(3), (ABSURD, 3))),
    "region_mesh": lambda: _core.region_mesh(POINTS, np.broadcast_to(np.arange(3), (ABSURD, 3))),
    "RigidBody.from_labelled_particles": lambda: RigidBody.from_labelled_particles(
        np.ones(3), np.eye(3), np.array([0, 1, ABSURD])
    ),
    "RigidBody.from_balls": lambda: RigidBody.from_balls(
        np.broadcast_to(1.0, (ABSURD, 3)), np.broadcast_to(1.0, ABSURD), density=1.0
    ),
    "RigidBody.from_labelled_voxels": lambda: RigidBody.from_labelled_voxels(
        np.broadcast_to(1, (ABSURD, 1, 1)), 1.0, spacing=1.0
    ),
    **{
        name: partial(
            getattr(_core, name),
            BODY,
            CONTACT,
            _core.uniform_gravity(WEIGHT),
            *(np.broadcast_to(x, (ABSURD, len(x))) for x in (V, Q, V, V)),
            *phases,
        )
        for name, phases in (("contact_history", (0.0,)), ("contact_invariants", ()))
    },
    "MassAccumulator.add": lambda: _core.MassAccumulator().add(
        np.broadcast_to(1.0, ABSURD), np.broadcast_to(1.0, (ABSURD, 3))
    ),
    "RigidBody.varying": lambda: RigidBody.varying(np.broadcast_to(1.0, ABSURD), BODY),
    "sampled": lambda: _core.sampled(np.broadcast_to(1.0, ABSURD), np.broadcast_to(1.0, (ABSURD, 3))),
    "schedule": lambda: _core.schedule(LOAD, np.broadcast_to(1.0, (ABSURD, 2))),
    **{
        f"RigidBody.{name} of a stack": call
        for name, call in {
            "inertia_about": lambda: COLUMN.inertia_about(many(V)),
            "principal_about": lambda: COLUMN.principal_about(many(V)),
            "kinetic_energy": lambda: COLUMN.kinetic_energy(many(V)),
            "free_motion": lambda: COLUMN.free_motion(many(V)),
            "heavy_top": lambda: COLUMN.heavy_top(many(V), Q, WEIGHT),
            "simulate": lambda: COLUMN.simulate([0.0, 1.0], many(V)),
            "simulate, load": lambda: COLUMN.simulate([0.0, 1.0], many(V), load=LOAD),
            "translated": lambda: COLUMN.translated(many(V)),
        }.items()
    },
}


def many(row: Any) -> Any:
    """Give a row `SIDE` times."""
    return np.broadcast_to(row, (SIDE, *np.shape(row)))


def calls() -> dict[str, Callable[[], object]]:
    """Give every call: rows that exist nowhere, and two arguments that broadcast to as many."""
    found = dict(OTHERS)
    for name, (function, rows) in ROWS.items():
        for argument, row in rows.items():
            if argument == "mass" and name not in ("RigidBody", "stick"):
                continue
            absurd = rows | {argument: np.broadcast_to(row, (ABSURD, *np.shape(row)))}
            found[f"{name}, {argument}"] = partial(function, **absurd)
        names = list(rows)
        for one, other in pairwise(names):
            column = np.broadcast_to(rows[one], (SIDE, 1, *np.shape(rows[one])))
            wide = rows | {one: column, other: many(rows[other])}
            found[f"{name}, {one} and {other}"] = partial(function, **wide)
    return found


def main() -> None:
    """Do every call."""
    for name, call in calls().items():
        try:
            call()
        except BaseException as error:
            print(json.dumps([name, type(error).__name__, str(error)]), flush=True)
        else:
            print(json.dumps([name, "", ""]), flush=True)


if __name__ == "__main__":
    main()
