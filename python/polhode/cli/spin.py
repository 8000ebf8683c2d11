"""``polhode spin``: the free motion of the body in a file, in numbers, tables and pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from polhode._extras import require
from polhode._files.trajectory import TRAJECTORY_SUFFIXES
from polhode.cli.layout import Field, Report
from polhode.cli.loading import load_body
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from polhode import Trajectory
    from polhode.cli.options import BodyOptions, SpinOptions

__all__ = ["PICTURE_SUFFIXES", "spin_report"]

PICTURE_SUFFIXES = (".png", ".pdf", ".svg")


def spin_report(file: Path, spin: SpinOptions, options: BodyOptions) -> Report:
    """Simulate the free motion, save it as asked for and report on it."""
    _check(spin)
    loaded = load_body(file, options)
    body = loaded.body
    to_radians = np.pi / 180.0 if spin.degrees else 1.0
    axes = body.principal.axes if spin.axes == "principal" else np.eye(3)
    start = axes @ (np.array(spin.omega) * to_radians)
    trajectory = body.simulate(np.linspace(0.0, spin.until, spin.samples), start, rtol=spin.rtol)
    rates = trajectory.omega[[0, -1]] @ axes / to_radians
    energy = trajectory.kinetic_energy().total
    momentum = trajectory.angular_momentum().total
    angles = np.rad2deg(trajectory.euler_angles("ZXZ", singular="nan")[-1])
    rate_unit = "deg/s" if spin.degrees else "rad/s"

    report = Report()
    report.section("", Field("file", "file", str(file)), Field("axes", "components", _axes_text(spin)))
    report.section(
        "body",
        Field("mass", "mass", body.mass, loaded.mass_unit),
        Field("principal_moments", "I1 I2 I3", body.principal_moments, loaded.moment_unit),
    )
    report.section(
        "motion",
        Field("time", "end", spin.until, "s"),
        Field("omega_start", "omega, start", rates[0], rate_unit),
        Field("omega_end", "omega, end", rates[1], rate_unit),
        Field("euler_angles_end", "Euler angles, end", angles, "deg", "ZXZ phi, theta, psi"),
    )
    report.section(
        "conserved",
        Field("kinetic_energy", "kinetic energy", energy[0], f"{loaded.moment_unit}/s^2"),
        Field("kinetic_energy_drift", "  drift", _drift(energy), hint="largest, relative"),
        Field("angular_momentum", "|L|", np.linalg.norm(momentum[0]), f"{loaded.moment_unit}/s"),
        Field(
            "angular_momentum_drift",
            "  drift of L",
            _drift(momentum),
            hint="largest, relative; the vector in space",
        ),
    )
    report.notes += loaded.notes
    if np.isnan(angles).any():
        report.notes.append("at the end theta is 0 or 180 deg, where phi and psi are not defined one by one")
    if options.length_unit is None and loaded.mass_unit != "u":
        report.notes.append("unit unknown: mass and moments are in the file's own unit of length")
    if loaded.assumed:
        report.notes.append(
            "neither density nor mass was given: density 1 was used; the motion does not depend on it"
        )
    for path in spin.save:
        _save(trajectory, path, spin, title=file.name)
        report.notes.append(f"saved {path}")
    return report


def _axes_text(spin: SpinOptions) -> str:
    return "along the principal axes e1 e2 e3" if spin.axes == "principal" else "along the file's axes x y z"


def _check(spin: SpinOptions) -> None:
    """Everything that can be refused before the work is."""
    if not np.isfinite(spin.omega).all():
        raise PolhodeError("--omega: give three finite numbers")
    if not (np.isfinite(spin.until) and spin.until != 0.0):
        raise PolhodeError(f"--until: {spin.until:g} is not a time other than 0")
    if spin.samples < 2:
        raise PolhodeError(f"--samples: {spin.samples} is less than 2, the start and the end")
    for path in spin.save:
        if path.suffix.lower() not in (*PICTURE_SUFFIXES, *TRAJECTORY_SUFFIXES):
            known = ", ".join((*PICTURE_SUFFIXES, *TRAJECTORY_SUFFIXES))
            raise PolhodeError(f"--save: {path} does not end in one of {known}")
        if not path.parent.is_dir():
            raise PolhodeError(f"--save: there is no directory {path.parent}; create it first")


def _drift(values: NDArray[np.float64]) -> float:
    """Largest distance from the value at the start, relative to that value."""
    distance = values - values[0]
    size = np.abs(values[0]) if values.ndim == 1 else np.linalg.norm(values[0])
    largest = np.max(np.abs(distance) if values.ndim == 1 else np.linalg.norm(distance, axis=-1))
    return float(largest / size) if size > 0.0 else 0.0


def _save(trajectory: Trajectory, path: Path, spin: SpinOptions, *, title: str) -> None:
    if path.suffix.lower() in TRAJECTORY_SUFFIXES:
        trajectory.save(path)
        return
    figure_module = require("matplotlib.figure", extra="plot", purpose=f"--save {path}:")
    from polhode.plot import angular_velocity

    # A figure of its own, outside pyplot: no window system is asked for.
    figure = figure_module.Figure(figsize=(8.0, 4.5), layout="constrained")
    frame: Literal["body", "principal"] = "principal" if spin.axes == "principal" else "body"
    ax = angular_velocity(trajectory, figure.add_subplot(), frame=frame, degrees=spin.degrees)
    ax.set_title(title, loc="left")
    figure.savefig(path, dpi=160)
